/* How many images it takes to try all that a campaign may draw. */
#include "campaign/drawing.h"

static uint32_t longest(const struct draws *draws, uint32_t steps)
{
    for (size_t i = 0; i < draws->count; i++)
        if (draws->list[i].count > steps)
            steps = (uint32_t)draws->list[i].count;
    return steps;
}

uint32_t image_plan_steps(const struct campaign *campaign, const struct item *item)
{
    return item ? longest(&campaign->object_draws, longest(&item->draws, 2))
                : longest(&campaign->draws, 2);
}

/* Times the cells of these axes; what is too many stays so. */
static uint64_t count_cells(const struct draws *draws, const struct draws *but, uint64_t cells)
{
    for (size_t i = 0; i < draws->count; i++) {
        const uint32_t steps = distribution_steps(&draws->list[i]);
        if (steps > 0 && !(but && draws_have_key(but, draws->list[i].key)))
            cells = cells > UINT64_MAX / steps ? UINT64_MAX : cells * steps;
    }
    return cells;
}

sonject_status image_plan_check_grid(const struct campaign *campaign)
{
    for (size_t i = 0; campaign->design == DESIGN_GRID && i < campaign->target_count; i++) {
        const struct item *item = &campaign->targets[i];
        uint64_t images = 0;
        for (size_t j = 0; j < campaign->split_count; j++)
            images += campaign->splits[j].shares[CATEGORY_TARGET + i];
        uint64_t cells = count_cells(&campaign->draws, NULL, 1);
        cells = count_cells(&campaign->object_draws, &item->draws, cells);
        cells = count_cells(&item->draws, NULL, cells);
        if (item->weight > 0.0 && cells > images)
            return tree_failure(&campaign->tree, item->place, "targets",
                                "%s comes in %llu images, but the grid of its values has %s%llu "
                                "cells; ask for more images or fewer steps",
                                item->class_name, (unsigned long long)images,
                                cells == UINT64_MAX ? "more than " : "", (unsigned long long)cells);
    }
    return SONJECT_OK;
}
