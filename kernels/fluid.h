/* Reflection at a fluid half-space: L. M. Brekhovskikh, Yu. P. Lysanov, "Fundamentals of Ocean
 * Acoustics", section 3.1 (Rayleigh's coefficient). */
#ifndef SONJECT_KERNELS_FLUID_H
#define SONJECT_KERNELS_FLUID_H

#include "layout.h"
#include "width.h"

/* At the cosine of the angle of incidence,
 *     R = (m cos - s) / (m cos + s),   s = sqrt(n^2 - sin^2),   Im s >= 0,
 * m the density ratio, n the complex refractive index k2/k. */
FUNCTION void fluid_reflection(GLOBAL const struct surface_record *surface, vfloat cosine,
                               vfloat *real_part, vfloat *imaginary_part)
{
    const vfloat square_real = surface->index_real - 1.0f + cosine * cosine;
    const vfloat square_imaginary = SPLAT(surface->index_imaginary);
    const vfloat modulus =
        SQUARE_ROOT(square_real * square_real + square_imaginary * square_imaginary);
    /* the larger part of the root first: it does not cancel */
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

#endif
