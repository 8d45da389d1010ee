/* Sound-speed profiles of scene files: a table's file, or lists. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/profile_table.h"
#include "io/scene_fields.h"
#include "io/scene_medium.h"
#include "medium/profile.h"

static sonject_status read_numbers(struct reader *reader, const struct tree_node *node,
                                   enum quantity quantity, double **values, size_t *count)
{
    sonject_status status = check_list(
        reader, node, quantity == QUANTITY_SPEED ? "[1490 m/s, 1500 m/s]" : "[0 m, 12 m, 15 m]");
    if (status != SONJECT_OK)
        return status;
    *values = allocate_array(node->count, sizeof **values);
    if (!*values)
        return report_out_of_memory(reader->report, "a sound-speed profile");
    *count = node->count;
    for (size_t i = 0; i < node->count; i++) {
        const size_t before = key_path_add_index(&reader->path, i);
        if (read_quantity(reader, &node->entries[i].value, quantity, &(*values)[i]) != SONJECT_OK)
            status = SONJECT_ERROR_INPUT;
        key_path_shorten(&reader->path, before);
    }
    return status;
}

static sonject_status read_heights(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct medium_text *text = structure;
    return read_numbers(reader, node, QUANTITY_LENGTH, &text->heights_m, &text->height_count);
}

static sonject_status read_depths(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct medium_text *text = structure;
    return read_numbers(reader, node, QUANTITY_LENGTH, &text->depths_m, &text->depth_count);
}

static sonject_status read_speeds(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct medium_text *text = structure;
    return read_numbers(reader, node, QUANTITY_SPEED, &text->speeds_mps, &text->speed_count);
}

/* The message about entry `index` of the list that is the section's `key`. */
static sonject_status refuse_entry(struct reader *reader, const struct tree_node *node,
                                   const char *key, size_t index, const char *what)
{
    const struct tree_node *list = &tree_find(node, key)->value;
    if (index >= list->count)
        return refuse_key(reader, node, key, "%s", what);
    const size_t before = key_path_add(&reader->path, key);
    key_path_add_index(&reader->path, index);
    const sonject_status status = refuse_value(reader, &list->entries[index].value, "%s", what);
    key_path_shorten(&reader->path, before);
    return status;
}

/* Moves what the lists say into a table. */
static sonject_status table_of_lists(struct reader *reader, const struct tree_node *node,
                                     struct medium_text *text, struct profile_table *table)
{
    const char *key = text->depths_m ? "depths" : "heights";
    struct profile_fault fault;
    if (!text->speeds_mps)
        return refuse_key(reader, node, "sound_speeds", "missing; %s need it", key);
    table->is_depth = text->depths_m != NULL;
    table->count = table->is_depth ? text->depth_count : text->height_count;
    if (text->speed_count != table->count)
        return refuse_key(reader, node, "sound_speeds", "has %zu entries, but %s has %zu",
                          text->speed_count, key, table->count);
    table->positions_m = table->is_depth ? text->depths_m : text->heights_m;
    table->speeds_mps = text->speeds_mps;
    text->heights_m = text->depths_m = text->speeds_mps = NULL;
    if (!profile_table_is_good(table, &fault))
        return refuse_entry(reader, node, fault.is_speed ? "sound_speeds" : key, fault.sample,
                            fault.what);
    return SONJECT_OK;
}

static sonject_status table_of_file(struct reader *reader, const struct tree_node *node,
                                    const struct medium_text *text, struct profile_table *table)
{
    if (is_given(node, "sound_speeds"))
        return refuse_key(reader, node, "sound_speeds",
                          "the file tells them; remove one of the two");
    return profile_table_read(reader->report, text->profile_file, table);
}

static sonject_status layers_of_table(struct reader *reader, const struct tree_node *node,
                                      const char *key, struct profile_table *table,
                                      struct medium_text *text)
{
    const double depth = reader->scene->surface.water_depth_m;
    struct report check = {{0}, NULL, NULL};
    if (table->is_depth && mistakes_concern(reader->tree->mistakes, reader->tree, "surface.depth"))
        return SONJECT_ERROR_INPUT;
    if (table->is_depth && !(depth > 0.0))
        return refuse_key(reader, node, key,
                          "depths are meant from the sea surface; set depth in surface");
    profile_table_to_heights(table, depth);
    sonject_status status = check_sound_speed_profile(table->positions_m, table->speeds_mps,
                                                      table->count, &check, NULL);
    free(text->layers); /* that the file has beside the profile, which is refused */
    text->layers = NULL;
    if (status == SONJECT_OK)
        status = layers_of_profile(table->positions_m, table->speeds_mps, table->count, &check,
                                   &text->layers, &text->layer_count);
    if (status == SONJECT_ERROR_INPUT)
        return refuse_key(reader, node, key, "%s", behind_name(&check));
    return status == SONJECT_OK ? status : report_out_of_memory(reader->report, "layers of water");
}

static sonject_status finish_profile(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    struct medium_text *text = structure;
    struct profile_table table = {NULL, NULL, 0, false};
    if (check_one_given(reader, node, "file heights depths", "file, heights and depths") !=
            SONJECT_OK ||
        !are_sound(reader, "file heights depths sound_speeds"))
        return SONJECT_ERROR_INPUT;
    sonject_status status = text->profile_file ? table_of_file(reader, node, text, &table)
                                               : table_of_lists(reader, node, text, &table);
    const char *key = text->profile_file ? "file" : table.is_depth ? "depths" : "heights";
    if (status == SONJECT_OK)
        status = layers_of_table(reader, node, key, &table, text);
    profile_table_clear(&table);
    return status;
}

#define STRUCTURE struct medium_text
static const struct field profile_fields[] = {
    {"file", "table with columns height_m or depth_m, and sound_speed_mps", .kind = FIELD_FILE,
     .offset = offsetof(STRUCTURE, profile_file)},
    {"heights", "over the mean seabed, list", .kind = FIELD_SPECIAL, .read = read_heights,
     .unit = "m, km, cm, mm"},
    {"depths", "below the sea surface, list; needs surface.depth", .kind = FIELD_SPECIAL,
     .read = read_depths, .unit = "m, km, cm, mm"},
    {"sound_speeds", "at heights or depths, list", .kind = FIELD_SPECIAL, .read = read_speeds,
     .unit = "m/s, km/s"},
};
const struct section profile_section = {profile_fields, COUNT(profile_fields), finish_profile};
#undef STRUCTURE
