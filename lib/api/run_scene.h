/* Whole runs on files, from rays or from impulses. */
#ifndef SONJECT_API_RUN_SCENE_H
#define SONJECT_API_RUN_SCENE_H

#include <sonject/run.h>
#include <sonject/stages.h>

#include "api/handles.h"
#include "inject/checkpoints.h"
#include "inject/swath.h"

#define LABEL_FORMATS ((uint32_t)(SONJECT_LABELS_YOLO | SONJECT_LABELS_VOC))

/* Injects and writes the folder's files: sonject_run and sonject_form. */
sonject_status run_scene(struct sonject_context *context, const struct run_request *request,
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

#endif
