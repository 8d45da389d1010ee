#include "inject/input_patch.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/synthetic.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"

static sonject_status make_synthetic(struct report *report, const struct scene *scene,
                                     struct injection_input *input)
{
    const sonject_synthetic_params *synthetic = &scene->synthetic;
    const double reference = scene_reference_speed(scene);
    struct point_response response;
    point_response_init(&response, &scene->sonar, reference, scene->geometry.row_spacing_m);
    input->is_complex = synthetic->complex_pixels != 0;
    float *pixels = allocate_array((size_t)synthetic->rows * synthetic->columns,
                                   (input->is_complex ? 2 : 1) * sizeof *pixels);
    CHECK_MEMORY(report, pixels, "the synthetic seabed");
    const sonject_status status =
        synthesise_seabed(report, synthetic, &scene->geometry, response.resolution_m,
                          reference / (2.0 * scene->sonar.bandwidth_hz), pixels);
    if (status != SONJECT_OK)
        free(pixels);
    else
        input->pixels = pixels;
    return status;
}

sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input)
{
    memset(input, 0, sizeof *input);
    input->is_made = true;
    if (scene->input_kind == SONJECT_INPUT_SYNTHETIC) {
        input->rows = scene->synthetic.rows;
        input->columns = scene->synthetic.columns;
        return make_synthetic(report, scene, input);
    }
    input->rows = scene->uniform_rows;
    input->columns = scene->uniform_columns;
    const size_t count = input->rows * input->columns;
    float *pixels = allocate_array(count, sizeof *pixels);
    CHECK_MEMORY(report, pixels, "the uniform seabed");
    for (size_t i = 0; i < count; i++)
        pixels[i] = 1.0f;
    input->pixels = pixels;
    return SONJECT_OK;
}
