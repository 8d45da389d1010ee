/* Incoherent sound by several interactions, as plainly as it can be computed: the energies that the
   library's kernels are held to. It shares nothing with them but the physics:

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

#include "reference_shapes.h"

#define REFERENCE_ORDERS  8
#define REFERENCE_BINS    256
#define REFERENCE_BATCHES 32

enum reference_estimator {
    REFERENCE_CONNECT,    /* every hit is joined with a point of the source, if that is seen */
    REFERENCE_BRUTE_FORCE /* a path counts when its last ray meets the source's square */
};

/* Surfaces of a path's first and last hits. */
enum reference_ends {
    REFERENCE_SEABED_SEABED,
    REFERENCE_SEABED_OBJECT,
    REFERENCE_OBJECT_SEABED,
    REFERENCE_OBJECT_OBJECT,
    REFERENCE_ALL_ENDS, /* their sum */
    REFERENCE_ENDS
};

/* Sonar at (x, 0, altitude), x uniform from first_x to last_x, looking along
   (0, cos(elevation), -sin(elevation)), elevation (rad, downwards) uniform from first to last.
   The source is the sonar's own point (source_side 0, connecting only), or a square about it, of
   points that radiate all ways alike: one edge along x, one across x and `central`. It hides
   nothing. */
struct reference_request {
    enum reference_estimator estimator;
    int limit;     /* highest order, 1 .. REFERENCE_ORDERS */
    uint64_t rays; /* rounded down to a multiple of REFERENCE_BATCHES */
    uint64_t seed;
    double altitude;
    double first_x, last_x;
    double first_elevation, last_elevation;
    double source_side;
    struct reference_vector central;
    bool pressure; /* energies as they are; else times (half the path length)^4 */
    int bins;      /* of half the path length, 1 .. REFERENCE_BINS */
    double first_range, bin_width;
};

/* A mean over batches, and its standard error. */
struct reference_value {
    double mean, error;
};

/* Index [ends][order - 1][bin]: energies over the whole track interval. Those of `all_ranges` count
   every path, also outside the bins: meant for `pressure`, as r^4 gives rare far paths over an
   endless seabed a variance without bound. */
struct reference_energy {
    struct reference_value bins[REFERENCE_ENDS][REFERENCE_ORDERS][REFERENCE_BINS];
    struct reference_value all_ranges[REFERENCE_ENDS][REFERENCE_ORDERS];
};

/* 0; or -1 for a request out of its ranges or want of memory, *energy untouched. */
int reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                    struct reference_energy *energy);

#endif
