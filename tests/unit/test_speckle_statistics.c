/* Contrast, looks, texture and correlation of fields that are known, and saturation. */
#include "claims.h"

#include <sonject/image.h>

#include "image/statistics.h"
#include "image/synthetic.h"

#define ROWS    512
#define COLUMNS 512
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define BLOCKS  256.0

static struct report report;

static void expect_near(const char *what, double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%s is %.5f, not %.5f +- %.5f", what, value, expected, tolerance);
}

/* Adds the intensity of a plain seabed: sinc response of row_width pixels, Gaussian one of a -3 dB
 * width of column_width pixels. */
static void add_seabed(double shape, double row_width, double column_width, uint64_t seed,
                       float *intensity)
{
    sonject_synthetic_params synthetic;
    sonject_geometry_params geometry;
    float *pixels = calloc(PIXELS, sizeof *pixels);
    assert_non_null(pixels);
    sonject_synthetic_params_init(&synthetic);
    sonject_geometry_params_init(&geometry);
    geometry.first_slant_range_m = 40.0;
    synthetic.rows = ROWS;
    synthetic.columns = COLUMNS;
    synthetic.seed = seed;
    synthetic.speckle_shape = shape;
    synthetic.ripple_contrast = 0.0;
    synthetic.patch_contrast_db = 0.0;
    assert_int_equal(synthesise_seabed(&report, &synthetic, &geometry, row_width * 0.025,
                                       column_width * 0.025, pixels),
                     SONJECT_OK);
    for (size_t i = 0; i < PIXELS; i++)
        intensity[i] += pixels[i] * pixels[i];
    free(pixels);
}

static struct speckle_statistics measure(const float *intensity, const uint8_t *excluded)
{
    struct speckle_statistics statistics;
    assert_int_equal(
        measure_speckle(&report, intensity, excluded, ROWS, COLUMNS, COLUMNS, &statistics),
        SONJECT_OK);
    return statistics;
}

/* Speckle of L looks: intensity contrast 1 / sqrt(L), amplitude contrast by Gamma functions. A
 * block of 32 x 32 pixels with some 500 independent ones knows the squared contrast 1 / L to
 * sqrt(20 / 500) / L or less, the median of 256 of them to 1.25 / 16 of that: 1.6 %; its skewness
 * takes 2 % more off. Tolerance 4 * 1.6 % + 2 %. */
static void test_looks(void **state)
{
    static const double expected_amplitude[] = {0.52272, 0.0, 0.0, 0.25289};
    float *intensity = calloc(PIXELS, sizeof *intensity);
    assert_non_null(intensity);
    for (int look = 1; look <= 4; look++) {
        add_seabed(INFINITY, 1.5, 1.0, (uint64_t)look, intensity);
        if (look == 2 || look == 3)
            continue;
        const struct speckle_statistics told = measure(intensity, NULL);
        const double contrast = 1.0 / sqrt(look);
        assert_int_equal(told.blocks, 256);
        expect_near("intensity contrast", told.intensity_contrast, contrast, 0.042 * contrast);
        expect_near("amplitude contrast", told.amplitude_contrast, expected_amplitude[look - 1],
                    0.02 * expected_amplitude[look - 1]);
        expect_near("looks", told.looks, look, 0.084 * look);
        assert_true(told.looks_error > 0.0 && told.looks_error < 0.05 * look);
    }
    free(intensity);
}

/* Correlation of single looks: sinc^2(1 / row width), exp(-4 ln 2 / (2 column width^2)) with the
 * width at half power; that of the median of 256 blocks is known to the error it tells itself, and
 * the trend and mean that are taken off a block cost 1 % of a correlation. */
static void test_correlation(void **state)
{
    static const double row_widths[] = {1.0, 1.5, 2.5};
    static const double column_widths[] = {1.0, 2.0, 1.5};
    for (int i = 0; i < 3; i++) {
        float *intensity = calloc(PIXELS, sizeof *intensity);
        assert_non_null(intensity);
        add_seabed(INFINITY, row_widths[i], column_widths[i], 7, intensity);
        const struct speckle_statistics told = measure(intensity, NULL);
        const double x = PI / row_widths[i];
        const double deviation = column_widths[i] / (2.0 * sqrt(log(2.0)));
        const double rows = sin(x) / x * (sin(x) / x);
        const double columns = exp(-0.5 / (deviation * deviation));
        expect_near("row correlation", told.along_track.correlation[1], rows,
                    4.0 * told.along_track.lag_one_error + 0.015);
        expect_near("column correlation", told.range.correlation[1], columns,
                    4.0 * told.range.lag_one_error + 0.015);
        assert_true(told.range.lag_one_error > 0.0 && told.range.lag_one_error < 0.02);
        /* 1/e of exp(-x^2 / 2 deviation^2), between whole pixels within the chord's sag */
        expect_near("column length", told.range.length_pixels, sqrt(2.0) * deviation, 0.25);
        free(intensity);
    }
}

/* K-distributed intensity: second moment 2 (1 + 1 / shape) of the squared mean. Blocks of so heavy
 * tails are skewed: their median lies up to 15 % below the mean. */
static void test_texture(void **state)
{
    float *intensity = calloc(PIXELS, sizeof *intensity);
    assert_non_null(intensity);
    add_seabed(4.0, 1.5, 1.0, 3, intensity);
    const struct speckle_statistics told = measure(intensity, NULL);
    expect_near("squared contrast", told.intensity_contrast * told.intensity_contrast, 1.5, 0.225);
    assert_true(told.shape > 2.5 && told.shape < 8.0);
    expect_near("looks", told.looks, 1.0, 1e-9);
    memset(intensity, 0, PIXELS * sizeof *intensity);
    add_seabed(INFINITY, 1.5, 1.0, 3, intensity);
    assert_true(measure(intensity, NULL).shape > 20.0);
    free(intensity);
}

/* Neither bright stones in a tenth of the blocks, nor what is excluded, nor an even slope of the
 * level counts for more than the error. */
static void test_what_does_not_count(void **state)
{
    float *intensity = calloc(PIXELS, sizeof *intensity);
    uint8_t *excluded = calloc(PIXELS, 1);
    assert_true(intensity && excluded);
    add_seabed(INFINITY, 1.5, 1.0, 5, intensity);
    const struct speckle_statistics plain = measure(intensity, NULL);
    for (size_t i = 0; i < PIXELS; i++) {
        const size_t row = i / COLUMNS;
        const size_t column = i % COLUMNS;
        intensity[i] *= 1.0f + (float)column / COLUMNS;
        if (row < 64 && row % 32 < 6 && column % 32 < 6)
            intensity[i] *= 100.0f;
        excluded[i] = row >= 300 && row < 320;
        if (excluded[i])
            intensity[i] = 0.0f;
    }
    const struct speckle_statistics told = measure(intensity, excluded);
    assert_true(told.blocks >= 240 && told.blocks < 256);
    expect_near("contrast", told.intensity_contrast, plain.intensity_contrast, 0.04);
    expect_near("row correlation", told.along_track.correlation[1],
                plain.along_track.correlation[1], 0.03);
    memset(excluded, 1, PIXELS);
    assert_int_equal(measure(intensity, excluded).blocks, 0);
    for (size_t i = 0; i < PIXELS; i++)
        intensity[i] = 3.0f;
    assert_int_equal(measure(intensity, NULL).blocks, 0);
    free(intensity);
    free(excluded);
}

static void test_saturation(void **state)
{
    float values[1000];
    for (int i = 0; i < 1000; i++)
        values[i] = (float)((i * 37) % 1000);
    assert_true(isinf(find_saturation(values, 1000)));
    for (int i = 0; i < 1000; i++)
        values[i] = fminf(values[i], 960.0f);
    expect_near("saturation", find_saturation(values, 1000), 960.0, 0.0);
    for (int i = 0; i < 1000; i++)
        values[i] = 1.0f;
    assert_true(isinf(find_saturation(values, 1000))); /* all alike: nothing is cut */
}

TEST_PROGRAM(NULL, NULL, TEST(test_looks), TEST(test_correlation), TEST(test_texture),
             TEST(test_what_does_not_count), TEST(test_saturation))
