/* Entry point: one group follows one segment of one strip. All groups share the tallies, since
 * chains' echoes end in other strips too. */
#include "trace_chains.h"

GROUP_KERNEL void trace_chains(__global const struct fan_record *fan_buffer,
                               __global const struct ray_piece_record *pieces,
                               __global const struct chain_record *chains,
                               __global const struct object_record *objects,
                               __global const struct sphere_record *spheres,
                               __global const float *map, __global TALLY *tallies,
                               __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_group(&fan, GROUP_NUMBER);
    const int segment = GROUP_NUMBER % fan.segments;
    GROUP_MEMORY float throughputs[GROUP_WIDTH];
    const struct outcome_record outcome = trace_chains_strip(
        &fan, pieces, chains, objects, spheres, map, tallies, throughputs, strip, segment);
    count_outcome(&outcomes[GROUP_NUMBER], &outcome);
}
