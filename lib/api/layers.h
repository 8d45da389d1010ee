/* The image files of a run. */
#ifndef SONJECT_API_LAYERS_H
#define SONJECT_API_LAYERS_H

#include "api/swath.h"

/* Writes patch.tif, energy.tif, highlight.png, shadow.png, labels.png, influence.png, quicklook.png
 * and, where the result has them, energy_order_1.tif and so on into the folder, each whole or not
 * at all. Errors: STORAGE, MEMORY. */
sonject_status write_layers(struct report *report, const struct scene *scene,
                            const struct swath *swath, const struct injection_result *result,
                            const char *folder);

#endif
