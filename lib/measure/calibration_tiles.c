/* The tiles that a calibration rests on: the plainer half of fixed tiles all over the swath. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"
#include "measure/calibration.h"
#include "measure/contacts.h"

#define TILE_SIDE       32
#define TILE_SIDE_SMALL 16
#define TILES_FEW       40   /* fewest tiles of TILE_SIDE; below, smaller ones are used */
#define CANDIDATES_MOST 4000 /* most tiles examined */
#define TILES_MOST      600  /* most tiles used */
#define PARTS           4    /* parts of a tile along an axis, whose medians tell how plain it is */
#define CLIPPED_MOST    0.25 /* largest share of clipped pixels in a tile */
#define BLANK_MOST      0.05
#define QUANTILE_EDGES  48

struct candidate {
    size_t row, column;
    float unevenness;
};

static int compare_candidates(const void *a, const void *b)
{
    const float x = ((const struct candidate *)a)->unevenness;
    const float y = ((const struct candidate *)b)->unevenness;
    return (x > y) - (x < y);
}

/* Compares the places of two candidates, to restore their order. */
static int compare_places(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    if (x->row != y->row)
        return x->row < y->row ? -1 : 1;
    return x->column < y->column ? -1 : x->column > y->column;
}

static void copy_part(const struct stored_swath *swath, size_t row, size_t column, size_t rows,
                      size_t columns, float *part)
{
    for (size_t i = 0; i < rows; i++)
        memcpy(part + i * columns, swath->values + (row + i) * swath->columns + column,
               columns * sizeof *part);
}

static float median_of_floats(float *values, size_t count)
{
    qsort(values, count, sizeof *values, compare_floats);
    return 0.5f * (values[(count - 1) / 2] + values[count / 2]);
}

/* Returns the first row or column of a window in the middle of which a tile lies, as far as the
 * swath has room. */
static size_t window_start(size_t first, size_t side, size_t window, size_t end)
{
    const size_t before = (window - side) / 2;
    const size_t start = first > before ? first - before : 0;
    return start + window > end ? end - window : start;
}

/* Returns the deviation of the medians of the parts of a window about a tile, over the spread of
 * the tile's pixels. This rank statistic hardly depends on the curve. The window grows with the
 * grain. In parts of few grains chance would decide, and the tiles chosen would have less speckle
 * than others. Infinite for a tile that is blank, clipped or constant. */
static float unevenness(const struct stored_swath *swath, size_t row, size_t column, size_t side,
                        const size_t grain[2], double ceiling)
{
    float pixels[TILE_SIDE * TILE_SIDE];
    const size_t count = side * side;
    const size_t sizes[2] = {swath->rows, swath->columns};
    size_t part[2], first[2] = {row, column};
    for (int axis = 0; axis < 2; axis++) {
        part[axis] = smaller_size(grain[axis] * side, sizes[axis]) / PARTS;
        first[axis] = window_start(first[axis], side, PARTS * part[axis], sizes[axis]);
    }
    double sum = 0.0, squares = 0.0;
    size_t blank = 0, clipped = 0;
    for (size_t i = 0; i < PARTS * PARTS; i++) {
        copy_part(swath, first[0] + i / PARTS * part[0], first[1] + i % PARTS * part[1], part[0],
                  part[1], pixels);
        const double median = median_of_floats(pixels, part[0] * part[1]);
        sum += median;
        squares += median * median;
    }
    copy_part(swath, row, column, side, side, pixels);
    for (size_t i = 0; i < count; i++) {
        blank += pixels[i] == 0.0f;
        clipped += (double)pixels[i] >= ceiling;
    }
    qsort(pixels, count, sizeof *pixels, compare_floats);
    const double spread = (double)(pixels[3 * count / 4] - pixels[count / 4]);
    const double parts = PARTS * PARTS;
    if ((double)blank > BLANK_MOST * (double)count ||
        (double)clipped > CLIPPED_MOST * (double)count || !(spread > 0.0))
        return INFINITY;
    return (float)(sqrt(fmax(0.0, squares / parts - sum * sum / (parts * parts))) / spread);
}

/* Examines tiles all over the swath. *count gets the number of usable ones. NULL: memory is out. */
static struct candidate *find_candidates(const struct stored_swath *swath,
                                         const struct first_returns *water, size_t side,
                                         const size_t grain[2], double ceiling, size_t *count)
{
    const size_t across = swath->columns / side, all = swath->rows / side * across;
    const size_t tried = all < CANDIDATES_MOST ? all : CANDIDATES_MOST;
    struct candidate *list = allocate_array(tried, sizeof *list);
    *count = 0;
    for (size_t i = 0; list && i < tried; i++) {
        const size_t tile = i * all / tried;
        struct candidate *next = &list[*count];
        next->row = tile / across * side;
        next->column = tile % across * side;
        const struct water_place place = {next->row, next->column, side, side};
        next->unevenness = first_returns_cover(water, &place, swath->columns)
                               ? INFINITY
                               : unevenness(swath, next->row, next->column, side, grain, ceiling);
        *count += isfinite(next->unevenness) ? 1 : 0;
    }
    return list;
}

/* Chooses edges at quantiles of all numbers in the tiles. Where the numbers are whole, edges lie
 * between whole numbers. Clipped numbers have a cell of their own. */
static sonject_status choose_edges(struct plain_tiles *tiles, struct report *report,
                                   const struct stored_swath *swath, double ceiling)
{
    static const double tails[] = {0.0005, 0.002, 0.005, 0.01, 0.98, 0.99, 0.995, 0.998, 0.9995};
    const size_t pixels = tiles->side * tiles->side, count = tiles->count * pixels;
    const double unit = swath->unit;
    const double last = isfinite(ceiling)
                            ? unit > 0.0 ? ceiling - 0.5 * unit : ceiling - 1e-6 * fabs(ceiling)
                            : INFINITY;
    float *sorted = allocate_array(count, sizeof *sorted);
    double wanted[QUANTILE_EDGES + COUNT(tails) + 1];
    size_t wanted_count = 0;
    CHECK_MEMORY(report, sorted, "a calibration");
    for (size_t i = 0; i < tiles->count; i++)
        copy_part(swath, tiles->rows[i], tiles->columns[i], tiles->side, tiles->side,
                  sorted + i * pixels);
    qsort(sorted, count, sizeof *sorted, compare_floats);
    for (size_t i = 0; i < 4; i++)
        wanted[wanted_count++] = tails[i];
    for (size_t i = 1; i < QUANTILE_EDGES; i++)
        wanted[wanted_count++] = (double)i / QUANTILE_EDGES;
    for (size_t i = 4; i < COUNT(tails); i++)
        wanted[wanted_count++] = tails[i];
    tiles->edge_count = 0;
    for (size_t i = 0; i < wanted_count; i++) {
        const double value = (double)sorted[(size_t)(wanted[i] * (double)(count - 1))];
        const double edge = unit > 0.0 ? (floor(value / unit) + 0.5) * unit : value;
        if (edge < last && (tiles->edge_count == 0 || edge > tiles->edges[tiles->edge_count - 1]))
            tiles->edges[tiles->edge_count++] = edge;
    }
    if (isfinite(last))
        tiles->edges[tiles->edge_count++] = last;
    free(sorted);
    return SONJECT_OK;
}

static size_t cell_of(const struct plain_tiles *tiles, double value)
{
    size_t low = 0, high = tiles->edge_count; /* high: first edge not below the value */
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (tiles->edges[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static sonject_status fill_cells(struct plain_tiles *tiles, struct report *report,
                                 const struct stored_swath *swath)
{
    const size_t cells = tiles->edge_count + 1, pixels = tiles->side * tiles->side;
    float values[TILE_SIDE * TILE_SIDE];
    tiles->counts = allocate_array(tiles->count, cells * sizeof *tiles->counts);
    CHECK_MEMORY(report, tiles->counts, "a calibration");
    for (size_t i = 0; i < tiles->count; i++) {
        copy_part(swath, tiles->rows[i], tiles->columns[i], tiles->side, tiles->side, values);
        for (size_t k = 0; k < pixels; k++)
            tiles->counts[i * cells + cell_of(tiles, (double)values[k])]++;
    }
    return SONJECT_OK;
}

sonject_status plain_tiles_init(struct plain_tiles *tiles, struct report *report,
                                const struct stored_swath *swath, const struct first_returns *water,
                                const size_t grain[2], double ceiling)
{
    memset(tiles, 0, sizeof *tiles);
    tiles->side = TILE_SIDE;
    if (swath->rows / TILE_SIDE * (swath->columns / TILE_SIDE) < TILES_FEW)
        tiles->side = TILE_SIDE_SMALL;
    size_t count;
    struct candidate *list = find_candidates(swath, water, tiles->side, grain, ceiling, &count);
    CHECK_MEMORY(report, list, "a calibration");
    qsort(list, count, sizeof *list, compare_candidates);
    const size_t plain = count < TILES_FEW ? count : count / 2 < TILES_FEW ? TILES_FEW : count / 2;
    qsort(list, plain, sizeof *list, compare_places);
    tiles->count = plain < TILES_MOST ? plain : TILES_MOST;
    tiles->rows = allocate_array(tiles->count, sizeof *tiles->rows);
    tiles->columns = allocate_array(tiles->count, sizeof *tiles->columns);
    tiles->unevenness = allocate_array(tiles->count, sizeof *tiles->unevenness);
    sonject_status status = tiles->rows && tiles->columns && tiles->unevenness
                                ? SONJECT_OK
                                : report_out_of_memory(report, "a calibration");
    for (size_t i = 0; status == SONJECT_OK && i < tiles->count; i++) {
        tiles->rows[i] = list[i * plain / tiles->count].row;
        tiles->columns[i] = list[i * plain / tiles->count].column;
        tiles->unevenness[i] = list[i * plain / tiles->count].unevenness;
    }
    free(list);
    if (status == SONJECT_OK && tiles->count > 0)
        status = choose_edges(tiles, report, swath, ceiling);
    if (status == SONJECT_OK && tiles->count > 0)
        status = fill_cells(tiles, report, swath);
    if (status != SONJECT_OK)
        plain_tiles_clear(tiles);
    return status;
}

void plain_tiles_clear(struct plain_tiles *tiles)
{
    free(tiles->rows);
    free(tiles->columns);
    free(tiles->unevenness);
    free(tiles->counts);
    memset(tiles, 0, sizeof *tiles);
}

/* ---- The curve from the amplitude contrast of the plain tiles alone, for swaths whose numbers
 * follow no law of speckle. */

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
