/* Fans of rays. A fan is a set of rays by elevation that repeats on each strip of the track. It
 * covers a whole patch, or one object. Here are also the aspects of a synthetic aperture and the
 * beam of a real one (kernels/aspects.h), and rays that layers of water bend (kernels/ray_table.h;
 * kernels/MATH.md, "Layers"). */
#ifndef SONJECT_TRACE_FAN_H
#define SONJECT_TRACE_FAN_H

#include <stdbool.h>

#include "trace/tracer.h"

void ray_table_clear(struct ray_table *table);

/* Elevations, rad above the direction in which sound comes to a frame's origin. */
struct elevations {
    double lowest, highest;
};

/* Finds the middle of the patch on the seabed, which is the origin of the patch's frame. */
void patch_fan_origin(double origin[3], const struct patch_view *view);

/* Fills in a fan record for the patch. Its rays, quanta and stream are left 0. has_map: the launch
 * has a reflectivity map of the view's rows x columns. */
void patch_fan_aim(struct fan_record *fan, const struct tracer *tracer,
                   const struct line_grid *grid, bool has_map);

/* Fills in a fan record for the patch with rays of even steps. Elevations run from the seabed at
 * the grid's first bin to that at the last bin, or over the highest object. Steps put rays_per_bin
 * rays (times the scene's ray scale) into a bin where elevation covers most range. They are finer
 * where a rough object is so small that few would meet it. Errors: INPUT (too many rays). */
sonject_status patch_fan_init(struct fan_record *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, double rays_per_bin);

/* The elevations between which each ray of a fan lies, rad above the central direction: rays + 1 of
 * them, and the last one repeated for lanes without a ray. */
struct fan_edges {
    float *elevations; /* owned */
    size_t count, capacity;
    double widest; /* widest step, rad */
};

/* Lays a patch's rays, from a processor range on, by the bins in which rays meet level seabed. Each
 * bin has rays_per_bin rays (times the scene's ray scale). It has more where sound comes so
 * steeply, or a rough object is so small, that rays would lie far apart across it. Rays are
 * numbered by their bins in the patch. fan: a record of patch_fan_aim. The caller frees
 * edges->elevations, also on failure. Errors: INPUT (too many rays), MEMORY. */
sonject_status fan_edges_init(struct fan_edges *edges, struct fan_record *fan,
                              const struct tracer *tracer, const struct line_grid *grid,
                              double nearest_m, double rays_per_bin);

/* Grazing angles, rad, at which sound comes to the near and the far end of what is traced. */
struct grazing_angles {
    double near, far;
};

/* Returns the grazing angles of the mean plane, widened to what the tracer's relief needs. */
struct grazing_angles grazing_over_relief(const struct tracer *tracer, struct grazing_angles plane);

/* Works out the rays of all fans in the patch's frame, from the sonar to the patch and to whatever
 * is near the objects. The caller gives the table to ray_table_clear, also on failure. Errors:
 * INPUT (rays turn back, or so nearly that no cubic follows them), MEMORY. */
sonject_status patch_rays_init(struct ray_table *rays, struct ray_table_record *record,
                               const struct tracer *tracer, const struct line_grid *grid);

/* Returns the strips from one place along the track (m) to another, and one more on each side. They
 * may lie beyond the patch. */
struct span strips_between(const struct tracer *tracer, const struct line_grid *grid,
                           double first_x, double last_x);

/* Returns the elevation step, rad, for rays_per_bin rays (times the scene's ray scale) in a bin.
 * Sound meets the seabed there at a grazing angle, and elevation covers most range. */
double fan_elevation_step(const struct tracer *tracer, const struct line_grid *grid,
                          double grazing_rad, double rays_per_bin);

#define FAN_RAYS_MAX 67108864.0

/* Returns the elevation of the highest object, rad above the central direction; else `lowest`. */
double fan_highest_elevation(const struct tracer *tracer, double central_grazing, double lowest);

/* Returns the step, rad, at which 16 rays of a strip meet the smallest rough object, taken for a
 * sphere as large. Its energy is then known to 1 dB. */
double fan_step_to_objects(const struct tracer *tracer, double strip_m);

/* Lays rays from a lowest to a highest elevation, rad above the central direction. Errors: INPUT
 * (too many rays). */
sonject_status fan_set_rays(struct fan_record *fan, struct report *report, double lowest,
                            double highest, double step);

/* Returns the elevations that a part fills as seen on a path, from the direction of its centre,
 * with a small margin. */
struct elevations elevations_of_part(const struct tracer *tracer, uint32_t part,
                                     const struct ray_path *path);

/* Lays rays over a part as seen on a path, at most cell_m apart on the wavefront. */
void fan_aim_at_part(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                     const struct ray_path *path, double cell_m);

/* Appends the rays of a path to a part in the part's frame. Errors: as patch_rays_init. */
sonject_status part_rays_add(struct ray_table *rays, const struct tracer *tracer, uint32_t part,
                             const struct ray_path *path, struct ray_table_record *record);

/* Returns the sine of the largest angle off broadside; 0 for broadside alone. The response's own
 * sine, wavelength / (4 resolution), counts up to that of 45 degrees. */
double aspects_sine(const struct tracer *tracer);

/* Fills in fan->aspects except for the strips. A fan of broadside rays keeps its zeros. */
void aspects_record_init(struct fan_record *fan, const struct tracer *tracer,
                         const struct line_grid *grid);

/* Returns how far, m along the track, a ray of the largest angle moves over a range of length_m. */
double aspects_slide(const struct tracer *tracer, double length_m);

/* Returns how many strips on each side, beyond those whose seabed is wanted, send rays to that
 * seabed; 0 over the plane. */
int32_t aspects_relief_halo(const struct tracer *tracer, const struct line_grid *grid);

void beam_record_init(struct fan_record *fan, const struct tracer *tracer);

/* Returns the processor range at broadside, m, of the farthest place off broadside that is seen at
 * the grid's near end. */
double beam_nearest(const struct tracer *tracer, const struct line_grid *grid);

/* Returns the sine of the largest angle off broadside that the beam's rays go out to. */
double beam_largest_sine(const struct tracer *tracer);

/* Returns the most that a ray of the beam stands for, over what a ray of a strip does. */
double beam_largest_weight(const struct tracer *tracer, const struct fan_record *fan);

#endif
