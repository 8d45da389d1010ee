/* Whole runs on files: from rays, from impulses that were kept, or from shards. */
#ifndef SONJECT_DATASET_RUN_H
#define SONJECT_DATASET_RUN_H

#include <sonject/run.h>
#include <sonject/stages.h>

#include "device/device.h"
#include "inject/checkpoints.h"
#include "inject/swath.h"

#define LABEL_FORMATS ((uint32_t)(SONJECT_LABELS_YOLO | SONJECT_LABELS_VOC))

/* Injects and writes the folder's files: sonject_run. was_finished may be NULL. */
sonject_status run_scene(struct report *report, struct device_slot *slot,
                         const struct run_request *request, int *was_finished);

/* News of the noise floor, where it was estimated. */
void tell_noise_floor(struct report *report, const struct scene *scene,
                      const sonject_statistics *statistics);

/* Traces the scene and writes its impulses: sonject_trace. source: of the scene. */
sonject_status trace_scene(struct report *report, struct device_slot *slot,
                           const struct scene *scene, const struct scene_source *source,
                           const sonject_trace_params *params, sonject_progress_function progress,
                           void *user);

/* Forms the image of what was traced: sonject_form. scene: NULL for that whose text is kept. The
 * request has the folder, and what is asked of it. */
sonject_status form_scene(struct report *report, struct device_slot *slot,
                          const struct scene *scene, const sonject_form_params *params,
                          const struct run_request *request, int *was_finished);

/* Makes the result of all shards in the request's folder, whose scene they keep: sonject_merge; of
 * bands, where there are such, each in its folder. */
sonject_status merge_folder(struct report *report, struct device_slot *slot,
                            const struct run_request *request, bool allows_user_shapes,
                            int *was_finished);

/* Whether scene and image are those that the impulses were traced from, but for what image
 * formation alone depends on. Errors: INPUT, MEMORY. */
sonject_status check_traced(struct report *report, const struct impulse_file *impulses,
                            const struct scene *scene, const struct swath *swath);

/* Reads the scene whose text a file keeps, with the overrides of params, whose file is for the
 * message. Names of files are meant from where it was traced. scene is the caller's for
 * scene_clear, also on failure. Errors: INPUT, STORAGE, MEMORY. */
sonject_status read_traced_scene(struct report *report, const struct kept_scene *kept,
                                 const sonject_form_params *params, struct scene *scene);

/* What the hydrophones hear of the scene's input, into the folder: sonject_elements_run. */
sonject_status run_elements(struct report *report, struct device_slot *slot,
                            const struct scene *scene, const sonject_run_params *params,
                            sonject_progress_function progress, void *user);

/* The scene's geometry as a text with a drawing, for free(): sonject_check. */
sonject_status describe_scene(struct report *report, struct device_slot *slot,
                              const struct scene *scene, char **text);

#endif
