/* The backscatter of sediments: "APL-UW High-Frequency Ocean Environmental Acoustic Models
 * Handbook", TR 9407 (1994), section IV, after D. R. Jackson, D. P. Winebrenner, A. Ishimaru, J.
 * Acoust. Soc. Am. 79 (1986) and P. D. Mourad, D. R. Jackson, Oceans '89. The model is made for 10
 * to 100 kHz. It predicts well-known sand and silt to about 3 dB there. */
#ifndef SONJECT_SCENE_SEDIMENT_H
#define SONJECT_SCENE_SEDIMENT_H

#define GRAIN_SIZE_LEAST_PHI (-1.0)
#define GRAIN_SIZE_MOST_PHI  9.0

/* A sediment: a fluid with a rough surface and grains that scatter. */
struct sediment {
    double density_ratio, speed_ratio, loss; /* the members of sonject_material_params */
    double volume;   /* scattering of the volume over its attenuation, sigma2 */
    double strength; /* strength of the relief's spectrum, w2, cm^4: w2 (K cm)^-3.25 */
};

/* Returns the sediment of a mean grain size. */
struct sediment sediment_of_grain_size(double phi);

/* Returns the cross-section per m^2 and solid angle, straight back. */
double sediment_backscatter(const struct sediment *sediment, double wavelength_m,
                            double grazing_rad);

/* Returns the mu of Lambert's law that scatters as much at that angle, at most 1/pi. */
double sediment_lambert(double phi, double wavelength_m, double grazing_rad);

#endif
