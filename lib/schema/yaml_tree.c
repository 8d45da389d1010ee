#include "schema/yaml_tree.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

void tree_init(struct tree *tree, struct report *report, const char *file)
{
    memset(tree, 0, sizeof *tree);
    tree->report = report;
    tree->file = file;
    tree->given_overrides = SIZE_MAX;
}

void tree_clear(struct tree *tree)
{
    tree_node_clear(&tree->root);
    for (size_t i = 0; i < tree->override_count; i++)
        free(tree->override_paths[i]);
    free(tree->override_paths);
    tree_init(tree, tree->report, tree->file);
}

/* Trees are at most TREE_DEPTH_MAX deep, and so is this. */
void tree_node_clear(struct tree_node *node)
{
    for (size_t i = 0; i < node->count; i++) {
        free(node->entries[i].key);
        tree_node_clear(&node->entries[i].value);
    }
    free(node->entries);
    free(node->text);
    const struct tree_place place = node->place;
    memset(node, 0, sizeof *node);
    node->place = place;
}

static sonject_status make_room(struct tree *tree, struct tree_node *node)
{
    if (node->count < node->capacity)
        return SONJECT_OK;
    const size_t capacity = node->capacity == 0 ? 4 : 2 * node->capacity;
    struct tree_entry *entries = realloc(node->entries, capacity * sizeof *entries);
    if (!entries)
        return report_out_of_memory(tree->report, "the scene file");
    node->entries = entries;
    node->capacity = capacity;
    return SONJECT_OK;
}

sonject_status tree_append(struct tree *tree, struct tree_node *node, const struct key_path *path,
                           const char *key, struct tree_place place, struct tree_entry **entry)
{
    if (key && node->count >= TREE_KEYS_MAX)
        return tree_failure(tree, place, path->text, "has more than %d keys; remove some",
                            TREE_KEYS_MAX);
    if (tree->node_count >= TREE_NODES_MAX)
        return tree_failure(tree, place, path->text,
                            "is one value too many: a file may have %d; split it", TREE_NODES_MAX);
    CHECK(make_room(tree, node));
    char *own_key = key ? copy_text(key) : NULL;
    if (key && !own_key)
        return report_out_of_memory(tree->report, "the scene file");
    tree->node_count++;
    *entry = &node->entries[node->count++];
    memset(*entry, 0, sizeof **entry);
    (*entry)->key = own_key;
    (*entry)->place = place;
    (*entry)->value.place = place;
    return SONJECT_OK;
}

const struct tree_entry *tree_find(const struct tree_node *node, const char *key)
{
    if (node->kind == TREE_SECTION)
        for (size_t i = 0; i < node->count; i++)
            if (strcmp(node->entries[i].key, key) == 0)
                return &node->entries[i];
    return NULL;
}

bool tree_is_null(const struct tree_node *node)
{
    if (node->kind != TREE_TEXT || node->is_quoted)
        return false;
    return !node->text || strcmp(node->text, "") == 0 || strcmp(node->text, "~") == 0 ||
           strcmp(node->text, "null") == 0;
}

void tree_place_text(const struct tree *tree, struct tree_place place, char text[TREE_PLACE_TEXT])
{
    char name[240];
    size_t number = 0; /* of the override */
    while (number < tree->override_count && tree->override_paths[number] != place.override)
        number++;
    if (place.override)
        snprintf(text, TREE_PLACE_TEXT, "%s %s", number < tree->given_overrides ? "--set" : "set",
                 text_excerpt(name, sizeof name, place.override));
    else
        snprintf(text, TREE_PLACE_TEXT, "%s:%zu:%zu", text_excerpt(name, sizeof name, tree->file),
                 place.line, place.column);
}

/* The key is left out where the override's own path says it already. */
sonject_status tree_failure(const struct tree *tree, struct tree_place place, const char *path,
                            const char *format, ...)
{
    char where[TREE_PLACE_TEXT];
    char what[REPORT_LINE], line[2 * REPORT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    tree_place_text(tree, place, where);
    const bool is_told = *path == 0 || (place.override && strcmp(path, place.override) == 0);
    snprintf(line, sizeof line, "%s%s%s: %s", where, is_told ? "" : ": ", is_told ? "" : path,
             what);
    text_make_printable(line);
    if (!tree->mistakes)
        return report_failure(tree->report, SONJECT_ERROR_INPUT, "%s", line);
    mistakes_add(tree->mistakes, tree, &place, path, line);
    return SONJECT_ERROR_INPUT;
}

static size_t add_text(struct key_path *path, const char *text)
{
    const size_t before = path->length;
    text_excerpt(path->text + before, sizeof path->text - before, text);
    path->length += strlen(path->text + before);
    return before;
}

/* Long keys are cut, so that at least the first few of a path fit. */
size_t key_path_add(struct key_path *path, const char *key)
{
    char part[64];
    const size_t before = path->length;
    part[0] = '.';
    text_excerpt(part + 1, sizeof part - 1, key);
    if (before + sizeof part <= sizeof path->text)
        add_text(path, before == 0 ? part + 1 : part);
    return before;
}

size_t key_path_add_index(struct key_path *path, size_t index)
{
    char part[32];
    const size_t before = path->length;
    snprintf(part, sizeof part, "[%zu]", index);
    if (before + sizeof part <= sizeof path->text)
        add_text(path, part);
    return before;
}

void key_path_shorten(struct key_path *path, size_t length)
{
    path->length = length;
    path->text[length] = 0;
}

static bool is_plain_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           (c && strchr("_./+-", c));
}

/* Fit to stand in flow style without quotes: words of letters, digits and a few signs. */
static bool is_plain(const char *text)
{
    const size_t length = strlen(text);
    if (length == 0 || !is_plain_character(text[length - 1]) || text[0] == '-' ||
        !is_plain_character(text[0]))
        return length > 1 && text[0] == '-' && is_plain(text + 1) && text[1] != ' ';
    for (size_t i = 0; i < length; i++)
        if (!is_plain_character(text[i]) && text[i] != ' ')
            return false;
    return true;
}

static void write_quoted(const char *text, struct growing_text *out)
{
    growing_text_add(out, "\"");
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            growing_text_add(out, "\\%c", c);
        else if (c < 0x20 || c == 0x7F)
            growing_text_add(out, "\\x%02X", c);
        else
            growing_text_add(out, "%c", c);
    }
    growing_text_add(out, "\"");
}

void tree_write_flow(const struct tree_node *node, struct growing_text *text)
{
    if (node->kind == TREE_TEXT) {
        const struct tree_node unquoted = {.kind = TREE_TEXT, .text = node->text};
        if (tree_is_null(node))
            growing_text_add(text, "null");
        else if (is_plain(node->text) && !tree_is_null(&unquoted))
            growing_text_add(text, "%s", node->text);
        else
            write_quoted(node->text, text);
        return;
    }
    growing_text_add(text, node->kind == TREE_LIST ? "[" : "{");
    for (size_t i = 0; i < node->count; i++) {
        if (i > 0)
            growing_text_add(text, ", ");
        if (node->kind == TREE_SECTION) {
            write_quoted(node->entries[i].key, text);
            growing_text_add(text, ": ");
        }
        tree_write_flow(&node->entries[i].value, text);
    }
    growing_text_add(text, node->kind == TREE_LIST ? "]" : "}");
}

sonject_status tree_override_text(struct report *report, const struct tree_node *node, char **text)
{
    struct growing_text flow = {NULL, 0, 0, false};
    tree_write_flow(node, &flow);
    *text = growing_text_end(&flow);
    return *text ? SONJECT_OK : report_out_of_memory(report, "a value");
}
