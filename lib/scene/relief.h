/* The seabed's heights under a patch. */
#ifndef SONJECT_SCENE_RELIEF_H
#define SONJECT_SCENE_RELIEF_H

#include "scene/patch_view.h"
#include "scene/scene.h"

/* Towards the patch's edges heights fall to 0 as a raised cosine, so that there is no step. The
 * fall takes RELIEF_TAPER_M or, if less, RELIEF_TAPER_SHARE of the patch's side. */
#define RELIEF_TAPER_M     1.0
#define RELIEF_TAPER_SHARE 0.125

/* Heights over the mean seabed on a level grid over the patch, in coordinates of the view. They are
 * bilinear between the points, and 0 at the edges and outside. */
struct relief {
    uint32_t rows, columns;      /* along-track, and in ground range; at least 5 each */
    double first_x_m, first_y_m; /* place of the first point */
    double row_step_m, column_step_m;
    double lowest_m, highest_m; /* lowest height, at most 0, and highest height, at least 0 */
    float *heights;             /* owned, rows x columns */
    float *slopes; /* owned, rows x columns pairs: along-track and in range, by differences of
                      fourth order */
};

/* The ground that an object covers: half_width_m about a line of half_length_m each way. */
struct footprint {
    double x_m, y_m;         /* middle of the footprint, in the view */
    double along_x, along_y; /* unit direction of the object's nose */
    double half_length_m, half_width_m;
};

/* Computes the scene's relief; *relief is NULL where there is none. footprints: of the scene's
 * objects. On success the relief is to be given to relief_release. Errors: INPUT (too steep, too
 * high, finer than the grid can hold, scour around an unknown object; with a smooth seabed or a
 * coherent map), MEMORY. */
sonject_status relief_create(struct relief **relief, struct report *report,
                             const struct scene *scene, const struct patch_view *view,
                             double first_row, double first_column,
                             const struct footprint *footprints);
void relief_release(struct relief **relief);

/* Returns the height at a point of the view, m; 0 outside, or where relief is NULL. */
double relief_height(const struct relief *relief, double x_m, double y_m);

/* Return the places of a row and a column of the grid in the view, m. */
double relief_x(const struct relief *relief, uint32_t row);
double relief_y(const struct relief *relief, uint32_t column);

/* Sets slopes, lowest_m and highest_m from the heights. */
void relief_finish(struct relief *relief);

bool scene_has_relief(const struct scene *scene);

#endif
