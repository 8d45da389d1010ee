/* Paths between an object and two sources, each the sonar or one of its images in level boundaries.
 * A line between source and object is straight in unfolded space. Obstacles are looked for along
 * the folded line (kernels/MATH.md, "Image sources"). */
#ifndef SONJECT_KERNELS_IMAGE_SOURCES_H
#define SONJECT_KERNELS_IMAGE_SOURCES_H

#include "fan.h"
#include "intersection.h"
#include "seabed.h"
#include "surface.h"

/* The way from a hit to a source. */
struct leg {
    mask is_open;
    vfloat reflection_real,
        reflection_imaginary; /* product of the boundaries' coherent amplitudes */
};

/* Returns the cosine of incidence on a boundary, by Snell's law. cosine: at the object. */
FUNCTION vfloat cosine_at_boundary(GLOBAL const struct boundary_record *boundary, vfloat cosine)
{
    if (boundary->speed_ratio == 1.0f)
        return cosine;
    const float square = boundary->speed_ratio * boundary->speed_ratio;
    return SQUARE_ROOT(larger(1.0f - (1.0f - cosine * cosine) * square, SPLAT(0.0f)));
}

/* Follows a leg from a hit to a source. direction: unit, to the source in unfolded space; length:
 * m. Lanes that are not wanted stay closed. */
FUNCTION struct leg follow_leg(const struct trace *trace, GLOBAL const struct source_record *source,
                               struct vector3 point, struct vector3 direction, vfloat length,
                               mask is_wanted)
{
    const struct fan_record *fan = &trace->fan;
    struct leg leg;
    leg.is_open = is_wanted;
    leg.reflection_real = SPLAT(1.0f);
    leg.reflection_imaginary = SPLAT(0.0f);
    const vfloat cosine =
        magnitude(direction.z); /* equal at every bounce, since boundaries are level */
    const int is_bent = source->table.pieces > 0;
    int is_seen = 1; /* through layers, only obstacles in the water around the object are seen */
    int kind = source->last_boundary;
    for (int bounce = 0; bounce < source->bounces && ANY(leg.is_open); bounce++) {
        GLOBAL const struct boundary_record *boundary = &trace->pair->boundaries[kind];
        const mask is_level = MASK_OF(cosine < 1.0e-6f);
        const vfloat step =
            (boundary->height - point.z) / SELECT(is_level, SPLAT(1.0f), direction.z);
        if (is_seen) {
            leg.is_open = leg.is_open & MASK_OF(find_obstacle(trace->objects, fan->objects, point,
                                                              direction, step) > step);
            leg.is_open = is_clear_of_relief(trace, point, direction, step, leg.is_open);
        }
        leg.is_open = leg.is_open & ~is_level;
        is_seen = is_seen && !(is_bent && kind == BOUNDARY_SURFACE);
        point = along3(point, direction, step);
        direction.z = -direction.z;
        length = length - step;
        vfloat one_real, one_imaginary;
        smooth_reflection(&boundary->surface, cosine_at_boundary(boundary, cosine), &one_real,
                          &one_imaginary);
        const vfloat product_real =
            leg.reflection_real * one_real - leg.reflection_imaginary * one_imaginary;
        leg.reflection_imaginary =
            leg.reflection_real * one_imaginary + leg.reflection_imaginary * one_real;
        leg.reflection_real = product_real;
        kind = 1 - kind;
    }
    if (is_seen && ANY(leg.is_open)) {
        leg.is_open = leg.is_open & MASK_OF(find_obstacle(trace->objects, fan->objects, point,
                                                          direction, length) > length);
        leg.is_open = is_clear_of_relief(trace, point, direction, length, leg.is_open);
    }
    return leg;
}

/* The line from a source to a hit. */
struct line_from_source {
    struct vector3 direction; /* unit, towards the hit */
    vfloat wavefront; /* width per rad of elevation at the hit; without layers, the line's length */
    vfloat excess;    /* range less the source's range, formed without a difference of ranges */
    vfloat spreading; /* spreading of layers, as in struct arrival (lib/medium/water.h) */
};

FUNCTION struct line_from_source line_through_layers(GLOBAL const struct source_record *source,
                                                     GLOBAL const struct ray_piece_record *pieces,
                                                     struct vector3 hit)
{
    const struct ray_to_point ray = find_ray_to(source->table, pieces, source->cosine_depression,
                                                source->sine_depression, hit.y, hit.z);
    struct line_from_source line;
    line.direction = vector3_of(SPLAT(0.0f), ray.directions.away_y, ray.directions.away_z);
    line.wavefront = ray.wavefront;
    line.excess = ray.range;
    line.spreading = ray.spreading;
    return line;
}

FUNCTION struct line_from_source line_from_source(GLOBAL const struct source_record *source,
                                                  GLOBAL const struct ray_piece_record *pieces,
                                                  struct vector3 hit)
{
    if (source->table.pieces > 0)
        return line_through_layers(source, pieces, hit);
    const float range = source->range;
    const vfloat along = hit.y * source->cosine_depression - hit.z * source->sine_depression;
    const vfloat change = 2.0f * range * along + (hit.y * hit.y + hit.z * hit.z);
    struct line_from_source line;
    line.wavefront = SQUARE_ROOT(range * range + change);
    line.excess = change / (line.wavefront + range);
    line.spreading = SPLAT(1.0f);
    line.direction =
        vector3_of(SPLAT(0.0f), (range * source->cosine_depression + hit.y) / line.wavefront,
                   (hit.z - range * source->sine_depression) / line.wavefront);
    return line;
}

/* Returns the distance along a fan's rays at which they are past their last boundary. */
FUNCTION vfloat distance_past_boundaries(const struct trace *trace, const struct fan_ray *ray)
{
    if (trace->pair->outgoing.bounces == 0)
        return SPLAT(-trace->fan.reference_range);
    const vfloat slope = ray->direction.z;
    const mask is_away = trace->pair->outgoing.last_boundary == BOUNDARY_SEABED
                             ? MASK_OF(slope > 1.0e-6f)
                             : MASK_OF(slope < -1.0e-6f);
    const float height = trace->pair->boundaries[trace->pair->outgoing.last_boundary].height;
    return SELECT(is_away, (height - ray->closest.z) / SELECT(is_away, slope, SPLAT(1.0f)),
                  SPLAT(FAR_AWAY));
}

/* The hit of a fan's rays on the object, past their boundaries and above the seabed. */
struct image_hit {
    mask is_hit;
    struct vector3 point, normal;
    struct vector3 start; /* start of rays that test visibility, but for a step off the surface */
    vfloat range;         /* m, from the outgoing source, less the reference range */
    vfloat cosine;        /* cosine of the angle of incidence */
};

FUNCTION struct image_hit find_image_hit(const struct trace *trace, enum wanted_face wanted,
                                         const struct fan_ray *ray, mask is_ray)
{
    GLOBAL const struct object_record *object = &trace->objects[trace->fan.only_object];
    const vfloat past_boundaries = distance_past_boundaries(trace, ray);
    const vfloat distance = object_distance(object, ray->closest, ray->direction, past_boundaries);
    const mask on_object = is_ray & MASK_OF(distance < 0.5f * FAR_AWAY);
    struct image_hit hit;
    hit.is_hit = on_object & MASK_OF(distance < seabed_distance(trace, ray->closest, ray->direction,
                                                                past_boundaries, on_object));
    const vfloat safe = SELECT(hit.is_hit, distance, SPLAT(0.0f));
    hit.point = along3(ray->closest, ray->direction, safe);
    const struct surface_face face =
        object_face(object, wanted, ray->closest, ray->direction, safe);
    hit.normal = face.normal;
    hit.start = lifted_point(hit.point, &face);
    hit.range = ray->range_at_closest + safe;
    hit.cosine = -dot3(hit.normal, ray->direction);
    /* A hit from inside means that the boundary's point is buried in the object. */
    hit.is_hit = hit.is_hit & MASK_OF(hit.cosine > 0.0f);
    return hit;
}

/* The path from the outgoing source by way of a hit to the returning source. */
struct image_path {
    mask is_open;
    struct line_from_source back; /* line from the returning source to the hit */
    vfloat wavefront_out;         /* width per rad of the fan's elevation at the hit */
    vfloat range;                 /* half the path less that by way of the frame's origin */
    vfloat spreading;             /* square of half the path over the product of both legs */
    vfloat cosine_back;           /* cosine between the normal and the return path */
    vfloat reflection_real, reflection_imaginary; /* product of all boundaries */
};

/* Returns the square root of both legs' intensities, normalised by the square of half the path. A
 * leg that no layer bends has the spreading cos(grazing angle). */
FUNCTION vfloat spreading_through_layers(const struct trace *trace, const struct fan_ray *ray,
                                         const struct image_hit *hit, const struct image_path *path,
                                         vfloat half_path)
{
    const vfloat out = trace->fan.table.pieces > 0 ? ray->spreading : ray->direction.y;
    const vfloat back =
        trace->pair->returning.table.pieces > 0 ? path->back.spreading : path->back.direction.y;
    const vfloat ground = trace->pair->outgoing.table.ground_range + hit->point.y;
    return SQUARE_ROOT(out * back / (path->wavefront_out * path->back.wavefront)) * half_path *
           half_path / ground;
}

FUNCTION struct image_path follow_path(const struct trace *trace, const struct fan_ray *ray,
                                       const struct image_hit *hit)
{
    const struct fan_record *fan = &trace->fan;
    struct image_path path;
    path.back = line_from_source(&trace->pair->returning, trace->pieces, hit->point);
    path.wavefront_out = ray->wavefront + (hit->range - ray->range_at_closest);
    path.range = 0.5f * (hit->range + path.back.excess);
    const vfloat half_path =
        0.5f * (fan->reference_range + trace->pair->returning.range) + path.range;
    path.spreading = (half_path / path.wavefront_out) * (half_path / path.back.wavefront);
    if (fan->table.pieces > 0 || trace->pair->returning.table.pieces > 0)
        path.spreading = spreading_through_layers(trace, ray, hit, &path, half_path);
    path.cosine_back = -dot3(hit->normal, path.back.direction);
    const mask is_lit = hit->is_hit & MASK_OF(path.cosine_back > 0.0f);
    const struct vector3 start = along3(hit->start, hit->normal, SPLAT(START_OFF_SURFACE));
    const struct leg out = follow_leg(trace, &trace->pair->outgoing, start,
                                      reversed3(ray->direction), path.wavefront_out, is_lit);
    const struct leg returned =
        follow_leg(trace, &trace->pair->returning, start, reversed3(path.back.direction),
                   path.back.wavefront, out.is_open);
    trace->outcome->queries += count_lanes(is_lit) + count_lanes(out.is_open);
    path.is_open = returned.is_open;
    path.reflection_real = out.reflection_real * returned.reflection_real -
                           out.reflection_imaginary * returned.reflection_imaginary;
    path.reflection_imaginary = out.reflection_real * returned.reflection_imaginary +
                                out.reflection_imaginary * returned.reflection_real;
    return path;
}

#endif
