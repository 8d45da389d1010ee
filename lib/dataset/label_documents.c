/* Labels of an image as files, whatever the process's locale. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include <sonject/version.h>

#include "base/growing_text.h"
#include "base/json_document.h"
#include "base/text.h"
#include "dataset/labels.h"
#include "measure/measures.h"

/* Twelve digits with a point; nothing for NaN and infinity. */
static void add_number(struct growing_text *text, double value)
{
    char digits[40];
    if (isfinite(value))
        growing_text_add(text, "%s", text_of_number(digits, sizeof digits, value, 12));
}

/* U+FFFE and U+FFFF are UTF-8, but no characters of XML. */
static bool is_noncharacter(const char *bytes)
{
    return strncmp(bytes, "\xEF\xBF\xBE", 3) == 0 || strncmp(bytes, "\xEF\xBF\xBF", 3) == 0;
}

/* XML's text: characters that mean something are escaped, those that XML forbids become '?'. */
static void add_xml(struct growing_text *text, const char *words)
{
    const bool is_printable = text_is_printable(words);
    for (; *words; words++) {
        const unsigned char byte = (unsigned char)*words;
        if (byte == '&')
            growing_text_add(text, "&amp;");
        else if (byte == '<')
            growing_text_add(text, "&lt;");
        else if (byte == '>')
            growing_text_add(text, "&gt;");
        else if (byte == '"')
            growing_text_add(text, "&quot;");
        else if (!is_printable && (byte < 0x20 || byte >= 0x7F))
            growing_text_add(text, "?");
        else if (is_noncharacter(words)) {
            growing_text_add(text, "?");
            words += 2;
        } else
            growing_text_add(text, "%c", byte);
    }
}

/* A field of CSV: in quotes, which are doubled within. One that a spreadsheet would take for a
 * formula (it begins with = + - @, tab or carriage return) has a ' before it. */
static void add_field(struct growing_text *text, const char *words)
{
    growing_text_add(text, *words && strchr("=+-@\t\r", *words) ? "\"'" : "\"");
    for (; *words; words++)
        growing_text_add(text, *words == '"' ? "\"\"" : "%c", *words);
    growing_text_add(text, "\"");
}

json_t *place_document(bool is_geographic, const struct place *place)
{
    return JSON_OBJECT({is_geographic ? "longitude_deg" : "easting_m", json_number(place->x)},
                       {is_geographic ? "latitude_deg" : "northing_m", json_number(place->y)});
}

static json_t *contact_document(const struct image_labels *labels, const struct contact *contact)
{
    json_t *dimensions = JSON_OBJECT({"length_m", json_number(contact->length_m)},
                                     {"width_m", json_number(contact->width_m)},
                                     {"height_m", json_number(contact->body_height_m)});
    return JSON_OBJECT(
        {"id", json_count(contact->number)}, {"name", json_text(contact->name)},
        {"class", json_text(contact->class_name)}, {"confidence", json_number(contact->confidence)},
        {"row", json_number(contact->row)}, {"column", json_number(contact->column)},
        {"along_track_m", json_number(contact->along_track_m)},
        {"slant_range_m", json_number(contact->slant_range_m)},
        {"ground_range_m", json_number(contact->ground_range_m)},
        {"position",
         contact->has_place ? place_document(labels->is_geographic, &contact->place) : json_null()},
        {"sonar_heading_deg",
         contact->has_place ? json_number(contact->place.heading_deg) : json_null()},
        {"dimensions", dimensions}, {"heading_deg", json_number(contact->heading_deg)},
        {"box", box_document(&contact->box)}, {"pixels", json_count(contact->pixels)},
        {"truncated", json_boolean(contact->is_truncated)},
        {"occluded", json_boolean(contact->is_occluded)});
}

static json_t *contacts_document(const struct image_labels *labels)
{
    json_t *contacts = json_array();
    for (uint32_t i = 0; i < labels->count; i++)
        json_append(&contacts, contact_document(labels, &labels->contacts[i]));
    return JSON_OBJECT({"image", json_text(labels->file_name)}, {"contacts", contacts});
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
        json_append(&annotations,
                    JSON_OBJECT({"id", json_count(++number)}, {"image_id", json_count(1)},
                                {"category_id", json_count((uint64_t)contact->class_number + 1)},
                                {"bbox", json_counts(sides, 4)},
                                {"area", json_count(contact->pixels)}, {"segmentation", runs},
                                {"iscrowd", json_count(0)},
                                {"object_id", json_count(contact->number)},
                                {"truncated", json_boolean(contact->is_truncated)},
                                {"occluded", json_boolean(contact->is_occluded)}));
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

static void add_numbers(struct growing_text *csv, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        growing_text_add(csv, ",");
        add_number(csv, values[i]);
    }
}

static void add_row(struct growing_text *csv, const struct image_labels *labels,
                    const struct contact *contact)
{
    const bool has_degrees = contact->has_place && labels->is_geographic;
    const bool has_metres = contact->has_place && !labels->is_geographic;
    const double values[] = {
        contact->confidence,
        contact->row,
        contact->column,
        contact->along_track_m,
        contact->slant_range_m,
        contact->ground_range_m,
        has_degrees ? contact->place.x : NAN,
        has_degrees ? contact->place.y : NAN,
        has_metres ? contact->place.x : NAN,
        has_metres ? contact->place.y : NAN,
        contact->length_m,
        contact->width_m,
        contact->body_height_m,
        contact->heading_deg,
    };
    add_field(csv, labels->file_name);
    growing_text_add(csv, ",%u,", (unsigned)contact->number);
    add_field(csv, contact->name);
    growing_text_add(csv, ",");
    add_field(csv, contact->class_name);
    add_numbers(csv, values, sizeof values / sizeof *values);
    if (contact->pixels > 0)
        growing_text_add(csv, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64,
                         contact->box.first_row, contact->box.first_column, contact->box.rows,
                         contact->box.columns);
    else
        growing_text_add(csv, ",,,,");
    growing_text_add(csv, ",%" PRIu64 ",%d,%d\n", contact->pixels, contact->is_truncated,
                     contact->is_occluded);
}

static void add_csv(struct growing_text *csv, const struct image_labels *labels)
{
    growing_text_add(csv,
                     "image,id,name,class,confidence,row,column,along_track_m,slant_range_m,"
                     "ground_range_m,longitude_deg,latitude_deg,easting_m,northing_m,length_m,"
                     "width_m,height_m,heading_deg,box_row,box_column,box_rows,box_columns,pixels,"
                     "truncated,occluded\n");
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
    add_xml(xml, contact->class_name);
    growing_text_add(xml,
                     "</name>\n"
                     "    <pose>Unspecified</pose>\n"
                     "    <truncated>%d</truncated>\n"
                     "    <occluded>%d</occluded>\n"
                     "    <difficult>0</difficult>\n",
                     contact->is_truncated, contact->is_occluded);
    growing_text_add(xml,
                     "    <bndbox>\n"
                     "      <xmin>%" PRIu64 "</xmin>\n"
                     "      <ymin>%" PRIu64 "</ymin>\n"
                     "      <xmax>%" PRIu64 "</xmax>\n"
                     "      <ymax>%" PRIu64 "</ymax>\n"
                     "    </bndbox>\n"
                     "  </object>\n",
                     box->first_column + 1, box->first_row + 1, box->first_column + box->columns,
                     box->first_row + box->rows);
}

static void add_voc(struct growing_text *xml, const struct image_labels *labels)
{
    growing_text_add(xml, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<annotation>\n"
                          "  <filename>");
    add_xml(xml, labels->file_name);
    growing_text_add(xml,
                     "</filename>\n"
                     "  <source><database>sonject</database></source>\n"
                     "  <size>\n"
                     "    <width>%" PRIu64 "</width>\n"
                     "    <height>%" PRIu64 "</height>\n"
                     "    <depth>1</depth>\n"
                     "  </size>\n"
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
        return json_document_write(report, coco_document(labels, classes), 12, path);
    case LABEL_CONTACTS_JSON:
        return json_document_write(report, contacts_document(labels), 12, path);
    case LABEL_CONTACTS_CSV:
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
