/* Rays that layers of water bend, worked out for the kernels (kernels/ray_table.h; kernels/MATH.md,
 * "Layers"). */
#ifndef SONJECT_TRACE_RAY_TABLE_H
#define SONJECT_TRACE_RAY_TABLE_H

#include "base/report.h"
#include "kernels/layout.h"
#include "medium/water.h"

/* The pieces of all ways that a launch looks up; none where all are straight. */
struct ray_table {
    struct ray_piece_record *pieces; /* owned */
    size_t count;
};

/* Elevations in rad over the direction in which sound comes to a frame's origin. */
struct elevations {
    double lowest, highest;
};

/* Appends the rays of a way in a frame whose origin has the ground range and height given, over the
 * elevations that a launch needs, and describes them in the record. A straight way needs no pieces.
 * Errors: INPUT (rays so near to total reflection that no cubic follows them), MEMORY; the table
 * stays the caller's for ray_table_clear. */
sonject_status ray_table_add(struct ray_table *table, struct report *report,
                             const struct water_way *way, double ground_range_m, double height_m,
                             struct elevations elevations, struct ray_table_record *record);
void ray_table_clear(struct ray_table *table);

/* The elevations at which sound comes to points (ground range, height), over the direction in which
 * it comes to the origin. Points beyond the straight water count as its edge. */
struct elevations elevations_of_points(const struct water_way *way, double origin_grazing_rad,
                                       const double (*points)[2], size_t count);

#endif
