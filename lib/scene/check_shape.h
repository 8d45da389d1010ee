/* The check of an object's shape. */
#ifndef SONJECT_SCENE_CHECK_SHAPE_H
#define SONJECT_SCENE_CHECK_SHAPE_H

#include <sonject/object.h>

#include "base/ranges.h"

/* Shape, sizes, ends and cuts of an object, as object.h states them. */
void check_shape(struct check *check, const sonject_object_params *object);

#endif
