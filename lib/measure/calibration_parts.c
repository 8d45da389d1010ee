#include "measure/calibration_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/shadow_floor.h"
#include "image/statistics.h"

/* Response. */
#define FAINTEST_CORRELATION 0.02
#define FAR_LAG              8   /* speckle is uncorrelated from this lag on */
#define WIDTH_MOST           5.5 /* pixels; wider responses are still correlated at lags 8 to 11 */
#define WIDTH_BIAS           0.015 /* relative error: tiles are chosen by chance speckle, too */
#define UNEVEN_MOST          2.0   /* largest variance of a tile, over the median variance */
#define PEAK_MOST            14.0  /* over a tile's mean; brighter pixels are no speckle */

/* Grain. */
#define TAIL_MOST 0.15 /* largest correlation of speckle two widths away; ripples have more */

/* Noise floor. */
#define ROUNDING_MOST 0.05 /* most that rounding may add, as a share of the floor */
#define LOWEST_SHARE  0.05 /* most pixels at the lowest number, as a share */

static double median_level(const struct calibration *found, double *scratch)
{
    memcpy(scratch, found->fits[found->family].levels, found->tiles.count * sizeof *scratch);
    return median_of(scratch, found->tiles.count);
}

/* Fills intensities relative to a level. Uses a table where values are whole numbers. */
static sonject_status fill_intensities(struct report *report, const struct calibration *found,
                                       const struct stored_swath *swath, double level,
                                       float *intensity)
{
    const size_t count = swath->rows * swath->columns;
    const size_t length = swath->unit > 0.0 ? (size_t)(swath->type_full / swath->unit) + 1 : 0;
    float *table = allocate_array(length, sizeof *table);
    CHECK_MEMORY(report, table, "a calibration");
    for (size_t i = 0; i < length; i++)
        table[i] = (float)exp(pixel_log_intensity(found, swath, (double)i * swath->unit) - level);
    for (size_t i = 0; i < count; i++) {
        const double value = (double)swath->values[i];
        const size_t at = length > 0 ? (size_t)(value / swath->unit + 0.5) : 0;
        intensity[i] = length > 0 ? table[at < length ? at : length - 1]
                                  : (float)exp(pixel_log_intensity(found, swath, value) - level);
        if (value == 0.0 && found->family != CURVE_DECIBEL)
            intensity[i] = 0.0f;
    }
    free(table);
    return SONJECT_OK;
}

/* ---- The response, from the correlation of the plain tiles' intensity. */

/* Returns the covariance of a tile's pixels at a lag along an axis, over the square of the mean. */
static double tile_covariance(const float *tile, size_t side, size_t stride, size_t lag, int axis,
                              double mean)
{
    double sum = 0.0;
    for (size_t i = 0; i < side; i++)
        for (size_t k = 0; k + lag < side; k++) {
            const size_t a = axis == 0 ? k * stride + i : i * stride + k;
            const size_t b = axis == 0 ? a + lag * stride : a + lag;
            sum += ((double)tile[a] - mean) * ((double)tile[b] - mean);
        }
    return sum / ((double)(side * (side - lag)) * mean * mean);
}

/* Returns the half-power width w of a Gaussian response whose intensities have this correlation,
 * exp(-2 ln 2 x^2 / w^2), which falls to a half at w / sqrt 2. Between lags the logarithm is
 * interpolated over the square of the lag. */
static double width_of(const double correlation[CALIBRATION_LAGS])
{
    size_t lag = 1;
    while (lag + 1 < CALIBRATION_LAGS && correlation[lag] > 0.5)
        lag++;
    const double before = -log(fmin(1.0, fmax(1e-3, correlation[lag - 1])));
    const double after = -log(fmin(0.999, fmax(1e-3, correlation[lag])));
    const double near = (double)((lag - 1) * (lag - 1)), far = (double)(lag * lag);
    if (!(after > before))
        return NAN;
    return sqrt(2.0 * (near + (far - near) * (log(2.0) - before) / (after - before)));
}

/* Leaves out tiles of more than twice the median variance, which lie across edges and shadows. Sums
 * up the others, and returns their number. */
static size_t leave_uneven(double *values, size_t count, double sums[CALIBRATION_LAGS])
{
    size_t taken = 0;
    double median = 0.0;
    /* Find the median by halving: as many values are above as below. */
    for (double step = 1.0; step > 1e-4; step *= 0.5) {
        size_t below = 0;
        for (size_t i = 0; i < count; i++)
            below += values[i * CALIBRATION_LAGS] < median + step;
        median += 2 * below < count ? step : 0.0;
    }
    memset(sums, 0, CALIBRATION_LAGS * sizeof *sums);
    for (size_t i = 0; i < count; i++) {
        if (values[i * CALIBRATION_LAGS] > UNEVEN_MOST * median)
            continue;
        memmove(values + taken * CALIBRATION_LAGS, values + i * CALIBRATION_LAGS,
                CALIBRATION_LAGS * sizeof *values);
        for (size_t lag = 0; lag < CALIBRATION_LAGS; lag++)
            sums[lag] += values[taken * CALIBRATION_LAGS + lag];
        taken++;
    }
    return taken;
}

static sonject_status find_response(struct report *report, struct calibration *found,
                                    const struct stored_swath *swath, const float *intensity,
                                    int axis, struct estimate *width)
{
    const struct plain_tiles *tiles = &found->tiles;
    double *values = allocate_array(tiles->count, CALIBRATION_LAGS * sizeof *values);
    double *correlation = found->correlation[axis];
    double means[CALIBRATION_LAGS] = {0.0}, errors[CALIBRATION_LAGS], far = 0.0;
    CHECK_MEMORY(report, values, "a calibration");
    size_t taken = 0;
    for (size_t tile = 0; tile < tiles->count; tile++) {
        const float *pixels = intensity + tiles->rows[tile] * swath->columns + tiles->columns[tile];
        double mean = 0.0, peak = 0.0;
        for (size_t i = 0; i < tiles->side * tiles->side; i++) {
            const double own = pixels[i / tiles->side * swath->columns + i % tiles->side];
            mean += own / (double)(tiles->side * tiles->side);
            peak = fmax(peak, own);
        }
        if (!(peak < PEAK_MOST * mean))
            continue;
        for (size_t lag = 0; lag < CALIBRATION_LAGS; lag++)
            values[taken * CALIBRATION_LAGS + lag] =
                tile_covariance(pixels, tiles->side, swath->columns, lag, axis, mean);
        taken++;
    }
    taken = leave_uneven(values, taken, means);
    const double count = (double)taken;
    if (taken < TILES_LEAST) {
        free(values);
        width->unseen = "almost all plain tiles have pixels that are brighter than speckle";
        return SONJECT_OK;
    }
    for (size_t lag = 0; lag < CALIBRATION_LAGS; lag++)
        means[lag] /= count;
    for (size_t lag = FAR_LAG; lag < CALIBRATION_LAGS; lag++)
        far += means[lag] / (CALIBRATION_LAGS - FAR_LAG);
    for (size_t lag = 0; lag < CALIBRATION_LAGS; lag++) {
        double squares = 0.0;
        correlation[lag] = (means[lag] - far) / (means[0] - far);
        for (size_t tile = 0; tile < taken; tile++) {
            const double *own = values + tile * CALIBRATION_LAGS;
            const double off = own[lag] - means[lag] - correlation[lag] * (own[0] - means[0]);
            squares += off * off;
        }
        errors[lag] = sqrt(squares) / count / (means[0] - far);
    }
    free(values);
    width->how = "half-power width of a Gaussian response whose speckle has this correlation";
    if (correlation[1] < fmax(FAINTEST_CORRELATION, CLEARLY * errors[1])) {
        width->unseen = "neighbouring pixels are independent: the response is narrower than 0.7 of "
                        "a pixel";
        return SONJECT_OK;
    }
    double higher[CALIBRATION_LAGS];
    for (size_t lag = 0; lag < CALIBRATION_LAGS; lag++)
        higher[lag] = lag == 0 ? 1.0 : correlation[lag] + errors[lag];
    width->value = width_of(correlation);
    width->error = hypot(fabs(width_of(higher) - width->value), WIDTH_BIAS * width->value);
    if (!isfinite(width->value) || !isfinite(width->error) || width->value > WIDTH_MOST)
        width->unseen = "wider than 5.5 pixels: the correlation does not fall off within 8";
    return SONJECT_OK;
}

/* ---- Level against range. */

static void find_gain(struct calibration *found, double level)
{
    const struct plain_tiles *tiles = &found->tiles;
    const double *levels = found->fits[found->family].levels;
    const size_t across = found->columns / tiles->side;
    found->gain_bands = across < GAIN_BANDS ? across : GAIN_BANDS;
    for (size_t band = 0; band < found->gain_bands; band++) {
        double sum = 0.0, squares = 0.0, count = 0.0;
        for (size_t i = 0; i < tiles->count; i++) {
            const size_t middle = tiles->columns[i] + tiles->side / 2;
            if (middle * found->gain_bands / found->columns != band)
                continue;
            const double own = DECIBELS * (levels[i] - level);
            sum += own;
            squares += own * own;
            count += 1.0;
        }
        const double mean = sum / count;
        found->gain_db[band] = count >= 2.0 ? mean : NAN;
        found->gain_error_db[band] =
            count >= 2.0 ? sqrt(fmax(0.0, squares / count - mean * mean) / (count - 1.0)) : NAN;
    }
}

/* ---- The noise floor, from shadows. */

/* Finds what rounding to stored steps adds to the intensities of shadow pixels, as a share of
 * these, and the share of shadow pixels that lie at the lowest number. */
static void look_at_steps(const struct calibration *found, const struct stored_swath *swath,
                          const float *intensity, const uint8_t *states, double level,
                          double *rounding, double *at_lowest)
{
    const size_t count = swath->rows * swath->columns;
    double pixels = 0.0, low = 0.0, sum = 0.0, squares = 0.0, lowest = INFINITY;
    for (size_t i = 0; i < count; i++)
        lowest = fmin(lowest, (double)swath->values[i]);
    for (size_t i = 0; i < count; i++) {
        if (!(states[i] & SHADOW_CORE))
            continue;
        const double value = (double)swath->values[i], half = 0.5 * swath->unit;
        const double step =
            exp(0.5 * (pixel_log_intensity(found, swath, value + half) - level)) -
            (value > half ? exp(0.5 * (pixel_log_intensity(found, swath, value - half) - level))
                          : 0.0);
        squares += half > 0.0 ? step * step / 12.0 : 0.0;
        sum += (double)intensity[i];
        low += value <= lowest;
        pixels += 1.0;
    }
    *rounding = squares / sum;
    *at_lowest = low / pixels;
}

/* Returns by how many dB a standard error of the curve's parameter moves the floor over seabed. */
static double floor_by_parameter(const struct calibration *found, double level, double log_floor)
{
    const struct curve_fit *fit = &found->fits[found->family];
    const double error =
        found->transfer.kind < SONJECT_TRANSFER_DECIBEL ? 0.0 : fit->parameter_error;
    const double b = fit->parameter;
    double slopes[2]; /* d log intensity / d log b, at the floor and at the seabed */
    if (found->family != CURVE_SCHLICK)
        return DECIBELS * log_floor * error;
    for (int i = 0; i < 2; i++) {
        const double amplitude = exp(0.5 * (level + (i == 0 ? log_floor : 0.0)));
        const double q = amplitude * b / (1.0 + (b - 1.0) * amplitude);
        slopes[i] = 2.0 * b * (1.0 - q) / (b - (b - 1.0) * q);
    }
    return DECIBELS * (slopes[0] - slopes[1]) * error;
}

static void judge_floor(struct calibration *found, const struct stored_swath *swath,
                        const struct shadow_floor *shadows, const float *intensity,
                        const uint8_t *states, double level)
{
    struct estimate *noise = &found->noise_floor_db;
    double rounding, at_lowest;
    found->shadows = shadows->shadows;
    noise->how =
        "mean over shadows with seabed on all sides, each relative to the seabed around it";
    noise->unseen = found->returns.sides == WATER_UNSEEN
                        ? "no shadow has seabed on all sides and lies 9 dB below it"
                        : "no shadow has seabed on all sides and lies 9 dB below it; the water "
                          "column is not a shadow";
    if (shadows->shadows == 0)
        return;
    look_at_steps(found, swath, intensity, states, level, &rounding, &at_lowest);
    noise->unseen = "the shadows are darker than the stored numbers can resolve";
    if ((found->family == CURVE_DECIBEL && at_lowest > LOWEST_SHARE) || rounding > ROUNDING_MOST)
        return;
    noise->unseen = NULL;
    const double log_floor = shadows->log_ratio + log(1.0 - rounding);
    noise->value = DECIBELS * log_floor;
    noise->error = hypot(DECIBELS * (shadows->log_error + 0.5 * rounding),
                         floor_by_parameter(found, level, log_floor));
}

static sonject_status find_floor(struct report *report, struct calibration *found,
                                 const struct stored_swath *swath, const float *intensity,
                                 double level)
{
    const size_t count = swath->rows * swath->columns;
    uint8_t *states = allocate_array(count, 1);
    struct shadow_floor shadows = {0};
    CHECK_MEMORY(report, states, "a calibration");
    for (size_t i = 0; i < count; i++) {
        const struct water_place place = {i / swath->columns, i % swath->columns, 1, 1};
        states[i] = first_returns_cover(&found->returns, &place, swath->columns);
    }
    const sonject_status status =
        shadow_floor_find(report, intensity, states, swath->rows, swath->columns, &shadows);
    if (status == SONJECT_OK)
        judge_floor(found, swath, &shadows, intensity, states, level);
    free(shadows.list);
    free(states);
    return status;
}

/* ---- The water column. */

/* Returns the standard error of one ping's first return, from the scatter about its neighbours. */
static double return_error(const double *columns, size_t rows, double *scratch)
{
    for (size_t i = 1; i + 1 < rows; i++)
        scratch[i - 1] = fabs(columns[i - 1] - 2.0 * columns[i] + columns[i + 1]);
    return rows < 3 ? NAN : 1.4826 * median_of(scratch, rows - 2) / sqrt(6.0);
}

/* scratch: one number for each row. */
static void tell_water(struct calibration *found, double *scratch)
{
    static const char no_water[] =
        "fewer than nine in ten rows begin with a water column 10 dB under the seabed";
    const struct first_returns *returns = &found->returns;
    found->nadir_column.unseen = found->altitude_m.unseen = NULL;
    found->nadir_column.how = "halfway between both sides' first returns";
    found->altitude_m.how = "median of the pings' first returns; the error is that of a ping";
    if (returns->sides == WATER_UNSEEN) {
        found->nadir_column.unseen = found->altitude_m.unseen = no_water;
        return;
    }
    if (returns->sides == WATER_BETWEEN) {
        found->nadir_column.value = returns->nadir_column;
        found->nadir_column.error = returns->nadir_column_error;
    } else {
        found->nadir_column.unseen = "the swath shows one side";
    }
    const double error = return_error(returns->columns, found->rows, scratch);
    memcpy(scratch, returns->columns, found->rows * sizeof *scratch);
    double columns[3];
    spread_of(scratch, found->rows, columns);
    found->median_return = columns[1];
    const bool knows_first = returns->sides != WATER_BETWEEN && found->first_slant_range_m >= 0.0;
    const double first = knows_first ? found->first_slant_range_m / found->column_spacing_m : 0.5;
    if (!(found->column_spacing_m > 0.0)) {
        found->altitude_m.unseen = "the column spacing is not known";
        return;
    }
    found->altitude_m.value = (columns[1] + first) * found->column_spacing_m;
    for (int i = 0; i < 2; i++)
        found->altitude_ends_m[i] = (columns[2 * i] + first) * found->column_spacing_m;
    found->altitude_m.error = fmax(error, 0.3) * found->column_spacing_m;
}

/* Finds the grain along an axis: the response's width, if the speckle and not ripples tell it. */
static sonject_status find_grain(struct report *report, struct calibration *found,
                                 const struct stored_swath *swath, const float *intensity, int axis)
{
    struct estimate width = {.unseen = NULL};
    CHECK(find_response(report, found, swath, intensity, axis, &width));
    const size_t grain = width.unseen ? 1 : (size_t)fmin(GRAIN_MOST, fmax(1.0, width.value));
    found->grain[axis] = found->correlation[axis][2 * grain] < TAIL_MOST ? grain : 1;
    return SONJECT_OK;
}

sonject_status find_water_and_grain(struct report *report, struct calibration *found,
                                    const struct stored_swath *swath)
{
    struct first_returns *returns = &found->returns;
    float *intensity = allocate_array(swath->rows, swath->columns * sizeof *intensity);
    double *scratch = allocate_array(
        swath->rows > found->tiles.count ? swath->rows : found->tiles.count, sizeof *scratch);
    sonject_status status =
        intensity && scratch ? SONJECT_OK : report_out_of_memory(report, "a calibration");
    THEN(status, fill_intensities(report, found, swath, median_level(found, scratch), intensity));
    THEN(status, first_returns_find(returns, report, intensity, found->rows, found->columns));
    THEN(status, find_grain(report, found, swath, intensity, 0));
    THEN(status, find_grain(report, found, swath, intensity, 1));
    if (status == SONJECT_OK)
        tell_water(found, scratch);
    free(intensity);
    free(scratch);
    return status;
}

static void fill_histogram(struct calibration *found, const struct stored_swath *swath)
{
    const size_t count = swath->rows * swath->columns;
    double top = 0.0;
    for (size_t i = 0; i < count; i++)
        top = fmax(top, (double)swath->values[i]);
    found->histogram_top = swath->unit > 0.0 ? fmin(swath->type_full, top) : top;
    for (size_t i = 0; i < count && top > 0.0; i++) {
        const double at = fmax(0.0, (double)swath->values[i]) / found->histogram_top * PAGE_BINS;
        found->histogram[(size_t)fmin(PAGE_BINS - 1.0, at)] += 1.0 / (double)count;
    }
}

sonject_status find_parts(struct report *report, struct calibration *found,
                          const struct stored_swath *swath)
{
    float *intensity = allocate_array(swath->rows, swath->columns * sizeof *intensity);
    double *scratch = allocate_array(found->tiles.count, sizeof *scratch);
    sonject_status status =
        intensity && scratch ? SONJECT_OK : report_out_of_memory(report, "a calibration");
    if (status == SONJECT_OK) {
        const double level = median_level(found, scratch);
        status = fill_intensities(report, found, swath, level, intensity);
        find_gain(found, level);
        fill_histogram(found, swath);
        THEN(status, find_response(report, found, swath, intensity, 0, &found->along_rows));
        THEN(status, find_response(report, found, swath, intensity, 1, &found->range_columns));
        THEN(status, find_floor(report, found, swath, intensity, level));
    }
    free(intensity);
    free(scratch);
    return status;
}
