#include "dataset/labels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define DEGREES_PER_RADIAN 57.29577951308232

sonject_status class_names_take(struct class_names *classes, struct report *report,
                                const char *name, uint32_t *number)
{
    for (*number = 0; *number < classes->count; ++*number)
        if (strcmp(classes->names[*number], name) == 0)
            return SONJECT_OK;
    char **names = realloc(classes->names, (classes->count + 1) * sizeof *names);
    CHECK_MEMORY(report, names, "the classes");
    classes->names = names;
    names[classes->count] = copy_text(name);
    CHECK_MEMORY(report, names[classes->count], "the classes");
    classes->count++;
    return SONJECT_OK;
}

void class_names_clear(struct class_names *classes)
{
    for (uint32_t i = 0; i < classes->count; i++)
        free(classes->names[i]);
    free(classes->names);
    memset(classes, 0, sizeof *classes);
}

/* Widens a contact's box by a pixel of the patch. */
static void add_pixel(struct contact *contact, uint64_t row, uint64_t column)
{
    sonject_box *box = &contact->box;
    if (contact->pixels++ == 0) {
        box->first_row = row;
        box->first_column = column;
        box->columns = 1;
    }
    const uint64_t last_column = box->first_column + box->columns - 1;
    box->rows = row - box->first_row + 1; /* rows come in order */
    box->columns = (column > last_column ? column : last_column) + 1;
    box->first_column = column < box->first_column ? column : box->first_column;
    box->columns -= box->first_column;
}

/* Boxes and numbers of the pixels that carry contacts' numbers, in pixels of the patch. */
static void find_boxes(struct image_labels *labels, const struct injection_result *result)
{
    for (size_t row = 0; row < result->rows; row++)
        for (size_t column = 0; column < result->columns; column++) {
            const uint32_t number = result->labels[row * result->columns + column];
            if (number > 0 && number <= labels->count)
                add_pixel(&labels->contacts[number - 1], row, column);
        }
}

/* Runs being written: all pixels up to `reached` are told. */
struct run_writer {
    uint64_t *runs; /* NULL: they are only counted */
    size_t count;
    uint64_t reached;
    bool is_inside; /* at `reached` */
};

static void end_run(struct run_writer *writer, uint64_t position)
{
    if (writer->runs)
        writer->runs[writer->count] = position - writer->reached;
    writer->count++;
    writer->reached = position;
    writer->is_inside = !writer->is_inside;
}

/* The runs of the image; the contact's box still counts pixels of the patch. */
static size_t write_runs(const struct contact *contact, const struct label_request *request,
                         uint64_t *runs)
{
    const struct injection_result *result = request->result;
    const sonject_box *box = &contact->box;
    struct run_writer writer = {runs, 0, 0, false};
    for (uint64_t column = box->first_column; column < box->first_column + box->columns; column++) {
        const uint64_t start =
            (request->patch.first_column + column) * request->rows + request->patch.first_row;
        for (uint64_t row = box->first_row; row < box->first_row + box->rows; row++) {
            const bool is_inside =
                result->labels[row * result->columns + column] == contact->number;
            if (is_inside != writer.is_inside)
                end_run(&writer, start + row);
        }
        if (writer.is_inside && box->rows < request->rows)
            end_run(&writer, start + box->first_row + box->rows);
    }
    if (writer.reached < request->rows * request->columns)
        end_run(&writer, request->rows * request->columns);
    return writer.count;
}

static sonject_status find_pixels(struct contact *contact, struct report *report,
                                  const struct label_request *request)
{
    if (contact->pixels == 0)
        return SONJECT_OK;
    contact->run_count = write_runs(contact, request, NULL);
    contact->runs = allocate_array(contact->run_count, sizeof *contact->runs);
    CHECK_MEMORY(report, contact->runs, "labels");
    write_runs(contact, request, contact->runs);
    contact->box.first_row += request->patch.first_row;
    contact->box.first_column += request->patch.first_column;
    return SONJECT_OK;
}

static void describe(struct contact *contact, const struct label_request *request, uint32_t index)
{
    const sonject_object_params *object = &request->scene->objects[index];
    const sonject_object_truth *truth = &request->result->objects[index];
    contact->number = index + 1;
    contact->name = object->name;
    contact->class_name = object->class_name;
    contact->confidence = 1.0;
    contact->row = truth->row + (double)request->patch.first_row;
    contact->column = truth->column + (double)request->patch.first_column;
    contact->along_track_m = truth->along_track_m;
    contact->slant_range_m = truth->slant_range_m;
    contact->ground_range_m = truth->ground_range_m;
    contact->height_m = truth->height_m;
    contact->length_m = truth->overall_length_m;
    contact->width_m = truth->overall_width_m;
    contact->body_height_m = truth->overall_height_m;
    contact->heading_deg = object->heading_rad * DEGREES_PER_RADIAN;
    contact->is_truncated = truth->highlight_is_cut || truth->shadow_is_cut;
    contact->has_place =
        request->track &&
        track_place(request->track, contact->row, contact->ground_range_m,
                    request->scene->geometry.side == SONJECT_SIDE_PORT, &contact->place);
}

sonject_status image_labels_find(struct image_labels *labels, struct report *report,
                                 const struct label_request *request, struct class_names *classes)
{
    const struct injection_result *result = request->result;
    sonject_status status = SONJECT_OK;
    memset(labels, 0, sizeof *labels);
    labels->contacts = allocate_array(result->object_count, sizeof *labels->contacts);
    CHECK_MEMORY(report, labels->contacts, "labels");
    labels->file_name = request->file_name;
    labels->rows = request->rows;
    labels->columns = request->columns;
    labels->is_geographic = request->track && request->track->is_geographic;
    labels->count = result->object_count;
    find_boxes(labels, result);
    for (uint32_t i = 0; status == SONJECT_OK && i < labels->count; i++) {
        struct contact *contact = &labels->contacts[i];
        const sonject_object_truth *truth = &result->objects[i];
        describe(contact, request, i);
        status = class_names_take(classes, report, contact->class_name, &contact->class_number);
        THEN(status, find_pixels(contact, report, request));
        contact->is_occluded = contact->pixels < truth->highlight_pixels + truth->shadow_pixels;
    }
    if (status != SONJECT_OK)
        image_labels_clear(labels);
    return status;
}

void image_labels_clear(struct image_labels *labels)
{
    for (uint32_t i = 0; labels->contacts && i < labels->count; i++)
        free(labels->contacts[i].runs);
    free(labels->contacts);
    memset(labels, 0, sizeof *labels);
}
