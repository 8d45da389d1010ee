/* Entry point: one work-item traces one segment of one strip. */
#include "trace_rough.h"

__kernel void trace_rough(__global const struct fan_record *fan_buffer,
                          __global const struct ray_piece_record *pieces,
                          __global const struct object_record *objects, __global const float *map,
                          __global const float *edges, __global TALLY *seabed,
                          __global TALLY *tiles, __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_item(&fan, (int)get_global_id(0));
    const int segment = (int)(get_global_id(0) % (size_t)fan.segments);
    outcomes[get_global_id(0)] =
        trace_rough_strip(&fan, pieces, objects, map, edges, seabed, tiles, strip, segment);
}
