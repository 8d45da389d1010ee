/* Incoherent sound between a seabed, a body over it and the sea surface, computed as plainly as
 * possible in double precision. The library's chains are compared with it and share nothing with it
 * but the physics. Rays leave the sonar all ways, upwards too, so every path is found in the
 * direction in which sound runs, from the sea surface on as well.
 *
 * A ray of the fan stands for the area dA = width x r1 x (elevation step) across it at its first
 * hit, r1 away. Patterns are 1. A path over X1 ... Xk brings
 *   E = dA / r1^2 x [product over i < k of f_i cos(theta_i) / pdf_i] x f_k cos(theta_k) / r_s^2,
 * times half its length to the fourth power. f = mu (Lambert). r_s is the distance from Xk to the
 * source, which moves with the ray. */
#ifndef SONJECT_TESTS_REFERENCE_PATHS_H
#define SONJECT_TESTS_REFERENCE_PATHS_H

#include "sea.h"

#define REFERENCE_ORDERS  3
#define REFERENCE_BINS    16
#define REFERENCE_BATCHES 32

/* ---- surfaces ---- */

struct reference_vector {
    double x, y, z;
};

struct reference_vector reference_sum(struct reference_vector a, double scale,
                                      struct reference_vector b); /* a + scale b */
double reference_dot(struct reference_vector a, struct reference_vector b);

enum reference_shape {
    REFERENCE_SPHERE,  /* of a radius */
    REFERENCE_CAPSULE, /* along the nose; the length (>= 2 radius) includes the round ends */
    REFERENCE_CYLINDER /* along the nose, with flat ends */
};

/* A body, lengths in m. `axes` are orthonormal: nose, own y, own z. lambert: mu; albedo: pi mu. */
struct reference_body {
    enum reference_shape shape;
    struct reference_vector centre, axes[3];
    double length, radius, lambert;
};

/* The surfaces that a path meets: digits of its number to the base 5, those of first hits first. */
enum reference_surface {
    MET_NOTHING,
    MET_SEABED,
    MET_TARGET,
    MET_SURFACE, /* the sea surface's rough part */
    MET_MIRROR   /* the sea surface's smooth part */
};
#define REFERENCE_PATHS 125

/* The seabed z = 0, the sonar (x, 0, altitude), one body. Lambert's law holds everywhere, for the
 * sea surface times D(i) D(s), D = 1 - exp(-P^2), P = phase * cosine. The sea surface's mirror has
 * R^2 exp(-P^2). A reflection of 0 means no mirror and D = 1. */
struct reference_scene {
    double altitude, depth; /* depth INFINITY: no sea surface */
    double seabed_lambert;
    double surface_lambert, reflection, phase;
    bool rough_is_apart; /* the surface's rough part has D = 1 beside a mirror, too */
    struct reference_body body;
    double source_side;    /* of a square source with one edge along x; 0: a point source */
    double source_grazing; /* of the square's normal, rad; the square is heard only on that side */
};

/* `point` is lifted off the surface by a nanometre, ready to start another ray. `normal` faces the
 * side that the ray came from. */
struct reference_hit {
    double distance;
    struct reference_vector point, normal;
};

/* Finds the nearest surface along a ray of unit direction that starts outside the body. The sea
 * surface is always MET_SURFACE. */
enum reference_surface reference_nearest(const struct reference_scene *scene,
                                         struct reference_vector origin,
                                         struct reference_vector direction,
                                         struct reference_hit *hit);

/* Returns whether the body lies between two points. */
bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to);

/* ---- paths ---- */

struct reference_request {
    double first_x, last_x; /* along-track range of the columns that count */
    /* The seabed where a path may begin, as for the library's fan: ground ranges, and the distance
     * from the body along x. */
    double near_ground, far_ground, reach_x;
    struct ranges ranges; /* ranges of half the path length, at most REFERENCE_BINS */
    bool is_focused; /* a path's column is halfway between first and last hit, with the receiver
                        broadside of it. That lengthens the first leg, but its angles stay. */
    uint64_t rays;
};

/* Energies in m^2 over the whole track, by number of the path and range, from 32 batches. */
struct reference_energy {
    struct estimate in_first[REFERENCE_PATHS]
                            [REFERENCE_BINS]; /* the first hit's column must count */
    struct estimate in_both[REFERENCE_PATHS][REFERENCE_BINS]; /* the last hit's must count, too */
};

/* Sets the scene and its track from a sea with one object and no layers, after sea_ready. */
void reference_of_sea(const struct sea *sea, enum reference_shape shape,
                      struct reference_scene *scene, struct reference_request *request);

void reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                     struct reference_energy *energy);

/* Returns the number of surfaces that a path meets, and gives them in turn. */
int reference_met(int path, int met[REFERENCE_ORDERS]);

#endif
