#include "trace/chain_reach.h"

#include <math.h>

/* In sizes of the part, or in its heights if that is more. */
#define REACH_AROUND 16.0

/* In ways from below the part to the seabed's mirror point, which lies nearer to the sonar the
 * flatter sound comes: what goes by there comes first. */
#define REACH_TO_MIRROR 6.5

/* Half the sum of the heights of the top and of the lowest point that is not buried. */
static double mean_height(const struct tracer *tracer, const struct placement *placement)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    const double half_extent = placement_half_extent(placement, upward);
    const double height = placement->centre[2] - tracer_lowest_seabed(tracer);
    return 0.5 * (fmax(height + half_extent, 0.0) + fmax(height - half_extent, 0.0));
}

/* What is further from the part is heard after the patch's last range, r_B + d + r over 2, even
 * straight below the sonar; a little more, for the point response. */
static double heard_reach(const struct tracer *tracer, const struct placement *placement)
{
    const struct patch_view *view = &tracer->view;
    const double last = 1.02 * view_apparent_range(view, (double)view->columns);
    return 2.0 * last - placement_range(placement, view) - view->altitude_m;
}

struct chain_reach chain_reach_of(const struct tracer *tracer, const struct placement *placement)
{
    const double radius = placement->bounding_radius_m;
    const double height = mean_height(tracer, placement);
    const double ground = placement->centre[1];
    const double altitude = tracer->view.altitude_m;
    struct chain_reach reach;
    reach.around_m = radius + fmax(REACH_AROUND * radius,
                                   fmin(REACH_AROUND * height, heard_reach(tracer, placement)));
    /* seabed that sees the sonar steeper than 45 degrees fills many rays, and matters little */
    const double wanted = radius + REACH_TO_MIRROR * height * ground / altitude;
    reach.towards_sonar_m = fmax(reach.around_m, fmin(wanted, ground - altitude));
    return reach;
}
