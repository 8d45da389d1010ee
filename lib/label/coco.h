/* COCO annotations of any number of images: boxes, and masks as runs. */
#ifndef SONJECT_LABEL_COCO_H
#define SONJECT_LABEL_COCO_H

#include <jansson.h>

#include "label/class_names.h"
#include "label/image_labels.h"

/* Starts as all zeros. */
struct coco {
    json_t *images, *annotations; /* owned */
    uint64_t image_count, annotation_count;
};

/* Adds an image, the next in number from 1, and an annotation for each contact of which something
 * is seen. Category numbers are those of the classes, from 1. Errors: MEMORY. */
sonject_status coco_add(struct coco *coco, struct report *report, const struct image_labels *labels,
                        struct class_names *classes);

/* Writes all that was added, and clears it. Errors: STORAGE, MEMORY. */
sonject_status coco_write(struct coco *coco, struct report *report,
                          const struct class_names *classes, const char *path);
void coco_clear(struct coco *coco);

#endif
