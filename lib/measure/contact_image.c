/* The level of an image's seabed, the pixels of a contact's highlight and shadow, and how clearly
 * they stand out. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "measure/contacts.h"
#include "measure/first_return.h"

#define PART_SEEN 128 /* mark of an area that is not the largest */

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

/* Fills the means over 3 x 3 pixels, fewer at the image's edges. */
static void mean_of_neighbours(const float *intensity, size_t rows, size_t columns, float *mean)
{
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++) {
            const size_t low_row = row > 0 ? row - 1 : 0;
            const size_t low = column > 0 ? column - 1 : 0;
            double sum = 0.0;
            int count = 0;
            for (size_t r = low_row; r <= row + 1 && r < rows; r++)
                for (size_t c = low; c <= column + 1 && c < columns; c++) {
                    sum += (double)intensity[r * columns + c];
                    count++;
                }
            mean[row * columns + column] = (float)(sum / count);
        }
}

sonject_box box_with_margin(const sonject_box *box, size_t margin, size_t rows, size_t columns)
{
    sonject_box wide;
    wide.first_row = box->first_row > margin ? box->first_row - margin : 0;
    wide.first_column = box->first_column > margin ? box->first_column - margin : 0;
    wide.rows = smaller_size(box->first_row + box->rows + margin, rows) - wide.first_row;
    wide.columns =
        smaller_size(box->first_column + box->columns + margin, columns) - wide.first_column;
    return wide;
}

/* Returns the box from the first row and column to before the last ones. */
static sonject_box box_of_limits(size_t first_row, size_t first_column, size_t last_row,
                                 size_t last_column)
{
    const sonject_box box = {first_row, first_column, last_row - first_row,
                             last_column - first_column};
    return box;
}

sonject_box box_around(const sonject_box *a, const sonject_box *b)
{
    return box_of_limits(smaller_size(a->first_row, b->first_row),
                         smaller_size(a->first_column, b->first_column),
                         larger(a->first_row + a->rows, b->first_row + b->rows),
                         larger(a->first_column + a->columns, b->first_column + b->columns));
}

sonject_box box_around_parts(const sonject_box *highlight, const sonject_box *shadow)
{
    return highlight->rows == 0 ? *shadow
           : shadow->rows == 0  ? *highlight
                                : box_around(highlight, shadow);
}

/* Returns the intersection of two boxes, which must overlap. */
static sonject_box box_within(const sonject_box *a, const sonject_box *b)
{
    return box_of_limits(larger(a->first_row, b->first_row),
                         larger(a->first_column, b->first_column),
                         smaller_size(a->first_row + a->rows, b->first_row + b->rows),
                         smaller_size(a->first_column + a->columns, b->first_column + b->columns));
}

static bool boxes_overlap(const sonject_box *a, const sonject_box *b)
{
    return a->first_row < b->first_row + b->rows && b->first_row < a->first_row + a->rows &&
           a->first_column < b->first_column + b->columns &&
           b->first_column < a->first_column + a->columns;
}

/* A search for areas in `box` whose means are above the threshold, or below it for a shadow. */
struct area_search {
    const float *means, *intensity; /* the image's */
    size_t columns;                 /* the image's */
    sonject_box box;
    size_t start_columns; /* first columns of the box; an area must have a pixel in them */
    enum contact_part part;
    double threshold;
    uint8_t *marks; /* the image's; pixels with other marks than 0 belong to no area */
    size_t *stack;  /* box.rows * box.columns places */
};

static bool is_wanted(const struct area_search *search, size_t i, uint8_t mark)
{
    const double mean = (double)search->means[i];
    return search->marks[i] == mark &&
           (search->part == PART_HIGHLIGHT ? mean > search->threshold : mean < search->threshold);
}

/* Changes the marks of the area around a pixel from one value to another. */
static struct contact_area fill_area(const struct area_search *search, size_t start, uint8_t from,
                                     uint8_t to)
{
    const sonject_box *box = &search->box;
    struct contact_area area;
    size_t last_row = 0;
    size_t last_column = 0;
    size_t height = 0;
    memset(&area, 0, sizeof area);
    area.box.first_row = start / search->columns;
    area.box.first_column = start % search->columns;
    search->marks[start] = to;
    search->stack[height++] = start;
    while (height > 0) {
        const size_t i = search->stack[--height];
        const size_t row = i / search->columns;
        const size_t column = i % search->columns;
        const size_t next[4] = {i - search->columns, i + search->columns, i - 1, i + 1};
        const bool is_inside[4] = {row > box->first_row, row + 1 < box->first_row + box->rows,
                                   column > box->first_column,
                                   column + 1 < box->first_column + box->columns};
        area.pixels++;
        area.energy += (double)search->intensity[i];
        area.box.first_row = row < area.box.first_row ? row : area.box.first_row;
        area.box.first_column = column < area.box.first_column ? column : area.box.first_column;
        last_row = row > last_row ? row : last_row;
        last_column = column > last_column ? column : last_column;
        for (int k = 0; k < 4; k++)
            if (is_inside[k] && is_wanted(search, next[k], from)) {
                search->marks[next[k]] = to;
                search->stack[height++] = next[k];
            }
    }
    area.box.rows = last_row - area.box.first_row + 1;
    area.box.columns = last_column - area.box.first_column + 1;
    return area;
}

/* Marks the area of most energy as the part, or for a shadow the area of most pixels. */
static struct contact_area mark_largest_area(const struct area_search *search)
{
    const sonject_box *box = &search->box;
    struct contact_area best;
    size_t best_start = 0;
    memset(&best, 0, sizeof best);
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < smaller_size(search->start_columns, box->columns); k++) {
            const size_t i = row * search->columns + box->first_column + k;
            if (!is_wanted(search, i, PART_NONE))
                continue;
            const struct contact_area area = fill_area(search, i, PART_NONE, PART_SEEN);
            if (search->part == PART_HIGHLIGHT ? area.energy > best.energy
                                               : area.pixels > best.pixels) {
                best = area;
                best_start = i;
            }
        }
    if (best.pixels > 0)
        fill_area(search, best_start, PART_SEEN, (uint8_t)search->part);
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < box->columns; k++) {
            uint8_t *mark = &search->marks[row * search->columns + box->first_column + k];
            *mark = *mark == PART_SEEN ? PART_NONE : *mark;
        }
    return best;
}

#define BLOCK                                                                                      \
    6 /* pixels on a side. The median of a mean of 36 exponential values is 1 % below the mean */

sonject_status contact_image_create(struct contact_image *image, struct report *report,
                                    const float *intensity, size_t rows, size_t columns)
{
    size_t count;
    memset(image, 0, sizeof *image);
    image->intensity = intensity;
    image->rows = rows;
    image->columns = columns;
    if (size_multiply(rows, columns, &count)) {
        image->means = allocate_array(count, sizeof *image->means);
        image->marks = allocate_array(count, 1);
        image->taken = allocate_array(count, 1);
        image->seabed_columns = allocate_array(rows, sizeof *image->seabed_columns);
    }
    CHECK_MEMORY(report, image->means && image->marks && image->taken && image->seabed_columns,
                 "contacts' measures");
    mean_of_neighbours(intensity, rows, columns, image->means);
    const sonject_status status =
        find_first_return(report, intensity, rows, columns, image->seabed_columns);
    return status != SONJECT_OK
               ? status
               : measure_speckle(report, intensity, NULL, rows, columns, columns, &image->speckle);
}

void contact_image_clear(struct contact_image *image)
{
    free(image->means);
    free(image->marks);
    free(image->taken);
    free(image->seabed_columns);
    memset(image, 0, sizeof *image);
}

int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return (x > y) - (x < y);
}

static float mean_of_box(const struct contact_image *image, const sonject_box *box)
{
    double sum = 0.0;
    for (size_t row = 0; row < box->rows; row++)
        for (size_t column = 0; column < box->columns; column++)
            sum += (double)image->intensity[(box->first_row + row) * image->columns +
                                            box->first_column + column];
    return (float)(sum / ((double)box->rows * (double)box->columns));
}

/* Returns the median of the blocks of `wide` that touch neither `box` nor the water column, or a
 * negative number if there are none. */
static double level_beside(const struct contact_image *image, const sonject_box *wide,
                           const sonject_box *box, float *blocks)
{
    size_t count = 0;
    for (size_t row = 0; row + BLOCK <= wide->rows; row += BLOCK)
        for (size_t column = 0; column + BLOCK <= wide->columns; column += BLOCK) {
            const sonject_box block = {wide->first_row + row, wide->first_column + column, BLOCK,
                                       BLOCK};
            if (block.first_column >= image->seabed_columns[block.first_row] &&
                (!box || !boxes_overlap(&block, box)))
                blocks[count++] = mean_of_box(image, &block);
        }
    qsort(blocks, count, sizeof *blocks, compare_floats);
    return count > 0 ? (double)blocks[count / 2] : -1.0;
}

sonject_status find_seabed_level(const struct contact_image *image, struct report *report,
                                 const sonject_box *box, double *level)
{
    const sonject_box wide = box_with_margin(box, SEABED_MARGIN, image->rows, image->columns);
    float *blocks =
        allocate_array((wide.rows / BLOCK) * (wide.columns / BLOCK) + 1, sizeof *blocks);
    CHECK_MEMORY(report, blocks, "the seabed's level");
    *level = level_beside(image, &wide, box, blocks);
    if (*level < 0.0)
        *level = level_beside(image, &wide, NULL, blocks);
    if (*level < 0.0)
        *level = (double)mean_of_box(image, &wide);
    free(blocks);
    return SONJECT_OK;
}

#define ROWS_BESIDE   8 /* rows on either side of a highlight for its shadow, beside half its own */
#define SHADOW_PIXELS 9 /* fewest pixels: one mean of 3 x 3 pixels may be dark by chance */
#define COLUMNS_LEAST                                                                              \
    32 /* columns behind a highlight in which its shadow begins; twice its own if that is more */

/* Marks the brightest area, and areas near it that speckle has cut off. */
static struct contact_area mark_highlight(const struct contact_image *image,
                                          const struct area_search *search)
{
    struct contact_area highlight = mark_largest_area(search);
    for (int piece = 0; highlight.pixels > 0 && piece < PIECES_MAX; piece++) {
        const sonject_box wide =
            box_with_margin(&highlight.box, PIECE_GAP, image->rows, image->columns);
        struct area_search near = *search;
        near.box = box_within(&wide, &search->box);
        const struct contact_area area = mark_largest_area(&near);
        if (area.pixels == 0)
            break;
        highlight.box = box_around(&highlight.box, &area.box);
        highlight.pixels += area.pixels;
        highlight.energy += area.energy;
    }
    return highlight;
}

static double brightest_mean(const struct contact_image *image, const sonject_box *box)
{
    float brightest = 0.0f;
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < box->columns; k++)
            brightest =
                fmaxf(brightest, image->means[row * image->columns + box->first_column + k]);
    return (double)brightest;
}

static sonject_box beside(const struct contact_image *image, const sonject_box *bright,
                          const sonject_box *box)
{
    const sonject_box wide =
        box_with_margin(bright, bright->rows / 2 + ROWS_BESIDE, image->rows, image->columns);
    sonject_box beyond = box_within(&wide, box);
    beyond.first_column = bright->first_column;
    beyond.columns = box->first_column + box->columns - bright->first_column;
    return beyond;
}

/* Clears the marks of the last contact. */
static void begin_marks(struct contact_image *image, const sonject_box *box)
{
    const sonject_box *last = &image->marked;
    for (size_t row = last->first_row; row < last->first_row + last->rows; row++)
        memset(image->marks + row * image->columns + last->first_column, PART_NONE, last->columns);
    image->marked = *box;
}

static void keep_marks(struct contact_image *image, const sonject_box *box)
{
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < box->columns; k++) {
            const size_t i = row * image->columns + box->first_column + k;
            image->taken[i] |= image->marks[i];
        }
}

/* Marks the highlight. The caller frees search->stack. */
static sonject_status find_highlight(struct contact_image *image, struct report *report,
                                     const struct contact_place *place, double least,
                                     struct area_search *search, struct contact_area *highlight)
{
    const struct area_search bright = {image->means,  image->intensity, image->columns,
                                       place->bright, image->columns,   PART_HIGHLIGHT,
                                       0.0,           image->marks,     NULL};
    *search = bright;
    search->stack = allocate_array(place->box.rows, place->box.columns * sizeof *search->stack);
    CHECK_MEMORY(report, search->stack, "a contact's measures");
    begin_marks(image, &place->box);
    search->threshold = fmax(least, HIGHLIGHT_UNDER_PEAK * brightest_mean(image, &place->bright));
    *highlight = mark_highlight(image, search);
    return SONJECT_OK;
}

sonject_status find_contact_highlight(struct contact_image *image, struct report *report,
                                      const struct contact_place *place, double least,
                                      struct contact_area *highlight)
{
    struct area_search search;
    CHECK(find_highlight(image, report, place, least, &search, highlight));
    free(search.stack);
    return SONJECT_OK;
}

sonject_status find_contact_parts(struct contact_image *image, struct report *report,
                                  const struct contact_place *place, double seabed,
                                  struct contact_area *highlight, struct contact_area *shadow)
{
    struct area_search search;
    CHECK(find_highlight(image, report, place, HIGHLIGHT_OVER_SEABED * seabed, &search, highlight));
    search.box = place->box;
    search.part = PART_SHADOW;
    search.threshold = SHADOW_UNDER_SEABED * seabed;
    if (highlight->pixels > 0) {
        const size_t columns = 2 * highlight->box.columns;
        search.box = beside(image, &highlight->box, &place->box);
        if (place->is_near)
            search.start_columns =
                highlight->box.columns + (columns > COLUMNS_LEAST ? columns : COLUMNS_LEAST);
    }
    *shadow = mark_largest_area(&search);
    if (shadow->pixels < SHADOW_PIXELS)
        memset(shadow, 0, sizeof *shadow);
    keep_marks(image, &place->box);
    free(search.stack);
    return SONJECT_OK;
}

/* ---- The contrast of a contact's parts to the seabed's speckle, as one who labels images sees it:
 * small means, as an eye takes them, against the highest and lowest such means nearby. */

#define GUARD       2   /* pixels around contacts that do not count as seabed */
#define WINDOWS_MIN 400 /* fewest windows of seabed: two lie beyond a quantile */

/* The extreme mean that is looked for. */
struct extreme {
    size_t column_reach; /* windows have 3 rows and 2 column_reach + 1 columns */
    double quantile;     /* quantile of the seabed's means */
    bool is_highest;
};

/* Returns whether the window around a pixel, with its guard, is in the image and all seabed. */
static bool is_seabed(const struct contact_image *image, size_t row, size_t column,
                      size_t column_reach)
{
    const size_t rows = 1 + GUARD;
    const size_t columns = column_reach + GUARD;
    if (row < rows || row + rows >= image->rows || column < columns ||
        column + columns >= image->columns)
        return false;
    for (size_t r = row - rows; r <= row + rows; r++) {
        if (column - columns < image->seabed_columns[r])
            return false;
        for (size_t c = column - columns; c <= column + columns; c++)
            if (image->taken[r * image->columns + c])
                return false;
    }
    return true;
}

/* Returns the mean of the window around a pixel; NaN where the window leaves the image. */
static double mean_about(const struct contact_image *image, size_t row, size_t column, size_t reach)
{
    double sum = 0.0;
    if (row < 1 || row + 1 >= image->rows || column < reach || column + reach >= image->columns)
        return NAN;
    for (size_t r = row - 1; r <= row + 1; r++)
        for (size_t c = column - reach; c <= column + reach; c++)
            sum += (double)image->intensity[r * image->columns + c];
    return sum / (double)(3 * (2 * reach + 1));
}

/* means: room for one number per pixel of the seabed's box. */
static double contrast_of(const struct contact_image *image, const sonject_box *seabed,
                          const sonject_box *part, const struct extreme *wanted, float *means)
{
    const size_t reach = wanted->column_reach;
    double found = NAN;
    size_t count = 0;
    for (size_t row = part->first_row; row < part->first_row + part->rows; row++)
        for (size_t k = 0; k < part->columns; k++) {
            const double mean = mean_about(image, row, part->first_column + k, reach);
            found = wanted->is_highest ? fmax(found, mean) : fmin(found, mean);
        }
    for (size_t row = seabed->first_row; row < seabed->first_row + seabed->rows; row++)
        for (size_t k = 0; k < seabed->columns; k++)
            if (is_seabed(image, row, seabed->first_column + k, reach))
                means[count++] = (float)mean_about(image, row, seabed->first_column + k, reach);
    if (count < WINDOWS_MIN)
        return NAN;
    qsort(means, count, sizeof *means, compare_floats);
    return 10.0 *
           log10(found / (double)means[(size_t)(wanted->quantile * (double)(count - 1) + 0.5)]);
}

sonject_status measure_visibility(const struct contact_image *image, struct report *report,
                                  const sonject_box *highlight, const sonject_box *shadow,
                                  struct contact_visibility *visibility)
{
    static const struct extreme brightest = {1, 0.995, true};
    static const struct extreme darkest = {3, 0.005, false};
    const sonject_box both = box_around_parts(highlight, shadow);
    const sonject_box seabed = box_with_margin(&both, SEABED_MARGIN, image->rows, image->columns);
    float *means = allocate_array(seabed.rows, seabed.columns * sizeof *means);
    CHECK_MEMORY(report, means, "the seabed about a contact");
    visibility->highlight_db = contrast_of(image, &seabed, highlight, &brightest, means);
    visibility->shadow_db = contrast_of(image, &seabed, shadow, &darkest, means);
    free(means);
    return SONJECT_OK;
}
