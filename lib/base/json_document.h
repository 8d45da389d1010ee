/* JSON files. */
#ifndef SONJECT_BASE_JSON_DOCUMENT_H
#define SONJECT_BASE_JSON_DOCUMENT_H

#include <stdint.h>

#include <jansson.h>

#include "base/report.h"

/* A number; null for what JSON does not know: NaN and infinity. */
json_t *json_number(double value);

json_t *json_count(uint64_t value);

/* Adds a member; jansson itself frees a value that cannot be added, and a document that lacks
 * something fails when it is written. */
void json_add(json_t *object, const char *key, json_t *value);

/* Writes the document, indented, whole or not at all, and releases it. Errors: STORAGE, MEMORY. */
sonject_status json_document_write(struct report *report, json_t *document, const char *path);

#endif
