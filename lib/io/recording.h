/* What a recording says of where its pixels lie. */
#ifndef SONJECT_IO_RECORDING_H
#define SONJECT_IO_RECORDING_H

#include "base/report.h"
#include "scene/scene.h"

/* Takes the scene's geometry (takes_geometry) and the sonar's altitude (takes_altitude) from its
 * input, an XTF file: spacing and altitude are the means over the patch's rows. Errors: INPUT (not
 * an XTF file; no positions, no altitude: says what to give instead; as xtf_file_open), STORAGE,
 * MEMORY. On failure the scene is unchanged. */
sonject_status recording_describe(struct report *report, bool takes_geometry, bool takes_altitude,
                                  struct scene *scene);

#endif
