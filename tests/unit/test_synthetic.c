/* Tests synthetic seabeds against the statistics that they promise. Tolerances are five standard
 * errors. With N independent cells the relative standard error of a mean intensity is 1 / sqrt(N),
 * and the error of a correlation is 1 / sqrt(N). Seeds are fixed, so that a pass stays a pass. */
#include "claims.h"
#include "image/statistics.h"
#include "image/synthetic.h"

#define SPACING     0.025
#define PIXELS_MOST ((size_t)800 * 800)

static sonject_synthetic_params plain(uint32_t rows, uint32_t columns)
{
    sonject_synthetic_params synthetic;
    memset(&synthetic, 0, sizeof synthetic);
    synthetic.rows = rows;
    synthetic.columns = columns;
    synthetic.seed = 7;
    synthetic.speckle_shape = INFINITY;
    synthetic.texture_length_m = 0.1;
    synthetic.ripple_wavelength_m = 0.6;
    synthetic.ripple_heading_rad = PI / 2.0;
    synthetic.patch_length_m = 4.0;
    synthetic.mean_amplitude = 0.2;
    return synthetic;
}

/* Returns a seabed, valid until the third call from this one. */
static float *make(const sonject_synthetic_params *synthetic, double along_track_pixels,
                   double range_pixels)
{
    static float seabeds[3][2 * PIXELS_MOST];
    static size_t next;
    float *pixels = seabeds[next++ % 3];
    struct report report;
    memset(&report, 0, sizeof report);
    sonject_geometry_params geometry;
    memset(&geometry, 0, sizeof geometry);
    geometry.row_spacing_m = SPACING;
    geometry.column_spacing_m = SPACING;
    geometry.first_slant_range_m = 50.0;
    assert_true((size_t)synthetic->rows * synthetic->columns <= PIXELS_MOST);
    assert_int_equal(synthesise_seabed(&report, synthetic, &geometry, along_track_pixels * SPACING,
                                       range_pixels * SPACING, pixels),
                     SONJECT_OK);
    return pixels;
}

static size_t count_of(const sonject_synthetic_params *synthetic)
{
    return (size_t)synthetic->rows * synthetic->columns;
}

/* Returns the mean of the amplitude to the given power. */
static double moment(const float *pixels, size_t count, int power)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        double product = 1.0;
        for (int factor = 0; factor < power; factor++)
            product *= (double)pixels[i];
        sum += product;
    }
    return sum / (double)count;
}

static void expect_near(const char *what, double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%s is %.6g, not %.6g +- %.2g", what, value, expected, tolerance);
}

/* At one pixel of resolution the intensity's correlation is 1/4 to either side in range, 0 along
 * the track. A cell has 1.5 pixels, so there are 107,000 cells, and 5 / sqrt(N) = 0.015. */
TEST(test_rayleigh)
{
    const sonject_synthetic_params synthetic = plain(400, 400);
    float *pixels = make(&synthetic, 1.0, 1.0);
    const double mean = moment(pixels, count_of(&synthetic), 1);
    const double square = moment(pixels, count_of(&synthetic), 2);
    const double fourth = moment(pixels, count_of(&synthetic), 4);
    expect_near("rms amplitude", sqrt(square), 0.2, 0.2 * 0.0075);
    expect_near("std/mean", sqrt(square - mean * mean) / mean, sqrt(4.0 / PI - 1.0),
                0.5227 * 0.015);
    /* the variance of I^2 is 20 <I>^4: relative to 2 <I>^2 it is sqrt(5) that of I */
    expect_near("<I^2>/<I>^2", fourth / (square * square), 2.0, 2.0 * 0.015 * sqrt(5.0));
}

/* Two shapes have closed forms: with 1 the local intensity is exponential, with 1/2 it is the
 * square of a normal deviate. At 5 deviations probabilities and amplitudes go like exp(5 z), so
 * linear interpolation between steps h = 1/256 is off by 25 h^2 / 8 = 5e-5 of the amplitude. */
TEST(test_texture_distribution)
{
    struct speckle_texture exponential, squared_normal;
    speckle_texture_init(&exponential, 1.0);
    speckle_texture_init(&squared_normal, 0.5);
    for (int i = -500; i <= 500; i++) {
        const float deviate = (float)i / 100.0f + 0.0021f;
        const double below = 0.5 * erfc(-(double)deviate / sqrt(2.0));
        const double above = 0.5 * erfc((double)deviate / sqrt(2.0));
        double amplitude = (double)speckle_texture_amplitude(&exponential, deviate);
        expect_near("exponential, below", -expm1(-amplitude * amplitude) / below, 1.0, 1.2e-4);
        expect_near("exponential, above", exp(-amplitude * amplitude) / above, 1.0, 1.2e-4);
        amplitude = (double)speckle_texture_amplitude(&squared_normal, deviate);
        expect_near("square of normal, below", erf(amplitude / sqrt(2.0)) / below, 1.0, 1.2e-4);
        expect_near("square of normal, above", erfc(amplitude / sqrt(2.0)) / above, 1.0, 1.2e-4);
    }
}

/* The texture's mean and variance come from quadrature over the normal deviate. */
TEST(test_texture_moments)
{
    static const double shapes[] = {0.1, 0.5, 1.5, 4.0, 10.0, 100.0, 1e4, 9e5};
    for (size_t i = 0; i < COUNT(shapes); i++) {
        struct speckle_texture texture;
        speckle_texture_init(&texture, shapes[i]);
        double mean = 0.0;
        double square = 0.0;
        const double step = 1.0 / 128.0;
        for (double z = -7.5; z < 7.5; z += step) {
            const double weight = step * exp(-0.5 * z * z) / sqrt(2.0 * PI);
            const double amplitude = (double)speckle_texture_amplitude(&texture, (float)z);
            const double q = amplitude * amplitude;
            mean += weight * q;
            square += weight * q * q;
        }
        expect_near("mean texture", mean, 1.0, 1e-4);
        /* float amplitudes limit the variance of a texture that is nearly constant */
        expect_near("texture variance", (square - mean * mean) * shapes[i], 1.0,
                    1e-3 + 1e-7 * shapes[i]);
    }
}

/* Computes the complex correlation of pixels `rows` and `columns` apart. */
static void correlate(const float *pixels, const sonject_synthetic_params *synthetic, size_t rows,
                      size_t columns, double *real_part, double *imaginary_part)
{
    double real_sum = 0.0;
    double imaginary_sum = 0.0;
    double energy = 0.0;
    for (size_t row = 0; row + rows < synthetic->rows; row++) {
        for (size_t column = 0; column + columns < synthetic->columns; column++) {
            const float *a = pixels + 2 * (row * synthetic->columns + column);
            const float *b = a + 2 * (rows * synthetic->columns + columns);
            real_sum += (double)(a[0] * b[0] + a[1] * b[1]);
            imaginary_sum += (double)(a[0] * b[1] - a[1] * b[0]);
            energy += (double)(a[0] * a[0] + a[1] * a[1]);
        }
    }
    *real_part = real_sum / energy;
    *imaginary_part = imaginary_sum / energy;
}

/* The correlation of speckle is the autocorrelation of the point response: sinc(x / resolution)
 * along the track, 2^-(r / resolution)^2 in range. There are 800 x 800 pixels in cells of at most
 * 2.3 x 2.4, so 5 / sqrt(N) = 0.015. */
TEST(test_correlation_is_the_point_response)
{
    static const double resolutions[][2] = {{1.0, 1.0}, {2.3, 1.6}, {1.4, 0.7}};
    sonject_synthetic_params synthetic = plain(800, 800);
    synthetic.complex_pixels = 1;
    for (size_t i = 0; i < 3; i++) {
        float *pixels = make(&synthetic, resolutions[i][0], resolutions[i][1]);
        double real_part, imaginary_part;
        for (size_t lag = 1; lag < 6; lag++) {
            const double x = PI * (double)lag / resolutions[i][0];
            correlate(pixels, &synthetic, lag, 0, &real_part, &imaginary_part);
            expect_near("along-track correlation", real_part, sin(x) / x, 0.015);
            expect_near("its imaginary part", imaginary_part, 0.0, 0.015);
            const double r = (double)lag / resolutions[i][1];
            correlate(pixels, &synthetic, 0, lag, &real_part, &imaginary_part);
            expect_near("range correlation", real_part, pow(2.0, -r * r), 0.015);
            expect_near("its imaginary part", imaginary_part, 0.0, 0.015);
        }
    }
}

TEST(test_seed_decides)
{
    sonject_synthetic_params synthetic = plain(90, 110);
    synthetic.speckle_shape = 4.0;
    synthetic.ripple_contrast = 0.6;
    synthetic.patch_contrast_db = 4.0;
    const size_t count = count_of(&synthetic);
    const float *first = make(&synthetic, 1.0, 1.0);
    assert_memory_equal(first, make(&synthetic, 1.0, 1.0), count * sizeof *first);
    synthetic.seed += UINT64_C(1) << 40;
    const float *other = make(&synthetic, 1.0, 1.0);
    size_t equal = 0;
    for (size_t i = 0; i < count; i++)
        equal += first[i] == other[i];
    assert_true(equal < 3);
}

/* Returns FNV-1a over the bits, least significant byte of each pixel first. */
static uint32_t hash_of(const float *pixels, size_t count)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &pixels[i], sizeof bits);
        for (int byte = 0; byte < 4; byte++)
            hash = (hash ^ ((bits >> (8 * byte)) & 255u)) * 16777619u;
    }
    return hash;
}

/* Bits are the same on every machine, compiler and optimisation level. The number changes only with
 * the model: nothing else in this file depends on it. */
TEST(test_same_bits_everywhere)
{
    sonject_synthetic_params synthetic = plain(64, 80);
    synthetic.speckle_shape = 3.0;
    synthetic.ripple_contrast = 0.7;
    synthetic.ripple_heading_rad = 1.1;
    synthetic.patch_contrast_db = 4.0;
    synthetic.patch_length_m = 1.0;
    float *pixels = make(&synthetic, 1.3, 1.0);
    assert_int_equal(hash_of(pixels, count_of(&synthetic)), 0x0551a0ec);
}

TEST(test_amplitude_is_that_of_complex_pixels)
{
    sonject_synthetic_params synthetic = plain(40, 50);
    synthetic.speckle_shape = 2.0;
    synthetic.ripple_contrast = 0.8;
    float *amplitude = make(&synthetic, 1.0, 1.0);
    synthetic.complex_pixels = 1;
    float *pixels = make(&synthetic, 1.0, 1.0);
    for (size_t i = 0; i < count_of(&synthetic); i++)
        expect_near("amplitude",
                    hypot((double)pixels[2 * i], (double)pixels[2 * i + 1]) / (double)amplitude[i],
                    1.0, 3e-7); /* two roundings of float */
}

/* Mean intensities of 20 x 20 blocks, of 267 cells each, have a standard error of 6 %. Sediments 6
 * dB apart (a factor of 4) are then clearly separate. Blocks across a border lie between the two,
 * but hardly move medians. */
TEST(test_patch_step)
{
    sonject_synthetic_params synthetic = plain(800, 800);
    synthetic.patch_contrast_db = 6.0;
    synthetic.patch_length_m = 5.0;
    float *pixels = make(&synthetic, 1.0, 1.0);
    static double dark[1600], bright[1600];
    size_t dark_count = 0;
    size_t bright_count = 0;
    for (size_t block = 0; block < 1600; block++) {
        double sum = 0.0;
        for (size_t row = 0; row < 20; row++)
            for (size_t column = 0; column < 20; column++)
                sum += pow((double)pixels[(block / 40 * 20 + row) * 800 + block % 40 * 20 + column],
                           2.0);
        const double intensity = sum / 400.0 / 0.04;
        if (intensity < 2.0)
            dark[dark_count++] = intensity;
        else
            bright[bright_count++] = intensity;
    }
    assert_true(dark_count > 320 && bright_count > 320); /* neither sediment below a fifth */
    expect_near("darker sediment", median_of(dark, dark_count), 1.0, 0.05);
    expect_near("brighter sediment", median_of(bright, bright_count) / pow(10.0, 0.6), 1.0, 0.05);
}

/* Returns the correlation of intensities `rows` and `columns` apart. */
static double intensity_correlation(const float *pixels, const sonject_synthetic_params *synthetic,
                                    size_t rows, size_t columns)
{
    const double mean = moment(pixels, count_of(synthetic), 2);
    double products = 0.0;
    double squares = 0.0;
    for (size_t row = 0; row + rows < synthetic->rows; row++) {
        for (size_t column = 0; column + columns < synthetic->columns; column++) {
            const float *a = pixels + row * synthetic->columns + column;
            const float *b = a + rows * synthetic->columns + columns;
            const double from_mean = (double)(*a * *a) - mean;
            products += from_mean * ((double)(*b * *b) - mean);
            squares += from_mean * from_mean;
        }
    }
    return products / squares;
}

/* Beyond the speckle's own correlation, the intensity's, (<I I'> / <I>^2 - 1) * shape, is the
 * texture's. It falls to about 1/e at the texture length, a little less since Gamma deviates follow
 * normal ones less than in proportion, and to exp(-4) at twice the length. 800 x 800 pixels are
 * 4,000 cells, whose products scatter by about 3 / sqrt(N) = 0.05 in 1/shape. */
TEST(test_texture_length)
{
    sonject_synthetic_params synthetic = plain(800, 800);
    synthetic.speckle_shape = 1.5;
    synthetic.texture_length_m = 10.0 * SPACING;
    float *pixels = make(&synthetic, 1.0, 1.0);
    const double mean = moment(pixels, count_of(&synthetic), 2);
    const double variance = moment(pixels, count_of(&synthetic), 4) / (mean * mean) - 1.0;
    for (size_t turned = 0; turned < 2; turned++) {
        const double scale = variance * synthetic.speckle_shape;
        const double at_length =
            scale * intensity_correlation(pixels, &synthetic, turned ? 10 : 0, turned ? 0 : 10);
        const double at_twice =
            scale * intensity_correlation(pixels, &synthetic, turned ? 20 : 0, turned ? 0 : 20);
        expect_near("texture correlation", at_length, 0.33, 0.1);
        expect_near("texture correlation", at_twice, 0.015, 0.1);
    }
}

/* Ripples 0.6 m = 24 pixels long repeat across the crests, not along them, on about half of the
 * ground. They do not change the mean intensity. Its error is that of 30 wavelengths times 30
 * uncorrelated places, each with an intensity deviation of about 1. */
TEST(test_ripples)
{
    sonject_synthetic_params synthetic = plain(800, 800);
    synthetic.ripple_contrast = 0.8;
    float *pixels = make(&synthetic, 1.0, 1.0);
    expect_near("mean intensity", moment(pixels, count_of(&synthetic), 2) / 0.04, 1.0, 0.05);
    assert_true(intensity_correlation(pixels, &synthetic, 0, 24) > 0.05);
    assert_true(intensity_correlation(pixels, &synthetic, 0, 12) < -0.05);
    assert_true(intensity_correlation(pixels, &synthetic, 12, 0) > 0.1);
    /* heading h and h + 180 degrees are the same crests */
    synthetic.ripple_heading_rad -= PI;
    const float *opposite = make(&synthetic, 1.0, 1.0);
    for (size_t i = 0; i < count_of(&synthetic); i++)
        expect_near("amplitude", (double)opposite[i] / (double)pixels[i], 1.0, 1e-3);
    synthetic.ripple_heading_rad = 0.0;
    pixels = make(&synthetic, 1.0, 1.0);
    assert_true(intensity_correlation(pixels, &synthetic, 24, 0) > 0.05);
    assert_true(intensity_correlation(pixels, &synthetic, 12, 0) < -0.05);
    assert_true(intensity_correlation(pixels, &synthetic, 0, 12) > 0.1);
}

static void expect_usable(const sonject_synthetic_params *synthetic, double along_track_pixels,
                          double range_pixels)
{
    float *pixels = make(synthetic, along_track_pixels, range_pixels);
    double sum = 0.0;
    for (size_t i = 0; i < count_of(synthetic); i++) {
        assert_true(isfinite(pixels[i]) && pixels[i] >= 0.0f);
        sum += (double)pixels[i];
    }
    assert_true(sum > 0.0);
}

TEST(test_extremes)
{
    sonject_synthetic_params synthetic = plain(1, 1);
    synthetic.speckle_shape = 4.0;
    synthetic.ripple_contrast = 1.0;
    synthetic.patch_contrast_db = 100.0;
    expect_usable(&synthetic, 1.0, 1.0);
    synthetic.rows = 30;
    synthetic.columns = 40;
    synthetic.speckle_shape = 0.01;
    expect_usable(&synthetic, 1e-9, 1e-9);
    expect_usable(&synthetic, 1e9, 1e9);
    synthetic.speckle_shape = 1e300;
    synthetic.texture_length_m = synthetic.patch_length_m = synthetic.ripple_wavelength_m = 1e6;
    expect_usable(&synthetic, 1.0, 1.0);
    synthetic.speckle_shape = 4.0;
    synthetic.texture_length_m = synthetic.patch_length_m = synthetic.ripple_wavelength_m = 1e-6;
    synthetic.ripple_heading_rad = -1e300;
    expect_usable(&synthetic, 1.0, 1.0);
    synthetic.rows = 1;
    synthetic.columns = 1u << 16;
    expect_usable(&synthetic, 1.0, 1.0);
    synthetic.rows = 1u << 16;
    synthetic.columns = 1;
    expect_usable(&synthetic, 1.0, 1.0);
}

TEST_PROGRAM(NULL, NULL)
