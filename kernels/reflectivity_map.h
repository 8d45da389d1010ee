/* The measured image as the seabed's reflectivity. */
#ifndef SONJECT_KERNELS_REFLECTIVITY_MAP_H
#define SONJECT_KERNELS_REFLECTIVITY_MAP_H

#include "chain_hit.h"
#include "layout.h"
#include "seabed.h"
#include "width.h"

/* Returns the reflectivity over mu0 at the pixel nearest to a row and column; 1 without a map. */
FUNCTION float map_value(const struct trace *trace, float row, float column)
{
    const struct fan_record *fan = &trace->fan;
    if (fan->map_rows == 0)
        return 1.0f;
    int r = (int)(row + 0.5f);
    int c = (int)(column + 0.5f);
    r = r < 0 ? 0 : r >= fan->map_rows ? fan->map_rows - 1 : r;
    c = c < 0 ? 0 : c >= fan->map_columns ? fan->map_columns - 1 : c;
    return trace->map[(LONG_INDEX)r * fan->map_columns + c];
}

/* A row and a column of the map, limited to what integers hold. */
struct map_place {
    vfloat row, column;
};

/* Returns the place of what lies at x and at a range less the reference range. */
FUNCTION struct map_place place_in_map(const struct fan_record *fan, vfloat x, vfloat range)
{
    const vfloat row = fan->map_row_at_origin + x * fan->map_rows_per_metre;
    const vfloat column = fan->map_column_at_reference + range * fan->map_columns_per_metre;
    struct map_place place;
    place.row = smaller(larger(row, SPLAT(-1.0f)), SPLAT(1.0e8f));
    place.column = smaller(larger(column, SPLAT(-1.0f)), SPLAT(1.0e8f));
    return place;
}

/* Returns the slant range of a point from the track, less the reference range. */
FUNCTION vfloat broadside_range(const struct trace *trace, struct vector3 point)
{
    const struct fan_record *fan = &trace->fan;
    if (fan->table.pieces > 0)
        return find_ray_to(fan->table, trace->pieces, fan->cosine_depression, fan->sine_depression,
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
FUNCTION vfloat range_in_plan(const struct trace *trace, struct vector3 point)
{
    point.z = SPLAT(trace->fan.seabed_height);
    return broadside_range(trace, point);
}

/* Returns the map's value at a chain's hits on the seabed if the map scales scattering, else 1. */
FUNCTION vfloat map_factor(const struct trace *trace, const struct chain_hit *hit)
{
    const mask on_seabed = hit->is_hit & MASK_OF(hit->surface == -1);
    if (!trace->chains->forward_is_map || !ANY(on_seabed))
        return SPLAT(1.0f);
    const vfloat range =
        has_relief(trace) ? range_in_plan(trace, hit->point) : broadside_range(trace, hit->point);
    const struct map_place place = place_in_map(&trace->fan, hit->point.x, range);
    float rows[WIDTH], columns[WIDTH], values[WIDTH];
    STORE_VFLOAT(place.row, rows);
    STORE_VFLOAT(place.column, columns);
    for (int lane = 0; lane < WIDTH; lane++)
        values[lane] = map_value(trace, rows[lane], columns[lane]);
    return SELECT(on_seabed, LOAD_VFLOAT(values), SPLAT(1.0f));
}

#endif
