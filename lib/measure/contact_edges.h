/* Where profiles of mean intensity end or step, amid speckle. A mean over n independent samples of
 * speckle has the gamma distribution of shape n: where m is expected, a mean p has the negative log
 * likelihood n (p/m - 1 - ln p/m), over that of m = p. Places are means over that likelihood, all
 * places alike likely before. */
#ifndef SONJECT_MEASURE_CONTACT_EDGES_H
#define SONJECT_MEASURE_CONTACT_EDGES_H

#include <stddef.h>

/* Mean intensities of pixels one after the other. */
struct profile {
    const double *means;
    const double *lobe_bias; /* what side lobes of what is bright may add, at most */
    size_t count;
    double samples;   /* independent ones, a pixel */
    double deviation; /* of the point response's energy, taken for Gaussian; pixels, > 0 */
};

/* In pixels from the first one's centre; the error is standard, and of speckle alone. */
struct profile_edge {
    double place, error;
};

/* What is expected on either side of an end; both > 0. */
struct end_levels {
    double lit;  /* at least that before it, and LOBE_BIAS_RATIO times the side-lobe bias */
    double dark; /* at most that and the side-lobe bias behind it, beside what the point response
                    spreads there */
};

/* Where a profile that is lit at its first pixels becomes dark, and stays so: what is lit may have
 * any levels. */
struct profile_edge find_profile_end(const struct profile *profile,
                                     const struct end_levels *levels);

/* Sums over places, each weighted with its likelihood over the largest one's. */
struct edge_belief {
    double least; /* negative log likelihood */
    double weight, sum, squares;
};

#define STEP_WIDTHS 7 /* of penumbras that are tried */

struct edge_posterior {
    struct edge_belief widths[STEP_WIDTHS];
};

/* What is expected about a step from one level to another, both > 0, by deviations from it. */
#define STEP_ENTRIES 1536
struct step_levels {
    double inverse_behind, log_behind;
    double inverse[STEP_ENTRIES + 1], logarithm[STEP_ENTRIES + 1];
};
void step_levels_init(struct step_levels *levels, double before, double behind);

/* Weighs where a profile steps so: half way up a penumbra of any width. Several profiles through an
 * edge, such as ones along different slants, may be weighed one after the other, the belief all
 * zeros at first. */
void weigh_profile_step(struct edge_posterior *belief, const struct profile *profile,
                        const struct step_levels *levels);

/* The mean place of parts of one edge, whose penumbra is equally wide in all of them: how wide, and
 * with that how far out they lie, is believed for all together. */
struct profile_edge mean_step_believed(const struct edge_posterior *parts, size_t count);

/* Where the first part of a profile, brighter than its rest, ends; each has one level. The
 * side-lobe bias is what side lobes may add of that level. *gain: how much more likely that is than
 * one level for all, the logarithm; 0: no first part is brighter. */
struct profile_edge find_profile_change(const struct profile *profile, double *gain);

#endif
