/* A patch as the tracer sees it: the places of its pixels, with the imaged side to port, and the
 * fine grid that collects its echoes before image formation. */
#ifndef SONJECT_SCENE_PATCH_VIEW_H
#define SONJECT_SCENE_PATCH_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "medium/water.h"
#include "scene/scene.h"

struct point_response;

/* The view of a patch. Starboard images are mirrored: x runs against the image's along-track axis
 * and row n is the image's row rows - 1 - n, so +y is to port of +x, as in a right-handed frame. */
struct patch_view {
    size_t rows, columns;
    size_t first_row, first_column; /* a window's first pixel in the patch; 0: the whole patch */
    double row_spacing_m, column_spacing_m;
    double first_x_m;     /* x of row 0 of the view */
    double first_range_m; /* processor's slant range of column 0 */
    double farthest_m;    /* processor's slant range of the patch's last column */
    double range_ratio;   /* processor over straight range: reference over straight sound speed */
    double altitude_m;
    double wavelength_m;   /* in the straight water, around seabed and targets */
    double seabed_lambert; /* mu0: the scene's, or its sediment's at the middle of the patch's
                              seabed */
    bool is_mirrored;      /* rows are the image's reversed */
    bool is_reversed;      /* columns are the image's reversed, so that range grows with them */
    struct ray_path water; /* path of sound straight from the sonar */
};

/* Lays the scene's water, straight up to the highest object. Errors: as for water_init. */
sonject_status scene_lay_water(const struct scene *scene, struct report *report,
                               struct water *water);

/* Returns the sound speed that the image processor assumed. */
double scene_reference_speed(const struct scene *scene);

/* Fills the view of the region that starts at first_row, first_column of the swath. water is
 * borrowed. The patch may begin in the water column where the water is isovelocity and the seabed
 * level. Errors: INPUT (patch in the water column, or on both sides of the nadir column; no pixels;
 * sonar not above the straight water's targets). */
sonject_status patch_view_init(struct patch_view *view, struct report *report,
                               const struct scene *scene, const struct water *water,
                               double first_row, double first_column, size_t rows, size_t columns);

/* A window: rows and columns of a view. */
struct window {
    size_t first_row, rows, first_column, columns;
};

/* Returns a window of the whole patch's view as a view of its own. x, ranges and all that belongs
 * to the patch stay the same, and so do the random numbers of its cells. */
struct patch_view patch_view_window(const struct patch_view *view, const struct window *window);

/* Turns a plane of the patch, or of a part of it, from the image's order of rows and columns to the
 * view's, or back. */
void view_turn_plane(const struct patch_view *view, size_t rows, size_t columns, void *plane,
                     size_t pixel_bytes);

/* Returns the patch's column for a column of the view. */
double view_patch_column(const struct patch_view *view, double column);

/* Finds row and column of the view at a position that is given as an object's. kind:
 * sonject_position_kind. first_row, first_column: of the patch in the swath. */
void view_find_pixel(const struct patch_view *view, double first_row, double first_column,
                     uint32_t kind, double along, double range, double *row, double *column);

/* Returns the processor range of the first return from the bottom, straight below. */
double view_bottom_range(const struct patch_view *view);

/* Returns the number of columns of the view in the water column, before the first return. */
size_t view_water_columns(const struct patch_view *view);

/* Returns the along-track position (in the view's x) of a row, which may be fractional. */
double view_x_of_row(const struct patch_view *view, double row);

double view_row_of_x(const struct patch_view *view, double x_m);
double view_processor_range(const struct patch_view *view, double column);
double view_column_of_range(const struct patch_view *view, double processor_range_m);

/* Returns the ground range of the seabed at a processor's slant range; 0 in the water column. */
double view_ground_range(const struct patch_view *view, double processor_range_m);

/* Returns the seabed's grazing angle, rad, at a processor's slant range; pi/2 in the water column.
 */
double view_grazing(const struct patch_view *view, double processor_range_m);

/* Returns the factor of refraction on the energy of seabed echoes at a processor's slant range: 1
 * in isovelocity water. */
double view_refraction_gain(const struct patch_view *view, double processor_range_m);

/* Returns (processor / true range)^4: the effect on energies of normalising target strength by
 * processor range, when the processor's sound speed is off. */
double view_energy_scale(const struct patch_view *view);

struct span {
    int32_t first, count;
};

/* The grid of strips and bins. Strips divide rows: strip q is part of row floor(q /
 * strips_per_row). Bins divide pixels: the middle of bin b is at column b / bins_per_pixel. Strips
 * and bins outside the patch are its margins. */
struct line_grid {
    uint32_t strips_per_row, bins_per_pixel;
    struct span strips, bins;
};

/* Sets the grid for energies and speckle. Cells are at most the along-track resolution by an eighth
 * of the range resolution. Margins hold all but 0.5 % of the energies of cross-range response and
 * pulse, and end at range 0. */
void line_grid_for_patch(struct line_grid *grid, const struct patch_view *view,
                         const struct point_response *response);

/* Return the bins on each side of a pixel: those that hold all but 0.1 % of the pulse's energy, and
 * those that glints are spread over, to where side lobes are below -60 dB. For a Gaussian both are
 * 5 deviations (-108 dB). */
int32_t pulse_reach_bins(const struct patch_view *view, const struct point_response *response,
                         uint32_t bins_per_pixel);

int32_t pulse_tail_bins(const struct patch_view *view, const struct point_response *response,
                        uint32_t bins_per_pixel);

/* Returns the standard deviation, m, of the shortest pulse that the grid's bins resolve. */
double line_grid_shortest_deviation(const struct line_grid *grid, double column_spacing_m);

/* Return the processor ranges, m, between which echoes share with the grid's bins: one bin beyond
 * the middles of the outermost bins. */
double line_grid_near_end(const struct line_grid *grid, const struct patch_view *view);
double line_grid_far_end(const struct line_grid *grid, const struct patch_view *view);

/* Returns strips.count * bins.count. */
size_t line_grid_cells(const struct line_grid *grid);

#endif
