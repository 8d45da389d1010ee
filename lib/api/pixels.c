#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "api/handles.h"
#include "base/memory.h"

static const enum pixel_type types[] = {[SONJECT_PIXELS_AMPLITUDE] = PIXEL_FLOAT32,
                                        [SONJECT_PIXELS_COMPLEX] = PIXEL_FLOAT32,
                                        [SONJECT_PIXELS_UINT8] = PIXEL_UINT8,
                                        [SONJECT_PIXELS_UINT16] = PIXEL_UINT16};

/* Copies the caller's structure to *taken, and its rows, packed, to swath->stored. borrows: linear
 * rows that are packed stay where they are, as swath->pixels. */
static sonject_status pack_pixels(struct report *report, const sonject_pixels *pixels, bool borrows,
                                  sonject_pixels *taken, struct swath *swath)
{
    memset(swath, 0, sizeof *swath);
    CHECK(params_take(report, taken, sizeof *taken, pixels, offsetof(sonject_pixels, transfer),
                      "pixels"));
    if (!taken->data || taken->kind > SONJECT_PIXELS_UINT16)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "pixels need data and a known kind");
    const size_t number = pixel_bytes(types[taken->kind]);
    if (taken->row_stride % number != 0)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "the row stride of pixels must be a multiple of %zu", number);
    if (taken->rows == 0 || taken->columns == 0 || taken->rows > SWATH_PIXELS_MAX ||
        taken->columns > SWATH_PIXELS_MAX || taken->rows * taken->columns > SWATH_PIXELS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch of %llu x %llu pixels is empty or has more than 2^31",
                              (unsigned long long)taken->rows, (unsigned long long)taken->columns);
    swath->is_complex = taken->kind == SONJECT_PIXELS_COMPLEX;
    swath->layout = (struct raster_layout){taken->rows, taken->columns, swath->is_complex ? 2 : 1,
                                           types[taken->kind]};
    swath->patch = (struct region){0, 0, taken->rows, taken->columns};
    const size_t row_bytes = (size_t)taken->columns * swath->layout.channels * number;
    const size_t stride = taken->row_stride ? (size_t)taken->row_stride : row_bytes;
    if (stride < row_bytes)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "the row stride of %zu bytes is shorter than a row of %zu", stride,
                              row_bytes);
    const bool is_linear = taken->kind <= SONJECT_PIXELS_COMPLEX && !taken->transfer;
    if (borrows && is_linear && stride == row_bytes && (uintptr_t)taken->data % number == 0) {
        swath->pixels = (float *)taken->data;
        swath->borrows_pixels = true;
        return SONJECT_OK;
    }
    swath->stored = allocate_array((size_t)taken->rows, row_bytes);
    CHECK_MEMORY(report, swath->stored, "the patch");
    for (size_t row = 0; row < taken->rows; row++)
        memcpy((char *)swath->stored + row * row_bytes, (const char *)taken->data + row * stride,
               row_bytes);
    return SONJECT_OK;
}

/* Reads the transfer function of an image of this kind. text: NULL if the image is linear. */
static sonject_status read_transfer(struct report *report, uint32_t kind, const char *text,
                                    sonject_transfer_params *transfer)
{
    struct image_options options;
    if (!text && kind >= SONJECT_PIXELS_UINT8)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "pixels of whole numbers need their transfer function, such as "
                              "{kind: amplitude}");
    if (text && kind == SONJECT_PIXELS_COMPLEX)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "complex pixels have no transfer function: take transfer out");
    memset(transfer, 0, sizeof *transfer);
    if (!text)
        return SONJECT_OK;
    CHECK(image_options_take(report, NULL, NULL, text, NULL, &options));
    *transfer = options.transfer;
    return SONJECT_OK;
}

sonject_status take_stored(struct report *report, const sonject_pixels *pixels, struct swath *swath)
{
    sonject_pixels taken;
    CHECK(pack_pixels(report, pixels, false, &taken, swath));
    if (taken.transfer)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "calibrate finds the transfer function itself: take transfer out");
    return SONJECT_OK;
}

sonject_status take_pixels(struct report *report, const sonject_pixels *pixels, struct swath *swath)
{
    sonject_pixels taken;
    CHECK(pack_pixels(report, pixels, true, &taken, swath));
    CHECK(read_transfer(report, taken.kind, taken.transfer, &swath->transfer));
    swath->is_whole = swath->layout.type != PIXEL_FLOAT32;
    if (taken.transfer)
        return swath_linearise(report, NULL, swath);
    if (!swath->borrows_pixels)
        swath->pixels = swath->stored;
    swath->stored = NULL;
    return SONJECT_OK;
}

sonject_status find_input(struct report *report, const struct scene *scene,
                          const sonject_pixels *pixels, struct swath *swath)
{
    memset(swath, 0, sizeof *swath);
    if (scene->calibrates_itself)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "input.calibration: auto is for runs on files: make a file with "
                              "sonject_calibrate and name it");
    if (pixels) {
        CHECK(take_pixels(report, pixels, swath));
        return swath_find_empty(report, scene, swath);
    }
    if (scene->input_kind == SONJECT_INPUT_FILE)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "the scene names a file, which only runs read: use sonject_run (in "
                              "Python sonject.run(scene, folder)), or give the file's pixels");
    if (scene->input_kind != SONJECT_INPUT_UNIFORM && scene->input_kind != SONJECT_INPUT_SYNTHETIC)
        return null_argument(report, "pixels");
    struct injection_input input;
    CHECK(make_input(report, scene, &input));
    swath->is_made = true;
    swath->is_complex = input.is_complex;
    swath->layout = made_layout(scene);
    swath->patch = (struct region){0, 0, input.rows, input.columns};
    swath->pixels = (float *)input.pixels;
    return SONJECT_OK;
}

static sonject_status convert(struct report *report, const struct swath *swath, uint32_t kind,
                              const char *text, void *buffer, size_t bytes)
{
    sonject_transfer_params transfer;
    uint64_t clipped = 0;
    const size_t columns = (size_t)swath->patch.columns;
    const size_t count = (size_t)swath->patch.rows * columns;
    if (swath->is_complex || kind == SONJECT_PIXELS_COMPLEX || kind > SONJECT_PIXELS_UINT16)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "amplitudes and stored numbers are converted, not complex pixels");
    CHECK(read_transfer(report, kind, text, &transfer));
    const enum pixel_type type = types[kind];
    if (bytes != count * pixel_bytes(type))
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "the pixels have %zu bytes, the buffer %zu",
                              count * pixel_bytes(type), bytes);
    for (size_t i = 0; i < count; i++)
        if (!(swath->pixels[i] >= 0.0f) || !isfinite(swath->pixels[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "the pixel at row %zu, column %zu is %g: amplitudes are finite "
                                  "numbers from 0 on",
                                  i / columns, i % columns, (double)swath->pixels[i]);
    if (!text) {
        memcpy(buffer, swath->pixels, bytes);
        return SONJECT_OK;
    }
    transfer_to_stored(&transfer, type, type == PIXEL_FLOAT32 ? 0 : 1, swath->pixels, count, buffer,
                       &clipped);
    if (clipped > 0)
        report_log(report, "%llu pixels are cut at full scale", (unsigned long long)clipped);
    return SONJECT_OK;
}

sonject_status sonject_pixels_convert(sonject_context *context, const sonject_pixels *pixels,
                                      sonject_pixel_kind kind, const char *transfer, void *buffer,
                                      size_t bytes)
{
    struct swath swath;
    CHECK(context_begin_call(context));
    if (!pixels || !buffer)
        return null_argument(&context->report, "pixels and buffer");
    sonject_status status = take_pixels(&context->report, pixels, &swath);
    THEN(status, convert(&context->report, &swath, (uint32_t)kind, transfer, buffer, bytes));
    swath_close(&swath);
    return status;
}
