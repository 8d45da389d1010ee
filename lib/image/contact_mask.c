#include "image/contact_mask.h"

#include <stdbool.h>
#include <string.h>

#define PART_SEEN 128 /* of an area that is not the largest */

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

/* One search: what does not change while areas are filled. */
struct area_search {
    const float *means, *intensity;
    size_t columns;
    const struct window_box *box;
    enum contact_part part;
    double threshold;
    uint8_t *marks;
    size_t *stack;
};

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
    const struct window_box *box = search->box;
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

struct contact_area mark_largest_area(const float *means, const float *intensity, size_t columns,
                                      const struct window_box *box, enum contact_part part,
                                      double threshold, uint8_t *marks, size_t *stack)
{
    const struct area_search search = {means, intensity, columns, box,
                                       part,  threshold, marks,   stack};
    struct contact_area best;
    size_t best_start = 0;
    memset(&best, 0, sizeof best);
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t column = box->first_column; column < box->first_column + box->columns;
             column++) {
            const size_t i = row * columns + column;
            if (!is_wanted(&search, i, PART_NONE))
                continue;
            const struct contact_area area = fill_area(&search, i, PART_NONE, PART_SEEN);
            if (part == PART_HIGHLIGHT ? area.energy > best.energy : area.pixels > best.pixels) {
                best = area;
                best_start = i;
            }
        }
    if (best.pixels > 0)
        fill_area(&search, best_start, PART_SEEN, (uint8_t)part);
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t column = box->first_column; column < box->first_column + box->columns; column++)
            if (marks[row * columns + column] == PART_SEEN)
                marks[row * columns + column] = PART_NONE;
    return best;
}
