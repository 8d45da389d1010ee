/* The cross-range response of a synthetic aperture whose sonar did not keep to the track: complex,
 * and another one for each track position. Formulas: kernels/MATH.md, "Point response". */
#ifndef SONJECT_SCENE_MOTION_RESPONSE_H
#define SONJECT_SCENE_MOTION_RESPONSE_H

#include "base/report.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"

/* Work of one grid of distances. */
struct motion_response {
    const struct point_response *response; /* borrowed */
    const struct patch_view *view;         /* borrowed */
    double strip_m, offset_m;              /* distances are j strip_m + offset_m */
    int reach;                             /* j from -reach to reach */
    size_t aspects;                        /* of the transform, a power of two */
    double *root_real, *root_imaginary, *real_part, *imaginary_part; /* owned */
    double *heard; /* what elements hear at the distances, over what they hear at 0; owned */
    double first_m, length_m; /* the track that the aperture of all rows holds */
    double sway_step_m;       /* from first_m on */
    double *sway_m;           /* owned */
    size_t sways;
    double advance_m, first_ping; /* a ping's number is its place along-track over the advance */
    double *yaw_rad;              /* of pings; owned */
    size_t pings;                 /* 0: no yaw */
};

/* Prepares responses of rows of the view at the distances. To be given to motion_response_end on
 * success. Errors: INPUT (too many pings, motion over too short scales), MEMORY.
 */
sonject_status motion_response_begin(struct motion_response *motion, struct report *report,
                                     const struct point_response *response,
                                     const struct patch_view *view, double strip_m, double offset_m,
                                     int reach);
void motion_response_end(struct motion_response *motion);

/* W of pixels of a row, at the 2 reach + 1 distances. */
void motion_response_row(struct motion_response *motion, double row, double *real_part,
                         double *imaginary_part);

/* The same if elements heard all around: its energy is that of the straight W. */
void motion_response_row_all_around(struct motion_response *motion, double row, double *real_part,
                                    double *imaginary_part);

/* How much farther than the window's response the energy of the moved one reaches, m, over nine
 * rows of the view: into response->motion_spread_m, for motion_spread; and, on average, how much of
 * the window's energy elements hear of it: motion_energy_share. Errors: INPUT (it reaches
 * farther than responses are worked out), MEMORY. */
sonject_status motion_response_spread(struct report *report, struct point_response *response,
                                      const struct patch_view *view);

/* The same, where `share` of the energy may lie beyond; 0 without motion. */
double motion_spread(const struct point_response *response, double share);

#endif
