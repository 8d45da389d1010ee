#include "base/json_document.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#define DOCUMENT_BYTES_MAX ((size_t)64 << 20)
#define HASH_STEP          ((size_t)1 << 20)
#define TRUSTED_BYTES      ((json_int_t)16 << 20) /* size from which an unchanged time is trusted */
#define NS_PER_S           INT64_C(1000000000)

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_count(uint64_t value)
{
    return json_integer((json_int_t)value);
}

json_t *json_seed(uint64_t seed)
{
    char text[24];
    if (seed <= (uint64_t)INT64_MAX)
        return json_count(seed);
    snprintf(text, sizeof text, "%llu", (unsigned long long)seed);
    return json_string(text);
}

json_t *json_text(const char *text)
{
    if (text_is_printable(text))
        return json_string(text);
    char *copy = copy_text(text);
    if (!copy)
        return NULL;
    for (char *c = copy; *c; c++)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c > 0x7e)
            *c = '?';
    json_t *value = json_string(copy);
    free(copy);
    return value;
}

static void give_up(json_t **document)
{
    json_decref(*document);
    *document = NULL;
}

void json_add(json_t **object, const char *key, json_t *value)
{
    if (json_object_set_new(*object, key, value) != 0)
        give_up(object);
}

void json_append(json_t **array, json_t *value)
{
    if (json_array_append_new(*array, value) != 0)
        give_up(array);
}

json_t *json_object_of(const struct json_member *members)
{
    json_t *object = json_object();
    for (; members->key; members++)
        json_add(&object, members->key, members->value);
    return object;
}

json_t *json_counts(const uint64_t *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_append(&array, json_count(values[i]));
    return array;
}

static int add_piece(const char *piece, size_t length, void *text)
{
    struct growing_text *whole = text;
    growing_text_add(whole, "%.*s", (int)length, piece);
    return whole->failed ? -1 : 0;
}

char *json_document_text(const json_t *document, size_t flags)
{
    struct growing_text text = {NULL, 0, 0, false};
    text.failed = json_dump_callback(document, add_piece, &text, flags) != 0 || text.failed;
    return growing_text_end(&text);
}

sonject_status json_document_hash(struct report *report, const json_t *document, size_t flags,
                                  char text[HASH_TEXT_CAPACITY])
{
    char *whole = json_document_text(document, flags);
    struct hash *hash = hash_begin();
    const bool has_memory = whole && hash;
    if (hash) {
        hash_add_text(hash, whole);
        hash_end(hash, text);
    }
    free(whole);
    return has_memory ? SONJECT_OK : report_out_of_memory(report, "a hash");
}

const char *member_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

sonject_status json_document_write(struct report *report, sonject_status status, json_t *document,
                                   size_t digits, const char *path)
{
    const size_t flags = JSON_INDENT(2) | JSON_REAL_PRECISION(digits);
    char *text = status == SONJECT_OK ? json_document_text(document, flags) : NULL;
    json_decref(document);
    CHECK(status);
    CHECK_MEMORY(report, text, path);
    status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}

/* Loads JSON. If memory is out, jansson may blame the text, or silently drop a byte of it. So
 * jansson is asked twice, and memory is tested. */
static json_t *load_json(const char *text, size_t bytes, json_error_t *error, bool *lacks_memory)
{
    json_t *document = json_loadb(text, bytes, 0, error);
    json_t *again = json_loadb(text, bytes, 0, NULL);
    void *room = allocate_array(bytes + 1, 2);
    *lacks_memory = !room || ((document || again) && !json_equal(document, again));
    free(room);
    json_decref(again);
    if (*lacks_memory)
        give_up(&document);
    return document;
}

sonject_status json_document_read(struct report *report, const char *path, json_t **document)
{
    char *text;
    size_t bytes;
    bool lacks_memory;
    json_error_t error;
    *document = NULL;
    CHECK(file_read_whole(report, path, DOCUMENT_BYTES_MAX, &text, &bytes));
    *document = load_json(text, bytes, &error, &lacks_memory);
    free(text);
    if (lacks_memory)
        return report_out_of_memory(report, path);
    if (!json_is_object(*document)) {
        json_decref(*document);
        *document = NULL;
        if (error.text[0])
            return input_failure(report, path,
                                 "damaged in line %d: %s; mend it, or remove it and run that again",
                                 error.line, error.text);
        return input_failure(report, path, "damaged: no JSON object; remove it and run that again");
    }
    return SONJECT_OK;
}

sonject_status file_hash(struct report *report, const char *path, char text[HASH_TEXT_CAPACITY])
{
    struct path_facts identity;
    sonject_status status = file_identify(report, path, &identity);
    if (status != SONJECT_OK)
        return status;
    FILE *file = file_open(path, "rb");
    if (!file)
        return file_failure(report, path, "open", errno);
    struct hash *hash = hash_begin();
    char *bytes = malloc(HASH_STEP);
    if (hash && bytes) {
        size_t count;
        while ((count = fread(bytes, 1, HASH_STEP, file)) > 0)
            hash_add(hash, bytes, count);
        if (ferror(file))
            status = file_failure(report, path, "read", errno);
    } else {
        status = report_out_of_memory(report, "a hash");
    }
    if (hash)
        hash_end(hash, text);
    free(bytes);
    fclose(file);
    return status;
}

static json_int_t changed_ns(const struct path_facts *identity)
{
    return identity->changed_s * NS_PER_S + identity->changed_ns;
}

sonject_status file_entry(struct report *report, const char *path, const char *name, bool has_time,
                          json_t **entry)
{
    struct path_facts identity;
    char hash[HASH_TEXT_CAPACITY];
    *entry = NULL;
    sonject_status status = file_identify(report, path, &identity);
    THEN(status, file_hash(report, path, hash));
    if (status != SONJECT_OK)
        return status;
    *entry = json_object();
    json_add(entry, "name", json_text(name));
    json_add(entry, "bytes", json_count(identity.bytes));
    if (has_time)
        json_add(entry, "changed_ns", json_integer(changed_ns(&identity)));
    json_add(entry, "xxh3", json_string(hash));
    return *entry ? SONJECT_OK : report_out_of_memory(report, path);
}

static json_int_t whole_of(const json_t *entry, const char *key)
{
    const json_t *value = json_object_get(entry, key);
    return json_is_integer(value) ? json_integer_value(value) : -1;
}

sonject_status file_entry_holds(struct report *report, const json_t *entry, const char *path,
                                bool hashes_all, bool *holds)
{
    struct report ignored = {.host = NULL};
    struct path_facts identity;
    char hash[HASH_TEXT_CAPACITY];
    const char *expected = json_string_value(json_object_get(entry, "xxh3"));
    const json_int_t bytes = whole_of(entry, "bytes");
    *holds = false;
    if (!expected || file_identify(&ignored, path, &identity) != SONJECT_OK ||
        bytes != (json_int_t)identity.bytes)
        return SONJECT_OK;
    *holds = !hashes_all && bytes >= TRUSTED_BYTES &&
             whole_of(entry, "changed_ns") == changed_ns(&identity);
    if (*holds)
        return SONJECT_OK;
    const sonject_status status = file_hash(report, path, hash);
    *holds = status == SONJECT_OK && strcmp(hash, expected) == 0;
    return status;
}

sonject_status file_list_add(json_t **list, struct report *report, const char *folder,
                             const char *name, bool has_time)
{
    json_t *entry = NULL;
    char *path = path_join(folder, name);
    const sonject_status status = path ? file_entry(report, path, name, has_time, &entry)
                                       : report_out_of_memory(report, "a path");
    free(path);
    if (status == SONJECT_OK)
        json_append(list, entry);
    return status != SONJECT_OK || *list ? status : report_out_of_memory(report, "a list of files");
}

/* Returns whether an entry names a file that is not outside the folder. */
static bool names_file(const json_t *entry)
{
    const char *name = json_string_value(json_object_get(entry, "name"));
    return name && *name && *name != '/' && !strstr(name, "..");
}

/* Returns the path of an entry's file, for free(); NULL if there is none or memory is out. */
static char *entry_path(const json_t *entry, const char *folder)
{
    return names_file(entry) ? path_join(folder, json_string_value(json_object_get(entry, "name")))
                             : NULL;
}

sonject_status file_list_check(const json_t *list, struct report *report, const char *folder,
                               bool hashes_all, const char **name)
{
    size_t i;
    const json_t *entry;
    *name = json_array_size(list) > 0 ? NULL : "the list of files";
    json_array_foreach(list, i, entry)
    {
        bool holds = false;
        char *path = entry_path(entry, folder);
        sonject_status status = SONJECT_OK;
        if (path)
            status = file_entry_holds(report, entry, path, hashes_all, &holds);
        else if (names_file(entry))
            status = report_out_of_memory(report, "a path");
        free(path);
        if (status != SONJECT_OK)
            return status;
        if (!holds) {
            *name = json_string_value(json_object_get(entry, "name"));
            *name = *name ? *name : "a file without a name";
            break;
        }
    }
    return SONJECT_OK;
}

static bool is_listed(const json_t *list, const json_t *entry)
{
    size_t i;
    const json_t *other;
    json_array_foreach(list, i, other)
    {
        if (json_equal(json_object_get(other, "name"), json_object_get(entry, "name")))
            return true;
    }
    return false;
}

void file_list_discard(const json_t *list, const json_t *kept, const char *folder)
{
    size_t i;
    const json_t *entry;
    json_array_foreach(list, i, entry)
    {
        char *path = is_listed(kept, entry) ? NULL : entry_path(entry, folder);
        if (path)
            file_discard(path);
        free(path);
    }
}
