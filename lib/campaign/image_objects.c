/* What lies in an image: which objects, where, and what is drawn of each. */
#include <math.h>
#include <stdio.h>

#include "base/growing_text.h"
#include "base/text.h"
#include "campaign/design.h"
#include "campaign/drawing.h"
#include "io/yaml_flow.h"

#define CANDIDATES 16 /* places that are tried for an object beside others */

/* Draws that an object has of its own, and those of all objects that it has not. number: of the
 * object; 0 is the target, if there is one. */
static sonject_status draw_object(struct drawing *drawing, const struct item *item, uint32_t number,
                                  bool is_clutter)
{
    const struct campaign *campaign = drawing->campaign;
    const struct draws *both[] = {&campaign->object_draws, &item->draws};
    const uint64_t place = drawing->plan->id * OBJECTS_OF_IMAGE + number;
    const uint64_t seed =
        category_seed(campaign, is_clutter ? UINT32_MAX - 1 : drawing->plan->category);
    char prefix[32];
    sonject_status status = SONJECT_OK;
    snprintf(prefix, sizeof prefix, "objects[%u].", (unsigned)number);
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; status == SONJECT_OK && i < both[k]->count; i++) {
            char text[DISTRIBUTION_TEXT_CAPACITY];
            const char *value;
            const struct distribution *distribution = &both[k]->list[i];
            if (k == 0 && draws_have_key(&item->draws, distribution->key))
                continue;
            if (is_clutter && drawing->trial == NO_TRIAL)
                value = distribution_value(distribution,
                                           uniform_number(seed, distribution->stream, place), text);
            else
                value =
                    draw_value(drawing, distribution, seed, drawing->index, drawing->count, text);
            status = add_value(drawing, distribution->place, prefix, distribution->key, value);
        }
    return status;
}

/* A place in the middle part of the chip: the first candidate for the first object, for others the
 * one that is farthest from all before. */
static void place_object(struct drawing *drawing)
{
    const struct campaign *campaign = drawing->campaign;
    const struct region *chip = &drawing->plan->chip;
    const uint32_t number = drawing->objects;
    double farthest = -1.0;
    for (uint32_t i = 0; i < (number > 0 ? CANDIDATES : 1u); i++) {
        const uint64_t index = (drawing->plan->id * OBJECTS_OF_IMAGE + number) * CANDIDATES + i;
        const double u = uniform_number(campaign->seed, STREAM_OBJECT_ROW, index) - 0.5;
        const double v = uniform_number(campaign->seed, STREAM_OBJECT_COLUMN, index) - 0.5;
        const double row =
            0.5 * (double)(chip->rows - 1) + campaign->spread * (double)(chip->rows - 1) * u;
        const double column =
            0.5 * (double)(chip->columns - 1) + campaign->spread * (double)(chip->columns - 1) * v;
        double nearest = HUGE_VAL;
        for (uint32_t j = 0; j < number; j++)
            nearest = fmin(nearest, hypot(row - drawing->rows[j], column - drawing->columns[j]));
        if (nearest > farthest) {
            farthest = nearest;
            drawing->rows[number] = row;
            drawing->columns[number] = column;
        }
    }
    drawing->objects++;
}

static void write_object(struct drawing *drawing, const struct item *item,
                         struct growing_text *text)
{
    const struct region *chip = &drawing->plan->chip;
    const struct tree_node class_name = {
        .kind = TREE_TEXT, .is_quoted = true, .text = (char *)item->class_name};
    const uint32_t number = drawing->objects;
    char row[32], column[32];
    place_object(drawing);
    text_of_number(row, sizeof row, (double)chip->first_row + drawing->rows[number], 9);
    text_of_number(column, sizeof column, (double)chip->first_column + drawing->columns[number], 9);
    growing_text_add(text, "%s{\"class\": ", number > 0 ? ", " : "");
    tree_write_flow(&class_name, text);
    growing_text_add(text, ", \"position\": {\"row\": %s, \"column\": %s}%s%s", row, column,
                     item->object[1] == '}' ? "" : ", ", item->object + 1);
}

static uint32_t clutter_objects(struct drawing *drawing)
{
    const struct campaign *campaign = drawing->campaign;
    const struct distribution *number = &campaign->clutter_number;
    const uint32_t category = drawing->plan->category;
    char text[DISTRIBUTION_TEXT_CAPACITY];
    uint64_t count = 1;
    if (category == CATEGORY_EMPTY || campaign->clutter_count == 0)
        return 0;
    if (number->count > 0)
        text_to_count(
            distribution_value(
                number, uniform_number(campaign->seed, number->stream, drawing->plan->id), text),
            &count);
    return (uint32_t)(category == CATEGORY_CLUTTER && count == 0 ? 1 : count);
}

static const struct item *choose_clutter(const struct drawing *drawing, uint32_t number)
{
    const struct campaign *campaign = drawing->campaign;
    double left = 0.0;
    for (size_t i = 0; i < campaign->clutter_count; i++)
        left += campaign->clutter[i].weight;
    left *=
        uniform_number(campaign->seed, STREAM_ITEM, drawing->plan->id * OBJECTS_OF_IMAGE + number);
    const struct item *item = campaign->clutter;
    while (item + 1 < campaign->clutter + campaign->clutter_count && left >= item->weight)
        left -= (item++)->weight;
    return item;
}

/* All of the image; the target comes first, if there is one. */
static uint32_t choose_objects(struct drawing *drawing, const struct item *trial_clutter,
                               const struct item **items)
{
    const uint32_t category = drawing->plan->category;
    uint32_t count = 0;
    if (category >= CATEGORY_TARGET)
        items[count++] = &drawing->campaign->targets[category - CATEGORY_TARGET];
    if (trial_clutter) {
        items[count++] = trial_clutter;
    } else if (drawing->trial == NO_TRIAL) {
        const uint32_t end = count + clutter_objects(drawing);
        for (; count < end; count++)
            items[count] = choose_clutter(drawing, count);
    }
    return count;
}

/* The objects in one value, and then what is drawn of each. */
sonject_status draw_objects(struct drawing *drawing, const struct item *trial_clutter)
{
    const struct tree_place nowhere = {NULL, 0, 0};
    const struct item *items[OBJECTS_OF_IMAGE];
    struct growing_text text = {NULL, 0, 0, false};
    const uint32_t count = choose_objects(drawing, trial_clutter, items);
    const uint32_t first_clutter = drawing->plan->category >= CATEGORY_TARGET ? 1 : 0;
    drawing->plan->object_count = count;
    growing_text_add(&text, "objects=[");
    for (uint32_t i = 0; i < count; i++)
        write_object(drawing, items[i], &text);
    growing_text_add(&text, "]");
    sonject_status status = add_key(drawing, nowhere, growing_text_end(&text));
    for (uint32_t i = 0; status == SONJECT_OK && i < count; i++)
        status = draw_object(drawing, items[i], i, i >= first_clutter);
    return status;
}
