/* JSON files, and lists of files in documents, by which a changed file is recognised later. */
#ifndef SONJECT_BASE_JSON_DOCUMENT_H
#define SONJECT_BASE_JSON_DOCUMENT_H

#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "base/hash.h"
#include "base/report.h"

/* Makes a number; null for NaN and infinity, which JSON lacks. */
json_t *json_number(double value);

json_t *json_count(uint64_t value);

/* Makes a number of 64 bits; a text if all are needed, since JSON's readers take 63. */
json_t *json_seed(uint64_t seed);

/* Makes a text. If it is not well-formed UTF-8 without control characters, as a file's name may be,
 * '?' replaces all of its bytes that are not printable ASCII. */
json_t *json_text(const char *text);

/* A member of an object. json_object_of makes an object of members, in order, and takes over their
 * values. If memory is out or a value is NULL, it releases the others and returns NULL. */
struct json_member {
    const char *key; /* NULL: the list's end */
    json_t *value;
};
json_t *json_object_of(const struct json_member *members);
#define JSON_OBJECT(...) json_object_of((const struct json_member[]){__VA_ARGS__, {NULL, NULL}})

/* JSON members that are named after members of a structure. */
#define JSON_NUMBER(structure, member)                                                             \
    {                                                                                              \
#member, json_number((structure)->member)                                                  \
    }
#define JSON_COUNT(structure, member)                                                              \
    {                                                                                              \
#member, json_count((structure)->member)                                                   \
    }

/* Makes an array of numbers. */
json_t *json_counts(const uint64_t *values, size_t count);

/* Adds a member to an object, or an element to an array, and takes over the value. If memory is out
 * or the value is NULL, releases *object or *array and sets it to NULL. A value that is added to
 * NULL is released, so that a document that lacks something is NULL in the end. */
void json_add(json_t **object, const char *key, json_t *value);
void json_append(json_t **array, json_t *value);

/* Returns the document's text with the flags of json_dumps, for free(). NULL if the document is
 * NULL or memory is out, which json_dumps overlooks among keys. */
char *json_document_text(const json_t *document, size_t flags);

/* Hashes the document's text with those flags. Errors: MEMORY (also if the document is NULL). */
sonject_status json_document_hash(struct report *report, const json_t *document, size_t flags,
                                  char text[HASH_TEXT_CAPACITY]);

/* Returns the text of a member, "" if there is none. */
const char *member_text(const json_t *object, const char *key);

/* Writes the document whole or not at all, indented, numbers with so many digits, if status, that
 * of the steps which made it, is OK. Releases the document. Returns status or, as errors of its
 * own, STORAGE and MEMORY (also if the document is NULL). */
sonject_status json_document_write(struct report *report, sonject_status status, json_t *document,
                                   size_t digits, const char *path);

/* Reads a JSON object of at most 64 MB. Errors: STORAGE, INPUT, MEMORY. */
sonject_status json_document_read(struct report *report, const char *path, json_t **document);

/* Hashes a regular file's bytes. Errors: STORAGE, MEMORY. */
sonject_status file_hash(struct report *report, const char *path, char text[HASH_TEXT_CAPACITY]);

/* Makes a file's entry: {"name", "bytes", "xxh3"}, and with has_time "changed_ns", the time of the
 * last change since 1970. For json_decref. Errors: STORAGE, MEMORY. */
sonject_status file_entry(struct report *report, const char *path, const char *name, bool has_time,
                          json_t **entry);

/* Sets *holds to whether the file has the entry's size and hash. Files of 16 MB or more are not
 * hashed if their time of change is the entry's, unless hashes_all. A missing file does not hold.
 * Errors: STORAGE (the file cannot be read), MEMORY. */
sonject_status file_entry_holds(struct report *report, const json_t *entry, const char *path,
                                bool hashes_all, bool *holds);

/* Adds the entry of a file in a folder or below. Errors: STORAGE, MEMORY. */
sonject_status file_list_add(json_t **list, struct report *report, const char *folder,
                             const char *name, bool has_time);

/* Checks that a list's files are in the folder as listed. *name: the first that is not, borrowed
 * from the list, or "the list of files" if it is empty; NULL: all are. Errors: STORAGE, MEMORY. */
sonject_status file_list_check(const json_t *list, struct report *report, const char *folder,
                               bool hashes_all, const char **name);

/* Removes a list's files from the folder, except those that `kept` lists, too. Never fails. */
void file_list_discard(const json_t *list, const json_t *kept, const char *folder);

#endif
