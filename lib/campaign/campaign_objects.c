/* What is drawn and what is put into images, as campaign files write it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "campaign/campaign_fields.h"
#include "io/scene_key.h"
#include "io/yaml_flow.h"

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
