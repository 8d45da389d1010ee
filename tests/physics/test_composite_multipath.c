/* What two interactions add to a measured picture: where, how strong, and nothing elsewhere. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "inject/injection.h"

#define ROWS     240
#define COLUMNS  320
#define PIXELS   ((size_t)ROWS * COLUMNS)
#define RANGE    50.0
#define SEEDS    12
#define LENGTH_M 2.3

/* A measured patch: independent circular deviates of unit mean square. */
static float *measured_field(void)
{
    float *field = calloc(2 * PIXELS, sizeof *field);
    assert_non_null(field);
    uint64_t state = 20061;
    for (size_t i = 0; i < PIXELS; i++) {
        double u[2];
        for (int k = 0; k < 2; k++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            u[k] = ((double)(state >> 11) + 0.5) / 9007199254740992.0;
        }
        field[2 * i] = (float)(sqrt(-log(u[0])) * cos(2.0 * PI * u[1]));
        field[2 * i + 1] = (float)(sqrt(-log(u[0])) * sin(2.0 * PI * u[1]));
    }
    return field;
}

static void inject(struct bench *bench, const float *field, uint32_t interactions,
                   struct injection_result *result)
{
    struct injection_input input;
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.is_complex = true;
    input.pixels = field;
    bench->scene.injection.interactions = interactions;
    bench->scene.injection.order_energies = true;
    if (injection_run(&bench->report, bench->tracer.device, &bench->scene, &input, NULL, NULL,
                      result) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

/* Figure 7's capsule, broadside. */
static void open_with_capsule(struct bench *bench)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    sonject_object_params *object = bench_add(bench, SONJECT_SHAPE_CAPSULE, LENGTH_M, 0.0, 0.3);
    object->burial_m = 0.1;
    sonject_material_params_init(&object->material);
}

/* The seabed's own energy in a pixel of a column, where nothing else is: the mean over the first
 * rows. */
static double plain_energy(const struct injection_result *result, size_t column)
{
    double sum = 0.0;
    for (size_t row = 0; row < ROWS / 8; row++)
        sum += result->energy[row * COLUMNS + column];
    return sum / (ROWS / 8);
}

static bool is_near(size_t row, size_t column)
{
    const double spacing = 0.025;
    const double along = ((double)row - 0.5 * (ROWS - 1)) * spacing;
    const double across = ((double)column - 0.5 * (COLUMNS - 1)) * spacing;
    return fabs(along) < 0.5 * LENGTH_M && fabs(across) < 0.5;
}

/* A path of two legs over the seabed and the target is never shorter than there and back to the
 * farther of both, so none is seen before the target, but for the pulse: six deviations leave
 * exp(-18). */
static size_t first_column_of_paths(const struct bench *bench)
{
    const double nearest = placement_range(&bench->placements[0], &bench->tracer.view) - 0.15;
    return (size_t)floor(view_column_of_range(
        &bench->tracer.view, nearest - 6.0 * bench->tracer.response.range_deviation_m));
}

/* Measured pixels that two interactions change beyond what one does, and by how much: the change's
 * mean square over what is expected of it. */
static void test_change_is_that_of_the_second_interaction(void **unused)
{
    (void)unused;
    double ratios[SEEDS], levels[SEEDS];
    float *field = measured_field();
    for (int seed = 0; seed < SEEDS; seed++) {
        struct bench bench;
        struct injection_result one, two;
        open_with_capsule(&bench);
        bench_ready(&bench);
        bench.scene.injection.seed = (uint64_t)seed + 1;
        inject(&bench, field, 1, &one);
        inject(&bench, field, 2, &two);
        double change = 0.0, expected = 0.0, in_shadow = 0.0;
        size_t kept = 0, shaded = 0;
        const size_t first = first_column_of_paths(&bench);
        for (size_t i = 0; i < PIXELS; i++) {
            const size_t row = i / COLUMNS, column = i % COLUMNS;
            if (!two.influence[i]) {
                assert_memory_equal(&((const float *)two.image)[2 * i], &field[2 * i],
                                    2 * sizeof(float));
                kept++;
            }
            if (column < first)
                assert_memory_equal(&((const float *)two.image)[2 * i],
                                    &((const float *)one.image)[2 * i], 2 * sizeof(float));
            if (!is_near(row, column) || !one.influence[i])
                continue;
            change += pow((double)two.image[2 * i] - one.image[2 * i], 2.0) +
                      pow((double)two.image[2 * i + 1] - one.image[2 * i + 1], 2.0);
            const double plain = plain_energy(&one, column);
            expected += two.order_energy[1][i] / plain;
            if (one.visibility[i] < 0.1f) {
                in_shadow += two.order_energy[1][i] / plain;
                shaded++;
            }
        }
        assert_true(kept > PIXELS / 2);
        ratios[seed] = change / expected;
        assert_true(shaded > 300);
        levels[seed] = in_shadow / (double)shaded;
        injection_result_clear(&one);
        injection_result_clear(&two);
        bench_close(&bench);
    }
    free(field);
    double mean = 0.0, squares = 0.0, level = 0.0;
    for (int i = 0; i < SEEDS; i++) {
        mean += ratios[i] / SEEDS;
        level += levels[i] / SEEDS;
    }
    for (int i = 0; i < SEEDS; i++)
        squares += pow(ratios[i] - mean, 2.0);
    const double error = sqrt(squares / (SEEDS * (SEEDS - 1.0)));
    print_message("in the shadow, over the seabed beside it: %.1f dB\n", decibels_of_energy(level));
    expect_close("change over what is expected", mean, 1.0, 4.0 * error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_change_is_that_of_the_second_interaction),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
