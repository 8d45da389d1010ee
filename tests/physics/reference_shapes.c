#include "reference_shapes.h"

#include <math.h>
#include <string.h>

#define LIFT_M 1e-9 /* far above rounding at some 100 m (1e-14), far below every size */

/* Nearest meeting so far, in the object's own axes. */
struct meeting {
    double distance;
    struct reference_vector normal;
};

struct reference_vector reference_vector(double x, double y, double z)
{
    const struct reference_vector result = {x, y, z};
    return result;
}

struct reference_vector reference_sum(struct reference_vector a, double scale,
                                      struct reference_vector b)
{
    return reference_vector(a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z);
}

double reference_dot(struct reference_vector a, struct reference_vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct reference_vector reference_cross(struct reference_vector a, struct reference_vector b)
{
    return reference_vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

struct reference_vector reference_unit(struct reference_vector a)
{
    return reference_sum(reference_vector(0.0, 0.0, 0.0), 1.0 / sqrt(reference_dot(a, a)), a);
}

struct reference_object *reference_add_object(struct reference_scene *scene,
                                              enum reference_shape shape, double radius,
                                              double lambert)
{
    struct reference_object *object = &scene->objects[scene->object_count++];
    memset(object, 0, sizeof *object);
    object->shape = shape;
    object->radius = radius;
    object->lambert = lambert;
    object->axes[0] = reference_vector(1.0, 0.0, 0.0);
    object->axes[1] = reference_vector(0.0, 1.0, 0.0);
    object->axes[2] = reference_vector(0.0, 0.0, 1.0);
    return object;
}

void reference_turn(struct reference_object *object, double heading, double pitch)
{
    object->axes[0] =
        reference_vector(cos(pitch) * cos(heading), cos(pitch) * sin(heading), -sin(pitch));
    object->axes[1] = reference_vector(-sin(heading), cos(heading), 0.0);
    object->axes[2] = reference_cross(object->axes[0], object->axes[1]);
}

/* Roots of a t^2 + 2 b t + c = 0, its discriminant b^2 - a c given by whoever knows it without
   cancellation. */
static int quadratic_roots(double a, double b, double c, double discriminant, double roots[2])
{
    if (discriminant < 0.0 || a == 0.0)
        return 0;
    const double q = -(b + copysign(sqrt(discriminant), b));
    roots[0] = q / a;
    roots[1] = q != 0.0 ? c / q : roots[0];
    return 2;
}

static void keep_nearest(struct meeting *nearest, double distance, struct reference_vector normal)
{
    if (distance > 0.0 && distance < nearest->distance) {
        nearest->distance = distance;
        nearest->normal = normal;
    }
}

/* Sphere about (shift, 0, 0); of a capsule's end (`end` -1 or 1) only what lies beyond it. */
static void meet_sphere(struct meeting *nearest, struct reference_vector o,
                        struct reference_vector d, double radius, double shift, int end)
{
    const struct reference_vector from = reference_vector(o.x - shift, o.y, o.z);
    const struct reference_vector moment = reference_cross(from, d);
    double roots[2];
    const int count =
        quadratic_roots(1.0, reference_dot(from, d), reference_dot(from, from) - radius * radius,
                        radius * radius - reference_dot(moment, moment), roots);
    for (int i = 0; i < count; i++) {
        const struct reference_vector outwards = reference_sum(from, roots[i], d);
        if (end == 0 || outwards.x * end >= 0.0)
            keep_nearest(nearest, roots[i], reference_unit(outwards));
    }
}

/* Round side of a cylinder along own x. */
static void meet_side(struct meeting *nearest, struct reference_vector o, struct reference_vector d,
                      double radius, double half_length)
{
    const double a = d.y * d.y + d.z * d.z, moment = o.y * d.z - o.z * d.y;
    double roots[2];
    const int count =
        quadratic_roots(a, o.y * d.y + o.z * d.z, o.y * o.y + o.z * o.z - radius * radius,
                        a * radius * radius - moment * moment, roots);
    for (int i = 0; i < count; i++) {
        const struct reference_vector at = reference_sum(o, roots[i], d);
        if (fabs(at.x) <= half_length)
            keep_nearest(nearest, roots[i], reference_unit(reference_vector(0.0, at.y, at.z)));
    }
}

static void meet_flat_ends(struct meeting *nearest, struct reference_vector o,
                           struct reference_vector d, double radius, double half_length)
{
    for (int end = -1; end <= 1 && d.x != 0.0; end += 2) {
        const double distance = (end * half_length - o.x) / d.x;
        const struct reference_vector at = reference_sum(o, distance, d);
        if (at.y * at.y + at.z * at.z <= radius * radius)
            keep_nearest(nearest, distance, reference_vector(end, 0.0, 0.0));
    }
}

static void meet_rectangle(struct meeting *nearest, struct reference_vector o,
                           struct reference_vector d, double half_length, double half_width)
{
    if (d.z == 0.0)
        return;
    const double distance = -o.z / d.z;
    const struct reference_vector at = reference_sum(o, distance, d);
    if (fabs(at.x) <= half_length && fabs(at.y) <= half_width)
        keep_nearest(nearest, distance, reference_vector(0.0, 0.0, 1.0));
}

static struct reference_vector in_own_axes(const struct reference_object *object,
                                           struct reference_vector v)
{
    return reference_vector(reference_dot(v, object->axes[0]), reference_dot(v, object->axes[1]),
                            reference_dot(v, object->axes[2]));
}

static struct meeting meet_object(const struct reference_object *object,
                                  struct reference_vector origin, struct reference_vector direction)
{
    struct meeting nearest = {INFINITY, {0.0, 0.0, 0.0}};
    const struct reference_vector o =
        in_own_axes(object, reference_sum(origin, -1.0, object->centre));
    const struct reference_vector d = in_own_axes(object, direction);
    const double half = 0.5 * object->length, radius = object->radius;
    switch (object->shape) {
    case REFERENCE_SPHERE:
        meet_sphere(&nearest, o, d, radius, 0.0, 0);
        break;
    case REFERENCE_CAPSULE:
        meet_side(&nearest, o, d, radius, half - radius);
        meet_sphere(&nearest, o, d, radius, half - radius, 1);
        meet_sphere(&nearest, o, d, radius, radius - half, -1);
        break;
    case REFERENCE_CYLINDER:
        meet_side(&nearest, o, d, radius, half);
        meet_flat_ends(&nearest, o, d, radius, half);
        break;
    case REFERENCE_RECTANGLE:
        meet_rectangle(&nearest, o, d, half, 0.5 * object->width);
        break;
    }
    return nearest;
}

static struct reference_vector in_scene_axes(const struct reference_object *object,
                                             struct reference_vector v)
{
    struct reference_vector result = reference_vector(0.0, 0.0, 0.0);
    result = reference_sum(result, v.x, object->axes[0]);
    result = reference_sum(result, v.y, object->axes[1]);
    return reference_sum(result, v.z, object->axes[2]);
}

bool reference_nearest(const struct reference_scene *scene, struct reference_vector origin,
                       struct reference_vector direction, struct reference_hit *hit)
{
    struct reference_hit nearest = {
        INFINITY, origin, {0.0, 0.0, 1.0}, scene->seabed_lambert, false};
    const double to_seabed = -origin.z / direction.z;
    if (direction.z != 0.0 && to_seabed > 0.0)
        nearest.distance = to_seabed;
    for (int i = 0; i < scene->object_count; i++) {
        const struct reference_object *object = &scene->objects[i];
        const struct meeting meeting = meet_object(object, origin, direction);
        if (meeting.distance >= nearest.distance)
            continue;
        nearest.distance = meeting.distance;
        nearest.normal = in_scene_axes(object, meeting.normal);
        nearest.lambert = object->lambert;
        nearest.on_object = true;
    }
    if (isinf(nearest.distance))
        return false;
    if (reference_dot(nearest.normal, direction) > 0.0)
        nearest.normal = reference_vector(-nearest.normal.x, -nearest.normal.y, -nearest.normal.z);
    nearest.point =
        reference_sum(reference_sum(origin, nearest.distance, direction), LIFT_M, nearest.normal);
    *hit = nearest;
    return true;
}

bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to)
{
    const struct reference_vector way = reference_sum(to, -1.0, from);
    const double distance = sqrt(reference_dot(way, way));
    struct reference_hit hit;
    return reference_nearest(scene, from, reference_unit(way), &hit) && hit.distance < distance;
}
