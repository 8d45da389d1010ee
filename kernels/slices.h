/* Targets that reach into layers of water which bend rays. In each layer, a slice, a ray is a line;
 * at its planes the line of one slice meets that of the next (kernels/MATH.md, "Layers"). */
#ifndef SONJECT_KERNELS_SLICES_H
#define SONJECT_KERNELS_SLICES_H

#include "aspects.h"
#include "fan.h"
#include "intersection.h"

#define SLICE_OVERLAP 1.0e-5f /* m along a ray: no hit falls between two slices */

/* A slice over the straight water: slice >= 1. */
FUNCTION GLOBAL const struct ray_piece_record *slice_of_table(
    const struct fan_record *fan, GLOBAL const struct ray_piece_record *pieces, int slice)
{
    const int each = 1 + 2 * fan->table.pieces;
    return pieces + fan->table.first_piece + fan->table.pieces + (slice - 1) * each;
}

FUNCTION float bottom_of_slice(GLOBAL const struct ray_piece_record *slice)
{
    return slice->offset[0];
}

/* The line in a slice of a ray of the straight water. */
FUNCTION struct fan_ray ray_in_slice(const struct fan_record *fan,
                                     GLOBAL const struct ray_piece_record *slice,
                                     const struct fan_ray *straight, vfloat elevation)
{
    struct ray_table_record table = fan->table;
    table.first_piece = 1;
    const struct table_ray bent = look_up_ray(table, slice, elevation);
    table.first_piece += table.pieces;
    const struct table_ray ranges = look_up_ray(table, slice, elevation);
    struct fan_ray ray;
    ray.direction.x = SPLAT(0.0f);
    ray.direction.y = straight->direction.y * slice->offset[1];
    ray.direction.z =
        -SQUARE_ROOT(larger(1.0f - ray.direction.y * ray.direction.y, SPLAT(1.0e-6f)));
    ray.upward.x = SPLAT(0.0f);
    ray.upward.y = -ray.direction.z;
    ray.upward.z = ray.direction.y;
    ray.turn = slice->offset[1] * straight->direction.z / ray.direction.z;
    ray.range_at_closest = ranges.offset;
    ray.range_per_metre = SPLAT(slice->offset[2]);
    ray.wavefront = bent.wavefront / ray.turn;
    ray.spreading = bent.spreading;
    ray.closest.x = straight->closest.x;
    ray.closest.y = bent.offset * ray.upward.y;
    ray.closest.z = bent.offset * ray.upward.z;
    return ray;
}

/* Distance along a fan's ray to a level plane. */
FUNCTION vfloat distance_to_height(const struct fan_ray *ray, float height)
{
    return (height - ray->closest.z) / ray->direction.z;
}

/* The first object that a ray meets, and the ray as it is there. */
struct sliced_hit {
    struct nearest_hit nearest;
    struct fan_ray ray;
    struct aspect_ray squinted;
    mask is_over_straight_water;
};

/* What a ray meets in its slice, into the lanes that meet something. top: of the slice, the bottom
 * of the next one; NULL: it is the highest. to_bottom: along the fan's ray. */
FUNCTION void meet_in_slice(const struct fan_record *fan,
                            GLOBAL const struct object_record *objects, const struct fan_ray *ray,
                            const struct aspect_ray *squinted,
                            GLOBAL const struct ray_piece_record *top, vfloat to_bottom,
                            struct sliced_hit *hit)
{
    vfloat entry = SPLAT(-fan->reference_range);
    if (top)
        entry = distance_to_height(ray, bottom_of_slice(top)) / squinted->cosine;
    const struct vector3 start = along3(squinted->start, squinted->direction, entry);
    struct nearest_hit nearest =
        find_nearest_hit(objects, fan->objects, start, squinted->direction, -SLICE_OVERLAP);
    const mask is_any = MASK_OF(nearest.distance < 0.5f * FAR_AWAY);
    nearest.distance = nearest.distance + entry;
    const mask is_met =
        is_any & MASK_OF(nearest.distance <= to_bottom / squinted->cosine + SLICE_OVERLAP);
    if (!ANY(is_met))
        return;
    hit->nearest.distance = SELECT(is_met, nearest.distance, hit->nearest.distance);
    hit->nearest.object = SELECT(is_met, nearest.object, hit->nearest.object);
    hit->ray.closest = choose3(is_met, ray->closest, hit->ray.closest);
    hit->ray.direction = choose3(is_met, ray->direction, hit->ray.direction);
    hit->ray.range_at_closest = SELECT(is_met, ray->range_at_closest, hit->ray.range_at_closest);
    hit->ray.wavefront = SELECT(is_met, ray->wavefront, hit->ray.wavefront);
    hit->ray.spreading = SELECT(is_met, ray->spreading, hit->ray.spreading);
    hit->ray.range_per_metre = SELECT(is_met, ray->range_per_metre, hit->ray.range_per_metre);
    hit->ray.turn = SELECT(is_met, ray->turn, hit->ray.turn);
    hit->squinted.start = choose3(is_met, squinted->start, hit->squinted.start);
    hit->squinted.direction = choose3(is_met, squinted->direction, hit->squinted.direction);
}

/* From the straight water, where the ray and its aspect are known, upwards: what is met in a higher
 * slice is met before. */
FUNCTION struct sliced_hit find_sliced_hit(const struct fan_record *fan,
                                           GLOBAL const struct ray_piece_record *pieces,
                                           GLOBAL const struct object_record *objects,
                                           vfloat elevation, const struct fan_ray *straight,
                                           const struct aspect_ray *squinted)
{
    struct sliced_hit hit;
    hit.ray = *straight;
    hit.squinted = *squinted;
    hit.is_over_straight_water = MASK_OF(elevation != elevation);
    if (fan->table.slices < 2) {
        hit.nearest = find_nearest_hit(objects, fan->objects, squinted->start, squinted->direction,
                                       -fan->reference_range);
        return hit;
    }
    struct fan_ray ray = *straight;
    struct aspect_ray aspect = *squinted;
    hit.nearest.distance = SPLAT(FAR_AWAY);
    hit.nearest.object = VINT_OF(SPLAT(-1.0f));
    meet_in_slice(fan, objects, &ray, &aspect, slice_of_table(fan, pieces, 1), SPLAT(FAR_AWAY),
                  &hit);
    const vfloat in_straight_water = hit.nearest.distance;
    for (int i = 1; i < fan->table.slices; i++) {
        GLOBAL const struct ray_piece_record *slice = slice_of_table(fan, pieces, i);
        const vfloat to_bottom_below = distance_to_height(&ray, bottom_of_slice(slice));
        ray = ray_in_slice(fan, slice, straight, elevation);
        const vfloat to_bottom = distance_to_height(&ray, bottom_of_slice(slice));
        aspect.start.y = ray.closest.y;
        aspect.start.z = ray.closest.z;
        aspect.start.x =
            aspect.start.x + (to_bottom_below - to_bottom) * (aspect.sine / aspect.cosine);
        aspect.direction.y = ray.direction.y * aspect.cosine;
        aspect.direction.z = ray.direction.z * aspect.cosine;
        meet_in_slice(fan, objects, &ray, &aspect,
                      i + 1 < fan->table.slices ? slice_of_table(fan, pieces, i + 1) : 0, to_bottom,
                      &hit);
    }
    hit.is_over_straight_water = MASK_OF(hit.nearest.distance != in_straight_water);
    return hit;
}

#endif
