/* The objects of a scene: their table, and what is read in a way of its own. */
#include <string.h>

#include "schema/scene_parts.h"
#include "schema/scene_shape.h"
#include "schema/scene_target.h"

#define STRUCTURE sonject_object_params

static const struct field position_fields[] = {
    {"along_track", "track position", QUANTITY(STRUCTURE, position_along, QUANTITY_LENGTH)},
    {"slant_range", "as the image shows it", QUANTITY(STRUCTURE, position_range, QUANTITY_LENGTH)},
    {"row", "of the swath, may be a fraction",
     QUANTITY(STRUCTURE, position_along, QUANTITY_NUMBER)},
    {"column", "of the swath, may be a fraction",
     QUANTITY(STRUCTURE, position_range, QUANTITY_NUMBER)},
};
static const struct section position_section = {position_fields, COUNT(position_fields),
                                                finish_position};

sonject_status finish_position(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_object_params *object = structure;
    return check_position(reader, node, &object->position_kind);
}

static sonject_status finish_burial(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    sonject_object_params *object = structure;
    if (count_given(node, "fraction proud") != 1 && are_sound(reader, "fraction proud"))
        return refuse_value(reader, node,
                            "needs fraction or proud; give one, or a depth by itself");
    object->burial_kind =
        is_given(node, "fraction") ? SONJECT_BURIAL_FRACTION : SONJECT_BURIAL_PROUD;
    return SONJECT_OK;
}

static const struct field burial_fields[] = {
    {"fraction", "of the height that the object has in its pose, 0 to 1",
     QUANTITY(STRUCTURE, burial_fraction, QUANTITY_NUMBER)},
    {"proud", "height of the highest point above the seabed",
     QUANTITY(STRUCTURE, proud_height_m, QUANTITY_LENGTH)},
};
static const struct section burial_section = {burial_fields, COUNT(burial_fields), finish_burial};

static sonject_status finish_level(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    sonject_object_params *object = structure;
    if (count_given(node, "target_strength over_seabed") != 1 &&
        are_sound(reader, "target_strength over_seabed"))
        return refuse_value(reader, node, "needs target_strength or over_seabed; give one");
    object->level_kind =
        is_given(node, "over_seabed") ? SONJECT_LEVEL_OVER_SEABED : SONJECT_LEVEL_TARGET_STRENGTH;
    return SONJECT_OK;
}

static const struct field level_fields[] = {
    {"target_strength", "of its echo's peak, between pixels too, speckle averaged out, re 1 m^2",
     QUANTITY(STRUCTURE, level_db, QUANTITY_DECIBEL)},
    {"over_seabed", "its echo's peak over the local mean seabed",
     QUANTITY(STRUCTURE, level_db, QUANTITY_DECIBEL)},
};
static const struct section level_section = {level_fields, COUNT(level_fields), finish_level};

/* Objects on their way into the scene begin as the target that their file describes, which their
 * own keys then change. */
static sonject_status read_object_target(struct reader *reader, const struct tree_node *node,
                                         void *structure)
{
    return read_target(reader, node, structure);
}

static sonject_status read_object_parts(struct reader *reader, const struct tree_node *node,
                                        void *structure)
{
    sonject_object_params *object = structure;
    object->shape = SONJECT_SHAPE_PARTS;
    return read_parts(reader, node, &object->material);
}

/* Keys are read in this order, whatever the file's: a target's file comes first, so that all other
 * keys change what it says; parts come last, when their surface is known. */
static const struct field object_fields[] = {
    {"target", "file that describes the object instead of shape or parts", .kind = FIELD_SPECIAL,
     .unit = "file name", .read = read_object_target},
    {"name", "of this object", LABEL(STRUCTURE, name)},
    {"class", "label for training; by default the shape", LABEL(STRUCTURE, class_name)},
    SHAPE_FIELDS,
    {"position",
     "ground point under the centre: centre, {along_track: , slant_range: } or {row: , column: }",
     WORD(STRUCTURE, position_kind) = {[SONJECT_POSITION_PATCH_CENTRE] = "centre"},
     .section = &position_section},
    TURN_FIELDS("from along-track towards range"),
    {"burial", "depth of the lowest point below the seabed, or {fraction: } or {proud: }",
     QUANTITY(STRUCTURE, burial_m, QUANTITY_LENGTH), .section = &burial_section},
    {"level",
     "scales the echo to {target_strength: } or {over_seabed: }; by default shape, material "
     "and seabed.lambert alone set it",
     .kind = FIELD_WORD, .offset = offsetof(STRUCTURE, level_kind), .words = {"physical"},
     .section = &level_section},
    SURFACE_FIELD("surface of the object: a material's name, or a section"),
    {"parts", "instead of one shape: the object is their union", .kind = FIELD_SPECIAL,
     .unit = "list", .section = &part_section, .is_list = true, .read = read_object_parts},
};
const struct section object_section = {object_fields, COUNT(object_fields), finish_object};

static sonject_status read_object(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct target_text text;
    (void)structure;
    memset(&text, 0, sizeof text);
    start_shape(&text.object, NULL);
    sonject_status status = read_section(reader, &object_section, node, &text);
    if (!reading_ends(status)) {
        const sonject_status of_parts = read_target_parts(reader, &text);
        status = of_parts == SONJECT_OK ? status : of_parts;
    }
    THEN(status, scene_append_object(reader->scene, reader->report, &text.object));
    target_text_clear(&text);
    return status;
}

sonject_status read_objects(struct reader *reader, const struct tree_node *node, void *structure)
{
    static const struct list objects = {SCENE_OBJECTS_MAX, "; start each object with '- '",
                                        read_object};
    return tree_is_null(node) ? SONJECT_OK : read_list(reader, node, &objects, structure);
}

sonject_status finish_object(struct reader *reader, const struct tree_node *node, void *structure)
{
    const struct target_text *text = structure;
    const bool is_one = count_given(node, "shape parts target") == 1;
    if (is_one && is_given(node, "target"))
        refuse_shape_keys(reader, node, "the target's file tells the shape");
    else if (is_one)
        check_shape_keys(reader, node, text->object.shape);
    check_shape_values(reader, node, &text->object);
    return check_one_given(reader, node, "shape parts target", "shape, parts and target");
}
