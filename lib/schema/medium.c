/* The keys of the water: one sound speed, layers or a profile, and the absorption. */
#include <stdlib.h>

#include "base/memory.h"
#include "schema/keys.h"
#include "schema/tables.h"

static void replace_layers(struct scene *scene, struct water_layer *layers, size_t count)
{
    free(scene->water_layers);
    scene->water_layers = layers;
    scene->water_layer_count = count;
}

/* ---- A profile of the sound speed. */

struct numbers {
    double *values; /* owned; NULL: not given */
    size_t count;
    enum quantity quantity;
};

struct profile_text {
    char *file; /* owned */
    struct numbers heights, depths, speeds;
};

static sonject_status read_number(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct numbers *numbers = structure;
    return read_quantity(reader, node, numbers->quantity, &numbers->values[numbers->count++]);
}

static sonject_status read_numbers(struct reader *reader, const struct tree_node *node,
                                   enum quantity quantity, const char *how, struct numbers *numbers)
{
    const struct list list = {1, WATER_LAYERS_MAX, how, read_number};
    numbers->quantity = quantity;
    numbers->values = allocate_array(node->count, sizeof *numbers->values);
    CHECK_MEMORY(reader->report, numbers->values, "a sound-speed profile");
    return read_list(reader, node, &list, numbers);
}

#define NUMBERS_READER(name, member, quantity, how)                                                \
    static sonject_status name(struct reader *reader, const struct tree_node *node,                \
                               void *structure)                                                    \
    {                                                                                              \
        struct profile_text *text = structure;                                                     \
        return read_numbers(reader, node, quantity, how, &text->member);                           \
    }
NUMBERS_READER(read_heights, heights, QUANTITY_LENGTH, ", such as [0 m, 12 m, 15 m]")
NUMBERS_READER(read_depths, depths, QUANTITY_LENGTH, ", such as [0 m, 12 m, 15 m]")
NUMBERS_READER(read_speeds, speeds, QUANTITY_SPEED, ", such as [1490 m/s, 1500 m/s]")

/* Reports a message about entry `index` of the list that is the section's `key`. */
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

/* Moves the values of the lists into a table. */
static sonject_status table_of_lists(struct reader *reader, const struct tree_node *node,
                                     const char *key, struct profile_text *text,
                                     struct profile_table *table)
{
    struct profile_fault fault;
    struct numbers *positions = text->depths.values ? &text->depths : &text->heights;
    if (!text->speeds.values)
        return refuse_key(reader, node, "sound_speeds", "missing; %s need it", key);
    if (text->speeds.count != positions->count)
        return refuse_key(reader, node, "sound_speeds", "has %zu entries, but %s has %zu",
                          text->speeds.count, key, positions->count);
    *table = (struct profile_table){positions->values, text->speeds.values, positions->count,
                                    positions == &text->depths};
    positions->values = text->speeds.values = NULL;
    return profile_table_is_good(table, &fault)
               ? SONJECT_OK
               : refuse_entry(reader, node, fault.is_speed ? "sound_speeds" : key, fault.sample,
                              fault.what);
}

static sonject_status table_of_file(struct reader *reader, const struct tree_node *node,
                                    const char *file, struct profile_table *table)
{
    if (is_given(node, "sound_speeds"))
        return refuse_key(reader, node, "sound_speeds",
                          "the file gives them, too; remove one of the two");
    return profile_table_read(reader->report, file, find_array(reader, file), table);
}

static sonject_status layers_of_table(struct reader *reader, const struct tree_node *node,
                                      const char *key, struct profile_table *table)
{
    const double depth = reader->scene->surface.water_depth_m;
    struct report check = {.host = NULL};
    struct water_layer *layers;
    size_t count;
    if (table->is_depth && !is_valid_in_file(reader, "surface.depth"))
        return SONJECT_ERROR_INPUT;
    if (table->is_depth && !(depth > 0.0))
        return refuse_key(reader, node, key,
                          "depths count from the sea surface; set depth in surface");
    profile_table_to_heights(table, depth);
    const double highest = table->positions_m[table->count - 1];
    if (!(highest > 0.0))
        return refuse_key(reader, node, key,
                          "must lie over the seabed: the whole profile is below it (%g m)",
                          highest);
    const sonject_status status = layers_of_profile(table->positions_m, table->speeds_mps,
                                                    table->count, &check, &layers, &count);
    if (status == SONJECT_ERROR_INPUT)
        return refuse_key(reader, node, key, "%s", check.message);
    if (status != SONJECT_OK)
        return report_out_of_memory(reader->report, "layers of water");
    replace_layers(reader->scene, layers, count);
    return SONJECT_OK;
}

static sonject_status finish_profile(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    struct profile_text *text = structure;
    struct profile_table table = {NULL, NULL, 0, false};
    const char *key = text->file ? "file" : text->depths.values ? "depths" : "heights";
    if (count_given(node, "file heights depths") != 1 ||
        !are_valid(reader, "file heights depths sound_speeds"))
        return SONJECT_ERROR_INPUT;
    sonject_status status = text->file ? table_of_file(reader, node, text->file, &table)
                                       : table_of_lists(reader, node, key, text, &table);
    THEN(status, layers_of_table(reader, node, key, &table));
    profile_table_clear(&table);
    return status;
}

#define STRUCTURE struct profile_text
static const struct field profile_fields[] = {
    {"file", "table with columns height_m or depth_m, and sound_speed_mps", .kind = FIELD_FILE,
     MEMBER(file)},
    {"heights", "list of heights over the mean seabed", SPECIAL(read_heights, "m, km, cm, mm")},
    {"depths", "list of depths below the sea surface; needs surface.depth",
     SPECIAL(read_depths, "m, km, cm, mm")},
    {"sound_speeds", "list of sound speeds at the heights or depths",
     SPECIAL(read_speeds, "m/s, km/s")},
};
static const struct section profile_section = {
    ROWS(profile_fields), .choice = "file heights depths", .finish = finish_profile};
#undef STRUCTURE

static sonject_status read_profile(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct profile_text text = {.file = NULL};
    (void)structure;
    const sonject_status status = read_section(reader, &profile_section, node, &text);
    free(text.file);
    free(text.heights.values);
    free(text.depths.values);
    free(text.speeds.values);
    return status;
}

/* ---- Level layers. */

#define STRUCTURE struct water_layer
static const struct field layer_fields[] = {
    {"bottom", "height of the layer's lower edge over the mean seabed", QUANTITY(bottom_m, LENGTH),
     COORDINATE, REQUIRED},
    {"sound_speed", "sound speed of the layer", QUANTITY(speed_mps, SPEED),
     WITHIN(WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS), REQUIRED},
    {"density", "density of the layer; give it for all layers or for none",
     QUANTITY(density, DENSITY), WITHIN(1e-6, 1e6), NONE_IF_NAN},
};
const struct section layer_section = {ROWS(layer_fields)};
#undef STRUCTURE

/* Checks that all or no layers have a density, and bottoms rise from the seabed. node: the list. */
static sonject_status relate_layers(struct reader *reader, const struct tree_node *node,
                                    const struct water_layer *layers)
{
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_node *entry = &node->entries[i].value;
        const size_t before = key_path_add_index(&reader->path, i);
        if (is_given(entry, "density") != is_given(&node->entries[0].value, "density"))
            return refuse_key(reader, entry, "density", "give it for all layers or for none");
        if (i == 0 && layers[0].bottom_m != 0.0)
            return refuse_key(reader, entry, "bottom",
                              "must be 0 m: the first layer lies on the seabed; not %g m",
                              layers[0].bottom_m);
        if (i > 0 && !(layers[i].bottom_m >= layers[i - 1].bottom_m + WATER_HEIGHT_STEP_MIN_M))
            return refuse_key(
                reader, entry, "bottom",
                "must lie over the one before it, %g m, by at least %g m, not at %g m",
                layers[i - 1].bottom_m, WATER_HEIGHT_STEP_MIN_M, layers[i].bottom_m);
        key_path_shorten(&reader->path, before);
    }
    return SONJECT_OK;
}

static sonject_status read_layer(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct scene *scene = structure;
    struct water_layer *layer = &scene->water_layers[scene->water_layer_count++];
    layer->density = 1.0;
    return read_section(reader, &layer_section, node, layer);
}

static sonject_status read_layers(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    static const struct list list = {
        1, WATER_LAYERS_MAX,
        ", such as [{bottom: 0 m, sound_speed: 1490 m/s}, {bottom: 12 m, ...}]", read_layer};
    (void)structure;
    struct water_layer *layers = allocate_array(node->count, sizeof *layers);
    CHECK_MEMORY(reader->report, layers, "layers of water");
    replace_layers(reader->scene, layers, 0);
    CHECK(read_list(reader, node, &list, reader->scene));
    return relate_layers(reader, node, layers);
}

/* ---- Absorption. */

static sonject_status finish_sea_water(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    (void)structure;
    const double frequency = reader->scene->sonar.centre_frequency_hz;
    if (is_valid_in_file(reader, "sonar.frequency") &&
        !(frequency >= ABSORPTION_FREQUENCY_MIN_HZ && frequency <= ABSORPTION_FREQUENCY_MAX_HZ))
        return refuse_value(reader, node,
                            "is known from 200 Hz to 1 MHz, not at the sonar's %g Hz; give it in "
                            "dB/m",
                            frequency);
    return SONJECT_OK;
}

/* The ranges in which the formula of sonject_absorption holds. */
#define STRUCTURE struct sea_water
static const struct field sea_water_fields[] = {
    {"temperature", "temperature of the sea water, degrees Celsius",
     QUANTITY(temperature_celsius, TEMPERATURE), WITHIN(-2.0, 30.0), REQUIRED},
    {"salinity", "salinity of the sea water, per mille", QUANTITY(salinity_permille, NUMBER),
     WITHIN(0.0, 40.0), .per = " per mille", REQUIRED},
    {"depth", "depth below the sea surface at which the absorption is taken",
     QUANTITY(depth_m, LENGTH), WITHIN(0.0, 5000.0), REQUIRED},
    {"ph", "acidity (pH) of the sea water", QUANTITY(ph, NUMBER), WITHIN(7.0, 9.0), .preset = 8.0},
};
static const struct section sea_water_section = {ROWS(sea_water_fields),
                                                 .finish = finish_sea_water};
#undef STRUCTURE

static sonject_status read_absorption(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    sonject_medium_params *medium = structure;
    struct sea_water water;
    if (node->kind == TREE_TEXT)
        return read_quantity(reader, node, QUANTITY_ABSORPTION, &medium->absorption_db_per_m);
    section_defaults(&sea_water_section, &water, NULL);
    CHECK(read_section(reader, &sea_water_section, node, &water));
    if (is_valid_in_file(reader, "sonar.frequency"))
        medium->absorption_db_per_m =
            sonject_absorption(reader->scene->sonar.centre_frequency_hz, water.temperature_celsius,
                               water.salinity_permille, water.depth_m, water.ph);
    return SONJECT_OK;
}

/* ---- The water. */

#define STRUCTURE sonject_medium_params
static const struct field medium_fields[] = {
    {"sound_speed", "sound speed of the water", QUANTITY(sound_speed_mps, SPEED),
     WITHIN(WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS), .preset = 1500.0},
    {"reference_sound_speed",
     "sound speed that the image processor assumed; by default the true one, around the seabed",
     QUANTITY(reference_sound_speed_mps, SPEED), WITHIN(WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS),
     NONE_IF_ZERO},
    {"absorption", "absorption of the water: a number, or a section that describes the sea water",
     QUANTITY(absorption_db_per_m, ABSORPTION), WITHIN(0.0, 100.0), .section = &sea_water_section,
     .read = read_absorption},
    {"layers", "list of horizontal layers from the seabed upwards, instead of sound_speed",
     .kind = FIELD_SPECIAL, .read = read_layers, .section = &layer_section, .is_list = true},
    {"profile", "profile of measured sound speeds, instead of sound_speed", .kind = FIELD_SPECIAL,
     .read = read_profile, .section = &profile_section},
};
const struct section medium_section = {ROWS(medium_fields), .choice = "sound_speed layers profile",
                                       .may_lack = true, .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE
