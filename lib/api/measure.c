/* Measurements of images and contacts, and calibration. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/calibrate.h>

#include "api/handles.h"
#include "base/memory.h"
#include "measure/calibration.h"
#include "measure/measures.h"

/* Makes a float for each of a swath's pixels: its number, or the magnitude of a complex one.
 * numbers: the swath's stored pixels or its linear ones. */
static sonject_status find_magnitudes(struct report *report, const struct swath *swath,
                                      enum pixel_type type, const void *numbers, float **made)
{
    const size_t columns = (size_t)swath->patch.columns;
    const size_t count = (size_t)swath->patch.rows * columns;
    float *values = *made = allocate_array(count, sizeof *values);
    CHECK_MEMORY(report, values, "the patch");
    for (size_t i = 0; i < count; i++) {
        values[i] = swath->is_complex ? hypotf((float)pixel_number(type, numbers, 2 * i),
                                               (float)pixel_number(type, numbers, 2 * i + 1))
                                      : (float)pixel_number(type, numbers, i);
        if (!isfinite(values[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "the pixel at row %zu, column %zu is not a finite number",
                                  i / columns, i % columns);
    }
    return SONJECT_OK;
}

/* Takes the amplitudes of a caller's pixels. */
static sonject_status take_amplitudes(struct report *report, const sonject_pixels *pixels,
                                      struct measured *measured)
{
    struct swath swath;
    sonject_status status = take_pixels(report, pixels, &swath);
    measured->rows = (size_t)swath.patch.rows;
    measured->columns = (size_t)swath.patch.columns;
    THEN(status,
         find_magnitudes(report, &swath, PIXEL_FLOAT32, swath.pixels, &measured->amplitudes));
    for (size_t i = 0; status == SONJECT_OK && i < measured->rows * measured->columns; i++)
        if (measured->amplitudes[i] < 0.0f)
            status = negative_amplitude(report, "pixels", i, measured->columns);
    swath_close(&swath);
    return status;
}

static sonject_status copy_mask(struct report *report, const uint8_t *mask, size_t count,
                                uint8_t **copy)
{
    if (!mask)
        return SONJECT_OK;
    *copy = allocate_array(count, 1);
    CHECK_MEMORY(report, *copy, "a mask");
    memcpy(*copy, mask, count);
    return SONJECT_OK;
}

static sonject_status measure_pixels(struct report *report, const sonject_measure_params *params,
                                     sonject_measurement *made)
{
    struct measured measured;
    memset(&measured, 0, sizeof measured);
    sonject_status status = take_amplitudes(report, params->pixels, &measured);
    const size_t count = measured.rows * measured.columns;
    THEN(status, copy_mask(report, params->labels_mask, count, &measured.labels));
    THEN(status, measure_amplitudes(report, &measured, made));
    measured_clear(&measured);
    return status;
}

/* Takes the image and its options. */
static sonject_status take_image(struct report *report, const sonject_measure_params *params,
                                 sonject_measure_params *taken, struct image_options *options)
{
    CHECK(params_take(report, taken, sizeof *taken, params, sizeof *taken, "measure parameters"));
    if (!taken->image == !taken->pixels)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "give an image file, or pixels");
    if (taken->pixels && (taken->transfer || taken->channel || taken->array || taken->labels))
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "transfer, channel, array and labels are of image files: pixels have "
                              "a transfer of their own, and labels_mask");
    if (taken->image && taken->labels_mask)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "labels_mask is of pixels: labels names the mask of an image file");
    return image_options_take(report, taken->channel, taken->array, taken->transfer, NULL, options);
}

sonject_status sonject_measure(sonject_context *context, const sonject_measure_params *params,
                               sonject_measurement *measurement)
{
    sonject_measure_params taken;
    struct image_options options;
    sonject_measurement made;
    CHECK(context_begin_call(context));
    struct report *report = &context->report;
    CHECK(take_image(report, params, &taken, &options));
    CHECK(taken.pixels ? measure_pixels(report, &taken, &made)
                       : measure_file(report, &taken, &options, &made));
    return params_give(report, measurement, &made, sizeof made, sizeof made, "measurement");
}

sonject_status sonject_measure_contact(sonject_context *context, const sonject_pixels *pixels,
                                       const sonject_box *box, double row_spacing_m,
                                       double column_spacing_m, sonject_contact_measures *measures)
{
    sonject_contact_measures found;
    struct measured measured;
    CHECK(context_begin_call(context));
    struct report *report = &context->report;
    memset(&measured, 0, sizeof measured);
    if (!pixels || !measures)
        return null_argument(report, "pixels and measures");
    sonject_status status = check_spacings(report, row_spacing_m, column_spacing_m);
    THEN(status, take_amplitudes(report, pixels, &measured));
    THEN(status, measured_square(report, &measured));
    THEN(status, measure_one_contact(report, measured.amplitudes, measured.rows, measured.columns,
                                     box, row_spacing_m, column_spacing_m, &found));
    THEN(status,
         params_give(report, measures, &found, sizeof found, sizeof found, "contact measures"));
    measured_clear(&measured);
    return status;
}

static sonject_status check_contacts(struct report *report, const sonject_measure_params *params)
{
    if (params->box_count > 0 && !params->boxes)
        return null_argument(report, "boxes");
    if (params->box_count == 0 && !params->truth)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "give boxes, or a run's truth");
    if (params->box_count > BOXES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT, "at most %d contacts are measured",
                              BOXES_MAX);
    return check_spacings(report, params->row_spacing_m, params->column_spacing_m);
}

sonject_status sonject_measure_contacts(sonject_context *context,
                                        const sonject_measure_params *params, char **text)
{
    sonject_measure_params taken;
    struct image_options options;
    struct measured measured;
    BEGIN_MAKING(context, text);
    struct report *report = &context->report;
    memset(&measured, 0, sizeof measured);
    CHECK(take_image(report, params, &taken, &options));
    CHECK(check_contacts(report, &taken));
    sonject_status status = taken.pixels ? take_amplitudes(report, taken.pixels, &measured)
                                         : read_amplitudes(report, &taken, &options, &measured);
    THEN(status, measured_square(report, &measured));
    THEN(status, measure_listed_contacts(report, &taken, &measured, text));
    measured_clear(&measured);
    return status;
}

static sonject_status calibrate_pixels(struct report *report,
                                       const sonject_calibrate_params *params,
                                       const struct image_options *options, char **text)
{
    struct swath swath;
    float *values = NULL;
    sonject_status status = take_stored(report, params->pixels, &swath);
    THEN(status, find_magnitudes(report, &swath, swath.layout.type, swath.stored, &values));
    struct stored_swath stored = {
        values, (size_t)swath.patch.rows, (size_t)swath.patch.columns, 0.0, 0.0, swath.is_complex};
    THEN(status, calibrate_image(report, params, options, &stored, false, text));
    free(values);
    swath_close(&swath);
    return status;
}

sonject_status sonject_calibrate(sonject_context *context, const sonject_calibrate_params *params,
                                 char **text)
{
    sonject_calibrate_params taken;
    struct image_options options;
    char *made = NULL;
    CHECK(context_begin_call(context));
    struct report *report = &context->report;
    if (text)
        *text = NULL;
    CHECK(params_take(report, &taken, sizeof taken, params, sizeof taken, "calibrate parameters"));
    if (!taken.image == !taken.pixels)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "give an image file, or pixels");
    CHECK(image_options_take(report, taken.channel, taken.array, NULL, taken.geometry, &options));
    CHECK(taken.pixels ? calibrate_pixels(report, &taken, &options, &made)
                       : calibrate_image(report, &taken, &options, NULL, false, &made));
    if (text)
        *text = made;
    else
        free(made);
    return SONJECT_OK;
}
