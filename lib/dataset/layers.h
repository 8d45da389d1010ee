/* The image files of a run. */
#ifndef SONJECT_DATASET_LAYERS_H
#define SONJECT_DATASET_LAYERS_H

#include "dataset/documents.h"

/* Writes patch.tif, energy.tif, highlight.png, shadow.png, labels.png, influence.png, quicklook.png
 * and, where the result has them, energy_order_1.tif and so on into the folder, each whole or not
 * at all, and lists them in facts->files. Errors: STORAGE, MEMORY. */
sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder);

#endif
