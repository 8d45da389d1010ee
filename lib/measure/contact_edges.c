#include <math.h>

#include "measure/contact_edges.h"

#define STEPS_PER_PIXEL 4
#define BEFORE_END      3    /* pixels before an end, whose largest mean spreads beyond it */
#define SPREADS         3    /* shares of that mean that are tried */
#define SPREAD_RATIO    0.71 /* ratio of one share to the one before; the first is 1 */
#define REACH           6    /* deviations beyond which the point response is nil */
#define WIDTH_RATIO     1.6  /* ratio of penumbras' widths; the first is the response's */
#define LOBE_BIAS_RATIO 2.0
#define FAINTEST        1e-9 /* least mean, as a share of the dark level: some means are 0 */

/* share: the pixels of places that this place stands for. */
static void weigh(struct edge_belief *belief, double place, double share, double cost)
{
    if (belief->weight == 0.0 || cost < belief->least) {
        const double factor = belief->weight > 0.0 ? exp(cost - belief->least) : 0.0;
        belief->weight *= factor;
        belief->sum *= factor;
        belief->squares *= factor;
        belief->least = cost;
    }
    const double weight = share * exp(belief->least - cost);
    belief->weight += weight;
    belief->sum += weight * place;
    belief->squares += weight * place * place;
}

static struct profile_edge edge_believed(const struct edge_belief *belief)
{
    const double place = belief->sum / belief->weight;
    const double variance = belief->squares / belief->weight - place * place;
    const struct profile_edge edge = {place, sqrt(fmax(0.0, variance))};
    return edge;
}

/* Returns the share of a step's energy that lies more than so many deviations beyond the step. */
static double spread(double deviations)
{
    return 0.5 * erfc(deviations / 1.4142135623730951);
}

/* Returns the negative log likelihood, per sample, of a mean > 0, where a range is expected. */
static double cost_within(double mean, double least, double most)
{
    const double ratio = mean / fmin(fmax(mean, least), most);
    return ratio - 1.0 - log(ratio);
}

static double mean_at(const struct profile *profile, const struct end_levels *levels, size_t k)
{
    return fmax(profile->means[k], FAINTEST * levels->dark);
}

static double cost_of_lit(const struct profile *profile, const struct end_levels *levels, size_t k)
{
    return cost_within(mean_at(profile, levels, k),
                       levels->lit + LOBE_BIAS_RATIO * profile->lobe_bias[k], INFINITY);
}

/* spread_there: the energy that lit pixels spread to this one. */
static double cost_of_dark(const struct profile *profile, const struct end_levels *levels, size_t k,
                           double spread_there)
{
    return cost_within(mean_at(profile, levels, k), spread_there,
                       spread_there + levels->dark + profile->lobe_bias[k]);
}

/* Returns the number of pixels whose centres lie before a place >= -0.5. */
static size_t pixels_before(double place, size_t count)
{
    const size_t before = (size_t)(place + 1.0);
    return before < count ? before : count;
}

/* Returns the cost that spreading adds to the pixels behind an end at `place`, where a share of the
 * largest mean before it spreads. */
static double cost_of_spread(const struct profile *profile, const struct end_levels *levels,
                             double place, double share)
{
    const size_t first = pixels_before(place, profile->count);
    double before = 0.0;
    double cost = 0.0;
    for (size_t k = first > BEFORE_END ? first - BEFORE_END : 0; k < first; k++)
        before = fmax(before, profile->means[k]);
    for (size_t k = first; k < profile->count; k++) {
        const double deviations = ((double)k - place) / profile->deviation;
        if (deviations > REACH)
            break;
        cost += cost_of_dark(profile, levels, k, share * before * spread(deviations)) -
                cost_of_dark(profile, levels, k, 0.0);
    }
    return cost;
}

struct profile_edge find_profile_end(const struct profile *profile, const struct end_levels *levels)
{
    struct edge_belief belief = {0.0, 0.0, 0.0, 0.0};
    double cost = 0.0; /* cost of an end behind pixel `first`, minus that before all pixels */
    size_t first = 0;
    for (size_t step = 0; step <= profile->count * STEPS_PER_PIXEL; step++) {
        const double place = (double)step / STEPS_PER_PIXEL - 0.5;
        for (; first < pixels_before(place, profile->count); first++)
            cost += cost_of_lit(profile, levels, first) - cost_of_dark(profile, levels, first, 0.0);
        double share = 1.0;
        for (int i = 0; i < SPREADS; i++, share *= SPREAD_RATIO)
            weigh(&belief, place, 1.0,
                  profile->samples * (cost + cost_of_spread(profile, levels, place, share)));
    }
    return edge_believed(&belief);
}

/* Values between the entries are interpolated linearly, which errs by 1e-5 of a sample. */
void step_levels_init(struct step_levels *levels, double before, double behind)
{
    levels->inverse_behind = 1.0 / behind;
    levels->log_behind = log(behind);
    for (int i = 0; i <= STEP_ENTRIES; i++) {
        const double deviations = (double)i * 2.0 * REACH / STEP_ENTRIES - REACH;
        const double expected = behind + (before - behind) * spread(deviations);
        levels->inverse[i] = 1.0 / expected;
        levels->logarithm[i] = log(expected);
    }
}

/* Returns the negative log likelihood, per sample, of a pixel's mean at less than REACH deviations
 * from the step, minus that of a pixel behind the step. */
static double cost_at_step(const struct step_levels *levels, double mean, double deviations)
{
    const double at = (deviations + REACH) * (STEP_ENTRIES / (2.0 * REACH));
    const int i = at < STEP_ENTRIES - 1.0 ? (int)at : STEP_ENTRIES - 1;
    const double later = at - i;
    return mean * (levels->inverse[i] + later * (levels->inverse[i + 1] - levels->inverse[i]) -
                   levels->inverse_behind) +
           levels->logarithm[i] + later * (levels->logarithm[i + 1] - levels->logarithm[i]) -
           levels->log_behind;
}

/* Adds the places of a step whose penumbra is this wide. Wider penumbras have less prior weight. */
static void weigh_steps(struct edge_belief *belief, const struct profile *profile,
                        const struct step_levels *levels, double width)
{
    const double stride = fmax(1.0, width) / STEPS_PER_PIXEL;
    double settled_cost = 0.0; /* cost of pixels well before the step, minus that behind */
    size_t settled = 0;        /* number of these pixels */
    /* costs are not relative to those of m = p, so that profiles of other means can be compared */
    double all_cost = (double)profile->count * levels->log_behind;
    for (size_t k = 0; k < profile->count; k++)
        all_cost += profile->means[k] * levels->inverse_behind;
    for (double place = -0.5; place <= (double)profile->count - 0.5; place += stride) {
        for (; (double)settled < place - REACH * width; settled++)
            settled_cost += cost_at_step(levels, profile->means[settled], -REACH);
        double cost = all_cost + settled_cost;
        for (size_t k = settled; k < profile->count && (double)k < place + REACH * width; k++)
            cost += cost_at_step(levels, profile->means[k], ((double)k - place) / width);
        weigh(belief, place, stride / width, profile->samples * cost);
    }
}

void weigh_profile_step(struct edge_posterior *belief, const struct profile *profile,
                        const struct step_levels *levels)
{
    double width = profile->deviation;
    for (int i = 0; i < STEP_WIDTHS; i++, width *= WIDTH_RATIO)
        weigh_steps(&belief->widths[i], profile, levels, width);
}

struct profile_edge mean_step_believed(const struct edge_posterior *parts, size_t count)
{
    struct edge_belief all = {0.0, 0.0, 0.0, 0.0};
    double variance = 0.0; /* sum of the variances within each width, weighted by likelihood */
    double least = INFINITY;
    double costs[STEP_WIDTHS];
    for (int i = 0; i < STEP_WIDTHS; i++) {
        costs[i] = 0.0;
        for (size_t part = 0; part < count; part++)
            costs[i] += parts[part].widths[i].least - log(parts[part].widths[i].weight);
        least = fmin(least, costs[i]);
    }
    for (int i = 0; i < STEP_WIDTHS; i++) {
        double place = 0.0;
        double squares = 0.0;
        for (size_t part = 0; part < count; part++) {
            const struct profile_edge edge = edge_believed(&parts[part].widths[i]);
            place += edge.place / (double)count;
            squares += edge.error * edge.error;
        }
        weigh(&all, place, 1.0, costs[i]);
        variance += exp(least - costs[i]) * squares / ((double)count * (double)count);
    }
    struct profile_edge mean = edge_believed(&all);
    mean.error = sqrt(mean.error * mean.error + variance / all.weight);
    return mean;
}

struct profile_edge find_profile_change(const struct profile *profile, double *gain)
{
    struct edge_belief belief = {0.0, 0.0, 0.0, 0.0};
    const double count = (double)profile->count;
    double all = 0.0;
    double first = 0.0;
    for (size_t k = 0; k < profile->count; k++)
        all += profile->means[k] / (1.0 + profile->lobe_bias[k]);
    const double plain = count * log(fmax(all, FAINTEST) / count);
    for (size_t k = 1; k < profile->count; k++) {
        first += profile->means[k - 1] / (1.0 + profile->lobe_bias[k - 1]);
        const double before = fmax(first, FAINTEST * all) / (double)k;
        const double behind = fmax(all - first, FAINTEST * all) / (count - (double)k);
        if (before > behind)
            weigh(&belief, (double)k - 0.5, 1.0,
                  profile->samples *
                      ((double)k * log(before) + (count - (double)k) * log(behind) - plain));
    }
    const struct profile_edge none = {-0.5, 0.0};
    *gain = belief.weight > 0.0 ? -belief.least : 0.0;
    return belief.weight > 0.0 ? edge_believed(&belief) : none;
}
