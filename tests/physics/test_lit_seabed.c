/* A glint that lights the seabed: sonar, smooth sphere, Lambert seabed, sonar, and the reverse. The
 * energy of each bundle of rays is known in closed form; the expected value integrates it over the
 * sphere in double precision. */
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
#include "trace/chains.h"

#define RADIUS_M 0.5
#define HEIGHT_M 1.5 /* of the sphere's centre */
#define LAMBERT  0.02
#define RANGES   3
#define RANGE_M  0.25
#define FIRST_M  0.25 /* of the first range bin, beyond the sphere's centre */
#define SEEDS    16
#define STEPS    3000 /* of the integral, each way */

struct energies {
    double value[RANGES], square[RANGES];
};

static void make_scene(struct bench *bench, uint32_t column_rule)
{
    bench_open(bench, 480, 200, 50.0);
    sonject_object_params *sphere =
        bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * RADIUS_M);
    sphere->burial_m = RADIUS_M - HEIGHT_M;
    sphere->material.reflection = 0.8;
    sphere->material.roughness_m = 0.0;
    sphere->material.lambert = 0.0;
    bench->scene.seabed.lambert = LAMBERT;
    bench->scene.injection.interactions = 2;
    bench->scene.injection.column_rule = column_rule;
    bench_ready(bench);
}

static int range_bin(double half_path, double centre_range)
{
    return (int)floor((half_path - centre_range - FIRST_M) / RANGE_M);
}

static double distance_to_sphere(const double start[3], const double direction[3],
                                 const double centre[3])
{
    double along = 0.0;
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        along += (centre[k] - start[k]) * direction[k];
        square += (centre[k] - start[k]) * (centre[k] - start[k]);
    }
    const double left = RADIUS_M * RADIUS_M - (square - along * along);
    return left > 0.0 && along > 0.0 ? along - sqrt(left) : INFINITY;
}

/* One bundle of rays: wavefront dx by r dphi at the sphere; its energy over the square of the range
 * goes by the mirror to the seabed, which sends mu cos(angle) / r^2 of it to the sonar: abreast of
 * the sphere's hit, or (focused columns) of the middle between both hits. */
static void add_bundle(const struct bench *bench, const double centre[3], double x,
                       double elevation, double width, double energies[RANGES])
{
    const double altitude = bench->tracer.view.altitude_m;
    const double sonar[3] = {x, 0.0, altitude};
    double direction[3] = {0.0, cos(elevation), sin(elevation)};
    double hit[3], normal[3], point[3], back[3];
    const double first = distance_to_sphere(sonar, direction, centre);
    if (!isfinite(first))
        return;
    double cosine = 0.0;
    for (int k = 0; k < 3; k++) {
        hit[k] = sonar[k] + first * direction[k];
        normal[k] = (hit[k] - centre[k]) / RADIUS_M;
        cosine -= normal[k] * direction[k];
    }
    for (int k = 0; k < 3; k++)
        direction[k] += 2.0 * cosine * normal[k];
    if (direction[2] >= 0.0)
        return;
    const double between = hit[2] / -direction[2];
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        point[k] = hit[k] + between * direction[k];
    const bool is_focused = bench->scene.injection.column_rule == SONJECT_COLUMNS_FOCUSED;
    const double aside = is_focused ? 0.5 * (point[0] - x) : 0.0;
    for (int k = 0; k < 3; k++) {
        back[k] = sonar[k] + (k == 0 ? aside : 0.0) - point[k];
        square += back[k] * back[k];
    }
    const double last = sqrt(square);
    for (int k = 0; k < 3; k++)
        back[k] /= last;
    if (isfinite(distance_to_sphere(point, back, centre)))
        return;
    const double half_path = 0.5 * (hypot(first, aside) + between + last);
    const int range = range_bin(half_path, hypot(centre[1], altitude - centre[2]));
    if (range >= 0 && range < RANGES)
        energies[range] +=
            width / first * 0.8 * 0.8 * LAMBERT * back[2] / square * pow(half_path, 4.0);
}

static void integrate(const struct bench *bench, double energies[RANGES])
{
    const double *centre = bench->tracer.placements[0].centre;
    const double altitude = bench->tracer.view.altitude_m;
    const double middle = -atan2(altitude - centre[2], centre[1]);
    const double half_angle = 1.02 * RADIUS_M / hypot(altitude - centre[2], centre[1]);
    const double width = (2.0 * RADIUS_M / STEPS) * (2.0 * half_angle / STEPS);
    memset(energies, 0, RANGES * sizeof *energies);
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++)
            add_bundle(bench, centre, centre[0] + RADIUS_M * ((2 * i + 1.0) / STEPS - 1.0),
                       middle + half_angle * ((2 * j + 1.0) / STEPS - 1.0), width, energies);
}

static void trace_once(struct bench *bench, struct energies *energies)
{
    struct chain_trace trace;
    struct tracer *tracer = &bench->tracer;
    bench_trace_chains(bench, &trace);
    sonject_status status = SONJECT_OK;
    const size_t cells = line_grid_cells(&trace.grid);
    float *plane = malloc(cells * sizeof *plane);
    assert_non_null(plane);
    if (status == SONJECT_OK)
        status = chain_trace_read(&trace, tracer, 0, plane);
    if (status != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    double values[RANGES] = {0.0};
    const double centre_range = placement_range(&tracer->placements[0], &tracer->view);
    for (size_t i = 0; i < cells; i++) {
        const int32_t bin = trace.grid.bins.first + (int32_t)(i % (size_t)trace.grid.bins.count);
        const int range =
            range_bin(view_apparent_range(&tracer->view, (double)bin / trace.grid.bins_per_pixel),
                      centre_range);
        if (range >= 0 && range < RANGES)
            values[range] += (double)plane[i];
    }
    for (int range = 0; range < RANGES; range++) {
        energies->value[range] += values[range] / SEEDS;
        energies->square[range] += values[range] * values[range] / SEEDS;
    }
    free(plane);
    chain_trace_end(&trace);
}

/* ways: how often the path's energy is in the image. */
static void compare(uint32_t column_rule, double ways, const char *what)
{
    struct bench bench;
    struct energies measured;
    double expected[RANGES];
    memset(&measured, 0, sizeof measured);
    make_scene(&bench, column_rule);
    integrate(&bench, expected);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        bench.scene.injection.seed = seed;
        trace_once(&bench, &measured);
    }
    for (int range = 0; range < RANGES; range++) {
        const double mean = measured.value[range];
        const double error = sqrt(fmax(0.0, measured.square[range] - mean * mean) / (SEEDS - 1));
        print_message("%s, %.3f m beyond the centre: %.4g m2, expected %.4g +- %.2g\n", what,
                      FIRST_M + (range + 0.5) * RANGE_M, mean, ways * expected[range], error);
        /* 1 %: bins at the edges of a range, and seabed beyond the ends of the track */
        assert_true(expected[range] > 0.0);
        assert_true(fabs(mean - ways * expected[range]) <=
                    4.0 * error + 0.01 * ways * expected[range]);
    }
    bench_close(&bench);
}

/* The path in its first hit's column, the reverse in the seabed's. */
static void test_paper_columns(void **unused)
{
    (void)unused;
    compare(SONJECT_COLUMNS_PAPER, 2.0, "paper columns");
}

/* Both are one echo: twice the amplitude. */
static void test_focused_columns(void **unused)
{
    (void)unused;
    compare(SONJECT_COLUMNS_FOCUSED, 4.0, "focused columns");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_paper_columns),
        cmocka_unit_test(test_focused_columns),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
