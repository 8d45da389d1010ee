/* Contact records: where each object lies and how large it is, as JSON and CSV. */
#ifndef SONJECT_LABEL_CONTACT_RECORD_H
#define SONJECT_LABEL_CONTACT_RECORD_H

#include <jansson.h>

#include "base/growing_text.h"
#include "label/image_labels.h"

/* A place on the track's map: longitude_deg and latitude_deg, or easting_m and northing_m. */
json_t *place_document(bool is_geographic, const struct place *place);

/* Rows and columns; null where it has no rows. */
json_t *box_document(const sonject_box *box);

/* The contacts of an image. Errors: STORAGE, MEMORY. */
sonject_status contacts_write_json(struct report *report, const struct image_labels *labels,
                                   const char *path);

/* The line of column names, and lines of an image's contacts: several images may share a file. */
void contacts_add_csv_head(struct growing_text *csv);
void contacts_add_csv(struct growing_text *csv, const struct image_labels *labels);

/* Both in a file. Errors: STORAGE, MEMORY. */
sonject_status contacts_write_csv(struct report *report, const struct image_labels *labels,
                                  const char *path);

#endif
