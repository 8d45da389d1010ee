/* Materials of objects and seabed: a name, or a section whose keys change what the name stands for.
 */
#include <math.h>
#include <string.h>

#include "schema/scene_fields.h"

#define NAMES_MAX 32

static sonject_status refuse_name(struct reader *reader, const struct tree_node *node,
                                  const char *name)
{
    const char *names[NAMES_MAX];
    struct word_list list = {{0}, 0};
    while (list.count < NAMES_MAX && sonject_material_name((uint32_t)list.count)) {
        names[list.count] = sonject_material_name((uint32_t)list.count);
        list_word(&list, names[list.count]);
    }
    return refuse_word(reader, node, name, &list, nearest_word(name, names, list.count));
}

sonject_status read_material_name(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    const char *name = read_text(reader, node);
    if (!name)
        return SONJECT_ERROR_INPUT;
    if (sonject_material_named(name, structure) != SONJECT_OK)
        return refuse_name(reader, node, name);
    return SONJECT_OK;
}

sonject_status read_sediment_name(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    sonject_seabed_params *seabed = structure;
    const sonject_status status = read_material_name(reader, node, &seabed->forward);
    seabed->forward.lambert = NAN;
    return status;
}

/* The keys of fluid may change a named fluid; what is none yet needs them. */
static sonject_status finish_fluid(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    sonject_material_params *material = structure;
    static const char *const needed[] = {"density", "speed"};
    for (int i = 0; i < 2; i++)
        if (material->reflection_kind != SONJECT_REFLECTION_FLUID && !is_given(node, needed[i]))
            refuse_key(reader, node, needed[i], "missing; a fluid needs it (ratio to the water's)");
    material->reflection_kind = SONJECT_REFLECTION_FLUID;
    return SONJECT_OK;
}

static sonject_status set_reflection(struct reader *reader, const struct tree_node *node,
                                     sonject_material_params *material)
{
    if (is_given(node, "reflection") && is_given(node, "fluid"))
        return refuse_key(reader, node, "reflection",
                          "fluid tells the reflection at every angle; remove one of the two");
    if (is_given(node, "reflection"))
        material->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    return SONJECT_OK;
}

static sonject_status finish_material(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    return set_reflection(reader, node, structure);
}

static sonject_status finish_forward(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    sonject_seabed_params *seabed = structure;
    return set_reflection(reader, node, &seabed->forward);
}

#define STRUCTURE sonject_material_params
static const struct field glossy_fields[] = {
    {"albedo", "fraction of the energy that the cone returns at most",
     QUANTITY(STRUCTURE, glossy_albedo, QUANTITY_NUMBER), REQUIRED},
    {"slope", "rms slope of the facets that make the cone",
     QUANTITY(STRUCTURE, glossy_slope, QUANTITY_NUMBER)},
};
static const struct section glossy_section = {glossy_fields, COUNT(glossy_fields), NULL};

static const struct field fluid_fields[] = {
    {"density", "ratio to the water's", QUANTITY(STRUCTURE, density_ratio, QUANTITY_NUMBER)},
    {"speed", "of sound, ratio to the water's", QUANTITY(STRUCTURE, speed_ratio, QUANTITY_NUMBER)},
    {"loss", "imaginary over real part of the wavenumber",
     QUANTITY(STRUCTURE, loss, QUANTITY_NUMBER)},
};
static const struct section fluid_section = {fluid_fields, COUNT(fluid_fields), finish_fluid};
#undef STRUCTURE

/* A material that begins at offset `start` of a structure, member by member. */
#define MEMBER(start, member) .offset = (start) + offsetof(sonject_material_params, member)
#define MATERIAL_FIELDS(start)                                                                     \
    {"reflection", "amplitude of the mirror-like part, -1 to 1", .kind = FIELD_QUANTITY,           \
     .quantity = QUANTITY_NUMBER, MEMBER(start, reflection)},                                      \
        {"roughness", "rms height", .kind = FIELD_QUANTITY, .quantity = QUANTITY_LENGTH,           \
         MEMBER(start, roughness_m)},                                                              \
        {"lambert", "coefficient mu of the rough part", .kind = FIELD_QUANTITY,                    \
         .quantity = QUANTITY_LEVEL, MEMBER(start, lambert)},                                      \
        {"exponent", "of the rough part's cosines, 1 for Lambert's law", .kind = FIELD_QUANTITY,   \
         .quantity = QUANTITY_NUMBER, MEMBER(start, lambert_exponent)},                            \
        {"glossy", "cone about the mirror direction", .kind = FIELD_SECTION, .offset = (start),    \
         .section = &glossy_section},                                                              \
    {                                                                                              \
        "fluid", "what sound enters; gives the reflection at every angle",                         \
            .kind = FIELD_SECTION, .offset = (start), .section = &fluid_section                    \
    }

/* Names come first: the other keys change what they stand for. */
static const struct field material_fields[] = {
    {"name", "of a known material", .kind = FIELD_SPECIAL, .read = read_material_name,
     .unit = "name"},
    MATERIAL_FIELDS(0),
};
const struct section material_section = {material_fields, COUNT(material_fields), finish_material};

static const struct field forward_fields[] = {
    {"sediment", "name of a known material", .kind = FIELD_SPECIAL, .read = read_sediment_name,
     .unit = "name"},
    {"rule", "rough part from the model alone, or times the image's map",
     WORD(sonject_seabed_params,
          forward_rule) = {[SONJECT_FORWARD_MODEL] = "model", [SONJECT_FORWARD_MAP] = "map"}},
    MATERIAL_FIELDS(offsetof(sonject_seabed_params, forward)),
};
const struct section forward_section = {forward_fields, COUNT(forward_fields), finish_forward};
