#include "inject/match.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/point_response.h"

#define PI            3.14159265358979323846
#define REACH         160  /* pixels around the objects: ten blocks across */
#define ASPECTS       256  /* of the numerical integral */
#define CLEARLY       4.0  /* standard errors */
#define DIFFERENCE    0.05 /* of correlations, below which they count as equal */
#define LOOKS_CLEARLY 1.15
#define LOOKS_MOST    64.0
#define WIDEST        8.0  /* pixels */
#define FAINTEST      0.02 /* correlation; a response much narrower than a pixel shows none */
#define HALVINGS      60

/* By Wiener and Khinchin: the aspects' energy, transformed. */
double along_track_speckle_correlation(const struct point_response *response, double distance_m)
{
    double sum = 0.0;
    double total = 0.0;
    for (int i = 0; i < ASPECTS; i++) {
        const double aspect = (i + 0.5) / ASPECTS - 0.5;
        double amplitude = 1.0;
        for (int m = 1; m <= response->terms; m++)
            amplitude += 2.0 * response->weights[m - 1] * cos(2.0 * PI * m * aspect);
        sum += amplitude * amplitude * cos(2.0 * PI * aspect * distance_m / response->resolution_m);
        total += amplitude * amplitude;
    }
    return (sum / total) * (sum / total);
}

static double range_speckle_correlation(const struct point_response *response, double distance_m)
{
    const double x = distance_m / response->range_deviation_m;
    return exp(-0.5 * x * x);
}

static bool clearly_differs(double measured, double error, double nominal)
{
    return fabs(measured - nominal) > fmax(DIFFERENCE, CLEARLY * error);
}

/* The resolution that gives neighbouring rows the correlation: at least their spacing, which gives
 * nearly none. */
static void match_along_track(struct point_response *response, const struct speckle_axis *axis,
                              double spacing_m)
{
    struct point_response trial = *response;
    if (!clearly_differs(axis->correlation[1], axis->lag_one_error,
                         along_track_speckle_correlation(response, spacing_m)))
        return;
    double low = spacing_m;
    double high = WIDEST * spacing_m;
    for (int i = 0; i < HALVINGS; i++) {
        trial.resolution_m = 0.5 * (low + high);
        if (along_track_speckle_correlation(&trial, spacing_m) < axis->correlation[1])
            low = trial.resolution_m;
        else
            high = trial.resolution_m;
    }
    point_response_set_widths(response, trial.resolution_m, response->range_resolution_m);
}

static void match_range(struct point_response *response, const struct speckle_axis *axis,
                        double spacing_m)
{
    if (!clearly_differs(axis->correlation[1], axis->lag_one_error,
                         range_speckle_correlation(response, spacing_m)))
        return;
    const double widest = exp(-0.5 / (WIDEST * WIDEST));
    const double correlation = fmin(widest, fmax(FAINTEST, axis->correlation[1]));
    point_response_set_widths(response, response->resolution_m,
                              2.0 * sqrt(log(2.0)) * spacing_m / sqrt(-2.0 * log(correlation)));
}

/* Widths are matched where the scene has no other pulse or response than the image's own kind. */
static bool has_widths(const struct point_response *response)
{
    return response->pulse_kind == SONJECT_PULSE_GAUSSIAN && cross_range_is_plain(response);
}

struct span_of_pixels {
    size_t first, count;
};

/* Pixels from low - REACH to high + REACH that exist. */
static struct span_of_pixels around(double low, double high, size_t count)
{
    const double last = (double)count;
    const double first = fmin(last, fmax(0.0, floor(low) - REACH));
    const double end = fmin(last, fmax(first, ceil(high) + REACH + 1.0));
    const struct span_of_pixels span = {(size_t)first, (size_t)(end - first)};
    return span;
}

static void find_region(const struct tracer *tracer, struct span_of_pixels *rows,
                        struct span_of_pixels *columns)
{
    const struct patch_view *view = &tracer->view;
    double box[4] = {(double)view->rows, 0.0, (double)view->columns, 0.0};
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *part = &tracer->placements[i];
        const double row = view_row_of_x(view, part->centre[0]);
        const double range = water_way_range(&view->water, part->centre[1], part->centre[2]);
        const double column = view_column_of_range(view, range * view->range_ratio);
        box[0] = fmin(box[0], row);
        box[1] = fmax(box[1], row);
        box[2] = fmin(box[2], column);
        box[3] = fmax(box[3], column);
    }
    if (tracer->part_count == 0) {
        box[0] = box[2] = 0.0;
        box[1] = (double)view->rows;
        box[3] = (double)view->columns;
    }
    *rows = around(box[0], box[1], view->rows);
    *columns = around(box[2], box[3], view->columns);
}

static sonject_status measure_around(const struct tracer *tracer, const float *pixels,
                                     bool is_complex, struct speckle_statistics *seabed)
{
    struct span_of_pixels rows, columns;
    find_region(tracer, &rows, &columns);
    float *intensity = allocate_array(rows.count, columns.count * sizeof *intensity);
    CHECK_MEMORY(tracer->report, intensity, "the seabed's statistics");
    for (size_t row = 0; row < rows.count; row++)
        for (size_t column = 0; column < columns.count; column++) {
            const size_t i = (rows.first + row) * tracer->view.columns + columns.first + column;
            const float a = is_complex ? pixels[2 * i] : pixels[i];
            const float b = is_complex ? pixels[2 * i + 1] : 0.0f;
            intensity[row * columns.count + column] = a * a + b * b;
        }
    const sonject_status status = measure_speckle(tracer->report, intensity, NULL, rows.count,
                                                  columns.count, columns.count, seabed);
    free(intensity);
    return status;
}

sonject_status match_image(struct tracer *tracer, const float *pixels,
                           const struct injection_input *input, struct image_match *match)
{
    const sonject_injection_params *asked = &tracer->scene->injection;
    const struct speckle_statistics *seabed = &match->seabed;
    memset(match, 0, sizeof *match);
    match->looks = 1.0;
    match->saturation = INFINITY;
    const sonject_status status = measure_around(tracer, pixels, input->is_complex, &match->seabed);
    if (status != SONJECT_OK || input->is_complex || input->is_made ||
        asked->mode != SONJECT_MODE_COMPOSITE)
        return status;
    if (asked->match_looks >= 1.0)
        match->looks = asked->match_looks;
    else if (seabed->blocks > 0 && seabed->looks > LOOKS_CLEARLY &&
             seabed->looks - 1.0 > CLEARLY * seabed->looks_error)
        match->looks = fmin(LOOKS_MOST, seabed->looks);
    if (asked->match_response == SONJECT_MATCH_IMAGE && seabed->blocks > 0 &&
        has_widths(&tracer->response)) {
        match_along_track(&tracer->response, &seabed->along_track, tracer->view.row_spacing_m);
        match_range(&tracer->response, &seabed->range, tracer->view.column_spacing_m);
    }
    if (asked->match_saturation == SONJECT_MATCH_IMAGE)
        match->saturation = find_saturation(pixels, tracer->view.rows * tracer->view.columns);
    return SONJECT_OK;
}

void tell_match(const struct image_match *match, const struct point_response *response,
                sonject_statistics *statistics)
{
    const struct speckle_statistics *seabed = &match->seabed;
    const bool is_known = seabed->blocks > 0;
    statistics->seabed_amplitude_contrast = is_known ? seabed->amplitude_contrast : NAN;
    statistics->seabed_shape = is_known ? seabed->shape : NAN;
    statistics->seabed_looks = is_known ? seabed->looks : NAN;
    statistics->seabed_row_correlation = is_known ? seabed->along_track.correlation[1] : NAN;
    statistics->seabed_column_correlation = is_known ? seabed->range.correlation[1] : NAN;
    statistics->along_track_resolution_m = response->resolution_m;
    statistics->range_resolution_m = response->range_resolution_m;
    statistics->looks = match->looks;
    statistics->saturation_amplitude = match->saturation;
}
