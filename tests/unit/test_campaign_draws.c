/* Tests what campaigns draw from: distributions against their closed forms, permutations, shares,
 * and places for images. */
#include "base/memory.h"
#include "base/text.h"
#include "claims.h"
#include "dataset/campaign.h"

#define DRAWS 40000

static void read_text_of(const char *text, struct distribution *distribution)
{
    struct report report = {.host = NULL};
    struct tree tree;
    tree_init(&tree, &report, "test.yaml");
    struct reader reader = {.report = &report, .tree = &tree};
    memset(distribution, 0, sizeof *distribution);
    assert_int_equal(tree_parse(&tree, text, strlen(text)), SONJECT_OK);
    assert_int_equal(distribution_read(&reader, &tree.root, "key", distribution), SONJECT_OK);
    tree_clear(&tree);
}

/* Expects the values that text draws to have a mean and a variance, within five standard errors.
 * fourth: the distribution's fourth central moment over its variance squared. */
static void check_moments(const char *text, double mean, double variance, double fourth)
{
    struct distribution distribution;
    double sum = 0.0;
    double squares = 0.0;
    read_text_of(text, &distribution);
    for (uint64_t i = 0; i < DRAWS; i++) {
        const double value = distribution_number(&distribution, uniform_number(11, 3, i));
        assert_true(value >= distribution.low && value <= distribution.high);
        sum += value - mean;
        squares += (value - mean) * (value - mean);
    }
    assert_true(fabs(sum / DRAWS) < 5.0 * sqrt(variance / DRAWS));
    assert_true(fabs(squares / DRAWS - variance) < 5.0 * variance * sqrt((fourth - 1.0) / DRAWS));
    distribution_clear(&distribution);
}

TEST(test_moments_are_those_of_the_distributions)
{
    check_moments("{uniform: [-2 cm, 4 cm]}", 1.0, 3.0, 1.8);
    /* mean: (b - a) / ln(b / a), mean square: (b^2 - a^2) / (2 ln(b / a)) */
    const double log_mean = 9.0 / log(10.0);
    check_moments("{log_uniform: [1, 10]}", log_mean, 49.5 / log(10.0) - log_mean * log_mean, 2.46);
    check_moments("{normal: {mean: 3 dB, deviation: 2 dB}}", 3.0, 4.0, 3.0);
    /* cut at the mean: half a normal, mean sqrt(2 / pi), variance 1 - 2 / pi */
    check_moments("{normal: {mean: 0, deviation: 1, minimum: 0}}", sqrt(2.0 / 3.141592653589793),
                  1.0 - 2.0 / 3.141592653589793, 3.87);
    /* far out in the tail, six deviations and more: mean phi(6) / Q(6), by the table 6.158 */
    check_moments("{normal: {mean: 0, deviation: 1, minimum: 6}}", 6.1584826, 0.0239876, 8.04);
}

TEST(test_weights_are_frequencies)
{
    struct distribution distribution;
    char text[DISTRIBUTION_TEXT_CAPACITY];
    int counts[3] = {0, 0, 0};
    read_text_of("{choice: [a, b, {c: d}], weights: [1, 0, 3]}", &distribution);
    for (uint64_t i = 0; i < DRAWS; i++) {
        const char *value = distribution_value(&distribution, uniform_number(1, 1, i), text);
        counts[*value == 'a' ? 0 : *value == 'b' ? 1 : 2]++;
    }
    assert_int_equal(counts[1], 0);
    assert_true(fabs(counts[0] - 0.25 * DRAWS) < 5.0 * sqrt(0.25 * 0.75 * DRAWS));
    assert_string_equal(distribution_value(&distribution, 1.0, text), "{\"c\": d}");
    distribution_clear(&distribution);
}

TEST(test_ends_are_reached_and_not_left)
{
    struct distribution distribution;
    char text[DISTRIBUTION_TEXT_CAPACITY];
    double value;
    const char *rest;
    read_text_of("{uniform: [0.3333333333333333 m, 0.6666666666666666 m]}", &distribution);
    for (int end = 0; end < 2; end++) {
        assert_true(text_to_number(distribution_value(&distribution, end, text), &value, &rest));
        assert_true(value >= distribution.low && value <= distribution.high);
        assert_string_equal(rest, " m");
    }
    distribution_clear(&distribution);
    read_text_of("{uniform: [0 deg, 90 deg], steps: 4}", &distribution);
    assert_int_equal(distribution_steps(&distribution), 4);
    assert_string_equal(distribution_step(&distribution, 1, text), "30 deg");
    assert_string_equal(distribution_step(&distribution, 3, text), "90 deg");
    distribution_clear(&distribution);
}

TEST(test_permutations_hit_all_once)
{
    for (uint64_t count = 1; count < 300; count += 1 + count / 7) {
        uint8_t hits[300] = {0};
        uint64_t fixed = 0;
        for (uint64_t i = 0; i < count; i++) {
            const uint64_t to = permuted_index(5, 9, i, count);
            assert_true(to < count);
            assert_int_equal(hits[to]++, 0);
            fixed += to == i;
        }
        /* one is fixed in the mean, more than eight in less than one case in 10^5 */
        assert_true(count == 1 || fixed < 9);
    }
}

TEST(test_strata_hold_one_each)
{
    uint8_t hits[1000] = {0};
    double products = 0.0;
    for (uint64_t i = 0; i < 1000; i++) {
        const double u = stratified_number(3, 1, i, 1000);
        const double v = stratified_number(3, 2, i, 1000);
        assert_int_equal(hits[(int)(u * 1000)]++, 0);
        products += (u - 0.5) * (v - 0.5);
    }
    /* the axes are independent: variance 1/144 each */
    assert_true(fabs(products / 1000) < 5.0 / 12.0 / sqrt(1000));
}

TEST(test_shares_are_whole_and_add_up)
{
    const double weights[] = {1.0, 0.0, 2.0, 0.5, 0.1};
    uint64_t shares[5];
    for (uint64_t total = 0; total < 200; total++) {
        uint64_t sum = 0;
        share_out(total, weights, 5, shares);
        for (int i = 0; i < 5; i++) {
            assert_true(fabs((double)shares[i] - (double)total * weights[i] / 3.6) < 1.0);
            sum += shares[i];
        }
        assert_int_equal(shares[1], 0);
        assert_int_equal(sum, total);
    }
}

/* Returns whether a chip at a place keeps the campaign's clearance from the box. */
static bool is_clear(const struct campaign *campaign, const struct region *box, uint64_t row,
                     uint64_t column)
{
    return row + campaign->chip_rows + campaign->clearance <= box->first_row ||
           row >= box->first_row + box->rows + campaign->clearance ||
           column + campaign->chip_columns + campaign->clearance <= box->first_column ||
           column >= box->first_column + box->columns + campaign->clearance;
}

/* Checks places for images. quality: of a JPEG, whose images begin at blocks; 0: no JPEG. */
static void check_places(int quality)
{
    struct report report = {.host = NULL};
    struct region boxes[] = {{25, 40, 5, 7}, {0, 0, 2, 2}, {58, 0, 99, 3}};
    struct avoided_box avoided[] = {{{0, 0, 0, 0}, {6.25, 7.25}, {40.0, 43.0}}, /* boxes[0] in m */
                                    {boxes[1], {NAN, NAN}, {NAN, NAN}},
                                    {boxes[2], {NAN, NAN}, {NAN, NAN}}};
    struct swath_plan swath;
    struct campaign campaign;
    int hits[60][90] = {{0}};
    double altitudes[60];
    uint64_t places = 0;
    memset(&swath, 0, sizeof swath);
    memset(&campaign, 0, sizeof campaign);
    const sonject_geometry_params geometry = {
        .row_spacing_m = 0.25, .column_spacing_m = 0.5, .first_slant_range_m = 20.0};
    campaign.swaths = &swath;
    campaign.chip_rows = 16;
    campaign.chip_columns = 17;
    campaign.edge = 1;
    campaign.clearance = 3;
    campaign.slant_range_m[0] = 26.0; /* column 12, the middle of a chip at 4 */
    campaign.slant_range_m[1] = 52.0; /* column 64, the middle of a chip at 56 */
    swath.layout.rows = 60;
    swath.layout.columns = 90;
    swath.avoid = avoided;
    swath.avoid_count = 3;
    swath.jpeg_quality = quality;
    for (int i = 0; i < 60; i++)
        altitudes[i] = i < 40 ? 10.0 : 30.0; /* at 30 m the seabed begins at column 20 */
    assert_int_equal(campaign_measure(&report, &campaign, 0, &geometry, altitudes, true),
                     SONJECT_OK);
    for (int i = 0; i < 200; i++)
        for (int j = 0; j < 200; j++) {
            uint64_t row, column;
            crop_sample(&swath.room, (i + 0.5) / 200, (j + 0.5) / 200, &row, &column);
            assert_true(row < 60 && column < 90);
            hits[row][column]++;
        }
    for (uint64_t row = 0; row < 60; row++)
        for (uint64_t column = 0; column < 90; column++) {
            bool is_free = row >= 1 && row + 16 < 60 && column >= 4 && column <= 56;
            is_free = is_free && (row + 16 <= 40 || column > 20);
            for (int i = 0; i < 3; i++)
                is_free = is_free && is_clear(&campaign, &boxes[i], row, column);
            if (quality > 0)
                assert_true(hits[row][column] == 0 || (is_free && row % 8 == 0 && column % 8 == 0));
            else
                assert_int_equal(hits[row][column] > 0, is_free);
            places += is_free;
        }
    assert_true(quality > 0 || swath.room.places == places);
    crop_places_clear(&swath.room);
}

TEST(test_images_lie_wherever_edges_contacts_ranges_and_altitudes_let_them)
{
    check_places(0);
}

TEST(test_images_of_a_jpeg_lie_at_its_blocks_within_these)
{
    check_places(75);
}

TEST_PROGRAM(NULL, NULL)
