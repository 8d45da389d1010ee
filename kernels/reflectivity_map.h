/* The measured image as the seabed's reflectivity. */
#ifndef SONJECT_KERNELS_REFLECTIVITY_MAP_H
#define SONJECT_KERNELS_REFLECTIVITY_MAP_H

#include "chain_hit.h"
#include "layout.h"
#include "seabed.h"
#include "width.h"

/* Returns the reflectivity over mu0 at the pixel nearest to a row and column; 1 without a map. */
FUNCTION float map_value(const struct fan_record *fan, GLOBAL const float *map, float row,
                         float column)
{
    if (fan->map_rows == 0)
        return 1.0f;
    int r = (int)(row + 0.5f);
    int c = (int)(column + 0.5f);
    r = r < 0 ? 0 : r >= fan->map_rows ? fan->map_rows - 1 : r;
    c = c < 0 ? 0 : c >= fan->map_columns ? fan->map_columns - 1 : c;
    return map[(LONG_INDEX)r * fan->map_columns + c];
}

/* Returns the slant range of a point from the track, less the reference range. */
FUNCTION vfloat broadside_range(const struct fan_record *fan,
                                GLOBAL const struct ray_piece_record *pieces, struct vector3 point)
{
    if (fan->table.pieces > 0)
        return find_ray_to(fan->table, pieces, fan->cosine_depression, fan->sine_depression,
                           point.y, point.z)
            .range;
    /* formed as in path_to_source */
    const float r = fan->reference_range;
    const vfloat square =
        point.y * point.y + point.z * point.z +
        2.0f * r * (point.y * fan->cosine_depression - point.z * fan->sine_depression);
    return square / (SQUARE_ROOT(larger(square + r * r, SPLAT(0.0f))) + r);
}

/* Returns broadside_range of the mean seabed below or above a point: the image shows it level. */
FUNCTION vfloat range_in_plan(const struct fan_record *fan,
                              GLOBAL const struct ray_piece_record *pieces, struct vector3 point)
{
    point.z = SPLAT(fan->seabed_height);
    return broadside_range(fan, pieces, point);
}

/* Returns the map's value at a chain's hits on the seabed if the map scales scattering, else 1. */
FUNCTION vfloat map_factor(const struct fan_record *fan,
                           GLOBAL const struct ray_piece_record *pieces,
                           GLOBAL const struct chain_record *chains, GLOBAL const float *map,
                           const struct chain_hit *hit)
{
    const mask on_seabed = hit->is_hit & MASK_OF(hit->surface == -1);
    if (!chains->forward_is_map || !ANY(on_seabed))
        return SPLAT(1.0f);
    const vfloat range = has_relief(fan) ? range_in_plan(fan, pieces, hit->point)
                                         : broadside_range(fan, pieces, hit->point);
    const vfloat row = fan->map_row_at_origin + hit->point.x * fan->map_rows_per_metre;
    const vfloat column = fan->map_column_at_reference + range * fan->map_columns_per_metre;
    const vfloat safe_row = smaller(larger(row, SPLAT(-1.0f)), SPLAT(1.0e8f));
    const vfloat safe_column = smaller(larger(column, SPLAT(-1.0f)), SPLAT(1.0e8f));
    float rows[WIDTH], columns[WIDTH], values[WIDTH];
    STORE_VFLOAT(safe_row, rows);
    STORE_VFLOAT(safe_column, columns);
    for (int lane = 0; lane < WIDTH; lane++)
        values[lane] = map_value(fan, map, rows[lane], columns[lane]);
    return SELECT(on_seabed, LOAD_VFLOAT(values), SPLAT(1.0f));
}

#endif
