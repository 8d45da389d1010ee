/* The law of the logarithm of speckle's intensity: averaged looks, on texture (K distribution). */
#ifndef SONJECT_MEASURE_SPECKLE_LAW_H
#define SONJECT_MEASURE_SPECKLE_LAW_H

#define LAW_STEP   0.02
#define LAW_LEAST  (-16.0)
#define LAW_POINTS 1101

/* The law of log intensity over its mean: the share below each point, and density x LAW_STEP. */
struct speckle_law {
    double below[LAW_POINTS];
    double density[LAW_POINTS];
};

/* looks: above 0. texture: 1 / shape of the K distribution, 0: none. */
void speckle_law_init(struct speckle_law *law, double looks, double texture);

/* Returns the share below x. *density gets its derivative. */
double speckle_law_below(const struct speckle_law *law, double x, double *density);

/* Returns the value below which a share lies. */
double speckle_law_quantile(const struct speckle_law *law, double share);

/* Returns the variance of the logarithm of a gamma variable of a shape: trigamma(shape). */
double log_gamma_variance(double shape);

#endif
