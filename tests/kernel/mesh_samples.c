#include "mesh_samples.h"

#include "claims.h"
#include "random_rays.h"

double sample_uniform(double low, double high)
{
    return uniform(low, high);
}

void sample_direction(double direction[3])
{
    const double z = sample_uniform(-1.0, 1.0);
    const double angle = sample_uniform(-PI, PI);
    const double across = sqrt(1.0 - z * z);
    direction[0] = across * cos(angle);
    direction[1] = across * sin(angle);
    direction[2] = z;
}

static void reserve(struct mesh_sample *sample, size_t vertices, size_t triangles)
{
    memset(sample, 0, sizeof *sample);
    sample->positions = zeroed(vertices, 3 * sizeof *sample->positions);
    sample->corners = zeroed(triangles, 3 * sizeof *sample->corners);
}

void sample_clear(struct mesh_sample *sample)
{
    free(sample->positions);
    free(sample->corners);
    memset(sample, 0, sizeof *sample);
}

static uint32_t add_vertex(struct mesh_sample *sample, double x, double y, double z)
{
    double *position = &sample->positions[3 * sample->vertices];
    position[0] = x;
    position[1] = y;
    position[2] = z;
    return (uint32_t)sample->vertices++;
}

static void add_triangle(struct mesh_sample *sample, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corners = &sample->corners[3 * sample->triangles++];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

/* Adds a vertex of an octant of the unit sphere. x, y, z: integer weights of its corners. */
static uint32_t octant_vertex(struct mesh_sample *sample, const double signs[3], double x, double y,
                              double z)
{
    const double length = sqrt(x * x + y * y + z * z);
    return add_vertex(sample, signs[0] * x / length, signs[1] * y / length, signs[2] * z / length);
}

static void add_octant(struct mesh_sample *sample, const double signs[3], int steps)
{
    const int is_mirrored = signs[0] * signs[1] * signs[2] < 0.0;
    for (int i = 0; i < steps; i++) {
        for (int j = 0; j < steps - i; j++) {
            const int k = steps - i - j;
            const uint32_t a = octant_vertex(sample, signs, i, j, k);
            const uint32_t b = octant_vertex(sample, signs, i + 1, j, k - 1);
            const uint32_t c = octant_vertex(sample, signs, i, j + 1, k - 1);
            add_triangle(sample, a, is_mirrored ? c : b, is_mirrored ? b : c);
            if (j + i + 1 < steps) {
                const uint32_t d = octant_vertex(sample, signs, i + 1, j + 1, k - 2);
                add_triangle(sample, b, is_mirrored ? c : d, is_mirrored ? d : c);
            }
        }
    }
}

/* Repeats vertices that neighbours share, with the same bits, so that the mesh must weld them. */
void sample_sphere(struct mesh_sample *sample, int subdivisions)
{
    const int steps = 1 << subdivisions;
    const size_t triangles = 8 * (size_t)steps * (size_t)steps;
    reserve(sample, 4 * triangles, triangles);
    for (int octant = 0; octant < 8; octant++) {
        const double signs[3] = {octant & 1 ? -1.0 : 1.0, octant & 2 ? -1.0 : 1.0,
                                 octant & 4 ? -1.0 : 1.0};
        add_octant(sample, signs, steps);
    }
}

void sample_box(struct mesh_sample *sample)
{
    static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    reserve(sample, 8, 12);
    for (int i = 0; i < 8; i++)
        add_vertex(sample, i & 1 ? 1.0 : -1.0, i & 2 ? 0.6 : -0.6, i & 4 ? 0.3 : -0.3);
    for (int face = 0; face < 6; face++) {
        add_triangle(sample, faces[face][0], faces[face][1], faces[face][2]);
        add_triangle(sample, faces[face][0], faces[face][2], faces[face][3]);
    }
}

void sample_ring(struct mesh_sample *sample, unsigned around, unsigned across)
{
    reserve(sample, (size_t)around * across, 2 * (size_t)around * across);
    for (unsigned i = 0; i < around; i++) {
        const double u = 2.0 * PI * i / around;
        for (unsigned j = 0; j < across; j++) {
            const double v = 2.0 * PI * j / across;
            const double tube =
                0.3 + 0.03 * sin(9.0 * u + 5.0 * v) + 0.01 * sin(61.0 * u) * cos(43.0 * v);
            add_vertex(sample, (0.65 + tube * cos(v)) * cos(u), (0.65 + tube * cos(v)) * sin(u),
                       tube * sin(v));
        }
    }
    for (unsigned i = 0; i < around; i++) {
        for (unsigned j = 0; j < across; j++) {
            const unsigned next_i = (i + 1) % around;
            const unsigned next_j = (j + 1) % across;
            add_triangle(sample, i * across + j, next_i * across + j, next_i * across + next_j);
            add_triangle(sample, i * across + j, next_i * across + next_j, i * across + next_j);
        }
    }
}

void sample_litter(struct mesh_sample *sample, size_t triangles)
{
    reserve(sample, 3 * triangles, triangles);
    for (size_t i = 0; i < triangles; i++) {
        const double size = pow(10.0, sample_uniform(-3.0, -0.3));
        double middle[3];
        uint32_t corners[3];
        sample_direction(middle);
        for (int corner = 0; corner < 3; corner++) {
            double offset[3];
            sample_direction(offset);
            const double reach = size * (corner == 0 ? pow(10.0, sample_uniform(-3.0, 0.0)) : 1.0);
            corners[corner] = add_vertex(sample, 0.5 * middle[0] + reach * offset[0],
                                         0.5 * middle[1] + reach * offset[1],
                                         0.5 * middle[2] + reach * offset[2]);
        }
        add_triangle(sample, corners[0], corners[1], corners[2]);
    }
}
