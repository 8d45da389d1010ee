/* What a value of a scene is drawn from, and numbers for experiments: counted random numbers,
 * permutations, and shares of whole things, each of which depends on its arguments alone, so that
 * any image of a campaign can be drawn by itself. */
#ifndef SONJECT_DATASET_DISTRIBUTION_H
#define SONJECT_DATASET_DISTRIBUTION_H

#include <stddef.h>
#include <stdint.h>

#include "schema/scene_schema.h"

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

enum distribution_kind {
    DISTRIBUTION_FIXED,       /* the only text */
    DISTRIBUTION_UNIFORM,     /* between low and high */
    DISTRIBUTION_LOG_UNIFORM, /* its logarithm is */
    DISTRIBUTION_NORMAL,      /* cut off at low and high */
    DISTRIBUTION_CHOICE       /* one of the texts */
};

struct distribution {
    enum distribution_kind kind;
    char *key; /* of the scene or of an object; owned */
    struct tree_place place;
    double low, high; /* in the unit as it is written */
    double mean, deviation;
    char unit[16];      /* " kHz", "" for none */
    char **texts;       /* values as --set takes them; owned */
    double *cumulative; /* weights of the texts, added up, the last 1 */
    size_t count;       /* of texts */
    uint32_t steps;     /* of a grid's axis; 0: none */
    uint32_t stream;    /* of random numbers */
};

#define DISTRIBUTION_TEXT_CAPACITY 48

/* Reads what the node says: a single value, a list, or a section {uniform: [low, high]},
 * {log_uniform: [low, high]}, {normal: {mean, deviation, minimum, maximum}}, {choice: [...],
 * weights: [...]}, {fixed: value}; the first two also with steps. The reader's path is the
 * value's. distribution: all zeros; on failure as well it is for distribution_clear. Errors: INPUT,
 * MEMORY. */
sonject_status distribution_read(struct reader *reader, const struct tree_node *node,
                                 const char *key, struct distribution *distribution);
void distribution_clear(struct distribution *distribution);

/* The value that a share of u, 0...1, lies below, as a text for --set; text: where numbers are
 * written, to nine digits. */
const char *distribution_value(const struct distribution *distribution, double u,
                               char text[DISTRIBUTION_TEXT_CAPACITY]);

/* The same as a number in the written unit; only of kinds with low and high. */
double distribution_number(const struct distribution *distribution, double u);

/* Number of values on a grid's axis: its steps, or the texts of a choice whose weights are equal;
 * 0: it is none. distribution_step gives each, counted from 0. */
uint32_t distribution_steps(const struct distribution *distribution);
const char *distribution_step(const struct distribution *distribution, uint32_t step,
                              char text[DISTRIBUTION_TEXT_CAPACITY]);

#endif
