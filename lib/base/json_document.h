/* JSON files, and the files that a document names, with what tells them from others later. */
#ifndef SONJECT_BASE_JSON_DOCUMENT_H
#define SONJECT_BASE_JSON_DOCUMENT_H

#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include "base/hash.h"
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

/* Members of JSON that are members of a structure. */
#define JSON_NUMBER(structure, member)                                                             \
    {                                                                                              \
#member, json_number((structure)->member)                                                  \
    }
#define JSON_COUNT(structure, member)                                                              \
    {                                                                                              \
#member, json_count((structure)->member)                                                   \
    }

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

/* Digest of the document's text by those flags. Errors: MEMORY (also where the document is NULL).
 */
sonject_status json_document_hash(struct report *report, const json_t *document, size_t flags,
                                  char text[HASH_TEXT_CAPACITY]);

/* The text of a member, "" if there is none. */
const char *member_text(const json_t *object, const char *key);

/* Writes the document, indented, numbers with so many digits, whole or not at all, and releases it.
 * Errors: STORAGE, MEMORY (also where the document is NULL). */
sonject_status json_document_write(struct report *report, json_t *document, size_t digits,
                                   const char *path);

/* Reads a JSON object of at most 64 MB. Errors: STORAGE, INPUT, MEMORY. */
sonject_status json_document_read(struct report *report, const char *path, json_t **document);

/* Digest of a regular file's bytes. Errors: STORAGE, MEMORY. */
sonject_status file_hash(struct report *report, const char *path, char text[HASH_TEXT_CAPACITY]);

/* A file under a name: {"name", "bytes", "xxh3"}, and "changed_ns" (since 1970) if it is to have
 * the time of its last change. For json_decref. Errors: STORAGE, MEMORY. */
sonject_status file_entry(struct report *report, const char *path, const char *name, bool has_time,
                          json_t **entry);

/* Whether the file is as an entry says: of the size, and of the hash; that of a file of 16 MB or
 * more counts as the same where the time is, unless all are hashed. A file that is not there is
 * not. Errors: STORAGE (it cannot be read), MEMORY. */
sonject_status file_entry_holds(struct report *report, const json_t *entry, const char *path,
                                bool hashes_all, bool *holds);

/* Adds the entry of a file of a folder, or of one below it. Errors: STORAGE, MEMORY. */
sonject_status file_list_add(json_t **list, struct report *report, const char *folder,
                             const char *name, bool has_time);

/* Whether all files of a list are in the folder as it says; *name is of the first that is not, NULL
 * where all are, and the list's. Errors: STORAGE, MEMORY. */
sonject_status file_list_check(const json_t *list, struct report *report, const char *folder,
                               bool hashes_all, const char **name);

/* Removes the files of a list from the folder but for those that another list names, too. Never
 * fails. */
void file_list_discard(const json_t *list, const json_t *kept, const char *folder);

#endif
