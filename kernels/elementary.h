/* Elementary functions from + - * / alone, so that every device gives the same bits. They are
 * minimax polynomials. Their errors were measured against double precision over the whole range
 * (tests/kernel/test_elementary.c). */
#ifndef SONJECT_KERNELS_ELEMENTARY_H
#define SONJECT_KERNELS_ELEMENTARY_H

#include "width.h"

/* Returns the integer nearest to value, |value| < 2^22. */
FUNCTION vfloat nearest_integer(vfloat value)
{
    const vfloat magic = SPLAT(12582912.0f); /* 1.5 * 2^23: adding it leaves no fraction bits */
    return (value + magic) - magic;
}

/* Computes the sine and cosine of an angle in cycles, |cycles| < 2^22. The error is below 1e-7; the
 * sine's is relative near 0 (1.3e-7). An angle in cycles is reduced exactly, where one in radians
 * would lose digits. */
FUNCTION void sine_cosine_of_cycles(vfloat cycles, vfloat *sine, vfloat *cosine)
{
    const vfloat turns = cycles - nearest_integer(cycles); /* -1/2...1/2, exact */
    const vfloat quarter = nearest_integer(turns * 4.0f);
    const vfloat rest = turns - quarter * 0.25f; /* -1/8...1/8, exact */
    const vfloat square = rest * rest;
    const vfloat s =
        rest *
        (6.283185307f +
         square * (-41.34170215f +
                   square * (81.60520475f + square * (-76.69786989f + square * 41.47294645f))));
    const vfloat c =
        1.0f + square * (-19.7392088f +
                         square * (64.93939383f +
                                   square * (-85.45676503f +
                                             square * (60.23819113f + square * -26.05833571f))));
    const vint quadrant = VINT_OF(quarter) & 3;
    const mask swapped = MASK_OF((quadrant & 1) != 0);
    const vfloat plain_sine = SELECT(swapped, c, s);
    const vfloat plain_cosine = SELECT(swapped, s, c);
    *sine = SELECT(MASK_OF((quadrant & 2) != 0), -plain_sine, plain_sine);
    *cosine = SELECT(MASK_OF(((quadrant + 1) & 2) != 0), -plain_cosine, plain_cosine);
}

/* Returns sin(2 pi u) / (2 pi u), and 1 at 0, for |cycles| < 2^22. The error is below 2e-7. */
FUNCTION vfloat sinc_of_cycles(vfloat cycles)
{
    vfloat sine, cosine;
    sine_cosine_of_cycles(cycles, &sine, &cosine);
    const mask is_zero = MASK_OF(cycles == 0.0f);
    return SELECT(is_zero, SPLAT(1.0f),
                  sine / (SELECT(is_zero, SPLAT(1.0f), cycles) * 6.2831853072f));
}

/* Returns exp(value) for value <= 0, and 0 below -80. The relative error is below 1.3e-7. */
FUNCTION vfloat exponential_of_negative(vfloat value)
{
    const vfloat limited = larger(value, SPLAT(-80.0f));
    const vfloat power = nearest_integer(limited * 1.44269504089f);
    /* ln 2 is split in two, so that the remainder keeps its digits. */
    const vfloat rest = (limited - power * 0.693359375f) - power * -2.12194440e-4f;
    const vfloat fraction =
        1.0f +
        rest * (1.0f +
                rest * (0.49999992f +
                        rest * (0.1666642f +
                                rest * (0.04166823f + rest * (0.00837482f + rest * 0.00138368f)))));
    const vfloat scale = AS_VFLOAT((VINT_OF(power) + 127) << 23);
    return SELECT(MASK_OF(value < -80.0f), SPLAT(0.0f), fraction * scale);
}

/* Returns ln(value) of a normal value > 0. The absolute error is below 1e-7 + 1.25e-7 |result|. */
FUNCTION vfloat natural_logarithm(vfloat value)
{
    const vint bits = AS_VINT(value);
    vint exponent = ((bits >> 23) & 255) - 127;
    vfloat fraction = AS_VFLOAT((bits & 0x007fffff) | 0x3f800000); /* 1...2 */
    const mask upper = MASK_OF(fraction > 1.41421356f);
    fraction = SELECT(upper, fraction * 0.5f, fraction);
    exponent = SELECT(upper, exponent + 1, exponent);
    const vfloat ratio = (fraction - 1.0f) / (fraction + 1.0f); /* ln f = 2 artanh(ratio) */
    const vfloat square = ratio * ratio;
    const vfloat series =
        2.0f * ratio *
        (1.0f + square * (0.33333333f +
                          square * (0.20000193f + square * (0.14267472f + square * 0.11809092f))));
    return VFLOAT_OF(exponent) * 0.69314718056f + series;
}

/* Returns the cube root of a normal value > 0 and below 1e30. The relative error is below 3e-7. A
 * third of the exponent is the first guess for two steps of Halley's method. */
FUNCTION vfloat cube_root(vfloat value)
{
    vfloat root = AS_VFLOAT(VINT_OF(VFLOAT_OF(AS_VINT(value)) * 0.333333333f) + 709921077);
    for (int step = 0; step < 2; step++) {
        const vfloat cube = root * root * root;
        root = root * ((cube + 2.0f * value) / (2.0f * cube + value));
    }
    return root;
}

#endif
