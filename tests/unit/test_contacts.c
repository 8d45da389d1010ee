/* Tests edges in speckle against the drawn ones, and the search for contacts in an image. */
#include "claims.h"
#include "measure/contact_edges.h"
#include "measure/contacts.h"

#define PIXELS  60
#define DRAWS   400
#define ROWS    200
#define COLUMNS 300

static struct report report;
static uint64_t random_state;
static double means[PIXELS]; /* mean intensities of a profile */
static const double lobe_bias[PIXELS];

static double draw(void)
{
    return ((double)(next_random(&random_state) >> 11) + 0.5) * 0x1p-53;
}

/* Returns the mean of n exponential values of mean 1. */
static double speckle(int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum -= log(draw()) / n;
    return sum;
}

static double share_behind(double distance, double deviation)
{
    return 0.5 * erfc(-distance / (sqrt(2.0) * deviation));
}

/* Mean and spread of (measured - true) over the stated error, as sums. */
struct pulls {
    double sum, squares, offset;
    int count;
};

static void add_pull(struct pulls *pulls, const struct profile_edge *edge, double truth)
{
    const double pull = (edge->place - truth) / edge->error;
    pulls->sum += pull;
    pulls->squares += pull * pull;
    pulls->offset += edge->place - truth;
    pulls->count++;
}

/* Expects stated errors to be right. Over DRAWS edges the spread of pulls is known to 1/sqrt(2
 * DRAWS) = 4 %; 30 % are allowed, as likelihoods are not normal. Soft edges also fit sharp steps
 * that lie further out by a fraction of a pixel. */
static void expect_pulls(const char *what, const struct pulls *pulls)
{
    const double spread = sqrt(pulls->squares / pulls->count);
    const double offset = pulls->offset / pulls->count;
    print_message("%s: offset %.3f pixels, pulls %.2f\n", what, offset, spread);
    if (!(spread > 0.7 && spread < 1.3))
        fail_msg("%s: pulls of %.2f standard errors", what, spread);
    if (!(fabs(offset) < 0.25))
        fail_msg("%s: edges are off by %.2f pixels on average", what, offset);
}

/* Profiles go from a highlight of varying levels to a shadow, all through a point response. */
TEST(test_ends_in_speckle)
{
    const double deviation = 0.42;
    const struct end_levels levels = {0.2, 0.06};
    struct pulls pulls = {0.0, 0.0, 0.0, 0};
    random_state = 1;
    for (int i = 0; i < DRAWS; i++) {
        const double truth = 10.0 + 5.0 * draw();
        for (int k = 0; k < PIXELS; k++) {
            const double lit = 1.0 - share_behind(k - truth, deviation);
            means[k] = (0.03 + (k < 6 ? 8.0 : 30.0) * lit) * speckle(6);
        }
        const struct profile profile = {means, lobe_bias, PIXELS, 6.0, deviation};
        const struct profile_edge edge = find_profile_end(&profile, &levels);
        add_pull(&pulls, &edge, truth);
    }
    expect_pulls("ends", &pulls);
}

/* Profiles go from a shadow to the seabed, through penumbras of several widths. */
TEST(test_steps_in_speckle)
{
    const double widths[2] = {0.42, 2.5};
    struct step_levels levels;
    random_state = 2;
    step_levels_init(&levels, 0.03, 1.0);
    for (int i = 0; i < 2; i++) {
        struct pulls pulls = {0.0, 0.0, 0.0, 0};
        for (int j = 0; j < DRAWS; j++) {
            const double truth = 25.0 + 5.0 * draw();
            for (int k = 0; k < PIXELS; k++)
                means[k] = (0.03 + 0.97 * share_behind(k - truth, widths[i])) * speckle(6);
            const struct profile profile = {means, lobe_bias, PIXELS, 6.0, 0.42};
            struct edge_posterior belief;
            memset(&belief, 0, sizeof belief);
            weigh_profile_step(&belief, &profile, &levels);
            const struct profile_edge edge = mean_step_believed(&belief, 1);
            add_pull(&pulls, &edge, truth);
        }
        expect_pulls(i == 0 ? "steps" : "soft steps", &pulls);
    }
}

/* Six samples a pixel show twice the level in the first third. Where there is one level, a
 * likelihood ratio of e^10 comes up once in some 200 (see contact_ruler.c). */
TEST(test_changes_in_shadows)
{
    const struct profile profile = {means, lobe_bias, PIXELS, 6.0, 0.42};
    struct pulls pulls = {0.0, 0.0, 0.0, 0};
    int told = 0;
    double gain;
    random_state = 7;
    for (int i = 0; i < 2 * DRAWS; i++) {
        const int first = i < DRAWS ? 20 : 0;
        for (int k = 0; k < PIXELS; k++)
            means[k] = (k < first ? 0.02 : 0.01) * speckle(6);
        const struct profile_edge change = find_profile_change(&profile, &gain);
        if (i < DRAWS)
            add_pull(&pulls, &change, 19.5);
        told += i < DRAWS ? gain >= 10.0 : -(gain >= 10.0);
        assert_true(i < DRAWS || gain < 14.0);
    }
    assert_true(told > DRAWS * 9 / 10);
    expect_pulls("changes", &pulls);
}

/* Profiles are all dark, all lit, nothing but zeros, or a single pixel. */
TEST(test_profiles_without_an_edge)
{
    memset(means, 0, sizeof means);
    const struct end_levels levels = {4.0, 1.0};
    const struct profile profile = {means, lobe_bias, PIXELS, 20.0, 0.5};
    const struct profile single = {means, lobe_bias, 1, 1.0, 0.5};
    struct profile_edge edge = find_profile_end(&profile, &levels);
    assert_true(fabs(edge.place + 0.5) < 0.5);
    edge = find_profile_end(&single, &levels);
    assert_true(edge.place >= -0.5 && edge.place <= 0.5 && edge.error >= 0.0);
    for (int k = 0; k < PIXELS; k++)
        means[k] = 9.0;
    edge = find_profile_end(&profile, &levels);
    assert_true(fabs(edge.place - (PIXELS - 0.5)) < 0.5);
}

static float intensity[ROWS * COLUMNS];

/* A few dark pixels behind a highlight are speckle, and no shadow. */
TEST(test_dark_speckle_is_no_shadow)
{
    struct contact_image image;
    const sonject_box box = {50, 80, 40, 120};
    const struct contact_place place = {box, box, false};
    struct contact_sizes sizes;
    for (size_t i = 0; i < (size_t)ROWS * COLUMNS; i++)
        intensity[i] = 1.0f;
    for (size_t row = 64; row < 76; row++)
        for (size_t column = 100; column < 105; column++)
            intensity[row * COLUMNS + column] = 100.0f;
    for (size_t row = 68; row < 72; row++)
        for (size_t column = 130; column < 134; column++)
            intensity[row * COLUMNS + column] = 0.01f;
    EXPECT_OK(&report, contact_image_create(&image, &report, intensity, ROWS, COLUMNS));
    EXPECT_OK(&report, measure_contact_sizes(&image, &report, &place, &sizes));
    assert_true(sizes.highlight.pixels > 0 && sizes.shadow.pixels == 0);
    assert_true(isnan(sizes.shadow_columns.pixels) && isnan(sizes.dim_columns.pixels));
    contact_image_clear(&image);
}

/* Images and boxes have any size, and bright pixels are at any place. */
TEST(test_small_images)
{
    random_state = 5;
    for (size_t rows = 1; rows < 40; rows += rows < 8 ? 1 : 7)
        for (size_t columns = 1; columns < 40; columns += columns < 8 ? 1 : 7)
            for (int i = 0; i < 8; i++) {
                float *pixels = zeroed(rows * columns, sizeof *pixels);
                struct contact_image image;
                struct contact_place place = {{0, 0, rows, columns}, {0, 0, 0, 0}, i % 2 == 0};
                struct contact_sizes sizes;
                for (size_t k = 0; k < rows * columns; k++)
                    pixels[k] = (float)(draw() < 0.6 ? speckle(1) : i < 4 ? 0.0 : 1e-3);
                for (int k = 0; k < i; k++)
                    pixels[(size_t)(draw() * (double)(rows * columns))] = 1e4f;
                place.box.first_row = (size_t)(draw() * (double)rows);
                place.box.first_column = (size_t)(draw() * (double)columns);
                place.box.rows -= place.box.first_row;
                place.box.columns -= place.box.first_column;
                place.bright = place.box;
                EXPECT_OK(&report, contact_image_create(&image, &report, pixels, rows, columns));
                const sonject_status status =
                    measure_contact_sizes(&image, &report, &place, &sizes);
                assert_true(status == SONJECT_OK || status == SONJECT_ERROR_INPUT);
                if (status == SONJECT_OK && sizes.highlight.pixels > 0)
                    assert_true(sizes.highlight_rows.pixels >= 0.0 &&
                                sizes.highlight_rows.pixels < (double)rows + 1.0 &&
                                sizes.highlight_columns.pixels >= 0.0);
                if (status == SONJECT_OK && sizes.shadow.pixels > 0)
                    assert_true(sizes.shadow_rows.pixels >= 0.0 &&
                                sizes.shadow_columns.pixels >= 0.0 &&
                                sizes.shadow_columns.error >= 0.0);
                contact_image_clear(&image);
                free(pixels);
            }
}

static void fill_box(const sonject_box *box, float value)
{
    for (size_t row = 0; row < box->rows; row++)
        for (size_t column = 0; column < box->columns; column++)
            intensity[(box->first_row + row) * COLUMNS + box->first_column + column] = value;
}

static void take_box(struct contact_image *image, const sonject_box *box)
{
    for (size_t row = 0; row < box->rows; row++)
        memset(image->taken + (box->first_row + row) * COLUMNS + box->first_column, 1,
               box->columns);
}

/* Means of 9 and 21 values of single-look speckle are Gamma distributed. Their quantiles are 2.064
 * (99.5 %) and 0.527 (0.5 %). One draw gives them to some 0.25 dB, as windows overlap, and SEEN
 * draws to 0.04 dB. A second contact nearby does not count as seabed. A missing part gets no
 * answer. */
TEST(parts_are_seen_by_the_quantiles_of_speckle)
{
    enum {
        SEEN = 40
    };
    const sonject_box bright = {90, 100, 6, 6}, dark = {90, 110, 7, 21}, none = {0, 0, 0, 0};
    const sonject_box other = {70, 100, 8, 20};
    struct contact_image image;
    struct contact_visibility seen, mean = {0.0, 0.0};
    random_state = 7;
    for (int i = 0; i < SEEN; i++) {
        for (size_t k = 0; k < ROWS * COLUMNS; k++)
            intensity[k] = (float)speckle(1);
        fill_box(&bright, 20.0f);
        fill_box(&dark, 0.05f);
        fill_box(&other, 300.0f);
        EXPECT_OK(&report, contact_image_create(&image, &report, intensity, ROWS, COLUMNS));
        take_box(&image, &bright);
        take_box(&image, &dark);
        take_box(&image, &other);
        EXPECT_OK(&report, measure_visibility(&image, &report, &bright, &dark, &seen));
        mean.highlight_db += seen.highlight_db / SEEN;
        mean.shadow_db += seen.shadow_db / SEEN;
        EXPECT_OK(&report, measure_visibility(&image, &report, &none, &dark, &seen));
        assert_true(isnan(seen.highlight_db) && !isnan(seen.shadow_db));
        contact_image_clear(&image);
    }
    print_message("highlight %.2f dB, shadow %.2f dB\n", mean.highlight_db, mean.shadow_db);
    assert_true(fabs(mean.highlight_db - 10.0 * log10(20.0 / 2.064)) < 0.16);
    assert_true(fabs(mean.shadow_db - 10.0 * log10(0.05 / 0.527)) < 0.16);
}

TEST_PROGRAM(NULL, NULL)
