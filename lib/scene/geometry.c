#include "scene/geometry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/response_table.h"

bool geometry_is_reversed(const sonject_geometry_params *geometry)
{
    return geometry->nadir_column > 0.0 && geometry->side == SONJECT_SIDE_PORT;
}

static double range_step(const sonject_geometry_params *geometry)
{
    return geometry_is_reversed(geometry) ? -geometry->column_spacing_m
                                          : geometry->column_spacing_m;
}

double geometry_range(const sonject_geometry_params *geometry, double column)
{
    return geometry->first_slant_range_m + (column - geometry->nadir_column) * range_step(geometry);
}

double geometry_column(const sonject_geometry_params *geometry, double range_m)
{
    return geometry->nadir_column +
           (range_m - geometry->first_slant_range_m) / range_step(geometry);
}

bool geometry_side(const sonject_geometry_params *geometry, uint64_t columns, uint64_t *first,
                   uint64_t *count)
{
    const double nadir = geometry->nadir_column;
    *first = 0;
    *count = columns;
    if (!(nadir > 0.0))
        return true;
    if (nadir > (double)columns - 0.5)
        return false;
    if (geometry_is_reversed(geometry))
        *count = nadir < (double)(columns - 1) ? (uint64_t)floor(nadir) + 1 : columns;
    else
        *first = (uint64_t)ceil(nadir);
    *count -= *first;
    return *first < columns;
}

sonject_geometry_params geometry_crop(const sonject_geometry_params *geometry, double first_row,
                                      double first_column, double columns)
{
    sonject_geometry_params crop = *geometry;
    const bool is_reversed = geometry_is_reversed(geometry);
    /* the nearest column replaces a nadir outside the crop */
    const double nearest = is_reversed ? first_column + columns - 1.0 : first_column;
    crop.first_along_track_m += first_row * geometry->row_spacing_m;
    crop.nadir_column = fmax(0.0, geometry->nadir_column - first_column);
    if (is_reversed ? geometry->nadir_column > nearest + 0.5 : geometry->nadir_column <= nearest) {
        crop.first_slant_range_m = geometry_range(geometry, nearest);
        crop.nadir_column = is_reversed ? columns - 1.0 : 0.0;
    }
    return crop;
}

double first_return_range(const struct first_return_list *returns,
                          const sonject_geometry_params *geometry, uint64_t row)
{
    const double columns = returns->columns[row / returns->every];
    /* To the centre of the seabed's first pixel. Of one side that begins at the right, a scene may
     * name the last column as the nadir, or the image's edge. */
    const double beyond = returns->edge > 0.0 ? geometry->nadir_column - returns->edge : 0.0;
    const double to_centre = geometry->nadir_column > 0.0 ? 0.5 + beyond : 0.0;
    return geometry->first_slant_range_m + (columns + to_centre) * geometry->column_spacing_m;
}

double ping_table_at(const struct ping_table *table, const double *column, double row)
{
    const size_t i = piece_at(table->rows, table->count, row);
    const double share = (row - table->rows[i]) / (table->rows[i + 1] - table->rows[i]);
    return column[i] + share * (column[i + 1] - column[i]);
}

void ping_table_clear(struct ping_table *table)
{
    free(table->rows);
    memset(table, 0, sizeof *table);
}
