/* The rounds of a fit. In each round chips are made and measured as the real contacts are, and the
 * results say how to move the draws. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/fit.h"

#define CLEAR_LEAST  24   /* clear contacts of a round */
#define LEVEL_ROUNDS 2    /* first rounds, which move only levels */
#define CUT_MOST     0.25 /* share of shadows that images cut beyond that of real ones */
#define PAD_MOST     16.0
#define PAD_CLEAR    0.75 /* pixels */

/* Opens the campaign with the current draws and a round's number of images, each with a target. */
static sonject_status open_round(struct fit *fit, uint32_t round, struct sonject_campaign **opened)
{
    const struct campaign *campaign = &fit->campaign->campaign;
    const size_t given = fit->source.override_count;
    struct fitted_selection selection = fit->selection;
    char images[32], seed[48];
    char *text = NULL;
    const char **overrides = allocate_array(given + 3, sizeof *overrides);
    CHECK_MEMORY(fit->report, overrides, "the fit");
    if (given > 0)
        memcpy(overrides, fit->source.overrides, given * sizeof *overrides);
    snprintf(images, sizeof images, "images=%d", FIT_CHIPS);
    snprintf(seed, sizeof seed, "seed=%llu",
             (unsigned long long)((campaign->seed + round) & 0xffffffffu));
    overrides[given] = images;
    overrides[given + 1] = seed;
    overrides[given + 2] = "design=stratified";
    if (round == 0) /* no target may be seen with the first levels */
        selection.highlight_db = selection.shadow_db = NAN;
    *opened = NULL;
    sonject_status status = fit_draws_text(&fit->draws, fit->report, &selection, "", &text);
    if (status == SONJECT_OK) {
        struct campaign_source source = fit->source;
        source.text = text;
        source.overrides = overrides;
        source.override_count = given + 3;
        source.has_one_target = true;
        const sonject_log_function log = fit->report->log;
        fit->report->log = NULL; /* it told the notes when it opened the campaign to be fitted */
        status = campaign_open(fit->report, &source, opened);
        fit->report->log = log;
        if (status == SONJECT_OK) {
            /* faint targets are left out, not drawn again, since time is limited */
            (*opened)->campaign.faint = FAINT_DIFFICULT;
            (*opened)->folder = fit->folder;
        }
    }
    free(text);
    free(overrides);
    return status;
}

/* Opens the first round. Where some swath does not reach the contacts' ranges, only the swaths that
 * show contacts keep their limits; where these do not reach either, none does. */
static sonject_status open_first(struct fit *fit, struct sonject_campaign **opened)
{
    static const char *const notes[] = {
        "some swath does not reach the contacts' ratios of range to altitude, so only images of "
        "swaths that show contacts are limited to them",
        "the campaign's swaths do not reach the contacts' ratios of range to altitude, so images "
        "stay in the same places"};
    sonject_status status = open_round(fit, 0, opened);
    if (!(fit->selection.chip.least > 0.0))
        return status;
    bool is_by_swath = false;
    for (size_t i = 0; i < fit->campaign->campaign.swath_count; i++)
        is_by_swath |= fit->selection.swaths[i].least > 0.0;
    for (size_t i = is_by_swath ? 0 : 1; i < COUNT(notes) && status == SONJECT_ERROR_INPUT; i++) {
        fit->selection.chip = (struct ratio_limits){0.0, 0.0};
        if (i > 0) {
            free(fit->selection.swaths);
            fit->selection.swaths = NULL;
        }
        status = open_round(fit, 0, opened);
        if (status == SONJECT_OK)
            fit_note(fit, notes[i]);
    }
    return status;
}

/* Keeps the drawn values of a contact. Kinds that are not observed are kept constant, so that, for
 * one, a sphere's height takes no part of the diameter that its highlight shows. */
static void note_drawn(const struct fit *fit, const struct campaign_image *image,
                       struct drawn_contact *contact)
{
    const sonject_object_truth *truth = image->result.objects;
    const double proud = truth->overall_height_m - fmax(truth->burial_m, 0.0);
    double *drawn = contact->drawn;
    drawn[FITTED_LENGTH] = log(truth->overall_length_m);
    drawn[FITTED_WIDTH] = log(truth->overall_width_m);
    drawn[FITTED_HEIGHT] = log(fmax(proud, 1e-3));
    drawn[FITTED_LEVEL] = truth->over_seabed_db;
    drawn[FITTED_FLOOR] = image->result.statistics.noise_floor_db;
    for (int kind = 0; kind < FITTED_KINDS; kind++)
        if (fit->draws.unseen & FITTED_BIT(kind))
            drawn[kind] = 0.0;
    contact->heading_rad = image->scene.objects[0].heading_rad;
    memcpy(contact->now, drawn, sizeof contact->now);
}

/* A round's images, which are made in parallel. */
struct fit_round {
    struct fit *fit;
    uint32_t number;
    char stage[64];
    sonject_progress_function progress;
    void *user;
    struct round_contact {
        bool is_there; /* the image has something to label */
        struct drawn_contact contact;
        struct contact_chip chip; /* owned; kept in the last round */
    } contacts[FIT_CHIPS];
};

/* Makes and measures a contact. Called by several threads; changes only the image's own entry. */
static sonject_status make_contact(void *user, const struct image_maker *maker, uint64_t id)
{
    struct fit_round *round = user;
    const struct fit *fit = round->fit;
    struct report *report = maker->campaign->report;
    struct round_contact *made = &round->contacts[id];
    struct campaign_image image;
    bool is_seen = false;
    memset(&image, 0, sizeof image);
    sonject_status status = campaign_image_make(maker->device, maker->campaign, id, maker->progress,
                                                maker->user, &image);
    THEN(status,
         contact_chip_of_image(report, &image, fit->choice.part, fit->pad, &made->chip, &is_seen));
    if (status == SONJECT_OK && is_seen && isfinite(image.result.objects->over_seabed_db)) {
        made->contact.round = round->number;
        made->contact.is_faint = image.is_faint[0];
        note_drawn(fit, &image, &made->contact);
        status = contact_chip_measure(report, &made->chip, fit->choice.part, &made->contact.shown);
        made->is_there = status == SONJECT_OK;
    }
    if (round->number + 1 < FIT_ROUNDS)
        contact_chip_clear(&made->chip);
    campaign_image_clear(&image);
    return status;
}

/* Takes a round's contacts in the order of their images, not of their making. */
static void take_round(struct fit *fit, struct fit_round *round)
{
    for (size_t id = 0; id < FIT_CHIPS; id++) {
        struct round_contact *made = &round->contacts[id];
        if (made->is_there)
            fit->made[fit->made_count++] = made->contact;
        if (made->is_there && made->chip.intensity && !made->contact.is_faint &&
            fit->made_chip_count < FIT_SHOWN) {
            fit->made_chips[fit->made_chip_count++] = made->chip;
            made->chip.intensity = NULL;
        }
        contact_chip_clear(&made->chip);
    }
}

static int tell_round(void *user, double done, const char *stage)
{
    const struct fit_round *round = user;
    (void)stage;
    return round->progress &&
           round->progress(round->user, ((double)round->number + done / FIT_CHIPS) / FIT_ROUNDS,
                           round->stage) != 0;
}

/* Makes the draws that the campaign lacks from the results of the first round. */
static sonject_status learn_from_first(struct fit *fit)
{
    struct fit_draws *draws = &fit->draws;
    const size_t count = fit->made_count;
    double *values = allocate_array(count + 1, sizeof *values);
    CHECK_MEMORY(fit->report, values, "the fit");
    for (size_t i = 0; i < count; i++)
        values[i] = fit->made[i].drawn[FITTED_LEVEL];
    draws->level_db[0] = finite_quantile(values, count, 0.1);
    draws->level_db[1] = finite_quantile(values, count, 0.9);
    for (size_t i = 0; i < count; i++)
        values[i] = fit->made[i].drawn[FITTED_FLOOR];
    draws->floor_db = finite_quantile(values, count, 0.5);
    draws->has_added = count > 0;
    free(values);
    return SONJECT_OK;
}

/* Returns the mean of the pixels by which labels are wider than the parts that show. */
static double mean_pad(const struct contact_extents *extents, size_t stride, size_t count)
{
    double sum = 0.0;
    double seen = 0.0;
    for (size_t i = 0; i < count; i++) {
        double pad;
        memcpy(&pad,
               (const char *)extents + i * stride + offsetof(struct contact_extents, pad_pixels),
               sizeof pad);
        sum += isfinite(pad) ? pad : 0.0;
        seen += isfinite(pad) ? 1.0 : 0.0;
    }
    return seen > 0.0 ? sum / seen : 0.0;
}

/* Makes labels of injected contacts as wide as real ones, where the last round's, from the first-th
 * contact on, clearly were not. */
static void widen_labels(struct fit *fit, size_t first)
{
    const double wider =
        mean_pad(fit->real, sizeof *fit->real, fit->real_count) -
        mean_pad(&fit->made[first].shown, sizeof *fit->made, fit->made_count - first);
    if (fit->real_count > 0 && fabs(wider) > PAD_CLEAR)
        fit->pad = (uint64_t)fmin(fmax((double)fit->pad + round(wider), 0.0), PAD_MOST);
}

/* Returns the median that real contacts show less that of a round's injected ones; 0: not compared.
 * In the first round levels count as drawn: the image's ceiling may cut what the highlights show.
 */
static double middle_difference(const struct fit *fit, uint32_t round, size_t extent,
                                double *values)
{
    const struct quantile_goal *goal = &fit->goals[extent];
    const bool is_as_drawn = round == 0 && extent == EXTENT_HIGHLIGHT_LEVEL;
    for (size_t i = 0; i < fit->made_count; i++) {
        const struct drawn_contact *made = &fit->made[i];
        values[i] = made->round != round ? NAN
                    : is_as_drawn        ? made->drawn[FITTED_LEVEL]
                                         : made->shown.of[extent];
    }
    const double made = finite_quantile(values, fit->made_count, 0.5);
    for (size_t i = 0; i < goal->levels; i++)
        if (goal->level[i] == 0.5 && isfinite(made))
            return goal->value[i] - made;
    return 0.0;
}

/* Moves levels alone at first: while levels are far off, highlights tell little of sizes. */
static sonject_status move_levels(const struct fit *fit, uint32_t round, struct draw_move *moves)
{
    static const struct draw_move none = {0.0, 0.0, 1.0};
    double *values = allocate_array(fit->made_count + 1, sizeof *values);
    CHECK_MEMORY(fit->report, values, "the fit");
    for (size_t k = 0; k < FITTED_KINDS; k++)
        moves[k] = none;
    moves[FITTED_LEVEL].shift = middle_difference(fit, round, EXTENT_HIGHLIGHT_LEVEL, values);
    moves[FITTED_FLOOR].shift = middle_difference(fit, round, EXTENT_SHADOW_LEVEL, values);
    free(values);
    return SONJECT_OK;
}

/* Moves the draws, and applies the same moves to the values that earlier contacts drew. */
static sonject_status move_draws(struct fit *fit, uint32_t round, struct move_prior *prior)
{
    struct draw_move moves[FITTED_KINDS];
    CHECK(round < LEVEL_ROUNDS
              ? move_levels(fit, round, moves)
              : fit_moves(fit->report, fit->made, fit->made_count, fit->goals, prior, moves));
    prior->moves += round < LEVEL_ROUNDS ? 0.0 : 1.0;
    for (size_t k = 0; k < FITTED_KINDS; k++) {
        prior->shift[k] += moves[k].shift;
        prior->stretch[k] += log(moves[k].stretch);
        for (size_t i = 0; i < fit->made_count; i++)
            fit->made[i].now[k] = draw_moved(&moves[k], fit->made[i].now[k]);
    }
    fit_draws_move(&fit->draws, moves);
    return SONJECT_OK;
}

/* Leaves faint contacts out, from the first-th on, as labellers do. If nearly all are faint, all
 * stay, since the draws are still far off. */
static void leave_out_faint(struct fit *fit, size_t first)
{
    size_t kept = first;
    for (size_t i = first; i < fit->made_count; i++)
        kept += !fit->made[i].is_faint;
    if (kept < first + CLEAR_LEAST)
        return;
    kept = first;
    for (size_t i = first; i < fit->made_count; i++)
        if (!fit->made[i].is_faint)
            fit->made[kept++] = fit->made[i];
    fit->made_count = kept;
}

static sonject_status run_round(struct fit *fit, const struct device_slot *slot, uint32_t number,
                                sonject_progress_function progress, void *user)
{
    struct sonject_campaign *campaign = NULL;
    struct fit_round *round = allocate_array(1, sizeof *round);
    CHECK_MEMORY(fit->report, round, "the fit");
    *round = (struct fit_round){.fit = fit, .number = number, .progress = progress, .user = user};
    snprintf(round->stage, sizeof round->stage, "round %u of %d", (unsigned)number + 1, FIT_ROUNDS);
    const struct image_work work = {FIT_CHIPS, make_contact, tell_round, round};
    sonject_status status =
        number == 0 ? open_first(fit, &campaign) : open_round(fit, number, &campaign);
    THEN(status, campaign_work(campaign, slot, &work));
    if (status == SONJECT_CANCELLED)
        report_failure(fit->report, status, "cancelled in %s", round->stage);
    take_round(fit, round);
    campaign_close(&campaign);
    free(round);
    return status;
}

/* Returns the share of shadows that images cut. */
static double cut_share(const struct contact_extents *extents, size_t stride, size_t count)
{
    size_t seen = 0;
    size_t cut = 0;
    for (size_t i = 0; i < count; i++) {
        struct contact_extents of;
        memcpy(&of, (const char *)extents + i * stride, sizeof of);
        const bool is_seen = isfinite(of.of[EXTENT_SHADOW_HEIGHT]);
        seen += is_seen;
        cut += is_seen && of.is_shadow_cut;
    }
    return seen > 0 ? (double)cut / (double)seen : 0.0;
}

/* Tells where the campaign's images cut more shadows of the last round, from the first-th contact
 * on, than real images do. Such shadows stay short, however high the targets are made. */
static void tell_cut_shadows(struct fit *fit, size_t first)
{
    const double real = cut_share(fit->real, sizeof *fit->real, fit->real_count);
    const double made =
        cut_share(&fit->made[first].shown, sizeof *fit->made, fit->made_count - first);
    char note[200];
    if ((fit->draws.unseen & FITTED_BIT(FITTED_HEIGHT)) || made < real + CUT_MOST)
        return;
    snprintf(
        note, sizeof note,
        "the campaign's images cut %.0f %% of the injected shadows, far more than of real ones, "
        "so heights come out too great: fit with larger images (chip.columns)",
        100.0 * made);
    fit_note(fit, note);
}

sonject_status fit_run_rounds(struct fit *fit, struct device_slot *slot,
                              sonject_progress_function progress, void *user)
{
    struct move_prior prior = {.contacts = fit->real_count > 0 ? (double)fit->set.count
                                                               : fit->set.quantiles.contacts};
    fit->made = allocate_array((size_t)FIT_ROUNDS * FIT_CHIPS, sizeof *fit->made);
    CHECK_MEMORY(fit->report, fit->made, "the fit");
    for (uint32_t round = 0; round < FIT_ROUNDS; round++) {
        const size_t first = fit->made_count;
        CHECK(run_round(fit, slot, round, progress, user));
        leave_out_faint(fit, first);
        if (round == 0)
            CHECK(learn_from_first(fit));
        else
            widen_labels(fit, first);
        if (round + 1 < FIT_ROUNDS)
            CHECK(move_draws(fit, round, &prior));
        else
            tell_cut_shadows(fit, first);
    }
    return SONJECT_OK;
}
