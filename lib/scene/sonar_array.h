/* The pose of a real aperture's array. */
#ifndef SONJECT_SCENE_SONAR_ARRAY_H
#define SONJECT_SCENE_SONAR_ARRAY_H

#include <stdbool.h>

#include "scene/params.h"

/* Rows: the long side, which points ahead in the view, the beam, and the other side, in the view's
 * axes. is_mirrored: the view's. */
void sonar_array_axes(double axes[3][3], const sonject_sonar_params *sonar, bool is_mirrored);

/* Whether the long side does not lie along the track. */
bool sonar_array_is_turned(const sonject_sonar_params *sonar);

#endif
