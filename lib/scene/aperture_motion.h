/* Residual sway of the sonar along its track. */
#ifndef SONJECT_SCENE_APERTURE_MOTION_H
#define SONJECT_SCENE_APERTURE_MOTION_H

#include <stdbool.h>
#include <stddef.h>

#include <sonject/motion.h>

#include "base/report.h"

#define MOTION_SAMPLES_MAX 65536

struct aperture_motion {
    sonject_motion_params params;
    double *along_track_m, *sway_m; /* of a table; owned */
    size_t count;                   /* 0: no table */
};

/* Samples from callers; on failure *sample is the wrong one, or count, and *what says why. */
bool motion_samples_are_good(const double *along_track_m, const double *sway_m, size_t count,
                             size_t *sample, const char **what);

/* Takes a copy of good samples in place of the table. Errors: MEMORY. */
sonject_status aperture_motion_set_table(struct aperture_motion *motion, struct report *report,
                                         const double *along_track_m, const double *sway_m,
                                         size_t count);

void aperture_motion_clear(struct aperture_motion *motion);

bool aperture_motion_is_still(const struct aperture_motion *motion);

/* A length over which the sway is all but linear, m: a hundredth of its shortest scale. */
double aperture_motion_step(const struct aperture_motion *motion);

/* Sway in m at count positions start + i step along-track; a step of any sign. */
void aperture_motion_sway(const struct aperture_motion *motion, double start_m, double step_m,
                          size_t count, double *sway_m);

#endif
