/* The assignment of a campaign's swaths to its splits. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/campaign.h"

#define SWATH_STREAM 0x30000001u /* above the streams of distributions */
#define SPLIT_OPEN   UINT32_MAX

/* Groups of swaths that show the same seabed: one side of equal files, at any frequency, or both if
 * a swath takes the whole file. A group is named after its first swath. */
struct groups {
    uint32_t *group_of; /* group of each swath; owned, with the arrays below */
    uint32_t *split_of; /* split of each group; SPLIT_OPEN: none yet */
    uint32_t *open;     /* groups without a split, in random order */
    size_t open_count, count;
};

/* Gives groups the splits that their swaths ask for. */
static sonject_status take_wishes(const struct campaign *campaign, struct groups *groups)
{
    for (size_t i = 0; i < campaign->swath_count; i++) {
        const struct swath_plan *plan = &campaign->swaths[i];
        uint32_t *split = &groups->split_of[groups->group_of[i]];
        uint32_t wish = 0;
        if (!plan->split)
            continue;
        while (strcmp(campaign->splits[wish].name, plan->split) != 0)
            wish++;
        if (*split != SPLIT_OPEN && *split != wish)
            return tree_failure(&campaign->tree, plan->place, "swaths",
                                "%s shows the same seabed as %s, which is in split %s: no swath "
                                "may be in two",
                                plan->written, campaign->swaths[groups->group_of[i]].written,
                                campaign->splits[*split].name);
        *split = wish;
    }
    return SONJECT_OK;
}

static bool show_same_seabed(const struct campaign *campaign, char (*hashes)[HASH_TEXT_CAPACITY],
                             size_t first, size_t second)
{
    const struct swath_plan *swaths = campaign->swaths;
    if (strcmp(hashes[first], hashes[second]) != 0)
        return false;
    bool is_same = swaths[first].side == swaths[second].side;
    for (size_t i = 0; i < campaign->swath_count && !is_same; i++)
        is_same = swaths[i].side == 0 && strcmp(hashes[i], hashes[first]) == 0;
    return is_same;
}

static sonject_status find_groups(const struct campaign *campaign,
                                  char (*hashes)[HASH_TEXT_CAPACITY], struct groups *groups)
{
    for (size_t i = 0; i < campaign->swath_count; i++) {
        uint32_t first = 0;
        while (!show_same_seabed(campaign, hashes, first, i))
            first++;
        groups->group_of[i] = first;
        groups->split_of[i] = SPLIT_OPEN;
        groups->count += first == i;
    }
    CHECK(take_wishes(campaign, groups));
    for (size_t i = 0; i < campaign->swath_count; i++)
        if (groups->group_of[i] == i && groups->split_of[i] == SPLIT_OPEN)
            groups->open[groups->open_count++] = (uint32_t)i;
    return SONJECT_OK;
}

/* Deals the open groups in random order. Each goes to the split that lacks most of its share, and
 * splits without any group come first. */
static sonject_status deal(const struct campaign *campaign, struct groups *groups)
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

/* Finds the number of images of each kind in a split. */
static sonject_status share_kinds(struct report *report, const struct campaign *campaign,
                                  struct split *split)
{
    const size_t count = CATEGORY_TARGET + campaign->target_count;
    const double rest = fmax(0.0, 1.0 - campaign->empty - campaign->clutter_alone);
    double *weights = allocate_array(count, sizeof *weights);
    double sum = 0.0;
    CHECK_MEMORY(report, weights, "the splits");
    for (size_t i = 0; i < campaign->target_count; i++)
        sum += campaign->targets[i].weight;
    weights[CATEGORY_EMPTY] = campaign->empty;
    weights[CATEGORY_CLUTTER] = campaign->clutter_alone;
    for (size_t i = 0; i < campaign->target_count; i++)
        weights[CATEGORY_TARGET + i] = rest * (campaign->targets[i].weight / sum);
    split->shares = allocate_array(count, sizeof *split->shares);
    if (split->shares)
        share_out(split->images, weights, count, split->shares);
    free(weights);
    return split->shares ? SONJECT_OK : report_out_of_memory(report, "the splits");
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
                              char (*hashes)[HASH_TEXT_CAPACITY])
{
    const size_t count = campaign->swath_count;
    struct groups groups = {allocate_array(count, 3 * sizeof *groups.group_of), NULL, NULL, 0, 0};
    CHECK_MEMORY(report, groups.group_of, "the splits");
    groups.split_of = groups.group_of + count;
    groups.open = groups.split_of + count;
    sonject_status status = find_groups(campaign, hashes, &groups);
    THEN(status, deal(campaign, &groups));
    THEN(status, fill_splits(report, campaign, &groups));
    free(groups.group_of);
    return status;
}
