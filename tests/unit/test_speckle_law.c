/* Tests the law of speckle's logarithm against closed forms. */
#include "base/memory.h"
#include "claims.h"
#include "measure/first_return.h"
#include "measure/speckle_law.h"

static void moments_of(const struct speckle_law *law, double *mean, double *variance)
{
    *mean = *variance = 0.0;
    for (int i = 0; i < LAW_POINTS; i++)
        *mean += law->density[i] * (LAW_LEAST + i * LAW_STEP);
    for (int i = 0; i < LAW_POINTS; i++)
        *variance += law->density[i] * pow(LAW_LEAST + i * LAW_STEP - *mean, 2.0);
}

/* At whole numbers trigamma is pi^2 / 6 less the first squares' reciprocals. */
TEST(variance_of_a_logarithm_is_trigamma)
{
    double exact = PI * PI / 6.0;
    for (int looks = 1; looks <= 12; looks++) {
        assert_true(fabs(log_gamma_variance(looks) - exact) < 1e-8);
        exact -= 1.0 / (looks * looks);
    }
}

/* A K distribution's log intensity is the sum of two gamma variables' logarithms. Grid and cut ends
 * leave 1e-3 of the variance. */
TEST(texture_adds_its_variance)
{
    struct speckle_law law;
    double mean, variance;
    for (int looks = 1; looks <= 4; looks++)
        for (int k = 0; k < 4; k++) {
            const double shape = k == 0 ? INFINITY : 3.0 * k;
            const double exact =
                log_gamma_variance(looks) + (k == 0 ? 0.0 : log_gamma_variance(shape));
            speckle_law_init(&law, looks, 1.0 / shape);
            moments_of(&law, &mean, &variance);
            assert_true(fabs(variance - exact) < 3e-3 * exact);
        }
}

/* One look's intensity is exponential: the share below x times the mean is 1 - exp(-x). */
TEST(one_look_is_exponential)
{
    struct speckle_law law;
    double density;
    speckle_law_init(&law, 1.0, 0.0);
    for (double x = 0.01; x < 6.0; x *= 1.37) {
        assert_true(fabs(speckle_law_below(&law, log(x), &density) - (1.0 - exp(-x))) < 2e-5);
        assert_true(fabs(density - x * exp(-x)) < 2e-4);
        assert_true(fabs(speckle_law_quantile(&law, 1.0 - exp(-x)) - log(x)) < 1e-2);
    }
}

/* Finds the first returns of a waterfall of two sides, 60 rows high. The water reaches `first`
 * columns from the nadir, and one more in every second row. It is 20 dB under the seabed or, in
 * speckle, nearly black: grey levels linear in amplitude, which are 0 to 3 there. */
static void find_in_waterfall(int columns, int nadir, int first, bool has_speckle,
                              struct first_returns *returns)
{
    struct report report = {.host = NULL};
    uint64_t seed = 1;
    float *intensity = allocate_array(60, (size_t)columns * sizeof *intensity);
    for (int i = 0; i < 60 * columns; i++) {
        const bool is_water = abs(i % columns - nadir) < first + i / columns / 2;
        const double u = ((double)(next_random(&seed) >> 11) + 0.5) * 0x1p-53;
        const double grey = round((is_water ? 0.8 : 30.0) * sqrt(-log(u)));
        intensity[i] = has_speckle ? (float)(grey * grey) : is_water ? 0.01f : 1.0f;
    }
    EXPECT_OK(&report, first_returns_find(returns, &report, intensity, 60, (size_t)columns));
    assert_int_equal(returns->sides, WATER_BETWEEN);
    free(intensity);
}

TEST(a_nadir_lies_between_both_first_returns)
{
    struct first_returns returns;
    find_in_waterfall(400, 190, 60, false, &returns);
    assert_true(fabs(returns.nadir_column - 190) <= 0.5);
    for (int row = 3; row < 60 - 3; row++)
        assert_true(fabs(returns.columns[row] - (60 + row / 2) + 0.5) <= 1.0);
    const struct water_place water = {10, 190 + 30, 16, 16}, seabed = {10, 190 + 120, 16, 16};
    assert_true(first_returns_cover(&returns, &water, 400));
    assert_false(first_returns_cover(&returns, &seabed, 400));
    first_returns_clear(&returns);
}

TEST(a_nadir_is_found_where_the_water_is_nearly_black)
{
    struct first_returns returns;
    find_in_waterfall(1000, 480, 250, true, &returns);
    assert_true(fabs(returns.nadir_column - 480) <= 1.0);
    first_returns_clear(&returns);
}

TEST_PROGRAM(NULL, NULL)
