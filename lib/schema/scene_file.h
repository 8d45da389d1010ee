/* Scene files: the source that a scene is read from, and its reading. */
#ifndef SONJECT_SCHEMA_SCENE_FILE_H
#define SONJECT_SCHEMA_SCENE_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"
#include "scene/scene.h"
#include "schema/tables.h"
#include "schema/yaml_tree.h"

/* Reads the text of a scene file, *bytes long without the 0 at its end, for free(). Errors: INPUT
 * (no such file, too large, a zero byte within it), STORAGE, MEMORY. */
sonject_status scene_file_load(struct report *report, const char *path, char **text, size_t *bytes);

/* The source of a scene: a text, and what calls have set since, as overrides of keys and as arrays
 * in place of files. Starts as all zeros. scene_source_keep and the setting functions fill it with
 * memory that scene_source_clear frees. A source that is only read may borrow all. */
struct scene_source {
    const char *path; /* path of the text's file, for messages and for file names in the text */
    const char *text; /* NULL: no text, because the scene is a campaign's */
    const char **overrides; /* "key.path=value" */
    size_t override_count;
    size_t set_count; /* number of the last overrides, which calls have set */
    /* The folder for file names in the first moved_overrides overrides; NULL, and for all other
     * overrides: the user's working folder. */
    const char *moved_folder;
    size_t moved_overrides;
    const char *made_calibration; /* file that stands for input.calibration: auto; NULL: none */
    struct number_array *arrays;  /* arrays, whose names are their keys' values */
    size_t array_count;
    bool has_no_channels; /* the input is an image, whatever input.channel says */
    bool takes_pixels;    /* a call may give pixels instead of path, uniform or synthetic */
    bool *are_relations;  /* set if a reading fails with INPUT: each value would do by itself, but
                             not with the others; NULL: not wanted */
    struct tree tree;     /* tree of text and overrides, made when needed; empty: not made */
};

/* Takes the text (for free(), also on failure) and copies the rest. Errors: MEMORY. */
sonject_status scene_source_keep(struct scene_source *source, struct report *report,
                                 const char *path, char *text, const char *const *overrides,
                                 size_t count);
void scene_source_clear(struct scene_source *source);

/* Sets a key, as an override does. On failure nothing changes. Errors: INPUT (no such key, not a
 * value), MEMORY. */
sonject_status scene_source_set(struct scene_source *source, struct report *report, const char *key,
                                const char *value);

/* Sets a key whose value is the name of a file to a copy of an array; array->name is the key. On
 * failure nothing changes. Errors: INPUT, MEMORY. */
sonject_status scene_source_set_array(struct scene_source *source, struct report *report,
                                      const struct number_array *array);

/* Reads a scene. Only scene->mesh_store is used before. On failure the scene is left empty but for
 * that. Errors: INPUT, STORAGE, UNSUPPORTED (a mesh's format), MEMORY. */
sonject_status scene_source_read(const struct scene_source *source, struct report *report,
                                 struct scene *scene);

/* Parses the text with its overrides into an initialised tree. Errors: INPUT, MEMORY. */
sonject_status scene_source_tree(const struct scene_source *source, struct tree *tree);

/* Returns in *names the bands to choose from, if none is chosen, in the text's order, one per line,
 * for free(). Errors: INPUT, MEMORY. */
sonject_status scene_source_bands(const struct scene_source *source, struct report *report,
                                  char **names);

/* Makes source->tree if it is not made. Errors: INPUT, MEMORY. */
sonject_status scene_source_keep_tree(struct scene_source *source, struct report *report);

/* Makes file names in source->tree absolute. Arrays in place of files stay. Errors: MEMORY. */
sonject_status name_files_absolutely(struct scene_source *source, struct report *report);

/* Writes the scene's value at a key, "" for all, as JSON, for free(); see sonject_scene_get.
 * Errors: INPUT (no such key), MEMORY. */
sonject_status scene_source_get(struct scene_source *source, struct report *report, const char *key,
                                char **json);

/* Writes the text with all that was set and absolute file names, one section per line, for free().
 * Errors: INPUT, MEMORY. */
sonject_status scene_source_text(struct scene_source *source, struct report *report, char **text);

/* Returns whether a band may have this name, which is a folder's name, too. */
bool is_band_name(const char *text);

#endif
