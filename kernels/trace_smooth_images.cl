/* Entry point beside trace_smooth.cl's, in a program of its own, since compiling it takes long and
 * few scenes have boundaries. */
#include "trace_smooth_images.h"

__kernel void trace_smooth_images(__global const struct fan_record *fan_buffer,
                                  __global const struct ray_piece_record *pieces,
                                  __global const struct object_record *objects,
                                  __global TALLY *tally,
                                  __global const struct image_pair_record *pair,
                                  __global struct outcome_record *outcomes)
{
    const struct fan_record fan = *fan_buffer;
    const int strip = strip_of_item(&fan, (int)get_global_id(0));
    const int segment = (int)(get_global_id(0) % (size_t)fan.segments);
    outcomes[get_global_id(0)] =
        trace_smooth_images_strip(&fan, pieces, pair, objects, tally, strip, segment);
}
