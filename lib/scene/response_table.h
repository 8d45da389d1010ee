/* A measured response: complex samples over metres (or seconds), between which it is a cubic with
 * the slopes of the parabola through each sample and its neighbours; 0 outside. The largest sample
 * is 1: all are divided by it. */
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

/* Takes a copy of samples in place of what the table held: at least two, positions rising from
 * below 0, the target's own place, to above it, not all 0. imaginary_part: NULL where it is 0.
 * Errors: MEMORY. */
sonject_status response_table_set(struct response_table *table, struct report *report,
                                  const double *positions, const double *real_part,
                                  const double *imaginary_part, size_t count, bool is_time);

void response_table_clear(struct response_table *table);

/* Of rising positions the last at or before x, but not the last of all: where x's piece begins. */
size_t piece_at(const double *positions, size_t count, double x);

struct complex_number response_table_at(const struct response_table *table, double position);

/* Integral of the squared magnitude over positions from `low` to `high`. */
double response_table_energy(const struct response_table *table, double low, double high);

/* Half width about 0 beyond which less than `share` of that integral lies. */
double response_table_reach(const struct response_table *table, double share);

/* Distance between the points around the largest sample where the squared magnitude has fallen to
 * one half; the table's own length where it has not. */
double response_table_width(const struct response_table *table);

#endif
