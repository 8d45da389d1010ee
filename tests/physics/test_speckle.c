/* Speckle: circular Gaussian, with the point response's correlation, for any number of rays. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "bench.h"

#define ROWS    480
#define COLUMNS 480
#define EDGE    40 /* pixels next to an edge lack a part of their response */
#define BLOCKS  20 /* of rows, for standard errors from the scatter between them */

/* A field of unit mean square. */
struct field {
    double *real_part, *imaginary_part;
};

static struct field field_init(void)
{
    struct field field = {calloc(ROWS * COLUMNS, sizeof(double)),
                          calloc(ROWS * COLUMNS, sizeof(double))};
    assert_true(field.real_part && field.imaginary_part);
    return field;
}

static void field_clear(struct field *field)
{
    free(field->real_part);
    free(field->imaginary_part);
}

static void open_bench(struct bench *bench, double ray_scale, uint64_t seed)
{
    bench_open(bench, ROWS, COLUMNS, 40.0);
    bench->scene.injection.ray_scale = ray_scale;
    bench->scene.injection.seed = seed;
    bench->scene.sonar.along_track_resolution_m = 0.05; /* two rows, so that rows correlate */
    bench_ready(bench);
}

/* The seabed's realisation over the root of the expected energy. */
static struct field seabed_field(double ray_scale, uint64_t seed)
{
    struct bench bench;
    struct echoes echoes;
    open_bench(&bench, ray_scale, seed);
    bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
    struct field field = field_init();
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        const double expected = seabed_cell_energy(
            &bench.tracer.view, &bench.tracer.response, bench.scene.seabed.lambert,
            view_apparent_range(&bench.tracer.view, (double)(i % COLUMNS)));
        field.real_part[i] = echoes.seabed_real[i] / sqrt(expected);
        field.imaginary_part[i] = echoes.seabed_imaginary[i] / sqrt(expected);
    }
    echoes_clear(&echoes);
    bench_close(&bench);
    return field;
}

static struct field noise_field(uint64_t seed, uint32_t stream)
{
    struct bench bench;
    open_bench(&bench, 1.0, seed);
    struct field field = field_init();
    float *a = calloc(ROWS * COLUMNS, sizeof *a);
    float *b = calloc(ROWS * COLUMNS, sizeof *b);
    assert_true(a && b);
    const struct window window = {0, ROWS, 0, COLUMNS};
    if (coloured_noise(&bench.tracer, stream, &window, a, b) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        field.real_part[i] = a[i];
        field.imaginary_part[i] = b[i];
    }
    free(a);
    free(b);
    bench_close(&bench);
    return field;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Intensities on a lattice of at least 3 resolutions: mean, contrast, Kolmogorov-Smirnov. */
static void check_intensity(const struct field *field)
{
    double *samples = calloc(ROWS * COLUMNS, sizeof *samples);
    size_t count = 0;
    double sum = 0.0;
    double squares = 0.0;
    assert_non_null(samples);
    for (size_t row = EDGE; row < ROWS - EDGE; row += 6)
        for (size_t column = EDGE; column < COLUMNS - EDGE; column += 4) {
            const size_t i = row * COLUMNS + column;
            const double intensity = field->real_part[i] * field->real_part[i] +
                                     field->imaginary_part[i] * field->imaginary_part[i];
            samples[count++] = intensity;
            sum += intensity;
            squares += intensity * intensity;
        }
    const double n = (double)count;
    const double mean = sum / n;
    const double contrast = sqrt(squares / n - mean * mean) / mean;
    qsort(samples, count, sizeof *samples, compare_doubles);
    double distance = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double expected = 1.0 - exp(-samples[i]);
        distance = fmax(distance, fmax((double)(i + 1) / n - expected, expected - (double)i / n));
    }
    free(samples);
    /* exponential intensities: the mean's and the contrast's standard errors are both 1/sqrt(n);
     * Kolmogorov's distance stays below 2.27/sqrt(n) as often as a normal one within 4 sigma; W's
     * tail that is left out takes 0.1 % of the mean */
    expect_close("mean", mean, 1.0, 4.0 / sqrt(n) + 1e-3);
    expect_close("contrast", contrast, 1.0, 4.0 / sqrt(n));
    expect_below("Kolmogorov-Smirnov distance", distance, 2.27 / sqrt(n) + 4e-4);
}

struct estimate {
    double value, error;
};

/* Mean over row blocks and the standard error from their scatter of
 * Re or Im <a(n, j) b*(n + rows, j + columns)>. */
static struct estimate correlate(const struct field *a, const struct field *b, size_t rows,
                                 size_t columns, int imaginary)
{
    struct estimate estimate = {0.0, 0.0};
    const size_t block = (ROWS - 2 * EDGE) / BLOCKS;
    double squares = 0.0;
    for (size_t k = 0; k < BLOCKS; k++) {
        double sum = 0.0;
        for (size_t row = EDGE + k * block; row < EDGE + (k + 1) * block; row++)
            for (size_t column = EDGE; column < COLUMNS - EDGE; column++) {
                const size_t i = row * COLUMNS + column;
                const size_t j = i + rows * COLUMNS + columns;
                sum += imaginary ? a->imaginary_part[i] * b->real_part[j] -
                                       a->real_part[i] * b->imaginary_part[j]
                                 : a->real_part[i] * b->real_part[j] +
                                       a->imaginary_part[i] * b->imaginary_part[j];
            }
        const double mean = sum / (double)(block * (COLUMNS - 2 * EDGE));
        estimate.value += mean / BLOCKS;
        squares += mean * mean / BLOCKS;
    }
    estimate.error =
        sqrt(fmax(0.0, squares - estimate.value * estimate.value) / (double)(BLOCKS - 1));
    return estimate;
}

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

/* Autocorrelation of sinc(x/delta) is itself, of exp(-r^2/2s^2) is exp(-r^2/4s^2). */
static void check_correlation(const struct field *field)
{
    const double deviation = 0.025 / (2.0 * sqrt(log(2.0))); /* c/2B = 2.5 cm */
    static const size_t lags[][2] = {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {0, 1},
                                     {0, 2}, {0, 3}, {1, 1}, {3, 2}, {0, 8}, {9, 0}};
    for (size_t i = 0; i < sizeof lags / sizeof *lags; i++) {
        const double range = (double)lags[i][1] * 0.025 / deviation;
        const double expected = sinc((double)lags[i][0] / 2.0) * exp(-0.25 * range * range);
        const struct estimate real_part = correlate(field, field, lags[i][0], lags[i][1], 0);
        const struct estimate imaginary_part = correlate(field, field, lags[i][0], lags[i][1], 1);
        print_message("lag of %zu rows, %zu columns\n", lags[i][0], lags[i][1]);
        expect_close("correlation", real_part.value, expected, 4.0 * real_part.error + 1e-3);
        expect_close("its imaginary part", imaginary_part.value, 0.0, 4.0 * imaginary_part.error);
        expect_below("standard error", real_part.error, 0.02);
    }
}

static void test_seabed(void **unused)
{
    (void)unused;
    static const double scales[] = {1.0, 4.0, 16.0};
    for (size_t i = 0; i < 3; i++) {
        print_message("%.0f times the rays\n", scales[i]);
        struct field field = seabed_field(scales[i], 1);
        check_intensity(&field);
        check_correlation(&field);
        field_clear(&field);
    }
}

static void test_noise(void **unused)
{
    (void)unused;
    struct field field = noise_field(1, STREAM_NOISE);
    check_intensity(&field);
    check_correlation(&field);
    field_clear(&field);
}

static void expect_independent(const char *what, const struct field *a, const struct field *b)
{
    for (size_t rows = 0; rows < 2; rows++)
        for (size_t columns = 0; columns < 2; columns++) {
            const struct estimate real_part = correlate(a, b, rows, columns, 0);
            const struct estimate imaginary_part = correlate(a, b, rows, columns, 1);
            expect_close(what, real_part.value, 0.0, 4.0 * real_part.error);
            expect_close(what, imaginary_part.value, 0.0, 4.0 * imaginary_part.error);
        }
}

static void test_fields_are_independent(void **unused)
{
    (void)unused;
    struct field one = seabed_field(1.0, 1);
    struct field other_seed = seabed_field(1.0, 2);
    struct field other_word = seabed_field(1.0, (uint64_t)1 << 32 | 1);
    struct field noise = noise_field(1, STREAM_NOISE);
    struct field phase = noise_field(1, STREAM_INPUT_PHASE);
    expect_independent("seabed of two seeds", &one, &other_seed);
    expect_independent("seabed of two seeds' upper words", &one, &other_word);
    expect_independent("seabed and noise", &one, &noise);
    expect_independent("noise and input phase", &noise, &phase);
    field_clear(&one);
    field_clear(&other_seed);
    field_clear(&other_word);
    field_clear(&noise);
    field_clear(&phase);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_seabed),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_fields_are_independent),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
