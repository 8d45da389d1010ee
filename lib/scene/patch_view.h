/* A patch as the tracer sees it: where its pixels lie, with the imaged side to port, and the fine
 * grid on which its echoes are collected before image formation. */
#ifndef SONJECT_SCENE_PATCH_VIEW_H
#define SONJECT_SCENE_PATCH_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "medium/water.h"
#include "scene/scene.h"

struct point_response;

/* Starboard images are mirrored: x runs against the image's along-track axis and row n of the
 * view is row rows - 1 - n of the image, so that +y is to port of +x as in a right-handed frame. */
struct patch_view {
    size_t rows, columns;
    size_t first_row, first_column; /* of a window, in the patch's view; 0 of the whole patch */
    double row_spacing_m, column_spacing_m;
    double first_x_m;     /* of row 0 of the view */
    double first_range_m; /* processor's slant range of column 0 */
    double farthest_m;    /* and of the patch's last column */
    double range_ratio;   /* processor over straight range: reference over straight sound speed */
    double altitude_m;
    double wavelength_m;   /* in the straight water, around seabed and targets */
    double seabed_lambert; /* mu0: what the scene says, or its sediment at the middle of the patch's
                              seabed */
    bool is_mirrored;      /* its rows are the image's from the last to the first */
    bool is_reversed;      /* and so are its columns, so that range grows with them */
    struct ray_path water; /* of sound straight from the sonar */
};

/* The scene's water, straight up to the highest object. Errors: as water_init. */
sonject_status scene_lay_water(const struct scene *scene, struct report *report,
                               struct water *water);

/* The sound speed that the image processor assumed. */
double scene_reference_speed(const struct scene *scene);

/* The scene's geometry shifted to the region that starts at first_row, first_column of the swath.
 * water is borrowed. The patch may begin in the water column where water and seabed are level and
 * plain. Errors: INPUT (patch in the water column, or on both sides of the nadir column; no pixels;
 * sonar not above the straight water's targets). */
sonject_status patch_view_init(struct patch_view *view, struct report *report,
                               const struct scene *scene, const struct water *water,
                               double first_row, double first_column, size_t rows, size_t columns);

/* Rows and columns of a view. */
struct window {
    size_t first_row, rows, first_column, columns;
};

/* A window of the whole patch's view as a view of its own: x, ranges and all that belongs to the
 * patch stay as they are, and so do the random numbers of its cells. */
struct patch_view patch_view_window(const struct patch_view *view, const struct window *window);

/* Turns a plane of the patch, or of a part of it, from the image's order of rows and columns into
 * the view's, or back. */
void view_turn_plane(const struct patch_view *view, size_t rows, size_t columns, void *plane,
                     size_t pixel_bytes);

/* The patch's column that a column of the view is. */
double view_patch_column(const struct patch_view *view, double column);

/* Row and column of the view at a position given as an object's is: kind sonject_position_kind.
 * first_row, first_column: of the patch in the swath. */
void view_find_pixel(const struct patch_view *view, double first_row, double first_column,
                     uint32_t kind, double along, double range, double *row, double *column);

/* Processor range of the first return from the bottom, straight below. */
double view_bottom_range(const struct patch_view *view);

/* Columns of the view that lie in the water column, before the first return. */
size_t view_water_columns(const struct patch_view *view);

/* Along-track position (in the view's x) of a row, which may be fractional. */
double view_x_of_row(const struct patch_view *view, double row);

double view_row_of_x(const struct patch_view *view, double x_m);
double view_processor_range(const struct patch_view *view, double column);
double view_column_of_range(const struct patch_view *view, double processor_range_m);

/* Horizontal range of the seabed point seen at a processor's slant range; 0 above the altitude. */
double view_ground_range(const struct patch_view *view, double processor_range_m);

/* Grazing angle in rad of the seabed at a processor's slant range; straight down above the
 * altitude.
 */
double view_grazing(const struct patch_view *view, double processor_range_m);

/* What refraction does to the energy of echoes of the seabed at a processor's slant range: 1 in
 * isovelocity water. */
double view_refraction_gain(const struct patch_view *view, double processor_range_m);

/* (processor / true range)^4: what the target-strength normalisation by processor range does to
 * energies when the processor's sound speed is off. */
double view_energy_scale(const struct patch_view *view);

struct span {
    int32_t first, count;
};

/* Strips divide rows: strip q is part of row floor(q / strips_per_row); bins divide pixels: the
 * middle of bin b is at column b / bins_per_pixel. Numbers below 0 and beyond the patch are its
 * margins. */
struct line_grid {
    uint32_t strips_per_row, bins_per_pixel;
    struct span strips, bins;
};

/* The grid for energies and speckle: cells of at most the along-track resolution by an eighth of
 * the range resolution, with margins that hold all but 0.5 % of the energies of cross-range
 * response and pulse, and end at range 0. */
void line_grid_for_patch(struct line_grid *grid, const struct patch_view *view,
                         const struct point_response *response);

/* Bins on each side of a pixel that hold all but 0.1 % of the pulse's energy, and those that glints
 * are spread over: to where its side lobes are below -60 dB. A Gaussian's are both 5 deviations
 * (-108 dB). */
int32_t pulse_reach_bins(const struct patch_view *view, const struct point_response *response,
                         uint32_t bins_per_pixel);

int32_t pulse_tail_bins(const struct patch_view *view, const struct point_response *response,
                        uint32_t bins_per_pixel);

/* Standard deviation in m of the shortest pulse that the bins of line_grid_for_patch are fine
 * enough for. */
double line_grid_shortest_deviation(const struct line_grid *grid, double column_spacing_m);

/* The processor ranges, m, between which echoes share with the grid's bins: a bin beyond the
 * middles of its outermost ones. */
double line_grid_near_end(const struct line_grid *grid, const struct patch_view *view);
double line_grid_far_end(const struct line_grid *grid, const struct patch_view *view);

/* strips.count * bins.count */
size_t line_grid_cells(const struct line_grid *grid);

#endif
