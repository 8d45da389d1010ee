/* Scene files: YAML to a scene. */
#ifndef SONJECT_SCHEMA_SCENE_FILE_H
#define SONJECT_SCHEMA_SCENE_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"
#include "scene/scene.h"
#include "schema/number_table.h"
#include "schema/yaml_tree.h"

/* Reads path, applies count overrides "key.path=value" and fills scene, which must be initialised
 * and empty; on failure it is left empty. Contract and errors as of sonject_scene_read. */
sonject_status scene_file_read(struct report *report, const char *path,
                               const char *const *overrides, size_t count, struct scene *scene);

/* The same for a file that may describe shapes by code: scene_file_read refuses them. */
sonject_status scene_file_read_with(struct report *report, const char *path,
                                    const char *const *overrides, size_t count,
                                    bool allows_user_shapes, struct scene *scene);

/* The text of a scene file, *bytes long, to be given to free(). Errors: INPUT (there is none, too
 * large), STORAGE, MEMORY. */
sonject_status scene_file_load(struct report *report, const char *path, char **text, size_t *bytes);

/* What scene_file_read_with does with the text of a file. */
struct scene_text {
    const char *path; /* of the file */
    const char *text;
    size_t bytes;
    const char *const *overrides;
    size_t override_count;
    /* Where the names of files in the first so many overrides are meant from; NULL: where the user
     * is, as with all others. */
    const char *moved_folder;
    size_t moved_overrides;
    bool allows_user_shapes;
    size_t call_overrides; /* of the overrides, the last ones: set by calls, not with the text */
    const struct number_array *arrays; /* in place of files that are named so */
    size_t array_count;
    bool takes_pixels; /* the input may be pixels that a call is given: none of path, uniform and
                          synthetic */
};
sonject_status scene_text_read(struct report *report, const struct scene_text *source,
                               struct scene *scene);

/* The text with its overrides as a tree, which is initialised. Errors: INPUT, MEMORY. */
sonject_status scene_text_tree(const struct scene_text *source, struct tree *tree);

/* The names of the bands that the text leaves to be chosen, in its order, one a line; for free().
 * Errors: INPUT, MEMORY. */
sonject_status scene_text_bands(struct report *report, const struct scene_text *source,
                                char **names);

struct scene_file_key {
    char path[64];            /* "objects[].heading" */
    const char *unit;         /* "deg, rad", "whole number", "word", ...; static */
    const char *meaning;      /* one line; static */
    bool is_required;         /* in its section */
    const char *const *words; /* that it may be, ended by NULL, "" for a place that no word has;
                                 NULL: it is no word */
};

/* Lists every key that has a value of its own. keys: room for capacity entries (NULL if capacity is
 * 0). Returns the number of keys, which may exceed capacity. */
size_t scene_file_keys(struct scene_file_key *keys, size_t capacity);

/* All keys as a JSON array, in the tables' order, for free(): objects with path
 * ("objects[].heading"), section (the path of the section that it is in, "" at the top), meaning,
 * kind (quantity, count, flag, word, text, file, section, list or special), unit (as users are told
 * it), is_required, words (null or an array), member (of the C structure; null: none), and preset,
 * least and most in the SI unit, null where there is none. Errors: MEMORY. */
sonject_status scene_keys_json(struct report *report, char **text);

#endif
