/* Finds the curve from the amplitude contrast of the plain tiles alone, for swaths whose numbers
 * follow no law of speckle. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "measure/calibration.h"
#include "measure/contacts.h"

#define RAYLEIGH_CONTRAST 0.5227 /* one look's deviation over mean, sqrt(4 / pi - 1) */
#define HALVINGS          40
#define SLOPE_STEP        0.05 /* step of the parameter's logarithm */

struct contrast_work {
    const struct plain_tiles *tiles;
    const struct stored_swath *swath;
    double full_scale;
    enum curve_family family;
    float most_uneven; /* largest unevenness of tiles that count */
    size_t count;      /* number of tiles that count */
    double *contrasts; /* contrasts of tiles that count */
};

/* Returns the median contrast over the tiles. A tile's contrast does not depend on its level. */
static double contrast_at(struct contrast_work *work, double parameter)
{
    const struct plain_tiles *tiles = work->tiles;
    const size_t side = tiles->side, pixels = side * side;
    work->count = 0;
    for (size_t tile = 0; tile < tiles->count; tile++) {
        if (tiles->unevenness[tile] > work->most_uneven)
            continue;
        const float *first =
            work->swath->values + tiles->rows[tile] * work->swath->columns + tiles->columns[tile];
        const double level =
            curve_log_intensity(work->family, parameter, work->full_scale, (double)first[0]);
        double sum = 0.0, squares = 0.0;
        for (size_t i = 0; i < pixels; i++) {
            const double value = (double)first[i / side * work->swath->columns + i % side];
            const double log_intensity =
                curve_log_intensity(work->family, parameter, work->full_scale, value);
            const double amplitude = exp(0.5 * (log_intensity - (isfinite(level) ? level : 0.0)));
            sum += amplitude;
            squares += amplitude * amplitude;
        }
        work->contrasts[work->count++] =
            sqrt(fmax(0.0, squares * (double)pixels / (sum * sum) - 1.0));
    }
    qsort(work->contrasts, work->count, sizeof *work->contrasts, compare_doubles);
    return work->contrasts[work->count / 2];
}

/* Returns the logarithm of the parameter that gives one look's contrast. *error: standard error. */
static double solve(struct contrast_work *work, double low, double high, double *error)
{
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (contrast_at(work, exp(middle)) < RAYLEIGH_CONTRAST)
            low = middle;
        else
            high = middle;
    }
    const double found = 0.5 * (low + high);
    const double slope =
        (contrast_at(work, exp(found + SLOPE_STEP)) - contrast_at(work, exp(found - SLOPE_STEP))) /
        (2.0 * SLOPE_STEP);
    contrast_at(work, exp(found));
    /* A median errs by 1.2533 deviations over sqrt(count); quartiles tell the deviation. */
    const size_t count = work->count;
    const double deviation = (work->contrasts[3 * count / 4] - work->contrasts[count / 4]) / 1.349;
    *error = slope > 0.0 ? 1.2533 * deviation / sqrt((double)count) / slope : INFINITY;
    return found;
}

sonject_status find_by_contrast(struct report *report, const struct plain_tiles *tiles,
                                const struct stored_swath *swath, double full_scale,
                                enum curve_family family, struct curve_fit *fit)
{
    const double low = log(family == CURVE_SCHLICK ? 1.0 : fit->parameter / 20.0);
    const double high = log(family == CURVE_SCHLICK ? 1e4 : fit->parameter * 20.0);
    struct contrast_work work = {tiles,
                                 swath,
                                 full_scale,
                                 family,
                                 INFINITY,
                                 0,
                                 allocate_array(tiles->count, sizeof *work.contrasts)};
    float *sorted = allocate_array(tiles->count, sizeof *sorted);
    const bool is_complete = work.contrasts && sorted;
    if (is_complete) {
        double plainer_error;
        const double found = solve(&work, low, high, &fit->parameter_error);
        memcpy(sorted, tiles->unevenness, tiles->count * sizeof *sorted);
        qsort(sorted, tiles->count, sizeof *sorted, compare_floats);
        work.most_uneven = sorted[tiles->count / 2];
        /* The plainer half of the tiles shows what the seabed's own unevenness changes. */
        const double plainer = solve(&work, low, high, &plainer_error);
        fit->parameter = exp(found);
        fit->parameter_error = hypot(fit->parameter_error, plainer - found);
    }
    free(work.contrasts);
    free(sorted);
    CHECK_MEMORY(report, is_complete, "a calibration");
    return SONJECT_OK;
}
