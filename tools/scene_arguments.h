/* Reading a scene file with a command's overrides. */
#ifndef SONJECT_TOOLS_SCENE_ARGUMENTS_H
#define SONJECT_TOOLS_SCENE_ARGUMENTS_H

#include <stdbool.h>

#include <sonject/sonject.h>

#include "arguments.h"

struct scene_arguments {
    const char *path;
    struct text_list overrides;
    struct whole_argument seed; /* an override too, the last */
    bool allows_user_shapes;
};

/* As sonject_scene_read_with. */
sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene);

#endif
