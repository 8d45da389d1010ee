/* Surfaces: how much sound they return, and where to. */
#ifndef SONJECT_MATERIAL_H
#define SONJECT_MATERIAL_H

#include <stdint.h>

#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* How the reflection coefficient depends on the angle. */
typedef enum sonject_reflection_kind {
    SONJECT_REFLECTION_CONSTANT = 0, /* `reflection` at every angle */
    SONJECT_REFLECTION_FLUID = 1     /* Rayleigh coefficient of a fluid half-space of density_ratio,
                                        speed_ratio and loss; `reflection` is not used */
} sonject_reflection_kind;

/* A surface returns sound in two parts that are never mixed (kernels/MATH.md).
 * Smooth: mirror-like, amplitude R(angle) exp(-P^2/2), P = 2 k roughness cos(angle).
 * Rough: scattering per area and solid angle f cos cos,
 *     f = lambert (n + 1)/2 (cos cos)^(n - 1)  +  a cone of rms slope glossy_slope about the mirror
 *     direction that returns at most the fraction glossy_albedo of the energy,
 * reduced at both angles by what the smooth part keeps, so that no more energy leaves than came. */
typedef struct sonject_material_params {
    uint32_t struct_size;
    uint32_t reflection_kind; /* sonject_reflection_kind */
    double reflection;        /* -1...1, amplitude; 0: no smooth part */
    double roughness_m;       /* rms height, >= 0 */
    double lambert; /* mu >= 0, linear; pi*mu + glossy_albedo <= reflection^2, or <= 1 where there
                       is no smooth part or it is a fluid's */
    double lambert_exponent; /* n, 1...64; 1: Lambert's law */
    double glossy_albedo;    /* 0...1 */
    double glossy_slope;     /* rms slope of the cone's facets, 0.01...1 */
    double density_ratio;    /* to the water's, 0.001...100 */
    double speed_ratio;      /* of sound, to the water's, 0.01...20 */
    double loss; /* imaginary over real part of the wavenumber, 0...1; a plane wave in the material
                    loses 54.6 * loss dB a wavelength */
} sonject_material_params;

/* Weathered steel: reflection 0.9, roughness 1 mm, mu = -10 dB, no cone. */
SONJECT_API void sonject_material_params_init(sonject_material_params *material);

/* Fills in a named material: "steel", "concrete", "rubber", "wood", "rock" for objects; "gravel",
 * "coarse sand", "medium sand", "fine sand", "silt", "clay" for sediments ('_' and '-' do for the
 * blank). Errors: ARGUMENT (NULL, unknown name; *material is unchanged). */
SONJECT_API sonject_status sonject_material_named(const char *name,
                                                  sonject_material_params *material);

/* Name number index of all that sonject_material_named knows, NULL beyond the last. Static. */
SONJECT_API const char *sonject_material_name(uint32_t index);

SONJECT_END_DECLARATIONS

#endif
