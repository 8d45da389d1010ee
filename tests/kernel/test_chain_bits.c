/* The same bits everywhere for chains of several interactions: what a device tallies, at any width,
 * chunking and core count, is what the same kernel functions give as plain C, one lane at a time.
 */
#include "claims.h"
#include "trace_chains.h"

#include "device/device.h"
#include "physics/bench.h"
#include "trace/chains.h"

#define ROWS    64
#define COLUMNS 96

struct variant {
    const char *name;
    uint32_t interactions, estimator, column_rule, forward_rule;
    int has_map, has_wide_source, seabed_is_smooth, has_layers, has_surface, has_relief;
};

static const struct variant variants[] = {
    {"focused", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_FOCUSED, SONJECT_FORWARD_MODEL, 0, 0,
     0, 0, 0, 0},
    {"paper columns and map", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_PAPER,
     SONJECT_FORWARD_MAP, 1, 0, 0, 0, 0, 0},
    {"wide source, smooth seabed", 4, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_FOCUSED,
     SONJECT_FORWARD_MODEL, 0, 1, 1, 0, 0, 0},
    {"brute force", 3, SONJECT_ESTIMATOR_BRUTE_FORCE, SONJECT_COLUMNS_PAPER, SONJECT_FORWARD_MODEL,
     0, 1, 0, 0, 0, 0},
    {"focused through layers", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_FOCUSED,
     SONJECT_FORWARD_MODEL, 0, 0, 1, 1, 0, 0},
    {"wide source and map through layers", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_PAPER,
     SONJECT_FORWARD_MAP, 1, 1, 0, 1, 0, 0},
    {"focused below the surface", 4, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_FOCUSED,
     SONJECT_FORWARD_MODEL, 0, 0, 1, 0, 1, 0},
    {"wide source and map below the surface", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_PAPER,
     SONJECT_FORWARD_MAP, 1, 1, 0, 0, 1, 0},
    {"brute force below the surface", 3, SONJECT_ESTIMATOR_BRUTE_FORCE, SONJECT_COLUMNS_PAPER,
     SONJECT_FORWARD_MODEL, 0, 1, 0, 0, 1, 0},
    {"among ripples", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_FOCUSED, SONJECT_FORWARD_MAP, 1,
     0, 0, 0, 0, 1},
    {"among ripples below the surface", 3, SONJECT_ESTIMATOR_CONNECT, SONJECT_COLUMNS_FOCUSED,
     SONJECT_FORWARD_MAP, 1, 0, 0, 0, 1, 1},
    {"brute force among ripples", 3, SONJECT_ESTIMATOR_BRUTE_FORCE, SONJECT_COLUMNS_PAPER,
     SONJECT_FORWARD_MODEL, 0, 1, 0, 0, 0, 1},
};

static void make_scene(struct bench *bench, const struct variant *variant)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.02}, {3.0, 1530.0, 1.0}};
    struct scene *scene = &bench->scene;
    sonject_object_params *sphere = bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.5);
    sphere->material.lambert = 0.2;
    sphere->material.reflection = 0.9;
    sphere->material.roughness_m = 1e-3;
    sonject_object_params *capsule = bench_add(bench, SONJECT_SHAPE_CAPSULE, 1.0, 0.0, 0.3);
    capsule->material.reflection = 0.0;
    capsule->material.lambert = 0.1;
    capsule->material.lambert_exponent = 2.0;
    capsule->material.glossy_albedo = 0.5;
    capsule->heading_rad = 0.6;
    capsule->burial_m = 0.1;
    capsule->position_kind = SONJECT_POSITION_PIXELS;
    capsule->position_along = 40.0;
    capsule->position_range = 40.0;
    if (variant->has_layers)
        bench_set_layers(bench, layers, 2);
    if (variant->has_relief) {
        struct relief_feature *ripples = bench_add_relief(bench, RELIEF_RIPPLES);
        ripples->wavelength_m = 0.4;
        ripples->height_m = 0.06;
        ripples->heading_rad = 1.2;
    }
    scene->seabed.lambert = 0.2;
    scene->seabed.forward_rule = variant->forward_rule;
    if (variant->seabed_is_smooth) {
        scene->seabed.forward.reflection_kind = SONJECT_REFLECTION_FLUID;
        scene->seabed.forward.density_ratio = 1.8;
        scene->seabed.forward.speed_ratio = 1.15;
        scene->seabed.forward.loss = 0.016;
        scene->seabed.forward.roughness_m = 2e-3;
    }
    if (variant->has_surface) {
        scene->surface.water_depth_m = 13.0;
        scene->surface.material.roughness_m = 2e-3;
        scene->surface.material.lambert = 0.1;
        scene->surface.material.lambert_exponent = 1.5;
    }
    scene->sonar.transducer_side_m = variant->has_wide_source ? 4.0 : 0.0;
    scene->injection.interactions = variant->interactions;
    scene->injection.estimator = variant->estimator;
    scene->injection.column_rule = variant->column_rule;
    scene->injection.order_energies = 1;
    scene->injection.ray_scale = 0.5;
    scene->injection.seed = 0xfedcba9876543210u;
    bench_ready(bench);
}

static float *make_map(const struct variant *variant)
{
    float *map = variant->has_map ? malloc(ROWS * COLUMNS * sizeof *map) : NULL;
    for (uint32_t i = 0; map && i < ROWS * COLUMNS; i++) {
        float u, v;
        two_uniforms(random_key_of(5, 0, 99, 0), i, 0, &u, &v);
        map[i] = u < 0.1f ? 0.0f : -3.0f * natural_logarithm(v);
    }
    return map;
}

/* The tallies of all planes after all fans. */
static int64_t *trace_on_device(struct bench *bench, const float *map, int32_t chunk, size_t *count,
                                struct trace_counts *counts)
{
    struct chain_trace trace;
    struct tracer *tracer = &bench->tracer;
    memset(&tracer->counts, 0, sizeof tracer->counts);
    sonject_status status = chain_trace_begin(&trace, tracer, map);
    *count = trace.planes * line_grid_cells(&trace.grid);
    int64_t *tallies = malloc(*count * sizeof *tallies);
    assert_non_null(tallies);
    for (uint32_t i = 0; status == SONJECT_OK && i < chain_fan_count(tracer); i++) {
        struct chain_fan fan;
        status = chain_fan_init(&fan, tracer, &trace.grid, trace.has_map, i);
        for (int32_t done = 0; status == SONJECT_OK && done < fan.strips.count; done += chunk) {
            const int32_t left = fan.strips.count - done;
            const struct span strips = {fan.strips.first + done, left < chunk ? left : chunk};
            status = chain_trace_strips(&trace, tracer, &fan, strips);
        }
    }
    if (status == SONJECT_OK)
        status = buffer_read(&bench->report, tracer->device, trace.launch.buffers[CHAIN_TALLIES], 0,
                             *count * sizeof *tallies, tallies);
    EXPECT_OK(&bench->report, status);
    chain_trace_end(&trace);
    *counts = tracer->counts;
    return tallies;
}

/* Reads the records that a device was given, so that both work from the same ones. */
static void *copy_buffer(struct bench *bench, device_buffer buffer, size_t bytes)
{
    void *copy = malloc(bytes);
    assert_non_null(copy);
    EXPECT_OK(&bench->report,
              buffer_read(&bench->report, bench->tracer.device, buffer, 0, bytes, copy));
    return copy;
}

static int64_t *trace_as_c(struct bench *bench, const float *map, struct trace_counts *counts)
{
    struct chain_trace trace;
    EXPECT_OK(&bench->report, chain_trace_begin(&trace, &bench->tracer, map));
    struct chain_record *chains =
        copy_buffer(bench, trace.launch.buffers[CHAIN_RECORD], sizeof *chains);
    struct object_record *objects = bench_copy_buffer(bench, trace.launch.buffers[CHAIN_OBJECTS]);
    struct sphere_record *spheres = copy_buffer(bench, trace.launch.buffers[CHAIN_SPHERES],
                                                (size_t)chains->spheres * sizeof *spheres);
    int64_t *tallies = calloc(trace.planes * line_grid_cells(&trace.grid), sizeof *tallies);
    assert_non_null(tallies);
    memset(counts, 0, sizeof *counts);
    for (uint32_t i = 0; i < chain_fan_count(&bench->tracer); i++) {
        struct chain_fan fan;
        EXPECT_OK(&bench->report,
                  chain_fan_init(&fan, &bench->tracer, &trace.grid, trace.has_map, i));
        fan.record.quanta = ldexpf(1.0f, trace.exponents[0]);
        fan.record.table = trace.table;
        fan.record.first_strip = fan.strips.first;
        fan.record.strips = fan.strips.count;
        for (int strip = 0; strip < fan.strips.count; strip++) {
            const struct outcome_record outcome =
                trace_chains_strip(&fan.record, trace.launch.rays.pieces, chains, objects, spheres,
                                   map, tallies, strip, 0);
            assert_int_equal(outcome.faults, 0);
            counts->rays += outcome.rays;
            counts->queries += outcome.queries;
            counts->impulses += outcome.impulses;
        }
    }
    free(chains);
    free(objects);
    free(spheres);
    chain_trace_end(&trace);
    return tallies;
}

static void compare(const struct variant *variant)
{
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    make_scene(&bench, variant);
    float *map = make_map(variant);
    struct trace_counts expected_counts, counts;
    int64_t *expected = trace_as_c(&bench, map, &expected_counts);
    static const int32_t chunks[] = {1 << 20, 1 << 20, 13};
    for (size_t i = 0; i < COUNT(chunks); i++) {
        size_t count;
        int64_t *measured = trace_on_device(&bench, map, chunks[i], &count, &counts);
        size_t filled = 0;
        for (size_t k = 0; k < count; k++) {
            filled += expected[k] != 0;
            if (measured[k] != expected[k])
                fail_msg("%s, %s: element %zu of %zu is %lld, not %lld", bench_device,
                         variant->name, k, count, (long long)measured[k], (long long)expected[k]);
        }
        assert_true(filled > 300); /* a dead trace would agree too */
        assert_int_equal(counts.rays, expected_counts.rays);
        assert_int_equal(counts.queries, expected_counts.queries);
        assert_int_equal(counts.impulses, expected_counts.impulses);
        free(measured);
    }
    free(expected);
    free(map);
    bench_close(&bench);
}

static void test_chains(void **state)
{
    for (size_t v = 0; v < COUNT(variants); v++)
        compare(&variants[v]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_chains),
    };
    return bench_run_on_devices(tests, COUNT(tests));
}
