/* The calibration of an image file or of numbers in memory, and the files that it writes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "image/statistics.h"
#include "measure/calibration.h"
#include "swath/geometry_notes.h"
#include "swath/swath_file.h"

#define FULL_8_BIT  255.0
#define FULL_16_BIT 65535.0

/* Finds the unit that all values are multiples of, and the full scale of the pixel type. Floats
 * that are all whole numbers get those of integers. */
static void find_type(struct stored_swath *swath, enum pixel_type type, const void *stored)
{
    const size_t count = swath->rows * swath->columns;
    float largest = 0.0f;
    bool are_whole = true;
    for (size_t i = 0; i < count && are_whole; i++) {
        are_whole = swath->values[i] >= 0.0f && swath->values[i] <= (float)FULL_16_BIT &&
                    floorf(swath->values[i]) == swath->values[i];
        largest = fmaxf(largest, swath->values[i]);
    }
    swath->unit = 0.0;
    swath->type_full = pixel_full_scale(type);
    if (swath->is_complex)
        return;
    if (type != PIXEL_FLOAT32) {
        swath->unit = quantisation_step(type, stored, count);
    } else if (are_whole && largest > 1.0f) {
        swath->unit = 1.0;
        swath->type_full = (double)largest > FULL_8_BIT ? FULL_16_BIT : FULL_8_BIT;
    }
}

/* Reads a file's numbers, or the magnitudes of complex pixels. *values is for free(). */
static sonject_status read_swath(struct report *report, const char *path, struct swath_file *file,
                                 struct stored_swath *swath, float **values)
{
    struct raster_layout layout;
    void *stored;
    CHECK(swath_file_read_all(report, file, &layout, &stored));
    swath->rows = (size_t)layout.rows;
    swath->columns = (size_t)layout.columns;
    swath->is_complex = layout.channels == 2;
    *values = allocate_array(swath->rows, swath->columns * sizeof **values);
    sonject_status status = *values ? SONJECT_OK : report_out_of_memory(report, path);
    const size_t count = swath->rows * swath->columns;
    for (size_t i = 0; status == SONJECT_OK && i < count; i++) {
        const size_t at = i * layout.channels;
        const double first = pixel_number(layout.type, stored, at);
        const double value =
            swath->is_complex ? hypot(first, pixel_number(layout.type, stored, at + 1)) : first;
        (*values)[i] = (float)value;
        if (!isfinite((*values)[i]))
            status = report_failure(report, SONJECT_ERROR_INPUT,
                                    "%s: the pixel at row %zu, column %zu is not a finite number",
                                    path, i / swath->columns, i % swath->columns);
    }
    swath->values = *values;
    if (status == SONJECT_OK)
        find_type(swath, layout.type, stored);
    if (status == SONJECT_OK && swath_file_largest(file) > 0)
        swath->type_full = swath_file_full_scale(file);
    free(stored);
    return status;
}

/* Returns the caller's geometry or, where there is none, what the file notes. */
static sonject_geometry_params known_geometry(const struct noted_geometry *noted,
                                              const struct image_options *options)
{
    const bool is_ground = noted->axis == RANGE_GROUND;
    return options->has_geometry
               ? options->geometry
               : (sonject_geometry_params){
                     .row_spacing_m = noted->row_spacing_m,
                     .column_spacing_m = is_ground ? NAN : noted->column_spacing_m,
                     .first_slant_range_m = is_ground ? NAN : noted->first_range_m};
}

/* Compares the altitude that the pings record with where their seabed begins. */
static sonject_status compare_altitudes(struct report *report, const struct recording *recording,
                                        struct calibration *found)
{
    const struct first_returns *returns = &found->returns;
    size_t count = 0;
    if (!recording || !returns->columns || returns->sides == WATER_BETWEEN)
        return SONJECT_OK;
    double *shares = allocate_array(found->rows, 2 * sizeof *shares);
    CHECK_MEMORY(report, shares, "a calibration");
    double *altitudes = shares + found->rows;
    for (size_t row = 0; row < found->rows; row++) {
        const double recorded = (double)recording->pings[row].altitude_m;
        const double first =
            found->first_slant_range_m + returns->columns[row] * found->column_spacing_m;
        if (recorded > 0.0 && first > 0.0) {
            altitudes[count] = recorded;
            shares[count++] = recorded / first;
        }
    }
    if (count > 0) {
        found->recorded_share = median_of(shares, count);
        found->recorded_altitude_m =
            median_of(altitudes, count); /* the median, as for first returns */
    }
    free(shares);
    return SONJECT_OK;
}

/* Reports a recorded altitude unlike this image's first returns. Runs and checks tell their users
 * what to write instead. */
static void tell_altitude(struct report *report, const char *image, const struct calibration *found)
{
    const double share = found->recorded_share;
    if (share > 0.0 && fabs(share - 1.0) > ALTITUDES_ALIKE)
        report_note(report,
                    "%s: the recorded altitude, %.2f m in the median, is %.0f %% %s the first "
                    "return, and would make shadows too %s",
                    path_name(image), found->recorded_altitude_m, 100.0 * fabs(share - 1.0),
                    share < 1.0 ? "below" : "above", share < 1.0 ? "long" : "short");
}

static sonject_status write_results(struct report *report, const sonject_calibrate_params *params,
                                    const struct stored_swath *swath,
                                    const struct calibration *found, char **text)
{
    char hash[HASH_TEXT_CAPACITY];
    *text = NULL;
    if (params->image)
        CHECK(file_hash(report, params->image, hash));
    /* Only the name counts: a swath gives the same document in any folder. */
    json_t *document = calibration_document(found, params->image ? path_name(params->image) : NULL,
                                            params->image ? hash : NULL, params->channel);
    sonject_status status = SONJECT_OK;
    if (!params->as_json)
        status = document_as_yaml(report, document, text);
    else if (!(*text = json_document_text(document, JSON_INDENT(1) | JSON_REAL_PRECISION(10))))
        status = report_out_of_memory(report, "a calibration");
    if (params->picture)
        THEN(status, calibration_page_write(report, found, swath, params->image, params->picture));
    if (params->output)
        THEN(status, file_write_whole(report, params->output, *text, strlen(*text)));
    json_decref(document);
    if (status != SONJECT_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}

static void tell_curve(struct report *report, const char *image, const struct stored_swath *swath,
                       const struct calibration *found)
{
    const char *name = image ? path_name(image) : "the pixels";
    const struct curve_fit *fit = &found->fits[found->family];
    const bool is_seen =
        !found->transfer_kind.unseen &&
        (found->transfer.kind < SONJECT_TRANSFER_DECIBEL || !found->parameter.unseen);
    if (!is_seen && swath->unit > 0.0)
        report_note(report,
                    "%s: its tiles do not show the grey-level curve, so stored numbers are taken "
                    "as amplitudes: if they are not, give the curve as input.transfer",
                    name);
    else if (is_seen && !curve_fits(fit))
        report_note(report,
                    "%s: the measured grey-level curve does not explain the seabed's speckle "
                    "(%.2g %% of its pixels are off): targets may have another grain or contrast "
                    "than the seabed. Compare them in quicklook.png of sonject run; if they "
                    "differ, give the sonar maker's curve as input.transfer, or other "
                    "injection.match.looks",
                    name, 100.0 * fit->misfit);
}

sonject_status calibrate_image(struct report *report, const sonject_calibrate_params *params,
                               const struct image_options *options, struct stored_swath *pixels,
                               bool for_scene, char **text)
{
    struct stored_swath swath = {NULL, 0, 0, 0.0, 0.0, false};
    struct calibration found;
    struct swath_file *file = NULL;
    struct noted_geometry noted = {
        .row_spacing_m = NAN, .column_spacing_m = NAN, .first_range_m = NAN};
    float *values = NULL;
    sonject_status status = SONJECT_OK;
    *text = NULL;
    if (pixels) {
        swath = *pixels;
        find_type(&swath, PIXEL_FLOAT32, NULL);
    } else {
        file_protect(report, params->image);
        status =
            swath_file_open_array(report, params->image, options->channel, options->array, &file);
        THEN(status, read_swath(report, params->image, file, &swath, &values));
    }
    if (status == SONJECT_OK && file)
        geometry_notes_read(file, &noted);
    const sonject_geometry_params geometry = known_geometry(&noted, options);
    THEN(status, calibrate_swath(report, &swath, &geometry, &found));
    if (status == SONJECT_OK) {
        tell_curve(report, params->image, &swath, &found);
        found.side = noted.knows_side ? noted.side : SIDE_UNKNOWN;
        found.recorded_altitude_m = noted.altitude_m;
        if (file)
            status = compare_altitudes(report, swath_file_recording(file), &found);
        THEN(status, write_results(report, params, &swath, &found, text));
        if (status == SONJECT_OK && params->image && !for_scene)
            tell_altitude(report, params->image, &found);
        calibration_clear(&found);
    }
    if (file)
        swath_file_close(&file);
    free(values);
    return status;
}
