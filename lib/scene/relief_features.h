/* The relief of a scene's seabed: features that are added together. */
#ifndef SONJECT_SCENE_RELIEF_FEATURES_H
#define SONJECT_SCENE_RELIEF_FEATURES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/params.h"

#include "base/report.h"

#define RELIEF_FEATURES_MAX  256
#define RELIEF_HEIGHT_MAX_M  100.0
#define RELIEF_GRID_SIDE_MAX 16384u /* rows or columns of heights */

enum relief_kind {
    RELIEF_RIPPLES,
    RELIEF_MOUND,
    RELIEF_PIT,
    RELIEF_SCOUR
};

/* A feature. Members whose comments do not name its kind are not used. */
struct relief_feature {
    uint32_t kind;
    double height_m;     /* mound: height; ripples: from trough to crest; pit, scour: depth */
    double wavelength_m; /* ripples: from crest to crest */
    double heading_rad;  /* ripples: direction across the crests, from along-track towards range */
    double phase_rad;    /* ripples: phase at along-track 0, ground range 0; a crest is at 0 */
    double sharpness;    /* ripples: 0 (a sine) ... 1 (narrow crests, wide troughs) */
    double irregularity; /* ripples: 0 (straight crests) ... 1 (they wander, fork and end) */
    uint64_t seed;       /* ripples: seed of the irregularity */
    double radius_m;     /* mound, pit: a raised cosine ends there */
    double width_m;      /* scour: from the object's outline to its end */
    uint32_t position_kind; /* mound, pit: as an object's */
    double position_along, position_range;
    char object[SONJECT_NAME_CAPACITY]; /* scour: name of the object within; "": all objects */
};

/* The relief of a scene; all 0: the seabed is a plane. */
struct relief_features {
    struct relief_feature *features; /* owned */
    uint32_t count;
    sonject_relief_params grid; /* grid of heights_m */
    float *heights_m;           /* owned, rows x columns; NULL: none */
};

/* Returns whether a grid fits: 2...RELIEF_GRID_SIDE_MAX rows and columns, at most 2^24 points. */
bool relief_grid_fits(uint64_t rows, uint64_t columns);

/* Appends a copy. There must be fewer than RELIEF_FEATURES_MAX features. Errors: MEMORY. */
sonject_status relief_features_append(struct relief_features *features, struct report *report,
                                      const struct relief_feature *feature);

/* Takes over heights, grid->rows x grid->columns, for free(), in place of earlier ones. */
void relief_features_take_grid(struct relief_features *features, const sonject_relief_params *grid,
                               float *heights_m);

void relief_features_clear(struct relief_features *features);

/* Returns heights, m, that the relief cannot exceed; both 0 where the seabed is a plane. */
void relief_features_bounds(const struct relief_features *features, double *lowest_m,
                            double *highest_m);

#endif
