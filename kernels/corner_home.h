/* The way home from the last hit of a corner's path, to a source that stands beside it along-track
 * (kernels/MATH.md, "Corners"). */
#ifndef SONJECT_KERNELS_CORNER_HOME_H
#define SONJECT_KERNELS_CORNER_HOME_H

#include "mirrors.h"

struct way_home {
    struct vector3 direction; /* unit, from the hit to the source in unfolded space */
    real length;              /* m */
    real excess;              /* range less the source's, formed without subtracting */
    real spreading;           /* of the amplitude, 1/m */
};

/* off: from the hit to the source along-track. As way_through_layers in chain_echo.h. */
FUNCTION struct way_home home_through_layers(GLOBAL const struct source_record *source,
                                             GLOBAL const struct ray_piece_record *pieces,
                                             struct vector3 hit, real off)
{
    const real abreast = source->table.ground_range + hit.y;
    const real ground = SQUARE_ROOT(abreast * abreast + off * off);
    const struct ray_to_point ray =
        find_ray_to(source->table, pieces, source->cosine_depression, source->sine_depression,
                    hit.y + off * off / (ground + abreast), hit.z);
    struct way_home home;
    home.direction.x = ray.directions.away_y * off / ground;
    home.direction.y = -ray.directions.away_y * abreast / ground;
    home.direction.z = -ray.directions.away_z;
    home.length = ray.wavefront;
    home.excess = ray.range;
    home.spreading = SQUARE_ROOT(ray.spreading / (ground * ray.wavefront));
    return home;
}

FUNCTION struct way_home way_home(GLOBAL const struct source_record *source,
                                  GLOBAL const struct ray_piece_record *pieces, struct vector3 hit,
                                  real off)
{
    if (source->table.pieces > 0)
        return home_through_layers(source, pieces, hit, off);
    const float range = source->range;
    const real along = hit.y * source->cosine_depression - hit.z * source->sine_depression;
    const real change = 2.0f * range * along + (off * off + hit.y * hit.y + hit.z * hit.z);
    struct way_home home;
    home.length = SQUARE_ROOT(range * range + change);
    home.excess = change / (home.length + range);
    home.spreading = 1.0f / home.length;
    home.direction.x = off * home.spreading;
    home.direction.y = -(range * source->cosine_depression + hit.y) * home.spreading;
    home.direction.z = (range * source->sine_depression - hit.z) * home.spreading;
    return home;
}

#endif
