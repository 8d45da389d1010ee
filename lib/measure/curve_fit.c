/* Finds the curve of a family that gives the tiles' numbers the distribution of speckle. All tiles
 * share the curve and the law of speckle; each has its own level. This is a composite likelihood
 * (C. Varin, N. Reid, D. Firth, "An overview of composite likelihood methods", Statistica Sinica
 * 21, 2011). Its errors come from the scatter of the tiles' derivatives, which allows for
 * correlated pixels. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "measure/calibration.h"
#include "measure/speckle_law.h"

#define DECIBEL_LOG      0.23025850929940457 /* ln(10) / 10 */
#define LOOKS_LEAST      0.4
#define LOOKS_MOST       64.0
#define PARAMETER_LEAST  1e-5
#define PARAMETER_MOST   1e5
#define MANY_LOOKS       4.0
#define LEVEL_STEPS      12
#define NO_GAIN          1e-5 /* smallest gain of a tile's likelihood by another level */
#define STRAY_SHARE      1e-5 /* share of pixels in any cell that are no speckle: contacts, edges */
#define EVALUATIONS_MOST 160
#define CLOSE            0.02 /* difference of likelihoods that no tile tells */
#define MISFIT_BINS      20
#define STEP_PARAMETER   0.01 /* finite difference for derivatives by logarithms */
#define STEP_LOOKS       0.02

struct fitting {
    const struct plain_tiles *tiles;
    double full_scale;
    enum curve_family family;
    bool moves[2]; /* true where the parameter, the looks are fitted */
    double start[2];
    double texture;
    struct speckle_law law;
    double places[CELLS_MAX]; /* log intensities of the edges */
    double *levels;           /* the tiles', kept between evaluations */
    double *by_tile;
};

double curve_log_intensity(enum curve_family family, double parameter, double full_scale,
                           double value)
{
    const double q = value / full_scale;
    if (family == CURVE_DECIBEL)
        return DECIBEL_LOG * parameter * value;
    if (!(q > 0.0))
        return -INFINITY;
    if (family == CURVE_SCHLICK)
        return 2.0 * log(fmin(q, 1.0) / (parameter - (parameter - 1.0) * fmin(q, 1.0)));
    return 2.0 * parameter * log(q);
}

double curve_value(enum curve_family family, double parameter, double full_scale,
                   double log_intensity)
{
    const double amplitude = exp(0.5 * log_intensity);
    if (family == CURVE_DECIBEL)
        return log_intensity / (DECIBEL_LOG * parameter);
    if (family == CURVE_SCHLICK)
        return full_scale * amplitude * parameter / (1.0 + (parameter - 1.0) * amplitude);
    return full_scale * exp(0.5 * log_intensity / parameter);
}

/* Returns the log likelihood of a tile at a level. *slope gets its derivative by the level, and
 * *information the tile's Fisher information on the level. */
static double tile_likelihood(const struct fitting *fit, const uint16_t *counts, double level,
                              double *slope, double *information)
{
    const size_t edges = fit->tiles->edge_count;
    double sum = 0.0, below = 0.0, density = 0.0;
    *slope = *information = 0.0;
    for (size_t cell = 0; cell <= edges; cell++) {
        double upper = 1.0, upper_density = 0.0;
        if (counts[cell] == 0 && (cell == edges || counts[cell + 1] == 0))
            continue;
        if (cell < edges)
            upper = speckle_law_below(&fit->law, fit->places[cell] - level, &upper_density);
        if (counts[cell] > 0) {
            const double share = fmax(0.0, upper - below) + STRAY_SHARE;
            const double relative = (density - upper_density) / share;
            sum += counts[cell] * log(share);
            *slope += counts[cell] * relative;
            *information += counts[cell] * relative * relative;
        }
        below = upper;
        density = upper_density;
    }
    return sum;
}

static double fit_level(const struct fitting *fit, const uint16_t *counts, double *level)
{
    double slope, information;
    double best = tile_likelihood(fit, counts, *level, &slope, &information);
    for (int i = 0; i < LEVEL_STEPS; i++) {
        double step = information > 0.0 ? slope / information : 0.0;
        step = fmin(1.0, fmax(-1.0, step));
        if (slope * step < NO_GAIN) {
            *level += step;
            return best + 0.5 * slope * step;
        }
        double tried = -INFINITY, tried_slope = 0.0, tried_information = 0.0;
        for (int half = 0; half < 4 && tried < best; half++, step *= 0.5)
            tried = tile_likelihood(fit, counts, *level + step, &tried_slope, &tried_information);
        step *= 2.0;
        if (tried < best)
            break;
        *level += step;
        best = tried;
        /* The curvature that the step showed tells more of the peak than the information does. */
        const double curvature = (slope - tried_slope) / step;
        information = curvature > 0.0 ? curvature : tried_information;
        slope = tried_slope;
    }
    return best;
}

static double parameter_of(const struct fitting *fit, const double logs[2])
{
    const double least = fit->family == CURVE_SCHLICK ? 1.0 : PARAMETER_LEAST;
    return fmin(PARAMETER_MOST, fmax(least, exp(logs[0])));
}

static double looks_of(const double logs[2])
{
    return fmin(LOOKS_MOST, fmax(LOOKS_LEAST, exp(logs[1])));
}

/* Returns the log likelihood of all tiles, and fills that of each. Outside the bounds it falls. */
static double evaluate(struct fitting *fit, const double logs[2])
{
    const struct plain_tiles *tiles = fit->tiles;
    const double parameter = parameter_of(fit, logs), looks = looks_of(logs);
    double sum = 0.0;
    speckle_law_init(&fit->law, looks, fit->texture);
    for (size_t i = 0; i < tiles->edge_count; i++)
        fit->places[i] =
            curve_log_intensity(fit->family, parameter, fit->full_scale, tiles->edges[i]);
    for (size_t i = 0; i < tiles->count; i++)
        sum += fit->by_tile[i] =
            fit_level(fit, tiles->counts + i * (tiles->edge_count + 1), &fit->levels[i]);
    return sum - 1e3 * (fabs(logs[0] - log(parameter)) + fabs(logs[1] - log(looks)));
}

/* Returns the log intensity below which a share of a tile's numbers lies. */
static double tile_quantile(const struct fitting *fit, size_t tile, double share)
{
    const struct plain_tiles *tiles = fit->tiles;
    const uint16_t *counts = tiles->counts + tile * (tiles->edge_count + 1);
    const double wanted = share * (double)(tiles->side * tiles->side);
    double passed = counts[0], before = 0.0;
    size_t edge = 0;
    while (edge + 1 < tiles->edge_count && passed < wanted) {
        before = passed;
        passed += counts[++edge];
    }
    if (edge == 0 || !isfinite(fit->places[edge - 1]) || !(passed > before))
        return fit->places[edge];
    const double t = fmin(1.0, (wanted - before) / (passed - before));
    return fit->places[edge - 1] + t * (fit->places[edge] - fit->places[edge - 1]);
}

/* Starts the levels at the tiles' medians. Returns the median interquartile distance. */
static double start_levels(struct fitting *fit, const double logs[2])
{
    const struct plain_tiles *tiles = fit->tiles;
    const double parameter = parameter_of(fit, logs);
    speckle_law_init(&fit->law, looks_of(logs), fit->texture);
    for (size_t i = 0; i < tiles->edge_count; i++)
        fit->places[i] =
            curve_log_intensity(fit->family, parameter, fit->full_scale, tiles->edges[i]);
    for (size_t i = 0; i < tiles->count; i++) {
        const double spread = tile_quantile(fit, i, 0.75) - tile_quantile(fit, i, 0.25);
        fit->by_tile[i] = isfinite(spread) ? spread : 0.0;
    }
    qsort(fit->by_tile, tiles->count, sizeof *fit->by_tile, compare_doubles);
    const double spread = fit->by_tile[tiles->count / 2];
    const double middle = speckle_law_quantile(&fit->law, 0.5);
    for (size_t i = 0; i < tiles->count; i++) {
        const double median = tile_quantile(fit, i, 0.5);
        fit->levels[i] = isfinite(median) ? median - middle : 0.0;
    }
    return spread;
}

/* Chooses where a search begins: at these looks, and at the parameter that fits their quartiles. */
static void choose_start(struct fitting *fit, double looks, double logs[2])
{
    if (fit->moves[1])
        logs[1] = log(looks);
    if (fit->moves[0]) {
        logs[0] = fit->family == CURVE_SCHLICK ? log(3.0) : 0.0;
        const double spread = start_levels(fit, logs);
        if (fit->family != CURVE_SCHLICK && spread > 0.0)
            logs[0] = log(
                (speckle_law_quantile(&fit->law, 0.75) - speckle_law_quantile(&fit->law, 0.25)) /
                spread);
    }
    start_levels(fit, logs);
}

/* A corner of the simplex that moves along one or two axes (J. A. Nelder, R. Mead, "A simplex
 * method for function minimization", Computer Journal 7, 1965). */
struct corner {
    double logs[2], likelihood;
};

static struct corner corner_at(struct fitting *fit, const struct corner *from,
                               const struct corner *to, double share)
{
    struct corner corner;
    for (int k = 0; k < 2; k++)
        corner.logs[k] =
            fit->moves[k] ? from->logs[k] + share * (to->logs[k] - from->logs[k]) : from->logs[k];
    corner.likelihood = evaluate(fit, corner.logs);
    return corner;
}

static void sort_corners(struct corner *corners, int count)
{
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && corners[k].likelihood > corners[k - 1].likelihood; k--) {
            const struct corner better = corners[k];
            corners[k] = corners[k - 1];
            corners[k - 1] = better;
        }
}

static double climb(struct fitting *fit, double logs[2])
{
    static const double strides[] = {0.15, 0.35};
    struct corner corners[3];
    int count = 1;
    memcpy(corners[0].logs, logs, sizeof corners[0].logs);
    corners[0].likelihood = evaluate(fit, logs);
    for (int k = 0; k < 2; k++)
        if (fit->moves[k]) {
            corners[count] = corners[0];
            corners[count].logs[k] += strides[k];
            corners[count].likelihood = evaluate(fit, corners[count].logs);
            count++;
        }
    const int worst = count - 1;
    for (int i = 0; count > 1 && i < EVALUATIONS_MOST; i += 2) {
        sort_corners(corners, count);
        if (corners[0].likelihood - corners[worst].likelihood < CLOSE)
            break;
        struct corner middle = corners[0];
        for (int k = 0; count == 3 && k < 2; k++)
            middle.logs[k] = 0.5 * (corners[0].logs[k] + corners[1].logs[k]);
        struct corner tried = corner_at(fit, &middle, &corners[worst], -1.0);
        if (tried.likelihood > corners[0].likelihood) {
            const struct corner farther = corner_at(fit, &middle, &corners[worst], -2.0);
            tried = farther.likelihood > tried.likelihood ? farther : tried;
        } else if (tried.likelihood <= corners[worst - 1].likelihood) {
            tried = corner_at(fit, &middle, &corners[worst],
                              tried.likelihood > corners[worst].likelihood ? -0.5 : 0.5);
        }
        if (tried.likelihood > corners[worst].likelihood)
            corners[worst] = tried;
        else
            for (int k = 1; k < count; k++)
                corners[k] = corner_at(fit, &corners[0], &corners[k], 0.5);
    }
    sort_corners(corners, count);
    memcpy(logs, corners[0].logs, sizeof corners[0].logs);
    return corners[0].likelihood;
}

/* Finds the standard errors H^-1 J H^-1 from the second derivatives H and the scatter J of the
 * tiles' first derivatives. */
static sonject_status find_errors(struct fitting *fit, struct report *report, const double logs[2],
                                  double errors[2])
{
    static const double steps[] = {STEP_PARAMETER, STEP_LOOKS};
    const size_t count = fit->tiles->count;
    double *slopes = allocate_array(count, 2 * sizeof *slopes);
    double second[2][2] = {{1.0, 0.0}, {0.0, 1.0}}, scatter[2][2] = {{0.0}};
    CHECK_MEMORY(report, slopes, "a calibration");
    const double middle = evaluate(fit, logs);
    for (int k = 0; k < 2; k++) {
        double up[2] = {logs[0], logs[1]}, down[2] = {logs[0], logs[1]};
        if (!fit->moves[k])
            continue;
        up[k] += steps[k];
        down[k] -= steps[k];
        const double above = evaluate(fit, up);
        for (size_t i = 0; i < count; i++)
            slopes[2 * i + (size_t)k] = fit->by_tile[i];
        const double below = evaluate(fit, down);
        for (size_t i = 0; i < count; i++)
            slopes[2 * i + (size_t)k] =
                (slopes[2 * i + (size_t)k] - fit->by_tile[i]) / (2.0 * steps[k]);
        second[k][k] = -(above - 2.0 * middle + below) / (steps[k] * steps[k]);
    }
    if (fit->moves[0] && fit->moves[1]) {
        double sum = 0.0;
        for (int corner = 0; corner < 4; corner++) {
            const double sign = corner == 0 || corner == 3 ? 1.0 : -1.0;
            const double at[2] = {logs[0] + (corner & 1 ? steps[0] : -steps[0]),
                                  logs[1] + (corner & 2 ? steps[1] : -steps[1])};
            sum += sign * evaluate(fit, at);
        }
        second[0][1] = second[1][0] = -sum / (4.0 * steps[0] * steps[1]);
    }
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                scatter[a][b] += slopes[2 * i + (size_t)a] * slopes[2 * i + (size_t)b];
    free(slopes);
    const double determinant = second[0][0] * second[1][1] - second[0][1] * second[1][0];
    const bool is_peak = second[0][0] > 0.0 && second[1][1] > 0.0 && determinant > 0.0;
    for (int k = 0; k < 2; k++) {
        const double a = second[1 - k][1 - k] / determinant, b = -second[0][1] / determinant;
        const double variance =
            a * a * scatter[k][k] + 2.0 * a * b * scatter[0][1] + b * b * scatter[1 - k][1 - k];
        errors[k] = !fit->moves[k] ? 0.0 : is_peak && variance > 0.0 ? sqrt(variance) : INFINITY;
    }
    return SONJECT_OK;
}

/* Returns the largest difference between the shares of the tiles' numbers that should lie below the
 * law's twentieths and those that do (Kolmogorov and Smirnov's statistic, coarsely). *error gets
 * its standard error, from the scatter of the tiles there. */
static double find_misfit(const struct fitting *fit, double *error)
{
    const struct plain_tiles *tiles = fit->tiles;
    double sums[MISFIT_BINS] = {0.0}, squares[MISFIT_BINS] = {0.0}, largest = 0.0;
    const double pixels = (double)(tiles->side * tiles->side), count = (double)tiles->count;
    for (size_t i = 0; i < tiles->count; i++) {
        const uint16_t *counts = tiles->counts + i * (tiles->edge_count + 1);
        double below = 0.0, density, shares[MISFIT_BINS] = {0.0}, off = 0.0;
        for (size_t cell = 0; cell <= tiles->edge_count; cell++) {
            const double upper =
                cell < tiles->edge_count
                    ? speckle_law_below(&fit->law, fit->places[cell] - fit->levels[i], &density)
                    : 1.0;
            /* Pixels of a cell count as even within its part of the law. */
            for (int bin = 0; counts[cell] > 0 && bin < MISFIT_BINS; bin++) {
                const double low = fmax(below, (double)bin / MISFIT_BINS);
                const double high = fmin(upper, (bin + 1.0) / MISFIT_BINS);
                if (high > low)
                    shares[bin] += counts[cell] / pixels * (high - low) / (upper - below);
            }
            below = upper;
        }
        for (int bin = 0; bin < MISFIT_BINS; bin++) {
            off += shares[bin] - 1.0 / MISFIT_BINS;
            sums[bin] += off / count;
            squares[bin] += off * off / count;
        }
    }
    *error = 0.0;
    for (int bin = 0; bin < MISFIT_BINS; bin++)
        if (fabs(sums[bin]) > largest) {
            largest = fabs(sums[bin]);
            *error = sqrt(fmax(0.0, squares[bin] - largest * largest) / count);
        }
    return largest;
}

void curve_fit_clear(struct curve_fit *fit)
{
    free(fit->by_tile);
    free(fit->levels);
    memset(fit, 0, sizeof *fit);
}

sonject_status curve_fit_find(struct report *report, const struct plain_tiles *tiles,
                              double full_scale, enum curve_family family, double parameter,
                              double looks, double texture, struct curve_fit *fit)
{
    struct fitting *fitting = allocate_array(1, sizeof *fitting);
    if (!fit->by_tile)
        fit->by_tile = allocate_array(tiles->count, sizeof *fit->by_tile);
    if (!fit->levels)
        fit->levels = allocate_array(tiles->count, sizeof *fit->levels);
    if (!fitting || !fit->by_tile || !fit->levels) {
        free(fitting);
        return report_out_of_memory(report, "a calibration");
    }
    fitting->tiles = tiles;
    fitting->full_scale = full_scale;
    fitting->family = family;
    fitting->texture = texture;
    fitting->levels = fit->levels;
    fitting->by_tile = fit->by_tile;
    fitting->moves[0] = isnan(parameter);
    fitting->moves[1] = isnan(looks);
    double logs[2] = {fitting->moves[0] ? 0.0 : log(parameter),
                      fitting->moves[1] ? 0.0 : log(looks)};
    double errors[2] = {0.0};
    choose_start(fitting, 1.0, logs);
    const double likelihood = climb(fitting, logs);
    if (fitting->moves[0] && fitting->moves[1]) { /* curve and looks make a long ridge */
        double others[2];
        choose_start(fitting, MANY_LOOKS, others);
        if (climb(fitting, others) > likelihood)
            memcpy(logs, others, sizeof logs);
    }
    const sonject_status status = find_errors(fitting, report, logs, errors);
    fit->parameter = parameter_of(fitting, logs);
    fit->looks = looks_of(logs);
    fit->parameter_error = errors[0];
    fit->looks_error = errors[1];
    fit->texture = texture;
    fit->likelihood = evaluate(fitting, logs);
    fit->misfit = find_misfit(fitting, &fit->misfit_error);
    free(fitting);
    return status;
}
