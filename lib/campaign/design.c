#include "campaign/design.h"

#include <math.h>

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
