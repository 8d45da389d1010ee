/* Second-order paths: two interactions, one on a target and one on the seabed. Each range cell of
 * the output has equally many samples: a point of a target, then a place of the seabed from which
 * the echo comes in that cell. Rays that targets scatter to the seabed find the same paths. Both
 * count with the shares of multiple importance sampling (kernels/MATH.md, "Second order"). */
#ifndef SONJECT_KERNELS_SECOND_ORDER_H
#define SONJECT_KERNELS_SECOND_ORDER_H

#include "chain_sea_surface.h"
#include "chain_step.h"
#include "path_ellipse.h"

/* Returns the records of targets' parts, which lie behind the spheres and their groups. */
FUNCTION GLOBAL const struct target_record *targets_of(const struct trace *trace)
{
    return (GLOBAL const struct target_record *)((GLOBAL const float *)trace->spheres +
                                                 trace->chains->target_words);
}

/* The cell in which a group of samples' echoes end. Ranges are those of half the path, less the
 * reference range. */
struct echo_cell {
    vfloat receiver_x;
    vfloat near_range, far_range;
};

/* Returns a cell of the output. */
FUNCTION struct echo_cell cell_number(const struct trace *trace, vfloat number, vfloat receiver_x)
{
    const struct fan_record *fan = &trace->fan;
    const float bins = (float)trace->chains->cell_bins;
    const vfloat first = (number - 0.5f) * bins - (float)trace->chains->first_bin;
    const float metres = 1.0f / fan->bins_per_metre;
    struct echo_cell cell;
    cell.receiver_x = receiver_x;
    cell.near_range = (first - fan->bin_at_reference) * metres;
    cell.far_range = ((first + bins) - fan->bin_at_reference) * metres;
    return cell;
}

/* Estimates a part's echo by way of the seabed in a cell, over the seabed's own echo. The way
 * between part and seabed is no shorter than the detour. The longer it is, the flatter it meets the
 * seabed. */
FUNCTION vfloat weight_of_target(GLOBAL const struct target_record *target,
                                 const struct echo_cell *cell)
{
    const vfloat aside = 2.0f * (cell->receiver_x - target->centre_x);
    const vfloat detour = larger(cell->near_range - target->range, SPLAT(0.0f));
    const vfloat square = aside * aside + detour * detour + target->square_radius;
    const vfloat weight =
        target->weight * smaller(target->top / SQUARE_ROOT(square), SPLAT(1.0f)) / square;
    return SELECT(MASK_OF(cell->far_range > target->nearest_range) &
                      MASK_OF(weight >= LEAST_WEIGHT),
                  weight, SPLAT(0.0f));
}

/* The weights of an object's parts in a cell. A cell that gets little follows only some of its
 * samples. */
struct target_weights {
    vfloat sum, share; /* share: of the samples that are followed */
};

FUNCTION struct target_weights weigh_targets(GLOBAL const struct target_record *targets, int count,
                                             const struct echo_cell *cell)
{
    struct target_weights weights;
    weights.sum = SPLAT(0.0f);
    for (int i = 0; i < count; i++)
        weights.sum += weight_of_target(&targets[i], cell);
    weights.share = smaller(weights.sum, SPLAT(1.0f));
    return weights;
}

/* The part on which a sample begins, and the window of the wavefront that it fills. */
struct sampled_target {
    vfloat first_x, width, first_elevation, elevations;
    vfloat least_y; /* least y of the seabed that exchanges sound with it */
    vfloat rays;    /* rays per m rad of the part's own fan */
    vfloat weight;  /* 0: the sample is left out */
    vint part;
};

/* Chooses the part of each sample. chosen: a uniform deviate. */
FUNCTION struct sampled_target sample_target(GLOBAL const struct target_record *targets, int count,
                                             const struct echo_cell *cell,
                                             const struct target_weights *weights, vfloat chosen,
                                             mask is_followed)
{
    struct sampled_target sampled;
    const vfloat wanted = chosen * weights->sum;
    vfloat before = SPLAT(0.0f);
    sampled.first_x = sampled.width = sampled.first_elevation = sampled.elevations = SPLAT(0.0f);
    sampled.least_y = sampled.rays = sampled.weight = SPLAT(0.0f);
    sampled.part = VINT_OF(SPLAT(-1.0f));
    for (int i = 0; i < count; i++) {
        GLOBAL const struct target_record *target = &targets[i];
        const vfloat weight = weight_of_target(target, cell);
        const mask is_it = is_followed & MASK_OF(weight > 0.0f) & MASK_OF(before <= wanted);
        sampled.first_x = SELECT(is_it, SPLAT(target->first_x), sampled.first_x);
        sampled.width = SELECT(is_it, SPLAT(target->width), sampled.width);
        sampled.first_elevation =
            SELECT(is_it, SPLAT(target->first_elevation), sampled.first_elevation);
        sampled.elevations = SELECT(is_it, SPLAT(target->elevations), sampled.elevations);
        sampled.least_y = SELECT(is_it, SPLAT(target->least_y), sampled.least_y);
        sampled.rays = SELECT(is_it, SPLAT(target->rays), sampled.rays);
        sampled.weight = SELECT(is_it, weight, sampled.weight);
        sampled.part = SELECT(is_it, VINT_OF(SPLAT((float)target->part)), sampled.part);
        before += weight;
    }
    return sampled;
}

/* Returns the samples of a cell per m rad of a part's window and m^2 of the seabed's plan. length:
 * of the line across the track that a sample's place stands for. Along this line the seabed's x
 * moves twice as fast as the echo's. */
FUNCTION vfloat density_of_samples(const struct trace *trace, vfloat weight,
                                   const struct target_weights *weights, vfloat window,
                                   vfloat length)
{
    const mask is_possible = MASK_OF(weight > 0.0f) & MASK_OF(length > 0.0f);
    const vfloat area = 2.0f * trace->fan.strip_width * window * length * weights->sum;
    return SELECT(is_possible,
                  (float)trace->chains->cell_samples * weight * weights->share /
                      SELECT(is_possible, area, SPLAT(1.0f)),
                  SPLAT(0.0f));
}

/* Returns the seabed under a point of the plan. */
FUNCTION struct chain_hit seabed_below(const struct trace *trace, vfloat x, vfloat y,
                                       mask is_wanted)
{
    struct chain_hit hit;
    hit.point = vector3_of(x, y, SPLAT(trace->fan.seabed_height));
#if HAS_RELIEF
    if (has_relief(trace)) { /* rays start little above it, so that heights keep their digits */
        struct vector3 above = hit.point;
        const struct vector3 down = vector3_of(SPLAT(0.0f), SPLAT(0.0f), SPLAT(-1.0f));
        above.z = above.z + (relief_of(trace).grid->highest + 0.01f);
        hit.point.z = above.z - seabed_distance(trace, above, down, SPLAT(0.0f), is_wanted);
    }
#endif
    hit.surface = VINT_OF(SPLAT((float)SEABED));
    hit.left_behind = VINT_OF(SPLAT(-1.0f));
    hit.is_hit = is_wanted;
    return hit;
}

/* Returns the solid angle of a square metre of the plan at a hit, sr. spreading: 1 / way^2. */
FUNCTION vfloat opening_of_plan(const struct chain_hit *seabed, vfloat spreading)
{
    return dot3(seabed->normal, seabed->back) * spreading /
           larger(seabed->normal.z, SPLAT(1.0e-3f));
}

/* Returns the places on a line from which the echo of a chain's hit is in a cell. */
FUNCTION struct places places_of_cell(const struct fan_record *fan, const struct chain *chain,
                                      const struct seabed_line *line, const struct echo_cell *cell,
                                      vfloat least_y)
{
    const vfloat first = fan->reference_range - first_leg(chain, cell->receiver_x);
    return places_between(line, first + 2.0f * cell->near_range, first + 2.0f * cell->far_range,
                          least_y);
}

/* Returns the share of an echo that counts for a ray from a target that met the seabed. Samples
 * count for the rest. */
NOINLINE vfloat share_of_ray(const struct trace *trace, const struct chain *chain)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct chain_record *chains = trace->chains;
    const mask is_shared = chain->is_alive & ~chain->began_smooth &
                           MASK_OF(chain->first_surface >= 0) &
                           MASK_OF(chain->hit.surface == SEABED);
    if (!ANY(is_shared))
        return SPLAT(1.0f);
    GLOBAL const struct target_record *targets = targets_of(trace);
    GLOBAL const struct target_record *own = &targets[fan->target];
    const struct vector3 from = along3(chain->hit.point, chain->hit.back, chain->length);
    const vfloat receiver_x = receiver_of(chains, chain);
    const struct seabed_line line = line_across(fan, from, chain->hit.point.x, receiver_x);
    const vfloat y = chain->hit.point.y - from.y;
    const vfloat square = line.square + y * y;
    const vfloat length =
        SQUARE_ROOT(square) +
        SQUARE_ROOT(larger(square + line.difference + 2.0f * line.ground * y, SPLAT(0.0f)));
    const vfloat first = fan->reference_range - first_leg(chain, receiver_x);
    const vfloat bin = 0.5f * (length - first) * fan->bins_per_metre + fan->bin_at_reference +
                       (float)chains->first_bin;
    const vfloat place =
        smaller(larger(bin / (float)chains->cell_bins + 0.5f, SPLAT(-1.0e6f)), SPLAT(1.0e6f));
    const vfloat towards_zero = VFLOAT_OF(VINT_OF(place));
    const vfloat number =
        towards_zero - SELECT(MASK_OF(towards_zero > place), SPLAT(1.0f), SPLAT(0.0f));
    const struct echo_cell cell = cell_number(trace, number, receiver_x);
    const struct target_weights weights =
        weigh_targets(targets + own->first_target, own->targets, &cell);
    const vfloat least_y = own->least_y - from.y;
    const struct places places = places_of_cell(fan, chain, &line, &cell, least_y);
    const mask is_heard = MASK_OF(y >= least_y);
    const mask is_sampled = is_heard & MASK_OF(number >= (float)own->first_cell) &
                            MASK_OF(number < (float)(own->first_cell + own->cells));
    const vfloat samples =
        SELECT(is_sampled,
               density_of_samples(trace, weight_of_target(own, &cell), &weights,
                                  SPLAT(own->width * own->elevations), length_of_place(&places, y)),
               SPLAT(0.0f));
    const vfloat opening =
        opening_of_plan(&chain->hit, 1.0f / larger(chain->length * chain->length, SPLAT(1.0e-12f)));
    const vfloat rays = own->rays * chain->first_density * opening;
    const mask has_rays = MASK_OF(rays > 0.0f);
    const vfloat share = rays / SELECT(has_rays, rays + samples, SPLAT(1.0f));
    return SELECT(is_shared, SELECT(is_heard & has_rays, share, SPLAT(0.0f)), SPLAT(1.0f));
}

#endif
