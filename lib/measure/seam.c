#include "measure/measures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define SEAM_PATCH   12 /* pixels on a side */
#define GUARD        1  /* pixels around highlights and shadows */
#define GAPS         3  /* pixels, in the influence, that are closed */
#define MARGIN       6  /* pixels around a patch that its level is compared with */
#define SURROUNDINGS (SEAM_PATCH + 2 * MARGIN)
#define BAND_LEAST   30  /* pixels of a patch that are in the band */
#define STEP         3   /* pixels between the places where patches may begin */
#define PAIRS        2   /* of untouched patches for each of the band, on opposite sides of it */
#define FARTHEST     10  /* patches off, where those are looked for */
#define SAMPLES_MAX  600 /* of the band; comparing goes as their square */

#define SEAM_FEATURES 7
#define SEAM_FOLDS    5

/* A patch by its local statistics. */
struct seam_sample {
    double features[SEAM_FEATURES];
    int fold;         /* 0...SEAM_FOLDS - 1: part of the image, judged by what the others taught */
    size_t group;     /* number of the injected sample that it belongs to; groups follow each other,
                         each begins with its injected sample */
    bool is_injected; /* or untouched seabed */
};

enum pixel_kind {
    PIXEL_UNTOUCHED,
    PIXEL_BAND,
    PIXEL_TARGET, /* and its surroundings, and what of the band is used: neither */
    PIXEL_TAKEN   /* untouched, and part of a sample already */
};

struct seam_search {
    const float *amplitudes;
    uint8_t *kinds;
    size_t rows, columns;
    struct seam_sample *samples;
    size_t count;
};

/* Outline of a sample: the pixels of a patch that are in the band, and the untouched ones around
 * it; from MARGIN above and left of the patch on. */
struct outline {
    bool is_in[SURROUNDINGS * SURROUNDINGS];
    bool is_around[SURROUNDINGS * SURROUNDINGS];
    size_t pixels, around;
};

/* A pixel of the surroundings of a patch; false where it is not in the image. */
static bool pixel_at(const struct seam_search *search, size_t row, size_t column, size_t i,
                     size_t *at)
{
    const size_t r = row + i / SURROUNDINGS;
    const size_t c = column + i % SURROUNDINGS;
    if (r < MARGIN || c < MARGIN || r - MARGIN >= search->rows || c - MARGIN >= search->columns)
        return false;
    *at = (r - MARGIN) * search->columns + c - MARGIN;
    return true;
}

void fill_square(uint8_t *mask, size_t rows, size_t columns, size_t at, size_t radius,
                 uint8_t value)
{
    const size_t row = at / columns;
    const size_t column = at % columns;
    for (size_t r = row > radius ? row - radius : 0; r <= row + radius && r < rows; r++)
        for (size_t c = column > radius ? column - radius : 0; c <= column + radius && c < columns;
             c++)
            mask[r * columns + c] = value;
}

/* Spreads the pixels of a kind over squares of GAPS pixels around them. scratch: as kinds. */
static void spread(const struct seam_search *search, uint8_t kind, uint8_t *scratch)
{
    memcpy(scratch, search->kinds, search->rows * search->columns);
    for (size_t i = 0; i < search->rows * search->columns; i++)
        if (scratch[i] == kind)
            fill_square(search->kinds, search->rows, search->columns, i, GAPS, kind);
}

/* Where little changes, dark pixels change first: gaps in the influence are closed, or the band
 * would be of another level than its surroundings before anything was put in. */
static void mark_kinds(struct seam_search *search, const uint8_t *influence, const uint8_t *labels,
                       uint8_t *scratch)
{
    const size_t count = search->rows * search->columns;
    for (size_t i = 0; i < count; i++)
        search->kinds[i] = influence[i] ? PIXEL_BAND : PIXEL_UNTOUCHED;
    spread(search, PIXEL_BAND, scratch);
    spread(search, PIXEL_UNTOUCHED, scratch);
    for (size_t i = 0; i < count; i++)
        if (influence[i])
            search->kinds[i] = PIXEL_BAND;
    for (size_t i = 0; labels && i < count; i++)
        if (labels[i])
            fill_square(search->kinds, search->rows, search->columns, i, GUARD, PIXEL_TARGET);
}

static void take_outline(const struct seam_search *search, size_t row, size_t column,
                         struct outline *outline)
{
    memset(outline, 0, sizeof *outline);
    for (size_t i = 0; i < SURROUNDINGS * SURROUNDINGS; i++) {
        size_t at;
        if (!pixel_at(search, row, column, i, &at))
            continue;
        const uint8_t kind = search->kinds[at];
        const size_t down = i / SURROUNDINGS - MARGIN; /* in the patch, or large */
        const size_t right = i % SURROUNDINGS - MARGIN;
        outline->is_in[i] = down < SEAM_PATCH && right < SEAM_PATCH && kind == PIXEL_BAND;
        outline->is_around[i] = kind == PIXEL_UNTOUCHED || kind == PIXEL_TAKEN;
        outline->pixels += outline->is_in[i];
        outline->around += outline->is_around[i];
    }
}

/* All of the outline on untouched pixels, those in it not yet used. */
static bool is_untouched(const struct seam_search *search, size_t row, size_t column,
                         const struct outline *outline)
{
    for (size_t i = 0; i < SURROUNDINGS * SURROUNDINGS; i++) {
        size_t at;
        if (!outline->is_in[i] && !outline->is_around[i])
            continue;
        if (!pixel_at(search, row, column, i, &at))
            return false;
        const uint8_t kind = search->kinds[at];
        if (kind != PIXEL_UNTOUCHED && (outline->is_in[i] || kind != PIXEL_TAKEN))
            return false;
    }
    return true;
}

static void take(struct seam_search *search, size_t row, size_t column,
                 const struct outline *outline, enum pixel_kind kind)
{
    size_t at;
    for (size_t i = 0; i < SURROUNDINGS * SURROUNDINGS; i++)
        if (outline->is_in[i] && pixel_at(search, row, column, i, &at))
            search->kinds[at] = (uint8_t)kind;
}

/* Correlation and mean step of neighbours `ahead` pixels on in the order of the surroundings, both
 * in the outline; values are over the patch's mean, spread is their variance. */
static void compare_neighbours(const double *values, const struct outline *outline, size_t ahead,
                               double spread, double *correlation, double *step)
{
    double products = 0.0;
    double steps = 0.0;
    double pairs = 0.0;
    for (size_t i = 0; i + ahead < SURROUNDINGS * SURROUNDINGS; i++) {
        if (!outline->is_in[i] || !outline->is_in[i + ahead])
            continue;
        products += (values[i] - 1.0) * (values[i + ahead] - 1.0);
        steps += fabs(values[i] - values[i + ahead]);
        pairs += 1.0;
    }
    *correlation = pairs > 0.0 && spread > 0.0 ? products / pairs / spread : 0.0;
    *step = pairs > 0.0 ? steps / pairs : 0.0;
}

/* Mean amplitude of the pixels of an outline. */
static double mean_of(const struct seam_search *search, size_t row, size_t column,
                      const bool *is_counted, size_t count)
{
    double sum = 0.0;
    size_t at;
    for (size_t i = 0; i < SURROUNDINGS * SURROUNDINGS; i++)
        if (is_counted[i] && pixel_at(search, row, column, i, &at))
            sum += (double)search->amplitudes[at];
    return count > 0 ? sum / (double)count : 0.0;
}

/* Level over the surroundings, contrast, skewness, and correlation and mean step along either axis.
 * False for a patch of nothing. */
static bool describe(const struct seam_search *search, size_t row, size_t column,
                     const struct outline *outline, double features[SEAM_FEATURES])
{
    double values[SURROUNDINGS * SURROUNDINGS] = {0.0};
    double variance = 0.0;
    double third = 0.0;
    const double count = (double)outline->pixels;
    const double mean = mean_of(search, row, column, outline->is_in, outline->pixels);
    const double around = mean_of(search, row, column, outline->is_around, outline->around);
    if (!(mean > 0.0))
        return false;
    for (size_t i = 0; i < SURROUNDINGS * SURROUNDINGS; i++) {
        size_t at;
        if (!outline->is_in[i] || !pixel_at(search, row, column, i, &at))
            continue;
        values[i] = (double)search->amplitudes[at] / mean;
        const double difference = values[i] - 1.0;
        variance += difference * difference / count;
        third += difference * difference * difference / count;
    }
    features[0] = outline->around >= BAND_LEAST && around > 0.0 ? log(mean / around) : 0.0;
    features[1] = sqrt(variance);
    features[2] = variance > 0.0 ? third / (variance * sqrt(variance)) : 0.0;
    compare_neighbours(values, outline, SURROUNDINGS, variance, &features[3], &features[4]);
    compare_neighbours(values, outline, 1, variance, &features[5], &features[6]);
    return true;
}

static bool add_sample(struct seam_search *search, size_t row, size_t column,
                       const struct outline *outline, bool is_injected)
{
    struct seam_sample *sample = &search->samples[search->count];
    if (!describe(search, row, column, outline, sample->features))
        return false;
    sample->is_injected = is_injected;
    search->count++;
    return true;
}

/* Adds the patches at an offset in whole patches and at the opposite one; false, and none, where
 * one is not inside, not untouched or of nothing. */
static bool add_pair(struct seam_search *search, size_t row, size_t column, long down, long right,
                     const struct outline *outline)
{
    const size_t before = search->count;
    size_t rows[2], columns[2];
    for (int i = 0; i < 2; i++) {
        const long r = (long)row + (i == 0 ? down : -down) * SEAM_PATCH;
        const long c = (long)column + (i == 0 ? right : -right) * SEAM_PATCH;
        if (r < 0 || c < 0 || r + SEAM_PATCH > (long)search->rows ||
            c + SEAM_PATCH > (long)search->columns)
            return false;
        rows[i] = (size_t)r;
        columns[i] = (size_t)c;
        if (!is_untouched(search, rows[i], columns[i], outline))
            return false;
    }
    for (int i = 0; i < 2; i++)
        if (!add_sample(search, rows[i], columns[i], outline, false)) {
            search->count = before;
            return false;
        }
    for (int i = 0; i < 2; i++)
        take(search, rows[i], columns[i], outline, PIXEL_TAKEN);
    return true;
}

/* Untouched patches of this outline, nearest first, in pairs on opposite sides: what changes evenly
 * across the seabed is the same in their mean as between them. */
static size_t add_backgrounds(struct seam_search *search, size_t row, size_t column,
                              const struct outline *outline)
{
    size_t found = 0;
    for (long distance = 1; distance <= FARTHEST; distance++)
        for (long down = 0; down <= distance; down++)
            for (long right = down == 0 ? 1 : -distance; right <= distance; right++) {
                if (down != distance && labs(right) != distance)
                    continue;
                found += add_pair(search, row, column, down, right, outline);
                if (found == PAIRS)
                    return found;
            }
    return found;
}

/* Counts the features of a sample and its backgrounds from their common mean, so that only what
 * differs near by is left. */
static void centre(struct seam_sample *group, size_t count)
{
    for (int k = 0; k < SEAM_FEATURES; k++) {
        double mean = 0.0;
        for (size_t i = 0; i < count; i++)
            mean += group[i].features[k] / (double)count;
        for (size_t i = 0; i < count; i++)
            group[i].features[k] -= mean;
    }
}

/* Takes a patch and its backgrounds; false where it has too little of the band, or nothing near to
 * be compared with. */
static bool add_group(struct seam_search *search, size_t row, size_t column, size_t least,
                      size_t number)
{
    struct outline outline;
    const size_t first = search->count;
    take_outline(search, row, column, &outline);
    if (outline.pixels < least || !add_sample(search, row, column, &outline, true))
        return false;
    if (add_backgrounds(search, row, column, &outline) == 0) {
        search->count = first;
        return false;
    }
    take(search, row, column, &outline, PIXEL_TARGET);
    centre(search->samples + first, search->count - first);
    for (size_t i = first; i < search->count; i++)
        search->samples[i].group = number;
    return true;
}

/* Whole patches first, then what is left of the band at its edges. */
static size_t collect(struct seam_search *search)
{
    static const size_t least[] = {SEAM_PATCH * SEAM_PATCH * 9 / 10, SEAM_PATCH * SEAM_PATCH / 2,
                                   BAND_LEAST};
    size_t injected = 0;
    for (size_t pass = 0; pass < sizeof least / sizeof *least; pass++)
        for (size_t row = 0; row + SEAM_PATCH <= search->rows; row += STEP)
            for (size_t column = 0;
                 column + SEAM_PATCH <= search->columns && injected < SAMPLES_MAX; column += STEP)
                injected += add_group(search, row, column, least[pass], injected);
    return injected;
}

#define SHRINKAGE 0.1 /* of the covariance towards its diagonal */
#define LEAST     2   /* samples of a kind in a fold */
#define SHUFFLES  30

/* Means and spread of the samples that a discriminant learns from. */
struct training {
    double mean[2][SEAM_FEATURES];
    double covariance[SEAM_FEATURES][SEAM_FEATURES];
};

/* From the samples that are not of a fold. */
static void learn(const struct seam_sample *samples, size_t count, int left_out,
                  struct training *training)
{
    double counts[2] = {0.0, 0.0};
    memset(training, 0, sizeof *training);
    for (size_t i = 0; i < count; i++) {
        const int kind = samples[i].is_injected;
        counts[kind] += samples[i].fold != left_out;
        for (int k = 0; k < SEAM_FEATURES && samples[i].fold != left_out; k++)
            training->mean[kind][k] += samples[i].features[k];
    }
    for (int kind = 0; kind < 2; kind++)
        for (int k = 0; k < SEAM_FEATURES; k++)
            training->mean[kind][k] /= fmax(counts[kind], 1.0);
    for (size_t i = 0; i < count; i++) {
        const double *mean = training->mean[samples[i].is_injected];
        for (int k = 0; k < SEAM_FEATURES && samples[i].fold != left_out; k++)
            for (int l = 0; l < SEAM_FEATURES; l++)
                training->covariance[k][l] +=
                    (samples[i].features[k] - mean[k]) * (samples[i].features[l] - mean[l]);
    }
    for (int k = 0; k < SEAM_FEATURES; k++)
        for (int l = 0; l < SEAM_FEATURES; l++)
            if (k != l)
                training->covariance[k][l] *= 1.0 - SHRINKAGE;
            else
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
    learn(samples, count, fold, &training);
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

/* The area under the curve and its error by DeLong and others. scores: room for count numbers. */
static double cross_validate(const struct seam_sample *samples, size_t count, double *scores,
                             double *error)
{
    double sums[2] = {0.0, 0.0};
    double squares[2] = {0.0, 0.0};
    double counts[2] = {0.0, 0.0};
    double variance = 0.0;
    for (int fold = 0; fold < SEAM_FOLDS; fold++)
        score_fold(samples, count, fold, scores);
    for (size_t i = 0; i < count; i++) {
        const int kind = samples[i].is_injected;
        const double share = right_share(samples, count, scores, i);
        sums[kind] += share;
        squares[kind] += share * share;
        counts[kind] += 1.0;
    }
    for (int kind = 0; kind < 2; kind++) {
        const double mean = sums[kind] / counts[kind];
        variance += (squares[kind] / counts[kind] - mean * mean) / (counts[kind] - 1.0);
    }
    *error = sqrt(fmax(0.0, variance));
    return sums[1] / counts[1];
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

/* Area under the curve of Fisher's discriminant, cross-validated over the folds, each compared
 * within itself; not known unless every fold has two samples of either kind. The standard error is
 * the larger one of that by DeLong, DeLong and Clarke-Pearson, "Comparing the areas under two or
 * more correlated receiver operating characteristic curves", Biometrics 44 (1988), and the scatter
 * of the area when in each group another sample is taken for the injected one, which holds what the
 * classifier learns by chance. */
static sonject_status classify_seam(struct report *report, struct seam_search *search,
                                    size_t injected, struct seam *seam)
{
    seam->patches = injected;
    seam->background = search->count - injected;
    for (size_t i = 0; i < search->count; i++) /* contiguous fifths, with their backgrounds */
        search->samples[i].fold = (int)(search->samples[i].group * SEAM_FOLDS / injected);
    if (!has_enough(search->samples, search->count))
        return SONJECT_OK;
    double *scores = allocate_array(search->count, sizeof *scores);
    CHECK_MEMORY(report, scores, "the seam's classifier");
    seam->auc = cross_validate(search->samples, search->count, scores, &seam->error);
    seam->error = fmax(seam->error, scatter_by_chance(search->samples, search->count, scores));
    free(scores);
    return SONJECT_OK;
}

sonject_status measure_seam(struct report *report, const float *amplitudes,
                            const uint8_t *influence, const uint8_t *labels, size_t rows,
                            size_t columns, struct seam *seam)
{
    struct seam_search search = {amplitudes, NULL, rows, columns, NULL, 0};
    memset(seam, 0, sizeof *seam);
    seam->auc = NAN;
    seam->error = NAN;
    search.kinds = allocate_array(rows, columns);
    uint8_t *scratch = allocate_array(rows, columns);
    search.samples = allocate_array((SAMPLES_MAX + 1) * (2 * PAIRS + 1), sizeof *search.samples);
    sonject_status status = search.kinds && search.samples && scratch
                                ? SONJECT_OK
                                : report_out_of_memory(report, "the seam");
    if (status == SONJECT_OK) {
        mark_kinds(&search, influence, labels, scratch);
        status = classify_seam(report, &search, collect(&search), seam);
    }
    free(search.kinds);
    free(search.samples);
    free(scratch);
    return status;
}
