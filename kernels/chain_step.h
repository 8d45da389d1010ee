/* The step of a chain of sound from a hit: by the surface's BRDF, by its specular part, or from
 * seabed and sea surface towards the targets (kernels/MATH.md, "Chains"). */
#ifndef SONJECT_KERNELS_CHAIN_STEP_H
#define SONJECT_KERNELS_CHAIN_STEP_H

#include "chain_hit.h"
#include "many_targets.h"
#include "reflectivity_map.h"
#include "target_sampling.h"

/* The step of a chain from a hit. */
struct chain_step {
    struct vector3 direction;
    vfloat weight;  /* f cos / density, or the specular part's energy over its probability */
    vfloat density; /* density of the rough part's directions, 1/sr */
    mask is_specular;
};

/* Returns a step by a rough part: its scattering in the direction over the sampling density. */
FUNCTION struct chain_step step_in_direction(GLOBAL const struct surface_record *surface,
                                             const struct chain_hit *hit, struct vector3 direction,
                                             vfloat density)
{
    const vfloat cosine = dot3(hit->normal, direction);
    const mask is_possible = MASK_OF(density > 0.0f) & MASK_OF(cosine > 0.0f);
    const vfloat scattering = rough_scattering(surface, hit->normal, hit->back, direction);
    struct chain_step step;
    step.direction = direction;
    step.weight = SELECT(
        is_possible, scattering * cosine / SELECT(is_possible, density, SPLAT(1.0f)), SPLAT(0.0f));
    step.density = density;
    step.is_specular = is_possible & 0;
    return step;
}

/* Returns a step by the rough part of seabed or sea surface, towards the targets. If the hit is
 * among the targets or the step leads elsewhere too, half of the steps follow the BRDF. All do if
 * no cone is seen, since the point is inside all spheres. */
FUNCTION struct chain_step step_among_few(const struct trace *trace,
                                          GLOBAL const struct surface_record *surface,
                                          int leads_elsewhere, const struct chain_hit *hit,
                                          vfloat choice, vfloat u, vfloat v)
{
    GLOBAL const struct chain_record *chains = trace->chains;
    struct target_sampling cones;
    view_targets(trace->spheres, chains->spheres, hit->point, &cones);
    const vfloat elsewhere_share =
        leads_elsewhere ? SPLAT(0.5f) : SELECT(cones.is_inside, SPLAT(0.5f), SPLAT(0.0f));
    const vfloat brdf_share = SELECT(MASK_OF(cones.sum > 0.0f), elsewhere_share, SPLAT(1.0f));
    const vfloat cone_share = 1.0f - brdf_share;
    const mask by_brdf = MASK_OF(choice < brdf_share);
    const vfloat cone_choice = (choice - brdf_share) / larger(cone_share, SPLAT(0.5f));
    struct vector3 direction =
        sample_target_direction(trace->spheres, chains->spheres, hit->point, &cones,
                                larger(cone_choice, SPLAT(0.0f)), u, v);
    if (ANY(by_brdf)) {
        const struct vector3 around = sample_rough_direction(
            surface, hit->normal, hit->back, choice / larger(brdf_share, SPLAT(0.5f)), u, v);
        direction = choose3(by_brdf, around, direction);
    }
    vfloat density = cone_share * target_direction_density(trace->spheres, chains->spheres,
                                                           hit->point, &cones, direction);
    if (ANY(MASK_OF(brdf_share > 0.0f)))
        density += brdf_share * rough_direction_density(surface, hit->normal, hit->back, direction);
    return step_in_direction(surface, hit, direction, density);
}

/* Works as step_among_few, among many targets. If the point is inside the chosen sphere, the
 * surface's own BRDF finds the direction. targets: the choice of first hits on the seabed; 0: each
 * hit makes its own. */
NOINLINE struct chain_step step_among_many(const struct trace *trace,
                                           const struct target_choice *targets,
                                           GLOBAL const struct surface_record *surface,
                                           int leads_elsewhere, const struct chain_hit *hit,
                                           vfloat choice, vfloat u, vfloat v)
{
    const mask is_here = hit->is_hit & MASK_OF(hit->surface < 0);
    const float elsewhere_share = leads_elsewhere ? 0.5f : 0.0f;
    const float cone_share = 1.0f - elsewhere_share;
    const mask goes_elsewhere = MASK_OF(choice < elsewhere_share);
    const vfloat cone_choice = larger((choice - elsewhere_share) / cone_share, SPLAT(0.0f));
    struct target_choice own[WIDTH];
    const struct sampled_spheres chosen =
        sample_spheres(trace, targets, own, hit->point, cone_choice, is_here);
    const struct vector3 way = minus3(chosen.centre, hit->point);
    mask is_outside;
    const vfloat opening = opening_at(dot3(way, way), chosen.radius * chosen.radius, &is_outside);
    struct vector3 direction =
        direction_in_cone(choose3(is_outside, way, hit->normal), opening, u, v);
    const mask by_brdf = goes_elsewhere | ~is_outside;
    if (ANY(is_here & by_brdf)) {
        const vfloat brdf_choice = SELECT(goes_elsewhere, 2.0f * choice, chosen.rest);
        direction = choose3(
            by_brdf, sample_rough_direction(surface, hit->normal, hit->back, brdf_choice, u, v),
            direction);
    }
    vfloat density, brdf_share;
    densities_towards(trace, targets, own, hit->point, direction, is_here, &density, &brdf_share);
    density = cone_share * density;
    brdf_share = elsewhere_share + cone_share * brdf_share;
    if (ANY(MASK_OF(brdf_share > 0.0f)))
        density += brdf_share * rough_direction_density(surface, hit->normal, hit->back, direction);
    return step_in_direction(surface, hit, direction, density);
}

/* Returns a step by the rough part of seabed or sea surface, towards few or many targets. */
FUNCTION struct chain_step step_to_targets(const struct trace *trace,
                                           const struct target_choice *targets,
                                           GLOBAL const struct surface_record *surface,
                                           int leads_elsewhere, const struct chain_hit *hit,
                                           vfloat choice, vfloat u, vfloat v)
{
    if (trace->chains->groups > 0)
        return step_among_many(trace, targets, surface, leads_elsewhere, hit, choice, u, v);
    return step_among_few(trace, surface, leads_elsewhere, hit, choice, u, v);
}

/* Returns a step by the rough part of an object, by its own BRDF. */
FUNCTION struct chain_step step_from_object(GLOBAL const struct surface_record *surface,
                                            const struct chain_hit *hit, vfloat choice, vfloat u,
                                            vfloat v)
{
    const struct vector3 direction =
        sample_rough_direction(surface, hit->normal, hit->back, choice, u, v);
    const vfloat density = rough_direction_density(surface, hit->normal, hit->back, direction);
    return step_in_direction(surface, hit, direction, density);
}

/* Returns the probability of a specular bounce, near the bounce's share of the energy. */
FUNCTION vfloat specular_probability(GLOBAL const struct surface_record *surface, vfloat energy)
{
    if (!has_rough_part(surface))
        return SPLAT(1.0f);
    const float rough = rough_albedo(surface);
    return smaller(larger(energy / (energy + rough), SPLAT(0.1f)), SPLAT(0.9f));
}

/* Returns a step by the rough or smooth part of one surface. Rough steps from seabed or sea surface
 * go to targets. If chains meet the sea surface, later hits also send some of these elsewhere. */
FUNCTION struct chain_step step_from_surface(const struct trace *trace,
                                             const struct target_choice *targets,
                                             GLOBAL const struct surface_record *surface,
                                             int number, int order, const struct chain_hit *hit,
                                             vfloat choice, vfloat u, vfloat v)
{
    GLOBAL const struct chain_record *chains = trace->chains;
    struct chain_step step;
    const int samples_targets =
        number < 0 && chains->spheres > 0 && chains->estimator == CHAINS_CONNECT;
    const int leads_elsewhere = has_sea_surface(chains) && order > 1;
    if (!has_smooth_part(surface))
        return samples_targets
                   ? step_to_targets(trace, targets, surface, leads_elsewhere, hit, choice, u, v)
                   : step_from_object(surface, hit, choice, u, v);
    const vfloat cosine = dot3(hit->normal, hit->back);
    const vfloat energy = specular_energy(surface, cosine);
    const vfloat probability = specular_probability(surface, energy);
    const mask is_specular = MASK_OF(choice < probability);
    const vfloat left = larger(1.0f - probability, SPLAT(1.0e-6f));
    const vfloat rest = smaller((choice - probability) / left, SPLAT(0.9999999f));
    if (has_rough_part(surface)) {
        const vfloat rough_choice = larger(rest, SPLAT(0.0f));
        step = samples_targets ? step_to_targets(trace, targets, surface, leads_elsewhere, hit,
                                                 rough_choice, u, v)
                               : step_from_object(surface, hit, rough_choice, u, v);
    } else {
        step.direction = hit->back;
        step.weight = step.density = SPLAT(0.0f);
    }
    step.direction =
        choose3(is_specular, reflected3(reversed3(hit->back), hit->normal), step.direction);
    step.weight = SELECT(is_specular, energy / probability, step.weight / left);
    step.density = step.density * left;
    step.is_specular = is_specular;
    return step;
}

/* Returns the density, 1/sr, with which an object's rough part sends a ray in a direction. */
FUNCTION vfloat rough_density_at(const struct trace *trace, const struct chain_hit *hit,
                                 struct vector3 direction)
{
    vfloat density = SPLAT(0.0f);
    FOR_SURFACES_MET (i, 0, trace->fan.objects, hit->surface, hit->is_hit) {
        GLOBAL const struct surface_record *surface = &trace->objects[i].surface;
        const mask here = hit->is_hit & MASK_OF(hit->surface == i);
        if (!ANY(here) || !has_rough_part(surface))
            continue;
        vfloat of_surface = rough_direction_density(surface, hit->normal, hit->back, direction);
        if (has_smooth_part(surface))
            of_surface =
                of_surface *
                (1.0f - specular_probability(
                            surface, specular_energy(surface, dot3(hit->normal, hit->back))));
        density = SELECT(here, of_surface, density);
    }
    return density;
}

FUNCTION struct chain_step next_step(const struct trace *trace, int order,
                                     const struct chain *chain, RECORD_WORD draw)
{
    vfloat u, v, choice;
    three_uniforms(chain->key, chain->number, draw, &u, &v, &choice);
    if (order == 1)
        choice = lattice_uniform(chain->number, LATTICE_OF_2_0, chain->key.second);
    const struct chain_hit *hit = &chain->hit;
    struct chain_step step;
    step.direction = hit->back;
    step.weight = step.density = SPLAT(0.0f);
    step.is_specular = MASK_OF(choice < -1.0f);
    FOR_SURFACES_MET (i, first_surface_number(trace->chains), trace->fan.objects, hit->surface,
                      chain->is_alive) {
        const mask here = chain->is_alive & MASK_OF(hit->surface == i);
        if (!ANY(here))
            continue;
        const struct chain_step from = step_from_surface(
            trace, chain->choice, surface_number(trace, i), i, order, hit, choice, u, v);
        step.direction = choose3(here, from.direction, step.direction);
        const vfloat fouled = from.weight * fouling_at(trace->objects, i, hit, from.direction);
        step.weight = SELECT(here, SELECT(from.is_specular, from.weight, fouled), step.weight);
        step.density = SELECT(here, from.density, step.density);
        step.is_specular = SELECT(here, from.is_specular, step.is_specular);
    }
    const vfloat factor = map_factor(trace, hit);
    step.weight = SELECT(step.is_specular, step.weight, step.weight * factor);
    return step;
}

#endif
