/* The check of a material, wherever it is used. */
#ifndef SONJECT_SCENE_CHECK_MATERIAL_H
#define SONJECT_SCENE_CHECK_MATERIAL_H

#include <sonject/material.h>

#include "base/ranges.h"

/* Names of a material's values where it is used. */
struct material_keys {
    const char *reflection, *roughness, *lambert, *exponent, *albedo, *slope, *density, *speed,
        *loss;
    const char *energy; /* all that limits what may be returned, for check_relation */
};

/* MATERIAL_KEYS("material.") are those of an object's. */
#define MATERIAL_KEYS(prefix)                                                                      \
    {                                                                                              \
        prefix "reflection", prefix "roughness", prefix "lambert", prefix "exponent",              \
            prefix "glossy.albedo", prefix "glossy.slope", prefix "fluid.density",                 \
            prefix "fluid.speed", prefix "fluid.loss",                                             \
            "lambert " prefix "lambert " prefix "reflection " prefix "name " prefix "sediment"     \
    }

/* Ranges and energy bound of a material, as material.h states them. own_lambert: what its lambert
 * is where that is NaN; NaN where it must be a number. */
void check_material(struct check *check, const struct material_keys *keys,
                    const sonject_material_params *material, double own_lambert);

#endif
