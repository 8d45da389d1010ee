/* What is drawn, what is put into images, swaths and splits, as campaign files write them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign_fields.h"
#include "schema/scene_key.h"
#include "schema/yaml_tree.h"

#define OBJECT_PREFIX "objects[]."

sonject_status grow_list(struct report *report, void *list, size_t count, size_t size)
{
    void *old;
    size_t bytes;
    memcpy(&old, list, sizeof old);
    char *grown = size_multiply(count + 1, size, &bytes) ? realloc(old, bytes) : NULL;
    CHECK_MEMORY(report, grown, "the campaign");
    memset(grown + count * size, 0, size);
    memcpy(list, &grown, sizeof grown);
    return SONJECT_OK;
}

/* Keys that the campaign itself gives values. */
static bool is_taken(const char *key, bool is_object)
{
    static const char *const taken[] = {"sonject", "input.path", "patch", "objects", "elements"};
    if (is_object)
        return strcmp(key, "class") == 0 || strncmp(key, "position", 8) == 0;
    for (size_t i = 0; i < COUNT(taken); i++) {
        const size_t length = strlen(taken[i]);
        if (strncmp(key, taken[i], length) == 0 && (!key[length] || strchr(".[", key[length])))
            return true;
    }
    return false;
}

static sonject_status refuse_key_of(struct reader *reader, const struct tree_entry *entry,
                                    const char *format, const char *word)
{
    return tree_failure(reader->tree, entry->place, reader->path.text, format, word);
}

sonject_status check_scene_key(struct reader *reader, const struct tree_entry *entry,
                               const char *key, bool is_object)
{
    const char *near;
    const struct section *section;
    const struct section *top = is_object ? &object_section : &scene_section;
    sonject_status status = SONJECT_OK;
    const size_t before = key_path_add(&reader->path, entry->key);
    if (is_taken(key, is_object)) {
        status = refuse_key_of(reader, entry, "the campaign itself sets %s; remove it", key);
    } else if (!scene_key_find(top, key, &near, &section)) {
        struct word_list list = {{0}, 0};
        for (size_t i = 0; i < section->count; i++)
            list_word(&list, section->fields[i].key);
        status =
            near ? refuse_key_of(reader, entry, "scenes have no such key; did you mean '%s'?", near)
                 : refuse_key_of(reader, entry, "scenes have no such key; there are %s", list.text);
    }
    key_path_shorten(&reader->path, before);
    return status;
}

static sonject_status read_draw(struct reader *reader, struct campaign *campaign,
                                const struct tree_entry *entry, const char *key,
                                struct draws *draws)
{
    CHECK(grow_list(reader->report, &draws->list, draws->count, sizeof *draws->list));
    struct distribution *distribution = &draws->list[draws->count++];
    distribution->stream = ++campaign->streams;
    const size_t before = key_path_add(&reader->path, entry->key);
    sonject_status status = distribution_read(reader, &entry->value, key, distribution);
    key_path_shorten(&reader->path, before);
    return status;
}

static sonject_status check_section(struct reader *reader, const struct tree_node *node)
{
    if (node->kind == TREE_SECTION || tree_is_null(node))
        return SONJECT_OK;
    return refuse_value(reader, node, "must be a section of 'key: distribution' lines");
}

sonject_status read_campaign_draws(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct campaign *campaign = structure;
    sonject_status status = check_section(reader, node);
    for (size_t i = 0; !reading_ends(status) && i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        const bool is_object = strncmp(entry->key, OBJECT_PREFIX, strlen(OBJECT_PREFIX)) == 0;
        const char *key = entry->key + (is_object ? strlen(OBJECT_PREFIX) : 0);
        if (check_scene_key(reader, entry, key, is_object) == SONJECT_OK)
            status = read_draw(reader, campaign, entry, key,
                               is_object ? &campaign->object_draws : &campaign->draws);
    }
    return status;
}

/* What an item's table fills. */
struct item_text {
    struct campaign *campaign;
    struct item *item;
};

static sonject_status read_class(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct item_text *text = structure;
    const char *name = read_text(reader, node);
    if (!name)
        return SONJECT_ERROR_INPUT;
    if (!*name || strlen(name) >= sizeof text->item->class_name || !text_is_printable(name))
        return refuse_value(reader, node, "must be 1 to %d bytes on one line",
                            SONJECT_NAME_CAPACITY - 1);
    strcpy(text->item->class_name, name);
    return SONJECT_OK;
}

static sonject_status read_weight(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct item_text *text = structure;
    const sonject_status status = read_quantity(reader, node, QUANTITY_NUMBER, &text->item->weight);
    if (status == SONJECT_OK && !(text->item->weight >= 0.0 && text->item->weight <= 1e9))
        return refuse_value(reader, node, "must be from 0 to 1e9");
    return status;
}

static sonject_status read_object(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct item_text *text = structure;
    if (node->kind != TREE_SECTION)
        return refuse_value(reader, node, "must be a section, as of objects in a scene");
    for (size_t i = 0; i < node->count; i++)
        check_scene_key(reader, &node->entries[i], node->entries[i].key, true);
    return tree_override_text(reader->report, node, &text->item->object);
}

static sonject_status read_item_draws(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct item_text *text = structure;
    sonject_status status = check_section(reader, node);
    for (size_t i = 0; !reading_ends(status) && i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        if (check_scene_key(reader, entry, entry->key, true) == SONJECT_OK)
            status = read_draw(reader, text->campaign, entry, entry->key, &text->item->draws);
    }
    return status;
}

static const struct field item_fields[] = {
    {"class", "label for training", .kind = FIELD_SPECIAL, .read = read_class, REQUIRED},
    {"weight", "how often, beside the others; by default 1", .kind = FIELD_SPECIAL,
     .read = read_weight},
    {"object", "keys of an object that are not drawn", .kind = FIELD_SPECIAL, .read = read_object,
     REQUIRED},
    {"draw", "what other keys of the object are drawn from", .kind = FIELD_SPECIAL,
     .read = read_item_draws},
};
static const struct section item_section = {item_fields, COUNT(item_fields), NULL};

/* Items on their way into the campaign. */
struct item_list {
    struct campaign *campaign;
    struct item **items;
    size_t *count;
    double sum; /* of the weights */
};

static sonject_status read_item(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    struct item_list *list = structure;
    CHECK(grow_list(reader->report, list->items, *list->count, sizeof **list->items));
    struct item *item = &(*list->items)[(*list->count)++];
    struct item_text text = {list->campaign, item};
    item->weight = 1.0;
    item->place = node->place;
    sonject_status status = read_section(reader, &item_section, node, &text);
    list->sum += item->weight;
    return status;
}

static sonject_status read_items(struct reader *reader, const struct tree_node *node,
                                 struct campaign *campaign, struct item **items, size_t *count)
{
    static const struct list entries = {CAMPAIGN_ITEMS_MAX, "", read_item};
    struct item_list list = {campaign, items, count, 0.0};
    if (node->kind != TREE_LIST || node->count == 0 || node->count > CAMPAIGN_ITEMS_MAX)
        return refuse_value(reader, node, "must be a list of 1 to %d entries, not of %zu",
                            CAMPAIGN_ITEMS_MAX, node->count);
    const sonject_status status = read_list(reader, node, &entries, &list);
    if (status == SONJECT_OK && !(list.sum > 0.0))
        return refuse_value(reader, node, "has weights that are all 0");
    return status;
}

sonject_status read_targets(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct campaign *campaign = structure;
    return read_items(reader, node, campaign, &campaign->targets, &campaign->target_count);
}

sonject_status read_clutter_objects(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    struct campaign *campaign = structure;
    return read_items(reader, node, campaign, &campaign->clutter, &campaign->clutter_count);
}

/* Whole numbers: fixed, or a choice of such. */
sonject_status read_clutter_number(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct campaign *campaign = structure;
    struct distribution *number = &campaign->clutter_number;
    number->stream = ++campaign->streams;
    CHECK(distribution_read(reader, node, "clutter.number", number));
    if (number->kind != DISTRIBUTION_FIXED && number->kind != DISTRIBUTION_CHOICE)
        return refuse_value(reader, node, "must be a whole number or a choice of such");
    for (size_t i = 0; i < number->count; i++) {
        uint64_t value;
        if (!text_to_count(number->texts[i], &value) || value > CAMPAIGN_CLUTTER_MAX)
            return refuse_value(reader, node, "must be whole numbers from 0 to %d",
                                CAMPAIGN_CLUTTER_MAX);
    }
    return SONJECT_OK;
}

#define PIXELS_MAX (UINT64_C(1) << 40)
#define BOXES_MAX  1000 /* in a swath */

static sonject_status read_swath_path(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct swath_plan *swath = structure;
    CHECK(read_path(reader, node, &swath->path));
    swath->written = copy_text(node->text);
    return swath->written ? SONJECT_OK : report_out_of_memory(reader->report, "the campaign");
}

static sonject_status read_split_name(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct swath_plan *swath = structure;
    const char *name = read_text(reader, node);
    if (!name)
        return SONJECT_ERROR_INPUT;
    swath->split = copy_text(name);
    return swath->split ? SONJECT_OK : report_out_of_memory(reader->report, "the campaign");
}

static sonject_status read_swath_key(struct reader *reader, const struct tree_entry *entry,
                                     struct swath_plan *swath)
{
    char *value = NULL;
    sonject_status status = check_scene_key(reader, entry, entry->key, false);
    THEN(status, grow_list(reader->report, &swath->keys, swath->key_count, sizeof *swath->keys));
    THEN(status, tree_override_text(reader->report, &entry->value, &value));
    if (status != SONJECT_OK)
        return status;
    const size_t bytes = strlen(entry->key) + strlen(value) + 2;
    char *pair = allocate_array(bytes, 1);
    if (pair)
        snprintf(pair, bytes, "%s=%s", entry->key, value);
    free(value);
    CHECK_MEMORY(reader->report, pair, "the campaign");
    swath->keys[swath->key_count++] = pair;
    return SONJECT_OK;
}

static sonject_status read_swath_keys(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    sonject_status status = SONJECT_OK;
    if (node->kind != TREE_SECTION)
        return refuse_value(reader, node, "must be a section of 'key: value' lines");
    for (size_t i = 0; !reading_ends(status) && i < node->count; i++)
        status = read_swath_key(reader, &node->entries[i], structure);
    return status;
}

static const struct field box_fields[] = {
    {"row", "first row", COUNT64(struct region, first_row, PIXELS_MAX), REQUIRED},
    {"column", "first column", COUNT64(struct region, first_column, PIXELS_MAX), REQUIRED},
    {"rows", "number of rows", COUNT64(struct region, rows, PIXELS_MAX), REQUIRED},
    {"columns", "number of columns", COUNT64(struct region, columns, PIXELS_MAX), REQUIRED},
};
static const struct section box_section = {box_fields, COUNT(box_fields), NULL};

static sonject_status read_box(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct swath_plan *swath = structure;
    CHECK(grow_list(reader->report, &swath->avoid, swath->avoid_count, sizeof *swath->avoid));
    return read_section(reader, &box_section, node, &swath->avoid[swath->avoid_count++]);
}

static sonject_status read_avoid(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    static const struct list boxes = {BOXES_MAX, " of {row: , column: , rows: , columns: }",
                                      read_box};
    return read_list(reader, node, &boxes, structure);
}

static const struct field swath_fields[] = {
    {"path", "image file", .kind = FIELD_SPECIAL, .read = read_swath_path, REQUIRED},
    {"split", "that all of its images are in", .kind = FIELD_SPECIAL, .read = read_split_name},
    {"set", "keys of the scene for this swath", .kind = FIELD_SPECIAL, .read = read_swath_keys},
    {"avoid", "boxes of contacts that images are not to show", .kind = FIELD_SPECIAL,
     .read = read_avoid},
};
static const struct section swath_section = {swath_fields, COUNT(swath_fields), NULL};

static sonject_status check_split_name(struct reader *reader, const struct campaign *campaign,
                                       const struct swath_plan *swath, const struct tree_node *node)
{
    struct word_list list = {{0}, 0};
    for (size_t i = 0; i < campaign->split_count; i++) {
        if (!swath->split || strcmp(swath->split, campaign->splits[i].name) == 0)
            return SONJECT_OK;
        list_word(&list, campaign->splits[i].name);
    }
    if (mistakes_concern(reader->tree->mistakes, reader->tree, "splits"))
        return SONJECT_ERROR_INPUT;
    return refuse_key(reader, node, "split", "is none of the splits, which are %s", list.text);
}

static sonject_status read_swath(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct campaign *campaign = structure;
    CHECK(grow_list(reader->report, &campaign->swaths, campaign->swath_count,
                    sizeof *campaign->swaths));
    struct swath_plan *swath = &campaign->swaths[campaign->swath_count++];
    swath->place = node->place;
    sonject_status status = read_section(reader, &swath_section, node, swath);
    return reading_ends(status) ? status : check_split_name(reader, campaign, swath, node);
}

sonject_status read_swaths(struct reader *reader, const struct tree_node *node, void *structure)
{
    static const struct list swaths = {CAMPAIGN_SWATHS_MAX, "", read_swath};
    if (node->kind != TREE_LIST || node->count == 0 || node->count > CAMPAIGN_SWATHS_MAX)
        return refuse_value(reader, node, "must be a list of 1 to %d entries", CAMPAIGN_SWATHS_MAX);
    return read_list(reader, node, &swaths, structure);
}

bool is_split_name(const char *name)
{
    static const char signs[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    return *name && *name != '-' && strspn(name, signs) == strlen(name) &&
           strlen(name) < SPLIT_NAME_CAPACITY;
}

sonject_status read_splits(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct campaign *campaign = structure;
    double sum = 0.0;
    sonject_status status = SONJECT_OK;
    if (node->kind != TREE_SECTION || node->count == 0 || node->count > CAMPAIGN_SPLITS_MAX)
        return refuse_value(reader, node, "must be a section of 1 to %d 'name: fraction' lines",
                            CAMPAIGN_SPLITS_MAX);
    campaign->split_count = 0;
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        struct split *split = &campaign->splits[campaign->split_count++];
        memset(split, 0, sizeof *split);
        const size_t before = key_path_add(&reader->path, entry->key);
        if (is_split_name(entry->key))
            strcpy(split->name, entry->key);
        else
            status = tree_failure(reader->tree, entry->place, reader->path.text,
                                  "names a folder: use up to %d letters, digits, _ and -",
                                  SPLIT_NAME_CAPACITY - 1);
        if (read_quantity(reader, &entry->value, QUANTITY_NUMBER, &split->fraction) != SONJECT_OK)
            status = SONJECT_ERROR_INPUT;
        else if (!(split->fraction > 0.0 && split->fraction <= 1.0))
            status = refuse_value(reader, &entry->value, "must be above 0 and at most 1");
        sum += split->fraction;
        key_path_shorten(&reader->path, before);
    }
    if (status == SONJECT_OK && fabs(sum - 1.0) > 1e-6)
        return refuse_value(reader, node, "add up to %g; make that 1", sum);
    return status;
}
