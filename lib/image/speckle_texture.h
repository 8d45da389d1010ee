/* The texture that turns Rayleigh speckle into K-distributed speckle: a Gamma-distributed local
 * intensity of mean 1 (E. Jakeman and P. N. Pusey, IEEE Trans. Antennas Propag. 24, 1976). */
#ifndef SONJECT_IMAGE_SPECKLE_TEXTURE_H
#define SONJECT_IMAGE_SPECKLE_TEXTURE_H

#define TEXTURE_REACH          8 /* standard deviations */
#define TEXTURE_STEPS_PER_UNIT 256

/* Square root of the intensity that has the same quantile as a standard normal deviate. */
struct speckle_texture {
    float amplitude[2 * TEXTURE_REACH * TEXTURE_STEPS_PER_UNIT + 1];
};

/* shape: 0.01...infinity; from 10^6 on the texture is taken as constant (it departs from 1 by less
 * than 0.001). The same bits on every machine with IEEE arithmetic. */
void speckle_texture_init(struct speckle_texture *texture, double shape);

float speckle_texture_amplitude(const struct speckle_texture *texture, float deviate);

#endif
