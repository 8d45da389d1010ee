/* A synthetic aperture sees shadows from all its aspects, and puts what it sees where it is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

#define ROWS       241
#define COLUMNS    401
#define RANGE      44.0
#define MIDDLE_ROW 120
#define SCREEN_H   1.8 /* m, height of the screen */

/* An upright screen across the track's normal in the middle row, its foot at a ground range. */
static void add_screen(struct bench *bench, double width, double ground_range)
{
    sonject_object_params *screen =
        bench_add(bench, SONJECT_SHAPE_PLANE, width, 2.0 * SCREEN_H, 0.0);
    screen->roll_rad = 0.5 * PI;
    screen->burial_m = SCREEN_H;
    screen->position_kind = SONJECT_POSITION_PIXELS;
    screen->position_along = MIDDLE_ROW;
    bench_ready(bench);
    screen->position_range = view_column_of_range(
        &bench->tracer.view, hypot(ground_range, bench->tracer.view.altitude_m));
}

/* Visibility of every pixel. */
static double *visibility_of(struct bench *bench)
{
    struct echoes echoes;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    double *visibility = calloc(ROWS * COLUMNS, sizeof *visibility);
    assert_non_null(visibility);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        visibility[i] = 1.0 - (double)echoes.lost_energy[i] / echoes.seabed_energy[i];
    echoes_clear(&echoes);
    return visibility;
}

/* Energy window of the aspects, over one period of the offset. */
static double window_energy(uint32_t window, double offset)
{
    const double amplitude =
        window == SONJECT_WINDOW_HAMMING ? 0.54 + 0.46 * cos(2.0 * PI * offset) : 1.0;
    return amplitude * amplitude;
}

/* Visibility at x along the track behind a screen of `width` around 0, at a distance d behind it in
 * the plane across the track: the aspects whose way from there, x - d tan(aspect) at the screen, is
 * beside it. Lambert's law gives each aspect the square of its cosine. */
static double expected_visibility(double x, double width, double d, double largest_sine,
                                  uint32_t window)
{
    const int steps = 4000;
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < steps; i++) {
        const double offset = (i + 0.5) / steps - 0.5;
        const double sine = 2.0 * largest_sine * offset;
        const double energy = window_energy(window, offset) * (1.0 - sine * sine);
        const double at_screen = x - d * sine / sqrt(1.0 - sine * sine);
        seen += fabs(at_screen) > 0.5 * width ? energy : 0.0;
        all += energy;
    }
    return seen / all;
}

/* Distance, along the sound's way in the plane across the track, from the screen to a column's
 * seabed. */
static double distance_behind(const struct bench *bench, double column, double screen_ground)
{
    const double range = view_apparent_range(&bench->tracer.view, column);
    const double ground = view_ground_range(&bench->tracer.view, range);
    return (ground - screen_ground) * range / ground;
}

static size_t column_behind(const struct bench *bench, double screen_ground, double distance)
{
    size_t column = 0;
    while (column + 1 < COLUMNS &&
           distance_behind(bench, (double)column, screen_ground) < distance)
        column++;
    return column;
}

/* The response takes in neighbouring rows and columns: some pixels' worth of the expected line. */
static void compare_line(const double *visibility, const struct bench *bench, double width,
                         double ground, size_t column, uint32_t window, double tolerance)
{
    const double sine = 0.25 * bench->tracer.view.wavelength_m /
                        bench->tracer.response.resolution_m;
    const double d = distance_behind(bench, (double)column, ground);
    const double penumbra = 2.0 * d * sine / sqrt(1.0 - sine * sine);
    double square = 0.0, measured = 0.0, expected = 0.0;
    for (size_t row = 0; row < ROWS; row++) {
        const double x = ((double)row - MIDDLE_ROW) * bench->tracer.view.row_spacing_m;
        double mean = 0.0;
        for (int k = -4; k <= 4; k++)
            mean += visibility[row * COLUMNS + (size_t)((int)column + k)] / 9.0;
        const double error = mean - expected_visibility(x, width, d, sine, window);
        square += error * error;
        /* first moment of what is lost: half the penumbra's width enters it squared */
        measured += (1.0 - mean) * x * x;
        expected += (mean - error < 1.0 ? 1.0 - (mean - error) : 0.0) * x * x;
    }
    print_message("%.2f m behind: penumbra %.2f m, lost moment %.5g of %.5g\n", d, penumbra,
                  measured, expected);
    expect_below("rms of visibility - expected", sqrt(square / ROWS), tolerance);
}

static void compare_penumbra(uint32_t window)
{
    static const double distances[] = {1.0, 3.0, 6.0};
    static const double ground = 40.0;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.sonar.aperture_rad = -1.0;
    bench.scene.sonar.response_window = window;
    bench.scene.injection.ray_scale = 4.0;
    add_screen(&bench, 2.0, ground);
    double *visibility = visibility_of(&bench);
    for (size_t i = 0; i < sizeof distances / sizeof *distances; i++)
        compare_line(visibility, &bench, 2.0, ground, column_behind(&bench, ground, distances[i]),
                     window, 0.02);
    free(visibility);
    bench_close(&bench);
}

static void test_penumbra(void **unused)
{
    (void)unused;
    compare_penumbra(SONJECT_WINDOW_RECTANGULAR);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_penumbra),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
