/* The check of cuts for which a shape must be known. */
#ifndef SONJECT_SCENE_CHECK_CUTS_H
#define SONJECT_SCENE_CHECK_CUTS_H

#include "scene/scene.h"

/* Whether the cuts of a mesh or of a user's shape, which is the scene's, leave something;
 * check_object tells it of all other shapes, and has passed this one. Errors: INPUT, as
 * check_object. */
sonject_status check_cuts_in_scene(const struct scene *scene, const sonject_object_params *object,
                                   struct report *report, struct check_listener *listener);

#endif
