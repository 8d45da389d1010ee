/* Shapes that users wrote, as a scene keeps them: code that several share is kept once. */
#ifndef SONJECT_SCENE_USER_SHAPES_H
#define SONJECT_SCENE_USER_SHAPES_H

#include <stdbool.h>
#include <stdint.h>

#include "scene/params.h"

#include "base/report.h"
#include "user/snippet.h"

#define USER_SNIPPETS_MAX 64
#define USER_SHAPES_MAX   1250 /* as many as objects and parts */

struct user_shape {
    uint32_t snippet; /* number of its code */
    bool is_open;
    double bounding_radius_m;
    double half_length_m, half_width_m, half_height_m; /* at most the radius */
    float parameters[SONJECT_USER_PARAMETERS_CAPACITY];
};

struct user_shapes {
    struct user_snippet *snippets; /* owned; no two of the same code */
    uint32_t snippet_count;
    struct user_shape *shapes; /* owned */
    uint32_t count;
};

/* Ranges of the values, but for name and code, as check_ functions of scene/scene.h do. */
sonject_status check_user_shape(const sonject_user_shape_params *shape, struct report *report,
                                struct check_listener *listener);

/* Appends a checked shape. Errors: INPUT (its code or name, see snippet_make; too many), MEMORY. */
sonject_status user_shapes_append(struct user_shapes *shapes, struct report *report,
                                  const sonject_user_shape_params *shape);

void user_shapes_clear(struct user_shapes *shapes);

#endif
