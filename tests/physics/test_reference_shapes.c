/* Surfaces of the reference, against marching along the ray by the distance to them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "reference_shapes.h"

#define PI 3.14159265358979323846

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* From a point outside to an object, in its own axes. */
static double distance_to(const struct reference_object *object, struct reference_vector p)
{
    const double half = 0.5 * object->length, level = hypot(p.y, p.z);
    switch (object->shape) {
    case REFERENCE_SPHERE:
        return hypot(level, p.x) - object->radius;
    case REFERENCE_CAPSULE:
        return hypot(level, larger(0.0, fabs(p.x) - half + object->radius)) - object->radius;
    case REFERENCE_CYLINDER: {
        const double aside = level - object->radius, beyond = fabs(p.x) - half;
        if (aside <= 0.0 || beyond <= 0.0)
            return larger(aside, beyond);
        return hypot(aside, beyond);
    }
    case REFERENCE_RECTANGLE:
        break;
    }
    return hypot(hypot(larger(0.0, fabs(p.x) - half), larger(0.0, fabs(p.y) - 0.5 * object->width)),
                 p.z);
}

static double distance_in_scene(const struct reference_object *object, struct reference_vector p)
{
    const struct reference_vector from = reference_sum(p, -1.0, object->centre);
    return distance_to(object, reference_vector(reference_dot(from, object->axes[0]),
                                                reference_dot(from, object->axes[1]),
                                                reference_dot(from, object->axes[2])));
}

/* INFINITY for a miss; sets *nearest to the least distance passed. */
static double march(const struct reference_object *object, struct reference_vector origin,
                    struct reference_vector direction, double *nearest)
{
    double along = 0.0;
    *nearest = INFINITY;
    for (int i = 0; i < 20000 && along < 30.0; i++) {
        const double gap = distance_in_scene(object, reference_sum(origin, along, direction));
        *nearest = fmin(*nearest, gap);
        if (gap < 1e-11)
            return along;
        along += gap;
    }
    return INFINITY;
}

/* The normal must be the way in which the distance grows; differences over 1 um are good to 1e-5
   away from edges, where the distance's gradient jumps. */
static void assert_normal(const struct reference_object *object, const struct reference_hit *hit)
{
    const struct reference_vector at = reference_sum(hit->point, 1e-5, hit->normal);
    const double step = 1e-6, *normal = &hit->normal.x;
    const struct reference_vector axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int i = 0; i < 3; i++) {
        const double slope = (distance_in_scene(object, reference_sum(at, step, axes[i])) -
                              distance_in_scene(object, reference_sum(at, -step, axes[i]))) /
                             (2.0 * step);
        assert_true(fabs(slope - normal[i]) < 1e-4);
    }
}

/* The part of n times an irrational number beyond its whole part: spreads evenly over 0 .. 1. */
static double spread(int n, double irrational)
{
    return fmod(n * irrational, 1.0);
}

/* A ray from 6 m away, from anywhere, to somewhere about the object. */
static struct reference_vector ray_about(const struct reference_object *object, int n,
                                         struct reference_vector *direction)
{
    const double azimuth = spread(n, 0.6180339887498949) * 2.0 * PI;
    const double z = 2.0 * spread(n, 0.7548776662466927) - 1.0, level = sqrt(1.0 - z * z);
    const struct reference_vector way = {level * cos(azimuth), level * sin(azimuth), z};
    const struct reference_vector aside = {spread(n, 0.8191725133961645) - 0.5,
                                           spread(n, 0.6710436067037893) - 0.5,
                                           spread(n, 0.5497004779019703) - 0.5};
    const struct reference_vector origin = reference_sum(object->centre, 6.0, way);
    const struct reference_vector aim = reference_sum(object->centre, 1.8, aside);
    *direction = reference_unit(reference_sum(aim, -1.0, origin));
    return origin;
}

/* Returns whether the ray meets the object. */
static bool assert_ray(const struct reference_scene *scene, int n)
{
    const struct reference_object *object = &scene->objects[0];
    struct reference_vector direction;
    const struct reference_vector origin = ray_about(object, n, &direction);
    double nearest;
    const double expected = march(object, origin, direction, &nearest);
    struct reference_hit hit;
    const bool met = reference_nearest(scene, origin, direction, &hit) && hit.on_object;
    if (isinf(expected)) {
        assert_true(!met || nearest < 1e-6);
        return false;
    }
    assert_true(met);
    assert_true(fabs(hit.distance - expected) < 1e-6); /* marching stalls when grazing */
    assert_true(reference_dot(hit.normal, direction) <= 0.0);
    assert_normal(object, &hit);
    const struct reference_vector there = reference_sum(origin, hit.distance, direction);
    assert_int_equal(reference_blocked(scene, origin, reference_sum(there, 1e-6, direction)), 1);
    assert_int_equal(reference_blocked(scene, origin, reference_sum(there, -1e-6, direction)), 0);
    return true;
}

static void rays_meet_surfaces(void **state)
{
    (void)state;
    for (int shape = REFERENCE_SPHERE; shape <= REFERENCE_RECTANGLE; shape++) {
        struct reference_scene scene = {.seabed_lambert = 0.1};
        struct reference_object *object =
            reference_add_object(&scene, (enum reference_shape)shape, 0.4, 0.1);
        object->centre = reference_vector(3.0, -2.0, 20.0);
        object->length = 2.3;
        object->width = 1.1;
        reference_turn(object, 0.6, 0.4);
        int hits = 0;
        for (int n = 0; n < 4000; n++)
            hits += assert_ray(&scene, n) ? 1 : 0;
        assert_true(hits > 500 && hits < 3500);
    }
}

/* From inside, the surface faces the ray too. */
static void inner_surfaces_are_met(void **state)
{
    (void)state;
    for (int shape = REFERENCE_SPHERE; shape <= REFERENCE_CYLINDER; shape++) {
        struct reference_scene scene = {.seabed_lambert = 0.1};
        struct reference_object *object =
            reference_add_object(&scene, (enum reference_shape)shape, 0.5, 0.1);
        object->centre = reference_vector(0.0, 0.0, 5.0);
        object->length = 2.0;
        const struct reference_vector inside = {0.1, 0.0, 5.0}, up = {0.0, 0.0, 1.0},
                                      along = {1.0, 0.0, 0.0};
        struct reference_hit hit;
        assert_true(reference_nearest(&scene, inside, up, &hit) && hit.on_object);
        assert_true(hit.normal.z < 0.0);
        const double height = shape == REFERENCE_SPHERE ? sqrt(0.24) : 0.5;
        assert_true(fabs(hit.distance - height) < 1e-12);
        assert_true(reference_nearest(&scene, inside, along, &hit) && hit.on_object);
        assert_true(fabs(hit.normal.x + 1.0) < 1e-12);
        const double reach = shape == REFERENCE_SPHERE ? 0.4 : 0.9;
        assert_true(fabs(hit.distance - reach) < 1e-12);
        /* What starts on it goes on to the other side, not to itself. */
        assert_true(reference_nearest(&scene, hit.point, hit.normal, &hit));
        const double across = shape == REFERENCE_SPHERE ? 1.0 : 2.0;
        assert_true(fabs(hit.distance - across) < 1e-8);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_surfaces),
        cmocka_unit_test(inner_surfaces_are_met),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
