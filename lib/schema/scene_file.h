/* Scene files: what a scene is read from, and its reading. */
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

/* A text, and what was set since by calls: values of keys, as overrides set them, and arrays in
 * place of files. Starts as all zeros. What scene_source_keep and the setting functions put there
 * is owned, for scene_source_clear; a source that is only read may borrow all. */
struct scene_source {
    const char *path;       /* of the text's file, for messages and the names of files in it */
    const char *text;       /* NULL: there is none, the scene is a campaign's */
    const char **overrides; /* "key.path=value" */
    size_t override_count;
    size_t set_count; /* of them, the last ones: set by calls, not with the text */
    /* Where the names of files in the first so many overrides are meant from; NULL: where the user
     * is, as with all others. */
    const char *moved_folder;
    size_t moved_overrides;
    const char *made_calibration; /* file that stands for input.calibration: auto; NULL: none */
    struct number_array *arrays;  /* by their names, which are their keys' values */
    size_t array_count;
    bool has_no_channels; /* the input is an image, whatever input.channel says */
    bool takes_pixels;    /* the input may be pixels that a call is given: none of path, uniform and
                             synthetic */
    bool *are_relations;  /* told by a reading that fails with INPUT: that each value would do by
                             itself, but not with the others; NULL: not told */
    struct tree tree;     /* of text and overrides, while something is set; empty: not made */
};

/* Takes the text over (for free(), also on failure) and copies the rest. Errors: MEMORY. */
sonject_status scene_source_keep(struct scene_source *source, struct report *report,
                                 const char *path, char *text, const char *const *overrides,
                                 size_t count);
void scene_source_clear(struct scene_source *source);

/* Sets a key, as an override does. On failure nothing is changed. Errors: INPUT (no such key, not a
 * value), MEMORY. */
sonject_status scene_source_set(struct scene_source *source, struct report *report, const char *key,
                                const char *value);

/* Sets a key whose value is the name of a file to an array in its place, copied; array->name is the
 * key. On failure nothing is changed. Errors: INPUT, MEMORY. */
sonject_status scene_source_set_array(struct scene_source *source, struct report *report,
                                      const struct number_array *array);

/* Reads it all. Of the scene only mesh_store counts before; on failure it is left empty but for
 * that. Errors:
 * INPUT, STORAGE, UNSUPPORTED (a mesh's format), MEMORY. */
sonject_status scene_source_read(const struct scene_source *source, struct report *report,
                                 struct scene *scene);

/* The text with its overrides as a tree, which is initialised. Errors: INPUT, MEMORY. */
sonject_status scene_source_tree(const struct scene_source *source, struct tree *tree);

/* The names of the bands that are left to be chosen, in the text's order, one a line; for free().
 * Errors: INPUT, MEMORY. */
sonject_status scene_source_bands(const struct scene_source *source, struct report *report,
                                  char **names);

/* Makes source->tree where it is not there. Errors: INPUT, MEMORY. */
sonject_status scene_source_keep_tree(struct scene_source *source, struct report *report);

/* Makes the names of files in source->tree absolute; arrays in place of files stay. Errors: MEMORY.
 */
sonject_status name_files_absolutely(struct scene_source *source, struct report *report);

/* What the scene says at a key, "" for all of it, as JSON, for free(); see sonject_scene_get.
 * Errors: INPUT (no such key), MEMORY. */
sonject_status scene_source_get(struct scene_source *source, struct report *report, const char *key,
                                char **json);

/* The text with all that was set in its place and absolute names of files, a line a section; for
 * free(). Errors: INPUT, MEMORY. */
sonject_status scene_source_text(struct scene_source *source, struct report *report, char **text);

/* Whether a band may have this name, which is a folder's. */
bool is_band_name(const char *text);

#endif
