/* Numbers for experiments: counted random numbers, permutations, and shares of whole things. Each
 * depends on its arguments alone, so that any image of a campaign can be drawn by itself. */
#ifndef SONJECT_CAMPAIGN_DESIGN_H
#define SONJECT_CAMPAIGN_DESIGN_H

#include <stddef.h>
#include <stdint.h>

/* A deviate of (0, 1), the middle of one of 2^53 equal parts; streams are independent. */
double uniform_number(uint64_t seed, uint32_t stream, uint64_t index);

/* Where a random permutation of 0...count - 1 takes index, which is below count. */
uint64_t permuted_index(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count);

/* The index-th of count deviates of (0, 1) of which each of count equal parts holds one, in random
 * order: an axis of a Latin hypercube. */
double stratified_number(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count);

/* Splits total by weights (finite, >= 0, their sum above 0) into whole shares that add up to it and
 * miss their exact values by less than 1, after Hamilton: of equal remainders the first is rounded
 * up. */
void share_out(uint64_t total, const double *weights, size_t count, uint64_t *shares);

#endif
