/* The keys of campaign files on swaths, contacts to avoid, and splits. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/campaign.h"
#include "schema/keys.h"

#define SWATHS_MAX 10000
#define PIXELS_MAX (UINT64_C(1) << 40)
#define BOXES_MAX  1000 /* boxes in a swath */

/* Reads a swath's path, and keeps the text as written. */
static sonject_status read_swath_path(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct swath_plan *swath = structure;
    swath->written = node->text;
    return read_path(reader, node, &swath->path);
}

static sonject_status read_swath_keys(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct swath_plan *swath = structure;
    if (node->kind != TREE_SECTION)
        return refuse_value(reader, node, "must be a section of 'key: value' lines");
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        char *value = NULL;
        struct growing_text pair = {NULL, 0, 0, false};
        if (campaign_check_entry(reader, entry, entry->key, false) != SONJECT_OK)
            continue;
        CHECK(grow_list(reader->report, &swath->keys, swath->key_count, sizeof *swath->keys,
                        "the campaign"));
        CHECK(tree_override_text(reader->report, &entry->value, &value));
        growing_text_add(&pair, "%s=%s", entry->key, value);
        free(value);
        swath->keys[swath->key_count] = growing_text_end(&pair);
        CHECK_MEMORY(reader->report, swath->keys[swath->key_count], "the campaign");
        swath->key_count++;
    }
    return SONJECT_OK;
}

sonject_status campaign_read_lengths(struct reader *reader, const struct tree_node *node,
                                     void *member)
{
    double *ends_m = member;
    if (node->kind != TREE_LIST || node->count != 2)
        return refuse_value(reader, node, "must be two lengths, [from, to]");
    for (int i = 0; i < 2; i++)
        CHECK(read_quantity(reader, &node->entries[i].value, QUANTITY_LENGTH, &ends_m[i]));
    if (ends_m[0] < ends_m[1])
        return SONJECT_OK;
    return refuse_value(reader, node, "begins at %g m, which is not below its end, %g m", ends_m[0],
                        ends_m[1]);
}

#define STRUCTURE struct avoided_box
static const struct field box_fields[] = {
    {"along_track", "[from, to] of the box along the track",
     SPECIAL(campaign_read_lengths, "list of two lengths"), MEMBER(along_track_m)},
    {"slant_range", "[from, to] of the box in slant range",
     SPECIAL(campaign_read_lengths, "list of two lengths"), MEMBER(slant_range_m)},
    {"row", "first row of the box", COUNT64(pixels.first_row, 0, PIXELS_MAX)},
    {"column", "first column of the box", COUNT64(pixels.first_column, 0, PIXELS_MAX)},
    {"rows", "number of rows of the box", COUNT64(pixels.rows, 0, PIXELS_MAX)},
    {"columns", "number of columns of the box", COUNT64(pixels.columns, 0, PIXELS_MAX)},
};
static const struct section box_section = {
    ROWS(box_fields), .choice = "along_track+slant_range row+column+rows+columns"};
#undef STRUCTURE

static sonject_status read_box(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct swath_plan *swath = structure;
    CHECK(grow_list(reader->report, &swath->avoid, swath->avoid_count, sizeof *swath->avoid,
                    "the campaign"));
    struct avoided_box *box = &swath->avoid[swath->avoid_count++];
    box->along_track_m[0] = box->slant_range_m[0] = NAN;
    return read_section(reader, &box_section, node, box);
}

static sonject_status read_avoid(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    static const struct list boxes = {
        0, BOXES_MAX, " of {along_track: [from, to], slant_range: [from, to]}", read_box};
    return read_list(reader, node, &boxes, structure);
}

#define STRUCTURE struct swath_plan
static const struct field swath_fields[] = {
    {"path", "image file of the swath", SPECIAL(read_swath_path, "file name"), REQUIRED},
    {"split", "split that all images of this swath are in; by default any", TEXT(split)},
    {"set", "keys of the scene for this swath, such as {input.channel: port}",
     SPECIAL(read_swath_keys, "section")},
    {"avoid",
     "boxes of contacts that no image shows; if chip.rows or chip.columns is all, only objects "
     "keep away from them",
     SPECIAL(read_avoid, "list"), .is_list = true, .section = &box_section},
    {"range_over_altitude",
     "[least, most] slant range over altitude for this swath's images, instead of "
     "chip.range_over_altitude",
     SPECIAL(campaign_read_ratio, "list of two numbers"), MEMBER(ratio),
     .range = "1..." TEXT_OF(RATIO_MAX)},
};
const struct section campaign_swath_section = {ROWS(swath_fields)};
#undef STRUCTURE

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
                    sizeof *campaign->swaths, "the campaign"));
    struct swath_plan *swath = &campaign->swaths[campaign->swath_count++];
    swath->place = node->place;
    const sonject_status status = read_section(reader, &campaign_swath_section, node, swath);
    return reading_ends(status) ? status : check_split_name(reader, campaign, swath, node);
}

sonject_status campaign_read_swaths(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    static const struct list swaths = {0, SWATHS_MAX, "", read_swath};
    if (node->kind != TREE_LIST || node->count == 0 || node->count > SWATHS_MAX)
        return refuse_value(reader, node, "must be a list of 1 to %d entries", SWATHS_MAX);
    return read_list(reader, node, &swaths, structure);
}

bool is_split_name(const char *name)
{
    return is_band_name(name) && *name != '-' && strlen(name) < SPLIT_NAME_CAPACITY;
}

sonject_status campaign_read_splits(struct reader *reader, const struct tree_node *node,
                                    void *structure)
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
            status = refuse_value(reader, &entry->value,
                                  "must be above 0 and at most 1; leave a split without images "
                                  "out");
        sum += split->fraction;
        key_path_shorten(&reader->path, before);
    }
    if (status == SONJECT_OK && fabs(sum - 1.0) > 1e-6)
        return refuse_value(reader, node, "add up to %g; make that 1", sum);
    return status;
}
