/* Synthetic seabeds. */
#ifndef SONJECT_IMAGE_SYNTHETIC_H
#define SONJECT_IMAGE_SYNTHETIC_H

#include "scene/params.h"

#include "base/report.h"

/* Fills pixels (rows x columns amplitudes, or complex values as pairs of floats) with a seabed. The
 * same parameters give the same bits on every machine. along_track_resolution_m: first zero of the
 * sinc response; range_resolution_m: half-power width of the Gaussian response. Errors: MEMORY. */
sonject_status synthesise_seabed(struct report *report, const sonject_synthetic_params *synthetic,
                                 const sonject_geometry_params *geometry,
                                 double along_track_resolution_m, double range_resolution_m,
                                 float *pixels);

/* The texture that turns Rayleigh speckle into K-distributed speckle: a Gamma-distributed local
 * intensity of mean 1 (E. Jakeman and P. N. Pusey, IEEE Trans. Antennas Propag. 24, 1976). */

#define TEXTURE_REACH          8 /* standard deviations */
#define TEXTURE_STEPS_PER_UNIT 256

/* A table over normal deviates: the square root of the intensity at the deviate's quantile. */
struct speckle_texture {
    float amplitude[2 * TEXTURE_REACH * TEXTURE_STEPS_PER_UNIT + 1];
};

/* Fills the table. shape: 0.01...infinity; from 10^6 on the texture is constant (it departs from 1
 * by less than 0.001). The bits are the same on every machine with IEEE arithmetic. */
void speckle_texture_init(struct speckle_texture *texture, double shape);

float speckle_texture_amplitude(const struct speckle_texture *texture, float deviate);

#endif
