/* Objects placed on the seabed under a patch: centre, axes and extents of each of their parts. An
 * object of one shape is its own only part. */
#ifndef SONJECT_SCENE_PLACEMENT_H
#define SONJECT_SCENE_PLACEMENT_H

#include "scene/patch_view.h"
#include "scene/relief.h"
#include "scene/scene.h"
#include "scene/shapes/shape.h"

/* One part. */
struct placement {
    uint32_t shape;                   /* enum shape_kind */
    uint32_t object;                  /* number of the object that it belongs to */
    sonject_material_params material; /* the scene's, with the relief that fouls it */
    double centre[3];  /* m: x of the view, horizontal range from the track, height */
    double axes[3][3]; /* rows: nose, own y, own z, in view coordinates */
    struct shape_size size;
    double bounding_radius_m; /* size's */
};

/* Its parts lie one after the other. */
struct placed_object {
    uint32_t first_part, part_count;
    double origin[3];       /* of its own frame; the centre of an object of one shape */
    double bottom_m, top_m; /* heights of its lowest and highest point over the mean seabed */
    double seabed_m;        /* height of the seabed under its origin, which it rests on */
    double size_m;          /* the largest of its sizes along x, y and z */
};

struct placements {
    struct placement *parts; /* owned */
    uint32_t part_count;
    struct placed_object *objects; /* owned; the scene's, in their order */
    uint32_t object_count;
    struct relief *relief; /* owned; NULL: the seabed is the plane */
};

/* Places all objects. first_row, first_column: of the patch in the swath, for positions in swath
 * pixels. The materials are borrowed from the scene. On success to be given to placements_clear; on
 * failure nothing is held. All wrong objects are told, a line each. Errors: INPUT (more shapes than
 * SCENE_SHAPES_MAX, an object without parts, outside the patch, larger than it, smaller than half a
 * wavelength, prouder than it is high, up to the sonar), MEMORY. */
sonject_status placements_init(struct placements *placements, struct report *report,
                               const struct scene *scene, const struct patch_view *view,
                               double first_row, double first_column);
void placements_clear(struct placements *placements);

/* Rows: nose, own y, own z, in the axes that the angles (rad) are counted in: heading turns x
 * towards y, pitch raises the nose, roll turns about it. */
void turn_axes(double axes[3][3], double heading, double pitch, double roll);

/* Rows of `inner`, given in the axes that the rows of `outer` are, in those that outer's are given
 * in. product may not be one of both. */
void compose_axes(double product[3][3], double inner[3][3], double outer[3][3]);

/* Nose, own y and own z of an object in the axes of a view. */
void object_axes(double axes[3][3], const sonject_object_params *object, bool is_mirrored);

/* How far a part reaches from its centre along a unit direction of the view. */
double placement_extent(const struct placement *placement, const double direction[3]);

/* The same both ways: the part lies within so much of its centre along a line. */
double placement_half_extent(const struct placement *placement, const double direction[3]);

/* Slant range in m (straight: travel time times the sound speed there) from the track broadside of
 * the centre to the centre. */
double placement_range(const struct placement *placement, const struct patch_view *view);

/* Grazing angle, rad, of the ray to the centre (medium/water.h). */
double placement_grazing(const struct placement *placement, const struct patch_view *view);

/* Ground range at which the shadow of the part's top ends on ground of a height; that of its far
 * end where nothing of it stands over that. */
double placement_shadow_end(const struct placement *placement, const struct patch_view *view,
                            double ground_m);

/* The highest point of an object of the scene, wherever it lies; 0 if it has no part. Errors:
 * MEMORY. */
sonject_status object_top(const struct scene *scene, struct report *report, uint32_t object,
                          double *top_m);

/* ---- The pose of a real aperture's array. */

/* Rows: the long side, which points ahead in the view, the beam, and the other side, in the view's
 * axes. is_mirrored: the view's. */
void sonar_array_axes(double axes[3][3], const sonject_sonar_params *sonar, bool is_mirrored);

/* Whether the long side does not lie along the track. */
bool sonar_array_is_turned(const sonject_sonar_params *sonar);

#endif
