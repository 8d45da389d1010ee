/* Where rays meet solids, in double precision and in a way of its own: every surface is a
 * polynomial of the point, which is sampled along the ray and solved; a root counts where it lies
 * on the part of the surface that the solid has. */
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
    TORUS      /* radius, radius of the ring */
};

struct surface {
    enum surface_kind kind;
    double numbers[4];
    double from, to; /* of x: the part that counts */
};

struct body {
    struct surface surfaces[12];
    int count;
    int is_thin;                    /* has no inside */
    int is_round;                   /* a straight part with two ends */
    double rim;                     /* radius of a disc */
    double half_length, half_width; /* of a plate */
    double size;                    /* longest half size */
};

/* Every shape that has sizes. What tests ask of rays, lanes, extents and poses they ask of all
 * rows.
 */
extern const struct solid_row {
    const char *name;
    uint32_t shape;
    /* Its surfaces, `more` m further out. */
    void (*build)(struct body *body, const sonject_object_params *solid, double more);
    /* Makes random sizes fit together, none thinner than that part of another; NULL: they do. */
    void (*fit)(sonject_object_params *solid, double thinnest);
} solid_rows[];
extern const int solid_row_count;

/* `more`: m that every surface is moved outwards. */
void body_init(struct body *body, const sonject_object_params *solid, double more);

/* Whether a point lies in it, or in the plane of a sheet on it; tubes are taken as filled. */
int body_holds(const struct body *body, struct point p);

struct solid_hit {
    double distance;     /* INFINITY: none */
    struct point normal; /* outward; of sheets and tubes towards the ray's start */
    double to_edge;      /* about how far the next other surface or rim is */
};

/* The first surface beyond minimum, all in the solid's own frame. */
struct solid_hit solid_first_hit(const sonject_object_params *solid, struct point start,
                                 struct point direction, double minimum, double more);

#endif
