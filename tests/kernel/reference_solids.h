/* Where rays meet solids, in double precision and in a way of its own: every surface is a
 * polynomial of the point, which is sampled along the ray and solved; a root counts where it lies
 * on the part of the surface that the solid has. */
#ifndef SONJECT_TESTS_REFERENCE_SOLIDS_H
#define SONJECT_TESTS_REFERENCE_SOLIDS_H

#include "scene/params.h"

#include "random_rays.h"

struct solid_hit {
    double distance;     /* INFINITY: none */
    struct point normal; /* outward; of sheets and tubes towards the ray's start */
    double to_edge;      /* about how far the next other surface or rim is */
};

/* The first surface beyond minimum, all in the solid's own frame; `more`: m that every surface is
 * moved outwards. */
struct solid_hit solid_first_hit(const sonject_object_params *solid, struct point start,
                                 struct point direction, double minimum, double more);

/* Longest half size. */
double solid_size(const sonject_object_params *solid);

#endif
