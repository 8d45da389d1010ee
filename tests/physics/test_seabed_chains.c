/* Chains of several interactions between a sphere well over the seabed and that: seabed far in
 * front of it, and the seabed's mirror. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "reference_slab.h"
#include "trace/chains.h"

#define RANGES      6 /* of RANGE_M each */
#define RANGE_M     0.5
#define MIDDLE_M    52.0
#define FIRST_M     MIDDLE_M
#define SEEDS       8
#define ROWS        300
#define COLUMNS     400
#define HEIGHT_M    1.5
#define RADIUS_M    0.4
#define REFLECTION  0.9
#define REFERENCE_M 200.0 /* the reference's depth: its seabed, black, is out of hearing */

/* Energies of one order by range, m^2: sums over seeds of value and square. */
struct energies {
    double sum[RANGES], square[RANGES];
};

static void open_scene(struct bench *bench, uint32_t interactions)
{
    bench_open(bench, ROWS, COLUMNS, MIDDLE_M);
    bench->scene.geometry.row_spacing_m = 0.1;
    sonject_object_params *sphere =
        bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * RADIUS_M);
    sphere->burial_m = RADIUS_M - HEIGHT_M;
    sphere->material.reflection = 0.0;
    sphere->material.lambert = 0.3;
    bench->scene.seabed.lambert = 0.1;
    bench->scene.injection.interactions = interactions;
    bench->scene.injection.order_energies = 1;
    bench->scene.injection.column_rule = SONJECT_COLUMNS_FOCUSED;
}

static void add_trace(struct bench *bench, uint32_t order, struct energies *energies)
{
    struct chain_trace trace;
    struct tracer *tracer = &bench->tracer;
    double values[RANGES] = {0.0};
    bench_trace_chains(bench, &trace);
    const size_t cells = line_grid_cells(&trace.grid);
    float *plane = malloc(cells * sizeof *plane);
    assert_non_null(plane);
    if (chain_trace_read(&trace, tracer, order - trace.first_order, plane) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    for (size_t i = 0; i < cells; i++) {
        const int32_t bin = trace.grid.bins.first + (int32_t)(i % (size_t)trace.grid.bins.count);
        const double range =
            view_apparent_range(&tracer->view, (double)bin / trace.grid.bins_per_pixel);
        const int at = (int)floor((range - FIRST_M) / RANGE_M);
        if (at >= 0 && at < RANGES)
            values[at] += (double)plane[i];
    }
    for (int range = 0; range < RANGES; range++) {
        energies->sum[range] += values[range];
        energies->square[range] += values[range] * values[range];
    }
    free(plane);
    chain_trace_end(&trace);
}

static struct energies trace_seeds(struct bench *bench, uint32_t order)
{
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        bench->scene.injection.seed = seed;
        add_trace(bench, order, &energies);
    }
    return energies;
}

static void expect_energies(const char *what, const struct energies *measured, int ranges,
                            const struct slab_value expected[RANGES], double systematic)
{
    for (int range = 0; range < ranges; range++) {
        const double mean = measured->sum[range] / SEEDS;
        const double variance = measured->square[range] / SEEDS - mean * mean;
        const double error = hypot(sqrt(fmax(0.0, variance) / (SEEDS - 1)), expected[range].error);
        print_message("%s, %.2f m: %.4g m2, expected %.4g +- %.2g\n", what,
                      FIRST_M + (range + 0.5) * RANGE_M, mean, expected[range].mean, error);
        assert_true(error < 0.02 * expected[range].mean);
        assert_true(fabs(mean - expected[range].mean) <=
                    4.0 * error + systematic * expected[range].mean);
    }
}

/* --- Seabed far in front of the sphere: integral over all seabed and over the sphere --- */

#define RINGS    300 /* of seabed, ever wider */
#define SECTORS  400
#define PARALLEL 12 /* pieces of the sphere */
#define MERIDIAN 24

struct point {
    double x, y, z;
};

static struct point difference(struct point a, struct point b)
{
    const struct point way = {a.x - b.x, a.y - b.y, a.z - b.z};
    return way;
}

static double dot(struct point a, struct point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static bool passes_sphere(struct point from, struct point to, struct point centre)
{
    const struct point way = difference(to, from);
    const struct point middle = difference(centre, from);
    const double along = dot(way, middle) / dot(way, way);
    const double square_miss = dot(middle, middle) - along * along * dot(way, way);
    return along < 0.0 || along > 1.0 || square_miss > RADIUS_M * RADIUS_M;
}

/* Sonar, seabed at `bottom`, a piece of the sphere, sonar: first abreast of the seabed, then of the
 * middle between both. Together with the reverse it is in the image four times. */
static void add_pieces(const struct bench *bench, struct point centre, struct point bottom,
                       double area, double expected[RANGES])
{
    const double altitude = bench->tracer.view.altitude_m;
    const double first = hypot(bottom.y, altitude);
    const double lit = bench->scene.seabed.lambert * area * altitude / pow(first, 3.0);
    const struct point abreast = {bottom.x, 0.0, altitude};
    if (!passes_sphere(abreast, bottom, centre))
        return;
    for (int i = 0; i < PARALLEL; i++)
        for (int k = 0; k < MERIDIAN; k++) {
            const double cosine = 2.0 * (i + 0.5) / PARALLEL - 1.0;
            const double sine = sqrt(1.0 - cosine * cosine);
            const double turn = 2.0 * PI * (k + 0.5) / MERIDIAN;
            const struct point normal = {sine * cos(turn), sine * sin(turn), cosine};
            const struct point hit = {centre.x + RADIUS_M * normal.x,
                                      centre.y + RADIUS_M * normal.y,
                                      centre.z + RADIUS_M * normal.z};
            const struct point sonar = {0.5 * (bottom.x + hit.x), 0.0, altitude};
            const struct point between = difference(bottom, hit);
            const struct point home = difference(sonar, hit);
            const double way = sqrt(dot(between, between)), last = sqrt(dot(home, home));
            if (dot(between, normal) <= 0.0 || dot(home, normal) <= 0.0)
                continue;
            const double half_path = 0.5 * (hypot(first, sonar.x - bottom.x) + way + last);
            const int range = (int)floor((half_path - FIRST_M) / RANGE_M);
            if (range < 0 || range >= RANGES)
                continue;
            const double piece = 4.0 * PI * RADIUS_M * RADIUS_M / (PARALLEL * MERIDIAN);
            expected[range] += 4.0 * lit * hit.z / pow(way, 4.0) * dot(between, normal) * piece *
                               bench->scene.objects[0].material.lambert * dot(home, normal) /
                               pow(last, 3.0) * pow(half_path, 4.0);
        }
}

/* 1.5 %: of the detours up to the sphere's height, in the first two ranges, 0.5 % may be left out;
 * bins at the edges of a range. */
static void test_far_seabed(void **unused)
{
    (void)unused;
    struct bench bench;
    double sums[RANGES] = {0.0};
    struct slab_value expected[RANGES];
    open_scene(&bench, 2);
    bench_ready(&bench);
    const double *placed = bench.placements[0].centre;
    const struct point centre = {0.0, placed[1], placed[2]};
    const double growth = log(placed[1] / 0.02) / RINGS; /* up to below the sonar */
    for (int ring = 0; ring < RINGS; ring++)
        for (int sector = 0; sector < SECTORS; sector++) {
            const double from_centre = 0.02 * exp(growth * (ring + 0.5));
            const double turn = 2.0 * PI * (sector + 0.5) / SECTORS;
            const struct point bottom = {from_centre * sin(turn),
                                         placed[1] - from_centre * cos(turn), 0.0};
            if (bottom.y > 0.0)
                add_pieces(&bench, centre, bottom,
                           from_centre * from_centre * growth * 2.0 * PI / SECTORS, sums);
        }
    for (int range = 0; range < RANGES; range++) {
        expected[range].mean = sums[range];
        expected[range].error = 0.0;
    }
    const struct energies measured = trace_seeds(&bench, 2);
    expect_energies("far seabed", &measured, 2, expected, 0.015);
    bench_close(&bench);
}

/* --- The seabed's mirror first: a sphere under the sea surface, upside down --- */

/* The library's seabed is the reference's sea surface. */
static void trace_upside_down(struct bench *bench, double reflection, uint64_t rays,
                              struct slab_energy *energy)
{
    struct slab_scene scene;
    struct slab_request request;
    struct line_grid grid;
    memset(&scene, 0, sizeof scene);
    memset(&request, 0, sizeof request);
    scene.depth = REFERENCE_M;
    scene.altitude = REFERENCE_M - bench->tracer.view.altitude_m;
    scene.surface_lambert = bench->scene.seabed.lambert;
    scene.reflection = reflection;
    scene.rough_is_apart = 1;
    scene.centre_y = bench->placements[0].centre[1];
    scene.centre_z = REFERENCE_M - bench->placements[0].centre[2];
    scene.radius = RADIUS_M;
    scene.target_lambert = bench->scene.objects[0].material.lambert;
    line_grid_for_patch(&grid, &bench->tracer.view, &bench->tracer.response);
    request.half_track =
        0.5 * bench->scene.geometry.row_spacing_m * grid.strips.count / grid.strips_per_row;
    request.far_ground = INFINITY;
    request.reach_x = INFINITY;
    request.first_range = FIRST_M;
    request.bin_width = RANGE_M;
    request.bins = RANGES;
    request.is_focused = 1;
    request.rays = rays;
    request.seed = 7;
    slab_trace(&scene, &request, energy);
}

/* How often a path of three interactions is in the image. */
static double ways_of(int first, int middle, int last)
{
    const int targets = (first == SLAB_TARGET) + (middle == SLAB_TARGET) + (last == SLAB_TARGET);
    if (targets == 0 || last == SLAB_MIRROR)
        return 0.0; /* what ends on the mirror is a reverse */
    if (first == last)
        return 2.0;
    return first == SLAB_TARGET ? 0.0 : 4.0;
}

/* Above all sonar, seabed's mirror, sphere, seabed, sonar. The mirror's point is 7.7 m in front of
 * the sphere, whose sound spreads 8 m more than it would from there. */
static void test_mirror_first(void **unused)
{
    (void)unused;
    static struct slab_energy energy;
    struct bench bench;
    struct slab_value expected[RANGES];
    open_scene(&bench, 3);
    bench.scene.seabed.forward.reflection = REFLECTION;
    bench_ready(&bench);
    /* the mirror has what the rough part leaves of it */
    const double left = sqrt(1.0 - PI * bench.scene.seabed.lambert);
    trace_upside_down(&bench, left * REFLECTION, 24000000, &energy);
    memset(expected, 0, sizeof expected);
    for (int path = 0; path < SLAB_PATHS; path++) {
        const int digits[3] = {path / 25, path / 5 % 5, path % 5};
        if (digits[0] < SLAB_TARGET || digits[1] < SLAB_TARGET || digits[2] < SLAB_TARGET)
            continue;
        const double ways = ways_of(digits[0], digits[1], digits[2]);
        for (int range = 0; range < RANGES; range++) {
            const struct slab_value value = energy.in_first[path][range];
            expected[range].mean += ways * value.mean;
            expected[range].error = hypot(expected[range].error, ways * value.error);
        }
    }
    const struct energies measured = trace_seeds(&bench, 3);
    expect_energies("mirror first", &measured, 2, expected, 0.01);
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_far_seabed),
        cmocka_unit_test(test_mirror_first),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
