/* Objects placed on the seabed under a patch: centre, axes and extents of each of their parts. An
 * object of one shape is its own only part. */
#ifndef SONJECT_SCENE_PLACEMENT_H
#define SONJECT_SCENE_PLACEMENT_H

#include "scene/patch_view.h"
#include "scene/relief.h"
#include "scene/scene.h"
#include "scene/shapes/shape.h"

/* A placed part of an object. */
struct placement {
    uint32_t shape;                   /* enum shape_kind */
    uint32_t object;                  /* number of the object that owns the part */
    sonject_material_params material; /* the scene's material, with the relief of its fouling */
    double centre[3];                 /* m: x in the view, ground range from the track, height */
    double axes[3][3];                /* rows: nose, own y, own z, in view coordinates */
    struct shape_size size;
    double bounding_radius_m; /* bounding radius of size */
};

/* A placed object. Its parts lie one after the other. */
struct placed_object {
    uint32_t first_part, part_count;
    double origin[3];       /* origin of its own frame; for one shape, its centre */
    double bottom_m, top_m; /* heights of its lowest and highest point over the mean seabed */
    double seabed_m;        /* height of the seabed under its origin, on which it rests */
    double size_m;          /* the largest of its sizes along x, y and z */
};

struct placements {
    struct placement *parts; /* owned */
    uint32_t part_count;
    struct placed_object *objects; /* owned; in the scene's order */
    uint32_t object_count;
    struct relief *relief; /* owned; NULL: the seabed is a plane */
};

/* Places all objects. first_row, first_column: the patch's place in the swath, for positions in
 * swath pixels. The materials are borrowed from the scene. On success to be given to
 * placements_clear; on failure nothing is held. All wrong objects are reported, one line each.
 * Errors: INPUT (more shapes than SCENE_SHAPES_MAX, an object without parts, outside the patch,
 * larger than it, smaller than half a wavelength, prouder than it is high, up to the sonar),
 * MEMORY. */
sonject_status placements_init(struct placements *placements, struct report *report,
                               const struct scene *scene, const struct patch_view *view,
                               double first_row, double first_column);
void placements_clear(struct placements *placements);

/* Computes axes, rows nose, own y and own z, from angles in rad: heading turns x towards y, pitch
 * raises the nose, roll turns about the nose. */
void turn_axes(double axes[3][3], double heading, double pitch, double roll);

/* Computes the rows of `inner`, which count in the axes of `outer`, in the axes that outer counts
 * in. product must be neither of the two. */
void compose_axes(double product[3][3], double inner[3][3], double outer[3][3]);

/* Computes nose, own y and own z of an object in the axes of a view. */
void object_axes(double axes[3][3], const sonject_object_params *object, bool is_mirrored);

/* Returns how far a part reaches from its centre along a unit direction of the view. */
double placement_extent(const struct placement *placement, const double direction[3]);

/* Returns the larger of a part's extents both ways along a line. */
double placement_half_extent(const struct placement *placement, const double direction[3]);

/* Returns the slant range in m from the track broadside of the centre to the centre (straight:
 * travel time times the sound speed there). */
double placement_range(const struct placement *placement, const struct patch_view *view);

/* Returns the grazing angle of the ray to the centre, rad (medium/water.h). */
double placement_grazing(const struct placement *placement, const struct patch_view *view);

/* Returns the ground range at which the shadow of the part's top ends on ground of a height, or
 * that of the part's far end if the part is not above that height. */
double placement_shadow_end(const struct placement *placement, const struct patch_view *view,
                            double ground_m);

/* Returns in *top_m the height of an object's highest point over the seabed, wherever the object
 * lies. Errors: MEMORY. */
sonject_status object_top(const struct scene *scene, struct report *report, uint32_t object,
                          double *top_m);

/* ---- The pose of a real aperture's array. */

/* Computes the axes of the array in the view: its long side, which points ahead, the beam, and the
 * other side. is_mirrored: the view's. */
void sonar_array_axes(double axes[3][3], const sonject_sonar_params *sonar, bool is_mirrored);

/* Returns whether the long side is turned from the track. */
bool sonar_array_is_turned(const sonject_sonar_params *sonar);

#endif
