/* Shapes that a scene or a target's file describes by code. */
#ifndef SONJECT_SCHEMA_SCENE_USER_H
#define SONJECT_SCHEMA_SCENE_USER_H

#include "schema/scene_schema.h"

extern const struct section user_section;

/* Reads the section `user` of a sonject_object_params, and appends the shape to the scene. Files of
 * code are at most 64 KiB, named as all files are. Errors: INPUT (also: code is not allowed),
 * STORAGE, MEMORY. */
sonject_status read_user_shape(struct reader *reader, const struct tree_node *node,
                               void *structure);

#endif
