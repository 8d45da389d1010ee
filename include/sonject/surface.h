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
    sonject_material_params material; /* reflection -1 for air above water; no rough part: lambert
                                         and glossy_albedo are 0 */
} sonject_surface_params;

/* No surface; material: reflection -1, smooth, no rough part. */
SONJECT_API void sonject_surface_params_init(sonject_surface_params *surface);

SONJECT_END_DECLARATIONS

#endif
