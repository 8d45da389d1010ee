#include "measure/measures.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "base/json_document.h"
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
    NUMBER(dim_range_error_pixels),
    NUMBER(highlight_visibility_db),
    NUMBER(shadow_visibility_db)};

static double decibels(double intensity)
{
    return intensity > 0.0 ? 10.0 * log10(intensity) : NAN;
}

/* Measures the axes of the highlight's energy. A bar of uniform energy has the variance length^2 /
 * 12 along itself. */
static void measure_axis(const float *intensity, size_t columns, const uint8_t *marks,
                         const struct contact_sizes *sizes, double row_spacing_m,
                         double column_spacing_m, sonject_contact_measures *measures)
{
    const sonject_box *box = &sizes->highlight.box;
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
    measures->highlight = sizes->highlight.box;
    measures->shadow = sizes->shadow.box;
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

/* Sets all numbers to NaN, since none is known yet. */
static void forget(sonject_contact_measures *measures)
{
    const double unknown = NAN;
    memset(measures, 0, sizeof *measures);
    measures->struct_size = sizeof *measures;
    for (size_t i = 0; i < CONTACT_NUMBERS; i++)
        memcpy((char *)measures + contact_numbers[i].offset, &unknown, sizeof unknown);
}

/* Returns whether an area touches an edge of the box around it. */
static bool is_cut_by(const struct contact_area *area, const sonject_box *box)
{
    const sonject_box *inner = &area->box;
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

/* Takes a box of the image as the place of a contact. Errors: INPUT (the box is not inside). */
static sonject_status place_in_box(struct report *report, const sonject_box *box, size_t rows,
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
    place->box = place->bright = *box;
    return SONJECT_OK;
}

/* Measures everything but the seabed's speckle. Errors: INPUT, MEMORY. */
static sonject_status contact_measure(struct report *report, struct contact_image *image,
                                      const struct contact_place *place, double row_spacing_m,
                                      double column_spacing_m, sonject_contact_measures *measures)
{
    struct contact_sizes sizes;
    forget(measures);
    CHECK(measure_contact_sizes(image, report, place, &sizes));
    fill(&sizes, row_spacing_m, column_spacing_m, measures);
    measures->box = place->box;
    measures->is_cut =
        is_cut_by(&sizes.highlight, &place->box) || is_cut_by(&sizes.shadow, &place->box);
    if (sizes.highlight.pixels > 0 && row_spacing_m > 0.0 && column_spacing_m > 0.0)
        measure_axis(image->intensity, image->columns, image->marks, &sizes, row_spacing_m,
                     column_spacing_m, measures);
    return SONJECT_OK;
}

/* Measures how well each contact is seen. All are known by then: none is seabed. Errors: MEMORY. */
static sonject_status contacts_add_visibility(struct report *report,
                                              const struct contact_image *image,
                                              sonject_contact_measures *measures, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct contact_visibility visibility;
        CHECK(measure_visibility(image, report, &measures[i].highlight, &measures[i].shadow,
                                 &visibility));
        measures[i].highlight_visibility_db = visibility.highlight_db;
        measures[i].shadow_visibility_db = visibility.shadow_db;
    }
    return SONJECT_OK;
}

/* Tells each contact the speckle of the seabed outside all contacts so far. Errors: MEMORY. */
static sonject_status contacts_add_seabed(struct report *report, const struct contact_image *image,
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

sonject_status measure_placed_contact(struct report *report, const float *intensity, size_t rows,
                                      size_t columns, const struct contact_place *place,
                                      double row_spacing_m, double column_spacing_m,
                                      sonject_contact_measures *found)
{
    struct contact_image image;
    sonject_status status = contact_image_create(&image, report, intensity, rows, columns);
    THEN(status, contact_measure(report, &image, place, row_spacing_m, column_spacing_m, found));
    THEN(status, contacts_add_visibility(report, &image, found, 1));
    THEN(status, contacts_add_seabed(report, &image, found, 1));
    contact_image_clear(&image);
    return status;
}

sonject_status measure_one_contact(struct report *report, const float *intensity, size_t rows,
                                   size_t columns, const sonject_box *box, double row_spacing_m,
                                   double column_spacing_m, sonject_contact_measures *found)
{
    const sonject_box whole = {0, 0, rows, columns};
    struct contact_place place;
    CHECK(place_in_box(report, box ? box : &whole, rows, columns, &place));
    place.is_near = !box;
    return measure_placed_contact(report, intensity, rows, columns, &place, row_spacing_m,
                                  column_spacing_m, found);
}

/* ---- Contacts as JSON: of boxes, of a truth.json, or from a search. */

#define TRUTH_BYTES_MAX ((size_t)1 << 26)
#define LENGTH_MOST     1e6 /* m; longest box */

/* The contacts to measure. */
struct contact_list {
    sonject_box *boxes; /* owned */
    size_t count;
    double row_spacing_m, column_spacing_m;
    bool is_reversed; /* range grows to the left */
};

static sonject_status bad_truth(struct report *report, const char *path, const char *what)
{
    return input_failure(report, path, "%s: give the truth.json of a run on this image", what);
}

static bool read_count(const json_t *object, const char *key, uint64_t *value)
{
    const json_t *member = json_object_get(object, key);
    const json_int_t number = json_integer_value(member);
    *value = (uint64_t)number;
    return json_is_integer(member) && number >= 0 && number <= (json_int_t)1 << 31;
}

/* Takes a truth's box with a margin, within the image, since a truth's masks end where they are
 * half dark. Returns false where the box is not inside the image. */
static bool take_truth_box(const json_t *box, size_t rows, size_t columns, sonject_box *taken)
{
    uint64_t row, column, box_rows, box_columns;
    if (!read_count(box, "row", &row) || !read_count(box, "column", &column) ||
        !read_count(box, "rows", &box_rows) || !read_count(box, "columns", &box_columns) ||
        box_rows == 0 || box_columns == 0 || row + box_rows > rows ||
        column + box_columns > columns)
        return false;
    const uint64_t last_row = row + box_rows + CONTACT_MARGIN;
    const uint64_t last_column = column + box_columns + CONTACT_MARGIN;
    taken->first_row = row > CONTACT_MARGIN ? row - CONTACT_MARGIN : 0;
    taken->first_column = column > CONTACT_MARGIN ? column - CONTACT_MARGIN : 0;
    taken->rows = (last_row < rows ? last_row : rows) - taken->first_row;
    taken->columns = (last_column < columns ? last_column : columns) - taken->first_column;
    return true;
}

static sonject_status take_truth(struct contact_list *list, struct report *report, const char *path,
                                 size_t rows, size_t columns)
{
    char *text = NULL;
    size_t bytes;
    sonject_status status = file_read_whole(report, path, TRUTH_BYTES_MAX, &text, &bytes);
    if (status != SONJECT_OK)
        return status == SONJECT_ERROR_STORAGE ? SONJECT_ERROR_INPUT : status;
    json_t *truth = json_loadb(text, bytes, 0, NULL);
    const json_t *objects = json_object_get(truth, "objects");
    free(text);
    if (!json_is_array(objects) || json_array_size(objects) > BOXES_MAX)
        status = bad_truth(report, path, "it lists no objects");
    sonject_box *boxes =
        realloc(list->boxes, (list->count + json_array_size(objects) + 1) * sizeof *boxes);
    if (!boxes)
        status = report_out_of_memory(report, path);
    else
        list->boxes = boxes;
    for (size_t i = 0; status == SONJECT_OK && i < json_array_size(objects); i++) {
        const json_t *box = json_object_get(json_array_get(objects, i), "box");
        if (!box || json_is_null(box))
            continue;
        if (!take_truth_box(box, rows, columns, &list->boxes[list->count]))
            status = bad_truth(report, path, "a box is not inside the image");
        const double length = json_number_value(json_object_get(box, "length_m"));
        const double width = json_number_value(json_object_get(box, "width_m"));
        if (!(length >= 0.0 && length <= LENGTH_MOST && width >= 0.0 && width <= LENGTH_MOST))
            status = bad_truth(report, path, "a box has impossible lengths in metres");
        if (!(list->row_spacing_m > 0.0))
            list->row_spacing_m = length / json_number_value(json_object_get(box, "rows"));
        if (!(list->column_spacing_m > 0.0))
            list->column_spacing_m = width / json_number_value(json_object_get(box, "columns"));
        list->count++;
    }
    const char *grows = json_string_value(json_object_get(truth, "range_grows"));
    list->is_reversed = list->is_reversed || (grows && strcmp(grows, "left") == 0);
    json_decref(truth);
    return status;
}

static void turn_box(sonject_box *box, size_t columns)
{
    if (box->rows > 0)
        box->first_column = columns - box->first_column - box->columns;
}

/* Mirrors the image and its boxes so that range grows to the right, as contacts are measured. Boxes
 * outside the image stay as they are, to be refused. */
static void turn_image(const struct contact_list *list, struct measured *intensities)
{
    const size_t columns = intensities->columns;
    for (size_t row = 0; row < intensities->rows; row++) {
        float *line = intensities->amplitudes + row * columns;
        for (size_t i = 0; i < columns / 2; i++) {
            const float kept = line[i];
            line[i] = line[columns - 1 - i];
            line[columns - 1 - i] = kept;
        }
    }
    for (size_t i = 0; i < list->count; i++) {
        sonject_box *box = &list->boxes[i];
        if (box->first_column < columns && box->columns <= columns - box->first_column)
            turn_box(box, columns);
    }
}

static json_t *box_document(const sonject_box *box)
{
    return box->rows == 0 ? json_null()
                          : JSON_OBJECT({"row", json_count(box->first_row)},
                                        {"column", json_count(box->first_column)},
                                        {"rows", json_count(box->rows)},
                                        {"columns", json_count(box->columns)});
}

static json_t *measures_document(const char *image, const sonject_contact_measures *measures)
{
    json_t *document = JSON_OBJECT(
        {"image", json_text(image)}, {"measured_box", box_document(&measures->box)},
        {"highlight_box", box_document(&measures->highlight)},
        {"shadow_box", box_document(&measures->shadow)}, {"cut", json_boolean(measures->is_cut)});
    for (size_t i = 0; i < CONTACT_NUMBERS; i++) {
        double value;
        memcpy(&value, (const char *)measures + contact_numbers[i].offset, sizeof value);
        json_add(&document, contact_numbers[i].name, json_number(value));
    }
    return document;
}

/* *text gets NULL where memory is out. */
static sonject_status write_list(struct report *report, const char *image,
                                 const sonject_contact_measures *measures, size_t count,
                                 char **text)
{
    json_t *contacts = json_array();
    for (size_t i = 0; i < count; i++)
        json_append(&contacts, measures_document(image, &measures[i]));
    json_t *document = JSON_OBJECT({"contacts", contacts});
    *text = json_document_text(document, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(document);
    return *text ? SONJECT_OK : report_out_of_memory(report, image);
}

/* Measures the contacts of the list. measures: one for each. */
static sonject_status measure_list(struct report *report, const struct contact_list *list,
                                   struct contact_image *image, sonject_contact_measures *measures)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < list->count; i++) {
        struct contact_place place;
        status = place_in_box(report, &list->boxes[i], image->rows, image->columns, &place);
        THEN(status, contact_measure(report, image, &place, list->row_spacing_m,
                                     list->column_spacing_m, &measures[i]));
    }
    return status;
}

static sonject_status take_boxes(struct contact_list *list, struct report *report,
                                 const sonject_measure_params *params, size_t rows, size_t columns)
{
    list->row_spacing_m = params->row_spacing_m;
    list->column_spacing_m = params->column_spacing_m;
    list->is_reversed = params->range_to_left != 0;
    list->boxes = allocate_array((size_t)params->box_count + 1, sizeof *list->boxes);
    CHECK_MEMORY(report, list->boxes, "boxes");
    if (params->box_count > 0)
        memcpy(list->boxes, params->boxes, params->box_count * sizeof *list->boxes);
    list->count = params->box_count;
    return params->truth ? take_truth(list, report, params->truth, rows, columns) : SONJECT_OK;
}

sonject_status measure_listed_contacts(struct report *report, const sonject_measure_params *params,
                                       struct measured *intensities, char **text)
{
    struct contact_list list = {NULL, 0, 0.0, 0.0, false};
    struct contact_image image;
    sonject_contact_measures *measures = NULL;
    memset(&image, 0, sizeof image);
    sonject_status status =
        take_boxes(&list, report, params, intensities->rows, intensities->columns);
    if (!(list.row_spacing_m > 0.0 || list.column_spacing_m > 0.0)) {
        list.row_spacing_m = intensities->row_spacing_m;
        list.column_spacing_m = intensities->column_spacing_m;
    }
    const size_t count = list.count;
    if (status == SONJECT_OK) {
        if (list.is_reversed)
            turn_image(&list, intensities);
        measures = allocate_array(count + 1, sizeof *measures);
        status = measures ? contact_image_create(&image, report, intensities->amplitudes,
                                                 intensities->rows, intensities->columns)
                          : report_out_of_memory(report, "contacts");
    }
    THEN(status, measure_list(report, &list, &image, measures));
    THEN(status, contacts_add_visibility(report, &image, measures, count));
    THEN(status, contacts_add_seabed(report, &image, measures, count));
    for (size_t i = 0; status == SONJECT_OK && list.is_reversed && i < count; i++) {
        turn_box(&measures[i].box, intensities->columns);
        turn_box(&measures[i].highlight, intensities->columns);
        turn_box(&measures[i].shadow, intensities->columns);
    }
    THEN(status, write_list(report, params->image ? params->image : "", measures, count, text));
    contact_image_clear(&image);
    free(measures);
    free(list.boxes);
    return status;
}
