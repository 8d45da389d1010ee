/* The seabed's relief: a list of features. */
#include <string.h>

#include "schema/scene_fields.h"

#define STRUCTURE struct relief_feature

static sonject_status finish_place(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct relief_feature *feature = structure;
    return check_position(reader, node, &feature->position_kind);
}

static const struct field place_fields[] = {
    {"along_track", "track position", QUANTITY(STRUCTURE, position_along, QUANTITY_LENGTH)},
    {"slant_range", "of the mean seabed there, as the image shows it",
     QUANTITY(STRUCTURE, position_range, QUANTITY_LENGTH)},
    {"row", "of the swath, may be a fraction",
     QUANTITY(STRUCTURE, position_along, QUANTITY_NUMBER)},
    {"column", "of the swath, may be a fraction",
     QUANTITY(STRUCTURE, position_range, QUANTITY_NUMBER)},
};
static const struct section place_section = {place_fields, COUNT(place_fields), finish_place};

#define POSITION_FIELD                                                                             \
    {                                                                                              \
        "position", "of its middle: centre, {along_track: , slant_range: } or {row: , column: }",  \
            WORD(STRUCTURE, position_kind) = {[SONJECT_POSITION_PATCH_CENTRE] = "centre"},         \
                            .section = &place_section                                              \
    }

static sonject_status finish_kind(struct reader *reader, const struct tree_node *node,
                                  struct relief_feature *feature, enum relief_kind kind)
{
    feature->kind = kind;
    return check_relief_feature(feature, NULL, listen_at(reader, node));
}

static sonject_status finish_ripples(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    return finish_kind(reader, node, structure, RELIEF_RIPPLES);
}

static sonject_status finish_mound(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    return finish_kind(reader, node, structure, RELIEF_MOUND);
}

static sonject_status finish_pit(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    return finish_kind(reader, node, structure, RELIEF_PIT);
}

static sonject_status finish_scour(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    return finish_kind(reader, node, structure, RELIEF_SCOUR);
}

static const struct field ripples_fields[] = {
    {"wavelength", "from crest to crest", QUANTITY(STRUCTURE, wavelength_m, QUANTITY_LENGTH),
     REQUIRED},
    {"height", "from trough to crest", QUANTITY(STRUCTURE, height_m, QUANTITY_LENGTH), REQUIRED},
    {"heading", "direction across the crests, from along-track towards range",
     QUANTITY(STRUCTURE, heading_rad, QUANTITY_ANGLE)},
    {"phase", "at along-track 0 and ground range 0; a crest is at 0",
     QUANTITY(STRUCTURE, phase_rad, QUANTITY_ANGLE)},
    {"sharpness", "of the crests, 0 (a sine) to 1 (narrow crests, wide troughs)",
     QUANTITY(STRUCTURE, sharpness, QUANTITY_NUMBER)},
    {"irregularity", "0 (straight crests) to 1 (they wander, fork and end)",
     QUANTITY(STRUCTURE, irregularity, QUANTITY_NUMBER)},
    {"seed", "of the irregularity", COUNT64(STRUCTURE, seed, UINT64_MAX)},
};
static const struct section ripples_section = {ripples_fields, COUNT(ripples_fields),
                                               finish_ripples};

static const struct field mound_fields[] = {
    POSITION_FIELD,
    {"radius", "at which it ends, a raised cosine", QUANTITY(STRUCTURE, radius_m, QUANTITY_LENGTH),
     REQUIRED},
    {"height", "of its top over the ground around", QUANTITY(STRUCTURE, height_m, QUANTITY_LENGTH),
     REQUIRED},
};
static const struct section mound_section = {mound_fields, COUNT(mound_fields), finish_mound};

static const struct field pit_fields[] = {
    POSITION_FIELD,
    {"radius", "at which it ends, a raised cosine", QUANTITY(STRUCTURE, radius_m, QUANTITY_LENGTH),
     REQUIRED},
    {"depth", "of its bottom under the ground around",
     QUANTITY(STRUCTURE, height_m, QUANTITY_LENGTH), REQUIRED},
};
static const struct section pit_section = {pit_fields, COUNT(pit_fields), finish_pit};

static const struct field scour_fields[] = {
    {"object", "name of the object that it surrounds", LABEL(STRUCTURE, object), REQUIRED},
    {"width", "from the object's outline to where it ends",
     QUANTITY(STRUCTURE, width_m, QUANTITY_LENGTH), REQUIRED},
    {"depth", "at and under the object, which rests on its bottom",
     QUANTITY(STRUCTURE, height_m, QUANTITY_LENGTH), REQUIRED},
};
static const struct section scour_section = {scour_fields, COUNT(scour_fields), finish_scour};

static sonject_status finish_feature(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    static const char kinds[] = "ripples mound pit scour heights";
    (void)structure;
    if (count_given(node, kinds) != 1 && are_sound(reader, kinds))
        return refuse_value(reader, node,
                            "needs one of ripples, mound, pit, scour and heights; give one");
    return SONJECT_OK;
}

static const struct field relief_fields[] = {
    {"ripples", "of sand", SAME(ripples_section)},
    {"mound", "a round rise", SAME(mound_section)},
    {"pit", "a round hollow", SAME(pit_section)},
    {"scour", "a hollow around an object", SAME(scour_section)},
    {"heights", "from a file", .kind = FIELD_SPECIAL, .section = &heights_section,
     .read = read_relief_heights},
};
const struct section relief_section = {relief_fields, COUNT(relief_fields), finish_feature};

static sonject_status read_feature(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct relief_feature feature;
    (void)structure;
    memset(&feature, 0, sizeof feature);
    const sonject_status status = read_section(reader, &relief_section, node, &feature);
    if (status != SONJECT_OK || is_given(node, "heights")) /* which are in the scene already */
        return status;
    return relief_features_append(&reader->scene->relief, reader->report, &feature);
}

sonject_status read_relief(struct reader *reader, const struct tree_node *node, void *structure)
{
    static const struct list relief = {RELIEF_FEATURES_MAX, "; start each feature with '- '",
                                       read_feature};
    return tree_is_null(node) ? SONJECT_OK : read_list(reader, node, &relief, structure);
}
