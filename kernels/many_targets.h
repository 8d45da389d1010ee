/* Directions from a point towards one of many targets. A sphere is chosen in proportion to its
 * opening. Some neighbouring rays share the probabilities, seen from their middle, so that all
 * spheres are gone through once for all of these rays. The direction is uniform over the chosen
 * sphere's cone as seen from the ray's own point (kernels/MATH.md, "Chains"). */
#ifndef SONJECT_KERNELS_MANY_TARGETS_H
#define SONJECT_KERNELS_MANY_TARGETS_H

#include "target_sampling.h"

/* Returns the groups of spheres, which lie behind the sphere_records. Behind them lie the groups of
 * the spheres around groups. Unused slots of a group have radius 0. */
FUNCTION GLOBAL const struct sphere_group *groups_of(const struct trace *trace)
{
    return (GLOBAL const struct sphere_group *)(trace->spheres + trace->chains->spheres);
}

/* The probabilities by which rays choose their spheres. */
struct target_choice {
    float x, y, z;     /* m: point from which the openings are seen */
    float square_blur; /* m^2: added to squared distances from that point, as a blur */
    float before[TARGET_GROUPS_MAX + 1]; /* sum of the openings in earlier groups; last: in all */
};

/* The spheres of a group from one slot on, as seen from a point. */
struct seen_spheres {
    struct vector3 way;
    vfloat square_distance, square_radius;
};

FUNCTION struct seen_spheres see_spheres(GLOBAL const struct sphere_group *group, int slot,
                                         struct vector3 point)
{
    struct seen_spheres seen;
    seen.way = vector3_of(LOAD_VFLOAT(group->centre_x + slot) - point.x,
                          LOAD_VFLOAT(group->centre_y + slot) - point.y,
                          LOAD_VFLOAT(group->centre_z + slot) - point.z);
    const vfloat radius = LOAD_VFLOAT(group->radius + slot);
    seen.square_distance = dot3(seen.way, seen.way);
    seen.square_radius = radius * radius;
    return seen;
}

/* Returns the weight of a sphere in the choice: its opening, or 1 from inside. */
FUNCTION vfloat choice_weight(const struct target_choice *choice,
                              GLOBAL const struct sphere_group *group, int slot)
{
    const struct vector3 from = vector3_of(SPLAT(choice->x), SPLAT(choice->y), SPLAT(choice->z));
    const struct seen_spheres seen = see_spheres(group, slot, from);
    mask is_outside;
    const vfloat opening =
        opening_at(seen.square_distance + choice->square_blur, seen.square_radius, &is_outside);
    return SELECT(MASK_OF(seen.square_radius > 0.0f), SELECT(is_outside, opening, SPLAT(1.0f)),
                  SPLAT(0.0f));
}

FUNCTION void weigh_group(const struct target_choice *choice,
                          GLOBAL const struct sphere_group *group, float weights[SPHERES_OF_GROUP])
{
    for (int slot = 0; slot < SPHERES_OF_GROUP; slot += WIDTH) {
        const vfloat weight = choice_weight(choice, group, slot);
        STORE_VFLOAT(weight, weights + slot);
    }
}

/* Sums the openings one after the other, whatever the width. */
FUNCTION void begin_choice(const struct trace *trace, struct target_choice *choice)
{
    GLOBAL const struct sphere_group *groups = groups_of(trace);
    float sum = 0.0f;
    for (int group = 0; group < trace->chains->groups; group++) {
        float weights[SPHERES_OF_GROUP];
        choice->before[group] = sum;
        weigh_group(choice, &groups[group], weights);
        for (int slot = 0; slot < SPHERES_OF_GROUP; slot++)
            sum += weights[slot];
    }
    choice->before[trace->chains->groups] = sum;
}

/* The spheres that lanes choose, and the rest 0...1 of each lane's uniform deviate. */
struct sampled_spheres {
    struct vector3 centre;
    vfloat radius, rest;
};

/* Finds one lane's sphere: the last whose predecessors' weights sum to no more than `wanted`. */
FUNCTION void sample_sphere(const struct target_choice *choice,
                            GLOBAL const struct sphere_group *groups, int count, float wanted,
                            int *group, int *slot, float *rest)
{
    float weights[SPHERES_OF_GROUP];
    int low = 0;
    for (int end = count; end - low > 1;) {
        const int middle = (low + end) / 2;
        if (choice->before[middle] <= wanted)
            low = middle;
        else
            end = middle;
    }
    weigh_group(choice, &groups[low], weights);
    float before = choice->before[low];
    float share = 0.0f;
    *group = low;
    *slot = 0;
    for (int i = 0; i < SPHERES_OF_GROUP; i++) {
        if (weights[i] > 0.0f && before <= wanted) {
            *slot = i;
            share = (wanted - before) / weights[i];
        }
        before += weights[i];
    }
    *rest = share < 0.9999999f ? share : 0.9999999f;
}

/* Chooses spheres by the choice that all lanes share. If that is 0, each lane chooses for itself
 * and leaves its choice in own[lane]. */
FUNCTION struct sampled_spheres sample_spheres(const struct trace *trace,
                                               const struct target_choice *shared,
                                               struct target_choice *own, struct vector3 point,
                                               vfloat uniform, mask is_wanted)
{
    GLOBAL const struct sphere_group *groups = groups_of(trace);
    float from[3][WIDTH], uniforms[WIDTH];
    float x[WIDTH], y[WIDTH], z[WIDTH], radius[WIDTH], rest[WIDTH];
    store_vector3(point, from);
    STORE_VFLOAT(uniform, uniforms);
    for (int lane = 0; lane < WIDTH; lane++) {
        x[lane] = y[lane] = radius[lane] = rest[lane] = 0.0f;
        z[lane] = 1.0e6f; /* far up, where nothing is wanted */
    }
    for (RECORD_WORD left = lane_bits(is_wanted); left != 0; left &= left - 1) {
        const int lane = lowest_bit(left);
        const struct target_choice *choice = shared;
        int group, slot;
        if (!shared) {
            own[lane].x = from[0][lane];
            own[lane].y = from[1][lane];
            own[lane].z = from[2][lane];
            own[lane].square_blur = 0.0f;
            begin_choice(trace, &own[lane]);
            choice = &own[lane];
        }
        sample_sphere(choice, groups, trace->chains->groups,
                      uniforms[lane] * choice->before[trace->chains->groups], &group, &slot,
                      &rest[lane]);
        x[lane] = groups[group].centre_x[slot];
        y[lane] = groups[group].centre_y[slot];
        z[lane] = groups[group].centre_z[slot];
        radius[lane] = groups[group].radius[slot];
    }
    struct sampled_spheres chosen;
    chosen.centre = vector3_of(LOAD_VFLOAT(x), LOAD_VFLOAT(y), LOAD_VFLOAT(z));
    chosen.radius = LOAD_VFLOAT(radius);
    chosen.rest = LOAD_VFLOAT(rest);
    return chosen;
}

/* The densities with which directions are found. Cones give by_solid_angle, 1/sr. The surface's own
 * BRDF gets brdf_share of the choices, where the point is inside the chosen sphere. */
struct target_density {
    float by_solid_angle, brdf_share;
};

/* Adds the densities of a group's spheres whose cones hold the direction or that hold the point. */
FUNCTION void add_group_density(const struct target_choice *choice,
                                GLOBAL const struct sphere_group *group, struct vector3 point,
                                struct vector3 direction, struct target_density *density)
{
    float by_solid_angle[SPHERES_OF_GROUP], inside[SPHERES_OF_GROUP];
    RECORD_WORD met = 0;
    for (int slot = 0; slot < SPHERES_OF_GROUP; slot += WIDTH) {
        const struct seen_spheres seen = see_spheres(group, slot, point);
        const vfloat along = dot3(seen.way, direction);
        const struct vector3 miss = along3(seen.way, direction, -along);
        const mask is_there = MASK_OF(seen.square_radius > 0.0f);
        mask is_outside;
        const vfloat opening = opening_at(seen.square_distance, seen.square_radius, &is_outside);
        const mask is_in_cone = is_there & is_outside & MASK_OF(along > 0.0f) &
                                MASK_OF(dot3(miss, miss) <= seen.square_radius);
        const mask is_inside = is_there & ~is_outside;
        const RECORD_WORD here = lane_bits(is_in_cone | is_inside);
        if (here == 0)
            continue;
        met |= here << slot;
        const vfloat weight = choice_weight(choice, group, slot);
        const vfloat cones =
            SELECT(is_in_cone, weight / SELECT(is_in_cone, opening, SPLAT(1.0f)), SPLAT(0.0f));
        const vfloat brdf = SELECT(is_inside, weight, SPLAT(0.0f));
        STORE_VFLOAT(cones, by_solid_angle + slot);
        STORE_VFLOAT(brdf, inside + slot);
    }
    for (; met != 0; met &= met - 1) {
        const int slot = lowest_bit(met);
        density->by_solid_angle += by_solid_angle[slot];
        density->brdf_share += inside[slot];
    }
}

/* Returns the spheres, slightly enlarged, that the ray may meet or starts in: bit i is sphere i. */
FUNCTION RECORD_WORD groups_ahead(GLOBAL const struct sphere_group *bounds, struct vector3 point,
                                  struct vector3 direction)
{
    RECORD_WORD met = 0;
    for (int slot = 0; slot < SPHERES_OF_GROUP; slot += WIDTH) {
        const struct seen_spheres seen = see_spheres(bounds, slot, point);
        const vfloat along = dot3(seen.way, direction);
        const struct vector3 miss = along3(seen.way, direction, -along);
        const vfloat reach = seen.square_radius * 1.01f;
        met |= lane_bits(MASK_OF(seen.square_radius > 0.0f) & MASK_OF(dot3(miss, miss) <= reach) &
                         (MASK_OF(along > 0.0f) | MASK_OF(seen.square_distance <= reach)))
               << slot;
    }
    return met;
}

/* Returns the density of one lane's direction. */
FUNCTION struct target_density single_density(GLOBAL const struct chain_record *chains,
                                              GLOBAL const struct sphere_group *groups,
                                              const struct target_choice *choice,
                                              struct vector3 point, struct vector3 direction)
{
    GLOBAL const struct sphere_group *bounds = groups + chains->groups;
    struct target_density density = {0.0f, 0.0f};
    for (int first = 0; first < chains->groups; first += SPHERES_OF_GROUP) {
        RECORD_WORD met = groups_ahead(&bounds[first / SPHERES_OF_GROUP], point, direction);
        for (; met != 0; met &= met - 1)
            add_group_density(choice, &groups[first + lowest_bit(met)], point, direction, &density);
    }
    const float all = choice->before[chains->groups];
    density.by_solid_angle = density.by_solid_angle / all * 0.15915494309f;
    density.brdf_share = density.brdf_share / all;
    return density;
}

struct rays_lanes {
    float point[3][WIDTH], direction[3][WIDTH];
};

FUNCTION void densities_towards(const struct trace *trace, const struct target_choice *shared,
                                const struct target_choice *own, struct vector3 point,
                                struct vector3 direction, mask is_wanted, vfloat *by_solid_angle,
                                vfloat *brdf_share)
{
    GLOBAL const struct sphere_group *groups = groups_of(trace);
    struct rays_lanes lanes;
    const struct rays_lanes *rays = &lanes;
    float cones[WIDTH], shares[WIDTH];
    store_vector3(point, lanes.point);
    store_vector3(direction, lanes.direction);
    for (int lane = 0; lane < WIDTH; lane++)
        cones[lane] = shares[lane] = 0.0f;
    for (RECORD_WORD left = lane_bits(is_wanted); left != 0; left &= left - 1) {
        const int lane = lowest_bit(left);
        const struct target_density density =
            single_density(trace->chains, groups, shared ? shared : &own[lane],
                           splat_vector3(rays->point, lane), splat_vector3(rays->direction, lane));
        cones[lane] = density.by_solid_angle;
        shares[lane] = density.brdf_share;
    }
    *by_solid_angle = LOAD_VFLOAT(cones);
    *brdf_share = LOAD_VFLOAT(shares);
}

#endif
