/* Users' shapes that planes cut. Their code knows the whole; which side of a surface is the inner
 * one its normals tell. */
#ifndef SONJECT_KERNELS_USER_CUT_H
#define SONJECT_KERNELS_USER_CUT_H

#include "cut.h"
#include "user_object.h"

/* Whether the next surface beyond a distance shows its inner side: its normal points along the ray.
 */
FUNCTION mask next_is_exit(GLOBAL const struct object_record *object, struct vector3 start,
                           struct vector3 direction, vfloat beyond, mask is_wanted)
{
    const vfloat next = user_object_distance(object, start, direction, beyond, is_wanted);
    const mask is_met = is_wanted & MASK_OF(next < FAR_AWAY);
    const struct vector3 hit =
        along3(start, direction, SELECT(is_met, next, SPLAT(2.0f * object->bounding_radius)));
    const struct vector3 normal = user_object_normal(object, hit, direction);
    return is_met & MASK_OF(dot3(normal, direction) > 0.0f);
}

/* As user_object_distance, of what the cuts leave. A ray meets the face of a cut where it crosses
 * the plane inside the shape: where the next surface shows its inner side both onwards and back, so
 * that one that is only grazed does not count. */
NOINLINE vfloat cut_user_distance(GLOBAL const struct object_record *object, struct vector3 start,
                                  struct vector3 direction, vfloat minimum, mask is_wanted)
{
    const float radius = object->bounding_radius;
    const struct interval left = interval_under_cuts(object, start, direction);
    const vfloat first = larger(minimum, left.entry);
    const mask is_left = is_wanted & MASK_OF(first <= left.exit);
    const vfloat next = user_object_distance(object, start, direction, first, is_left);
    const vfloat surface = SELECT(MASK_OF(next <= left.exit), next, SPLAT(FAR_AWAY));
    if (user_of_object(object)->is_open)
        return surface;
    const mask enters = MASK_OF(left.entry > minimum);
    const mask leaves = MASK_OF(left.exit > minimum) & MASK_OF(surface >= FAR_AWAY);
    const vfloat face = SELECT(enters, left.entry, left.exit);
    mask is_inside =
        is_left & (enters | leaves) & MASK_OF(next < FAR_AWAY) & MASK_OF(magnitude(face) < radius);
    if (!ANY(is_inside))
        return surface;
    is_inside = next_is_exit(object, start, direction, face, is_inside);
    if (ANY(is_inside))
        is_inside = next_is_exit(object, start, reversed3(direction), -face, is_inside);
    return SELECT(is_inside, face, surface);
}

#endif
