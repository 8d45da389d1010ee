#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "dataset/distribution.h"
#include "kernels/random.h"

#define FEISTEL_ROUNDS 8

/* Streams of what a permutation needs beside those of callers, which are below this. */
#define JITTER_STREAMS 0x40000000u
#define ROUND_STREAMS  0x80000000u

static uint64_t random_bits(uint64_t seed, uint32_t stream, uint64_t index)
{
    const struct random_key key =
        random_key_of((uint32_t)seed, (uint32_t)(seed >> 32), stream, (uint32_t)(index >> 32));
    uint32_t high = (uint32_t)index;
    uint32_t low = 0;
    threefry_scalar(key.first, key.second, &high, &low);
    return (uint64_t)high << 32 | low;
}

double uniform_number(uint64_t seed, uint32_t stream, uint64_t index)
{
    return ((double)(random_bits(seed, stream, index) >> 12) + 0.5) * 0x1p-52;
}

/* A Feistel network on 2^(2 half_bits) numbers; those beyond count are sent on until they are
 * below it, fewer than four times in the mean. */
uint64_t permuted_index(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count)
{
    unsigned half_bits = 1;
    while (half_bits < 32 && (UINT64_C(1) << (2 * half_bits)) < count)
        half_bits++;
    const uint64_t low_bits = (UINT64_C(1) << half_bits) - 1;
    do {
        uint64_t left = index >> half_bits;
        uint64_t right = index & low_bits;
        for (uint32_t round = 0; round < FEISTEL_ROUNDS; round++) {
            const uint64_t mixed =
                random_bits(seed, ROUND_STREAMS | stream, (uint64_t)round << 40 | right);
            const uint64_t next = left ^ (mixed & low_bits);
            left = right;
            right = next;
        }
        index = left << half_bits | right;
    } while (index >= count);
    return index;
}

double stratified_number(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count)
{
    const uint64_t stratum = permuted_index(seed, stream, index, count);
    const double within = uniform_number(seed, JITTER_STREAMS | stream, index);
    return fmin(((double)stratum + within) / (double)count, 1.0 - 0x1p-53);
}

void share_out(uint64_t total, const double *weights, size_t count, uint64_t *shares)
{
    double sum = 0.0;
    uint64_t given = 0;
    for (size_t i = 0; i < count; i++)
        sum += weights[i];
    for (size_t i = 0; i < count; i++) {
        shares[i] = (uint64_t)floor((double)total * (weights[i] / sum));
        given += shares[i];
    }
    /* rounding may have given one too many of very large totals */
    for (size_t i = 0; given > total && i < count; i++)
        if (shares[i] > 0) {
            shares[i]--;
            given--;
        }
    while (given < total) {
        size_t best = 0;
        double most = -2.0;
        for (size_t i = 0; i < count; i++) {
            const double left = (double)total * (weights[i] / sum) - (double)shares[i];
            if (weights[i] > 0.0 && left > most + 1e-9) {
                most = left;
                best = i;
            }
        }
        shares[best]++;
        given++;
    }
}

#define ROOT_HALF 0.70710678118654752440

/* Mass of the standard normal distribution between low and high. Tails are measured from their own
 * side, where they have their digits. */
static double mass_between(double low, double high)
{
    if (low > 0.0)
        return 0.5 * (erfc(low * ROOT_HALF) - erfc(high * ROOT_HALF));
    return 0.5 * (erfc(-high * ROOT_HALF) - erfc(-low * ROOT_HALF));
}

/* By bisection, to the last digits that are written. */
static double normal_quantile(double low, double high, double u)
{
    const double mass = u * mass_between(low, high);
    double below = low;
    double above = high;
    for (int i = 0; i < 100 && below < above; i++) {
        const double middle = 0.5 * (below + above);
        if (mass_between(low, middle) < mass)
            below = middle;
        else
            above = middle;
    }
    return 0.5 * (below + above);
}

double distribution_number(const struct distribution *distribution, double u)
{
    const double low = distribution->low;
    const double high = distribution->high;
    double number = low + u * (high - low);
    if (distribution->kind == DISTRIBUTION_LOG_UNIFORM)
        number = low * pow(high / low, u);
    if (distribution->kind == DISTRIBUTION_NORMAL)
        number = distribution->mean +
                 distribution->deviation *
                     normal_quantile((low - distribution->mean) / distribution->deviation,
                                     (high - distribution->mean) / distribution->deviation, u);
    return fmin(fmax(number, low), high);
}

/* Nine digits hide what the last bits of a machine's functions make of it. Rounded, a number may
 * lie beyond the limits by a billionth of it; then it is written in full. */
static const char *write_number(const struct distribution *distribution, double number,
                                char text[DISTRIBUTION_TEXT_CAPACITY])
{
    char digits[32];
    double read = number;
    const char *rest;
    text_of_number(digits, sizeof digits, number, 9);
    text_to_number(digits, &read, &rest);
    if (read < distribution->low || read > distribution->high)
        text_of_number(digits, sizeof digits, number, 17);
    snprintf(text, DISTRIBUTION_TEXT_CAPACITY, "%s%s", digits, distribution->unit);
    return text;
}

const char *distribution_value(const struct distribution *distribution, double u,
                               char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->kind == DISTRIBUTION_FIXED)
        return distribution->texts[0];
    if (distribution->kind != DISTRIBUTION_CHOICE)
        return write_number(distribution, distribution_number(distribution, u), text);
    size_t chosen = 0;
    while (chosen + 1 < distribution->count && u >= distribution->cumulative[chosen])
        chosen++;
    return distribution->texts[chosen];
}

uint32_t distribution_steps(const struct distribution *distribution)
{
    if (distribution->kind != DISTRIBUTION_CHOICE)
        return distribution->steps;
    for (size_t i = 0; i < distribution->count; i++)
        if (fabs(distribution->cumulative[i] - (double)(i + 1) / (double)distribution->count) >
            1e-12)
            return 0;
    return (uint32_t)distribution->count;
}

const char *distribution_step(const struct distribution *distribution, uint32_t step,
                              char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->kind == DISTRIBUTION_CHOICE)
        return distribution->texts[step];
    const double u =
        distribution->steps > 1 ? (double)step / (double)(distribution->steps - 1) : 0.5;
    return write_number(distribution, distribution_number(distribution, u), text);
}

void distribution_clear(struct distribution *distribution)
{
    for (size_t i = 0; distribution->texts && i < distribution->count; i++)
        free(distribution->texts[i]);
    free(distribution->texts);
    free(distribution->cumulative);
    free(distribution->key);
    memset(distribution, 0, sizeof *distribution);
}
