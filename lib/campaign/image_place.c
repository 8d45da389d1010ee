/* Where an image lies, and of what kind it is. */
#include "campaign/design.h"
#include "campaign/drawing.h"

static void choose_chip(const struct campaign *campaign, struct image_plan *plan, uint64_t index,
                        uint64_t count)
{
    double u, v;
    if (campaign->design == DESIGN_STRATIFIED) {
        u = stratified_number(campaign->seed, STREAM_CHIP_ROW + plan->swath, index, count);
        v = stratified_number(campaign->seed, STREAM_CHIP_COLUMN + plan->swath, index, count);
    } else {
        u = uniform_number(campaign->seed, STREAM_CHIP_ROW, plan->id);
        v = uniform_number(campaign->seed, STREAM_CHIP_COLUMN, plan->id);
    }
    chip_room_choose(&campaign->swaths[plan->swath].room, u, v, &plan->chip.first_row,
                     &plan->chip.first_column);
}

uint32_t image_split(const struct campaign *campaign, uint64_t id)
{
    uint32_t number = 0;
    while (id - campaign->splits[number].first_image >= campaign->splits[number].images)
        number++;
    return number;
}

/* Images of a split follow its swaths: as many from each, but for one. */
static uint64_t swath_within(const struct split *split, uint64_t within)
{
    return within * split->swath_count / split->images;
}

uint32_t image_swath(const struct campaign *campaign, uint64_t id)
{
    const struct split *split = &campaign->splits[image_split(campaign, id)];
    return split->swaths[swath_within(split, id - split->first_image)];
}

static void choose_swath(const struct campaign *campaign, struct image_plan *plan, uint64_t within)
{
    const struct split *split = &campaign->splits[plan->split];
    const uint64_t swaths = split->swath_count;
    const uint64_t number = swath_within(split, within);
    const uint64_t first = (number * split->images + swaths - 1) / swaths;
    const uint64_t end = ((number + 1) * split->images + swaths - 1) / swaths;
    plan->swath = split->swaths[number];
    choose_chip(campaign, plan, within - first, end - first);
}

/* The kind of image, in random order; index and count of the image among those of its kind. */
static void choose_kind(struct drawing *drawing, uint64_t within)
{
    const struct campaign *campaign = drawing->campaign;
    struct image_plan *plan = drawing->plan;
    const struct split *split = &campaign->splits[plan->split];
    uint64_t slot =
        permuted_index(category_seed(campaign, plan->split), STREAM_KIND, within, split->images);
    while (slot >= split->shares[plan->category])
        slot -= split->shares[plan->category++];
    drawing->index = slot;
    for (size_t i = 0; i < campaign->split_count; i++) {
        const uint64_t share = campaign->splits[i].shares[plan->category];
        drawing->index += i < plan->split ? share : 0;
        drawing->count += share;
    }
    drawing->cell = permuted_index(category_seed(campaign, plan->category), STREAM_GRID,
                                   drawing->index, drawing->count);
}

void choose_place(struct drawing *drawing)
{
    struct image_plan *plan = drawing->plan;
    plan->split = image_split(drawing->campaign, plan->id);
    const uint64_t within = plan->id - drawing->campaign->splits[plan->split].first_image;
    choose_swath(drawing->campaign, plan, within);
    choose_kind(drawing, within);
}
