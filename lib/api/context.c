#include "api/handles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/memory.h"

const char *sonject_status_name(sonject_status status)
{
    switch (status) {
    case SONJECT_OK:
        return "ok";
    case SONJECT_ERROR_ARGUMENT:
        return "bad argument";
    case SONJECT_ERROR_INPUT:
        return "bad input";
    case SONJECT_ERROR_DEVICE:
        return "device failure";
    case SONJECT_ERROR_STORAGE:
        return "storage failure";
    case SONJECT_ERROR_MEMORY:
        return "out of memory";
    case SONJECT_ERROR_UNSUPPORTED:
        return "not in this build";
    case SONJECT_CANCELLED:
        return "cancelled";
    }
    return "unknown status";
}

sonject_status context_begin_call(struct sonject_context *context)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context->report.message[0] = '\0';
    context->report.input_count = 0;
    context->host.progress = NULL;
    return SONJECT_OK;
}

static int pass_on(void *user, double fraction, const char *stage)
{
    struct report_host *host = user;
    host->fraction = fraction;
    snprintf(host->stage, sizeof host->stage, "%s", stage);
    return host->progress(host->progress_user, fraction, stage);
}

void context_watch(struct sonject_context *context, sonject_progress_function *progress,
                   void **user)
{
    struct report_host *host = &context->host;
    host->progress = *progress;
    host->progress_user = *user;
    host->fraction = 0.0;
    strcpy(host->stage, "reading");
    if (!*progress)
        return;
    *progress = pass_on;
    *user = host;
}

sonject_status context_finish(struct sonject_context *context, sonject_status status)
{
    const struct report_host *host = &context->host;
    if (status == SONJECT_OK && host->progress && host->fraction < 1.0)
        host->progress(host->progress_user, 1.0, host->stage);
    return status;
}

sonject_status null_argument(struct report *report, const char *name)
{
    return report_failure(report, SONJECT_ERROR_ARGUMENT, "%s must not be NULL", name);
}

static uint32_t size_of(const void *params)
{
    uint32_t size;
    memcpy(&size, params, sizeof size);
    return size;
}

sonject_status params_take(struct report *report, void *to, size_t to_size, const void *from,
                           size_t smallest, const char *name)
{
    if (!from)
        return null_argument(report, name);
    const size_t size = size_of(from);
    if (size < smallest)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "%s: struct_size is %zu, at least %zu is needed: set it to the "
                              "structure's size",
                              name, size, smallest);
    for (size_t i = to_size; i < size; i++)
        if (((const unsigned char *)from)[i] != 0)
            return report_failure(report, SONJECT_ERROR_ARGUMENT,
                                  "%s sets members that version %s of the library does not know",
                                  name, sonject_version());
    memset(to, 0, to_size);
    memcpy(to, from, size < to_size ? size : to_size);
    const uint32_t known = (uint32_t)to_size;
    memcpy(to, &known, sizeof known);
    return SONJECT_OK;
}

sonject_status params_give(struct report *report, void *to, const void *from, size_t from_size,
                           size_t smallest, const char *name)
{
    if (!to)
        return null_argument(report, name);
    const uint32_t size = size_of(to);
    if (size < smallest)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "%s: struct_size is %u, at least %zu is needed", name, (unsigned)size,
                              smallest);
    memcpy(to, from, size < from_size ? size : from_size);
    memcpy(to, &size, sizeof size);
    return SONJECT_OK;
}

static sonject_status copy_params(struct sonject_context *context,
                                  const sonject_context_params *params)
{
    if (!params)
        return SONJECT_OK;
    sonject_context_params taken;
    CHECK(params_take(&context->report, &taken, sizeof taken, params,
                      offsetof(sonject_context_params, decodes_in_process), "context parameters"));
    context->report.log = taken.log;
    context->host.log_user = taken.log_user;
    context->decoder.is_in_process = taken.decodes_in_process != 0;
    context->device.params = taken;
    context->device.params.device_name = taken.device_name ? copy_text(taken.device_name) : NULL;
    if (taken.device_name && !context->device.params.device_name)
        return SONJECT_ERROR_MEMORY;
    return SONJECT_OK;
}

sonject_status sonject_context_create(const sonject_context_params *params,
                                      sonject_context **context)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    *context = NULL;
    struct sonject_context *made = allocate_array(1, sizeof *made);
    if (!made)
        return SONJECT_ERROR_MEMORY;
    made->host.decoder = &made->decoder;
    made->report.host = &made->host;
    const sonject_status status = copy_params(made, params);
    if (status != SONJECT_OK) {
        sonject_context_release(&made);
        return status;
    }
    *context = made;
    return SONJECT_OK;
}

void sonject_context_release(sonject_context **context)
{
    if (!context || !*context)
        return;
    device_slot_close(&(*context)->device);
    decoder_stop(&(*context)->decoder);
    free((char *)(*context)->device.params.device_name);
    free(*context);
    *context = NULL;
}

const char *sonject_context_message(const sonject_context *context)
{
    return context ? context->report.message : "";
}

sonject_status sonject_devices(sonject_context *context, sonject_device_info *devices,
                               size_t capacity, size_t *count)
{
    CHECK(context_begin_call(context));
    if (!count || (capacity > 0 && !devices))
        return null_argument(&context->report, "devices and count");
    return device_list(&context->report, devices, capacity, count);
}
