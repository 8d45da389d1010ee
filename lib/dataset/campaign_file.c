/* The tables of keys of campaign files. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign.h"
#include "schema/keys.h"

#define OBJECT_PREFIX "objects[]."

/* Returns whether the campaign itself sets a key. */
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

sonject_status campaign_check_key(const struct tree *tree, struct tree_place place,
                                  const char *path, const char *key, bool is_object)
{
    const char *near, *unused, *of_objects = key;
    const struct section *section, *other;
    struct word_list list = {{0}, 0};
    if (!is_object && strncmp(key, "objects", 7) == 0 && strchr(key, '.'))
        of_objects = strchr(key, '.') + 1;
    if (!is_object && !is_taken(of_objects, true) &&
        scene_key_find(&object_section, of_objects, &unused, &other))
        return tree_failure(
            tree, place, path,
            "is a key of objects: write objects[].%s in draw, or %s in targets[].draw", of_objects,
            of_objects);
    if (is_taken(key, is_object))
        return tree_failure(tree, place, path, "the campaign itself sets %s; remove it", key);
    if (scene_key_find(is_object ? &object_section : &scene_section, key, &near, &section))
        return SONJECT_OK;
    if (is_object && scene_key_find(&scene_section, key, &unused, &other))
        return tree_failure(
            tree, place, path,
            "is a key of scenes: write it in the scene's file or the campaign's draw");
    for (size_t i = 0; i < section->count; i++)
        if (!section->fields[i].is_hidden)
            list_word(&list, section->fields[i].key);
    return tree_failure(tree, place, path,
                        near ? "scenes have no such key; did you mean '%s'?"
                             : "scenes have no such key; there are %s",
                        near ? near : list.text);
}

sonject_status campaign_check_entry(struct reader *reader, const struct tree_entry *entry,
                                    const char *key, bool is_object)
{
    const size_t before = key_path_add(&reader->path, entry->key);
    const sonject_status status =
        campaign_check_key(reader->tree, entry->place, reader->path.text, key, is_object);
    key_path_shorten(&reader->path, before);
    return status;
}

static sonject_status read_draw(struct reader *reader, struct campaign *campaign,
                                const struct tree_entry *entry, const char *key,
                                struct draws *draws)
{
    CHECK(
        grow_list(reader->report, &draws->list, draws->count, sizeof *draws->list, "the campaign"));
    struct distribution *distribution = &draws->list[draws->count++];
    distribution->stream = ++campaign->streams;
    const struct draws others = {draws->list, draws->count - 1};
    const bool is_table = strcmp(key, "table") == 0;
    const size_t before = key_path_add(&reader->path, entry->key);
    sonject_status status = is_table ? body_table_read(reader, &entry->value, distribution)
                                     : distribution_read(reader, &entry->value, key, distribution);
    if (status == SONJECT_OK && distribution->of && !draws_have_key(&others, distribution->of))
        status =
            refuse_value(reader, &entry->value, "is a ratio of '%s', which must be drawn before it",
                         distribution->of);
    for (size_t i = 0; is_table && status == SONJECT_OK && i < distribution->table->key_count; i++)
        if (draws_have_key(&others, distribution->table->keys[i]))
            status = refuse_value(reader, &entry->value, "draws %s, which is drawn already",
                                  distribution->table->keys[i]);
    if (status == SONJECT_OK && !is_table && draws_have_key(&others, key))
        status = refuse_value(reader, &entry->value, "is a column of the table, too; remove one");
    key_path_shorten(&reader->path, before);
    return status;
}

/* Reads the draws of an item, or of the scene if item is NULL. In the scene's draws,
 * "objects[].heading" and the like hold for all objects. */
static sonject_status read_draws(struct reader *reader, const struct tree_node *node,
                                 struct campaign *campaign, struct item *item)
{
    const size_t prefix = strlen(OBJECT_PREFIX);
    sonject_status status = SONJECT_OK;
    if (node->kind != TREE_SECTION && !tree_is_null(node))
        return refuse_value(reader, node, "must be a section of 'key: distribution' lines");
    for (size_t i = 0; !reading_ends(status) && i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        const bool is_of_all = !item && strncmp(entry->key, OBJECT_PREFIX, prefix) == 0;
        const char *key = entry->key + (is_of_all ? prefix : 0);
        const bool is_table = item && strcmp(key, "table") == 0;
        if (is_table || campaign_check_entry(reader, entry, key, item || is_of_all) == SONJECT_OK)
            status = read_draw(reader, campaign, entry, key,
                               item        ? &item->draws
                               : is_of_all ? &campaign->object_draws
                                           : &campaign->draws);
        if (is_table && status != SONJECT_OK)
            return status; /* other draws may be ratios of the table's columns */
    }
    return status;
}

static sonject_status read_item_draws(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct item *item = structure;
    return read_draws(reader, node, item->campaign, item);
}

static sonject_status read_campaign_draws(struct reader *reader, const struct tree_node *node,
                                          void *structure)
{
    return read_draws(reader, node, structure, NULL);
}

static sonject_status read_object(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct item *item = structure;
    if (node->kind != TREE_SECTION)
        return refuse_value(reader, node, "must be a section, as of objects in a scene");
    for (size_t i = 0; i < node->count; i++)
        campaign_check_entry(reader, &node->entries[i], node->entries[i].key, true);
    item->fixed = node;
    return tree_override_text(reader->report, node, &item->object);
}

static sonject_status finish_item(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct item *item = structure;
    item->place = node->place;
    if (is_given(node, "class") && (!*item->class_name || !text_is_printable(item->class_name)))
        refuse_key(reader, node, "class", "must be 1 to %d bytes on one line",
                   SONJECT_NAME_CAPACITY - 1);
    return SONJECT_OK;
}

#define STRUCTURE struct item
static const struct field item_fields[] = {
    {"class", "class of the object in labels, for training", LABEL(class_name), REQUIRED},
    {"weight", "how often the entry is drawn, relative to the weights of the other entries",
     QUANTITY(weight, NUMBER), WITHIN(0.0, 1e9), .preset = 1.0},
    {"object", "keys of the object that are fixed, not drawn", SPECIAL(read_object, "section"),
     REQUIRED},
    {"draw", "other keys of the object, with their distributions; table: rows of a file",
     SPECIAL(read_item_draws, "section")},
};
static const struct section item_section = {ROWS(item_fields), .finish = finish_item};
#undef STRUCTURE

/* Reads whole numbers: a fixed one, or a choice of several. */
static sonject_status read_number(struct reader *reader, const struct tree_node *node,
                                  struct campaign *campaign, uint64_t least, uint64_t most,
                                  struct distribution *number)
{
    uint64_t value;
    number->stream = ++campaign->streams;
    CHECK(distribution_read(reader, node, reader->path.text, number));
    if (number->kind != DISTRIBUTION_FIXED && number->kind != DISTRIBUTION_CHOICE)
        return refuse_value(reader, node, "must be a whole number or a choice of such");
    for (size_t i = 0; i < number->count; i++)
        if (!text_to_count(number->texts[i], &value) || value < least || value > most)
            return refuse_value(reader, node, "must be whole numbers from %d to %d", (int)least,
                                (int)most);
    return SONJECT_OK;
}

static sonject_status read_clutter_number(struct reader *reader, const struct tree_node *node,
                                          void *structure)
{
    struct campaign *campaign = structure;
    return read_number(reader, node, campaign, 0, CAMPAIGN_CLUTTER_MAX, &campaign->clutter_number);
}

static sonject_status read_target_number(struct reader *reader, const struct tree_node *node,
                                         void *structure)
{
    struct campaign *campaign = structure;
    return read_number(reader, node, campaign, 1, CAMPAIGN_TARGETS_MAX, &campaign->target_number);
}

static sonject_status read_scene_name(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct campaign *campaign = structure;
    campaign->scene_written = node->text;
    return read_path(reader, node, &campaign->scene_path);
}

sonject_status campaign_read_ratio(struct reader *reader, const struct tree_node *node,
                                   void *member)
{
    struct ratio_limits *ratio = member;
    if (node->kind != TREE_LIST || node->count != 2)
        return refuse_value(reader, node, "must be two numbers, [least, most]");
    CHECK(read_quantity(reader, &node->entries[0].value, QUANTITY_NUMBER, &ratio->least));
    CHECK(read_quantity(reader, &node->entries[1].value, QUANTITY_NUMBER, &ratio->most));
    if (ratio->least >= 1.0 && ratio->least < ratio->most && ratio->most <= RATIO_MAX)
        return SONJECT_OK;
    return refuse_value(reader, node,
                        "must be two rising numbers within 1...%d, where 1 is straight below the "
                        "sonar, not %g and %g",
                        RATIO_MAX, ratio->least, ratio->most);
}

static sonject_status read_grey(struct reader *reader, const struct tree_node *node, void *member)
{
    double *ends = member;
    if (node->kind != TREE_LIST || node->count != 2)
        return refuse_value(reader, node, "must be two levels, [black, white]");
    for (int i = 0; i < 2; i++)
        CHECK(read_quantity(reader, &node->entries[i].value, QUANTITY_DECIBEL, &ends[i]));
    if (ends[0] < ends[1])
        return SONJECT_OK;
    return refuse_value(reader, node,
                        "black must be below white, but black is %g dB and white %g dB", ends[0],
                        ends[1]);
}

static sonject_status read_side(struct reader *reader, const struct tree_node *node, void *member)
{
    uint64_t pixels = 0;
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (strcmp(text, "all") != 0 &&
        (!text_to_count(text, &pixels) || pixels < CAMPAIGN_CHIP_MIN || pixels > CAMPAIGN_CHIP_MAX))
        return refuse_value(reader, node, "must be all, or a whole number of %d...%d",
                            CAMPAIGN_CHIP_MIN, CAMPAIGN_CHIP_MAX);
    *(uint32_t *)member = (uint32_t)pixels;
    return SONJECT_OK;
}

/* The words of enum output, from the first that a user chooses on. Labels begin with yolo. */
static const char *const output_words[] = {"highlight", "shadow", "masks", "influence",
                                           "energy",    "field",  "yolo",  "voc"};
#define LABEL_WORDS 2

/* Reads an entry of the list `outputs` or `labels`, as the reader's path says. */
static sonject_status read_output(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    const size_t labels = COUNT(output_words) - LABEL_WORDS;
    const bool is_label = strncmp(reader->path.text, "labels", 6) == 0;
    const size_t first = is_label ? labels : 0;
    const size_t end = is_label ? COUNT(output_words) : labels;
    struct campaign *campaign = structure;
    struct word_list list = {{0}, 0};
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    for (size_t word = first; word < end; word++) {
        list_word(&list, output_words[word]);
        if (strcmp(output_words[word], text) == 0) {
            campaign->outputs |= OUTPUT_BIT(OUTPUT_HIGHLIGHT + word);
            return SONJECT_OK;
        }
    }
    return refuse_word(reader, node, text, &list,
                       nearest_word(text, output_words + first, end - first));
}

static sonject_status read_outputs(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    static const struct list words = {0, SIZE_MAX, "", read_output};
    struct campaign *campaign = structure;
    if (strcmp(reader->path.text, "outputs") == 0)
        campaign->outputs &= OUTPUT_ALWAYS | OUTPUT_BIT(OUTPUT_YOLO) | OUTPUT_BIT(OUTPUT_VOC);
    return read_list(reader, node, &words, campaign);
}

/* Checks that the items' weights are not all 0. */
static sonject_status check_items(struct reader *reader, const struct tree_node *node,
                                  const char *key, const struct item *items, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++)
        sum += items[i].weight;
    if (!is_given(node, key) || sum > 0.0)
        return SONJECT_OK;
    return refuse_key(reader, node, key, "must be a list of 1 to %d entries, not all of weight 0",
                      CAMPAIGN_ITEMS_MAX);
}

#define STRUCTURE  struct campaign
#define SIDE_RANGE TEXT_OF(CAMPAIGN_CHIP_MIN) "..." TEXT_OF(CAMPAIGN_CHIP_MAX) " pixels, or all"
static const struct field chip_fields[] = {
    {"rows", "rows of each image; all: as many as its swath has",
     SPECIAL(read_side, "whole number, or all"), MEMBER(chip_rows), .range = SIDE_RANGE, REQUIRED},
    {"columns", "columns of each image; all: as many as its swath has",
     SPECIAL(read_side, "whole number, or all"), MEMBER(chip_columns), .range = SIDE_RANGE,
     REQUIRED},
    {"edge", "pixels that images keep away from the edges of swaths",
     COUNT32(edge, 0, UINT32_MAX / 4), .per = " pixels"},
    {"clearance",
     "pixels that images (if rows or columns is all: objects' middles) keep away from contacts to "
     "avoid",
     COUNT32(clearance, 0, UINT32_MAX / 4), .per = " pixels"},
    {"spread", "share of each image side, about its middle, in which objects lie",
     QUANTITY(spread, NUMBER), WITHIN(0.0, 1.0), .preset = 0.5},
    {"slant_range",
     "[nearest, farthest] slant range of images' middles, or of objects if columns is all",
     SPECIAL(campaign_read_lengths, "list of two lengths"), MEMBER(slant_range_m)},
    {"range_over_altitude",
     "[least, most] slant range over altitude at images' middles (objects if columns is all); "
     "water column allowed",
     SPECIAL(campaign_read_ratio, "list of two numbers"), MEMBER(ratio),
     .range = "1..." TEXT_OF(RATIO_MAX)},
};
static const struct section chip_section = {ROWS(chip_fields)};

static sonject_status finish_visible(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    const struct campaign *campaign = structure;
    if (isnan(campaign->visible_highlight_db) && isnan(campaign->visible_shadow_db))
        refuse_key(reader, node, "highlight", "is missing, and so is shadow; give one of them");
    return SONJECT_OK;
}

static const struct field visible_fields[] = {
    {"highlight", "least visibility of targets' highlights, highlight_visibility_db in truth",
     QUANTITY(visible_highlight_db, DECIBEL), WITHIN(-100.0, 100.0), NONE_IF_NAN},
    {"shadow",
     "greatest visibility of targets' shadows, shadow_visibility_db in truth; dark ones are "
     "negative",
     QUANTITY(visible_shadow_db, DECIBEL), WITHIN(-100.0, 100.0), NONE_IF_NAN},
    {"otherwise",
     "treatment of a target that is less visible: draw it again, or label it as difficult",
     WORD(faint) = {[FAINT_REDRAW] = "redraw", [FAINT_DIFFICULT] = "difficult"}},
};
static const struct section visible_section = {ROWS(visible_fields), .finish = finish_visible};

static sonject_status finish_clutter(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    const struct campaign *campaign = structure;
    check_items(reader, node, "objects", campaign->clutter, campaign->clutter_count);
    return SONJECT_OK;
}

static const struct field clutter_fields[] = {
    {"objects", "list of kinds of clutter, written like targets",
     ENTRIES(clutter, clutter_count, "object", item_section), REQUIRED},
    {"number", "clutter objects in an image, by default 1; at least 1 where clutter is alone",
     SPECIAL(read_clutter_number, "whole number, or a choice"),
     .range = "0..." TEXT_OF(CAMPAIGN_CLUTTER_MAX)},
    {"alone", "fraction of images with clutter and no target", QUANTITY(clutter_alone, NUMBER),
     WITHIN(0.0, 1.0)},
    {"labelled", "label clutter in COCO, YOLO and VOC; else detectors learn it as background",
     FLAG(clutter_labelled), .preset = 1},
};
static const struct section clutter_section = {ROWS(clutter_fields), .finish = finish_clutter};

static sonject_status finish_campaign(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct campaign *campaign = structure;
    const double without_target = campaign->empty + campaign->clutter_alone;
    check_items(reader, node, "targets", campaign->targets, campaign->target_count);
    if (campaign->format == FORMAT_AS_INPUT && !isnan(campaign->grey_db[0]))
        refuse_relation(reader, node, "grey", "format",
                        "cannot be combined with format: as_input; remove one of the two");
    if (without_target > 1.0)
        refuse_relation(reader, node, "empty", "clutter",
                        "together with clutter.alone must be at most 1; lower one of the two");
    if (campaign->target_count == 0 && without_target < 1.0)
        refuse_relation(reader, node, "targets", "empty clutter",
                        "is missing; add it, or make empty and clutter.alone add up to 1");
    return SONJECT_OK;
}

/* Draws are read last, in this order, so that streams of random numbers keep their places. */
static const struct field campaign_fields[] = {
    {"sonject_campaign", "version of the format, 1", SPECIAL(read_version, "whole number"),
     REQUIRED},
    {"scene", "scene file with all values that are not drawn",
     SPECIAL(read_scene_name, "file name"), REQUIRED},
    {"images", "number of images", COUNT64(images, 1, CAMPAIGN_IMAGES_MAX), REQUIRED},
    {"seed", "seed of all random draws", COUNT64(seed, 0, 0), .preset = 1.0},
    {"design", "method of drawing values: random, in equal strata, or on a grid",
     WORD(design) =
         {[DESIGN_RANDOM] = "random", [DESIGN_STRATIFIED] = "stratified", [DESIGN_GRID] = "grid"},
     .preset = DESIGN_STRATIFIED},
    {"chip", "size of images, and their places in the swaths", SAME(chip_section), REQUIRED},
    {"outputs",
     "files beside image and truth: highlight, shadow, masks (by default these three), influence, "
     "energy, field",
     SPECIAL(read_outputs, "list of words")},
    {"format", "format of image files; as_input: a JPEG, coded alike, where the swath is a JPEG",
     WORD(format) = {[FORMAT_LOSSLESS] = "lossless", [FORMAT_AS_INPUT] = "as_input"}},
    {"grey",
     "[black, white] of 8 bit images for detectors: levels over full scale, as convert --db; "
     "default: swath's numbers",
     SPECIAL(read_grey, "list of two levels"), MEMBER(grey_db)},
    {"labels", "label formats besides COCO: yolo, voc", SPECIAL(read_outputs, "list of words")},
    {"empty", "fraction of images without any object", QUANTITY(empty, NUMBER), WITHIN(0.0, 1.0)},
    {"visible", "how visible targets must be", SAME(visible_section)},
    {"splits", "split names and fractions, such as {train: 0.8, test: 0.2}; by default {all: 1}",
     SPECIAL(campaign_read_splits, "section"), .range = "fractions above 0 that add up to 1"},
    {"swaths", "list of the images that objects are put into",
     SPECIAL(campaign_read_swaths, "list"), .is_list = true, .section = &campaign_swath_section,
     REQUIRED},
    {"draw", "keys of the scene that are drawn, with their distributions",
     SPECIAL(read_campaign_draws, "section")},
    {"targets", "list of kinds of targets, the objects to be found",
     ENTRIES(targets, target_count, "target", item_section)},
    {"clutter", "objects that lie in images besides targets", SAME(clutter_section)},
    {"targets_per_image",
     "targets in an image that has any, by default 1; all but the first are drawn by weight",
     SPECIAL(read_target_number, "whole number, or a choice"),
     .range = "1..." TEXT_OF(CAMPAIGN_TARGETS_MAX)},
};
const struct section campaign_section = {ROWS(campaign_fields), .finish = finish_campaign};

static sonject_status fill_campaign(struct tree *tree, const char *const *overrides, size_t count,
                                    struct campaign *campaign)
{
    struct reader reader = {.report = tree->report, .tree = tree};
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; !reading_ends(status) && i < count; i++)
        status = tree_override(tree, overrides[i], NULL);
    if (reading_ends(status))
        return status;
    if (tree_is_null(&tree->root))
        return refuse_value(&reader, &tree->root,
                            "there is nothing in it; start with 'sonject_campaign: 1'");
    return read_section(&reader, &campaign_section, &tree->root, campaign);
}

sonject_status campaign_read(struct report *report, const char *path, const char *text,
                             const char *const *overrides, size_t count, struct campaign *campaign)
{
    char *read = NULL;
    size_t bytes = text ? strlen(text) : 0;
    memset(campaign, 0, sizeof *campaign);
    section_defaults(&campaign_section, campaign, NULL);
    campaign->outputs = OUTPUT_ALWAYS | OUTPUT_BIT(OUTPUT_HIGHLIGHT) | OUTPUT_BIT(OUTPUT_SHADOW) |
                        OUTPUT_BIT(OUTPUT_MASKS);
    campaign->grey_db[0] = campaign->grey_db[1] = NAN;
    campaign->splits[0].fraction = 1.0;
    strcpy(campaign->splits[0].name, "all");
    campaign->split_count = 1;
    for (size_t i = 0; i < CAMPAIGN_ITEMS_MAX; i++)
        campaign->targets[i].campaign = campaign->clutter[i].campaign = campaign;
    campaign->path = copy_text(path);
    campaign->folder = path_folder(path);
    CHECK_MEMORY(report, campaign->path && campaign->folder, "the campaign");
    if (!text) {
        if (!file_exists(path))
            return input_failure(report, path, "there is no such campaign file; check its name");
        CHECK(file_read_whole(report, path, TREE_BYTES_MAX, &read, &bytes));
    }
    struct mistakes mistakes = {0};
    struct tree *tree = &campaign->tree;
    tree_init(tree, report, campaign->path);
    tree->mistakes = &mistakes;
    report->message[0] = 0;
    sonject_status status = tree_parse(tree, text ? text : read, bytes);
    free(read);
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
}

static void clear_swath(struct swath_plan *swath)
{
    for (size_t i = 0; i < swath->key_count; i++)
        free(swath->keys[i]);
    free(swath->keys);
    free(swath->path);
    free(swath->split);
    free(swath->block_objects);
    free(swath->avoid);
    crop_places_clear(&swath->room);
}

void campaign_clear(struct campaign *campaign)
{
    clear_draws(&campaign->draws);
    clear_draws(&campaign->object_draws);
    clear_items(campaign->targets, campaign->target_count);
    clear_items(campaign->clutter, campaign->clutter_count);
    distribution_clear(&campaign->clutter_number);
    distribution_clear(&campaign->target_number);
    for (size_t i = 0; i < campaign->swath_count; i++)
        clear_swath(&campaign->swaths[i]);
    free(campaign->swaths);
    for (size_t i = 0; i < campaign->split_count; i++) {
        free(campaign->splits[i].swaths);
        free(campaign->splits[i].shares);
    }
    free(campaign->scene_path);
    free(campaign->folder);
    if (campaign->tree.file)
        tree_clear(&campaign->tree);
    free(campaign->path);
    memset(campaign, 0, sizeof *campaign);
}
