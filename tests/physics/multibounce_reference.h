/* Sound over two smooth rigid faces, in double precision. The integral of physical optics is summed
 * over points of the last face. The integral over the first face is taken by stationary phase,
 * which is geometrical optics. None of the kernels' rays, tubes and caustics is used. */
#ifndef SONJECT_TESTS_MULTIBOUNCE_REFERENCE_H
#define SONJECT_TESTS_MULTIBOUNCE_REFERENCE_H

#include "sea.h"

/* The kinds of faces, with the two coordinates of each. */
enum face_kind {
    FACE_PLANE,      /* m along nose and own y */
    FACE_SPHERE,     /* rad over its own x-y plane, and in that plane from own x to own y */
    FACE_INSIDE_TUBE /* m along the nose, rad from own y to own z about it */
};

struct face {
    uint32_t part;
    enum face_kind kind;
    double radius;            /* m; unused for planes */
    double first[2], last[2]; /* range of the two coordinates */
};

/* Returns the whole face of an object that is one rectangle. */
struct face face_of_plane(const struct sea *sea, uint32_t part);

/* The way of the sound: out from one height and home to another, which are the sonar's or its
 * images'. Between the faces it is straight, or folded at the seabed, a rigid mirror. */
struct multibounce_way {
    double height_out, height_home; /* m over the seabed */
    bool is_folded;
};

/* Returns the way out from the sonar and home to it, straight between the faces. */
struct multibounce_way straight_way(const struct sea *sea);

/* Returns the echo first -> last at a processor range through the pulse, all strips together, with
 * sources broadside of the mean of both points. It is normalised by the square of half the path.
 * spacing: of the last face's points, m. For each, at most one of the first face is stationary. */
double complex multibounce_echo(const struct sea *sea, const struct multibounce_way *way,
                                const struct face *first, const struct face *last, double spacing,
                                double range);

/* Returns half the length of the path over the two places, m. */
double multibounce_range(const struct multibounce_way *way, const double one[3],
                         const double other[3]);

#endif
