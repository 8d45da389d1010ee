/* The seabed: a plane at z = 0 whose reflectivity comes from the measured image. */
#ifndef SONJECT_SEABED_H
#define SONJECT_SEABED_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

typedef enum sonject_seabed_map {
    SONJECT_MAP_INTENSITY = 0,  /* the measured intensity as it is, speckle and all */
    SONJECT_MAP_DESPECKLED = 1, /* its local mean over a few resolution cells */
    SONJECT_MAP_COHERENT = 2    /* complex reflectivity; needs a complex image */
} sonject_seabed_map;

typedef struct sonject_seabed_params {
    uint32_t struct_size;
    uint32_t map;          /* sonject_seabed_map; what resynthesise uses as reflectivity */
    double lambert;        /* mu0, backscatter per area and solid angle at normal incidence, linear:
                              0 < mu0 <= 1/pi. Mackenzie's seabed is 10^-2.7 */
    double level_radius_m; /* radius of the smooth local mean that mu0 stands for; > 0 */
    double despeckle_radius_m; /* > 0 */
} sonject_seabed_params;

/* Mackenzie's level (-27 dB), 3 m level radius, 0.1 m despeckle radius, intensity map. */
SONJECT_API void sonject_seabed_params_init(sonject_seabed_params *seabed);

SONJECT_END_DECLARATIONS

#endif
