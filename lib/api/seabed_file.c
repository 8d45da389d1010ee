#include "api/handles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/run.h>

#include "base/memory.h"
#include "inject/injection_setup.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"

void sonject_seabed_file_params_init(sonject_seabed_file_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
    sonject_synthetic_params_init(&params->synthetic);
    sonject_geometry_params_init(&params->geometry);
    params->geometry.first_slant_range_m = 44.0;
    sonject_sonar_params_init(&params->sonar);
}

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text);
    const size_t end_length = strlen(end);
    return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

static sonject_status check_all(struct report *report, const sonject_seabed_file_params *params)
{
    if (!params->image)
        return null_argument(report, "image");
    if (!ends_with(params->image, ".tif") && !ends_with(params->image, ".png"))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: a synthetic seabed is written as .tif or .png", params->image);
    if (params->synthetic.complex_pixels && !ends_with(params->image, ".tif"))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: complex pixels need .tif",
                              params->image);
    CHECK(check_synthetic(&params->synthetic, report, NULL));
    CHECK(check_geometry(&params->geometry, report, NULL));
    return check_sonar(&params->sonar, report, NULL);
}

/* Amplitudes as 8-bit numbers, 1 = 255; in place, since they need less room. */
static void to_bytes(float *pixels, size_t count)
{
    unsigned char *bytes = (unsigned char *)pixels;
    for (size_t i = 0; i < count; i++)
        bytes[i] = (unsigned char)fminf(255.0f, floorf(pixels[i] * 255.0f + 0.5f));
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
    sonject_status status =
        params_take(report, &taken, sizeof taken, params, sizeof taken, "seabed parameters");
    THEN(status, check_all(report, &taken));
    if (status != SONJECT_OK)
        return status;
    struct scene scene;
    struct injection_input input;
    scene_init(&scene);
    scene.sonar = taken.sonar;
    scene.geometry = taken.geometry;
    scene.synthetic = taken.synthetic;
    scene.input_kind = SONJECT_INPUT_SYNTHETIC;
    status = make_input(report, &scene, &input);
    if (status == SONJECT_OK) {
        const bool is_png = ends_with(taken.image, ".png");
        const struct raster_layout layout = {input.rows, input.columns, input.is_complex ? 2 : 1,
                                             is_png ? PIXEL_UINT8 : PIXEL_FLOAT32};
        static const char *const complex_names[] = {"real", "imag"};
        struct geometry_notes notes;
        geometry_notes_init(&notes, &taken.sonar, &taken.geometry, 0.0, 0.0);
        if (is_png)
            to_bytes((float *)input.pixels, input.rows * input.columns);
        status =
            raster_file_write(report, taken.image, &layout, input.is_complex ? complex_names : NULL,
                              notes.attributes, notes.count, input.pixels);
        free((void *)input.pixels);
    }
    scene_clear(&scene);
    return status;
}
