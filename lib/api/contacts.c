#include "api/contacts.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "api/handles.h"
#include "base/memory.h"
#include "image/contact_ruler.h"
#include "image/speckle_statistics.h"

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
};

void sonject_contact_params_init(sonject_contact_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

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
                         const struct contact_sizes *sizes, const sonject_contact_params *params,
                         sonject_contact_measures *measures)
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
            const double along = (double)(row - box->first_row) * params->row_spacing_m;
            const double range = (double)(column - box->first_column) * params->column_spacing_m;
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

static void fill(const struct contact_sizes *sizes, const sonject_contact_params *params,
                 sonject_contact_measures *measures)
{
    const double row = params->row_spacing_m > 0.0 ? params->row_spacing_m : NAN;
    const double column = params->column_spacing_m > 0.0 ? params->column_spacing_m : NAN;
    measures->highlight = public_box(&sizes->highlight.box);
    measures->shadow = public_box(&sizes->shadow.box);
    measures->highlight_along_pixels = sizes->highlight_rows;
    measures->highlight_range_pixels = sizes->highlight_columns;
    measures->shadow_along_pixels = sizes->shadow_rows;
    measures->shadow_range_pixels = sizes->shadow_columns;
    measures->highlight_along_m = sizes->highlight_rows * row;
    measures->highlight_range_m = sizes->highlight_columns * column;
    measures->shadow_along_m = sizes->shadow_rows * row;
    measures->shadow_range_m = sizes->shadow_columns * column;
    measures->highlight_db = decibels(sizes->highlight_intensity);
    measures->shadow_db = decibels(sizes->shadow_intensity);
    measures->seabed_db = decibels(sizes->seabed);
    measures->highlight_contrast_db = measures->highlight_db - measures->seabed_db;
    measures->shadow_contrast_db = measures->shadow_db - measures->seabed_db;
}

static void fill_seabed(const struct speckle_statistics *seabed, sonject_contact_measures *measures)
{
    if (seabed->blocks == 0)
        return;
    measures->seabed_shape = seabed->shape;
    measures->seabed_looks = seabed->looks;
    measures->row_length_pixels = seabed->along_track.length_pixels;
    measures->column_length_pixels = seabed->range.length_pixels;
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

static sonject_status check_box(struct report *report, const sonject_box *box, size_t rows,
                                size_t columns)
{
    if (box->first_row < rows && box->rows <= rows - box->first_row &&
        box->first_column < columns && box->columns <= columns - box->first_column &&
        box->columns > 0)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "the box at row %llu, column %llu of %llu x %llu pixels is not inside "
                          "the image of %zu x %zu",
                          (unsigned long long)box->first_row, (unsigned long long)box->first_column,
                          (unsigned long long)box->rows, (unsigned long long)box->columns, rows,
                          columns);
}

sonject_status contact_measure(struct report *report, const float *intensity, size_t rows,
                               size_t columns, const sonject_contact_params *params,
                               sonject_contact_measures *measures)
{
    const sonject_box *asked = &params->box;
    struct window_box box = {0, 0, rows, columns};
    struct contact_sizes sizes;
    struct speckle_statistics seabed;
    forget(measures);
    if (asked->rows > 0) {
        const sonject_status inside = check_box(report, asked, rows, columns);
        if (inside != SONJECT_OK)
            return inside;
        box.first_row = (size_t)asked->first_row;
        box.first_column = (size_t)asked->first_column;
        box.rows = (size_t)asked->rows;
        box.columns = (size_t)asked->columns;
    }
    uint8_t *marks = allocate_array(rows * columns, 1);
    sonject_status status =
        marks ? measure_contact_sizes(report, intensity, rows, columns, &box, marks, &sizes)
              : report_out_of_memory(report, "a contact's measures");
    if (status == SONJECT_OK) {
        fill(&sizes, params, measures);
        if (sizes.highlight.pixels > 0 && params->row_spacing_m > 0.0 &&
            params->column_spacing_m > 0.0)
            measure_axis(intensity, columns, marks, &sizes, params, measures);
        status = measure_speckle(report, intensity, marks, rows, columns, columns, &seabed);
    }
    if (status == SONJECT_OK)
        fill_seabed(&seabed, measures);
    free(marks);
    return status;
}

static bool is_length(double value)
{
    return value >= 0.0 && value <= 1e6;
}

sonject_status sonject_measure_contact(sonject_context *context, const sonject_pixels *pixels,
                                       const sonject_contact_params *params,
                                       sonject_contact_measures *measures)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    struct report *report = &context->report;
    sonject_contact_params taken;
    sonject_contact_measures found;
    float *packed = NULL;
    size_t rows, columns;
    sonject_contact_params_init(&taken);
    sonject_status status =
        params_take(report, &taken, sizeof taken, params, sizeof taken, "contact parameters");
    if (status != SONJECT_OK)
        return status;
    if (!pixels || !measures)
        return null_argument(report, "pixels and measures");
    if (!is_length(taken.row_spacing_m) || !is_length(taken.column_spacing_m))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "row and column spacing must be 0...1000 km");
    status = take_intensities(report, pixels, &rows, &columns, &packed);
    if (status == SONJECT_OK)
        status = contact_measure(report, packed, rows, columns, &taken, &found);
    free(packed);
    return status == SONJECT_OK ? params_give(report, measures, &found, sizeof found, sizeof found,
                                              "contact measures")
                                : status;
}
