/* sonject devices: lists the devices. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/sonject.h>

#include "console.h"
#include "verbs.h"

struct device_options {
    char none; /* a structure needs a member */
};

/* Lists all devices; give *devices to free(). */
static sonject_status list_devices(sonject_context *context, sonject_device_info **devices,
                                   size_t *count)
{
    size_t capacity = 0;
    sonject_status status = sonject_devices(context, NULL, 0, &capacity);
    if (status != SONJECT_OK)
        return status;
    *devices = calloc(capacity, sizeof(**devices));
    if (!*devices)
        return SONJECT_ERROR_MEMORY;
    status = sonject_devices(context, *devices, capacity, count);
    if (*count > capacity)
        *count = capacity; /* a device was plugged in meanwhile */
    return status;
}

static int width(int least, size_t length)
{
    return (int)length > least ? (int)length : least;
}

static void print_table(const sonject_device_info *devices, size_t count)
{
    int name = width(4, 0), platform = width(8, 0);
    for (size_t i = 0; i < count; i++) {
        name = width(name, strlen(devices[i].name));
        platform = width(platform, strlen(devices[i].platform));
    }
    printf("  %-*s  %-*s  units  lanes  driver\n", name, "name", platform, "platform");
    for (size_t i = 0; i < count; i++) {
        const sonject_device_info *device = &devices[i];
        printf("%c %-*s  %-*s  %5" PRIu32 "  %5" PRIu32 "  %s\n", device->is_default ? '*' : ' ',
               name, device->name, platform, device->platform, device->compute_units,
               device->vector_width, device->driver);
    }
}

static int work(const void *verb_options)
{
    (void)verb_options;
    sonject_context *context = NULL;
    sonject_device_info *devices = NULL;
    size_t count = 0;
    /* The log says why OpenCL's devices are missing. */
    const sonject_context_params params = {.struct_size = sizeof params, .log = progress_log};
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = list_devices(context, &devices, &count);
    int code;
    if (status != SONJECT_OK) {
        code = fail_with(context, status);
    } else {
        print_table(devices, count);
        code = finish_output();
    }
    free(devices);
    sonject_context_release(&context);
    return code;
}

const struct verb devices_verb = {
    .name = "devices",
    .summary =
        "lists the devices: native, which is this processor, and OpenCL's; * marks the default",
    .notes = "",
    .options_size = sizeof(struct device_options),
    .work = work,
};
