/* Shadows of a sidescan are those of its pings: their edges are as wide as the beam is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "bench.h"

#define ROWS        241
#define COLUMNS     161
#define MIDDLE_ROW  120
#define ROW_SPACING 0.05
#define ARRAY       0.5
#define SCREEN_H    1.0 /* m, height of the screen */
#define SCREEN_W    3.0

static void open_sidescan(struct bench *bench, double range)
{
    bench_open(bench, ROWS, COLUMNS, range);
    bench->scene.geometry.row_spacing_m = ROW_SPACING;
    bench->scene.sonar.kind = SONJECT_SONAR_REAL;
    bench->scene.sonar.array_length_m = ARRAY;
    bench->scene.injection.ray_scale = 4.0;
}

/* An upright screen square to the way from the middle row, 1 m before the middle of the patch. */
static void add_screen(struct bench *bench, double range)
{
    sonject_object_params *screen =
        bench_add(bench, SONJECT_SHAPE_PLANE, SCREEN_W, 2.0 * SCREEN_H, 0.0);
    screen->roll_rad = 0.5 * PI;
    screen->burial_m = SCREEN_H;
    screen->position_kind = SONJECT_POSITION_METRES;
    screen->position_along = MIDDLE_ROW * ROW_SPACING;
    screen->position_range = range - 1.0;
}

/* Two-way energy pattern of the array, from its definition. */
static double pattern(double sine)
{
    const double z = PI * ARRAY * sine / 0.015;
    return z == 0.0 ? 1.0 : pow(sin(z) / z, 4.0);
}

/* Share of its beam that a ping sees past a screen around 0, x being the ping's place and s the
 * distance of the screen: the edge is as wide as the beam is there. */
static double expected_visibility(double x, double s)
{
    const double reach = 2.0 * 0.015 / ARRAY;
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < 4000; i++) {
        const double sine = reach * ((i + 0.5) / 2000.0 - 1.0);
        const double at_screen = x + s * sine / sqrt(1.0 - sine * sine);
        seen += fabs(at_screen) > 0.5 * SCREEN_W ? pattern(sine) : 0.0;
        all += pattern(sine);
    }
    return seen / all;
}

/* Visibility half-way down the shadow, mean over columns that the pulse joins. */
static void line_behind(struct bench *bench, double line[ROWS])
{
    struct echoes echoes;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    for (size_t row = 0; row < ROWS; row++) {
        line[row] = 0.0;
        for (size_t k = COLUMNS / 2 - 4; k <= COLUMNS / 2 + 4; k++) {
            const size_t i = row * COLUMNS + k;
            line[row] += (1.0 - (double)echoes.lost_energy[i] / echoes.seabed_energy[i]) / 9.0;
        }
    }
    echoes_clear(&echoes);
}

/* What the screen hides, m along the track, and where its middle is. */
static void hidden(const double line[ROWS], double *width, double *middle)
{
    *width = 0.0;
    *middle = 0.0;
    for (size_t row = 0; row < ROWS; row++) {
        const double x = ((double)row - MIDDLE_ROW) * ROW_SPACING;
        *width += (1.0 - line[row]) * ROW_SPACING;
        *middle += (1.0 - line[row]) * ROW_SPACING * x;
    }
    *middle /= *width;
}

static void test_edges_widen_with_range(void **unused)
{
    (void)unused;
    static const double ranges[] = {25.0, 40.0, 55.0};
    for (int i = 0; i < 3; i++) {
        struct bench bench;
        double line[ROWS];
        open_sidescan(&bench, ranges[i]);
        add_screen(&bench, ranges[i]);
        line_behind(&bench, line);
        const double s = ranges[i] - 1.0;
        double square = 0.0, other = 0.0;
        for (size_t row = 0; row < ROWS; row++) {
            const double x = ((double)row - MIDDLE_ROW) * ROW_SPACING;
            const double error = line[row] - expected_visibility(x, s);
            const double wider = line[row] - expected_visibility(x, 1.15 * s);
            square += error * error;
            other += wider * wider;
        }
        print_message("%g m: beam %.2f m; one that is 15 %% wider misses by %.4f\n", ranges[i],
                      s * 0.015 / ARRAY, sqrt(other / ROWS));
        /* some 1200 stratified rays a point */
        expect_below("rms of visibility less expected", sqrt(square / ROWS), 0.008);
        bench_close(&bench);
    }
}

/* A turned array looks at the screen from elsewhere: from where its beam's middle meets it. */
static void test_heading_moves_shadows(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        double width, middle, line[ROWS];
        struct bench bench;
        open_sidescan(&bench, 40.0);
        bench.scene.geometry.side = i ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        bench.scene.sonar.array_heading_rad = 0.08;
        add_screen(&bench, 40.0);
        line_behind(&bench, line);
        hidden(line, &width, &middle);
        expect_close("shadow's width, m", width, SCREEN_W, 0.05);
        /* heading turns the bow towards the imaged side, and the beam backwards: pings that see the
         * screen are ahead of it, which to starboard is before it in the view's rows. The long side
         * has a cosine off the slant plane as well: x at the array's ground range. The patch's
         * columns lie 1 m behind the screen */
        const double ground = sqrt(39.0 * 39.0 - 100.0);
        expect_close("shadow's middle, m", middle, (i ? -1.0 : 1.0) * ground * tan(0.08), 0.03);
        bench_close(&bench);
    }
}

/* Energy of the patch's middle bins, a strip. */
static double seabed_in_middle(struct bench *bench, bool is_beam)
{
    struct tracer *tracer = &bench->tracer;
    struct rough_trace trace;
    const sonject_status status = is_beam
                                      ? rough_trace_begin_beam(&trace, tracer, &tracer->response)
                                      : rough_trace_begin(&trace, tracer, NULL);
    assert_int_equal(status, SONJECT_OK);
    const struct line_grid *grid = &trace.grid;
    float *energy = calloc(line_grid_cells(grid), sizeof *energy);
    assert_non_null(energy);
    assert_int_equal(rough_trace_strips(&trace, tracer, grid->strips, energy), SONJECT_OK);
    const int32_t middle = COLUMNS / 2 * (int32_t)grid->bins_per_pixel - grid->bins.first;
    double sum = 0.0;
    for (int32_t strip = 0; strip < grid->strips.count; strip++)
        for (int32_t bin = middle - 20; bin <= middle + 20; bin++)
            sum += energy[strip * grid->bins.count + bin];
    sum /= grid->strips.count;
    free(energy);
    rough_trace_end(&trace);
    return sum;
}

/* A ping's energy over that of a strip: integral of sinc^4, 2/3 of range wavelength / length, over
 * the strip's width. */
static void test_seabed_grows_with_range(void **unused)
{
    (void)unused;
    static const double ranges[] = {25.0, 40.0, 55.0};
    for (int i = 0; i < 3; i++) {
        struct bench bench;
        open_sidescan(&bench, ranges[i]);
        bench_ready(&bench);
        print_message("%g m\n", ranges[i]);
        /* 10^5 rays of weights whose deviation is below their mean: 0.014 dB */
        expect_close(
            "ping over strip, dB",
            decibels_of_energy(seabed_in_middle(&bench, true) / seabed_in_middle(&bench, false)),
            decibels_of_energy(2.0 / 3.0 * ranges[i] * 0.015 / ARRAY / ROW_SPACING), 0.06);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edges_widen_with_range),
        cmocka_unit_test(test_heading_moves_shadows),
        cmocka_unit_test(test_seabed_grows_with_range),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
