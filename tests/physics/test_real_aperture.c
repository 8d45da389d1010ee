/* Images of a sidescan: what its array's beam makes of points, spheres, seabeds and noise. */
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

#define ROWS       161
#define COLUMNS    61
#define SPACING    0.05
#define ARRAY      0.5
#define WAVELENGTH 0.015
#define LEVEL_DB   0.2

static const double ranges[] = {20.0, 40.0, 60.0};

static void choose_sidescan(struct bench *bench, double range)
{
    bench->scene.sonar.kind = SONJECT_SONAR_REAL;
    bench->scene.sonar.array_length_m = ARRAY;
    bench->scene.geometry.row_spacing_m = SPACING;
    bench_move(bench, range);
}

/* A ball that hangs over the seabed, in the middle of the middle row. */
static void hang_ball(struct bench *bench, double range, double diameter)
{
    sonject_object_params *object = bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, diameter);
    object->burial_m = -0.1;
    object->position_kind = SONJECT_POSITION_METRES;
    object->position_along = 80 * SPACING;
    object->position_range = range;
    bench->scene.injection.ray_scale = 4.0;
}

static double complex pixel_at(const struct echoes *echoes, size_t row, size_t column)
{
    const size_t i = row * echoes->columns + column;
    return echoes->target_real[i] + I * (double)echoes->target_imaginary[i];
}

static size_t brightest_column(const struct echoes *echoes, size_t row)
{
    size_t brightest = 0;
    for (size_t column = 1; column < echoes->columns; column++)
        if (cabs(pixel_at(echoes, row, column)) > cabs(pixel_at(echoes, row, brightest)))
            brightest = column;
    return brightest;
}

/* Two-way, from the definition: the array's pattern in amplitude, squared, and the longer way. */
static double complex beam(double range, double x)
{
    const double distance = sqrt(range * range + x * x);
    const double z = PI * ARRAY * x / distance / WAVELENGTH;
    const double one_way = z == 0.0 ? 1.0 : sin(z) / z;
    return one_way * one_way * cexp(I * 4.0 * PI / WAVELENGTH * (distance - range));
}

/* Where the squared magnitude has fallen to one half, by lines between rows. */
static double half_power_width(const struct echoes *echoes, size_t column)
{
    const double peak = pow(cabs(pixel_at(echoes, 80, column)), 2.0);
    double ends[2];
    for (int side = 0; side < 2; side++) {
        size_t row = 80;
        double here = 1.0;
        double next = 1.0;
        while (next > 0.5) {
            here = next;
            row = side ? row + 1 : row - 1;
            next = pow(cabs(pixel_at(echoes, row, column)), 2.0) / peak;
        }
        ends[side] = fabs((double)row - 80.0) - 1.0 + (here - 0.5) / (here - next);
    }
    return (ends[0] + ends[1]) * SPACING;
}

static void test_point_widens_with_range(void **unused)
{
    (void)unused;
    for (int i = 0; i < 3; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, ranges[i]);
        choose_sidescan(&bench, ranges[i]);
        hang_ball(&bench, ranges[i], 0.008);
        bench_ready(&bench);
        const double range = placement_range(&bench.placements[0], &bench.tracer.view);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        const size_t column = brightest_column(&echoes, 80);
        const double complex peak = pixel_at(&echoes, 80, column);
        assert_true(cabs(peak) > 0.0);
        double worst = 0.0;
        for (size_t row = 0; row < ROWS; row++)
            worst = fmax(worst, cabs(pixel_at(&echoes, row, column) / peak -
                                     beam(range, ((double)row - 80.0) * SPACING)));
        /* sinc(z)^4 = 1/2 at z = 0.31895: 0.638 range wavelength / length */
        print_message("%g m\n", ranges[i]);
        expect_close("half-power width, m", half_power_width(&echoes, column),
                     2.0 * 0.31895 * range * WAVELENGTH / ARRAY, 0.01);
        /* strips of an eighth of a wavelength: 2e-3 of the peak's phase at the beam's foot, and
         * the bins' range instead of the echo's */
        expect_below("along-track cut less the beam", worst, 0.02);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* A turned array's, from the ball's own place: the cosine between its long side, ahead in the
 * image's rows, and the way. side: +-1, the way along which rows run. */
static double complex turned_beam(const struct bench *bench, double x, double side)
{
    const double heading = bench->scene.sonar.array_heading_rad;
    const double pitch = bench->scene.sonar.array_pitch_rad;
    const double *ball = bench->placements[0].centre;
    const double down = bench->tracer.view.altitude_m - ball[2];
    const double range = hypot(ball[1], down);
    const double distance = hypot(range, x);
    const double along = side * -x * cos(heading) * cos(pitch) +
                         ball[1] * sin(heading) * cos(pitch) - down * sin(pitch);
    const double z = PI * ARRAY * along / distance / WAVELENGTH;
    const double one_way = sin(z) / z;
    return one_way * one_way * cexp(I * 4.0 * PI / WAVELENGTH * (distance - range));
}

/* Pings ahead of a ball see it where the bow is turned towards it. Rows of the view run the other
 * way to starboard. */
static void test_turned_array(void **unused)
{
    static const double sides[] = {1.0, -1.0};
    (void)unused;
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, 40.0);
        choose_sidescan(&bench, 40.0);
        bench.scene.geometry.side = i ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        bench.scene.sonar.array_heading_rad = 0.006;
        bench.scene.sonar.array_pitch_rad = -0.004;
        hang_ball(&bench, 40.0, 0.008);
        bench_ready(&bench);
        assert_int_equal(cross_range_check(&bench.tracer.response, &bench.report, &bench.scene,
                                           &bench.tracer.view),
                         SONJECT_OK);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        const size_t column = brightest_column(&echoes, 80);
        const double complex middle =
            pixel_at(&echoes, 80, column) / turned_beam(&bench, 1e-9, sides[i]);
        double worst = 0.0;
        size_t brightest = 0;
        for (size_t row = 0; row < ROWS; row++) {
            const double complex pixel = pixel_at(&echoes, row, column) / middle;
            const double x = ((double)row - 80.0) * SPACING + 1e-9;
            worst = fmax(worst, cabs(pixel - turned_beam(&bench, x, sides[i])));
            brightest =
                cabs(pixel_at(&echoes, row, column)) > cabs(pixel_at(&echoes, brightest, column))
                    ? row
                    : brightest;
        }
        expect_close("rows ahead of the ball", sides[i] * ((double)brightest - 80.0),
                     40.0 * (0.006 * cos(asin(0.25)) + 0.004 * 0.25) / SPACING, 0.6);
        /* as for the one along the track; a ball 10 cm over the seabed is seen 1e-5 rad elsewhere
         */
        expect_below("along-track cut less the beam", worst, 0.03);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

static void test_synthetic_aperture_does_not(void **unused)
{
    (void)unused;
    for (int i = 0; i < 3; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, ranges[i]);
        bench.scene.geometry.row_spacing_m = SPACING;
        bench.scene.sonar.along_track_resolution_m = 0.4;
        bench_move(&bench, ranges[i]);
        hang_ball(&bench, ranges[i], 0.008);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        expect_close("half-power width, m",
                     half_power_width(&echoes, brightest_column(&echoes, 80)), 0.8859 * 0.4, 0.01);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

#define WIDE 240

static void test_glint_of_a_sphere(void **unused)
{
    (void)unused;
    for (int i = 0; i < 3; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, WIDE, ranges[i]);
        choose_sidescan(&bench, ranges[i]);
        bench.scene.geometry.column_spacing_m = 0.004;
        bench_move(&bench, ranges[i]);
        hang_ball(&bench, ranges[i], 0.3);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        const double r = placement_range(&bench.placements[0], &bench.tracer.view);
        const double reflection = bench.scene.objects[0].material.reflection;
        double peak = 0.0;
        for (size_t column = 0; column < WIDE; column++)
            peak = fmax(peak, cabs(pixel_at(&echoes, 80, column)));
        /* a/2, and the sphere's own divergence r / (r + a); columns 4 mm apart lose 0.08 dB */
        expect_close("peak over a/2, dB",
                     decibels_of_amplitude(peak / (reflection * 0.075 * r / (r + 0.15))), 0.0,
                     LEVEL_DB);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* Of W over its energy: what the speckle of pings apart by a lag has in common. Far away it is the
 * transform of sinc^4, the cubic spline at 2 lag / length. */
static double complex autocorrelation(double range, double lag)
{
    const double step = 0.002;
    double complex sum = 0.0;
    double energy = 0.0;
    for (int i = -4000; i < 4000; i++) {
        const double complex w = beam(range, i * step);
        sum += conj(w) * beam(range, i * step + lag);
        energy += cabs(w) * cabs(w);
    }
    return sum / energy;
}

static void check_pings(double range, const float *real_part, const float *imaginary_part,
                        const float *energy)
{
    for (int lag = 2; lag <= 8; lag += 2) {
        double complex sum = 0.0;
        double count = 0.0;
        for (size_t row = 0; row + (size_t)lag < ROWS; row++)
            for (size_t column = 0; column < WIDE; column++) {
                const size_t i = row * WIDE + column;
                const size_t j = i + (size_t)lag * WIDE;
                sum += conj(real_part[i] + I * (double)imaginary_part[i]) *
                       (real_part[j] + I * (double)imaginary_part[j]) /
                       sqrt((double)energy[i] * energy[j]);
                count += 1.0;
            }
        /* pixels are independent every 7 pings (0.35 m) and 1.5 columns: 4 standard errors */
        const double error = 4.0 * sqrt(10.5 / count);
        expect_close("correlation of pings", creal(sum) / count,
                     creal(autocorrelation(range, lag * SPACING)), error);
        expect_close("imaginary part", cimag(sum) / count, 0.0, error);
    }
}

static double spline(double x)
{
    const double value = x < 1.0   ? 2.0 / 3.0 - x * x + 0.5 * x * x * x
                         : x < 2.0 ? pow(2.0 - x, 3.0) / 6.0
                                   : 0.0;
    return 1.5 * value;
}

static void test_autocorrelation_far_away(void **unused)
{
    (void)unused;
    for (int lag = 2; lag <= 8; lag += 2) /* a lag of 1 % of the beam's width changes it so much */
        expect_close("autocorrelation", creal(autocorrelation(200.0, lag * SPACING)),
                     spline(2.0 * lag * SPACING / ARRAY), 0.01);
}

static void test_seabed_and_noise(void **unused)
{
    (void)unused;
    for (int i = 0; i < 3; i += 2) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, WIDE, ranges[i]);
        choose_sidescan(&bench, ranges[i]);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
        double ratio = 0.0;
        double square = 0.0;
        for (size_t at = 0; at < ROWS * WIDE; at++) {
            const double r = view_apparent_range(&bench.tracer.view, (double)(at % WIDE));
            const double expected = seabed_cell_energy(&bench.tracer.view, &bench.tracer.response,
                                                       bench.scene.seabed.lambert, r);
            ratio += echoes.seabed_energy[at] / expected;
            square += (pow(echoes.seabed_real[at], 2.0) + pow(echoes.seabed_imaginary[at], 2.0)) /
                      expected;
        }
        const double count = ROWS * WIDE;
        print_message("%g m\n", ranges[i]);
        /* integral of sinc^4: 2/3 range wavelength / length */
        expect_close("width of |W|^2 over theory",
                     cross_range_energy_width(&bench.tracer.response, ranges[i]) /
                         (2.0 / 3.0 * ranges[i] * WAVELENGTH / ARRAY),
                     1.0, 2e-3);
        /* rows near the edges miss 0.25 % of it, taps 0.1 %, |W|^2 of 16 columns is that of one */
        expect_close("mean energy of the seabed, dB", decibels_of_energy(ratio / count), 0.0, 0.04);
        expect_close("speckle over it", square / count, 1.0, 4.0 * sqrt(10.5 / count) + 0.01);
        check_pings(ranges[i], echoes.seabed_real, echoes.seabed_imaginary, echoes.seabed_energy);
        const struct window whole = {0, ROWS, 0, WIDE};
        float *real_part = calloc(ROWS * WIDE, sizeof(float));
        float *imaginary_part = calloc(ROWS * WIDE, sizeof(float));
        float *one = calloc(ROWS * WIDE, sizeof(float));
        assert_true(real_part && imaginary_part && one);
        assert_int_equal(
            coloured_noise(&bench.tracer, STREAM_NOISE, &whole, real_part, imaginary_part),
            SONJECT_OK);
        double noise = 0.0;
        for (size_t at = 0; at < ROWS * WIDE; at++) {
            noise += pow(real_part[at], 2.0) + pow(imaginary_part[at], 2.0);
            one[at] = 1.0f;
        }
        expect_close("noise", noise / count, 1.0, 4.0 * sqrt(10.5 / count) + 0.01);
        check_pings(ranges[i], real_part, imaginary_part, one);
        free(real_part);
        free(imaginary_part);
        free(one);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

static sonject_status try_array(struct bench *bench, double length, double heading)
{
    bench->scene.sonar.array_length_m = length;
    bench->scene.sonar.array_heading_rad = heading;
    bench_ready(bench);
    return cross_range_check(&bench->tracer.response, &bench->report, &bench->scene,
                             &bench->tracer.view);
}

static void test_beams_that_are_refused(void **unused)
{
    struct bench bench;
    (void)unused;
    bench_open(&bench, ROWS, COLUMNS, 60.0);
    choose_sidescan(&bench, 60.0);
    /* 0.0509 r (wavelength / length)^2 is a quarter of the cell at 0.333 m */
    assert_int_equal(try_array(&bench, 0.32, 0.0), SONJECT_ERROR_INPUT);
    print_message("%s\n", bench.report.message);
    assert_int_equal(try_array(&bench, 0.34, 0.0), SONJECT_OK);
    assert_int_equal(try_array(&bench, 0.34, 0.01), SONJECT_ERROR_INPUT);
    print_message("%s\n", bench.report.message);
    assert_int_equal(try_array(&bench, 1.0, 0.008), SONJECT_OK);
    bench.scene.injection.interactions = 2;
    assert_int_equal(try_array(&bench, 1.0, 0.0), SONJECT_OK);
    assert_int_equal(try_array(&bench, 1.0, 0.008), SONJECT_ERROR_INPUT);
    print_message("%s\n", bench.report.message);
    bench.scene.injection.interactions = 1;
    bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    assert_int_equal(try_array(&bench, 1.0, 0.008), SONJECT_ERROR_INPUT);
    bench.scene.injection.mode = SONJECT_MODE_COMPOSITE;
    struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
    mound->radius_m = 1.0;
    mound->height_m = 0.2;
    assert_int_equal(try_array(&bench, 1.0, 0.008), SONJECT_ERROR_INPUT);
    print_message("%s\n", bench.report.message);
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_widens_with_range),
        cmocka_unit_test(test_turned_array),
        cmocka_unit_test(test_synthetic_aperture_does_not),
        cmocka_unit_test(test_glint_of_a_sphere),
        cmocka_unit_test(test_autocorrelation_far_away),
        cmocka_unit_test(test_seabed_and_noise),
        cmocka_unit_test(test_beams_that_are_refused),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
