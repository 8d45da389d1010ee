/* The list of keys, from the tables, and whether there is one. */
#include <stdio.h>
#include <string.h>

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
