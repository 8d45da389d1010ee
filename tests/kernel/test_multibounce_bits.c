/* Tests that echoes of several smooth faces have the same bits everywhere. At any width and
 * chunking, a device must tally what the same kernels tally as plain C with the fewest lanes. */
#include "claims.h"

#include "physics/bench.h"

#define ROWS    64
#define COLUMNS 160

struct variant {
    const char *name;
    uint32_t column_rule;
    int seabed_is_smooth, has_layers;
};

static const struct variant variants[] = {
    {"focused", SONJECT_COLUMNS_FOCUSED, 0, 0},
    {"paper columns, smooth seabed and surface", SONJECT_COLUMNS_PAPER, 1, 0},
    {"focused, smooth seabed, through layers", SONJECT_COLUMNS_FOCUSED, 1, 1},
};

/* Makes a scene of a leaning plate, a sphere, a torus, half a tube and a box, closely placed. */
static void make_scene(struct bench *bench, const struct variant *variant)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.02}, {3.0, 1530.0, 1.0}};
    struct scene *scene = &bench->scene;
    bench_place(bench_add(bench, SHAPE_PLANE, 0.5, 0.4, 0.0), 30.0, 70.0, 0.2, 0.1, 0.9);
    bench_place(bench_add(bench, SHAPE_SPHERE, 0.0, 0.0, 0.3), 24.0, 55.0, 0.0, 0.0, 0.0);
    sonject_object_params *torus = bench_add(bench, SHAPE_TORUS, 0.0, 0.0, 0.5);
    torus->height_m = 0.12;
    bench_place(torus, 44.0, 60.0, 0.3, 1.0, 0.0);
    sonject_object_params *tube = bench_add(bench, SHAPE_CYLINDER, 0.4, 0.0, 0.4);
    bench_place(tube, 20.0, 85.0, 1.3, 0.1, 0.0);
    tube->nose_end = SONJECT_END_OPEN;
    tube->tail_end = SONJECT_END_SPHERICAL;
    tube->tail_end_depth_m = 0.05;
    sonject_object_params *box = bench_add(bench, SHAPE_BOX, 0.4, 0.3, 0.0);
    box->height_m = 0.3;
    bench_place(box, 40.0, 80.0, 0.7, 0.0, 0.0);
    if (variant->has_layers)
        bench_set_layers(bench, layers, 2);
    if (variant->seabed_is_smooth) {
        scene->seabed.forward.reflection_kind = SONJECT_REFLECTION_FLUID;
        scene->seabed.forward.density_ratio = 1.8;
        scene->seabed.forward.speed_ratio = 1.15;
        scene->seabed.forward.loss = 0.016;
        scene->surface.water_depth_m = 12.0;
    }
    scene->injection.interactions = 4;
    scene->injection.column_rule = variant->column_rule;
    scene->injection.ray_scale = 0.1;
    scene->injection.seed = 0xfedcba9876543210u;
    bench_ready(bench);
}

static uint64_t add_on_device(struct bench *bench, const struct multibounce_strips *of_part,
                              struct multibounce_launch *of_pair, int32_t wanted_chunk,
                              struct multibounce_sums *sums)
{
    const struct span all = of_part->first_hits;
    const int32_t chunk = wanted_chunk < of_pair->chunk ? wanted_chunk : of_pair->chunk;
    bench->tracer.counts.impulses = 0;
    for (int32_t done = 0; done < all.count; done += chunk) {
        const int32_t left = all.count - done;
        const struct span strips = {all.first + done, left < chunk ? left : chunk};
        EXPECT_OK(&bench->report, multibounce_launch_strips(of_pair, &bench->tracer, strips, sums));
    }
    return bench->tracer.counts.impulses;
}

static void expect_same(const struct multibounce_sums *a, const struct multibounce_sums *b)
{
    for (size_t i = 0; i < a->rows * a->columns; i++) {
        assert_int_equal(a->tiles[i] != NULL, b->tiles[i] != NULL);
        if (a->tiles[i])
            assert_memory_equal(a->tiles[i], b->tiles[i],
                                2 * TILE_STRIPS * TILE_BINS * sizeof(int64_t));
    }
}

/* The reference, and then the device at each width. */
static struct device *devices[1 + BENCH_WIDTHS];
static size_t device_count;

/* Compares one pair's echoes in full and, if told to, small launches. Returns their number. */
static uint64_t compare_pair(struct bench *bench, const struct multibounce_strips *of_part,
                             uint32_t part, const struct image_pair *pair, bool has_small_ones)
{
    struct device *own = bench->tracer.device;
    struct multibounce_sums expected, measured;
    uint64_t impulses = 0;
    size_t d = 0;
    for (; d < device_count; d++) {
        struct multibounce_launch of_pair;
        struct line_grid grid;
        bench->tracer.device = devices[d];
        EXPECT_OK(&bench->report,
                  multibounce_launch_begin(&of_pair, &grid, of_part, &bench->tracer, part, pair));
        if (grid.bins.count == 0)
            break;
        if (d == 0) {
            assert_true(multibounce_sums_init(&expected, &grid));
            impulses = add_on_device(bench, of_part, &of_pair, 1 << 20, &expected);
        }
        for (int is_small = 0; d > 0 && is_small <= has_small_ones; is_small++) {
            assert_true(multibounce_sums_init(&measured, &grid));
            assert_int_equal(
                add_on_device(bench, of_part, &of_pair, is_small ? 37 : 1 << 20, &measured),
                impulses);
            expect_same(&measured, &expected);
            multibounce_sums_clear(&measured);
        }
        multibounce_launch_end(&of_pair);
    }
    bench->tracer.device = own;
    if (d > 0)
        multibounce_sums_clear(&expected);
    return impulses;
}

static void compare_variant(struct bench *bench, const struct variant *variant)
{
    make_scene(bench, variant);
    uint64_t impulses = 0;
    size_t pairs = 0;
    for (uint32_t part = 0; part < bench->scene.object_count; part++) {
        struct multibounce_strips of_part;
        struct image_pairs all;
        struct image_pair pair;
        assert_true(multibounce_may_echo(&bench->tracer, part));
        multibounce_strips_init(&of_part, &bench->tracer, part);
        image_pairs_begin(&all, &bench->tracer, part, true, 2);
        for (; image_pairs_next(&all, &pair); pairs++)
            impulses += compare_pair(bench, &of_part, part, &pair, impulses == 0);
    }
    print_message("%s: %zu pairs, %llu echoes\n", variant->name, pairs,
                  (unsigned long long)impulses);
    assert_true(pairs >= bench->scene.object_count * (variant->seabed_is_smooth ? 4 : 1));
    assert_true(impulses > 2000);
}

TEST(test_multibounce_tallies)
{
    uint32_t widths[BENCH_WIDTHS];
    struct bench bench;
    device_count = 1 + bench_widths(widths);
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    devices[0] = bench_open_reference(&bench);
    for (size_t d = 1; d < device_count; d++)
        devices[d] = bench_open_width(&bench, widths[d - 1]);
    for (size_t i = 0; i < COUNT(variants); i++) {
        scene_clear(&bench.scene);
        scene_init(&bench.scene);
        bench.scene.sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
        bench_set_layers(&bench, NULL, 0);
        bench_move(&bench, 18.0);
        compare_variant(&bench, &variants[i]);
    }
    for (size_t d = 0; d < device_count; d++)
        device_close(&devices[d]);
    bench_close(&bench);
}

int main(void)
{
    return bench_run_on_devices(own_tests, own_test_count);
}
