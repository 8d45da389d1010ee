/* What is formed from a file of sums is, bit for bit, what is formed as they are traced. */
#define _POSIX_C_SOURCE 200809L
#include "sea.h"

#include "../unit/temporary_folder.h"
#include "bench.h"
#include "inject/impulse_file.h"
#include "inject/injection.h"

#define ROWS    60
#define COLUMNS 80
#define PIXELS  ((size_t)ROWS * COLUMNS)

static float pixels[PIXELS];

/* A smooth ball and a box that is both rough and smooth, whose shadows meet. */
static void open_bench(struct bench *bench)
{
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] = 0.2f + 0.1f * (float)(i * 7919 % 13);
    bench_open(bench, ROWS, COLUMNS, 30.0);
    bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
    sonject_object_params *box = bench_add(bench, SONJECT_SHAPE_BOX, 0.3, 0.2, 0.0);
    box->height_m = 0.2;
    box->position_kind = SONJECT_POSITION_PIXELS;
    box->position_along = 40.0;
    box->position_range = 50.0;
    box->material.reflection = 0.5;
    box->material.lambert = 0.05;
    bench->scene.injection.interactions = 2;
    bench->scene.injection.order_energies = true;
}

static void trace_to_file(struct bench *bench, const struct injection_input *input,
                          const char *path)
{
    struct sums_writer writer;
    struct sums_head head;
    struct impulse_facts facts;
    const struct impulse_sink sink = {impulse_lines_write, &writer};
    memset(&head, 0, sizeof head);
    memset(&facts, 0, sizeof facts);
    impulse_facts_note_sonar(&facts, &bench->scene.sonar);
    if (sums_writer_begin(&writer, &bench->report, path, NULL) != SONJECT_OK ||
        injection_trace(&bench->report, bench->tracer.device, &bench->scene, input, &sink, NULL,
                        NULL, &facts.counts) != SONJECT_OK ||
        impulse_file_publish(&writer, &head, NULL, &facts, "") != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    sums_writer_clear(&writer);
}

static void form_from_file(struct bench *bench, const struct injection_input *input,
                           const char *path, struct injection_result *result)
{
    struct impulse_file file;
    assert_int_equal(impulse_file_open(&bench->report, path, &file), SONJECT_OK);
    const struct impulse_source source = impulse_file_source(&file);
    if (injection_form(&bench->report, bench->tracer.device, &bench->scene, input, &source, NULL,
                       NULL, result) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    impulse_file_close(&file);
}

static void expect_the_same(const struct injection_result *a, const struct injection_result *b)
{
    assert_memory_equal(a->image, b->image, PIXELS * sizeof *a->image);
    assert_memory_equal(a->field, b->field, 2 * PIXELS * sizeof *a->field);
    assert_memory_equal(a->energy, b->energy, PIXELS * sizeof *a->energy);
    assert_memory_equal(a->visibility, b->visibility, PIXELS * sizeof *a->visibility);
    assert_memory_equal(a->labels, b->labels, PIXELS);
    assert_memory_equal(a->influence, b->influence, PIXELS);
    assert_int_equal(a->orders, b->orders);
    for (uint32_t i = 0; i < a->orders; i++)
        assert_memory_equal(a->order_energy[i], b->order_energy[i], PIXELS * sizeof(float));
    assert_memory_equal(a->objects, b->objects, a->object_count * sizeof *a->objects);
    assert_true(a->statistics.rays == b->statistics.rays);
    assert_true(a->statistics.pings == b->statistics.pings);
    assert_true(a->statistics.impulses == b->statistics.impulses);
}

static void compare(struct bench *bench, struct temporary_folder *folder)
{
    struct injection_input input;
    struct injection_result run, formed;
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.pixels = pixels;
    const char *path = temporary_file(folder, "traced.sums");
    if (injection_run(&bench->report, bench->tracer.device, &bench->scene, &input, NULL, NULL,
                      &run) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    trace_to_file(bench, &input, path);
    form_from_file(bench, &input, path, &formed);
    expect_the_same(&run, &formed);
    assert_true(run.orders == 2);
    injection_result_clear(&run);
    injection_result_clear(&formed);
    bench_close(bench);
}

static void relief_and_mirrors_are_formed_from_a_file(void **state)
{
    struct bench bench;
    open_bench(&bench);
    struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
    mound->height_m = 0.1;
    mound->radius_m = 0.4;
    bench.scene.surface.water_depth_m = 14.0;
    compare(&bench, *state);
}

static void brute_force_is_formed_from_a_file(void **state)
{
    struct bench bench;
    open_bench(&bench);
    bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    bench.scene.injection.estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    bench.scene.sonar.transducer_side_m = 1.0;
    compare(&bench, *state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(relief_and_mirrors_are_formed_from_a_file,
                                        make_temporary_folder, remove_temporary_folder),
        cmocka_unit_test_setup_teardown(brute_force_is_formed_from_a_file, make_temporary_folder,
                                        remove_temporary_folder),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
