/* The incoherent part beyond the first interaction: chains of sound between seabed and targets
 * (kernels/MATH.md, "Chains"). A ray is followed from the receiver; at every rough hit the path is
 * closed to the source. */
#ifndef SONJECT_KERNELS_TRACE_CHAINS_H
#define SONJECT_KERNELS_TRACE_CHAINS_H

#include "chain_hit.h"
#include "random.h"
#include "reflectivity_map.h"
#include "tally.h"
#include "target_cones.h"

/* One group of chains under way. */
struct chain {
    struct chain_hit hit;
    struct random_key key;
    word number;  /* of the ray, for its random numbers */
    real energy;  /* what the receiver would get per unit of irradiance at the hit and unit of
                     scattering, m^2 sr, in quanta */
    real range;   /* from the receiver to the first hit less the reference range */
    real length;  /* from the first hit to this one */
    real first_x; /* along-track, of the first hit */
    whole first_surface;
    mask began_smooth; /* the first hit was a mirror bounce: nothing finds the reverse path */
    mask is_alive;
};

/* Where the source is as seen from a hit. */
struct source_way {
    struct vector3 direction;
    real path;
    real range; /* of half the whole path, less the reference range */
};

/* The receiver is at -reference_range * central direction of the plane x = ray's x. */
FUNCTION struct vector3 to_receiver(const struct fan_record *fan, struct vector3 point, real x)
{
    struct vector3 way;
    way.x = x - point.x;
    way.y = -fan->reference_range * fan->cosine_depression - point.y;
    way.z = fan->reference_range * fan->sine_depression - point.z;
    return way;
}

/* The way to the point (aside, up) of the source's rectangle, which spans x and the fan's central
 * upward direction about the receiver at receiver_x. Its length less the reference range R is
 * formed without subtracting ranges: |s - p|^2 - R^2 = |p|^2 - 2 s.p + up^2 (+ x^2), s the source,
 * up across s. */
FUNCTION struct source_way way_to_source(const struct fan_record *fan, const struct chain *chain,
                                         real receiver_x, real aside, real up)
{
    const struct vector3 point = chain->hit.point;
    const float r = fan->reference_range;
    struct source_way way;
    struct vector3 to = to_receiver(fan, point, receiver_x + aside);
    to.y += up * fan->sine_depression;
    to.z += up * fan->cosine_depression;
    way.path = SQUARE_ROOT(dot3(to, to));
    const real inverse = 1.0f / way.path;
    way.direction.x = to.x * inverse;
    way.direction.y = to.y * inverse;
    way.direction.z = to.z * inverse;
    const real height_along =
        point.y * fan->cosine_depression - point.z * fan->sine_depression; /* of p towards R */
    const real height_across = point.y * fan->sine_depression + point.z * fan->cosine_depression;
    const real excess = (to.x * to.x + point.y * point.y + point.z * point.z +
                         2.0f * r * height_along - 2.0f * up * height_across + up * up) /
                        (way.path + r);
    /* in focused columns the receiver is not abreast of the first hit: that leg is longer too */
    const real shift = chain->first_x - receiver_x;
    const real first = r + chain->range;
    const real longer = shift * shift / (SQUARE_ROOT(first * first + shift * shift) + first);
    way.range = 0.5f * (chain->range + longer + chain->length + excess);
    return way;
}

/* Energies of one group of rays, lane by lane, ready to be tallied. */
struct chain_echo {
    float energy[WIDTH]; /* quanta; 0: none */
    int bin[WIDTH];
    int strip[WIDTH], reverse_strip[WIDTH]; /* of the whole track; reverse -2^30: no such echo */
};

#define NO_STRIP (-1073741824)

/* The strip of the whole track at x; NO_STRIP outside it. */
FUNCTION whole strip_at(const struct fan_record *fan, real x)
{
    const real strip = (x - fan->first_strip_x) / fan->strip_width;
    return WHOLE_OF(smaller(larger(strip, SPLAT(-1.0e6f)), SPLAT(1.0e6f)) + 1000000.5f) - 1000000;
}

FUNCTION void tally_chain_echo(const struct fan_record *fan,
                               GLOBAL const struct chain_record *chains, GLOBAL TALLY *tallies,
                               int order, const struct chain_echo *echo,
                               struct outcome_record *outcome)
{
    const int plane = chains->planes > 1 ? order - chains->first_order : 0;
    for (int lane = 0; lane < WIDTH; lane++) {
        const float energy = echo->energy[lane];
        const int bin = echo->bin[lane];
        if (!(energy > 0.0f) && energy == energy)
            continue;
        if (bin < 0 || bin >= fan->bins)
            continue;
        const int strip = echo->strip[lane] - chains->tally_first_strip;
        const int reverse = echo->reverse_strip[lane] - chains->tally_first_strip;
        GLOBAL TALLY *line = tallies + (long)plane * chains->tally_strips * fan->bins + bin;
        if (strip >= 0 && strip < chains->tally_strips)
            tally_add(line + (long)strip * fan->bins, energy, &outcome->faults);
        if (reverse >= 0 && reverse < chains->tally_strips)
            tally_add(line + (long)reverse * fan->bins, energy, &outcome->faults);
        outcome->impulses++;
    }
}

/* A path that was found one way may also stand for its reverse. What began with a mirror bounce
 * does, because nothing finds the reverse: its last hit would be the mirror. In focused columns,
 * where both are seen from the same place, so do the chains that began on the seabed and end on a
 * target: they are led there on purpose, and those found from the target are left out for them. */
struct ways_counted {
    mask is_counted, stands_for_reverse;
};

FUNCTION struct ways_counted count_ways(GLOBAL const struct chain_record *chains, int order,
                                        const struct chain *chain)
{
    const mask none = chain->is_alive & 0;
    const mask began_on_seabed = MASK_OF(chain->first_surface == -1);
    const mask ends_on_seabed = MASK_OF(chain->hit.surface == -1);
    struct ways_counted ways;
    ways.is_counted = ~none;
    ways.stands_for_reverse = chains->estimator == CHAINS_CONNECT ? chain->began_smooth : none;
    if (chains->is_reciprocal) {
        ways.is_counted = ~(~chain->began_smooth & ~began_on_seabed & ends_on_seabed);
        ways.stands_for_reverse =
            ways.stands_for_reverse | (~chain->began_smooth & began_on_seabed & ~ends_on_seabed);
    }
    /* one object seen by way of the seabed's mirror is a pair of sources' (trace_rough_mirrored.h)
     */
    if (order == 2 && chains->estimator == CHAINS_CONNECT)
        ways.is_counted = ways.is_counted & ~(chain->began_smooth & began_on_seabed);
    return ways;
}

/* Keeps the echo that a hit sends to the source: energy is that of the path, way the one to the
 * source. */
FUNCTION void keep_echo(const struct fan_record *fan, GLOBAL const struct chain_record *chains,
                        int order, const struct chain *chain, real energy, real range,
                        real normalisation, struct chain_echo *echo)
{
    const struct ways_counted ways = count_ways(chains, order, chain);
    const mask both = ways.stands_for_reverse;
    real kept = energy * normalisation;
    const whole none = WHOLE_OF(SPLAT((float)NO_STRIP));
    whole strip, reverse;
    if (chains->is_focused) {
        /* a path and its reverse are one echo of twice the amplitude */
        kept = CHOOSE(both, kept * 4.0f, kept * 2.0f);
        strip = strip_at(fan, 0.5f * (chain->first_x + chain->hit.point.x));
        reverse = none;
    } else {
        strip = strip_at(fan, chain->first_x);
        reverse = CHOOSE(both, strip_at(fan, chain->hit.point.x), none);
    }
    kept = CHOOSE(ways.is_counted & chain->is_alive, kept, SPLAT(0.0f));
    const whole bin = nearest_bin(range * fan->bins_per_metre + fan->first_bin);
    STORE_REAL(kept, echo->energy);
    STORE_WHOLE(bin, echo->bin);
    STORE_WHOLE(strip, echo->strip);
    STORE_WHOLE(reverse, echo->reverse_strip);
}

/* Connects the hit to the source and gives the echo: energy f cos / r^2 at the source, normalised
 * by the fourth power of half the path (MATH.md). */
FUNCTION void connect_chain(const struct fan_record *fan, GLOBAL const struct chain_record *chains,
                            GLOBAL const struct object_record *objects, GLOBAL const float *map,
                            int order, const struct chain *chain, RECORD_WORD draw,
                            struct chain_echo *echo, struct outcome_record *outcome)
{
    const struct chain_hit *hit = &chain->hit;
    real receiver_x = chain->first_x;
    real source_aside = SPLAT(0.0f);
    real source_up = SPLAT(0.0f);
    if (chains->is_focused)
        receiver_x = 0.5f * (chain->first_x + hit->point.x);
    if (fan->source_side > 0.0f) {
        real along, across;
        two_uniforms(chain->key, chain->number, draw, &along, &across);
        source_aside = (along - 0.5f) * fan->source_side;
        source_up = (across - 0.5f) * fan->source_side;
    }
    const struct source_way way = way_to_source(fan, chain, receiver_x, source_aside, source_up);
    const real scattering =
        scattering_at(fan, chains, objects, hit, way.direction) * map_factor(fan, chains, map, hit);
    const real cosine = dot3(hit->normal, way.direction);
    mask is_open = chain->is_alive & MASK_OF(scattering > 0.0f);
    if (ANY(is_open)) {
        outcome->queries += count_lanes(is_open);
        is_open = is_open & is_open_way(fan, objects, start_from(hit), way.direction, way.path);
    }
    const real energy =
        CHOOSE(is_open, chain->energy * scattering * cosine / (way.path * way.path), SPLAT(0.0f));
    const real half_path = fan->reference_range + way.range;
    const real square = half_path * half_path;
    keep_echo(fan, chains, order, chain, energy, way.range, square * square, echo);
}

/* How a chain goes on from a hit. */
struct chain_step {
    struct vector3 direction;
    real weight; /* f cos / density, or the mirror's energy over its probability */
    mask is_mirror;
};

/* The rough part of the seabed: towards the targets; where the hit is among them, also all around.
 */
FUNCTION struct chain_step step_from_seabed(GLOBAL const struct chain_record *chains,
                                            GLOBAL const struct sphere_record *spheres,
                                            const struct chain_hit *hit, real choice, real u,
                                            real v)
{
    struct target_cones cones;
    view_targets(spheres, chains->spheres, hit->point, &cones);
    const real lobe_share = CHOOSE(cones.is_inside, SPLAT(0.5f), SPLAT(0.0f));
    const real cone_share = 1.0f - lobe_share;
    const mask by_lobe = MASK_OF(choice < lobe_share);
    const real cone_choice = (choice - lobe_share) / cone_share;
    struct chain_step step;
    step.direction = sample_target_direction(spheres, chains->spheres, hit->point, &cones,
                                             larger(cone_choice, SPLAT(0.0f)), u, v);
    if (ANY(by_lobe)) {
        const struct vector3 around =
            sample_rough_direction(&chains->seabed, hit->normal, hit->back,
                                   choice / larger(lobe_share, SPLAT(0.5f)), u, v);
        step.direction = choose3(by_lobe, around, step.direction);
    }
    real density = cone_share * target_direction_density(spheres, chains->spheres, hit->point,
                                                         &cones, step.direction);
    if (ANY(cones.is_inside))
        density += lobe_share *
                   rough_direction_density(&chains->seabed, hit->normal, hit->back, step.direction);
    const real cosine = dot3(hit->normal, step.direction);
    const mask is_possible = MASK_OF(density > 0.0f) & MASK_OF(cosine > 0.0f);
    step.weight = CHOOSE(is_possible,
                         rough_scattering(&chains->seabed, hit->normal, hit->back, step.direction) *
                             cosine / CHOOSE(is_possible, density, SPLAT(1.0f)),
                         SPLAT(0.0f));
    step.is_mirror = MASK_OF(choice < -1.0f);
    return step;
}

/* The rough part of an object, by its own lobes. */
FUNCTION struct chain_step step_from_object(GLOBAL const struct surface_record *surface,
                                            const struct chain_hit *hit, real choice, real u,
                                            real v)
{
    struct chain_step step;
    step.direction = sample_rough_direction(surface, hit->normal, hit->back, choice, u, v);
    const real density = rough_direction_density(surface, hit->normal, hit->back, step.direction);
    const real cosine = dot3(hit->normal, step.direction);
    const mask is_possible = MASK_OF(density > 0.0f) & MASK_OF(cosine > 0.0f);
    step.weight = CHOOSE(is_possible,
                         rough_scattering(surface, hit->normal, hit->back, step.direction) *
                             cosine / CHOOSE(is_possible, density, SPLAT(1.0f)),
                         SPLAT(0.0f));
    step.is_mirror = MASK_OF(choice < -1.0f);
    return step;
}

/* Rough or smooth part of one surface: a mirror bounce is taken with a probability near its share
 * of the energy. */
FUNCTION struct chain_step step_from_surface(GLOBAL const struct chain_record *chains,
                                             GLOBAL const struct sphere_record *spheres,
                                             GLOBAL const struct surface_record *surface,
                                             int is_seabed, const struct chain_hit *hit,
                                             real choice, real u, real v)
{
    struct chain_step step;
    const int follows_cones =
        is_seabed && chains->spheres > 0 && chains->estimator == CHAINS_CONNECT;
    if (!has_smooth_part(surface))
        return follows_cones ? step_from_seabed(chains, spheres, hit, choice, u, v)
                             : step_from_object(surface, hit, choice, u, v);
    const real cosine = dot3(hit->normal, hit->back);
    const real energy = mirror_energy(surface, cosine);
    real probability = SPLAT(1.0f);
    if (has_rough_part(surface)) {
        const float rough = rough_albedo(surface);
        probability = smaller(larger(energy / (energy + rough), SPLAT(0.1f)), SPLAT(0.9f));
    }
    const mask is_mirror = MASK_OF(choice < probability);
    const real left = larger(1.0f - probability, SPLAT(1.0e-6f));
    const real rest = smaller((choice - probability) / left, SPLAT(0.9999999f));
    if (has_rough_part(surface)) {
        const real rough_choice = larger(rest, SPLAT(0.0f));
        step = follows_cones ? step_from_seabed(chains, spheres, hit, rough_choice, u, v)
                             : step_from_object(surface, hit, rough_choice, u, v);
    } else {
        step.direction = hit->back;
        step.weight = SPLAT(0.0f);
    }
    struct vector3 mirrored;
    mirrored.x = 2.0f * cosine * hit->normal.x - hit->back.x;
    mirrored.y = 2.0f * cosine * hit->normal.y - hit->back.y;
    mirrored.z = 2.0f * cosine * hit->normal.z - hit->back.z;
    step.direction = choose3(is_mirror, mirrored, step.direction);
    step.weight = CHOOSE(is_mirror, energy / probability, step.weight / left);
    step.is_mirror = is_mirror;
    return step;
}

FUNCTION struct chain_step next_step(const struct fan_record *fan,
                                     GLOBAL const struct chain_record *chains,
                                     GLOBAL const struct object_record *objects,
                                     GLOBAL const struct sphere_record *spheres,
                                     GLOBAL const float *map, const struct chain *chain,
                                     RECORD_WORD draw)
{
    real u, v, choice;
    three_uniforms(chain->key, chain->number, draw, &u, &v, &choice);
    const struct chain_hit *hit = &chain->hit;
    struct chain_step step;
    step.direction = hit->back;
    step.weight = SPLAT(0.0f);
    step.is_mirror = MASK_OF(choice < -1.0f);
    for (int i = -1; i < fan->objects; i++) {
        const mask here = chain->is_alive & MASK_OF(hit->surface == i);
        if (!ANY(here))
            continue;
        const struct chain_step from = step_from_surface(
            chains, spheres, surface_number(chains, objects, i), i < 0, hit, choice, u, v);
        step.direction = choose3(here, from.direction, step.direction);
        step.weight = CHOOSE(here, from.weight, step.weight);
        step.is_mirror = CHOOSE(here, from.is_mirror, step.is_mirror);
    }
    const real factor = map_factor(fan, chains, map, hit);
    step.weight = CHOOSE(step.is_mirror, step.weight, step.weight * factor);
    return step;
}

/* Where a ray crosses the source's rectangle: the echo of brute force, which counts what happens to
 * arrive. Per unit of the source's strength a rectangle of area A seen under the angle theta stands
 * for 1 / (A cos theta). */
FUNCTION void count_arrival(const struct fan_record *fan, GLOBAL const struct chain_record *chains,
                            int order, const struct chain *chain, const struct chain_step *step,
                            real to_next_hit, struct chain_echo *echo)
{
    const struct vector3 to = to_receiver(fan, chain->hit.point, chain->first_x);
    /* the rectangle's normal is the central direction, across it lies `up` */
    const real cosine =
        -(step->direction.y * fan->cosine_depression - step->direction.z * fan->sine_depression);
    const real distance_across = -(to.y * fan->cosine_depression - to.z * fan->sine_depression);
    const mask is_towards = MASK_OF(cosine > 1.0e-6f);
    const real path = distance_across / CHOOSE(is_towards, cosine, SPLAT(1.0f));
    const real off_x = step->direction.x * path - to.x;
    const real off_up = (step->direction.y * path - to.y) * fan->sine_depression +
                        (step->direction.z * path - to.z) * fan->cosine_depression;
    const float half_side = 0.5f * fan->source_side;
    const mask arrives = is_towards & MASK_OF(path > 0.0f) & MASK_OF(path < to_next_hit) &
                         MASK_OF(magnitude(off_x) < half_side) &
                         MASK_OF(magnitude(off_up) < half_side);
    const float area = fan->source_side * fan->source_side;
    const real energy = CHOOSE(
        arrives, chain->energy * step->weight / (CHOOSE(arrives, cosine, SPLAT(1.0f)) * area),
        SPLAT(0.0f));
    const real range = 0.5f * (chain->range + chain->length + (path - fan->reference_range));
    const real half_path = fan->reference_range + range;
    const real square = half_path * half_path;
    keep_echo(fan, chains, order, chain, energy, range, square * square, echo);
}

#define THIN_BLOCK 64u /* rays that are followed, or not, together; whatever the width */

/* Seabed far from the targets exchanges little sound with them, so of its rays only some blocks are
 * followed and stand for the others. Returns what a ray of each of WIDTH blocks stands for, 0: not
 * followed. */
FUNCTION real thin_out(const struct fan_record *fan, GLOBAL const struct chain_record *chains,
                       GLOBAL const struct sphere_record *spheres, struct random_key key, int strip,
                       word block)
{
    if (chains->seabed_share == 0.0f || fan->only_object != -1)
        return SPLAT(1.0f);
    const real rays = (REAL_OF(block) + 0.5f) * (float)THIN_BLOCK;
    const struct fan_ray middle = fan_ray_at(fan, SPLAT(strip_position(fan, strip)),
                                             fan->first_elevation + rays * fan->elevation_step);
    const real to_seabed = seabed_distance(fan, middle.closest, middle.direction);
    const mask is_seabed = MASK_OF(to_seabed < 0.5f * FAR_AWAY);
    const struct vector3 point =
        along3(middle.closest, middle.direction, CHOOSE(is_seabed, to_seabed, SPLAT(0.0f)));
    struct target_cones cones;
    view_targets(spheres, chains->spheres, point, &cones);
    const real share = CHOOSE(cones.is_inside | ~is_seabed, SPLAT(1.0f),
                              smaller(chains->seabed_share * cones.sum, SPLAT(1.0f)));
    real chosen, unused;
    two_uniforms(key, block, 1, &chosen, &unused);
    const mask is_followed = MASK_OF(chosen < share);
    return CHOOSE(is_followed, 1.0f / CHOOSE(is_followed, share, SPLAT(1.0f)), SPLAT(0.0f));
}

/* Sends out one group of rays. */
FUNCTION void begin_chain(const struct fan_record *fan, GLOBAL const struct object_record *objects,
                          int strip, struct random_key key, RECORD_WORD first_ray, float stands_for,
                          struct chain *chain)
{
    chain->key = key;
    chain->number = SPLAT_WORD(first_ray) + LANE_NUMBERS;
    const mask is_ray = MASK_OF(chain->number < fan->rays);
    real along, across;
    two_uniforms(key, chain->number, 0, &along, &across);
    const real x = strip_position(fan, strip) + (along - 0.5f) * fan->strip_width;
    const struct fan_ray ray = fan_ray_at(
        fan, x, fan->first_elevation + (REAL_OF(chain->number) + across) * fan->elevation_step);
    chain->hit =
        find_chain_hit(fan, objects, ray.closest, ray.direction, -fan->reference_range, is_ray);
    chain->range = ray.range_at_closest + chain->hit.distance;
    chain->length = SPLAT(0.0f);
    chain->first_x = x;
    chain->first_surface = chain->hit.surface;
    chain->is_alive = chain->hit.is_hit;
    if (fan->only_object >= -1)
        chain->is_alive = chain->is_alive & MASK_OF(chain->hit.surface == fan->only_object);
    chain->began_smooth = chain->is_alive & 0;
    /* the strip of wavefront w r de over r^2 */
    chain->energy = stands_for * fan->strip_width * fan->elevation_step * fan->quanta /
                    CHOOSE(chain->is_alive, fan->reference_range + chain->range, SPLAT(1.0f));
}

/* Follows one group of WIDTH rays of a strip over all their interactions. */
FUNCTION void trace_chain_group(const struct fan_record *fan,
                                GLOBAL const struct chain_record *chains,
                                GLOBAL const struct object_record *objects,
                                GLOBAL const struct sphere_record *spheres, GLOBAL const float *map,
                                GLOBAL TALLY *tallies, int strip, struct random_key key,
                                RECORD_WORD first_ray, float stands_for,
                                struct outcome_record *outcome)
{
    struct chain chain;
    struct chain_echo echo;
    const int is_connected = chains->estimator == CHAINS_CONNECT;
    begin_chain(fan, objects, strip, key, first_ray, stands_for, &chain);
    for (int order = 1; order <= chains->interactions && ANY(chain.is_alive); order++) {
        const RECORD_WORD draw = 4u * (RECORD_WORD)order;
        if (is_connected && order >= chains->first_order) {
            connect_chain(fan, chains, objects, map, order, &chain, draw + 2, &echo, outcome);
            tally_chain_echo(fan, chains, tallies, order, &echo, outcome);
        }
        if (is_connected && order == chains->interactions)
            break;
        const struct chain_step step = next_step(fan, chains, objects, spheres, map, &chain, draw);
        const mask goes_on = chain.is_alive & MASK_OF(step.weight > 0.0f);
        outcome->queries += count_lanes(goes_on);
        const struct chain_hit next =
            find_chain_hit(fan, objects, start_from(&chain.hit), step.direction, 0.0f, goes_on);
        if (!is_connected) {
            const real clear =
                CHOOSE(next.is_hit, next.distance, CHOOSE(goes_on, SPLAT(FAR_AWAY), SPLAT(-1.0f)));
            count_arrival(fan, chains, order, &chain, &step, clear, &echo);
            tally_chain_echo(fan, chains, tallies, order, &echo, outcome);
        }
        if (order == 1)
            chain.began_smooth = step.is_mirror;
        chain.energy = chain.energy * step.weight;
        chain.length = chain.length + next.distance;
        chain.hit = next;
        chain.is_alive = next.is_hit;
    }
}

/* Follows the block of rays that begins with first_ray. */
FUNCTION void trace_chain_block(const struct fan_record *fan,
                                GLOBAL const struct chain_record *chains,
                                GLOBAL const struct object_record *objects,
                                GLOBAL const struct sphere_record *spheres, GLOBAL const float *map,
                                GLOBAL TALLY *tallies, int strip, struct random_key key,
                                RECORD_WORD first_ray, float stands_for,
                                struct outcome_record *outcome)
{
    const RECORD_WORD left = fan->rays - first_ray;
    const RECORD_WORD count = left < THIN_BLOCK ? left : THIN_BLOCK;
    outcome->rays += count;
    outcome->queries += count;
    for (RECORD_WORD ray = 0; ray < count; ray += WIDTH)
        trace_chain_group(fan, chains, objects, spheres, map, tallies, strip, key, first_ray + ray,
                          stands_for, outcome);
}

/* Traces the share `segment` of a strip's fan. tallies: planes x tally_strips x bins. */
FUNCTION struct outcome_record trace_chains_strip(const struct fan_record *fan,
                                                  GLOBAL const struct chain_record *chains,
                                                  GLOBAL const struct object_record *objects,
                                                  GLOBAL const struct sphere_record *spheres,
                                                  GLOBAL const float *map, GLOBAL TALLY *tallies,
                                                  int strip, int segment)
{
    struct outcome_record outcome = {0, 0, 0, 0};
    const struct random_key key = random_key_of(fan->seed_low, fan->seed_high, fan->stream,
                                                (RECORD_WORD)(fan->first_strip + strip));
    const RECORD_WORD blocks = (fan->rays + THIN_BLOCK - 1u) / THIN_BLOCK;
    const RECORD_WORD stride = (RECORD_WORD)fan->segments * WIDTH;
    for (RECORD_WORD some = (RECORD_WORD)segment * WIDTH; some < blocks; some += stride) {
        const real stands_for =
            thin_out(fan, chains, spheres, key, strip, SPLAT_WORD(some) + LANE_NUMBERS);
        float lanes[WIDTH];
        STORE_REAL(stands_for, lanes);
        for (RECORD_WORD lane = 0; lane < WIDTH && some + lane < blocks; lane++)
            if (lanes[lane] > 0.0f)
                trace_chain_block(fan, chains, objects, spheres, map, tallies, strip, key,
                                  (some + lane) * THIN_BLOCK, lanes[lane], &outcome);
    }
    return outcome;
}

#endif
