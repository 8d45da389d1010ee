/* Hits of chains of sound on surfaces, and what these surfaces do with the sound. */
#ifndef SONJECT_KERNELS_CHAIN_HIT_H
#define SONJECT_KERNELS_CHAIN_HIT_H

#include "fan.h"
#include "fouling.h"
#include "intersection.h"
#include "random.h"
#include "seabed.h"
#include "surface.h"

#define SEABED      (-1)
#define SEA_SURFACE (-2)

struct chain_hit {
    struct vector3 point, normal; /* the normal is on the side that the ray came from */
    struct vector3 back;          /* unit, back along the ray, away from the surface */
    vfloat distance;
    vint surface;     /* an object's number, SEABED or SEA_SURFACE */
    vint left_behind; /* convex object that no way from here meets again; -1: none */
    mask is_hit;
};

/* Returns the nearest object on each way, except the one that the way leaves behind. If all ways
 * leave one and the same object, as on a single target, the search costs nothing. If is_any, the
 * result is any object up to `limit`. */
FUNCTION struct nearest_hit find_nearest_ahead(const struct trace *trace, struct vector3 start,
                                               struct vector3 direction, float minimum,
                                               vfloat limit, int is_any, vint left_behind,
                                               mask is_ray)
{
    const struct fan_record *fan = &trace->fan;
    struct nearest_hit nearest;
    if (has_object_tree(trace->objects, fan->objects)) {
        const struct object_search search = {limit, is_any, left_behind, is_ray};
        return search_objects(trace->objects, fan->objects, start, direction, minimum, &search);
    }
    nearest.distance = SPLAT(FAR_AWAY);
    nearest.object = VINT_OF(SPLAT(-1.0f));
    for (int i = 0; i < fan->objects; i++) {
        const mask is_ahead = is_ray & MASK_OF(left_behind != i);
        if (!ANY(is_ahead))
            continue;
        const vfloat distance =
            object_distance(&trace->objects[i], start, direction, SPLAT(minimum));
        const mask is_nearer = is_ahead & MASK_OF(distance < nearest.distance);
        nearest.distance = SELECT(is_nearer, distance, nearest.distance);
        nearest.object = SELECT(is_nearer, VINT_OF(SPLAT((float)i)), nearest.object);
    }
    return nearest;
}

/* Returns the hit on the nearest object, or on the seabed if that is nearer. */
FUNCTION struct chain_hit hit_of_ray(const struct trace *trace, enum wanted_face wanted,
                                     struct vector3 start, struct vector3 direction,
                                     const struct nearest_hit *nearest, vfloat to_seabed,
                                     mask is_ray)
{
    const mask on_object = MASK_OF(nearest->distance < to_seabed);
    struct chain_hit hit;
    hit.distance = smaller(nearest->distance, to_seabed);
    hit.is_hit = is_ray & MASK_OF(hit.distance < 0.5f * FAR_AWAY);
    hit.distance = SELECT(hit.is_hit, hit.distance, SPLAT(0.0f));
    hit.surface = SELECT(on_object, nearest->object, VINT_OF(SPLAT(-1.0f)));
    hit.point = along3(start, direction, hit.distance);
    hit.back = reversed3(direction);
    struct surface_face face;
    face.normal = seabed_normal(trace, hit.point, direction);
#if HAS_MESHES
    face.lift = zero3();
#endif
    hit.left_behind = VINT_OF(SPLAT(-1.0f));
    FOR_SURFACES_MET (i, 0, trace->fan.objects, hit.surface, hit.is_hit) {
        const mask here = hit.is_hit & MASK_OF(hit.surface == i);
        if (!ANY(here))
            continue;
        const struct surface_face found = object_face(&trace->objects[i], wanted, start, direction,
                                                      SELECT(here, hit.distance, SPLAT(0.0f)));
        face = choose_face(here, found, face);
        if (is_convex(&trace->objects[i]))
            hit.left_behind = SELECT(here, hit.surface, hit.left_behind);
    }
    /* Inner sides scatter as outer ones do, but their sound meets the object again. */
    const mask is_outer = MASK_OF(dot3(face.normal, hit.back) >= 0.0f);
    hit.normal = choose3(is_outer, face.normal, reversed3(face.normal));
    hit.point = lifted_point(hit.point, &face);
    hit.left_behind = SELECT(is_outer, hit.left_behind, VINT_OF(SPLAT(-1.0f)));
    return hit;
}

/* Returns the first hit of a ray. left_behind: of the surface where the ray starts. */
FUNCTION struct chain_hit find_chain_hit(const struct trace *trace, enum wanted_face wanted,
                                         struct vector3 start, struct vector3 direction,
                                         float minimum, vint left_behind, mask is_ray)
{
    const vfloat to_seabed = seabed_distance(trace, start, direction, SPLAT(minimum), is_ray);
    const struct nearest_hit nearest = find_nearest_ahead(trace, start, direction, minimum,
                                                          SPLAT(FAR_AWAY), 0, left_behind, is_ray);
    return hit_of_ray(trace, wanted, start, direction, &nearest, to_seabed, is_ray);
}

/* Returns the hit of a ray on its own object, whatever else may hide the object. */
FUNCTION struct chain_hit find_hit_on(const struct trace *trace, struct vector3 start,
                                      struct vector3 direction, float minimum, vint object,
                                      mask is_ray)
{
    struct nearest_hit nearest = {SPLAT(FAR_AWAY), object};
    FOR_SURFACES_MET (i, 0, trace->fan.objects, object, is_ray) {
        const mask here = is_ray & MASK_OF(object == i);
        if (ANY(here))
            nearest.distance =
                SELECT(here, object_distance(&trace->objects[i], start, direction, SPLAT(minimum)),
                       nearest.distance);
    }
    return hit_of_ray(trace, FACE_OF_SCATTERING, start, direction, &nearest, SPLAT(FAR_AWAY),
                      is_ray);
}

/* Returns whether chains meet the sea surface. */
FUNCTION int has_sea_surface(GLOBAL const struct chain_record *chains)
{
    return chains->sea_surface_height > 0.0f;
}

/* Returns the lowest number of a surface that chains meet. */
FUNCTION int first_surface_number(GLOBAL const struct chain_record *chains)
{
    return has_sea_surface(chains) ? SEA_SURFACE : SEABED;
}

/* Returns the record of surface number i of a scene. */
FUNCTION GLOBAL const struct surface_record *surface_number(const struct trace *trace, int i)
{
    if (i == SEA_SURFACE)
        return &trace->chains->sea_surface;
    return i == SEABED ? &trace->chains->seabed : &trace->objects[i].surface;
}

/* Returns the factor of fouling of surface number i on the scattering at a hit. */
FUNCTION vfloat fouling_at(GLOBAL const struct object_record *objects, int i,
                           const struct chain_hit *hit, struct vector3 out)
{
    return i < 0 ? SPLAT(1.0f)
                 : fouling_factor(&objects[i], hit->point, hit->normal, hit->back, out);
}

/* Returns the rough part's scattering at a hit, from one direction into another (surface.h). */
FUNCTION vfloat scattering_at(const struct trace *trace, const struct chain_hit *hit,
                              struct vector3 out)
{
    vfloat scattering = SPLAT(0.0f);
    FOR_SURFACES_MET (i, first_surface_number(trace->chains), trace->fan.objects, hit->surface,
                      hit->is_hit) {
        const mask here = hit->is_hit & MASK_OF(hit->surface == i);
        if (ANY(here))
            scattering =
                SELECT(here,
                       rough_scattering(surface_number(trace, i), hit->normal, hit->back, out) *
                           fouling_at(trace->objects, i, hit, out),
                       scattering);
    }
    return scattering;
}

FUNCTION struct vector3 start_from(const struct chain_hit *hit)
{
    return along3(hit->point, hit->normal, SPLAT(START_OFF_SURFACE));
}

/* Returns where nothing is between a hit and a point that lies `path` away. */
FUNCTION mask is_open_way(const struct trace *trace, const struct chain_hit *hit,
                          struct vector3 direction, vfloat path, mask is_way)
{
    const struct vector3 start = start_from(hit);
    const struct nearest_hit blocking =
        find_nearest_ahead(trace, start, direction, 0.0f, path, 1, hit->left_behind, is_way);
    const mask is_open = is_way & MASK_OF(blocking.distance > path);
    return is_open & MASK_OF(seabed_distance(trace, start, direction, SPLAT(0.0f), is_open) > path);
}

struct target_choice;

/* One group of chains under way. */
struct chain {
    struct chain_hit hit;
    struct random_key key;
    word number;    /* number of the ray, for its random numbers */
    vfloat energy;  /* the ray's solid angle times the weights so far, sr, in quanta of the hit's
                       order */
    vfloat dither;  /* uniform deviate for rounding its echoes */
    vfloat range;   /* range of the first hit less the reference range */
    vfloat length;  /* path from the first hit to this one, m */
    vfloat first_x; /* along-track position of the first hit */
    /* Ground range of the first hit that is no level boundary, over the cosine of the grazing
     * angle; without layers, the range by way of the boundaries. */
    vfloat first_reach;
    vint first_surface;
    vint surface_before;  /* the surface that the sound came from to this hit */
    vfloat first_density; /* density of the rough part at the first hit for its direction, 1/sr */
    mask began_smooth;  /* the first hit was a specular bounce, so nothing finds the reverse path */
    mask only_specular; /* every hit before this one was a specular bounce */
    mask only_boundaries; /* all of these bounces were on seabed or sea surface */
    mask met_object;
    mask is_alive;
    const struct target_choice *choice; /* choice among many targets; 0: each ray makes its own */
};

/* Sends out rays from the sonar at x. cell: the ray's piece of wavefront, along the track and in
 * elevation, m rad. only: the one object that each lane looks for, whatever hides it; 0: the first
 * surface is taken. Random numbers are left to be set. */
NOINLINE void begin_chain(const struct trace *trace, vfloat x, vfloat elevation, vfloat cell,
                          const vint *only, mask is_ray, struct chain *chain)
{
    const struct fan_record *fan = &trace->fan;
    const struct fan_ray ray = fan_ray_at(trace, x, elevation);
    const float minimum = -fan->reference_range;
    chain->hit = only ? find_hit_on(trace, ray.closest, ray.direction, minimum, *only, is_ray)
                      : find_chain_hit(trace, FACE_OF_SCATTERING, ray.closest, ray.direction,
                                       minimum, VINT_OF(SPLAT(-1.0f)), is_ray);
    chain->choice = 0;
    chain->range = ray.range_at_closest + chain->hit.distance;
    chain->length = SPLAT(0.0f);
    chain->first_x = x;
    chain->first_surface = chain->hit.surface;
    chain->surface_before = chain->hit.surface;
    chain->met_object = MASK_OF(chain->hit.surface >= 0);
    chain->is_alive = chain->hit.is_hit;
    chain->began_smooth = chain->is_alive & 0;
    chain->only_specular = chain->is_alive;
    chain->only_boundaries = chain->is_alive;
    /* Energy is that of the strip of wavefront w r de, over r^2. Through layers r de widens, and
     * 1/r^2 becomes s/(ground r). */
    const vfloat ground =
        fan->table.pieces > 0 ? fan->table.ground_range + chain->hit.point.y : SPLAT(1.0f);
    chain->first_reach =
        fan->table.pieces > 0 ? ground / ray.direction.y : fan->reference_range + chain->range;
    const vfloat spreading =
        fan->table.pieces > 0 ? ray.spreading / ground : 1.0f / chain->first_reach;
    chain->energy = cell * fan->quanta * SELECT(chain->is_alive, spreading, SPLAT(1.0f));
}

#endif
