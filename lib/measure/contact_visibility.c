/* The contrast of a contact's parts to the seabed's speckle, as one who labels images sees it:
 * small means, as an eye takes them, against the highest and lowest such means nearby. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "measure/contacts.h"

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
static double contrast_of(const struct contact_image *image, const struct window_box *seabed,
                          const struct window_box *part, const struct extreme *wanted, float *means)
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
                                  const struct window_box *highlight,
                                  const struct window_box *shadow,
                                  struct contact_visibility *visibility)
{
    static const struct extreme brightest = {1, 0.995, true};
    static const struct extreme darkest = {3, 0.005, false};
    const struct window_box both = highlight->rows == 0 ? *shadow
                                   : shadow->rows == 0  ? *highlight
                                                        : box_around(highlight, shadow);
    const struct window_box seabed =
        box_with_margin(&both, SEABED_MARGIN, image->rows, image->columns);
    float *means = allocate_array(seabed.rows, seabed.columns * sizeof *means);
    CHECK_MEMORY(report, means, "the seabed about a contact");
    visibility->highlight_db = contrast_of(image, &seabed, highlight, &brightest, means);
    visibility->shadow_db = contrast_of(image, &seabed, shadow, &darkest, means);
    free(means);
    return SONJECT_OK;
}
