/* Many objects at a time: each is what it is alone where no other is near, shadows add up, and
 * sound between seabed and many targets is what plain cosine sampling finds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "cl/launch.h"
#include "trace/chains.h"
#include "trace/object_buffer.h"

#define SIDE     10 /* objects in a row, and rows */
#define PIXELS   400
#define MIDDLE_M 25.0

static sonject_object_params object_at(double row, double column, double diameter)
{
    sonject_object_params object;
    sonject_object_params_init(&object);
    object.shape = SONJECT_SHAPE_SPHERE;
    object.diameter_m = diameter;
    object.position_kind = SONJECT_POSITION_PIXELS;
    object.position_along = row;
    object.position_range = column;
    object.material.lambert = 0.2;
    object.material.reflection = 0.9;
    object.material.roughness_m = 0.0;
    return object;
}

static void append(struct bench *bench, const sonject_object_params *object)
{
    if (scene_append_object(&bench->scene, &bench->report, object) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

/* Of a lattice; shadows, of 0.3 m at most, end before the next object. */
static sonject_object_params lattice_object(int number)
{
    const double step = (double)PIXELS / (SIDE + 1);
    return object_at(step * (1 + number / SIDE), 0.9 * step * (1 + number % SIDE),
                     0.06 + 0.0005 * number);
}

/* What the rough part and the glints leave of one object. */
struct traces {
    int64_t *tile, *glint;
    size_t tile_count, glint_count;
    struct line_grid tile_grid;
};

static void *copy_of(struct bench *bench, cl_mem buffer, size_t first, size_t bytes)
{
    void *copy = malloc(bytes);
    assert_non_null(copy);
    if (buffer_read(&bench->report, bench->tracer.device, buffer, first, bytes, copy) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    return copy;
}

static void trace_object(struct bench *bench, struct rough_trace *rough, uint32_t number,
                         struct traces *traces)
{
    struct smooth_trace smooth;
    const struct rough_tile *tile = &rough->tiles[number];
    traces->tile_grid = tile->grid;
    traces->tile_count = TILE_PLANES * line_grid_cells(&tile->grid);
    traces->tile = copy_of(bench, rough->tile_buffer, tile->offset * sizeof(int64_t),
                           traces->tile_count * sizeof(int64_t));
    if (smooth_trace_begin(&smooth, &bench->tracer, number) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    /* the same random numbers whatever the object's number */
    smooth.fan.stream = STREAM_SMOOTH_RAYS;
    const struct span strips = {smooth.grid.strips.first, smooth_trace_chunk(&smooth)};
    const size_t cells = (size_t)strips.count * (size_t)smooth.grid.bins.count;
    float *field = calloc(2 * cells, sizeof *field);
    assert_non_null(field);
    if (smooth_trace_strips(&smooth, &bench->tracer, strips, field, field + cells) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    traces->glint_count = 2 * cells;
    traces->glint =
        copy_of(bench, smooth.on_device.tallies, 0, traces->glint_count * sizeof(int64_t));
    free(field);
    smooth_trace_end(&smooth);
}

static void begin_rough(struct bench *bench, struct rough_trace *trace)
{
    bench_ready(bench);
    if (rough_trace_begin(trace, &bench->tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    float *energy = calloc(line_grid_cells(&trace->grid), sizeof *energy);
    assert_non_null(energy);
    if (rough_trace_strips(trace, &bench->tracer, trace->grid.strips, energy) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    free(energy);
}

static void expect_same(const char *what, int number, const int64_t *in_clutter,
                        const int64_t *alone, size_t count)
{
    size_t filled = 0;
    for (size_t i = 0; i < count; i++) {
        filled += alone[i] != 0;
        if (in_clutter[i] != alone[i])
            fail_msg("%s of object %d: element %zu is %lld among others, %lld alone", what, number,
                     i, (long long)in_clutter[i], (long long)alone[i]);
    }
    assert_true(filled > 20);
}

/* Echo, footprint, shadow and glint of each of 100 objects have the bits that they have alone: rays
 * and their random numbers are the patch's, not the objects'. */
static void test_each_is_what_it_is_alone(void **unused)
{
    (void)unused;
    static struct rough_trace all, one;
    struct bench clutter;
    bench_open(&clutter, PIXELS, PIXELS, MIDDLE_M);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const sonject_object_params object = lattice_object(i);
        append(&clutter, &object);
    }
    begin_rough(&clutter, &all);
    for (int i = 0; i < SIDE * SIDE; i += 9) {
        struct bench alone;
        struct traces expected, found;
        bench_open(&alone, PIXELS, PIXELS, MIDDLE_M);
        const sonject_object_params object = lattice_object(i);
        append(&alone, &object);
        begin_rough(&alone, &one);
        assert_int_equal(one.fan.rays, all.fan.rays);
        trace_object(&alone, &one, 0, &expected);
        trace_object(&clutter, &all, (uint32_t)i, &found);
        assert_int_equal(expected.tile_count, found.tile_count);
        assert_int_equal(expected.glint_count, found.glint_count);
        expect_same("echo and shadow", i, found.tile, expected.tile, expected.tile_count);
        expect_same("glint", i, found.glint, expected.glint, expected.glint_count);
        free(expected.tile);
        free(expected.glint);
        free(found.tile);
        free(found.glint);
        rough_trace_end(&one);
        bench_close(&alone);
    }
    rough_trace_end(&all);
    bench_close(&clutter);
}

/* Energy of the seabed that objects hide, quanta. */
static double hidden_energy(struct bench *bench, struct rough_trace *trace)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < bench->scene.object_count; i++) {
        const size_t plane = line_grid_cells(&trace->tiles[i].grid);
        int64_t *lost = copy_of(bench, trace->tile_buffer,
                                (trace->tiles[i].offset + TILE_LOST * plane) * sizeof(int64_t),
                                plane * sizeof(int64_t));
        for (size_t k = 0; k < plane; k++)
            sum += (double)lost[k];
        free(lost);
    }
    return sum;
}

/* A ball hides as much seabed when 39 others stand in its shadow or inside it: what is hidden twice
 * is lost once. */
static void test_shadows_are_lost_once(void **unused)
{
    (void)unused;
    static struct rough_trace trace;
    double hidden[2];
    for (int is_crowded = 0; is_crowded < 2; is_crowded++) {
        struct bench bench;
        bench_open(&bench, PIXELS, PIXELS, MIDDLE_M);
        for (int i = 0; is_crowded && i < 39; i++) {
            /* inside, or behind within the ball's shadow, of 0.9 m */
            const sonject_object_params small =
                object_at(200.0 + 1.5 * (i % 3 - 1), 150.0 + 0.6 * i, 0.05);
            append(&bench, &small);
        }
        const sonject_object_params ball = object_at(200.0, 150.0, 0.6);
        append(&bench, &ball);
        begin_rough(&bench, &trace);
        hidden[is_crowded] = hidden_energy(&bench, &trace);
        rough_trace_end(&trace);
        bench_close(&bench);
    }
    print_message("hidden %.6g, in a crowd %.6g\n", hidden[0], hidden[1]);
    assert_true(hidden[0] > 0.0 && hidden[0] == hidden[1]);
}

#define RANGES 8
#define SEEDS  24
#define ORDERS 3

/* Sums over seeds of energies by order and range, and of their squares. */
struct energies {
    double sum[ORDERS][RANGES], square[ORDERS][RANGES];
};

/* Plain cosine sampling: nobody is led anywhere. */
static void make_plain(struct bench *bench, struct chain_trace *trace)
{
    struct chain_record *chains = copy_of(bench, trace->chains, 0, sizeof *chains);
    assert_true(chains->groups > 8);
    chains->spheres = 0;
    chains->groups = 0;
    chains->seabed_share = 0.0f;
    buffer_release(&trace->chains);
    if (buffer_create(&bench->report, bench->tracer.device, sizeof *chains, chains,
                      &trace->chains) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    free(chains);
}

static void trace_seed(struct bench *bench, bool is_plain, struct energies *energies)
{
    struct chain_trace trace;
    struct tracer *tracer = &bench->tracer;
    sonject_status status = chain_trace_begin(&trace, tracer, NULL);
    if (status == SONJECT_OK && is_plain)
        make_plain(bench, &trace);
    for (uint32_t i = 0; status == SONJECT_OK && i < chain_fan_count(tracer); i++) {
        struct chain_fan fan;
        status = chain_fan_init(&fan, tracer, &trace.grid, false, i);
        if (status == SONJECT_OK)
            status = chain_trace_strips(&trace, tracer, &fan, fan.strips);
    }
    if (status != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    const size_t cells = line_grid_cells(&trace.grid);
    float *plane = malloc(cells * sizeof *plane);
    assert_non_null(plane);
    for (uint32_t p = 0; p < trace.planes; p++) {
        double values[RANGES] = {0.0};
        if (chain_trace_read(&trace, tracer, p, plane) != SONJECT_OK)
            fail_msg("%s", bench->report.message);
        for (size_t i = 0; i < cells; i++)
            values[i % (size_t)trace.grid.bins.count * RANGES / (size_t)trace.grid.bins.count] +=
                (double)plane[i];
        for (int range = 0; range < RANGES; range++) {
            energies->sum[p + 1][range] += values[range];
            energies->square[p + 1][range] += values[range] * values[range];
        }
    }
    free(plane);
    chain_trace_end(&trace);
}

static struct energies trace_seeds(struct bench *bench, bool is_plain, uint64_t first_seed)
{
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        bench->scene.injection.seed = first_seed + seed;
        trace_seed(bench, is_plain, &energies);
    }
    return energies;
}

static double error_of(const struct energies *energies, int order, int range)
{
    const double mean = energies->sum[order][range] / SEEDS;
    const double variance = energies->square[order][range] / SEEDS - mean * mean;
    return sqrt(fmax(0.0, variance) / (SEEDS - 1));
}

/* ranges: that plain sampling must find to 10 % and better */
static void compare_energies(const char *what, const struct energies *led,
                             const struct energies *plain, int ranges)
{
    for (int order = 1; order < ORDERS; order++) {
        int compared = 0;
        for (int range = 0; range < RANGES; range++) {
            const double mean = led->sum[order][range] / SEEDS;
            const double expected = plain->sum[order][range] / SEEDS;
            const double error = hypot(error_of(led, order, range), error_of(plain, order, range));
            print_message("%s, order %d, range %d: %.4g m2, plain %.4g, +- %.2g (led %.2g)\n", what,
                          order + 1, range, mean, expected, error, error_of(led, order, range));
            if (!(error < 0.1 * expected))
                continue;
            assert_true(fabs(mean - expected) <= 4.0 * error);
            compared++;
        }
        assert_true(compared >= ranges);
    }
}

/* Led from the seabed to one of 160 targets, or not led at all: the same energy. Strewn; heaped so
 * that spheres overlap and hold the seabed about them; and below waves, to which sound is led from
 * the seabed besides. */
static void test_leading_to_many_targets(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        bool is_heap;
        double depth_m; /* 0: no sea surface */
        int ranges;
    } seas[] = {
        {"strewn", false, 0.0, 4}, {"heap", true, 0.0, 4}, {"heap below waves", true, 12.0, 2}};
    for (size_t sea = 0; sea < sizeof seas / sizeof *seas; sea++) {
        const bool is_heap = seas[sea].is_heap;
        struct bench bench;
        bench_open(&bench, 160, 160, MIDDLE_M);
        for (int i = 0; i < 160; i++) {
            const double row = is_heap ? 60.0 + 4.0 * (i % 13) : 12.0 + 11.0 * (i % 13);
            const double column = is_heap ? 60.0 + 4.0 * (i / 13) : 12.0 + 10.0 * (i / 13);
            sonject_object_params object = object_at(row, column, is_heap ? 0.25 : 0.12);
            if (i % 3 == 0) {
                object.shape = SONJECT_SHAPE_CYLINDER;
                object.length_m = 0.5;
                object.diameter_m = 0.08;
                object.heading_rad = 0.7 * i;
                object.burial_m = is_heap ? 0.05 : 0.0;
            }
            object.material.reflection = 0.0;
            append(&bench, &object);
        }
        bench.scene.seabed.lambert = 0.2;
        bench.scene.surface.water_depth_m = seas[sea].depth_m;
        bench.scene.surface.material.roughness_m = 0.1; /* no mirror is left */
        bench.scene.surface.material.lambert = 0.3;
        bench.scene.surface.material.glossy_albedo = 0.0;
        bench.scene.injection.interactions = ORDERS;
        bench.scene.injection.order_energies = 1;
        bench.scene.injection.column_rule = SONJECT_COLUMNS_PAPER;
        bench.scene.injection.ray_scale = 0.05;
        bench_ready(&bench);
        const struct energies led = trace_seeds(&bench, false, 100);
        const struct energies plain = trace_seeds(&bench, true, 900);
        compare_energies(seas[sea].name, &led, &plain, seas[sea].ranges);
        bench_close(&bench);
    }
}

/* More shapes than random numbers are told apart for are refused with one line. */
static void test_too_many_shapes(void **unused)
{
    (void)unused;
    struct bench bench;
    struct placements placed;
    struct scene_part part;
    bench_open(&bench, 160, 160, MIDDLE_M);
    sonject_object_params object = object_at(80.0, 80.0, 0.1);
    append(&bench, &object);
    bench_ready(&bench);
    memset(&part, 0, sizeof part);
    part.object = 1;
    part.shape = object;
    for (int axis = 0; axis < 3; axis++)
        part.axes[axis][axis] = 1.0;
    for (int i = 0; i < 1000; i++)
        assert_int_equal(scene_append_part(&bench.scene, &bench.report, &part), SONJECT_OK);
    for (int i = 1; i <= 24; i++) {
        object.shape = i == 1 ? SONJECT_SHAPE_PARTS : SONJECT_SHAPE_SPHERE;
        append(&bench, &object);
    }
    assert_int_equal(
        placements_init(&placed, &bench.report, &bench.scene, &bench.tracer.view, 0.0, 0.0),
        SONJECT_OK); /* 1024 */
    placements_clear(&placed);
    append(&bench, &object);
    assert_int_equal(
        placements_init(&placed, &bench.report, &bench.scene, &bench.tracer.view, 0.0, 0.0),
        SONJECT_ERROR_INPUT);
    assert_string_equal(bench.report.message,
                        "objects: 1025 shapes, counting those of parts, are too many: a scene may "
                        "have 1024; split it");
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_is_what_it_is_alone),
        cmocka_unit_test(test_shadows_are_lost_once),
        cmocka_unit_test(test_leading_to_many_targets),
        cmocka_unit_test(test_too_many_shapes),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
