#include "campaign/drawing.h"

#include <stdlib.h>
#include <string.h>

#include "base/growing_text.h"
#include "campaign/campaign_fields.h"
#include "campaign/design.h"

void drawing_init(struct drawing *drawing, struct report *report, const struct campaign *campaign,
                  uint32_t trial, struct image_plan *plan)
{
    memset(plan, 0, sizeof *plan);
    plan->chip.rows = campaign->chip_rows;
    plan->chip.columns = campaign->chip_columns;
    memset(drawing, 0, sizeof *drawing);
    drawing->report = report;
    drawing->campaign = campaign;
    drawing->plan = plan;
    drawing->trial = trial;
}

uint64_t category_seed(const struct campaign *campaign, uint32_t category)
{
    return campaign->seed ^ (UINT64_C(0x9E3779B97F4A7C15) * (category + 1));
}

sonject_status add_key(struct drawing *drawing, struct tree_place place, char *text)
{
    struct image_plan *plan = drawing->plan;
    CHECK_MEMORY(drawing->report, text, "an image's scene");
    const sonject_status status =
        grow_list(drawing->report, &plan->keys, plan->key_count, sizeof *plan->keys);
    if (status != SONJECT_OK) {
        free(text);
        return status;
    }
    plan->keys[plan->key_count].text = text;
    plan->keys[plan->key_count++].place = place;
    return SONJECT_OK;
}

sonject_status add_value(struct drawing *drawing, struct tree_place place, const char *prefix,
                         const char *key, const char *value)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "%s%s=%s", prefix, key, value);
    return add_key(drawing, place, growing_text_end(&text));
}

static const char *trial_value(const struct distribution *distribution, uint32_t step,
                               char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->count > 0)
        return distribution->texts[step % distribution->count];
    return distribution_value(distribution, step % 2 == 0 ? 0.0 : 1.0, text);
}

const char *draw_value(struct drawing *drawing, const struct distribution *distribution,
                       uint64_t seed, uint64_t index, uint64_t count,
                       char text[DISTRIBUTION_TEXT_CAPACITY])
{
    const struct campaign *campaign = drawing->campaign;
    const uint32_t steps = distribution_steps(distribution);
    if (drawing->trial != NO_TRIAL)
        return trial_value(distribution, drawing->trial, text);
    if (campaign->design == DESIGN_GRID && steps > 0) {
        const uint32_t step = (uint32_t)(drawing->cell % steps);
        drawing->cell /= steps;
        return distribution_step(distribution, step, text);
    }
    const double u = campaign->design == DESIGN_STRATIFIED
                         ? stratified_number(seed, distribution->stream, index, count)
                         : uniform_number(seed, distribution->stream, drawing->plan->id);
    return distribution_value(distribution, u, text);
}

bool draws_have_key(const struct draws *draws, const char *key)
{
    for (size_t i = 0; i < draws->count; i++)
        if (strcmp(draws->list[i].key, key) == 0)
            return true;
    return false;
}
