/* Image files: pictures, conversions, and synthetic seabeds. */
#include <math.h>
#include <string.h>

#include <sonject/convert.h>
#include <sonject/run.h>

#include "api/handles.h"
#include "inject/swath.h"
#include "swath/conversion.h"
#include "swath/quicklook.h"

void sonject_quicklook_params_init(sonject_quicklook_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
    sonject_geometry_params_init(&params->geometry);
    sonject_transfer_params_init(&params->transfer);
    params->channel = SONJECT_CHANNEL_ONLY;
}

/* Fills in what is not given. */
static sonject_status check_quicklook(struct report *report, sonject_quicklook_params *params)
{
    const bool has_scale = params->minimum_db != 0.0 || params->maximum_db != 0.0;
    sonject_status status = SONJECT_OK;
    if (!params->image || !params->picture)
        return null_argument(report, "image and picture");
    if (params->range_axis > SONJECT_AXIS_GROUND)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "range_axis: no such choice");
    if (has_scale && !(isfinite(params->minimum_db) && isfinite(params->maximum_db) &&
                       params->minimum_db < params->maximum_db))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "minimum_db must be a number below maximum_db, not %g and %g",
                              params->minimum_db, params->maximum_db);
    if (!(params->altitude_m >= 0.0) || !isfinite(params->altitude_m))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "altitude must be a number of m above 0, not %g", params->altitude_m);
    if (params->has_geometry)
        status = check_geometry(&params->geometry, report, NULL);
    if (status == SONJECT_OK && params->has_transfer)
        status = check_transfer(&params->transfer, report, NULL);
    if (!params->has_transfer)
        sonject_transfer_params_init(&params->transfer);
    return status;
}

sonject_status sonject_quicklook(sonject_context *context, const sonject_quicklook_params *params)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    struct report *report = &context->report;
    sonject_quicklook_params taken;
    sonject_quicklook_params_init(&taken);
    CHECK(params_take(report, &taken, sizeof taken, params, sizeof taken, "quicklook parameters"));
    CHECK(check_quicklook(report, &taken));
    return draw_quicklook(report, &taken);
}

void sonject_convert_params_init(sonject_convert_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
    params->channel = SONJECT_CHANNEL_ONLY;
    params->scale = 1.0;
    sonject_geometry_params_init(&params->geometry);
}

static sonject_status check_conversion(struct report *report, const sonject_convert_params *params)
{
    if (!params->input || !params->output)
        return null_argument(report, "input and output");
    if (params->samples > SONJECT_SAMPLES_FLOAT32 ||
        params->range_axis > SONJECT_CONVERT_AXIS_GROUND)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "samples or range_axis: no such choice");
    if (!(params->scale > 0.0) || !isfinite(params->scale))
        return report_failure(report, SONJECT_ERROR_INPUT, "scale must be a number above 0, not %g",
                              params->scale);
    if (!(params->altitude_m >= 0.0) || !isfinite(params->altitude_m))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "altitude must be a number of m above 0, not %g", params->altitude_m);
    if (params->samples == SONJECT_SAMPLES_KEPT && params->scale != 1.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "a scale belongs to a type of samples: say which");
    return params->has_geometry ? check_geometry(&params->geometry, report, NULL) : SONJECT_OK;
}

sonject_status sonject_convert(sonject_context *context, const sonject_convert_params *params)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    sonject_convert_params taken;
    sonject_convert_params_init(&taken);
    CHECK(params_take(&context->report, &taken, sizeof taken, params, sizeof taken,
                      "convert parameters"));
    CHECK(check_conversion(&context->report, &taken));
    return convert_file(&context->report, &taken);
}

void sonject_seabed_file_params_init(sonject_seabed_file_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
    sonject_synthetic_params_init(&params->synthetic);
    sonject_geometry_params_init(&params->geometry);
    params->geometry.first_slant_range_m = 44.0;
    sonject_sonar_params_init(&params->sonar);
}

sonject_status sonject_seabed_write(sonject_context *context,
                                    const sonject_seabed_file_params *params)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    struct report *report = &context->report;
    sonject_seabed_file_params taken;
    sonject_seabed_file_params_init(&taken);
    CHECK(params_take(report, &taken, sizeof taken, params, sizeof taken, "seabed parameters"));
    if (!taken.image)
        return null_argument(report, "image");
    CHECK(check_synthetic(&taken.synthetic, report, NULL));
    CHECK(check_geometry(&taken.geometry, report, NULL));
    CHECK(check_sonar(&taken.sonar, report, NULL));
    struct scene scene;
    scene_init(&scene);
    scene.sonar = taken.sonar;
    scene.geometry = taken.geometry;
    scene.synthetic = taken.synthetic;
    scene.input_kind = SONJECT_INPUT_SYNTHETIC;
    return write_seabed(report, &scene, taken.image);
}
