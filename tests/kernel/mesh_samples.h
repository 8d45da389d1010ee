/* Meshes for tests. */
#ifndef SONJECT_TESTS_MESH_SAMPLES_H
#define SONJECT_TESTS_MESH_SAMPLES_H

#include <stddef.h>
#include <stdint.h>

struct mesh_sample {
    double *positions; /* vertices x 3, m */
    uint32_t *corners; /* triangles x 3, anticlockwise from outside */
    size_t vertices, triangles;
};

/* Makes a sphere of radius 1 with 8 * 4^subdivisions triangles from an octahedron. */
void sample_sphere(struct mesh_sample *sample, int subdivisions);

/* Makes a box of 2 x 1.2 x 0.6 with 12 triangles. */
void sample_box(struct mesh_sample *sample);

/* Makes a ring about z with bumps and hollows. All its 2 * around * across triangles are within
 * 1.05 of the origin. The middle of the ring's tube, 0.65 from the axis, is inside. */
void sample_ring(struct mesh_sample *sample, unsigned around, unsigned across);

/* Strews triangles within 1 of the origin, from large to very thin ones. The mesh is not closed. */
void sample_litter(struct mesh_sample *sample, size_t triangles);
void sample_clear(struct mesh_sample *sample);

/* Returns a uniform number in [low, high). A program's samples and tests share one sequence. */
double sample_uniform(double low, double high);

/* Draws a direction, uniform over the sphere. */
void sample_direction(double direction[3]);

#endif
