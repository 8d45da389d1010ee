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
    const char *band; /* --set band=, of a verb that goes through all; NULL: as the scene says */
};

/* Lines of a verb's arguments, whose options are a structure with a struct scene_arguments `scene`.
 */
#define SCENE_ARGUMENTS(structure)                                                                 \
    {"--seed",                                                                                     \
     NULL,                                                                                         \
     "N",                                                                                          \
     "seed of the random numbers: --set injection.seed=N",                                         \
     ARGUMENT_WHOLE,                                                                               \
     false,                                                                                        \
     offsetof(structure, scene.seed)},                                                             \
        {"--set",                                                                                  \
         NULL,                                                                                     \
         "KEY.PATH=VALUE",                                                                         \
         "replaces or adds a key of the scene; may be repeated",                                   \
         ARGUMENT_TEXTS,                                                                           \
         false,                                                                                    \
         offsetof(structure, scene.overrides)},                                                    \
    {                                                                                              \
        "--allow-user-shapes", NULL, NULL,                                                         \
            "runs code of shapes in the scene; only if you trust it", ARGUMENT_FLAG, false,        \
            offsetof(structure, scene.allows_user_shapes)                                          \
    }

/* The bands that the scene leaves to be chosen; see sonject_scene_bands. */
sonject_status scene_arguments_bands(sonject_context *context,
                                     const struct scene_arguments *arguments, char **names);

/* As sonject_scene_read. */
sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene);

#endif
