/* What a scene says about a seabed that is not level: features that are added together. */
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

/* Members that a kind does not name are of no meaning. */
struct relief_feature {
    uint32_t kind;
    double height_m;     /* of a mound; of ripples from trough to crest; depth of pit and scour */
    double wavelength_m; /* ripples: from crest to crest */
    double heading_rad;  /* ripples: direction across the crests, from along-track towards range */
    double phase_rad;    /* ripples: at along-track 0, ground range 0; a crest is at 0 */
    double sharpness;    /* ripples: 0 (a sine) ... 1 (narrow crests, wide troughs) */
    double irregularity; /* ripples: 0 (straight crests) ... 1 (they wander, fork and end) */
    uint64_t seed;       /* ripples: of their irregularity */
    double radius_m;     /* mound, pit: raised cosine, 0 from there on */
    double width_m;      /* scour: from the object's outline to where it ends */
    uint32_t position_kind; /* mound, pit: as an object's */
    double position_along, position_range;
    char object[SONJECT_NAME_CAPACITY]; /* scour: name of the one; "": all */
};

/* Of a scene; all 0: the seabed is a plane. */
struct relief_features {
    struct relief_feature *features; /* owned */
    uint32_t count;
    sonject_relief_params grid; /* of the heights below */
    float *heights_m;           /* owned, rows x columns; NULL: none */
};

/* Whether heights may have so many: 2...RELIEF_GRID_SIDE_MAX of each, at most 2^24 points. */
bool relief_grid_fits(uint64_t rows, uint64_t columns);

/* Appends a copy; there are fewer than RELIEF_FEATURES_MAX. Errors: MEMORY. */
sonject_status relief_features_append(struct relief_features *features, struct report *report,
                                      const struct relief_feature *feature);

/* Takes heights over in place of those that are there: grid->rows x grid->columns, for free(). */
void relief_features_take_grid(struct relief_features *features, const sonject_relief_params *grid,
                               float *heights_m);

void relief_features_clear(struct relief_features *features);

/* Heights, m, that what is said cannot exceed; both 0 where the seabed is a plane. */
void relief_features_bounds(const struct relief_features *features, double *lowest_m,
                            double *highest_m);

#endif
