/* Labels as YOLO's programs read them: a line a contact, its class and box as fractions of the
 * image. */
#ifndef SONJECT_LABEL_YOLO_H
#define SONJECT_LABEL_YOLO_H

#include "label/class_names.h"
#include "label/image_labels.h"

/* Writes "class centre_x centre_y width height" of each contact of which something is seen, x along
 * the columns; class: its number among the classes. Errors: STORAGE, MEMORY. */
sonject_status yolo_write(struct report *report, const struct image_labels *labels,
                          struct class_names *classes, const char *path);

#endif
