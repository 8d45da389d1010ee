/* The places where profiles of mean intensity end or step, amid speckle. A mean p over n
 * independent samples of speckle has the gamma distribution of shape n. Where m is expected, its
 * negative log likelihood is n (p/m - 1 - ln p/m), relative to that of m = p. Places are means over
 * the likelihood, with an even prior. */
#ifndef SONJECT_MEASURE_CONTACT_EDGES_H
#define SONJECT_MEASURE_CONTACT_EDGES_H

#include <stddef.h>

/* Mean intensities of successive pixels. */
struct profile {
    const double *means;
    const double *lobe_bias; /* the most that side lobes of bright pixels may add */
    size_t count;
    double samples;   /* independent samples in the mean of a pixel */
    double deviation; /* standard deviation of the response's energy, a Gaussian; pixels, > 0 */
};

/* Pixels from the centre of the first one, and the standard error from speckle alone. */
struct profile_edge {
    double place, error;
};

/* The levels expected before and behind an end; both > 0. */
struct end_levels {
    double lit;  /* least level before; LOBE_BIAS_RATIO times the side-lobe bias is added */
    double dark; /* most behind; side-lobe bias and the spread of the point response are added */
};

/* Returns where a profile that is lit at its first pixels becomes dark and stays dark. Lit pixels
 * may have any level above the least. */
struct profile_edge find_profile_end(const struct profile *profile,
                                     const struct end_levels *levels);

/* Sums over places, each weighted with its likelihood over the largest likelihood. */
struct edge_belief {
    double least; /* least negative log likelihood */
    double weight, sum, squares;
};

#define STEP_WIDTHS 7 /* widths of penumbras that are tried */

struct edge_posterior {
    struct edge_belief widths[STEP_WIDTHS];
};

/* The levels expected about a step from one level to another, both > 0, over deviations from the
 * step. REACH deviations on either side are tabulated. */
#define STEP_ENTRIES 1536
struct step_levels {
    double inverse_behind, log_behind;
    double inverse[STEP_ENTRIES + 1], logarithm[STEP_ENTRIES + 1];
};
void step_levels_init(struct step_levels *levels, double before, double behind);

/* Weighs the places where a profile steps: the middle of a penumbra of any width. Several profiles
 * through one edge, such as those along different slants, may be weighed one after the other.
 * belief is all zeros at first. */
void weigh_profile_step(struct edge_posterior *belief, const struct profile *profile,
                        const struct step_levels *levels);

/* Returns the mean place of the parts of one edge. The penumbra is equally wide in all parts, so
 * its width, and with it how far out the parts lie, is weighed for all together. */
struct profile_edge mean_step_believed(const struct edge_posterior *parts, size_t count);

/* Returns where a first part of a profile ends that is brighter than the rest. Each has one level.
 * lobe_bias is relative to that level. *gain gets the logarithm of the likelihood over that of one
 * level for all; 0: no first part is brighter. */
struct profile_edge find_profile_change(const struct profile *profile, double *gain);

#endif
