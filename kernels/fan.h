/* Primary rays: a fan of elevations from a sonar that moves with the ray's track position. */
#ifndef SONJECT_KERNELS_FAN_H
#define SONJECT_KERNELS_FAN_H

#include "elementary.h"
#include "interval.h"
#include "ray_table.h"
#include "trace.h"

/* A ray near the frame's origin. Distances count from the ray's point closest to the origin. At
 * 500 m the sonar's own coordinates would leave too few digits for the phase. */
struct fan_ray {
    struct vector3 closest;   /* point closest to the frame's origin, in the plane of the strip */
    struct vector3 direction; /* unit, away from the sonar */
    struct vector3 upward;    /* unit, across the ray, towards larger elevations */
    vfloat range_at_closest;  /* range at that point less the reference range */
    vfloat wavefront; /* width of the wavefront at that point, m per rad of elevation; it grows by 1
                         m per m, and without layers it is the range */
    vfloat spreading; /* spreading as in struct arrival; only where layers bend the ray */
    vfloat range_per_metre; /* range per m along the ray; 1 except in slices */
    vfloat turn;            /* turn of the direction per rad of elevation; 1 except in slices */
};

/* Returns the ray at a track position x and an elevation e, rad over the direction d from the track
 * to the origin. With u upward across d and R the reference range, the ray runs along d cos e +
 * u sin e. It passes the origin at R sin e (u cos e - d sin e), at the range R cos e. */
FUNCTION struct fan_ray fan_ray_at(const struct trace *trace, vfloat x, vfloat elevation)
{
    const struct fan_record *fan = &trace->fan;
    vfloat sine, cosine;
    sine_cosine_of_cycles(elevation * 0.15915494309f, &sine, &cosine);
    cosine = SQUARE_ROOT(1.0f - sine * sine);
    struct fan_ray ray;
    ray.direction =
        vector3_of(SPLAT(0.0f), cosine * fan->cosine_depression + sine * fan->sine_depression,
                   sine * fan->cosine_depression - cosine * fan->sine_depression);
    ray.upward = vector3_of(SPLAT(0.0f), -ray.direction.z, ray.direction.y);
    vfloat offset = fan->reference_range * sine;
    ray.range_at_closest = -offset * sine / (1.0f + cosine);
    ray.wavefront = fan->reference_range + ray.range_at_closest;
    ray.spreading = SPLAT(1.0f);
    ray.range_per_metre = SPLAT(1.0f);
    ray.turn = SPLAT(1.0f);
    if (fan->table.pieces > 0) {
        const struct table_ray bent = look_up_ray(fan->table, trace->pieces, elevation);
        offset = bent.offset;
        ray.range_at_closest = bent.range;
        ray.wavefront = bent.wavefront;
        ray.spreading = bent.spreading;
    }
    ray.closest = vector3_of(x, offset * ray.upward.y, offset * ray.upward.z);
    return ray;
}

/* Returns the range at a distance along a ray, less the reference range. */
FUNCTION vfloat range_along(const struct fan_ray *ray, vfloat distance)
{
    return ray->range_at_closest + ray->range_per_metre * distance;
}

/* Returns the gain by layers in the amplitude of an echo from a point of the ray, over isovelocity
 * water. It counts both ways and is normalised by the square of the range. */
FUNCTION vfloat refraction_gain(const struct fan_record *fan, const struct fan_ray *ray,
                                vfloat distance)
{
    if (fan->table.pieces == 0)
        return SPLAT(1.0f);
    const vfloat range = fan->reference_range + range_along(ray, distance);
    const vfloat ground = fan->table.ground_range + (ray->closest.y + distance * ray->direction.y);
    return ray->spreading * range * range / (ground * (ray->wavefront + distance));
}

/* The two bins about a bin coordinate. Far outside the grid they are bins that do not exist. */
struct bin_pair {
    vint bin;     /* number of the first */
    vfloat later; /* share of the second, 0...1 */
};

#define BEFORE_BINS (-9.0f) /* bin coordinate of echoes that no bin takes */

FUNCTION struct bin_pair bins_about(vfloat coordinate)
{
    const vfloat limited = smaller(larger(coordinate, SPLAT(-2.0f)), SPLAT(8.0e6f));
    struct bin_pair pair;
    pair.bin = VINT_OF(limited + 4.0f) - 4; /* truncation is floor on positive numbers */
    pair.later = larger(limited - VFLOAT_OF(pair.bin), SPLAT(0.0f));
    return pair;
}

/* Returns the distance from a point to the mean seabed; FAR_AWAY for rays that do not go down. */
FUNCTION vfloat plane_distance(const struct fan_record *fan, struct vector3 point,
                               struct vector3 direction)
{
    const mask is_downward = MASK_OF(direction.z < -1.0e-6f);
    return SELECT(is_downward,
                  (fan->seabed_height - point.z) / SELECT(is_downward, direction.z, SPLAT(-1.0f)),
                  SPLAT(FAR_AWAY));
}

#endif
