#include "scene/relief_features.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"

#define GRID_SIZE_MAX (UINT32_C(1) << 24)
#define OVERSHOOT     1.3 /* of irregular ripples where crests meet, over regular ones */

bool relief_grid_fits(uint64_t rows, uint64_t columns)
{
    return rows >= 2 && rows <= RELIEF_GRID_SIDE_MAX && columns >= 2 &&
           columns <= RELIEF_GRID_SIDE_MAX && rows * columns <= GRID_SIZE_MAX;
}

static sonject_status check_grid(const sonject_relief_params *grid, const float *heights_m,
                                 struct report *report)
{
    struct check check = {report, NULL, SONJECT_OK};
    if (!relief_grid_fits(grid->rows, grid->columns))
        check_failure(&check, "relief", "must be 2...%u rows and columns, at most 2^24 points",
                      RELIEF_GRID_SIDE_MAX);
    check_coordinate(&check, "relief's first_along_track", grid->first_along_track_m);
    check_coordinate(&check, "relief's first_ground_range", grid->first_ground_range_m);
    check_positive_length(&check, "relief's row_spacing", grid->row_spacing_m);
    check_positive_length(&check, "relief's column_spacing", grid->column_spacing_m);
    for (size_t i = 0; check.status == SONJECT_OK && i < (size_t)grid->rows * grid->columns; i++)
        if (!(fabs((double)heights_m[i]) <= RELIEF_HEIGHT_MAX_M))
            check_failure(&check, "relief",
                          "must be within %g m of the mean seabed; at row %zu, column %zu it is %g "
                          "m",
                          RELIEF_HEIGHT_MAX_M, i / grid->columns, i % grid->columns,
                          (double)heights_m[i]);
    return check.status;
}

sonject_status relief_features_append(struct relief_features *features, struct report *report,
                                      const struct relief_feature *feature)
{
    if (features->count >= RELIEF_FEATURES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "relief must be at most %d features; join some", RELIEF_FEATURES_MAX);
    struct relief_feature *grown =
        realloc(features->features, (features->count + 1) * sizeof *grown);
    CHECK_MEMORY(report, grown, "relief");
    features->features = grown;
    features->features[features->count++] = *feature;
    return SONJECT_OK;
}

sonject_status relief_features_set_grid(struct relief_features *features, struct report *report,
                                        const sonject_relief_params *grid, const float *heights_m)
{
    float *copy = NULL;
    if (grid->rows > 0) {
        CHECK(check_grid(grid, heights_m, report));
        const size_t count = (size_t)grid->rows * grid->columns;
        copy = allocate_array(count, sizeof *copy);
        CHECK_MEMORY(report, copy, "relief");
        memcpy(copy, heights_m, count * sizeof *copy);
    }
    free(features->heights_m);
    features->heights_m = copy;
    features->grid = *grid;
    return SONJECT_OK;
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
