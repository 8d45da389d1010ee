#include "measure/draw_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define MOVES      (2 * FITTED_KINDS) /* shifts, then logarithms of stretches */
#define RELATIONS  3                  /* number of ratios of sizes */
#define RESIDUALS  (EXTENT_KINDS * QUANTILES_MAX + MOVES + RELATIONS)
#define TERMS      (FITTED_KINDS + 1) /* terms of a response: a constant, then the draws */
#define STEPS_MAX  60
#define RIDGE      1e-5 /* share of the weights' sum: draws that were not varied get no response */
#define NEAR_LEAST 0.5  /* least mean nearness of a round whose contacts are compared */
#define OWN_ERROR  1.0  /* variance that a quantile shares with no other */

/* The largest first move: natural logarithms of sizes, dB, and logarithms of stretches. Later moves
 * are at most a share of it, lest contacts that hardly tell sizes lead to and fro. */
static const double most[MOVES] = {0.7, 0.7, 0.7, 20.0, 8.0, 0.5, 0.5, 0.5, 0.5, 0.5};

/* The deviations of nearness: how far draws may move before contacts count less. */
static const double near[FITTED_KINDS] = {0.3, 0.3, 0.3, 3.0, 3.0};

/* The prior's standard deviations: how far all moves together may leave the campaign's own values.
 * BELIEVED_RATIO is that of the ratios of sizes, which contacts of any heading tell poorly. */
static const double believed[MOVES] = {1.0, 1.0, 1.0, 15.0, 10.0, 0.15, 0.15, 0.3, 0.5, 0.5};
#define BELIEVED_RATIO 0.25

double sorted_quantile(const double *sorted, size_t count, double share)
{
    const double place = fmax(share * ((double)count + 1.0 / 3.0) - 2.0 / 3.0, 0.0);
    const size_t below = (size_t)fmin(floor(place), (double)(count - 1));
    const size_t above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (place - (double)below) * (sorted[above] - sorted[below]);
}

double finite_quantile(double *values, size_t count, double share)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(values[i]))
            values[n++] = values[i];
    qsort(values, n, sizeof *values, compare_doubles);
    return n > 0 ? sorted_quantile(values, n, share) : NAN;
}

/* Returns the standard normal distribution's quantile, after Hastings (1955), to 4.5e-4. */
static double normal_deviate(double share)
{
    const double tail = fmin(share, 1.0 - share);
    const double t = sqrt(-2.0 * log(tail));
    const double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                             (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    return share < 0.5 ? -z : z;
}

double quantile_error(double share, double middle_half, double count)
{
    /* The outermost of the values lie at about this share. */
    const double outermost = 0.5 / fmax(count, 2.0);
    share = fmin(fmax(share, outermost), 1.0 - outermost);
    const double z = normal_deviate(share);
    const double deviation = fmax(middle_half / 1.349, 0.05);
    const double density = exp(-0.5 * z * z) / sqrt(2.0 * 3.14159265358979323846);
    return deviation * sqrt(share * (1.0 - share) / count) / density;
}

/* Chooses shares that 100, 30 or fewer contacts can tell. A few of them do not show everything. */
static size_t choose_levels(size_t count, double *levels)
{
    static const double many[] = {0.05, 0.15, 0.25, 0.375, 0.5, 0.625, 0.75, 0.85, 0.95};
    static const double some[] = {0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9};
    static const double few[] = {0.2, 0.35, 0.5, 0.65, 0.8};
    const double *chosen = count >= 90 ? many : count >= 27 ? some : few;
    const size_t chosen_count = count >= 90 ? COUNT(many) : count >= 27 ? COUNT(some) : COUNT(few);
    memcpy(levels, chosen, chosen_count * sizeof *levels);
    return chosen_count;
}

sonject_status quantile_goals(struct report *report, const struct contact_extents *contacts,
                              size_t count, struct quantile_goal *goals)
{
    double *seen = allocate_array(count + 1, sizeof *seen);
    CHECK_MEMORY(report, seen, "contacts");
    for (size_t k = 0; k < EXTENT_KINDS; k++) {
        struct quantile_goal *goal = &goals[k];
        size_t n = 0;
        memset(goal, 0, sizeof *goal);
        for (size_t i = 0; i < count; i++)
            if (isfinite(contacts[i].of[k]))
                seen[n++] = contacts[i].of[k];
        /* Other extents say the same as the two slant extents, and more precisely. */
        if (n < SEEN_LEAST || k == EXTENT_HIGHLIGHT_SLANT || k == EXTENT_SHADOW_SLANT)
            continue;
        qsort(seen, n, sizeof *seen, compare_doubles);
        const double half = sorted_quantile(seen, n, 0.75) - sorted_quantile(seen, n, 0.25);
        goal->levels = choose_levels(n, goal->level);
        for (size_t j = 0; j < goal->levels; j++) {
            goal->value[j] = sorted_quantile(seen, n, goal->level[j]);
            goal->error[j] = quantile_error(goal->level[j], half, (double)n);
        }
    }
    free(seen);
    return SONJECT_OK;
}

/* ---- The response of measures to draws. */

/* Replaces length and width by the extents along and across the track of an ellipse of that size in
 * plan. Keeps the rest. Measures follow these extents more closely than they follow sizes. */
static void project(const double *drawn, double heading_rad, double *projected)
{
    const double length = exp(drawn[FITTED_LENGTH]);
    const double width = exp(drawn[FITTED_WIDTH]);
    const double c = cos(heading_rad);
    const double s = sin(heading_rad);
    memcpy(projected, drawn, FITTED_KINDS * sizeof *projected);
    projected[0] = log(hypot(length * c, width * s));
    projected[1] = log(hypot(length * s, width * c));
}

/* Factors a symmetric n x n matrix in place (Cholesky, lower). False if it is not positive. */
static bool factor_symmetric(double *a, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = a[i * n + j];
            for (size_t k = 0; k < j; k++)
                sum -= a[i * n + k] * a[j * n + k];
            if (i == j && !(sum > 0.0))
                return false;
            a[i * n + j] = i == j ? sqrt(sum) : sum / a[j * n + j];
        }
    return true;
}

/* Solves a x = b in place for a lower factor. */
static void solve_lower(const double *a, double *b, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++)
            b[i] -= a[i * n + k] * b[k];
        b[i] /= a[i * n + i];
    }
}

/* Solves a x = b in place for a symmetric positive matrix. False if the matrix is not positive. */
static bool solve_symmetric(double *a, double *b, size_t n)
{
    if (!factor_symmetric(a, n))
        return false;
    solve_lower(a, b, n);
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            b[i] -= a[k * n + i] * b[k];
        b[i] /= a[i * n + i];
    }
    return true;
}

/* Returns how near a contact's draws are to where they are now: 1 if unmoved, else less. */
static double nearness(const struct drawn_contact *contact)
{
    double sum = 0.0;
    for (size_t k = 0; k < FITTED_KINDS; k++)
        sum += pow((contact->now[k] - contact->drawn[k]) / near[k], 2.0);
    return exp(-0.5 * sum);
}

/* Finds the slopes of a measure over what is drawn, by weighted least squares. */
static void find_response(const struct drawn_contact *contacts, size_t count, size_t extent,
                          double response[FITTED_KINDS])
{
    double a[TERMS * TERMS] = {0.0};
    double b[TERMS] = {0.0};
    double total = 0.0;
    double varied = 0.0; /* largest change of the floor */
    for (size_t i = 0; i < count; i++) {
        const double y = contacts[i].shown.of[extent];
        const double weight = nearness(&contacts[i]);
        double x[TERMS] = {1.0};
        if (!isfinite(y))
            continue;
        project(contacts[i].drawn, contacts[i].heading_rad, x + 1);
        for (size_t j = 0; j < TERMS; j++) {
            b[j] += weight * x[j] * y;
            for (size_t k = 0; k < TERMS; k++)
                a[j * TERMS + k] += weight * x[j] * x[k];
        }
        total += weight;
        varied =
            fmax(varied, fabs(contacts[i].drawn[FITTED_FLOOR] - contacts[0].drawn[FITTED_FLOOR]));
    }
    for (size_t j = 1; j < TERMS; j++)
        a[j * TERMS + j] += RIDGE * total;
    memset(response, 0, FITTED_KINDS * sizeof *response);
    if (solve_symmetric(a, b, TERMS))
        memcpy(response, b + 1, FITTED_KINDS * sizeof *response);
    /* The noise floor adds to all shadows alike, and hardly to anything else. */
    if (extent != EXTENT_SHADOW_LEVEL)
        response[FITTED_FLOOR] = 0.0;
    else if (varied < 0.5)
        response[FITTED_FLOOR] = 1.0;
}

/* ---- Moves. */

struct move_fit {
    const struct drawn_contact **contacts; /* the contacts that are compared; owned */
    size_t count;
    const struct quantile_goal *goals;
    const struct move_prior *prior;
    double centre[FITTED_KINDS];
    double response[EXTENT_KINDS][FITTED_KINDS];
    double *shown;  /* room for count values; owned */
    double *factor; /* Cholesky factor of the quantiles' correlations; owned */
    double trust;   /* factor on the deviations of the prior's stretches */
};

double draw_moved(const struct draw_move *move, double value)
{
    return move->centre + move->shift + move->stretch * (value - move->centre);
}

static void moves_as_steps(const struct move_fit *fit, const double *moves,
                           struct draw_move steps[FITTED_KINDS])
{
    for (size_t k = 0; k < FITTED_KINDS; k++)
        steps[k] = (struct draw_move){fit->centre[k], moves[k], exp(moves[FITTED_KINDS + k])};
}

/* Fills the differences of quantiles over their errors. Returns their number. */
static size_t add_extent_residuals(const struct move_fit *fit, const double *moves, size_t extent,
                                   double *residuals)
{
    const struct quantile_goal *goal = &fit->goals[extent];
    struct draw_move steps[FITTED_KINDS];
    size_t n = 0;
    moves_as_steps(fit, moves, steps);
    for (size_t i = 0; i < fit->count; i++) {
        const struct drawn_contact *contact = fit->contacts[i];
        double drawn[FITTED_KINDS], before[FITTED_KINDS], after[FITTED_KINDS];
        double shown = contact->shown.of[extent];
        if (!isfinite(shown))
            continue;
        for (size_t k = 0; k < FITTED_KINDS; k++)
            drawn[k] = draw_moved(&steps[k], contact->now[k]);
        project(contact->drawn, contact->heading_rad, before);
        project(drawn, contact->heading_rad, after);
        for (size_t k = 0; k < FITTED_KINDS; k++)
            shown += fit->response[extent][k] * (after[k] - before[k]);
        fit->shown[n++] = shown;
    }
    if (n < SEEN_LEAST)
        return 0;
    qsort(fit->shown, n, sizeof *fit->shown, compare_doubles);
    const double half = sorted_quantile(fit->shown, n, 0.75) - sorted_quantile(fit->shown, n, 0.25);
    for (size_t j = 0; j < goal->levels; j++) {
        const double error = hypot(goal->error[j], quantile_error(goal->level[j], half, (double)n));
        residuals[j] = (sorted_quantile(fit->shown, n, goal->level[j]) - goal->value[j]) / error;
    }
    return goal->levels;
}

static size_t find_residuals(const struct move_fit *fit, const double *moves, double *residuals)
{
    const struct move_prior *prior = fit->prior;
    double sizes[FITTED_KINDS];
    size_t count = 0;
    for (size_t k = 0; k < EXTENT_KINDS; k++)
        count += fit->goals[k].levels ? add_extent_residuals(fit, moves, k, residuals + count) : 0;
    solve_lower(fit->factor, residuals, count);
    for (size_t k = 0; k < FITTED_KINDS; k++) {
        sizes[k] = prior->shift[k] + moves[k];
        residuals[count++] = sizes[k] / believed[k];
        residuals[count++] = (prior->stretch[k] + moves[FITTED_KINDS + k]) /
                             (believed[FITTED_KINDS + k] * fit->trust);
    }
    residuals[count++] = (sizes[FITTED_LENGTH] - sizes[FITTED_WIDTH]) / BELIEVED_RATIO;
    residuals[count++] = (sizes[FITTED_WIDTH] - sizes[FITTED_HEIGHT]) / BELIEVED_RATIO;
    residuals[count++] = (sizes[FITTED_LENGTH] - sizes[FITTED_HEIGHT]) / BELIEVED_RATIO;
    return count;
}

static double sum_of_squares(const double *values, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += values[i] * values[i];
    return sum;
}

/* Finds moves by Levenberg-Marquardt steps within a round's limits. buffers:
 * RESIDUALS*(MOVES+2). */
static void descend(const struct move_fit *fit, double *moves, double *buffers)
{
    double *now = buffers;
    double *tried = buffers + RESIDUALS;
    double *slopes = tried + RESIDUALS; /* MOVES x RESIDUALS */
    const double share = 1.0 / (1.0 + fit->prior->moves);
    double damping = 1e-2;
    size_t count = find_residuals(fit, moves, now);
    double cost = sum_of_squares(now, count);
    for (int step = 0; step < STEPS_MAX && damping < 1e6; step++) {
        double a[MOVES * MOVES], b[MOVES], next[MOVES];
        for (size_t i = 0; i < MOVES; i++) {
            const double nudge = 0.02 * most[i];
            memcpy(next, moves, sizeof next);
            next[i] += moves[i] > 0.0 ? -nudge : nudge;
            find_residuals(fit, next, slopes + i * RESIDUALS);
            for (size_t j = 0; j < count; j++)
                slopes[i * RESIDUALS + j] =
                    (slopes[i * RESIDUALS + j] - now[j]) / (next[i] - moves[i]);
        }
        for (size_t i = 0; i < MOVES; i++) {
            b[i] = 0.0;
            for (size_t j = 0; j < count; j++)
                b[i] -= slopes[i * RESIDUALS + j] * now[j];
            for (size_t k = 0; k < MOVES; k++) {
                a[i * MOVES + k] = 0.0;
                for (size_t j = 0; j < count; j++)
                    a[i * MOVES + k] += slopes[i * RESIDUALS + j] * slopes[k * RESIDUALS + j];
            }
            a[i * MOVES + i] *= 1.0 + damping;
        }
        if (!solve_symmetric(a, b, MOVES))
            return;
        for (size_t i = 0; i < MOVES; i++)
            next[i] = fmin(fmax(moves[i] + b[i], -most[i] * share), most[i] * share);
        count = find_residuals(fit, next, tried);
        const double next_cost = sum_of_squares(tried, count);
        const bool is_better = next_cost < cost;
        const bool is_done = fabs(cost - next_cost) < 1e-6 * cost;
        if (is_better) {
            memcpy(moves, next, sizeof next);
            memcpy(now, tried, count * sizeof *now);
            cost = next_cost;
        }
        damping *= is_better ? 0.3 : 4.0;
        if (is_done)
            return;
    }
}

/* Notes which contacts lie below each quantile of an extent: 1 - level if below, -level if not, 0
 * if they do not show it. below: levels x count. Returns the number of levels, or 0 where too few
 * contacts show the extent. */
static size_t note_below(const struct move_fit *fit, size_t extent, double *below)
{
    const struct quantile_goal *goal = &fit->goals[extent];
    size_t n = 0;
    for (size_t i = 0; i < fit->count; i++)
        if (isfinite(fit->contacts[i]->shown.of[extent]))
            fit->shown[n++] = fit->contacts[i]->shown.of[extent];
    if (n < SEEN_LEAST)
        return 0;
    qsort(fit->shown, n, sizeof *fit->shown, compare_doubles);
    for (size_t j = 0; j < goal->levels; j++) {
        const double value = sorted_quantile(fit->shown, n, goal->level[j]);
        for (size_t i = 0; i < fit->count; i++) {
            const double shown = fit->contacts[i]->shown.of[extent];
            below[j * fit->count + i] =
                isfinite(shown) ? (shown < value ? 1.0 : 0.0) - goal->level[j] : 0.0;
        }
    }
    return goal->levels;
}

/* Fills the factor from the correlation of quantiles. Quantiles of one sample err together as often
 * as the same contacts lie below both. Errors: MEMORY. */
static sonject_status correlate(struct move_fit *fit, struct report *report)
{
    const size_t count = fit->count;
    size_t n = 0;
    for (size_t k = 0; k < EXTENT_KINDS; k++)
        n += fit->goals[k].levels;
    double *below = allocate_array(n * count + 1, sizeof *below);
    fit->factor = allocate_array(n * n + 1, sizeof *fit->factor);
    if (!below || !fit->factor) {
        free(below);
        return report_out_of_memory(report, "the fit");
    }
    n = 0;
    for (size_t k = 0; k < EXTENT_KINDS; k++)
        n += fit->goals[k].levels ? note_below(fit, k, below + n * count) : 0;
    for (size_t i = 0; i < n; i++) {
        const double scale = sqrt(sum_of_squares(below + i * count, count));
        for (size_t c = 0; scale > 0.0 && c < count; c++)
            below[i * count + c] /= scale;
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double *sum = &fit->factor[i * n + j];
            *sum = i == j ? OWN_ERROR : 0.0;
            for (size_t c = 0; c < count; c++)
                *sum += below[i * count + c] * below[j * count + c];
        }
    factor_symmetric(fit->factor, n);
    free(below);
    return SONJECT_OK;
}

/* Chooses the contacts that are compared, and finds their mean draws and responses. Rounds are
 * compared whole: after a stretch only large or only small draws stay where they were. */
static void prepare(struct move_fit *fit, const struct drawn_contact *contacts, size_t count)
{
    for (size_t first = 0, end; first < count; first = end) {
        double sum = 0.0;
        for (end = first; end < count && contacts[end].round == contacts[first].round; end++)
            sum += nearness(&contacts[end]);
        for (size_t i = first; sum > NEAR_LEAST * (double)(end - first) && i < end; i++)
            fit->contacts[fit->count++] = &contacts[i];
    }
    for (size_t k = 0; k < FITTED_KINDS; k++)
        for (size_t i = 0; i < fit->count; i++)
            fit->centre[k] += fit->contacts[i]->now[k] / (double)fit->count;
    for (size_t k = 0; k < EXTENT_KINDS; k++)
        find_response(contacts, count, k, fit->response[k]);
}

sonject_status fit_moves(struct report *report, const struct drawn_contact *contacts, size_t count,
                         const struct quantile_goal *goals, const struct move_prior *prior,
                         struct draw_move *moves)
{
    struct move_fit fit = {.goals = goals, .prior = prior};
    double found[MOVES] = {0.0};
    fit.contacts = allocate_array(count + 1, sizeof *fit.contacts);
    fit.shown = allocate_array(count + 1, sizeof *fit.shown);
    double *buffers = allocate_array((MOVES + 2) * RESIDUALS, sizeof *buffers);
    sonject_status status =
        fit.contacts && fit.shown && buffers ? SONJECT_OK : report_out_of_memory(report, "the fit");
    if (status == SONJECT_OK) {
        /* Few contacts tell little of how wide their distribution is. */
        fit.trust = prior->contacts >= 100.0 ? 1.0 : prior->contacts >= 30.0 ? 0.7 : 0.45;
        prepare(&fit, contacts, count);
        if (fit.count < SEEN_LEAST)
            status = report_failure(report, SONJECT_ERROR_INPUT,
                                    "hardly any injected contact can be seen; give the campaign's "
                                    "targets levels over the seabed (level: {over_seabed: })");
    }
    THEN(status, correlate(&fit, report));
    if (status == SONJECT_OK)
        descend(&fit, found, buffers);
    moves_as_steps(&fit, found, moves);
    free(fit.contacts);
    free(fit.shown);
    free(fit.factor);
    free(buffers);
    return status;
}
