/* What is put into a measured image has that image's response, looks and saturation, and the level
 * that was asked for. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "inject/injection.h"
#include "inject/looks.h"
#include "inject/match.h"

#define ROWS    320
#define COLUMNS 320
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define RANGE   40.0
#define SPACING 0.025
#define DEEP    5e-3f /* visibility in the deep shadow */

/* Amplitudes of a speckle field: a mean over looks, formed with a resolution along track. */
static float *measured_amplitudes(struct bench *bench, int looks, double resolution_m)
{
    const struct window window = {0, ROWS, 0, COLUMNS};
    float *a = calloc(PIXELS, sizeof *a);
    float *b = calloc(PIXELS, sizeof *b);
    float *amplitude = calloc(PIXELS, sizeof *amplitude);
    assert_true(a && b && amplitude);
    bench_ready(bench);
    bench->tracer.response.resolution_m = resolution_m;
    for (int look = 0; look < looks; look++) {
        assert_int_equal(coloured_noise(&bench->tracer, 77 + (uint32_t)look, &window, a, b),
                         SONJECT_OK);
        for (size_t i = 0; i < PIXELS; i++)
            amplitude[i] += (a[i] * a[i] + b[i] * b[i]) / (float)looks;
    }
    for (size_t i = 0; i < PIXELS; i++)
        amplitude[i] = sqrtf(amplitude[i]);
    free(a);
    free(b);
    return amplitude;
}

/* A plate over the seabed that returns nothing, and its shadow of some 9000 pixels. */
static void add_plate(struct bench *bench)
{
    sonject_object_params *plate = bench_add(bench, SONJECT_SHAPE_PLANE, 4.5, 2.4, 0.0);
    plate->material.reflection = 0.0;
    plate->material.lambert = 0.0;
    plate->burial_m = -0.5;
    bench->scene.injection.estimate_noise = 0;
    bench->scene.injection.noise_floor_db = -20.0;
}

static void inject(struct bench *bench, const float *pixels, struct injection_result *result)
{
    struct injection_input input;
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.pixels = pixels;
    if (injection_run(&bench->report, bench->tracer.device, &bench->scene, &input, NULL, NULL,
                      result) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

/* Contrast of the amplitudes in the deep shadow, and the correlation of intensities there from row
 * to row; *count of the pixels. */
static void shadow_statistics(const struct injection_result *result, double *contrast,
                              double *correlation, double *count)
{
    double n = 0.0, sum = 0.0, squares = 0.0;
    double pairs = 0.0, product = 0.0, fourth = 0.0;
    for (size_t i = 0; i < PIXELS; i++) {
        if (!(result->visibility[i] < DEEP))
            continue;
        const double value = (double)result->image[i];
        sum += value;
        squares += value * value;
        fourth += value * value * value * value;
        n += 1.0;
    }
    const double mean = squares / n;
    for (size_t i = 0; i + COLUMNS < PIXELS; i++) {
        if (!(result->visibility[i] < DEEP) || !(result->visibility[i + COLUMNS] < DEEP))
            continue;
        const double here = (double)result->image[i];
        const double next = (double)result->image[i + COLUMNS];
        product += (here * here - mean) * (next * next - mean);
        pairs += 1.0;
    }
    *contrast = sqrt(squares * n / (sum * sum) - 1.0);
    *correlation = product / pairs / (fourth / n - mean * mean);
    *count = n;
}

/* Speckle in the shadow is the image's: of one look or three, as coarse as there. The shadow has
 * some count / (2.5 pixels of speckle) independent values, which know contrast to 0.6 / root and
 * correlation to 1.5 / root; the image's own widths are known to 5 %, its looks to 6 % and -2 %. */
static void test_speckle_in_shadows(void **unused)
{
    static const double amplitude_contrast[] = {0.0, 0.5227, 0.0, 0.2940};
    (void)unused;
    for (int looks = 1; looks <= 3; looks += 2) {
        struct bench bench;
        struct injection_result result;
        double contrast, correlation, count;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        add_plate(&bench);
        float *pixels = measured_amplitudes(&bench, looks, 1.6 * SPACING);
        const double expected =
            along_track_speckle_correlation(&bench.tracer.response, SPACING); /* 0.22 */
        inject(&bench, pixels, &result);
        shadow_statistics(&result, &contrast, &correlation, &count);
        const double root = sqrt(count / 2.5);
        print_message("%.0f pixels in the deep shadow\n", count);
        assert_true(count > 6000.0);
        expect_close("resolution", result.statistics.along_track_resolution_m, 1.6 * SPACING,
                     0.08 * SPACING);
        expect_close("looks", result.statistics.looks, looks, looks == 1 ? 0.0 : 0.06 * looks * 4);
        expect_close("contrast", contrast, amplitude_contrast[looks], 4.0 * 0.6 / root * contrast);
        expect_close("correlation", correlation, expected, 4.0 * 1.5 / root);
        injection_result_clear(&result);
        free(pixels);
        bench_close(&bench);
    }
}

/* An image of the sonar's own response is left to it, to the bit; so is what is told to be nominal.
 */
static void test_nominal(void **unused)
{
    (void)unused;
    for (int is_told = 0; is_told < 2; is_told++) {
        struct bench bench;
        struct injection_result result;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        add_plate(&bench);
        if (is_told) {
            bench.scene.injection.match_response = SONJECT_MATCH_NOMINAL;
            bench.scene.injection.match_looks = 1.0;
        }
        float *pixels = measured_amplitudes(&bench, is_told ? 3 : 1, is_told ? 0.05 : SPACING);
        inject(&bench, pixels, &result);
        assert_true(result.statistics.along_track_resolution_m == SPACING);
        assert_true(result.statistics.looks == 1.0);
        assert_true(isinf(result.statistics.saturation_amplitude));
        injection_result_clear(&result);
        free(pixels);
        bench_close(&bench);
    }
}

/* Highlights end where the image's do, or with full_scale go on. */
static void test_saturation(void **unused)
{
    (void)unused;
    for (int is_cut = 0; is_cut < 2; is_cut++) {
        struct bench bench;
        struct injection_result result;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.injection.match_saturation = (uint32_t)is_cut;
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6);
        float *pixels = measured_amplitudes(&bench, 1, SPACING);
        float largest = 0.0f;
        for (size_t i = 0; i < PIXELS; i++)
            pixels[i] = fminf(pixels[i], 2.0f); /* two in a hundred pixels */
        inject(&bench, pixels, &result);
        for (size_t i = 0; i < PIXELS; i++)
            largest = fmaxf(largest, result.image[i]);
        assert_true(is_cut ? largest == 2.0f : largest > 20.0f);
        injection_result_clear(&result);
        free(pixels);
        bench_close(&bench);
    }
}

static double peak_of(const struct injection_result *result, size_t first_row, size_t end_row)
{
    double peak = 0.0;
    for (size_t i = first_row * COLUMNS; i < end_row * COLUMNS; i++)
        peak = fmax(peak, (double)result->energy[i]);
    return 10.0 * log10(peak);
}

/* Two spheres, one scaled to a target strength, one over the seabed; a third is left alone. */
static void test_levels(void **unused)
{
    (void)unused;
    struct bench bench;
    struct injection_result before, after;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    for (int i = 0; i < 3; i++) {
        sonject_object_params *ball = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.4);
        ball->position_kind = SONJECT_POSITION_PIXELS;
        ball->position_along = 60.0 + 100.0 * i;
        ball->position_range = 130.0 + 20.0 * i;
        ball->material.lambert = 0.1;
    }
    float *pixels = measured_amplitudes(&bench, 1, SPACING);
    inject(&bench, pixels, &before);
    bench.scene.objects[0].level_kind = SONJECT_LEVEL_TARGET_STRENGTH;
    bench.scene.objects[0].level_db = -30.0;
    bench.scene.objects[1].level_kind = SONJECT_LEVEL_OVER_SEABED;
    bench.scene.objects[1].level_db = 18.0;
    inject(&bench, pixels, &after);
    expect_close("target strength", after.objects[0].target_strength_db, -30.0, 1e-4);
    expect_close("over the seabed", after.objects[1].over_seabed_db, 18.0, 1e-4);
    for (int i = 0; i < 3; i++) {
        const sonject_object_truth *truth = &after.objects[i];
        expect_close("gain", truth->level_gain_db,
                     truth->over_seabed_db - before.objects[i].over_seabed_db, 1e-4);
        expect_close("target strength moves with the gain", truth->target_strength_db,
                     before.objects[i].target_strength_db + truth->level_gain_db, 1e-4);
        assert_int_equal(truth->level_kind, bench.scene.objects[i].level_kind);
        /* what is left of the seabed adds a hundredth at 18 dB over it */
        expect_close("energy layer",
                     peak_of(&after, 20 + 100 * (size_t)i, 100 + 100 * (size_t)i) -
                         peak_of(&before, 20 + 100 * (size_t)i, 100 + 100 * (size_t)i),
                     truth->level_gain_db, 0.1);
    }
    assert_true(after.objects[2].level_gain_db == 0.0);
    assert_true(before.objects[0].level_gain_db == 0.0);
    injection_result_clear(&before);
    injection_result_clear(&after);
    free(pixels);
    bench_close(&bench);
}

/* Weights of looks: sum 1, sum of squares 1 / looks, none negative. */
static void test_look_weights(void **unused)
{
    (void)unused;
    for (double looks = 1.0; looks <= 64.0; looks += 0.37) {
        double weight, last;
        const double others = (double)look_weights(looks, &weight, &last) - 1.0;
        assert_true(weight >= 0.0 && last >= -1e-12 && others < looks);
        assert_true(fabs(others * weight + last - 1.0) < 1e-12);
        assert_true(fabs((others * weight * weight + last * last) * looks - 1.0) < 1e-12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_speckle_in_shadows), cmocka_unit_test(test_nominal),
        cmocka_unit_test(test_saturation),         cmocka_unit_test(test_levels),
        cmocka_unit_test(test_look_weights),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof tests[0]);
}
