#include "image/contact_image.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/first_return.h"

#define BLOCK                                                                                      \
    6 /* pixels on a side. A mean of 36 exponential values has its median 1 %                      \
         below its mean */

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

static int by_size(const void *a, const void *b)
{
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return (x > y) - (x < y);
}

static float mean_of_box(const struct contact_image *image, const struct window_box *box)
{
    double sum = 0.0;
    for (size_t row = 0; row < box->rows; row++)
        for (size_t column = 0; column < box->columns; column++)
            sum += (double)image->intensity[(box->first_row + row) * image->columns +
                                            box->first_column + column];
    return (float)(sum / ((double)box->rows * (double)box->columns));
}

size_t seabed_blocks(const struct window_box *box)
{
    return (box->rows / BLOCK) * (box->columns / BLOCK) + 1;
}

/* The median of the blocks of a box that do not overlap another one or the water column; negative
 * if there are none. */
static double level_beside(const struct contact_image *image, const struct window_box *wide,
                           const struct window_box *box, float *blocks)
{
    size_t count = 0;
    for (size_t row = 0; row + BLOCK <= wide->rows; row += BLOCK)
        for (size_t column = 0; column + BLOCK <= wide->columns; column += BLOCK) {
            const struct window_box block = {wide->first_row + row, wide->first_column + column,
                                             BLOCK, BLOCK};
            if (block.first_column >= image->seabed_columns[block.first_row] &&
                (!box || !boxes_overlap(&block, box)))
                blocks[count++] = mean_of_box(image, &block);
        }
    qsort(blocks, count, sizeof *blocks, by_size);
    return count > 0 ? (double)blocks[count / 2] : -1.0;
}

double level_within(const struct contact_image *image, const struct window_box *box, float *blocks)
{
    const double level = level_beside(image, box, NULL, blocks);
    return level >= 0.0 ? level : (double)mean_of_box(image, box);
}

sonject_status find_seabed_level(const struct contact_image *image, struct report *report,
                                 const struct window_box *box, double *level)
{
    const struct window_box wide = box_with_margin(box, SEABED_MARGIN, image->rows, image->columns);
    float *blocks = allocate_array(seabed_blocks(&wide), sizeof *blocks);
    CHECK_MEMORY(report, blocks, "the seabed's level");
    *level = level_beside(image, &wide, box, blocks);
    if (*level < 0.0)
        *level = level_within(image, &wide, blocks);
    free(blocks);
    return SONJECT_OK;
}
