#include "measure/measures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/raster.h"
#include "image/statistics.h"
#include "swath/geometry_notes.h"
#include "swath/swath_file.h"

void measured_clear(struct measured *measured)
{
    free(measured->amplitudes);
    free(measured->labels);
}

static void fill_seabed(const struct speckle_statistics *seabed, sonject_measurement *measurement)
{
    const bool is_known = seabed->blocks > 0;
    measurement->amplitude_contrast = is_known ? seabed->amplitude_contrast : NAN;
    measurement->intensity_contrast = is_known ? seabed->intensity_contrast : NAN;
    measurement->looks = is_known ? seabed->looks : NAN;
    measurement->shape = is_known ? seabed->shape : NAN;
    measurement->row_correlation = is_known ? seabed->along_track.correlation[1] : NAN;
    measurement->column_correlation = is_known ? seabed->range.correlation[1] : NAN;
    measurement->row_length_pixels = is_known ? seabed->along_track.length_pixels : NAN;
    measurement->column_length_pixels = is_known ? seabed->range.length_pixels : NAN;
}

sonject_status measured_square(struct report *report, struct measured *measured)
{
    for (size_t i = 0; i < measured->rows * measured->columns; i++) {
        measured->amplitudes[i] *= measured->amplitudes[i];
        if (!isfinite(measured->amplitudes[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "the pixel at row %zu, column %zu is too large to be squared: "
                                  "scale the image down",
                                  i / measured->columns, i % measured->columns);
    }
    return SONJECT_OK;
}

sonject_status measure_amplitudes(struct report *report, struct measured *measured,
                                  sonject_measurement *measurement)
{
    struct speckle_statistics seabed;
    memset(measurement, 0, sizeof *measurement);
    measurement->struct_size = sizeof *measurement;
    sonject_status status = measured_square(report, measured);
    THEN(status, measure_speckle(report, measured->amplitudes, measured->labels, measured->rows,
                                 measured->columns, measured->columns, &seabed));
    if (status != SONJECT_OK)
        return status;
    fill_seabed(&seabed, measurement);
    return SONJECT_OK;
}

/* Takes the spacings that a file notes, unless its range is on the ground. */
static void take_spacings(const struct swath_file *file, struct measured *measured)
{
    struct noted_geometry noted;
    sonject_geometry_params told;
    geometry_notes_read(file, &noted);
    if (noted.axis == RANGE_GROUND || !geometry_notes_to_params(&noted, &told))
        return;
    measured->row_spacing_m = told.row_spacing_m;
    measured->column_spacing_m = told.column_spacing_m;
}

/* Reads all of an image. *stored is for free(). measured gets the spacings, and transfer its full
 * scale; both NULL for a mask. */
static sonject_status read_stored(struct report *report, const char *path, int32_t channel,
                                  const char *array, struct raster_layout *layout, void **stored,
                                  struct measured *measured, sonject_transfer_params *transfer)
{
    struct swath_file *file = NULL;
    *stored = NULL;
    CHECK(swath_file_open_array(report, path, channel, array, &file));
    if (measured) {
        take_spacings(file, measured);
        swath_file_limit(file, transfer);
    }
    const sonject_status status = swath_file_read_all(report, file, layout, stored);
    swath_file_close(&file);
    return status;
}

static sonject_status check_size(struct report *report, const char *path, uint64_t rows,
                                 uint64_t columns, const struct measured *measured)
{
    if (rows == measured->rows && columns == measured->columns)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s has %llu x %llu pixels, the image %zu x %zu: give masks of its size",
                          path, (unsigned long long)rows, (unsigned long long)columns,
                          measured->rows, measured->columns);
}

/* path NULL: no mask. */
static sonject_status read_mask(struct report *report, const char *path,
                                const struct measured *measured, uint8_t **mask)
{
    struct raster_layout layout;
    void *stored = NULL;
    if (!path)
        return SONJECT_OK;
    sonject_status status =
        read_stored(report, path, SONJECT_CHANNEL_ONLY, NULL, &layout, &stored, NULL, NULL);
    THEN(status, check_size(report, path, layout.rows, layout.columns, measured));
    if (status == SONJECT_OK) {
        const size_t bytes = layout.channels * pixel_bytes(layout.type);
        const size_t count = measured->rows * measured->columns;
        *mask = allocate_array(count, 1);
        if (!*mask)
            status = report_out_of_memory(report, path);
        for (size_t i = 0; *mask && i < count * bytes; i++)
            if (((const uint8_t *)stored)[i])
                (*mask)[i / bytes] = 255;
    }
    free(stored);
    return status;
}

sonject_status negative_amplitude(struct report *report, const char *what, size_t at,
                                  size_t columns)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: the pixel at row %zu, column %zu is a negative amplitude; numbers "
                          "in dB need their transfer function",
                          what, at / columns, at % columns);
}

sonject_status read_amplitudes(struct report *report, const sonject_measure_params *params,
                               const struct image_options *options, struct measured *measured)
{
    struct raster_layout layout;
    void *stored = NULL;
    size_t bad = 0;
    uint64_t clipped = 0;
    sonject_transfer_params transfer = options->transfer;
    sonject_status status = read_stored(report, params->image, options->channel, options->array,
                                        &layout, &stored, measured, &transfer);
    if (status != SONJECT_OK) {
        free(stored);
        return status;
    }
    measured->rows = (size_t)layout.rows;
    measured->columns = (size_t)layout.columns;
    const size_t count = measured->rows * measured->columns;
    float *linear = allocate_array(count, layout.channels * sizeof *linear);
    if (!linear)
        status = report_out_of_memory(report, params->image);
    else if (transfer_to_amplitude(&transfer, layout.type, stored, count * layout.channels, linear,
                                   &bad, &clipped) != SONJECT_OK)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: the pixel at row %zu, column %zu is not a finite number",
                                params->image, bad / layout.channels / measured->columns,
                                bad / layout.channels % measured->columns);
    free(stored);
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        if (layout.channels == 2)
            linear[i] = hypotf(linear[2 * i], linear[2 * i + 1]);
        else if (linear[i] < 0.0f)
            status = negative_amplitude(report, params->image, i, measured->columns);
    measured->amplitudes = linear;
    return status;
}

sonject_status measure_file(struct report *report, const sonject_measure_params *params,
                            const struct image_options *options, sonject_measurement *measurement)
{
    struct measured measured;
    memset(&measured, 0, sizeof measured);
    sonject_status status = read_amplitudes(report, params, options, &measured);
    THEN(status, read_mask(report, params->labels, &measured, &measured.labels));
    THEN(status, measure_amplitudes(report, &measured, measurement));
    measured_clear(&measured);
    return status;
}
