#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "swath/conversion.h"
#include "swath/raster_formats.h"

#define PIXELS_MAX ((uint64_t)1 << 31)

/* What is asked for but has nothing to do. */
static sonject_status check_uses(struct report *report, const sonject_convert_params *params)
{
    const bool keeps_geometry = !params->into && raster_format_keeps_attributes(params->output);
    if ((params->has_geometry || params->altitude_m > 0.0) && !keeps_geometry &&
        params->range_axis == SONJECT_CONVERT_AXIS_KEPT)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: keeps no geometry or altitude: take them out, or write .tif",
                              params->output);
    return SONJECT_OK;
}

static sonject_status read_input(struct report *report, const sonject_convert_params *params,
                                 struct conversion *conversion)
{
    struct swath_file *file = NULL;
    size_t bytes = 0;
    sonject_status status;
    CHECK(swath_file_open_beside(report, params->input, params->into, params->channel,
                                 params->array, &file));
    struct raster_layout *layout = &conversion->layout;
    swath_file_layout(file, layout);
    const struct region whole = {0, 0, layout->rows, layout->columns};
    if (layout->rows > PIXELS_MAX / layout->columns || !region_bytes(layout, &whole, &bytes))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: %llu x %llu pixels are more than the 2^31 that are converted",
                                params->input, (unsigned long long)layout->rows,
                                (unsigned long long)layout->columns);
    else if (!(conversion->pixels = allocate_array(bytes, 1)))
        status = report_out_of_memory(report, params->input);
    else
        status = swath_file_read(report, file, &whole, conversion->pixels);
    THEN(status, conversion_take_geometry(report, conversion, file, params));
    swath_file_close(&file);
    return status;
}

static sonject_status write_into(struct report *report, const sonject_convert_params *params,
                                 const struct conversion *conversion)
{
    struct swath_file *file = NULL;
    struct raster_layout layout;
    sonject_status status;
    CHECK(swath_file_open_beside(report, params->into, params->input, params->channel,
                                 params->array, &file));
    swath_file_layout(file, &layout);
    const struct raster_layout *ours = &conversion->layout;
    const struct region whole = {0, 0, layout.rows, layout.columns};
    if (swath_file_new_extension(file))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: files of this kind are not changed in place: write a new .tif "
                                "instead",
                                params->into);
    else if (layout.rows != ours->rows || layout.columns != ours->columns ||
             layout.channels != ours->channels || layout.type != ours->type)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s holds %llu x %llu %s samples, the input %llu x %llu %s ones: "
                                "both must be alike",
                                params->into, (unsigned long long)layout.rows,
                                (unsigned long long)layout.columns, conversion_type_name(&layout),
                                (unsigned long long)ours->rows, (unsigned long long)ours->columns,
                                conversion_type_name(ours));
    else
        status = swath_file_copy_with_patch(report, file, params->output, &whole,
                                            conversion->pixels, NULL, NULL);
    swath_file_close(&file);
    return status;
}

static sonject_status write_new(struct report *report, const sonject_convert_params *params,
                                const struct conversion *conversion)
{
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX + 1];
    struct geometry_notes notes;
    geometry_notes_make(&notes, &conversion->geometry);
    size_t count = notes.count;
    memcpy(attributes, notes.attributes, sizeof notes.attributes);
    if (conversion->is_resampled)
        attributes[count++] = (struct raster_attribute){"sonject:resampled", "nearest column"};
    const sonject_status status = raster_format_write(report, params->output, &conversion->layout,
                                                      attributes, count, conversion->pixels);
    if (status == SONJECT_OK && count > 0 && !raster_format_keeps_attributes(params->output))
        report_news(report, "%s keeps no geometry: .tif, .png and .h5 do", params->output);
    return status;
}

sonject_status convert_file(struct report *report, const sonject_convert_params *params)
{
    struct conversion conversion;
    memset(&conversion, 0, sizeof conversion);
    sonject_status status = check_uses(report, params);
    THEN(status, read_input(report, params, &conversion));
    if (params->magnitude)
        THEN(status, conversion_to_magnitude(report, &conversion, params->input));
    if (params->range_axis != SONJECT_CONVERT_AXIS_KEPT)
        THEN(status, conversion_resample(report, &conversion, params));
    if (params->samples != SONJECT_SAMPLES_KEPT)
        THEN(status, conversion_to_type(report, &conversion, params));
    THEN(status, params->into ? write_into(report, params, &conversion)
                              : write_new(report, params, &conversion));
    free(conversion.pixels);
    return status;
}
