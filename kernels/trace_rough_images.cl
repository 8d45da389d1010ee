/* Entry point like that of trace_rough.cl, in a program of its own: compiling it takes long, and
 * few scenes have boundaries. */
#include "trace_rough_images.h"

GROUP_KERNEL void trace_rough_images(__global const struct fan_record *fan_buffer,
                                     __global const struct ray_piece_record *pieces,
                                     __global const struct object_record *objects,
                                     __global TALLY *tiles,
                                     __global const struct image_pair_record *pair,
                                     __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_group(&fan, GROUP_NUMBER);
    const int segment = GROUP_NUMBER % fan.segments;
    const struct outcome_record outcome =
        trace_rough_images_strip(&fan, pieces, pair, objects, tiles, strip, segment);
    count_outcome(&outcomes[GROUP_NUMBER], &outcome);
}
