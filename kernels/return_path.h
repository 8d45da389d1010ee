/* The return path from the last hit of a corner's path, to a source that stands beside it
 * along-track (kernels/MATH.md, "Corners"). */
#ifndef SONJECT_KERNELS_CORNER_HOME_H
#define SONJECT_KERNELS_CORNER_HOME_H

#include "mirrors.h"

struct return_path {
    struct vector3 direction; /* unit, from the hit to the source in unfolded space */
    vfloat length;            /* m */
    vfloat excess;            /* range less the source's, formed without subtracting */
    vfloat spreading;         /* of the amplitude, 1/m */
};

/* off: from the hit to the source along-track. As way_through_layers in chain_echo.h. */
FUNCTION struct return_path return_through_layers(GLOBAL const struct source_record *source,
                                                  GLOBAL const struct ray_piece_record *pieces,
                                                  struct vector3 hit, vfloat off)
{
    const vfloat broadside = source->table.ground_range + hit.y;
    const vfloat ground = SQUARE_ROOT(broadside * broadside + off * off);
    const struct ray_to_point ray =
        find_ray_to(source->table, pieces, source->cosine_depression, source->sine_depression,
                    hit.y + off * off / (ground + broadside), hit.z);
    struct return_path returned;
    returned.direction.x = ray.directions.away_y * off / ground;
    returned.direction.y = -ray.directions.away_y * broadside / ground;
    returned.direction.z = -ray.directions.away_z;
    returned.length = ray.wavefront;
    returned.excess = ray.range;
    returned.spreading = SQUARE_ROOT(ray.spreading / (ground * ray.wavefront));
    return returned;
}

FUNCTION struct return_path return_path(GLOBAL const struct source_record *source,
                                        GLOBAL const struct ray_piece_record *pieces,
                                        struct vector3 hit, vfloat off)
{
    if (source->table.pieces > 0)
        return return_through_layers(source, pieces, hit, off);
    const float range = source->range;
    const vfloat along = hit.y * source->cosine_depression - hit.z * source->sine_depression;
    const vfloat change = 2.0f * range * along + (off * off + hit.y * hit.y + hit.z * hit.z);
    struct return_path returned;
    returned.length = SQUARE_ROOT(range * range + change);
    returned.excess = change / (returned.length + range);
    returned.spreading = 1.0f / returned.length;
    returned.direction.x = off * returned.spreading;
    returned.direction.y = -(range * source->cosine_depression + hit.y) * returned.spreading;
    returned.direction.z = (range * source->sine_depression - hit.z) * returned.spreading;
    return returned;
}

#endif
