/* Ranges of a material's values. */
#include <math.h>

#include "scene/check_material.h"

#define PI 3.14159265358979323846

/* 1/pi written in decimal digits must not be refused for its last bit. */
#define ENERGY_SLACK (1.0 + 1e-12)

/* At normal incidence the rough part returns pi * lambert + glossy_albedo of the energy, whatever
 * the exponent. It must fit into what roughness can take from the smooth part; where nothing is
 * known of that but its angle-dependent limit, or there is none, into all of it. */
static void check_energy(struct check *check, const struct material_keys *keys,
                         const sonject_material_params *material, double own_lambert)
{
    const bool has_own = isnan(material->lambert) && !isnan(own_lambert);
    const double lambert = has_own ? own_lambert : material->lambert;
    const bool is_reduced =
        material->reflection_kind == SONJECT_REFLECTION_CONSTANT && material->reflection != 0.0;
    const double available = is_reduced ? material->reflection * material->reflection : 1.0;
    const char *bound = is_reduced ? "reflection^2" : "1";
    if (!(lambert >= 0.0 && PI * lambert <= available * ENERGY_SLACK))
        check_relation(check, keys->lambert, keys->energy,
                       "must be 0...%.4g (%s / pi), or the surface returns more than it receives; "
                       "it is %s%g",
                       available / PI, bound, has_own ? "the seabed's own, " : "", lambert);
    const double left = fmax(0.0, available - PI * lambert);
    if (!(material->glossy_albedo >= 0.0 &&
          PI * lambert + material->glossy_albedo <= available * ENERGY_SLACK))
        check_relation(check, keys->albedo, keys->energy,
                       "must be 0...%.4g (%s - pi lambert), or the surface returns more than it "
                       "receives; it is %g",
                       left, bound, material->glossy_albedo);
}

void check_material(struct check *check, const struct material_keys *keys,
                    const sonject_material_params *material, double own_lambert)
{
    check_choice(check, keys->reflection, material->reflection_kind, SONJECT_REFLECTION_FLUID + 1);
    check_within(check, keys->reflection, material->reflection, -1.0, 1.0, "");
    check_within(check, keys->roughness, material->roughness_m, 0.0, 1.0, " m");
    check_energy(check, keys, material, own_lambert);
    check_within(check, keys->exponent, material->lambert_exponent, 1.0, 64.0, "");
    check_within(check, keys->slope, material->glossy_slope, 0.01, 1.0, "");
    check_within(check, keys->density, material->density_ratio, 0.001, 100.0, " times the water's");
    check_within(check, keys->speed, material->speed_ratio, 0.01, 20.0, " times the water's");
    check_within(check, keys->loss, material->loss, 0.0, 1.0, "");
}
