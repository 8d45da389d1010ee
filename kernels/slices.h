/* Targets that reach into layers of water which bend rays. In each layer, a slice, a ray is a line.
 * At a plane between slices two lines meet (kernels/MATH.md, "Layers"). */
#ifndef SONJECT_KERNELS_SLICES_H
#define SONJECT_KERNELS_SLICES_H

#include "aspects.h"
#include "fan.h"
#include "intersection.h"

#define SLICE_OVERLAP 1.0e-5f /* m along a ray, so that no hit falls between two slices */

/* Returns a slice over the straight water. slice: >= 1. */
FUNCTION GLOBAL const struct ray_piece_record *slice_of_table(const struct trace *trace, int slice)
{
    const struct fan_record *fan = &trace->fan;
    const int each = 1 + 2 * fan->table.pieces;
    return trace->pieces + fan->table.first_piece + fan->table.pieces + (slice - 1) * each;
}

FUNCTION float bottom_of_slice(GLOBAL const struct ray_piece_record *slice)
{
    return slice->offset[0];
}

/* Returns the upward component of a straight water ray's direction in the slice. */
FUNCTION vfloat slope_in_slice(GLOBAL const struct ray_piece_record *slice,
                               const struct fan_ray *straight)
{
    const vfloat level = straight->direction.y * slice->offset[1];
    return -SQUARE_ROOT(larger(1.0f - level * level, SPLAT(1.0e-6f)));
}

/* Returns the line that a ray of the straight water follows in a slice. */
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
    ray.direction = vector3_of(SPLAT(0.0f), straight->direction.y * slice->offset[1],
                               slope_in_slice(slice, straight));
    ray.upward = vector3_of(SPLAT(0.0f), -ray.direction.z, ray.direction.y);
    ray.turn = slice->offset[1] * straight->direction.z / ray.direction.z;
    ray.range_at_closest = ranges.offset;
    ray.range_per_metre = SPLAT(slice->offset[2]);
    ray.wavefront = bent.wavefront / ray.turn;
    ray.spreading = bent.spreading;
    ray.closest =
        vector3_of(straight->closest.x, bent.offset * ray.upward.y, bent.offset * ray.upward.z);
    return ray;
}

/* Returns the distance along a fan's ray to a level plane. */
FUNCTION vfloat distance_to_height(const struct fan_ray *ray, float height)
{
    return (height - ray->closest.z) / ray->direction.z;
}

/* The first object that a ray meets, and the ray in the object's slice. */
struct sliced_hit {
    struct nearest_hit nearest;
    struct fan_ray ray;
    struct aspect_ray squinted;
    mask is_over_straight_water;
};

/* Returns whether anything may be met between two heights. */
FUNCTION int is_reached(GLOBAL const struct object_record *objects, int count, float bottom,
                        float top)
{
    if (count > OBJECTS_IN_LOOP)
        return 1;
    for (int i = 0; i < count; i++)
        if (objects[i].centre_z + objects[i].bounding_radius > bottom &&
            objects[i].centre_z - objects[i].bounding_radius < top)
            return 1;
    return 0;
}

/* Finds what rays meet in their slice, and sets the lanes that meet something. top: the next slice,
 * NULL for the highest one; to_bottom: along the fan's ray. */
FUNCTION void meet_in_slice(const struct trace *trace, const struct fan_ray *ray,
                            const struct aspect_ray *squinted,
                            GLOBAL const struct ray_piece_record *top, vfloat to_bottom,
                            struct sliced_hit *hit)
{
    const struct fan_record *fan = &trace->fan;
    vfloat entry = SPLAT(-fan->reference_range);
    if (top)
        entry = distance_to_height(ray, bottom_of_slice(top)) / squinted->cosine;
    const struct vector3 start = along3(squinted->start, squinted->direction, entry);
    struct nearest_hit nearest =
        find_nearest_hit(trace->objects, fan->objects, start, squinted->direction, -SLICE_OVERLAP);
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

/* Returns the first object on each ray. The search goes upwards from the straight water, where ray
 * and aspect are known. A hit in a higher slice comes earlier on the ray. */
FUNCTION struct sliced_hit find_sliced_hit(const struct trace *trace, vfloat elevation,
                                           const struct fan_ray *straight,
                                           const struct aspect_ray *squinted)
{
    const struct fan_record *fan = &trace->fan;
    struct sliced_hit hit;
    hit.ray = *straight;
    hit.squinted = *squinted;
    hit.is_over_straight_water = MASK_OF(elevation != elevation);
    if (!HAS_SLICES || fan->table.slices < 2) {
        hit.nearest = find_nearest_hit(trace->objects, fan->objects, squinted->start,
                                       squinted->direction, -fan->reference_range);
        return hit;
    }
    struct aspect_ray aspect = *squinted;
    const vfloat aside = aspect.sine / aspect.cosine;
    float bottom = bottom_of_slice(slice_of_table(trace, 1));
    vfloat x = aspect.start.x + distance_to_height(straight, bottom) * aside; /* x at the bottom */
    hit.nearest.distance = SPLAT(FAR_AWAY);
    hit.nearest.object = VINT_OF(SPLAT(-1.0f));
    meet_in_slice(trace, straight, &aspect, slice_of_table(trace, 1), SPLAT(FAR_AWAY), &hit);
    const vfloat in_straight_water = hit.nearest.distance;
    for (int i = 1; i < fan->table.slices; i++) {
        GLOBAL const struct ray_piece_record *slice = slice_of_table(trace, i);
        GLOBAL const struct ray_piece_record *next =
            i + 1 < fan->table.slices ? slice_of_table(trace, i + 1) : 0;
        const float top = next ? bottom_of_slice(next) : FAR_AWAY;
        if (is_reached(trace->objects, fan->objects, bottom, top)) {
            const struct fan_ray ray = ray_in_slice(fan, slice, straight, elevation);
            const vfloat to_bottom = distance_to_height(&ray, bottom);
            aspect.start = ray.closest;
            aspect.start.x = x - to_bottom * aside;
            aspect.direction.y = ray.direction.y * aspect.cosine;
            aspect.direction.z = ray.direction.z * aspect.cosine;
            meet_in_slice(trace, &ray, &aspect, next, to_bottom, &hit);
        }
        x = x + (top - bottom) / slope_in_slice(slice, straight) * aside;
        bottom = top;
    }
    hit.ray.upward.y = -hit.ray.direction.z;
    hit.ray.upward.z = hit.ray.direction.y;
    hit.is_over_straight_water = MASK_OF(hit.nearest.distance != in_straight_water);
    return hit;
}

#endif
