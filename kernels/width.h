/* The physics is written once, on `vfloat`, which holds WIDTH lanes. A lane is one ray of a packet,
 * or one box, triangle or pixel. The code is OpenCL C at WIDTH 1, 4, 8 or 16. It is also plain C99
 * at WIDTH 1, or at the same widths with the vector extension of gcc and clang (lib/device/native).
 * All operations on `vfloat` are exact or correctly rounded in each lane, so all widths give the
 * same bits. A lane of a mask is 0 or -1. */
#ifndef SONJECT_KERNELS_WIDTH_H
#define SONJECT_KERNELS_WIDTH_H

#include "layout.h"

#ifndef WIDTH
#define WIDTH 1
#endif

#ifdef __OPENCL_C_VERSION__

#pragma OPENCL FP_CONTRACT OFF
#define FUNCTION    static inline __attribute__((always_inline)) /* vectors are slow to pass */
#define NOINLINE    static __attribute__((noinline))             /* rare and large code is called */
#define GLOBAL      __global
#define UNROLLED    _Pragma("unroll") /* keeps sums of a loop in registers */
#define JOIN_(a, b) a##b
#define JOIN(a, b)  JOIN_(a, b)
#if WIDTH == 1
typedef float vfloat;
typedef int vint;
typedef uint word;
typedef int mask;
#define MASK_OF(comparison)        (-(comparison))
#define AS_VINT(value)             as_int(value)
#define AS_VFLOAT(value)           as_float(value)
#define AS_WORD(value)             as_uint(value)
#define VFLOAT_OF(value)           convert_float(value)
#define VINT_OF(value)             convert_int_rtz(value)
#define STORE_VFLOAT(value, array) ((array)[0] = (value))
#define STORE_VINT(value, array)   ((array)[0] = (value))
#define LOAD_VFLOAT(array)         ((array)[0])
#define LOAD_VINT(array)           ((array)[0])
#define LANE_NUMBERS               0u
#define LANE_FLAGS                 1
#else
typedef JOIN(float, WIDTH) vfloat;
typedef JOIN(int, WIDTH) vint;
typedef JOIN(uint, WIDTH) word;
typedef JOIN(int, WIDTH) mask;
#define MASK_OF(comparison)        (comparison)
#define AS_VINT(value)             JOIN(as_int, WIDTH)(value)
#define AS_VFLOAT(value)           JOIN(as_float, WIDTH)(value)
#define AS_WORD(value)             JOIN(as_uint, WIDTH)(value)
#define VFLOAT_OF(value)           JOIN(convert_float, WIDTH)(value)
#define VINT_OF(value)             JOIN(JOIN(convert_int, WIDTH), _rtz)(value)
#define STORE_VFLOAT(value, array) JOIN(vstore, WIDTH)(value, 0, array)
#define STORE_VINT(value, array)   JOIN(vstore, WIDTH)(value, 0, array)
#define LOAD_VFLOAT(array)         JOIN(vload, WIDTH)(0, array)
#define LOAD_VINT(array)           JOIN(vload, WIDTH)(0, array)
#if WIDTH == 4
#define LANE_NUMBERS ((word)(0, 1, 2, 3))
#define LANE_FLAGS   ((mask)(1, 2, 4, 8))
#elif WIDTH == 8
#define LANE_NUMBERS ((word)(0, 1, 2, 3, 4, 5, 6, 7))
#define LANE_FLAGS   ((mask)(1, 2, 4, 8, 16, 32, 64, 128))
#else
#define LANE_NUMBERS ((word)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#define LANE_FLAGS                                                                                 \
    ((mask)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768))
#endif
#endif
#define LOWEST_BIT(bits)   (31 - (int)clz((bits) & (0u - (bits))))
#define COUNT_BITS(bits)   popcount(bits)
#define SPLAT(value)       ((vfloat)(value))
#define SPLAT_WORD(value)  ((word)(value))
#define SPLAT_VINT(value)  ((vint)(value))
#define SQUARE_ROOT(value) sqrt(value)
#define ROOT_OF_ONE(value) sqrt(value)
#define SELECT(m, yes, no) select(no, yes, m)
#if WIDTH == 1
#define ANY(m)   any(m)
#define UNION(m) ((RECORD_WORD)(m))
#else
/* Joins the bits of all lanes by or, in halves: PoCL's any() and loops over lanes take longer. */
FUNCTION RECORD_WORD UNION(mask m)
{
#if WIDTH == 16
    const int8 eight = m.lo | m.hi;
    const int4 four = eight.lo | eight.hi;
#elif WIDTH == 8
    const int4 four = m.lo | m.hi;
#else
    const int4 four = m;
#endif
    const int2 two = four.lo | four.hi;
    return as_uint(two.x | two.y);
}
#define ANY(m) (UNION(m) != 0u)
#endif

#else /* plain C */

#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef __SSE2__
#include <immintrin.h>
#endif

#ifdef NATIVE_KERNELS /* without it, tests compile in a fraction of the time */
#define FUNCTION static inline __attribute__((always_inline))
#else
#define FUNCTION static inline
#endif
#ifdef __GNUC__
#define NOINLINE static __attribute__((noinline, unused))
#else
#define NOINLINE static inline
#endif
#define GLOBAL
#define UNROLLED
#define LOWEST_BIT(bits)   __builtin_ctz(bits)
#define COUNT_BITS(bits)   (RECORD_WORD) __builtin_popcount(bits)
#define ROOT_OF_ONE(value) sqrtf(value)
#if WIDTH == 1
typedef float vfloat;
typedef int32_t vint;
typedef uint32_t word;
typedef int32_t mask;
#define MASK_OF(comparison)        (-(int32_t)(comparison))
FUNCTION int32_t AS_VINT(float value)
{
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}
FUNCTION float AS_VFLOAT(int32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}
#define AS_WORD(value)             ((word)(value))
#define VFLOAT_OF(value)           ((float)(value))
#define VINT_OF(value)             ((int32_t)(value))
#define SPLAT(value)               ((vfloat)(value))
#define SPLAT_WORD(value)          ((word)(value))
#define SPLAT_VINT(value)          ((vint)(value))
#define SQUARE_ROOT(value)         sqrtf(value)
#define SELECT(m, yes, no)         ((m) ? (yes) : (no))
#define ANY(m)                     ((m) != 0)
#define UNION(m)                   ((RECORD_WORD)(m))
#define STORE_VFLOAT(value, array) ((array)[0] = (value))
#define STORE_VINT(value, array)   ((array)[0] = (value))
#define LOAD_VFLOAT(array)         ((array)[0])
#define LOAD_VINT(array)           ((array)[0])
#define LANE_NUMBERS               0u
#define LANE_FLAGS                 1
#else
typedef float vfloat __attribute__((vector_size(4 * WIDTH)));
typedef int32_t vint __attribute__((vector_size(4 * WIDTH)));
typedef uint32_t word __attribute__((vector_size(4 * WIDTH)));
typedef int32_t mask __attribute__((vector_size(4 * WIDTH)));
#define MASK_OF(comparison)        (comparison)
#define AS_VINT(value)             ((vint)(value))
#define AS_VFLOAT(value)           ((vfloat)(value))
#define AS_WORD(value)             ((word)(value))
#define VFLOAT_OF(value)           __builtin_convertvector(value, vfloat)
#define VINT_OF(value)             __builtin_convertvector(value, vint)
#define SPLAT(value)               ((float)(value) - (vfloat){0}) /* + would lose the sign of -0 */
#define SPLAT_WORD(value)          ((word){0} + (uint32_t)(value))
#define SPLAT_VINT(value)          ((vint){0} + (int32_t)(value))
FUNCTION vfloat SQUARE_ROOT(vfloat value)
{
    vfloat root;
    for (int lane = 0; lane < WIDTH; lane++)
        root[lane] = sqrtf(value[lane]);
    return root;
}
#define SELECT(m, yes, no)         ((__typeof__(yes))(((m) & (mask)(yes)) | (~(m) & (mask)(no))))
FUNCTION vfloat LOAD_VFLOAT(const float *array)
{
    vfloat value;
    memcpy(&value, array, sizeof value);
    return value;
}
FUNCTION vint LOAD_VINT(const int32_t *array)
{
    vint value;
    memcpy(&value, array, sizeof value);
    return value;
}
FUNCTION uint32_t UNION(mask m)
{
    int32_t all = 0;
    for (int lane = 0; lane < WIDTH; lane++)
        all |= m[lane];
    return (uint32_t)all;
}
#define ANY(m)                     (UNION(m) != 0)
#define STORE_VFLOAT(value, array) memcpy(array, &(value), sizeof(vfloat))
#define STORE_VINT(value, array)   memcpy(array, &(value), sizeof(vint))
/* x86 has instructions for lane_bits, which walks through hierarchies call at every step. */
#if WIDTH == 16 && defined(__AVX512DQ__)
#define LANE_BITS(m) _mm512_movepi32_mask((__m512i)(m))
#elif WIDTH == 8 && defined(__AVX2__)
#define LANE_BITS(m) _mm256_movemask_ps((__m256)(m))
#elif WIDTH == 4 && defined(__SSE2__)
#define LANE_BITS(m) _mm_movemask_ps((__m128)(m))
#endif
#if WIDTH == 4
#define LANE_NUMBERS ((word){0, 1, 2, 3})
#define LANE_FLAGS   ((mask){1, 2, 4, 8})
#elif WIDTH == 8
#define LANE_NUMBERS ((word){0, 1, 2, 3, 4, 5, 6, 7})
#define LANE_FLAGS   ((mask){1, 2, 4, 8, 16, 32, 64, 128})
#else
#define LANE_NUMBERS ((word){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15})
#define LANE_FLAGS                                                                                 \
    ((mask){1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768})
#endif
#endif

#endif

/* STORE_* takes the address of its value in C, so the value must be a named variable. */

FUNCTION vfloat smaller(vfloat a, vfloat b)
{
    return SELECT(MASK_OF(b < a), b, a);
}

FUNCTION vfloat larger(vfloat a, vfloat b)
{
    return SELECT(MASK_OF(b > a), b, a);
}

FUNCTION vfloat magnitude(vfloat value)
{
    return AS_VFLOAT(AS_VINT(value) & 0x7fffffff);
}

/* Returns -1 where the value is negative, else 1. */
FUNCTION vfloat sign_of(vfloat value)
{
    return SELECT(MASK_OF(value < 0.0f), SPLAT(-1.0f), SPLAT(1.0f));
}

/* Returns the mask as bits: bit i is lane i. */
FUNCTION RECORD_WORD lane_bits(mask m)
{
#ifdef LANE_BITS
    return (RECORD_WORD)LANE_BITS(m);
#else
    return UNION(m & LANE_FLAGS);
#endif
}

/* Returns how many lanes of the mask are set. */
FUNCTION RECORD_WORD count_lanes(mask m)
{
    return COUNT_BITS(lane_bits(m));
}

/* Returns the number of the lowest bit that is set. bits: not 0. */
FUNCTION int lowest_bit(RECORD_WORD bits)
{
    return LOWEST_BIT(bits);
}

/* Returns the least value of all lanes. */
FUNCTION float least_lane(vfloat value)
{
#if WIDTH == 1
    return value;
#elif defined(__OPENCL_C_VERSION__)
#if WIDTH == 16
    const float8 eight = select(value.lo, value.hi, value.hi < value.lo);
    const float4 four = select(eight.lo, eight.hi, eight.hi < eight.lo);
#elif WIDTH == 8
    const float4 four = select(value.lo, value.hi, value.hi < value.lo);
#else
    const float4 four = value;
#endif
    const float2 two = select(four.lo, four.hi, four.hi < four.lo);
    return two.y < two.x ? two.y : two.x;
#else
    float lanes[WIDTH];
    STORE_VFLOAT(value, lanes);
    for (int span = WIDTH / 2; span > 0; span /= 2)
        for (int lane = 0; lane < span; lane++)
            lanes[lane] = lanes[lane + span] < lanes[lane] ? lanes[lane + span] : lanes[lane];
    return lanes[0];
#endif
}

#endif
