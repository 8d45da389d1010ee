/* Directions of the rough part: the generalised Lambert's law and the cone about the specular
 * direction. Directions are unit vectors away from the surface. */
#ifndef SONJECT_KERNELS_BRDF_H
#define SONJECT_KERNELS_BRDF_H

#include "elementary.h"
#include "vector3.h"

/* Returns cosine^exponent for a cosine in (0, 1] and an exponent >= 0. */
FUNCTION vfloat cosine_power(vfloat cosine, float exponent)
{
    if (exponent == 0.0f)
        return SPLAT(1.0f);
    if (exponent == 1.0f)
        return cosine;
    const vfloat positive = larger(cosine, SPLAT(1.0e-30f));
    return exponential_of_negative(smaller(exponent * natural_logarithm(positive), SPLAT(0.0f)));
}

/* Returns (n + 1)/2 (cos cos)^(n - 1), the factor of mu for an exponent n; n = 1 is Lambert's. */
FUNCTION vfloat diffuse_shape(vfloat cosine_one, vfloat cosine_other, float exponent)
{
    if (exponent == 1.0f)
        return SPLAT(1.0f);
    return 0.5f * (exponent + 1.0f) * cosine_power(cosine_one * cosine_other, exponent - 1.0f);
}

/* Returns the density (n + 1)/(2 pi) cos^n of sample_diffuse, 1/sr; 0 below the surface. */
FUNCTION vfloat diffuse_density(vfloat cosine, float exponent)
{
    const mask is_above = MASK_OF(cosine > 0.0f);
    const vfloat shape = cosine_power(SELECT(is_above, cosine, SPLAT(1.0f)), exponent);
    return SELECT(is_above, 0.15915494309f * (exponent + 1.0f) * shape, SPLAT(0.0f));
}

/* Returns the direction with a given cosine to the normal and turn about it, in cycles. */
FUNCTION struct vector3 direction_about(struct vector3 normal, vfloat cosine, vfloat sine,
                                        vfloat turn)
{
    struct vector3 first, second;
    vfloat sine_about, cosine_about;
    tangents3(normal, &first, &second);
    sine_cosine_of_cycles(turn, &sine_about, &cosine_about);
    return combine3(normal, cosine, first, sine * cosine_about, second, sine * sine_about);
}

FUNCTION struct vector3 sample_diffuse(struct vector3 normal, float exponent, vfloat u, vfloat v)
{
    /* At n = 1, 1 - cos^2 = u: no difference of nearly equal numbers. */
    vfloat square_sine = u;
    if (exponent != 1.0f) {
        const vfloat cosine =
            exponential_of_negative(natural_logarithm(1.0f - u) / (exponent + 1.0f));
        square_sine = (1.0f - cosine) * (1.0f + cosine);
    }
    return direction_about(normal, SQUARE_ROOT(1.0f - square_sine), SQUARE_ROOT(square_sine), v);
}

/* Returns the density of facets with normally distributed slopes (P. Beckmann, A. Spizzichino, "The
 * Scattering of Electromagnetic Waves from Rough Surfaces"): the area of facets per area of surface
 * and solid angle of their normals, 1/sr. Its integral times the cosine is 1. slope: rms, both
 * axes. */
FUNCTION vfloat facet_density(vfloat cosine, float slope)
{
    const mask is_above = MASK_OF(cosine > 1.0e-4f);
    const vfloat inverse = 1.0f / SELECT(is_above, cosine * cosine, SPLAT(1.0f));
    const float square = slope * slope;
    const vfloat density = 0.31830988618f / square * inverse * inverse *
                           exponential_of_negative((1.0f - inverse) / square);
    return SELECT(is_above, density, SPLAT(0.0f));
}

/* The facet that reflects one direction into another. */
struct microfacet {
    struct vector3 normal;
    vfloat half_angle; /* cosine between its normal and either direction */
};

/* Returns the facet between two directions. The half angle's cosine is half their sum's length:
 * near grazing a scalar product with the normal would cancel. */
FUNCTION struct microfacet facet_between(struct vector3 one, struct vector3 other)
{
    struct microfacet facet;
    facet.normal = vector3_of(one.x + other.x, one.y + other.y, one.z + other.z);
    const vfloat length = larger(SQUARE_ROOT(dot3(facet.normal, facet.normal)), SPLAT(2.0e-6f));
    facet.normal = scaled3(facet.normal, 1.0f / length);
    facet.half_angle = 0.5f * length;
    return facet;
}

/* Returns the cone's scattering over both cosines, for directions above the surface. Facets reflect
 * and shade each other as V-shaped grooves do: min(1, 2 nh no/oh, 2 nh ni/oh) (K. E. Torrance, E.
 * M. Sparrow, J. Opt. Soc. Am. 57, 1967). The cone never returns more than comes in. */
FUNCTION vfloat cone_scattering(struct vector3 normal, struct vector3 one, struct vector3 other,
                                float slope)
{
    const struct microfacet facet = facet_between(one, other);
    const vfloat cosine_one = dot3(normal, one);
    const vfloat cosine_other = dot3(normal, other);
    const vfloat tilt = dot3(normal, facet.normal);
    /* The shading is divided by both cosines here, so it is never a quotient of zeros. */
    const vfloat least = smaller(cosine_one, cosine_other);
    const vfloat most = larger(larger(cosine_one, cosine_other), SPLAT(1.0e-6f));
    const vfloat shading =
        smaller(2.0f * tilt / facet.half_angle, 1.0f / larger(least, SPLAT(1.0e-6f)));
    return facet_density(tilt, slope) * 0.25f * shading / most;
}

/* Returns the density of the directions of sample_cone, 1/sr. */
FUNCTION vfloat cone_density(struct vector3 normal, struct vector3 back, struct vector3 direction,
                             float slope)
{
    const struct microfacet facet = facet_between(back, direction);
    const vfloat tilt = dot3(normal, facet.normal);
    return facet_density(tilt, slope) * tilt / (4.0f * facet.half_angle);
}

/* Samples the direction into which a random facet reflects sound that came along -back. The
 * direction may lie below the surface. */
FUNCTION struct vector3 sample_cone(struct vector3 normal, struct vector3 back, float slope,
                                    vfloat u, vfloat v)
{
    const vfloat square_slope = -(slope * slope) * natural_logarithm(u);
    const vfloat cosine = 1.0f / SQUARE_ROOT(1.0f + square_slope);
    const struct vector3 facet =
        direction_about(normal, cosine, SQUARE_ROOT(square_slope) * cosine, v);
    const vfloat twice = 2.0f * dot3(back, facet);
    return vector3_of(twice * facet.x - back.x, twice * facet.y - back.y, twice * facet.z - back.z);
}

#endif
