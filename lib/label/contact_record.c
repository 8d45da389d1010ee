#include "label/contact_record.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "label/label_text.h"

json_t *place_document(bool is_geographic, const struct place *place)
{
    json_t *document = json_object();
    json_add(&document, is_geographic ? "longitude_deg" : "easting_m", json_number(place->x));
    json_add(&document, is_geographic ? "latitude_deg" : "northing_m", json_number(place->y));
    return document;
}

json_t *box_document(const sonject_box *box)
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

static json_t *contact_document(const struct image_labels *labels, const struct contact *contact)
{
    json_t *dimensions = json_object();
    json_add(&dimensions, "length_m", json_number(contact->length_m));
    json_add(&dimensions, "width_m", json_number(contact->width_m));
    json_add(&dimensions, "height_m", json_number(contact->body_height_m));
    json_t *document = json_object();
    json_add(&document, "id", json_count(contact->number));
    json_add(&document, "name", json_text(contact->name));
    json_add(&document, "class", json_text(contact->class_name));
    json_add(&document, "confidence", json_number(contact->confidence));
    json_add(&document, "row", json_number(contact->row));
    json_add(&document, "column", json_number(contact->column));
    json_add(&document, "along_track_m", json_number(contact->along_track_m));
    json_add(&document, "slant_range_m", json_number(contact->slant_range_m));
    json_add(&document, "ground_range_m", json_number(contact->ground_range_m));
    json_add(&document, "position",
             contact->has_place ? place_document(labels->is_geographic, &contact->place)
                                : json_null());
    json_add(&document, "sonar_heading_deg",
             contact->has_place ? json_number(contact->place.heading_deg) : json_null());
    json_add(&document, "dimensions", dimensions);
    json_add(&document, "heading_deg", json_number(contact->heading_deg));
    json_add(&document, "box", box_document(&contact->box));
    json_add(&document, "pixels", json_count(contact->pixels));
    json_add(&document, "truncated", json_boolean(contact->is_truncated));
    json_add(&document, "occluded", json_boolean(contact->is_occluded));
    return document;
}

sonject_status contacts_write_json(struct report *report, const struct image_labels *labels,
                                   const char *path)
{
    json_t *contacts = json_array();
    for (uint32_t i = 0; i < labels->count; i++)
        json_append(&contacts, contact_document(labels, &labels->contacts[i]));
    json_t *document = json_object();
    json_add(&document, "image", json_text(labels->file_name));
    json_add(&document, "contacts", contacts);
    return json_document_write(report, document, path);
}

void contacts_add_csv_head(struct growing_text *csv)
{
    growing_text_add(csv,
                     "image,id,name,class,confidence,row,column,along_track_m,slant_range_m,"
                     "ground_range_m,longitude_deg,latitude_deg,easting_m,northing_m,length_m,"
                     "width_m,height_m,heading_deg,box_row,box_column,box_rows,box_columns,pixels,"
                     "truncated,occluded\n");
}

static void add_numbers(struct growing_text *csv, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        growing_text_add(csv, ",");
        label_text_number(csv, values[i]);
    }
}

static void add_contact(struct growing_text *csv, const struct image_labels *labels,
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
    label_text_csv(csv, labels->file_name);
    growing_text_add(csv, ",%u,", (unsigned)contact->number);
    label_text_csv(csv, contact->name);
    growing_text_add(csv, ",");
    label_text_csv(csv, contact->class_name);
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

void contacts_add_csv(struct growing_text *csv, const struct image_labels *labels)
{
    for (uint32_t i = 0; i < labels->count; i++)
        add_contact(csv, labels, &labels->contacts[i]);
}

sonject_status contacts_write_csv(struct report *report, const struct image_labels *labels,
                                  const char *path)
{
    struct growing_text csv = {NULL, 0, 0, false};
    contacts_add_csv_head(&csv);
    contacts_add_csv(&csv, labels);
    char *text = growing_text_end(&csv);
    CHECK_MEMORY(report, text, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}
