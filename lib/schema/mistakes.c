/* The mistakes of a file read to its end, ordered by place, and section readers' messages. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "schema/keys.h"

#define MISTAKES_MAX 1000 /* mistakes that are kept; nobody reads more */

struct mistake {
    size_t order[5]; /* override or not; number, or line and column; line, column in named file */
    char *file;      /* owned; its memory holds the two below */
    const char *path;
    const char *line; /* NULL: only marks the key as wrong */
};

static bool is_same(const struct mistake *mistake, const struct tree *tree, const char *path)
{
    return strcmp(mistake->path, path) == 0 && strcmp(mistake->file, tree->file) == 0;
}

static bool is_kept(const struct mistakes *mistakes, const struct tree *tree, const char *path)
{
    for (size_t i = 0; i < mistakes->count; i++)
        if (is_same(&mistakes->list[i], tree, path))
            return true;
    return false;
}

static void find_order(size_t order[5], const struct tree *tree, const struct tree_place *place)
{
    const bool is_named = tree->named_at.override || tree->named_at.line > 0;
    const struct tree_place *outer = is_named ? &tree->named_at : place;
    size_t number = 0; /* number of the override */
    while (number < tree->override_count && tree->override_paths[number] != outer->override)
        number++;
    order[0] = outer->override != NULL;
    order[1] = outer->override ? number : outer->line;
    order[2] = outer->override ? 0 : outer->column;
    order[3] = outer == place ? 0 : place->line;
    order[4] = outer == place ? 0 : place->column;
}

static bool is_behind(const size_t a[5], const size_t b[5])
{
    int i = 0;
    while (i < 4 && a[i] == b[i])
        i++;
    return a[i] > b[i];
}

void mistakes_add(struct mistakes *mistakes, const struct tree *tree,
                  const struct tree_place *place, const char *path, const char *line)
{
    struct mistake added = {.line = NULL};
    if (is_kept(mistakes, tree, path))
        return;
    const size_t file_bytes = strlen(tree->file) + 1;
    const size_t path_bytes = strlen(path) + 1;
    struct mistake *list = NULL;
    if (mistakes->count < MISTAKES_MAX)
        list = grow_doubling(mistakes->list, mistakes->count, sizeof *list);
    if (list)
        added.file = malloc(file_bytes + path_bytes + (line ? strlen(line) + 1 : 0));
    mistakes->list = list ? list : mistakes->list;
    if (!added.file) {
        mistakes->uncounted += line != NULL;
        return;
    }
    memcpy(added.file, tree->file, file_bytes);
    added.path = memcpy(added.file + file_bytes, path, path_bytes);
    if (line)
        added.line = strcpy(added.file + file_bytes + path_bytes, line);
    find_order(added.order, tree, place);
    size_t at = mistakes->count++;
    for (; at > 0 && is_behind(mistakes->list[at - 1].order, added.order); at--)
        mistakes->list[at] = mistakes->list[at - 1];
    mistakes->list[at] = added;
}

/* Returns whether the outer path is that of a section or list that holds the inner path's key. */
static bool holds(const char *outer, const char *inner)
{
    const size_t length = strlen(outer);
    return strncmp(inner, outer, length) == 0 && (length == 0 || strchr(".[", inner[length]));
}

bool mistakes_concern(const struct mistakes *mistakes, const struct tree *tree, const char *path)
{
    for (size_t i = 0; mistakes && i < mistakes->count; i++) {
        const struct mistake *mistake = &mistakes->list[i];
        if (strcmp(mistake->file, tree->file) == 0 &&
            (holds(mistake->path, path) || holds(path, mistake->path)))
            return true;
    }
    return false;
}

/* Joins the lines to one message, with room left for the number of those that do not fit. */
static void join(const struct mistakes *mistakes, struct report *report)
{
    const size_t room = sizeof report->message - 40;
    size_t length = 0;
    size_t told = 0;
    size_t untold = mistakes->uncounted;
    for (size_t i = 0; i < mistakes->count; i++) {
        const char *line = mistakes->list[i].line;
        if (line && told < MISTAKES_TOLD && length + strlen(line) + 1 < room) {
            length += (size_t)sprintf(report->message + length, "%s%s", told ? "\n" : "", line);
            told++;
        } else {
            untold += line != NULL;
        }
    }
    if (untold > 0)
        sprintf(report->message + length, "%sand %zu more", told ? "\n" : "", untold);
}

bool mistakes_are_relations(const struct mistakes *mistakes)
{
    size_t told = mistakes->uncounted;
    for (size_t i = 0; i < mistakes->count; i++)
        told += mistakes->list[i].line != NULL;
    return told > 0 && told == mistakes->relations;
}

sonject_status mistakes_tell(struct mistakes *mistakes, struct report *report,
                             sonject_status status)
{
    const bool is_ended = status != SONJECT_OK && status != SONJECT_ERROR_INPUT;
    if (mistakes->count + mistakes->uncounted > 0) {
        if (!is_ended || !report->message[0])
            join(mistakes, report);
        status = is_ended ? status : SONJECT_ERROR_INPUT;
    }
    for (size_t i = 0; i < mistakes->count; i++)
        free(mistakes->list[i].file);
    free(mistakes->list);
    memset(mistakes, 0, sizeof *mistakes);
    return status;
}

/* ---- Messages of section readers, and their questions about keys. */

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

/* Returns the place of a section node's key, or of the section if the key is not there. */
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

bool next_key(const char **keys, char key[64])
{
    const size_t length = strcspn(*keys, " ");
    snprintf(key, 64, "%.*s", (int)length, *keys);
    *keys += length + ((*keys)[length] == ' ');
    return *key != 0;
}

bool is_valid_in_file(const struct reader *reader, const char *path)
{
    return !mistakes_concern(reader->tree->mistakes, reader->tree, path);
}

bool are_valid(struct reader *reader, const char *keys)
{
    char key[64];
    while (next_key(&keys, key)) {
        const size_t before = key_path_add(&reader->path, key);
        const bool is_wrong = !is_valid_in_file(reader, reader->path.text);
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

sonject_status refuse_relation(struct reader *reader, const struct tree_node *node, const char *key,
                               const char *others, const char *format, ...)
{
    va_list arguments;
    if (!are_valid(reader, key) || !are_valid(reader, others))
        return SONJECT_ERROR_INPUT;
    const size_t before = key_path_add(&reader->path, key);
    va_start(arguments, format);
    const sonject_status status = refuse_at(reader, place_of_key(node, key), format, arguments);
    va_end(arguments);
    key_path_shorten(&reader->path, before);
    if (*others && reader->tree->mistakes)
        reader->tree->mistakes->relations++;
    return status;
}

/* Refuses what a check finds wrong. The listener is the reader's first member. */
static void hear(struct check_listener *listener, const char *key, const char *others,
                 const char *what)
{
    struct reader *reader = (struct reader *)listener;
    refuse_relation(reader, reader->checked, key, others, "%s", what);
}

struct check check_at(struct reader *reader, const struct tree_node *node)
{
    reader->listener.hear = hear;
    reader->checked = node;
    return (struct check){NULL, &reader->listener, SONJECT_OK};
}

bool is_given(const struct tree_node *node, const char *key)
{
    return tree_find(node, key) != NULL;
}

void list_word(struct word_list *list, const char *word)
{
    const size_t length = strlen(list->text);
    snprintf(list->text + length, sizeof list->text - length, "%s%s", list->count ? ", " : "",
             word);
    list->count++;
}

sonject_status refuse_word(const struct reader *reader, const struct tree_node *node,
                           const char *word, const struct word_list *known, const char *near)
{
    char excerpt[40];
    return refuse_value(reader, node, "'%s' is not one of %s%s%s%s",
                        text_excerpt(excerpt, sizeof excerpt, word), known->text,
                        near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

const char *nearest_word(const char *typed, const char *const *words, size_t count)
{
    struct nearest nearest;
    nearest_begin(&nearest, typed);
    for (size_t i = 0; i < count; i++)
        nearest_consider(&nearest, words[i]);
    return nearest.best;
}
