/* An object's target strength is its own: its echo's peak, wherever pixels lie and however far
 * apart they are. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>

#include "bench.h"
#include "inject/target_level.h"

#define RANGE       50.0
#define RESOLUTION  0.025
#define WAVELENGTH  0.015
#define CLOSED_FORM 0.05    /* dB: systematic, of bins and of parabolas between points */
#define ROUGH_DB    0.2     /* its energies are known by strips of a resolution */
#define GIBBS       1.08949 /* 1/2 + Si(pi)/pi: sinc passing over the end of a line */

/* Pixels, m: along the track and in range. */
static const double spacings[][2] = {{0.025, 0.025}, {0.01, 0.0125}, {0.1, 0.075}};
/* Where a centre lies between pixels. */
static const double offsets[][2] = {{0.0, 0.0}, {0.5, 0.27}, {0.21, 0.5}, {0.77, 0.83}};

#define SPACINGS (sizeof spacings / sizeof *spacings)
#define OFFSETS  (sizeof offsets / sizeof *offsets)

static sonject_object_params *hang(struct bench *bench, size_t spacing, size_t offset,
                                   sonject_shape shape, double length_m, double diameter_m)
{
    const double along = spacings[spacing][0];
    const double range = spacings[spacing][1];
    bench_open(bench, (size_t)(4.0 / along), (size_t)(4.0 / range), RANGE);
    bench->scene.sonar.along_track_resolution_m = RESOLUTION;
    bench->scene.geometry.row_spacing_m = along;
    bench->scene.geometry.column_spacing_m = range;
    bench_move(bench, RANGE);
    sonject_object_params *object = bench_add(bench, shape, length_m, 0.0, diameter_m);
    object->burial_m = -1.0;
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = floor(2.0 / along) + offsets[offset][0];
    object->position_range = floor(2.0 / range) + offsets[offset][1];
    return object;
}

static double peak_db(struct bench *bench)
{
    struct echoes echoes;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    const double peak = decibels_of_energy(echoes.objects[0].peak_energy);
    echoes_clear(&echoes);
    return peak;
}

/* 1/lambda times the integral of sinc(x/delta) exp(2ikd) G(offset - d) over the disc, d the depth
 * of the sphere's front, where the pulse's middle makes it largest; the front is curved against the
 * wavefront. About a/2 times the factor of W alone, -0.8 dB and -3.2 dB for these. */
static double sphere_db(double a)
{
    const double deviation = 0.601 * RESOLUTION; /* of the default bandwidth: c/2B is 2.5 cm */
    const double step = WAVELENGTH / 40.0;
    double largest = 0.0;
    for (int i = 0; i < 8; i++) {
        double complex sum = 0.0;
        for (double x = 0.5 * step; x < a; x += step)
            for (double w = 0.5 * step; x * x + w * w < a * a; w += step) {
                const double depth = a - sqrt(a * a - x * x - w * w);
                const double behind = (i * 0.125 * RESOLUTION - depth) / deviation;
                sum += 4.0 * step * step * sin(PI * x / RESOLUTION) / (PI * x / RESOLUTION) *
                       cexp(4.0 * PI * I * depth / WAVELENGTH - 0.5 * behind * behind);
            }
        largest = fmax(largest, cabs(sum) / WAVELENGTH);
    }
    return decibels_of_amplitude(largest / sqrt(1.0 + a / RANGE));
}

static void test_spheres_wherever_pixels_lie(void **unused)
{
    (void)unused;
    static const double radii[] = {0.15, 0.3};
    const double expected[] = {sphere_db(radii[0]), sphere_db(radii[1])};
    for (size_t i = 0; i < 2 * SPACINGS * OFFSETS; i++) {
        struct bench bench;
        hang(&bench, i / 2 % SPACINGS, i / 2 / SPACINGS, SONJECT_SHAPE_SPHERE, 0.0,
             2.0 * radii[i % 2]);
        expect_close("sphere's target strength, dB", peak_db(&bench), expected[i % 2], CLOSED_FORM);
        bench_close(&bench);
    }
}

/* Broadside: sqrt(a / 2 lambda) delta where W passes over the line, Gibbs' overshoot at its end. */
static void test_cylinder_peaks_at_its_ends(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < SPACINGS * OFFSETS; i++) {
        struct bench bench;
        const double a = 0.15;
        hang(&bench, i % SPACINGS, i / SPACINGS, SONJECT_SHAPE_CYLINDER, 1.5, 2.0 * a);
        expect_close("cylinder's target strength, dB", peak_db(&bench),
                     decibels_of_amplitude(GIBBS * RESOLUTION * sqrt(0.5 * a / WAVELENGTH)),
                     CLOSED_FORM);
        bench_close(&bench);
    }
}

/* Lambert's sphere: the expected energy, speckle averaged out. No closed form is held here, but
 * that pixels do not matter. */
static void test_rough_sphere_wherever_pixels_lie(void **unused)
{
    (void)unused;
    double lowest = INFINITY;
    double highest = -INFINITY;
    for (size_t i = 0; i < OFFSETS; i++) {
        struct bench bench;
        sonject_object_params *object = hang(&bench, 0, i, SONJECT_SHAPE_SPHERE, 0.0, 0.6);
        object->material.reflection = 0.0;
        object->material.lambert = 0.1;
        const double peak = peak_db(&bench);
        lowest = fmin(lowest, peak);
        highest = fmax(highest, peak);
        bench_close(&bench);
    }
    expect_below("rough sphere's target strengths are apart, dB", highest - lowest, ROUGH_DB);
}

/* The level that is asked for is the target's, not that of a pixel. */
static void test_level_is_the_targets(void **unused)
{
    (void)unused;
    const double physical = sphere_db(0.15);
    for (size_t i = 0; i < SPACINGS * OFFSETS; i++) {
        struct bench bench;
        struct echoes echoes;
        sonject_object_truth truth;
        struct injection_result result = {.objects = &truth};
        sonject_object_params *object =
            hang(&bench, i % SPACINGS, i / SPACINGS, SONJECT_SHAPE_SPHERE, 0.0, 0.3);
        object->level_kind = SONJECT_LEVEL_TARGET_STRENGTH;
        object->level_db = -10.0;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        assert_int_equal(set_target_levels(&bench.tracer, &echoes, &result), SONJECT_OK);
        expect_close("gain, dB", truth.level_gain_db, -10.0 - physical, CLOSED_FORM);
        expect_close("level, dB", decibels_of_energy(echoes.objects[0].peak_energy), -10.0, 1e-9);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spheres_wherever_pixels_lie),
        cmocka_unit_test(test_cylinder_peaks_at_its_ends),
        cmocka_unit_test(test_rough_sphere_wherever_pixels_lie),
        cmocka_unit_test(test_level_is_the_targets),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof tests[0]);
}
