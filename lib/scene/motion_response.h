/* The cross-range response of a synthetic aperture whose sonar left the straight track. It is
 * complex and differs with the track position. Formulas: kernels/MATH.md, "Point response". */
#ifndef SONJECT_SCENE_MOTION_RESPONSE_H
#define SONJECT_SCENE_MOTION_RESPONSE_H

#include "base/report.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"

/* The work space of one grid of distances. */
struct motion_response {
    const struct point_response *response; /* borrowed */
    const struct patch_view *view;         /* borrowed */
    double strip_m, offset_m;              /* distances are j strip_m + offset_m */
    int reach;                             /* j from -reach to reach */
    size_t aspects;                        /* size of the transform, a power of two */
    double *root_real, *root_imaginary, *real_part, *imaginary_part; /* owned */
    double *heard; /* the share that elements hear at the distances, over that at 0; owned */
    double first_m, length_m; /* start and length of the track that all rows' apertures cover */
    double sway_step_m;       /* step of sway_m from first_m on */
    double *sway_m;           /* owned */
    size_t sways;
    double advance_m, first_ping; /* a ping's number is its place along-track over the advance */
    double *yaw_rad;              /* yaw of each ping; owned */
    size_t pings;                 /* 0: no yaw */
};

/* Prepares responses of rows of the view at the distances. On success to be given to
 * motion_response_end. Errors: INPUT (too many pings, motion over too short scales), MEMORY. */
sonject_status motion_response_begin(struct motion_response *motion, struct report *report,
                                     const struct point_response *response,
                                     const struct patch_view *view, double strip_m, double offset_m,
                                     int reach);
void motion_response_end(struct motion_response *motion);

/* Computes W of a row's pixels at the 2 reach + 1 distances. */
void motion_response_row(struct motion_response *motion, double row, double *real_part,
                         double *imaginary_part);

/* Does the same for elements that hear all around. The energy is then that of the straight W. */
void motion_response_row_all_around(struct motion_response *motion, double row, double *real_part,
                                    double *imaginary_part);

/* Measures over nine rows of the view how much farther the energy of the moved response reaches
 * than the window's, m, into response->motion_spread_m for motion_spread. Sets motion_energy_share
 * to the mean share of the window's energy that elements hear. Errors: INPUT (the energy reaches
 * farther than responses are computed), MEMORY. */
sonject_status motion_response_spread(struct report *report, struct point_response *response,
                                      const struct patch_view *view);

/* Returns that spread in m where `share` of the energy may lie beyond; 0 without motion. */
double motion_spread(const struct point_response *response, double share);

#endif
