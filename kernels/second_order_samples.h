/* The tracing of the samples of second_order.h. Few samples of a cell far from the targets are
 * followed, and most of these begin where a target turns away from their place on the seabed.
 * Samples are therefore gathered until every lane has one: first those that are followed, then
 * those that face their seabed. Obstacles are looked for only for the latter. */
#ifndef SONJECT_KERNELS_SECOND_ORDER_SAMPLES_H
#define SONJECT_KERNELS_SECOND_ORDER_SAMPLES_H

#include "second_order.h"

/* The way from a hit on a target to a place of the seabed. */
struct way_to_seabed {
    struct chain_hit to;
    struct source_path way;
    vfloat leaving; /* cosine between the way and the target's normal */
    mask is_facing;
};

FUNCTION struct way_to_seabed way_to_seabed(const struct trace *trace, vfloat x, vfloat y,
                                            const struct chain *chain)
{
    const struct chain_hit *from = &chain->hit;
    const struct vector3 start = start_from(from);
    struct way_to_seabed found;
    struct chain_hit *to = &found.to;
    *to = seabed_below(trace, x, y, chain->is_alive);
    to->normal = seabed_normal(trace, to->point, straight_path(minus3(to->point, start)).direction);
    /* The way ends as far over the seabed as rays start, so that the place does not hide itself. */
    found.way = straight_path(minus3(start_from(to), start));
    to->back = reversed3(found.way.direction);
    to->distance = found.way.path;
    found.leaving = dot3(from->normal, found.way.direction);
    found.is_facing = chain->is_alive & MASK_OF(found.leaving > 0.0f) &
                      MASK_OF(dot3(to->normal, to->back) > 0.0f);
    return found;
}

/* Takes a chain from its hit on a target to a place of the seabed. samples: per m rad and m^2 of
 * the plan; rays: of the target's fan, per m rad, which may also find the path. */
FUNCTION void step_to_seabed(const struct trace *trace, const struct way_to_seabed *found,
                             vfloat samples, vfloat rays, struct chain *chain)
{
    const struct chain_hit *from = &chain->hit;
    const struct vector3 direction = found->way.direction;
    const vfloat scattering = scattering_at(trace, from, direction);
    mask is_open = found->is_facing & MASK_OF(scattering > 0.0f);
    trace->outcome->queries += count_lanes(is_open);
    is_open = is_open_way(trace, from, direction, found->way.path, is_open);
    const vfloat opening = opening_of_plan(&found->to, found->way.spreading);
    const vfloat density = samples + rays * rough_density_at(trace, from, direction) * opening;
    chain->energy = SELECT(
        is_open,
        chain->energy * (scattering * found->leaving * opening * trace->chains->finer[0] / density),
        SPLAT(0.0f));
    chain->length = SELECT(is_open, found->way.path, SPLAT(0.0f));
    chain->surface_before = from->surface;
    chain->hit = found->to;
    chain->hit.is_hit = is_open;
    chain->is_alive = is_open;
}

/* The coordinates of a sample, in the order of their multipliers. */
enum sample_coordinate {
    IS_FOLLOWED,
    ECHO_ALONG,
    SEABED_PLACE,
    TARGET_ALONG,
    TARGET_ACROSS,
    TARGET_PART,
    SAMPLE_COORDINATES
};

/* Draws the lattice's shifts, by draws that no sample has. */
FUNCTION void draw_shifts(struct random_key key, RECORD_WORD shifts[SAMPLE_COORDINATES])
{
    for (int i = 0; i < SAMPLE_COORDINATES; i += 2) {
        shifts[i] = (RECORD_WORD)i;
        shifts[i + 1] = ~0u;
        threefry_scalar(key.first, key.second, &shifts[i], &shifts[i + 1]);
    }
}

FUNCTION vfloat sample_uniform(const RECORD_WORD *shifts, word number,
                               enum sample_coordinate coordinate)
{
    const RECORD_WORD multipliers[SAMPLE_COORDINATES] = {LATTICE_OF_6_0, LATTICE_OF_6_1,
                                                         LATTICE_OF_6_2, LATTICE_OF_6_3,
                                                         LATTICE_OF_6_4, LATTICE_OF_6_5};
    return lattice_uniform(number, multipliers[coordinate], shifts[coordinate]);
}

/* The samples of a strip, one in each lane: their cells, and the weights of targets there. */
struct samples {
    word number;
    struct echo_cell cell;
    struct target_weights weights;
    mask is_followed;
};

FUNCTION struct samples aim_samples(const struct trace *trace, const RECORD_WORD *shifts,
                                    word sample)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct target_record *targets = targets_of(trace) + fan->target;
    struct samples samples;
    samples.number = SPLAT_WORD(fan->first_ray) + sample;
    const vfloat along = sample_uniform(shifts, samples.number, ECHO_ALONG);
    samples.cell = cell_number(trace,
                               VFLOAT_OF(sample / (RECORD_WORD)trace->chains->cell_samples) +
                                   (float)targets->first_cell,
                               strip_position(trace) + (along - 0.5f) * fan->strip_width);
    samples.weights = weigh_targets(targets, targets->targets, &samples.cell);
    const vfloat followed = sample_uniform(shifts, samples.number, IS_FOLLOWED);
    samples.is_followed = MASK_OF(sample < fan->rays) & MASK_OF(followed < samples.weights.share);
    return samples;
}

/* A path from the sonar by way of a target to the seabed. */
struct second_order_path {
    struct chain chain; /* chain at the target */
    struct way_to_seabed onward;
    vfloat samples, rays; /* densities that find the path (step_to_seabed) */
};

/* Finds the paths of samples. is_alone: the target is found whatever hides it. */
NOINLINE void path_of_samples(const struct trace *trace, const RECORD_WORD *shifts, word sample,
                              mask is_sample, int is_alone, struct second_order_path *path)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct target_record *targets = targets_of(trace) + fan->target;
    const struct samples samples = aim_samples(trace, shifts, sample);
    const word number = samples.number;
    const struct sampled_target target =
        sample_target(targets, targets->targets, &samples.cell, &samples.weights,
                      sample_uniform(shifts, number, TARGET_PART), is_sample & samples.is_followed);
    struct chain *chain = &path->chain;
    const vfloat along = sample_uniform(shifts, number, TARGET_ALONG);
    const vfloat across = sample_uniform(shifts, number, TARGET_ACROSS);
    vfloat dither, unused;
    two_uniforms(trace->key, number, 0, &dither, &unused);
    begin_chain(trace, target.first_x + along * target.width,
                target.first_elevation + across * target.elevations, SPLAT(1.0f),
                is_alone ? &target.part : 0, is_sample & samples.is_followed, chain);
    chain->is_alive = chain->is_alive & MASK_OF(chain->hit.surface == target.part);
    chain->key = trace->key;
    chain->number = number;
    chain->dither = dither;
    const vfloat receiver_x = samples.cell.receiver_x;
    const vfloat x = 2.0f * receiver_x - chain->first_x;
    const struct seabed_line line = line_across(fan, chain->hit.point, x, receiver_x);
    const struct places places =
        places_of_cell(fan, chain, &line, &samples.cell, target.least_y - chain->hit.point.y);
    const vfloat y = sample_place(&places, sample_uniform(shifts, number, SEABED_PLACE));
    path->samples =
        density_of_samples(trace, target.weight, &samples.weights, target.width * target.elevations,
                           length_of_place(&places, y));
    path->rays = target.rays;
    chain->is_alive = chain->is_alive & MASK_OF(path->samples > 0.0f);
    path->onward = way_to_seabed(trace, x, chain->hit.point.y + y, chain);
}

/* The samples that wait until every lane has one. */
struct waiting_samples {
    int numbers[2 * WIDTH];
    int count;
};

FUNCTION void add_waiting(const int numbers[WIDTH], mask is_wanted, struct waiting_samples *waiting)
{
    for (RECORD_WORD left = lane_bits(is_wanted); left != 0; left &= left - 1)
        waiting->numbers[waiting->count++] = numbers[lowest_bit(left)];
}

/* Takes the last of the waiting samples, fewer than WIDTH if no more wait. */
FUNCTION mask take_waiting(struct waiting_samples *waiting, int numbers[WIDTH])
{
    const int taken = waiting->count < WIDTH ? waiting->count : WIDTH;
    waiting->count -= taken;
    for (int lane = 0; lane < WIDTH; lane++)
        numbers[lane] = lane < taken ? waiting->numbers[waiting->count + lane] : 0;
    return MASK_OF(LANE_NUMBERS < (RECORD_WORD)taken);
}

/* Takes samples that are followed, and keeps those whose target faces the place on the seabed. */
FUNCTION void find_facing(const struct trace *trace, const RECORD_WORD *shifts,
                          struct waiting_samples *followed, struct waiting_samples *facing)
{
    int numbers[WIDTH];
    struct second_order_path path;
    const mask is_sample = take_waiting(followed, numbers);
    trace->outcome->rays += count_lanes(is_sample);
    trace->outcome->queries += count_lanes(is_sample);
    path_of_samples(trace, shifts, AS_WORD(LOAD_VINT(numbers)), is_sample, 1, &path);
    add_waiting(numbers, path.onward.is_facing, facing);
}

/* Traces some of the samples that face their seabed. */
FUNCTION void trace_facing(const struct trace *trace, const RECORD_WORD *shifts,
                           struct waiting_samples *facing)
{
    int numbers[WIDTH];
    struct second_order_path path;
    struct chain_echo echo;
    struct chain *chain = &path.chain;
    const mask is_sample = take_waiting(facing, numbers);
    trace->outcome->queries += count_lanes(is_sample);
    path_of_samples(trace, shifts, AS_WORD(LOAD_VINT(numbers)), is_sample, 0, &path);
    if (!ANY(path.onward.is_facing))
        return;
    step_to_seabed(trace, &path.onward, path.samples, path.rays, chain);
    if (!ANY(chain->is_alive))
        return;
    struct ways_counted ways;
    ways.is_counted = ways.counts_reverse = chain->is_alive;
    vfloat range;
    const vfloat energy = energy_returned(trace, chain, receiver_of(trace->chains, chain), 0, 3,
                                          chain->is_alive, &range);
    keep_echo(trace, ways, chain, energy, range, SPLAT(1.0f), &echo);
    tally_chain_echo(trace, 2, &echo);
}

/* Traces the share `segment` of a strip's samples. fan->rays tells their number. */
NOINLINE void trace_second_order_strip(const struct trace *trace)
{
    RECORD_WORD shifts[SAMPLE_COORDINATES];
    struct waiting_samples followed, facing;
    draw_shifts(trace->key, shifts);
    followed.count = facing.count = 0;
    int is_over = 0;
    for (RECORD_WORD first = first_ray_of_item(trace); !is_over; first += ray_step(trace)) {
        is_over = first >= trace->fan.rays;
        if (!is_over) {
            int numbers[WIDTH];
            for (int lane = 0; lane < WIDTH; lane++)
                numbers[lane] = (int)first + lane;
            add_waiting(numbers,
                        aim_samples(trace, shifts, SPLAT_WORD(first) + LANE_NUMBERS).is_followed,
                        &followed);
        }
        const int least = is_over ? 1 : WIDTH; /* the last samples may be fewer */
        while (followed.count >= least)
            find_facing(trace, shifts, &followed, &facing);
        while (facing.count >= least)
            trace_facing(trace, shifts, &facing);
    }
}

#endif
