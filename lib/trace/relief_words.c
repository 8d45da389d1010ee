#include "trace/relief_words.h"

#include <math.h>
#include <string.h>

#include "kernels/relief_records.h"

#define MARGIN_M 1.0e-3 /* beyond the heights, so that rays cross them all between the bounds */

typedef char relief_record_is_packed[sizeof(struct relief_record) == 8 * 4 ? 1 : -1];

static size_t blocks_of(uint32_t points)
{
    return (points - 1 + RELIEF_BLOCK - 1) / RELIEF_BLOCK;
}

size_t relief_word_count(const struct relief *relief)
{
    return sizeof(struct relief_record) / 4 + 3 * (size_t)relief->rows * relief->columns +
           2 * blocks_of(relief->rows) * blocks_of(relief->columns);
}

/* Highest and lowest point of the cells of a block, edges included. */
static void block_bounds(const struct relief *relief, size_t block_row, size_t block_column,
                         float bounds[2])
{
    const size_t first_row = block_row * RELIEF_BLOCK;
    const size_t first_column = block_column * RELIEF_BLOCK;
    bounds[0] = -INFINITY;
    bounds[1] = INFINITY;
    for (size_t row = first_row; row <= first_row + RELIEF_BLOCK && row < relief->rows; row++)
        for (size_t column = first_column;
             column <= first_column + RELIEF_BLOCK && column < relief->columns; column++) {
            const float height = relief->heights[row * relief->columns + column];
            bounds[0] = fmaxf(bounds[0], height);
            bounds[1] = fminf(bounds[1], height);
        }
}

void relief_words_init(uint32_t *words, const struct relief *relief)
{
    const size_t points = (size_t)relief->rows * relief->columns;
    struct relief_record record;
    memset(&record, 0, sizeof record);
    record.rows = (int32_t)relief->rows;
    record.columns = (int32_t)relief->columns;
    record.block_rows = (int32_t)blocks_of(relief->rows);
    record.block_columns = (int32_t)blocks_of(relief->columns);
    record.rows_per_metre = (float)(1.0 / relief->row_step_m);
    record.columns_per_metre = (float)(1.0 / relief->column_step_m);
    record.lowest = (float)(relief->lowest_m - MARGIN_M);
    record.highest = (float)(relief->highest_m + MARGIN_M);
    memcpy(words, &record, sizeof record);
    words += sizeof record / 4;
    memcpy(words, relief->heights, points * sizeof(float));
    memcpy(words + points, relief->slopes, 2 * points * sizeof(float));
    words += 3 * points;
    for (size_t row = 0; row < (size_t)record.block_rows; row++)
        for (size_t column = 0; column < (size_t)record.block_columns; column++, words += 2) {
            float bounds[2];
            block_bounds(relief, row, column, bounds);
            memcpy(words, bounds, sizeof bounds);
        }
}
