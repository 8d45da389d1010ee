/* JSON files. */
#ifndef SONJECT_BASE_JSON_DOCUMENT_H
#define SONJECT_BASE_JSON_DOCUMENT_H

#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "base/report.h"

/* A number; null for what JSON does not know: NaN and infinity. */
json_t *json_number(double value);

json_t *json_count(uint64_t value);

/* A number of 64 bits; a text where it takes all of them, since JSON's readers take 63. */
json_t *json_seed(uint64_t seed);

/* A text. One that is not well-formed UTF-8 without control characters, as a file's name may be,
 * has
 * '?' for all of its bytes that are not printable ASCII. */
json_t *json_text(const char *text);

/* An object of members, in their order; the values go into it. NULL where memory is out or a value
 * is NULL: what was made of the others is released. */
struct json_member {
    const char *key; /* NULL: there are no more */
    json_t *value;
};
json_t *json_object_of(const struct json_member *members);
#define JSON_OBJECT(...) json_object_of((const struct json_member[]){__VA_ARGS__, {NULL, NULL}})

/* An array of numbers. */
json_t *json_counts(const uint64_t *values, size_t count);

/* Adds a member to an object, or an element to an array; the value goes into it. Where memory is
 * out or the value is NULL, *object or *array is released and becomes NULL, and what is added to
 * NULL is released, so that a document that lacks something is NULL in the end. */
void json_add(json_t **object, const char *key, json_t *value);
void json_append(json_t **array, json_t *value);

/* The document's text, by the flags of json_dumps, for free(); NULL where memory is out, which
 * json_dumps overlooks among keys, or where the document is NULL. */
char *json_document_text(const json_t *document, size_t flags);

/* Writes the document, indented, numbers with so many digits, whole or not at all, and releases it.
 * Errors: STORAGE, MEMORY (also where the document is NULL). */
sonject_status json_document_write(struct report *report, json_t *document, size_t digits,
                                   const char *path);

/* Reads a JSON object of at most 64 MB. Errors: STORAGE, INPUT, MEMORY. */
sonject_status json_document_read(struct report *report, const char *path, json_t **document);

#endif
