/* The making of an image's plan: swath and place, kind, objects, and values drawn one after the
 * other, as "key=value" of the scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign.h"

/* Streams of random numbers, above those of distributions. */
enum {
    STREAM_KIND = 0x31000000,
    STREAM_GRID = 0x31000001,
    STREAM_SEED = 0x31000002,
    STREAM_ITEM = 0x31000003,
    STREAM_OBJECT_ROW = 0x31000004,
    STREAM_OBJECT_COLUMN = 0x31000005,
    STREAM_CHIP_ROW = 0x32000000,   /* plus a swath's number */
    STREAM_CHIP_COLUMN = 0x33000000 /* plus a swath's number */
};

#define NO_TRIAL       UINT32_MAX
#define ATTEMPT_STRIDE UINT64_C(0xD1342543DE82EF95) /* step from one attempt's seed to the next */

/* The state of drawing a plan. */
struct drawing {
    struct report *report;
    sonject_status status; /* status so far */
    const struct campaign *campaign;
    struct image_plan *plan;
    uint32_t trial; /* step of a trial, or NO_TRIAL */
    struct attempts attempts;
    uint32_t attempt;      /* attempt of the values drawn now, from 0 */
    uint64_t index, count; /* index and number among the images of its category */
    uint64_t cell;         /* rest of the grid's cell, one axis after the other */
    uint32_t objects;
};

/* Begins an empty plan, for image_plan_clear. trial: step of a trial, or NO_TRIAL. */
static void drawing_init(struct drawing *drawing, struct report *report,
                         const struct campaign *campaign, uint32_t trial,
                         const struct attempts *attempts, struct image_plan *plan)
{
    *plan = (struct image_plan){.places = attempts->places};
    *drawing = (struct drawing){.report = report,
                                .campaign = campaign,
                                .plan = plan,
                                .trial = trial,
                                .attempts = *attempts,
                                .attempt = attempts->of_all};
}

void attempts_next(struct attempts *attempts)
{
    attempts->of_all++;
    memset(&attempts->places, 0, sizeof attempts->places);
}

/* Sets the swath. Before it is measured, chips have the least sides: only its scene is of use. */
static void set_swath(struct drawing *drawing, uint32_t number)
{
    const struct swath_plan *swath = &drawing->campaign->swaths[number];
    const bool is_measured = swath->chip_rows > 0;
    drawing->plan->swath = number;
    drawing->plan->chip.rows = is_measured ? swath->chip_rows : CAMPAIGN_CHIP_MIN;
    drawing->plan->chip.columns = is_measured ? swath->chip_columns : CAMPAIGN_CHIP_MIN;
}

/* Makes later draws those of an object. */
static void begin_object(struct drawing *drawing, uint32_t number)
{
    drawing->attempt = drawing->attempts.of_all;
    if (number < drawing->plan->target_count)
        drawing->attempt += drawing->attempts.of_targets[number];
}

/* Returns a seed for each category, so that categories do not draw alike. */
static uint64_t category_seed(const struct campaign *campaign, uint32_t category)
{
    return campaign->seed ^ (UINT64_C(0x9E3779B97F4A7C15) * (category + 1));
}

/* Returns the seed of the current attempt. */
static uint64_t attempt_seed(const struct drawing *drawing, uint64_t seed)
{
    return seed ^ (ATTEMPT_STRIDE * drawing->attempt);
}

/* Adds a key to the plan. text: taken over; NULL: memory is out. table: see struct plan_key. */
static void add_key_of(struct drawing *drawing, struct tree_place place, const char *table,
                       char *text)
{
    struct image_plan *plan = drawing->plan;
    if (drawing->status == SONJECT_OK && !text)
        drawing->status = report_out_of_memory(drawing->report, "an image's scene");
    THEN(drawing->status, grow_list(drawing->report, &plan->keys, plan->key_count,
                                    sizeof *plan->keys, "the campaign"));
    if (drawing->status == SONJECT_OK)
        plan->keys[plan->key_count++] = (struct plan_key){text, place, table};
    else
        free(text);
}

static void add_key(struct drawing *drawing, struct tree_place place, char *text)
{
    add_key_of(drawing, place, NULL, text);
}

static void add_value(struct drawing *drawing, struct tree_place place, const char *prefix,
                      const char *key, const char *value)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "%s%s=%s", prefix, key, value);
    add_key(drawing, place, growing_text_end(&text));
}

/* Adds all keys of a table's row. */
static void add_row(struct drawing *drawing, const struct distribution *distribution,
                    const char *prefix, const char *value)
{
    const struct body_table *table = distribution->table;
    const struct body_cell *cells = body_table_row(distribution, value);
    for (size_t i = 0; i < table->key_count; i++) {
        struct growing_text text = {NULL, 0, 0, false};
        if (!cells[i].text)
            continue;
        growing_text_add(&text, "%s%s=%s", prefix, table->keys[i], cells[i].text);
        add_key_of(drawing, cells[i].place, table->path, growing_text_end(&text));
    }
}

static const char *trial_value(const struct distribution *distribution, uint32_t step,
                               char text[DISTRIBUTION_TEXT_CAPACITY])
{
    if (distribution->count > 0)
        return distribution->texts[step % distribution->count];
    return distribution_value(distribution, step % 2 == 0 ? 0.0 : 1.0, text);
}

/* Draws the index-th of count values. Random designs use the image's id instead. */
static const char *draw_value(struct drawing *drawing, const struct distribution *distribution,
                              uint64_t seed, uint64_t index, uint64_t count,
                              char text[DISTRIBUTION_TEXT_CAPACITY])
{
    const struct campaign *campaign = drawing->campaign;
    const uint32_t steps = distribution_steps(distribution);
    const bool is_trial = drawing->trial != NO_TRIAL;
    if (is_trial && (drawing->attempt == 0 || distribution->count > 0))
        return trial_value(distribution, drawing->trial, text);
    if (campaign->design == DESIGN_GRID && steps > 0 && drawing->attempt == 0) {
        const uint32_t step = (uint32_t)(drawing->cell % steps);
        drawing->cell /= steps;
        return distribution_step(distribution, step, text);
    }
    const double u = campaign->design == DESIGN_STRATIFIED && drawing->attempt == 0
                         ? stratified_number(seed, distribution->stream, index, count)
                         : uniform_number(attempt_seed(drawing, seed), distribution->stream,
                                          is_trial ? drawing->trial : drawing->plan->id);
    return campaign->design == DESIGN_GRID && steps > 0
               ? distribution_step(distribution, (uint32_t)(u * steps), text)
               : distribution_value(distribution, u, text);
}

/* Returns the value that a ratio stands for, in the unit of the key that the ratio is of. */
static const char *value_of_ratio(struct drawing *drawing, const char *prefix,
                                  const struct distribution *distribution, const char *ratio,
                                  char text[DISTRIBUTION_TEXT_CAPACITY])
{
    const struct image_plan *plan = drawing->plan;
    char key[256], digits[32];
    double share = 1.0, number = 0.0;
    const char *rest = "";
    const int length = snprintf(key, sizeof key, "%s%s=", prefix, distribution->of);
    size_t i = plan->key_count;
    while (i > 0 && strncmp(plan->keys[i - 1].text, key, (size_t)length) != 0)
        i--;
    if (drawing->status == SONJECT_OK &&
        (i == 0 || !text_to_number(plan->keys[i - 1].text + length, &number, &rest)))
        drawing->status =
            report_failure(drawing->report, SONJECT_ERROR_INPUT,
                           "%s%s is a ratio of %s, for which no number is drawn before it", prefix,
                           distribution->key, distribution->of);
    text_to_number(ratio, &share, &ratio);
    text_of_number(digits, sizeof digits, share * number, 9);
    snprintf(text, DISTRIBUTION_TEXT_CAPACITY, "%s%.15s", digits, rest);
    return text;
}

bool draws_have_key(const struct draws *draws, const char *key)
{
    for (size_t i = 0; i < draws->count; i++) {
        const struct body_table *table = draws->list[i].table;
        for (size_t k = 0; table && k < table->key_count; k++)
            if (strcmp(table->keys[k], key) == 0)
                return true;
        if (strcmp(draws->list[i].key, key) == 0)
            return true;
    }
    return false;
}

uint32_t image_split(const struct campaign *campaign, uint64_t id)
{
    uint32_t number = 0;
    while (id - campaign->splits[number].first_image >= campaign->splits[number].images)
        number++;
    return number;
}

/* Chooses the image's swath and its place there. Images of a split go through the split's swaths,
 * in numbers that differ by one at most. within: the image's number in its split. */
static void choose_place(struct drawing *drawing, uint64_t within)
{
    const struct campaign *campaign = drawing->campaign;
    struct image_plan *plan = drawing->plan;
    const struct split *split = &campaign->splits[plan->split];
    const uint64_t swaths = split->swath_count;
    const uint64_t number = within * swaths / split->images;
    const uint64_t first = (number * split->images + swaths - 1) / swaths;
    const uint64_t end = ((number + 1) * split->images + swaths - 1) / swaths;
    const uint64_t moves = drawing->attempts.of_all / ATTEMPTS_OF_CHIP;
    const uint64_t seed = campaign->seed ^ (ATTEMPT_STRIDE * moves);
    double u, v;
    set_swath(drawing, split->swaths[number]);
    if (moves == 0 && campaign->design == DESIGN_STRATIFIED) {
        u = stratified_number(campaign->seed, STREAM_CHIP_ROW + plan->swath, within - first,
                              end - first);
        v = stratified_number(campaign->seed, STREAM_CHIP_COLUMN + plan->swath, within - first,
                              end - first);
    } else {
        u = uniform_number(seed, STREAM_CHIP_ROW, plan->id);
        v = uniform_number(seed, STREAM_CHIP_COLUMN, plan->id);
    }
    crop_sample(&campaign->swaths[plan->swath].room, u, v, &plan->chip.first_row,
                &plan->chip.first_column);
}

/* Chooses the image's kind in random order, with index and count of the image in that kind. */
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

#define CANDIDATES 16   /* places tried for an object beside others */
#define PLACES_MAX 1000 /* tries to find an object a free place */

bool item_fixes(const struct item *item, const char *key)
{
    const struct tree_node *node = item->fixed;
    for (;;) {
        char name[64];
        const size_t length = strcspn(key, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, key);
        const struct tree_entry *entry = tree_find(node, name);
        if (!entry || !key[length] || entry->value.kind != TREE_SECTION)
            return entry != NULL;
        node = &entry->value;
        key += length + 1;
    }
}

static bool has_own(const struct item *item, const char *key)
{
    return draws_have_key(&item->draws, key) || item_fixes(item, key);
}

/* Draws an object's values: its own draws, and the draws of all objects whose keys it does not have
 * itself. number: of the object; 0 is the target, if there is one. is_beside: clutter, or another
 * target. */
static void draw_object(struct drawing *drawing, const struct item *item, uint32_t number,
                        bool is_beside)
{
    const struct campaign *campaign = drawing->campaign;
    const struct draws *both[] = {&campaign->object_draws, &item->draws};
    const uint64_t place = drawing->plan->id * OBJECTS_OF_IMAGE + number;
    const uint64_t seed =
        category_seed(campaign, is_beside ? UINT32_MAX - 1 : drawing->plan->category);
    const uint64_t own_seed = attempt_seed(drawing, seed);
    char prefix[32];
    snprintf(prefix, sizeof prefix, "objects[%u].", (unsigned)number);
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < both[k]->count; i++) {
            char text[DISTRIBUTION_TEXT_CAPACITY], ratio[DISTRIBUTION_TEXT_CAPACITY];
            const struct distribution *distribution = &both[k]->list[i];
            if (k == 0 && has_own(item, distribution->key))
                continue;
            const char *value =
                is_beside && drawing->trial == NO_TRIAL
                    ? distribution_value(
                          distribution, uniform_number(own_seed, distribution->stream, place), text)
                    : draw_value(drawing, distribution, seed, drawing->index, drawing->count, text);
            if (distribution->of)
                value = value_of_ratio(drawing, prefix, distribution, value, ratio);
            if (distribution->table)
                add_row(drawing, distribution, prefix, value);
            else
                add_value(drawing, distribution->place, prefix, distribution->key, value);
        }
}

/* Returns whether a place in the chip is free of contacts that objects keep away from. */
static bool is_free(const struct drawing *drawing, double row, double column)
{
    const struct campaign *campaign = drawing->campaign;
    const struct swath_plan *swath = &campaign->swaths[drawing->plan->swath];
    const double clearance = (double)campaign->clearance;
    row += (double)drawing->plan->chip.first_row;
    column += (double)drawing->plan->chip.first_column;
    for (size_t i = 0; images_show_contacts(campaign) && i < swath->avoid_count; i++) {
        const struct region *box = &swath->avoid[i].pixels;
        const double first_row = (double)box->first_row, first_column = (double)box->first_column;
        if (row > first_row - clearance && row < first_row + (double)box->rows + clearance &&
            column > first_column - clearance &&
            column < first_column + (double)box->columns + clearance)
            return false;
    }
    return true;
}

/* Returns the distance of a place from the nearest object that has one; infinite: none has. */
static double distance_to_others(const struct drawing *drawing, double row, double column)
{
    const struct object_places *places = &drawing->plan->places;
    double nearest = HUGE_VAL;
    for (uint32_t j = 0; j < OBJECTS_OF_IMAGE; j++)
        if (j < drawing->objects || places->are_kept[j])
            nearest = fmin(nearest, hypot(row - places->rows[j], column - places->columns[j]));
    return nearest;
}

/* Finds a place in the chip's middle part: the first candidate for the first object, for others the
 * farthest one from all objects that have theirs. False: contacts take all candidates. */
static bool try_place(struct drawing *drawing, uint64_t seed)
{
    const struct campaign *campaign = drawing->campaign;
    const struct region *chip = &drawing->plan->chip;
    const struct swath_plan *swath = &campaign->swaths[drawing->plan->swath];
    const uint32_t number = drawing->objects;
    const double offset = (double)chip->first_column;
    const struct object_columns columns = objects_of_chip(swath, chip->first_row);
    const double first = fmax(0.0, columns.first - offset);
    const double last = fmin((double)(chip->columns - 1), columns.last - offset);
    const uint32_t candidates = isinf(distance_to_others(drawing, 0.0, 0.0)) ? 1 : CANDIDATES;
    double farthest = -1.0;
    for (uint32_t i = 0; i < candidates; i++) {
        const uint64_t index = (drawing->plan->id * OBJECTS_OF_IMAGE + number) * CANDIDATES + i;
        const double u = uniform_number(seed, STREAM_OBJECT_ROW, index) - 0.5;
        const double v = uniform_number(seed, STREAM_OBJECT_COLUMN, index) - 0.5;
        const double row =
            0.5 * (double)(chip->rows - 1) + campaign->spread * (double)(chip->rows - 1) * u;
        const double column = first + 0.5 * (last - first) + campaign->spread * (last - first) * v;
        const double nearest = distance_to_others(drawing, row, column);
        if (nearest > farthest && is_free(drawing, row, column)) {
            farthest = nearest;
            drawing->plan->places.rows[number] = row;
            drawing->plan->places.columns[number] = column;
        }
    }
    return farthest >= 0.0;
}

static void place_object(struct drawing *drawing)
{
    const uint64_t seed = attempt_seed(drawing, drawing->campaign->seed);
    uint64_t tries = 0;
    const bool is_kept = drawing->plan->places.are_kept[drawing->objects];
    while (!is_kept && tries < PLACES_MAX &&
           !try_place(drawing, seed ^ (UINT64_C(0xA0761D6478BD642F) * tries)))
        tries++;
    if (tries == PLACES_MAX && drawing->status == SONJECT_OK)
        drawing->status = report_failure(
            drawing->report, SONJECT_ERROR_INPUT,
            "%s: the contacts to avoid leave no place for an object; lower chip.clearance",
            drawing->campaign->swaths[drawing->plan->swath].written);
    drawing->objects++;
}

static void write_object(struct drawing *drawing, const struct item *item,
                         struct growing_text *text)
{
    const struct region *chip = &drawing->plan->chip;
    const uint32_t number = drawing->objects;
    char row[32], column[32];
    begin_object(drawing, number);
    place_object(drawing);
    const struct object_places *places = &drawing->plan->places;
    text_of_number(row, sizeof row, (double)chip->first_row + places->rows[number], 9);
    text_of_number(column, sizeof column, (double)chip->first_column + places->columns[number], 9);
    growing_text_add(text, "%s{\"class\": ", number > 0 ? ", " : "");
    tree_write_text(item->class_name, text);
    growing_text_add(text, ", \"position\": {\"row\": %s, \"column\": %s}%s%s", row, column,
                     item->object[1] == '}' ? "" : ", ", item->object + 1);
}

/* Draws a number of objects in an image; 1 where the campaign does not give it. */
static uint32_t draw_number(const struct drawing *drawing, const struct distribution *number)
{
    const uint64_t seed = drawing->campaign->seed;
    char text[DISTRIBUTION_TEXT_CAPACITY];
    uint64_t count = 1;
    if (number->count > 0)
        text_to_count(distribution_value(
                          number, uniform_number(seed, number->stream, drawing->plan->id), text),
                      &count);
    return (uint32_t)count;
}

static uint32_t clutter_objects(struct drawing *drawing)
{
    const struct campaign *campaign = drawing->campaign;
    const uint32_t category = drawing->plan->category;
    if (category == CATEGORY_EMPTY || campaign->clutter_count == 0 || campaign->has_one_target)
        return 0;
    const uint32_t count = draw_number(drawing, &campaign->clutter_number);
    return category == CATEGORY_CLUTTER && count == 0 ? 1 : count;
}

/* Chooses one of the items by weight. number: of the object. */
static const struct item *choose_item(const struct drawing *drawing, const struct item *items,
                                      size_t count, uint32_t number)
{
    const struct item *item = items;
    double left = 0.0;
    for (size_t i = 0; i < count; i++)
        left += items[i].weight;
    left *= uniform_number(drawing->campaign->seed, STREAM_ITEM,
                           drawing->plan->id * OBJECTS_OF_IMAGE + number);
    while (item + 1 < items + count && left >= item->weight)
        left -= (item++)->weight;
    return item;
}

/* Chooses the image's objects. Targets come first, and among them the one of the category. */
static uint32_t choose_objects(struct drawing *drawing, const struct item *trial_clutter,
                               const struct item **items)
{
    const struct campaign *campaign = drawing->campaign;
    const uint32_t category = drawing->plan->category;
    const bool has_target = category >= CATEGORY_TARGET;
    uint32_t count = 0;
    if (has_target)
        items[count++] = &campaign->targets[category - CATEGORY_TARGET];
    if (has_target && drawing->trial == NO_TRIAL && !campaign->has_one_target)
        for (const uint32_t end = draw_number(drawing, &campaign->target_number); count < end;
             count++)
            items[count] = choose_item(drawing, campaign->targets, campaign->target_count, count);
    drawing->plan->target_count = count;
    if (trial_clutter) {
        items[count++] = trial_clutter;
    } else if (drawing->trial == NO_TRIAL) {
        const uint32_t end = count + clutter_objects(drawing);
        for (; count < end; count++)
            items[count] = choose_item(drawing, campaign->clutter, campaign->clutter_count, count);
    }
    return count;
}

/* Adds all objects in one value, and then the draws of each. */
static void draw_objects(struct drawing *drawing, const struct item *trial_clutter)
{
    const struct tree_place nowhere = {NULL, 0, 0};
    const struct item *items[OBJECTS_OF_IMAGE];
    struct growing_text text = {NULL, 0, 0, false};
    const uint32_t count = choose_objects(drawing, trial_clutter, items);
    const uint32_t first_beside = drawing->plan->target_count > 0 ? 1 : 0;
    drawing->plan->object_count = count;
    growing_text_add(&text, "objects=[");
    for (uint32_t i = 0; i < count; i++)
        write_object(drawing, items[i], &text);
    growing_text_add(&text, "]");
    /* trials have one object at a time */
    add_key(drawing, count == 1 || trial_clutter ? items[count - 1]->place : nowhere,
            growing_text_end(&text));
    for (uint32_t i = 0; i < count; i++) {
        begin_object(drawing, i);
        draw_object(drawing, items[i], i, i >= first_beside);
    }
}

/* Adds the swath's own keys, chip and seed, the draws of the scene, and the objects. */
static sonject_status fill_plan(struct drawing *drawing, const struct item *trial_clutter)
{
    const struct campaign *campaign = drawing->campaign;
    const struct region *chip = &drawing->plan->chip;
    const struct tree_place nowhere = {NULL, 0, 0};
    const struct swath_plan *swath = &campaign->swaths[drawing->plan->swath];
    char text[160];
    for (size_t i = 0; i < swath->key_count; i++)
        add_key(drawing, swath->place, copy_text(swath->keys[i]));
    snprintf(text, sizeof text, "{row: %llu, column: %llu, rows: %llu, columns: %llu}",
             (unsigned long long)chip->first_row, (unsigned long long)chip->first_column,
             (unsigned long long)chip->rows, (unsigned long long)chip->columns);
    add_value(drawing, nowhere, "", "patch", text);
    snprintf(text, sizeof text, "%llu", (unsigned long long)drawing->plan->seed);
    add_value(drawing, nowhere, "", "injection.seed", text);
    for (size_t i = 0; i < campaign->draws.count; i++) {
        char ratio[DISTRIBUTION_TEXT_CAPACITY];
        const struct distribution *distribution = &campaign->draws.list[i];
        const char *value = draw_value(drawing, distribution, campaign->seed, drawing->plan->id,
                                       campaign->images, text);
        if (distribution->of)
            value = value_of_ratio(drawing, "", distribution, value, ratio);
        add_value(drawing, distribution->place, "", distribution->key, value);
    }
    draw_objects(drawing, trial_clutter);
    return drawing->status;
}

sonject_status image_plan_make(struct report *report, const struct campaign *campaign, uint64_t id,
                               const struct attempts *attempts, struct image_plan *plan)
{
    struct drawing drawing;
    drawing_init(&drawing, report, campaign, NO_TRIAL, attempts, plan);
    plan->id = id;
    plan->seed = (uint64_t)(uniform_number(campaign->seed, STREAM_SEED, id) * 0x1p52);
    plan->split = image_split(campaign, id);
    const uint64_t within = id - campaign->splits[plan->split].first_image;
    choose_place(&drawing, within);
    choose_kind(&drawing, within);
    return fill_plan(&drawing, NULL);
}

sonject_status image_plan_try(struct report *report, const struct campaign *campaign,
                              uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                              uint32_t attempt, struct image_plan *plan)
{
    const struct attempts attempts = {.of_all = attempt};
    struct drawing drawing;
    drawing_init(&drawing, report, campaign, step, &attempts, plan);
    set_swath(&drawing, swath);
    plan->category = category;
    if (campaign->swaths[swath].room.places > 0)
        crop_sample(&campaign->swaths[swath].room, 0.0, 0.0, &plan->chip.first_row,
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

/* Returns cells times the cells of the draws' axes, at most UINT64_MAX. but: item whose own keys do
 * not count; NULL: all count. */
static uint64_t count_cells(const struct draws *draws, const struct item *but, uint64_t cells)
{
    for (size_t i = 0; i < draws->count; i++) {
        const uint32_t steps = distribution_steps(&draws->list[i]);
        if (steps > 0 && !(but && has_own(but, draws->list[i].key)))
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
        cells = count_cells(&campaign->object_draws, item, cells);
        cells = count_cells(&item->draws, NULL, cells);
        if (item->weight > 0.0 && cells > images)
            return tree_failure(&campaign->tree, item->place, "targets",
                                "%s appears in %llu images, but the grid of its values has %s%llu "
                                "cells; ask for more images or fewer steps",
                                item->class_name, (unsigned long long)images,
                                cells == UINT64_MAX ? "more than " : "", (unsigned long long)cells);
    }
    return SONJECT_OK;
}
