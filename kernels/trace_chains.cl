/* Entry point: one work-item follows one segment of one strip. Echoes of chains end in other strips
 * too, so all work-items share the tallies. */
#include "trace_chains.h"

__kernel void trace_chains(__global const struct fan_record *fan_buffer,
                           __global const struct ray_piece_record *pieces,
                           __global const struct chain_record *chains,
                           __global const struct object_record *objects,
                           __global const struct sphere_record *spheres, __global const float *map,
                           __global TALLY *tallies, __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_item(&fan, (int)get_global_id(0));
    const int segment = (int)(get_global_id(0) % (size_t)fan.segments);
    outcomes[get_global_id(0)] =
        trace_chains_strip(&fan, pieces, chains, objects, spheres, map, tallies, strip, segment);
}
