/* The values of a scene, read back key by key. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/text.h"
#include "schema/keys.h"
#include "schema/scene_file.h"

/* A value of the tree, and what the tables know about the value. */
struct spot {
    struct tree_node *node;
    const struct field *field;     /* row of its key; NULL: the scene itself, or an unknown key */
    const struct section *section; /* section of the keys within; NULL: none are known */
};

/* Stands for the section `bands`, whose keys are names, each with the keys of scenes. */
static const struct section names_of_bands;

/* Returns the spot of an entry. A list's entries are values of the list's key. */
static struct spot entry_of(const struct spot *spot, size_t index)
{
    struct tree_entry *entry = &spot->node->entries[index];
    struct spot below = {&entry->value, spot->field, spot->section};
    if (!entry->key)
        return below;
    below.field = NULL;
    below.section = spot->section == &names_of_bands ? &scene_section : NULL;
    if (!spot->section || below.section)
        return below;
    below.field = field_of(spot->section, entry->key, strlen(entry->key));
    below.section = below.field ? below.field->section : NULL;
    if (spot->section == &scene_section && strcmp(entry->key, "bands") == 0)
        below.section = &names_of_bands;
    else if (spot->section == &part_section && strcmp(entry->key, "parts") == 0)
        below.section = &part_section; /* the table of parts does not refer to itself */
    return below;
}

static struct spot whole_scene(struct scene_source *source)
{
    const struct spot all = {&source->tree.root, NULL, &scene_section};
    return all;
}

/* ---- Names of files. */

static const struct number_array *array_of(const struct scene_source *source, const char *name)
{
    const struct reader reader = {.arrays = source->arrays, .array_count = source->array_count};
    return find_array(&reader, name);
}

/* Returns whether a text names a file: no array in memory, nor `auto`, a calibration to be made. */
static bool is_file(const struct scene_source *source, const struct spot *spot)
{
    const struct tree_node *node = spot->node;
    if (!spot->field || !field_is_file(spot->field) || node->kind != TREE_TEXT ||
        tree_is_null(node) || !*node->text || array_of(source, node->text))
        return false;
    return strcmp(spot->field->key, "calibration") != 0 || !is_word(node, "auto");
}

/* Returns an absolute name, for free(), or NULL if memory is out. A name in the text is relative to
 * the text's folder, any other to the user's working folder. */
static char *absolute_name(const struct scene_source *source, const struct tree_node *node)
{
    char *folder = node->place.override ? copy_text("") : path_folder(source->path);
    char *joined = folder ? path_join(folder, node->text) : NULL;
    char *name = joined ? path_absolute(joined) : NULL;
    free(folder);
    free(joined);
    return name;
}

static bool name_files(const struct scene_source *source, const struct spot *spot)
{
    bool are_named = true;
    if (is_file(source, spot)) {
        char *name = absolute_name(source, spot->node);
        if (!name)
            return false;
        free(spot->node->text);
        spot->node->text = name;
    }
    for (size_t i = 0; are_named && i < spot->node->count; i++) {
        const struct spot below = entry_of(spot, i);
        are_named = name_files(source, &below);
    }
    return are_named;
}

sonject_status name_files_absolutely(struct scene_source *source, struct report *report)
{
    const struct spot all = whole_scene(source);
    CHECK_MEMORY(report, name_files(source, &all), "names of files");
    return SONJECT_OK;
}

/* ---- Values. */

/* Returns the text as it stands where it is UTF-8, else its printable form. */
static json_t *json_as_it_is(const char *text)
{
    json_t *value = json_string(text);
    return value ? value : json_text(text);
}

static json_t *json_of_quantity(enum quantity quantity, const char *text)
{
    char problem[200];
    const char *unit;
    double value, written;
    if (!quantity_from_text(quantity, text, &value, problem, sizeof problem) || !isfinite(value))
        return json_as_it_is(text);
    if (quantity == QUANTITY_ANGLE && text_to_number(text, &written, &unit))
        value = strstr(unit, "rad") ? value * DEGREES_PER_RADIAN : written;
    return json_real(value);
}

/* Returns a plain number. Whole numbers stay whole. */
static json_t *json_of_number(const char *text)
{
    uint64_t count;
    double number;
    const char *rest;
    if (text_to_count(text, &count))
        return json_seed(count);
    if (text_to_number(text, &number, &rest) && !*rest && isfinite(number))
        return json_real(number);
    return json_as_it_is(text);
}

static json_t *json_of_array(const struct number_array *array)
{
    json_t *values = json_array();
    for (size_t i = 0; i < array->rows; i++) {
        json_t *row = json_array();
        for (size_t k = 0; k < array->column_count; k++)
            json_append(&row, json_number(array->values[i * array->column_count + k]));
        json_append(&values, row);
    }
    return JSON_OBJECT({"columns", array->columns ? json_text(array->columns) : json_null()},
                       {"values", values});
}

static json_t *json_of_file(const struct scene_source *source, const struct tree_node *node)
{
    char *name = absolute_name(source, node);
    json_t *value = name ? json_as_it_is(name) : NULL;
    free(name);
    return value;
}

static json_t *json_of_text(const struct scene_source *source, const struct spot *spot)
{
    const struct field *field = spot->field;
    const char *text = spot->node->text;
    enum quantity quantity;
    if (tree_is_null(spot->node))
        return json_null();
    if (is_file(source, spot))
        return json_of_file(source, spot->node);
    if (array_of(source, text))
        return json_of_array(array_of(source, text));
    if (!field)
        return json_as_it_is(text);
    if (field_quantity(field, &quantity))
        return json_of_quantity(quantity, text);
    if (field->kind == FIELD_BOOL && (is_word(spot->node, "true") || is_word(spot->node, "false")))
        return json_boolean(is_word(spot->node, "true"));
    return field_is_number(field) ? json_of_number(text) : json_as_it_is(text);
}

static json_t *json_of(const struct scene_source *source, const struct spot *spot)
{
    const struct tree_node *node = spot->node;
    if (node->kind == TREE_TEXT)
        return json_of_text(source, spot);
    json_t *whole = node->kind == TREE_LIST ? json_array() : json_object();
    for (size_t i = 0; i < node->count; i++) {
        const struct spot below = entry_of(spot, i);
        if (node->kind == TREE_LIST)
            json_append(&whole, json_of(source, &below));
        else
            json_add(&whole, node->entries[i].key, json_of(source, &below));
    }
    return whole;
}

/* ---- Keys. */

/* Goes down to the entry that a step "heading" or "[0]" of a path names, length bytes long. Returns
 * false if there is none. */
static bool go_down(struct spot *spot, const char *step, size_t length)
{
    for (size_t i = 0; i < spot->node->count; i++) {
        struct key_path index = {"", 0};
        const char *key = spot->node->entries[i].key;
        if (!key)
            key_path_add_index(&index, i);
        const char *name = key ? key : index.text;
        if (strlen(name) == length && memcmp(name, step, length) == 0) {
            *spot = entry_of(spot, i);
            return true;
        }
    }
    return false;
}

static bool find_spot(struct spot *spot, const char *path)
{
    while (*path) {
        const size_t length = *path == '[' ? strcspn(path, "]") + (path[strcspn(path, "]")] == ']')
                                           : strcspn(path, ".[");
        if (!go_down(spot, path, length))
            return false;
        path += length;
        path += *path == '.';
    }
    return true;
}

sonject_status scene_source_get(struct scene_source *source, struct report *report, const char *key,
                                char **json)
{
    char hint[HINT_CAPACITY];
    *json = NULL;
    if (*key && !scene_key_is_known(key, hint))
        return input_failure(report, key, "there is no such key%s", hint);
    CHECK(scene_source_keep_tree(source, report));
    struct spot spot = whole_scene(source);
    json_t *value = find_spot(&spot, key) ? json_of(source, &spot) : json_null();
    *json = json_document_text(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    json_decref(value);
    return *json ? SONJECT_OK : report_out_of_memory(report, "what the scene says");
}
