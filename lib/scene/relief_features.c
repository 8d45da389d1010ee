#include "scene/relief_features.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"

#define GRID_SIZE_MAX (UINT32_C(1) << 24)
#define OVERSHOOT     1.3 /* irregular ripples where crests meet, over regular ones */

bool relief_grid_fits(uint64_t rows, uint64_t columns)
{
    return rows >= 2 && rows <= RELIEF_GRID_SIDE_MAX && columns >= 2 &&
           columns <= RELIEF_GRID_SIDE_MAX && rows * columns <= GRID_SIZE_MAX;
}

sonject_status relief_features_append(struct relief_features *features, struct report *report,
                                      const struct relief_feature *feature)
{
    struct relief_feature *grown =
        realloc(features->features, (features->count + 1) * sizeof *grown);
    CHECK_MEMORY(report, grown, "relief");
    features->features = grown;
    features->features[features->count++] = *feature;
    return SONJECT_OK;
}

void relief_features_take_grid(struct relief_features *features, const sonject_relief_params *grid,
                               float *heights_m)
{
    free(features->heights_m);
    features->heights_m = heights_m;
    features->grid = *grid;
}

void relief_features_clear(struct relief_features *features)
{
    free(features->features);
    free(features->heights_m);
    memset(features, 0, sizeof *features);
}

void relief_features_bounds(const struct relief_features *features, double *lowest_m,
                            double *highest_m)
{
    float low = 0.0f;
    float high = 0.0f;
    *lowest_m = *highest_m = 0.0;
    for (uint32_t i = 0; i < features->count; i++) {
        const struct relief_feature *feature = &features->features[i];
        const bool is_ripples = feature->kind == RELIEF_RIPPLES;
        const double height = is_ripples ? OVERSHOOT * 0.5 * feature->height_m : feature->height_m;
        *highest_m += is_ripples || feature->kind == RELIEF_MOUND ? height : 0.0;
        *lowest_m -= feature->kind != RELIEF_MOUND ? height : 0.0;
    }
    for (size_t i = 0;
         features->heights_m && i < (size_t)features->grid.rows * features->grid.columns; i++) {
        low = fminf(low, features->heights_m[i]);
        high = fmaxf(high, features->heights_m[i]);
    }
    *lowest_m += (double)low;
    *highest_m += (double)high;
}
