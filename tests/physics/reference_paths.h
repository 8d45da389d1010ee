/* Incoherent sound between a seabed, a body over it and the sea surface, as plainly as it can be
 * computed, in double precision: what the library's chains are held to. It shares nothing with them
 * but the physics. Rays leave the sonar all ways, upwards too, so every path is found in the
 * direction in which it is run, from the sea surface on as well:
 *
 * A ray of the fan stands for the area dA = width x r1 x (elevation step) across it at its first
 * hit, r1 away. A path over X1 ... Xk brings, one-way patterns being 1,
 *   E = dA / r1^2 x [product over i < k of f_i cos(theta_i) / pdf_i] x f_k cos(theta_k) / r_s^2,
 * f = mu (Lambert), r_s from Xk to the source, which moves with the ray; times half its length to
 * the fourth power. */
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
    REFERENCE_SPHERE,  /* radius */
    REFERENCE_CAPSULE, /* length with its round ends (>= 2 radius), radius; along the nose */
    REFERENCE_CYLINDER /* length, radius; flat ends; along the nose */
};

/* Lengths in m. `axes` are orthonormal: nose, own y, own z. lambert is mu, albedo pi mu. */
struct reference_body {
    enum reference_shape shape;
    struct reference_vector centre, axes[3];
    double length, radius, lambert;
};

/* What a path meets, in turn: digits of a number to the base 5, the first hit's first. */
enum reference_surface {
    MET_NOTHING,
    MET_SEABED,
    MET_TARGET,
    MET_SURFACE, /* its rough part */
    MET_MIRROR   /* its smooth part */
};
#define REFERENCE_PATHS 125

/* Seabed z = 0, sonar (x, 0, altitude), one body. Lambert's law everywhere; the surface's times
 * D(i) D(s), D = 1 - exp(-P^2), and its mirror R^2 exp(-P^2), P = phase * cosine, unless reflection
 * is 0: then it has no mirror and D = 1. */
struct reference_scene {
    double altitude, depth; /* depth INFINITY: no sea surface */
    double seabed_lambert;
    double surface_lambert, reflection, phase;
    bool rough_is_apart; /* the surface's rough part is Lambert's law beside a mirror too */
    struct reference_body body;
    double source_side;    /* of a square source, 0: a point; one edge along x, one across */
    double source_grazing; /* its normal's, rad; it is heard before it alone */
};

/* `point` is lifted off the surface by a nanometre, ready to start another ray; `normal` faces the
 * side that the ray came from. */
struct reference_hit {
    double distance;
    struct reference_vector point, normal;
};

/* The nearest surface along a ray of unit direction from outside the body; the sea surface is one.
 */
enum reference_surface reference_nearest(const struct reference_scene *scene,
                                         struct reference_vector origin,
                                         struct reference_vector direction,
                                         struct reference_hit *hit);

/* Whether the body lies between. */
bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to);

/* ---- paths ---- */

struct reference_request {
    double first_x, last_x; /* columns that are counted */
    /* where seabed must be that a path begins on: the library's fan looks there; x about the body
     */
    double near_ground, far_ground, reach_x;
    struct ranges ranges; /* of half the path length; at most REFERENCE_BINS */
    bool is_focused; /* columns in the middle between first and last hit, receiver broadside of it:
                        that lengthens the first leg, whose angles stay those of its own column */
    uint64_t rays;
};

/* Energies in m^2 over the whole track by number of the path and range, of 32 batches. */
struct reference_energy {
    struct estimate in_first[REFERENCE_PATHS][REFERENCE_BINS]; /* column of the first hit */
    struct estimate in_both[REFERENCE_PATHS][REFERENCE_BINS];  /* and that of the last is counted */
};

/* The scene of a sea with one object and level water, and its track, after sea_ready. */
void reference_of_sea(const struct sea *sea, enum reference_shape shape,
                      struct reference_scene *scene, struct reference_request *request);

void reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                     struct reference_energy *energy);

/* How many surfaces a path meets, and which. */
int reference_met(int path, int met[REFERENCE_ORDERS]);

#endif
