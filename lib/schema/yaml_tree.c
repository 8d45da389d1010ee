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

/* Clears a node by recursion, which is at most TREE_DEPTH_MAX deep. */
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

sonject_status tree_append(struct tree *tree, struct tree_node *node, const struct key_path *path,
                           const char *key, struct tree_place place, struct tree_entry **entry)
{
    if (key && node->count >= TREE_KEYS_MAX)
        return tree_failure(tree, place, path->text, "has more than %d keys; remove some",
                            TREE_KEYS_MAX);
    if (tree->node_count >= TREE_NODES_MAX)
        return tree_failure(tree, place, path->text,
                            "is one value too many: a file may have %d; split it", TREE_NODES_MAX);
    CHECK(grow_list(tree->report, &node->entries, node->count, sizeof *node->entries,
                    "the scene file"));
    char *own_key = key ? copy_text(key) : NULL;
    if (key && !own_key)
        return report_out_of_memory(tree->report, "the scene file");
    tree->node_count++;
    *entry = &node->entries[node->count++];
    (*entry)->key = own_key;
    (*entry)->place = place;
    (*entry)->value.place = place;
    return SONJECT_OK;
}

struct tree_entry *tree_find(const struct tree_node *node, const char *key)
{
    if (node->kind == TREE_SECTION)
        for (size_t i = 0; i < node->count; i++)
            if (strcmp(node->entries[i].key, key) == 0)
                return &node->entries[i];
    return NULL;
}

struct tree_node *tree_value(const struct tree_node *node, const char *key)
{
    struct tree_entry *entry = node ? tree_find(node, key) : NULL;
    return entry ? &entry->value : NULL;
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
    size_t number = 0; /* number of the override */
    while (number < tree->override_count && tree->override_paths[number] != place.override)
        number++;
    if (place.override)
        snprintf(text, TREE_PLACE_TEXT, "%s %s", number < tree->given_overrides ? "--set" : "set",
                 text_excerpt(name, sizeof name, place.override));
    else
        snprintf(text, TREE_PLACE_TEXT, "%s:%zu:%zu", text_excerpt(name, sizeof name, tree->file),
                 place.line, place.column);
}

/* Leaves the key out of the message where the override's own path gives it already. */
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

/* Long keys are cut, so that at least the first few keys of a path fit. */
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

/* Returns whether a text needs no quotes in flow style: only letters, digits and a few signs. */
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

void tree_write_text(const char *text, struct growing_text *out)
{
    const struct tree_node unquoted = {.kind = TREE_TEXT, .text = (char *)text};
    if (is_plain(text) && !tree_is_null(&unquoted))
        growing_text_add(out, "%s", text);
    else
        write_quoted(text, out);
}

void tree_write_flow(const struct tree_node *node, struct growing_text *text)
{
    if (node->kind == TREE_TEXT) {
        if (tree_is_null(node))
            growing_text_add(text, "null");
        else
            tree_write_text(node->text, text);
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

/* ---- Overrides "key.path=value" of a tree. */

#define HOW_TO_WRITE "not a key path; write it as 'objects[0].heading'"

/* The most steps of a path: deeper than any key of a scene, with room for the value below. */
#define PATH_STEPS_MAX 24

struct walk {
    struct tree *tree;
    struct tree_place place; /* place of the values that the override makes */
    struct tree_node *node;  /* the node reached so far */
    struct key_path path;    /* path of that node */
    int steps;
};

static bool is_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
}

static sonject_status refuse(const struct walk *walk, const char *what)
{
    return tree_failure(walk->tree, walk->place, walk->place.override, "%s", what);
}

static sonject_status enter(struct walk *walk, enum tree_kind kind)
{
    static const char *const names[] = {"a value", "a list", "a section"};
    if (++walk->steps > PATH_STEPS_MAX)
        return refuse(walk, "nested too deeply; no key of a scene is");
    if (tree_is_null(walk->node)) {
        tree_node_clear(walk->node);
        walk->node->kind = kind;
        walk->node->place = walk->place;
    }
    if (walk->node->kind != kind)
        return tree_failure(walk->tree, walk->place, walk->place.override,
                            "%s is %s in the file, not %s; give the whole of it",
                            walk->path.length ? walk->path.text : "the document",
                            names[walk->node->kind], names[kind]);
    return SONJECT_OK;
}

static sonject_status step_to(struct walk *walk, struct tree_entry *entry, const char *key)
{
    sonject_status status = SONJECT_OK;
    if (!entry)
        status = tree_append(walk->tree, walk->node, &walk->path, key, walk->place, &entry);
    if (status == SONJECT_OK)
        walk->node = &entry->value;
    return status;
}

static sonject_status enter_key(struct walk *walk, const char *name, size_t length)
{
    char key[64];
    if (length == 0 || length >= sizeof key)
        return refuse(walk, HOW_TO_WRITE);
    memcpy(key, name, length);
    key[length] = 0;
    CHECK(enter(walk, TREE_SECTION));
    key_path_add(&walk->path, key);
    return step_to(walk, tree_find(walk->node, key), key);
}

static sonject_status enter_index(struct walk *walk, const char *digits, size_t length)
{
    char text[24];
    uint64_t index;
    if (length == 0 || length >= sizeof text)
        return refuse(walk, HOW_TO_WRITE);
    memcpy(text, digits, length);
    text[length] = 0;
    if (!text_to_count(text, &index))
        return refuse(walk, "not a key path; an index must be a whole number from 0");
    CHECK(enter(walk, TREE_LIST));
    if (index > walk->node->count)
        return tree_failure(walk->tree, walk->place, walk->place.override,
                            "%s has %zu entries, counted from 0; [%zu] would add one",
                            walk->path.text, walk->node->count, walk->node->count);
    key_path_add_index(&walk->path, (size_t)index);
    return step_to(walk, index < walk->node->count ? &walk->node->entries[index] : NULL, NULL);
}

/* Follows the path and makes the nodes that are missing. */
static sonject_status follow(struct walk *walk, const char *path)
{
    sonject_status status = SONJECT_OK;
    bool is_first = true;
    while (status == SONJECT_OK && (*path || is_first)) {
        const char *start = path;
        if (*path == '[' && !is_first) {
            start++;
            path += strcspn(path, "]");
            status = enter_index(walk, start, (size_t)(path - start));
            path += *path == ']';
            if (status == SONJECT_OK && path[-1] != ']')
                status = refuse(walk, "not a key path; ']' is missing");
            continue;
        }
        if (!is_first && *path != '.')
            return refuse(walk, HOW_TO_WRITE);
        start += !is_first;
        path = start;
        while (is_word(*path))
            path++;
        status = enter_key(walk, start, (size_t)(path - start));
        is_first = false;
    }
    return status;
}

/* Returns the text without the blanks around it, for free(). */
static char *trimmed(const char *text, size_t length)
{
    while (length > 0 && (*text == ' ' || *text == '\t')) {
        text++;
        length--;
    }
    while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\t'))
        length--;
    char *copy = malloc(length + 1);
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = 0;
    }
    return copy;
}

static sonject_status keep_path(struct tree *tree, const char *path, size_t length,
                                const char **kept)
{
    char **paths = realloc(tree->override_paths, (tree->override_count + 1) * sizeof *paths);
    CHECK_MEMORY(tree->report, paths, "an override");
    tree->override_paths = paths;
    paths[tree->override_count] = trimmed(path, length);
    CHECK_MEMORY(tree->report, paths[tree->override_count], "an override");
    *kept = paths[tree->override_count++];
    return SONJECT_OK;
}

/* Sets the node to the value, which is not empty. Takes ownership of the value. */
static sonject_status set_value(struct walk *walk, char *value)
{
    sonject_status status = SONJECT_OK;
    tree_node_clear(walk->node);
    walk->node->place = walk->place;
    if (!strchr("{[\"'", *value)) {
        walk->node->text = value;
        return SONJECT_OK;
    }
    status = tree_parse_value(walk->tree, walk->place.override, value, walk->steps, walk->node);
    free(value);
    if (status != SONJECT_OK) /* the value is not kept: the key is only known to be wrong */
        tree_node_clear(walk->node);
    if (status != SONJECT_OK && walk->tree->mistakes)
        mistakes_add(walk->tree->mistakes, walk->tree, &walk->place, walk->place.override, NULL);
    return status;
}

sonject_status tree_override(struct tree *tree, const char *override, const struct tree_node **node)
{
    const char *equals = strchr(override, '=');
    const struct tree_place whole = {override, 1, 1};
    if (!equals)
        return tree_failure(tree, whole, override, "has no '='; write key.path=value");
    struct walk walk = {.tree = tree, .node = &tree->root};
    sonject_status status =
        keep_path(tree, override, (size_t)(equals - override), &walk.place.override);
    if (status != SONJECT_OK)
        return status;
    if (strlen(equals) > TREE_BYTES_MAX)
        return refuse(&walk, "the value is too long");
    char *value = trimmed(equals + 1, strlen(equals + 1));
    CHECK_MEMORY(tree->report, value, "an override");
    if (!*value)
        status = refuse(&walk, "has no value; write key.path=value");
    else if (!text_is_printable(value) || !text_is_printable(walk.place.override))
        status = refuse(&walk, "not UTF-8 text on one line");
    THEN(status, follow(&walk, walk.place.override));
    if (status != SONJECT_OK) {
        free(value);
        return status;
    }
    if (node)
        *node = walk.node;
    return set_value(&walk, value);
}
