/* The energy that a surface returns: its split into a smooth and a rough part, and the directions
 * of the rough part. Directions are unit vectors away from the surface. The normal is on the side
 * that the sound is on. */
#ifndef SONJECT_KERNELS_SURFACE_H
#define SONJECT_KERNELS_SURFACE_H

#include "brdf.h"
#include "elementary.h"
#include "layout.h"
#include "vector3.h"
#include "width.h"

/* Computes Rayleigh's reflection coefficient of a fluid half-space (L. M. Brekhovskikh, Yu. P.
 * Lysanov, "Fundamentals of Ocean Acoustics", section 3.1) at the cosine of the angle of incidence:
 *     R = (m cos - s) / (m cos + s),   s = sqrt(n^2 - sin^2),   Im s >= 0,
 * m the density ratio, n the complex refractive index k2/k. */
FUNCTION void fluid_reflection(GLOBAL const struct surface_record *surface, vfloat cosine,
                               vfloat *real_part, vfloat *imaginary_part)
{
    const vfloat square_real = surface->index_real - 1.0f + cosine * cosine;
    const vfloat square_imaginary = SPLAT(surface->index_imaginary);
    const vfloat modulus =
        SQUARE_ROOT(square_real * square_real + square_imaginary * square_imaginary);
    /* The larger part of the root comes first, since it does not cancel. */
    const vfloat greater = SQUARE_ROOT(0.5f * (modulus + magnitude(square_real)));
    const vfloat lesser = 0.5f * square_imaginary / larger(greater, SPLAT(1.0e-18f));
    const mask is_propagating = MASK_OF(square_real >= 0.0f);
    const vfloat root_real = SELECT(is_propagating, greater, lesser);
    const vfloat root_imaginary = SELECT(is_propagating, lesser, greater);
    const vfloat above = surface->density_ratio * cosine;
    const vfloat sum = above + root_real;
    const vfloat square = larger(sum * sum + root_imaginary * root_imaginary, SPLAT(1.0e-30f));
    *real_part = ((above - root_real) * sum - root_imaginary * root_imaginary) / square;
    *imaginary_part = -2.0f * above * root_imaginary / square;
}

FUNCTION int has_smooth_part(GLOBAL const struct surface_record *surface)
{
    return surface->reflection_kind != REFLECTION_NONE;
}

FUNCTION int has_rough_part(GLOBAL const struct surface_record *surface)
{
    const int takes_some = surface->reflection_kind == REFLECTION_NONE || surface->rough_is_apart ||
                           surface->roughness_phase > 0.0f;
    return takes_some && (surface->lambert > 0.0f || surface->glossy_albedo > 0.0f);
}

/* Computes the complex reflection coefficient R at the cosine of the angle of incidence. */
FUNCTION void plane_reflection(GLOBAL const struct surface_record *surface, vfloat cosine,
                               vfloat *real_part, vfloat *imaginary_part)
{
    if (surface->reflection_kind == REFLECTION_FLUID) {
        fluid_reflection(surface, cosine, real_part, imaginary_part);
        return;
    }
    *real_part = SPLAT(surface->reflection);
    *imaginary_part = SPLAT(0.0f);
}

/* Computes the amplitude of the specular part, R exp(-P^2 / 2), with P = 2 k eta cos(angle). */
FUNCTION void smooth_reflection(GLOBAL const struct surface_record *surface, vfloat cosine,
                                vfloat *real_part, vfloat *imaginary_part)
{
    const vfloat phase = surface->roughness_phase * cosine;
    const vfloat kept = exponential_of_negative(-0.5f * phase * phase);
    plane_reflection(surface, cosine, real_part, imaginary_part);
    *real_part = *real_part * kept;
    *imaginary_part = *imaginary_part * kept;
}

/* Returns the largest share of incident energy that the rough part may return, pi mu + g. */
FUNCTION float rough_albedo(GLOBAL const struct surface_record *surface)
{
    return 3.14159265359f * surface->lambert + surface->glossy_albedo;
}

/* Returns the energy of the specular part, |R|^2 exp(-P^2). */
FUNCTION vfloat specular_energy(GLOBAL const struct surface_record *surface, vfloat cosine)
{
    vfloat real_part, imaginary_part;
    smooth_reflection(surface, cosine, &real_part, &imaginary_part);
    const vfloat energy = real_part * real_part + imaginary_part * imaginary_part;
    if (surface->rough_is_apart)
        return energy * (1.0f - rough_albedo(surface));
    return energy;
}

/* Returns the share of energy that roughness takes out of the specular direction, 1 - exp(-P^2). A
 * fluid's reflection depends on the angle, so its share is multiplied by |R|^2. */
FUNCTION vfloat scattered_fraction(GLOBAL const struct surface_record *surface, vfloat cosine)
{
    const vfloat phase = surface->roughness_phase * cosine;
    const vfloat fraction = 1.0f - exponential_of_negative(-phase * phase);
    if (surface->reflection_kind != REFLECTION_FLUID)
        return fraction;
    vfloat real_part, imaginary_part;
    fluid_reflection(surface, cosine, &real_part, &imaginary_part);
    return fraction * (real_part * real_part + imaginary_part * imaginary_part);
}

/* Returns the f of kernels/MATH.md from one direction into the other: scattering per area and solid
 * angle, over both cosines. It is the same both ways, and 0 if a direction is below the surface. */
FUNCTION vfloat rough_scattering(GLOBAL const struct surface_record *surface, struct vector3 normal,
                                 struct vector3 one, struct vector3 other)
{
    const vfloat cosine_one = dot3(normal, one);
    const vfloat cosine_other = dot3(normal, other);
    const mask is_above = MASK_OF(cosine_one > 0.0f) & MASK_OF(cosine_other > 0.0f);
    vfloat scattering =
        surface->lambert * diffuse_shape(cosine_one, cosine_other, surface->lambert_exponent);
    if (surface->glossy_albedo > 0.0f)
        scattering +=
            surface->glossy_albedo * cone_scattering(normal, one, other, surface->glossy_slope);
    if (has_smooth_part(surface) && !surface->rough_is_apart)
        scattering = scattering * (scattered_fraction(surface, cosine_one) *
                                   scattered_fraction(surface, cosine_other));
    return SELECT(is_above, scattering, SPLAT(0.0f));
}

/* Returns the share of sampled directions that the cone gets. */
FUNCTION float cone_share(GLOBAL const struct surface_record *surface)
{
    const float all = rough_albedo(surface);
    return all > 0.0f ? surface->glossy_albedo / all : 0.0f;
}

/* Samples a direction of the rough part for sound that came along -back. The direction may lie
 * below the surface, where its scattering is 0. choice, u, v: uniform deviates. */
FUNCTION struct vector3 sample_rough_direction(GLOBAL const struct surface_record *surface,
                                               struct vector3 normal, struct vector3 back,
                                               vfloat choice, vfloat u, vfloat v)
{
    const float share = cone_share(surface);
    if (share == 0.0f)
        return sample_diffuse(normal, surface->lambert_exponent, u, v);
    const struct vector3 in_cone = sample_cone(normal, back, surface->glossy_slope, u, v);
    if (share == 1.0f)
        return in_cone;
    return choose3(MASK_OF(choice < share), in_cone,
                   sample_diffuse(normal, surface->lambert_exponent, u, v));
}

/* Returns the density of sampled directions, 1/sr; 0 below the surface. */
FUNCTION vfloat rough_direction_density(GLOBAL const struct surface_record *surface,
                                        struct vector3 normal, struct vector3 back,
                                        struct vector3 direction)
{
    const float share = cone_share(surface);
    const vfloat cosine = dot3(normal, direction);
    const vfloat diffuse = diffuse_density(cosine, surface->lambert_exponent);
    if (share == 0.0f)
        return diffuse;
    const vfloat cone = cone_density(normal, back, direction, surface->glossy_slope);
    return SELECT(MASK_OF(cosine > 0.0f), share * cone + (1.0f - share) * diffuse, SPLAT(0.0f));
}

#endif
