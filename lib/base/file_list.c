#include "base/file_list.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"

#define HASH_STEP     ((size_t)1 << 20)
#define TRUSTED_BYTES ((json_int_t)16 << 20) /* from which on an unchanged time is believed */
#define NS_PER_S      INT64_C(1000000000)

sonject_status file_hash(struct report *report, const char *path, char text[HASH_TEXT_CAPACITY])
{
    struct file_identity identity;
    sonject_status status = file_identify(report, path, &identity);
    if (status != SONJECT_OK)
        return status;
    FILE *file = fopen(path, "rb");
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

static json_int_t changed_ns(const struct file_identity *identity)
{
    return identity->changed_s * NS_PER_S + identity->changed_ns;
}

sonject_status file_entry(struct report *report, const char *path, const char *name, bool has_time,
                          json_t **entry)
{
    struct file_identity identity;
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
    struct report ignored = {{0}, NULL, NULL};
    struct file_identity identity;
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

/* Whether an entry names a file, and none out of the folder. */
static bool names_file(const json_t *entry)
{
    const char *name = json_string_value(json_object_get(entry, "name"));
    return name && *name && *name != '/' && !strstr(name, "..");
}

/* The path of an entry's file, for free(); NULL where it names none, or memory is out. */
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
