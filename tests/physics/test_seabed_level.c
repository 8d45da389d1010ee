/* The mean level of a Lambert seabed: mu sin^2(grazing) times the area of a pixel's point response,
 * at every range, for any number of rays, however the energies are turned into pixels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "bench.h"

#define ROWS    240
#define COLUMNS 200
#define EDGE    24 /* resolution cells of |W|^2 and pulses that pixels near the edge lack */

/* From the formulas, not from seabed_cell_energy: mu sin^2(g) dA, dA = width of |W|^2 times the
 * ground length of G^2, 1.0645 c/2B / cos(g) on the water's own range scale. */
static double closed_form(const struct bench *bench, double apparent_range)
{
    const sonject_sonar_params *sonar = &bench->scene.sonar;
    const double c = bench->scene.medium.sound_speed_mps;
    const double reference = bench->scene.medium.reference_sound_speed_mps > 0.0
                                 ? bench->scene.medium.reference_sound_speed_mps
                                 : c;
    const double range = apparent_range * c / reference;
    const double sine = sonar->altitude_m / range;
    const double cosine = sqrt(1.0 - sine * sine);
    const double delta = sonar->along_track_resolution_m > 0.0
                             ? sonar->along_track_resolution_m
                             : bench->scene.geometry.row_spacing_m;
    /* integral of G^2 over true range: sqrt(pi/(4 ln 2)) = 1.0645 of the half-power width c/2B */
    const double length = sqrt(PI / (4.0 * log(2.0))) * c / (2.0 * sonar->bandwidth_hz);
    return bench->scene.seabed.lambert * sine * sine * delta * length / cosine *
           pow(apparent_range / range, 4.0);
}

/* Means over the pixels away from the edges, each over its own closed form; the standard error of
 * the mean from the scatter of column means, whose neighbours within a pulse are not independent
 * (a factor of 3 pixels at most). */
struct level {
    double mean, error;
};

static struct level level_of(const struct bench *bench, const float *a, const float *b)
{
    double sum = 0.0;
    double squares = 0.0;
    size_t count = 0;
    for (size_t column = EDGE; column < COLUMNS - EDGE; column++) {
        const double expected =
            closed_form(bench, view_apparent_range(&bench->tracer.view, (double)column));
        double column_sum = 0.0;
        for (size_t row = EDGE; row < ROWS - EDGE; row++) {
            const size_t i = row * COLUMNS + column;
            const double energy = b ? (double)a[i] * a[i] + (double)b[i] * b[i] : a[i];
            column_sum += energy / expected;
        }
        const double mean = column_sum / (ROWS - 2 * EDGE);
        sum += mean;
        squares += mean * mean;
        count++;
    }
    struct level level;
    level.mean = sum / (double)count;
    level.error =
        sqrt(3.0 * fmax(0.0, squares / (double)count - level.mean * level.mean) / (double)count);
    return level;
}

static void check_level(struct bench *bench, const char *what)
{
    struct echoes echoes;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
    const struct level energy = level_of(bench, echoes.seabed_energy, NULL);
    const struct level field = level_of(bench, echoes.seabed_real, echoes.seabed_imaginary);
    print_message("%s: expected energy %.5f +- %.5f, realisation %.4f +- %.4f of closed form\n",
                  what, energy.mean, energy.error, field.mean, field.error);
    /* W's tail beyond the kept reach: 0.1 % of the energy */
    expect_close("expected energy over closed form", energy.mean, 1.0, 4.0 * energy.error + 2e-3);
    expect_close("realisation over closed form", field.mean, 1.0, 4.0 * field.error + 2e-3);
    expect_below("4 standard errors of the realisation", 4.0 * field.error, 0.047); /* 0.2 dB */
    expect_below("largest scatter of the expected energy", energy.error, 1e-3);
    echoes_clear(&echoes);
}

static void test_ranges(void **unused)
{
    (void)unused;
    static const double ranges[] = {14.0, 50.0, 180.0};
    for (size_t i = 0; i < 3; i++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, ranges[i]);
        print_message("range %.0f m\n", ranges[i]);
        check_level(&bench, "1 times the rays");
        bench_close(&bench);
    }
}

static void test_ray_count(void **unused)
{
    (void)unused;
    static const double scales[] = {1.0, 4.0, 16.0};
    for (size_t i = 0; i < 3; i++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, 30.0);
        bench.scene.injection.ray_scale = scales[i];
        print_message("%.0f times the rays\n", scales[i]);
        check_level(&bench, "range 30 m");
        bench_close(&bench);
    }
}

/* c_ref is not c: what lies at r shows at r c_ref/c, and energies gain (c_ref/c)^4. */
static void test_wrong_sound_speed(void **unused)
{
    (void)unused;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 30.0);
    bench.scene.medium.reference_sound_speed_mps = 1400.0;
    check_level(&bench, "c_ref 1400 m/s");
    bench_close(&bench);
}

/* A source beside the receiver changes path and angle by a few mm in 30 m: not the level. */
static void test_wide_source(void **unused)
{
    (void)unused;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 30.0);
    bench.scene.sonar.transducer_side_m = 0.1;
    check_level(&bench, "source of 0.1 m");
    bench_close(&bench);
}

/* Another pixel grid, resolution and window: the area of the point response follows. */
static void test_other_pixels(void **unused)
{
    (void)unused;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 30.0);
    bench.scene.geometry.row_spacing_m = 0.03;
    bench.scene.geometry.column_spacing_m = 0.01;
    bench.scene.sonar.along_track_resolution_m = 0.02;
    bench.scene.sonar.bandwidth_hz = 50e3;
    bench_move(&bench, 30.0);
    check_level(&bench, "rows of 3 cm at 2 cm resolution, columns of 1 cm");
    bench_close(&bench);
}

/* A map multiplies: half the ground twice as bright, the middle of each half shows it. */
static void test_map(void **unused)
{
    (void)unused;
    struct bench bench;
    struct echoes echoes;
    float *map = malloc(ROWS * COLUMNS * sizeof *map);
    assert_non_null(map);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        map[i] = (float)((i / COLUMNS < ROWS / 2 ? 1.0 : 3.0) *
                         (i % COLUMNS < COLUMNS / 2 ? 1.0 : 10.0));
    bench_open(&bench, ROWS, COLUMNS, 30.0);
    bench_ready(&bench);
    bench_echoes(&bench, map, SEABED_FIELD_NONE, &echoes);
    static const size_t at[4][2] = {{60, 50}, {180, 50}, {60, 150}, {180, 150}};
    static const double factor[4] = {1.0, 3.0, 10.0, 30.0};
    for (size_t i = 0; i < 4; i++) {
        double sum = 0.0;
        for (size_t row = at[i][0] - 10; row < at[i][0] + 10; row++)
            for (size_t column = at[i][1] - 10; column < at[i][1] + 10; column++)
                sum += echoes.seabed_energy[row * COLUMNS + column] /
                       closed_form(&bench, view_apparent_range(&bench.tracer.view, (double)column));
        /* W's side lobes bring in a little of the brighter half: 1/(pi^2 50) of 2 times its level
         */
        expect_close("over closed form", sum / 400.0 / factor[i], 1.0, 0.01);
    }
    /* the step between columns sits where its pixels are: half-way energy between their middles */
    double line[COLUMNS];
    for (size_t column = 0; column < COLUMNS; column++) {
        line[column] = 0.0;
        for (size_t row = 40; row < 80; row++)
            line[column] +=
                echoes.seabed_energy[row * COLUMNS + column] / 40.0 /
                closed_form(&bench, view_apparent_range(&bench.tracer.view, (double)column));
    }
    size_t step = 80;
    while (step < 120 && line[step + 1] < 5.5)
        step++;
    const double crossing = (double)step + (5.5 - line[step]) / (line[step + 1] - line[step]);
    expect_close("step of the map, column", crossing, COLUMNS / 2 - 0.5, 0.1);
    step = 100;
    while (step < 140 &&
           echoes.seabed_energy[(step + 1) * COLUMNS + 50] <
               2.0 * closed_form(&bench, view_apparent_range(&bench.tracer.view, 50.0)))
        step++;
    expect_close("step of the map, row", (double)step + 0.5, ROWS / 2 - 0.5, 0.51);
    echoes_clear(&echoes);
    bench_close(&bench);
    free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_ray_count),
        cmocka_unit_test(test_wrong_sound_speed),
        cmocka_unit_test(test_wide_source),
        cmocka_unit_test(test_other_pixels),
        cmocka_unit_test(test_map),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
