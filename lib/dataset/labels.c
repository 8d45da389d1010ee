/* The labels of the objects in an image, and their files, which do not depend on the locale. */
#include "dataset/labels.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"

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

/* Finds the boxes around the pixels that carry contacts' numbers, and counts these pixels. Boxes
 * count pixels of the patch. */
static void find_boxes(struct image_labels *labels, const struct injection_result *result)
{
    for (size_t row = 0; row < result->rows; row++)
        for (size_t column = 0; column < result->columns; column++) {
            const uint32_t number = result->labels[row * result->columns + column];
            if (number == 0 || number > labels->count)
                continue;
            struct contact *contact = &labels->contacts[number - 1];
            const sonject_box pixel = {row, column, 1, 1};
            sonject_box *box = &contact->box;
            if (contact->pixels++ == 0)
                *box = pixel;
            const uint64_t end = box->first_column + box->columns;
            box->rows = row - box->first_row + 1; /* rows are visited in order */
            box->first_column = column < box->first_column ? column : box->first_column;
            box->columns = (column + 1 > end ? column + 1 : end) - box->first_column;
        }
}

/* Runs while they are written. All pixels up to `reached` are written. */
struct run_writer {
    uint64_t *runs; /* NULL: runs are only counted */
    size_t count;
    uint64_t reached;
    bool is_inside; /* state at `reached` */
};

static void end_run(struct run_writer *writer, uint64_t position)
{
    if (writer->runs)
        writer->runs[writer->count] = position - writer->reached;
    writer->count++;
    writer->reached = position;
    writer->is_inside = !writer->is_inside;
}

/* Writes a contact's runs over the image, and returns their number. The contact's box still counts
 * pixels of the patch. */
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
    if (writer.is_inside) /* the last column is set down to the image's last row */
        end_run(&writer,
                (request->patch.first_column + box->first_column + box->columns) * request->rows);
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

/* Returns whether the object has no highlight in the patch and may reach beyond the patch's edge,
 * where its highlight then lies. */
static bool may_show_outside(const sonject_object_truth *truth, const struct label_request *request)
{
    const sonject_geometry_params *geometry = &request->scene->geometry;
    const double reach_m = 0.5 * hypot(hypot(truth->overall_length_m, truth->overall_width_m),
                                       truth->overall_height_m);
    const double rows = reach_m / geometry->row_spacing_m;
    const double columns = reach_m / geometry->column_spacing_m;
    return truth->highlight.rows == 0 &&
           (truth->row - rows < -0.5 || truth->row + rows > (double)request->result->rows - 0.5 ||
            truth->column - columns < -0.5 ||
            truth->column + columns > (double)request->result->columns - 0.5);
}

static void describe(struct contact *contact, const struct label_request *request, uint32_t index)
{
    const sonject_object_truth *truth = &request->result->objects[index];
    contact->number = index + 1;
    contact->object = &request->scene->objects[index];
    contact->truth = truth;
    contact->row = truth->row + (double)request->patch.first_row;
    contact->column = truth->column + (double)request->patch.first_column;
    contact->is_truncated =
        truth->highlight_is_cut || truth->shadow_is_cut || may_show_outside(truth, request);
    contact->has_place =
        request->track &&
        track_place(request->track, contact->row, truth->ground_range_m,
                    request->scene->geometry.side == SONJECT_SIDE_PORT, &contact->place);
}

sonject_status image_labels_find(struct image_labels *labels, struct report *report,
                                 const struct label_request *request, struct class_names *classes)
{
    const struct injection_result *result = request->result;
    sonject_status status = SONJECT_OK;
    memset(labels, 0, sizeof *labels);
    labels->contacts = allocate_array(request->count, sizeof *labels->contacts);
    CHECK_MEMORY(report, labels->contacts, "labels");
    labels->file_name = request->file_name;
    labels->rows = request->rows;
    labels->columns = request->columns;
    labels->is_geographic = request->track && request->track->is_geographic;
    labels->count = request->count;
    find_boxes(labels, result);
    for (uint32_t i = 0; status == SONJECT_OK && i < labels->count; i++) {
        struct contact *contact = &labels->contacts[i];
        const sonject_object_truth *truth = &result->objects[i];
        describe(contact, request, i);
        status =
            class_names_take(classes, report, contact->object->class_name, &contact->class_number);
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

/* Writes twelve digits with a point; nothing for NaN and infinity. */
static void add_number(struct growing_text *text, double value)
{
    char digits[40];
    if (isfinite(value))
        growing_text_add(text, "%s", text_of_number(digits, sizeof digits, value, 12));
}

/* Writes XML text. Characters with a meaning are escaped. Characters that XML forbids become '?',
 * such as U+FFFE and U+FFFF, which are valid UTF-8. */
static void add_xml(struct growing_text *text, const char *words)
{
    static const char *const escapes[] = {"&&amp;", "<&lt;", ">&gt;", "\"&quot;"};
    const bool is_printable = text_is_printable(words);
    for (; *words; words++) {
        const unsigned char byte = (unsigned char)*words;
        const char *escape = NULL;
        for (int i = 0; i < 4; i++)
            if (*words == escapes[i][0])
                escape = escapes[i] + 1;
        if (!is_printable && (byte < 0x20 || byte >= 0x7F)) {
            escape = "?";
        } else if (strncmp(words, "\xEF\xBF\xBE", 3) == 0 ||
                   strncmp(words, "\xEF\xBF\xBF", 3) == 0) {
            escape = "?";
            words += 2;
        }
        growing_text_add(text, escape ? "%s" : "%.1s", escape ? escape : words);
    }
}

/* Writes a field of CSV in quotes, with quotes within doubled. A field that a spreadsheet would
 * take for a formula (it begins with = + - @, tab or carriage return) gets a ' before it. */
static void add_field(struct growing_text *text, const char *words)
{
    growing_text_add(text, *words && strchr("=+-@\t\r", *words) ? "\"'" : "\"");
    for (; *words; words++)
        growing_text_add(text, *words == '"' ? "\"\"" : "%c", *words);
    growing_text_add(text, "\"");
}

json_t *coco_annotations(const struct image_labels *labels)
{
    uint64_t number = 0;
    json_t *annotations = json_array();
    for (uint32_t i = 0; i < labels->count; i++) {
        const struct contact *contact = &labels->contacts[i];
        const sonject_box *box = &contact->box;
        const uint64_t sides[] = {box->first_column, box->first_row, box->columns, box->rows};
        const uint64_t size[] = {labels->rows, labels->columns};
        if (contact->pixels == 0)
            continue;
        json_t *runs = JSON_OBJECT({"size", json_counts(size, 2)},
                                   {"counts", json_counts(contact->runs, contact->run_count)});
        json_t *annotation =
            JSON_OBJECT({"id", json_count(++number)}, {"image_id", json_count(1)},
                        {"category_id", json_count((uint64_t)contact->class_number + 1)},
                        {"bbox", json_counts(sides, 4)}, {"area", json_count(contact->pixels)},
                        {"segmentation", runs}, {"iscrowd", json_count(0)},
                        {"object_id", json_count(contact->number)},
                        {"truncated", json_boolean(contact->is_truncated)},
                        {"occluded", json_boolean(contact->is_occluded)});
        if (contact->is_difficult)
            json_add(&annotation, "difficult", json_boolean(true));
        json_append(&annotations, annotation);
    }
    return annotations;
}

json_t *coco_image(uint64_t id, const char *name, uint64_t rows, uint64_t columns)
{
    return JSON_OBJECT({"id", json_count(id)}, {"file_name", json_text(name)},
                       {"width", json_count(columns)}, {"height", json_count(rows)});
}

json_t *coco_category(uint64_t id, const char *name)
{
    return JSON_OBJECT({"id", json_count(id)}, {"name", json_text(name)},
                       {"supercategory", json_string("object")});
}

static json_t *coco_document(const struct image_labels *labels, const struct class_names *classes)
{
    json_t *images = json_array();
    json_t *categories = json_array();
    json_append(&images, coco_image(1, labels->file_name, labels->rows, labels->columns));
    for (uint32_t i = 0; i < classes->count; i++)
        json_append(&categories, coco_category((uint64_t)i + 1, classes->names[i]));
    json_t *info = JSON_OBJECT({"description", json_string("targets injected by sonject")},
                               {"version", json_string(sonject_version())});
    return JSON_OBJECT({"info", info}, {"licenses", json_array()}, {"images", images},
                       {"annotations", coco_annotations(labels)}, {"categories", categories});
}

/* Adds a contact's row. The confidence is 1, since the object is known to be there. */
static void add_row(struct growing_text *csv, const struct image_labels *labels,
                    const struct contact *contact)
{
    const sonject_box *box = &contact->box;
    const sonject_object_truth *truth = contact->truth;
    const double x = contact->has_place ? contact->place.x : NAN;
    const double y = contact->has_place ? contact->place.y : NAN;
    const bool has_degrees = labels->is_geographic;
    const double values[] = {1.0,
                             contact->row,
                             contact->column,
                             truth->along_track_m,
                             truth->slant_range_m,
                             truth->ground_range_m,
                             has_degrees ? x : NAN,
                             has_degrees ? y : NAN,
                             has_degrees ? NAN : x,
                             has_degrees ? NAN : y,
                             truth->overall_length_m,
                             truth->overall_width_m,
                             truth->overall_height_m,
                             contact->object->heading_rad * DEGREES_PER_RADIAN,
                             contact->has_place ? contact->place.heading_deg : NAN};
    add_field(csv, labels->file_name);
    growing_text_add(csv, ",%u,", (unsigned)contact->number);
    add_field(csv, contact->object->name);
    growing_text_add(csv, ",");
    add_field(csv, contact->object->class_name);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        growing_text_add(csv, ",");
        add_number(csv, values[i]);
    }
    if (contact->pixels > 0)
        growing_text_add(csv, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64, box->first_row,
                         box->first_column, box->rows, box->columns);
    else
        growing_text_add(csv, ",,,,");
    growing_text_add(csv, ",%" PRIu64 ",%d,%d\n", contact->pixels, contact->is_truncated,
                     contact->is_occluded);
}

static void add_csv(struct growing_text *csv, const struct image_labels *labels)
{
    growing_text_add(csv, "image,id,name,class,confidence,row,column,along_track_m,slant_range_m,"
                          "ground_range_m,longitude_deg,latitude_deg,easting_m,northing_m,length_m,"
                          "width_m,height_m,heading_deg,sonar_heading_deg,box_row,box_column,"
                          "box_rows,box_columns,pixels,truncated,occluded\n");
    for (uint32_t i = 0; i < labels->count; i++)
        add_row(csv, labels, &labels->contacts[i]);
}

static void add_line(struct growing_text *lines, const struct image_labels *labels,
                     const struct contact *contact)
{
    const sonject_box *box = &contact->box;
    const double columns = (double)labels->columns;
    const double rows = (double)labels->rows;
    const double fractions[4] = {((double)box->first_column + 0.5 * (double)box->columns) / columns,
                                 ((double)box->first_row + 0.5 * (double)box->rows) / rows,
                                 (double)box->columns / columns, (double)box->rows / rows};
    growing_text_add(lines, "%u", (unsigned)contact->class_number);
    for (int i = 0; i < 4; i++) {
        growing_text_add(lines, " ");
        add_number(lines, fractions[i]);
    }
    growing_text_add(lines, "\n");
}

static void add_object(struct growing_text *xml, const struct contact *contact)
{
    const sonject_box *box = &contact->box;
    growing_text_add(xml, "  <object>\n    <name>");
    add_xml(xml, contact->object->class_name);
    growing_text_add(xml,
                     "</name>\n    <pose>Unspecified</pose>\n    <truncated>%d</truncated>\n"
                     "    <occluded>%d</occluded>\n    <difficult>%d</difficult>\n"
                     "    <bndbox>\n      <xmin>%" PRIu64 "</xmin>\n      <ymin>%" PRIu64
                     "</ymin>\n      <xmax>%" PRIu64 "</xmax>\n      <ymax>%" PRIu64
                     "</ymax>\n    </bndbox>\n  </object>\n",
                     contact->is_truncated, contact->is_occluded, contact->is_difficult,
                     box->first_column + 1, box->first_row + 1, box->first_column + box->columns,
                     box->first_row + box->rows);
}

static void add_voc(struct growing_text *xml, const struct image_labels *labels)
{
    growing_text_add(xml, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<annotation>\n"
                          "  <filename>");
    add_xml(xml, labels->file_name);
    growing_text_add(xml,
                     "</filename>\n  <source><database>sonject</database></source>\n  <size>\n"
                     "    <width>%" PRIu64 "</width>\n    <height>%" PRIu64
                     "</height>\n    <depth>1</depth>\n  </size>\n"
                     "  <segmented>0</segmented>\n",
                     labels->columns, labels->rows);
    for (uint32_t i = 0; i < labels->count; i++)
        if (labels->contacts[i].pixels > 0)
            add_object(xml, &labels->contacts[i]);
    growing_text_add(xml, "</annotation>\n");
}

sonject_status labels_write(struct report *report, const struct image_labels *labels,
                            const struct class_names *classes, enum label_file file,
                            const char *path)
{
    struct growing_text text = {NULL, 0, 0, false};
    switch (file) {
    case LABEL_COCO:
        return json_document_write(report, SONJECT_OK, coco_document(labels, classes), 12, path);
    case LABEL_CONTACTS:
        add_csv(&text, labels);
        break;
    case LABEL_YOLO:
        for (uint32_t i = 0; i < labels->count; i++)
            if (labels->contacts[i].pixels > 0)
                add_line(&text, labels, &labels->contacts[i]);
        break;
    case LABEL_CLASSES:
        for (uint32_t i = 0; i < classes->count; i++)
            growing_text_add(&text, "%s\n", classes->names[i]);
        break;
    default:
        add_voc(&text, labels);
    }
    return growing_text_write(report, &text, path);
}
