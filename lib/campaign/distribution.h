/* What a value of a scene is drawn from. */
#ifndef SONJECT_CAMPAIGN_DISTRIBUTION_H
#define SONJECT_CAMPAIGN_DISTRIBUTION_H

#include <stddef.h>
#include <stdint.h>

#include "io/scene_schema.h"

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
