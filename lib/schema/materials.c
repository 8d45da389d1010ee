/* The keys of materials: how surfaces return sound, given by name or key by key. Seabed and sea
 * surface are among them. */
#include <math.h>

#include "schema/keys.h"

#include <stdio.h>

/* Tolerance for 1/pi written in decimal digits, whose last bit may be too large. */
#define ENERGY_SLACK (1.0 + 1e-12)

/* ---- Names. */

struct named_material {
    const char *name;
    double density_ratio, speed_ratio, loss; /* ratios to sea water's 1025 kg/m3 and 1500 m/s */
    double roughness_m;                      /* rms height, by order of magnitude */
    double lambert;
    double grain_size_phi; /* mean grain size of a sediment; NaN: no sediment */
};

/* The known materials. Objects: densities and compressional speeds are of the order that handbooks
 * of acoustics give. They are fluids without shear waves, so reflection is a little low between the
 * critical angles. Sediments: "APL-UW High-Frequency Ocean Environmental Acoustic Models Handbook",
 * TR 9407 (1994), table 2, as commonly tabulated; their Lambert part is Mackenzie's. */
static const struct named_material materials[] = {
    {"steel", 0.0, 0.0, 0.0, 0.0, 0.0, NAN}, /* the defaults of material_section */
    {"concrete", 2.3, 2.1, 0.01, 1.0e-3, 0.063, NAN},
    {"rubber", 1.1, 1.03, 0.05, 0.5e-3, 0.02, NAN},
    {"wood", 0.9, 1.3, 0.02, 1.0e-3, 0.05, NAN},
    {"rock", 2.5, 2.5, 0.01, 5.0e-3, 0.1, NAN},
    {"gravel", 2.492, 1.3370, 0.01705, 20.0e-3, 1.9953e-3, -1.0},
    {"coarse sand", 2.231, 1.2503, 0.01638, 10.0e-3, 1.9953e-3, 0.5},
    {"medium sand", 1.845, 1.1782, 0.01624, 5.0e-3, 1.9953e-3, 1.5},
    {"fine sand", 1.451, 1.1073, 0.01602, 3.0e-3, 1.9953e-3, 2.5},
    {"silt", 1.149, 0.9873, 0.00386, 2.0e-3, 1.9953e-3, 6.0},
    {"clay", 1.145, 0.9801, 0.00148, 1.0e-3, 1.9953e-3, 9.0},
};

/* Returns whether names are equal, where '_' and '-' may replace blanks. */
static bool is_same_name(const char *given, const char *name)
{
    for (; *name; given++, name++) {
        const char letter = *given == '_' || *given == '-' ? ' ' : *given;
        if (letter != *name)
            return false;
    }
    return *given == 0;
}

bool material_named(const char *name, sonject_material_params *material)
{
    size_t i = 0;
    while (i < COUNT(materials) && !is_same_name(name, materials[i].name))
        i++;
    if (i == COUNT(materials))
        return false;
    section_defaults(&material_section, material, NULL);
    if (i > 0) {
        material->reflection_kind = SONJECT_REFLECTION_FLUID;
        material->density_ratio = materials[i].density_ratio;
        material->speed_ratio = materials[i].speed_ratio;
        material->loss = materials[i].loss;
        material->roughness_m = materials[i].roughness_m;
        material->lambert = materials[i].lambert;
    }
    return true;
}

const char *material_name(uint32_t index)
{
    return index < COUNT(materials) ? materials[index].name : NULL;
}

double material_grain_size(uint32_t index)
{
    return materials[index].grain_size_phi;
}

sonject_status find_material(struct reader *reader, const struct tree_node *node, bool of_sediments,
                             uint32_t *index)
{
    const char *names[COUNT(materials)];
    struct word_list list = {{0}, 0};
    const char *name = read_text(reader, node);
    if (!name)
        return SONJECT_ERROR_INPUT;
    for (uint32_t i = 0; material_name(i); i++) {
        if (of_sediments && isnan(material_grain_size(i)))
            continue;
        *index = i;
        if (is_same_name(name, material_name(i)))
            return SONJECT_OK;
        names[list.count] = material_name(i);
        list_word(&list, names[list.count]);
    }
    return refuse_word(reader, node, name, &list, nearest_word(name, names, list.count));
}

sonject_status read_material_name(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    uint32_t index;
    CHECK(find_material(reader, node, false, &index));
    material_named(material_name(index), structure);
    return SONJECT_OK;
}

/* Takes all but lambert from the sediment, because the seabed has its own. */
sonject_status read_sediment_name(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    sonject_material_params *material = structure;
    const sonject_status status = read_material_name(reader, node, material);
    material->lambert = NAN;
    return status;
}

/* ---- The energy that a surface returns. */

/* Checks that the energy of the rough part fits into what roughness can take from the smooth part.
 * At normal incidence the rough part returns pi * lambert + glossy_albedo, whatever the exponent. A
 * fluid, whose limit depends on the angle, or no smooth part leaves room for all energy. */
void relate_energy(struct check *check, const char *prefix, const sonject_material_params *material,
                   double own_lambert)
{
    const bool has_own = isnan(material->lambert) && !isnan(own_lambert);
    const double lambert = has_own ? own_lambert : material->lambert;
    const bool is_reduced =
        material->reflection_kind == SONJECT_REFLECTION_CONSTANT && material->reflection != 0.0;
    const double available = is_reduced ? material->reflection * material->reflection : 1.0;
    const char *bound = is_reduced ? "reflection^2" : "1";
    char key[40], others[160];
    snprintf(others, sizeof others, "lambert %slambert %sreflection %sname %ssediment", prefix,
             prefix, prefix, prefix);
    snprintf(key, sizeof key, "%slambert", prefix);
    if (!(lambert >= 0.0 && PI * lambert <= available * ENERGY_SLACK))
        check_relation(check, key, others,
                       "must be 0...%.4g (%s / pi), or the surface returns more than it receives; "
                       "it is %s%g",
                       available / PI, bound, has_own ? "the seabed's own, " : "", lambert);
    const double left = fmax(0.0, available - PI * lambert);
    snprintf(key, sizeof key, "%sglossy.albedo", prefix);
    if (!(material->glossy_albedo >= 0.0 &&
          PI * lambert + material->glossy_albedo <= available * ENERGY_SLACK))
        check_relation(check, key, others,
                       "must be 0...%.4g (%s - pi lambert), or the surface returns more than it "
                       "receives; it is %g",
                       left, bound, material->glossy_albedo);
}

/* ---- Keys of materials. */

/* Requires density and speed of what is no fluid yet. The keys may also change a named fluid. */
static sonject_status finish_fluid(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    const sonject_material_params *material = structure;
    const char *needed = "density speed";
    char key[64];
    while (material->reflection_kind != SONJECT_REFLECTION_FLUID && next_key(&needed, key))
        if (!is_given(node, key))
            refuse_key(reader, node, key, "missing; a fluid needs it (ratio to the water's)");
    return SONJECT_OK;
}

static sonject_status finish_material(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    sonject_material_params *material = structure;
    if (is_given(node, "reflection") && is_given(node, "fluid"))
        return refuse_key(reader, node, "reflection",
                          "fluid sets the reflection at every angle; remove one of the two");
    if (is_given(node, "reflection"))
        material->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    return SONJECT_OK;
}

#define STRUCTURE sonject_material_params
static const struct field glossy_fields[] = {
    {"albedo", "largest fraction of the energy that the glossy cone returns",
     QUANTITY(glossy_albedo, NUMBER), .range = "0...1, and at most what lambert leaves", REQUIRED},
    {"slope", "rms slope of the facets that make the glossy cone", QUANTITY(glossy_slope, NUMBER),
     WITHIN(0.01, 1.0), .preset = 0.1},
};
static const struct section glossy_section = {ROWS(glossy_fields)};

static const struct field fluid_fields[] = {
    {"density", "density, as a ratio to the water's; needed unless the material is a fluid by name",
     QUANTITY(density_ratio, NUMBER), WITHIN(0.001, 100.0), .per = " times the water's",
     .preset = 1.0, .hides_preset = true},
    {"speed", "sound speed, as a ratio to the water's; needed as density is",
     QUANTITY(speed_ratio, NUMBER), WITHIN(0.01, 20.0), .per = " times the water's", .preset = 1.0,
     .hides_preset = true},
    {"loss", "loss in the material: imaginary part of the wavenumber over its real part",
     QUANTITY(loss, NUMBER), WITHIN(0.0, 1.0)},
};
static const struct section fluid_section = {ROWS(fluid_fields), .finish = finish_fluid};

#define LAMBERT_RANGE                                                                              \
    .range = "0...reflection^2 / pi, or 1 / pi where there is no reflection, or it is a fluid's"

/* The keys of a material beside its name, and their defaults. */
#define MATERIAL_FIELDS(smooth, rough_m, mu)                                                       \
    {"reflection", "told by reflection or fluid", HIDDEN,                                          \
     WORD(reflection_kind) = {"constant", "fluid"}},                                               \
        {"reflection", "amplitude of the specular part, -1 to 1", QUANTITY(reflection, NUMBER),    \
         WITHIN(-1.0, 1.0), .preset = (smooth)},                                                   \
        {"roughness", "rms roughness height", QUANTITY(roughness_m, LENGTH), WITHIN(0.0, 1.0),     \
         .preset = (rough_m)},                                                                     \
        {"lambert", "coefficient mu of the rough part", QUANTITY(lambert, LEVEL), .preset = (mu),  \
         LAMBERT_RANGE},                                                                           \
        {"exponent", "exponent of the rough part's cosines; 1 is Lambert's law",                   \
         QUANTITY(lambert_exponent, NUMBER), WITHIN(1.0, 64.0), .preset = 1.0},                    \
        {"glossy", "glossy cone about the specular direction", SAME(glossy_section)},              \
    {                                                                                              \
        "fluid", "fluid that sound enters; sets reflection at every angle", SAME(fluid_section),   \
            SETS(reflection_kind, SONJECT_REFLECTION_FLUID)                                        \
    }

/* Names are read first, because the other keys change the named values. */
static const struct field material_fields[] = {
    {"name", "name of a known material", SPECIAL(read_material_name, "name")},
    MATERIAL_FIELDS(0.9, 1.0e-3, 0.1),
};
const struct section material_section = {ROWS(material_fields), .finish = finish_material,
                                         .bytes = sizeof(STRUCTURE)};

static const struct field forward_fields[] = {
    {"sediment", "name of a known material", SPECIAL(read_sediment_name, "name")},
    {"rule", "rough part: from the model alone, or multiplied by the image's map",
     .kind = FIELD_WORD, .is_in_scene = true, .offset = offsetof(struct scene, seabed.forward_rule),
     .words = {[SONJECT_FORWARD_MODEL] = "model", [SONJECT_FORWARD_MAP] = "map"}},
    MATERIAL_FIELDS(0.0, 0.0, NAN),
};
const struct section forward_section = {ROWS(forward_fields), .finish = finish_material,
                                        .bytes = sizeof(STRUCTURE)};

static const struct field waves_fields[] = {
    {"albedo", "largest fraction that the waves' cone returns; by default what lambert leaves",
     QUANTITY(glossy_albedo, NUMBER), .range = "0...1, and at most what lambert leaves",
     NONE_IF_NAN},
    {"slope", "rms slope of the waves that make the glossy cone", QUANTITY(glossy_slope, NUMBER),
     WITHIN(0.01, 1.0), .preset = 0.2},
};
static const struct section waves_section = {ROWS(waves_fields)};
#undef STRUCTURE

/* ---- The sea surface. */

static void relate_surface(struct check *check, const void *structure)
{
    const sonject_material_params material = surface_material(structure);
    relate_energy(check, "", &material, NAN);
}

/* The defaults are those of air above water. */
#define STRUCTURE sonject_surface_params
static const struct field surface_fields[] = {
    {"material", "material of the surface", HIDDEN, PART(material, material_section)},
    {"depth", "water depth: height of the sea surface over the mean seabed; 0: no surface",
     QUANTITY(water_depth_m, LENGTH), FROM_ZERO, REQUIRED},
    {"reflection", "amplitude of the sea surface's specular part, -1 to 1",
     QUANTITY(material.reflection, NUMBER), WITHIN(-1.0, 1.0), .preset = -1.0},
    {"roughness", "rms height of the waves", QUANTITY(material.roughness_m, LENGTH),
     WITHIN(0.0, 1.0)},
    {"lambert", "coefficient mu of the sea surface's rough part", QUANTITY(material.lambert, LEVEL),
     LAMBERT_RANGE},
    {"exponent", "exponent of the cosines of the sea surface's rough part; 1 is Lambert's law",
     QUANTITY(material.lambert_exponent, NUMBER), WITHIN(1.0, 64.0), .preset = 1.0},
    {"glossy", "glossy cone about the specular direction", PART(material, waves_section)},
};
const struct section surface_section = {ROWS(surface_fields), .relations = relate_surface,
                                        .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE
