#include "trace/launch_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "kernels/object_tree_records.h"
#include "trace/object_rays.h"

/* Far more than rounding: of a radius, and in m. */
#define MARGIN       0.01
#define MARGIN_LEAST 0.001

/* Where rays run that are aimed at a part. */
struct corridor {
    double first_x, last_x;         /* m, along-track */
    bool is_straight;               /* and by what follows */
    double least_angle, most_angle; /* rad below the horizontal, from the sonar */
    double farthest;                /* m from the sonar's track */
};

static double padded_radius(const struct placement *placement)
{
    return (1.0 + MARGIN) * placement->bounding_radius_m + MARGIN_LEAST;
}

static double distance_from_track(const struct tracer *tracer, const struct placement *placement)
{
    return hypot(placement->centre[1], tracer->scene->sonar.altitude_m - placement->centre[2]);
}

static double angle_from_track(const struct tracer *tracer, const struct placement *placement)
{
    return atan2(tracer->scene->sonar.altitude_m - placement->centre[2], placement->centre[1]);
}

static struct corridor corridor_to(const struct tracer *tracer, uint32_t target,
                                   const struct line_grid *grid, bool is_straight)
{
    const struct patch_view *view = &tracer->view;
    const struct placement *placement = &tracer->placements[target];
    const double per_row = grid->strips_per_row;
    const double end = grid->strips.first + grid->strips.count;
    struct corridor corridor;
    memset(&corridor, 0, sizeof corridor);
    corridor.first_x = view_x_of_row(view, grid->strips.first / per_row - 0.5) - MARGIN_LEAST;
    corridor.last_x = view_x_of_row(view, end / per_row - 0.5) + MARGIN_LEAST;
    corridor.is_straight = is_straight && view->water.is_straight;
    if (corridor.is_straight) {
        const struct elevations edges = elevations_of_object(tracer, target, &view->water);
        const double angle = angle_from_track(tracer, placement);
        corridor.least_angle = angle - edges.highest - 1e-4;
        corridor.most_angle = angle - edges.lowest + 1e-4;
        corridor.farthest = distance_from_track(tracer, placement) + padded_radius(placement);
    }
    return corridor;
}

static bool is_in_corridor(const struct tracer *tracer, const struct corridor *corridor,
                           const struct placement *placement)
{
    const double radius = padded_radius(placement);
    if (placement->centre[0] + radius < corridor->first_x ||
        placement->centre[0] - radius > corridor->last_x)
        return false;
    if (!corridor->is_straight)
        return true;
    const double distance = distance_from_track(tracer, placement);
    if (distance <= radius)
        return true;
    const double angle = angle_from_track(tracer, placement);
    const double half = asin(radius / distance);
    return distance - radius <= corridor->farthest && angle + half >= corridor->least_angle &&
           angle - half <= corridor->most_angle;
}

sonject_status launch_parts_init(struct launch_parts *parts, const struct tracer *tracer,
                                 uint32_t target, const struct line_grid *grid, bool is_straight)
{
    const struct corridor corridor = corridor_to(tracer, target, grid, is_straight);
    memset(parts, 0, sizeof *parts);
    parts->numbers = allocate_array(tracer->part_count, sizeof *parts->numbers);
    CHECK_MEMORY(tracer->report, parts->numbers, "objects");
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        if (i == target)
            parts->target = parts->count;
        else if (tracer->part_count > OBJECTS_IN_LOOP &&
                 !is_in_corridor(tracer, &corridor, &tracer->placements[i]))
            continue;
        parts->numbers[parts->count++] = i;
    }
    return SONJECT_OK;
}

void launch_parts_clear(struct launch_parts *parts)
{
    free(parts->numbers);
    memset(parts, 0, sizeof *parts);
}

sonject_status launch_records_create(struct object_record **records, const struct tracer *tracer,
                                     const struct launch_parts *parts, const double origin[3])
{
    *records = allocate_array(parts->count, sizeof **records);
    if (!*records)
        return report_out_of_memory(tracer->report, "objects");
    for (uint32_t i = 0; i < parts->count; i++)
        object_record_init(&(*records)[i], tracer, parts->numbers[i], origin);
    return SONJECT_OK;
}
