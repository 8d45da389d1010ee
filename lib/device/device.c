/* The choice of a device, and its functions, which call those of its kind. */
#include "device/device.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/backend.h"

void device_take_info(struct device *device, const sonject_device_info *info)
{
    memcpy(device->name, info->name, sizeof device->name);
    memcpy(device->platform, info->platform, sizeof device->platform);
    memcpy(device->driver, info->driver, sizeof device->driver);
    device->width = info->vector_width;
    device->group_items = 1;
    device->compute_units = info->compute_units;
}

sonject_status device_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count)
{
    const size_t rest = capacity > 1 ? capacity - 1 : 0;
    struct report of_opencl = {.host = NULL};
    size_t gpu;
    if (capacity > 0)
        native_describe(&devices[0]);
    if (opencl_list(&of_opencl, rest > 0 ? devices + 1 : NULL, rest, count, &gpu) != SONJECT_OK &&
        capacity > 0)
        report_note(report, "%s", of_opencl.message);
    const size_t chosen = gpu < *count ? gpu + 1 : 0;
    *count += 1;
    for (size_t i = 0; i < *count && i < capacity; i++)
        devices[i].is_default = i == chosen;
    return SONJECT_OK;
}

/* Returns whether there is a GPU; false if OpenCL cannot be asked, as in a forked child. */
static bool has_gpu(void)
{
    struct report ignored = {.host = NULL};
    size_t count, gpu;
    return opencl_list(&ignored, NULL, 0, &count, &gpu) == SONJECT_OK && gpu < count;
}

static sonject_status open_chosen(struct report *report, const sonject_context_params *params,
                                  struct device *device)
{
    const char *environment = getenv("SONJECT_DEVICE");
    const char *name = params->device_name             ? params->device_name
                       : environment && environment[0] ? environment
                                                       : NULL;
    const bool is_native = name ? native_is_named(name) : !has_gpu();
    return is_native ? native_open(report, params, device) : opencl_open(report, name, device);
}

sonject_status device_open(struct report *report, const sonject_context_params *params,
                           struct device **out)
{
    *out = NULL;
    struct device *device = allocate_array(1, sizeof *device);
    CHECK_MEMORY(report, device, "the device");
    const sonject_status status = open_chosen(report, params, device);
    if (status != SONJECT_OK) {
        device_close(&device);
        return status;
    }
    report_log(report, "device '%s' of %s, %u lanes", device->name, device->platform,
               (unsigned)device->width);
    *out = device;
    return SONJECT_OK;
}

sonject_status device_slot_open(struct report *report, struct device_slot *slot,
                                struct device **device)
{
    *device = NULL;
    if (slot->device)
        CHECK(slot->device->calls->claim(report));
    else
        CHECK(device_open(report, &slot->params, &slot->device));
    *device = slot->device;
    return SONJECT_OK;
}

void device_slot_close(struct device_slot *slot)
{
    device_close(&slot->device);
}

void device_close(struct device **device)
{
    if (!device || !*device)
        return;
    if ((*device)->calls)
        (*device)->calls->close(*device);
    free(*device);
    *device = NULL;
}

sonject_status buffer_reserve(struct report *report, struct device *device, size_t bytes,
                              device_buffer *buffer)
{
    const size_t size = bytes > 0 ? bytes : 1;
    *buffer = NULL;
    if (size > device->allocation_limit)
        return report_failure(report, SONJECT_ERROR_DEVICE,
                              "device '%s' allows buffers of %zu MB, %zu MB are needed: use a "
                              "smaller patch",
                              device->name, device->allocation_limit >> 20, size >> 20);
    return device->calls->buffer_reserve(report, device, size, buffer);
}

sonject_status buffer_create(struct report *report, struct device *device, size_t bytes,
                             const void *contents, device_buffer *buffer)
{
    CHECK(buffer_reserve(report, device, bytes, buffer));
    const sonject_status status = contents
                                      ? buffer_write(report, device, *buffer, 0, bytes, contents)
                                      : buffer_clear(report, device, *buffer, bytes);
    if (status != SONJECT_OK)
        buffer_release(device, buffer);
    return status;
}

void buffer_release(struct device *device, device_buffer *buffer)
{
    if (*buffer)
        device->calls->buffer_release(*buffer);
    *buffer = NULL;
}

sonject_status buffer_read(struct report *report, struct device *device, device_buffer buffer,
                           size_t offset, size_t bytes, void *contents)
{
    return bytes == 0 ? SONJECT_OK
                      : device->calls->buffer_read(report, device, buffer, offset, bytes, contents);
}

sonject_status buffer_write(struct report *report, struct device *device, device_buffer buffer,
                            size_t offset, size_t bytes, const void *contents)
{
    return bytes == 0
               ? SONJECT_OK
               : device->calls->buffer_write(report, device, buffer, offset, bytes, contents);
}

sonject_status buffer_map(struct report *report, struct device *device, device_buffer buffer,
                          size_t bytes, const void **contents)
{
    return device->calls->buffer_map(report, device, buffer, bytes > 0 ? bytes : 1, contents);
}

void buffer_unmap(struct device *device, device_buffer buffer, const void *contents)
{
    device->calls->buffer_unmap(device, buffer, contents);
}

sonject_status buffer_clear(struct report *report, struct device *device, device_buffer buffer,
                            size_t bytes)
{
    return bytes == 0 ? SONJECT_OK : device->calls->buffer_clear(report, device, buffer, bytes);
}

sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program program, enum program_variant variant,
                             const char *name, device_kernel *kernel)
{
    *kernel = NULL;
    return device->calls->kernel_create(report, device, program, variant, name, kernel);
}

void kernel_release(struct device *device, device_kernel *kernel)
{
    if (*kernel)
        device->calls->kernel_release(*kernel);
    *kernel = NULL;
}

sonject_status kernel_run(struct report *report, struct device *device, device_kernel kernel,
                          const struct kernel_argument *arguments, size_t argument_count,
                          uint32_t dimensions, const size_t *global)
{
    return device->calls->kernel_run(report, device, kernel, arguments, argument_count, dimensions,
                                     global);
}
