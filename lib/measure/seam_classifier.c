#include "measure/seam_classifier.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define SHRINKAGE 0.1 /* of the covariance towards its diagonal */
#define LEAST     2   /* samples of a kind in a fold */
#define SHUFFLES  30

/* Means and spread of the samples that a discriminant learns from. */
struct training {
    double mean[2][SEAM_FEATURES];
    double covariance[SEAM_FEATURES][SEAM_FEATURES];
};

static void find_means(const struct seam_sample *samples, size_t count, int left_out,
                       struct training *training)
{
    size_t counts[2] = {0, 0};
    memset(training, 0, sizeof *training);
    for (size_t i = 0; i < count; i++) {
        if (samples[i].fold == left_out)
            continue;
        const int kind = samples[i].is_injected;
        counts[kind]++;
        for (int k = 0; k < SEAM_FEATURES; k++)
            training->mean[kind][k] += samples[i].features[k];
    }
    for (int kind = 0; kind < 2; kind++)
        for (int k = 0; k < SEAM_FEATURES; k++)
            training->mean[kind][k] /= (double)(counts[kind] > 0 ? counts[kind] : 1);
}

static void find_covariance(const struct seam_sample *samples, size_t count, int left_out,
                            struct training *training)
{
    for (size_t i = 0; i < count; i++) {
        if (samples[i].fold == left_out)
            continue;
        const double *mean = training->mean[samples[i].is_injected];
        for (int k = 0; k < SEAM_FEATURES; k++)
            for (int l = 0; l < SEAM_FEATURES; l++)
                training->covariance[k][l] +=
                    (samples[i].features[k] - mean[k]) * (samples[i].features[l] - mean[l]);
    }
    for (int k = 0; k < SEAM_FEATURES; k++)
        for (int l = 0; l < SEAM_FEATURES; l++)
            if (k != l)
                training->covariance[k][l] *= 1.0 - SHRINKAGE;
    for (int k = 0; k < SEAM_FEATURES; k++)
        training->covariance[k][k] += 1e-12; /* a feature that never changes */
}

/* weights = covariance^-1 (injected mean - background mean), by Cholesky; the shrunk covariance is
 * positive definite. */
static void find_weights(struct training *training, double weights[SEAM_FEATURES])
{
    double(*a)[SEAM_FEATURES] = training->covariance;
    for (int k = 0; k < SEAM_FEATURES; k++) {
        weights[k] = training->mean[1][k] - training->mean[0][k];
        for (int l = 0; l <= k; l++) {
            double sum = a[k][l];
            for (int m = 0; m < l; m++)
                sum -= a[k][m] * a[l][m];
            a[k][l] = k == l ? sqrt(fmax(sum, 1e-300)) : sum / a[l][l];
        }
    }
    for (int k = 0; k < SEAM_FEATURES; k++) {
        for (int m = 0; m < k; m++)
            weights[k] -= a[k][m] * weights[m];
        weights[k] /= a[k][k];
    }
    for (int k = SEAM_FEATURES - 1; k >= 0; k--) {
        for (int m = k + 1; m < SEAM_FEATURES; m++)
            weights[k] -= a[m][k] * weights[m];
        weights[k] /= a[k][k];
    }
}

static void score_fold(const struct seam_sample *samples, size_t count, int fold, double *scores)
{
    struct training training;
    double weights[SEAM_FEATURES];
    find_means(samples, count, fold, &training);
    find_covariance(samples, count, fold, &training);
    find_weights(&training, weights);
    for (size_t i = 0; i < count; i++) {
        if (samples[i].fold != fold)
            continue;
        scores[i] = 0.0;
        for (int k = 0; k < SEAM_FEATURES; k++)
            scores[i] += weights[k] * samples[i].features[k];
    }
}

/* Share of the fold's samples of the other kind that this one is on the right side of. */
static double right_share(const struct seam_sample *samples, size_t count, const double *scores,
                          size_t i)
{
    double right = 0.0;
    size_t others = 0;
    for (size_t j = 0; j < count; j++) {
        if (samples[j].fold != samples[i].fold || samples[j].is_injected == samples[i].is_injected)
            continue;
        const double ahead = samples[i].is_injected ? scores[i] - scores[j] : scores[j] - scores[i];
        right += ahead > 0.0 ? 1.0 : ahead == 0.0 ? 0.5 : 0.0;
        others++;
    }
    return others > 0 ? right / (double)others : 0.5;
}

static bool has_enough(const struct seam_sample *samples, size_t count)
{
    size_t counts[SEAM_FOLDS][2] = {{0}};
    for (size_t i = 0; i < count; i++)
        counts[samples[i].fold][samples[i].is_injected]++;
    for (int fold = 0; fold < SEAM_FOLDS; fold++)
        if (counts[fold][0] < LEAST || counts[fold][1] < LEAST)
            return false;
    return true;
}

static void judge(const struct seam_sample *samples, size_t count, const double *scores,
                  double *auc, double *error)
{
    double sums[2] = {0.0, 0.0};
    double squares[2] = {0.0, 0.0};
    double counts[2] = {0.0, 0.0};
    for (size_t i = 0; i < count; i++) {
        const int kind = samples[i].is_injected;
        const double share = right_share(samples, count, scores, i);
        sums[kind] += share;
        squares[kind] += share * share;
        counts[kind] += 1.0;
    }
    double variance = 0.0;
    for (int kind = 0; kind < 2; kind++) {
        const double mean = sums[kind] / counts[kind];
        variance += (squares[kind] / counts[kind] - mean * mean) / (counts[kind] - 1.0);
    }
    *auc = sums[1] / counts[1];
    *error = sqrt(fmax(0.0, variance));
}

static double cross_validate(const struct seam_sample *samples, size_t count, double *scores,
                             double *error)
{
    double auc;
    for (int fold = 0; fold < SEAM_FOLDS; fold++)
        score_fold(samples, count, fold, scores);
    judge(samples, count, scores, &auc, error);
    return auc;
}

/* A whole number below `limit`, by a linear congruential generator (Knuth's MMIX). */
static size_t draw_below(uint64_t *state, size_t limit)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (size_t)((*state >> 33) % limit);
}

/* Calls one sample of each group the injected one: the first, or any. */
static void choose_injected(struct seam_sample *samples, size_t count, uint64_t *state)
{
    size_t first = 0;
    while (first < count) {
        size_t end = first;
        while (end < count && samples[end].group == samples[first].group)
            samples[end++].is_injected = false;
        samples[state ? first + draw_below(state, end - first) : first].is_injected = true;
        first = end;
    }
}

static double scatter_by_chance(struct seam_sample *samples, size_t count, double *scores)
{
    uint64_t state = 1;
    double squares = 0.0;
    double unused;
    for (int i = 0; i < SHUFFLES; i++) {
        choose_injected(samples, count, &state);
        const double auc = cross_validate(samples, count, scores, &unused);
        squares += (auc - 0.5) * (auc - 0.5);
    }
    choose_injected(samples, count, NULL);
    return sqrt(squares / SHUFFLES);
}

bool classify_seam(struct report *report, struct seam_sample *samples, size_t count, double *auc,
                   double *error, sonject_status *status)
{
    *status = SONJECT_OK;
    if (!has_enough(samples, count))
        return false;
    double *scores = allocate_array(count, sizeof *scores);
    if (!scores) {
        *status = report_out_of_memory(report, "the seam's classifier");
        return false;
    }
    *auc = cross_validate(samples, count, scores, error);
    *error = fmax(*error, scatter_by_chance(samples, count, scores));
    free(scores);
    return true;
}
