/* The sea surface over the scene. */
#ifndef SONJECT_SURFACE_H
#define SONJECT_SURFACE_H

#include <stdint.h>

#include <sonject/export.h>
#include <sonject/material.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_surface_params {
    uint32_t struct_size;
    uint32_t reserved;
    double water_depth_m; /* height of the surface over the mean seabed, above the sonar; 0: so far
                             away that nothing of it is heard */
    sonject_material_params
        material; /* reflection -1 for air above water; roughness_m: rms height of
                     the waves; its rough part is in the chains of several
                     interactions, where no layer bends sound below the surface;
                     glossy_albedo NaN: all that lambert leaves of what roughness
                     takes, reflection^2 - pi*lambert (fluid: 1 - pi*lambert) */
} sonject_surface_params;

/* No surface; material: reflection -1, smooth, lambert 0, glossy_albedo NaN, glossy_slope 0.2,
 * which is the sea's at 7 m/s of wind (C. Cox, W. Munk, J. Opt. Soc. Am. 44, 1954, 838). */
SONJECT_API void sonject_surface_params_init(sonject_surface_params *surface);

SONJECT_END_DECLARATIONS

#endif
