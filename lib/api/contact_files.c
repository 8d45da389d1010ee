#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "api/contacts.h"
#include "api/handles.h"
#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"

#define TRUTH_BYTES_MAX ((size_t)1 << 26)
#define TRUTH_MARGIN    6 /* pixels around a truth's box: its masks end where they are half dark */
#define BOXES_MAX       100000

void sonject_contact_file_params_init(sonject_contact_file_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
    sonject_transfer_params_init(&params->transfer);
}

/* The contacts to measure. */
struct contact_list {
    sonject_box *boxes; /* owned */
    size_t count;
    double row_spacing_m, column_spacing_m;
};

static sonject_status bad_truth(struct report *report, const char *path, const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: %s: give the truth.json of a run on this image", path, what);
}

static bool read_count(const json_t *object, const char *key, uint64_t *value)
{
    const json_t *member = json_object_get(object, key);
    const json_int_t number = json_integer_value(member);
    *value = (uint64_t)number;
    return json_is_integer(member) && number >= 0 && number <= (json_int_t)1 << 31;
}

/* A truth's box with a margin, within the image. */
static bool take_truth_box(const json_t *box, size_t rows, size_t columns, sonject_box *taken)
{
    uint64_t row, column, box_rows, box_columns;
    if (!read_count(box, "row", &row) || !read_count(box, "column", &column) ||
        !read_count(box, "rows", &box_rows) || !read_count(box, "columns", &box_columns) ||
        box_rows == 0 || box_columns == 0 || row + box_rows > rows ||
        column + box_columns > columns)
        return false;
    const uint64_t last_row = row + box_rows + TRUTH_MARGIN;
    const uint64_t last_column = column + box_columns + TRUTH_MARGIN;
    taken->first_row = row > TRUTH_MARGIN ? row - TRUTH_MARGIN : 0;
    taken->first_column = column > TRUTH_MARGIN ? column - TRUTH_MARGIN : 0;
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
        if (!(list->row_spacing_m > 0.0))
            list->row_spacing_m = length / json_number_value(json_object_get(box, "rows"));
        if (!(list->column_spacing_m > 0.0))
            list->column_spacing_m = width / json_number_value(json_object_get(box, "columns"));
        list->count++;
    }
    json_decref(truth);
    return status;
}

static json_t *box_document(const sonject_box *box)
{
    if (box->rows == 0)
        return json_null();
    json_t *document = json_object();
    json_add(&document, "row", json_count(box->first_row));
    json_add(&document, "column", json_count(box->first_column));
    json_add(&document, "rows", json_count(box->rows));
    json_add(&document, "columns", json_count(box->columns));
    return document;
}

static json_t *measures_document(const char *image, const sonject_contact_measures *measures)
{
    json_t *document = json_object();
    json_add(&document, "image", json_text(image));
    json_add(&document, "highlight", box_document(&measures->highlight));
    json_add(&document, "shadow", box_document(&measures->shadow));
    for (size_t i = 0; i < CONTACT_NUMBERS; i++) {
        double value;
        memcpy(&value, (const char *)measures + contact_numbers[i].offset, sizeof value);
        json_add(&document, contact_numbers[i].name, json_number(value));
    }
    return document;
}

/* *text is NULL where memory is out. */
static sonject_status measure_list(struct report *report, const char *image,
                                   const struct contact_list *list, const float *intensity,
                                   size_t rows, size_t columns, char **text)
{
    json_t *contacts = json_array();
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < list->count; i++) {
        sonject_contact_params params;
        sonject_contact_measures measures;
        sonject_contact_params_init(&params);
        params.box = list->boxes[i];
        params.row_spacing_m = list->row_spacing_m;
        params.column_spacing_m = list->column_spacing_m;
        status = contact_measure(report, intensity, rows, columns, &params, &measures);
        if (status == SONJECT_OK)
            json_append(&contacts, measures_document(image, &measures));
    }
    json_t *document = json_object();
    json_add(&document, "contacts", contacts);
    *text =
        status == SONJECT_OK ? json_dumps(document, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(document);
    return status == SONJECT_OK && !*text ? report_out_of_memory(report, image) : status;
}

static sonject_status take_boxes(struct contact_list *list, struct report *report,
                                 const sonject_contact_file_params *params, size_t rows,
                                 size_t columns)
{
    list->row_spacing_m = params->row_spacing_m;
    list->column_spacing_m = params->column_spacing_m;
    list->boxes = allocate_array((size_t)params->box_count + 1, sizeof *list->boxes);
    if (!list->boxes)
        return report_out_of_memory(report, "boxes");
    if (params->box_count > 0)
        memcpy(list->boxes, params->boxes, params->box_count * sizeof *list->boxes);
    list->count = params->box_count;
    if (params->truth)
        return take_truth(list, report, params->truth, rows, columns);
    if (list->count == 0)
        list->count = 1; /* its box, all zeros, is the whole image */
    return SONJECT_OK;
}

sonject_status sonject_measure_contacts(sonject_context *context,
                                        const sonject_contact_file_params *params, char **text)
{
    if (!context || !text)
        return SONJECT_ERROR_ARGUMENT;
    *text = NULL;
    context_begin_call(context);
    struct report *report = &context->report;
    sonject_contact_file_params taken;
    struct contact_list list = {NULL, 0, 0.0, 0.0};
    float *intensity = NULL;
    size_t rows, columns;
    sonject_contact_file_params_init(&taken);
    sonject_status status =
        params_take(report, &taken, sizeof taken, params, sizeof taken, "contact parameters");
    if (status != SONJECT_OK)
        return status;
    if (!taken.image || (taken.box_count > 0 && !taken.boxes))
        return null_argument(report, "image and boxes");
    if (taken.has_transfer)
        status = check_transfer(&taken.transfer, report, NULL);
    if (status == SONJECT_OK)
        status =
            read_intensities(report, taken.image, &taken.transfer, &rows, &columns, &intensity);
    if (status == SONJECT_OK)
        status = take_boxes(&list, report, &taken, rows, columns);
    if (status == SONJECT_OK)
        status = measure_list(report, taken.image, &list, intensity, rows, columns, text);
    free(intensity);
    free(list.boxes);
    return status;
}
