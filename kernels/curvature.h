/* The turn of a surface's normal from one point to the next, by differences of the shapes' own
 * normals, so that it exists for every shape (kernels/MATH.md, "Multi-bounce specular paths"). */
#ifndef SONJECT_KERNELS_CURVATURE_H
#define SONJECT_KERNELS_CURVATURE_H

#include "chain_hit.h"

/* The step of the differences, as a share of the bounding radius. Its square is negligible, and so
 * is the rounding of the normals (6e-8). */
#define CURVATURE_STEP 5.0e-4f

/* Returns the change of one object's normal, in its own frame, for a shift on a point's tangent
 * plane. The two sides of an edge differ; the side that bends less is the hit's own face. */
FUNCTION struct vector3 own_normal_change(GLOBAL const struct object_record *object,
                                          struct vector3 point, struct vector3 normal,
                                          struct vector3 direction, struct vector3 shift)
{
    const vfloat length = larger(SQUARE_ROOT(dot3(shift, shift)), SPLAT(1.0e-12f));
    const vfloat step = CURVATURE_STEP * object->bounding_radius / length;
    const struct vector3 here = shape_normal(object, point, direction);
    const struct vector3 ahead = shape_normal(object, along3(point, shift, step), direction);
    const struct vector3 behind = shape_normal(object, along3(point, shift, -step), direction);
    const struct vector3 forth = along3(ahead, here, SPLAT(-1.0f));
    const struct vector3 back = along3(here, behind, SPLAT(-1.0f));
    const vfloat square_forth = dot3(forth, forth);
    const vfloat square_back = dot3(back, back);
    const struct vector3 unlike = along3(forth, back, SPLAT(-1.0f));
    const mask is_even = MASK_OF(dot3(unlike, unlike) <= 0.25f * (square_forth + square_back));
    struct vector3 change = choose3(MASK_OF(square_forth < square_back), forth, back);
    change = choose3(is_even, along3(back, unlike, SPLAT(0.5f)), change);
    /* The hit's normal is on the ray's side, which may be the inner one. */
    const vfloat side = sign_of(dot3(here, normal));
    return scaled3(change, side / step);
}

/* Returns the change of a hit's normal for a tangent shift. Seabed and facets are flat. */
FUNCTION struct vector3 normal_change_at(const struct trace *trace, const struct chain_hit *hit,
                                         struct vector3 shift)
{
    struct vector3 change = zero3();
    FOR_SURFACES_MET (i, 0, trace->fan.objects, hit->surface, hit->is_hit) {
        GLOBAL const struct object_record *object = &trace->objects[i];
        const mask here = hit->is_hit & MASK_OF(hit->surface == i);
        if (object->shape == SHAPE_MESH || !ANY(here))
            continue;
        const struct vector3 turned = out_of_object(
            object, own_normal_change(object, into_object(object, from_centre(object, hit->point)),
                                      into_object(object, hit->normal),
                                      into_object(object, reversed3(hit->back)),
                                      into_object(object, shift)));
        change = choose3(here, turned, change);
    }
    return change;
}

#endif
