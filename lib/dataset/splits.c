/* Swaths into splits, images into swaths. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/campaign.h"
#include "dataset/distribution.h"

#define SWATH_STREAM 0x30000001u /* beyond those of distributions */

/* Swaths with one identity form a group, which is named after its first. */
struct groups {
    uint32_t *group_of; /* of each swath */
    uint32_t *split_of; /* of each group, SPLIT_OPEN until it has one */
    uint32_t *open;     /* groups without a split, in random order */
    size_t open_count, count;
};

#define SPLIT_OPEN UINT32_MAX

static uint32_t split_named(const struct campaign *campaign, const char *name)
{
    uint32_t number = 0;
    while (strcmp(campaign->splits[number].name, name) != 0)
        number++;
    return number;
}

static sonject_status take_wish(struct campaign *campaign, struct groups *groups, size_t swath)
{
    const struct swath_plan *plan = &campaign->swaths[swath];
    if (!plan->split)
        return SONJECT_OK;
    uint32_t *split = &groups->split_of[groups->group_of[swath]];
    const uint32_t wish = split_named(campaign, plan->split);
    if (*split != SPLIT_OPEN && *split != wish)
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "%s is the same image as %s, which is in split %s: no swath may be in "
                            "two",
                            plan->written, campaign->swaths[groups->group_of[swath]].written,
                            campaign->splits[*split].name);
    *split = wish;
    return SONJECT_OK;
}

static sonject_status find_groups(struct campaign *campaign, const char *const *identities,
                                  struct groups *groups)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; i < campaign->swath_count; i++) {
        uint32_t first = 0;
        while (strcmp(identities[first], identities[i]) != 0)
            first++;
        groups->group_of[i] = first;
        groups->split_of[i] = SPLIT_OPEN;
        groups->count += first == i;
    }
    for (size_t i = 0; status == SONJECT_OK && i < campaign->swath_count; i++)
        status = take_wish(campaign, groups, i);
    for (size_t i = 0; i < campaign->swath_count; i++)
        if (groups->group_of[i] == i && groups->split_of[i] == SPLIT_OPEN)
            groups->open[groups->open_count++] = (uint32_t)i;
    return status;
}

/* Open groups go, in random order, to the split that lacks most of its share; splits without any
 * come first. */
static sonject_status deal(struct campaign *campaign, struct groups *groups)
{
    double held[CAMPAIGN_SPLITS_MAX] = {0};
    for (size_t i = 0; i < campaign->swath_count; i++)
        if (groups->group_of[i] == i && groups->split_of[i] != SPLIT_OPEN)
            held[groups->split_of[i]] += 1.0;
    for (size_t i = 0; i < groups->open_count; i++) {
        uint32_t best = 0;
        double most = -1e300;
        for (uint32_t j = 0; j < campaign->split_count; j++) {
            const double lack = campaign->splits[j].fraction * (double)groups->count - held[j] +
                                (held[j] == 0.0 ? 1e9 : 0.0);
            if (lack > most + 1e-9) {
                most = lack;
                best = j;
            }
        }
        const uint64_t drawn = permuted_index(campaign->seed, SWATH_STREAM, i, groups->open_count);
        groups->split_of[groups->open[drawn]] = best;
        held[best] += 1.0;
    }
    for (size_t j = 0; j < campaign->split_count; j++)
        if (held[j] == 0.0)
            return tree_failure(&campaign->tree, campaign->swaths[0].place, "swaths",
                                "no swath is left for split %s: %zu different swaths are too few "
                                "for %zu splits, since no swath may be in two; add swaths or "
                                "remove splits",
                                campaign->splits[j].name, groups->count, campaign->split_count);
    return SONJECT_OK;
}

/* Exact shares of each kind of image in each split. */
static sonject_status share_kinds(struct report *report, const struct campaign *campaign,
                                  struct split *split)
{
    const size_t count = CATEGORY_TARGET + campaign->target_count;
    double *weights = allocate_array(count, sizeof *weights);
    double sum = 0.0;
    split->shares = allocate_array(count, sizeof *split->shares);
    if (weights && split->shares) {
        for (size_t i = 0; i < campaign->target_count; i++)
            sum += campaign->targets[i].weight;
        weights[CATEGORY_EMPTY] = campaign->empty;
        weights[CATEGORY_CLUTTER] = campaign->clutter_alone;
        for (size_t i = 0; i < campaign->target_count; i++)
            weights[CATEGORY_TARGET + i] =
                fmax(0.0, 1.0 - campaign->empty - campaign->clutter_alone) *
                (campaign->targets[i].weight / sum);
        share_out(split->images, weights, count, split->shares);
    }
    const bool is_made = weights && split->shares;
    free(weights);
    return is_made ? SONJECT_OK : report_out_of_memory(report, "the splits");
}

static sonject_status fill_splits(struct report *report, struct campaign *campaign,
                                  const struct groups *groups)
{
    double fractions[CAMPAIGN_SPLITS_MAX];
    uint64_t shares[CAMPAIGN_SPLITS_MAX];
    uint64_t first = 0;
    for (size_t j = 0; j < campaign->split_count; j++)
        fractions[j] = campaign->splits[j].fraction;
    share_out(campaign->images, fractions, campaign->split_count, shares);
    for (size_t j = 0; j < campaign->split_count; j++) {
        struct split *split = &campaign->splits[j];
        split->first_image = first;
        split->images = shares[j];
        first += shares[j];
        split->swaths = allocate_array(campaign->swath_count, sizeof *split->swaths);
        CHECK_MEMORY(report, split->swaths, "the splits");
        CHECK(share_kinds(report, campaign, split));
    }
    for (size_t i = 0; i < campaign->swath_count; i++) {
        struct swath_plan *plan = &campaign->swaths[i];
        plan->split_number = groups->split_of[groups->group_of[i]];
        struct split *split = &campaign->splits[plan->split_number];
        split->swaths[split->swath_count++] = (uint32_t)i;
    }
    return SONJECT_OK;
}

sonject_status campaign_split(struct report *report, struct campaign *campaign,
                              const char *const *identities)
{
    const size_t count = campaign->swath_count;
    struct groups groups = {allocate_array(count, sizeof(uint32_t)),
                            allocate_array(count, sizeof(uint32_t)),
                            allocate_array(count, sizeof(uint32_t)), 0, 0};
    sonject_status status = groups.group_of && groups.split_of && groups.open
                                ? find_groups(campaign, identities, &groups)
                                : report_out_of_memory(report, "the splits");
    THEN(status, deal(campaign, &groups));
    THEN(status, fill_splits(report, campaign, &groups));
    free(groups.group_of);
    free(groups.split_of);
    free(groups.open);
    return status;
}
