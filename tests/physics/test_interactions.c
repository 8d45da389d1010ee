/* Several interactions: ways of finding the same paths must give the same mean energy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "reference_paths.h"
#include "trace/chains.h"

#define ORDERS   3
#define RANGES   12 /* coarse range bins */
#define SEEDS    24
#define RANGE_M  0.5
#define MIDDLE_M 50.0
#define FAR_M    400.0
#define NEAR_M   20.0

/* Energies by order and range, m^2: sums over seeds of value and square. */
struct energies {
    int seeds;
    double sum[ORDERS][RANGES], square[ORDERS][RANGES];
};

static double mean_of(const struct energies *energies, int order, int range)
{
    return energies->sum[order][range] / energies->seeds;
}

static double error_of(const struct energies *energies, int order, int range)
{
    const double mean = mean_of(energies, order, range);
    const double variance = energies->square[order][range] / energies->seeds - mean * mean;
    return sqrt(fmax(0.0, variance) / (energies->seeds - 1));
}

/* One object. Surfaces are so bright that the third order is heard. */
static sonject_object_params *make_scene_of(struct bench *bench, sonject_shape shape,
                                            double length_m, double diameter_m)
{
    bench_open(bench, 240, 240, MIDDLE_M);
    sonject_object_params *object = bench_add(bench, shape, length_m, 0.0, diameter_m);
    object->heading_rad = 35.0 * PI / 180.0;
    object->material.reflection = 0.0;
    object->material.lambert = 0.2;
    bench->scene.seabed.lambert = 0.2;
    bench->scene.injection.interactions = ORDERS;
    bench->scene.injection.order_energies = 1;
    bench->scene.injection.column_rule = SONJECT_COLUMNS_PAPER;
    bench->scene.injection.ray_scale = 0.25; /* 24 seeds know their standard errors better */
    return object;
}

/* Figure 7's geometry. */
static void make_scene(struct bench *bench)
{
    make_scene_of(bench, SONJECT_SHAPE_CAPSULE, 2.3, 0.3)->burial_m = 0.1;
}

/* An object that is all within one sphere, which seabed under its overhang is within too: from
 * there no cone leads to a target. Near by and in a wide patch, for brute force's sake. */
static sonject_object_params *make_overhang(struct bench *bench, sonject_shape shape,
                                            double diameter_m, double height_m)
{
    sonject_object_params *object = make_scene_of(bench, shape, 0.0, diameter_m);
    object->height_m = height_m;
    bench->scene.geometry.row_spacing_m = 0.1;
    bench->scene.geometry.column_spacing_m = 0.06;
    bench_move(bench, NEAR_M);
    return object;
}

static int range_of_bin(const struct bench *bench, const struct line_grid *grid, int32_t bin)
{
    const double range = view_apparent_range(&bench->tracer.view, (double)(grid->bins.first + bin) /
                                                                      grid->bins_per_pixel);
    const double middle =
        view_apparent_range(&bench->tracer.view, 0.5 * (double)(bench->tracer.view.columns - 1));
    return (int)floor((range - middle) / RANGE_M) + RANGES / 2;
}

/* Adds one seed's energies. */
static void trace_once(struct bench *bench, struct energies *energies)
{
    struct chain_trace trace;
    struct tracer *tracer = &bench->tracer;
    bench_trace_chains(bench, &trace);
    sonject_status status = SONJECT_OK;
    const size_t cells = line_grid_cells(&trace.grid);
    float *plane = malloc(cells * sizeof *plane);
    assert_non_null(plane);
    for (uint32_t p = 0; p < trace.planes; p++) {
        double values[RANGES] = {0.0};
        if (status == SONJECT_OK)
            status = chain_trace_read(&trace, tracer, p, plane);
        for (size_t i = 0; i < cells; i++) {
            const int range =
                range_of_bin(bench, &trace.grid, (int32_t)(i % (size_t)trace.grid.bins.count));
            if (range >= 0 && range < RANGES)
                values[range] += (double)plane[i];
        }
        const uint32_t order = trace.first_order - 1 + p;
        for (int range = 0; range < RANGES; range++) {
            energies->sum[order][range] += values[range];
            energies->square[order][range] += values[range] * values[range];
        }
    }
    free(plane);
    chain_trace_end(&trace);
    if (status != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

static struct energies trace_some_seeds(struct bench *bench, uint64_t first_seed, int seeds)
{
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    bench_ready(bench);
    for (; energies.seeds < seeds; energies.seeds++) {
        bench->scene.injection.seed = first_seed + (uint64_t)energies.seeds;
        trace_once(bench, &energies);
    }
    return energies;
}

static struct energies trace_seeds(struct bench *bench, uint64_t first_seed)
{
    return trace_some_seeds(bench, first_seed, SEEDS);
}

/* |a / b - ratio| within four standard errors, where there is energy that is known to 20 %; far
 * beyond the target, where there is less than 1 % of the most, what lies outside the patch counts.
 */
static void expect_ratio(const char *what, const struct energies *a, const struct energies *b,
                         int order, double ratio, double systematic)
{
    int compared = 0;
    double most = 0.0;
    for (int range = 0; range < RANGES; range++)
        most = fmax(most, mean_of(b, order, range));
    for (int range = 0; range < RANGES; range++) {
        const double expected = ratio * mean_of(b, order, range);
        const double error = hypot(error_of(a, order, range), ratio * error_of(b, order, range));
        if (!(error < 0.2 * expected) || expected < 0.01 * ratio * most)
            continue;
        print_message("%s, order %d, %+.1f m: %.4g m2, expected %.4g +- %.2g\n", what, order + 1,
                      (range - RANGES / 2 + 0.5) * RANGE_M, mean_of(a, order, range), expected,
                      error);
        assert_true(fabs(mean_of(a, order, range) - expected) <=
                    4.0 * error + systematic * expected);
        compared++;
    }
    assert_true(compared >= 3);
}

/* Ripples with shadows of their own, and scour about the target. */
static void lay_relief(struct bench *bench)
{
    struct relief_feature *ripples = bench_add_relief(bench, RELIEF_RIPPLES);
    ripples->wavelength_m = 0.6;
    ripples->height_m = 0.06;
    ripples->heading_rad = 1.2;
    ripples->sharpness = 0.5;
    struct relief_feature *scour = bench_add_relief(bench, RELIEF_SCOUR);
    scour->width_m = 0.5;
    scour->height_m = 0.1;
    strcpy(scour->object, "capsule");
    strcpy(bench->scene.objects[0].name, "capsule");
}

/* The paper's brute force, with so many times the rays, and connections to random points of the
 * same rectangle. */
static void compare_estimators(const char *what, struct bench *bench, double connected_rays,
                               double counted_rays)
{
    bench->scene.sonar.transducer_side_m = 8.0;
    bench->scene.injection.ray_scale = connected_rays;
    const struct energies connected = trace_seeds(bench, 100);
    bench->scene.injection.estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    bench->scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    bench->scene.injection.ray_scale = counted_rays;
    const struct energies counted = trace_seeds(bench, 900);
    for (int order = 1; order < ORDERS; order++)
        expect_ratio(what, &counted, &connected, order, 1.0, 0.0);
    bench_close(bench);
}

static void test_two_estimators(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    compare_estimators("brute force against connections", &bench, 0.25, 3.0);
}

/* Visibility, normals, and directions towards the target. Rays are slow over relief. */
static void test_two_estimators_over_relief(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    lay_relief(&bench);
    compare_estimators("brute force over relief", &bench, 0.25, 3.0);
}

static void test_two_estimators_under_overhangs(void **unused)
{
    (void)unused;
    struct bench bench;
    make_overhang(&bench, SONJECT_SHAPE_TORUS, 1.2, 0.4);
    compare_estimators("brute force under a torus", &bench, 0.25, 2.0);
    make_overhang(&bench, SONJECT_SHAPE_MESH, 0.0, 0.0)->pitch_rad = PI; /* on its tip */
    bench_add_tetrahedron(&bench);
    compare_estimators("brute force under a mesh", &bench, 0.25, 2.0);
}

/* What mirrors alone send into the source's rectangle is a glint, and none of the energies. */
static void test_brute_force_leaves_glints_out(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    sonject_object_params *capsule = &bench.scene.objects[0];
    capsule->heading_rad = 0.0;
    capsule->material.reflection = 1.0;
    capsule->material.roughness_m = 0.0;
    capsule->material.lambert = 0.0;
    bench.scene.seabed.lambert = 0.0;
    bench.scene.sonar.transducer_side_m = 8.0;
    bench.scene.injection.estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    const struct energies counted = trace_some_seeds(&bench, 900, 2);
    for (int order = 0; order < ORDERS; order++)
        for (int range = 0; range < RANGES; range++)
            assert_true(mean_of(&counted, order, range) == 0.0);
    bench_close(&bench);
}

/* In focused columns paths between seabed and target are looked for from the seabed alone and stand
 * for both ways. A source of a millimetre beside the receiver has both found on their own, each
 * from where its first hit lies; at this range that changes the angles by less than a degree and
 * the energies by less than 3 %. */
static void compare_reciprocity(const char *what, struct bench *bench)
{
    bench->scene.sonar.altitude_m = 80.0;
    bench->scene.injection.ray_scale = 0.25; /* errors are then as large as what is systematic */
    bench_move(bench, FAR_M);
    bench->scene.injection.column_rule = SONJECT_COLUMNS_FOCUSED;
    const struct energies reciprocal = trace_seeds(bench, 100);
    bench->scene.sonar.transducer_side_m = 1e-3;
    const struct energies plain = trace_seeds(bench, 900);
    for (int order = 1; order < ORDERS; order++)
        expect_ratio(what, &reciprocal, &plain, order, 1.0, 0.03);
    bench_close(bench);
}

static void test_reciprocity(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    compare_reciprocity("one way for both against both ways", &bench);
}

static void test_reciprocity_over_relief(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    lay_relief(&bench);
    compare_reciprocity("one way for both over relief", &bench);
}

/* In focused columns a path and its reverse are one echo of twice the amplitude: together twice the
 * energy. Angles differ as above. */
static void test_focused_columns(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    bench.scene.objects[0].length_m = 0.6;
    bench.scene.sonar.altitude_m = 80.0;
    bench_move(&bench, FAR_M);
    const struct energies paper = trace_seeds(&bench, 100);
    bench.scene.injection.column_rule = SONJECT_COLUMNS_FOCUSED;
    const struct energies focused = trace_seeds(&bench, 900);
    expect_ratio("focused against paper columns", &focused, &paper, 1, 2.0, 0.03);
    bench_close(&bench);
}

/* The reference's scene and request for the same bench: first hits on the strips of the grid,
 * seabed from well before the patch to its end. */
static void lay_reference(const struct bench *bench, struct reference_scene *scene,
                          struct reference_request *request)
{
    const struct placement *placement = &bench->tracer.placements[0];
    const struct patch_view *view = &bench->tracer.view;
    struct line_grid grid;
    line_grid_for_patch(&grid, view, &bench->tracer.response);
    memset(scene, 0, sizeof *scene);
    memset(request, 0, sizeof *request);
    scene->seabed_lambert = bench->scene.seabed.lambert;
    scene->object_count = 1;
    struct reference_object *object = &scene->objects[0];
    object->shape =
        placement->shape == SONJECT_SHAPE_CAPSULE ? REFERENCE_CAPSULE : REFERENCE_CYLINDER;
    object->length = bench->scene.objects[0].length_m;
    object->radius = placement->size.radius_m;
    object->lambert = bench->scene.objects[0].material.lambert;
    object->centre =
        reference_vector(placement->centre[0], placement->centre[1], placement->centre[2]);
    for (int axis = 0; axis < 3; axis++)
        object->axes[axis] = reference_vector(placement->axes[axis][0], placement->axes[axis][1],
                                              placement->axes[axis][2]);
    request->estimator = REFERENCE_CONNECT;
    request->limit = ORDERS;
    request->rays = 6000000;
    request->seed = 7;
    request->altitude = view->altitude_m;
    const double strips = grid.strips_per_row;
    request->first_x = view_x_of_row(view, grid.strips.first / strips - 0.5);
    request->last_x = view_x_of_row(view, (grid.strips.first + grid.strips.count) / strips - 0.5);
    request->first_elevation = asin(view->altitude_m / 52.9);
    request->last_elevation = asin(view->altitude_m / 34.0);
    request->bins = RANGES;
    request->first_range = MIDDLE_M - 0.5 * RANGES * RANGE_M;
    request->bin_width = RANGE_M;
}

/* What the reference's order comes to where seabed and target scatter this much more: sound goes to
 * and fro between them. */
static struct reference_value scaled_reference(const struct reference_energy *reference, int order,
                                               int range, double seabed, double target)
{
    const int meetings = order + 1;
    struct reference_value sum = {0.0, 0.0};
    for (int ends = 0; ends < REFERENCE_ALL_ENDS; ends++) {
        const int on_seabed = (meetings + (ends == REFERENCE_SEABED_SEABED)) / 2;
        const double factor = pow(seabed, on_seabed) * pow(target, meetings - on_seabed);
        sum.mean += factor * reference->bins[ends][order][range].mean;
        sum.error = hypot(sum.error, factor * reference->bins[ends][order][range].error);
    }
    return sum;
}

static void expect_reference(const struct energies *traced,
                             const struct reference_energy *reference, double seabed, double target)
{
    for (int order = 1; order < ORDERS; order++)
        for (int range = RANGES / 2 - 2; range < RANGES / 2 + 2; range++) {
            const struct reference_value expected =
                scaled_reference(reference, order, range, seabed, target);
            const double mean = mean_of(traced, order, range);
            const double error = hypot(expected.error, error_of(traced, order, range));
            print_message("order %d, %+.2f m: %.4g m2, reference %.4g +- %.2g\n", order + 1,
                          (range - RANGES / 2 + 0.5) * RANGE_M, mean, expected.mean, error);
            assert_true(error < 0.1 * expected.mean || expected.mean == 0.0);
            assert_true(fabs(mean - expected.mean) <= 4.0 * error + 0.01 * expected.mean);
        }
}

/* Against a reference that shares nothing with the kernels but the physics: plain double precision,
 * cosine sampling, its own shapes. A bin of 3 mm, shared at either end of a range, is systematic.
 */
static void compare_with_reference(struct bench *bench, const double (*seabed_and_target_db)[2],
                                   size_t count)
{
    static struct reference_energy reference;
    struct reference_scene scene;
    struct reference_request request;
    bench_ready(bench);
    lay_reference(bench, &scene, &request);
    assert_int_equal(reference_trace(&scene, &request, &reference), 0);
    for (size_t i = 0; i < count; i++) {
        const double seabed = pow(10.0, 0.1 * seabed_and_target_db[i][0]);
        const double target = pow(10.0, 0.1 * seabed_and_target_db[i][1]);
        print_message("seabed %g dB, target %g dB\n", seabed_and_target_db[i][0],
                      seabed_and_target_db[i][1]);
        bench->scene.seabed.lambert = seabed;
        bench->scene.objects[0].material.lambert = target;
        const struct energies traced = trace_seeds(bench, 100);
        expect_reference(&traced, &reference, seabed / scene.seabed_lambert,
                         target / scene.objects[0].lambert);
    }
    bench_close(bench);
}

/* However weak the surfaces are, each order keeps its energy. */
static void test_reference(void **unused)
{
    (void)unused;
    static const double seabed_and_target_db[][2] = {{-7.0, -7.0},   {-10.0, -10.0},
                                                     {-36.0, -36.0}, {-60.0, -60.0},
                                                     {-10.0, -60.0}, {-60.0, -10.0}};
    struct bench bench;
    make_scene(&bench);
    compare_with_reference(&bench, seabed_and_target_db,
                           sizeof seabed_and_target_db / sizeof *seabed_and_target_db);
}

/* A drum on its side, all within one sphere, which seabed under its overhang is within too. */
static void test_reference_under_overhang(void **unused)
{
    (void)unused;
    static const double seabed_and_target_db[][2] = {{-7.0, -7.0}};
    struct bench bench;
    make_scene_of(&bench, SONJECT_SHAPE_CYLINDER, 0.6, 0.6);
    compare_with_reference(&bench, seabed_and_target_db, 1);
}

/* An object seen by way of the seabed's mirror belongs to the pairs of sources
 * (trace_rough_mirrored.h). Chains, which could find it too, must not count it again: over a mirror
 * without a rough part they have nothing else to find. */
static void test_mirrored_object_is_left_to_pairs(void **unused)
{
    (void)unused;
    struct bench bench;
    make_scene(&bench);
    bench.scene.injection.interactions = 2;
    bench.scene.injection.column_rule = SONJECT_COLUMNS_FOCUSED;
    bench.scene.seabed.forward.reflection = 0.9;
    bench.scene.seabed.forward.lambert = 0.0;
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    bench_ready(&bench);
    trace_once(&bench, &energies);
    assert_true(bench.tracer.counts.queries > bench.tracer.counts.rays + 1000);
    for (int range = 0; range < RANGES; range++)
        assert_true(energies.sum[1][range] == 0.0);
    bench_close(&bench);
}

/* The narrowest cones are 2500 times as bright as Lambert's law; tallies must hold them: a sphere
 * echoes a quarter of its radius' square at once, and other paths add to that. A tilted plate
 * mirrors past the sonar. */
static void test_narrowest_cone_is_in_scale(void **unused)
{
    (void)unused;
    static const double slopes[] = {0.01, 0.03};
    for (size_t i = 0; i < sizeof slopes / sizeof *slopes; i++) {
        double sum = 0.0, square = 0.0;
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, 120, 160, MIDDLE_M);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.5);
        bench_add(&bench, SONJECT_SHAPE_PLANE, 1.0, 0.6, 0.0)->roll_rad = 68.0 * PI / 180.0;
        for (uint32_t k = 0; k < bench.scene.object_count; k++) {
            bench.scene.objects[k].material.reflection = 0.0;
            bench.scene.objects[k].material.lambert = 0.0;
            bench.scene.objects[k].material.glossy_albedo = 1.0;
            bench.scene.objects[k].material.glossy_slope = slopes[i];
        }
        bench.scene.injection.interactions = SCENE_INTERACTIONS_MAX;
        bench.scene.injection.order_energies = i == 0;
        bench_ready(&bench);
        for (int seed = 0; seed < SEEDS; seed++) {
            double energy = 0.0;
            bench.scene.injection.seed = (uint64_t)seed;
            bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
            for (size_t k = 0; k < echoes.rows * echoes.columns; k++)
                energy += (double)echoes.target_energy[k];
            sum += energy;
            square += energy * energy;
            echoes_clear(&echoes);
        }
        bench_close(&bench);
        const double mean = sum / SEEDS;
        const double error = sqrt(fmax(0.0, square / SEEDS - mean * mean) / (SEEDS - 1));
        print_message("slope %g: %.4g +- %.2g m2\n", slopes[i], mean, error);
        assert_true(error < 0.1 * mean);
        assert_true(mean >= 0.25 * 0.25 * 0.25 - 4.0 * error);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reference),
        cmocka_unit_test(test_reference_under_overhang),
        cmocka_unit_test(test_two_estimators),
        cmocka_unit_test(test_two_estimators_under_overhangs),
        cmocka_unit_test(test_brute_force_leaves_glints_out),
        cmocka_unit_test(test_two_estimators_over_relief),
        cmocka_unit_test(test_reciprocity_over_relief),
        cmocka_unit_test(test_reciprocity),
        cmocka_unit_test(test_focused_columns),
        cmocka_unit_test(test_mirrored_object_is_left_to_pairs),
        cmocka_unit_test(test_narrowest_cone_is_in_scale),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
