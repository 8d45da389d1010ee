#include "swath/conversion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "swath/raster_file.h"

#define COLUMNS_MAX 1e8

/* The image during its conversion. */
struct conversion {
    struct raster_layout layout;
    void *pixels; /* owned */
    struct noted_geometry geometry;
    double full_scale; /* of the file's numbers */
    bool is_resampled;
};

/* Returns a name such as "complex float32". */
static const char *type_name(const struct raster_layout *layout)
{
    return layout->channels == 2          ? "complex float32"
           : layout->type == PIXEL_UINT8  ? "uint8"
           : layout->type == PIXEL_UINT16 ? "uint16"
                                          : "float32";
}

/* Takes the geometry from the parameters, or else from the file. */
static sonject_status take_geometry(struct report *report, struct conversion *conversion,
                                    const struct swath_file *file,
                                    const sonject_convert_params *params,
                                    const struct image_options *options)
{
    struct noted_geometry *geometry = &conversion->geometry;
    geometry_notes_read(file, geometry);
    if (options->has_geometry) {
        if (geometry->axis == RANGE_GROUND)
            return input_failure(report, params->input,
                                 "says that it is in ground range, and a first slant range is "
                                 "given: take the geometry out");
        /* who asks for slant range has an image in ground range */
        geometry->axis =
            geometry->axis == RANGE_UNKNOWN && params->range_axis == SONJECT_CONVERT_AXIS_SLANT
                ? RANGE_GROUND
                : RANGE_SLANT;
        geometry->row_spacing_m = options->geometry.row_spacing_m;
        geometry->column_spacing_m = options->geometry.column_spacing_m;
        geometry->first_along_track_m = options->geometry.first_along_track_m;
        geometry->first_range_m = options->geometry.first_slant_range_m;
        geometry->nadir_column =
            options->geometry.nadir_column > 0.0 ? options->geometry.nadir_column : NAN;
        geometry->side = options->geometry.side;
        geometry->knows_side = true;
    }
    if (params->altitude_m > 0.0)
        geometry->altitude_m = params->altitude_m;
    return SONJECT_OK;
}

static sonject_status check_axis(struct report *report, const char *path, enum range_axis axis,
                                 double altitude, const struct range_columns *columns)
{
    const bool is_ground = columns->axis == RANGE_GROUND;
    if (columns->axis == RANGE_UNKNOWN || isnan(columns->first_m) || isnan(columns->spacing_m))
        return input_failure(report, path,
                             "does not say where its columns lie: give row spacing, column spacing "
                             "and first range");
    if (columns->axis == axis)
        return input_failure(report, path, "is in %s range already: take the range axis out",
                             is_ground ? "ground" : "slant");
    if (columns->has_nadir)
        return input_failure(report, path,
                             "has columns to the left of its nadir; range axes are changed where "
                             "range grows from column 0 on");
    if (!(altitude > 0.0))
        return input_failure(
            report, path, "does not say the sonar's altitude, which ground range needs: give it");
    if (!is_ground &&
        columns->first_m + columns->spacing_m * (double)(columns->count - 1) <= altitude)
        return input_failure(report, path, "no column lies beyond the altitude of %g m", altitude);
    return SONJECT_OK;
}

/* Returns the range on the given axis of a range on the other axis, over a level seabed. */
static double other_range(double altitude, enum range_axis axis, double range)
{
    return axis == RANGE_SLANT ? hypot(range, altitude)
                               : sqrt(fmax(0.0, (range - altitude) * (range + altitude)));
}

sonject_status range_axis_change(struct report *report, const char *path, enum range_axis axis,
                                 double altitude_m, double step_m, size_t rows, size_t bytes,
                                 struct range_columns *columns, void **pixels)
{
    CHECK(check_axis(report, path, axis, altitude_m, columns));
    const size_t before = columns->count;
    const double last = columns->first_m + columns->spacing_m * (double)(before - 1);
    const double start = other_range(altitude_m, axis, columns->first_m);
    const double width = floor((other_range(altitude_m, axis, last) - start) / step_m) + 1.0;
    if (!(width >= 1.0 && width <= COLUMNS_MAX))
        return input_failure(report, path, "the result would have %g columns: correct the geometry",
                             width);
    const size_t count = (size_t)width;
    unsigned char *fresh = count <= SIZE_MAX / bytes ? allocate_array(rows, count * bytes) : NULL;
    CHECK_MEMORY(report, fresh, "the columns");
    for (size_t column = 0; column < count; column++) {
        const double range =
            other_range(altitude_m, columns->axis, start + step_m * (double)column);
        const double nearest = floor((range - columns->first_m) / columns->spacing_m + 0.5);
        const size_t from = (size_t)fmin(fmax(nearest, 0.0), (double)(before - 1));
        for (size_t row = 0; row < rows; row++)
            memcpy(fresh + (row * count + column) * bytes,
                   (const unsigned char *)*pixels + (row * before + from) * bytes, bytes);
    }
    free(*pixels);
    *pixels = fresh;
    *columns = (struct range_columns){axis, start, step_m, false, count};
    return SONJECT_OK;
}

/* Changes the range axis and keeps the column spacing. */
static sonject_status resample(struct report *report, struct conversion *conversion,
                               const sonject_convert_params *params)
{
    struct raster_layout *layout = &conversion->layout;
    struct noted_geometry *geometry = &conversion->geometry;
    const double spacing = geometry->column_spacing_m;
    struct range_columns columns = {geometry->axis, geometry->first_range_m,
                                    spacing > 0.0 ? spacing : NAN, geometry->nadir_column > 0.0,
                                    (size_t)layout->columns};
    CHECK(range_axis_change(
        report, params->input,
        params->range_axis == SONJECT_CONVERT_AXIS_SLANT ? RANGE_SLANT : RANGE_GROUND,
        geometry->altitude_m, spacing, (size_t)layout->rows,
        layout->channels * pixel_bytes(layout->type), &columns, &conversion->pixels));
    layout->columns = columns.count;
    geometry->first_range_m = columns.first_m;
    geometry->axis = columns.axis;
    conversion->is_resampled = true;
    return SONJECT_OK;
}

/* Refuses options that would have no effect. */
static sonject_status check_uses(struct report *report, const sonject_convert_params *params,
                                 const struct image_options *options)
{
    const bool keeps_geometry = !params->into && raster_format_keeps_attributes(params->output);
    if ((options->has_geometry || params->altitude_m > 0.0) && !keeps_geometry &&
        params->range_axis == SONJECT_CONVERT_AXIS_KEPT)
        return input_failure(report, params->output,
                             "keeps no geometry or altitude: take them out, or write .tif");
    if (params->into && params->black_db < params->white_db)
        return input_failure(report, params->into,
                             "grey levels need a new file: remove one of --db and --into");
    return SONJECT_OK;
}

static sonject_status read_input(struct report *report, const sonject_convert_params *params,
                                 const struct image_options *options, struct conversion *conversion)
{
    struct swath_file *file = NULL;
    file_protect(report, params->input);
    CHECK(swath_file_open_beside(report, params->input, params->into, options->channel,
                                 options->array, &file));
    if (!(params->black_db < params->white_db))
        swath_file_refuse_rounding(file);
    sonject_status status =
        swath_file_read_all(report, file, &conversion->layout, &conversion->pixels);
    THEN(status, take_geometry(report, conversion, file, params, options));
    conversion->full_scale = swath_file_full_scale(file);
    swath_file_close(&file);
    return status;
}

static sonject_status write_into(struct report *report, const sonject_convert_params *params,
                                 const struct image_options *options,
                                 const struct conversion *conversion)
{
    struct swath_file *file = NULL;
    struct raster_layout layout;
    sonject_status status;
    file_protect(report, params->into);
    CHECK(swath_file_open_beside(report, params->into, params->input, options->channel,
                                 options->array, &file));
    swath_file_layout(file, &layout);
    const struct raster_layout *ours = &conversion->layout;
    const struct region whole = {0, 0, layout.rows, layout.columns};
    if (swath_file_new_extension(file))
        status =
            input_failure(report, params->into,
                          "files of this kind are not changed in place: write a new .tif instead");
    else if (!layouts_are_alike(&layout, ours))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s holds %llu x %llu %s samples, the input %llu x %llu %s ones: "
                                "both must be alike",
                                params->into, (unsigned long long)layout.rows,
                                (unsigned long long)layout.columns, type_name(&layout),
                                (unsigned long long)ours->rows, (unsigned long long)ours->columns,
                                type_name(ours));
    else
        status = swath_file_copy_with_patch(report, file, params->output, &whole,
                                            conversion->pixels, NULL, NULL);
    swath_file_close(&file);
    return status;
}

static sonject_status write_new(struct report *report, const sonject_convert_params *params,
                                struct conversion *conversion)
{
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX + 2];
    struct geometry_notes notes;
    char ends[GREY_TEXT];
    struct noted_geometry geometry = conversion->geometry;
    const bool is_kept = raster_format_keeps_attributes(params->output);
    if (geometry.altitude_varies && !(params->altitude_m > 0.0) && is_kept) {
        report_note(report,
                    "the altitude changes along the line, and %s has no place for that: it is left "
                    "out, and sonar.altitude: from_file works only with %s",
                    params->output, params->input);
        geometry.altitude_m = NAN;
    }
    if (params->black_db < params->white_db)
        geometry.full_scale = 0.0; /* grey levels are other numbers */
    if (geometry.full_scale > 0.0 && !is_kept) {
        report_note(report,
                    "%s has no place for the full scale of %s: set input.transfer.full_scale to "
                    "%.0f in its scenes",
                    params->output, params->input, geometry.full_scale);
        geometry.full_scale = 0.0;
    }
    geometry_notes_make(&notes, &geometry);
    size_t count = notes.count;
    memcpy(attributes, notes.attributes, sizeof notes.attributes);
    if (conversion->is_resampled)
        attributes[count++] = (struct raster_attribute){"sonject:resampled", "nearest column"};
    if (params->black_db < params->white_db)
        attributes[count++] = raster_make_grey(
            report, &conversion->layout, conversion->pixels, conversion->full_scale,
            (const double[]){params->black_db, params->white_db}, ends);
    const sonject_status status = raster_format_write(report, params->output, &conversion->layout,
                                                      attributes, count, conversion->pixels);
    if (status == SONJECT_OK && count > 0 && !is_kept)
        report_log(report, "%s keeps no geometry: .tif, .png and .h5 do", params->output);
    return status;
}

sonject_status convert_file(struct report *report, const sonject_convert_params *params,
                            const struct image_options *options)
{
    struct conversion conversion;
    memset(&conversion, 0, sizeof conversion);
    sonject_status status = check_uses(report, params, options);
    THEN(status, read_input(report, params, options, &conversion));
    if (params->range_axis != SONJECT_CONVERT_AXIS_KEPT)
        THEN(status, resample(report, &conversion, params));
    THEN(status, params->into ? write_into(report, params, options, &conversion)
                              : write_new(report, params, &conversion));
    free(conversion.pixels);
    return status;
}
