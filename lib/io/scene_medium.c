/* The water of scene files: one sound speed, layers or a profile, and its absorption. */
#include "io/scene_medium.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/scene_fields.h"
#include "medium/profile.h"

const char *behind_name(const struct report *check)
{
    const char *blank = strchr(check->message, ' ');
    return blank ? blank + 1 : check->message;
}

sonject_status check_list(struct reader *reader, const struct tree_node *node, const char *example)
{
    if (node->kind != TREE_LIST || node->count == 0)
        return refuse_value(reader, node, "must be a list, such as %s", example);
    if (node->count > WATER_LAYERS_MAX)
        return refuse_value(reader, node, "has %zu entries; at most %d are possible", node->count,
                            WATER_LAYERS_MAX);
    return SONJECT_OK;
}

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
