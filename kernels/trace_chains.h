/* The incoherent part beyond the first interaction: chains of sound between seabed and targets
 * (kernels/MATH.md, "Chains"). A chain is a path that is followed backwards from the receiver. At
 * every rough hit it is connected to the source, as in next-event estimation. */
#ifndef SONJECT_KERNELS_TRACE_CHAINS_H
#define SONJECT_KERNELS_TRACE_CHAINS_H

#include "chain_sea_surface.h"
#include "chain_step.h"
#include "second_order_samples.h"

/* Connects the hit to the source and returns the echo in *echo. */
FUNCTION void connect_chain(const struct trace *trace, int order, const struct chain *chain,
                            RECORD_WORD draw, struct chain_echo *echo)
{
    GLOBAL const struct chain_record *chains = trace->chains;
    vfloat range;
    const vfloat energy =
        energy_returned(trace, chain, receiver_of(chains, chain), 0, draw, chain->is_alive, &range);
    const vfloat share =
        order == 2 && chains->cell_samples > 0 ? share_of_ray(trace, chain) : SPLAT(1.0f);
    keep_echo(trace, count_ways(chains, order, chain), chain, energy, range, share, echo);
}

/* Finds the echo of brute force, which counts rays that happen to cross the source's square. Per
 * unit of the source's strength, a square of area A seen under the angle theta stands for 1 / (A
 * cos theta). */
FUNCTION void count_arrival(const struct trace *trace, int order, const struct chain *chain,
                            const struct chain_step *step, vfloat to_next_hit,
                            struct chain_echo *echo)
{
    const struct fan_record *fan = &trace->fan;
    const struct vector3 to = to_receiver(fan, chain->hit.point, chain->first_x);
    /* The square's normal is the central direction, and across it lies `up`. */
    const vfloat cosine =
        -(step->direction.y * fan->cosine_depression - step->direction.z * fan->sine_depression);
    const vfloat distance_across = -(to.y * fan->cosine_depression - to.z * fan->sine_depression);
    const mask is_towards = MASK_OF(cosine > 1.0e-6f);
    const vfloat path = distance_across / SELECT(is_towards, cosine, SPLAT(1.0f));
    const vfloat off_x = step->direction.x * path - to.x;
    const vfloat off_up = (step->direction.y * path - to.y) * fan->sine_depression +
                          (step->direction.z * path - to.z) * fan->cosine_depression;
    const float half_side = 0.5f * fan->source_side;
    /* Specular bounces alone belong to the coherent part. */
    const mask met_rough = ~(chain->only_specular & step->is_specular);
    const mask arrives = is_towards & met_rough & MASK_OF(path > 0.0f) &
                         MASK_OF(path < to_next_hit) & MASK_OF(magnitude(off_x) < half_side) &
                         MASK_OF(magnitude(off_up) < half_side);
    const float area = fan->source_side * fan->source_side;
    const vfloat energy = SELECT(
        arrives, chain->energy * step->weight / (SELECT(arrives, cosine, SPLAT(1.0f)) * area),
        SPLAT(0.0f));
    const vfloat range = 0.5f * (chain->range + chain->length + (path - fan->reference_range));
    const vfloat half_path = fan->reference_range + range;
    const vfloat square = half_path * half_path;
    keep_echo(trace, count_ways(trace->chains, order, chain), chain, energy, range, square * square,
              echo);
}

#define THIN_BLOCK 64u /* rays that are followed, or not, together; the same at any width */

/* Returns the ray in the middle of each of WIDTH blocks. */
FUNCTION struct fan_ray middle_ray(const struct trace *trace, word block)
{
    const struct fan_record *fan = &trace->fan;
    const vfloat rays = (VFLOAT_OF(block) + 0.5f) * (float)THIN_BLOCK;
    return fan_ray_at(trace, SPLAT(strip_position(trace)),
                      fan->first_elevation + rays * fan->elevation_step);
}

/* Returns where rays of a block may meet a target: its middle ray passes a target's sphere within
 * the radius plus the distance of the block's corners (a tenth more: rays fan out). */
FUNCTION mask may_meet_target(const struct trace *trace, const struct fan_ray *middle)
{
    const struct fan_record *fan = &trace->fan;
    const vfloat up = 0.5f * (float)THIN_BLOCK * fan->elevation_step * middle->wavefront;
    const vfloat margin = 1.1f * (0.5f * fan->strip_width + magnitude(up));
    mask may_meet = MASK_OF(margin < 0.0f);
    for (int i = 0; i < trace->chains->spheres; i++) {
        const struct vector3 way = to_sphere(&trace->spheres[i], middle->closest);
        const vfloat along = dot3(way, middle->direction);
        const struct vector3 miss = along3(way, middle->direction, -along);
        const vfloat reach = trace->spheres[i].radius * 1.001f + margin;
        may_meet = may_meet | MASK_OF(dot3(miss, miss) < reach * reach);
    }
    return may_meet;
}

/* Returns where rays of a block that the seabed reflects at a point may meet a target. */
FUNCTION mask may_be_reflected_to_target(const struct trace *trace, const struct fan_ray *middle,
                                         struct vector3 point)
{
    struct fan_ray reflected = *middle;
    reflected.closest = point;
    reflected.direction.z = -middle->direction.z;
    return may_meet_target(trace, &reflected);
}

/* Returns the throughput of each of WIDTH blocks, 0 if its rays are not followed. Seabed far from
 * the targets exchanges little sound with them unless it reflects. Only some blocks of such rays
 * are followed and stand for the others. An object's own rays are left out in blocks that cannot
 * meet a target. */
FUNCTION vfloat russian_roulette(const struct trace *trace, word block)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct chain_record *chains = trace->chains;
    const int begins_on_seabed = fan->only_object == -1;
    if (fan->only_object < -1 || (begins_on_seabed && chains->seabed_share == 0.0f) ||
        (!begins_on_seabed && chains->spheres == 0))
        return SPLAT(1.0f);
    const struct fan_ray middle = middle_ray(trace, block);
    if (!begins_on_seabed)
        return SELECT(may_meet_target(trace, &middle), SPLAT(1.0f), SPLAT(0.0f));
    const vfloat to_seabed =
        seabed_distance(trace, middle.closest, middle.direction, SPLAT(-fan->reference_range),
                        MASK_OF(block < fan->rays));
    const mask is_seabed = MASK_OF(to_seabed < 0.5f * FAR_AWAY);
    const struct vector3 point =
        along3(middle.closest, middle.direction, SELECT(is_seabed, to_seabed, SPLAT(0.0f)));
    mask is_inside;
    const vfloat sum = sum_of_openings(trace->spheres, chains->spheres, point, &is_inside);
    vfloat share = SELECT(is_inside | ~is_seabed, SPLAT(1.0f),
                          smaller(chains->seabed_share * sum, SPLAT(1.0f)));
    if (has_smooth_part(&chains->seabed))
        share = SELECT(may_be_reflected_to_target(trace, &middle, point), SPLAT(1.0f), share);
    vfloat chosen, unused;
    two_uniforms(trace->key, block, 1, &chosen, &unused);
    const mask is_followed = MASK_OF(chosen < share);
    return SELECT(is_followed, 1.0f / SELECT(is_followed, share, SPLAT(1.0f)), SPLAT(0.0f));
}

/* Sends out one group of a fan's rays. */
FUNCTION void begin_fan_chain(const struct trace *trace, RECORD_WORD first_ray, float throughput,
                              const struct target_choice *choice, struct chain *chain)
{
    const struct fan_record *fan = &trace->fan;
    const word number = SPLAT_WORD(first_ray) + LANE_NUMBERS;
    const vfloat along = lattice_uniform(number, LATTICE_OF_2_1, trace->key.first);
    vfloat across, dither;
    two_uniforms(trace->key, number, 0, &across, &dither);
    begin_chain(trace, strip_position(trace) + (along - 0.5f) * fan->strip_width,
                fan->first_elevation + (VFLOAT_OF(number) + across) * fan->elevation_step,
                SPLAT(throughput * fan->strip_width * fan->elevation_step), 0,
                MASK_OF(number < fan->rays), chain);
    chain->choice = choice;
    chain->key = trace->key;
    chain->number = number;
    chain->dither = dither;
    if (fan->only_object >= -1)
        chain->is_alive = chain->is_alive & MASK_OF(chain->hit.surface == fan->only_object);
    chain->only_specular = chain->is_alive;
    chain->only_boundaries = chain->is_alive;
}

/* Lets the energy fall before the chain goes `distance` further. Behind level boundaries sound
 * spreads from the sonar's image, so the ray's strip of the wavefront grows with the whole way. */
FUNCTION void spread_from_image(struct chain *chain, const struct chain_step *step, vfloat distance)
{
    chain->only_boundaries =
        chain->only_boundaries & step->is_specular & MASK_OF(chain->hit.surface < 0);
    if (!ANY(chain->only_boundaries))
        return;
    const vfloat reach = chain->first_reach + SELECT(chain->only_boundaries, distance, SPLAT(0.0f));
    chain->energy =
        chain->energy * SELECT(chain->only_boundaries, chain->first_reach / reach, SPLAT(1.0f));
    chain->first_reach = reach;
}

/* Returns the lowest order of the fan's rays that counts. Paths of two interactions that begin on
 * the seabed may have samples of their own. */
FUNCTION int first_order_of_fan(const struct trace *trace)
{
    return trace->fan.only_object == SEABED && trace->chains->cell_samples > 0
               ? 3
               : trace->chains->first_order;
}

/* Follows one group of WIDTH rays of a strip over all their interactions. */
FUNCTION void trace_chain_group(const struct trace *trace, RECORD_WORD first_ray, float throughput,
                                const struct target_choice *choice)
{
    GLOBAL const struct chain_record *chains = trace->chains;
    struct chain chain;
    struct chain_echo echo;
    const int is_connected = chains->estimator == CHAINS_CONNECT;
    const int first_order = first_order_of_fan(trace);
    begin_fan_chain(trace, first_ray, throughput, choice, &chain);
    for (int order = 1; order <= chains->interactions && ANY(chain.is_alive); order++) {
        /* An interaction has four draws: 0 and 1 for its step, 2 and 3 for its connections. */
        const RECORD_WORD draw = 4u * (RECORD_WORD)order;
        if (is_connected && order >= first_order) {
            connect_chain(trace, order, &chain, draw + 2, &echo);
            tally_chain_echo(trace, order, &echo);
        }
        if (is_connected && has_sea_surface(chains))
            connect_by_sea_surface(trace, order, &chain, draw + 3);
        if (is_connected && order == chains->interactions)
            break;
        const struct chain_step step = next_step(trace, order, &chain, draw);
        const mask goes_on = chain.is_alive & MASK_OF(step.weight > 0.0f);
        trace->outcome->queries += count_lanes(goes_on);
        struct chain_hit next =
            find_chain_hit(trace, FACE_OF_SCATTERING, start_from(&chain.hit), step.direction, 0.0f,
                           chain.hit.left_behind, goes_on);
        if (has_sea_surface(chains))
            meet_sea_surface(chains, start_from(&chain.hit), step.direction, goes_on, &next);
        if (!is_connected) {
            const vfloat clear =
                SELECT(next.is_hit, next.distance, SELECT(goes_on, SPLAT(FAR_AWAY), SPLAT(-1.0f)));
            count_arrival(trace, order, &chain, &step, clear, &echo);
            tally_chain_echo(trace, order, &echo);
        }
        /* Sound from one slope of the relief to another is left out. */
        const mask is_between_slopes =
            has_relief(trace) ? MASK_OF(chain.hit.surface == -1) & MASK_OF(next.surface == -1)
                              : chain.is_alive & 0;
        if (order == 1) {
            chain.began_smooth = step.is_specular;
            chain.first_density = step.density;
        }
        chain.only_specular = chain.only_specular & step.is_specular;
        chain.choice = 0;
        chain.energy = chain.energy * (step.weight * chains->finer[order - 1]);
        spread_from_image(&chain, &step, next.distance);
        chain.length = chain.length + next.distance;
        chain.surface_before = chain.hit.surface;
        chain.hit = next;
        chain.is_alive = next.is_hit & ~is_between_slopes;
        chain.met_object = chain.met_object | MASK_OF(next.surface >= 0);
        if (has_sea_surface(chains))
            leave_out_unheard(trace, order, &chain);
    }
}

#define CHOICE_RAYS 16u /* rays that share a choice of targets; a multiple of any width */

/* Aims the choice of the rays from first_ray on: the targets as the middle ray sees them from the
 * seabed, blurred by the rays' distance from each other. */
FUNCTION void aim_choice(const struct trace *trace, RECORD_WORD first_ray,
                         struct target_choice *choice)
{
    const struct fan_record *fan = &trace->fan;
    const vfloat number = SPLAT((float)first_ray) + 0.5f * (float)CHOICE_RAYS;
    const struct fan_ray middle = fan_ray_at(trace, SPLAT(strip_position(trace)),
                                             fan->first_elevation + number * fan->elevation_step);
    const vfloat to_seabed = plane_distance(fan, middle.closest, middle.direction);
    const mask is_seabed = MASK_OF(to_seabed < 0.5f * FAR_AWAY);
    const vfloat distance = SELECT(is_seabed, to_seabed, SPLAT(0.0f));
    const struct vector3 point = along3(middle.closest, middle.direction, distance);
    const vfloat apart = 0.5f * (float)CHOICE_RAYS * fan->elevation_step *
                         (middle.wavefront + distance) / larger(-middle.direction.z, SPLAT(0.05f));
    const vfloat square = apart * apart + 0.25f * fan->strip_width * fan->strip_width;
    float x[WIDTH], y[WIDTH], z[WIDTH], blur[WIDTH];
    STORE_VFLOAT(point.x, x);
    STORE_VFLOAT(point.y, y);
    STORE_VFLOAT(point.z, z);
    STORE_VFLOAT(square, blur);
    choice->x = x[0];
    choice->y = y[0];
    choice->z = z[0];
    choice->square_blur = blur[0];
    begin_choice(trace, choice);
}

/* Follows the block of rays that begins with first_ray. */
FUNCTION void trace_chain_block(const struct trace *trace, RECORD_WORD first_ray, float throughput)
{
    struct target_choice choice;
    const int is_shared = trace->chains->groups > 0 && trace->fan.only_object == -1;
    const RECORD_WORD count = rays_from(trace, first_ray, THIN_BLOCK);
    const RECORD_WORD first = GROUP_ITEM * WIDTH;
    for (RECORD_WORD ray = first; ray < count; ray += GROUP_WIDTH) {
        if (is_shared && (ray % CHOICE_RAYS == 0 || ray == first))
            aim_choice(trace, first_ray + ray - ray % CHOICE_RAYS, &choice);
        trace_chain_group(trace, first_ray + ray, throughput, is_shared ? &choice : 0);
    }
}

/* Traces the segment of the strip's fan, or of a target's second-order paths. tallies: orders x
 * tally_strips x bins, shared by all groups, since echoes end in other strips too. */
FUNCTION void trace_chains_strip(const struct trace *trace)
{
    const struct fan_record *fan = &trace->fan;
    GROUP_MEMORY float *throughputs = trace->throughputs;
    if (fan->is_sample) {
        trace_second_order_strip(trace);
        return;
    }
    const RECORD_WORD blocks = (fan->rays + THIN_BLOCK - 1u) / THIN_BLOCK;
    const RECORD_WORD stride = (RECORD_WORD)fan->segments;
    const RECORD_WORD own = GROUP_ITEM * WIDTH;
    for (RECORD_WORD some = (RECORD_WORD)trace->segment; some < blocks;
         some += stride * GROUP_WIDTH) {
        const word mine = SPLAT_WORD(some) + (SPLAT_WORD(own) + LANE_NUMBERS) * stride;
        const vfloat throughput = russian_roulette(trace, mine);
        STORE_VFLOAT(throughput, throughputs + own);
        GROUP_WAIT();
        for (RECORD_WORD i = 0; i < GROUP_WIDTH && some + i * stride < blocks; i++) {
            const RECORD_WORD first_ray = (some + i * stride) * THIN_BLOCK;
            /* Rays that are known to miss their object count as traced. */
            if (GROUP_ITEM == 0 && (throughputs[i] > 0.0f || fan->only_object >= 0))
                count_rays(trace, first_ray, THIN_BLOCK);
            if (throughputs[i] > 0.0f)
                trace_chain_block(trace, first_ray, throughputs[i]);
        }
        GROUP_WAIT();
    }
}

#endif
