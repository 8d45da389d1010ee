/* One injection in memory, from a patch to a patch with objects and its truth; or to what the
 * hydrophones hear of it. */
#ifndef SONJECT_INJECT_INJECTION_H
#define SONJECT_INJECT_INJECTION_H

#include <stdbool.h>

#include <sonject/elements.h>
#include <sonject/result.h>

#include "base/report.h"
#include "device/device.h"
#include "inject/impulses.h"
#include "scene/placement.h"
#include "scene/scene.h"
#include "swath/recording.h"
#include "trace/tracer.h"

/* The patch that objects are put into. Linear; row 0 is the image's. */
struct injection_input {
    size_t rows, columns;
    double first_row, first_column; /* of the patch in the swath that the geometry describes */
    bool is_complex;
    bool is_made;        /* by sonject, so that it is what the sonar's parameters say */
    const float *pixels; /* rows x columns amplitudes, or pairs of real and imaginary part */
    const struct ping_list *empty; /* the swath's rows in the patch where nothing was heard, which
                                      show no object; NULL: none */
    double ceiling; /* amplitude from which on the image's file stores its largest number; 0: not
                       known */
    struct checkpoint *checkpoint; /* how tracing is cut; NULL: not at all */
    const struct scene *traced;    /* NULL, or the scene of another response that is traced: its
                                      grids must be fine and wide enough */
};

/* What sonject_result is. All layers rows x columns in the image's own order. */
struct injection_result {
    size_t rows, columns;
    bool is_complex;
    void *memory; /* of the layers; owned */
    float *image; /* kind of the input */
    float *field; /* pairs; m */
    float *energy, *visibility;
    float *order_energy[SCENE_INTERACTIONS_MAX]; /* as in struct echoes; each owned */
    uint32_t orders;
    uint8_t *highlight, *shadow, *labels, *influence;
    sonject_object_truth *objects; /* owned */
    uint32_t object_count;
    sonject_statistics statistics;
};

/* Progress fractions run from 0 to 1. On failure *result is empty. Errors: as sonject_inject. */
sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result);
void injection_result_clear(struct injection_result *result);

/* The first stage of it, whose impulses go to the sink. Errors: as sonject_inject, and the sink's
 * own. */
sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               const struct impulse_sink *sink, sonject_progress_function progress,
                               void *user, struct trace_counts *counts);

/* The element level of a patch: its impulses, traced as for the image, heard by hydrophones. Fills
 * *layout (not its struct_size) for a patch of the input's size; pixels are not used. Errors:
 * INPUT, MEMORY. */
sonject_status element_echoes_describe(struct report *report, const struct scene *scene,
                                       const struct injection_input *input,
                                       sonject_element_layout *layout);

/* Traces, and fills series: element_plan_samples values of the layout, pairs in base band. Progress
 * fractions run from 0 to 1. Errors: as sonject_element_series. */
sonject_status element_echoes_compute(struct report *report, struct device *device,
                                      const struct scene *scene,
                                      const struct injection_input *input,
                                      sonject_progress_function progress, void *user,
                                      const sonject_element_layout *layout, float *series);

/* Makes the pixels of the scene's uniform or synthetic input (its whole swath) and describes them
 * in *input. input->pixels is to be given to free(). Errors: MEMORY. */
sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input);

/* Patch and scene, ready for rays or for impulses. */
struct injection_setup {
    struct placements placements;
    struct water water;
    struct tracer tracer;
    float *pixels; /* in the view's order of rows and columns */
};

/* Lays the scene out without the pixels, which stay NULL: geometry, water, objects, response.
 * device may be NULL where no ray follows. All that is wrong is told, a line each. To be given to
 * injection_setup_clear, also on failure. Errors: INPUT, MEMORY. */
sonject_status injection_setup_init_scene(struct injection_setup *setup, struct report *report,
                                          struct device *device, const struct scene *scene,
                                          const struct injection_input *input);

/* The same with the pixels. */
sonject_status injection_setup_init(struct injection_setup *setup, struct report *report,
                                    struct device *device, const struct scene *scene,
                                    const struct injection_input *input);
void injection_setup_clear(struct injection_setup *setup);

#endif
