/* What plane cuts leave of a ray, and the flat faces that they give a solid. */
#ifndef SONJECT_KERNELS_CUT_H
#define SONJECT_KERNELS_CUT_H

#include "interval.h"
#include "layout.h"

/* The part of a ray that a cut leaves, in the object's own frame. */
FUNCTION struct interval interval_under_cut(GLOBAL const struct cut_record *cut,
                                            struct vector3 point, struct vector3 direction)
{
    const vfloat depth =
        cut->offset - (point.x * cut->normal_x + point.y * cut->normal_y + point.z * cut->normal_z);
    const vfloat loss =
        direction.x * cut->normal_x + direction.y * cut->normal_y + direction.z * cut->normal_z;
    return interval_of_half_space(depth, loss);
}

/* What all of an object's cuts leave of it; empty if entry > exit. */
FUNCTION struct interval interval_under_cuts(GLOBAL const struct object_record *object,
                                             struct vector3 point, struct vector3 direction)
{
    struct interval left;
    left.entry = SPLAT(-FAR_AWAY);
    left.exit = SPLAT(FAR_AWAY);
    for (int i = 0; i < object->cuts; i++) {
        const struct interval under = interval_under_cut(&object->cut[i], point, direction);
        left.entry = larger(left.entry, under.entry);
        left.exit = smaller(left.exit, under.exit);
    }
    return left;
}

/* The face of a cut where a ray meets it. */
struct cut_face {
    mask is_met;
    struct vector3 normal; /* outward, unit, in the object's own frame */
};

/* Whether a hit lies on the face of a cut: it does where its distance is the very one of the plane,
 * by the same arithmetic and so with the same bits as where the hit was found. start: the ray's
 * closest approach in the object's own frame, `approach` along the ray; distance counts from where
 * `approach` does. */
FUNCTION struct cut_face cut_face_at(GLOBAL const struct object_record *object,
                                     struct vector3 start, struct vector3 direction,
                                     vfloat approach, vfloat distance)
{
    struct cut_face face;
    face.is_met = MASK_OF(SPLAT(1.0f) < 0.0f);
    face.normal = direction;
    for (int i = 0; i < object->cuts; i++) {
        GLOBAL const struct cut_record *cut = &object->cut[i];
        const struct interval left = interval_under_cut(cut, start, direction);
        const mask is_here =
            MASK_OF(distance == approach + left.entry) | MASK_OF(distance == approach + left.exit);
        struct vector3 normal;
        normal.x = SPLAT(cut->normal_x);
        normal.y = SPLAT(cut->normal_y);
        normal.z = SPLAT(cut->normal_z);
        face.normal = choose3(is_here, normal, face.normal);
        face.is_met = face.is_met | is_here;
    }
    return face;
}

#endif
