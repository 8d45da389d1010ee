#include "campaign/distribution.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

#define ROOT_HALF 0.70710678118654752440

/* Mass of the standard normal distribution between low and high. Tails are measured from their own
 * side, where they have their digits. */
static double mass_between(double low, double high)
{
    if (low > 0.0)
        return 0.5 * (erfc(low * ROOT_HALF) - erfc(high * ROOT_HALF));
    return 0.5 * (erfc(-high * ROOT_HALF) - erfc(-low * ROOT_HALF));
}

/* By bisection, to the last digits that are written. */
static double normal_quantile(double low, double high, double u)
{
    const double mass = u * mass_between(low, high);
    double below = low;
    double above = high;
    for (int i = 0; i < 100 && below < above; i++) {
        const double middle = 0.5 * (below + above);
        if (mass_between(low, middle) < mass)
            below = middle;
        else
            above = middle;
    }
    return 0.5 * (below + above);
}

double distribution_number(const struct distribution *distribution, double u)
{
    const double low = distribution->low;
    const double high = distribution->high;
    double number = low + u * (high - low);
    if (distribution->kind == DISTRIBUTION_LOG_UNIFORM)
        number = low * pow(high / low, u);
    if (distribution->kind == DISTRIBUTION_NORMAL)
        number = distribution->mean +
                 distribution->deviation *
                     normal_quantile((low - distribution->mean) / distribution->deviation,
                                     (high - distribution->mean) / distribution->deviation, u);
    return fmin(fmax(number, low), high);
}

/* Nine digits hide what the last bits of a machine's functions make of it. Rounded, a number may
 * lie beyond the limits by a billionth of it; then it is written in full. */
static const char *write_number(const struct distribution *distribution, double number,
                                char text[DISTRIBUTION_TEXT_CAPACITY])
{
    char digits[32];
    double read = number;
    const char *rest;
    text_of_number(digits, sizeof digits, number, 9);
    text_to_number(digits, &read, &rest);
    if (read < distribution->low || read > distribution->high)
        text_of_number(digits, sizeof digits, number, 17);
    snprintf(text, DISTRIBUTION_TEXT_CAPACITY, "%s%s", digits, distribution->unit);
    return text;
}

const char *distribution_value(const struct distribution *distribution, double u,
                               char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->kind == DISTRIBUTION_FIXED)
        return distribution->texts[0];
    if (distribution->kind != DISTRIBUTION_CHOICE)
        return write_number(distribution, distribution_number(distribution, u), text);
    size_t chosen = 0;
    while (chosen + 1 < distribution->count && u >= distribution->cumulative[chosen])
        chosen++;
    return distribution->texts[chosen];
}

uint32_t distribution_steps(const struct distribution *distribution)
{
    if (distribution->kind != DISTRIBUTION_CHOICE)
        return distribution->steps;
    for (size_t i = 0; i < distribution->count; i++)
        if (fabs(distribution->cumulative[i] - (double)(i + 1) / (double)distribution->count) >
            1e-12)
            return 0;
    return (uint32_t)distribution->count;
}

const char *distribution_step(const struct distribution *distribution, uint32_t step,
                              char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->kind == DISTRIBUTION_CHOICE)
        return distribution->texts[step];
    const double u =
        distribution->steps > 1 ? (double)step / (double)(distribution->steps - 1) : 0.5;
    return write_number(distribution, distribution_number(distribution, u), text);
}

void distribution_clear(struct distribution *distribution)
{
    for (size_t i = 0; distribution->texts && i < distribution->count; i++)
        free(distribution->texts[i]);
    free(distribution->texts);
    free(distribution->cumulative);
    free(distribution->key);
    memset(distribution, 0, sizeof *distribution);
}
