/* Entry point: one group traces one segment of one sub-strip. */
#include "trace_multibounce.h"

GROUP_KERNEL void trace_multibounce(__global const struct fan_record *fan_buffer,
                                    __global const struct ray_piece_record *pieces,
                                    __global const struct object_record *objects,
                                    __global const struct image_pair_record *pair,
                                    __global const struct multibounce_record *multibounce,
                                    __global struct multibounce_echo_record *echoes,
                                    __global uint *listed, __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_group(&fan, GROUP_NUMBER);
    const int segment = GROUP_NUMBER % fan.segments;
    const struct outcome_record outcome = trace_multibounce_strip(
        &fan, pieces, pair, multibounce, objects, echoes, listed, strip, segment);
    count_outcome(&outcomes[GROUP_NUMBER], &outcome);
}
