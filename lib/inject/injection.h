/* One injection in memory, from a patch to a patch with objects and its truth; or to what the
 * hydrophones hear of it. */
#ifndef SONJECT_INJECT_INJECTION_H
#define SONJECT_INJECT_INJECTION_H

#include <stdbool.h>

#include <sonject/elements.h>
#include <sonject/result.h>

#include "base/report.h"
#include "device/device.h"
#include "image/raster.h"
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
    const struct pilots *pilots;   /* that told the number of rays; NULL: none did yet */
    bool is_whole;              /* all of the patch is traced, whatever objects can change of it */
    const struct scene *traced; /* NULL, or the scene of another response that is traced: its
                                   grids must be fine and wide enough */
};

/* What is made of a window of the patch, or of all of it. All layers at.rows x at.columns.
 */
struct injected_window {
    struct window at; /* in the patch */
    bool is_complex;
    void *memory; /* of field, energy and visibility; owned */
    float *field; /* pairs; m */
    float *energy, *visibility;
    float *order_energy[SCENE_INTERACTIONS_MAX]; /* as in struct echoes; each owned */
    void *picture; /* memory of image and masks; owned; NULL once they are in the result's */
    float *image;  /* kind of the input */
    uint8_t *highlight, *shadow, *labels, *influence;
    sonject_object_truth *objects; /* borrowed: the result's */
};

/* What sonject_result is. Image and masks rows x columns in the image's own order. */
struct injection_result {
    size_t rows, columns;
    bool is_complex;
    float *image; /* kind of the input; owned, as all of these */
    uint8_t *highlight, *shadow, *labels, *influence;
    struct injected_window *windows; /* whose other layers are kept; owned */
    size_t window_count;
    float *seabed_energy; /* expected of plain seabed outside the windows, m^2; a column each */
    uint32_t orders;
    sonject_object_truth *objects;
    uint32_t object_count;
    sonject_statistics statistics;
};

/* Room for all but the image, of a patch of the tracer's view; to be given to
 * injection_result_clear, also on failure. Errors: MEMORY. */
sonject_status injection_result_init(struct injection_result *result, const struct tracer *tracer,
                                     size_t windows, bool is_complex);

/* Room for a window's layers, which its result frees. Errors: MEMORY. */
sonject_status injected_window_init(struct injected_window *window, struct report *report,
                                    const struct window *at, bool is_complex,
                                    sonject_object_truth *objects);

/* Moves the window's picture and masks into the patch's, and counts its changed pixels. */
void injection_result_paste(struct injection_result *result, struct injected_window *window);

/* An object's place from the window's pixels to the patch's. */
void object_truth_move(sonject_object_truth *truth, const struct window *at);

/* From the view's order of rows and columns back into the image's. */
void injection_result_turn_back(struct injection_result *result, const struct patch_view *view);

/* Progress fractions run from 0 to 1. On failure *result is empty. Errors: as sonject_inject. */
sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result);
void injection_result_clear(struct injection_result *result);

/* Layers that are kept in windows: float, FIELD pairs of it; ORDER + k of k + 1 interactions. */
enum injected_plane {
    INJECTED_FIELD,
    INJECTED_ENERGY,
    INJECTED_VISIBILITY,
    INJECTED_ORDER
};

/* Fills rows x columns pixels of the patch: outside the windows there is no field, the seabed is
 * plain and seen. */
void injection_result_plane(const struct injection_result *result, enum injected_plane plane,
                            float *out);

/* The first stage of it by the scene's own number of rays, kept by the input's checkpoint. Errors:
 * as sonject_inject. */
sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               sonject_progress_function progress, void *user);

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

/* Of the swath that the scene makes itself, uniform or synthetic; without rows where it makes none.
 */
struct raster_layout made_layout(const struct scene *scene);

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
