/* One ray's way over a height field, which is bilinear between four grid points. The ray goes from
 * block to block. It passes through the cells of a block only if the block reaches up to the ray.
 * Its clearance over the surface is carried from cell to cell, so that no ray slips between two
 * cells (kernels/MATH.md, "Relief"). */
#ifndef SONJECT_KERNELS_RELIEF_WALK_H
#define SONJECT_KERNELS_RELIEF_WALK_H

#include "interval.h"
#include "layout.h"

/* The depth in m up to which a ray that starts below the surface counts as starting on it. */
#define RELIEF_SLACK 1.0e-4f

struct relief_view {
    GLOBAL const struct relief_record *grid;
    GLOBAL const float *heights, *slopes, *blocks;
};

/* One coordinate of a ray, in cells of the grid. */
struct relief_axis {
    float start;  /* value at distance 0 */
    float gain;   /* per m; 0 if it is too small to matter */
    float metres; /* m per cell; without meaning if gain is 0 */
    int way;      /* sign of the gain */
};

struct relief_ray {
    struct relief_axis row, column;
    float height; /* height at distance 0 over the mean seabed, m */
    float rise;   /* m per m */
};

FUNCTION struct relief_axis relief_axis_of(float start, float gain)
{
    struct relief_axis axis;
    const int is_moving = gain > 1.0e-12f || gain < -1.0e-12f;
    axis.start = start;
    axis.gain = is_moving ? gain : 0.0f;
    axis.metres = 1.0f / (is_moving ? gain : 1.0f);
    axis.way = is_moving ? (gain > 0.0f ? 1 : -1) : 0;
    return axis;
}

/* Returns the distance at which a coordinate leaves the range low...high. */
FUNCTION float distance_out_of(struct relief_axis axis, int low, int high)
{
    if (axis.way == 0)
        return FAR_AWAY;
    return ((float)(axis.way > 0 ? high : low) - axis.start) * axis.metres;
}

/* Cuts the range begin...end of distances down to where a coordinate is in low...high. */
FUNCTION void keep_between(float start, float gain, float low, float high, float *begin, float *end)
{
    if (gain < 1.0e-12f && gain > -1.0e-12f) {
        *end = start < low || start > high ? -FAR_AWAY : *end;
        return;
    }
    const float to_low = (low - start) / gain;
    const float to_high = (high - start) / gain;
    const float enters = to_low < to_high ? to_low : to_high;
    const float leaves = to_low < to_high ? to_high : to_low;
    *begin = enters > *begin ? enters : *begin;
    *end = leaves < *end ? leaves : *end;
}

FUNCTION int limited(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

FUNCTION float unit_limited(float value)
{
    return value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
}

/* Interpolates between a cell's corners: (row, column), (row, column + 1), (row + 1, column),
 * (row + 1, column + 1). along, across: shares of the cell in rows and columns. */
FUNCTION float mix_corners(const float corners[4], float along, float across)
{
    const float here = corners[0] * (1.0f - across) + corners[1] * across;
    const float next = corners[2] * (1.0f - across) + corners[3] * across;
    return here * (1.0f - along) + next * along;
}

FUNCTION void load_corners(struct relief_view relief, int row, int column, float corners[4])
{
    const int columns = relief.grid->columns;
    const LONG_INDEX at = (LONG_INDEX)row * columns + column;
    corners[0] = relief.heights[at];
    corners[1] = relief.heights[at + 1];
    corners[2] = relief.heights[at + columns];
    corners[3] = relief.heights[at + columns + 1];
}

FUNCTION float share_of_cell(struct relief_axis axis, int cell, float distance)
{
    return unit_limited(axis.start + axis.gain * distance - (float)cell);
}

/* Returns the distance at which the ray first crosses the surface from above between two distances,
 * FAR_AWAY if it does not. clearance, next: heights over the surface at these distances. Heights
 * are bilinear, so the height at the share s of the way is clearance + fall s - twist s^2. */
FUNCTION float crossing_from_above(float clearance, float next, float twist, float begin, float end)
{
    if (clearance <= 0.0f)
        return next < -RELIEF_SLACK ? begin : FAR_AWAY;
    const float fall = next - clearance + twist;
    const float square = fall * fall + 4.0f * twist * clearance;
    /* the ray may dip below and come up again */
    if (next > 0.0f && !(twist < 0.0f && fall < 0.0f && fall > 2.0f * twist && square >= 0.0f))
        return FAR_AWAY;
    const float root = ROOT_OF_ONE(square > 0.0f ? square : 0.0f);
    const float share =
        fall > 0.0f ? (fall + root) / (2.0f * twist) : 2.0f * clearance / (root - fall);
    return begin + unit_limited(share) * (end - begin);
}

/* The state of a ray on its way over the grid. */
struct relief_walk {
    float at;        /* distance along the ray */
    float clearance; /* height over the surface at that distance, if is_known */
    int is_known;
    int was_above; /* the ray passed above the last block, so rounding must not put it below */
};

FUNCTION int is_level_cell(const float corners[4])
{
    return corners[0] == 0.0f && corners[1] == 0.0f && corners[2] == 0.0f && corners[3] == 0.0f;
}

/* Finds the clearance at which a walk begins, in the cell that holds that point. */
FUNCTION void begin_walk(const struct relief_ray *ray, const float corners[4], int row, int column,
                         struct relief_walk *walk)
{
    walk->clearance = ray->height + ray->rise * walk->at -
                      mix_corners(corners, share_of_cell(ray->row, row, walk->at),
                                  share_of_cell(ray->column, column, walk->at));
    if (walk->was_above && walk->clearance < 1.0e-7f)
        walk->clearance = 1.0e-7f;
    walk->is_known = 1;
}

/* Returns the distance of the ray's hit in a block's cells up to `end`, FAR_AWAY if there is none.
 * Level cells are hit at to_plane, the distance to the mean seabed. */
FUNCTION float walk_cells(struct relief_view relief, const struct relief_ray *ray, int first_row,
                          int first_column, float end, float to_plane, struct relief_walk *walk)
{
    const int last_row = limited(first_row + RELIEF_BLOCK, 0, relief.grid->rows - 1) - 1;
    const int last_column = limited(first_column + RELIEF_BLOCK, 0, relief.grid->columns - 1) - 1;
    int row = limited((int)(ray->row.start + ray->row.gain * walk->at), first_row, last_row);
    int column =
        limited((int)(ray->column.start + ray->column.gain * walk->at), first_column, last_column);
    for (int cells = 0; cells < 2 * RELIEF_BLOCK + 2; cells++) {
        const float out_of_row = distance_out_of(ray->row, row, row + 1);
        const float out_of_column = distance_out_of(ray->column, column, column + 1);
        float next = out_of_row < out_of_column ? out_of_row : out_of_column;
        next = next < end ? next : end;
        next = next > walk->at ? next : walk->at;
        float corners[4];
        load_corners(relief, row, column, corners);
        const float along = share_of_cell(ray->row, row, next);
        const float across = share_of_cell(ray->column, column, next);
        if (!walk->is_known)
            begin_walk(ray, corners, row, column, walk);
        const float clearance =
            ray->height + ray->rise * next - mix_corners(corners, along, across);
        const float way = next - walk->at;
        const float twist = ((corners[0] - corners[1]) - (corners[2] - corners[3])) *
                            (ray->row.gain * way) * (ray->column.gain * way);
        const float hit = crossing_from_above(walk->clearance, clearance, twist, walk->at, next);
        if (hit < FAR_AWAY)
            return is_level_cell(corners) ? to_plane : hit;
        walk->clearance = clearance;
        walk->at = next;
        if (next >= end)
            break;
        if (out_of_row <= out_of_column)
            row += ray->row.way;
        else
            column += ray->column.way;
        if (row < first_row || row > last_row || column < first_column || column > last_column)
            break;
    }
    return FAR_AWAY;
}

/* Walks over the blocks between two distances. Returns as walk_cells does. */
FUNCTION float walk_blocks(struct relief_view relief, const struct relief_ray *ray, float begin,
                           float end, float to_plane)
{
    const int block_rows = relief.grid->block_rows;
    const int block_columns = relief.grid->block_columns;
    int row =
        limited((int)(ray->row.start + ray->row.gain * begin) / RELIEF_BLOCK, 0, block_rows - 1);
    int column = limited((int)(ray->column.start + ray->column.gain * begin) / RELIEF_BLOCK, 0,
                         block_columns - 1);
    struct relief_walk walk = {begin, 0.0f, 0, 0};
    for (int blocks = 0; blocks < block_rows + block_columns + 2; blocks++) {
        const int first_row = row * RELIEF_BLOCK;
        const int first_column = column * RELIEF_BLOCK;
        const float out_of_row = distance_out_of(ray->row, first_row, first_row + RELIEF_BLOCK);
        const float out_of_column =
            distance_out_of(ray->column, first_column, first_column + RELIEF_BLOCK);
        float next = out_of_row < out_of_column ? out_of_row : out_of_column;
        next = next < end ? next : end;
        next = next > walk.at ? next : walk.at;
        GLOBAL const float *block = relief.blocks + 2 * ((LONG_INDEX)row * block_columns + column);
        const float here = ray->height + ray->rise * walk.at;
        const float there = ray->height + ray->rise * next;
        const float least = here < there ? here : there;
        const int is_level = block[0] == 0.0f && block[1] == 0.0f;
        if (is_level && least <= 0.0f && ray->rise < 0.0f)
            return to_plane;
        if (is_level || least > block[0]) {
            walk.at = next;
            walk.is_known = 0;
            walk.was_above = 1;
        } else {
            const float hit =
                walk_cells(relief, ray, first_row, first_column, next, to_plane, &walk);
            if (hit < FAR_AWAY)
                return hit;
            walk.at = next;
        }
        if (next >= end)
            break;
        if (out_of_row <= out_of_column)
            row += ray->row.way;
        else
            column += ray->column.way;
        if (row < 0 || row >= block_rows || column < 0 || column >= block_columns)
            break;
    }
    return FAR_AWAY;
}

/* Returns one ray's distance to the seabed beyond `minimum`. If the ray meets no relief, or only
 * outside the grid, that is to_plane, the distance to the mean plane. */
FUNCTION float relief_distance_of_one(struct relief_view relief, const struct relief_ray *ray,
                                      float to_plane, float minimum)
{
    float begin = -FAR_AWAY;
    float end = FAR_AWAY;
    keep_between(ray->row.start, ray->row.gain, 0.0f, (float)(relief.grid->rows - 1), &begin, &end);
    keep_between(ray->column.start, ray->column.gain, 0.0f, (float)(relief.grid->columns - 1),
                 &begin, &end);
    if (to_plane <= begin && to_plane >= minimum)
        return to_plane;
    keep_between(ray->height, ray->rise, relief.grid->lowest, relief.grid->highest, &begin, &end);
    begin = begin > minimum ? begin : minimum;
    if (!(begin < end))
        return to_plane;
    const float hit = walk_blocks(relief, ray, begin, end, to_plane);
    return hit < FAR_AWAY ? hit : to_plane;
}

#endif
