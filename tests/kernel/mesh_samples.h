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

/* Sphere of radius 1: 8 * 4^subdivisions triangles from an octahedron. */
void sample_sphere(struct mesh_sample *sample, int subdivisions);

/* Box of 2 x 1.2 x 0.6, 12 triangles. */
void sample_box(struct mesh_sample *sample);

/* Ring about z with bumps and hollows: 2 * around * across triangles, all within 1.05 of the
 * origin. The middle of its tube, 0.65 from the axis, is inside. */
void sample_ring(struct mesh_sample *sample, unsigned around, unsigned across);

/* Triangles strewn within 1 of the origin, from large to very thin ones; no closed mesh. */
void sample_litter(struct mesh_sample *sample, size_t triangles);
void sample_clear(struct mesh_sample *sample);

/* Uniform in [low, high); one sequence for all samples and tests of a program. */
double sample_uniform(double low, double high);

/* A direction, uniform over the sphere. */
void sample_direction(double direction[3]);

#endif
