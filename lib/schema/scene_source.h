/* What a scene is read from: a text, what was set since, and arrays in place of files. */
#ifndef SONJECT_SCHEMA_SCENE_SOURCE_H
#define SONJECT_SCHEMA_SCENE_SOURCE_H

#include <stdbool.h>
#include <stddef.h>

#include "scene/scene.h"
#include "schema/tables.h"
#include "schema/yaml_tree.h"

/* Starts as all zeros; is for scene_source_clear. All is owned. */
struct scene_source {
    char *path;       /* of the text's file, for messages and the names of files in it */
    char *text;       /* NULL: there is none, the scene came from structures */
    char **overrides; /* "key.path=value" */
    size_t override_count;
    size_t given_count; /* of them, the first ones: with the text; the others were set since */
    struct number_array *arrays; /* by their names, which are their keys' values */
    size_t array_count;
    bool allows_user_shapes;
    bool takes_pixels; /* the input may be pixels that a call is given */
    struct tree tree;  /* of text and overrides, while something is set; empty: not made */
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

/* Reads it all. scene must be initialised and empty; on failure it is left empty. Errors: as
 * scene_text_read. */
sonject_status scene_source_read(const struct scene_source *source, struct report *report,
                                 struct scene *scene);

/* The names of the bands that are left to be chosen: as of scene_text_bands. */
sonject_status scene_source_bands(const struct scene_source *source, struct report *report,
                                  char **names);

/* The text with all that was set in its place, a line a section; for free(). Errors: MEMORY. */
sonject_status scene_source_text(struct scene_source *source, struct report *report, char **text);

#endif
