/* The sonar and its images in the plane mirrors over and under the scene. */
#ifndef SONJECT_TRACE_SOURCES_H
#define SONJECT_TRACE_SOURCES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "kernels/layout.h"
#include "scene/scene.h"

#define SOURCES_MAX 15 /* the sonar, and two images for each of 1...7 bounces */

/* A source seen from an object: sound travels to it along a straight line that is folded at
 * `bounces` mirrors in turn, from last_mirror (next to the object) outwards to the sonar. */
struct sound_source {
    double height_m; /* over the mean seabed; below it for an odd number of images in the seabed */
    uint32_t bounces;
    enum mirror_kind last_mirror; /* of no meaning without bounces */
};

/* Whether the material has a mirror-like part. */
bool material_is_smooth(const sonject_material_params *material);

/* Whether the scene has the mirror, and its height over the mean seabed and its material. */
bool scene_mirror(const struct scene *scene, enum mirror_kind kind, double *height_m,
                  const sonject_material_params **material);

/* Lists the sonar (first) and all of its images of up to `bounces` bounces, by bounces; returns
 * their number. */
size_t sources_list(const struct scene *scene, uint32_t bounces,
                    struct sound_source sources[SOURCES_MAX]);

#endif
