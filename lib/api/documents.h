/* The JSON files of a run. */
#ifndef SONJECT_API_DOCUMENTS_H
#define SONJECT_API_DOCUMENTS_H

#include <jansson.h>

#include "api/swath.h"
#include "cl/device.h"

struct run_facts {
    const struct scene *scene;
    const struct swath *swath;
    const struct injection_result *result;
    const struct device *device;
    const char *scene_hash; /* of scene and input: see run.c */
    const char *image_name;
    uint32_t label_formats; /* sum of sonject_labels */
    double read_s, write_s, total_s;
};

/* Each writes one file, whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path);
sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path);

/* Which device that is; NULL when memory is out. */
json_t *device_document(const struct device *device);

/* Whether a run's results are in the folder: run.json, the last of them. */
bool folder_has_result(const char *folder);

/* The formats of labels that the run's results in the folder have. */
uint32_t labels_of_result(const char *folder);

/* The run.json at path, for json_decref; NULL where there is none that can be read. */
json_t *run_document(const char *path);

/* True if path is the run.json of a finished run with that hash and at least those labels. */
bool run_is_finished(const char *path, const char *scene_hash, uint32_t label_formats);

#endif
