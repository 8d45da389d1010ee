#include <math.h>
#include <stdbool.h>

#include "image/synthetic.h"

#define CONSTANT_SHAPE  1e6
#define HALF_STEPS      (TEXTURE_REACH * TEXTURE_STEPS_PER_UNIT)
#define DENSITY_STEPS   16384
#define LOWEST_EXPONENT -36.0 /* e^-36 = 2e-16 of the peak: the density ends there */

static const double factorials[] = {1,    1,     2,      6,       24,       120,       720,
                                    5040, 40320, 362880, 3628800, 39916800, 479001600, 6227020800};

/* Returns e^value for value < 700, to 1e-15. Uses + - * / alone, unlike the mathematics library. */
static double exponential(double value)
{
    if (value < -700.0)
        return 0.0;
    const double power = floor(value * 1.4426950408889634 + 0.5);
    /* ln 2 is in two parts. The first has few bits, so that the remainder keeps its digits. */
    const double rest = (value - power * 0.693145751953125) - power * 1.42860682030941723e-6;
    double sum = 0.0;
    for (int term = 13; term >= 0; term--)
        sum = sum * rest + 1.0 / factorials[term];
    return ldexp(sum, (int)power);
}

/* Returns the density of the logarithm y of a Gamma-distributed intensity, 1 at its peak y = 0. */
static double density(double shape, double y)
{
    return exponential(shape * (y + 1.0 - exponential(y)));
}

/* Returns where the density has fallen to e^LOWEST_EXPONENT, between its peak and `outer`. */
static double density_end(double shape, double outer)
{
    double inner = 0.0;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (inner + outer);
        if (shape * (middle + 1.0 - exponential(middle)) < LOWEST_EXPONENT)
            outer = middle;
        else
            inner = middle;
    }
    return outer;
}

/* Integrates over one step by Simpson's rule, with the densities at the ends. */
static double share_of_step(double shape, double y, double step, double at_start, double at_end)
{
    return fabs(step) / 6.0 * (at_start + 4.0 * density(shape, y + 0.5 * step) + at_end);
}

static double total_density(double shape, double start, double step)
{
    double total = 0.0;
    double at_start = density(shape, start);
    for (int n = 0; n < DENSITY_STEPS; n++) {
        const double at_end = density(shape, start + (n + 1) * step);
        total += share_of_step(shape, start + n * step, step, at_start, at_end);
        at_start = at_end;
    }
    return total;
}

/* Returns the fraction of a step at which the integral reaches amount, for a density that is linear
 * over the step. */
static double fraction_of_step(double amount, double step, double at_start, double at_end)
{
    const double rise = at_end - at_start;
    const double target = amount / fabs(step);
    const double root = sqrt(fmax(0.0, at_start * at_start + 2.0 * rise * target));
    const double sum = at_start + root;
    return sum > 0.0 ? fmin(fmax(2.0 * target / sum, 0.0), 1.0) : 0.0;
}

/* Fills tails[i], the probability that a standard normal deviate exceeds i /
 * TEXTURE_STEPS_PER_UNIT. */
static void normal_tails(double tails[HALF_STEPS + 1])
{
    const double step = 1.0 / TEXTURE_STEPS_PER_UNIT;
    const double scale = 0.39894228040143268 * step / 6.0;
    tails[HALF_STEPS] = 0.0;
    for (int i = HALF_STEPS - 1; i >= 0; i--) {
        const double low = i * step;
        const double middle = low + 0.5 * step;
        const double high = low + step;
        tails[i] = tails[i + 1] + scale * (exponential(-0.5 * low * low) +
                                           4.0 * exponential(-0.5 * middle * middle) +
                                           exponential(-0.5 * high * high));
    }
}

/* Fills one half of the table. Walks from the density's end towards the median and stops where the
 * probability passed equals that of a normal deviate, which keeps both tails exact. */
static void fill_half(struct speckle_texture *texture, const double *tails, double shape,
                      double total, double start, double step, bool is_upper)
{
    float *middle = texture->amplitude + HALF_STEPS;
    int i = HALF_STEPS;
    double passed = 0.0;
    double at_start = density(shape, start);
    for (int n = 0; n < DENSITY_STEPS && i >= 0; n++) {
        const double y = start + n * step;
        const double at_end = density(shape, y + step);
        const double share = share_of_step(shape, y, step, at_start, at_end);
        for (; i >= 0 && tails[i] * total <= passed + share; i--) {
            const double fraction =
                fraction_of_step(tails[i] * total - passed, step, at_start, at_end);
            middle[is_upper ? i : -i] = (float)exponential(0.5 * (y + fraction * step));
        }
        passed += share;
        at_start = at_end;
    }
}

void speckle_texture_init(struct speckle_texture *texture, double shape)
{
    for (int i = 0; i <= 2 * HALF_STEPS; i++)
        texture->amplitude[i] = 1.0f;
    if (!(shape < CONSTANT_SHAPE))
        return;
    double tails[HALF_STEPS + 1];
    normal_tails(tails);
    const double lowest = density_end(shape, LOWEST_EXPONENT / shape - 10.0);
    const double highest = density_end(shape, 40.0);
    const double step = (highest - lowest) / DENSITY_STEPS;
    const double total = total_density(shape, lowest, step);
    fill_half(texture, tails, shape, total, lowest, step, false);
    fill_half(texture, tails, shape, total, highest, -step, true);
}

float speckle_texture_amplitude(const struct speckle_texture *texture, float deviate)
{
    const float limit = (float)TEXTURE_REACH - 0.001f;
    const float inside = fminf(fmaxf(deviate, -limit), limit);
    const float position = (inside + (float)TEXTURE_REACH) * (float)TEXTURE_STEPS_PER_UNIT;
    const int index = (int)position;
    const float low = texture->amplitude[index];
    const float high = texture->amplitude[index + 1];
    return low + (position - (float)index) * (high - low);
}
