#include "api/handles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/run.h"
#include "inject/injection.h"

sonject_status take_pixels(struct report *report, const sonject_pixels *pixels,
                           struct injection_input *input, float **packed)
{
    const size_t parts = pixels->kind == SONJECT_PIXELS_COMPLEX ? 2 : 1;
    if (pixels->struct_size < sizeof *pixels || !pixels->data ||
        pixels->kind > SONJECT_PIXELS_COMPLEX || pixels->row_stride % 4 != 0)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "pixels need struct_size, data, a known kind and a row stride that "
                              "is a multiple of 4");
    if (pixels->rows == 0 || pixels->columns == 0 || pixels->rows > SWATH_PIXELS_MAX ||
        pixels->columns > SWATH_PIXELS_MAX || pixels->rows * pixels->columns > SWATH_PIXELS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch of %llu x %llu pixels is empty or has more than 2^31",
                              (unsigned long long)pixels->rows,
                              (unsigned long long)pixels->columns);
    const size_t row_bytes = (size_t)pixels->columns * parts * sizeof(float);
    const size_t stride = pixels->row_stride ? (size_t)pixels->row_stride : row_bytes;
    if (stride < row_bytes)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "the row stride of %zu bytes is shorter than a row of %zu", stride,
                              row_bytes);
    *packed = allocate_array((size_t)pixels->rows, row_bytes);
    CHECK_MEMORY(report, *packed, "the patch");
    for (size_t row = 0; row < pixels->rows; row++)
        memcpy((char *)*packed + row * row_bytes, (const char *)pixels->data + row * stride,
               row_bytes);
    memset(input, 0, sizeof *input);
    input->rows = (size_t)pixels->rows;
    input->columns = (size_t)pixels->columns;
    input->is_complex = pixels->kind == SONJECT_PIXELS_COMPLEX;
    input->pixels = *packed;
    return SONJECT_OK;
}

sonject_status find_input(struct report *report, const struct scene *scene,
                          const sonject_pixels *pixels, struct injection_input *input,
                          float **owned)
{
    if (scene->calibrates_itself)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "input.calibration: auto is for runs on files: make a file with "
                              "sonject_calibrate and name it");
    if (pixels)
        return take_pixels(report, pixels, input, owned);
    if (scene->input_kind != SONJECT_INPUT_UNIFORM && scene->input_kind != SONJECT_INPUT_SYNTHETIC)
        return null_argument(report, "pixels");
    const sonject_status status = make_input(report, scene, input);
    *owned = (float *)input->pixels;
    return status;
}

sonject_status sonject_inject(sonject_context *context, const sonject_scene *handle,
                              const sonject_pixels *pixels, sonject_progress_function progress,
                              void *user, sonject_result **result)
{
    if (!context || !result)
        return SONJECT_ERROR_ARGUMENT;
    *result = NULL;
    context_begin_call(context);
    context_watch(context, &progress, &user);
    const struct scene *scene;
    CHECK(scene_use(&context->report, handle, &scene));
    struct injection_input input;
    float *owned = NULL;
    sonject_status status = find_input(&context->report, scene, pixels, &input, &owned);
    struct device *device = NULL;
    THEN(status, device_slot_open(&context->report, &context->device, scene->user_shapes.count > 0,
                                  &device));
    sonject_result *made = NULL;
    if (status == SONJECT_OK) {
        made = allocate_array(1, sizeof *made);
        status = made ? SONJECT_OK : report_out_of_memory(&context->report, "the result");
    }
    if (status == SONJECT_OK) {
        made->report = &context->report;
        status =
            injection_run(&context->report, device, scene, &input, progress, user, &made->result);
    }
    free(owned);
    if (status != SONJECT_OK) {
        free(made);
        return status;
    }
    tell_noise_floor(&context->report, scene, &made->result.statistics);
    tell_accuracy(&context->report, &made->result.statistics);
    *result = made;
    return SONJECT_OK;
}

void sonject_result_release(sonject_result **result)
{
    if (!result || !*result)
        return;
    injection_result_clear(&(*result)->result);
    free(*result);
    *result = NULL;
}

sonject_status sonject_result_size(const sonject_result *result, uint64_t *rows, uint64_t *columns,
                                   uint32_t *image_kind)
{
    if (!result || !rows || !columns || !image_kind)
        return SONJECT_ERROR_ARGUMENT;
    *rows = result->result.rows;
    *columns = result->result.columns;
    *image_kind = result->result.is_complex ? SONJECT_PIXELS_COMPLEX : SONJECT_PIXELS_AMPLITUDE;
    return SONJECT_OK;
}

/* Whether a buffer is as large as a layer. what: is said of the layer. */
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
        const void *data; /* NULL: a plane */
        enum injected_plane plane;
    } layers[] = {
        [SONJECT_LAYER_IMAGE] = {(made->is_complex ? 2 : 1) * sizeof(float), made->image,
                                 INJECTED_FIELD},
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
