/* A beam: one set of bounds for a packet whose rays all run the same way along each axis. */
#ifndef SONJECT_KERNELS_MESH_BEAM_H
#define SONJECT_KERNELS_MESH_BEAM_H

#include "mesh_single.h"

/* The ways in which the rays of a packet run along the axes. */
struct mesh_heading {
    int downward[3]; /* the first ray runs down x, y, z; members are then visited from the upper
                        end, which is only a matter of speed */
    int is_common;   /* all rays run as the first does */
};

/* Returns 1 if the first ray runs down the axis, else 0. Clears *is_common if some differ. */
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

FUNCTION void set_beam_axis(vfloat point, vfloat inverse, int is_downward, vfloat *to_first,
                            vfloat *to_last, vfloat *least, vfloat *most)
{
    const float lower = least_lane(point);
    const float upper = -least_lane(-point);
    *to_first = SPLAT(is_downward ? lower : upper);
    *to_last = SPLAT(is_downward ? upper : lower);
    *least = SPLAT(least_lane(inverse));
    *most = SPLAT(-least_lane(-inverse));
}

FUNCTION struct ray_bounds mesh_beam_of(const struct mesh_ray *ray,
                                        const struct mesh_heading *heading)
{
    struct ray_bounds beam;
    for (int axis = 0; axis < 3; axis++)
        beam.downward[axis] = heading->downward[axis];
    set_beam_axis(ray->point.x, ray->inverse.x, heading->downward[0], &beam.to_first.x,
                  &beam.to_last.x, &beam.least.x, &beam.most.x);
    set_beam_axis(ray->point.y, ray->inverse.y, heading->downward[1], &beam.to_first.y,
                  &beam.to_last.y, &beam.least.y, &beam.most.y);
    set_beam_axis(ray->point.z, ray->inverse.z, heading->downward[2], &beam.to_first.z,
                  &beam.to_last.z, &beam.least.z, &beam.most.z);
    beam.minimum = SPLAT(least_lane(ray->minimum));
    return beam;
}

#endif
