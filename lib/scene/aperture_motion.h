/* Residual motion of the sonar along its track: its sway, and the yaw of its array. */
#ifndef SONJECT_SCENE_APERTURE_MOTION_H
#define SONJECT_SCENE_APERTURE_MOTION_H

#include <stdbool.h>
#include <stddef.h>

#include "scene/params.h"

#include "base/report.h"

#define MOTION_SAMPLES_MAX 65536
#define SWAY_MAX_M         1e3
#define YAW_MAX_RAD        0.1 /* its sine is the angle to 2 parts in 1000 */
#define SCALE_MIN_M        0.1 /* sway from one centimetre to the next is no motion of a sonar */
#define SCALE_MAX_M        1e6

/* Linear between its samples, constant beyond. */
struct motion_table {
    double *along_track_m, *values; /* owned */
    size_t count;                   /* 0: no table */
};

struct aperture_motion {
    sonject_motion_params params;
    struct motion_table sway_table, yaw_table;
};

/* Takes a copy of samples, whose positions rise, in place of the table's. Errors: MEMORY. */
sonject_status motion_table_set(struct motion_table *table, struct report *report,
                                const double *along_track_m, const double *values, size_t count);

/* Of both tables. */
void aperture_motion_clear(struct aperture_motion *motion);

/* Whether there is yaw, which then has an advance; and whether there is no motion at all. */
bool aperture_motion_has_yaw(const struct aperture_motion *motion);
bool aperture_motion_is_still(const struct aperture_motion *motion);

/* A length over which the sway is all but linear, m: a hundredth of its shortest scale. */
double aperture_motion_step(const struct aperture_motion *motion);

/* Sway in m, or yaw in rad, at count positions start + i step along-track; a step of any sign. */
void aperture_motion_sway(const struct aperture_motion *motion, double start_m, double step_m,
                          size_t count, double *sway_m);
void aperture_motion_yaw(const struct aperture_motion *motion, double start_m, double step_m,
                         size_t count, double *yaw_rad);

#endif
