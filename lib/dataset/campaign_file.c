/* Campaign files: the tables of their keys. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "dataset/campaign_fields.h"
#include "schema/scene_file.h"
#include "schema/yaml_tree.h"

#define STRUCTURE struct campaign

static sonject_status read_scene_name(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct campaign *campaign = structure;
    CHECK(read_path(reader, node, &campaign->scene_path));
    campaign->scene_written = copy_text(node->text);
    return campaign->scene_written ? SONJECT_OK
                                   : report_out_of_memory(reader->report, "the campaign");
}

static sonject_status read_range_end(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    struct campaign *campaign = structure;
    campaign->nearest_range_m = campaign->farthest_range_m;
    return read_quantity(reader, node, QUANTITY_LENGTH, &campaign->farthest_range_m);
}

static sonject_status read_range(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    static const struct list ends = {2, "", read_range_end};
    struct campaign *campaign = structure;
    if (node->kind != TREE_LIST || node->count != 2)
        return refuse_value(reader, node, "must be two slant ranges, [nearest, farthest]");
    sonject_status status = read_list(reader, node, &ends, campaign);
    if (status == SONJECT_OK && !(campaign->nearest_range_m < campaign->farthest_range_m))
        status = refuse_value(reader, node, "begins at %g m, which is not below its end, %g m",
                              campaign->nearest_range_m, campaign->farthest_range_m);
    campaign->has_range = true;
    return status;
}

/* Words, the first of which stands for the bit `first`, the next for the next. */
struct bit_words {
    const char *const *words;
    size_t count;
    uint32_t first;
    uint32_t *bits;
};

static sonject_status read_bit_word(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    const struct bit_words *bits = structure;
    struct word_list list = {{0}, 0};
    const char *text = read_text(reader, node);
    size_t word = 0;
    if (!text)
        return SONJECT_ERROR_INPUT;
    while (word < bits->count && strcmp(bits->words[word], text) != 0)
        list_word(&list, bits->words[word++]);
    if (word == bits->count)
        return refuse_word(reader, node, text, &list, nearest_word(text, bits->words, bits->count));
    *bits->bits |= bits->first << word;
    return SONJECT_OK;
}

static const struct list bit_words = {SIZE_MAX, "", read_bit_word};

static sonject_status read_outputs(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    static const char *const words[] = {"highlight", "shadow", "masks", "energy", "field"};
    struct campaign *campaign = structure;
    campaign->outputs &= OUTPUT_YOLO | OUTPUT_VOC;
    struct bit_words bits = {words, COUNT(words), OUTPUT_HIGHLIGHT, &campaign->outputs};
    return read_list(reader, node, &bit_words, &bits);
}

static sonject_status read_labels(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    static const char *const words[] = {"yolo", "voc"};
    struct campaign *campaign = structure;
    struct bit_words bits = {words, COUNT(words), OUTPUT_YOLO, &campaign->outputs};
    return read_list(reader, node, &bit_words, &bits);
}

static sonject_status finish_fraction(struct reader *reader, const struct tree_node *node,
                                      const char *key, double fraction)
{
    if (fraction >= 0.0 && fraction <= 1.0)
        return SONJECT_OK;
    return refuse_key(reader, node, key, "must be from 0 to 1, not %g", fraction);
}

static sonject_status finish_chip(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    const struct campaign *campaign = structure;
    if (campaign->chip_rows < 16)
        refuse_key(reader, node, "rows", "must be at least 16");
    if (campaign->chip_columns < 16)
        refuse_key(reader, node, "columns", "must be at least 16");
    return finish_fraction(reader, node, "spread", campaign->spread);
}

static const struct field chip_fields[] = {
    {"rows", "of each image", COUNT32(STRUCTURE, chip_rows, CAMPAIGN_CHIP_MAX), REQUIRED},
    {"columns", "of each image", COUNT32(STRUCTURE, chip_columns, CAMPAIGN_CHIP_MAX), REQUIRED},
    {"edge", "pixels that images stay away from swaths' edges",
     COUNT32(STRUCTURE, edge, UINT32_MAX / 4)},
    {"clearance", "pixels that images stay away from contacts to avoid",
     COUNT32(STRUCTURE, clearance, UINT32_MAX / 4)},
    {"spread", "part of the sides in which objects lie, about the middle, 0 to 1",
     QUANTITY(STRUCTURE, spread, QUANTITY_NUMBER)},
    {"slant_range", "[nearest, farthest] that the middle of an image may have",
     .kind = FIELD_SPECIAL, .read = read_range, .unit = "list of two lengths"},
};
static const struct section chip_section = {chip_fields, COUNT(chip_fields), finish_chip};

static sonject_status finish_clutter(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    const struct campaign *campaign = structure;
    return finish_fraction(reader, node, "alone", campaign->clutter_alone);
}

static const struct field clutter_fields[] = {
    {"objects", "list of what clutter may be, as targets are", .kind = FIELD_SPECIAL,
     .unit = "list", .read = read_clutter_objects, REQUIRED},
    {"number", "of clutter objects in an image with a target", .kind = FIELD_SPECIAL,
     .unit = "whole number, or a distribution", .read = read_clutter_number},
    {"alone", "fraction of images with clutter and no target",
     QUANTITY(STRUCTURE, clutter_alone, QUANTITY_NUMBER)},
};
static const struct section clutter_section = {clutter_fields, COUNT(clutter_fields),
                                               finish_clutter};

static sonject_status finish_campaign(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct campaign *campaign = structure;
    const double without_target = campaign->empty + campaign->clutter_alone;
    if (campaign->images == 0)
        refuse_key(reader, node, "images", "must be at least 1");
    finish_fraction(reader, node, "empty", campaign->empty);
    if (without_target > 1.0)
        refuse_relation(reader, node, "empty", "clutter", "and clutter.alone together are above 1");
    if (campaign->target_count == 0 && without_target < 1.0)
        refuse_relation(reader, node, "targets", "empty clutter",
                        "is missing; add it, or make empty and clutter.alone add up to 1");
    return SONJECT_OK;
}

/* Draws are read last, in this order, so that streams of random numbers keep their places. */
static const struct field campaign_fields[] = {
    {"sonject_campaign", "version of the format, 1", .kind = FIELD_SPECIAL, .read = read_version,
     REQUIRED},
    {"scene", "scene file with all that is not drawn", .kind = FIELD_SPECIAL,
     .read = read_scene_name, .unit = "file name", REQUIRED},
    {"images", "number of images", COUNT64(STRUCTURE, images, CAMPAIGN_IMAGES_MAX), REQUIRED},
    {"seed", "of all that is drawn", COUNT64(STRUCTURE, seed, UINT64_MAX)},
    {"design", "how values are drawn",
     WORD(STRUCTURE, design) =
         {[DESIGN_RANDOM] = "random", [DESIGN_STRATIFIED] = "stratified", [DESIGN_GRID] = "grid"}},
    {"chip", "size of images, and where in swaths they lie", .kind = FIELD_SECTION, .offset = 0,
     .section = &chip_section, REQUIRED},
    {"outputs", "written beside image and truth: highlight, shadow, masks, energy, field",
     .kind = FIELD_SPECIAL, .read = read_outputs, .unit = "list of words"},
    {"labels", "beside COCO: yolo, voc", .kind = FIELD_SPECIAL, .read = read_labels,
     .unit = "list of words"},
    {"empty", "fraction of images without any object", QUANTITY(STRUCTURE, empty, QUANTITY_NUMBER)},
    {"splits", "names and fractions, such as {train: 0.8, test: 0.2}", .kind = FIELD_SPECIAL,
     .read = read_splits, .unit = "section"},
    {"swaths", "list of the images that objects are put into", .kind = FIELD_SPECIAL,
     .read = read_swaths, .unit = "list", REQUIRED},
    {"draw", "what keys of the scene are drawn from", .kind = FIELD_SPECIAL,
     .read = read_campaign_draws, .unit = "section"},
    {"targets", "list of what is to be found", .kind = FIELD_SPECIAL, .read = read_targets,
     .unit = "list"},
    {"clutter", "what else lies there", .kind = FIELD_SECTION, .offset = 0,
     .section = &clutter_section},
};
static const struct section campaign_section = {campaign_fields, COUNT(campaign_fields),
                                                finish_campaign};

static sonject_status fill_campaign(struct tree *tree, const char *const *overrides, size_t count,
                                    struct campaign *campaign)
{
    struct reader reader = {.report = tree->report, .tree = tree};
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; !reading_ends(status) && i < count; i++)
        status = tree_override(tree, overrides[i]);
    if (reading_ends(status))
        return status;
    if (tree_is_null(&tree->root))
        return refuse_value(&reader, &tree->root,
                            "there is nothing in it; start with 'sonject_campaign: 1'");
    return read_section(&reader, &campaign_section, &tree->root, campaign);
}

static void set_defaults(struct campaign *campaign)
{
    memset(campaign, 0, sizeof *campaign);
    campaign->seed = 1;
    campaign->design = DESIGN_STRATIFIED;
    campaign->spread = 0.5;
    campaign->outputs = OUTPUT_HIGHLIGHT | OUTPUT_SHADOW | OUTPUT_MASKS;
    campaign->splits[0].fraction = 1.0;
    strcpy(campaign->splits[0].name, "all");
    campaign->split_count = 1;
}

sonject_status campaign_read(struct report *report, const char *path, const char *const *overrides,
                             size_t count, struct campaign *campaign)
{
    char *text = NULL;
    size_t bytes;
    set_defaults(campaign);
    campaign->path = copy_text(path);
    campaign->folder = path_folder(path);
    CHECK_MEMORY(report, campaign->path && campaign->folder, "the campaign");
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such campaign file; check its name", path);
    CHECK(file_read_whole(report, path, TREE_BYTES_MAX, &text, &bytes));
    struct mistakes mistakes = {NULL, 0, 0, 0};
    struct tree *tree = &campaign->tree;
    tree_init(tree, report, campaign->path);
    tree->mistakes = &mistakes;
    report->message[0] = 0;
    sonject_status status = tree_parse(tree, text, bytes);
    free(text);
    THEN(status, fill_campaign(tree, overrides, count, campaign));
    tree->mistakes = NULL;
    return mistakes_tell(&mistakes, report, status);
}

static void clear_draws(struct draws *draws)
{
    for (size_t i = 0; i < draws->count; i++)
        distribution_clear(&draws->list[i]);
    free(draws->list);
}

static void clear_items(struct item *items, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        clear_draws(&items[i].draws);
        free(items[i].object);
    }
    free(items);
}

static void clear_swath(struct swath_plan *swath)
{
    for (size_t i = 0; i < swath->key_count; i++)
        free(swath->keys[i]);
    free(swath->keys);
    free(swath->path);
    free(swath->written);
    free(swath->split);
    free(swath->avoid);
    chip_room_clear(&swath->room);
}

void campaign_clear(struct campaign *campaign)
{
    clear_draws(&campaign->draws);
    clear_draws(&campaign->object_draws);
    clear_items(campaign->targets, campaign->target_count);
    clear_items(campaign->clutter, campaign->clutter_count);
    distribution_clear(&campaign->clutter_number);
    for (size_t i = 0; i < campaign->swath_count; i++)
        clear_swath(&campaign->swaths[i]);
    free(campaign->swaths);
    for (size_t i = 0; i < campaign->split_count; i++) {
        free(campaign->splits[i].swaths);
        free(campaign->splits[i].shares);
    }
    free(campaign->scene_path);
    free(campaign->scene_written);
    free(campaign->folder);
    if (campaign->tree.file)
        tree_clear(&campaign->tree);
    free(campaign->path);
    memset(campaign, 0, sizeof *campaign);
}
