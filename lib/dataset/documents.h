/* The JSON files of a run. */
#ifndef SONJECT_DATASET_DOCUMENTS_H
#define SONJECT_DATASET_DOCUMENTS_H

#include <jansson.h>

#include "device/device.h"
#include "inject/swath.h"

struct run_facts {
    const struct scene *scene;
    const struct swath *swath;
    const struct injection_result *result;
    const struct device *device;
    const char *scene_hash; /* of scene and input: see run.c */
    json_t *inputs;         /* of what that is made */
    json_t *files;          /* that were written, as file_list_add has them */
    const char *image_name;
    uint32_t label_formats; /* sum of sonject_labels */
    double read_s, write_s, total_s;
};

/* Each writes one file, whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path);
sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path);

/* Which device that is; NULL when memory is out. */
json_t *device_document(const struct device *device);

#endif
