#include "measure/speckle_law.h"

#include <math.h>
#include <stddef.h>

#define TEXTURE_LEAST 1e-3
#define NODES         48 /* points of the texture's distribution on either side */
#define NODE_STEP     0.25
#define SERIES_LEAST  8.0 /* the series errs by less than 1e-9 from this shape on */

double log_gamma_variance(double shape)
{
    double sum = 0.0;
    for (; shape < SERIES_LEAST; shape += 1.0)
        sum += 1.0 / (shape * shape);
    const double r = 1.0 / shape, r2 = r * r;
    return sum + r + 0.5 * r2 + r * r2 * (1.0 / 6.0 - r2 * (1.0 / 30.0 - r2 / 42.0));
}

/* Returns the density of the logarithm of a gamma variable of mean 1, but for a factor. */
static double log_gamma_density(double shape, double x)
{
    return exp(shape * (x + 1.0 - exp(x)));
}

/* Convolves the density of the looks with the texture's, sampled at points some steps apart. */
static void spread_by_texture(double *density, double texture)
{
    double weights[2 * NODES + 1], plain[LAW_POINTS];
    const double shape = 1.0 / texture;
    const double deviation = sqrt(log_gamma_variance(shape));
    const int stride = (int)fmax(1.0, floor(NODE_STEP * deviation / LAW_STEP + 0.5));
    double sum = 0.0;
    for (int k = -NODES; k <= NODES; k++)
        sum += weights[k + NODES] = log_gamma_density(shape, k * stride * LAW_STEP);
    for (int i = 0; i < LAW_POINTS; i++) {
        plain[i] = density[i];
        density[i] = 0.0;
    }
    for (int k = -NODES; k <= NODES; k++) {
        const double weight = weights[k + NODES] / sum;
        const int shift = k * stride;
        const int first = shift > 0 ? shift : 0;
        const int end = shift < 0 ? LAW_POINTS + shift : LAW_POINTS;
        for (int i = first; weight > 1e-9 && i < end; i++)
            density[i] += weight * plain[i - shift];
    }
}

void speckle_law_init(struct speckle_law *law, double looks, double texture)
{
    double sum = 0.0;
    for (int i = 0; i < LAW_POINTS; i++)
        law->density[i] = log_gamma_density(looks, LAW_LEAST + i * LAW_STEP);
    if (texture > TEXTURE_LEAST)
        spread_by_texture(law->density, texture);
    for (int i = 0; i < LAW_POINTS; i++) {
        law->below[i] = sum + 0.5 * law->density[i];
        sum += law->density[i];
    }
    for (int i = 0; i < LAW_POINTS; i++) {
        law->below[i] /= sum;
        law->density[i] /= sum;
    }
}

double speckle_law_below(const struct speckle_law *law, double x, double *density)
{
    const double at = (x - LAW_LEAST) / LAW_STEP;
    *density = 0.0;
    if (!(at > 0.0))
        return 0.0;
    if (at >= LAW_POINTS - 1)
        return 1.0;
    const size_t i = (size_t)at;
    const double t = at - (double)i, s = 1.0 - t;
    const double low = law->below[i], high = law->below[i + 1];
    const double from = law->density[i], to = law->density[i + 1];
    *density =
        (6.0 * t * s * (high - low) + s * (s - 2.0 * t) * from + t * (t - 2.0 * s) * to) / LAW_STEP;
    return s * s * (1.0 + 2.0 * t) * low + t * t * (3.0 - 2.0 * t) * high + t * s * s * from -
           t * t * s * to;
}

double speckle_law_quantile(const struct speckle_law *law, double share)
{
    size_t low = 0, high = LAW_POINTS - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (law->below[middle] < share)
            low = middle;
        else
            high = middle;
    }
    const double step = law->below[high] - law->below[low];
    const double t = step > 0.0 ? (share - law->below[low]) / step : 0.0;
    return LAW_LEAST + LAW_STEP * ((double)low + t);
}
