/* A packet whose rays all run the same way along each axis, taken as one: what its bounds miss,
 * every ray misses. Bounds are formed from the rays' own numbers by the operations of the exact
 * test, and rounding is monotonic, so they never lose a box that the exact test would keep. */
#ifndef SONJECT_KERNELS_MESH_BEAM_H
#define SONJECT_KERNELS_MESH_BEAM_H

#include "mesh_single.h"

/* Which way the rays of a packet run. */
struct mesh_heading {
    int downward[3]; /* the first one's: down x, y, z. Members are then visited from the upper end,
                        which is only a matter of speed */
    int is_common;   /* all rays run as the first does */
};

/* 0 or 1: the first ray runs down the axis. Clears *is_common unless all do as it. */
FUNCTION int runs_downward(vfloat inverse, int *is_common)
{
    const RECORD_WORD all = ((1u << (WIDTH - 1)) - 1u) * 2u + 1u;
    const RECORD_WORD downward = lane_bits(MASK_OF(inverse < 0.0f));
    *is_common &= downward == 0u || downward == all;
    return (int)(downward & 1u);
}

FUNCTION struct mesh_heading mesh_heading_of(const struct mesh_ray *ray)
{
    struct mesh_heading heading;
    heading.is_common = 1;
    heading.downward[0] = runs_downward(ray->inverse.x, &heading.is_common);
    heading.downward[1] = runs_downward(ray->inverse.y, &heading.is_common);
    heading.downward[2] = runs_downward(ray->inverse.z, &heading.is_common);
    return heading;
}

/* Bounds over the rays, the same in every lane. */
struct mesh_beam {
    struct vector3 to_first, to_last; /* the point that is nearest to a box's first faces each way,
                                         farthest from its last ones */
    struct vector3 least, most;       /* of the inverse directions */
    vfloat minimum;
};

FUNCTION float least_of_lanes(vfloat value)
{
    float lanes[WIDTH];
    STORE_VFLOAT(value, lanes);
    for (int span = WIDTH / 2; span > 0; span /= 2)
        for (int lane = 0; lane < span; lane++)
            lanes[lane] = lanes[lane + span] < lanes[lane] ? lanes[lane + span] : lanes[lane];
    return lanes[0];
}

FUNCTION void set_beam_axis(vfloat point, vfloat inverse, int is_downward, vfloat *to_first,
                            vfloat *to_last, vfloat *least, vfloat *most)
{
    const float lower = least_of_lanes(point);
    const float upper = -least_of_lanes(-point);
    *to_first = SPLAT(is_downward ? lower : upper);
    *to_last = SPLAT(is_downward ? upper : lower);
    *least = SPLAT(least_of_lanes(inverse));
    *most = SPLAT(-least_of_lanes(-inverse));
}

FUNCTION struct mesh_beam mesh_beam_of(const struct mesh_ray *ray,
                                       const struct mesh_heading *heading)
{
    struct mesh_beam beam;
    set_beam_axis(ray->point.x, ray->inverse.x, heading->downward[0], &beam.to_first.x,
                  &beam.to_last.x, &beam.least.x, &beam.most.x);
    set_beam_axis(ray->point.y, ray->inverse.y, heading->downward[1], &beam.to_first.y,
                  &beam.to_last.y, &beam.least.y, &beam.most.y);
    set_beam_axis(ray->point.z, ray->inverse.z, heading->downward[2], &beam.to_first.z,
                  &beam.to_last.z, &beam.least.z, &beam.most.z);
    beam.minimum = SPLAT(least_of_lanes(ray->minimum));
    return beam;
}

/* Bit i: the beam may meet the box of slot i. */
FUNCTION RECORD_WORD beam_meets(const struct mesh_beam *beam, const struct mesh_heading *heading,
                                GLOBAL const struct mesh_branch *branch)
{
    const int *downward = heading->downward;
    RECORD_WORD met = 0;
    for (int slot = 0; slot < MESH_SLOTS; slot += WIDTH) {
        const struct vector3 first =
            load_vector3(downward[0] ? branch->upper_x : branch->lower_x,
                         downward[1] ? branch->upper_y : branch->lower_y,
                         downward[2] ? branch->upper_z : branch->lower_z, slot);
        const struct vector3 last =
            load_vector3(downward[0] ? branch->lower_x : branch->upper_x,
                         downward[1] ? branch->lower_y : branch->upper_y,
                         downward[2] ? branch->lower_z : branch->upper_z, slot);
        const vfloat x_first = first.x - beam->to_first.x;
        const vfloat y_first = first.y - beam->to_first.y;
        const vfloat z_first = first.z - beam->to_first.z;
        const vfloat x_last = last.x - beam->to_last.x;
        const vfloat y_last = last.y - beam->to_last.y;
        const vfloat z_last = last.z - beam->to_last.z;
        const vfloat entry =
            larger(larger(smaller(x_first * beam->least.x, x_first * beam->most.x),
                          smaller(y_first * beam->least.y, y_first * beam->most.y)),
                   larger(smaller(z_first * beam->least.z, z_first * beam->most.z), beam->minimum));
        const vfloat exit = smaller(smaller(larger(x_last * beam->least.x, x_last * beam->most.x),
                                            larger(y_last * beam->least.y, y_last * beam->most.y)),
                                    larger(z_last * beam->least.z, z_last * beam->most.z));
        met |= lane_bits(MASK_OF(entry <= exit)) << slot;
    }
    return met;
}

#endif
