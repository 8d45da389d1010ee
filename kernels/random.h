/* Counter-based random numbers: Threefry-2x32 with 20 rounds, by Salmon, Moraes, Dror and Shaw,
 * "Parallel random numbers: as easy as 1, 2, 3" (SC 2011). A number depends on its key and counter
 * alone. Neither order, width, chunk nor device can change it. */
#ifndef SONJECT_KERNELS_RANDOM_H
#define SONJECT_KERNELS_RANDOM_H

#include "width.h"

#define THREEFRY_BODY(type)                                                                        \
    const type parity = key0 ^ key1 ^ 0x1BD11BDAu;                                                 \
    *a += key0;                                                                                    \
    *b += key1;                                                                                    \
    THREEFRY_FOUR(13, 15, 26, 6)                                                                   \
    *a += key1;                                                                                    \
    *b += parity + 1u;                                                                             \
    THREEFRY_FOUR(17, 29, 16, 24)                                                                  \
    *a += parity;                                                                                  \
    *b += key0 + 2u;                                                                               \
    THREEFRY_FOUR(13, 15, 26, 6)                                                                   \
    *a += key0;                                                                                    \
    *b += key1 + 3u;                                                                               \
    THREEFRY_FOUR(17, 29, 16, 24)                                                                  \
    *a += key1;                                                                                    \
    *b += parity + 4u;                                                                             \
    THREEFRY_FOUR(13, 15, 26, 6)                                                                   \
    *a += parity;                                                                                  \
    *b += key0 + 5u;

#define THREEFRY_ROUND(turn)                                                                       \
    *a += *b;                                                                                      \
    *b = ((*b << turn) | (*b >> (32 - turn))) ^ *a;

#define THREEFRY_FOUR(turn0, turn1, turn2, turn3)                                                  \
    THREEFRY_ROUND(turn0) THREEFRY_ROUND(turn1) THREEFRY_ROUND(turn2) THREEFRY_ROUND(turn3)

/* Turns the counter (*a, *b) into two random words. */
FUNCTION void threefry(RECORD_WORD key0, RECORD_WORD key1, word *a,
                       word *b){THREEFRY_BODY(RECORD_WORD)}

/* Turns a counter of scalars into two random words, for keys. */
FUNCTION void threefry_scalar(RECORD_WORD key0, RECORD_WORD key1, RECORD_WORD *a, RECORD_WORD *b)
{
    THREEFRY_BODY(RECORD_WORD)
}

struct random_key {
    RECORD_WORD first, second;
};

/* Returns the key of one track strip in one stream. */
FUNCTION struct random_key random_key_of(RECORD_WORD seed_low, RECORD_WORD seed_high,
                                         RECORD_WORD stream, RECORD_WORD strip)
{
    struct random_key key = {strip, stream};
    threefry_scalar(seed_low, seed_high, &key.first, &key.second);
    return key;
}

/* Returns the middle of one of 2^23 equal parts of (0, 1). It is exact, never 0 and never 1. */
FUNCTION vfloat uniform_from(word bits)
{
    return (VFLOAT_OF(bits >> 9) + 0.5f) * 1.1920928955078125e-7f;
}

/* Draws two uniform deviates of (0, 1) for ray number `ray`. draw: numbers them within the ray. */
FUNCTION void two_uniforms(struct random_key key, word ray, RECORD_WORD draw, vfloat *first,
                           vfloat *second)
{
    word a = ray;
    word b = SPLAT_WORD(draw);
    threefry(key.first, key.second, &a, &b);
    *first = uniform_from(a);
    *second = uniform_from(b);
}

/* Draws two uniform deviates and a third from the bits that they leave over. The third is coarse,
 * the middle of one of 2^18 equal parts: good enough to choose between a few things. */
FUNCTION void three_uniforms(struct random_key key, word ray, RECORD_WORD draw, vfloat *first,
                             vfloat *second, vfloat *choice)
{
    word a = ray;
    word b = SPLAT_WORD(draw);
    threefry(key.first, key.second, &a, &b);
    *first = uniform_from(a);
    *second = uniform_from(b);
    *choice = (VFLOAT_OF(((a & 511u) << 9) | (b & 511u)) + 0.5f) * 3.814697265625e-6f;
}

/* Multipliers of lattices, in units of 2^-32. With number / count as a further coordinate, points
 * are even in two or six coordinates. The two are powers of the inverse of the plastic number. The
 * six are the best of a random search for even pairs of coordinates of 16 to 4096 neighbours. */
#define LATTICE_OF_2_0 0xC13FA9A9u
#define LATTICE_OF_2_1 0x91E10DA5u
#define LATTICE_OF_6_0 0x9E3779B9u
#define LATTICE_OF_6_1 0x10F73FBDu
#define LATTICE_OF_6_2 0x7202EA19u
#define LATTICE_OF_6_3 0x2CA485C3u
#define LATTICE_OF_6_4 0xBF1B0E5Fu
#define LATTICE_OF_6_5 0xB63FE2CBu

/* Returns a coordinate, in (0, 1), of a lattice's point. A random shift makes each point uniform.
 */
FUNCTION vfloat lattice_uniform(word number, RECORD_WORD multiplier, RECORD_WORD shift)
{
    return uniform_from(number * multiplier + SPLAT_WORD(shift));
}

#endif
