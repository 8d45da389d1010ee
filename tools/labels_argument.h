/* --labels: formats by name. */
#ifndef SONJECT_TOOLS_LABELS_ARGUMENT_H
#define SONJECT_TOOLS_LABELS_ARGUMENT_H

#include <stdbool.h>
#include <stdint.h>

#define LABELS_HELP "label files beside coco.json: yolo, voc, or both"

/* Reads names with commas between them into a sum of sonject_labels; text NULL: 0. On failure
 * prints a message. verb: for that. */
bool labels_parse(const char *verb, const char *text, uint32_t *labels);

#endif
