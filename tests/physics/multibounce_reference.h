/* Sound over two smooth rigid faces, in double precision: physical optics' integral over the last
 * face in points, that over the first by stationary phase, which is geometrical optics; with none
 * of the kernels' rays, tubes and caustics. */
#ifndef SONJECT_TESTS_MULTIBOUNCE_REFERENCE_H
#define SONJECT_TESTS_MULTIBOUNCE_REFERENCE_H

#include "sea.h"

/* A part by two coordinates of its own. */
enum face_kind {
    FACE_PLANE,      /* m along nose and own y */
    FACE_SPHERE,     /* rad over its own x-y plane, and in that from own x to own y */
    FACE_INSIDE_TUBE /* m along the nose, rad from own y to own z about it */
};

struct face {
    uint32_t part;
    enum face_kind kind;
    double radius;            /* m, but of planes */
    double first[2], last[2]; /* coordinates */
};

/* All of the rectangle that an object of one part is. */
struct face face_of_plane(const struct sea *sea, uint32_t part);

/* Which way sound goes: from one height out, to another home (the sonar's or its images'), and
 * between the faces straight or by way of the seabed, a rigid mirror. */
struct multibounce_way {
    double height_out, height_home; /* m over the seabed */
    bool is_folded;
};

/* Out from the sonar and home to it, straight between the faces. */
struct multibounce_way straight_way(const struct sea *sea);

/* The echo first -> last at a processor range through the pulse, all strips together, of sources
 * broadside of the mean of both points; normalised by the square of half the path. spacing: of the
 * last face's points, m. Of the first face's points one at most is stationary for each. */
double complex multibounce_echo(const struct sea *sea, const struct multibounce_way *way,
                                const struct face *first, const struct face *last, double spacing,
                                double range);

/* Half the shortest path over the two places. */
double multibounce_range(const struct multibounce_way *way, const double one[3],
                         const double other[3]);

#endif
