#include "base/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

#define PI 3.14159265358979323846

#define UNITS_MAX 4

struct unit {
    const char *name;
    int power_of_ten; /* relative to the quantity's first unit */
};

struct units {
    const char *names; /* for messages; NULL: none allowed */
    struct unit unit[UNITS_MAX];
};

static const struct units units_of[] = {
    [QUANTITY_NUMBER] = {NULL, {{NULL, 0}}},
    [QUANTITY_FRACTION] = {"%", {{"%", -2}}},
    [QUANTITY_LENGTH] = {"m, km, cm, mm", {{"m", 0}, {"km", 3}, {"cm", -2}, {"mm", -3}}},
    [QUANTITY_FREQUENCY] = {"Hz, kHz, MHz", {{"Hz", 0}, {"kHz", 3}, {"MHz", 6}}},
    [QUANTITY_SPEED] = {"m/s, km/s", {{"m/s", 0}, {"km/s", 3}}},
    [QUANTITY_ANGLE] = {"deg, rad", {{"deg", 0}, {"rad", 0}}},
    [QUANTITY_DECIBEL] = {"dB", {{"dB", 0}}},
    [QUANTITY_LEVEL] = {"dB", {{"dB", 0}}},
    [QUANTITY_ABSORPTION] = {"dB/m, dB/km", {{"dB/m", 0}, {"dB/km", -3}}},
    [QUANTITY_TEMPERATURE] = {"C", {{"C", 0}}},
    [QUANTITY_DENSITY] = {"kg/m3, g/cm3", {{"kg/m3", 0}, {"g/cm3", 3}}},
    [QUANTITY_TIME] = {"s, ms, us", {{"s", 0}, {"ms", -3}, {"us", -6}}},
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static const struct unit *find_unit(const struct units *units, const char *text, size_t length)
{
    for (int i = 0; i < UNITS_MAX && units->unit[i].name; i++)
        if (strlen(units->unit[i].name) == length && !memcmp(units->unit[i].name, text, length))
            return &units->unit[i];
    return NULL;
}

static bool unknown_unit(const struct units *units, const char *unit, char *problem,
                         size_t problem_capacity)
{
    char excerpt[40];
    text_excerpt(excerpt, sizeof excerpt, unit);
    if (!units->names)
        snprintf(problem, problem_capacity, "'%s' follows the number, but this has no unit",
                 excerpt);
    else
        snprintf(problem, problem_capacity, "unit '%s' is not one of %s", excerpt, units->names);
    return false;
}

/* Converts a number to SI after its power of ten. unit: one of the quantity's, or NULL. */
static double to_si(enum quantity quantity, const struct unit *unit, double number)
{
    if (quantity == QUANTITY_ANGLE && !(unit && strcmp(unit->name, "rad") == 0))
        return number / 180.0 * PI;
    if (quantity == QUANTITY_LEVEL && unit)
        return pow(10.0, number / 10.0);
    return number;
}

bool quantity_from_text(enum quantity quantity, const char *text, double *value, char *problem,
                        size_t problem_capacity)
{
    const struct units *units = &units_of[quantity];
    const char *rest;
    char excerpt[40];
    double number;
    while (is_blank(*text))
        text++;
    if (!text_to_number(text, &number, &rest)) {
        snprintf(problem, problem_capacity, "'%s' is not a number%s%s",
                 text_excerpt(excerpt, sizeof excerpt, text),
                 units->names ? " with a unit of " : "", units->names ? units->names : "");
        return false;
    }
    const bool is_infinite = isinf(number) && !strchr("0123456789", rest[-1]) && rest[-1] != '.';
    while (is_blank(*rest))
        rest++;
    size_t length = strlen(rest);
    while (length > 0 && is_blank(rest[length - 1]))
        length--;
    const struct unit *unit = NULL;
    if (length > 0) {
        unit = find_unit(units, rest, length);
        if (!unit)
            return unknown_unit(units, rest, problem, problem_capacity);
        text_to_shifted_number(text, unit->power_of_ten, &number, &rest);
    }
    const double result = to_si(quantity, unit, number);
    if (isinf(result) && !is_infinite) {
        snprintf(problem, problem_capacity, "'%s' is too large",
                 text_excerpt(excerpt, sizeof excerpt, text));
        return false;
    }
    *value = result;
    return true;
}
