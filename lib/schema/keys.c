/* Functions made from the tables of keys: defaults, bounds, the list of all keys. */
#include "schema/keys.h"

#include <stdio.h>
#include <string.h>

#include "base/json_document.h"
#include "base/text.h"

#define KEYS_LISTED 40 /* keys of a section that a message lists at most */

static const struct quantity_text {
    const char *units; /* the units that users may write */
    const char *si;    /* the unit after a number in a message */
} quantity_texts[] = {
    [QUANTITY_NUMBER] = {"number", ""},
    [QUANTITY_FRACTION] = {"%, or a fraction", ""},
    [QUANTITY_LENGTH] = {"m, km, cm, mm", " m"},
    [QUANTITY_FREQUENCY] = {"Hz, kHz, MHz", " Hz"},
    [QUANTITY_SPEED] = {"m/s, km/s", " m/s"},
    [QUANTITY_ANGLE] = {"deg, rad", " deg"},
    [QUANTITY_DECIBEL] = {"dB", " dB"},
    [QUANTITY_LEVEL] = {"dB, or a linear number", ""},
    [QUANTITY_ABSORPTION] = {"dB/m, dB/km", " dB/m"},
    [QUANTITY_TEMPERATURE] = {"C", " C"},
    [QUANTITY_DENSITY] = {"kg/m3, g/cm3", " kg/m3"},
    [QUANTITY_TIME] = {"s, ms, us", " s"},
};

static bool is_count(const struct field *field)
{
    return field->kind == FIELD_COUNT32 || field->kind == FIELD_COUNT64;
}

static bool is_number(const struct field *field)
{
    return field->kind == FIELD_QUANTITY || is_count(field);
}

static bool has_bounds(const struct field *field)
{
    return field->least != 0.0 || field->most != 0.0;
}

/* Returns how many values a word key has, including those without a word. */
static uint32_t count_words(const struct field *field)
{
    uint32_t count = 0;
    while (count < FIELD_WORDS_MAX && field->words[count])
        count++;
    return count;
}

static uint32_t value32(const void *structure, size_t offset)
{
    uint32_t value;
    memcpy(&value, (const char *)structure + offset, sizeof value);
    return value;
}

static double number_of(const struct field *field, const void *structure)
{
    const char *member = (const char *)structure + field->offset;
    if (field->kind == FIELD_QUANTITY)
        return *(const double *)(const void *)member;
    return field->kind == FIELD_COUNT64 ? (double)*(const uint64_t *)(const void *)member
                                        : value32(structure, field->offset);
}

/* Returns the number in the unit that users read: degrees for angles, else SI. */
static double shown(const struct field *field, double number)
{
    return field->kind == FIELD_QUANTITY && field->quantity == QUANTITY_ANGLE ? number * 180.0 / PI
                                                                              : number;
}

/* Returns a limit in the unit that users read, with the 6 digits that are told. An angle is rounded
 * so that it is within the limit itself. inwards: 1 or -1. */
static double shown_limit(const struct field *field, double limit, double inwards)
{
    const double number = shown(field, limit);
    if (number == limit || number == 0.0 || isinf(number))
        return number;
    const double digit = pow(10.0, floor(log10(fabs(number))) - 5.0);
    const double nearest = round(number / digit) * digit;
    const bool is_beyond = inwards * nearest * PI / 180.0 < inwards * limit;
    return is_beyond ? nearest + inwards * digit : nearest;
}

static const char *unit_behind(const struct field *field)
{
    return field->per                      ? field->per
           : field->kind == FIELD_QUANTITY ? quantity_texts[field->quantity].si
                                           : "";
}

uint32_t field_entry_count(const struct field *field, const void *structure)
{
    if (field->kind != FIELD_ENTRIES)
        return 1;
    const uint32_t count = value32(structure, field->count_offset);
    return count < field->maximum ? count : field->maximum;
}

const struct section *field_below(const struct field *field, const void *structure,
                                  const struct scene *scene, uint32_t index, const void **below)
{
    const void *of = field->is_in_scene ? (const void *)scene : structure;
    if (!of || field->kind == FIELD_SPECIAL ||
        (field->read && (field->kind == FIELD_WORD || field->kind == FIELD_QUANTITY)))
        return NULL;
    *below = structure; /* keys below that are another way to write the same value */
    if (field->kind == FIELD_SECTION || field->kind == FIELD_NAMED || field->kind == FIELD_ENTRIES)
        *below = (const char *)of + field->offset + index * field->entry_bytes;
    return field->section;
}

/* ---- Defaults. */

static void set_preset(const struct field *field, void *structure)
{
    char *member = (char *)structure + field->offset;
    const double preset = field->preset;
    if (field->kind == FIELD_QUANTITY)
        *(double *)(void *)member = preset;
    else if (field->kind == FIELD_COUNT64)
        *(uint64_t *)(void *)member = (uint64_t)preset;
    else if (field->kind == FIELD_BOOL)
        *(bool *)(void *)member = preset != 0.0;
    else if (field->kind == FIELD_COUNT32 || field->kind == FIELD_WORD)
        *(uint32_t *)(void *)member = (uint32_t)preset;
}

void section_defaults(const struct section *section, void *structure, struct scene *scene)
{
    memset(structure, 0, section->bytes);
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        const uint32_t entries = field->kind == FIELD_ENTRIES ? field->maximum : 1;
        const void *below;
        if (!field->is_in_scene || scene)
            set_preset(field, field->is_in_scene ? (void *)scene : structure);
        for (uint32_t k = 0; k < entries; k++) {
            const struct section *inner = field_below(field, structure, scene, k, &below);
            if (inner) /* below points into structure or scene, which both may be changed */
                section_defaults(inner, (void *)(uintptr_t)below, scene);
        }
    }
}

/* ---- Bounds. */

static bool is_within(const struct field *field, double number)
{
    if (number == 0.0 && (field->bounds & ZERO_IS_NONE))
        return true;
    if (!has_bounds(field))
        return is_count(field) || isfinite(number);
    return (field->bounds & ABOVE_LEAST ? number > field->least : number >= field->least) &&
           (field->bounds & BELOW_MOST ? number < field->most : number <= field->most);
}

/* Writes "1...8 surfaces" or "at least 0.01, or auto"; "" for no bounds. */
static void tell_range(const struct field *field, char text[200])
{
    const char *least_is = field->bounds & ABOVE_LEAST ? "above " : "at least ";
    const char *most_is = field->bounds & BELOW_MOST ? "below " : "at most ";
    const char *unit = unit_behind(field);
    const double least = shown_limit(field, field->least, 1.0);
    const double most = shown_limit(field, field->most, -1.0);
    const int digits = is_count(field) ? 15 : 6;
    if (field->range)
        snprintf(text, 200, "%s", field->range);
    else if (!has_bounds(field))
        text[0] = 0;
    else if (isinf(least))
        snprintf(text, 200, "%s%.*g%s", most_is, digits, most, unit);
    else if (isinf(most))
        snprintf(text, 200, "%s%.*g%s", least_is, digits, least, unit);
    else if (field->bounds & (ABOVE_LEAST | BELOW_MOST))
        snprintf(text, 200, "%s%.*g%s and %s%.*g%s", least_is, digits, least, unit, most_is, digits,
                 most, unit);
    else
        snprintf(text, 200, "%.*g...%.*g%s%s", digits, least, digits, most, unit,
                 field->bounds & ZERO_IS_NONE && least > 0.0 ? ", or 0 for the default" : "");
    for (size_t i = 0; *text && field->kind == FIELD_QUANTITY && field->words[i]; i++)
        snprintf(text + strlen(text), 200 - strlen(text), "%s%s",
                 field->words[i + 1] ? ", " : " or ", field->words[i]);
}

bool field_is_valid(const struct field *field, const void *structure, char what[300])
{
    char range[200];
    if (field->kind == FIELD_LABEL) {
        snprintf(what, 300, "must be UTF-8 text without control characters");
        return text_is_printable((const char *)structure + field->offset);
    }
    if (!is_number(field) || is_within(field, number_of(field, structure)))
        return true;
    tell_range(field, range);
    snprintf(what, 300, "must be %s, not %.*g", *range ? range : "a finite number",
             is_count(field) ? 15 : 6, shown(field, number_of(field, structure)));
    return false;
}

/* ---- The list of all keys. */

static const char *kind_of(const struct field *field)
{
    static const char *const kinds[] = {
        [FIELD_QUANTITY] = "quantity", [FIELD_UNIT] = "special",    [FIELD_COUNT32] = "count",
        [FIELD_COUNT64] = "count",     [FIELD_BOOL] = "flag",       [FIELD_WORD] = "word",
        [FIELD_LABEL] = "text",        [FIELD_TEXT] = "text",       [FIELD_PATH] = "file",
        [FIELD_FILE] = "file",         [FIELD_SECTION] = "section", [FIELD_NAMED] = "name",
        [FIELD_ENTRIES] = "list",      [FIELD_SPECIAL] = "special",
    };
    return field->kind == FIELD_SPECIAL && field->is_list ? "list" : kinds[field->kind];
}

static const char *unit_of(const struct field *field)
{
    if (field->unit)
        return field->unit;
    switch (field->kind) {
    case FIELD_QUANTITY:
        return quantity_texts[field->quantity].units;
    case FIELD_BOOL:
        return "true or false";
    case FIELD_PATH:
    case FIELD_FILE:
        return "file name";
    case FIELD_COUNT32:
    case FIELD_COUNT64:
        return "whole number";
    default:
        return kind_of(field);
    }
}

bool field_is_file(const struct field *field)
{
    return strncmp(unit_of(field), "file name", 9) == 0;
}

bool field_is_number(const struct field *field)
{
    return is_count(field) ||
           (field->kind == FIELD_SPECIAL && strstr(unit_of(field), "number") != NULL);
}

bool field_quantity(const struct field *field, enum quantity *quantity)
{
    *quantity = field->quantity;
    if (field->kind == FIELD_QUANTITY)
        return true;
    for (size_t i = 0; strcmp(kind_of(field), "special") == 0 && i < COUNT(quantity_texts); i++)
        if (strcmp(unit_of(field), quantity_texts[i].units) == 0) {
            *quantity = (enum quantity)i;
            return true;
        }
    return false;
}

/* Returns whether the section's choice names the key. Such a key has no default. */
static bool is_of_choice(const struct section *section, const char *key)
{
    const char *choice = section->choice && !section->may_lack ? section->choice : "";
    const size_t length = strlen(key);
    for (const char *at = choice; *at; at += strcspn(at, " +"), at += *at != 0)
        if (strncmp(at, key, length) == 0 && strchr(" +", at[length]))
            return true;
    return false;
}

/* Writes the default as scene files may say it; "" for none, or for one that is out of bounds. */
static void tell_preset(const struct section *section, const struct field *field, char text[64])
{
    const double preset = shown(field, field->preset);
    const bool is_none = field->is_required || field->hides_preset ||
                         is_of_choice(section, field->key) || isnan(preset) ||
                         (preset == 0.0 && !field->words[0] && !is_within(field, 0.0)) ||
                         (preset == 0.0 && (field->bounds & ZERO_IS_NONE));
    text[0] = 0;
    if (is_none)
        return;
    if (field->kind == FIELD_WORD)
        snprintf(text, 64, "%s", field->words[(size_t)preset]);
    else if (field->kind == FIELD_BOOL)
        snprintf(text, 64, "%s", preset != 0.0 ? "true" : "false");
    else if (is_count(field))
        snprintf(text, 64, "%.15g", preset);
    else if (field->kind == FIELD_QUANTITY && field->quantity == QUANTITY_LEVEL && preset > 0.0)
        snprintf(text, 64, "%.4g dB", 10.0 * log10(preset));
    else if (field->kind == FIELD_QUANTITY && field->quantity == QUANTITY_ANGLE)
        snprintf(text, 64, "%.4g deg", preset);
    else if (field->kind == FIELD_QUANTITY)
        snprintf(text, 64, "%.6g%s", preset, quantity_texts[field->quantity].si);
    for (size_t i = 0; field->kind == FIELD_QUANTITY && field->words[i]; i++)
        if (field->preset == field->word_values[i])
            snprintf(text, 64, "%s", field->words[i]);
}

/* Returns whether a key may be a single value. A section that may be one has a unit. */
static bool has_value(const struct field *field)
{
    return field->kind == FIELD_WORD || field->kind == FIELD_NAMED ||
           field->kind == FIELD_QUANTITY || !field->section || (field->unit && !field->is_list);
}

static json_t *json_or_null(bool is_there, json_t *value)
{
    if (is_there)
        return value;
    json_decref(value);
    return json_null();
}

static json_t *json_of_field(const char *prefix, const struct section *section,
                             const struct field *field)
{
    char preset[64], range[200];
    const int prefix_length = (int)strlen(prefix) - (*prefix != 0);
    const bool is_bounded = is_number(field) && has_bounds(field);
    json_t *words = field->words[0] ? json_array() : NULL;
    for (uint32_t i = 0; words && i < count_words(field); i++)
        if (*field->words[i])
            json_append(&words, json_string(field->words[i]));
    tell_preset(section, field, preset);
    tell_range(field, range);
    return json_pack("{s:o, s:o, s:s, s:s, s:s, s:b, s:b, s:b, s:o?, s:o, s:o, s:o, s:o, s:o}",
                     "path", json_sprintf("%s%s", prefix, field->key), "section",
                     json_sprintf("%.*s", prefix_length, prefix), "meaning", field->meaning, "kind",
                     kind_of(field), "unit", unit_of(field), "has_value", (int)has_value(field),
                     "is_list", (int)field->is_list, "is_required", (int)field->is_required,
                     "words", words, "default", json_or_null(*preset, json_string(preset)), "range",
                     json_or_null(*range, json_string(range)), "preset",
                     json_or_null(*preset && (is_number(field) || field->kind == FIELD_WORD),
                                  json_number(field->preset)),
                     "least", json_or_null(is_bounded, json_number(field->least)), "most",
                     json_or_null(is_bounded, json_number(field->most)));
}

/* Tables do not refer to themselves: parts within parts are listed as one key. */
static void add_json(json_t **keys, const char *prefix, const struct section *section)
{
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        char below[80];
        if (field->is_hidden)
            continue;
        json_append(keys, json_of_field(prefix, section, field));
        snprintf(below, sizeof below, "%s%s%s", prefix, field->key, field->is_list ? "[]." : ".");
        if (field->section)
            add_json(keys, below, field->section);
    }
}

sonject_status section_keys_json(struct report *report, const struct section *section, char **text)
{
    json_t *keys = json_array();
    add_json(&keys, "", section);
    *text = json_document_text(keys, JSON_INDENT(1) | JSON_REAL_PRECISION(15));
    json_decref(keys);
    return *text ? SONJECT_OK : report_out_of_memory(report, "the keys");
}

/* ---- Finding a key. */

const struct field *field_of(const struct section *section, const char *key, size_t length)
{
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        if (!field->is_hidden && strlen(field->key) == length &&
            memcmp(field->key, key, length) == 0)
            return field;
    }
    return NULL;
}

const char *nearest_key(const struct section *section, const char *key, size_t length,
                        struct word_list *list)
{
    const char *keys[KEYS_LISTED];
    char typed[32] = "";
    for (size_t i = 0; i < section->count && list->count < COUNT(keys); i++)
        if (!section->fields[i].is_hidden) {
            keys[list->count] = section->fields[i].key;
            list_word(list, section->fields[i].key);
        }
    if (length >= sizeof typed)
        return NULL;
    memcpy(typed, key, length);
    return nearest_word(typed, keys, list->count);
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
            struct word_list list = {{0}, 0};
            *near = nearest_key(*section, path, length, &list);
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

bool scene_key_is_known(const char *path, char hint[HINT_CAPACITY])
{
    const char *near;
    const struct section *section;
    const bool is_known = scene_key_find(&scene_section, path, &near, &section);
    hint[0] = '\0';
    if (near)
        snprintf(hint, HINT_CAPACITY, "; did you mean '%s'?", near);
    return is_known;
}

sonject_status check_scene_keys(const struct tree *tree, const struct tree_node *node,
                                struct key_path *path, const char *what, const char *behind)
{
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        char hint[HINT_CAPACITY];
        const size_t before =
            entry->key ? key_path_add(path, entry->key) : key_path_add_index(path, i);
        if (entry->key && !scene_key_is_known(path->text, hint))
            return tree_failure(tree, entry->place, path->text, "%s%s%s", what, hint, behind);
        CHECK(check_scene_keys(tree, &entry->value, path, what, behind));
        key_path_shorten(path, before);
    }
    return SONJECT_OK;
}
