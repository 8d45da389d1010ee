/* The fit of a campaign: real contacts are measured, rounds made, and the result written. */
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
#define SHADOW_SEEN_DB (-2.3) /* visibility up to which labellers see a shadow */
#define RATIOS_LEAST   1.05   /* farthest over nearest range at least, to limit chips by them */

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

void fit_note(struct fit *fit, const char *note)
{
    report_note(fit->report, "%s", note);
    growing_text_add(&fit->notes, "%s\n", note);
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
    fit_note(fit, note);
    fit->draws.unseen = FITTED_BIT(FITTED_HEIGHT) | FITTED_BIT(FITTED_FLOOR);
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
    return finite_quantile(values, count, share);
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
    const struct ratio_limits limits = {fmax(1.0, finite_quantile(values, n, 0.05)),
                                        finite_quantile(values, n, 0.95)};
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

/* Takes goals from published quantiles. What they do not tell stays. */
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
    const bool tells_height = fit->goals[EXTENT_SHADOW_SLANT].levels > 0;
    fit->draws.unseen = FITTED_BIT(FITTED_LEVEL) | FITTED_BIT(FITTED_FLOOR) |
                        (tells_height ? 0 : FITTED_BIT(FITTED_HEIGHT));
    const char *note = tells_height
                           ? "published extents tell no levels and no noise floor; these stay"
                           : "published extents tell no levels, no noise floor and, without "
                             "shadow_range, no heights; these stay";
    fit_note(fit, note);
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
    CHECK(contact_set_place(fit->campaign, &fit->set));
    contact_set_pair(fit->report, &fit->set);
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
             fit->draws.unseen & FITTED_BIT(FITTED_LEVEL)   ? ""
             : fit->draws.unseen & FITTED_BIT(FITTED_FLOOR) ? " and levels"
                                                            : ", levels and the noise floor");
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
    THEN(status, fit_run_rounds(fit, slot, progress, user));
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
