/* Scene files: YAML to a scene. */
#ifndef SONJECT_SCHEMA_SCENE_FILE_H
#define SONJECT_SCHEMA_SCENE_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"
#include "scene/scene.h"
#include "schema/tables.h"
#include "schema/yaml_tree.h"

/* The text of a scene file, *bytes long without the 0 at its end, to be given to free(). Errors:
 * INPUT (there is none, too large, a zero byte within it), STORAGE, MEMORY. */
sonject_status scene_file_load(struct report *report, const char *path, char **text, size_t *bytes);

/* What a scene is read from. */
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

/* Whether a band may have this name, which is a folder's. */
bool is_band_name(const char *text);

/* All keys as a JSON array, in the tables' order, for free(): objects with path
 * ("objects[].heading"), section (the path of the section that it is in, "" at the top), meaning,
 * kind (quantity, count, flag, word, name, text, file, section, list or special), unit (as users
 * are told it), has_value (it may be written as one value; else as a section or list alone),
 * is_list, is_required (in its section), words (an array, or null), member (of the C structure),
 * default and range (in words, as users are told), preset, least and most (the same as numbers in
 * the SI unit; least and most may be open). What there is none of is null. Errors: MEMORY. */
sonject_status scene_keys_json(struct report *report, char **text);

#endif
