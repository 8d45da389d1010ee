/* What readers of sections say about mistakes, and what they ask about keys. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "schema/scene_schema.h"

static sonject_status refuse_at(const struct reader *reader, struct tree_place place,
                                const char *format, va_list arguments)
{
    char what[REPORT_LINE];
    vsnprintf(what, sizeof what, format, arguments);
    return tree_failure(reader->tree, place, reader->path.text, "%s", what);
}

sonject_status refuse_value(const struct reader *reader, const struct tree_node *node,
                            const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const sonject_status status = refuse_at(reader, node->place, format, arguments);
    va_end(arguments);
    return status;
}

/* Where the key of a section node is, or the section itself where it is not. */
static struct tree_place place_of_key(const struct tree_node *node, const char *key)
{
    struct tree_place place = node->place;
    while (node && *key) {
        char step[64];
        const size_t length = strcspn(key, ".");
        snprintf(step, sizeof step, "%.*s", (int)length, key);
        const struct tree_entry *entry = tree_find(node, step);
        node = entry ? &entry->value : NULL;
        place = entry ? entry->value.place : place;
        key += length + (key[length] == '.');
    }
    return place;
}

/* Takes the first of some keys, which blanks separate. False where there is none. */
static bool next_key(const char **keys, char key[64])
{
    const size_t length = strcspn(*keys, " ");
    snprintf(key, 64, "%.*s", (int)length, *keys);
    *keys += length + ((*keys)[length] == ' ');
    return *key != 0;
}

bool are_sound(struct reader *reader, const char *keys)
{
    char key[64];
    while (next_key(&keys, key)) {
        const size_t before = key_path_add(&reader->path, key);
        const bool is_wrong =
            mistakes_concern(reader->tree->mistakes, reader->tree, reader->path.text);
        key_path_shorten(&reader->path, before);
        if (is_wrong)
            return false;
    }
    return true;
}

size_t count_given(const struct tree_node *node, const char *keys)
{
    char key[64];
    size_t count = 0;
    while (next_key(&keys, key))
        count += is_given(node, key);
    return count;
}

void mark_wrong(struct reader *reader, const struct tree_node *node, const char *key)
{
    const size_t before = *key ? key_path_add(&reader->path, key) : reader->path.length;
    mistakes_add(reader->tree->mistakes, reader->tree, &node->place, reader->path.text, NULL);
    key_path_shorten(&reader->path, before);
}

static sonject_status refuse_of(struct reader *reader, const struct tree_node *node,
                                const char *key, const char *others, const char *format,
                                va_list arguments)
{
    if (!are_sound(reader, key) || !are_sound(reader, others))
        return SONJECT_ERROR_INPUT;
    const size_t before = key_path_add(&reader->path, key);
    const sonject_status status = refuse_at(reader, place_of_key(node, key), format, arguments);
    key_path_shorten(&reader->path, before);
    return status;
}

sonject_status refuse_key(struct reader *reader, const struct tree_node *node, const char *key,
                          const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const sonject_status status = refuse_of(reader, node, key, "", format, arguments);
    va_end(arguments);
    return status;
}

sonject_status refuse_relation(struct reader *reader, const struct tree_node *node, const char *key,
                               const char *others, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const sonject_status status = refuse_of(reader, node, key, others, format, arguments);
    va_end(arguments);
    return status;
}

/* The listener is the reader's first member. */
static void hear(struct check_listener *listener, const char *key, const char *others,
                 const char *what)
{
    struct reader *reader = (struct reader *)listener;
    refuse_relation(reader, reader->checked, key, others, "%s", what);
}

struct check_listener *listen_at(struct reader *reader, const struct tree_node *node)
{
    reader->listener.hear = hear;
    reader->checked = node;
    return &reader->listener;
}

bool is_given(const struct tree_node *node, const char *key)
{
    return tree_find(node, key) != NULL;
}

sonject_status check_one_given(struct reader *reader, const struct tree_node *node,
                               const char *keys, const char *choice)
{
    const size_t given = count_given(node, keys);
    if (given == 1)
        return SONJECT_OK;
    if (given == 0 && !are_sound(reader, keys))
        return SONJECT_ERROR_INPUT; /* one is there, misspelt */
    return refuse_value(reader, node, "%s of %s is there; give one",
                        given == 0 ? "none" : "more than one", choice);
}
