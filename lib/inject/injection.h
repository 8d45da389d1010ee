/* One injection in memory: from a patch to the patch with objects and its truth, or to the series
 * that hydrophones hear. */
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

/* The patch that objects are put into, in linear amplitudes and the image's order of rows. */
struct injection_input {
    size_t rows, columns;
    double first_row, first_column; /* place of the patch in the swath of the geometry */
    bool is_complex;
    bool is_made;        /* made by sonject: the sonar's parameters hold */
    const float *pixels; /* rows x columns amplitudes, or pairs of real and imaginary part */
    const struct ping_list *empty; /* rows of the swath in the patch where nothing was heard, which
                                      show no object; NULL: none */
    double ceiling; /* amplitude of the largest number that the image's file stores; 0: unknown */
    struct checkpoint *checkpoint; /* takes a part of the tracing; NULL: all is traced */
    const struct pilots *pilots;   /* pilots that told the number of rays; NULL: none yet */
    bool is_whole;                 /* all of the patch is traced, not only windows */
    const struct scene *traced; /* scene of another response, whose rays are traced; its grids must
                                   be fine and wide enough; NULL: the same scene */
};

/* The layers of a window of the patch, or of all of it. Each has at.rows x at.columns pixels. */
struct injected_window {
    struct window at; /* place in the patch */
    bool is_complex;
    void *memory; /* memory of field, energy and visibility; owned */
    float *field; /* pairs of real and imaginary part; m */
    float *energy, *visibility;
    float *order_energy[SCENE_INTERACTIONS_MAX]; /* energies as in struct echoes; each owned */
    void *picture; /* memory of image and masks; owned; NULL once they are pasted into the result */
    float *image;  /* amplitudes or pairs, as the input */
    uint8_t *highlight, *shadow, *labels, *influence;
    sonject_object_truth *objects; /* borrowed: the result's */
};

/* The contents of a sonject_result. Masks and image: rows x columns in the image's order. */
struct injection_result {
    size_t rows, columns;
    bool is_complex;
    float *image;   /* amplitudes or pairs, as the input; owned, as are all members */
    double ceiling; /* largest amplitude that the image's file stores, or that is not saturated */
    uint8_t *highlight, *shadow, *labels, *influence;
    struct injected_window *windows; /* their other layers are kept; owned */
    size_t window_count;
    float *seabed_energy; /* expected energy of plain seabed outside windows, m^2; one a column */
    uint32_t orders;
    sonject_object_truth *objects;
    uint32_t object_count;
    sonject_statistics statistics;
};

/* Allocates all but the image, for a patch of the tracer's view. The caller gives the result to
 * injection_result_clear, also on failure. Errors: MEMORY. */
sonject_status injection_result_init(struct injection_result *result, const struct tracer *tracer,
                                     size_t windows, bool is_complex);

/* Allocates a window's layers, which the result frees. Errors: MEMORY. */
sonject_status injected_window_init(struct injected_window *window, struct report *report,
                                    const struct window *at, bool is_complex,
                                    sonject_object_truth *objects);

/* Moves the window's picture and masks into the patch's, and counts its changed pixels. */
void injection_result_paste(struct injection_result *result, struct injected_window *window);

/* Moves an object's place from the window's pixels to the patch's. */
void object_truth_move(sonject_object_truth *truth, const struct window *at);

/* Turns a result from the view's order of rows and columns back into the image's. */
void injection_result_turn_back(struct injection_result *result, const struct patch_view *view);

/* Runs an injection. Progress fractions run from 0 to 1. On failure *result is empty. Errors: as
 * sonject_inject. */
sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result);
void injection_result_clear(struct injection_result *result);

/* The layers that windows keep: floats, FIELD in pairs. ORDER + k has k + 1 interactions. */
enum injected_plane {
    INJECTED_FIELD,
    INJECTED_ENERGY,
    INJECTED_VISIBILITY,
    INJECTED_ORDER
};

/* Fills a layer of rows x columns pixels of the patch. Outside the windows there is no field, and
 * the seabed is plain and visible. */
void injection_result_plane(const struct injection_result *result, enum injected_plane plane,
                            float *out);

/* Traces the impulses alone, by the scene's own number of rays, into the input's checkpoint.
 * Errors: as sonject_inject. */
sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               sonject_progress_function progress, void *user);

/* The element level of a patch: hydrophones hear its impulses, which are traced as for the image.
 * Fills *layout (not struct_size) for a patch of the input's size. Pixels are not used. Errors:
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

/* Returns the layout of the uniform or synthetic swath that the scene makes itself. The layout has
 * no rows where the scene makes none. */
struct raster_layout made_layout(const struct scene *scene);

/* Makes the pixels of the scene's whole uniform or synthetic swath and describes them in *input.
 * The caller frees input->pixels by free(). Errors: MEMORY. */
sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input);

/* A patch and its scene, ready for rays or for impulses. */
struct injection_setup {
    struct placements placements;
    struct water water;
    struct tracer tracer;
    float *pixels; /* in the view's order of rows and columns */
};

/* Lays the scene out without the pixels, which stay NULL: geometry, water, objects, response.
 * device may be NULL where no ray follows. Reports all faults, a line each. The caller gives the
 * setup to injection_setup_clear, also on failure. Errors: INPUT, MEMORY. */
sonject_status injection_setup_init_scene(struct injection_setup *setup, struct report *report,
                                          struct device *device, const struct scene *scene,
                                          const struct injection_input *input);

/* Lays the scene out as injection_setup_init_scene does, with the pixels. */
sonject_status injection_setup_init(struct injection_setup *setup, struct report *report,
                                    struct device *device, const struct scene *scene,
                                    const struct injection_input *input);
void injection_setup_clear(struct injection_setup *setup);

#endif
