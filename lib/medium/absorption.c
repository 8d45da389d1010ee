/* Francois and Garrison's formula (J. Acoust. Soc. Am. 72, 1982: part I, page 896, pure water and
 * magnesium sulphate; part II, page 1879, boric acid and the total). Frequencies in kHz and
 * absorption in dB/km, as the papers have them. */
#include "medium/absorption.h"

#include <math.h>

#include "base/ranges.h"

#define KELVIN_AT_0_CELSIUS 273.0 /* the papers' own, without the 0.15 */

sonject_status check_sea_water(const struct sea_water *water, struct report *report,
                               struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_within(&check, "temperature", water->temperature_celsius, -2.0, 30.0, " C");
    check_within(&check, "salinity", water->salinity_permille, 0.0, 40.0, " per mille");
    check_within(&check, "depth", water->depth_m, 0.0, 5000.0, " m");
    check_within(&check, "ph", water->ph, 7.0, 9.0, "");
    return check.status;
}

/* Of a substance that needs time to follow the pressure, for unit strength. */
static double relaxation(double frequency, double relaxation_frequency)
{
    const double square = frequency * frequency;
    return relaxation_frequency * square / (relaxation_frequency * relaxation_frequency + square);
}

static double sound_speed(const struct sea_water *water)
{
    return 1412.0 + 3.21 * water->temperature_celsius + 1.19 * water->salinity_permille +
           0.0167 * water->depth_m;
}

static double boric_acid(const struct sea_water *water, double frequency)
{
    const double kelvin = KELVIN_AT_0_CELSIUS + water->temperature_celsius;
    const double strength = 8.86 / sound_speed(water) * pow(10.0, 0.78 * water->ph - 5.0);
    const double relaxation_frequency =
        2.8 * sqrt(water->salinity_permille / 35.0) * pow(10.0, 4.0 - 1245.0 / kelvin);
    return strength * relaxation(frequency, relaxation_frequency);
}

static double magnesium_sulphate(const struct sea_water *water, double frequency)
{
    const double kelvin = KELVIN_AT_0_CELSIUS + water->temperature_celsius;
    const double strength = 21.44 * water->salinity_permille / sound_speed(water) *
                            (1.0 + 0.025 * water->temperature_celsius);
    const double pressure = 1.0 + water->depth_m * (-1.37e-4 + water->depth_m * 6.2e-9);
    const double relaxation_frequency = 8.17 * pow(10.0, 8.0 - 1990.0 / kelvin) /
                                        (1.0 + 0.0018 * (water->salinity_permille - 35.0));
    return strength * pressure * relaxation(frequency, relaxation_frequency);
}

static double pure_water(const struct sea_water *water, double frequency)
{
    const double t = water->temperature_celsius;
    const double strength = t <= 20.0 ? 4.937e-4 + t * (-2.59e-5 + t * (9.11e-7 - t * 1.50e-8))
                                      : 3.964e-4 + t * (-1.146e-5 + t * (1.45e-7 - t * 6.5e-10));
    const double pressure = 1.0 + water->depth_m * (-3.83e-5 + water->depth_m * 4.9e-10);
    return strength * pressure * frequency * frequency;
}

double sonject_absorption(double frequency_hz, double temperature_celsius, double salinity_permille,
                          double depth_m, double ph)
{
    const struct sea_water water = {temperature_celsius, salinity_permille, depth_m, ph};
    struct report report = {{0}, NULL, NULL};
    const double frequency = frequency_hz / 1e3;
    if (!(frequency_hz >= ABSORPTION_FREQUENCY_MIN_HZ &&
          frequency_hz <= ABSORPTION_FREQUENCY_MAX_HZ) ||
        check_sea_water(&water, &report, NULL) != SONJECT_OK)
        return NAN;
    return (boric_acid(&water, frequency) + magnesium_sulphate(&water, frequency) +
            pure_water(&water, frequency)) /
           1e3;
}
