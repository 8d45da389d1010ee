/* What motion the navigation did not see: it defocuses synthetic apertures. SI units. */
#ifndef SONJECT_MOTION_H
#define SONJECT_MOTION_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

#define SONJECT_SWAYS_CAPACITY 8
#define SONJECT_YAWS_CAPACITY  8

/* amplitude_m * sin(2 pi x / wavelength_m + phase_rad), x along-track. */
typedef struct sonject_sway {
    double amplitude_m;
    double wavelength_m; /* from 10 cm */
    double phase_rad;
} sonject_sway;

/* amplitude_rad * sin(2 pi x / wavelength_m + phase_rad), x along-track. */
typedef struct sonject_yaw {
    double amplitude_rad; /* within 0.1 rad */
    double wavelength_m;  /* from 10 cm */
    double phase_rad;
} sonject_yaw;

/* Residual sway: horizontal, across the track, positive towards the imaged side; all of these are
 * added. Towards the seabed at grazing angle gamma the path is shorter by sway * cos(gamma).
 *
 * Residual yaw: what the heading of an array of several hydrophones has on top of the one that the
 * processor knows, positive where the bow is turned towards the imaged side, whichever that is;
 * bias, sines, random yaw and table are added. Pings are at multiples of yaw_advance_m, and the
 * phase centres of each fill one advance around it; one that is x ahead of its ping's middle sways
 * by yaw * x. */
typedef struct sonject_motion_params {
    uint32_t struct_size;
    uint32_t sway_count; /* of sways, at most 8 */
    sonject_sway sways[SONJECT_SWAYS_CAPACITY];
    double random_rms_m;         /* of a Gaussian random sway; 0: none */
    double random_correlation_m; /* from 10 cm; autocorrelation exp(-(x / this)^2 / 2) */
    uint64_t seed;
    double yaw_advance_m; /* from ping to ping, along-track: half the length of the hydrophones'
                             array where its pings neither overlap nor leave gaps; from 10 cm; 0:
                             there is no yaw */
    double yaw_bias_rad;  /* of all pings; within 0.1 rad */
    double yaw_random_rms_rad;       /* of a Gaussian random yaw, at most 0.1 rad; 0: none */
    double yaw_random_correlation_m; /* as above */
    uint64_t yaw_seed;
    uint32_t yaw_count; /* of yaws, at most 8 */
    uint32_t reserved;  /* 0 */
    sonject_yaw yaws[SONJECT_YAWS_CAPACITY];
} sonject_motion_params;

/* No motion; correlation lengths 1 m. */
SONJECT_API void sonject_motion_params_init(sonject_motion_params *motion);

SONJECT_END_DECLARATIONS

#endif
