/* Objects that are made of parts, in scene files and in the files of targets. */
#ifndef SONJECT_SCHEMA_SCENE_PARTS_H
#define SONJECT_SCHEMA_SCENE_PARTS_H

#include "schema/scene_schema.h"

/* A part; one of its keys is a list of the same, to which the table does not point back. */
extern const struct section part_section;

/* Reads a list of parts and appends them to the scene, as those of the object that will be the
 * scene's next. material: of parts that name none. Errors: INPUT, MEMORY. */
sonject_status read_parts(struct reader *reader, const struct tree_node *node,
                          const sonject_material_params *material);

#endif
