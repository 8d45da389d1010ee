/* Tests quantities with units. */
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

/* These cases are not in scene_keys.h, whose values have all other units, to the last bit. Blanks
 * do not matter, and angles are radians. Infinity comes only where it is written. */
TEST(test_units_and_blanks)
{
    static const struct {
        enum quantity quantity;
        const char *text;
        double value;
    } cases[] = {{QUANTITY_NUMBER, "0.25", 0.25},
                 {QUANTITY_LENGTH, "12.5", 12.5},
                 {QUANTITY_LENGTH, "6.7cm", 0.067},
                 {QUANTITY_FREQUENCY, "455e3", 455000.0},
                 {QUANTITY_LEVEL, "0.002", 0.002},
                 {QUANTITY_ABSORPTION, "34 dB/km", 0.034},
                 {QUANTITY_DENSITY, "1025 kg/m3", 1025.0},
                 {QUANTITY_TIME, "3 us", 3e-6},
                 {QUANTITY_ANGLE, "180", PI},
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

/* Tolerance 1e-15, relative: pow is not bound to round correctly. */
TEST(test_levels_are_energy_ratios)
{
    assert_true(value_of(QUANTITY_LEVEL, "0 dB") == 1.0);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "-27 dB") / 0.001995262314968879602 - 1.0) < 1e-15);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "-10 dB") / 0.1 - 1.0) < 1e-15);
    assert_true(fabs(value_of(QUANTITY_LEVEL, "3 dB") / 1.995262314968879602 - 1.0) < 1e-15);
}

TEST_PROGRAM(NULL, NULL)
