/* Tests statistics of image patches, and contrast, looks, texture and correlation of speckle that
 * is known. */
#include "claims.h"

#include "image/shadow_floor.h"
#include "image/statistics.h"
#include "image/synthetic.h"
#include "scene/scene.h"

#define ROWS    512
#define COLUMNS 512
#define PIXELS  ((size_t)ROWS * COLUMNS)

static struct report report;

static void expect_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.9g is not %.9g +- %.3g", value, expected, tolerance);
}

static float *make_map(size_t rows, size_t columns, float value)
{
    float *map = zeroed(rows * columns, sizeof *map);
    for (size_t i = 0; i < rows * columns; i++)
        map[i] = value;
    return map;
}

/* Returns a number in 0...1. Equal states give equal sequences. */
static double uniform(uint64_t *state)
{
    return ((double)(next_random(state) >> 11) + 0.5) / 9007199254740992.0;
}

/* Returns the intensity of speckle with mean 1. */
static float speckle(uint64_t *state)
{
    return (float)-log(uniform(state));
}

TEST(test_a_point_spreads_with_the_deviation_asked_for)
{
    const double deviations[][2] = {{0.0, 0.0}, {0.3, 0.7}, {1.0, 1.5}, {2.5, 0.0}, {4.0, 11.3}};
    const size_t rows = 101;
    const size_t columns = 141;
    for (size_t test = 0; test < COUNT(deviations); test++) {
        float *point = make_map(rows, columns, 0.0f);
        float *mean = make_map(rows, columns, -1.0f);
        point[50 * columns + 70] = 1.0f;
        EXPECT_OK(&report, local_mean(&report, point, rows, columns, deviations[test][0],
                                      deviations[test][1], mean));
        double sum = 0.0;
        double row_variance = 0.0;
        double column_variance = 0.0;
        double fourth = 0.0;
        for (size_t row = 0; row < rows; row++)
            for (size_t i = 0; i < columns; i++) {
                const double weight = (double)mean[row * columns + i];
                const double y = (double)row - 50.0;
                const double x = (double)i - 70.0;
                assert_true(weight >= 0.0);
                sum += weight;
                row_variance += weight * y * y;
                column_variance += weight * x * x;
                fourth += weight * x * x * x * x;
            }
        /* the map is float: 6e-8 a pixel, times squares that weigh the tails */
        expect_near(sum, 1.0, 1e-6);
        expect_near(row_variance, deviations[test][0] * deviations[test][0], 1e-5);
        expect_near(column_variance, deviations[test][1] * deviations[test][1], 1e-4);
        /* three running means of equal width have a kurtosis of 3 - 1.2 / 3 = 2.6 */
        if (deviations[test][1] > 4.0)
            expect_near(fourth / (column_variance * column_variance), 2.6, 0.02);
        free(point);
        free(mean);
    }
}

/* Smooths by the definition, pixel by pixel: a running mean with fractional ends, three times. */
static void smooth_slowly(double *line, size_t count, double deviation)
{
    const double variance = deviation * deviation / 3.0;
    const double radius = floor((sqrt(1.0 + 12.0 * variance) - 1.0) / 2.0);
    /* the end weight w makes the variance of the window right: the squares of its offsets are
     * radius (radius + 1) (2 radius + 1) / 3 inside and (radius + 1)^2 w at both ends */
    const double inside = radius * (radius + 1.0) * (2.0 * radius + 1.0) / 3.0;
    const double end = (radius + 1.0) * (radius + 1.0);
    const double weight = (variance * (2.0 * radius + 1.0) - inside) / (2.0 * end - 2.0 * variance);
    double *from = zeroed(count, sizeof *from);
    for (int pass = 0; pass < 3; pass++) {
        memcpy(from, line, count * sizeof *line);
        for (size_t i = 0; i < count; i++) {
            double sum = 0.0;
            double total = 0.0;
            for (size_t j = 0; j < count; j++) {
                const double distance = fabs((double)i - (double)j);
                const double here =
                    distance <= radius ? 1.0 : (distance <= radius + 1.0 ? weight : 0.0);
                sum += here * from[j];
                total += here;
            }
            line[i] = sum / total;
        }
    }
    free(from);
}

/* Lines have any length. The last two deviations give the mean of all. */
TEST(test_edges)
{
    const double deviations[] = {0.2, 0.9, 2.0, 7.7, 30.0, 1e6, INFINITY};
    const size_t counts[] = {1, 2, 9, 61};
    uint64_t random = 3;
    float values[61], along[61], across[61];
    double expected[61];
    for (size_t test = 0; test < COUNT(deviations) * COUNT(counts); test++) {
        const double deviation = deviations[test / COUNT(counts)];
        const size_t count = counts[test % COUNT(counts)];
        for (size_t i = 0; i < count; i++)
            expected[i] = (double)(values[i] = speckle(&random));
        smooth_slowly(expected, count, fmin(deviation, 1e6));
        EXPECT_OK(&report, local_mean(&report, values, 1, count, 9.0, deviation, along));
        EXPECT_OK(&report, local_mean(&report, values, count, 1, deviation, 9.0, across));
        for (size_t i = 0; i < count; i++) {
            expect_near((double)along[i], expected[i], 1e-6); /* float results of about 1 */
            expect_near((double)across[i], expected[i], 1e-6);
        }
    }
}

/* An echo far above everything must not leave rounding errors where it is out of reach. */
TEST(test_a_bright_echo_leaves_no_trace)
{
    const size_t columns = 300;
    float *map = make_map(1, columns, 1e-6f);
    float *mean = make_map(1, columns, 0.0f);
    map[20] = 1e12f;
    EXPECT_OK(&report, local_mean(&report, map, 1, columns, 1.0, 3.0, mean));
    for (size_t i = 60; i < columns; i++)
        expect_near((double)mean[i], 1e-6, 1e-12);
    free(map);
    free(mean);
}

TEST(test_mean_and_deviation)
{
    const float values[] = {2.0f, 4.0f, 4.0f, 4.0f, 5.0f, 5.0f, 7.0f, 9.0f};
    float *many = make_map(1000, 1000, 16777217.0f);
    double mean;
    double deviation;
    mean_and_deviation(values, 8, &mean, &deviation);
    assert_true(mean == 5.0 && deviation == 2.0);
    mean_and_deviation(many, 1000000, &mean, &deviation); /* float sums would stand still */
    assert_true(mean == (double)many[0] && deviation == 0.0);
    free(many);
}

/* Speckled seabed, 2 dB brighter and darker from place to place. Shadows of one size have a floor,
 * a share of the seabed around. Columns at the left are water, a thousandth of the seabed. */
struct made_shadows {
    double floor;
    size_t rows, columns, water;
    bool is_open; /* each shadow reaches the edge of the image */
};

static struct shadow_floor floor_of(const struct made_shadows *made)
{
    const size_t rows = 320, columns = 360;
    float *intensity = make_map(rows, columns, 0.0f);
    uint8_t *states = zeroed(rows * columns, 1);
    struct shadow_floor found = {0};
    uint64_t random = 11;
    for (size_t row = 0; row < rows; row++)
        for (size_t i = 0; i < columns; i++) {
            const size_t first = made->is_open ? columns - made->columns : 80 + row / 40 % 3 * 90;
            const bool is_shadow = row % 40 >= 16 && row % 40 < 16 + made->rows && i >= first &&
                                   i < first + made->columns;
            const double seabed = 2.5 * exp(0.46 * sin((double)row / 50.0 + (double)i / 70.0));
            const double share = i < made->water ? 1e-3 : is_shadow ? made->floor : 1.0;
            states[row * columns + i] = i < made->water;
            intensity[row * columns + i] = (float)(seabed * share) * speckle(&random);
        }
    EXPECT_OK(&report, shadow_floor_find(&report, intensity, states, rows, columns, &found));
    free(found.list);
    free(intensity);
    free(states);
    return found;
}

TEST(test_shadows_tell_the_floor_and_water_does_not)
{
    for (double floor_db = -10.0; floor_db > -26.0; floor_db -= 3.0)
        for (size_t size = 0; size < 2; size++) { /* shadows also as narrow as a small stone's */
            const struct made_shadows made = {pow(10.0, 0.1 * floor_db), size == 0 ? 4 : 12,
                                              size == 0 ? 24 : 40, 40, false};
            const struct shadow_floor found = floor_of(&made);
            assert_in_range(found.shadows, 5, 8);
            assert_true(found.log_error < 0.32); /* 1.4 dB */
            expect_near(found.log_ratio, log(made.floor), 3.0 * found.log_error);
        }
}

TEST(test_what_is_no_shadow_amid_the_seabed_tells_none)
{
    const struct made_shadows none[] = {
        {1.0, 12, 40, 40, false},  /* plain seabed behind water */
        {0.03, 12, 40, 0, true},   /* dark to the edge of the image */
        {0.03, 2, 2, 0, false},    /* smaller than what speckle needs */
        {0.2, 12, 40, 0, false},   /* dim ground */
        {1e-12, 12, 40, 0, false}, /* nothing but 0, as where an image is blank */
    };
    for (size_t i = 0; i < COUNT(none); i++)
        assert_int_equal(floor_of(&none[i]).shadows, 0);
}

static double distance_of(const float *a, const float *b, size_t count)
{
    double distance = -1.0;
    EXPECT_OK(&report, histogram_distance(&report, a, b, count, &distance));
    return distance;
}

TEST(test_histogram_distance)
{
    const float a[] = {1.0f, 2.0f, 3.0f, 4.0f};
    const float shuffled[] = {40.0f, 20.0f, 10.0f, 30.0f};
    const float equal[] = {5.0f, 5.0f, 5.0f, 5.0f};
    const float nothing[] = {0.0f, 0.0f, 0.0f, 0.0f};
    const float twice[] = {0.0f, 0.0f, 0.0f, 8.0f};
    assert_true(distance_of(a, a, 4) == 0.0);
    assert_true(distance_of(a, shuffled, 4) == 0.0); /* same shape: the mean is divided out */
    assert_true(distance_of(equal, nothing, 4) == 1.0);
    /* a / 2.5 = 0.4 0.8 1.2 1.6 against four times 1: 2 of 4 lie below */
    assert_true(distance_of(a, equal, 4) == 0.5);
    assert_true(distance_of(equal, a, 4) == 0.5);
    assert_true(distance_of(a, twice, 4) == 0.75);
    assert_true(distance_of(a, a, 0) == 0.0);
}

TEST(test_correlation)
{
    const float a[] = {1.0f, 2.0f, 3.0f, 4.0f};
    const float up[] = {30.0f, 50.0f, 70.0f, 90.0f};
    const float down[] = {4.0f, 3.0f, 2.0f, 1.0f};
    const float across[] = {1.0f, -1.0f, -1.0f, 1.0f};
    const float equal[] = {5.0f, 5.0f, 5.0f, 5.0f};
    const float some[] = {1.0f, 3.0f, 2.0f, 4.0f};
    expect_near(correlation(a, up, 4), 1.0, 1e-12);
    expect_near(correlation(a, down, 4), -1.0, 1e-12);
    expect_near(correlation(a, across, 4), 0.0, 1e-12);
    expect_near(correlation(a, some, 4), 0.8, 1e-12);
    assert_true(correlation(a, equal, 4) == 0.0);
    assert_true(correlation(a, up, 0) == 0.0);
}

/* Adds the intensity of a seabed without ripples and patches: nothing but speckle. Responses: a
 * sinc of row_width pixels, a Gaussian of a -3 dB width of column_width pixels. shape: of the K
 * distribution; INFINITY: Rayleigh. */
static void add_seabed(double shape, double row_width, double column_width, uint64_t seed,
                       float *intensity)
{
    struct scene scene;
    sonject_synthetic_params *synthetic = &scene.synthetic;
    float *pixels = zeroed(PIXELS, sizeof *pixels);
    scene_init(&scene);
    scene.geometry.first_slant_range_m = 40.0;
    synthetic->rows = ROWS;
    synthetic->columns = COLUMNS;
    synthetic->seed = seed;
    synthetic->speckle_shape = shape;
    synthetic->ripple_contrast = 0.0;
    synthetic->patch_contrast_db = 0.0;
    EXPECT_OK(&report, synthesise_seabed(&report, synthetic, &scene.geometry, row_width * 0.025,
                                         column_width * 0.025, pixels));
    for (size_t i = 0; i < PIXELS; i++)
        intensity[i] += pixels[i] * pixels[i];
    free(pixels);
}

static struct speckle_statistics measure(const float *intensity, const uint8_t *excluded)
{
    struct speckle_statistics statistics;
    EXPECT_OK(&report,
              measure_speckle(&report, intensity, excluded, ROWS, COLUMNS, COLUMNS, &statistics));
    return statistics;
}

/* Speckle of L looks has the intensity contrast 1 / sqrt(L), and an amplitude contrast by Gamma
 * functions. A block of 32 x 32 pixels, some 500 of them independent, gives the squared contrast 1
 * / L to sqrt(20 / 500) / L or less. The median of 256 blocks errs by 1.25 / 16 of it, 1.6 %, and
 * skewness takes off 2 % more. Tolerance 4 * 1.6 % + 2 %. */
TEST(test_looks)
{
    static const double expected_amplitude[] = {0.52272, 0.0, 0.0, 0.25289};
    float *intensity = make_map(ROWS, COLUMNS, 0.0f);
    for (int look = 1; look <= 4; look++) {
        add_seabed(INFINITY, 1.5, 1.0, (uint64_t)look, intensity);
        if (look == 2 || look == 3)
            continue;
        const struct speckle_statistics told = measure(intensity, NULL);
        const double contrast = 1.0 / sqrt(look);
        assert_int_equal(told.blocks, 256);
        expect_near(told.intensity_contrast, contrast, 0.042 * contrast);
        expect_near(told.amplitude_contrast, expected_amplitude[look - 1],
                    0.02 * expected_amplitude[look - 1]);
        expect_near(told.looks, look, 0.084 * look);
        assert_true(told.looks_error > 0.0 && told.looks_error < 0.05 * look);
    }
    free(intensity);
}

/* Single looks correlate by sinc^2(1 / row width) and exp(-4 ln 2 / (2 column width^2)), with the
 * width at half power. The median of 256 blocks has the error that is measured with it. The trend
 * and mean that are taken off a block cost 1 % of a correlation. */
TEST(test_speckle_correlation)
{
    static const double row_widths[] = {1.0, 1.5, 2.5};
    static const double column_widths[] = {1.0, 2.0, 1.5};
    for (int i = 0; i < 3; i++) {
        float *intensity = make_map(ROWS, COLUMNS, 0.0f);
        add_seabed(INFINITY, row_widths[i], column_widths[i], 7, intensity);
        const struct speckle_statistics told = measure(intensity, NULL);
        const double x = PI / row_widths[i];
        const double deviation = column_widths[i] / (2.0 * sqrt(log(2.0)));
        const double rows = sin(x) / x * (sin(x) / x);
        const double columns = exp(-0.5 / (deviation * deviation));
        expect_near(told.along_track.correlation[1], rows,
                    4.0 * told.along_track.lag_one_error + 0.015);
        expect_near(told.range.correlation[1], columns, 4.0 * told.range.lag_one_error + 0.015);
        assert_true(told.range.lag_one_error > 0.0 && told.range.lag_one_error < 0.02);
        /* exp(-x^2 / 2 deviation^2) is 1/e here, to the sag of chords between whole pixels */
        expect_near(told.range.length_pixels, sqrt(2.0) * deviation, 0.25);
        free(intensity);
    }
}

/* K-distributed intensity has the second moment 2 (1 + 1 / shape) times the squared mean. Blocks
 * with such heavy tails are skewed: their median lies up to 15 % below the mean. */
TEST(test_texture)
{
    float *intensity = make_map(ROWS, COLUMNS, 0.0f);
    add_seabed(4.0, 1.5, 1.0, 3, intensity);
    const struct speckle_statistics told = measure(intensity, NULL);
    expect_near(told.intensity_contrast * told.intensity_contrast, 1.5, 0.225);
    assert_true(told.shape > 2.5 && told.shape < 8.0);
    expect_near(told.looks, 1.0, 1e-9);
    memset(intensity, 0, PIXELS * sizeof *intensity);
    add_seabed(INFINITY, 1.5, 1.0, 3, intensity);
    assert_true(measure(intensity, NULL).shape > 20.0);
    free(intensity);
}

/* Bright stones in a tenth of the blocks, excluded pixels, and an even slope of the level count for
 * no more than the error. */
TEST(test_what_does_not_count)
{
    float *intensity = make_map(ROWS, COLUMNS, 0.0f);
    static uint8_t excluded[PIXELS];
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
    expect_near(told.intensity_contrast, plain.intensity_contrast, 0.04);
    expect_near(told.along_track.correlation[1], plain.along_track.correlation[1], 0.03);
    memset(excluded, 1, PIXELS);
    assert_int_equal(measure(intensity, excluded).blocks, 0);
    for (size_t i = 0; i < PIXELS; i++)
        intensity[i] = 3.0f;
    assert_int_equal(measure(intensity, NULL).blocks, 0);
    free(intensity);
}

TEST(test_saturation)
{
    float values[1000];
    for (int i = 0; i < 1000; i++)
        values[i] = (float)((i * 37) % 1000);
    assert_true(isinf(find_saturation(values, 1000)));
    for (int i = 0; i < 1000; i++)
        values[i] = fminf(values[i], 960.0f);
    expect_near(find_saturation(values, 1000), 960.0, 0.0);
    for (int i = 0; i < 1000; i++)
        values[i] = 1.0f;
    assert_true(isinf(find_saturation(values, 1000))); /* all alike: nothing is cut */
}

TEST_PROGRAM(NULL, NULL)
