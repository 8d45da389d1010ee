/* The sea surface within chains of several interactions: its rough part, its mirror inside and at
 * an end of a path, and which path is counted how often. */
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
#include "trace/chain_reach.h"
#include "trace/chains.h"
#include "trace/sea_surface.h"

#define ORDERS   2  /* of two and three interactions */
#define RANGES   10 /* of RANGE_M each */
#define RANGE_M  1.0
#define MIDDLE_M 52.0
#define FIRST_M  (MIDDLE_M - 0.5 * RANGES * RANGE_M)
#define SEEDS    16
#define ROWS     300
#define COLUMNS  480
#define DEPTH_M  15.0

/* Energies by order and range, m^2: sums over seeds of value and square. */
struct energies {
    double sum[ORDERS][RANGES], square[ORDERS][RANGES];
};

static double mean_of(const struct energies *energies, int order, int range)
{
    return energies->sum[order][range] / SEEDS;
}

static double error_of(const struct energies *energies, int order, int range)
{
    const double mean = mean_of(energies, order, range);
    return sqrt(fmax(0.0, energies->square[order][range] / SEEDS - mean * mean) / (SEEDS - 1));
}

/* A Lambert sphere over a Lambert seabed, 30 m of track, the surface 5 m over the sonar. */
static sonject_object_params *open_scene(struct bench *bench, double height_m)
{
    bench_open(bench, ROWS, COLUMNS, MIDDLE_M);
    bench->scene.geometry.row_spacing_m = 0.1;
    sonject_object_params *sphere = bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.8);
    sphere->burial_m = 0.4 - height_m;
    sphere->material.reflection = 0.0;
    sphere->material.lambert = 0.3;
    bench->scene.seabed.lambert = 0.2;
    bench->scene.surface.water_depth_m = DEPTH_M;
    bench->scene.surface.material.glossy_albedo = 0.0;
    bench->scene.injection.interactions = 3;
    bench->scene.injection.order_energies = 1;
    bench->scene.injection.column_rule = SONJECT_COLUMNS_PAPER;
    return sphere;
}

/* Adds one trace's energies of two and three interactions. */
static void add_trace(struct bench *bench, struct energies *energies)
{
    struct chain_trace trace;
    struct tracer *tracer = &bench->tracer;
    bench_trace_chains(bench, &trace);
    const size_t cells = line_grid_cells(&trace.grid);
    const double middle = view_apparent_range(&tracer->view, 0.5 * (COLUMNS - 1));
    float *plane = malloc(cells * sizeof *plane);
    assert_non_null(plane);
    for (uint32_t p = 2 - trace.first_order; p < trace.planes; p++) {
        double values[RANGES] = {0.0};
        if (chain_trace_read(&trace, tracer, p, plane) != SONJECT_OK)
            fail_msg("%s", bench->report.message);
        for (size_t i = 0; i < cells; i++) {
            const int32_t bin =
                trace.grid.bins.first + (int32_t)(i % (size_t)trace.grid.bins.count);
            const double range =
                view_apparent_range(&tracer->view, (double)bin / trace.grid.bins_per_pixel);
            const int at = (int)floor((range - middle) / RANGE_M) + RANGES / 2;
            if (at >= 0 && at < RANGES)
                values[at] += (double)plane[i];
        }
        const uint32_t order = p + trace.first_order - 2;
        for (int range = 0; range < RANGES; range++) {
            energies->sum[order][range] += values[range];
            energies->square[order][range] += values[range] * values[range];
        }
    }
    free(plane);
    chain_trace_end(&trace);
}

static struct energies trace_seeds(struct bench *bench, uint64_t first_seed)
{
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        bench->scene.injection.seed = first_seed + seed;
        add_trace(bench, &energies);
    }
    return energies;
}

/* Half the length of the track on which echoes are tallied, its middle in that of the patch. */
static double half_track(struct bench *bench)
{
    struct line_grid grid;
    line_grid_for_patch(&grid, &bench->tracer.view, &bench->tracer.response);
    const double first = grid.strips.first / (double)grid.strips_per_row - 0.5;
    const double last = (grid.strips.first + grid.strips.count) / (double)grid.strips_per_row - 0.5;
    const double x = view_x_of_row(&bench->tracer.view, first);
    assert_true(fabs(x + view_x_of_row(&bench->tracer.view, last) -
                     2.0 * bench->placements[0].centre[0]) < 0.2);
    return 0.5 * (view_x_of_row(&bench->tracer.view, last) - x);
}

static void expect_energies(const char *what, const struct energies *measured, int order,
                            const struct slab_value *expected, int ranges, double systematic)
{
    int compared = 0;
    double most = 0.0;
    for (int range = 0; range < ranges; range++)
        most = fmax(most, expected[range].mean);
    for (int range = 0; range < ranges; range++) {
        const double mean = mean_of(measured, order, range);
        const double error = hypot(error_of(measured, order, range), expected[range].error);
        if (expected[range].mean < 0.02 * most) /* beside the edge of what comes first */
            continue;
        print_message("%s, order %d, %.1f m: %.4g m2, expected %.4g +- %.2g\n", what, order + 2,
                      FIRST_M + (range + 0.5) * RANGE_M, mean, expected[range].mean, error);
        assert_true(fabs(mean - expected[range].mean) <=
                    4.0 * error + systematic * expected[range].mean);
        compared += error < 0.1 * expected[range].mean;
    }
    assert_true(most > 0.0);
    assert_true(compared >= 3);
}

/* --- A small disc that faces a Lambert surface: double integral --- */

#define DISC_M 0.2
#define STEPS  1500 /* of the integral over the surface, each way */

/* What the disc sends to a piece of the surface at (x, y), dx dy, and that to the sonar; ways: 1 in
 * the disc's column, and the reverse in the other's. */
static void add_piece(const struct bench *bench, double x, double y, double area, double track,
                      struct slab_value expected[RANGES])
{
    const double altitude = bench->tracer.view.altitude_m;
    const double *centre = bench->placements[0].centre;
    const double disc = PI * 0.25 * DISC_M * DISC_M;
    const double lambert =
        bench->scene.objects[0].material.lambert * bench->scene.surface.material.lambert;
    const double up = DEPTH_M - centre[2];
    const double between = sqrt(x * x + pow(y - centre[1], 2.0) + up * up);
    const bool is_focused = bench->scene.injection.column_rule == SONJECT_COLUMNS_FOCUSED;
    /* paper columns: the sonar abreast of the disc, then of the surface; else in the middle */
    for (int way = 0; way < (is_focused ? 1 : 2); way++) {
        const double sonar = is_focused ? 0.5 * x : way == 0 ? 0.0 : x;
        const double one =
            sqrt(sonar * sonar + pow(centre[1], 2.0) + pow(altitude - centre[2], 2.0));
        const double other = sqrt(pow(x - sonar, 2.0) + y * y + pow(DEPTH_M - altitude, 2.0));
        const double half_path = 0.5 * (one + between + other);
        const int range = (int)floor((half_path - FIRST_M) / RANGE_M);
        if (range < 0 || range >= RANGES || fabs(sonar) > track)
            continue;
        expected[range].mean += (is_focused ? 4.0 : 1.0) * area * disc * lambert *
                                (altitude - centre[2]) / pow(one, 3.0) * pow(up, 2.0) /
                                pow(between, 4.0) * (DEPTH_M - altitude) / pow(other, 3.0) *
                                pow(half_path, 4.0);
    }
}

static void compare_disc(uint32_t column_rule, const char *what)
{
    struct bench bench;
    struct slab_value expected[RANGES];
    bench_open(&bench, ROWS, COLUMNS, MIDDLE_M);
    bench.scene.geometry.row_spacing_m = 0.1;
    sonject_object_params *disc = bench_add(&bench, SONJECT_SHAPE_DISC, 0.0, 0.0, DISC_M);
    disc->burial_m = -1.5;
    bench.scene.injection.ray_scale = 8.0;
    disc->material.reflection = 0.0;
    disc->material.lambert = 0.3;
    bench.scene.surface.water_depth_m = DEPTH_M;
    bench.scene.surface.material.reflection = 0.0;
    bench.scene.surface.material.lambert = 0.25;
    bench.scene.injection.interactions = 2;
    bench.scene.injection.order_energies = 1;
    bench.scene.injection.column_rule = column_rule;
    bench_ready(&bench);
    memset(expected, 0, sizeof expected);
    const double size = 120.0;
    const double track = half_track(&bench);
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < STEPS; k++)
            add_piece(&bench, size * ((i + 0.5) / STEPS - 0.5), size * ((k + 0.5) / STEPS - 0.4),
                      size * size / STEPS / STEPS, track, expected);
    const struct energies measured = trace_seeds(&bench, 1);
    /* 1.5 %: the disc is no point, and the angles at it are those of the first hit's column */
    expect_energies(what, &measured, 0, expected, RANGES, 0.015);
    bench_close(&bench);
}

static void test_disc_under_lambert_surface(void **unused)
{
    (void)unused;
    compare_disc(SONJECT_COLUMNS_PAPER, "paper columns");
    compare_disc(SONJECT_COLUMNS_FOCUSED, "focused columns");
}

/* --- Every path, against a reference that runs all of them --- */

enum convention {
    AS_CONNECTED, /* paper columns: every path counts in its own first hit's */
    AS_FOCUSED,   /* a path and its reverse are one echo, together four times the energy of one */
    AS_BY_CHANCE  /* brute force: what ends on the surface once more, for its reverse */
};

static int digits_of(int path, int digit[SLAB_ORDERS])
{
    int count = 0;
    for (int rest = path; rest > 0; rest /= 5)
        count++;
    for (int i = count - 1, rest = path; i >= 0; i--, rest /= 5)
        digit[i] = rest % 5;
    return count;
}

static bool is_of_surface(int digit)
{
    return digit == SLAB_SURFACE || digit == SLAB_MIRROR;
}

/* How often the image holds a path: kernels/MATH.md, "Chains by way of the sea surface". */
static double ways_of(int path, enum convention convention, int *order)
{
    int digit[SLAB_ORDERS];
    const int count = digits_of(path, digit);
    int targets = 0, mirrors = 0;
    for (int i = 0; i < count; i++) {
        if (digit[i] == 0)
            return 0.0;
        targets += digit[i] == SLAB_TARGET;
        mirrors += digit[i] == SLAB_MIRROR;
    }
    *order = count - 2;
    if (count < 2 || targets == 0 ||
        (convention != AS_BY_CHANCE && targets == 1 && mirrors == count - 1))
        return 0.0;
    const int last = digit[count - 1];
    const bool begins_there = is_of_surface(digit[0]);
    const bool goes_there = digit[0] == SLAB_SEABED && is_of_surface(digit[1]);
    const bool comes_from_there = last == SLAB_SEABED && is_of_surface(digit[count - 2]);
    if (convention == AS_CONNECTED)
        return begins_there && is_of_surface(last) ? 0.0 : 1.0;
    /* what the library runs in the other direction */
    if (begins_there || (convention == AS_FOCUSED && goes_there))
        return 0.0;
    if (convention == AS_BY_CHANCE)
        return is_of_surface(last) ? 2.0 : 1.0;
    if (is_of_surface(last) || comes_from_there)
        return 4.0;
    if (digit[0] == last)
        return 2.0;
    return digit[0] == SLAB_SEABED ? 4.0 : 0.0;
}

static void lay_slab(struct bench *bench, struct slab_scene *scene)
{
    const sonject_material_params *surface = &bench->scene.surface.material;
    const double *centre = bench->placements[0].centre;
    memset(scene, 0, sizeof *scene);
    scene->altitude = bench->tracer.view.altitude_m;
    scene->depth = DEPTH_M;
    scene->seabed_lambert = bench->scene.seabed.lambert;
    scene->surface_lambert = surface->lambert;
    scene->reflection = surface->reflection;
    scene->phase = 2.0 * bench_wavenumber(bench) * surface->roughness_m;
    scene->centre_y = centre[1];
    scene->centre_z = centre[2];
    scene->radius = bench->placements[0].size.radius_m;
    scene->target_lambert = bench->scene.objects[0].material.lambert;
    scene->source_side = bench->scene.sonar.transducer_side_m;
    scene->source_grazing = asin(scene->altitude / MIDDLE_M);
}

/* Connected chains begin on seabed that is not too far from the target, brute force on the patch's.
 */
static void look_at_seabed(struct bench *bench, enum convention convention,
                           const struct slab_scene *scene, struct slab_request *request)
{
    const struct chain_reach reach = chain_reach_of(&bench->tracer, &bench->placements[0]);
    request->near_ground = scene->centre_y - reach.towards_sonar_m;
    request->far_ground = scene->centre_y + reach.around_m;
    request->reach_x = reach.around_m;
    request->is_focused = convention == AS_FOCUSED;
    if (convention != AS_BY_CHANCE)
        return;
    struct line_grid grid;
    const struct patch_view *view = &bench->tracer.view;
    line_grid_for_patch(&grid, view, &bench->tracer.response);
    request->near_ground = view_ground_range(view, line_grid_near_end(&grid, view));
    request->far_ground = INFINITY;
    request->reach_x = INFINITY;
}

static void find_expected(struct bench *bench, enum convention convention, uint64_t rays,
                          struct slab_value expected[ORDERS][RANGES])
{
    static struct slab_energy energy;
    struct slab_scene scene;
    struct slab_request request;
    memset(&request, 0, sizeof request);
    request.half_track = half_track(bench);
    request.first_range = FIRST_M;
    request.bin_width = RANGE_M;
    request.bins = RANGES;
    request.rays = rays;
    request.seed = 7;
    lay_slab(bench, &scene);
    look_at_seabed(bench, convention, &scene, &request);
    slab_trace(&scene, &request, &energy);
    memset(expected, 0, ORDERS * sizeof *expected);
    for (int path = 0; path < SLAB_PATHS; path++) {
        int order = 0;
        const double ways = ways_of(path, convention, &order);
        if (ways == 0.0)
            continue;
        double all = 0.0;
        for (int range = 0; range < RANGES; range++) {
            const struct slab_value first = energy.in_first[path][range];
            const struct slab_value both = energy.in_both[path][range];
            struct slab_value *value = &expected[order][range];
            const bool is_twice = convention == AS_BY_CHANCE && ways == 2.0;
            value->mean += is_twice ? first.mean + both.mean : ways * first.mean;
            value->error =
                hypot(value->error, is_twice ? hypot(first.error, both.error) : ways * first.error);
            all += first.mean;
        }
        if (all > 0.0)
            print_message("path %d%d%d: %.4g m2\n", path / 25, path / 5 % 5, path % 5, all);
    }
}

/* The surface's rough part and its mirror at once: 1 - exp(-P^2) at right angles is 0.92. */
static void make_wavy(struct bench *bench)
{
    bench->scene.surface.material.reflection = -0.9;
    bench->scene.surface.material.lambert = 0.25;
    bench->scene.surface.material.roughness_m = 1.9e-3;
}

static void compare_all_paths(uint32_t column_rule, enum convention convention, const char *what,
                              double systematic)
{
    struct bench bench;
    struct slab_value expected[ORDERS][RANGES];
    open_scene(&bench, 1.5);
    make_wavy(&bench);
    bench.scene.injection.column_rule = column_rule;
    bench_ready(&bench);
    find_expected(&bench, convention, 6000000, expected);
    const struct energies measured = trace_seeds(&bench, 1);
    for (int order = 0; order < ORDERS; order++)
        expect_energies(what, &measured, order, expected[order], RANGES, systematic);
    bench_close(&bench);
}

/* Where the library gives a path's reverse its column, it keeps the angles at the far end: 3 %. */
static void test_all_paths_in_paper_columns(void **unused)
{
    (void)unused;
    compare_all_paths(SONJECT_COLUMNS_PAPER, AS_CONNECTED, "paper columns", 0.03);
}

/* A bin of 3 mm, shared at either end of a range, is systematic: 1 %. */
static void test_all_paths_in_focused_columns(void **unused)
{
    (void)unused;
    compare_all_paths(SONJECT_COLUMNS_FOCUSED, AS_FOCUSED, "focused columns", 0.01);
}

/* The paper's own estimator. */
static void test_brute_force(void **unused)
{
    (void)unused;
    struct bench bench;
    struct slab_value expected[ORDERS][RANGES];
    open_scene(&bench, 1.5);
    bench.scene.sonar.transducer_side_m = 8.0;
    make_wavy(&bench);
    bench.scene.injection.estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    bench.scene.injection.ray_scale = 8.0;
    bench_ready(&bench);
    find_expected(&bench, AS_BY_CHANCE, 6000000, expected);
    const struct energies measured = trace_seeds(&bench, 1);
    for (int order = 0; order < ORDERS; order++)
        expect_energies("by chance", &measured, order, expected[order], RANGES, 0.01);
    bench_close(&bench);
}

/* --- The scene upside down --- */

/* A sphere near a Lambert seabed, and the same near a Lambert surface: sonar 80 m off both, and so
 * far away that only what is close to the sphere comes in time. */
static struct energies trace_beside(uint32_t column_rule, bool is_below_surface, uint64_t seed)
{
    const double depth = 460.0, height = 3.2, radius = 3.0, lambert = 0.2;
    struct bench bench;
    sonject_object_params *sphere = open_scene(&bench, height);
    sphere->diameter_m = 2.0 * radius;
    sphere->burial_m = radius - height;
    bench.scene.sonar.altitude_m = 230.0;
    bench_move(&bench, 400.0);
    bench.scene.surface.water_depth_m = depth;
    bench.scene.surface.material.reflection = 0.0;
    bench.scene.surface.material.lambert = is_below_surface ? lambert : 0.0;
    bench.scene.seabed.lambert = is_below_surface ? 1e-9 : lambert;
    bench.scene.injection.interactions = 2;
    bench.scene.injection.ray_scale = 0.25; /* errors are then up to what is systematic */
    bench.scene.injection.column_rule = column_rule;
    bench_ready(&bench);
    if (is_below_surface) /* higher than objects may be placed */
        bench.placements[0].centre[2] = depth - height;
    const struct energies energies = trace_seeds(&bench, seed);
    bench_close(&bench);
    return energies;
}

/* 1 %: in paper columns the surface's share keeps the angles at the sphere. The last ranges hear
 * seabed further from the sphere than the library looks. */
static void test_upside_down(void **unused)
{
    (void)unused;
    static const uint32_t rules[] = {SONJECT_COLUMNS_PAPER, SONJECT_COLUMNS_FOCUSED};
    for (int i = 0; i < 2; i++) {
        const struct energies upright = trace_beside(rules[i], false, 1);
        const struct energies turned = trace_beside(rules[i], true, 500);
        struct slab_value expected[RANGES];
        for (int range = 0; range < RANGES; range++) {
            expected[range].mean = mean_of(&upright, 0, range);
            expected[range].error = error_of(&upright, 0, range);
        }
        expect_energies(i == 0 ? "upside down, paper" : "upside down, focused", &turned, 0,
                        expected, RANGES - 3, 0.01);
    }
}

/* --- What changes nothing --- */

static bool traces_agree(struct bench *one, struct bench *other)
{
    struct energies first, second;
    memset(&first, 0, sizeof first);
    memset(&second, 0, sizeof second);
    add_trace(one, &first);
    add_trace(other, &second);
    assert_true(first.sum[0][RANGES / 2] > 0.0);
    return memcmp(&first, &second, sizeof first) == 0;
}

struct change {
    const char *name;
    double depth_m, roughness_m, glossy_albedo; /* depth 0: no surface */
    uint32_t interactions;
    bool has_layers;
};

static void open_changed(struct bench *bench, const struct change *change)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {12.0, 1500.0, 1.0}};
    open_scene(bench, 1.5);
    bench->scene.surface.water_depth_m = change->depth_m;
    bench->scene.surface.material.roughness_m = change->roughness_m;
    bench->scene.surface.material.glossy_albedo = change->glossy_albedo;
    bench->scene.injection.interactions = change->interactions;
    if (change->has_layers)
        bench_set_layers(bench, layers, 2);
    bench_ready(bench);
}

/* Pairs of scenes whose chains have the same bits, or have not. */
static void test_what_is_heard(void **unused)
{
    (void)unused;
    static const struct {
        struct change one, other;
        bool agrees;
    } pairs[] = {
        {{"no surface", 0.0, 0.0, 1.0, 3, false}, {"far away", 200.0, 0.01, 1.0, 3, false}, true},
        {{"no surface", 0.0, 0.0, 1.0, 3, false}, {"near", 15.0, 0.01, 1.0, 3, false}, false},
        {{"no surface", 0.0, 0.0, 1.0, 2, false}, {"mirror, 2", 15.0, 0.0, 1.0, 2, false}, true},
        {{"no surface", 0.0, 0.0, 1.0, 3, false}, {"mirror, 3", 15.0, 0.0, 1.0, 3, false}, false},
        {{"mirror", 15.0, 0.0, 0.0, 3, false}, {"no roughness", 15.0, 0.0, 1.0, 3, false}, true},
        {{"bare waves", 15.0, 0.01, 0.0, 3, false}, {"waves", 15.0, 0.01, 1.0, 3, false}, false},
        {{"layers", 0.0, 0.01, 1.0, 3, true}, {"and surface", 15.0, 0.01, 1.0, 3, true}, true},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        struct bench one, other;
        open_changed(&one, &pairs[i].one);
        open_changed(&other, &pairs[i].other);
        print_message("%s, %s\n", pairs[i].one.name, pairs[i].other.name);
        assert_int_equal(traces_agree(&one, &other), pairs[i].agrees);
        bench_close(&one);
        bench_close(&other);
    }
}

/* From which range on the surface is in chains: a patch that ends before the first echo by way of
 * it holds none. The sphere's radius is 0.4 m. */
static void test_bound(void **unused)
{
    (void)unused;
    for (int holds = 0; holds < 2; holds++) {
        struct bench bench;
        struct line_grid grid;
        open_scene(&bench, 1.5);
        bench.scene.surface.material.roughness_m = 0.01;
        bench.scene.surface.material.glossy_albedo = 1.0;
        bench_ready(&bench);
        const double *centre = bench.placements[0].centre;
        const double altitude = bench.tracer.view.altitude_m;
        const double by_centre = 0.5 * (hypot(centre[1], altitude - centre[2]) +
                                        hypot(centre[1], 2.0 * DEPTH_M - altitude - centre[2]));
        line_grid_for_patch(&grid, &bench.tracer.view, &bench.tracer.response);
        const double last = view_apparent_range(
            &bench.tracer.view, (double)(grid.bins.first + grid.bins.count) / grid.bins_per_pixel);
        grid.bins.count -= (int32_t)((last - by_centre + (holds ? 0.3 : 0.5)) *
                                     grid.bins_per_pixel / bench.tracer.view.column_spacing_m);
        assert_int_equal(sea_surface_is_in_chains(&bench.tracer, &grid), holds);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_disc_under_lambert_surface),
        cmocka_unit_test(test_all_paths_in_paper_columns),
        cmocka_unit_test(test_all_paths_in_focused_columns),
        cmocka_unit_test(test_brute_force),
        cmocka_unit_test(test_upside_down),
        cmocka_unit_test(test_what_is_heard),
        cmocka_unit_test(test_bound),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
