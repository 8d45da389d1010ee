/* Tests that the hierarchy over many objects finds what a loop over all objects finds, to the bit.
 * Rays run together and apart, from near and far, as plain C and as vectors. test_bits.c tests
 * devices. */
#include "claims.h"
#include "trace_smooth.h"

#include "kernel/clutter.h"
#include "kernel/random_rays.h"
#include "trace/fan.h"
#include "trace/object_buffer.h"

#define RAYS     4800 /* rays of each kind */
#define ROWS     160
#define COLUMNS  160
#define MIDDLE_M 18.0

/* Arrangements of a test's rays. */
enum ray_kind {
    RAYS_TOGETHER, /* fans, as from the sonar */
    RAYS_APART,    /* each from one object towards another */
    RAYS_FAR,      /* starting up to 5 km away */
    RAYS_LEVEL,    /* along axes and in planes across them, along the seabed */
    RAY_KINDS
};

static struct point point_on(const struct object_record *object)
{
    const struct point centre = {object->centre_x, object->centre_y, object->centre_z};
    return add(centre, random_direction(), uniform(0.0, object->bounding_radius));
}

static void put_ray(float *input, uint32_t i, struct point from, struct point way)
{
    const double length = sqrt(dot(way, way));
    input[i] = (float)from.x;
    input[RAYS + i] = (float)from.y;
    input[2 * RAYS + i] = (float)from.z;
    input[3 * RAYS + i] = (float)(way.x / length);
    input[4 * RAYS + i] = (float)(way.y / length);
    input[5 * RAYS + i] = (float)(way.z / length);
}

static void draw_ray(float *input, uint32_t i, enum ray_kind kind,
                     const struct object_record *objects, int count)
{
    static struct point target;
    const struct object_record *one = &objects[(int)uniform(0.0, count)];
    const struct object_record *other = &objects[(int)uniform(0.0, count)];
    if (kind != RAYS_TOGETHER || i % 16 == 0)
        target = point_on(one);
    struct point from = point_on(other);
    struct point to = target;
    if (kind == RAYS_TOGETHER) {
        /* points are counted from broadside of the frame's origin, 1 mm from ray to ray */
        const struct point back = {0.0, -0.94, 0.34};
        to.x += uniform(-0.01, 0.01);
        to.z += 1e-3 * (i % 16);
        from = add(to, back, 3.0);
    } else if (kind == RAYS_FAR) {
        from = add(to, random_direction(), uniform(50.0, 5000.0));
    } else if (kind == RAYS_LEVEL) {
        const int axis = (int)uniform(0.0, 4.0);
        from.x = axis == 0 || axis == 3 ? to.x : from.x;
        from.y = axis == 1 ? to.y : from.y;
        from.z = axis == 2 || axis == 3 ? to.z : from.z;
        from = axis == 3 ? add(to, (struct point){0.0, -1.0, 0.0}, uniform(0.1, 9.0)) : from;
    }
    put_ray(input, i, from, add(to, from, -1.0));
    input[6 * RAYS + i] = (float)uniform(0.0, kind == RAYS_FAR ? 5000.0 : 4.0);
    input[7 * RAYS + i] = (float)(other - objects);
}

/* A scene of clutter, with records that have the tree and records that do not. */
struct searched {
    struct bench bench;
    struct object_record *with_tree, *looped;
    int count;
};

static void searched_begin(struct searched *searched, uint32_t count)
{
    struct tracer *tracer = &searched->bench.tracer;
    double origin[3];
    device_buffer buffer = NULL;
    bench_open(&searched->bench, ROWS, COLUMNS, MIDDLE_M);
    clutter_strew(&searched->bench, count, 0.8);
    bench_ready(&searched->bench);
    searched->count = (int)count;
    const struct part_list all = all_parts(tracer);
    struct object_record *records;
    patch_fan_origin(origin, &tracer->view);
    EXPECT_OK(tracer->report, object_records_create(&records, tracer, &all, origin));
    EXPECT_OK(tracer->report, object_buffer_create(tracer, records, &all, &buffer));
    searched->with_tree = bench_copy_buffer(&searched->bench, buffer);
    searched->looped = bench_copy_buffer(&searched->bench, buffer);
    assert_true(searched->with_tree[0].tree_words != 0);
    searched->looped[0].tree_words = 0;
    free(records);
    buffer_release(tracer->device, &buffer);
}

static void searched_end(struct searched *searched)
{
    free(searched->with_tree);
    free(searched->looped);
    bench_close(&searched->bench);
}

struct answers {
    float distance[RAYS];
    int32_t object[RAYS];
};

static void compare_answers(const char *what, const struct answers *found,
                            const struct answers *expected)
{
    for (uint32_t i = 0; i < RAYS; i++)
        if (memcmp(&found->distance[i], &expected->distance[i], sizeof(float)) != 0 ||
            found->object[i] != expected->object[i])
            fail_msg("%s: ray %u meets object %d at %.9g, not %d at %.9g", what, (unsigned)i,
                     (int)found->object[i], (double)found->distance[i], (int)expected->object[i],
                     (double)expected->distance[i]);
}

static void compare_searches(const struct searched *searched, enum ray_kind kind,
                             enum search_question question, const float *input)
{
    static struct answers expected, found;
    clutter_search_one(searched->looped, searched->count, question, input, expected.distance,
                       expected.object, RAYS);
    uint32_t met = 0;
    for (uint32_t i = 0; i < RAYS; i++)
        met += question == SEARCH_OBSTACLE ? expected.object[i] != 0 : expected.object[i] >= 0;
    print_message("%d objects, rays of kind %d, question %d: %u of %u meet something\n",
                  searched->count, (int)kind, (int)question, (unsigned)met, (unsigned)RAYS);
    assert_true(met > RAYS / 10);
    clutter_search_one(searched->with_tree, searched->count, question, input, found.distance,
                       found.object, RAYS);
    compare_answers("one lane", &found, &expected);
    clutter_search_wide(searched->with_tree, searched->count, question, input, found.distance,
                        found.object, RAYS);
    compare_answers("eight lanes", &found, &expected);
    clutter_search_wide(searched->looped, searched->count, question, input, found.distance,
                        found.object, RAYS);
    compare_answers("eight lanes in a loop", &found, &expected);
}

TEST(test_tree_is_the_loop)
{
    static const uint32_t counts[] = {17, 41, 250};
    static float input[SEARCH_INPUTS * RAYS];
    for (size_t c = 0; c < COUNT(counts); c++) {
        struct searched searched;
        searched_begin(&searched, counts[c]);
        for (int kind = 0; kind < RAY_KINDS; kind++) {
            for (uint32_t i = 0; i < RAYS; i++)
                draw_ray(input, i, (enum ray_kind)kind, searched.looped, searched.count);
            for (int question = 0; question < SEARCH_QUESTIONS; question++)
                compare_searches(&searched, (enum ray_kind)kind, (enum search_question)question,
                                 input);
        }
        searched_end(&searched);
    }
}

/* Every hit lies inside the object's bounding sphere but for a tenth of the tree's margin. Grazing
 * rays do not use up the margin either. */
TEST(test_hits_are_in_their_spheres)
{
    struct searched searched;
    searched_begin(&searched, 250);
    for (uint32_t i = 0; i < 40 * RAYS; i++) {
        const struct object_record *object = &searched.looped[i % 250];
        const struct point centre = {object->centre_x, object->centre_y, object->centre_z};
        const struct point way = random_direction();
        const struct point edge =
            add(centre, random_direction(), object->bounding_radius * sqrt(uniform(0.0, 1.0)));
        const struct point from = add(edge, way, -uniform(0.0, 20.0));
        struct vector3 p = {(float)from.x, (float)from.y, (float)from.z};
        struct vector3 d = {(float)way.x, (float)way.y, (float)way.z};
        const float distance = object_distance(object, p, d, -60.0f);
        if (distance >= FAR_AWAY)
            continue;
        const struct point met = add(from, way, (double)distance);
        const struct point off = add(met, centre, -1.0);
        /* 1.001: a tenth of the margin; 2e-5: rounding at 20 m */
        assert_true(sqrt(dot(off, off)) <= 1.001 * object->bounding_radius + 2e-5);
    }
    searched_end(&searched);
}

/* The device knows the parts in the way alone. Plain C knows all, with the relief behind them. */
static size_t compare_smooth(struct bench *bench, uint32_t number)
{
    struct smooth_trace trace;
    struct tracer *tracer = &bench->tracer;
    EXPECT_OK(&bench->report, smooth_trace_begin(&trace, tracer, number, NULL));
    const struct span strips = {trace.grid.strips.first, trace.chunk};
    const size_t cells = (size_t)strips.count * (size_t)trace.grid.bins.count;
    float *field = zeroed(2 * cells, sizeof *field);
    int64_t *lines = zeroed(2 * cells, sizeof *lines);
    device_buffer buffer = NULL;
    const struct part_list all = all_parts(tracer);
    struct object_record *records;
    EXPECT_OK(&bench->report,
              object_records_create(&records, tracer, &all, tracer->placements[number].centre));
    EXPECT_OK(&bench->report, smooth_trace_strips(&trace, tracer, strips, field, field + cells));
    EXPECT_OK(&bench->report, object_buffer_create(tracer, records, &all, &buffer));
    struct object_record *objects = bench_copy_buffer(bench, buffer);
    int64_t *from_device = bench_copy_buffer(bench, trace.launch.buffers[LAUNCH_TALLIES]);
    assert_true(trace.launch.fan.objects < (int)tracer->part_count / 2);
    objects[0].tree_words = 0;
    trace.launch.fan.segments = 1;
    trace.launch.fan.objects = (int)tracer->part_count;
    trace.launch.fan.relief_words = object_buffer_relief_words(tracer, tracer->part_count);
    trace.launch.fan.only_object = (int)number;
    struct outcome_record outcome = {0};
    struct trace by_all = {
        .fan = trace.launch.fan, .objects = objects, .tallies = lines, .outcome = &outcome};
    for (int strip = 0; strip < by_all.fan.strips; strip++) {
        begin_strip(&by_all, strip, 0);
        trace_smooth_strip(&by_all, 0);
    }
    assert_int_equal(outcome.faults, 0);
    const size_t filled = bench_expect_sums("glints", from_device, lines, 2 * cells);
    free(field);
    free(lines);
    free(records);
    free(objects);
    free(from_device);
    buffer_release(tracer->device, &buffer);
    smooth_trace_end(&trace);
    return filled;
}

TEST(test_parts_out_of_the_way_change_no_glint)
{
    for (int has_relief = 0; has_relief < 2; has_relief++) {
        struct bench bench;
        size_t filled = 0;
        bench_open(&bench, ROWS, COLUMNS, MIDDLE_M);
        clutter_strew(&bench, 200, 0.4);
        if (has_relief) {
            struct relief_feature *ripples = bench_add_relief(&bench, RELIEF_RIPPLES);
            ripples->wavelength_m = 0.4;
            ripples->height_m = 0.05;
        }
        bench_ready(&bench);
        for (uint32_t number = 0; number < 200; number += has_relief ? 70 : 23)
            filled += compare_smooth(&bench, number);
        assert_true(filled > 300);
        bench_close(&bench);
    }
}

int main(void)
{
    return bench_run_on_devices(own_tests, own_test_count);
}
