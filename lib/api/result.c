#include "api/handles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/run.h"
#include "inject/injection.h"

/* Makes the image as the caller stores it. */
static sonject_status store_image(struct report *report, const struct swath *swath,
                                  sonject_result *made)
{
    sonject_statistics *statistics = &made->result.statistics;
    statistics->input_clipped = swath->clipped;
    made->stored_type = swath->layout.type;
    made->stored = swath_stored_result(swath, &made->result, &statistics->output_clipped);
    CHECK_MEMORY(report, made->stored, "the result");
    return SONJECT_OK;
}

sonject_status sonject_inject(sonject_context *context, const sonject_scene *handle,
                              const sonject_pixels *pixels, sonject_progress_function progress,
                              void *user, sonject_result **result)
{
    BEGIN_MAKING(context, result);
    context_watch(context, &progress, &user);
    struct report *report = &context->report;
    const struct scene *scene;
    CHECK(scene_use(report, handle, &scene));
    struct swath swath;
    sonject_status status = find_input(report, scene, pixels, &swath);
    struct device *device = NULL;
    THEN(status, device_slot_open(report, &context->device, &device));
    sonject_result *made = NULL;
    if (status == SONJECT_OK) {
        made = allocate_array(1, sizeof *made);
        status = made ? SONJECT_OK : report_out_of_memory(report, "the result");
    }
    if (status == SONJECT_OK) {
        const struct injection_input input = swath_input(&swath);
        made->report = report;
        status = injection_run(report, device, scene, &input, progress, user, &made->result);
        if (status == SONJECT_OK)
            swath_leave_empty(&swath, &made->result);
        if (swath.stored)
            THEN(status, store_image(report, &swath, made));
    }
    if (status == SONJECT_OK)
        tell_result(report, scene, &swath, &made->result);
    swath_close(&swath);
    if (status != SONJECT_OK) {
        sonject_result_release(&made);
        return status;
    }
    *result = made;
    return context_finish(context, SONJECT_OK);
}

void sonject_result_release(sonject_result **result)
{
    if (!result || !*result)
        return;
    injection_result_clear(&(*result)->result);
    free((*result)->stored);
    free(*result);
    *result = NULL;
}

sonject_status sonject_result_size(const sonject_result *result, uint64_t *rows, uint64_t *columns,
                                   uint32_t *image_kind)
{
    static const sonject_pixel_kind kinds[] = {[PIXEL_UINT8] = SONJECT_PIXELS_UINT8,
                                               [PIXEL_UINT16] = SONJECT_PIXELS_UINT16,
                                               [PIXEL_FLOAT32] = SONJECT_PIXELS_AMPLITUDE};
    if (!result)
        return SONJECT_ERROR_ARGUMENT;
    if (!rows || !columns || !image_kind)
        return null_argument(result->report, "rows, columns and image_kind");
    *rows = result->result.rows;
    *columns = result->result.columns;
    *image_kind = result->stored              ? kinds[result->stored_type]
                  : result->result.is_complex ? SONJECT_PIXELS_COMPLEX
                                              : SONJECT_PIXELS_AMPLITUDE;
    return SONJECT_OK;
}

/* Checks that a buffer is as large as a layer. what: the layer, for messages. */
static sonject_status check_buffer(const sonject_result *result, const char *what,
                                   size_t pixel_bytes, size_t bytes)
{
    const size_t needed = result->result.rows * result->result.columns * pixel_bytes;
    if (bytes != needed)
        return report_failure(result->report, SONJECT_ERROR_ARGUMENT,
                              "%s has %zu bytes, the buffer %zu", what, needed, bytes);
    return SONJECT_OK;
}

sonject_status sonject_result_layer(const sonject_result *result, sonject_layer layer, void *buffer,
                                    size_t bytes)
{
    if (!result)
        return SONJECT_ERROR_ARGUMENT;
    if (!buffer)
        return null_argument(result->report, "buffer");
    const struct injection_result *made = &result->result;
    const struct {
        size_t pixel_bytes;
        const void *data; /* NULL: see plane */
        enum injected_plane plane;
    } layers[] = {
        [SONJECT_LAYER_IMAGE] = {result->stored ? pixel_bytes(result->stored_type)
                                                : (made->is_complex ? 2 : 1) * sizeof(float),
                                 result->stored ? result->stored : made->image, INJECTED_FIELD},
        [SONJECT_LAYER_FIELD] = {2 * sizeof(float), NULL, INJECTED_FIELD},
        [SONJECT_LAYER_ENERGY] = {sizeof(float), NULL, INJECTED_ENERGY},
        [SONJECT_LAYER_VISIBILITY] = {sizeof(float), NULL, INJECTED_VISIBILITY},
        [SONJECT_LAYER_HIGHLIGHT] = {1, made->highlight, INJECTED_FIELD},
        [SONJECT_LAYER_SHADOW] = {1, made->shadow, INJECTED_FIELD},
        [SONJECT_LAYER_LABELS] = {1, made->labels, INJECTED_FIELD},
        [SONJECT_LAYER_INFLUENCE] = {1, made->influence, INJECTED_FIELD},
    };
    char what[32];
    snprintf(what, sizeof what, "layer %d", (int)layer);
    if ((size_t)layer >= sizeof layers / sizeof *layers)
        return report_failure(result->report, SONJECT_ERROR_ARGUMENT, "%s does not exist", what);
    CHECK(check_buffer(result, what, layers[layer].pixel_bytes, bytes));
    if (layers[layer].data)
        memcpy(buffer, layers[layer].data, bytes);
    else
        injection_result_plane(made, layers[layer].plane, buffer);
    return SONJECT_OK;
}

sonject_status sonject_result_order_energy(const sonject_result *result, uint32_t order,
                                           void *buffer, size_t bytes)
{
    if (!result)
        return SONJECT_ERROR_ARGUMENT;
    if (!buffer)
        return null_argument(result->report, "buffer");
    const uint32_t orders = result->result.orders;
    if (orders == 0)
        return report_failure(result->report, SONJECT_ERROR_ARGUMENT,
                              "the energies of the orders were not kept: set order_energies");
    if (order < 1 || order > orders)
        return report_failure(result->report, SONJECT_ERROR_ARGUMENT,
                              "there is no order %u, only 1 to %u", (unsigned)order,
                              (unsigned)orders);
    CHECK(check_buffer(result, "the energy of an order", sizeof(float), bytes));
    injection_result_plane(&result->result, INJECTED_ORDER + order - 1, buffer);
    return SONJECT_OK;
}

sonject_status sonject_result_object(const sonject_result *result, uint32_t index,
                                     sonject_object_truth *truth)
{
    if (!result)
        return SONJECT_ERROR_ARGUMENT;
    if (index >= result->result.object_count)
        return report_failure(result->report, SONJECT_ERROR_ARGUMENT,
                              "there is no object %u, only %u", (unsigned)index,
                              (unsigned)result->result.object_count);
    return params_give(result->report, truth, &result->result.objects[index], sizeof *truth,
                       sizeof *truth, "truth");
}

sonject_status sonject_result_statistics(const sonject_result *result,
                                         sonject_statistics *statistics)
{
    if (!result)
        return SONJECT_ERROR_ARGUMENT;
    return params_give(result->report, statistics, &result->result.statistics, sizeof *statistics,
                       sizeof *statistics, "statistics");
}
