/* The seabed, whose reflectivity comes from the measured image: the plane z = 0, or a relief about
 * it (sonject_scene_set_relief, seabed.relief of scene files). */
#ifndef SONJECT_SEABED_H
#define SONJECT_SEABED_H

#include <stdint.h>

#include <sonject/export.h>
#include <sonject/material.h>

SONJECT_BEGIN_DECLARATIONS

/* What resynthesise uses as reflectivity. */
typedef enum sonject_seabed_map {
    SONJECT_MAP_INTENSITY = 0,  /* the measured intensity as it is, speckle and all */
    SONJECT_MAP_DESPECKLED = 1, /* its local mean over a few resolution cells */
    SONJECT_MAP_COHERENT = 2    /* complex reflectivity; needs a complex image */
} sonject_seabed_map;

/* What scatters sound at the seabed that does not come straight from the sonar and go straight
 * back, as between seabed and target. */
typedef enum sonject_forward_rule {
    SONJECT_FORWARD_MODEL = 0, /* the material `forward` alone */
    SONJECT_FORWARD_MAP = 1 /* the material, its rough part times the measured reflectivity as for
                               sound that goes straight back */
} sonject_forward_rule;

typedef struct sonject_seabed_params {
    uint32_t struct_size;
    uint32_t map;          /* sonject_seabed_map; what resynthesise uses as reflectivity */
    double lambert;        /* mu0, backscatter per area and solid angle at normal incidence, linear:
                              0 < mu0 <= 1/pi. Mackenzie's seabed is 10^-2.7 */
    double level_radius_m; /* radius of the smooth local mean that mu0 stands for; > 0 */
    double despeckle_radius_m; /* > 0 */
    uint32_t forward_rule;     /* sonject_forward_rule */
    uint32_t reserved;
    sonject_material_params forward; /* its lambert: NaN stands for the seabed's own mu0. Its rough
                                        part is the same at every angle, smooth part or not */
} sonject_seabed_params;

/* Mackenzie's level (-27 dB), 3 m level radius, 0.1 m despeckle radius, intensity map; forward: the
 * same Lambert's law, no smooth part. */
SONJECT_API void sonject_seabed_params_init(sonject_seabed_params *seabed);

SONJECT_END_DECLARATIONS

#endif
