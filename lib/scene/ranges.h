/* How the checks of a scene say that a value is out of range. */
#ifndef SONJECT_SCENE_RANGES_H
#define SONJECT_SCENE_RANGES_H

#include <stdint.h>

#include <sonject/object.h>

#include "base/report.h"

/* A check that goes on. Keys are the names of values as scene files write them, in static storage.
 * Only the first failure is kept. */
struct check {
    struct report *report;
    const char **key; /* gets the first failure's; may be NULL */
    sonject_status status;
};

/* The message "<key> <what>"; check->status becomes INPUT. */
void check_failure(struct check *check, const char *key, const char *format, ...) REPORT_FORMAT(3);

/* unit: as it stands behind a number, " m"; "" for none. */
void check_within(struct check *check, const char *key, double value, double minimum,
                  double maximum, const char *unit);
void check_finite(struct check *check, const char *key, double value);

/* Choices are numbered from 0. */
void check_choice(struct check *check, const char *key, uint32_t value, uint32_t count);

/* Lengths in m: above 0, from 0, and of any sign. */
void check_positive_length(struct check *check, const char *key, double value_m);
void check_length(struct check *check, const char *key, double value_m);
void check_coordinate(struct check *check, const char *key, double value_m);

/* Names of a material's values where it is used. */
struct material_keys {
    const char *reflection, *roughness, *lambert, *exponent, *albedo, *slope, *density, *speed,
        *loss;
};

/* MATERIAL_KEYS("material.") are those of an object's. */
#define MATERIAL_KEYS(prefix)                                                                      \
    {                                                                                              \
        prefix "reflection", prefix "roughness", prefix "lambert", prefix "exponent",              \
            prefix "glossy.albedo", prefix "glossy.slope", prefix "fluid.density",                 \
            prefix "fluid.speed", prefix "fluid.loss"                                              \
    }

/* Ranges and energy bound of a material, as material.h states them. own_lambert: what its lambert
 * is where that is NaN; NaN where it must be a number. */
void check_material(struct check *check, const struct material_keys *keys,
                    const sonject_material_params *material, double own_lambert);

/* Shape, sizes, ends and cuts of an object, as object.h states them. */
void check_shape(struct check *check, const sonject_object_params *object);

#endif
