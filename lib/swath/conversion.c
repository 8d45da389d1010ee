#include "swath/conversion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define COLUMNS_MAX 1e8

const char *conversion_type_name(const struct raster_layout *layout)
{
    return layout->channels == 2          ? "complex float32"
           : layout->type == PIXEL_UINT8  ? "uint8"
           : layout->type == PIXEL_UINT16 ? "uint16"
                                          : "float32";
}

sonject_status conversion_take_geometry(struct report *report, struct conversion *conversion,
                                        const struct swath_file *file,
                                        const sonject_convert_params *params)
{
    struct noted_geometry *geometry = &conversion->geometry;
    geometry_notes_read(file, geometry);
    if (params->has_geometry) {
        if (geometry->axis == RANGE_GROUND)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: says that it is in ground range, and a first slant range is "
                                  "given: take the geometry out",
                                  params->input);
        geometry->axis = RANGE_SLANT;
        geometry->row_spacing_m = params->geometry.row_spacing_m;
        geometry->column_spacing_m = params->geometry.column_spacing_m;
        geometry->first_along_track_m = params->geometry.first_along_track_m;
        geometry->first_range_m = params->geometry.first_slant_range_m;
        geometry->side = params->geometry.side;
        geometry->knows_side = true;
    }
    if (params->altitude_m > 0.0)
        geometry->altitude_m = params->altitude_m;
    return SONJECT_OK;
}

static void replace(struct conversion *conversion, void *pixels)
{
    free(conversion->pixels);
    conversion->pixels = pixels;
}

sonject_status conversion_to_magnitude(struct report *report, struct conversion *conversion,
                                       const char *input)
{
    struct raster_layout *layout = &conversion->layout;
    const size_t count = (size_t)(layout->rows * layout->columns);
    const float *parts = conversion->pixels;
    if (layout->channels != 2 || layout->type != PIXEL_FLOAT32)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is not complex, so it has no other magnitude: take that out",
                              input);
    float *magnitudes = allocate_array(count, sizeof *magnitudes);
    CHECK_MEMORY(report, magnitudes, "the magnitudes");
    for (size_t i = 0; i < count; i++)
        magnitudes[i] = hypotf(parts[2 * i], parts[2 * i + 1]);
    replace(conversion, magnitudes);
    layout->channels = 1;
    return SONJECT_OK;
}

static double sample_at(enum pixel_type type, const void *pixels, size_t i)
{
    return type == PIXEL_UINT8    ? (double)((const uint8_t *)pixels)[i]
           : type == PIXEL_UINT16 ? (double)((const uint16_t *)pixels)[i]
                                  : (double)((const float *)pixels)[i];
}

/* False if the type does not hold the number. */
static bool put_sample(enum pixel_type type, void *pixels, size_t i, double number)
{
    if (type == PIXEL_FLOAT32) {
        ((float *)pixels)[i] = (float)number;
        return isfinite(((float *)pixels)[i]) || !isfinite(number);
    }
    const double rounded = floor(number + 0.5);
    if (!(rounded >= 0.0 && rounded <= pixel_full_scale(type)))
        return false;
    if (type == PIXEL_UINT8)
        ((uint8_t *)pixels)[i] = (uint8_t)rounded;
    else
        ((uint16_t *)pixels)[i] = (uint16_t)rounded;
    return true;
}

sonject_status conversion_to_type(struct report *report, struct conversion *conversion,
                                  const sonject_convert_params *params)
{
    struct raster_layout *layout = &conversion->layout;
    const enum pixel_type type = params->samples == SONJECT_SAMPLES_UINT8    ? PIXEL_UINT8
                                 : params->samples == SONJECT_SAMPLES_UINT16 ? PIXEL_UINT16
                                                                             : PIXEL_FLOAT32;
    const size_t count = (size_t)(layout->rows * layout->columns) * layout->channels;
    if (layout->channels == 2 && type != PIXEL_FLOAT32)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is complex, which whole numbers do not hold: ask for its "
                              "magnitude too",
                              params->input);
    if (type == layout->type && params->scale == 1.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: already has %s samples: take the type out", params->input,
                              conversion_type_name(layout));
    void *fresh = allocate_array(count, pixel_bytes(type));
    CHECK_MEMORY(report, fresh, "the samples");
    for (size_t i = 0; i < count; i++) {
        const double number = sample_at(layout->type, conversion->pixels, i) * params->scale;
        if (put_sample(type, fresh, i, number))
            continue;
        free(fresh);
        const uint64_t pixel = i / layout->channels;
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: the sample at row %llu, column %llu would become %g, which the "
                              "new type does not hold: choose another scale",
                              params->input, (unsigned long long)(pixel / layout->columns),
                              (unsigned long long)(pixel % layout->columns), number);
    }
    replace(conversion, fresh);
    layout->type = type;
    return SONJECT_OK;
}

static sonject_status check_axis(struct report *report, const struct noted_geometry *geometry,
                                 const sonject_convert_params *params)
{
    const bool to_ground = params->range_axis == SONJECT_CONVERT_AXIS_GROUND;
    if (geometry->axis == RANGE_UNKNOWN || isnan(geometry->first_range_m) ||
        !(geometry->column_spacing_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: does not say where its columns lie: give row spacing, column "
                              "spacing and first slant range",
                              params->input);
    if ((geometry->axis == RANGE_GROUND) == to_ground)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is in %s range already: take the range axis out", params->input,
                              to_ground ? "ground" : "slant");
    if (!(geometry->altitude_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: does not say the sonar's altitude, which ground range needs: "
                              "give it",
                              params->input);
    return SONJECT_OK;
}

/* Slant range over a level seabed of a ground range, or the other way round. */
static double other_range(double altitude, bool to_slant, double range)
{
    return to_slant ? hypot(range, altitude)
                    : sqrt(fmax(0.0, (range - altitude) * (range + altitude)));
}

sonject_status conversion_resample(struct report *report, struct conversion *conversion,
                                   const sonject_convert_params *params)
{
    struct raster_layout *layout = &conversion->layout;
    const bool to_slant = params->range_axis == SONJECT_CONVERT_AXIS_SLANT;
    struct noted_geometry *geometry = &conversion->geometry;
    CHECK(check_axis(report, geometry, params));
    const double spacing = geometry->column_spacing_m;
    const double last = geometry->first_range_m + spacing * (double)(layout->columns - 1);
    if (!to_slant && last <= geometry->altitude_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: no column lies beyond the altitude of %g m", params->input,
                              geometry->altitude_m);
    const double start = other_range(geometry->altitude_m, to_slant, geometry->first_range_m);
    const double width =
        floor((other_range(geometry->altitude_m, to_slant, last) - start) / spacing) + 1.0;
    if (!(width >= 1.0 && width <= COLUMNS_MAX))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: %g columns would come of it: correct the geometry",
                              params->input, width);
    const size_t pixel = layout->channels * pixel_bytes(layout->type);
    const size_t columns = (size_t)width;
    const size_t before = (size_t)layout->columns;
    unsigned char *fresh =
        columns <= SIZE_MAX / pixel ? allocate_array((size_t)layout->rows, columns * pixel) : NULL;
    CHECK_MEMORY(report, fresh, "the columns");
    for (size_t column = 0; column < columns; column++) {
        const double range =
            other_range(geometry->altitude_m, !to_slant, start + spacing * (double)column);
        const double nearest = floor((range - geometry->first_range_m) / spacing + 0.5);
        const size_t from = (size_t)fmin(fmax(nearest, 0.0), (double)(before - 1));
        for (size_t row = 0; row < layout->rows; row++)
            memcpy(fresh + (row * columns + column) * pixel,
                   (const unsigned char *)conversion->pixels + (row * before + from) * pixel,
                   pixel);
    }
    replace(conversion, fresh);
    layout->columns = columns;
    geometry->first_range_m = start;
    geometry->axis = to_slant ? RANGE_SLANT : RANGE_GROUND;
    conversion->is_resampled = true;
    return SONJECT_OK;
}
