/* A trace: what a kernel knows of its launch, and the strip that a group of work-items traces. All
 * tracers have the same arguments. */
#ifndef SONJECT_KERNELS_TRACE_H
#define SONJECT_KERNELS_TRACE_H

#include "group.h"
#include "random.h"

/* The fan, what its rays may meet, and where their echoes are counted. Buffers that a tracer does
 * without are 0. */
struct trace {
    struct fan_record fan;
    GLOBAL const struct ray_piece_record *pieces; /* rays that layers of water bend */
    GLOBAL const struct object_record *objects;
    GLOBAL const float *map;   /* the seabed's reflectivity */
    GLOBAL const float *edges; /* the elevations between which each ray lies, rad */
    GLOBAL const struct image_pair_record *pair;
    GLOBAL const struct chain_record *chains;
    GLOBAL const struct sphere_record *spheres; /* around the targets */
    GLOBAL const struct multibounce_record *multibounce;
    GLOBAL TALLY *tallies; /* those of the launch's strips; chains: of each order and strip */
    GLOBAL TALLY *tiles;   /* those of each object */
    GLOBAL struct multibounce_echo_record *echoes;
    GLOBAL RECORD_WORD *listed; /* the number of echoes in the list */
    GROUP_MEMORY float
        *throughputs; /* of GROUP_WIDTH blocks of rays; shared by the group's items */
    struct outcome_record *outcome;
    int strip, segment; /* a strip of this launch, and the share of its rays */
    struct random_key key;
};

#define TRACE_ARGUMENTS                                                                            \
    __global const struct fan_record *fan, __global const struct ray_piece_record *pieces,         \
        __global const struct object_record *objects, __global const float *map,                   \
        __global const float *edges, __global const struct image_pair_record *pair,                \
        __global const struct chain_record *chains, __global const struct sphere_record *spheres,  \
        __global const struct multibounce_record *multibounce, __global TALLY *tallies,            \
        __global TALLY *tiles, __global struct multibounce_echo_record *echoes,                    \
        __global RECORD_WORD *listed, __global struct outcome_record *outcomes

/* Defines an entry point: one group traces one segment of one strip. call: of the tracer. */
#define TRACE_KERNEL(name, call)                                                                   \
    GROUP_KERNEL void name(TRACE_ARGUMENTS)                                                        \
    {                                                                                              \
        GROUP_MEMORY float throughputs[GROUP_WIDTH];                                               \
        struct outcome_record outcome = {0, 0, 0, 0};                                              \
        struct trace trace = {*fan,   pieces,      objects,     map,     edges, pair,              \
                              chains, spheres,     multibounce, tallies, tiles, echoes,            \
                              listed, throughputs, &outcome,    0,       0,     {0, 0}};           \
        begin_strip(&trace, strip_of_group(&trace, GROUP_NUMBER),                                  \
                    GROUP_NUMBER % trace.fan.segments);                                            \
        call;                                                                                      \
        count_outcome(&outcomes[GROUP_NUMBER], &outcome);                                          \
    }

/* Returns the strip of a group. Devices hand groups out in runs, and strips near targets take
 * longest. Neighbours in a run are therefore strides apart, so that all runs take about as long.
 * The stride and the number of strips have no common factor, so every strip gets its turn, in one
 * call of the kernel or in several. */
FUNCTION int strip_of_group(const struct trace *trace, int group)
{
    const struct fan_record *fan = &trace->fan;
    const LONG_INDEX turn = (LONG_INDEX)fan->first_turn + group / fan->segments;
    return (int)(turn * fan->strip_stride % fan->strips);
}

/* Begins a segment of a strip. A strip's key is the same in a window as in the whole patch. */
FUNCTION void begin_strip(struct trace *trace, int strip, int segment)
{
    const struct fan_record *fan = &trace->fan;
    trace->strip = strip;
    trace->segment = segment;
    trace->key = random_key_of(fan->seed_low, fan->seed_high, fan->stream,
                               (RECORD_WORD)(fan->track_strip + fan->first_strip + strip));
}

/* Returns a work-item's first ray in the segment. Its next rays follow in steps of ray_step. */
FUNCTION RECORD_WORD first_ray_of_item(const struct trace *trace)
{
    return (RECORD_WORD)trace->segment * GROUP_WIDTH + GROUP_ITEM * WIDTH;
}

FUNCTION RECORD_WORD ray_step(const struct trace *trace)
{
    return (RECORD_WORD)trace->fan.segments * GROUP_WIDTH;
}

/* Returns how many of `most` rays, from the first on, the fan has. */
FUNCTION RECORD_WORD rays_from(const struct trace *trace, RECORD_WORD first_ray, RECORD_WORD most)
{
    const RECORD_WORD left = trace->fan.rays - first_ray;
    return left < most ? left : most;
}

/* Counts some rays from the first on as traced. */
FUNCTION void count_rays(const struct trace *trace, RECORD_WORD first_ray, RECORD_WORD most)
{
    trace->outcome->rays += rays_from(trace, first_ray, most);
    trace->outcome->queries += rays_from(trace, first_ray, most);
}

/* Returns the along-track position of the middle of the strip, m. */
FUNCTION float strip_position(const struct trace *trace)
{
    const struct fan_record *fan = &trace->fan;
    return fan->first_strip_x + (float)(fan->first_strip + trace->strip) * fan->strip_width;
}

#endif
