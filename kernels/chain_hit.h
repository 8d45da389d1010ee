/* Where a chain of sound meets a surface, and what that surface does. */
#ifndef SONJECT_KERNELS_CHAIN_HIT_H
#define SONJECT_KERNELS_CHAIN_HIT_H

#include "fan.h"
#include "intersection.h"
#include "random.h"
#include "surface.h"

struct chain_hit {
    struct vector3 point, normal; /* the normal is on the side that the ray came from */
    struct vector3 back;          /* the way that it came, unit, away from the surface */
    real distance;
    whole surface; /* object's number, -1: the seabed */
    mask is_hit;
};

/* The first surface on a ray. */
FUNCTION struct chain_hit find_chain_hit(const struct fan_record *fan,
                                         GLOBAL const struct object_record *objects,
                                         struct vector3 start, struct vector3 direction,
                                         float minimum, mask is_ray)
{
    const real to_seabed = seabed_distance(fan, start, direction);
    const struct nearest_hit nearest =
        find_nearest_hit(objects, fan->objects, start, direction, minimum);
    const mask on_object = MASK_OF(nearest.distance < to_seabed);
    struct chain_hit hit;
    hit.distance = smaller(nearest.distance, to_seabed);
    hit.is_hit = is_ray & MASK_OF(hit.distance < 0.5f * FAR_AWAY);
    hit.distance = CHOOSE(hit.is_hit, hit.distance, SPLAT(0.0f));
    hit.surface = CHOOSE(on_object, nearest.object, WHOLE_OF(SPLAT(-1.0f)));
    hit.point = along3(start, direction, hit.distance);
    hit.back = reversed3(direction);
    hit.normal.x = SPLAT(0.0f);
    hit.normal.y = SPLAT(0.0f);
    hit.normal.z = SPLAT(1.0f);
    for (int i = 0; i < fan->objects; i++) {
        const mask here = hit.is_hit & MASK_OF(hit.surface == i);
        if (!ANY(here))
            continue;
        const struct vector3 outward =
            object_normal(&objects[i], start, direction, CHOOSE(here, hit.distance, SPLAT(0.0f)));
        hit.normal = choose3(here, outward, hit.normal);
    }
    /* inner sides scatter as outer ones do */
    const mask is_outer = MASK_OF(dot3(hit.normal, hit.back) >= 0.0f);
    hit.normal = choose3(is_outer, hit.normal, reversed3(hit.normal));
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

/* Whether anything is between a point on a surface and another one `path` away. */
FUNCTION mask is_open_way(const struct fan_record *fan, GLOBAL const struct object_record *objects,
                          struct vector3 start, struct vector3 direction, real path)
{
    const struct nearest_hit blocking =
        find_nearest_hit(objects, fan->objects, start, direction, 0.0f);
    return MASK_OF(blocking.distance > path) &
           MASK_OF(seabed_distance(fan, start, direction) > path);
}

/* A point off the surface by more than its rounding, less than anything that throws a shadow. */
FUNCTION struct vector3 start_from(const struct chain_hit *hit)
{
    return along3(hit->point, hit->normal, SPLAT(2.0e-5f));
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
