/* What the sea surface does with sound. */
#ifndef SONJECT_SCENE_SURFACE_MATERIAL_H
#define SONJECT_SCENE_SURFACE_MATERIAL_H

#include "scene/params.h"

/* The surface's material, with a number for a glossy_albedo that is NaN: all that lambert leaves of
 * what roughness takes from the mirror. */
sonject_material_params surface_material(const sonject_surface_params *surface);

#endif
