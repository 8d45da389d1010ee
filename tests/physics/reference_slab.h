/* Incoherent sound between a seabed, a sphere over it and the sea surface, in plain double
 * precision: what the library's chains by way of the sea surface are held to. It shares nothing
 * with them but the physics. Rays leave the sonar all ways, upwards too, so every path is found in
 * the direction in which it is run, from the sea surface on as well. */
#ifndef SONJECT_TESTS_REFERENCE_SLAB_H
#define SONJECT_TESTS_REFERENCE_SLAB_H

#include <stdint.h>

#include "estimate.h"

#define SLAB_ORDERS  3
#define SLAB_BINS    16
#define SLAB_BATCHES 32

/* What a path meets, in turn: digits of a number to the base 5, the first hit's first. */
enum slab_hit {
    SLAB_SEABED = 1,
    SLAB_TARGET = 2,
    SLAB_SURFACE = 3, /* its rough part */
    SLAB_MIRROR = 4   /* its smooth part */
};

#define SLAB_PATHS 125

/* Seabed z = 0, sonar (x, 0, altitude), sphere over x = 0. Lambert's law everywhere, lambert is mu;
 * the surface's times D(i) D(s), D = 1 - exp(-P^2), and its mirror R^2 exp(-P^2), P = phase *
 * cosine, unless reflection is 0: then it has no mirror and D = 1. */
struct slab_scene {
    double altitude, depth;
    double seabed_lambert;
    double surface_lambert, reflection, phase;
    int rough_is_apart; /* the surface's rough part is Lambert's law beside a mirror too */
    double centre_y, centre_z, radius, target_lambert;
    double source_side;    /* of a square source, 0: a point; one edge along x, one across */
    double source_grazing; /* its normal's, rad; it is heard before it alone */
};

struct slab_request {
    double half_track; /* columns from -half_track to half_track are counted */
    /* where seabed must be that a path begins on: the library's fan looks there */
    double near_ground, far_ground, reach_x;
    double first_range, bin_width;
    int bins;
    int is_focused; /* columns in the middle between first and last hit, receiver abreast of it:
                       that lengthens the first leg, whose angles stay those of its own column */
    uint64_t rays, seed;
};

/* Energies in m^2 over the whole track by number of the path and range. */
struct slab_energy {
    struct estimate in_first[SLAB_PATHS][SLAB_BINS]; /* column of the first hit */
    struct estimate in_both[SLAB_PATHS][SLAB_BINS]; /* where that of the last is on the track too */
};

void slab_trace(const struct slab_scene *scene, const struct slab_request *request,
                struct slab_energy *energy);

#endif
