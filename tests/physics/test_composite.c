/* Measured and traced sound in one picture: what is kept, what is added, and how the whole patch
 * comes out when it is traced anew. */
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

#define ROWS    320
#define COLUMNS 320
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define RANGE   40.0

/* A measured patch: a speckle field with the sonar's point response, unit mean square. */
static float *measured_field(struct bench *bench, uint64_t seed)
{
    const uint64_t own_seed = bench->scene.injection.seed;
    const struct window window = {0, ROWS, 0, COLUMNS};
    float *a = calloc(PIXELS, sizeof *a);
    float *b = calloc(PIXELS, sizeof *b);
    float *field = calloc(2 * PIXELS, sizeof *field);
    assert_true(a && b && field);
    bench->scene.injection.seed = seed;
    bench_ready(bench);
    if (coloured_noise(&bench->tracer, 77, &window, a, b) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    bench->scene.injection.seed = own_seed;
    for (size_t i = 0; i < PIXELS; i++) {
        field[2 * i] = a[i];
        field[2 * i + 1] = b[i];
    }
    free(a);
    free(b);
    return field;
}

static float *magnitudes(const float *field)
{
    float *amplitude = calloc(PIXELS, sizeof *amplitude);
    assert_non_null(amplitude);
    for (size_t i = 0; i < PIXELS; i++)
        amplitude[i] = hypotf(field[2 * i], field[2 * i + 1]);
    return amplitude;
}

static void inject(struct bench *bench, const float *pixels, bool is_complex,
                   struct injection_result *result)
{
    struct injection_input input;
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.is_complex = is_complex;
    input.pixels = pixels;
    if (injection_run(&bench->report, bench->tracer.device, &bench->scene, &input, NULL, NULL,
                      result) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

static double energy_of(const struct injection_result *result, size_t i)
{
    const float *p = result->image;
    return result->is_complex ? (double)p[2 * i] * p[2 * i] + (double)p[2 * i + 1] * p[2 * i + 1]
                              : (double)p[i] * p[i];
}

static void add_sphere(struct bench *bench)
{
    sonject_object_params *object = bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6);
    object->material.reflection = 0.8;
    object->material.roughness_m = 1e-3;
    object->material.lambert = 0.1;
}

/* Outside the influence every bit is the input's; inside, V is a fraction. */
static void test_untouched_pixels_keep_every_bit(void **unused)
{
    (void)unused;
    for (int is_complex = 0; is_complex < 2; is_complex++) {
        struct bench bench;
        struct injection_result result;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        float *field = measured_field(&bench, 5);
        float *pixels = is_complex ? field : magnitudes(field);
        const size_t bytes = (is_complex ? 2 : 1) * sizeof(float);
        add_sphere(&bench);
        inject(&bench, pixels, is_complex != 0, &result);
        size_t kept = 0;
        size_t shaded = 0;
        for (size_t i = 0; i < PIXELS; i++) {
            const int is_same = memcmp((const char *)result.image + i * bytes,
                                       (const char *)pixels + i * bytes, bytes) == 0;
            assert_true(result.visibility[i] >= 0.0f && result.visibility[i] <= 1.0f);
            if (!result.influence[i]) {
                assert_true(is_same);
                assert_true(result.visibility[i] == 1.0f);
                assert_int_equal(result.labels[i], 0);
            }
            kept += !result.influence[i];
            shaded += result.visibility[i] < 0.1f;
        }
        print_message("%zu of %zu pixels kept, %zu in deep shadow\n", kept, PIXELS, shaded);
        assert_true(kept > PIXELS / 3);
        assert_true(shaded > 300);
        assert_int_equal(result.statistics.changed_pixels, PIXELS - kept);
        injection_result_clear(&result);
        if (!is_complex)
            free(pixels);
        free(field);
        bench_close(&bench);
    }
}

/* Mean and its standard error from the scatter of a few values. */
struct estimate {
    double mean, error;
};

static struct estimate estimate_of(const double *values, size_t count)
{
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    const double mean = sum / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - mean) * (values[i] - mean);
    const struct estimate estimate = {mean, sqrt(squares / ((double)count * (double)(count - 1)))};
    return estimate;
}

/* In the deep shadow of something that returns nothing there is the noise that was asked for, on
 * highlights the energy that was expected, each pixel over its own: means over a few seeds. */
#define SEEDS 12

static void test_shadow_and_highlight_energy(void **unused)
{
    (void)unused;
    for (int is_complex = 0; is_complex < 2; is_complex++) {
        double noise[SEEDS], highlight[SEEDS];
        for (int seed = 0; seed < SEEDS; seed++) {
            struct bench bench;
            struct injection_result result;
            struct patch_level level;
            bench_open(&bench, ROWS, COLUMNS, RANGE);
            bench.scene.injection.seed = (uint64_t)seed + 1;
            bench.scene.injection.estimate_noise = 0;
            bench.scene.injection.noise_floor_db = -20.0;
            float *field = measured_field(&bench, (uint64_t)seed + 100);
            float *pixels = is_complex ? field : magnitudes(field);
            sonject_object_params *plate = bench_add(&bench, SONJECT_SHAPE_PLANE, 1.5, 1.0, 0.0);
            plate->material.reflection = 0.0;
            plate->burial_m = -0.5;
            sonject_object_params *ball = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.8);
            ball->position_kind = SONJECT_POSITION_PIXELS;
            ball->position_along = 60.0;
            ball->position_range = 60.0;
            ball->material.reflection = 0.0;
            ball->material.lambert = 0.2;
            bench_ready(&bench);
            inject(&bench, pixels, is_complex != 0, &result);
            if (patch_level_init(&level, &bench.report, &bench.scene, &bench.tracer.view,
                                 &bench.tracer.response, pixels, is_complex != 0) != SONJECT_OK)
                fail_msg("%s", bench.report.message);
            double in_shadow = 0.0, on_ball = 0.0;
            size_t shadow_pixels = 0, ball_pixels = 0;
            for (size_t i = 0; i < PIXELS; i++) {
                if (result.visibility[i] < 1e-3f && result.labels[i] == 1) {
                    in_shadow += energy_of(&result, i) / level.level[i];
                    shadow_pixels++;
                }
                if (result.highlight[i] && result.labels[i] == 2) {
                    const double cell = level.cell_energy[i % COLUMNS];
                    const double expected =
                        result.energy[i] + (1.0 - result.visibility[i]) * level.noise_ratio * cell;
                    on_ball += energy_of(&result, i) * cell / level.level[i] / expected;
                    ball_pixels++;
                }
            }
            assert_true(ball_pixels > 100);
            assert_true(shadow_pixels > 500);
            noise[seed] = in_shadow / (double)shadow_pixels / 0.01;
            highlight[seed] = on_ball / (double)ball_pixels;
            patch_level_clear(&level);
            injection_result_clear(&result);
            if (!is_complex)
                free(pixels);
            free(field);
            bench_close(&bench);
        }
        const struct estimate floor_level = estimate_of(noise, SEEDS);
        const struct estimate echo_level = estimate_of(highlight, SEEDS);
        print_message("%s\n", is_complex ? "complex" : "amplitude");
        expect_close("noise in the shadow over what was asked", floor_level.mean, 1.0,
                     4.0 * floor_level.error);
        expect_close("highlight energy over expected", echo_level.mean, 1.0,
                     4.0 * echo_level.error);
        expect_below("standard errors", fmax(floor_level.error, echo_level.error), 0.047);
    }
}

/* Where half of the seabed's energy arrives, half of it is in the picture: the mean of
 * |out|^2 / |in|^2 weighted by |in|^2 is V + (1 - V) noise. */
static void test_partial_shadow(void **unused)
{
    (void)unused;
    struct bench bench;
    struct injection_result result;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.estimate_noise = 0;
    bench.scene.injection.noise_floor_db = -60.0;
    float *field = measured_field(&bench, 5);
    /* a lattice of narrow slats: V between 0 and 1 in all of its shadow */
    for (int k = 0; k < 8; k++) {
        sonject_object_params *slat = bench_add(&bench, SONJECT_SHAPE_PLANE, 0.06, 1.5, 0.0);
        slat->material.reflection = 0.0;
        slat->burial_m = -0.3;
        slat->position_kind = SONJECT_POSITION_PIXELS;
        slat->position_along = 140.0 + 4.3 * k;
        slat->position_range = 150.0;
    }
    inject(&bench, field, true, &result);
    double out = 0.0, expected = 0.0;
    size_t partial = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        if (!result.influence[i])
            continue;
        const double in =
            (double)field[2 * i] * field[2 * i] + (double)field[2 * i + 1] * field[2 * i + 1];
        out += energy_of(&result, i);
        expected += result.visibility[i] * in;
        partial += result.visibility[i] > 0.1f && result.visibility[i] < 0.9f;
    }
    assert_true(partial > 300);
    /* the noise's share: 60 dB down, and its interference with the seabed */
    expect_close("energy over V of the input's", out / expected, 1.0, 2e-3);
    injection_result_clear(&result);
    free(field);
    bench_close(&bench);
}

enum patch_kind {
    PATCH_UNIFORM, /* amplitude 1 */
    PATCH_WHITE,   /* exponential intensities, pixel by pixel */
    PATCH_MEASURED /* a speckle field of the sonar's */
};

static float *make_patch(struct bench *bench, enum patch_kind kind, uint64_t seed)
{
    if (kind == PATCH_MEASURED) {
        float *field = measured_field(bench, seed);
        float *pixels = magnitudes(field);
        free(field);
        return pixels;
    }
    float *pixels = calloc(PIXELS, sizeof *pixels);
    assert_non_null(pixels);
    uint64_t state = seed * 0x9e3779b97f4a7c15u + 1;
    for (size_t i = 0; i < PIXELS; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const double u = ((double)(state >> 33) + 0.5) / 2147483648.0;
        pixels[i] = kind == PATCH_UNIFORM ? 1.0f : (float)sqrt(-log(u));
    }
    return pixels;
}

/* Share of a pixel's seabed energy that comes from `column` columns beside: G^2 over that pixel. */
static double column_share(double resolution, int column)
{
    const double deviation = resolution / (2.0 * sqrt(log(2.0))) / sqrt(2.0) / 0.025;
    return 0.5 * (erf((column + 0.5) / deviation / sqrt(2.0)) -
                  erf((column - 0.5) / deviation / sqrt(2.0)));
}

/* Contrast of new speckle on a map: intensity = (map smoothed by |W|^2 G^2) times an exponential
 * deviate, so contrast^2 = 1 + 2 v with v the smoothed map's variance. With rows as wide as the
 * resolution, |W|^2 takes its own row alone. v is the sum over pairs of shares of the map's
 * correlation: white, or exp(-(lag/s)^2/2) for measured speckle. Unsmoothed v = 1: sqrt(3). */
static double expected_contrast(enum patch_kind kind, double resolution)
{
    const double deviation = resolution / (2.0 * sqrt(log(2.0))) / 0.025;
    double variance = 0.0;
    for (int i = -6; i <= 6; i++)
        for (int j = -6; j <= 6; j++) {
            const double lag = (i - j) / deviation;
            const double correlation =
                kind == PATCH_MEASURED ? exp(-0.5 * lag * lag) : (i == j ? 1.0 : 0.0);
            variance += column_share(resolution, i) * column_share(resolution, j) * correlation;
        }
    return kind == PATCH_UNIFORM ? 1.0 : sqrt(1.0 + 2.0 * variance);
}

static void check_anew(const char *what, enum patch_kind kind, sonject_seabed_map map,
                       double resolution, double contrast)
{
    double level_db[4], contrasts[4];
    for (int seed = 0; seed < 4; seed++) {
        struct bench bench;
        struct injection_result result;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
        bench.scene.injection.seed = (uint64_t)seed + 1;
        bench.scene.seabed.map = map;
        bench.scene.sonar.bandwidth_hz = 1500.0 / (2.0 * resolution);
        bench_ready(&bench);
        float *pixels = make_patch(&bench, kind, (uint64_t)seed + 40);
        inject(&bench, pixels, false, &result);
        level_db[seed] = result.statistics.level_change_db;
        contrasts[seed] = result.statistics.output_contrast;
        if (kind != PATCH_UNIFORM)
            expect_close("contrast of the input", result.statistics.input_contrast, 1.0, 0.03);
        injection_result_clear(&result);
        free(pixels);
        bench_close(&bench);
    }
    const struct estimate level = estimate_of(level_db, 4);
    const struct estimate speckle = estimate_of(contrasts, 4);
    print_message("%s\n", what);
    /* Errors from the number of independent pixels, at least 50,000 in 4 patches of 102,400 with
     * intensities correlated over 1.5 to 3 of them (four values give a poor scatter): 0.5 % of
     * level and 1 % of contrast, whose own variance grows with it. */
    expect_close("level change, dB", level.mean, 0.0, 4.0 * 0.02);
    expect_close("contrast", speckle.mean, contrast, 4.0 * 0.008 * contrast);
}

static void test_resynthesis(void **unused)
{
    (void)unused;
    check_anew("uniform", PATCH_UNIFORM, SONJECT_MAP_INTENSITY, 0.025, 1.0);
    check_anew("white map, resolution of half a pixel: nearly sqrt(3)", PATCH_WHITE,
               SONJECT_MAP_INTENSITY, 0.0125, expected_contrast(PATCH_WHITE, 0.0125));
    check_anew("white map, resolution of a pixel", PATCH_WHITE, SONJECT_MAP_INTENSITY, 0.025,
               expected_contrast(PATCH_WHITE, 0.025));
    check_anew("measured speckle, resolution of a pixel", PATCH_MEASURED, SONJECT_MAP_INTENSITY,
               0.025, expected_contrast(PATCH_MEASURED, 0.025));
    assert_true(fabs(expected_contrast(PATCH_WHITE, 0.001) - sqrt(3.0)) < 0.01);
    /* a mean over 2 pi 2 4^2 pixels leaves 1/200 of the variance of a white map */
    check_anew("despeckled map", PATCH_MEASURED, SONJECT_MAP_DESPECKLED, 0.025, 1.0);
}

/* A complex patch used as reflectivity comes back as itself, seen through the sonar once more:
 * level kept, and of the field's correlation what a second Gaussian leaves in range, sqrt(2
 * sqrt(2)/3) = 0.971 (along-track the sinc is its own square), squared for intensities.
 * Interpolating between columns as wide as the resolution costs a little of it. */
static void test_coherent_map(void **unused)
{
    (void)unused;
    static const struct {
        double row, column, resolution; /* m; range resolution is 2.5 cm */
    } grids[] = {
        {0.025, 0.025, 0.025}, {0.025, 0.0125, 0.05}, {0.025, 0.0125, 0.0125}, {0.02, 0.02, 0.03}};
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++) {
        struct bench bench;
        struct injection_result result;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.geometry.row_spacing_m = grids[i].row;
        bench.scene.geometry.column_spacing_m = grids[i].column;
        bench.scene.sonar.along_track_resolution_m = grids[i].resolution;
        bench_move(&bench, RANGE);
        bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
        bench.scene.seabed.map = SONJECT_MAP_COHERENT;
        float *field = measured_field(&bench, 9);
        inject(&bench, field, true, &result);
        double ab = 0.0, aa = 0.0, bb = 0.0;
        for (size_t k = 0; k < 2 * PIXELS; k++) {
            ab += (double)field[k] * result.image[k];
            aa += (double)field[k] * field[k];
            bb += (double)result.image[k] * result.image[k];
        }
        print_message("pixels of %.4f x %.4f m, resolution %.4f m along-track\n", grids[i].row,
                      grids[i].column, grids[i].resolution);
        expect_close("correlation of the fields", ab / sqrt(aa * bb), 0.971, 0.03);
        expect_close("correlation of the intensities", result.statistics.correlation, 0.943, 0.05);
        expect_close("level change, dB", result.statistics.level_change_db, 0.0, 0.2);
        expect_close("contrast", result.statistics.output_contrast, 1.0, 0.05);
        injection_result_clear(&result);
        free(field);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_untouched_pixels_keep_every_bit),
        cmocka_unit_test(test_shadow_and_highlight_energy),
        cmocka_unit_test(test_partial_shadow),
        cmocka_unit_test(test_resynthesis),
        cmocka_unit_test(test_coherent_map),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
