/* The water of scene files: one sound speed, layers or a profile, and its absorption. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "medium/water.h"
#include "schema/profile_table.h"
#include "schema/scene_fields.h"

/* What the section says, until it is the scene's. */
struct medium_text {
    sonject_medium_params medium;
    struct sea_water sea_water;
    struct water_layer *layers; /* owned, like all below */
    size_t layer_count;
    char *profile_file;
    double *heights_m, *depths_m, *speeds_mps;
    size_t height_count, depth_count, speed_count;
};

/* What a check of layers or profiles says behind the name that its message begins with. */
static const char *behind_name(const struct report *check)
{
    const char *blank = strchr(check->message, ' ');
    return blank ? blank + 1 : check->message;
}

/* That the node is a list of 1...WATER_LAYERS_MAX entries. example: for the message. */
static sonject_status check_list(struct reader *reader, const struct tree_node *node,
                                 const char *example)
{
    if (node->kind != TREE_LIST || node->count == 0)
        return refuse_value(reader, node, "must be a list, such as %s", example);
    if (node->count > WATER_LAYERS_MAX)
        return refuse_value(reader, node, "has %zu entries; at most %d are possible", node->count,
                            WATER_LAYERS_MAX);
    return SONJECT_OK;
}

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
    const struct number_array *array = find_array(reader, text->profile_file);
    return array ? profile_table_take(reader->report, array, table)
                 : profile_table_read(reader->report, text->profile_file, table);
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
    THEN(status, layers_of_profile(table->positions_m, table->speeds_mps, table->count, &check,
                                   &text->layers, &text->layer_count));
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
    THEN(status, layers_of_table(reader, node, key, &table, text));
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
static const struct section profile_section = {profile_fields, COUNT(profile_fields),
                                               finish_profile};
#undef STRUCTURE

#define STRUCTURE struct water_layer
static const struct field layer_fields[] = {
    {"bottom", "height of the lower edge over the mean seabed",
     QUANTITY(STRUCTURE, bottom_m, QUANTITY_LENGTH), REQUIRED},
    {"sound_speed", "of the layer", QUANTITY(STRUCTURE, speed_mps, QUANTITY_SPEED), REQUIRED},
    {"density", "of all layers or of none", QUANTITY(STRUCTURE, density, QUANTITY_DENSITY)},
};
const struct section layer_section = {layer_fields, COUNT(layer_fields), NULL};
#undef STRUCTURE

/* Densities stand at all layers or at none. node: the list. */
static sonject_status check_layers(struct reader *reader, const struct tree_node *node,
                                   const struct water_layer *layers)
{
    struct report check = {{0}, NULL, NULL};
    struct profile_place place;
    const char *what = NULL;
    for (size_t i = 0; !what && i < node->count; i++) {
        place.index = i;
        place.key = "density";
        if (is_given(&node->entries[i].value, "density") !=
            is_given(&node->entries[0].value, "density"))
            what = "give it for all layers or for none";
    }
    if (!what && check_water_layers(layers, node->count, &check, &place) != SONJECT_OK)
        what = behind_name(&check);
    if (!what)
        return SONJECT_OK;
    key_path_add_index(&reader->path, place.index);
    return refuse_key(reader, &node->entries[place.index].value, place.key, "%s", what);
}

static sonject_status read_layer(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct medium_text *text = structure;
    struct water_layer *layer = &text->layers[text->layer_count++];
    layer->density = 1.0;
    return read_section(reader, &layer_section, node, layer);
}

static sonject_status read_layers(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    static const struct list layers = {WATER_LAYERS_MAX, "", read_layer};
    struct medium_text *text = structure;
    sonject_status status =
        check_list(reader, node, "[{bottom: 0 m, sound_speed: 1490 m/s}, {bottom: 12 m, ...}]");
    if (status != SONJECT_OK)
        return status;
    text->layers = allocate_array(node->count, sizeof *text->layers);
    if (!text->layers)
        return report_out_of_memory(reader->report, "layers of water");
    status = read_list(reader, node, &layers, text);
    return status == SONJECT_OK ? check_layers(reader, node, text->layers) : status;
}

static sonject_status finish_sea_water(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    struct medium_text *text = structure;
    const struct sea_water *water = &text->sea_water;
    const double frequency = reader->scene->sonar.centre_frequency_hz;
    check_sea_water(water, NULL, listen_at(reader, node));
    if (mistakes_concern(reader->tree->mistakes, reader->tree, "sonar.frequency"))
        return SONJECT_OK;
    if (!(frequency >= ABSORPTION_FREQUENCY_MIN_HZ && frequency <= ABSORPTION_FREQUENCY_MAX_HZ))
        return refuse_value(reader, node,
                            "is known from 200 Hz to 1 MHz, not at the sonar's %g Hz; give it in "
                            "dB/m",
                            frequency);
    text->medium.absorption_db_per_m = sonject_absorption(
        frequency, water->temperature_celsius, water->salinity_permille, water->depth_m, water->ph);
    return SONJECT_OK;
}

#define STRUCTURE struct medium_text
static const struct field sea_water_fields[] = {
    {"temperature", "of sea water, degrees Celsius",
     QUANTITY(STRUCTURE, sea_water.temperature_celsius, QUANTITY_TEMPERATURE), REQUIRED},
    {"salinity", "per mille", QUANTITY(STRUCTURE, sea_water.salinity_permille, QUANTITY_NUMBER),
     REQUIRED},
    {"depth", "below the sea surface", QUANTITY(STRUCTURE, sea_water.depth_m, QUANTITY_LENGTH),
     REQUIRED},
    {"ph", "acidity; by default 8", QUANTITY(STRUCTURE, sea_water.ph, QUANTITY_NUMBER)},
};
static const struct section sea_water_section = {sea_water_fields, COUNT(sea_water_fields),
                                                 finish_sea_water};

static sonject_status read_absorption(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    struct medium_text *text = structure;
    if (node->kind != TREE_TEXT)
        return read_section(reader, &sea_water_section, node, text);
    return read_quantity(reader, node, QUANTITY_ABSORPTION, &text->medium.absorption_db_per_m);
}

static sonject_status read_profile(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    return read_section(reader, &profile_section, node, structure);
}

static sonject_status finish_medium(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    const struct medium_text *text = structure;
    return check_medium(&text->medium, NULL, listen_at(reader, node));
}

static const struct field medium_fields[] = {
    {"sound_speed", "of the water", QUANTITY(STRUCTURE, medium.sound_speed_mps, QUANTITY_SPEED)},
    {"reference_sound_speed",
     "that the image processor assumed; by default the true one, around the seabed",
     QUANTITY(STRUCTURE, medium.reference_sound_speed_mps, QUANTITY_SPEED)},
    {"absorption", "of the water: a number, or a section of what the sea water is like",
     QUANTITY(STRUCTURE, medium.absorption_db_per_m, QUANTITY_ABSORPTION),
     .section = &sea_water_section, .read = read_absorption},
    {"layers", "list of level layers instead of sound_speed, from the seabed upwards",
     .kind = FIELD_SPECIAL, .read = read_layers, .section = &layer_section, .is_list = true},
    {"profile", "measured sound speeds instead of sound_speed", .kind = FIELD_SPECIAL,
     .read = read_profile, .section = &profile_section},
};
const struct section medium_section = {medium_fields, COUNT(medium_fields), finish_medium};
#undef STRUCTURE

static void clear_text(struct medium_text *text)
{
    free(text->layers);
    free(text->profile_file);
    free(text->heights_m);
    free(text->depths_m);
    free(text->speeds_mps);
}

sonject_status read_medium(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct scene *scene = structure;
    struct medium_text text = {.medium = scene->medium, .sea_water = {.ph = 8.0}};
    if (tree_is_null(node))
        return SONJECT_OK;
    if (count_given(node, "sound_speed layers profile") > 1)
        refuse_value(reader, node,
                     "more than one of sound_speed, layers and profile is there; give one");
    const sonject_status status = read_section(reader, &medium_section, node, &text);
    if (status == SONJECT_OK) {
        free(scene->water_layers);
        scene->medium = text.medium;
        scene->water_layers = text.layers;
        scene->water_layer_count = text.layer_count;
        text.layers = NULL;
    }
    clear_text(&text);
    return status;
}
