/* What the input file says of where its pixels lie. */
#ifndef SONJECT_SWATH_RECORDING_H
#define SONJECT_SWATH_RECORDING_H

#include "base/report.h"
#include "scene/scene.h"

/* Takes the scene's geometry (takes_geometry) and the sonar's altitude (takes_altitude) from its
 * input: an XTF file, of which spacing and altitude are the means over the patch's rows, or an
 * image whose notes say them (swath/geometry_notes.h). Errors: INPUT (it does not say them: says
 * what to give instead; ground range; as swath_file_open_array), UNSUPPORTED, STORAGE, MEMORY. On
 * failure the scene is unchanged, and *key is the key of the scene that the message is about. */
sonject_status recording_describe(struct report *report, bool takes_geometry, bool takes_altitude,
                                  struct scene *scene, const char **key);

#endif
