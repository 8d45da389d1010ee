/* Labels as Pascal VOC writes them: XML, whole pixels counted from 1. */
#ifndef SONJECT_LABEL_VOC_H
#define SONJECT_LABEL_VOC_H

#include "label/image_labels.h"

/* Writes the box of each contact of which something is seen. Errors: STORAGE, MEMORY. */
sonject_status voc_write(struct report *report, const struct image_labels *labels,
                         const char *path);

#endif
