/* A beam: one set of bounds for a packet whose rays share their own axes and run the same way along
 * each of them. */
#ifndef SONJECT_KERNELS_MESH_BEAM_H
#define SONJECT_KERNELS_MESH_BEAM_H

#include "mesh_single.h"

/* The way in which the rays of a packet run. */
struct mesh_heading {
    int axes[3];     /* the mesh's axes that are the rays' own x, y, z */
    int downward[3]; /* the rays run down their own x, y, z: 0 or 1 */
    struct face_rows rows;
};

/* Returns 1 if the mask is set for the first ray, else 0. Clears *is_common if it differs. */
FUNCTION int common_flag(mask flag, int *is_common)
{
    const RECORD_WORD all = ((1u << (WIDTH - 1)) - 1u) * 2u + 1u;
    const RECORD_WORD flags = lane_bits(flag);
    *is_common &= flags == 0u || flags == all;
    return (int)(flags & 1u);
}

/* Finds the heading of a packet. Returns 0 if its rays have different headings. */
FUNCTION int find_packet_heading(const struct mesh_ray *ray, vint own_z,
                                 struct mesh_heading *heading)
{
    int is_common = 1;
    const int is_x = common_flag(MASK_OF(own_z == 0), &is_common);
    const int is_y = common_flag(MASK_OF(own_z == 1), &is_common);
    heading->downward[0] = common_flag(MASK_OF(ray->inverse.x < 0.0f), &is_common);
    heading->downward[1] = common_flag(MASK_OF(ray->inverse.y < 0.0f), &is_common);
    heading->downward[2] = common_flag(MASK_OF(ray->inverse.z < 0.0f), &is_common);
    find_own_axes(is_x ? 0 : is_y ? 1 : 2, heading->axes);
    heading->rows = face_rows_of(heading->axes, heading->downward[0], heading->downward[1],
                                 heading->downward[2]);
    return is_common;
}

/* Returns whether the packet's rays run down an axis of the mesh: 0 x, 1 y, 2 z. The members of a
 * branch are then visited from the upper end, which is only a matter of speed. */
FUNCTION int runs_down(const struct mesh_heading *heading, int axis)
{
    return axis == heading->axes[0]   ? heading->downward[0]
           : axis == heading->axes[1] ? heading->downward[1]
                                      : heading->downward[2];
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
    beam.rows = heading->rows;
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
