#include "trace/target_spheres.h"

#include <math.h>

#define SPHERES_WANTED 32 /* more cost more than they save */

/* Size of the object along its nose, and of the circle around its section across it. */
static void overall_size(const struct placement *placement, double *half_length, double *radius)
{
    static const double nose[3] = {1.0, 0.0, 0.0};
    static const double tail[3] = {-1.0, 0.0, 0.0};
    struct shape_size uncut = placement->size;
    uncut.cut_count = 0;
    *half_length = fmax(shape_extent(&uncut, placement->shape, nose),
                        shape_extent(&uncut, placement->shape, tail));
    *radius = shape_radius_about_nose(&uncut, placement->shape);
    if (placement->shape == SONJECT_SHAPE_SPHERE)
        *half_length = 0.0;
}

static uint32_t spheres_for(double half_length, double radius, uint32_t objects)
{
    const double wanted = ceil(half_length / fmax(radius, 1e-9) - 1e-6);
    const double allowed = fmax(1.0, floor(SPHERES_WANTED / (double)objects));
    return (uint32_t)fmax(1.0, fmin(wanted, allowed));
}

uint32_t target_spheres_init(struct sphere_record *records, const struct tracer *tracer,
                             const double origin[3])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        double half_length, radius;
        overall_size(placement, &half_length, &radius);
        const uint32_t parts = spheres_for(half_length, radius, tracer->part_count);
        const double half_part = half_length / parts;
        const double sphere_radius = hypot(radius, half_part) * (1.0 + 1e-5);
        for (uint32_t part = 0; part < parts && count < TARGET_SPHERES_MAX; part++) {
            const double along = (2.0 * part + 1.0) * half_part - half_length;
            double centre[3];
            for (int k = 0; k < 3; k++)
                centre[k] = placement->centre[k] + along * placement->axes[0][k];
            if (centre[2] + sphere_radius <= tracer_lowest_seabed(tracer))
                continue;
            records[count].centre_x = (float)(centre[0] - origin[0]);
            records[count].centre_y = (float)(centre[1] - origin[1]);
            records[count].centre_z = (float)(centre[2] - origin[2]);
            records[count].radius = (float)sphere_radius;
            count++;
        }
    }
    return count;
}
