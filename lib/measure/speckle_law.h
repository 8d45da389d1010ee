/* How the logarithm of speckle's intensity is distributed: looks averaged, and texture under them
 * (the K distribution). */
#ifndef SONJECT_MEASURE_SPECKLE_LAW_H
#define SONJECT_MEASURE_SPECKLE_LAW_H

#define LAW_STEP   0.02
#define LAW_LEAST  (-16.0)
#define LAW_POINTS 1101

/* Of log intensity over its mean: the share below each point, and the density there times the step.
 */
struct speckle_law {
    double below[LAW_POINTS];
    double density[LAW_POINTS];
};

/* looks: above 0. texture: 1 / shape of the K distribution, 0: none. */
void speckle_law_init(struct speckle_law *law, double looks, double texture);

/* The share below x; *density gets its derivative. */
double speckle_law_below(const struct speckle_law *law, double x, double *density);

/* The value below which that share lies. */
double speckle_law_quantile(const struct speckle_law *law, double share);

/* Variance of the logarithm of a gamma variable of that shape, trigamma(shape). */
double log_gamma_variance(double shape);

#endif
