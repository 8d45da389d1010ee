/* What motion the navigation did not see: it defocuses synthetic apertures. SI units. */
#ifndef SONJECT_MOTION_H
#define SONJECT_MOTION_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

#define SONJECT_SWAYS_CAPACITY 8

/* amplitude_m * sin(2 pi x / wavelength_m + phase_rad), x along-track. */
typedef struct sonject_sway {
    double amplitude_m;
    double wavelength_m; /* from 10 cm */
    double phase_rad;
} sonject_sway;

/* Residual sway: horizontal, across the track, positive towards the imaged side; all of these are
 * added. Towards the seabed at grazing angle gamma the path is shorter by sway * cos(gamma). */
typedef struct sonject_motion_params {
    uint32_t struct_size;
    uint32_t sway_count; /* of sways, at most 8 */
    sonject_sway sways[SONJECT_SWAYS_CAPACITY];
    double random_rms_m;         /* of a Gaussian random sway; 0: none */
    double random_correlation_m; /* from 10 cm; autocorrelation exp(-(x / this)^2 / 2) */
    uint64_t seed;
} sonject_motion_params;

/* No motion; correlation length 1 m. */
SONJECT_API void sonject_motion_params_init(sonject_motion_params *motion);

SONJECT_END_DECLARATIONS

#endif
