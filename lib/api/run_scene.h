/* Whole runs on files, from rays or from impulses. */
#ifndef SONJECT_API_RUN_SCENE_H
#define SONJECT_API_RUN_SCENE_H

#include <sonject/run.h>

#include "api/handles.h"
#include "api/swath.h"
#include "inject/impulse_file.h"

#define LABEL_FORMATS ((uint32_t)(SONJECT_LABELS_YOLO | SONJECT_LABELS_VOC))

struct run_request {
    const struct scene *scene;
    struct impulse_file *impulses; /* NULL: they are traced */
    const char *folder;
    sonject_progress_function progress; /* may be NULL */
    void *user;
    uint32_t label_formats; /* sum of sonject_labels */
};

/* Injects and writes the folder's files: sonject_run and sonject_form. */
sonject_status run_scene(struct sonject_context *context, const struct run_request *request,
                         int *was_finished);

/* Whether scene and image are those that the impulses were traced from, but for what image
 * formation alone depends on. Errors: INPUT, MEMORY. */
sonject_status check_traced(struct report *report, const struct impulse_file *impulses,
                            const struct scene *scene, const struct swath *swath);

#endif
