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
#include "trace/aspects.h"

#define ROWS        241
#define COLUMNS     401
#define RANGE       44.0
#define MIDDLE_ROW  120
#define SCREEN_H    1.8 /* m, height of the screen */
#define ROW_SPACING 0.025

/* The aspects of the response, whose resolution is the row spacing. */
static void open_sas(struct bench *bench, uint32_t window, double ray_scale)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    bench->scene.geometry.row_spacing_m = ROW_SPACING;
    bench->scene.sonar.aperture_rad = -1.0;
    bench->scene.sonar.response_window = window;
    bench->scene.injection.ray_scale = ray_scale;
}

/* Traces the whole patch; the tiles, for free(). */
static float *trace_tiles(struct bench *bench, struct rough_trace *trace)
{
    if (rough_trace_begin(trace, &bench->tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    float *lines = calloc(line_grid_cells(&trace->grid), sizeof *lines);
    float *tiles = calloc(trace->tile_elements, sizeof *tiles);
    assert_true(lines && tiles);
    if (rough_trace_strips(trace, &bench->tracer, trace->grid.strips, lines) != SONJECT_OK ||
        rough_trace_tiles(trace, &bench->tracer, tiles) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    free(lines);
    return tiles;
}

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
    while (column + 1 < COLUMNS && distance_behind(bench, (double)column, screen_ground) < distance)
        column++;
    return column;
}

/* Mean over nine columns, which the pulse joins anyway, against the geometry, in every row. */
static double line_error(const double *visibility, const struct bench *bench, double width,
                         double ground, size_t column, uint32_t window)
{
    const double sine = aspects_sine(&bench->tracer);
    const double d = distance_behind(bench, (double)column, ground);
    double square = 0.0;
    for (size_t row = 0; row < ROWS; row++) {
        const double x = ((double)row - MIDDLE_ROW) * bench->tracer.view.row_spacing_m;
        double mean = 0.0;
        for (size_t k = column - 4; k <= column + 4; k++)
            mean += visibility[row * COLUMNS + k] / 9.0;
        const double error = mean - expected_visibility(x, width, d, sine, window);
        square += error * error;
    }
    return sqrt(square / ROWS);
}

/* Visibility is linear across a penumbra d * wavelength / (2 resolution) wide at a distance d
 * behind the screen; a Hamming window's square narrows it. The line's own kinks, smoothed over a
 * few pixels, and 70 rays a point, stratified, leave less than 0.015; a penumbra of a tenth more
 * width would miss by 0.02 or more. */
static void compare_penumbra(uint32_t window)
{
    static const double distances[] = {1.0, 3.0, 6.0};
    static const double ground = 40.0;
    struct bench bench;
    open_sas(&bench, window, 4.0);
    add_screen(&bench, 2.0, ground);
    const double slope = bench.tracer.view.wavelength_m / (2.0 * ROW_SPACING);
    double *visibility = visibility_of(&bench);
    for (size_t i = 0; i < 3; i++) {
        const size_t column = column_behind(&bench, ground, distances[i]);
        const double d = distance_behind(&bench, (double)column, ground);
        print_message("%.2f m behind the screen, penumbra %.2f m\n", d, d * slope);
        expect_below("rms of visibility less expected",
                     line_error(visibility, &bench, 2.0, ground, column, window), 0.015);
    }
    free(visibility);
    bench_close(&bench);
}

static void test_penumbra(void **unused)
{
    (void)unused;
    compare_penumbra(SONJECT_WINDOW_RECTANGULAR);
}

static void test_penumbra_of_weighted_aspects(void **unused)
{
    (void)unused;
    compare_penumbra(SONJECT_WINDOW_HAMMING);
}

/* Behind a screen of width w the core closes where the aspects look around both of its ends, at
 * 2 w resolution / wavelength; from there on the share 1 - that / d of them is lit, and the shadow
 * fades. */
static void test_core_closes(void **unused)
{
    (void)unused;
    static const double ground = 40.0;
    static const double width = 0.6;
    struct bench bench;
    open_sas(&bench, SONJECT_WINDOW_RECTANGULAR, 4.0);
    add_screen(&bench, width, ground);
    double *visibility = visibility_of(&bench);
    const double closing = 2.0 * width * ROW_SPACING / bench.tracer.view.wavelength_m;
    for (double d = 0.5; d < 6.5; d += 0.5) {
        const size_t column = column_behind(&bench, ground, d);
        double mean = 0.0;
        for (size_t k = column - 4; k <= column + 4; k++)
            mean += visibility[MIDDLE_ROW * COLUMNS + k] / 9.0;
        print_message("%.1f m behind: ", d);
        /* 70 stratified rays; the tangent's growth over the sine's and cos^2 are below 0.02 */
        expect_close("visibility", mean, d < closing ? 0.0 : 1.0 - closing / d, 0.04);
    }
    free(visibility);
    bench_close(&bench);
}

/* Noise of one pixel's visibility with as many rays as users have by default, where it is largest:
 * in the middle of a penumbra. */
static void test_noise_in_penumbra(void **unused)
{
    (void)unused;
    static const double ground = 40.0;
    struct bench bench;
    double square = 0.0;
    size_t count = 0;
    open_sas(&bench, SONJECT_WINDOW_RECTANGULAR, 1.0);
    add_screen(&bench, 2.0, ground);
    double *visibility = visibility_of(&bench);
    const double sine = aspects_sine(&bench.tracer);
    for (size_t column = column_behind(&bench, ground, 3.0);
         column < column_behind(&bench, ground, 6.0); column++)
        for (size_t row = 0; row < ROWS; row++) {
            const double x = ((double)row - MIDDLE_ROW) * ROW_SPACING;
            const double d = distance_behind(&bench, (double)column, ground);
            const double expected =
                expected_visibility(x, 2.0, d, sine, SONJECT_WINDOW_RECTANGULAR);
            const double error = visibility[row * COLUMNS + column] - expected;
            if (expected < 0.2 || expected > 0.8)
                continue;
            square += error * error;
            count++;
        }
    assert_true(count > 1000);
    /* some 9 rays a pixel would leave 0.16 if they were not stratified; speckle's own standard
     * deviation is 1 of the mean intensity */
    expect_below("rms noise of visibility", sqrt(square / (double)count), 0.1);
    free(visibility);
    bench_close(&bench);
}

/* Lambert's law at an aspect has its cosine squared: 1 - sine^2/3 on the mean of all. */
static void test_seabed_level(void **unused)
{
    (void)unused;
    double sums[2] = {0.0, 0.0};
    double sine = 0.0;
    for (int is_on = 0; is_on < 2; is_on++) {
        struct bench bench;
        struct echoes echoes;
        open_sas(&bench, SONJECT_WINDOW_HAMMING, 1.0);
        bench.scene.sonar.aperture_rad = is_on ? -1.0 : 0.0;
        bench_ready(&bench);
        sine = fmax(sine, aspects_sine(&bench.tracer));
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        for (size_t i = 0; i < ROWS * COLUMNS; i++)
            sums[is_on] += echoes.seabed_energy[i];
        echoes_clear(&echoes);
        bench_close(&bench);
    }
    /* the squared Hamming window's own mean of sine^2; 10^6 rays of stratified weights */
    double weights = 0.0, squares = 0.0;
    for (int i = 0; i < 1000; i++) {
        const double offset = (i + 0.5) / 1000.0 - 0.5;
        const double weight = window_energy(SONJECT_WINDOW_HAMMING, offset);
        weights += weight;
        squares += weight * 4.0 * sine * sine * offset * offset;
    }
    expect_close("level, dB", decibels_of_energy(sums[1] / sums[0]),
                 decibels_of_energy(1.0 - squares / weights), 0.002);
}

/* A rough sphere of 1 cm keeps to its own strip at every height, and has the energy that it has
 * from abreast: only rays that meet it count, wherever they come from, beyond the patch's ends
 * too. */
static void test_highlight_stays(void **unused)
{
    (void)unused;
    static const double heights[] = {0.0, 0.5, 1.5, 1.5};
    static const double rows[] = {MIDDLE_ROW, MIDDLE_ROW, MIDDLE_ROW, 1.0};
    for (size_t i = 0; i < 4; i++) {
        double sums[2] = {0.0, 0.0};
        for (int is_on = 0; is_on < 2; is_on++) {
            struct bench bench;
            struct rough_trace trace;
            open_sas(&bench, SONJECT_WINDOW_RECTANGULAR, 64.0);
            bench.scene.sonar.aperture_rad = is_on ? -1.0 : 0.0;
            sonject_object_params *sphere = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.02);
            sphere->material.lambert = 0.2;
            sphere->material.reflection = 0.0;
            sphere->burial_m = -heights[i];
            sphere->position_kind = SONJECT_POSITION_PIXELS;
            sphere->position_along = rows[i];
            sphere->position_range = 200.0;
            bench_ready(&bench);
            const float *energy = trace_tiles(&bench, &trace);
            const struct line_grid *grid = &trace.tiles[0].grid;
            const double strip_of_sphere =
                view_row_of_x(&bench.tracer.view, bench.placements[0].centre[0]);
            for (int32_t strip = 0; strip < grid->strips.count; strip++)
                for (int32_t bin = 0; bin < grid->bins.count; bin++) {
                    const double here =
                        energy[(size_t)strip * (size_t)grid->bins.count + (size_t)bin];
                    sums[is_on] += here;
                    /* the sphere reaches 0.4 strips to each side of its centre */
                    if (fabs(grid->strips.first + strip - strip_of_sphere) > 0.9)
                        assert_true(here == 0.0);
                }
            free((void *)energy);
            rough_trace_end(&trace);
            bench_close(&bench);
        }
        print_message("%.1f m over the seabed: ", heights[i]);
        /* some 160 strata of elevation, whose rays meet the sphere at chance along the track, with
         * 0.6 on the mean: 0.065 each, four standard errors of their ratio */
        expect_close("energy over that from abreast", sums[1] / sums[0], 1.0, 0.37);
    }
}

/* A steep mound, a quarter of a metre high: rays meet it well before the mean seabed, in
 * other strips than their own, and the image must show it where it is. */
static void test_relief_stays(void **unused)
{
    (void)unused;
    double lines[2][ROWS];
    for (int is_on = 0; is_on < 2; is_on++) {
        struct bench bench;
        struct echoes echoes;
        open_sas(&bench, SONJECT_WINDOW_RECTANGULAR, 2.0);
        bench.scene.sonar.aperture_rad = is_on ? -1.0 : 0.0;
        struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
        mound->radius_m = 0.25;
        mound->height_m = 0.25;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        for (size_t row = 0; row < ROWS; row++) {
            lines[is_on][row] = 0.0;
            /* the side towards the sonar, bright, without the shadow behind */
            for (size_t column = 150; column < 198; column++)
                lines[is_on][row] += echoes.seabed_energy[row * COLUMNS + column];
        }
        echoes_clear(&echoes);
        bench_close(&bench);
    }
    double difference = 0.0, brightness = 0.0;
    for (size_t row = 0; row < ROWS; row++) {
        const double level = lines[0][0];
        difference += fabs(lines[1][row] - lines[0][row]);
        brightness += fabs(lines[0][row] - level);
    }
    /* aspects light its flanks a little otherwise: 0.07; tallied in the rays' own strips, up to
     * 17 cm to each side, it would differ by 0.22 */
    expect_below("difference over the mound's own brightness", difference / brightness, 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_penumbra),     cmocka_unit_test(test_penumbra_of_weighted_aspects),
        cmocka_unit_test(test_core_closes),  cmocka_unit_test(test_noise_in_penumbra),
        cmocka_unit_test(test_seabed_level), cmocka_unit_test(test_highlight_stays),
        cmocka_unit_test(test_relief_stays),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
