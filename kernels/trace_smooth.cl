/* Entry point: one group traces one segment of one sub-strip. */
#include "trace_smooth.h"

GROUP_KERNEL void trace_smooth(__global const struct fan_record *fan_buffer,
                               __global const struct ray_piece_record *pieces,
                               __global const struct object_record *objects, __global TALLY *tally,
                               __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_group(&fan, GROUP_NUMBER);
    const int segment = GROUP_NUMBER % fan.segments;
    const struct outcome_record outcome =
        trace_smooth_strip(&fan, pieces, objects, tally, strip, segment);
    count_outcome(&outcomes[GROUP_NUMBER], &outcome);
}
