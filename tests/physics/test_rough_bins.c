/* Echoes between range bins. A rough face at one range, moved through a pixel in steps finer than
 * bins: its echo is the pulse at its own range, of its own energy, wherever bins lie. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "bench.h"

#define STEPS   16 /* of a pixel */
#define REACH   3  /* pixels either side that hold its echo */
#define SIDE_M  0.1
#define LAMBERT 0.2

/* Energy of the pixels about the face by column, all rows; returns how far, m, its range lies
 * beyond the middle one's. */
static double trace_face(struct bench *bench, int step, double energy[2 * REACH + 1])
{
    struct echoes echoes;
    sonject_object_params *face = &bench->scene.objects[0];
    face->position_kind = SONJECT_POSITION_METRES;
    face->position_along = 0.5 * (double)bench->rows * bench->scene.geometry.row_spacing_m;
    face->position_range = 50.0 + bench->scene.geometry.column_spacing_m * step / STEPS;
    for (int i = 0; i < 2; i++) { /* it hangs by its lowest point */
        bench_ready(bench);
        face->roll_rad = 0.5 * PI - placement_grazing(&bench->placements[0], &bench->tracer.view);
    }
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    const double range = placement_range(&bench->placements[0], &bench->tracer.view);
    const double column = view_column_of_range(&bench->tracer.view, range);
    const size_t middle = (size_t)(column + 0.5);
    for (int k = 0; k <= 2 * REACH; k++) {
        energy[k] = 0.0;
        for (size_t row = 0; row < echoes.rows; row++)
            energy[k] +=
                (double)echoes.target_energy[row * echoes.columns + middle + (size_t)k - REACH];
    }
    echoes_clear(&echoes);
    return (column - (double)middle) * bench->scene.geometry.column_spacing_m;
}

/* Where the parabola through three logarithms peaks, in their steps from the middle one. */
static double top_of(const double energy[3], double *level)
{
    const double slope = 0.5 * log(energy[2] / energy[0]);
    const double bend = log(energy[2] * energy[0] / (energy[1] * energy[1]));
    *level = exp(log(energy[1]) - 0.5 * slope * slope / bend);
    return -slope / bend;
}

/* Sharing between bins d apart widens the pulse's energy, a Gaussian of variance s^2, by up to
 * d^2/4: with d = s/3.4 its peak is 0.047 dB low at most, and 0.02 mm off. Rays count the face's
 * area to 0.2 %. Of the mean over a pixel no bin can take anything. */
static void test_face_within_a_pixel(void **unused)
{
    (void)unused;
    static double energy[STEPS][2 * REACH + 1], beyond[STEPS];
    struct bench bench;
    bench_open(&bench, 64, 96, 50.0);
    bench.scene.injection.ray_scale = 16.0;
    sonject_object_params *face = bench_add(&bench, SONJECT_SHAPE_PLANE, SIDE_M, SIDE_M, 0.0);
    face->burial_m = -1.0;
    face->material.reflection = 0.0;
    face->material.lambert = LAMBERT;
    double sum = 0.0;
    for (int step = 0; step < STEPS; step++) {
        beyond[step] = trace_face(&bench, step, energy[step]);
        for (int k = 0; k <= 2 * REACH; k++)
            sum += energy[step][k];
    }
    const double spacing = bench.scene.geometry.column_spacing_m;
    const double deviation = bench.tracer.response.range_deviation_m;
    const double peak = sum * spacing / STEPS / (deviation * sqrt(PI));
    double farthest = 0.0, highest = 0.0, lowest = 0.0, worst = 0.0;
    for (int step = 0; step < STEPS; step++) {
        double level;
        const double top = top_of(&energy[step][REACH - 1], &level) * spacing;
        level = decibels_of_energy(level / peak);
        farthest = fmax(farthest, fabs(top - beyond[step]));
        highest = fmax(highest, level);
        lowest = fmin(lowest, level);
        const double off = beyond[step] / deviation;
        const double pixel = energy[step][REACH] / peak * exp(off * off);
        worst = fmax(worst, fabs(decibels_of_energy(pixel)));
    }
    print_message("level re the face's, dB: %.3f to %.3f\n", lowest, highest);
    /* all rows but for the response's tails */
    expect_close("energy over the face's", peak / (LAMBERT * SIDE_M * SIDE_M), 1.0, 0.02);
    expect_below("peak's range off the face's, mm", 1e3 * farthest, 0.1);
    expect_below("level off the face's, dB", fmax(highest, -lowest), 0.05);
    expect_below("the nearest pixel off the pulse, dB", worst, 0.05);
    bench_close(&bench);
}

/* Echoes from beyond the middles of the outermost bins share with them too: rays go that far. Over
 * its neighbour each has 1 but for 1e-4 of range. */
static void test_outermost_bins_are_full(void **unused)
{
    (void)unused;
    struct bench bench;
    struct rough_trace trace;
    bench_open(&bench, 64, 96, 50.0);
    bench.scene.injection.ray_scale = 16.0;
    bench_ready(&bench);
    assert_int_equal(rough_trace_begin(&trace, &bench.tracer, NULL), SONJECT_OK);
    const int32_t strips = trace.grid.strips.count;
    const int32_t bins = trace.grid.bins.count;
    float *energy = calloc(line_grid_cells(&trace.grid), sizeof *energy);
    assert_non_null(energy);
    assert_int_equal(rough_trace_strips(&trace, &bench.tracer, trace.grid.strips, energy),
                     SONJECT_OK);
    const int32_t outermost[2] = {0, bins - 1};
    for (int end = 0; end < 2; end++) {
        double sum = 0.0, square = 0.0;
        for (int32_t strip = 0; strip < strips; strip++) {
            const float *line = &energy[strip * bins];
            const double ratio =
                (double)line[outermost[end]] / (double)line[end == 0 ? 1 : bins - 2];
            sum += ratio / strips;
            square += ratio * ratio / strips;
        }
        expect_close("outermost bin over the one beside it", sum, 1.0,
                     1e-3 + 4.0 * sqrt((square - sum * sum) / strips));
    }
    free(energy);
    rough_trace_end(&trace);
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_face_within_a_pixel),
        cmocka_unit_test(test_outermost_bins_are_full),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
