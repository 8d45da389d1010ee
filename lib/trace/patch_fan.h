/* The fan of rays over a whole patch, seabed and objects. */
#ifndef SONJECT_TRACE_PATCH_FAN_H
#define SONJECT_TRACE_PATCH_FAN_H

#include <stdbool.h>

#include "trace/tracer.h"

/* The middle of the patch on the seabed: origin of the frame that the patch is traced in. */
void patch_fan_origin(double origin[3], const struct patch_view *view);

/* Fills a fan record for the patch: elevations from the seabed at the grid's first bin up to that
 * at the last bin or over the highest object, in steps that put rays_per_bin rays (times the
 * scene's ray scale) into a bin where elevation covers most range, or more where a rough object is
 * so small that few would meet it. Quanta and stream are left 0.
 * has_map: a reflectivity map of the view's rows x columns goes with it. Errors: INPUT (too many
 * rays). */
sonject_status patch_fan_init(struct fan_record *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, double rays_per_bin);

/* Grazing angles, rad, at which sound comes to the near and the far end of what is traced. */
struct grazing_angles {
    double near, far;
};

/* Those of the mean plane, widened to what the tracer's relief needs. */
struct grazing_angles grazing_over_relief(const struct tracer *tracer, struct grazing_angles plane);

/* Works out the rays of all fans in the patch's frame: from the sonar to the patch and to whatever
 * is near the objects. The table is the caller's for ray_table_clear, also on failure. Errors: as
 * ray_table_add. */
sonject_status patch_rays_init(struct ray_table *rays, struct ray_table_record *record,
                               const struct tracer *tracer, const struct line_grid *grid);

/* Elevation step, rad, that puts rays_per_bin rays (times the scene's ray scale) into a bin where
 * sound meets the seabed at a grazing angle, and elevation covers most range. */
double fan_elevation_step(const struct tracer *tracer, const struct line_grid *grid,
                          double grazing_rad, double rays_per_bin);

/* Lays rays from a lowest to a highest elevation (rad over the central direction). Errors: INPUT
 * (too many rays). */
sonject_status fan_lay_rays(struct fan_record *fan, struct report *report, double lowest,
                            double highest, double step);

#endif
