/* Meshes and users' shapes that planes cut, against the shapes that they stand for: glints by
 * physical optics, where the face of the cut is seen and where it is not, energies and shadows; and
 * two halves of a mesh against the whole. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../kernel/mesh_samples.h"
#include "bench.h"
#include "user_codes.h"

#define ROWS    121
#define COLUMNS 121
#define RANGE   50.0
#define RADIUS  0.25

/* Facets of 90 deg/128: they lie up to RADIUS (0.0123 rad)^2 / 6 = 6 um, at the middles of the
 * octahedron's faces four times that, under the sphere. */
#define SUBDIVISIONS 7

enum ball_kind {
    BALL_SPHERE,
    BALL_MESH,
    BALL_USER
};

static void add_ball_mesh(struct bench *bench)
{
    struct mesh_options options;
    struct mesh_sample sample;
    if (bench->scene.mesh_count > 0)
        return;
    mesh_options_init(&options);
    options.unit_m = RADIUS;
    sample_sphere(&sample, SUBDIVISIONS);
    bench->scene.meshes = calloc(1, sizeof *bench->scene.meshes);
    assert_non_null(bench->scene.meshes);
    bench->scene.mesh_count = 1;
    if (mesh_from_arrays(&bench->report, "sphere", sample.positions, sample.vertices,
                         sample.corners, sample.triangles, &options,
                         &bench->scene.meshes[0]) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    sample_clear(&sample);
}

static void add_ball_code(struct bench *bench)
{
    sonject_user_shape_params params;
    sonject_user_shape_params_init(&params);
    params.name = "sphere.cl";
    params.code = SPHERE_CODE;
    params.bounding_radius_m = RADIUS;
    params.parameter_count = 1;
    params.parameters[0] = RADIUS;
    if (user_shapes_append(&bench->scene.user_shapes, &bench->report, &params) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

/* A sphere 1 m over the seabed, whole where `cut` is NULL. */
static sonject_object_params *add_ball(struct bench *bench, enum ball_kind kind,
                                       const sonject_cut *cut)
{
    static const sonject_shape shapes[] = {SONJECT_SHAPE_SPHERE, SONJECT_SHAPE_MESH,
                                           SONJECT_SHAPE_USER};
    sonject_object_params *object = bench_add(bench, shapes[kind], 0.0, 0.0, 2.0 * RADIUS);
    object->burial_m = -1.0;
    object->cut_count = cut ? 1 : 0;
    if (cut)
        object->cuts[0] = *cut;
    if (kind == BALL_MESH)
        add_ball_mesh(bench);
    if (kind == BALL_USER)
        add_ball_code(bench);
    return object;
}

static void lift_to(struct bench *bench, double height_m)
{
    for (uint32_t i = 0; i < bench->tracer.part_count; i++)
        bench->placements[i].centre[2] = height_m;
}

static struct echo_line ball_line(enum ball_kind kind, const sonject_cut *cut)
{
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    add_ball(&bench, kind, cut);
    bench_ready(&bench);
    lift_to(&bench, 1.0 + RADIUS);
    struct echo_line line = bench_glint_line(&bench, 0);
    bench_close(&bench);
    return line;
}

static void add_line(struct echo_line *sum, const struct echo_line *line, double factor)
{
    const long shift = lround((sum->first_range_m - line->first_range_m) / line->spacing_m);
    for (size_t bin = 0; bin < sum->bins; bin++) {
        const long other = (long)bin + shift;
        if (other < 0 || other >= (long)line->bins)
            continue;
        sum->real_part[bin] += factor * line->real_part[other];
        sum->imaginary_part[bin] += factor * line->imaginary_part[other];
    }
}

static double energy_of(const struct echo_line *line)
{
    double energy = 0.0;
    for (size_t bin = 0; bin < line->bins; bin++)
        energy += pow(line->real_part[bin], 2.0) + pow(line->imaginary_part[bin], 2.0);
    return energy;
}

/* Towards the sonar, square to the sight: the face is a plate. */
static sonject_cut facing_cut(void)
{
    struct bench bench;
    sonject_cut cut = {-0.5 * PI, 0.0, 0.1};
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    add_ball(&bench, BALL_SPHERE, NULL);
    bench_ready(&bench);
    lift_to(&bench, 1.0 + RADIUS);
    cut.elevation_rad = placement_grazing(&bench.placements[0], &bench.tracer.view);
    bench_close(&bench);
    return cut;
}

/* Faces seen square and not at all, and one that takes half of the glint away. A facet's depth is
 * 24 um at the most: 1.2 deg of phase, -33 dB. Of a user's sphere the same rays meet the same, but
 * for roundings and those along rims. */
static void test_half_spheres(void **state)
{
    const sonject_cut cuts[] = {facing_cut(), {0.5 * PI, 0.0, 0.02}, {0.0, 0.0, 0.01}};
    static const char *const names[] = {"towards the sonar", "away from it", "across it"};
    (void)state;
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        struct echo_line sphere = ball_line(BALL_SPHERE, &cuts[i]);
        const double energy = energy_of(&sphere);
        for (int kind = BALL_MESH; kind <= (i == 1 ? BALL_MESH : BALL_USER); kind++) {
            struct echo_line line = ball_line((enum ball_kind)kind, &cuts[i]);
            add_line(&line, &sphere, -1.0);
            const double difference = 10.0 * log10(energy_of(&line) / energy);
            print_message("cut %s, %s: ", names[i], kind == BALL_MESH ? "mesh" : "user's shape");
            expect_below("difference, dB", difference, kind == BALL_MESH ? -33.0 : -60.0);
            echo_line_clear(&line);
        }
        echo_line_clear(&sphere);
    }
}

/* The face of a cut towards the sonar is a disc: pi a^2 / lambda of a flat plate. */
static void test_the_face_is_lit(void **state)
{
    struct bench bench;
    const sonject_cut cut = facing_cut();
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    add_ball(&bench, BALL_MESH, &cut);
    bench_ready(&bench);
    lift_to(&bench, 1.0 + RADIUS);
    struct echo_line line = bench_glint_line(&bench, 0);
    const double peak = echo_line_peak(&bench, &line, NULL);
    const double area = PI * (RADIUS * RADIUS - cut.distance_m * cut.distance_m);
    /* the plate is large for the wavefront's curvature: k a^2 / r = 0.5 rad at its rim, a quarter
     * of which on average, -0.05 dB; the pulse's band 0.1 dB */
    expect_close("face, dB re area / wavelength",
                 decibels_of_amplitude(peak * bench.tracer.view.wavelength_m / area), 0.0, 0.2);
    echo_line_clear(&line);
    bench_close(&bench);
}

/* Of what passes the pulse's band. */
static double energy_in_band(const struct bench *bench, const struct echo_line *line)
{
    double energy = 0.0;
    for (size_t bin = 0; bin < line->bins; bin += 4) {
        const double range_m = line->first_range_m + line->spacing_m * (double)bin;
        const struct complex_value value = echo_line_at(bench, line, range_m);
        energy += pow(value.real_part, 2.0) + pow(value.imaginary_part, 2.0);
    }
    return energy;
}

/* Two halves of a mesh, each with its face against the other's, are the whole: facets that the
 * plane crosses echo once. Rays hit or miss the cells of wavefront that the plane divides: of the
 * built-in sphere, halves of other seeds differ by -32 to -34 dB, two of them by 3 dB more, and
 * that energy of many cells varies by no more than 2 dB. A strip of 3.6 mm lost would be -20 dB. */
static void test_two_halves(void **state)
{
    static const sonject_cut halves[2] = {{0.0, 0.0, 0.013}, {PI, 0.0, -0.013}};
    struct echo_line whole = ball_line(BALL_MESH, NULL);
    struct bench bench;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    for (int i = 0; i < 2; i++)
        add_ball(&bench, BALL_MESH, &halves[i]);
    bench_ready(&bench);
    lift_to(&bench, 1.0 + RADIUS);
    const double energy = energy_in_band(&bench, &whole);
    for (uint32_t i = 0; i < 2; i++) {
        struct echo_line half = bench_glint_line(&bench, i);
        assert_true(energy_in_band(&bench, &half) > 0.05 * energy);
        add_line(&whole, &half, -1.0);
        echo_line_clear(&half);
    }
    expect_below("halves less the whole, dB", 10.0 * log10(energy_in_band(&bench, &whole) / energy),
                 -27.0);
    echo_line_clear(&whole);
    bench_close(&bench);
}

struct sums {
    double echoes, lost, footprint;
};

/* Of a rough ball on the seabed. */
static struct sums trace_tile(enum ball_kind kind, const sonject_cut *cut)
{
    struct bench bench;
    struct rough_trace trace;
    struct sums sums = {0.0, 0.0, 0.0};
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    sonject_object_params *object = add_ball(&bench, kind, cut);
    object->burial_m = 0.1;
    object->material.reflection = 0.0;
    object->material.lambert = 0.1;
    bench_ready(&bench);
    lift_to(&bench, 0.05);
    if (rough_trace_begin(&trace, &bench.tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    float *seabed = calloc(line_grid_cells(&trace.grid), sizeof *seabed);
    float *tiles = calloc(trace.tile_elements, sizeof *tiles);
    assert_true(seabed && tiles);
    if (rough_trace_strips(&trace, &bench.tracer, trace.grid.strips, seabed) != SONJECT_OK ||
        rough_trace_tiles(&trace, &bench.tracer, tiles) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    const size_t plane = line_grid_cells(&trace.tiles[0].grid);
    for (size_t i = 0; i < plane; i++) {
        sums.echoes += (double)tiles[TILE_ENERGY * plane + i];
        sums.lost += (double)tiles[TILE_LOST * plane + i];
        sums.footprint += (double)tiles[TILE_FOOTPRINT * plane + i];
    }
    free(seabed);
    free(tiles);
    rough_trace_end(&trace);
    bench_close(&bench);
    return sums;
}

/* The same rays meet both; energies differ by less than the facets' depth over the radius, 1e-4,
 * and by the few rays between both outlines and rims. */
static void test_rough_halves(void **state)
{
    static const sonject_cut cuts[] = {{-0.5 * PI, 0.7, 0.05}, {0.3, 0.2, 0.05}};
    (void)state;
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        const struct sums sphere = trace_tile(BALL_SPHERE, &cuts[i]);
        const struct sums whole = trace_tile(BALL_SPHERE, NULL);
        assert_true(fabs(sphere.footprint / whole.footprint - 1.0) > 0.05);
        for (int kind = BALL_MESH; kind <= (i == 1 ? BALL_MESH : BALL_USER); kind++) {
            const struct sums sums = trace_tile((enum ball_kind)kind, &cuts[i]);
            expect_close("echoes", sums.echoes / sphere.echoes, 1.0, 1e-3);
            expect_close("shadow", sums.lost / sphere.lost, 1.0, 1e-3);
            expect_close("hits", sums.footprint / sphere.footprint, 1.0, 1e-3);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_half_spheres),
        cmocka_unit_test(test_the_face_is_lit),
        cmocka_unit_test(test_two_halves),
        cmocka_unit_test(test_rough_halves),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
