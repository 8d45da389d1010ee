/* Overrides "key.path=value" of a tree. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "schema/yaml_tree.h"

#define HOW_TO_WRITE "not a key path; write it as 'objects[0].heading'"

/* Deeper than any key of a scene, with room for the value below it. */
#define PATH_STEPS_MAX 24

struct walk {
    struct tree *tree;
    struct tree_place place; /* for what the override makes */
    struct tree_node *node;  /* reached so far */
    struct key_path path;    /* of it */
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
    struct tree_entry *found = NULL;
    for (size_t i = 0; i < walk->node->count && !found; i++)
        if (strcmp(walk->node->entries[i].key, key) == 0)
            found = &walk->node->entries[i];
    key_path_add(&walk->path, key);
    return step_to(walk, found, key);
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

/* Follows the path, making what is not there. */
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

/* Text without the blanks around it, for free(). */
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
    if (!paths)
        return report_out_of_memory(tree->report, "an override");
    tree->override_paths = paths;
    paths[tree->override_count] = trimmed(path, length);
    if (!paths[tree->override_count])
        return report_out_of_memory(tree->report, "an override");
    *kept = paths[tree->override_count++];
    return SONJECT_OK;
}

/* Sets the node to the value, which is not empty; takes ownership of it. */
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
    if (status != SONJECT_OK) /* nothing of it is read: the key is only known to be wrong */
        tree_node_clear(walk->node);
    if (status != SONJECT_OK && walk->tree->mistakes)
        mistakes_add(walk->tree->mistakes, walk->tree, &walk->place, walk->place.override, NULL);
    return status;
}

sonject_status tree_override(struct tree *tree, const char *override)
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
    if (!value)
        return report_out_of_memory(tree->report, "an override");
    if (!*value)
        status = refuse(&walk, "has no value; write key.path=value");
    else if (!text_is_printable(value) || !text_is_printable(walk.place.override))
        status = refuse(&walk, "not UTF-8 text on one line");
    THEN(status, follow(&walk, walk.place.override));
    if (status == SONJECT_OK)
        return set_value(&walk, value);
    free(value);
    return status;
}
