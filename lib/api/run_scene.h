/* Whole runs on files, from rays or from impulses. */
#ifndef SONJECT_API_RUN_SCENE_H
#define SONJECT_API_RUN_SCENE_H

#include <sonject/run.h>
#include <sonject/stages.h>

#include "api/handles.h"
#include "api/kept_scene.h"
#include "api/swath.h"
#include "inject/impulse_file.h"

#define LABEL_FORMATS ((uint32_t)(SONJECT_LABELS_YOLO | SONJECT_LABELS_VOC))

struct run_request {
    const struct scene *scene;
    const struct scene_source *source; /* of the scene; kept with what is traced */
    struct impulse_file *impulses;     /* NULL: they are traced */
    uint32_t shard, shards;            /* 1...shards; shards 0: all is traced */
    bool merges;                       /* nothing is traced: all shards' tallies are there */
    double exit_after_s;               /* 0: never */
    double checkpoint_s;
    const char *folder;
    sonject_progress_function progress; /* may be NULL */
    void *user;
    uint32_t label_formats; /* sum of sonject_labels */
    bool overwrites;        /* another result in the folder may be given up */
};

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
