/* Tests kernels/elementary.h against double precision, over each function's whole stated range. */
#include "claims.h"
#include "elementary.h"

#define POINTS 1000000

/* A generator of its own, so that the one under test in random.h plays no part. */
static uint64_t generator = 0x9e3779b97f4a7c15u;

static uint32_t random_word(void)
{
    return (uint32_t)(next_random(&generator) >> 32);
}

static double random_fraction(void)
{
    return (random_word() + 0.5) / 4294967296.0;
}

/* Returns a number of either sign, its magnitude spread evenly over octaves 2^low to 2^high. */
static float random_over_octaves(double low, double high)
{
    const double value = exp2(low + (high - low) * random_fraction());
    return (float)(random_word() & 1 ? -value : value);
}

TEST(test_nearest_integer)
{
    static const float edges[] = {0.0f, 0.25f,       0.49999997f, 0.50000006f,
                                  1.0f, 4194303.25f, 4194302.75f, 1048575.9f};
    for (size_t i = 0; i < COUNT(edges); i++) {
        assert_true(nearest_integer(edges[i]) == nearbyintf(edges[i]));
        assert_true(nearest_integer(-edges[i]) == nearbyintf(-edges[i]));
    }
    for (int i = 0; i < POINTS; i++) {
        const float value = random_over_octaves(-10.0, 21.99);
        assert_true(nearest_integer(value) == nearbyintf(value));
    }
}

/* The largest errors found. They are printed, and held to the bounds that elementary.h states. */
struct worst {
    double sine, cosine, sine_relative;
};

static void compare_sine(float cycles, struct worst *worst)
{
    float sine, cosine;
    sine_cosine_of_cycles(cycles, &sine, &cosine);
    const double turn = remainder((double)cycles, 1.0);
    const double error = fabs(sine - sin(2.0 * PI * turn));
    worst->sine = fmax(worst->sine, error);
    worst->cosine = fmax(worst->cosine, fabs(cosine - cos(2.0 * PI * turn)));
    if (fabs(turn) < 0.125 && fabs(turn) > 1e-36) /* below 1e-36, single precision loses digits */
        worst->sine_relative = fmax(worst->sine_relative, error / fabs(sin(2.0 * PI * turn)));
}

TEST(test_sine_and_cosine)
{
    struct worst worst = {0.0, 0.0, 0.0};
    for (int eighth = -64; eighth <= 64; eighth++) {
        const float edge = (float)eighth * 0.125f;
        compare_sine(edge, &worst);
        compare_sine(nextafterf(edge, 100.0f), &worst);
        compare_sine(nextafterf(edge, -100.0f), &worst);
    }
    compare_sine(4194303.5f, &worst);
    compare_sine(-4194303.5f, &worst);
    for (int i = 0; i < POINTS; i++) {
        compare_sine((float)(random_fraction() - 0.5), &worst);
        compare_sine(random_over_octaves(-60.0, 22.0 - 1e-6), &worst);
    }
    print_message("sine %.3g, cosine %.3g, sine relative %.3g\n", worst.sine, worst.cosine,
                  worst.sine_relative);
    assert_true(worst.sine < 1e-7);
    assert_true(worst.cosine < 1e-7);
    assert_true(worst.sine_relative < 1.3e-7);
    float sine, cosine;
    sine_cosine_of_cycles(0.0f, &sine, &cosine);
    assert_true(sine == 0.0f && cosine == 1.0f);
}

TEST(test_sinc)
{
    double worst = 0.0;
    assert_true(sinc_of_cycles(0.0f) == 1.0f);
    for (int i = 0; i < POINTS; i++) {
        const float cycles = random_over_octaves(-60.0, 22.0 - 1e-6);
        const double angle = 2.0 * PI * (double)cycles;
        const double expected = sin(2.0 * PI * remainder((double)cycles, 1.0)) / angle;
        worst = fmax(worst, fabs(sinc_of_cycles(cycles) - expected));
    }
    print_message("sinc %.3g\n", worst);
    assert_true(worst < 2e-7);
}

static void compare_exponential(float value, double *worst)
{
    const double expected = exp((double)value);
    *worst = fmax(*worst, fabs(exponential_of_negative(value) - expected) / expected);
}

TEST(test_exponential)
{
    double worst = 0.0;
    assert_true(exponential_of_negative(0.0f) == 1.0f);
    assert_true(exponential_of_negative(-80.00001f) == 0.0f);
    assert_true(exponential_of_negative(-1e30f) == 0.0f);
    assert_true(exponential_of_negative(-INFINITY) == 0.0f);
    compare_exponential(-80.0f, &worst);
    for (int half = 1; half < 230; half++) { /* edges at which the power of two changes */
        const float edge = (float)(-0.5 * half * log(2.0));
        compare_exponential(edge, &worst);
        compare_exponential(nextafterf(edge, 0.0f), &worst);
        compare_exponential(nextafterf(edge, -100.0f), &worst);
    }
    for (int i = 0; i < POINTS; i++) {
        compare_exponential((float)(-80.0 * random_fraction()), &worst);
        compare_exponential(-fabsf(random_over_octaves(-40.0, 6.3)), &worst);
    }
    print_message("exponential, relative %.3g\n", worst);
    assert_true(worst < 1.3e-7);
}

static void compare_logarithm(float value, double *worst)
{
    const double expected = log((double)value);
    const double allowed = 1e-7 + 1.25e-7 * fabs(expected);
    *worst = fmax(*worst, fabs(natural_logarithm(value) - expected) / allowed);
}

TEST(test_logarithm)
{
    double worst = 0.0;
    assert_true(natural_logarithm(1.0f) == 0.0f);
    compare_logarithm(1.17549435e-38f, &worst);
    compare_logarithm(3.4e38f, &worst);
    for (int power = -125; power < 127; power++) { /* edges at which the exponent is split off */
        const float edge = ldexpf(1.0f, power);
        const float root = ldexpf(1.41421356f, power);
        compare_logarithm(edge, &worst);
        compare_logarithm(nextafterf(edge, 0.0f), &worst);
        compare_logarithm(root, &worst);
        compare_logarithm(nextafterf(root, 3.4e38f), &worst);
    }
    for (int i = 0; i < POINTS; i++) {
        compare_logarithm(fabsf(random_over_octaves(-125.9, 127.9)), &worst);
        compare_logarithm((float)random_fraction(), &worst);
    }
    print_message("logarithm, of its bound %.3g\n", worst);
    assert_true(worst < 1.0);
}

TEST(test_cube_root)
{
    double worst = 0.0;
    for (int i = 0; i < POINTS; i++) {
        const float value = fabsf(random_over_octaves(-100.0, 99.0)); /* up to 6e29 */
        worst = fmax(worst, fabs(cube_root(value) / cbrt((double)value) - 1.0));
    }
    print_message("cube root, relative %.3g\n", worst);
    assert_true(worst < 3e-7);
}

TEST(test_smaller_larger_magnitude)
{
    for (int i = 0; i < 1000; i++) {
        const float a = random_over_octaves(-60.0, 60.0);
        const float b = random_over_octaves(-60.0, 60.0);
        assert_true(smaller(a, b) == fminf(a, b));
        assert_true(larger(a, b) == fmaxf(a, b));
        assert_true(magnitude(a) == fabsf(a));
    }
    assert_int_equal(signbit(magnitude(-0.0f)), 0);
}

TEST_PROGRAM(NULL, NULL)
