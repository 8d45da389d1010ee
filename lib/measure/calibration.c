#include "measure/calibration.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"
#include "measure/calibration_parts.h"
#include "measure/speckle_law.h"

#define EDGES_LEAST 4

/* Looks. */
#define LOOKS_NO_SPECKLE  32.0 /* a fit of more looks means that there is no speckle */
#define LOOKS_MISFIT      0.02 /* fitted looks of a larger misfit mean little */
#define LOOKS_ERROR_MOST  0.35 /* largest standard error of seen looks, of their logarithm */
#define LOOKS_ONE         0.1  /* less than this from one look counts as one look, logarithm */
#define LOOKS_BIAS        0.01 /* relative error, since levels vary within plain tiles */
#define PARAMETER_ONE     0.03 /* closer to a simple exponent than this is simple, logarithm */
#define PARAMETER_UNKNOWN 0.5
#define EXPONENT_MOST     4.0

/* Texture. */
#define TEXTURE_LAGS 4
#define TEXTURE_MOST 0.6 /* largest share of the variance of log intensity */

static const char too_small[] =
    "fewer than 12 tiles of 16 x 16 pixels are usable: the others are blank, constant or clipped";

double pixel_log_intensity(const struct calibration *calibration, const struct stored_swath *swath,
                           double value)
{
    const enum curve_family family = calibration->family;
    const struct curve_fit *fit = &calibration->fits[family];
    const double least = family == CURVE_DECIBEL ? value : fmax(value, 0.5 * swath->unit);
    return curve_log_intensity(family, fit->parameter, curve_full_scale(calibration, swath), least);
}

double curve_full_scale(const struct calibration *calibration, const struct stored_swath *swath)
{
    return calibration->full_scale.unseen ? swath->type_full : calibration->full_scale.value;
}

/* ---- The ceiling. */

static void find_ceiling(const struct stored_swath *swath, struct calibration *found)
{
    const size_t count = swath->rows * swath->columns;
    const double ceiling = swath->is_complex ? INFINITY : find_saturation(swath->values, count);
    size_t clipped = 0;
    double squares = 0.0;
    found->full_scale.how = "largest stored number, which far more pixels have than the next one";
    found->clipped.how = "share of pixels with this number; errors from strips of rows";
    found->full_scale.value = ceiling;
    found->largest_number = swath->type_full;
    if (!isfinite(ceiling)) {
        found->full_scale.unseen = found->clipped.unseen =
            swath->is_complex ? "complex pixels have no ceiling"
                              : "the largest number has fewer than 16 pixels, or no more than 8 "
                                "times those of the next: nothing clips";
        return;
    }
    const size_t strips = swath->rows < 32 ? swath->rows : 32;
    for (size_t strip = 0; strip < strips; strip++) {
        const size_t first = strip * swath->rows / strips * swath->columns;
        const size_t end = (strip + 1) * swath->rows / strips * swath->columns;
        size_t here = 0;
        for (size_t i = first; i < end; i++)
            here += (double)swath->values[i] >= ceiling;
        const double share = (double)here / (double)(end - first);
        squares += share * share;
        clipped += here;
    }
    const double share = (double)clipped / (double)count;
    found->clipped.value = share;
    found->clipped.error =
        sqrt(fmax(0.0, squares / (double)strips - share * share) / (double)strips);
}

/* ---- The curve, and the speckle with it. */

/* Returns the covariance of a tile's logarithms along an axis, at lags where speckle of this grain
 * is uncorrelated. */
static double texture_covariance(const double *logs, size_t side, double mean, size_t grain,
                                 int axis)
{
    const size_t apart = axis == 0 ? side : 1, next = axis == 0 ? 1 : side;
    const size_t first = 2 + 2 * grain;
    double sum = 0.0;
    for (size_t lag = first; lag < first + TEXTURE_LAGS; lag++) {
        double of_lag = 0.0;
        for (size_t i = 0; i < side; i++)
            for (size_t k = 0; k + lag < side; k++) {
                const double *pixel = logs + i * next + k * apart;
                of_lag += (pixel[0] - mean) * (pixel[lag * apart] - mean);
            }
        sum += of_lag / (double)(side * (side - lag));
    }
    return sum / TEXTURE_LAGS;
}

/* Finds texture's share of the variance of log intensity, from the covariance of pixels some way
 * apart. The lesser of both axes counts, since bands along one axis are no texture. error: the
 * standard error of the share. */
static sonject_status texture_share(struct report *report, const struct calibration *found,
                                    const struct stored_swath *swath, enum curve_family family,
                                    double *share, double *error)
{
    const struct plain_tiles *tiles = &found->tiles;
    const size_t side = tiles->side, pixels = side * side;
    double *logs = allocate_array(pixels, sizeof *logs);
    double sums[2] = {0.0, 0.0}, squares[2] = {0.0, 0.0}, variance = 0.0;
    /* Except in the decibel family, a stored 0 has no logarithm. */
    const double least = tiles->edges[tiles->edges[0] > 0.0 || family == CURVE_DECIBEL ? 0 : 1];
    CHECK_MEMORY(report, logs, "a calibration");
    for (size_t tile = 0; tile < tiles->count; tile++) {
        double mean = 0.0, own = 0.0;
        for (size_t i = 0; i < pixels; i++) {
            const size_t at =
                (tiles->rows[tile] + i / side) * swath->columns + tiles->columns[tile] + i % side;
            const double value = fmax((double)swath->values[at], least);
            logs[i] = curve_log_intensity(family, found->fits[family].parameter,
                                          curve_full_scale(found, swath), value);
            mean += logs[i] / (double)pixels;
        }
        for (size_t i = 0; i < pixels; i++)
            own += (logs[i] - mean) * (logs[i] - mean) / (double)pixels;
        variance += own;
        for (int axis = 0; axis < 2; axis++) {
            const double covariance =
                texture_covariance(logs, side, mean, found->grain[axis], axis);
            sums[axis] += covariance;
            squares[axis] += covariance * covariance;
        }
    }
    free(logs);
    const double count = (double)tiles->count;
    const int axis = sums[0] < sums[1] ? 0 : 1;
    const double mean = sums[axis] / count;
    *error = sqrt(fmax(0.0, squares[axis] / count - mean * mean) / count) / (variance / count);
    *share = fmin(TEXTURE_MOST, mean / (variance / count));
    return SONJECT_OK;
}

/* Returns the texture that makes a share of the variance of log intensity, at the given looks. */
static double texture_of_share(double share, double looks)
{
    const double variance = share / (1.0 - share) * log_gamma_variance(looks);
    double low = 0.0, high = 4.0;
    for (int i = 0; i < 50; i++) {
        const double middle = 0.5 * (low + high);
        if (log_gamma_variance(1.0 / middle) < variance)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

static sonject_status fit_family(struct report *report, struct calibration *found,
                                 const struct stored_swath *swath, enum curve_family family,
                                 double parameter, double looks)
{
    return curve_fit_find(report, &found->tiles, curve_full_scale(found, swath), family, parameter,
                          looks, found->fits[family].texture, &found->fits[family]);
}

/* Fits looks and texture of a family, and its parameter if that is NAN. */
static sonject_status fit_freely(struct report *report, struct calibration *found,
                                 const struct stored_swath *swath, enum curve_family family,
                                 double parameter)
{
    struct curve_fit *fit = &found->fits[family];
    double share = 0.0, error = 0.0;
    CHECK(fit_family(report, found, swath, family, parameter, NAN));
    CHECK(texture_share(report, found, swath, family, &share, &error));
    fit->texture = share > CLEARLY * error ? texture_of_share(share, fmax(1.0, fit->looks)) : 0.0;
    if (fit->texture > 0.0)
        CHECK(fit_family(report, found, swath, family, parameter, NAN));
    fit->texture_error =
        texture_of_share(fmax(0.0, share) + fmax(error, 1e-6), fmax(1.0, fit->looks)) -
        texture_of_share(fmax(1e-9, share), fmax(1.0, fit->looks));
    return SONJECT_OK;
}

/* Returns whether the tiles' likelihoods differ by no more than their scatter (Q. H. Vuong,
 * "Likelihood ratio tests for model selection and non-nested hypotheses", Econometrica 57,
 * 1989). */
static bool are_alike(const struct calibration *found, enum curve_family a, enum curve_family b)
{
    const double count = (double)found->tiles.count;
    double sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < found->tiles.count; i++) {
        const double difference = found->fits[a].by_tile[i] - found->fits[b].by_tile[i];
        sum += difference;
        squares += difference * difference;
    }
    const double variance = fmax(0.0, squares - sum * sum / count);
    return fabs(sum) <= CLEARLY * sqrt(variance) + 1.0;
}

static bool is_near(double parameter, double error, double simple)
{
    return fabs(log(parameter / simple)) < CLEARLY * error + PARAMETER_ONE;
}

static void choose_family(struct calibration *found, const bool tried[CURVE_FAMILIES])
{
    const struct curve_fit *power = &found->fits[CURVE_POWER];
    int best = -1;
    for (int family = 0; family < CURVE_FAMILIES; family++)
        if (tried[family] &&
            (best < 0 || found->fits[family].likelihood > found->fits[best].likelihood))
            best = family;
    for (int family = 0; family < CURVE_FAMILIES; family++)
        found->alike[family] =
            tried[family] && are_alike(found, (enum curve_family)family, (enum curve_family)best);
    const bool is_simple = is_near(power->parameter, power->parameter_error, 1.0) ||
                           is_near(power->parameter, power->parameter_error, 0.5);
    found->family = (enum curve_family)best;
    if (found->alike[CURVE_POWER] && is_simple)
        found->family = CURVE_POWER;
    else if (found->alike[CURVE_DECIBEL] && power->parameter > EXPONENT_MOST)
        found->family = CURVE_DECIBEL; /* no recorder has such an exponent */
    found->alike[found->family] = false;
    /* Both curves are nearly straight, so they are the same curve. */
    if (found->family == CURVE_POWER && is_near(power->parameter, power->parameter_error, 1.0) &&
        is_near(found->fits[CURVE_SCHLICK].parameter, found->fits[CURVE_SCHLICK].parameter_error,
                1.0))
        found->alike[CURVE_SCHLICK] = false;
}

/* Finds the parameter of the chosen family for one look. */
static sonject_status fit_one_look(struct report *report, struct calibration *found,
                                   const struct stored_swath *swath, double parameter)
{
    const enum curve_family family = found->family;
    const bool by_contrast = found->looks.unseen && isnan(parameter);
    found->parameter.how = by_contrast ? "amplitudes of plain tiles vary as those of one look"
                                       : "likeliest for speckle in plain tiles of all levels";
    CHECK(fit_family(report, found, swath, family, parameter, 1.0));
    if (!by_contrast)
        return SONJECT_OK;
    struct curve_fit *fit = &found->fits[family];
    CHECK(find_by_contrast(report, &found->tiles, swath, curve_full_scale(found, swath), family,
                           fit));
    const double error = fit->parameter_error;
    CHECK(fit_family(report, found, swath, family, fit->parameter, 1.0)); /* fits the levels */
    fit->parameter_error = error;
    return SONJECT_OK;
}

/* Decides on the looks of the chosen family. Refits its parameter where one look is taken. */
static sonject_status settle_looks(struct report *report, struct calibration *found,
                                   const struct stored_swath *swath, double parameter)
{
    const struct curve_fit *fit = &found->fits[found->family];
    const double error = fit->looks_error;
    struct estimate *looks = &found->looks;
    looks->value = fit->looks;
    looks->error = fit->looks * hypot(error, LOOKS_BIAS);
    looks->how = "law of the logarithm of intensity in plain tiles, fitted with the curve";
    found->parameter.how = "likeliest for speckle in plain tiles of all levels";
    if (fit->looks > LOOKS_NO_SPECKLE || !(error < LOOKS_ERROR_MOST) ||
        (isnan(parameter) && fit->misfit > LOOKS_MISFIT))
        looks->unseen = "the logarithms of the plain tiles' numbers are not spread as those of "
                        "speckle; 1 look is assumed";
    else if (isnan(parameter) && log(fit->looks) < fmax(LOOKS_ONE, CLEARLY * error))
        looks->value = 1.0;
    else
        return SONJECT_OK;
    return fit_one_look(report, found, swath, parameter);
}

/* Decides the kind of transfer that the power's exponent makes. A simple exponent is then kept.
 * Where speckle does not tell looks and exponent apart, a narrow spread means several looks. */
static sonject_status settle_power(struct report *report, struct calibration *found,
                                   const struct stored_swath *swath)
{
    const struct curve_fit *fit = &found->fits[CURVE_POWER];
    const bool is_narrow = found->looks.unseen && fit->parameter > 1.0;
    found->transfer.kind = SONJECT_TRANSFER_GAMMA;
    found->alike[CURVE_POWER] = is_narrow;
    found->alike_exponent = fit->parameter;
    for (int kind = 0; kind < 2; kind++) {
        const double simple = kind == 0 ? 1.0 : 0.5;
        if (!is_near(fit->parameter, fit->parameter_error, simple) && !(kind == 0 && is_narrow))
            continue;
        found->transfer.kind = kind == 0 ? SONJECT_TRANSFER_AMPLITUDE : SONJECT_TRANSFER_INTENSITY;
        found->looks.unseen = NULL;
        CHECK(fit_freely(report, found, swath, CURVE_POWER, simple));
        return settle_looks(report, found, swath, simple);
    }
    return SONJECT_OK;
}

static void tell_curve(struct calibration *found)
{
    const struct curve_fit *fit = &found->fits[found->family];
    found->parameter.value = fit->parameter;
    found->parameter.error = fit->parameter * fit->parameter_error;
    found->shape.how = "correlation of plain tiles beyond the speckle's own; other ground has more";
    found->looks.value = fmax(1.0, found->looks.value);
    if (fit->texture > 0.0) {
        found->shape.value = 1.0 / fit->texture;
        found->shape.error = fit->texture_error / (fit->texture * fit->texture);
    } else {
        found->shape.unseen = "plain tiles have no texture beyond speckle";
    }
    if (!(fit->parameter_error < PARAMETER_UNKNOWN) &&
        found->transfer.kind >= SONJECT_TRANSFER_DECIBEL)
        found->parameter.unseen = "the tiles determine it no better than to a half of its value";
}

static sonject_status find_curve(struct report *report, struct calibration *found,
                                 const struct stored_swath *swath)
{
    const double full = curve_full_scale(found, swath);
    const size_t count = swath->rows * swath->columns;
    double lowest = INFINITY, highest = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        lowest = fmin(lowest, (double)swath->values[i]);
        highest = fmax(highest, (double)swath->values[i]);
    }
    if (swath->is_complex) {
        found->family = CURVE_POWER;
        found->transfer.kind = SONJECT_TRANSFER_AMPLITUDE;
        CHECK(fit_freely(report, found, swath, CURVE_POWER, 1.0));
        CHECK(settle_looks(report, found, swath, 1.0));
        tell_curve(found);
        return SONJECT_OK;
    }
    const bool tried[CURVE_FAMILIES] = {
        [CURVE_POWER] = lowest >= 0.0,
        [CURVE_DECIBEL] = true,
        [CURVE_SCHLICK] = lowest >= 0.0 && highest <= full,
    };
    for (int family = 0; family < CURVE_FAMILIES; family++)
        if (tried[family])
            CHECK(fit_freely(report, found, swath, (enum curve_family)family, NAN));
    choose_family(found, tried);
    CHECK(settle_looks(report, found, swath, NAN));
    if (found->family == CURVE_POWER)
        CHECK(settle_power(report, found, swath));
    else
        found->transfer.kind =
            found->family == CURVE_DECIBEL ? SONJECT_TRANSFER_DECIBEL : SONJECT_TRANSFER_SCHLICK;
    tell_curve(found);
    return SONJECT_OK;
}

/* ---- The whole calibration. */

void calibration_clear(struct calibration *calibration)
{
    for (int family = 0; family < CURVE_FAMILIES; family++)
        curve_fit_clear(&calibration->fits[family]);
    plain_tiles_clear(&calibration->tiles);
    first_returns_clear(&calibration->returns);
    memset(calibration, 0, sizeof *calibration);
}

static void fill_unseen(struct calibration *found)
{
    struct estimate *const all[] = {
        &found->transfer_kind,  &found->parameter,  &found->looks,
        &found->shape,          &found->along_rows, &found->range_columns,
        &found->noise_floor_db, &found->room_db,    &found->seabed_db};
    for (size_t i = 0; i < COUNT(all); i++)
        all[i]->unseen = too_small;
}

static void forget_curve(struct calibration *found)
{
    for (int family = 0; family < CURVE_FAMILIES; family++)
        curve_fit_clear(&found->fits[family]);
    plain_tiles_clear(&found->tiles);
    memset(&found->parameter, 0, sizeof found->parameter);
    memset(&found->looks, 0, sizeof found->looks);
    memset(&found->shape, 0, sizeof found->shape);
}

/* Chooses tiles and finds the curve from them. From too few tiles nothing is seen. */
static sonject_status find_from_tiles(struct report *report, struct calibration *found,
                                      const struct stored_swath *swath)
{
    const double ceiling = found->full_scale.unseen ? INFINITY : found->full_scale.value;
    CHECK(plain_tiles_init(&found->tiles, report, swath, &found->returns, found->grain, ceiling));
    if (found->tiles.count >= TILES_LEAST && found->tiles.edge_count >= EDGES_LEAST)
        return find_curve(report, found, swath);
    fill_unseen(found);
    return SONJECT_OK;
}

/* Returns how badly a row suits a first target, dB: 1 dB for each 5 % that its altitude differs
 * from the median, and 1 dB for each 2.5 % of the rows that it lies nearer to an edge than a
 * quarter of them. An edge would cut the target. */
static double oddness_of_row(const struct calibration *found, size_t row)
{
    const double returned = found->median_return > 0.0 ? found->returns.columns[row] : 0.0;
    const double to_edge = fmin((double)row, (double)(found->rows - row)) / (double)found->rows;
    return (returned > 0.0 ? 20.0 * fabs(log(returned / found->median_return)) : 0.0) +
           40.0 * fmax(0.0, 0.25 - to_edge);
}

/* Returns whether a column is in the middle third of the columns of its side. Objects without a
 * position are placed there. */
static bool is_amid_side(const struct calibration *found, size_t column)
{
    const double end = (double)found->columns - 0.5;
    const double nadir = found->returns.sides == WATER_BETWEEN ? found->returns.nadir_column : -0.5;
    const double off = (double)column - nadir;
    const double share = off < 0.0 ? off / (-0.5 - nadir) : off / (end - nadir);
    return share >= 1.0 / 3.0 && share < 2.0 / 3.0;
}

/* Finds a place for a first target: a dark tile of the plain seabed, so that the target stands out,
 * in a row that suits it. */
static void find_place(struct calibration *found, double level_db)
{
    const double *levels = found->fits[found->family].levels;
    double least = INFINITY;
    for (size_t i = 0; i < found->tiles.count; i++) {
        const size_t middle = found->tiles.columns[i] + found->tiles.side / 2;
        const size_t row = found->tiles.rows[i] + found->tiles.side / 2;
        const double off = fabs(DECIBELS * levels[i] - level_db) + oddness_of_row(found, row);
        if (!is_amid_side(found, middle) || off >= least)
            continue;
        least = off;
        found->plain_row = row;
        found->plain_column = middle;
    }
}

/* Finds the level of the plain seabed in the middle columns of a side, and how far highlights can
 * rise over it before they clip. */
static void find_seabed(struct calibration *found, const struct stored_swath *swath)
{
    const double *levels = found->fits[found->family].levels;
    double count = 0.0, sum = 0.0, squares = 0.0;
    found->seabed_db.how =
        "mean level of plain tiles in the middle third of a side's columns, over "
        "an amplitude of 1, which is full scale except in decibel curves; row "
        "and column are the place of one that is darker than most";
    found->room_db.how = "the ceiling, or the largest number that pixels hold, over those tiles";
    for (size_t i = 0; i < found->tiles.count; i++) {
        const double level = DECIBELS * levels[i];
        if (!is_amid_side(found, found->tiles.columns[i] + found->tiles.side / 2))
            continue;
        count += 1.0;
        sum += level;
        squares += level * level;
    }
    found->seabed_db.unseen =
        count < 2.0 ? "fewer than two plain tiles are in the middle third of a side's columns"
                    : NULL;
    found->room_db.unseen = found->seabed_db.unseen ? found->seabed_db.unseen
                            : swath->unit > 0.0     ? NULL
                                                    : found->full_scale.unseen;
    if (found->seabed_db.unseen)
        return;
    const double mean = sum / count, deviation = sqrt(fmax(0.0, squares / count - mean * mean));
    found->seabed_db.value = mean;
    found->seabed_db.error = deviation / sqrt(count);
    find_place(found, mean - deviation);
    if (found->room_db.unseen)
        return;
    found->room_db.value =
        DECIBELS * pixel_log_intensity(found, swath, curve_full_scale(found, swath)) - mean;
    found->room_db.error = found->seabed_db.error;
}

sonject_status calibrate_swath(struct report *report, const struct stored_swath *swath,
                               const sonject_geometry_params *geometry,
                               struct calibration *calibration)
{
    struct calibration *found = calibration;
    memset(found, 0, sizeof *found);
    found->grain[0] = found->grain[1] = 1;
    found->rows = swath->rows;
    found->columns = swath->columns;
    found->row_spacing_m = geometry->row_spacing_m;
    found->column_spacing_m = geometry->column_spacing_m;
    found->first_slant_range_m = geometry->first_slant_range_m;
    found->nadir_column.unseen = found->altitude_m.unseen = too_small;
    find_ceiling(swath, found);
    sonject_status status = find_from_tiles(report, found, swath);
    if (status == SONJECT_OK && !found->transfer_kind.unseen) {
        status = find_water_and_grain(report, found, swath);
        const bool is_coarse = found->grain[0] > 1 || found->grain[1] > 1;
        if (status == SONJECT_OK && (is_coarse || found->returns.sides != WATER_UNSEEN)) {
            forget_curve(found);
            status = find_from_tiles(report, found, swath);
        }
    }
    if (status == SONJECT_OK && !found->transfer_kind.unseen)
        status = find_parts(report, found, swath);
    if (status == SONJECT_OK && !found->transfer_kind.unseen)
        find_seabed(found, swath);
    if (!found->full_scale.unseen)
        found->transfer.full_scale = found->full_scale.value;
    found->transfer.parameter =
        !found->transfer_kind.unseen && found->transfer.kind >= SONJECT_TRANSFER_DECIBEL
            ? found->parameter.value
            : 1.0;
    if (status != SONJECT_OK)
        calibration_clear(found);
    return status;
}
