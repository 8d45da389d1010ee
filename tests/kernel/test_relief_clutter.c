/* A mesh, a user's shape and a sphere over relief and under a sea surface, alone and among so many
 * parts that launches know only some of them: the same bits at every width, and what is alone is
 * what it is among others that are out of its way. */
#include "claims.h"
#include "physics/bench.h"
#include "physics/user_codes.h"

#define ROWS    160
#define COLUMNS 96
#define OTHERS  20

static void make_user_shape(struct bench *bench)
{
    sonject_user_shape_params params = {0};
    params.name = "sphere.cl";
    params.code = SPHERE_CODE;
    params.bounding_radius_m = 0.2;
    params.parameter_count = 1;
    params.parameters[0] = 0.2;
    EXPECT_OK(&bench->report,
              user_shapes_append(&bench->scene.user_shapes, &bench->report, &params));
}

static void add(struct bench *bench, sonject_shape shape, double diameter, double row,
                double column)
{
    sonject_object_params object;
    object_init(&object);
    object.shape = shape;
    object.diameter_m = diameter;
    object.position_kind = SONJECT_POSITION_PIXELS;
    object.position_along = row;
    object.position_range = column;
    object.material.lambert = 0.1;
    object.material.reflection = 0.8;
    object.material.roughness_m = 1e-3;
    EXPECT_OK(&bench->report, scene_append_object(&bench->scene, &bench->report, &object));
}

/* The others stand along the track, 1.5 m and more beside the sphere: in no plane of its rays. */
static void make_scene(struct bench *bench, bool is_crowded)
{
    struct relief_feature *ripples = bench_add_relief(bench, RELIEF_RIPPLES);
    ripples->wavelength_m = 0.5;
    ripples->height_m = 0.05;
    ripples->heading_rad = 1.1;
    struct relief_feature *mound = bench_add_relief(bench, RELIEF_MOUND);
    mound->position_kind = SONJECT_POSITION_PIXELS;
    mound->position_along = 30.0;
    mound->position_range = 50.0;
    mound->radius_m = 0.5;
    mound->height_m = 0.2;
    bench->scene.injection.seed = 0x123456789abcdefu;
    bench->scene.injection.interactions = 3;
    bench->scene.surface.water_depth_m = 13.0;
    bench_add_tetrahedron(bench);
    make_user_shape(bench);
    add(bench, SONJECT_SHAPE_SPHERE, 0.4, 30.0, 40.0);
    add(bench, SONJECT_SHAPE_MESH, 0.0, 100.0, 30.0);
    add(bench, SONJECT_SHAPE_USER, 0.0, 135.0, 60.0);
    for (int i = 0; is_crowded && i < OTHERS; i++)
        add(bench, SONJECT_SHAPE_SPHERE, 0.08 + 0.002 * i, 90.0 + 12.0 * (i % 5),
            12.0 + 20.0 * (i / 5));
    bench_ready(bench);
}

/* What is left of the rough part by way of all paths, and the sphere's glint. */
struct tallies {
    int64_t *tiles, *glint;
    size_t tile_elements, glint_elements;
    int64_t sphere[TILE_PLANES]; /* sums over the sphere's tile, whose size may differ */
};

static void trace_glint(struct bench *bench, struct tallies *tallies)
{
    struct smooth_trace trace;
    EXPECT_OK(&bench->report, smooth_trace_begin(&trace, &bench->tracer, 0, NULL));
    const struct span strips = {trace.grid.strips.first, trace.chunk};
    const size_t cells = (size_t)strips.count * (size_t)trace.grid.bins.count;
    float *field = calloc(2 * cells, sizeof *field);
    assert_non_null(field);
    EXPECT_OK(&bench->report,
              smooth_trace_strips(&trace, &bench->tracer, strips, field, field + cells));
    tallies->glint_elements = 2 * cells;
    tallies->glint = bench_copy_buffer(bench, trace.launch.buffers[SMOOTH_TALLIES]);
    free(field);
    smooth_trace_end(&trace);
}

static struct tallies trace_scene(uint32_t width, bool is_crowded)
{
    static struct rough_trace trace;
    struct tallies tallies;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    bench_set_width(&bench, width);
    make_scene(&bench, is_crowded);
    EXPECT_OK(&bench.report, rough_trace_begin(&trace, &bench.tracer, NULL));
    float *energy = calloc(line_grid_cells(&trace.grid), sizeof *energy);
    assert_non_null(energy);
    EXPECT_OK(&bench.report, rough_trace_strips(&trace, &bench.tracer, trace.grid.strips, energy));
    EXPECT_OK(&bench.report, rough_trace_mirrored(&trace, &bench.tracer));
    free(energy);
    assert_int_equal(trace.tiles[0].offset, 0);
    tallies.tile_elements = trace.tile_elements;
    tallies.tiles = bench_copy_buffer(&bench, trace.launch.buffers[ROUGH_TILES]);
    const size_t cells = line_grid_cells(&trace.tiles[0].grid);
    for (size_t plane = 0; plane < TILE_PLANES; plane++) {
        tallies.sphere[plane] = 0;
        for (size_t i = 0; i < cells; i++)
            tallies.sphere[plane] += tallies.tiles[plane * cells + i];
    }
    rough_trace_end(&trace);
    trace_glint(&bench, &tallies);
    bench_close(&bench);
    return tallies;
}

static void tallies_clear(struct tallies *tallies)
{
    free(tallies->tiles);
    free(tallies->glint);
}

static void expect_same(const char *what, const int64_t *measured, const int64_t *expected,
                        size_t count)
{
    size_t filled = 0;
    for (size_t i = 0; i < count; i++) {
        filled += expected[i] != 0;
        if (measured[i] != expected[i])
            fail_msg("%s: element %zu of %zu is %lld, not %lld", what, i, count,
                     (long long)measured[i], (long long)expected[i]);
    }
    print_message("%s: %zu of %zu elements are not 0\n", what, filled, count);
    assert_true(filled > count / 100);
}

static void test_width_and_what_is_out_of_the_way_change_no_bits(void **state)
{
    uint32_t widths[BENCH_WIDTHS];
    const size_t count = bench_widths(widths);
    struct tallies wide = trace_scene(widths[count - 1], true);
    struct tallies narrow = trace_scene(widths[0], true);
    struct tallies alone = trace_scene(widths[0], false);
    assert_int_equal(wide.tile_elements, narrow.tile_elements);
    assert_int_equal(wide.glint_elements, narrow.glint_elements);
    assert_int_equal(alone.glint_elements, narrow.glint_elements);
    expect_same("all tiles, most and fewest lanes", wide.tiles, narrow.tiles, narrow.tile_elements);
    expect_same("glint, most and fewest lanes", wide.glint, narrow.glint, narrow.glint_elements);
    expect_same("the sphere's tile among others", narrow.sphere, alone.sphere, TILE_PLANES);
    expect_same("its glint among others", narrow.glint, alone.glint, alone.glint_elements);
    tallies_clear(&wide);
    tallies_clear(&narrow);
    tallies_clear(&alone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_width_and_what_is_out_of_the_way_change_no_bits)};
    return bench_run_on_devices(tests, COUNT(tests));
}
