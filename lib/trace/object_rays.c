#include "trace/object_rays.h"

#include <math.h>

#define MARGIN 1.02

struct elevations elevations_of_object(const struct tracer *tracer, uint32_t object,
                                       const struct water_way *way)
{
    const struct placement *placement = &tracer->placements[object];
    const double *centre = placement->centre;
    const double grazing = water_way_grazing(way, centre[1], centre[2]);
    const double upward[3] = {0.0, sin(grazing), cos(grazing)};
    const double across = MARGIN * placement_half_extent(placement, upward);
    const double along = placement->bounding_radius_m;
    double corners[4][2];
    for (int i = 0; i < 4; i++) {
        const double up = i & 1 ? across : -across;
        const double away = i & 2 ? along : -along;
        corners[i][0] = centre[1] + up * sin(grazing) + away * cos(grazing);
        corners[i][1] = centre[2] + up * cos(grazing) - away * sin(grazing);
    }
    return elevations_of_points(way, grazing, (const double(*)[2])corners, 4);
}

sonject_status object_rays_add(struct ray_table *rays, const struct tracer *tracer, uint32_t object,
                               const struct water_way *way, struct ray_table_record *record)
{
    const double *centre = tracer->placements[object].centre;
    return ray_table_add(rays, tracer->report, way, centre[1], centre[2],
                         elevations_of_object(tracer, object, way), record);
}
