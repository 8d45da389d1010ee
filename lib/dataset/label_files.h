/* The files of labels in a run's folder. */
#ifndef SONJECT_DATASET_LABEL_FILES_H
#define SONJECT_DATASET_LABEL_FILES_H

#include "dataset/documents.h"

/* Writes coco.json, contacts.json, contacts.csv, and what facts->label_formats asks for, and lists
 * them in facts->files; label files of other formats that an earlier run left are removed. Errors:
 * STORAGE, MEMORY. */
sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder);

/* The names of formats (sum of sonject_labels), as run.json has them under "labels", and those that
 * a run.json names. */
json_t *labels_document(uint32_t formats);
uint32_t labels_of_document(const json_t *run);

/* Writes numbers of objects as a PNG in which each has a colour of its own. labels: of region; 0
 * everywhere else. Errors: STORAGE, MEMORY. */
sonject_status write_label_mask(struct report *report, const struct swath *swath,
                                const struct region *region, const uint8_t *labels,
                                const char *path);

#endif
