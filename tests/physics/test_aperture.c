/* A synthetic aperture sees shadows from all its aspects, and puts what it sees where it is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "aperture_screen.h"
#include "trace/aspects.h"

#define RANGE         44.0
#define SCREEN_HEIGHT 1.8 /* m */

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

/* Visibility is linear across a penumbra d * wavelength / (2 resolution) wide at a distance d
 * behind the screen; a Hamming window's square narrows it. The line's own kinks, smoothed over a
 * few pixels, and 70 rays a point, stratified, leave less than 0.015; a penumbra of a tenth more
 * width would miss by 0.02 or more. */
static void compare_penumbra(uint32_t window)
{
    static const double distances[] = {1.0, 3.0, 6.0};
    static const double ground = 40.0;
    struct bench bench;
    open_synthetic_aperture(&bench, RANGE, window, 4.0);
    add_screen(&bench, 2.0, SCREEN_HEIGHT, ground);
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
    open_synthetic_aperture(&bench, RANGE, SONJECT_WINDOW_RECTANGULAR, 4.0);
    add_screen(&bench, width, SCREEN_HEIGHT, ground);
    double *visibility = visibility_of(&bench);
    const double closing = 2.0 * width * ROW_SPACING / bench.tracer.view.wavelength_m;
    for (double d = 0.5; d < 6.5; d += 0.5) {
        const size_t column = column_behind(&bench, ground, d);
        const double mean = visibility_at(visibility, MIDDLE_ROW, column);
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
    open_synthetic_aperture(&bench, RANGE, SONJECT_WINDOW_RECTANGULAR, 1.0);
    add_screen(&bench, 2.0, SCREEN_HEIGHT, ground);
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
        open_synthetic_aperture(&bench, RANGE, SONJECT_WINDOW_HAMMING, 1.0);
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
            open_synthetic_aperture(&bench, RANGE, SONJECT_WINDOW_RECTANGULAR, 64.0);
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
        open_synthetic_aperture(&bench, RANGE, SONJECT_WINDOW_RECTANGULAR, 2.0);
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
