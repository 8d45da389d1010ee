/* The list of keys, from the tables, and whether there is one. */
#include <stdio.h>
#include <string.h>

#include "base/json_document.h"
#include "schema/scene_file.h"
#include "schema/scene_key.h"

struct listing {
    struct scene_file_key *keys;
    size_t capacity;
    size_t count;
};

static const char *unit_of(const struct field *field)
{
    static const char *const of_quantities[] = {
        [QUANTITY_NUMBER] = "number",
        [QUANTITY_LENGTH] = "m, km, cm, mm",
        [QUANTITY_FREQUENCY] = "Hz, kHz, MHz",
        [QUANTITY_SPEED] = "m/s, km/s",
        [QUANTITY_ANGLE] = "deg, rad",
        [QUANTITY_DECIBEL] = "dB",
        [QUANTITY_LEVEL] = "dB, or a linear number",
        [QUANTITY_ABSORPTION] = "dB/m, dB/km",
        [QUANTITY_TEMPERATURE] = "C",
        [QUANTITY_DENSITY] = "kg/m3, g/cm3",
        [QUANTITY_TIME] = "s, ms, us",
    };
    if (field->unit)
        return field->unit;
    switch (field->kind) {
    case FIELD_QUANTITY:
        return of_quantities[field->quantity];
    case FIELD_BOOL:
    case FIELD_FLAG32:
        return "true or false";
    case FIELD_WORD:
        return "word";
    case FIELD_LABEL:
    case FIELD_TEXT:
        return "text";
    case FIELD_PATH:
    case FIELD_FILE:
        return "file name";
    case FIELD_NAMED:
        return "name";
    default:
        return "whole number";
    }
}

static void list_field(struct listing *listing, const char *path, const struct field *field)
{
    if (listing->count < listing->capacity) {
        struct scene_file_key *key = &listing->keys[listing->count];
        snprintf(key->path, sizeof key->path, "%s", path);
        key->unit = unit_of(field);
        key->meaning = field->meaning;
        key->is_required = field->is_required;
        key->words = field->kind == FIELD_WORD ? field->words : NULL;
    }
    listing->count++;
}

/* Tables do not come back to themselves: parts within parts are listed as one key. */
static void list_section(struct listing *listing, const char *prefix, const struct section *section)
{
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        char path[64];
        char below[sizeof path + 4];
        snprintf(path, sizeof path, "%s%s", prefix, field->key);
        /* a section with a unit may be written as a single value too */
        if (field->kind == FIELD_WORD || field->kind == FIELD_NAMED ||
            field->kind == FIELD_QUANTITY || !field->section || (field->unit && !field->is_list))
            list_field(listing, path, field);
        if (!field->section)
            continue;
        snprintf(below, sizeof below, "%s%s", path, field->is_list ? "[]." : ".");
        list_section(listing, below, field->section);
    }
}

size_t scene_file_keys(struct scene_file_key *keys, size_t capacity)
{
    struct listing listing = {keys, capacity, 0};
    list_section(&listing, "", &scene_section);
    return listing.count;
}

static const char *const kinds[] = {
    [FIELD_QUANTITY] = "quantity", [FIELD_COUNT32] = "count",   [FIELD_COUNT64] = "count",
    [FIELD_BOOL] = "flag",         [FIELD_FLAG32] = "flag",     [FIELD_WORD] = "word",
    [FIELD_LABEL] = "text",        [FIELD_TEXT] = "text",       [FIELD_PATH] = "file",
    [FIELD_FILE] = "file",         [FIELD_SECTION] = "section", [FIELD_NAMED] = "word",
    [FIELD_ENTRIES] = "list",      [FIELD_SPECIAL] = "special",
};

static json_t *json_of_field(const char *prefix, const struct field *field)
{
    const int prefix_length = (int)strlen(prefix) - (*prefix != 0);
    json_t *words = field->kind == FIELD_WORD ? json_array() : NULL;
    for (size_t i = 0; words && i < FIELD_WORDS_MAX && field->words[i]; i++)
        json_append(&words, json_string(field->words[i]));
    return json_pack("{s:o, s:o, s:s, s:s, s:s, s:b, s:o?, s:s?, s:n, s:n, s:n}", "path",
                     json_sprintf("%s%s", prefix, field->key), "section",
                     json_sprintf("%.*s", prefix_length, prefix), "meaning", field->meaning, "kind",
                     kinds[field->kind], "unit", unit_of(field), "is_required",
                     (int)field->is_required, "words", words, "member", field->member, "preset",
                     "least", "most");
}

static void add_json(json_t **keys, const char *prefix, const struct section *section)
{
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        char below[80];
        json_append(keys, json_of_field(prefix, field));
        snprintf(below, sizeof below, "%s%s%s", prefix, field->key, field->is_list ? "[]." : ".");
        if (field->section)
            add_json(keys, below, field->section);
    }
}

sonject_status scene_keys_json(struct report *report, char **text)
{
    json_t *keys = json_array();
    add_json(&keys, "", &scene_section);
    *text = json_document_text(keys, JSON_INDENT(1));
    json_decref(keys);
    return *text ? SONJECT_OK : report_out_of_memory(report, "the keys of scenes");
}

#define KEYS_COMPARED 32

static const struct field *field_of(const struct section *section, const char *key, size_t length)
{
    for (size_t i = 0; i < section->count; i++)
        if (strlen(section->fields[i].key) == length &&
            memcmp(section->fields[i].key, key, length) == 0)
            return &section->fields[i];
    return NULL;
}

static const char *nearest_key(const struct section *section, const char *key, size_t length)
{
    const char *keys[KEYS_COMPARED];
    char typed[32] = "";
    size_t count = 0;
    if (length >= sizeof typed)
        return NULL;
    memcpy(typed, key, length);
    for (size_t i = 0; i < section->count && count < KEYS_COMPARED; i++)
        keys[count++] = section->fields[i].key;
    return nearest_word(typed, keys, count);
}

bool scene_key_find(const struct section *top, const char *path, const char **near,
                    const struct section **section)
{
    *section = top;
    *near = NULL;
    for (;;) {
        const size_t length = strcspn(path, ".[");
        const struct field *field = field_of(*section, path, length);
        if (!field) {
            *near = nearest_key(*section, path, length);
            return false;
        }
        path += length;
        while (*path == '[')
            path += strcspn(path, "]") + (path[strcspn(path, "]")] == ']');
        if (!*path)
            return true;
        if (*path++ != '.')
            return false;
        if (!field->section)
            return field->kind == FIELD_SPECIAL && *path;
        *section = field->section;
    }
}
