#include "measure/measures.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"

#define NUMBER(name)                                                                               \
    {                                                                                              \
#name, offsetof(sonject_contact_measures, name)                                            \
    }

const struct contact_number contact_numbers[CONTACT_NUMBERS] = {
    NUMBER(highlight_along_pixels),
    NUMBER(highlight_range_pixels),
    NUMBER(shadow_along_pixels),
    NUMBER(shadow_range_pixels),
    NUMBER(highlight_along_m),
    NUMBER(highlight_range_m),
    NUMBER(shadow_along_m),
    NUMBER(shadow_range_m),
    NUMBER(axis_length_m),
    NUMBER(axis_width_m),
    NUMBER(axis_rad),
    NUMBER(highlight_db),
    NUMBER(shadow_db),
    NUMBER(seabed_db),
    NUMBER(highlight_contrast_db),
    NUMBER(shadow_contrast_db),
    NUMBER(seabed_shape),
    NUMBER(seabed_looks),
    NUMBER(row_length_pixels),
    NUMBER(column_length_pixels),
    NUMBER(gap_range_pixels),
    NUMBER(gap_range_m),
    NUMBER(dim_range_pixels),
    NUMBER(dim_range_m),
    NUMBER(highlight_along_error_pixels),
    NUMBER(highlight_range_error_pixels),
    NUMBER(shadow_along_error_pixels),
    NUMBER(shadow_range_error_pixels),
    NUMBER(gap_range_error_pixels),
    NUMBER(dim_range_error_pixels)};

static sonject_box public_box(const struct window_box *box)
{
    const sonject_box whole = {box->first_row, box->first_column, box->rows, box->columns};
    return whole;
}

static double decibels(double intensity)
{
    return intensity > 0.0 ? 10.0 * log10(intensity) : NAN;
}

/* A bar of uniform energy has the variance length^2 / 12 along itself. */
static void measure_axis(const float *intensity, size_t columns, const uint8_t *marks,
                         const struct contact_sizes *sizes, double row_spacing_m,
                         double column_spacing_m, sonject_contact_measures *measures)
{
    const struct window_box *box = &sizes->highlight.box;
    double sum = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double yy = 0.0;
    double xy = 0.0;
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t column = box->first_column; column < box->first_column + box->columns;
             column++) {
            const size_t i = row * columns + column;
            const double weight = marks[i] == PART_HIGHLIGHT ? (double)intensity[i] : 0.0;
            const double along = (double)(row - box->first_row) * row_spacing_m;
            const double range = (double)(column - box->first_column) * column_spacing_m;
            sum += weight;
            x += weight * along;
            y += weight * range;
            xx += weight * along * along;
            yy += weight * range * range;
            xy += weight * along * range;
        }
    const double vx = xx / sum - x / sum * (x / sum);
    const double vy = yy / sum - y / sum * (y / sum);
    const double vxy = xy / sum - x / sum * (y / sum);
    const double spread = hypot(0.5 * (vx - vy), vxy);
    measures->axis_rad = 0.5 * atan2(2.0 * vxy, vx - vy);
    measures->axis_length_m = sqrt(12.0 * fmax(0.0, 0.5 * (vx + vy) + spread));
    measures->axis_width_m = sqrt(12.0 * fmax(0.0, 0.5 * (vx + vy) - spread));
}

static void fill(const struct contact_sizes *sizes, double row_spacing_m, double column_spacing_m,
                 sonject_contact_measures *measures)
{
    const double row = row_spacing_m > 0.0 ? row_spacing_m : NAN;
    const double column = column_spacing_m > 0.0 ? column_spacing_m : NAN;
    measures->highlight = public_box(&sizes->highlight.box);
    measures->shadow = public_box(&sizes->shadow.box);
    measures->highlight_along_pixels = sizes->highlight_rows.pixels;
    measures->highlight_range_pixels = sizes->highlight_columns.pixels;
    measures->shadow_along_pixels = sizes->shadow_rows.pixels;
    measures->shadow_range_pixels = sizes->shadow_columns.pixels;
    measures->gap_range_pixels = sizes->gap_columns.pixels;
    measures->highlight_along_error_pixels = sizes->highlight_rows.error;
    measures->highlight_range_error_pixels = sizes->highlight_columns.error;
    measures->shadow_along_error_pixels = sizes->shadow_rows.error;
    measures->shadow_range_error_pixels = sizes->shadow_columns.error;
    measures->gap_range_error_pixels = sizes->gap_columns.error;
    measures->highlight_along_m = sizes->highlight_rows.pixels * row;
    measures->highlight_range_m = sizes->highlight_columns.pixels * column;
    measures->shadow_along_m = sizes->shadow_rows.pixels * row;
    measures->shadow_range_m = sizes->shadow_columns.pixels * column;
    measures->gap_range_m = sizes->gap_columns.pixels * column;
    measures->dim_range_pixels = sizes->dim_columns.pixels;
    measures->dim_range_m = sizes->dim_columns.pixels * column;
    measures->dim_range_error_pixels = sizes->dim_columns.error;
    measures->highlight_db = decibels(sizes->highlight_intensity);
    measures->shadow_db = decibels(sizes->shadow_intensity);
    measures->seabed_db = decibels(sizes->seabed);
    measures->highlight_contrast_db = measures->highlight_db - measures->seabed_db;
    measures->shadow_contrast_db = measures->shadow_db - measures->seabed_db;
}

/* Everything that is a number is not known yet. */
static void forget(sonject_contact_measures *measures)
{
    const double unknown = NAN;
    memset(measures, 0, sizeof *measures);
    measures->struct_size = sizeof *measures;
    for (size_t i = 0; i < CONTACT_NUMBERS; i++)
        memcpy((char *)measures + contact_numbers[i].offset, &unknown, sizeof unknown);
}

/* Whether an area touches an edge of the box around it. */
static bool is_cut_by(const struct contact_area *area, const struct window_box *box)
{
    const struct window_box *inner = &area->box;
    return area->pixels > 0 &&
           (inner->first_row == box->first_row || inner->first_column == box->first_column ||
            inner->first_row + inner->rows == box->first_row + box->rows ||
            inner->first_column + inner->columns == box->first_column + box->columns);
}

sonject_status check_spacings(struct report *report, double row_spacing_m, double column_spacing_m)
{
    const double spacings[2] = {row_spacing_m, column_spacing_m};
    for (int i = 0; i < 2; i++)
        if (!(spacings[i] >= 0.0 && spacings[i] <= 1e6))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "row and column spacing must be 0...1000 km");
    return SONJECT_OK;
}

sonject_status place_in_box(struct report *report, const sonject_box *box, size_t rows,
                            size_t columns, struct contact_place *place)
{
    if (box->first_row >= rows || box->rows > rows - box->first_row ||
        box->first_column >= columns || box->columns > columns - box->first_column ||
        box->rows == 0 || box->columns == 0)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "the box at row %llu, column %llu of %llu x %llu pixels is not inside "
            "the image of %zu x %zu",
            (unsigned long long)box->first_row, (unsigned long long)box->first_column,
            (unsigned long long)box->rows, (unsigned long long)box->columns, rows, columns);
    memset(place, 0, sizeof *place);
    place->box.first_row = (size_t)box->first_row;
    place->box.first_column = (size_t)box->first_column;
    place->box.rows = (size_t)box->rows;
    place->box.columns = (size_t)box->columns;
    place->bright = place->box;
    return SONJECT_OK;
}

sonject_status contact_measure(struct report *report, struct contact_image *image,
                               const struct contact_place *place, double row_spacing_m,
                               double column_spacing_m, sonject_contact_measures *measures)
{
    struct contact_sizes sizes;
    forget(measures);
    CHECK(measure_contact_sizes(image, report, place, &sizes));
    fill(&sizes, row_spacing_m, column_spacing_m, measures);
    measures->box = public_box(&place->box);
    measures->is_cut =
        is_cut_by(&sizes.highlight, &place->box) || is_cut_by(&sizes.shadow, &place->box);
    if (sizes.highlight.pixels > 0 && row_spacing_m > 0.0 && column_spacing_m > 0.0)
        measure_axis(image->intensity, image->columns, image->marks, &sizes, row_spacing_m,
                     column_spacing_m, measures);
    return SONJECT_OK;
}

sonject_status contacts_add_seabed(struct report *report, const struct contact_image *image,
                                   sonject_contact_measures *measures, size_t count)
{
    struct speckle_statistics seabed;
    const sonject_status status =
        measure_speckle(report, image->intensity, image->taken, image->rows, image->columns,
                        image->columns, &seabed);
    for (size_t i = 0; status == SONJECT_OK && seabed.blocks > 0 && i < count; i++) {
        measures[i].seabed_shape = seabed.shape;
        measures[i].seabed_looks = seabed.looks;
        measures[i].row_length_pixels = seabed.along_track.length_pixels;
        measures[i].column_length_pixels = seabed.range.length_pixels;
    }
    return status;
}

sonject_status measure_one_contact(struct report *report, const float *intensity, size_t rows,
                                   size_t columns, const sonject_box *box, double row_spacing_m,
                                   double column_spacing_m, sonject_contact_measures *found)
{
    const sonject_box whole = {0, 0, rows, columns};
    struct contact_place place;
    struct contact_image image;
    CHECK(place_in_box(report, box ? box : &whole, rows, columns, &place));
    place.is_near = !box;
    sonject_status status = contact_image_create(&image, report, intensity, rows, columns);
    THEN(status, contact_measure(report, &image, &place, row_spacing_m, column_spacing_m, found));
    THEN(status, contacts_add_seabed(report, &image, found, 1));
    contact_image_clear(&image);
    return status;
}
