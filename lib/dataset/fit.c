/* The rounds of a fit. In each round chips are made and measured as the real contacts are, and the
 * results say how to move the draws. */
#include "dataset/fit.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#define CONTACTS_LEAST 10
#define CLEAR_LEAST    24 /* clear contacts of a round */
#define PAD_MOST       16.0
#define PAD_CLEAR      0.75   /* pixels */
#define SHADOW_SEEN_DB (-2.3) /* visibility up to which labellers see a shadow */
#define RATIOS_LEAST   1.05   /* farthest over nearest range at least, to limit chips by them */

/* Returns the value below which a share of the finite values lies; NaN: no value is finite. Moves
 * the finite values to the front and sorts them. */
static double quantile_of(double *values, size_t count, double share)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(values[i]))
            values[n++] = values[i];
    qsort(values, n, sizeof *values, compare_doubles);
    return n > 0 ? sorted_quantile(values, n, share) : NAN;
}

/* ---- Real contacts. */

static sonject_status measure_real(struct fit *fit)
{
    const struct contact_set *set = &fit->set;
    fit->real = allocate_array(set->count, sizeof *fit->real);
    CHECK_MEMORY(fit->report, fit->real, "contacts");
    fit->swaths = allocate_array(set->count, sizeof *fit->swaths);
    CHECK_MEMORY(fit->report, fit->swaths, "contacts");
    for (size_t i = 0; i < set->count; i++) {
        const struct labelled_contact *contact = &set->contacts[i];
        const char *image = set->images[contact->image];
        struct contact_chip chip;
        sonject_status status = contact_chip_read(fit->campaign, image, contact, &chip);
        THEN(status, contact_chip_measure(fit->report, &chip, contact->part, &fit->real[i]));
        fit->swaths[i] = chip.swath;
        const bool is_shown = status == SONJECT_OK && fit->real_chip_count < FIT_SHOWN &&
                              i * FIT_SHOWN / set->count >= fit->real_chip_count;
        if (is_shown)
            fit->real_chips[fit->real_chip_count++] = chip;
        else
            contact_chip_clear(&chip);
        if (status != SONJECT_OK)
            return status;
        fit->real_count++;
    }
    return SONJECT_OK;
}

/* Leaves shadows out where fewer real contacts show one than an extent needs, or fewer than a
 * third. Up to a fifth of bright points without a shadow have dark speckle that looks like one. */
static void leave_out_shadows(struct fit *fit)
{
    static const enum extent of_shadows[] = {EXTENT_SHADOW_ALONG, EXTENT_SHADOW_HEIGHT,
                                             EXTENT_SHADOW_ROWS, EXTENT_SHADOW_SLANT,
                                             EXTENT_SHADOW_LEVEL};
    size_t seen = 0;
    char note[160];
    for (size_t i = 0; i < fit->real_count; i++)
        seen += isfinite(fit->real[i].of[EXTENT_SHADOW_LEVEL]) &&
                !(fit->real[i].shadow_visibility_db > SHADOW_SEEN_DB);
    if (seen >= SEEN_LEAST && 3 * seen >= fit->real_count)
        return;
    snprintf(
        note, sizeof note,
        "only %zu of %zu contacts show a shadow, so heights and the noise floor stay as they are",
        seen, fit->real_count);
    report_note(fit->report, "%s", note);
    growing_text_add(&fit->notes, "%s\n", note);
    fit->draws.contacts_lack_shadows = true;
    for (size_t i = 0; i < fit->real_count; i++) {
        fit->real[i].shadow_visibility_db = NAN;
        for (size_t k = 0; k < COUNT(of_shadows); k++)
            fit->real[i].of[of_shadows[k]] = NAN;
    }
}

/* Returns a quantile of a member. extents: count of them, stride bytes apart. values: room. */
static double quantile_of_member(const struct contact_extents *extents, size_t stride, size_t count,
                                 size_t member, double share, double *values)
{
    for (size_t i = 0; i < count; i++)
        memcpy(&values[i], (const char *)extents + i * stride + member, sizeof *values);
    return quantile_of(values, count, share);
}

/* Leaves real contacts out that are less visible than injected ones will be. */
static void leave_out_less_seen(struct fit *fit)
{
    size_t kept = 0;
    for (size_t i = 0; i < fit->real_count; i++)
        if (!(fit->real[i].highlight_visibility_db < fit->selection.highlight_db ||
              fit->real[i].shadow_visibility_db > fit->selection.shadow_db))
            fit->real[kept++] = fit->real[i];
    fit->real_count = kept;
}

/* Returns the limits of range over altitude between which contacts of a swath lie; SIZE_MAX: of all
 * swaths. Zeros where contacts are too few or too near each other. values: room for all. */
static struct ratio_limits ratios_of_contacts(const struct fit *fit, size_t swath, double *values)
{
    size_t n = 0;
    for (size_t i = 0; i < fit->real_count; i++)
        if (swath == SIZE_MAX || fit->swaths[i] == swath)
            values[n++] = fit->real[i].range_over_altitude;
    const struct ratio_limits limits = {fmax(1.0, quantile_of(values, n, 0.05)),
                                        quantile_of(values, n, 0.95)};
    return n >= CONTACTS_LEAST && limits.most > RATIOS_LEAST * limits.least
               ? limits
               : (struct ratio_limits){0.0, 0.0};
}

/* Sets the limits of chips to the contacts' ranges, swath by swath, and the visibility of targets
 * so that all contacts but one in fifty reach it. Leaving out more would make the comparison
 * narrower than what a labeller sees. */
static sonject_status take_contacts(struct fit *fit)
{
    CHECK(measure_real(fit));
    leave_out_shadows(fit);
    const size_t count = fit->real_count;
    const double share = (floor((double)count / 50.0) + 2.0 / 3.0) / ((double)count + 1.0 / 3.0);
    double *values = allocate_array(count, sizeof *values);
    CHECK_MEMORY(fit->report, values, "contacts");
#define OF_REAL(member, share)                                                                     \
    quantile_of_member(fit->real, sizeof *fit->real, count,                                        \
                       offsetof(struct contact_extents, member), share, values)
    fit->selection.highlight_db = OF_REAL(highlight_visibility_db, share);
    fit->selection.shadow_db = OF_REAL(shadow_visibility_db, 1.0 - share);
#undef OF_REAL
    const size_t swaths = fit->campaign->campaign.swath_count;
    fit->selection.swaths = allocate_array(swaths, sizeof *fit->selection.swaths);
    fit->selection.chip = ratios_of_contacts(fit, SIZE_MAX, values);
    for (size_t i = 0; fit->selection.swaths && swaths > 1 && i < swaths; i++)
        fit->selection.swaths[i] = ratios_of_contacts(fit, i, values);
    free(values);
    CHECK_MEMORY(fit->report, fit->selection.swaths, "contacts");
    leave_out_less_seen(fit);
    return quantile_goals(fit->report, fit->real, fit->real_count, fit->goals);
}

/* Takes goals from published quantiles. */
static void take_quantiles(struct fit *fit)
{
    static const enum extent extents[] = {EXTENT_HIGHLIGHT_ALONG, EXTENT_HIGHLIGHT_SLANT,
                                          EXTENT_SHADOW_ALONG, EXTENT_SHADOW_SLANT};
    const struct extent_quantiles *told = &fit->set.quantiles;
    for (size_t k = 0; k < COUNT(extents); k++) {
        struct quantile_goal *goal = &fit->goals[extents[k]];
        double values[QUANTILES_MAX];
        for (size_t i = 0; i < told->count; i++) {
            values[i] = log(told->extents_m[k][i]);
            if (!isfinite(values[i]))
                continue;
            goal->level[goal->levels] = told->levels[i];
            goal->value[goal->levels++] = values[i];
        }
        const double half =
            goal->levels > 1 ? 0.5 * (goal->value[goal->levels - 1] - goal->value[0]) : 0.5;
        for (size_t i = 0; i < goal->levels; i++)
            goal->error[i] = quantile_error(goal->level[i], half, told->contacts);
    }
}

/* ---- Rounds. */

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
        status = campaign_open(fit->report, &source, opened);
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
        if (status == SONJECT_OK) {
            report_note(fit->report, "%s", notes[i]);
            growing_text_add(&fit->notes, "%s\n", notes[i]);
        }
    }
    return status;
}

/* Keeps the drawn values of a contact. A height that is not observed is kept constant, so that a
 * sphere's height takes no part of the diameter that its highlight shows. */
static void note_drawn(const struct fit *fit, const struct campaign_image *image,
                       struct drawn_contact *contact)
{
    const sonject_object_truth *truth = image->result.objects;
    const double proud = truth->overall_height_m - fmax(truth->burial_m, 0.0);
    double *drawn = contact->drawn;
    drawn[FITTED_LENGTH] = log(truth->overall_length_m);
    drawn[FITTED_WIDTH] = log(truth->overall_width_m);
    drawn[FITTED_HEIGHT] = fit->draws.contacts_lack_shadows ? 0.0 : log(fmax(proud, 1e-3));
    drawn[FITTED_LEVEL] = truth->over_seabed_db;
    drawn[FITTED_FLOOR] = image->result.statistics.noise_floor_db;
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
    draws->level_db[0] = quantile_of(values, count, 0.1);
    draws->level_db[1] = quantile_of(values, count, 0.9);
    for (size_t i = 0; i < count; i++)
        values[i] = fit->made[i].drawn[FITTED_FLOOR];
    draws->floor_db = quantile_of(values, count, 0.5);
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

/* Returns the median that real contacts show less that of injected ones; 0: not compared. */
static double middle_difference(const struct fit *fit, size_t extent, double *values)
{
    const struct quantile_goal *goal = &fit->goals[extent];
    for (size_t i = 0; i < fit->made_count; i++)
        values[i] = fit->made[i].shown.of[extent];
    const double made = quantile_of(values, fit->made_count, 0.5);
    for (size_t i = 0; i < goal->levels; i++)
        if (goal->level[i] == 0.5 && isfinite(made))
            return goal->value[i] - made;
    return 0.0;
}

/* Moves levels alone at first: while levels are far off, highlights tell little of sizes. */
static sonject_status move_levels(const struct fit *fit, struct draw_move *moves)
{
    static const struct draw_move none = {0.0, 0.0, 1.0};
    double *values = allocate_array(fit->made_count + 1, sizeof *values);
    CHECK_MEMORY(fit->report, values, "the fit");
    for (size_t k = 0; k < FITTED_KINDS; k++)
        moves[k] = none;
    moves[FITTED_LEVEL].shift = middle_difference(fit, EXTENT_HIGHLIGHT_LEVEL, values);
    moves[FITTED_FLOOR].shift = middle_difference(fit, EXTENT_SHADOW_LEVEL, values);
    free(values);
    return SONJECT_OK;
}

/* Moves the draws, and applies the same moves to the values that earlier contacts drew. */
static sonject_status move_draws(struct fit *fit, uint32_t round, struct move_prior *prior)
{
    struct draw_move moves[FITTED_KINDS];
    CHECK(round == 0
              ? move_levels(fit, moves)
              : fit_moves(fit->report, fit->made, fit->made_count, fit->goals, prior, moves));
    for (size_t k = 0; k < FITTED_KINDS; k++) {
        if (round + 2 == FIT_ROUNDS) { /* half of the last move would be chance */
            moves[k].shift *= 0.5;
            moves[k].stretch = sqrt(moves[k].stretch);
        }
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

static sonject_status run_rounds(struct fit *fit, struct device_slot *slot,
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
    }
    return SONJECT_OK;
}

/* ---- The whole. */

static sonject_status check_fitted(const struct fit *fit, const char *fitted)
{
    char *folder = path_folder(fitted);
    CHECK_MEMORY(fit->report, folder, "the fit");
    const bool is_same = paths_are_same(folder, fit->campaign->campaign.folder);
    free(folder);
    if (!is_same)
        return input_failure(
            fit->report, fitted,
            "must lie in the folder of %s, because its file names are relative to that folder",
            fit->source.path);
    if (paths_are_same(fitted, fit->source.path))
        return input_failure(fit->report, fitted,
                             "is the campaign that is fitted; choose another name");
    return SONJECT_OK;
}

static sonject_status read_all(struct fit *fit, const sonject_campaign_fit_params *params)
{
    CHECK(campaign_open(fit->report, &fit->source, &fit->campaign));
    CHECK(check_fitted(fit, params->fitted));
    CHECK(fit_page_name(fit->report, params->fitted, "_fit", fit->folder));
    fit->campaign->folder = fit->folder;
    CHECK(contact_set_read(fit->report, params->contacts, &fit->choice, &fit->set));
    if (fit->set.quantiles.count > 0)
        take_quantiles(fit);
    else if (fit->set.count < CONTACTS_LEAST)
        return input_failure(fit->report, params->contacts,
                             "has %zu contacts%s; a fit needs %d or more", fit->set.count,
                             fit->choice.class_count > 0 ? " of the chosen classes" : "",
                             CONTACTS_LEAST);
    else
        CHECK(take_contacts(fit));
    CHECK(fit_draws_find(&fit->draws, fit->report, &fit->campaign->campaign));
    if (fit->draws.fixed.characters)
        growing_text_add(&fit->notes, "%s\n", fit->draws.fixed.characters);
    return SONJECT_OK;
}

static sonject_status write_all(const struct fit *fit, const char *fitted, const char *contacts)
{
    char comment[512], name[200];
    char *text;
    snprintf(comment, sizeof comment, "# Fitted by sonject %s to %s: draws of sizes%s.\n",
             sonject_version(), text_excerpt(name, sizeof name, path_name(contacts)),
             fit->draws.contacts_lack_shadows ? " and levels" : ", levels and the noise floor");
    CHECK(fit_draws_text(&fit->draws, fit->report, &fit->selection, comment, &text));
    sonject_status status = fit_page_write(fit, fitted);
    THEN(status, file_write_whole(fit->report, fitted, text, strlen(text)));
    free(text);
    return status;
}

sonject_status campaign_fit(struct report *report, struct device_slot *slot,
                            const struct campaign_source *source,
                            const sonject_campaign_fit_params *params,
                            sonject_progress_function progress, void *user)
{
    struct fit *fit = allocate_array(1, sizeof *fit);
    CHECK_MEMORY(report, fit, "the fit");
    fit->report = report;
    fit->source = *source;
    fit->choice = (struct contact_choice){params->part, params->classes, params->class_count};
    fit->selection = (struct fitted_selection){.highlight_db = NAN, .shadow_db = NAN};
    sonject_status status = read_all(fit, params);
    THEN(status, run_rounds(fit, slot, progress, user));
    THEN(status, write_all(fit, params->fitted, params->contacts));
    for (size_t i = 0; i < FIT_SHOWN; i++) {
        contact_chip_clear(&fit->real_chips[i]);
        contact_chip_clear(&fit->made_chips[i]);
    }
    fit_draws_clear(&fit->draws);
    free(growing_text_end(&fit->notes));
    campaign_close(&fit->campaign);
    contact_set_clear(&fit->set);
    free(fit->selection.swaths);
    free(fit->swaths);
    free(fit->real);
    free(fit->made);
    free(fit);
    return status;
}
