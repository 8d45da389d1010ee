/* The sonar and its images in the plane mirrors over and under the scene. */
#ifndef SONJECT_TRACE_SOURCES_H
#define SONJECT_TRACE_SOURCES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "kernels/layout.h"
#include "medium/water.h"
#include "scene/scene.h"

#define SOURCES_MAX 15 /* the sonar, and two images for each of 1...7 bounces */

/* A source seen from an object: sound comes from it by `bounces` mirrors in turn, the last of which
 * is last_mirror. */
struct sound_source {
    struct water_way way;
    uint32_t bounces;
    enum mirror_kind last_mirror; /* of no meaning without bounces */
};

/* Whether the material has a mirror-like part, and one that scatters: of what mirrors, that is what
 * roughness takes from it. */
bool material_is_smooth(const sonject_material_params *material);
bool material_is_rough(const sonject_material_params *material);

/* Whether the scene has the mirror, and its height over the mean seabed and its material. */
bool scene_mirror(const struct scene *scene, enum mirror_kind kind, double *height_m,
                  const sonject_material_params **material);

/* Lists the sonar (first) and all of its images of up to `bounces` bounces, by bounces; returns
 * their number. water is borrowed by them. */
size_t sources_list(const struct scene *scene, const struct water *water, uint32_t bounces,
                    struct sound_source sources[SOURCES_MAX]);

#endif
