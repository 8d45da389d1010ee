#include "image/contact_ruler.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define SEABED_MARGIN 24 /* pixels around the box that are taken for seabed */
#define SEABED_BLOCK  6  /* pixels on a side, of whose means the median is taken */
#define EDGE_REACH    8  /* pixels beyond a part in which its edge is looked for */
#define PIECE_GAP     6  /* pixels between pieces of one highlight, at most */
#define PIECES_MAX    32
/* Of the highlight over the seabed, where its profiles are cut off: an edge then lies at half of
 * it, and fainter faces count. */
#define HIGHLIGHT_FRACTION 0.3
/* Of the seabed, where a shadow's profiles are cut off, so that its edges lie at 0.6 of it: the
 * tail of the echo before it makes it look shorter, most at low thresholds. */
#define SHADOW_FRACTION 1.2

/* The image, and what is made of it. */
struct ruler {
    const float *intensity;
    size_t rows, columns;
    double seabed;
    /* Lines in range that are looked at together begin so many columns later a row, counted from a
     * middle row: along a highlight that lies askew. */
    double slant, middle_row;
};

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

static int by_size(const void *a, const void *b)
{
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return (x > y) - (x < y);
}

static struct window_box widen(const struct ruler *ruler, const struct window_box *box,
                               size_t margin)
{
    struct window_box wide;
    wide.first_row = box->first_row > margin ? box->first_row - margin : 0;
    wide.first_column = box->first_column > margin ? box->first_column - margin : 0;
    wide.rows = smaller(box->first_row + box->rows + margin, ruler->rows) - wide.first_row;
    wide.columns =
        smaller(box->first_column + box->columns + margin, ruler->columns) - wide.first_column;
    return wide;
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

static bool overlap(const struct window_box *a, const struct window_box *b)
{
    return a->first_row < b->first_row + b->rows && b->first_row < a->first_row + a->rows &&
           a->first_column < b->first_column + b->columns &&
           b->first_column < a->first_column + a->columns;
}

/* Of the pixels of the box, slanted, that are inside the image; NaN if none is. */
static double mean_in(const struct ruler *ruler, const struct window_box *box)
{
    double sum = 0.0;
    size_t count = 0;
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++) {
        const long shift = lround(ruler->slant * ((double)row - ruler->middle_row));
        for (size_t k = 0; k < box->columns; k++) {
            const long column = (long)(box->first_column + k) + shift;
            if (column < 0 || column >= (long)ruler->columns)
                continue;
            sum += (double)ruler->intensity[row * ruler->columns + (size_t)column];
            count++;
        }
    }
    return sum / (double)count;
}

/* The median of blocks around the box, and within it too if none is around: stones and other
 * shadows there do not count. A mean of 36 exponential values has its median 1 % below its mean. */
static sonject_status find_seabed(struct ruler *ruler, struct report *report,
                                  const struct window_box *box)
{
    const struct window_box wide = widen(ruler, box, SEABED_MARGIN);
    const size_t most = (wide.rows / SEABED_BLOCK) * (wide.columns / SEABED_BLOCK);
    float *means = allocate_array(most + 1, sizeof *means);
    size_t count = 0;
    if (!means)
        return report_out_of_memory(report, "the seabed's level");
    for (int takes_all = 0; takes_all < 2 && count == 0; takes_all++)
        for (size_t row = 0; row + SEABED_BLOCK <= wide.rows; row += SEABED_BLOCK)
            for (size_t column = 0; column + SEABED_BLOCK <= wide.columns; column += SEABED_BLOCK) {
                const struct window_box block = {wide.first_row + row, wide.first_column + column,
                                                 SEABED_BLOCK, SEABED_BLOCK};
                if (takes_all || !overlap(&block, box))
                    means[count++] = (float)mean_in(ruler, &block);
            }
    qsort(means, count, sizeof *means, by_size);
    ruler->seabed = count > 0 ? (double)means[count / 2] : mean_in(ruler, &wide);
    free(means);
    return ruler->seabed > 0.0
               ? SONJECT_OK
               : report_failure(report, SONJECT_ERROR_INPUT,
                                "the image is dark around row %zu, column %zu: there is no seabed "
                                "to measure a contact against",
                                box->first_row, box->first_column);
}

/* Mean intensity across a box, for each of its rows or columns. */
static double profile_at(const struct ruler *ruler, const struct window_box *box, bool is_along,
                         size_t index)
{
    struct window_box line = *box;
    if (is_along) {
        line.first_row = index;
        line.rows = 1;
    } else {
        line.first_column = index;
        line.columns = 1;
    }
    return mean_in(ruler, &line);
}

/* How far a line of the profile is from the level `inner` (0) to `outer` (1, either may be the
 * larger one); values beyond the levels are cut to them. */
static double outer_share(const struct ruler *ruler, const struct window_box *box, bool is_along,
                          size_t index, const double levels[2])
{
    const double share =
        (profile_at(ruler, box, is_along, index) - levels[0]) / (levels[1] - levels[0]);
    return fmin(fmax(share, 0.0), 1.0);
}

/* Where a profile steps from levels[0] to levels[1], from `start` in steps of `step` for at most
 * `count` pixels: the edge with the least sum of squares, and around it where the profile passes
 * half way. In pixels from start's centre; half a pixel before it if the step is there already. */
static double find_edge(const struct ruler *ruler, const struct window_box *box, bool is_along,
                        size_t start, int step, size_t count, const double levels[2])
{
    double cost = 0.0; /* of an edge behind pixel k, over that of one before pixel 0 */
    double best = 0.0;
    double share_before = 0.0; /* of the pixels on both sides of the best edge */
    double share_behind = 1.0;
    size_t edge = 0;
    for (size_t k = 0; k < count; k++) {
        const size_t index = step > 0 ? start + k : start - k;
        const double share = outer_share(ruler, box, is_along, index, levels);
        cost += share * share - (1.0 - share) * (1.0 - share);
        if (k == edge)
            share_behind = share;
        if (cost < best) {
            best = cost;
            edge = k + 1;
            share_before = share;
            share_behind = 1.0;
        }
    }
    if (edge == 0)
        return -0.5;
    return (double)edge - 1.0 + (0.5 - share_before) / (share_behind - share_before);
}

/* Pixels from `start` to an end of the image in a direction, start's included, at most `most`. */
static size_t room(size_t start, int step, size_t size, size_t most)
{
    return smaller(step > 0 ? size - start : start + 1, most);
}

/* From edge to edge through the middle of the part, across the lines of `across`. */
static double length_between_edges(const struct ruler *ruler, const struct window_box *part,
                                   const struct window_box *across, bool is_along, double inner,
                                   double outer)
{
    const double levels[2] = {inner, outer};
    const size_t first = is_along ? part->first_row : part->first_column;
    const size_t extent = is_along ? part->rows : part->columns;
    const size_t size = is_along ? ruler->rows : ruler->columns;
    const size_t middle = first + extent / 2;
    const size_t reach = extent / 2 + EDGE_REACH + 1;
    const double length =
        find_edge(ruler, across, is_along, middle, 1, room(middle, 1, size, reach), levels) +
        find_edge(ruler, across, is_along, middle, -1, room(middle, -1, size, reach), levels);
    return fmax(0.0, length);
}

/* The middle third of a part's rows, at least one. */
static struct window_box middle_rows(const struct window_box *part)
{
    struct window_box middle = *part;
    middle.rows = (part->rows + 2) / 3;
    middle.first_row = part->first_row + (part->rows - middle.rows) / 2;
    return middle;
}

/* The straight line through the marked pixels of each row, all rows alike, as the ruler's slant;
 * *part gets the columns that they take at the middle row, as wide as the mean row. */
static void lie_along(struct ruler *ruler, const uint8_t *marks, const struct contact_area *area,
                      struct window_box *part)
{
    const double count = (double)area->pixels;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (size_t row = area->box.first_row; row < area->box.first_row + area->box.rows; row++)
        for (size_t k = 0; k < area->box.columns; k++) {
            const size_t column = area->box.first_column + k;
            if (marks[row * ruler->columns + column] != PART_HIGHLIGHT)
                continue;
            x += (double)row / count;
            y += (double)column / count;
            xx += (double)row * (double)row / count;
            xy += (double)row * (double)column / count;
        }
    const double width = count / (double)area->box.rows;
    ruler->slant = xx - x * x > 0.0 ? (xy - x * y) / (xx - x * x) : 0.0;
    ruler->middle_row = x;
    *part = area->box;
    part->first_column = (size_t)fmax(0.0, floor(y - 0.5 * width + 0.5));
    part->columns = (size_t)(width + 0.5) > 0 ? (size_t)(width + 0.5) : 1;
}

/* Leaves the ruler lying along the highlight. */
static void measure_highlight(struct ruler *ruler, const uint8_t *marks,
                              struct contact_sizes *sizes)
{
    struct window_box along;
    lie_along(ruler, marks, &sizes->highlight, &along);
    const struct window_box *part = &along;
    const struct window_box middle = middle_rows(part);
    const double level = sizes->seabed * (1.0 - HIGHLIGHT_FRACTION) +
                         HIGHLIGHT_FRACTION * fmax(sizes->seabed, mean_in(ruler, &middle));
    sizes->highlight_intensity = sizes->highlight.energy / (double)sizes->highlight.pixels;
    sizes->highlight_rows = length_between_edges(ruler, part, part, true, level, sizes->seabed);
    sizes->highlight_columns =
        length_between_edges(ruler, part, &middle, false, level, sizes->seabed);
}

static void measure_shadow(const struct ruler *ruler, struct contact_sizes *sizes)
{
    const struct window_box *part = &sizes->shadow.box;
    const struct window_box middle = middle_rows(part);
    struct window_box heart = middle; /* of the columns likewise */
    heart.columns = (part->columns + 2) / 3;
    heart.first_column = part->first_column + (part->columns - heart.columns) / 2;
    struct window_box core = *part;
    core.first_column = heart.first_column;
    core.columns = heart.columns;
    const double dark = fmin(mean_in(ruler, &heart), SHADOW_UNDER_SEABED * sizes->seabed);
    const double bright = SHADOW_FRACTION * sizes->seabed;
    sizes->shadow_intensity = sizes->shadow.energy / (double)sizes->shadow.pixels;
    sizes->shadow_columns = length_between_edges(ruler, part, &middle, false, dark, bright);
    sizes->shadow_rows = length_between_edges(ruler, part, &core, true, dark, bright);
}

static struct window_box common_box(const struct window_box *a, const struct window_box *b)
{
    struct window_box box;
    const size_t last_row = larger(a->first_row + a->rows, b->first_row + b->rows);
    const size_t last_column = larger(a->first_column + a->columns, b->first_column + b->columns);
    box.first_row = smaller(a->first_row, b->first_row);
    box.first_column = smaller(a->first_column, b->first_column);
    box.rows = last_row - box.first_row;
    box.columns = last_column - box.first_column;
    return box;
}

static struct window_box box_within(const struct window_box *a, const struct window_box *b)
{
    struct window_box box;
    box.first_row = larger(a->first_row, b->first_row);
    box.first_column = larger(a->first_column, b->first_column);
    box.rows = smaller(a->first_row + a->rows, b->first_row + b->rows) - box.first_row;
    box.columns =
        smaller(a->first_column + a->columns, b->first_column + b->columns) - box.first_column;
    return box;
}

/* The brightest area, and those near it that speckle has cut off. */
static void find_highlight(const struct ruler *ruler, const float *means,
                           const struct window_box *box, double threshold, uint8_t *marks,
                           size_t *stack, struct contact_area *highlight)
{
    *highlight = mark_largest_area(means, ruler->intensity, ruler->columns, box, PART_HIGHLIGHT,
                                   threshold, marks, stack);
    for (int piece = 0; highlight->pixels > 0 && piece < PIECES_MAX; piece++) {
        const struct window_box wide = widen(ruler, &highlight->box, PIECE_GAP);
        const struct window_box near = box_within(&wide, box);
        const struct contact_area area =
            mark_largest_area(means, ruler->intensity, ruler->columns, &near, PART_HIGHLIGHT,
                              threshold, marks, stack);
        if (area.pixels == 0)
            return;
        highlight->box = common_box(&highlight->box, &area.box);
        highlight->pixels += area.pixels;
        highlight->energy += area.energy;
    }
}

/* The highlight, and the shadow that lies beyond its near edge and beside it in the same rows. */
static void find_parts(const struct ruler *ruler, const float *means, const struct window_box *box,
                       uint8_t *marks, size_t *stack, struct contact_sizes *sizes)
{
    double peak = 0.0;
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t column = box->first_column; column < box->first_column + box->columns; column++)
            peak = fmax(peak, (double)means[row * ruler->columns + column]);
    const double threshold =
        fmax(HIGHLIGHT_OVER_SEABED * ruler->seabed, HIGHLIGHT_UNDER_PEAK * peak);
    find_highlight(ruler, means, box, threshold, marks, stack, &sizes->highlight);
    struct window_box beyond = *box;
    if (sizes->highlight.pixels > 0) {
        beyond.first_column = sizes->highlight.box.first_column;
        beyond.columns -= beyond.first_column - box->first_column;
        const size_t last = box->first_row + box->rows;
        const size_t reach = sizes->highlight.box.rows / 2 + EDGE_REACH;
        const struct window_box near = widen(ruler, &sizes->highlight.box, reach);
        beyond.first_row = near.first_row > box->first_row ? near.first_row : box->first_row;
        beyond.rows = smaller(near.first_row + near.rows, last) - beyond.first_row;
    }
    sizes->shadow = mark_largest_area(means, ruler->intensity, ruler->columns, &beyond, PART_SHADOW,
                                      SHADOW_UNDER_SEABED * ruler->seabed, marks, stack);
}

sonject_status measure_contact_sizes(struct report *report, const float *intensity, size_t rows,
                                     size_t columns, const struct window_box *box, uint8_t *marks,
                                     struct contact_sizes *sizes)
{
    struct ruler ruler = {intensity, rows, columns, 0.0, 0.0, 0.0};
    float *means = allocate_array(rows * columns, sizeof *means);
    size_t *stack = allocate_array(box->rows * box->columns, sizeof *stack);
    memset(sizes, 0, sizeof *sizes);
    memset(marks, PART_NONE, rows * columns);
    sizes->highlight_rows = sizes->highlight_columns = sizes->highlight_intensity = NAN;
    sizes->shadow_rows = sizes->shadow_columns = sizes->shadow_intensity = NAN;
    sonject_status status =
        means && stack ? SONJECT_OK : report_out_of_memory(report, "a contact's measures");
    if (status == SONJECT_OK)
        status = find_seabed(&ruler, report, box);
    if (status == SONJECT_OK) {
        mean_of_neighbours(intensity, rows, columns, means);
        sizes->seabed = ruler.seabed;
        find_parts(&ruler, means, box, marks, stack, sizes);
        if (sizes->highlight.pixels > 0)
            measure_highlight(&ruler, marks, sizes);
        if (sizes->shadow.pixels > 0)
            measure_shadow(&ruler, sizes);
    }
    free(means);
    free(stack);
    return status;
}
