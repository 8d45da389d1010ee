#include "api/handles.h"

#include <stdlib.h>
#include <string.h>

#include <sonject/elements.h>

#include "inject/injection.h"
#include "scene/element_plan.h"

sonject_status sonject_elements_describe(sonject_context *context, const sonject_scene *handle,
                                         uint64_t rows, uint64_t columns,
                                         sonject_element_layout *layout)
{
    CHECK(context_begin_call(context));
    struct report *report = &context->report;
    const struct scene *scene;
    CHECK(scene_use(report, handle, &scene));
    if (rows > SWATH_PIXELS_MAX || columns > SWATH_PIXELS_MAX || rows * columns > SWATH_PIXELS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT, "a patch has at most 2^31 pixels");
    const struct raster_layout own = made_layout(scene);
    const bool is_own = rows == 0 && columns == 0;
    struct injection_input input;
    memset(&input, 0, sizeof input);
    input.rows = (size_t)(is_own ? own.rows : rows);
    input.columns = (size_t)(is_own ? own.columns : columns);
    input.is_complex = true; /* the kind of pixels does not change the geometry */
    sonject_element_layout made;
    memset(&made, 0, sizeof made);
    CHECK(element_echoes_describe(report, scene, &input, &made));
    return params_give(report, layout, &made, sizeof made, sizeof made, "element layout");
}

static sonject_status check_bytes(struct report *report, const sonject_element_layout *layout,
                                  size_t bytes)
{
    const size_t parts = layout->elements.form == SONJECT_SERIES_BASEBAND ? 2 : 1;
    const size_t wanted = element_plan_samples(layout) * parts * sizeof(float);
    if (bytes == wanted)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_ARGUMENT,
                          "the series take %zu bytes, the buffer has %zu", wanted, bytes);
}

sonject_status sonject_element_series(sonject_context *context, const sonject_scene *handle,
                                      const sonject_pixels *pixels,
                                      sonject_progress_function progress, void *user, float *series,
                                      size_t bytes)
{
    CHECK(context_begin_call(context));
    context_watch(context, &progress, &user);
    struct report *report = &context->report;
    const struct scene *scene;
    CHECK(scene_use(report, handle, &scene));
    if (!series)
        return null_argument(report, "series");
    struct swath swath;
    struct device *device = NULL;
    sonject_element_layout layout;
    sonject_status status = find_input(report, scene, pixels, &swath);
    const struct injection_input input = swath_input(&swath);
    THEN(status, element_echoes_describe(report, scene, &input, &layout));
    THEN(status, check_bytes(report, &layout, bytes));
    THEN(status, device_slot_open(report, &context->device, &device));
    THEN(status,
         element_echoes_compute(report, device, scene, &input, progress, user, &layout, series));
    swath_close(&swath);
    return context_finish(context, status);
}
