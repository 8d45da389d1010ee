#include "inject/patch_level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"
#include "scene/cross_range.h"

#define LEVEL_FLOOR                                                                                \
    1e-6 /* of the patch's mean intensity: blank corners of a swath have no level                  \
          */

double seabed_cell_energy(const struct patch_view *view, const struct point_response *response,
                          double mu, double apparent_range_m)
{
    /* half a cell beyond the first return: before it there is no seabed, and straight below its
     * cells would cover any area */
    const double steepest = view_bottom_range(view) + 0.5 * range_energy_width(response);
    const double grazing = view_grazing(view, fmax(apparent_range_m, steepest));
    const double sine = sin(grazing);
    const double cosine = fmax(1e-6, cos(grazing));
    const double area = cross_range_energy_width(response, apparent_range_m) *
                        range_energy_width(response) / (view->range_ratio * cosine);
    return mu * sine * sine * area * view_energy_scale(view) *
           view_refraction_gain(view, apparent_range_m);
}

void patch_level_clear(struct patch_level *level)
{
    free(level->intensity);
    free(level->level);
    free(level->map);
    free(level->cell_energy);
    memset(level, 0, sizeof *level);
}

#define WATER_SHARE 0.05f /* of seabed around a pixel that tells its level */

static sonject_status take_intensity(struct patch_level *level, struct report *report,
                                     const struct patch_view *view, const float *pixels,
                                     bool is_complex, double *mean)
{
    double sum = 0.0;
    for (size_t i = 0; i < view->rows * view->columns; i++) {
        const double a = is_complex ? pixels[2 * i] : pixels[i];
        const double b = is_complex ? pixels[2 * i + 1] : 0.0;
        const double intensity = a * a + b * b;
        const size_t row = i / view->columns;
        if (!(intensity <= 1e30) || (!is_complex && a < 0.0))
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "the patch's pixel at row %zu, column %zu is %s: mend the image",
                view->is_mirrored ? view->rows - 1 - row : row, i % view->columns,
                isnan(a) || isnan(b)
                    ? "not a number (NaN)"
                    : (intensity > 1e30 ? "too large or infinite" : "a negative amplitude"));
        level->intensity[i] = (float)intensity;
        sum += intensity;
    }
    *mean = sum / (double)(view->rows * view->columns);
    if (!(*mean > 1e-30))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch has no pixel above 0: choose another patch");
    return SONJECT_OK;
}

/* The local mean of the seabed alone; in the water column that of the seabed nearby. */
static sonject_status level_beside_water(struct patch_level *level, struct report *report,
                                         const struct scene *scene, const struct patch_view *view)
{
    const size_t count = view->rows * view->columns;
    float *seabed = allocate_array(count, sizeof *seabed);
    float *share = allocate_array(count, sizeof *share);
    sonject_status status =
        seabed && share ? SONJECT_OK : report_out_of_memory(report, "the patch");
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        seabed[i] = i % view->columns < level->water_columns ? 0.0f : 1.0f;
    const double rows = scene->seabed.level_radius_m / view->row_spacing_m;
    const double columns = scene->seabed.level_radius_m / view->column_spacing_m;
    THEN(status, local_mean(report, seabed, view->rows, view->columns, rows, columns, share));
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        seabed[i] *= level->intensity[i];
    THEN(status,
         local_mean(report, seabed, view->rows, view->columns, rows, columns, level->level));
    for (size_t i = count; status == SONJECT_OK && i-- > 0;) {
        const bool has_neighbour = (i + 1) % view->columns != 0;
        level->level[i] = share[i] > WATER_SHARE ? level->level[i] / share[i]
                          : has_neighbour        ? level->level[i + 1]
                                                 : 0.0f;
    }
    free(seabed);
    free(share);
    return status;
}

/* Intensity (or its local mean) over the level. */
static sonject_status make_map(struct patch_level *level, struct report *report,
                               const struct scene *scene, const struct patch_view *view)
{
    const size_t pixels = view->rows * view->columns;
    sonject_status status = SONJECT_OK;
    if (scene->seabed.map == SONJECT_MAP_DESPECKLED)
        status = local_mean(report, level->intensity, view->rows, view->columns,
                            scene->seabed.despeckle_radius_m / view->row_spacing_m,
                            scene->seabed.despeckle_radius_m / view->column_spacing_m, level->map);
    else if (scene->seabed.map == SONJECT_MAP_COHERENT)
        memcpy(level->map, level->level, pixels * sizeof *level->map);
    else
        memcpy(level->map, level->intensity, pixels * sizeof *level->map);
    for (size_t i = 0; status == SONJECT_OK && i < pixels; i++)
        level->map[i] /= level->level[i];
    return status;
}

sonject_status patch_level_init(struct patch_level *level, struct report *report,
                                const struct scene *scene, const struct patch_view *view,
                                const struct point_response *response, const float *pixels,
                                bool is_complex)
{
    const size_t count = view->rows * view->columns;
    double mean = 0.0;
    memset(level, 0, sizeof *level);
    level->water_columns = view_water_columns(view);
    level->intensity = allocate_array(count, sizeof(float));
    level->level = allocate_array(count, sizeof(float));
    level->map = allocate_array(count, sizeof(float));
    level->cell_energy = allocate_array(view->columns, sizeof(float));
    sonject_status status = level->intensity && level->level && level->map && level->cell_energy
                                ? SONJECT_OK
                                : report_out_of_memory(report, "the patch");
    THEN(status, take_intensity(level, report, view, pixels, is_complex, &mean));
    if (status == SONJECT_OK && level->water_columns > 0)
        status = level_beside_water(level, report, scene, view);
    else if (status == SONJECT_OK)
        status = local_mean(report, level->intensity, view->rows, view->columns,
                            scene->seabed.level_radius_m / view->row_spacing_m,
                            scene->seabed.level_radius_m / view->column_spacing_m, level->level);
    if (status == SONJECT_OK) {
        for (size_t i = 0; i < count; i++)
            level->level[i] = fmaxf(level->level[i], (float)(LEVEL_FLOOR * mean));
        for (size_t j = 0; j < view->columns; j++)
            level->cell_energy[j] = (float)seabed_cell_energy(view, response, scene->seabed.lambert,
                                                              view_apparent_range(view, (double)j));
        status = make_map(level, report, scene, view);
    }
    level->noise_ratio = pow(10.0, scene->injection.noise_floor_db / 10.0);
    if (status == SONJECT_OK && scene->injection.estimate_noise)
        status = estimate_noise_floor(report, level->intensity, level->level, view->rows,
                                      view->columns, &level->noise_ratio);
    if (status != SONJECT_OK)
        patch_level_clear(level);
    return status;
}
