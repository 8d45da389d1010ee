/* One image of a campaign: which swath, where, and what of the scene is drawn how. */
#ifndef SONJECT_DATASET_IMAGE_PLAN_H
#define SONJECT_DATASET_IMAGE_PLAN_H

#include "dataset/campaign.h"

/* "key=value" for the scene, and where the campaign file says so. */
struct plan_key {
    char *text;
    struct tree_place place; /* line 0: nowhere */
};

struct image_plan {
    uint64_t id;
    uint32_t split, swath;
    uint32_t category; /* enum category; targets from CATEGORY_TARGET on */
    struct region chip;
    uint64_t seed;
    uint32_t object_count;
    struct plan_key *keys; /* owned; names of files in them are meant from the campaign's folder */
    size_t key_count;
};

/* The plan of image id, below campaign->images. plan: for image_plan_clear, also on failure.
 * Errors: MEMORY. */
sonject_status image_plan_make(struct report *report, const struct campaign *campaign, uint64_t id,
                               struct image_plan *plan);

/* A plan that tries the ends of all distributions: one with an object of a category (and of
 * clutter number item), in the first place of a swath. step 0: low ends, 1: high ends, and of
 * choices the step-th. */
sonject_status image_plan_try(struct report *report, const struct campaign *campaign,
                              uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                              struct image_plan *plan);
void image_plan_clear(struct image_plan *plan);

/* How many steps image_plan_try has use for: two, or as many as the longest choice has entries,
 * among what is drawn of an item, or, for NULL, of the scene itself. */
uint32_t image_plan_steps(const struct campaign *campaign, const struct item *item);

/* Whether each target comes often enough for all cells of a grid. Errors: INPUT. */
sonject_status image_plan_check_grid(const struct campaign *campaign);

/* The split that an image is in, and the swath that it is cut out of. */
uint32_t image_split(const struct campaign *campaign, uint64_t id);
uint32_t image_swath(const struct campaign *campaign, uint64_t id);

#endif
