/* A linear classifier of patches by their local statistics, and how well it does. */
#ifndef SONJECT_MEASURE_SEAM_CLASSIFIER_H
#define SONJECT_MEASURE_SEAM_CLASSIFIER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

#define SEAM_FEATURES 7
#define SEAM_FOLDS    5

struct seam_sample {
    double features[SEAM_FEATURES];
    int fold;         /* 0...SEAM_FOLDS - 1: part of the image, judged by what the others taught */
    size_t group;     /* number of the injected sample that it belongs to; groups follow each other,
                         each begins with its injected sample */
    bool is_injected; /* or untouched seabed */
};

/* Area under the curve of Fisher's discriminant, cross-validated over the folds, each compared
 * within itself. The standard error is the larger one of that by DeLong, DeLong and Clarke-Pearson,
 * "Comparing the areas under two or more correlated receiver operating characteristic curves",
 * Biometrics 44 (1988), and the scatter of the area when in each group another sample is taken for
 * the injected one, which holds what the classifier learns by chance. samples are borrowed. Every
 * fold needs two samples of either kind: else false. Errors (of *status): MEMORY. */
bool classify_seam(struct report *report, struct seam_sample *samples, size_t count, double *auc,
                   double *error, sonject_status *status);

#endif
