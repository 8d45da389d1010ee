/* Directions from a point towards the targets: uniform over the cones of the targets' spheres, so
 * that sound between seabed and target is looked for where it can be. */
#ifndef SONJECT_KERNELS_TARGET_SAMPLING_H
#define SONJECT_KERNELS_TARGET_SAMPLING_H

#include "elementary.h"
#include "layout.h"
#include "vector3.h"

/* The cones of all spheres as seen from a point. An opening is 1 - cosine of the cone's half angle.
 * It is 0 if the point is inside the sphere, which is then all around. */
struct target_sampling {
    vfloat openings[FEW_SPHERES_MAX];
    vfloat sum;
    mask is_inside; /* inside some sphere */
};

FUNCTION struct vector3 to_sphere(GLOBAL const struct sphere_record *sphere, struct vector3 point)
{
    return vector3_of(sphere->centre_x - point.x, sphere->centre_y - point.y,
                      sphere->centre_z - point.z);
}

/* Returns the opening of a sphere at a distance, 0 if that is not outside. */
FUNCTION vfloat opening_at(vfloat square_distance, vfloat square_radius, mask *is_outside)
{
    *is_outside = MASK_OF(square_distance > square_radius * 1.0001f);
    /* 1 - sqrt(1 - r^2/d^2) without a difference of nearly equal numbers, and with one division. */
    const vfloat square_tangent_length = square_distance - square_radius;
    const vfloat divisor =
        square_distance +
        SQUARE_ROOT(square_distance * SELECT(*is_outside, square_tangent_length, SPLAT(0.0f)));
    return SELECT(*is_outside, square_radius / divisor, SPLAT(0.0f));
}

/* Returns the sum of any number of spheres' openings as seen from a point. */
FUNCTION vfloat sum_of_openings(GLOBAL const struct sphere_record *spheres, int count,
                                struct vector3 point, mask *is_inside)
{
    vfloat sum = SPLAT(0.0f);
    *is_inside = MASK_OF(sum > 1.0f);
    for (int i = 0; i < count; i++) {
        const struct vector3 way = to_sphere(&spheres[i], point);
        mask is_outside;
        sum +=
            opening_at(dot3(way, way), SPLAT(spheres[i].radius * spheres[i].radius), &is_outside);
        *is_inside = *is_inside | ~is_outside;
    }
    return sum;
}

/* Finds the cones of the targets' spheres. count: FEW_SPHERES_MAX at most. */
FUNCTION void view_targets(GLOBAL const struct sphere_record *spheres, int count,
                           struct vector3 point, struct target_sampling *cones)
{
    cones->sum = SPLAT(0.0f);
    cones->is_inside = MASK_OF(cones->sum > 1.0f);
    for (int i = 0; i < count; i++) {
        const struct vector3 way = to_sphere(&spheres[i], point);
        mask is_outside;
        cones->openings[i] =
            opening_at(dot3(way, way), SPLAT(spheres[i].radius * spheres[i].radius), &is_outside);
        cones->sum += cones->openings[i];
        cones->is_inside = cones->is_inside | ~is_outside;
    }
}

/* Returns a direction in a cone, uniform over its solid angle. way: to the middle of its sphere. */
FUNCTION struct vector3 direction_in_cone(struct vector3 way, vfloat opening, vfloat u, vfloat v)
{
    const vfloat inverse = 1.0f / SQUARE_ROOT(dot3(way, way));
    const struct vector3 axis = scaled3(way, inverse);
    const vfloat fall = u * opening; /* 1 - cosine */
    const vfloat sine = SQUARE_ROOT(fall * (2.0f - fall));
    vfloat sine_about, cosine_about;
    sine_cosine_of_cycles(v, &sine_about, &cosine_about);
    struct vector3 first, second;
    tangents3(axis, &first, &second);
    return combine3(axis, 1.0f - fall, first, sine * cosine_about, second, sine * sine_about);
}

/* Returns a direction in one sphere's cone, chosen in proportion to the cones' solid angles. */
FUNCTION struct vector3 sample_target_direction(GLOBAL const struct sphere_record *spheres,
                                                int count, struct vector3 point,
                                                const struct target_sampling *cones, vfloat choice,
                                                vfloat u, vfloat v)
{
    const vfloat wanted = choice * cones->sum;
    vfloat before = SPLAT(0.0f);
    vfloat opening = SPLAT(0.0f);
    struct vector3 way = vector3_of(SPLAT(0.0f), SPLAT(0.0f), SPLAT(1.0f));
    for (int i = 0; i < count; i++) {
        const mask is_next = MASK_OF(before <= wanted) & MASK_OF(cones->openings[i] > 0.0f);
        way = choose3(is_next, to_sphere(&spheres[i], point), way);
        opening = SELECT(is_next, cones->openings[i], opening);
        before += cones->openings[i];
    }
    return direction_in_cone(way, opening, u, v);
}

/* Returns the density of sample_target_direction, 1/sr: the number of cones that hold the direction
 * over the sum of their solid angles. */
FUNCTION vfloat target_direction_density(GLOBAL const struct sphere_record *spheres, int count,
                                         struct vector3 point, const struct target_sampling *cones,
                                         struct vector3 direction)
{
    vfloat holding = SPLAT(0.0f);
    for (int i = 0; i < count; i++) {
        const struct vector3 way = to_sphere(&spheres[i], point);
        const vfloat along = dot3(way, direction);
        /* A difference of two squares would not do: a far sphere is smaller than their rounding. */
        const struct vector3 miss = along3(way, direction, -along);
        const mask is_in_cone = MASK_OF(cones->openings[i] > 0.0f) & MASK_OF(along > 0.0f) &
                                MASK_OF(dot3(miss, miss) <= spheres[i].radius * spheres[i].radius);
        holding += SELECT(is_in_cone, SPLAT(1.0f), SPLAT(0.0f));
    }
    const mask is_some = MASK_OF(cones->sum > 0.0f);
    return SELECT(is_some, holding / SELECT(is_some, cones->sum, SPLAT(1.0f)), SPLAT(0.0f)) *
           0.15915494309f;
}

#endif
