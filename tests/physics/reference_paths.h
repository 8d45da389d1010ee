/* Incoherent sound by several interactions over a plane seabed with a few bodies, as plainly as it
   can be computed, in double precision: the energies that the library's kernels are held to. It
   shares nothing with them but the physics:

   A ray of the fan stands for the area dA = width x r1 x (elevation step) across it at its first
   hit, r1 away. A path over X1 ... Xk brings, one-way patterns being 1,
     E = dA / r1^2 x [product over i < k of f_i cos(theta_i) / pdf_i] x f_k cos(theta_k) / r_s^2,
   f = mu (Lambert), pdf = cos(theta) / pi, r_s from Xk to the source, which moves with the ray.
   Order 1 of a plain seabed is so mu sin(grazing) dA / r^4, times r^4 in a target-strength image.
 */
#ifndef SONJECT_TESTS_REFERENCE_PATHS_H
#define SONJECT_TESTS_REFERENCE_PATHS_H

#include <stdbool.h>
#include <stdint.h>

#include "estimate.h"

#define REFERENCE_OBJECTS 8
#define REFERENCE_ORDERS  8
#define REFERENCE_BINS    256
#define REFERENCE_BATCHES 32

/* ---- surfaces ---- */

struct reference_vector {
    double x, y, z;
};

enum reference_shape {
    REFERENCE_SPHERE,  /* radius */
    REFERENCE_CAPSULE, /* length with its round ends (>= 2 radius), radius; along the nose */
    REFERENCE_CYLINDER /* length, radius; flat ends; along the nose */
};

/* Lengths in m. `axes` are orthonormal: nose, own y, own z. `lambert` is mu, albedo pi mu. */
struct reference_object {
    enum reference_shape shape;
    struct reference_vector centre;
    struct reference_vector axes[3];
    double length, radius;
    double lambert;
};

/* The seabed is all of the plane z = 0. */
struct reference_scene {
    double seabed_lambert;
    int object_count; /* 0 .. REFERENCE_OBJECTS */
    struct reference_object objects[REFERENCE_OBJECTS];
};

/* `normal` faces the side that the ray came from, so closed bodies may hold a sonar. `point` is
   lifted off the surface by a nanometre, ready to start another ray. */
struct reference_hit {
    double distance;
    struct reference_vector point, normal;
    double lambert;
    bool on_object;
};

struct reference_vector reference_vector(double x, double y, double z);
struct reference_vector reference_sum(struct reference_vector a, double scale,
                                      struct reference_vector b); /* a + scale b */
double reference_dot(struct reference_vector a, struct reference_vector b);
struct reference_vector reference_cross(struct reference_vector a, struct reference_vector b);
struct reference_vector reference_unit(struct reference_vector a);

/* An unturned object at the origin, its nose along x; other sizes 0. The scene must have room. */
struct reference_object *reference_add_object(struct reference_scene *scene,
                                              enum reference_shape shape, double radius,
                                              double lambert);

/* Nearest surface along a ray of unit direction; false, and *hit untouched, if there is none. */
bool reference_nearest(const struct reference_scene *scene, struct reference_vector origin,
                       struct reference_vector direction, struct reference_hit *hit);

/* Whether anything lies between. */
bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to);

/* ---- paths ---- */

/* Surfaces of a path's first and last hits. */
enum reference_ends {
    REFERENCE_SEABED_SEABED,
    REFERENCE_SEABED_OBJECT,
    REFERENCE_OBJECT_SEABED,
    REFERENCE_OBJECT_OBJECT,
    REFERENCE_ENDS
};

/* Sonar at (x, 0, altitude), x uniform from first_x to last_x, looking along
   (0, cos(elevation), -sin(elevation)), elevation (rad, downwards) uniform from first to last.
   Every hit is joined with the sonar's own point, if that is seen. */
struct reference_request {
    int limit;     /* highest order, 1 .. REFERENCE_ORDERS */
    uint64_t rays; /* rounded down to a multiple of REFERENCE_BATCHES */
    uint64_t seed;
    double altitude;
    double first_x, last_x;
    double first_elevation, last_elevation;
    bool pressure; /* energies as they are; else times (half the path length)^4 */
    int bins;      /* of half the path length, 1 .. REFERENCE_BINS */
    double first_range, bin_width;
};

/* Index [ends][order - 1][bin]: energies over the whole track interval, of 32 batches. Those of
   `all_ranges` count every path, also outside the bins: meant for `pressure`, as r^4 gives rare far
   paths over an endless seabed a variance without bound. */
struct reference_energy {
    struct estimate bins[REFERENCE_ENDS][REFERENCE_ORDERS][REFERENCE_BINS];
    struct estimate all_ranges[REFERENCE_ENDS][REFERENCE_ORDERS];
};

void reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                     struct reference_energy *energy);

#endif
