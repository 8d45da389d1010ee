/* Patches that begin in the water column: the first return from the bottom, and what comes before
 * it. */
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

#define ROWS    48
#define COLUMNS 241
#define RANGE   10.6 /* of the middle: from 7.6 m to 13.6 m, 10 m over the seabed */

/* Energy of a strip up to a ground range y: integral of mu sin^2(grazing) over its length, that is
 * mu h atan(y/h); none before the bin whose middle comes last before the first return. */
static void expect_first_return(double middle_range, double altitude)
{
    struct bench bench;
    struct rough_trace trace;
    bench_open(&bench, ROWS, COLUMNS, middle_range);
    bench.scene.sonar.altitude_m = altitude;
    bench_ready(&bench);
    const struct patch_view *view = &bench.tracer.view;
    assert_int_equal(rough_trace_begin(&trace, &bench.tracer, NULL), SONJECT_OK);
    const struct line_grid *grid = &trace.grid;
    float *energy = calloc(line_grid_cells(grid), sizeof *energy);
    assert_non_null(energy);
    assert_int_equal(rough_trace_strips(&trace, &bench.tracer, grid->strips, energy), SONJECT_OK);
    double sum = 0.0;
    const double mu = bench.scene.seabed.lambert;
    const double strip = view->row_spacing_m / grid->strips_per_row;
    for (int32_t bin = 0; bin < grid->bins.count; bin++) {
        const double per_pixel = grid->bins_per_pixel;
        const double next = view_apparent_range(view, (grid->bins.first + bin + 1) / per_pixel);
        const double end = view_apparent_range(view, (grid->bins.first + bin + 0.5) / per_pixel);
        for (int32_t q = 0; q < grid->strips.count; q++)
            sum += (double)energy[q * grid->bins.count + bin] / grid->strips.count;
        if (next < altitude)
            assert_true(sum == 0.0);
        if (bin % 200 == 150 && end > altitude) {
            print_message("%.2f m: ", end);
            /* sharing smooths the sum over a bin of 3 mm: of its curvature 0.5 m on 1e-5 is left */
            expect_close("energy so far over the closed form",
                         sum / (mu * strip * altitude *
                                atan(sqrt(end * end - altitude * altitude) / altitude)),
                         1.0, 0.001);
        }
    }
    assert_true(sum > 0.0);
    free(energy);
    rough_trace_end(&trace);
    bench_close(&bench);
}

/* From 10 m over the seabed, and from 2 m in a patch that begins nearer to the sonar than the pulse
 * reaches. */
static void test_first_return(void **unused)
{
    (void)unused;
    expect_first_return(RANGE, 10.0);
    expect_first_return(3.01, 2.0);
}

/* A dark water column and an even seabed: the seabed's level is its own up to the first return, and
 * a patch that is traced anew keeps the column's pixels. */
static void test_column_keeps_its_pixels(void **unused)
{
    (void)unused;
    struct bench bench;
    struct injection_result result;
    struct injection_input input;
    float *pixels = calloc(ROWS * COLUMNS, sizeof *pixels);
    assert_non_null(pixels);
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    bench_ready(&bench);
    const size_t water = view_water_columns(&bench.tracer.view);
    assert_int_equal(water, 97); /* 7.6 m + 96 * 2.5 cm is 10 m */
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        pixels[i] = i % COLUMNS < water ? 0.01f : 1.0f;
    struct patch_level level;
    assert_int_equal(patch_level_init(&level, &bench.report, &bench.scene, &bench.tracer.view,
                                      &bench.tracer.response, pixels, false),
                     SONJECT_OK);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        assert_true(fabsf(level.level[i] - 1.0f) < 1e-4f); /* sums in single precision */
    patch_level_clear(&level);
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.pixels = pixels;
    if (injection_run(&bench.report, bench.tracer.device, &bench.scene, &input, NULL, NULL,
                      &result) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    double seabed = 0.0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        if (i % COLUMNS < water)
            assert_true(result.image[i] == pixels[i]);
        else if (i % COLUMNS >= water + 20)
            seabed += result.image[i] * result.image[i];
    }
    /* speckle on 48 x 124 pixels, 2.5 cm apart along the track and at half of that in range */
    expect_close("mean intensity of the seabed", seabed / (ROWS * (double)(COLUMNS - water - 20)),
                 1.0, 0.1);
    injection_result_clear(&result);
    bench_close(&bench);
    free(pixels);
}

static void expect_refused(struct bench *bench, const char *words)
{
    struct water water;
    struct patch_view view;
    struct placements placements;
    memset(&water, 0, sizeof water);
    memset(&placements, 0, sizeof placements);
    assert_int_equal(injection_check(&bench->report, &bench->scene, 0.0, 0.0, ROWS, COLUMNS, &water,
                                     &view, &placements),
                     SONJECT_ERROR_INPUT);
    if (!strstr(bench->report.message, words))
        fail_msg("%s", bench->report.message);
    water_clear(&water);
}

/* Nothing but water; layers, whose rays would start straight down; a target before the bottom. */
static void test_what_is_refused(void **unused)
{
    (void)unused;
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {3.0, 1530.0, 1.0}};
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 6.0);
    expect_refused(&bench, "not beyond the altitude");
    bench_move(&bench, RANGE);
    bench_set_layers(&bench, layers, 2);
    expect_refused(&bench, "not beyond the altitude");
    bench_set_layers(&bench, NULL, 0);
    sonject_object_params *sphere = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.4);
    sphere->position_kind = SONJECT_POSITION_PIXELS;
    sphere->position_along = 20.0;
    sphere->position_range = 90.0;
    expect_refused(&bench, "lies in the water column");
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_return),
        cmocka_unit_test(test_column_keeps_its_pixels),
        cmocka_unit_test(test_what_is_refused),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
