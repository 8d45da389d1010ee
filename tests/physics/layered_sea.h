/* Sound in a sea by the reference (reference_layers.h). It comes straight from the sonar or from
 * the sonar's images in seabed and sea surface, through layers or none, and makes glints on a
 * sphere. All functions but layered_sea_open are to be called after sea_ready. */
#ifndef SONJECT_TESTS_LAYERED_SEA_H
#define SONJECT_TESTS_LAYERED_SEA_H

#include "reference_layers.h"
#include "sea.h"

#define ALTITUDE  20.0   /* of the sonar, m */
#define REFERENCE 1500.0 /* sound speed of the image processor, m/s */

/* Opens a sea as sea_open does, at ALTITUDE, and copies the layers. */
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

/* Returns the sound at the place of the seabed that appears at a processor range. *area: area of a
 * resolution cell there, m2 (dt/dy = p). */
struct reference_sound sound_on_seabed(const struct sea *sea, double processor_range, double *area);

/* Returns the amplitude of a target of unit cross-section, out by one way and home by another. The
 * loss at planes between layers of unlike density counts (Rayleigh's reflection, one way each). */
double gain_of(const struct sea *sea, struct reference_sound out, struct reference_sound home);

/* A family of paths: out from one image of the sonar and home to another. The echo of the first
 * object, a sphere, is a/2 at the point of the shortest time, with both tubes and all mirrors. */
struct family {
    double complex amplitude;
    double range; /* processor range, m */
};
struct family family_of(const struct sea *sea, enum image_of_sonar out, enum image_of_sonar home);

/* Compares the line with the sum of all families within the limit of interactions, seen through the
 * pulse: level and phase, at the range of each family of up to `bounces` bounces. */
void expect_families(const struct sea *sea, const struct line *line, uint32_t bounces);

/* Returns the energy of a rough sphere's families by the sonar and one image, over that of the
 * straight family. A path by a mirror and its reverse are the same echo of twice the amplitude. */
double rough_ratio(const struct sea *sea, enum image_of_sonar image, double reflection);

#endif
