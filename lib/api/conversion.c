#include "api/conversion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

#define COLUMNS_MAX 1e8

const char *conversion_type_name(const struct raster_layout *layout)
{
    return layout->channels == 2          ? "complex float32"
           : layout->type == PIXEL_UINT8  ? "uint8"
           : layout->type == PIXEL_UINT16 ? "uint16"
                                          : "float32";
}

/* NaN where the file does not say it. */
static double noted(const struct swath_file *file, const char *name)
{
    char text[64];
    const char *rest;
    double value;
    return swath_file_attribute(file, name, text, sizeof text) &&
                   text_to_number(text, &value, &rest) && *rest == '\0' && isfinite(value)
               ? value
               : NAN;
}

static void take_recording(struct conversion *conversion, const struct xtf_file *xtf)
{
    const struct xtf_geometry geometry = xtf_geometry_of(xtf, 0, xtf->rows.layout.rows);
    if (geometry.row_spacing_m > 0.0)
        conversion->row_spacing_m = geometry.row_spacing_m;
    if (geometry.altitude_m > 0.0)
        conversion->altitude_m = geometry.altitude_m;
    conversion->column_spacing_m = geometry.column_spacing_m;
    conversion->first_range_m = geometry.first_slant_range_m;
    conversion->first_along_track_m = 0.0;
    conversion->side = xtf->side == XTF_PORT ? SONJECT_SIDE_PORT : SONJECT_SIDE_STARBOARD;
    conversion->knows_side = true;
}

static void take_attributes(struct conversion *conversion, const struct swath_file *file)
{
    char side[16] = "";
    conversion->row_spacing_m = noted(file, "sonject:row_spacing_m");
    conversion->column_spacing_m = noted(file, "sonject:column_spacing_m");
    conversion->first_along_track_m = noted(file, "sonject:first_along_track_m");
    conversion->first_range_m =
        noted(file, conversion->axis == RANGE_GROUND ? "sonject:first_ground_range_m"
                                                     : "sonject:first_slant_range_m");
    conversion->altitude_m = noted(file, "sonject:altitude_m");
    conversion->frequency_hz = noted(file, "sonject:frequency_hz");
    conversion->bandwidth_hz = noted(file, "sonject:bandwidth_hz");
    conversion->knows_side = swath_file_attribute(file, "sonject:side", side, sizeof side);
    conversion->side = strcmp(side, "starboard") == 0 ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
}

void conversion_take_notes(struct conversion *conversion, const struct swath_file *file,
                           const sonject_convert_params *params)
{
    conversion->axis = swath_file_range_axis(file);
    take_attributes(conversion, file);
    if (swath_file_xtf(file))
        take_recording(conversion, swath_file_xtf(file));
    if (params->has_geometry) {
        conversion->axis = RANGE_SLANT;
        conversion->row_spacing_m = params->geometry.row_spacing_m;
        conversion->column_spacing_m = params->geometry.column_spacing_m;
        conversion->first_along_track_m = params->geometry.first_along_track_m;
        conversion->first_range_m = params->geometry.first_slant_range_m;
        conversion->side = params->geometry.side;
        conversion->knows_side = true;
    }
    if (params->altitude_m > 0.0)
        conversion->altitude_m = params->altitude_m;
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
    if (!magnitudes)
        return report_out_of_memory(report, "the magnitudes");
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
    if (!fresh)
        return report_out_of_memory(report, "the samples");
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

static sonject_status check_axis(struct report *report, const struct conversion *conversion,
                                 const sonject_convert_params *params)
{
    const bool to_ground = params->range_axis == SONJECT_CONVERT_AXIS_GROUND;
    if (conversion->axis == RANGE_UNKNOWN || isnan(conversion->first_range_m) ||
        !(conversion->column_spacing_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: does not say where its columns lie: give row spacing, column "
                              "spacing and first slant range",
                              params->input);
    if ((conversion->axis == RANGE_GROUND) == to_ground)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is in %s range already: take the range axis out", params->input,
                              to_ground ? "ground" : "slant");
    if (!(conversion->altitude_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: does not say the sonar's altitude, which ground range needs: "
                              "give it",
                              params->input);
    return SONJECT_OK;
}

/* Slant range over a level seabed of a ground range, or the other way round. */
static double other_range(const struct conversion *conversion, bool to_slant, double range)
{
    const double altitude = conversion->altitude_m;
    return to_slant ? hypot(range, altitude)
                    : sqrt(fmax(0.0, (range - altitude) * (range + altitude)));
}

sonject_status conversion_resample(struct report *report, struct conversion *conversion,
                                   const sonject_convert_params *params)
{
    struct raster_layout *layout = &conversion->layout;
    const bool to_slant = params->range_axis == SONJECT_CONVERT_AXIS_SLANT;
    const sonject_status status = check_axis(report, conversion, params);
    if (status != SONJECT_OK)
        return status;
    const double spacing = conversion->column_spacing_m;
    const double last = conversion->first_range_m + spacing * (double)(layout->columns - 1);
    if (!to_slant && last <= conversion->altitude_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: no column lies beyond the altitude of %g m", params->input,
                              conversion->altitude_m);
    const double start = other_range(conversion, to_slant, conversion->first_range_m);
    const double width = floor((other_range(conversion, to_slant, last) - start) / spacing) + 1.0;
    if (!(width >= 1.0 && width <= COLUMNS_MAX))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: %g columns would come of it: correct the geometry",
                              params->input, width);
    const size_t pixel = layout->channels * pixel_bytes(layout->type);
    const size_t columns = (size_t)width;
    const size_t before = (size_t)layout->columns;
    unsigned char *fresh =
        columns <= SIZE_MAX / pixel ? allocate_array((size_t)layout->rows, columns * pixel) : NULL;
    if (!fresh)
        return report_out_of_memory(report, "the columns");
    for (size_t column = 0; column < columns; column++) {
        const double range = other_range(conversion, !to_slant, start + spacing * (double)column);
        const double nearest = floor((range - conversion->first_range_m) / spacing + 0.5);
        const size_t from = (size_t)fmin(fmax(nearest, 0.0), (double)(before - 1));
        for (size_t row = 0; row < layout->rows; row++)
            memcpy(fresh + (row * columns + column) * pixel,
                   (const unsigned char *)conversion->pixels + (row * before + from) * pixel,
                   pixel);
    }
    replace(conversion, fresh);
    layout->columns = columns;
    conversion->first_range_m = start;
    conversion->axis = to_slant ? RANGE_SLANT : RANGE_GROUND;
    conversion->is_resampled = true;
    return SONJECT_OK;
}

static void note_text(struct conversion *conversion, const char *name, const char *text)
{
    struct raster_attribute *note = &conversion->notes[conversion->note_count++];
    note->name = name;
    note->value = text;
}

static void note_number(struct conversion *conversion, const char *name, double value)
{
    char *text = conversion->texts[conversion->note_count];
    if (!isfinite(value))
        return;
    snprintf(text, sizeof conversion->texts[0], "%.9g", value);
    char *comma = strchr(text, ','); /* of a host's locale */
    if (comma)
        *comma = '.';
    note_text(conversion, name, text);
}

void conversion_make_notes(struct conversion *conversion)
{
    const bool is_ground = conversion->axis == RANGE_GROUND;
    note_number(conversion, "sonject:frequency_hz", conversion->frequency_hz);
    note_number(conversion, "sonject:bandwidth_hz", conversion->bandwidth_hz);
    note_number(conversion, "sonject:altitude_m", conversion->altitude_m);
    note_number(conversion, "sonject:row_spacing_m", conversion->row_spacing_m);
    note_number(conversion, "sonject:column_spacing_m", conversion->column_spacing_m);
    note_number(conversion, "sonject:first_along_track_m", conversion->first_along_track_m);
    note_number(conversion,
                is_ground ? "sonject:first_ground_range_m" : "sonject:first_slant_range_m",
                conversion->first_range_m);
    if (conversion->knows_side)
        note_text(conversion, "sonject:side",
                  conversion->side == SONJECT_SIDE_STARBOARD ? "starboard" : "port");
    if (conversion->axis != RANGE_UNKNOWN)
        note_text(conversion, "sonject:range_axis", is_ground ? "ground" : "slant");
    if (conversion->is_resampled)
        note_text(conversion, "sonject:resampled", "nearest column");
}
