/* Quantities with units. */
#include "base/units.h"
#include "claims.h"

static double value_of(enum quantity quantity, const char *text)
{
    char problem[200] = "";
    double value = NAN;
    if (!quantity_from_text(quantity, text, &value, problem, sizeof problem))
        fail_msg("'%s': %s", text, problem);
    return value;
}

static void expect_problem(enum quantity quantity, const char *text, const char *part)
{
    char problem[200] = "";
    double value = 7.0;
    if (quantity_from_text(quantity, text, &value, problem, sizeof problem))
        fail_msg("'%s' was taken", text);
    assert_true(value == 7.0);
    if (!strstr(problem, part))
        fail_msg("'%s': the problem is '%s', without '%s'", text, problem, part);
}

/* All units but degrees and decibels are powers of ten, so these are exact comparisons. Angles are
 * radians; blanks do not matter; infinity is only where it is written. */
static void test_every_unit(void **state)
{
    static const struct {
        enum quantity quantity;
        const char *text;
        double value;
    } cases[] = {{QUANTITY_NUMBER, "0.25", 0.25},
                 {QUANTITY_LENGTH, "12.5", 12.5},
                 {QUANTITY_LENGTH, "12.5 m", 12.5},
                 {QUANTITY_LENGTH, "1.2 km", 1200.0},
                 {QUANTITY_LENGTH, "2.5 cm", 0.025},
                 {QUANTITY_LENGTH, "6.7cm", 0.067},
                 {QUANTITY_LENGTH, "0.4 mm", 0.0004},
                 {QUANTITY_LENGTH, "-3 cm", -0.03},
                 {QUANTITY_FREQUENCY, "455e3", 455000.0},
                 {QUANTITY_FREQUENCY, "10 Hz", 10.0},
                 {QUANTITY_FREQUENCY, "100 kHz", 100000.0},
                 {QUANTITY_FREQUENCY, "1.8 MHz", 1800000.0},
                 {QUANTITY_SPEED, "1500", 1500.0},
                 {QUANTITY_SPEED, "1480.5 m/s", 1480.5},
                 {QUANTITY_SPEED, "1.5 km/s", 1500.0},
                 {QUANTITY_DECIBEL, "-40", -40.0},
                 {QUANTITY_DECIBEL, "-40 dB", -40.0},
                 {QUANTITY_LEVEL, "0.002", 0.002},
                 {QUANTITY_ABSORPTION, "0.03", 0.03},
                 {QUANTITY_ABSORPTION, "0.03 dB/m", 0.03},
                 {QUANTITY_ABSORPTION, "34 dB/km", 0.034},
                 {QUANTITY_TEMPERATURE, "12.5", 12.5},
                 {QUANTITY_TEMPERATURE, "-1 C", -1.0},
                 {QUANTITY_DENSITY, "1025", 1025.0},
                 {QUANTITY_DENSITY, "1025 kg/m3", 1025.0},
                 {QUANTITY_DENSITY, "1.025 g/cm3", 1025.0},
                 {QUANTITY_TIME, "0.25", 0.25},
                 {QUANTITY_TIME, "12.5 ms", 0.0125},
                 {QUANTITY_TIME, "3 us", 3e-6},
                 {QUANTITY_ANGLE, "180", PI},
                 {QUANTITY_ANGLE, "90 deg", 0.5 * PI},
                 {QUANTITY_ANGLE, "-45 deg", -0.25 * PI},
                 {QUANTITY_ANGLE, "1.5 rad", 1.5},
                 {QUANTITY_LENGTH, " 2.5  cm ", 0.025},
                 {QUANTITY_LENGTH, "2.5\tcm", 0.025},
                 {QUANTITY_LENGTH, "2.5 ", 2.5},
                 {QUANTITY_NUMBER, "inf", HUGE_VAL},
                 {QUANTITY_NUMBER, "-.inf", -HUGE_VAL}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const double value = value_of(cases[i].quantity, cases[i].text);
        if (!(value == cases[i].value))
            fail_msg("'%s' gave %.17g, not %.17g", cases[i].text, value, cases[i].value);
    }
}

/* 1e-15 relative: pow is not bound to round correctly. */
static void test_levels_are_energy_ratios(void **state)
{
    assert_true(value_of(QUANTITY_LEVEL, "0 dB") == 1.0);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "-27 dB") / 0.001995262314968879602 - 1.0) < 1e-15);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "-10 dB") / 0.1 - 1.0) < 1e-15);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "3 dB") / 1.995262314968879602 - 1.0) < 1e-15);
}

static void test_problems(void **state)
{
    expect_problem(QUANTITY_LENGTH, "3 kg", "unit 'kg' is not one of m, km, cm, mm");
    expect_problem(QUANTITY_LENGTH, "3 M", "unit 'M'");
    expect_problem(QUANTITY_LENGTH, "3 m 4 cm", "unit 'm 4 cm'");
    expect_problem(QUANTITY_LENGTH, "1,5 m", "unit ',5 m'");
    expect_problem(QUANTITY_FREQUENCY, "100 khz", "unit 'khz' is not one of Hz, kHz, MHz");
    expect_problem(QUANTITY_ANGLE, "30 degrees", "not one of deg, rad");
    expect_problem(QUANTITY_DECIBEL, "3 db", "unit 'db'");
    expect_problem(QUANTITY_SPEED, "3 knots", "m/s, km/s");
    expect_problem(QUANTITY_ABSORPTION, "3 dB", "unit 'dB' is not one of dB/m, dB/km");
    expect_problem(QUANTITY_TEMPERATURE, "285 K", "unit 'K' is not one of C");
    expect_problem(QUANTITY_DENSITY, "3 kg", "unit 'kg' is not one of kg/m3, g/cm3");
    expect_problem(QUANTITY_NUMBER, "3 m", "'m' follows the number");
    expect_problem(QUANTITY_NUMBER, "", "'' is not a number");
    expect_problem(QUANTITY_LENGTH, "nan", "'nan' is not a number with a unit of m");
    expect_problem(QUANTITY_LENGTH, "deep", "'deep' is not a number");
    expect_problem(QUANTITY_LENGTH, "0x10", "unit 'x10'");
    expect_problem(QUANTITY_NUMBER, "1e999", "too large");
    expect_problem(QUANTITY_FREQUENCY, "1e305 MHz", "too large");
    expect_problem(QUANTITY_LEVEL, "4000 dB", "too large");
}

static void test_a_long_unit_is_cut_in_the_message(void **state)
{
    char text[5000];
    memset(text, 'k', sizeof text);
    text[0] = '1';
    text[sizeof text - 1] = 0;
    expect_problem(QUANTITY_LENGTH, text, "kkk...' is not one of");
    text[0] = 'k';
    expect_problem(QUANTITY_NUMBER, text, "kkk...' is not a number");
}

TEST_PROGRAM(NULL, NULL, TEST(test_every_unit), TEST(test_levels_are_energy_ratios),
             TEST(test_problems), TEST(test_a_long_unit_is_cut_in_the_message))
