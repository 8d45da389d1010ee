/* What a point looks like: resolution, side lobes, energy, and where it lies between pixels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>
#include <stdlib.h>

#include "bench.h"

#define RANGE 50.0

static const struct {
    sonject_response_window window;
    double sidelobe_db;
    uint32_t terms;
} windows[] = {
    {SONJECT_WINDOW_RECTANGULAR, 0.0, 0}, {SONJECT_WINDOW_HAMMING, 0.0, 0},
    {SONJECT_WINDOW_TAYLOR, 25.0, 4},     {SONJECT_WINDOW_TAYLOR, 35.0, 5},
    {SONJECT_WINDOW_TAYLOR, 45.0, 8},
};
#define WINDOWS (sizeof windows / sizeof *windows)

static void choose_window(sonject_sonar_params *sonar, size_t i)
{
    sonar->response_window = windows[i].window;
    if (windows[i].window == SONJECT_WINDOW_TAYLOR) {
        sonar->taylor_sidelobe_db = windows[i].sidelobe_db;
        sonar->taylor_terms = windows[i].terms;
    }
}

static struct point_response response_of(size_t i)
{
    sonject_sonar_params sonar;
    struct point_response response;
    sonject_sonar_params_init(&sonar);
    choose_window(&sonar, i);
    sonar.along_track_resolution_m = 0.04;
    point_response_init(&response, &sonar, 1500.0, 0.025);
    return response;
}

/* Fourier transform of the aspect weighting: the definition of W, by quadrature. Weight over the
 * aspects, u from -1/2 to 1/2: 1, or Hamming's 0.54 + 0.46 cos(2 pi u), both over their mean. */
static double transform(size_t i, double x)
{
    const int steps = 4000;
    double sum = 0.0;
    double total = 0.0;
    for (int k = 0; k < steps; k++) {
        const double u = (k + 0.5) / steps - 0.5;
        const double weight =
            windows[i].window == SONJECT_WINDOW_HAMMING ? 0.54 + 0.46 * cos(2.0 * PI * u) : 1.0;
        sum += weight * cos(2.0 * PI * u * x);
        total += weight;
    }
    return sum / total;
}

/* Taylor's pattern by its zeros: those of an ideal pattern of equal lobes, stretched to meet the
 * sinc's from number `terms` on. */
static double taylor_pattern(double sidelobe_db, int terms, double z)
{
    const double a = acosh(pow(10.0, sidelobe_db / 20.0)) / PI;
    const double stretch = terms / sqrt(a * a + (terms - 0.5) * (terms - 0.5));
    double pattern = z == 0.0 ? 1.0 : sin(PI * z) / (PI * z);
    for (int n = 1; n < terms; n++) {
        const double zero = stretch * sqrt(a * a + (n - 0.5) * (n - 0.5));
        pattern *= (1.0 - z * z / (zero * zero)) / (1.0 - z * z / ((double)n * n));
    }
    return pattern;
}

static void test_cross_range_response(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < WINDOWS; i++) {
        const struct point_response response = response_of(i);
        assert_true(fabs(along_track_response(&response, 0.0) - 1.0) < 1e-12);
        for (double z = -12.037; z < 12.0; z += 0.173) {
            const double expected =
                windows[i].window == SONJECT_WINDOW_TAYLOR
                    ? taylor_pattern(windows[i].sidelobe_db, (int)windows[i].terms, z)
                    : transform(i, z);
            if (fabs(along_track_response(&response, 0.04 * z) - expected) > 1e-6)
                fail_msg("window %zu at %.3f resolutions: %.8f, not %.8f", i, z,
                         along_track_response(&response, 0.04 * z), expected);
        }
    }
}

/* Full width where |W|^2 is half of its peak, in resolutions. */
static double half_power_width(const struct point_response *response)
{
    double low = 0.0;
    double high = 2.0 * response->resolution_m;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (along_track_response(response, middle) > sqrt(0.5))
            low = middle;
        else
            high = middle;
    }
    return 2.0 * low / response->resolution_m;
}

/* The largest |W| beyond the first zero, dB. */
static double highest_lobe(const struct point_response *response)
{
    double x = 0.0;
    const double step = 1e-3 * response->resolution_m;
    while (along_track_response(response, x) > 0.0)
        x += step;
    double highest = 0.0;
    for (; x < 40.0 * response->resolution_m; x += step)
        highest = fmax(highest, fabs(along_track_response(response, x)));
    return decibels_of_amplitude(highest);
}

static void test_widths_and_lobes(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < WINDOWS; i++) {
        const struct point_response response = response_of(i);
        double width = 0.8859; /* 2 x where sinc x = 1/sqrt(2) */
        double lobe = -13.26;
        double tolerance = 0.02;
        if (windows[i].window == SONJECT_WINDOW_HAMMING) {
            width = 1.3030; /* as tables of windows give it: 1.30 bins, lobes at -43 dB */
            lobe = -42.7;
            tolerance = 0.3;
        } else if (windows[i].window == SONJECT_WINDOW_TAYLOR) {
            /* width of the ideal equal-lobe pattern, stretched; lobes a little under the level */
            const double r = pow(10.0, windows[i].sidelobe_db / 20.0);
            const double a = acosh(r) / PI;
            const double n = windows[i].terms;
            width = 2.0 / PI * sqrt(pow(acosh(r), 2.0) - pow(acosh(r / sqrt(2.0)), 2.0)) * n /
                    sqrt(a * a + (n - 0.5) * (n - 0.5));
            lobe = -windows[i].sidelobe_db;
            tolerance = 0.5;
        }
        print_message("window %zu\n", i);
        expect_close("half-power width, resolutions", half_power_width(&response), width,
                     0.01 * width);
        expect_close("highest side lobe, dB", highest_lobe(&response), lobe, tolerance);
        /* energy by quadrature out to 400 resolutions; a tail 2/(2 pi^2 x) of the rest is left */
        double energy = 0.0;
        double inside = 0.0;
        const double step = 0.02 * response.resolution_m;
        const double reach = along_track_energy_reach(&response, 0.01);
        for (double x = 0.5 * step; x < 400.0 * response.resolution_m; x += step) {
            const double w = along_track_response(&response, x);
            energy += 2.0 * w * w * step;
            if (x < reach)
                inside += 2.0 * w * w * step;
        }
        expect_close("energy width over resolution",
                     along_track_energy_width(&response) / response.resolution_m,
                     energy / response.resolution_m, 1e-3);
        expect_close("energy inside the reach of 99 %", inside / energy, 0.99, 6e-3);
    }
}

static void test_range_response(void **unused)
{
    (void)unused;
    const struct point_response response = response_of(0);
    /* half power at half of c/2B = 2.5 cm */
    expect_close("|G|^2 at c/4B", pow(range_response(&response, 0.0125), 2.0), 0.5, 1e-9);
    double energy = 0.0;
    for (double r = -0.2; r < 0.2; r += 1e-5)
        energy += pow(range_response(&response, r), 2.0) * 1e-5;
    expect_close("energy width, m", range_energy_width(&response), energy, 1e-6);
    expect_close("energy width over c/2B", range_energy_width(&response) / 0.025, 1.0645, 1e-4);
}

/* Cuts through the image of a ball far smaller than any resolution. */
#define ROWS    161
#define COLUMNS 121

static void open_fine(struct bench *bench, size_t window)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    bench->scene.geometry.row_spacing_m = 0.005;
    bench->scene.geometry.column_spacing_m = 0.002;
    bench->scene.sonar.along_track_resolution_m = 0.04;
    choose_window(&bench->scene.sonar, window);
    bench_move(bench, RANGE);
    bench->scene.sonar.centre_frequency_hz = 800e3; /* a ball is half a wavelength large at least */
    bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.001)->burial_m = -0.1;
    bench_ready(bench);
    /* puts the ball on the middle of the middle pixel */
    const double range = placement_range(&bench->placements[0], &bench->tracer.view);
    bench_move(bench, range);
    bench->scene.objects[0].position_kind = SONJECT_POSITION_METRES;
    bench->scene.objects[0].position_along = 80 * 0.005;
    bench->scene.objects[0].position_range = RANGE;
    bench_ready(bench);
}

static double amplitude_at(const struct echoes *echoes, size_t row, size_t column)
{
    const size_t i = row * echoes->columns + column;
    return hypot(echoes->target_real[i], echoes->target_imaginary[i]);
}

static void test_image_of_a_point(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < WINDOWS; i++) {
        struct bench bench;
        struct echoes echoes;
        open_fine(&bench, i);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        const double peak = amplitude_at(&echoes, 80, 60);
        assert_true(peak > 0.0);
        double worst_row = 0.0;
        double worst_column = 0.0;
        /* sub-strips of 2.5 mm hold the ball in two of them: W's mean over 2.5 mm of 40 */
        for (size_t row = 0; row < ROWS; row++) {
            const double x = ((double)row - 80.0) * 0.005;
            const double w = 0.5 * (along_track_response(&bench.tracer.response, x - 0.00125) +
                                    along_track_response(&bench.tracer.response, x + 0.00125));
            worst_row = fmax(worst_row, fabs(amplitude_at(&echoes, row, 60) / peak - fabs(w)));
        }
        for (size_t column = 0; column < COLUMNS; column++)
            worst_column =
                fmax(worst_column,
                     fabs(amplitude_at(&echoes, 80, column) / peak -
                          range_response(&bench.tracer.response, ((double)column - 60.0) * 0.002)));
        print_message("window %zu\n", i);
        expect_below("along-track cut less W", worst_row, 0.02);
        expect_below("range cut less G", worst_column, 0.02);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* Centroid of the energy about the brightest pixel. */
static void centroid(const struct echoes *echoes, double *row, double *column)
{
    double sum = 0.0;
    *row = 0.0;
    *column = 0.0;
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++) {
        const double energy =
            pow(echoes->target_real[i], 2.0) + pow(echoes->target_imaginary[i], 2.0);
        sum += energy;
        *row += energy * (double)(i / echoes->columns);
        *column += energy * (double)(i % echoes->columns);
    }
    *row /= sum;
    *column /= sum;
}

/* A ball moved by a part of a pixel is seen moved by that part. */
static void test_between_pixels(void **unused)
{
    (void)unused;
    double first_row = 0.0;
    double first_column = 0.0;
    double first_range = 0.0;
    for (int step = 0; step <= 8; step++) {
        struct bench bench;
        struct echoes echoes;
        double row, column;
        bench_open(&bench, 101, 101, RANGE);
        choose_window(&bench.scene.sonar, 3); /* low side lobes: the patch cuts nothing off */
        /* a centroid needs |W|^2 and G^2 sampled finely enough: twice an image's usual pixels */
        bench.scene.sonar.along_track_resolution_m = 0.05;
        bench.scene.sonar.bandwidth_hz = 15e3;
        bench.scene.injection.ray_scale = 16.0;
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.05);
        object->burial_m = -0.1;
        object->position_kind = SONJECT_POSITION_METRES;
        object->position_along = (50.0 + step / 8.0) * 0.025;
        object->position_range = RANGE + step / 8.0 * 0.025;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        centroid(&echoes, &row, &column);
        const double range = placement_range(&bench.placements[0], &bench.tracer.view);
        if (step == 0) {
            first_row = row;
            first_column = column;
            first_range = range;
        }
        expect_close("moved rows", row - first_row, step / 8.0, 0.02);
        expect_close("moved columns", column - first_column, (range - first_range) / 0.025, 0.02);
        if (step == 0)
            expect_close("row", row, 50.0, 0.02);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cross_range_response), cmocka_unit_test(test_widths_and_lobes),
        cmocka_unit_test(test_range_response),       cmocka_unit_test(test_image_of_a_point),
        cmocka_unit_test(test_between_pixels),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
