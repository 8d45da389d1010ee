/* One injection in memory, from a patch to a patch with objects and its truth. */
#ifndef SONJECT_INJECT_INJECTION_H
#define SONJECT_INJECT_INJECTION_H

#include <stdbool.h>

#include <sonject/result.h>

#include "base/report.h"
#include "device/device.h"
#include "inject/impulses.h"
#include "scene/placement.h"
#include "scene/scene.h"
#include "trace/tracer.h"

/* The patch that objects are put into. Linear; row 0 is the image's. */
struct injection_input {
    size_t rows, columns;
    double first_row, first_column; /* of the patch in the swath that the geometry describes */
    bool is_complex;
    bool is_made;        /* by sonject, so that it is what the sonar's parameters say */
    const float *pixels; /* rows x columns amplitudes, or pairs of real and imaginary part */
    struct checkpoint *checkpoint; /* how tracing is cut; NULL: not at all */
};

/* What sonject_result is. All layers rows x columns in the image's row order; owned. */
struct injection_result {
    size_t rows, columns;
    bool is_complex;
    float *image; /* kind of the input */
    float *field; /* pairs; m */
    float *energy, *visibility;
    float *order_energy[SCENE_INTERACTIONS_MAX]; /* as in struct echoes */
    uint32_t orders;
    uint8_t *highlight, *shadow, *labels, *influence;
    sonject_object_truth *objects;
    uint32_t object_count;
    sonject_statistics statistics;
};

/* Progress fractions run from 0 to 1. On failure *result is empty. Errors: as sonject_inject. */
sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result);
void injection_result_clear(struct injection_result *result);

/* The two stages of it. injection_trace hands the impulses to sink; injection_form makes the result
 * of those that source gives, which must be of the same scene and patch. Errors: as sonject_inject,
 * and those of sink and source. */
sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               const struct impulse_sink *sink, sonject_progress_function progress,
                               void *user, struct trace_counts *counts);
sonject_status injection_form(struct report *report, struct device *device,
                              const struct scene *scene, const struct injection_input *input,
                              const struct impulse_source *source,
                              sonject_progress_function progress, void *user,
                              struct injection_result *result);

#endif
