/* Files that describe one target each, for objects of scenes. */
#ifndef SONJECT_SCHEMA_SCENE_TARGET_H
#define SONJECT_SCHEMA_SCENE_TARGET_H

#include "schema/scene_schema.h"

/* A target on its way from its file into the scene. */
struct target_text {
    sonject_object_params object;  /* first: tables of shapes fill it */
    char *file;                    /* owned; NULL: there is no file */
    struct tree tree;              /* of the file */
    const struct tree_node *parts; /* of the tree; NULL: the target has a shape */
};

/* Reads the file of which the node tells the name into a target that has none yet: all but its
 * parts, for their surface may be told elsewhere. Errors: INPUT, STORAGE, MEMORY. */
sonject_status read_target(struct reader *reader, const struct tree_node *node,
                           struct target_text *target);

/* Appends its parts, if it has any, to the scene, as those of the object that will be its next.
 * Errors: INPUT, MEMORY. */
sonject_status read_target_parts(struct reader *reader, const struct target_text *target);

/* Appends the target of a file as an object. placing: what sonject_scene_add_target takes of an
 * object. On failure the scene is as before. Errors: INPUT, STORAGE, MEMORY. */
sonject_status scene_append_target(struct scene *scene, struct report *report, const char *path,
                                   bool allows_user_shapes, const sonject_object_params *placing);

/* Frees what is owned. */
void target_text_clear(struct target_text *target);

#endif
