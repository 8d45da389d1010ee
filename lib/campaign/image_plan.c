#include "campaign/image_plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "campaign/design.h"
#include "campaign/drawing.h"

static sonject_status draw_scene(struct drawing *drawing)
{
    const struct campaign *campaign = drawing->campaign;
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < campaign->draws.count; i++) {
        char text[DISTRIBUTION_TEXT_CAPACITY];
        const struct distribution *distribution = &campaign->draws.list[i];
        const char *value = draw_value(drawing, distribution, campaign->seed, drawing->plan->id,
                                       campaign->images, text);
        status = add_value(drawing, distribution->place, "", distribution->key, value);
    }
    return status;
}

static sonject_status draw_patch(struct drawing *drawing)
{
    const struct campaign *campaign = drawing->campaign;
    const struct region *chip = &drawing->plan->chip;
    const struct tree_place nowhere = {NULL, 0, 0};
    const struct swath_plan *swath = &campaign->swaths[drawing->plan->swath];
    char text[160];
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < swath->key_count; i++)
        status = add_key(drawing, swath->place, copy_text(swath->keys[i]));
    snprintf(text, sizeof text, "{row: %llu, column: %llu, rows: %llu, columns: %llu}",
             (unsigned long long)chip->first_row, (unsigned long long)chip->first_column,
             (unsigned long long)chip->rows, (unsigned long long)chip->columns);
    THEN(status, add_value(drawing, nowhere, "", "patch", text));
    snprintf(text, sizeof text, "%llu", (unsigned long long)drawing->plan->seed);
    THEN(status, add_value(drawing, nowhere, "", "injection.seed", text));
    return status;
}

static sonject_status fill_plan(struct drawing *drawing, const struct item *trial_clutter)
{
    sonject_status status = draw_patch(drawing);
    THEN(status, draw_scene(drawing));
    return status == SONJECT_OK ? draw_objects(drawing, trial_clutter) : status;
}

sonject_status image_plan_make(struct report *report, const struct campaign *campaign, uint64_t id,
                               struct image_plan *plan)
{
    struct drawing drawing;
    drawing_init(&drawing, report, campaign, NO_TRIAL, plan);
    plan->id = id;
    plan->seed = (uint64_t)(uniform_number(campaign->seed, STREAM_SEED, id) * 0x1p52);
    choose_place(&drawing);
    return fill_plan(&drawing, NULL);
}

sonject_status image_plan_try(struct report *report, const struct campaign *campaign,
                              uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                              struct image_plan *plan)
{
    struct drawing drawing;
    drawing_init(&drawing, report, campaign, step, plan);
    plan->swath = swath;
    plan->category = category;
    if (campaign->swaths[swath].room.places > 0)
        chip_room_choose(&campaign->swaths[swath].room, 0.0, 0.0, &plan->chip.first_row,
                         &plan->chip.first_column);
    return fill_plan(&drawing, category == CATEGORY_CLUTTER ? &campaign->clutter[item] : NULL);
}

void image_plan_clear(struct image_plan *plan)
{
    for (size_t i = 0; i < plan->key_count; i++)
        free(plan->keys[i].text);
    free(plan->keys);
    memset(plan, 0, sizeof *plan);
}
