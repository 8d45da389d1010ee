/* Materials by name. */
#include <stdbool.h>
#include <string.h>

#include <sonject/material.h>

struct named_material {
    const char *name;
    double density_ratio, speed_ratio, loss; /* to sea water's 1025 kg/m3 and 1500 m/s */
    double roughness_m;                      /* order of magnitude */
    double lambert;
};

/* Objects: densities and compressional speeds of the order that handbooks of acoustics give; fluids
 * without shear waves, so that reflection is a little low between the critical angles. Sediments:
 * "APL-UW High-Frequency Ocean Environmental Acoustic Models Handbook", TR 9407 (1994), table 2, as
 * commonly tabulated; their Lambert part is Mackenzie's. */
static const struct named_material materials[] = {
    {"concrete", 2.3, 2.1, 0.01, 1.0e-3, 0.063},
    {"rubber", 1.1, 1.03, 0.05, 0.5e-3, 0.02},
    {"wood", 0.9, 1.3, 0.02, 1.0e-3, 0.05},
    {"rock", 2.5, 2.5, 0.01, 5.0e-3, 0.1},
    {"gravel", 2.492, 1.3370, 0.01705, 20.0e-3, 1.9953e-3},
    {"coarse sand", 2.231, 1.2503, 0.01638, 10.0e-3, 1.9953e-3},
    {"medium sand", 1.845, 1.1782, 0.01624, 5.0e-3, 1.9953e-3},
    {"fine sand", 1.451, 1.1073, 0.01602, 3.0e-3, 1.9953e-3},
    {"silt", 1.149, 0.9873, 0.00386, 2.0e-3, 1.9953e-3},
    {"clay", 1.145, 0.9801, 0.00148, 1.0e-3, 1.9953e-3},
};

#define COUNT (sizeof materials / sizeof *materials)

/* Whether names are the same but for '_' and '-' in place of blanks. */
static bool is_same_name(const char *given, const char *name)
{
    for (; *name; given++, name++) {
        const char letter = *given == '_' || *given == '-' ? ' ' : *given;
        if (letter != *name)
            return false;
    }
    return *given == 0;
}

sonject_status sonject_material_named(const char *name, sonject_material_params *material)
{
    if (!name || !material)
        return SONJECT_ERROR_ARGUMENT;
    if (is_same_name(name, "steel")) {
        sonject_material_params_init(material);
        return SONJECT_OK;
    }
    for (size_t i = 0; i < COUNT; i++) {
        if (!is_same_name(name, materials[i].name))
            continue;
        sonject_material_params_init(material);
        material->reflection_kind = SONJECT_REFLECTION_FLUID;
        material->density_ratio = materials[i].density_ratio;
        material->speed_ratio = materials[i].speed_ratio;
        material->loss = materials[i].loss;
        material->roughness_m = materials[i].roughness_m;
        material->lambert = materials[i].lambert;
        return SONJECT_OK;
    }
    return SONJECT_ERROR_ARGUMENT;
}

const char *sonject_material_name(uint32_t index)
{
    return index == 0 ? "steel" : index <= COUNT ? materials[index - 1].name : NULL;
}
