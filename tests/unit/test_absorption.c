/* Tests the absorption of sea water. */
#include "claims.h"

#include <sonject/scene.h>

struct water {
    double temperature, salinity, depth, ph;
};

static const double frequencies[] = {200.0, 1e3, 3e3, 10e3, 30e3, 100e3, 200e3, 400e3, 1e6};

static double absorption(double frequency, struct water water)
{
    return sonject_absorption(frequency, water.temperature, water.salinity, water.depth, water.ph);
}

static void expect_near(double frequency, struct water water, double expected, double tolerance)
{
    const double value = absorption(frequency, water);
    if (!(fabs(value - expected) <= tolerance * expected))
        fail_msg("%g Hz, %g C, %g, %g m, pH %g: %.15g dB/m, not %.15g", frequency,
                 water.temperature, water.salinity, water.depth, water.ph, value, expected);
}

/* Every handbook has about 1, 34 and 100 dB/km, in one or two digits. */
TEST(test_well_known_values)
{
    const struct water sea = {10.0, 35.0, 0.0, 8.0};
    expect_near(10e3, sea, 1.0e-3, 0.05);
    expect_near(100e3, sea, 34e-3, 0.02);
    expect_near(400e3, sea, 100e-3, 0.05);
}

/* Returns Ainslie and McColm's simplification (J. Acoust. Soc. Am. 103, 1998, 1671), dB/m. Its
 * authors state that it is within 10 % of Francois and Garrison's formula where one of temperature,
 * salinity, depth and pH departs from 10 C, 35, 0 m, 8. */
static double simplified(double frequency_hz, struct water water)
{
    const double f = frequency_hz / 1e3, square = f * f;
    const double depth_km = water.depth / 1e3;
    const double boric = 0.78 * sqrt(water.salinity / 35.0) * exp(water.temperature / 26.0);
    const double magnesium = 42.0 * exp(water.temperature / 17.0);
    const double of_boric =
        0.106 * boric * square / (square + boric * boric) * exp((water.ph - 8.0) / 0.56);
    const double of_magnesium = 0.52 * (1.0 + water.temperature / 43.0) * water.salinity / 35.0 *
                                magnesium * square / (square + magnesium * magnesium) *
                                exp(-depth_km / 6.0);
    const double of_water = 0.00049 * square * exp(-(water.temperature / 27.0 + depth_km / 17.0));
    return (of_boric + of_magnesium + of_water) / 1e3;
}

TEST(test_within_ten_percent_of_the_simplified_formula)
{
    static const struct water waters[] = {
        {10, 35, 0, 8},    {-2, 35, 0, 8},    {0, 35, 0, 8},     {5, 35, 0, 8},
        {15, 35, 0, 8},    {20, 35, 0, 8},    {25, 35, 0, 8},    {30, 35, 0, 8},
        {10, 5, 0, 8},     {10, 15, 0, 8},    {10, 25, 0, 8},    {10, 40, 0, 8},
        {10, 35, 1000, 8}, {10, 35, 2000, 8}, {10, 35, 3500, 8}, {10, 35, 5000, 8},
        {10, 35, 0, 7.7},  {10, 35, 0, 8.3},
    };
    for (size_t i = 0; i < COUNT(waters); i++)
        for (size_t j = 0; j < COUNT(frequencies); j++)
            expect_near(frequencies[j], waters[i], simplified(frequencies[j], waters[i]), 0.1);
}

/* Returns the papers' formula once more, in Hz and seconds. A relaxation absorbs most per
 * wavelength at f_r, half its strength A f_r per cycle, and alpha = A f_r / (1 + (f_r / f)^2). */
static double in_hertz(double frequency, struct water water)
{
    const double t = water.temperature, s = water.salinity, d = water.depth;
    const double kelvin = t + 273.0;
    const double c = 1412.0 + 3.21 * t + 1.19 * s + 0.0167 * d;
    const double boric_hz = 2.8e7 * sqrt(s / 35.0) * exp(-1245.0 * log(10.0) / kelvin);
    const double magnesium_hz = 8.17e11 * exp(-1990.0 * log(10.0) / kelvin) / (0.937 + 0.0018 * s);
    const double boric = 8.86e-11 / c * exp(0.78 * water.ph * log(10.0));
    const double magnesium = 21.44e-6 * s * (1.0 + t / 40.0) / c;
    const double at_pressure = 1.0 - 0.137 * d / 1e3 + 0.0062 * d * d / 1e6;
    const double warm = 3.964e-4 - 1.146e-5 * t + 1.45e-7 * pow(t, 2.0) - 6.5e-10 * pow(t, 3.0);
    const double cold = 4.937e-4 - 2.590e-5 * t + 9.11e-7 * pow(t, 2.0) - 1.5e-8 * pow(t, 3.0);
    const double viscous = (t > 20.0 ? warm : cold) * 1e-9;
    const double of_water = viscous * (1.0 - 0.0383 * d / 1e3 + 4.9e-4 * d * d / 1e6);
    return boric * boric_hz / (1.0 + pow(boric_hz / frequency, 2.0)) +
           magnesium * at_pressure * magnesium_hz / (1.0 + pow(magnesium_hz / frequency, 2.0)) +
           of_water * frequency * frequency;
}

/* Tolerance 1e-12: some hundred roundings of 1e-16, also by exponentials of arguments up to 20. */
TEST(test_the_papers_formula)
{
    static const double temperatures[] = {-2.0, 4.0, 13.0, 20.0, 20.5, 30.0};
    static const double salinities[] = {0.0, 8.0, 35.0, 40.0};
    static const double depths[] = {0.0, 20.0, 1500.0, 5000.0};
    static const double acidities[] = {7.0, 7.7, 8.0, 9.0};
    for (size_t i = 0; i < COUNT(frequencies); i++)
        for (size_t t = 0; t < COUNT(temperatures); t++)
            for (size_t s = 0; s < COUNT(salinities); s++)
                for (size_t d = 0; d < COUNT(depths); d++)
                    for (size_t p = 0; p < COUNT(acidities); p++) {
                        const struct water water = {temperatures[t], salinities[s], depths[d],
                                                    acidities[p]};
                        expect_near(frequencies[i], water, in_hertz(frequencies[i], water), 1e-12);
                    }
}

/* The papers' two polynomials of pure water meet at 20 C to 0.1 %. */
TEST(test_no_step_at_20_degrees)
{
    const struct water cold = {20.0, 0.0, 0.0, 8.0}, warm = {nextafter(20.0, 30.0), 0.0, 0.0, 8.0};
    for (size_t i = 0; i < COUNT(frequencies); i++)
        expect_near(frequencies[i], cold, absorption(frequencies[i], warm), 1e-3);
}

TEST(test_nan_outside)
{
    static const double least[5] = {200.0, -2.0, 0.0, 0.0, 7.0};
    static const double most[5] = {1e6, 30.0, 40.0, 5000.0, 9.0};
    for (int i = 0; i < 5; i++) {
        double v[5] = {100e3, 10.0, 35.0, 20.0, 8.0};
        const double wrong[] = {nextafter(least[i], -1e9), nextafter(most[i], 1e9), NAN, HUGE_VAL,
                                -HUGE_VAL};
        v[i] = least[i];
        assert_true(sonject_absorption(v[0], v[1], v[2], v[3], v[4]) > 0.0);
        v[i] = most[i];
        assert_true(sonject_absorption(v[0], v[1], v[2], v[3], v[4]) > 0.0);
        for (size_t j = 0; j < COUNT(wrong); j++) {
            v[i] = wrong[j];
            assert_true(isnan(sonject_absorption(v[0], v[1], v[2], v[3], v[4])));
        }
    }
}

TEST_PROGRAM(NULL, NULL)
