/* Pulses that are not Gaussian: their shapes, and that images, seabeds and noise have them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "scene/cross_range.h"

#define RANGE      50.0
#define CELL       0.025 /* c / 2B at 1500 m/s and 30 kHz */
#define QUADRATURE 4000
#define TAYLOR_DB  35.0
#define TERMS      5

enum pulse {
    RECTANGULAR,
    HANN,
    TAYLOR,
    TABLE,
    PULSES
};

/* Taylor's pattern by its zeros: those of equal lobes, stretched to meet the sinc's. */
static double taylor_pattern(double z)
{
    const double a = acosh(pow(10.0, TAYLOR_DB / 20.0)) / PI;
    const double stretch = TERMS / sqrt(a * a + (TERMS - 0.5) * (TERMS - 0.5));
    double pattern = z == 0.0 ? 1.0 : sin(PI * z) / (PI * z);
    for (int n = 1; n < TERMS; n++) {
        const double zero = stretch * sqrt(a * a + (n - 0.5) * (n - 0.5));
        pattern *= (1.0 - z * z / (zero * zero)) / (1.0 - z * z / ((double)n * n));
    }
    return pattern;
}

/* The transform of a spectrum over the bandwidth, at z cells, over its mean; the table's has
 * Hann's weights and phases of second and third order, as an uncompensated transducer leaves. */
static double complex transform(enum pulse pulse, double z)
{
    double complex sum = 0.0;
    double total = 0.0;
    for (int k = 0; k < QUADRATURE; k++) {
        const double v = (k + 0.5) / QUADRATURE - 0.5;
        const double weight = pulse == RECTANGULAR ? 1.0 : 1.0 + cos(2.0 * PI * v);
        const double phase = pulse == TABLE ? 6.0 * v * v + 10.0 * v * v * v : 0.0;
        sum += weight * cexp(I * (phase + 2.0 * PI * v * z));
        total += weight;
    }
    return sum / total;
}

static double complex expected_shape(enum pulse pulse, double z)
{
    return pulse == TAYLOR ? taylor_pattern(z) : transform(pulse, z);
}

/* Eight samples a cell, 20 cells to each side; the seconds of half the sound speed. */
static void give_table(struct bench *bench)
{
    enum {
        SIDE = 160
    };
    double positions[2 * SIDE + 1], real_part[2 * SIDE + 1], imaginary_part[2 * SIDE + 1];
    for (int i = -SIDE; i <= SIDE; i++) {
        const double complex g = 3.0 * cexp(I * 2.0) * transform(TABLE, i / 8.0);
        positions[i + SIDE] = i / 8.0 * CELL / 750.0;
        real_part[i + SIDE] = creal(g);
        imaginary_part[i + SIDE] = cimag(g);
    }
    assert_int_equal(response_table_set(&bench->scene.pulse_table, &bench->report, positions,
                                        real_part, imaginary_part, 2 * SIDE + 1, true),
                     SONJECT_OK);
}

static void choose_pulse(struct bench *bench, enum pulse pulse)
{
    sonject_pulse_params *params = &bench->scene.pulse;
    params->kind = pulse == TABLE ? SONJECT_PULSE_TABLE : SONJECT_PULSE_CHIRP;
    params->window = pulse == HANN     ? SONJECT_PULSE_HANN
                     : pulse == TAYLOR ? SONJECT_PULSE_TAYLOR
                                       : SONJECT_PULSE_RECTANGULAR;
    params->taylor_sidelobe_db = TAYLOR_DB;
    params->taylor_terms = TERMS;
    if (pulse == TABLE)
        give_table(bench);
}

/* The sample of largest magnitude, by which a table is divided. */
static double complex peak_of(enum pulse pulse)
{
    double complex peak = expected_shape(pulse, 0.0);
    for (int i = -160; pulse == TABLE && i <= 160; i++) {
        const double complex g = transform(TABLE, i / 8.0);
        if (cabs(g) > cabs(peak))
            peak = g;
    }
    return peak;
}

static double complex response_at(const struct bench *bench, double distance)
{
    const struct complex_number g = range_response_complex(&bench->tracer.response, distance);
    return g.real_part + I * g.imaginary_part;
}

static double half_power_width(const struct bench *bench)
{
    double low = 0.0;
    double high = 2.0 * CELL;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (pow(range_response(&bench->tracer.response, middle), 2.0) > 0.5)
            low = middle;
        else
            high = middle;
    }
    return 2.0 * low / CELL;
}

static double highest_lobe_db(const struct bench *bench)
{
    const double step = 1e-3 * CELL;
    double x = 0.0;
    double highest = 0.0;
    while (fabs(range_response(&bench->tracer.response, x + step)) <
           fabs(range_response(&bench->tracer.response, x)))
        x += step;
    for (; x < 40.0 * CELL; x += step)
        highest = fmax(highest, fabs(range_response(&bench->tracer.response, x)));
    return 20.0 * log10(highest);
}

static void test_shapes_of_pulses(void **unused)
{
    /* theory: sinc, and sinc / (1 - z^2); Taylor's lobes are a little below the design's */
    static const double widths[] = {0.8859, 1.4406, 0.0};
    static const double lobes[] = {-13.26, -31.47, -TAYLOR_DB};
    (void)unused;
    for (enum pulse pulse = RECTANGULAR; pulse < PULSES; pulse++) {
        struct bench bench;
        bench_open(&bench, 4, 4, RANGE);
        choose_pulse(&bench, pulse);
        bench_ready(&bench);
        const double complex peak = peak_of(pulse);
        double worst = 0.0;
        double energy = 0.0;
        for (int i = -1600; i <= 1600; i++) {
            const double z = (i + 0.37) / 80.0;
            worst =
                fmax(worst, cabs(response_at(&bench, z * CELL) - expected_shape(pulse, z) / peak));
        }
        for (int i = -160000; i < 160000; i++)
            energy += pow(cabs(response_at(&bench, (i + 0.5) * CELL / 800.0)), 2.0) * CELL / 800.0;
        print_message("pulse %d\n", (int)pulse);
        /* quadrature errs by 1e-6; a cubic between eight samples a cell by a thousandth */
        expect_below("G less the transform", worst, pulse == TABLE ? 2e-3 : 1e-5);
        /* a sinc has 1 / (pi^2 200) of its energy beyond 200 cells */
        expect_close("energy over the sum's", range_energy_width(&bench.tracer.response) / energy,
                     1.0, 6e-4);
        if (pulse == TABLE) /* Parseval: Hann's spectrum has 1.5 times its mean's square */
            expect_close("energy of the table", range_energy_width(&bench.tracer.response) / CELL,
                         1.5 / pow(cabs(peak), 2.0), 2e-3);
        else
            expect_close("highest side lobe, dB", highest_lobe_db(&bench), lobes[pulse],
                         pulse == TAYLOR ? 0.5 : 0.02);
        if (pulse == RECTANGULAR || pulse == HANN)
            expect_close("half-power width, cells", half_power_width(&bench), widths[pulse], 1e-4);
        bench_close(&bench);
    }
}

/* Cuts through the image of a ball far smaller than any resolution. */
#define COLUMNS 121

static void test_image_of_a_point(void **unused)
{
    (void)unused;
    for (enum pulse pulse = RECTANGULAR; pulse < PULSES; pulse++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, 21, COLUMNS, RANGE);
        bench.scene.geometry.column_spacing_m = 0.003;
        choose_pulse(&bench, pulse);
        bench_move(&bench, RANGE);
        bench.scene.sonar.centre_frequency_hz =
            400e3; /* a ball is half a wavelength large at least */
        bench.scene.injection.ray_scale = 16.0;
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.002)->burial_m = -0.1;
        bench_ready(&bench);
        bench_move(&bench, placement_range(&bench.placements[0], &bench.tracer.view));
        bench.scene.objects[0].position_kind = SONJECT_POSITION_METRES;
        bench.scene.objects[0].position_along = 10 * 0.025;
        bench.scene.objects[0].position_range = RANGE;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        double worst = 0.0;
        double complex scale = 0.0;
        double norm = 0.0;
        for (int pass = 0; pass < 2; pass++)
            for (int column = 0; column < COLUMNS; column++) {
                const size_t i = (size_t)(10 * COLUMNS + column);
                const double complex pixel =
                    echoes.target_real[i] + I * (double)echoes.target_imaginary[i];
                const double complex g = response_at(&bench, (column - 60.0) * 0.003 + 0.001);
                if (pass == 0) { /* the echo's own amplitude and phase, by least squares */
                    scale += conj(g) * pixel;
                    norm += cabs(g) * cabs(g);
                } else {
                    worst = fmax(worst, cabs(pixel / (scale / norm) - g));
                }
            }
        print_message("pulse %d\n", (int)pulse);
        assert_true(cabs(scale) > 0.0);
        /* the glint is a radius before the ball's middle; bins err by 5e-4, its depth by more */
        expect_below("range cut less G", worst, 0.02);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* G's autocorrelation at a lag, over its energy. */
static double complex autocorrelation(const struct bench *bench, double lag)
{
    const double step = CELL / 40.0;
    double complex sum = 0.0;
    double energy = 0.0;
    for (int i = -8000; i < 8000; i++) {
        const double complex g = response_at(bench, i * step);
        sum += conj(g) * response_at(bench, i * step + lag);
        energy += cabs(g) * cabs(g);
    }
    return sum / energy;
}

#define ROWS 240
#define WIDE 360
#define EDGE 60

static void check_speckle(const struct bench *bench, const float *real_part,
                          const float *imaginary_part, const float *energy)
{
    for (int lag = 1; lag <= 4; lag++) {
        double complex sum = 0.0;
        double total = 0.0;
        for (size_t row = 0; row < ROWS; row++)
            for (size_t column = EDGE; column + EDGE < WIDE; column++) {
                const size_t i = row * WIDE + column;
                const size_t j = i + (size_t)lag;
                const double complex a = real_part[i] + I * (double)imaginary_part[i];
                const double complex b = real_part[j] + I * (double)imaginary_part[j];
                sum += conj(a) * b / sqrt((double)energy[i] * energy[j]);
                total += 1.0;
            }
        /* pixels of 0.4 cell are independent every 1.5 cells at best: 4 standard errors */
        const double error = 4.0 * sqrt(1.5 / 0.4 / total);
        const double complex expected = autocorrelation(bench, lag * 0.01);
        expect_close("correlation, real part", creal(sum) / total, creal(expected), error);
        expect_close("imaginary part", cimag(sum) / total, cimag(expected), error);
    }
}

static void test_seabed_and_noise(void **unused)
{
    (void)unused;
    for (enum pulse pulse = RECTANGULAR; pulse < PULSES; pulse++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, WIDE, RANGE);
        bench.scene.geometry.column_spacing_m = 0.01;
        choose_pulse(&bench, pulse);
        bench_move(&bench, RANGE);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
        double ratio = 0.0;
        double square = 0.0;
        double count = 0.0;
        for (size_t i = 0; i < ROWS * WIDE; i++) {
            const size_t column = i % WIDE;
            if (column < EDGE || column + EDGE >= WIDE)
                continue;
            const double expected = seabed_cell_energy(
                &bench.tracer.view, &bench.tracer.response, bench.scene.seabed.lambert,
                view_apparent_range(&bench.tracer.view, (double)column));
            ratio += echoes.seabed_energy[i] / expected;
            square +=
                (pow(echoes.seabed_real[i], 2.0) + pow(echoes.seabed_imaginary[i], 2.0)) / expected;
            count += 1.0;
        }
        print_message("pulse %d\n", (int)pulse);
        /* jittered rays, and 0.6 % beyond taps and margins: 0.03 dB */
        expect_close("mean energy of the seabed, dB", decibels_of_energy(ratio / count), 0.0, 0.04);
        /* 4 standard errors of exponential intensities, one every 1.5 cells of 2.5 pixels */
        expect_close("speckle over it", square / count, 1.0, 4.0 * sqrt(3.75 / count));
        check_speckle(&bench, echoes.seabed_real, echoes.seabed_imaginary, echoes.seabed_energy);
        const struct window whole = {0, ROWS, 0, WIDE};
        float *real_part = calloc(ROWS * WIDE, sizeof(float));
        float *imaginary_part = calloc(ROWS * WIDE, sizeof(float));
        float *one = calloc(ROWS * WIDE, sizeof(float));
        assert_true(real_part && imaginary_part && one);
        assert_int_equal(
            coloured_noise(&bench.tracer, STREAM_NOISE, &whole, real_part, imaginary_part),
            SONJECT_OK);
        double noise = 0.0;
        for (size_t i = 0; i < ROWS * WIDE; i++) {
            noise += pow(real_part[i], 2.0) + pow(imaginary_part[i], 2.0);
            one[i] = 1.0f;
        }
        expect_close("noise", noise / (ROWS * WIDE), 1.0, 4.0 * sqrt(3.75 / (ROWS * WIDE)) + 6e-3);
        check_speckle(&bench, real_part, imaginary_part, one);
        free(real_part);
        free(imaginary_part);
        free(one);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* The same image whether the Gaussian is known or measured. */
static void test_table_of_the_gaussian(void **unused)
{
    struct bench bench;
    struct echoes echoes[2];
    double positions[81], values[81];
    (void)unused;
    for (int i = 0; i < 81; i++) {
        positions[i] = (i - 40) * CELL / 8.0;
        values[i] = 7.0 * exp(-2.0 * log(2.0) * pow((i - 40) / 8.0, 2.0));
    }
    bench_open(&bench, 41, 81, RANGE);
    sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
    object->material.lambert = 0.01;
    for (int with_table = 0; with_table < 2; with_table++) {
        if (with_table) {
            assert_int_equal(response_table_set(&bench.scene.pulse_table, &bench.report, positions,
                                                values, NULL, 81, false),
                             SONJECT_OK);
            bench.scene.pulse.kind = SONJECT_PULSE_TABLE;
        }
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes[with_table]);
    }
    double worst = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < 41 * 81; i++) {
        worst = fmax(worst, hypot(echoes[0].target_real[i] - echoes[1].target_real[i],
                                  echoes[0].target_imaginary[i] - echoes[1].target_imaginary[i]));
        largest = fmax(largest, hypot(echoes[0].target_real[i], echoes[0].target_imaginary[i]));
    }
    expect_below("difference over the peak", worst / largest, 2e-3); /* of the cubic */
    for (int i = 0; i < 2; i++)
        echoes_clear(&echoes[i]);
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes_of_pulses),
        cmocka_unit_test(test_image_of_a_point),
        cmocka_unit_test(test_seabed_and_noise),
        cmocka_unit_test(test_table_of_the_gaussian),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
