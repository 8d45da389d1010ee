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

struct chain_reach chain_reach_of(const struct tracer *tracer, const struct placement *placement)
{
    const double radius = placement->bounding_radius_m;
    const double height = mean_height(tracer, placement);
    const double ground = placement->centre[1];
    const double altitude = tracer->view.altitude_m;
    struct chain_reach reach;
    reach.around_m = radius + REACH_AROUND * fmax(radius, height);
    /* seabed that sees the sonar steeper than 45 degrees fills many rays, and matters little */
    const double wanted = radius + REACH_TO_MIRROR * height * ground / altitude;
    reach.towards_sonar_m = fmax(reach.around_m, fmin(wanted, ground - altitude));
    return reach;
}
