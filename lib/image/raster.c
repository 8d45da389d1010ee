#include "image/raster.h"

#include "base/memory.h"

size_t pixel_bytes(enum pixel_type type)
{
    switch (type) {
    case PIXEL_UINT8:
        return 1;
    case PIXEL_UINT16:
        return 2;
    case PIXEL_FLOAT32:
        break;
    }
    return 4;
}

double pixel_full_scale(enum pixel_type type)
{
    switch (type) {
    case PIXEL_UINT8:
        return 255.0;
    case PIXEL_UINT16:
        return 65535.0;
    case PIXEL_FLOAT32:
        break;
    }
    return 1.0;
}

bool region_bytes(const struct raster_layout *layout, const struct region *region, size_t *bytes)
{
    if (region->rows > SIZE_MAX || region->columns > SIZE_MAX)
        return false;
    size_t total = 0;
    const bool fits = size_multiply((size_t)region->rows, (size_t)region->columns, &total) &&
                      size_multiply(total, layout->channels, &total) &&
                      size_multiply(total, pixel_bytes(layout->type), &total);
    if (fits)
        *bytes = total;
    return fits;
}

bool region_is_inside(const struct raster_layout *layout, const struct region *region)
{
    return region->rows > 0 && region->columns > 0 && region->rows <= layout->rows &&
           region->columns <= layout->columns && region->first_row <= layout->rows - region->rows &&
           region->first_column <= layout->columns - region->columns;
}
