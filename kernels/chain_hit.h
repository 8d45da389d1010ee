/* Where a chain of sound meets a surface, and what that surface does. */
#ifndef SONJECT_KERNELS_CHAIN_HIT_H
#define SONJECT_KERNELS_CHAIN_HIT_H

#include "fan.h"
#include "intersection.h"
#include "random.h"
#include "seabed.h"
#include "surface.h"

struct chain_hit {
    struct vector3 point, normal; /* the normal is on the side that the ray came from */
    struct vector3 back;          /* the way that it came, unit, away from the surface */
    real distance;
    whole surface;     /* object's number, -1: the seabed */
    whole left_behind; /* convex object that no way from here meets again, -1: none */
    mask is_hit;
};

/* The nearest object on each way, but for the one that it leaves behind: where that holds for all
 * ways, as on a lone target, the search costs nothing. */
FUNCTION struct nearest_hit find_nearest_ahead(const struct fan_record *fan,
                                               GLOBAL const struct object_record *objects,
                                               struct vector3 start, struct vector3 direction,
                                               float minimum, whole left_behind, mask is_ray)
{
    struct nearest_hit nearest;
    nearest.distance = SPLAT(FAR_AWAY);
    nearest.object = WHOLE_OF(SPLAT(-1.0f));
    for (int i = 0; i < fan->objects; i++) {
        const mask is_ahead = is_ray & MASK_OF(left_behind != i);
        if (!ANY(is_ahead))
            continue;
        const real distance = object_distance(&objects[i], start, direction, SPLAT(minimum));
        const mask is_nearer = is_ahead & MASK_OF(distance < nearest.distance);
        nearest.distance = CHOOSE(is_nearer, distance, nearest.distance);
        nearest.object = CHOOSE(is_nearer, WHOLE_OF(SPLAT((float)i)), nearest.object);
    }
    return nearest;
}

/* The first surface on a ray; left_behind: of where it starts. */
FUNCTION struct chain_hit find_chain_hit(const struct fan_record *fan,
                                         GLOBAL const struct object_record *objects,
                                         struct vector3 start, struct vector3 direction,
                                         float minimum, whole left_behind, mask is_ray)
{
    const real to_seabed = seabed_distance(fan, objects, start, direction, SPLAT(minimum), is_ray);
    const struct nearest_hit nearest =
        find_nearest_ahead(fan, objects, start, direction, minimum, left_behind, is_ray);
    const mask on_object = MASK_OF(nearest.distance < to_seabed);
    struct chain_hit hit;
    hit.distance = smaller(nearest.distance, to_seabed);
    hit.is_hit = is_ray & MASK_OF(hit.distance < 0.5f * FAR_AWAY);
    hit.distance = CHOOSE(hit.is_hit, hit.distance, SPLAT(0.0f));
    hit.surface = CHOOSE(on_object, nearest.object, WHOLE_OF(SPLAT(-1.0f)));
    hit.point = along3(start, direction, hit.distance);
    hit.back = reversed3(direction);
    hit.normal = seabed_normal(fan, objects, hit.point, direction);
    hit.left_behind = WHOLE_OF(SPLAT(-1.0f));
    for (int i = 0; i < fan->objects; i++) {
        const mask here = hit.is_hit & MASK_OF(hit.surface == i);
        if (!ANY(here))
            continue;
        const struct vector3 outward =
            object_normal(&objects[i], start, direction, CHOOSE(here, hit.distance, SPLAT(0.0f)));
        hit.normal = choose3(here, outward, hit.normal);
        if (is_convex(&objects[i]))
            hit.left_behind = CHOOSE(here, hit.surface, hit.left_behind);
    }
    /* inner sides scatter as outer ones do, but what they scatter meets the object again */
    const mask is_outer = MASK_OF(dot3(hit.normal, hit.back) >= 0.0f);
    hit.normal = choose3(is_outer, hit.normal, reversed3(hit.normal));
    hit.left_behind = CHOOSE(is_outer, hit.left_behind, WHOLE_OF(SPLAT(-1.0f)));
    return hit;
}

/* The record of surface number i of a scene, -1: the seabed. */
FUNCTION GLOBAL const struct surface_record *surface_number(
    GLOBAL const struct chain_record *chain, GLOBAL const struct object_record *objects, int i)
{
    return i < 0 ? &chain->seabed : &objects[i].surface;
}

/* Scattering at a hit from one direction into another (rough part), kernels/surface.h. */
FUNCTION real scattering_at(const struct fan_record *fan, GLOBAL const struct chain_record *chain,
                            GLOBAL const struct object_record *objects, const struct chain_hit *hit,
                            struct vector3 out)
{
    real scattering = SPLAT(0.0f);
    for (int i = -1; i < fan->objects; i++) {
        const mask here = hit->is_hit & MASK_OF(hit->surface == i);
        if (ANY(here))
            scattering = CHOOSE(
                here,
                rough_scattering(surface_number(chain, objects, i), hit->normal, hit->back, out),
                scattering);
    }
    return scattering;
}

/* A point off the surface by more than its rounding, less than anything that throws a shadow. */
FUNCTION struct vector3 start_from(const struct chain_hit *hit)
{
    return along3(hit->point, hit->normal, SPLAT(2.0e-5f));
}

/* Whether nothing is between a hit and a point that lies `path` away. */
FUNCTION mask is_open_way(const struct fan_record *fan, GLOBAL const struct object_record *objects,
                          const struct chain_hit *hit, struct vector3 direction, real path,
                          mask is_way)
{
    const struct vector3 start = start_from(hit);
    const struct nearest_hit blocking =
        find_nearest_ahead(fan, objects, start, direction, 0.0f, hit->left_behind, is_way);
    const mask is_open = is_way & MASK_OF(blocking.distance > path);
    return is_open &
           MASK_OF(seabed_distance(fan, objects, start, direction, SPLAT(0.0f), is_open) > path);
}

/* One group of chains under way. */
struct chain {
    struct chain_hit hit;
    struct random_key key;
    word number;      /* of the ray, for its random numbers */
    real energy;      /* what the receiver would get per unit of irradiance at the hit and unit of
                         scattering, m^2 sr, in quanta */
    real range;       /* from the receiver to the first hit less the reference range */
    real length;      /* from the first hit to this one */
    real first_x;     /* along-track, of the first hit */
    real first_reach; /* ground range of the first hit over the cosine of the grazing angle: without
                         layers the range */
    whole first_surface;
    mask began_smooth; /* the first hit was a mirror bounce: nothing finds the reverse path */
    mask is_alive;
};

#endif
