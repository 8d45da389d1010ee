#include "image/shadow_floor.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "image/statistics.h"

/* The least deviation of the local mean that is the seabed's level: in pixels, and as a share of
 * the image's shorter side. */
#define LEVEL_DEVIATION 28.0
#define LEVEL_SHARE     0.04
#define SQUARE          4        /* side of a square, pixels */
#define SHARE_LEAST     0.02     /* least share of nearby pixels that tells a pixel's level */
#define PLAIN           4.0f     /* ratio to the level, 6 dB, within which seabed is plain */
#define DARK            0.316f   /* ratio to the level, -5 dB */
#define BLANK           1e-6f    /* share of the level; all 0 is no shadow */
#define HIGHEST         0.126    /* -9 dB; a brighter part is dim ground */
#define LONE_HIGHEST    (-2.763) /* -12 dB, as a logarithm, for a single shadow */
#define LAGS            8        /* pixels; speckle is uncorrelated from there on */
#define PIXELS_ENOUGH   65536    /* enough pixels to tell the speckle's length */
#define BRIGHTEST       6.0      /* over the level; speckle of brighter pixels does not count */
#define LOOKS_LEAST     3.0      /* fewest independent pixels in a shadow's middle */

/* The other uncertainty of a shadow's level, as the variance of a look: the middle of a small
 * shadow is near its edges, which fill it. */
#define EDGES 3.0

/* The deviations of the means in which shadows are looked for: the least, and for each pixel of
 * speckle's length. They take some 3 rows and 6 columns, about 6 independent pixels or more. */
#define ROW_DEVIATION    0.7
#define ROW_BY_LENGTH    0.4
#define COLUMN_DEVIATION 1.5
#define COLUMN_BY_LENGTH 1.2
#define BEYOND           2.0  /* deviations beyond a shadow's end by which seabed has returned */
#define SHARP            0.5f /* least level beyond a sharp end, over the seabed's */
#define LEAST_BY_COLUMN  4.0  /* columns of a shadow for each deviation */

/* The deviation of shadows' levels where there are fewer than three, nepers: 4 dB. Those of a
 * sidescan line of 600 kHz differ by 4 to 7 dB. */
#define SCATTER_UNKNOWN 0.92

/* The state of a pixel: its kind, and whether it is in the middle of its dark run along an axis. */
enum {
    SEABED = 0,
    NO_SEABED = 1,
    SHADOW = 2,
    KINDS = 3,
    MIDDLE = 4, /* along the rows' axis; twice that along the columns' */
    SEEN = 32
};

struct shadow_search {
    const float *intensity;
    uint8_t *states;
    size_t rows, columns;
    float *weights, *smooth, *level;
    double row_length, column_length; /* pixels for one look */
    double variance;                  /* speckle's, over the mean's square */
    double row_deviation, column_deviation, level_deviation;
};

static bool holds(const struct shadow_search *search, size_t i, int kind)
{
    return (search->states[i] & KINDS) == kind;
}

/* Finds local means of the values that have a weight, in planes of any size; NaN where hardly any
 * is near. Overwrites weights and values. */
static sonject_status weighted_mean(struct report *report, size_t rows, size_t columns,
                                    float *weights, float *values, double row_deviation,
                                    double column_deviation)
{
    bool is_even = true; /* all weights are 1, and so are their means */
    for (size_t i = 0; i < rows * columns; i++)
        is_even &= weights[i] == 1.0f;
    CHECK(local_mean(report, values, rows, columns, row_deviation, column_deviation, values));
    if (is_even)
        return SONJECT_OK;
    CHECK(local_mean(report, weights, rows, columns, row_deviation, column_deviation, weights));
    for (size_t i = 0; i < rows * columns; i++)
        values[i] = weights[i] > (float)SHARE_LEAST ? values[i] / weights[i] : NAN;
    return SONJECT_OK;
}

/* Finds the seabed's level, which changes so slowly that squares of pixels tell it. */
static sonject_status find_level(struct report *report, struct shadow_search *search,
                                 const float *values)
{
    const size_t rows = (search->rows + SQUARE - 1) / SQUARE;
    const size_t columns = (search->columns + SQUARE - 1) / SQUARE;
    float *sums = allocate_array(2 * rows * columns, sizeof *sums);
    CHECK_MEMORY(report, sums, "an image's shadows");
    float *weights = sums + rows * columns;
    for (size_t row = 0, i = 0; row < search->rows; row++)
        for (size_t column = 0; column < search->columns; column++, i++) {
            const size_t square = row / SQUARE * columns + column / SQUARE;
            sums[square] += search->weights[i] * values[i] / (SQUARE * SQUARE);
            weights[square] += search->weights[i] / (SQUARE * SQUARE);
        }
    const double deviation = search->level_deviation / SQUARE;
    const sonject_status status =
        weighted_mean(report, rows, columns, weights, sums, deviation, deviation);
    for (size_t row = 0, i = 0; status == SONJECT_OK && row < search->rows; row++)
        for (size_t column = 0; column < search->columns; column++, i++)
            search->level[i] = sums[row / SQUARE * columns + column / SQUARE];
    free(sums);
    return status;
}

/* Returns how many pixels along an axis are one look, from the squared differences of pixels some
 * way apart on some of the axis's lines. *variance gets a pixel's. */
static double look_length(const struct shadow_search *search, bool is_along, double *variance)
{
    const size_t rows = search->rows, columns = search->columns;
    const size_t step = is_along ? columns : 1, length = is_along ? rows : columns;
    const size_t lines_apart = 1 + rows * columns / PIXELS_ENOUGH;
    const size_t rows_apart = is_along ? 1 : lines_apart;
    const size_t columns_apart = is_along ? lines_apart : 1;
    double sums[LAGS + 1] = {0.0}, counts[LAGS + 1] = {0.0}, sum = 0.0;
    for (size_t row = 0; row < rows; row += rows_apart)
        for (size_t column = 0; column < columns; column += columns_apart) {
            const size_t i = row * columns + column, place = is_along ? row : column;
            const double own = (double)search->intensity[i] / (double)search->level[i];
            if (!holds(search, i, SEABED) || !(own < BRIGHTEST))
                continue;
            sum += own;
            counts[0] += 1.0;
            for (size_t lag = 1; lag <= LAGS && place + lag < length; lag++) {
                const size_t at = i + lag * step;
                const double other = (double)search->intensity[at] / (double)search->level[at];
                if (!holds(search, at, SEABED) || !(other < BRIGHTEST))
                    continue;
                sums[lag] += (own - other) * (own - other);
                counts[lag] += 1.0;
            }
        }
    const double far = sums[LAGS] / fmax(1.0, counts[LAGS]);
    const double mean = sum / fmax(1.0, counts[0]);
    double pixels = 1.0;
    for (size_t lag = 1; far > 0.0 && lag < LAGS; lag++)
        pixels += 2.0 * fmax(0.0, 1.0 - sums[lag] / fmax(1.0, counts[lag]) / far);
    *variance = far > 0.0 ? fmin(1.0, 0.5 * far / (mean * mean)) : 1.0;
    return pixels;
}

/* Fills the seabed's level and the means in which shadows are looked for, and marks dark pixels. */
static sonject_status find_dark(struct report *report, struct shadow_search *search)
{
    const size_t count = search->rows * search->columns;
    double variance;
    for (size_t i = 0; i < count; i++) {
        search->weights[i] = holds(search, i, SEABED) ? 1.0f : 0.0f;
        search->smooth[i] = sqrtf(sqrtf(search->intensity[i])); /* lets highlights hardly count */
    }
    CHECK(find_level(report, search, search->smooth));
    for (size_t i = 0; i < count; i++)
        search->level[i] *= search->level[i] * search->level[i] * search->level[i];
    search->row_length = look_length(search, true, &variance);
    search->column_length = look_length(search, false, &search->variance);
    search->variance = fmax(search->variance, variance);
    search->column_deviation = fmax(COLUMN_DEVIATION, COLUMN_BY_LENGTH * search->column_length);
    search->row_deviation = fmax(ROW_DEVIATION, ROW_BY_LENGTH * search->row_length);
    for (size_t i = 0; i < count; i++)
        search->smooth[i] = search->weights[i] * search->intensity[i];
    CHECK(weighted_mean(report, search->rows, search->columns, search->weights, search->smooth,
                        search->row_deviation, search->column_deviation));
    for (size_t i = 0; i < count; i++) {
        search->weights[i] = holds(search, i, SEABED) ? 1.0f : 0.0f;
        if (!(search->smooth[i] * PLAIN > search->level[i] &&
              search->smooth[i] < PLAIN * search->level[i]))
            search->weights[i] = 0.0f;
    }
    CHECK(find_level(report, search, search->intensity));
    for (size_t i = 0; i < count; i++) {
        if (!(search->smooth[i] > BLANK * search->level[i]))
            search->states[i] = NO_SEABED;
        else if (holds(search, i, SEABED) && search->smooth[i] < DARK * search->level[i])
            search->states[i] = SHADOW;
    }
    return SONJECT_OK;
}

/* An axis along which dark runs are found. */
struct axis {
    size_t step, length, lines_apart; /* strides: to the next pixel, to the next line */
    double deviation;                 /* deviation of the means */
    size_t least;                     /* fewest pixels of a run */
    bool is_sharp;                    /* its ends must be sharp */
    uint8_t mark;
};

/* Returns whether a dark run ends at seabed, one pixel beyond its last. Along the track, where no
 * shadow fades away, the mean some pixels further must be bright: dim ground has no such edge. */
static bool ends(const struct shadow_search *search, const struct axis *axis, size_t first,
                 size_t last, size_t beyond)
{
    const size_t at = first + beyond * axis->step;
    return holds(search, first + last * axis->step, SEABED) &&
           (!axis->is_sharp || search->smooth[at] > SHARP * search->level[at]);
}

/* Marks the middle thirds of dark runs along an axis that begin and end at seabed. */
static void mark_middles(const struct shadow_search *search, const struct axis *axis)
{
    const size_t lines = search->rows * search->columns / axis->length, step = axis->step;
    const size_t beyond = axis->is_sharp ? (size_t)ceil(BEYOND * axis->deviation) : 1;
    for (size_t line = 0; line < lines; line++) {
        const size_t first = line * axis->lines_apart;
        for (size_t start = 0, end; start < axis->length; start = end) {
            const bool is_dark = holds(search, first + start * step, SHADOW);
            end = start + 1;
            while (end < axis->length && is_dark == holds(search, first + end * step, SHADOW))
                end++;
            if (!is_dark || end - start < axis->least || start < beyond ||
                end - 1 + beyond >= axis->length ||
                !ends(search, axis, first, start - 1, start - beyond) ||
                !ends(search, axis, first, end, end - 1 + beyond))
                continue;
            const size_t third = (end - start) / 3;
            for (size_t k = start + third; k < end - third; k++)
                search->states[first + k * step] |= axis->mark;
        }
    }
}

/* Lists the pixels of the shadow around a pixel. list has room for all dark pixels. */
static size_t list_shadow(const struct shadow_search *search, size_t start, size_t *list)
{
    size_t count = 1;
    list[0] = start;
    search->states[start] |= SEEN;
    for (size_t done = 0; done < count; done++) {
        const size_t row = list[done] / search->columns, column = list[done] % search->columns;
        const size_t beside[] = {list[done] - search->columns, list[done] + search->columns,
                                 list[done] - 1, list[done] + 1};
        const bool is_inside[] = {row > 0, row + 1 < search->rows, column > 0,
                                  column + 1 < search->columns};
        for (int i = 0; i < 4; i++)
            if (is_inside[i] && holds(search, beside[i], SHADOW) &&
                !(search->states[beside[i]] & SEEN)) {
                search->states[beside[i]] |= SEEN;
                list[count++] = beside[i];
            }
    }
    return count;
}

/* Adds a dark part as a shadow if its middle tells a level. */
static sonject_status add_shadow(struct report *report, const struct shadow_search *search,
                                 const size_t *list, size_t count, struct shadow_floor *found)
{
    const int middle = 3 * MIDDLE;
    double sum = 0.0, pixels = 0.0;
    for (size_t k = 0; k < count; k++)
        if ((search->states[list[k]] & middle) == middle) {
            sum += (double)search->intensity[list[k]] / (double)search->level[list[k]];
            pixels += 1.0;
        }
    const double looks = pixels / (search->row_length * search->column_length);
    if (!(looks >= LOOKS_LEAST) || !(sum < HIGHEST * pixels) || !(sum > 0.0))
        return SONJECT_OK;
    struct shadow *shadows = grow_doubling(found->list, found->listed, sizeof *shadows);
    CHECK_MEMORY(report, shadows, "an image's shadows");
    found->list = shadows;
    struct shadow *shadow = &shadows[found->listed++];
    for (size_t k = 0; k < count; k++)
        if ((search->states[list[k]] & middle) == middle)
            search->states[list[k]] |= SHADOW_CORE;
    shadow->variance = (search->variance + EDGES) / looks;
    /* The logarithm of a mean of few looks is biased low. */
    shadow->log_ratio = log(sum / pixels) + 0.5 * search->variance / looks;
    return SONJECT_OK;
}

/* Averages the shadows, weighted by their independent pixels. The standard error includes what they
 * differ beyond their own variances. */
static void average(struct shadow_floor *found)
{
    const struct shadow *shadows = found->list;
    const size_t count = found->listed;
    double weights = 0.0, sum = 0.0, plain = 0.0, squares = 0.0, own = 0.0, error = 0.0;
    for (size_t i = 0; i < count; i++) {
        weights += 1.0 / shadows[i].variance;
        sum += shadows[i].log_ratio / shadows[i].variance;
        plain += shadows[i].log_ratio / (double)count;
        own += shadows[i].variance / (double)count;
    }
    for (size_t i = 0; i < count; i++)
        squares += (shadows[i].log_ratio - plain) * (shadows[i].log_ratio - plain);
    const double between = count < 3 ? SCATTER_UNKNOWN * SCATTER_UNKNOWN
                                     : fmax(0.0, squares / (double)(count - 1) - own);
    for (size_t i = 0; i < count; i++)
        error += (between + shadows[i].variance) / (shadows[i].variance * shadows[i].variance);
    found->shadows = count;
    found->log_ratio = sum / weights;
    found->log_error = sqrt(error) / weights;
}

static sonject_status find_shadows(struct report *report, struct shadow_search *search,
                                   struct shadow_floor *found)
{
    const size_t count = search->rows * search->columns;
    const struct axis along = {search->columns, search->rows, 1, search->row_deviation, 1, true,
                               MIDDLE};
    const struct axis range = {1,
                               search->columns,
                               search->columns,
                               search->column_deviation,
                               (size_t)(LEAST_BY_COLUMN * search->column_deviation),
                               false,
                               2 * MIDDLE};
    size_t dark = 0;
    mark_middles(search, &along);
    mark_middles(search, &range);
    for (size_t i = 0; i < count; i++)
        dark += holds(search, i, SHADOW);
    size_t *list = allocate_array(dark, sizeof *list);
    sonject_status status = list ? SONJECT_OK : report_out_of_memory(report, "an image's shadows");
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        if ((search->states[i] & (3 * MIDDLE)) == 3 * MIDDLE && !(search->states[i] & SEEN))
            status = add_shadow(report, search, list, list_shadow(search, i, list), found);
    free(list);
    if (found->listed > 1 || (found->listed == 1 && found->list[0].log_ratio < LONE_HIGHEST))
        average(found);
    return status;
}

sonject_status shadow_floor_find(struct report *report, const float *intensity, uint8_t *states,
                                 size_t rows, size_t columns, struct shadow_floor *found)
{
    const size_t count = rows * columns;
    float *planes = allocate_array(count, 3 * sizeof *planes);
    struct shadow_search search = {.intensity = intensity,
                                   .states = states,
                                   .rows = rows,
                                   .columns = columns,
                                   .weights = planes,
                                   .smooth = planes + count,
                                   .level = planes + 2 * count};
    CHECK_MEMORY(report, planes, "an image's shadows");
    const size_t side = found->side > 0 ? found->side : rows < columns ? rows : columns;
    search.level_deviation = fmax(LEVEL_DEVIATION, LEVEL_SHARE * (double)side);
    sonject_status status = find_dark(report, &search);
    THEN(status, find_shadows(report, &search, found));
    free(planes);
    return status;
}
