/* Sound in a sea by the reference (reference_layers.h): straight from the sonar and from its images
 * in seabed and sea surface, through layers or none, and the glints of a sphere that it makes. Each
 * call after sea_ready. */
#ifndef SONJECT_TESTS_LAYERED_SEA_H
#define SONJECT_TESTS_LAYERED_SEA_H

#include "reference_layers.h"
#include "sea.h"

#define ALTITUDE  20.0   /* of the sonar, m */
#define REFERENCE 1500.0 /* sound speed of the image processor, m/s */

/* As sea_open, at ALTITUDE, with the layers copied. */
struct sea *layered_sea_open(size_t rows, size_t columns, double middle_range_m,
                             const struct water_layer *layers, size_t count);

/* The sonar and its images of up to two bounces. */
enum image_of_sonar {
    SONAR,
    BY_SEABED,
    BY_SURFACE,
    BY_SURFACE_AND_SEABED, /* the last bounce is the seabed */
    BY_SEABED_AND_SURFACE,
    IMAGES
};
uint32_t bounces_of(enum image_of_sonar image);
struct reference_way way_from(const struct sea *sea, enum image_of_sonar image);
struct reference_sound sound_from(const struct sea *sea, enum image_of_sonar image, double range,
                                  double height);

/* On the seabed, where it appears at a range; area: of a resolution cell there, m2 (dt/dy = p). */
struct reference_sound sound_on_seabed(const struct sea *sea, double processor_range, double *area);

/* Amplitude of a target of unit cross-section there, out by one way and home by another, and what
 * planes between layers of unlike density leave of it (Rayleigh's reflection, one way each). */
double gain_of(const struct sea *sea, struct reference_sound out, struct reference_sound home);

/* One family's echo of the first object, a sphere: a/2 at the point of the shortest time, both ray
 * tubes and all mirrors; nearest: that point's, over the horizontal. */
struct family {
    double complex amplitude;
    double range; /* the processor's */
};
struct family family_of(const struct sea *sea, enum image_of_sonar out, enum image_of_sonar home);

/* Compares level and phase of the line with those of all families within the limit of
 * interactions, seen through the pulse, at the range of each pair of up to so many bounces. */
void expect_families(const struct sea *sea, const struct line *line, uint32_t bounces);

/* Energy of all families of a rough sphere by one image over the straight one's: the reverse of a
 * path by a mirror is the same echo, twice the amplitude. */
double rough_ratio(const struct sea *sea, enum image_of_sonar image, double reflection);

#endif
