/* Rays that meet a seabed that is not level, and its normals there. Each lane walks alone
 * (relief_walk.h). */
#ifndef SONJECT_KERNELS_RELIEF_H
#define SONJECT_KERNELS_RELIEF_H

#include "layout.h"
#include "relief_walk.h"

/* The smallest cosine of incidence. An interpolated normal may turn further away than the facet. */
#define RELIEF_LEAST_COSINE 1.0e-3f

/* Returns the relief, which lies behind the records of all objects. */
FUNCTION struct relief_view relief_of(const struct trace *trace)
{
    GLOBAL const RECORD_WORD *words =
        (GLOBAL const RECORD_WORD *)trace->objects + trace->fan.relief_words;
    struct relief_view relief;
    relief.grid = (GLOBAL const struct relief_record *)words;
    relief.heights = (GLOBAL const float *)(relief.grid + 1);
    relief.slopes = relief.heights + (LONG_INDEX)relief.grid->rows * relief.grid->columns;
    relief.blocks = relief.slopes + 2 * (LONG_INDEX)relief.grid->rows * relief.grid->columns;
    return relief;
}

/* Returns the distance along each ray to the seabed beyond `minimum`, FAR_AWAY if there is none.
 * to_plane: distance to the mean plane, which lanes that are not wanted keep. */
NOINLINE vfloat relief_distance(const struct trace *trace, struct vector3 point,
                                struct vector3 direction, vfloat minimum, vfloat to_plane,
                                mask is_wanted)
{
    const struct fan_record *fan = &trace->fan;
    const struct relief_view relief = relief_of(trace);
    const float rows = relief.grid->rows_per_metre;
    const float columns = relief.grid->columns_per_metre;
    const vfloat starts[3] = {(point.x - fan->relief_x) * rows, (point.y - fan->relief_y) * columns,
                              point.z - fan->seabed_height};
    const vfloat gains[3] = {direction.x * rows, direction.y * columns, direction.z};
    float start[3][WIDTH], gain[3][WIDTH], plane[WIDTH], least[WIDTH];
    int wanted[WIDTH];
    for (int axis = 0; axis < 3; axis++) {
        STORE_VFLOAT(starts[axis], start[axis]);
        STORE_VFLOAT(gains[axis], gain[axis]);
    }
    STORE_VFLOAT(to_plane, plane);
    STORE_VFLOAT(minimum, least);
    STORE_VINT(is_wanted, wanted);
    for (int lane = 0; lane < WIDTH; lane++) {
        if (!wanted[lane])
            continue;
        struct relief_ray ray;
        ray.row = relief_axis_of(start[0][lane], gain[0][lane]);
        ray.column = relief_axis_of(start[1][lane], gain[1][lane]);
        ray.height = start[2][lane];
        ray.rise = gain[2][lane];
        plane[lane] = relief_distance_of_one(relief, &ray, plane[lane], least[lane]);
    }
    return LOAD_VFLOAT(plane);
}

/* Returns the slope at a grid coordinate, 0 outside the grid. It is mixed from the slopes at the
 * cell's corners, so that scattering does not show the cells. part: 0 along-track, 1 in range. */
FUNCTION float slope_at(struct relief_view relief, float row, float column, int part)
{
    const int rows = relief.grid->rows;
    const int columns = relief.grid->columns;
    if (!(row >= 0.0f && row <= (float)(rows - 1) && column >= 0.0f &&
          column <= (float)(columns - 1)))
        return 0.0f;
    const int r = limited((int)row, 0, rows - 2);
    const int c = limited((int)column, 0, columns - 2);
    GLOBAL const float *at = relief.slopes + 2 * ((LONG_INDEX)r * columns + c) + part;
    const float corners[4] = {at[0], at[2], at[2 * columns], at[2 * columns + 2]};
    return mix_corners(corners, row - (float)r, column - (float)c);
}

/* Returns the unit normals where rays have met the relief, on the side that the rays came from. */
NOINLINE struct vector3 relief_normal(const struct trace *trace, struct vector3 point,
                                      struct vector3 direction)
{
    const struct fan_record *fan = &trace->fan;
    const struct relief_view relief = relief_of(trace);
    const vfloat row = (point.x - fan->relief_x) * relief.grid->rows_per_metre;
    const vfloat column = (point.y - fan->relief_y) * relief.grid->columns_per_metre;
    float rows[WIDTH], columns[WIDTH], slopes[2][WIDTH];
    STORE_VFLOAT(row, rows);
    STORE_VFLOAT(column, columns);
    for (int lane = 0; lane < WIDTH; lane++)
        for (int part = 0; part < 2; part++)
            slopes[part][lane] = slope_at(relief, rows[lane], columns[lane], part);
    const vfloat along = LOAD_VFLOAT(slopes[0]);
    const vfloat across = LOAD_VFLOAT(slopes[1]);
    const vfloat up = 1.0f / SQUARE_ROOT(along * along + across * across + 1.0f);
    const struct vector3 normal = vector3_of(-along * up, -across * up, up);
    const vfloat lack = larger(RELIEF_LEAST_COSINE + dot3(normal, direction), SPLAT(0.0f));
    const struct vector3 bent = along3(normal, direction, -lack);
    const vfloat length = SQUARE_ROOT(dot3(bent, bent));
    return choose3(MASK_OF(lack > 0.0f), divided3(bent, length), normal);
}

#endif
