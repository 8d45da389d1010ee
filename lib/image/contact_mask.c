#include "image/contact_mask.h"

#include <string.h>

#define PART_SEEN 128 /* of an area that is not the largest */

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

void mean_of_neighbours(const float *intensity, size_t rows, size_t columns, float *mean)
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

struct window_box box_with_margin(const struct window_box *box, size_t margin, size_t rows,
                                  size_t columns)
{
    struct window_box wide;
    wide.first_row = box->first_row > margin ? box->first_row - margin : 0;
    wide.first_column = box->first_column > margin ? box->first_column - margin : 0;
    wide.rows = smaller(box->first_row + box->rows + margin, rows) - wide.first_row;
    wide.columns = smaller(box->first_column + box->columns + margin, columns) - wide.first_column;
    return wide;
}

/* From the first of these rows and columns to before the last of those. */
static struct window_box box_of_limits(size_t first_row, size_t first_column, size_t last_row,
                                       size_t last_column)
{
    const struct window_box box = {first_row, first_column, last_row - first_row,
                                   last_column - first_column};
    return box;
}

struct window_box box_around(const struct window_box *a, const struct window_box *b)
{
    return box_of_limits(smaller(a->first_row, b->first_row),
                         smaller(a->first_column, b->first_column),
                         larger(a->first_row + a->rows, b->first_row + b->rows),
                         larger(a->first_column + a->columns, b->first_column + b->columns));
}

struct window_box box_within(const struct window_box *a, const struct window_box *b)
{
    return box_of_limits(larger(a->first_row, b->first_row),
                         larger(a->first_column, b->first_column),
                         smaller(a->first_row + a->rows, b->first_row + b->rows),
                         smaller(a->first_column + a->columns, b->first_column + b->columns));
}

bool boxes_overlap(const struct window_box *a, const struct window_box *b)
{
    return a->first_row < b->first_row + b->rows && b->first_row < a->first_row + a->rows &&
           a->first_column < b->first_column + b->columns &&
           b->first_column < a->first_column + a->columns;
}

static bool is_wanted(const struct area_search *search, size_t i, uint8_t mark)
{
    const double mean = (double)search->means[i];
    return search->marks[i] == mark &&
           (search->part == PART_HIGHLIGHT ? mean > search->threshold : mean < search->threshold);
}

/* Turns the marks of the area around a pixel from one value to another. */
static struct contact_area fill_area(const struct area_search *search, size_t start, uint8_t from,
                                     uint8_t to)
{
    const struct window_box *box = &search->box;
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

struct contact_area mark_largest_area(const struct area_search *search)
{
    const struct window_box *box = &search->box;
    struct contact_area best;
    size_t best_start = 0;
    memset(&best, 0, sizeof best);
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < smaller(search->start_columns, box->columns); k++) {
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
