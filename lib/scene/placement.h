/* Objects placed on the seabed under a patch: centre, axes and extents. */
#ifndef SONJECT_SCENE_PLACEMENT_H
#define SONJECT_SCENE_PLACEMENT_H

#include "scene/patch_view.h"
#include "scene/scene.h"
#include "scene/shape_size.h"

struct placement {
    double centre[3];  /* m: x of the view, horizontal range from the track, height */
    double axes[3][3]; /* rows: nose, own y, own z, in view coordinates */
    struct shape_size size;
    double bounding_radius_m; /* size's */
};

/* Errors: INPUT (centre outside the patch, larger than the patch, prouder than it is high).
 * first_row, first_column: of the patch in the swath, for positions in swath pixels. */
sonject_status placement_init(struct placement *placement, struct report *report,
                              const struct patch_view *view, double first_row, double first_column,
                              const sonject_object_params *object);

/* How far the object reaches from its centre along a unit direction of the view. */
double placement_extent(const struct placement *placement, uint32_t shape,
                        const double direction[3]);

/* The same both ways: the object lies within so much of its centre along a line. */
double placement_half_extent(const struct placement *placement, uint32_t shape,
                             const double direction[3]);

/* Depth of the object's lowest point below the seabed, however its burial is given. */
double burial_of_object(const sonject_object_params *object);

/* Slant range in m (straight: travel time times the sound speed there) from the track abreast of
 * the centre to the centre. */
double placement_range(const struct placement *placement, const struct patch_view *view);

/* Grazing angle, rad, of the sound that comes to the centre. */
double placement_grazing(const struct placement *placement, const struct patch_view *view);

/* Ground range at which the shadow of the object's top ends; that of its far end where nothing of
 * it stands over the seabed. */
double placement_shadow_end(const struct placement *placement, uint32_t shape,
                            const struct patch_view *view);

/* Height of the object's highest point over the mean seabed, wherever it lies. */
double object_top(const sonject_object_params *object);

#endif
