/* A bench whose water lies in layers, and sound in it by the reference (reference_layers.h). */
#ifndef SONJECT_TESTS_LAYERED_SEA_H
#define SONJECT_TESTS_LAYERED_SEA_H

#include "bench.h"
#include "reference_layers.h"

#define ALTITUDE  20.0   /* of the sonar, m */
#define REFERENCE 1500.0 /* sound speed of the image processor, m/s */

/* As bench_open, at ALTITUDE, with the layers copied. */
void layered_sea_open(struct bench *bench, size_t rows, size_t columns, double middle_range_m,
                      const struct water_layer *layers, size_t count);

/* Straight from the sonar through the water as it was laid: layers that targets reach into are one
 * (tests/unit/test_water.c). After bench_ready; valid as long as the bench's water is. */
struct reference_way way_through_bench(const struct bench *bench);

/* At a ground range and a height. */
struct reference_sound sound_in_bench(const struct bench *bench, double range, double height);

/* On the seabed, where it appears at a range; area: of a resolution cell there, m2 (dt/dy = p). */
struct reference_sound sound_on_seabed(const struct bench *bench, double apparent_range,
                                       double *area);

#endif
