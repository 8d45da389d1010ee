/* Entry point: one group traces one segment of one strip. */
#include "trace_rough.h"

GROUP_KERNEL void trace_rough(__global const struct fan_record *fan_buffer,
                              __global const struct ray_piece_record *pieces,
                              __global const struct object_record *objects,
                              __global const float *map, __global const float *edges,
                              __global TALLY *seabed, __global TALLY *tiles,
                              __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_group(&fan, GROUP_NUMBER);
    const int segment = GROUP_NUMBER % fan.segments;
    const struct outcome_record outcome =
        trace_rough_strip(&fan, pieces, objects, map, edges, seabed, tiles, strip, segment);
    count_outcome(&outcomes[GROUP_NUMBER], &outcome);
}
