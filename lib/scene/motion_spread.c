/* How far along the track residual motion spreads echoes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/motion_response.h"

#define SPREAD_ROWS  9
#define SPREAD_REACH 2048 /* resolutions to each side that a spread is looked for in */

/* Of |W|^2 that may lie beyond: at the patch's edges, beyond margins, beyond taps. */
static const double spread_shares[MOTION_SHARES] = {0.04, MARGIN_ENERGY_SHARE, 0.001};

/* Distances within which all but `share` of a row's energy lies; the whole reach where more lies
 * beyond. */
static double reach_of_row(const struct motion_response *motion, const double *real_part,
                           const double *imaginary_part, double share)
{
    const double total = along_track_energy_width(motion->response) / motion->strip_m;
    double inside = 0.0;
    for (int j = 0; j <= motion->reach; j++)
        for (int side = -1; side <= (j > 0 ? 1 : -1); side += 2) {
            const int at = motion->reach + side * j;
            inside += real_part[at] * real_part[at] + imaginary_part[at] * imaginary_part[at];
            if (inside >= (1.0 - share) * total)
                return j * motion->strip_m;
        }
    return motion->reach * motion->strip_m;
}

static sonject_status spread_row(const struct motion_response *motion, struct report *report,
                                 const double *real_part, const double *imaginary_part,
                                 double spread_m[MOTION_SHARES])
{
    for (int s = 0; s < MOTION_SHARES; s++) {
        const double reach = reach_of_row(motion, real_part, imaginary_part, spread_shares[s]);
        if (spread_shares[s] >= MARGIN_ENERGY_SHARE && reach >= motion->reach * motion->strip_m)
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "sonar.motion spreads echoes farther than %.4g m along-track, %d times the "
                "resolution: lessen it",
                reach, motion->reach);
        spread_m[s] =
            fmax(spread_m[s], reach - along_track_energy_reach(motion->response, spread_shares[s]));
    }
    return SONJECT_OK;
}

/* Of a row's energy, what comes from beyond the beam of the elements. */
static double lost_by_row(const struct motion_response *motion, const double *real_part,
                          const double *imaginary_part)
{
    double lost = 0.0;
    for (int i = 0; i <= 2 * motion->reach; i++) {
        const double straight = along_track_response(
            motion->response, (i - motion->reach) * motion->strip_m + motion->offset_m);
        const double a = straight + motion->heard[i] * (real_part[i] - straight);
        const double b = motion->heard[i] * imaginary_part[i];
        lost += real_part[i] * real_part[i] + imaginary_part[i] * imaginary_part[i] - a * a - b * b;
    }
    return lost * motion->strip_m / along_track_energy_width(motion->response);
}

sonject_status motion_response_spread(struct report *report, struct point_response *response,
                                      const struct patch_view *view)
{
    struct motion_response motion;
    memset(response->motion_spread_m, 0, sizeof response->motion_spread_m);
    sonject_status status = motion_response_begin(&motion, report, response, view,
                                                  response->resolution_m, 0.0, SPREAD_REACH);
    if (status != SONJECT_OK)
        return status;
    double *real_part = allocate_array(2 * (size_t)SPREAD_REACH + 1, sizeof *real_part);
    double *imaginary_part = allocate_array(2 * (size_t)SPREAD_REACH + 1, sizeof *imaginary_part);
    if (!real_part || !imaginary_part)
        status = report_out_of_memory(report, "motion");
    response->motion_energy_share = 1.0;
    for (int i = 0; status == SONJECT_OK && i < SPREAD_ROWS; i++) {
        motion_response_row_all_around(&motion, (double)(view->rows - 1) * i / (SPREAD_ROWS - 1),
                                       real_part, imaginary_part);
        status = spread_row(&motion, report, real_part, imaginary_part, response->motion_spread_m);
        response->motion_energy_share -=
            lost_by_row(&motion, real_part, imaginary_part) / SPREAD_ROWS;
    }
    free(real_part);
    free(imaginary_part);
    motion_response_end(&motion);
    return status;
}

double motion_spread(const struct point_response *response, double share)
{
    int s = MOTION_SHARES - 1;
    while (s > 0 && spread_shares[s - 1] <= share)
        s--;
    return response->motion_spread_m[s];
}
