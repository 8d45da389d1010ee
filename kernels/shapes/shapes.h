/* The list of all shapes. A row gives a shape its number, its case in the kernels and its word in
 * scene files. It also gives its row of the host (lib/scene/shapes has a file of its name) and its
 * turn in the tests. */
#ifndef SONJECT_KERNELS_SHAPES_H
#define SONJECT_KERNELS_SHAPES_H

enum shape_trait {
    SHAPE_IS_HOLLOW = 1, /* a straight way from the outer side may meet the object again; never of a
                            flat or convex shape */
};

/* ROW(number: SHAPE_ and this, name, traits). The plainest shapes have one interval. Their code is
 * inlined, since most scenes hold no others. */
#define PLAIN_SHAPES(ROW)                                                                          \
    ROW(PLANE, plane, 0)                                                                           \
    ROW(SPHERE, sphere, 0)                                                                         \
    ROW(CYLINDER, cylinder, 0)                                                                     \
    ROW(CAPSULE, capsule, 0)

#define OTHER_SHAPES(ROW)                                                                          \
    ROW(DISC, disc, 0)                                                                             \
    ROW(ELLIPSOID, ellipsoid, 0)                                                                   \
    ROW(BOX, box, 0)                                                                               \
    ROW(WEDGE, wedge, 0)                                                                           \
    ROW(CONE, cone, 0)                                                                             \
    ROW(TORUS, torus, SHAPE_IS_HOLLOW)

/* Shapes of scenes that kernels know by another name or treat apart. */
#define SCENE_SHAPES(ROW)                                                                          \
    ROW(TRUNCATED_CONE, truncated_cone, 0)                                                         \
    ROW(MESH, mesh, SHAPE_IS_HOLLOW)

/* Cylinders with ends other than flat ones. */
#define ENDED_CYLINDERS(ROW)                                                                       \
    ROW(ENDED_CYLINDER, ended_cylinder, 0) /* solid: each end is flat or a part of a sphere */     \
    ROW(OPEN_CYLINDER, open_cylinder, SHAPE_IS_HOLLOW) /* thin wall */

#define ALL_SHAPES(ROW) PLAIN_SHAPES(ROW) OTHER_SHAPES(ROW) SCENE_SHAPES(ROW)

#define SHAPE_NUMBER(NUMBER, name, traits) SHAPE_##NUMBER,
enum shape_kind {
    ALL_SHAPES(SHAPE_NUMBER) SHAPE_PARTS, /* objects of several parts, in scenes */
    ENDED_CYLINDERS(SHAPE_NUMBER)
};

#endif

/* The files of the shapes, for kernels, which define SHAPE_FILES; the host does not. Each has
 * NAME_interval for a plain shape or NAME_spans for another, and NAME_normal, in the object's own
 * frame. Normals are outward and unit; those of sheets are on the side that the ray comes from. */
#if defined(SHAPE_FILES) && !defined(SONJECT_KERNELS_SHAPE_FILES)
#define SONJECT_KERNELS_SHAPE_FILES

#include "shapes/box.h"
#include "shapes/capsule.h"
#include "shapes/cone.h"
#include "shapes/cylinder.h"
#include "shapes/disc.h"
#include "shapes/ellipsoid.h"
#include "shapes/ended_cylinder.h"
#include "shapes/plane.h"
#include "shapes/sphere.h"
#include "shapes/torus.h"

#endif
