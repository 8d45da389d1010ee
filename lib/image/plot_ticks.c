#include "image/plot_ticks.h"

#include <math.h>

#define LARGEST_EXPONENT 12
#define LARGEST_NUMBER   1e6  /* ticks from 0: more digits than anyone reads */
#define SLACK            1e-9 /* of a step, so that an end that is a tick counts as one */

static double power_of_ten(int exponent)
{
    double power = 1.0;
    for (int i = 0; i < exponent; i++)
        power *= 10.0;
    return power;
}

static double step_of(const struct plot_ticks *ticks)
{
    return ticks->exponent < 0 ? ticks->multiple / power_of_ten(-ticks->exponent)
                               : ticks->multiple * power_of_ten(ticks->exponent);
}

/* The next larger step: 1, 2, 5, 10, ... */
static void widen(struct plot_ticks *ticks)
{
    if (ticks->multiple == 1) {
        ticks->multiple = 2;
    } else if (ticks->multiple == 2) {
        ticks->multiple = 5;
    } else {
        ticks->multiple = 1;
        ticks->exponent++;
    }
}

struct plot_ticks plot_ticks_between(double low, double high, double most)
{
    const struct plot_ticks none = {0, -1, 1, 0};
    struct plot_ticks ticks = {0, -1, 1, -LARGEST_EXPONENT};
    if (!(isfinite(low) && isfinite(high) && high - low >= step_of(&ticks) && most >= 1.0))
        return none;
    while (ticks.exponent <= LARGEST_EXPONENT && step_of(&ticks) * (most + SLACK) < high - low)
        widen(&ticks);
    const double first = ceil(low / step_of(&ticks) - SLACK);
    const double last = floor(high / step_of(&ticks) + SLACK);
    if (ticks.exponent > LARGEST_EXPONENT || fabs(first) > LARGEST_NUMBER ||
        fabs(last) > LARGEST_NUMBER)
        return none;
    ticks.first = (int64_t)first;
    ticks.last = (int64_t)last;
    return ticks;
}

double plot_tick_value(const struct plot_ticks *ticks, int64_t number)
{
    return (double)number * step_of(ticks);
}

const char *plot_tick_label(const struct plot_ticks *ticks, int64_t number,
                            char label[TICK_LABEL_CAPACITY])
{
    /* written backwards from the end: at most 8 digits, 12 decimals or zeros, point and sign */
    char *at = label + TICK_LABEL_CAPACITY;
    uint64_t digits = (uint64_t)(number < 0 ? -number : number) * (uint64_t)ticks->multiple;
    *--at = '\0';
    for (int i = 0; number != 0 && i < ticks->exponent; i++)
        *--at = '0';
    for (int i = ticks->exponent; i < 0; i++, digits /= 10)
        *--at = (char)('0' + digits % 10);
    if (ticks->exponent < 0)
        *--at = '.';
    do {
        *--at = (char)('0' + digits % 10);
        digits /= 10;
    } while (digits > 0);
    if (number < 0)
        *--at = '-';
    return at;
}
