/* Code of a user's, of which a box and a sphere that hold it are known; and the codes of a scene.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/shapes/shape.h"

void shape_size_of_user_shape(struct shape_size *size, const struct user_shape *shape)
{
    size->user_shape = shape;
    size->half_length_m = shape->half_length_m;
    size->half_width_m = shape->half_width_m;
    size->half_height_m = shape->half_height_m;
    size->bounding_radius_m = (1.0 + 1e-6) * shape->bounding_radius_m;
    size->radius_about_nose_m =
        fmin(hypot(size->half_width_m, size->half_height_m), size->bounding_radius_m);
    size->least_radius_of_curvature_m = 0.0; /* it is not known: rays are as dense as they get */
}

static double extent(const struct shape_size *size, const double v[3])
{
    const double of_sphere =
        size->user_shape->bounding_radius_m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return fmin(shape_extent(size, SHAPE_BOX, v), of_sphere);
}

const struct shape shape_user = {.needs = SHAPE_HAS_CODE, .extent = extent};

static sonject_status find_snippet(struct user_shapes *shapes, struct report *report,
                                   const sonject_user_shape_params *shape, uint32_t *number)
{
    for (uint32_t i = 0; i < shapes->snippet_count; i++)
        if (strcmp(shapes->snippets[i].code, shape->code) == 0) {
            *number = i;
            return SONJECT_OK;
        }
    *number = shapes->snippet_count;
    if (shapes->snippet_count == USER_SNIPPETS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "different codes of shapes must be at most %d in a scene; split it",
                              USER_SNIPPETS_MAX);
    struct user_snippet *snippets =
        realloc(shapes->snippets, (shapes->snippet_count + 1) * sizeof *snippets);
    CHECK_MEMORY(report, snippets, "a shape's code");
    shapes->snippets = snippets;
    const sonject_status status =
        snippet_make(report, shape->name, shape->first_line, shape->code, &snippets[*number]);
    shapes->snippet_count += status == SONJECT_OK;
    return status;
}

static double half_size(double given_m, double radius_m)
{
    return given_m > 0.0 ? fmin(given_m, radius_m) : radius_m;
}

sonject_status user_shapes_append(struct user_shapes *shapes, struct report *report,
                                  const sonject_user_shape_params *shape)
{
    uint32_t snippet;
    if (shapes->count == USER_SHAPES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "user shapes must be at most %d in a scene; split it",
                              USER_SHAPES_MAX);
    struct user_shape *grown = realloc(shapes->shapes, (shapes->count + 1) * sizeof *grown);
    CHECK_MEMORY(report, grown, "a user's shape");
    shapes->shapes = grown;
    CHECK(find_snippet(shapes, report, shape, &snippet));
    struct user_shape *made = &shapes->shapes[shapes->count++];
    memset(made, 0, sizeof *made);
    made->snippet = snippet;
    made->is_open = shape->is_open;
    made->bounding_radius_m = shape->bounding_radius_m;
    made->half_length_m = half_size(shape->half_length_m, shape->bounding_radius_m);
    made->half_width_m = half_size(shape->half_width_m, shape->bounding_radius_m);
    made->half_height_m = half_size(shape->half_height_m, shape->bounding_radius_m);
    for (uint32_t i = 0; i < shape->parameter_count; i++)
        made->parameters[i] = (float)shape->parameters[i];
    return SONJECT_OK;
}

void user_shapes_clear(struct user_shapes *shapes)
{
    for (uint32_t i = 0; i < shapes->snippet_count; i++)
        snippet_clear(&shapes->snippets[i]);
    free(shapes->snippets);
    free(shapes->shapes);
    memset(shapes, 0, sizeof *shapes);
}
