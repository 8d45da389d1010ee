/* Image files: pictures, conversions, and synthetic seabeds. */
#include <math.h>
#include <string.h>

#include <sonject/convert.h>
#include <sonject/run.h>

#include "api/handles.h"
#include "inject/swath.h"
#include "swath/conversion.h"
#include "swath/quicklook.h"

static sonject_status check_altitude(struct report *report, double altitude_m)
{
    if (altitude_m >= 0.0 && isfinite(altitude_m))
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "altitude must be a number of m above 0, not %g", altitude_m);
}

static sonject_status check_quicklook(struct report *report, const sonject_quicklook_params *params)
{
    const bool has_scale = params->minimum_db != 0.0 || params->maximum_db != 0.0;
    if (!params->image || !params->picture)
        return null_argument(report, "image and picture");
    if (params->range_axis > SONJECT_AXIS_GROUND)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "range_axis: no such choice");
    if (has_scale && !(isfinite(params->minimum_db) && isfinite(params->maximum_db) &&
                       params->minimum_db < params->maximum_db))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "minimum_db must be a number below maximum_db, not %g and %g",
                              params->minimum_db, params->maximum_db);
    return check_altitude(report, params->altitude_m);
}

sonject_status sonject_quicklook(sonject_context *context, const sonject_quicklook_params *params)
{
    CHECK(context_begin_call(context));
    struct report *report = &context->report;
    sonject_quicklook_params taken;
    struct image_options options;
    CHECK(params_take(report, &taken, sizeof taken, params, sizeof taken, "quicklook parameters"));
    CHECK(check_quicklook(report, &taken));
    CHECK(image_options_take(report, taken.channel, taken.array, taken.transfer, taken.geometry,
                             &options));
    return draw_quicklook(report, &taken, &options, NULL, 0);
}

static sonject_status check_conversion(struct report *report, const sonject_convert_params *params)
{
    if (!params->input || !params->output)
        return null_argument(report, "input and output");
    if (params->range_axis > SONJECT_CONVERT_AXIS_GROUND)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "range_axis: no such choice");
    if (!(params->black_db < params->white_db) &&
        !(params->black_db == 0.0 && params->white_db == 0.0))
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "black_db must be below white_db, not %g and %g", params->black_db,
                              params->white_db);
    return check_altitude(report, params->altitude_m);
}

sonject_status sonject_convert(sonject_context *context, const sonject_convert_params *params)
{
    CHECK(context_begin_call(context));
    sonject_convert_params taken;
    struct image_options options;
    CHECK(params_take(&context->report, &taken, sizeof taken, params, sizeof taken,
                      "convert parameters"));
    CHECK(check_conversion(&context->report, &taken));
    CHECK(image_options_take(&context->report, taken.channel, taken.array, NULL, taken.geometry,
                             &options));
    return convert_file(&context->report, &taken, &options);
}

sonject_status sonject_seabed_write(sonject_context *context, const sonject_scene *scene,
                                    const char *path)
{
    const struct scene *used;
    CHECK(context_begin_call(context));
    if (!path)
        return null_argument(&context->report, "path");
    CHECK(scene_use(&context->report, scene, &used));
    return write_seabed(&context->report, used, path);
}
