/* Where rays meet objects. A new shape enters here, in its two switches. */
#ifndef SONJECT_KERNELS_INTERSECTION_H
#define SONJECT_KERNELS_INTERSECTION_H

#include "layout.h"
#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "shapes/plane.h"
#include "shapes/sphere.h"

/* Turns a vector of the launch's frame into the object's own. */
FUNCTION struct vector3 into_object(GLOBAL const struct object_record *object, struct vector3 v)
{
    struct vector3 turned;
    turned.x = v.x * object->axes[0] + v.y * object->axes[1] + v.z * object->axes[2];
    turned.y = v.x * object->axes[3] + v.y * object->axes[4] + v.z * object->axes[5];
    turned.z = v.x * object->axes[6] + v.y * object->axes[7] + v.z * object->axes[8];
    return turned;
}

FUNCTION struct vector3 out_of_object(GLOBAL const struct object_record *object, struct vector3 v)
{
    struct vector3 turned;
    turned.x = v.x * object->axes[0] + v.y * object->axes[3] + v.z * object->axes[6];
    turned.y = v.x * object->axes[1] + v.y * object->axes[4] + v.z * object->axes[7];
    turned.z = v.x * object->axes[2] + v.y * object->axes[5] + v.z * object->axes[8];
    return turned;
}

FUNCTION struct vector3 from_centre(GLOBAL const struct object_record *object, struct vector3 point)
{
    struct vector3 relative;
    relative.x = point.x - object->centre_x;
    relative.y = point.y - object->centre_y;
    relative.z = point.z - object->centre_z;
    return relative;
}

/* In the object's own frame. */
FUNCTION struct interval shape_interval(GLOBAL const struct object_record *object,
                                        struct vector3 point, struct vector3 direction)
{
    switch (object->shape) {
    case SHAPE_PLANE:
        return plane_interval(point, direction, object->half_length, object->half_width);
    case SHAPE_SPHERE:
        return sphere_interval(point, direction, object->radius);
    case SHAPE_CYLINDER:
        return cylinder_interval(point, direction, object->half_length, object->radius);
    default:
        return capsule_interval(point, direction, object->half_length, object->radius);
    }
}

/* In the object's own frame, outward, unit. */
FUNCTION struct vector3 shape_normal(GLOBAL const struct object_record *object,
                                     struct vector3 point, struct vector3 direction)
{
    switch (object->shape) {
    case SHAPE_PLANE:
        return plane_normal(direction);
    case SHAPE_SPHERE:
        return sphere_normal(point, object->radius);
    case SHAPE_CYLINDER:
        return cylinder_normal(point, object->half_length, object->radius);
    default:
        return capsule_normal(point, object->half_length, object->radius);
    }
}

/* Distance along the ray to the first surface beyond `minimum`, FAR_AWAY if there is none. The ray
 * is first moved to its closest approach to the object, so that single precision holds the shape
 * and not the range (physics.md section 9 at 500 m). */
FUNCTION real object_distance(GLOBAL const struct object_record *object, struct vector3 point,
                              struct vector3 direction, real minimum)
{
    const struct vector3 relative = from_centre(object, point);
    const real approach = -dot3(relative, direction);
    const struct vector3 closest = along3(relative, direction, approach);
    const mask is_near =
        MASK_OF(dot3(closest, closest) <= object->bounding_radius * object->bounding_radius);
    if (!ANY(is_near))
        return SPLAT(FAR_AWAY);
    const struct interval inside =
        shape_interval(object, into_object(object, closest), into_object(object, direction));
    const real entry = approach + inside.entry;
    const real exit = approach + inside.exit;
    const real first = CHOOSE(MASK_OF(entry > minimum), entry,
                              CHOOSE(MASK_OF(exit > minimum), exit, SPLAT(FAR_AWAY)));
    return CHOOSE(MASK_OF(inside.entry <= inside.exit), first, SPLAT(FAR_AWAY));
}

/* Outward unit normal where the ray meets the object at that distance. */
FUNCTION struct vector3 object_normal(GLOBAL const struct object_record *object,
                                      struct vector3 point, struct vector3 direction, real distance)
{
    const struct vector3 hit = from_centre(object, along3(point, direction, distance));
    return out_of_object(
        object, shape_normal(object, into_object(object, hit), into_object(object, direction)));
}

struct nearest_hit {
    real distance; /* FAR_AWAY: none */
    whole object;  /* number, -1: none */
};

FUNCTION struct nearest_hit find_nearest_hit(GLOBAL const struct object_record *objects, int count,
                                             struct vector3 point, struct vector3 direction,
                                             float minimum)
{
    struct nearest_hit nearest;
    nearest.distance = SPLAT(FAR_AWAY);
    nearest.object = WHOLE_OF(SPLAT(-1.0f));
    for (int i = 0; i < count; i++) {
        const real distance = object_distance(&objects[i], point, direction, SPLAT(minimum));
        const mask is_nearer = MASK_OF(distance < nearest.distance);
        nearest.distance = CHOOSE(is_nearer, distance, nearest.distance);
        nearest.object = CHOOSE(is_nearer, WHOLE_OF(SPLAT((float)i)), nearest.object);
    }
    return nearest;
}

#endif
