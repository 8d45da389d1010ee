#include "union_mesh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/pose.h"

#define SECTORS    512 /* a multiple of 8, so that the square's corners are among them */
#define HALF_WIDTH 0.4 /* of the box, m */
#define BOX_TOP    0.3
#define RADIUS     0.25
#define TOP        0.8
#define SUNK       0.1 /* of the cylinder into the box */

/* Rings of vertices from the bottom to the top, SECTORS each, then the middles of both ends. */
enum ring {
    BOX_BELOW,
    BOX_ABOVE,
    CYLINDER_BELOW,
    CYLINDER_ABOVE,
    RINGS
};

static void put_vertex(double *positions, size_t number, double x, double y, double z)
{
    positions[3 * number] = x;
    positions[3 * number + 1] = y;
    positions[3 * number + 2] = z;
}

static void put_triangle(uint32_t **corners, uint32_t a, uint32_t b, uint32_t c)
{
    (*corners)[0] = a;
    (*corners)[1] = b;
    (*corners)[2] = c;
    *corners += 3;
}

static void make_mesh(struct bench *bench, struct mesh *mesh)
{
    const size_t vertices = RINGS * SECTORS + 2;
    const size_t triangles = 8 * SECTORS;
    double *positions = calloc(vertices, 3 * sizeof *positions);
    uint32_t *corners = calloc(triangles, 3 * sizeof *corners);
    uint32_t *end = corners;
    assert_true(positions && corners);
    for (size_t i = 0; i < SECTORS; i++) {
        const double angle = 2.0 * PI * (double)i / SECTORS;
        const double x = cos(angle);
        const double y = sin(angle);
        const double to_square = HALF_WIDTH / fmax(fabs(x), fabs(y));
        put_vertex(positions, BOX_BELOW * SECTORS + i, to_square * x, to_square * y, 0.0);
        put_vertex(positions, BOX_ABOVE * SECTORS + i, to_square * x, to_square * y, BOX_TOP);
        put_vertex(positions, CYLINDER_BELOW * SECTORS + i, RADIUS * x, RADIUS * y, BOX_TOP);
        put_vertex(positions, CYLINDER_ABOVE * SECTORS + i, RADIUS * x, RADIUS * y, TOP);
    }
    put_vertex(positions, vertices - 2, 0.0, 0.0, 0.0);
    put_vertex(positions, vertices - 1, 0.0, 0.0, TOP);
    for (uint32_t i = 0; i < SECTORS; i++) {
        const uint32_t next = (i + 1) % SECTORS;
        put_triangle(&end, (uint32_t)vertices - 2, next, i);
        for (uint32_t ring = BOX_BELOW; ring < CYLINDER_ABOVE; ring++) {
            const uint32_t below = ring * SECTORS;
            const uint32_t above = below + SECTORS;
            put_triangle(&end, below + i, below + next, above + next);
            put_triangle(&end, below + i, above + next, above + i);
        }
        put_triangle(&end, (uint32_t)vertices - 1, CYLINDER_ABOVE * SECTORS + i,
                     CYLINDER_ABOVE * SECTORS + next);
    }
    struct mesh_options options;
    mesh_options_init(&options);
    if (mesh_from_arrays(&bench->report, "union", positions, vertices, corners, triangles, &options,
                         mesh) != SONJECT_OK ||
        mesh_require_closed(&bench->report, "union", mesh) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    assert_int_equal(mesh->topology.turned, 0);
    free(positions);
    free(corners);
}

static void add_part(struct bench *bench, sonject_shape shape, double length, double up,
                     double pitch)
{
    struct scene_part part;
    memset(&part, 0, sizeof part);
    part.shape = bench->scene.objects[0];
    part.shape.shape = shape;
    part.shape.length_m = length;
    part.shape.width_m = 2.0 * HALF_WIDTH;
    part.shape.height_m = BOX_TOP;
    part.shape.diameter_m = 2.0 * RADIUS;
    part.centre[2] = up - 0.5 * TOP; /* a mesh counts from its middle */
    turn_axes(part.axes, 0.0, pitch, 0.0);
    if (scene_append_part(&bench->scene, &bench->report, &part) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

void add_union(struct bench *bench, bool is_mesh)
{
    bench_add(bench, is_mesh ? SONJECT_SHAPE_MESH : SONJECT_SHAPE_PARTS, 0.0, 0.0, 0.0);
    if (is_mesh) {
        bench->scene.meshes = calloc(1, sizeof *bench->scene.meshes);
        assert_non_null(bench->scene.meshes);
        bench->scene.mesh_count = 1;
        make_mesh(bench, bench->scene.meshes);
        return;
    }
    const double length = TOP - BOX_TOP + SUNK;
    add_part(bench, SONJECT_SHAPE_BOX, 2.0 * HALF_WIDTH, 0.5 * BOX_TOP, 0.0);
    add_part(bench, SONJECT_SHAPE_CYLINDER, length, TOP - 0.5 * length, 0.5 * PI);
}
