/* A measured response: complex samples over metres (or seconds). Between the samples it is a cubic
 * with the slopes of the parabola through each sample and its neighbours; outside it is 0. All
 * samples are divided by the largest one, which becomes 1. */
#ifndef SONJECT_SCENE_RESPONSE_TABLE_H
#define SONJECT_SCENE_RESPONSE_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

#define RESPONSE_SAMPLES_MAX  65536
#define RESPONSE_POSITION_MAX 1e6
#define RESPONSE_VALUE_MAX    1e15

struct complex_number {
    double real_part, imaginary_part;
};

struct response_table {
    double *positions;             /* rising; owned */
    struct complex_number *values; /* owned */
    size_t count;                  /* 0: no table */
    bool is_time;                  /* positions are s, not m */
};

/* Replaces the table by a copy of samples: at least two, not all 0, at positions that rise from
 * below 0, the target's own place, to above it. imaginary_part: NULL for 0. Errors: MEMORY. */
sonject_status response_table_set(struct response_table *table, struct report *report,
                                  const double *positions, const double *real_part,
                                  const double *imaginary_part, size_t count, bool is_time);

void response_table_clear(struct response_table *table);

/* Returns the index at which x's piece begins: the last of rising positions at or before x, but not
 * the last of all. */
size_t piece_at(const double *positions, size_t count, double x);

struct complex_number response_table_at(const struct response_table *table, double position);

/* Returns the integral of the squared magnitude over positions from `low` to `high`. */
double response_table_energy(const struct response_table *table, double low, double high);

/* Returns the half width about 0 beyond which less than `share` of the whole integral lies. */
double response_table_reach(const struct response_table *table, double share);

/* Returns the distance between the points on both sides of the largest sample where the squared
 * magnitude has fallen to one half, or the table's end where it has not. */
double response_table_width(const struct response_table *table);

#endif
