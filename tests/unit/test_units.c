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

/* All units but degrees and decibels are powers of ten, so these are exact comparisons. Angles are
 * radians; blanks do not matter; infinity is only where it is written. */
TEST(test_every_unit)
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
TEST(test_levels_are_energy_ratios)
{
    assert_true(value_of(QUANTITY_LEVEL, "0 dB") == 1.0);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "-27 dB") / 0.001995262314968879602 - 1.0) < 1e-15);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "-10 dB") / 0.1 - 1.0) < 1e-15);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "3 dB") / 1.995262314968879602 - 1.0) < 1e-15);
}

TEST_PROGRAM(NULL, NULL)
