#include "shadow_edge.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>

/* The argument at which a normal distribution reaches a probability, by bisection. */
static double normal_argument(double probability)
{
    double low = -6.0;
    double high = 6.0;
    for (int i = 0; i < 50; i++) {
        const double middle = 0.5 * (low + high);
        if (0.5 * erfc(-middle / sqrt(2.0)) < probability)
            low = middle;
        else
            high = middle;
    }
    return low;
}

double shadow_edge(const double *visibilities, size_t first, size_t last)
{
    const bool starts_above = visibilities[first] > 0.5;
    for (size_t i = first; i < last; i++)
        if ((visibilities[i + 1] > 0.5) != starts_above) {
            const double a = normal_argument(visibilities[i]);
            const double b = normal_argument(visibilities[i + 1]);
            return (double)i - a / (b - a);
        }
    fail_msg("no crossing of 0.5 between %zu and %zu", first, last);
    return 0.0;
}
