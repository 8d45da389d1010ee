/* What images and contacts measure. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/calibrate.h>

#include "api/handles.h"
#include "base/memory.h"
#include "measure/calibration.h"
#include "measure/measures.h"

#define FIND_MOST     100
#define FIND_CONTRAST 12.0 /* dB */

/* Amplitudes of a caller's pixels. */
static sonject_status take_amplitudes(struct report *report, const sonject_pixels *pixels,
                                      struct measured *measured)
{
    struct injection_input input;
    float *packed = NULL;
    CHECK(take_pixels(report, pixels, &input, &packed));
    measured->rows = input.rows;
    measured->columns = input.columns;
    measured->amplitudes = packed;
    for (size_t i = 0; i < input.rows * input.columns; i++) {
        const float a = input.is_complex ? packed[2 * i] : packed[i];
        packed[i] = input.is_complex ? hypotf(a, packed[2 * i + 1]) : fabsf(a);
        if (!isfinite(packed[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "the pixel at row %zu, column %zu is not a finite number",
                                  i / input.columns, i % input.columns);
    }
    return SONJECT_OK;
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
    THEN(status, copy_mask(report, params->influence_mask, count, &measured.influence));
    THEN(status, copy_mask(report, params->labels_mask, count, &measured.labels));
    THEN(status, measure_amplitudes(report, &measured, made));
    measured_clear(&measured);
    return status;
}

/* The image and what is said of it. */
static sonject_status take_image(struct report *report, const sonject_measure_params *params,
                                 sonject_measure_params *taken, struct image_options *options)
{
    CHECK(params_take(report, taken, sizeof *taken, params, sizeof *taken, "measure parameters"));
    if (!taken->image == !taken->pixels)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "give an image file, or pixels");
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

/* Fills in what 0 stands for. */
static sonject_status check_contacts(struct report *report, sonject_measure_params *params)
{
    if (params->find_most == 0)
        params->find_most = FIND_MOST;
    if (params->find_contrast_db == 0.0)
        params->find_contrast_db = FIND_CONTRAST;
    if (params->box_count > 0 && !params->boxes)
        return null_argument(report, "boxes");
    if (params->box_count > BOXES_MAX || params->find_most > BOXES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT, "at most %d contacts are measured",
                              BOXES_MAX);
    if (!(params->find_contrast_db >= 6.0 && params->find_contrast_db <= 100.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "contacts are looked for by contrasts of 6...100 dB, not %g dB",
                              params->find_contrast_db);
    return check_spacings(report, params->row_spacing_m, params->column_spacing_m);
}

sonject_status sonject_measure_contacts(sonject_context *context,
                                        const sonject_measure_params *params, char **text)
{
    sonject_measure_params taken;
    struct image_options options;
    struct measured measured;
    if (!context || !text)
        return SONJECT_ERROR_ARGUMENT;
    *text = NULL;
    context_begin_call(context);
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

/* Magnitudes of complex pixels; others as they are. */
static sonject_status calibrate_pixels(struct report *report,
                                       const sonject_calibrate_params *params,
                                       const struct image_options *options, char **text)
{
    struct injection_input input;
    struct stored_swath swath = {NULL, 0, 0, 0.0, 0.0, false};
    float *packed = NULL;
    sonject_status status = take_pixels(report, params->pixels, &input, &packed);
    const size_t count = status == SONJECT_OK ? input.rows * input.columns : 0;
    for (size_t i = 0; status == SONJECT_OK && i < count; i++) {
        packed[i] = input.is_complex ? hypotf(packed[2 * i], packed[2 * i + 1]) : packed[i];
        if (!isfinite(packed[i]))
            status = report_failure(report, SONJECT_ERROR_INPUT,
                                    "the pixel at row %zu, column %zu is not a finite number",
                                    i / input.columns, i % input.columns);
    }
    if (status == SONJECT_OK) {
        swath.values = packed;
        swath.rows = input.rows;
        swath.columns = input.columns;
        swath.is_complex = input.is_complex;
    }
    THEN(status, calibrate_image(report, params, options, &swath, text));
    free(packed);
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
                       : calibrate_image(report, &taken, &options, NULL, &made));
    if (text)
        *text = made;
    else
        free(made);
    return SONJECT_OK;
}
