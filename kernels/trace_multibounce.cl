/* Entry point: one work-item traces one segment of one sub-strip. */
#include "trace_multibounce.h"

__kernel void trace_multibounce(__global const struct fan_record *fan_buffer,
                                __global const struct ray_piece_record *pieces,
                                __global const struct object_record *objects,
                                __global const struct image_pair_record *pair,
                                __global const struct multibounce_record *multibounce,
                                __global struct multibounce_echo_record *echoes,
                                __global uint *listed, __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_item(&fan, (int)get_global_id(0));
    const int segment = (int)(get_global_id(0) % (size_t)fan.segments);
    outcomes[get_global_id(0)] = trace_multibounce_strip(&fan, pieces, pair, multibounce, objects,
                                                         echoes, listed, strip, segment);
}
