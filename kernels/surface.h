/* What a surface returns: the split of its energy between rough and smooth part. */
#ifndef SONJECT_KERNELS_SURFACE_H
#define SONJECT_KERNELS_SURFACE_H

#include "elementary.h"
#include "layout.h"

/* Fraction of the smooth surface's energy that roughness takes out of the mirror direction,
 * 1 - exp(-P^2), P = 2 k eta cos(angle). */
FUNCTION real scattered_fraction(GLOBAL const struct object_record *object, real cosine)
{
    const real phase = object->roughness_phase * cosine;
    return 1.0f - exponential_of_negative(-phase * phase);
}

/* Cross-section per unit area and solid angle over cos cos (the f of kernels/MATH.md): Lambert's
 * mu, held at both angles below what roughness takes from the smooth part. The product is
 * reciprocal, and its albedo stays below the fraction at the incident angle. */
FUNCTION real rough_scattering(GLOBAL const struct object_record *object, real cosine_in,
                               real cosine_out)
{
    const real lambert = SPLAT(object->lambert);
    if (!object->has_smooth_part)
        return lambert;
    return lambert * scattered_fraction(object, cosine_in) * scattered_fraction(object, cosine_out);
}

/* Amplitude of the mirror-like part, R exp(-P^2 / 2). */
FUNCTION real smooth_reflection(GLOBAL const struct object_record *object, real cosine)
{
    const real phase = object->roughness_phase * cosine;
    return object->reflection * exponential_of_negative(-0.5f * phase * phase);
}

#endif
