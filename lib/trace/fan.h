/* Fans of rays: over a whole patch, seabed and objects, and what they need to know of objects, of
 * the aspects that a synthetic aperture integrates over and of a real aperture's two-way beam (both
 * in kernels/aspects.h); and rays that layers of water bend, worked out for the kernels
 * (kernels/ray_table.h; kernels/MATH.md, "Layers"). */
#ifndef SONJECT_TRACE_FAN_H
#define SONJECT_TRACE_FAN_H

#include <stdbool.h>

#include "trace/tracer.h"

void ray_table_clear(struct ray_table *table);

/* Elevations in rad over the direction in which sound comes to a frame's origin. */
struct elevations {
    double lowest, highest;
};

/* The middle of the patch on the seabed: origin of the frame that the patch is traced in. */
void patch_fan_origin(double origin[3], const struct patch_view *view);

/* Fills a fan record for the patch but for its rays, quanta and stream, which are left 0. has_map:
 * a reflectivity map of the view's rows x columns goes with it. */
void patch_fan_aim(struct fan_record *fan, const struct tracer *tracer,
                   const struct line_grid *grid, bool has_map);

/* The same with rays by even steps: elevations from the seabed at the grid's first bin up to that
 * at the last bin or over the highest object, in steps that put rays_per_bin rays (times the
 * scene's ray scale) into a bin where elevation covers most range, or more where a rough object is
 * so small that few would meet it. Errors: INPUT (too many rays). */
sonject_status patch_fan_init(struct fan_record *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, double rays_per_bin);

/* The elevations between which each ray of a fan lies, rad over the central direction: rays + 1,
 * and the last again for lanes without a ray. */
struct fan_edges {
    float *elevations; /* owned */
    size_t count, capacity;
    double widest; /* step, rad */
};

/* Lays a patch's rays, from a processor range on, by the bins that rays meet level seabed in:
 * rays_per_bin (times the scene's ray scale) in each, and more where sound comes so steeply, or a
 * rough object is so small, that they would lie far apart across it. A bin's rays are numbered as
 * the bins of the patch are. fan: of patch_fan_aim. To be given to free(edges->elevations), also
 * on failure. Errors: INPUT (too many rays), MEMORY. */
sonject_status fan_edges_init(struct fan_edges *edges, struct fan_record *fan,
                              const struct tracer *tracer, const struct line_grid *grid,
                              double nearest_m, double rays_per_bin);

/* Grazing angles, rad, at which sound comes to the near and the far end of what is traced. */
struct grazing_angles {
    double near, far;
};

/* Those of the mean plane, widened to what the tracer's relief needs. */
struct grazing_angles grazing_over_relief(const struct tracer *tracer, struct grazing_angles plane);

/* Works out the rays of all fans in the patch's frame: from the sonar to the patch and to whatever
 * is near the objects. The table is the caller's for ray_table_clear, also on failure. Errors:
 * INPUT (rays so near to total reflection that no cubic follows them), MEMORY. */
sonject_status patch_rays_init(struct ray_table *rays, struct ray_table_record *record,
                               const struct tracer *tracer, const struct line_grid *grid);

/* Strips from one place along the track (m) to another, and one more on each side; in the patch or
 * beyond. */
struct span strips_between(const struct tracer *tracer, const struct line_grid *grid,
                           double first_x, double last_x);

/* Elevation step, rad, that puts rays_per_bin rays (times the scene's ray scale) into a bin where
 * sound meets the seabed at a grazing angle, and elevation covers most range. */
double fan_elevation_step(const struct tracer *tracer, const struct line_grid *grid,
                          double grazing_rad, double rays_per_bin);

#define FAN_RAYS_MAX 67108864.0

/* Elevation of the highest object over the central direction; the lowest given where none is. */
double fan_highest_elevation(const struct tracer *tracer, double central_grazing, double lowest);

/* The step at which the smallest rough object, a sphere as large as that, is met by 16 rays of a
 * strip so wide: its energy is then known to 1 dB. */
double fan_step_to_objects(const struct tracer *tracer, double strip_m);

/* Lays rays from a lowest to a highest elevation (rad over the central direction). Errors: INPUT
 * (too many rays). */
sonject_status fan_set_rays(struct fan_record *fan, struct report *report, double lowest,
                            double highest, double step);

/* Elevations that a part fills as seen on a path, from the direction of its centre; a little
 * more than that. */
struct elevations elevations_of_object(const struct tracer *tracer, uint32_t part,
                                       const struct ray_path *path);

/* Lays rays over a part as seen on a path, at most cell_m apart on the wavefront. */
void fan_aim_at_part(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                     const struct ray_path *path, double cell_m);

/* Appends the rays of a path to a part in the part's frame. Errors: as patch_rays_init. */
sonject_status object_rays_add(struct ray_table *rays, const struct tracer *tracer, uint32_t part,
                               const struct ray_path *path, struct ray_table_record *record);

/* Sine of the largest angle off broadside; 0: broadside alone. The response's own, wavelength /
 * (4 resolution), is taken to at most 45 degrees. */
double aspects_sine(const struct tracer *tracer);

/* Fills fan->aspects but for the strips; a fan of broadside rays keeps its zeros. */
void aspects_record_init(struct fan_record *fan, const struct tracer *tracer,
                         const struct line_grid *grid);

/* How far, m along the track, a ray of the largest angle moves over a range of length_m. */
double aspects_slide(const struct tracer *tracer, double length_m);

/* Strips beyond those whose seabed is wanted, on each side, from which rays may come to it: 0 over
 * the plane. */
int32_t aspects_relief_halo(const struct tracer *tracer, const struct line_grid *grid);

/* Fills fan->beam. */
void beam_record_init(struct fan_record *fan, const struct tracer *tracer);

/* The processor range at broadside, m, of what lies farthest off it at the grid's near end. */
double beam_nearest(const struct tracer *tracer, const struct line_grid *grid);

/* Sine of the largest angle off broadside that the beam's rays go out to. */
double beam_largest_sine(const struct tracer *tracer);

/* The most that a ray of the beam stands for, over one of a strip. */
double beam_largest_weight(const struct tracer *tracer, const struct fan_record *fan);

#endif
