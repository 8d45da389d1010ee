/* A second way to find where rays meet solids, in double precision. Every surface is a polynomial
 * of the point, which is sampled along the ray and solved. A root counts where it lies on the part
 * of the surface that the solid has. */
#ifndef SONJECT_TESTS_REFERENCE_SOLIDS_H
#define SONJECT_TESTS_REFERENCE_SOLIDS_H

#include "scene/params.h"

#include "random_rays.h"

enum surface_kind {
    PLANE,     /* numbers: normal, offset */
    BALL,      /* centre along x, radius */
    TUBE,      /* about x: radius */
    ELLIPSOID, /* three semi-axes */
    CONE,      /* about z: radius at z = 0, its growth with z */
    TORUS      /* radius of the ring, radius of its tube */
};

struct surface {
    enum surface_kind kind;
    double numbers[4];
    double from, to; /* range of x that counts */
};

struct body {
    struct surface surfaces[12];
    int count;
    int is_thin;                    /* 1: has no inside */
    int is_round;                   /* 1: has a straight part with two ends */
    double rim;                     /* radius of a disc */
    double half_length, half_width; /* half sizes of a plate */
    double size;                    /* longest half size */
};

/* Every shape that has sizes. Tests of rays, lanes, extents and poses go through all rows. */
extern const struct solid_row {
    const char *name;
    uint32_t shape;
    /* Adds the surfaces, `more` m further out. */
    void (*build)(struct body *body, const sonject_object_params *solid, double more);
    /* Makes random sizes fit together, none below `thinnest` times another. NULL: all fit. */
    void (*fit)(sonject_object_params *solid, double thinnest);
} solid_rows[];
extern const int solid_row_count;

/* Builds the body of a solid. more: m that every surface is moved outwards. */
void body_init(struct body *body, const sonject_object_params *solid, double more);

/* Returns whether a body or filled tube holds a point. Points for sheets must be in their plane. */
int body_holds(const struct body *body, struct point p);

struct solid_hit {
    double distance;     /* INFINITY: no hit */
    struct point normal; /* outward; of sheets and tubes towards the ray's start */
    double to_edge;      /* approximate distance to the next other surface or rim */
};

/* Returns the first hit beyond minimum, all in the solid's own frame. more: as in body_init. */
struct solid_hit solid_first_hit(const sonject_object_params *solid, struct point start,
                                 struct point direction, double minimum, double more);

#endif
