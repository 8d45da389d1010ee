/* Sound through level layers, summed up as plainly as possible: Snell's law layer by layer along
   the folded path, in long double, found by bisection. The library's water is compared with it and
   shares nothing with it but the list of layers.

   With p = cos/c the same everywhere and h the height crossed in a layer, however often,
     r = sum of h c p / sin,   t = sum of h / (c sin),   dr/dp = sum of h c / sin^3.
   A source of unit intensity at 1 m sends cos d(angle) d(azimuth) into a tube. The tube's area
   across the ray at the other end is r d(azimuth) sin dr. Planes between layers pass everything. */
#ifndef SONJECT_TESTS_REFERENCE_LAYERS_H
#define SONJECT_TESTS_REFERENCE_LAYERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "medium/water.h"

/* The layers, and the way of sound from the sonar: by `bounces` mirrors in turn. The last mirror is
   the seabed (at 0) or the sea surface (at depth). */
struct reference_way {
    const struct water_layer *layers; /* borrowed */
    size_t count;
    double sonar_height, depth;
    uint32_t bounces;
    bool comes_from_seabed;
};

/* A ray from the sonar to a height, in m, s and rad. */
struct reference_ray {
    long double range, time, length;
    long double growth; /* derivative of the range with p */
};

#define REFERENCE_BOUNCES_MAX 4

/* Returns the height that is crossed in a layer on the way to `height`, m. */
long double reference_crossed(const struct reference_way *way, size_t layer, double height);

/* Returns the sums along the ray of p = cos/c. */
struct reference_ray reference_sum(const struct reference_way *way, double height, long double p);

double reference_speed_at(const struct reference_way *way, double height);

/* Returns the largest sound speed on the way to a height. p stays below its reciprocal. */
double reference_fastest(const struct reference_way *way, double height);

/* Returns p of the ray to a point. */
long double reference_parameter(const struct reference_way *way, double range, double height);

/* Returns p of the ray that meets the seabed after a time. */
long double reference_parameter_of_time(const struct reference_way *way, long double time);

/* Sound at a point of the lowest layer. */
struct reference_sound {
    double time;
    double grazing;   /* grazing angle of its direction, positive downwards */
    double wavefront; /* radius of the wavefront in elevation */
    double out, home; /* intensities at the point from the sonar, and at the sonar from the point */
};

struct reference_sound reference_sound_at(const struct reference_way *way, double range,
                                          double height);

#endif
