/* Objects that are triangle meshes against the shapes that they stand for: glints of facets by
 * physical optics, energies and shadows, both sides of the track, and the same bits as plain C. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "trace_rough.h"
#include "trace_smooth.h"

#include "bench.h"
#include "cl/launch.h"

#define ROWS    161
#define COLUMNS 161
#define RANGE   50.0
#define RADIUS  0.25

/* A sphere of rings x 2 rings quadrangles, halved; its poles on the z axis. */
static void make_sphere(struct mesh *mesh, struct report *report, uint32_t rings,
                        double smooth_angle_rad)
{
    const uint32_t sectors = 2 * rings;
    const size_t vertices = 2 + (size_t)(rings - 1) * sectors;
    double *positions = calloc(vertices, 3 * sizeof *positions);
    uint32_t *corners = calloc((size_t)rings * sectors * 2, 3 * sizeof *corners);
    size_t triangles = 0;
    assert_true(positions && corners);
    positions[2] = RADIUS;
    positions[3 * (vertices - 1) + 2] = -RADIUS;
    for (uint32_t ring = 1; ring < rings; ring++)
        for (uint32_t sector = 0; sector < sectors; sector++) {
            double *p = &positions[3 * (1 + (size_t)(ring - 1) * sectors + sector)];
            const double polar = PI * ring / rings;
            const double azimuth = 2.0 * PI * sector / sectors;
            p[0] = RADIUS * sin(polar) * cos(azimuth);
            p[1] = RADIUS * sin(polar) * sin(azimuth);
            p[2] = RADIUS * cos(polar);
        }
    for (uint32_t ring = 0; ring < rings; ring++)
        for (uint32_t sector = 0; sector < sectors; sector++) {
            const uint32_t next = (sector + 1) % sectors;
            const uint32_t above = ring == 0 ? 0 : 1 + (ring - 1) * sectors;
            const uint32_t below = ring == rings - 1 ? (uint32_t)vertices - 1 : 1 + ring * sectors;
            const uint32_t a = ring == 0 ? 0 : above + sector;
            const uint32_t b = ring == 0 ? 0 : above + next;
            const uint32_t c = ring == rings - 1 ? below : below + sector;
            const uint32_t d = ring == rings - 1 ? below : below + next;
            const uint32_t both[2][3] = {{a, c, d}, {a, d, b}};
            for (int half = 0; half < 2; half++)
                if (both[half][0] != both[half][1] && both[half][1] != both[half][2] &&
                    both[half][0] != both[half][2])
                    memcpy(&corners[3 * triangles++], both[half], sizeof both[half]);
        }
    struct mesh_options options;
    mesh_options_init(&options);
    options.smooth_angle_rad = smooth_angle_rad;
    if (mesh_from_arrays(report, "sphere", positions, vertices, corners, triangles, &options,
                         mesh) != SONJECT_OK ||
        mesh_require_closed(report, "sphere", mesh) != SONJECT_OK)
        fail_msg("%s", report->message);
    free(positions);
    free(corners);
}

/* A box of length x width x height with one upper corner cut away: nothing of it is like its image
 * in a mirror. */
static void make_chipped_box(struct mesh *mesh, struct report *report)
{
    static const double positions[][3] = {{-0.5, -0.2, -0.1}, {0.5, -0.2, -0.1}, {0.5, 0.2, -0.1},
                                          {-0.5, 0.2, -0.1},  {-0.5, -0.2, 0.1}, {0.5, -0.2, 0.1},
                                          {-0.5, 0.2, 0.1},   {0.1, 0.2, 0.1},   {0.5, 0.0, 0.1},
                                          {0.5, 0.2, 0.0}};
    static const uint32_t corners[][3] = {
        {0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {0, 4, 6}, {0, 6, 3}, {1, 2, 9}, {1, 9, 8},
        {1, 8, 5}, {2, 3, 9}, {3, 6, 7}, {3, 7, 9}, {4, 5, 8}, {4, 8, 7}, {4, 7, 6}, {7, 8, 9}};
    struct mesh_options options;
    mesh_options_init(&options);
    if (mesh_from_arrays(report, "box", positions[0], 10, corners[0], 16, &options, mesh) !=
            SONJECT_OK ||
        mesh_require_closed(report, "box", mesh) != SONJECT_OK)
        fail_msg("%s", report->message);
}

/* Makes room for the scene's only mesh. */
static struct mesh *add_mesh(struct bench *bench)
{
    bench->scene.meshes = calloc(1, sizeof *bench->scene.meshes);
    assert_non_null(bench->scene.meshes);
    bench->scene.mesh_count = 1;
    return &bench->scene.meshes[0];
}

/* The glint of a sphere of `rings` rings, or of the shape itself. */
static struct echo_line sphere_line(struct bench *bench, uint32_t rings)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    sonject_object_params *object = bench_add(
        bench, rings > 0 ? SONJECT_SHAPE_MESH : SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * RADIUS);
    object->burial_m = -1.0;
    if (rings > 0)
        make_sphere(add_mesh(bench), &bench->report, rings, 0.0);
    bench_ready(bench);
    return bench_glint_line(bench, 0);
}

/* Facets as fine as a sphere's glint wants have its level and phase; coarse ones, some wavelengths
 * wide, do not, but converge as their sagitta, which falls with the square of the rings. */
static void test_tessellated_sphere(void **state)
{
    static const uint32_t rings[] = {48, 96, 192, 384};
    struct bench bench;
    struct echo_line sphere = sphere_line(&bench, 0);
    double range, last = INFINITY;
    (void)state;
    const double peak = echo_line_peak(&bench, &sphere, &range);
    bench_close(&bench);
    for (size_t i = 0; i < sizeof rings / sizeof *rings; i++) {
        double at, difference = 0.0, energy = 0.0;
        struct echo_line line = sphere_line(&bench, rings[i]);
        const double level = decibels_of_amplitude(echo_line_peak(&bench, &line, &at) / peak);
        const long shift = lround((line.first_range_m - sphere.first_range_m) / sphere.spacing_m);
        for (size_t bin = 0; bin < sphere.bins; bin++) {
            const long other = (long)bin - shift;
            if (other < 0 || other >= (long)line.bins)
                continue;
            difference += pow(line.real_part[other] - sphere.real_part[bin], 2.0) +
                          pow(line.imaginary_part[other] - sphere.imaginary_part[bin], 2.0);
            energy += pow(sphere.real_part[bin], 2.0) + pow(sphere.imaginary_part[bin], 2.0);
        }
        difference = 10.0 * log10(difference / energy);
        print_message("%u rings: peak %+.3f dB, %+.2f mm, difference %.1f dB\n", (unsigned)rings[i],
                      level, 1e3 * (at - range), difference);
        assert_true(difference < last - 3.0);
        last = difference;
        if (i == 3) {
            /* sagitta a (pi/384)^2/8 x 2 ways: 0.3 degrees of phase */
            expect_close("level, dB", level, 0.0, 0.05);
            expect_close("range, mm", 1e3 * (at - range), 0.0, 0.5);
            assert_true(difference < -30.0);
        }
        echo_line_clear(&line);
        bench_close(&bench);
    }
    echo_line_clear(&sphere);
}

struct sums {
    double echoes, lost, footprint;
};

/* Energies and hits of a rough object. */
static struct sums trace_tile(struct bench *bench)
{
    struct rough_trace trace;
    struct sums sums = {0.0, 0.0, 0.0};
    if (rough_trace_begin(&trace, &bench->tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    float *seabed = calloc(line_grid_cells(&trace.grid), sizeof *seabed);
    float *tiles = calloc(trace.tile_elements, sizeof *tiles);
    assert_true(seabed && tiles);
    if (rough_trace_strips(&trace, &bench->tracer, trace.grid.strips, seabed) != SONJECT_OK ||
        rough_trace_tiles(&trace, &bench->tracer, tiles) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    const size_t plane = line_grid_cells(&trace.tiles[0].grid);
    for (size_t i = 0; i < plane; i++) {
        sums.echoes += (double)tiles[TILE_ENERGY * plane + i];
        sums.lost += (double)tiles[TILE_LOST * plane + i];
        sums.footprint += (double)tiles[TILE_FOOTPRINT * plane + i];
    }
    free(seabed);
    free(tiles);
    rough_trace_end(&trace);
    return sums;
}

static void make_rough(sonject_object_params *object)
{
    object->material.reflection = 0.0;
    object->material.lambert = 0.1;
}

/* The same rays meet the sphere and its facets: energies differ by less than the facets' sagitta
 * over the radius, 3e-5 with 192 rings, and by the few rays that pass between both outlines. */
static void test_rough_sphere(void **state)
{
    struct sums sums[2];
    (void)state;
    for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        make_rough(bench_add(&bench, is_mesh ? SONJECT_SHAPE_MESH : SONJECT_SHAPE_SPHERE, 0.0, 0.0,
                             2.0 * RADIUS));
        if (is_mesh)
            make_sphere(add_mesh(&bench), &bench.report, 192, 0.0);
        bench_ready(&bench);
        sums[is_mesh] = trace_tile(&bench);
        bench_close(&bench);
    }
    expect_close("echoes", sums[1].echoes / sums[0].echoes, 1.0, 1e-3);
    expect_close("shadow", sums[1].lost / sums[0].lost, 1.0, 1e-3);
    expect_close("hits", sums[1].footprint / sums[0].footprint, 1.0, 1e-3);
}

/* Half a turn about the upright takes a view to starboard into one to port along the reverse track,
 * where a heading h is pi - h: both show the same. A mirrored box would return 3 % less. */
static void test_both_sides(void **state)
{
    struct sums sums[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.geometry.side = i == 1 ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_MESH, 0.0, 0.0, 0.0);
        make_rough(object);
        object->heading_rad = i == 1 ? PI - 0.4 : 0.4;
        make_chipped_box(add_mesh(&bench), &bench.report);
        bench_ready(&bench);
        sums[i] = trace_tile(&bench);
        bench_close(&bench);
    }
    expect_close("echoes", sums[1].echoes / sums[0].echoes, 1.0, 0.01);
    expect_close("shadow", sums[1].lost / sums[0].lost, 1.0, 0.01);
}

/* Connections to a source of 10 cm start where smooth normals lift them to. */
static void expect_same_bits(double smooth_angle_rad)
{
    struct bench bench;
    struct rough_trace trace;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    make_rough(bench_add(&bench, SONJECT_SHAPE_MESH, 0.0, 0.0, 0.0));
    make_sphere(add_mesh(&bench), &bench.report, 24, smooth_angle_rad);
    bench.scene.sonar.transducer_side_m = 0.1;
    bench_ready(&bench);
    if (rough_trace_begin(&trace, &bench.tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    size_t bytes;
    assert_int_equal(
        clGetMemObjectInfo(trace.on_device.objects, CL_MEM_SIZE, sizeof bytes, &bytes, NULL),
        CL_SUCCESS);
    struct object_record *objects = malloc(bytes);
    const size_t lines = line_grid_cells(&trace.grid);
    float *seabed = calloc(lines, sizeof *seabed);
    int64_t *line = calloc(lines, sizeof *line);
    int64_t *tile = calloc(trace.tile_elements, sizeof *tile);
    int64_t *from_device = calloc(trace.tile_elements, sizeof *from_device);
    assert_true(objects && seabed && line && tile && from_device);
    if (buffer_read(&bench.report, bench.tracer.device, trace.on_device.objects, 0, bytes,
                    objects) != SONJECT_OK ||
        rough_trace_strips(&trace, &bench.tracer, trace.grid.strips, seabed) != SONJECT_OK ||
        buffer_read(&bench.report, bench.tracer.device, trace.tile_buffer, 0,
                    trace.tile_elements * sizeof *from_device, from_device) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    trace.fan.segments = 1;
    for (int strip = 0; strip < trace.fan.strips; strip++)
        trace_rough_strip(&trace.fan, trace.rays.pieces, objects, NULL, line, tile, strip, 0);
    int64_t sum = 0;
    for (size_t i = 0; i < trace.tile_elements; i++)
        sum += from_device[i] != 0;
    assert_true(sum > 1000);
    assert_memory_equal(tile, from_device, trace.tile_elements * sizeof *tile);
    free(objects);
    free(seabed);
    free(line);
    free(tile);
    free(from_device);
    rough_trace_end(&trace);
    bench_close(&bench);
}

static void test_same_bits(void **state)
{
    (void)state;
    expect_same_bits(0.0);
    expect_same_bits(1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tessellated_sphere),
        cmocka_unit_test(test_rough_sphere),
        cmocka_unit_test(test_both_sides),
        cmocka_unit_test(test_same_bits),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
