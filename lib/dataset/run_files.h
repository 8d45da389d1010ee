/* The files of a run: its images, labels and JSON. */
#ifndef SONJECT_DATASET_RUN_FILES_H
#define SONJECT_DATASET_RUN_FILES_H

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

/* Writes patch.tif, energy.tif, highlight.png, shadow.png, labels.png, influence.png, quicklook.png
 * and, where the result has them, energy_order_1.tif and so on into the folder, each whole or not
 * at all, and lists them in facts->files. Errors: STORAGE, MEMORY. */
sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder);

/* Writes coco.json, contacts.json, contacts.csv, and what facts->label_formats asks for, and lists
 * them in facts->files; label files of other formats that an earlier run left are removed. Errors:
 * STORAGE, MEMORY. */
sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder);

/* A mask of the swath's patch in an image of the swath's size, and the numbers of objects, each in
 * a colour of its own. Errors: STORAGE, MEMORY. */
sonject_status write_mask(struct report *report, const struct swath *swath, const uint8_t *mask,
                          const char *path);
sonject_status write_label_mask(struct report *report, const struct swath *swath,
                                const uint8_t *labels, const char *path);

/* The formats (sum of sonject_labels) that a run.json names. */
uint32_t labels_of_document(const json_t *run);

/* Which device that is; NULL when memory is out. */
json_t *device_document(const struct device *device);

#endif
