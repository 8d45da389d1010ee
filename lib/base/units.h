/* Quantities with units, such as "100 kHz", "2.5 cm", "30 deg", "-27 dB". */
#ifndef SONJECT_BASE_UNITS_H
#define SONJECT_BASE_UNITS_H

#include <stdbool.h>
#include <stddef.h>

#define DEGREES_PER_RADIAN 57.29577951308232

enum quantity {
    QUANTITY_NUMBER,      /* no unit allowed */
    QUANTITY_FRACTION,    /* bare numbers; % */
    QUANTITY_LENGTH,      /* m (bare numbers too); km, cm, mm */
    QUANTITY_FREQUENCY,   /* Hz (bare numbers too); kHz, MHz */
    QUANTITY_SPEED,       /* m/s (bare numbers too); km/s */
    QUANTITY_ANGLE,       /* radians out; deg (bare numbers too), rad */
    QUANTITY_DECIBEL,     /* dB (bare numbers too) */
    QUANTITY_LEVEL,       /* linear energy ratio out; "-27 dB" or a bare linear number */
    QUANTITY_ABSORPTION,  /* dB/m (bare numbers too); dB/km */
    QUANTITY_TEMPERATURE, /* degrees Celsius: C (bare numbers too) */
    QUANTITY_DENSITY,     /* kg/m3 (bare numbers too); g/cm3 */
    QUANTITY_TIME         /* s (bare numbers too); ms, us */
};

/* Parses the whole text. On success *value is in SI units as listed above. On failure returns false
 * and problem gets a clause such as "unit 'kg' is not one of m, km, cm, mm". */
bool quantity_from_text(enum quantity quantity, const char *text, double *value, char *problem,
                        size_t problem_capacity);

#endif
