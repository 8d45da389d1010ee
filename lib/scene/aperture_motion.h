/* Residual motion of the sonar along its track: the sway, and the yaw of its array. */
#ifndef SONJECT_SCENE_APERTURE_MOTION_H
#define SONJECT_SCENE_APERTURE_MOTION_H

#include <stdbool.h>
#include <stddef.h>

#include "scene/params.h"

#include "base/report.h"

#define MOTION_SAMPLES_MAX 65536
#define SWAY_MAX_M         1e3
#define YAW_MAX_RAD        0.1 /* up to it sine and angle agree to 2 parts in 1000 */
#define SCALE_MIN_M        0.1 /* changes over shorter scales are no motion of a sonar */
#define SCALE_MAX_M        1e6

/* Samples of a motion, linear between them and constant beyond them. */
struct motion_table {
    double *along_track_m, *values; /* owned */
    size_t count;                   /* 0: no table */
};

struct aperture_motion {
    sonject_motion_params params;
    struct motion_table sway_table, yaw_table;
};

/* Replaces the table by a copy of samples, whose positions rise. Errors: MEMORY. */
sonject_status motion_table_set(struct motion_table *table, struct report *report,
                                const double *along_track_m, const double *values, size_t count);

/* Frees both tables. */
void aperture_motion_clear(struct aperture_motion *motion);

/* Return whether there is yaw, which then has an advance, and whether there is no motion at all. */
bool aperture_motion_has_yaw(const struct aperture_motion *motion);
bool aperture_motion_is_still(const struct aperture_motion *motion);

/* Returns a length over which the sway is nearly linear, m: a hundredth of its shortest scale. */
double aperture_motion_step(const struct aperture_motion *motion);

/* Compute the sway in m, or the yaw in rad, at count positions start + i step along-track. The step
 * may have any sign. */
void aperture_motion_sway(const struct aperture_motion *motion, double start_m, double step_m,
                          size_t count, double *sway_m);
void aperture_motion_yaw(const struct aperture_motion *motion, double start_m, double step_m,
                         size_t count, double *yaw_rad);

#endif
