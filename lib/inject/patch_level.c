#include "inject/patch_level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"
#include "scene/point_response.h"

#define LEVEL_FLOOR                                                                                \
    1e-6 /* of the patch's mean intensity: blank corners of a swath have no level                  \
          */

double seabed_cell_energy(const struct patch_view *view, const struct point_response *response,
                          double mu, double processor_range_m)
{
    /* half a cell beyond the first return: before it there is no seabed, and straight below its
     * cells would cover any area */
    const double steepest = view_bottom_range(view) + 0.5 * range_energy_width(response);
    const double grazing = view_grazing(view, fmax(processor_range_m, steepest));
    const double sine = sin(grazing);
    const double cosine = fmax(1e-6, cos(grazing));
    const double area = cross_range_energy_width(response, processor_range_m) *
                        range_energy_width(response) / (view->range_ratio * cosine);
    return mu * sine * sine * area * view_energy_scale(view) *
           view_refraction_gain(view, processor_range_m);
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

static sonject_status set_intensity(struct patch_level *level, struct report *report,
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
    THEN(status, set_intensity(level, report, view, pixels, is_complex, &mean));
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
            level->cell_energy[j] = (float)seabed_cell_energy(
                view, response, scene->seabed.lambert, view_processor_range(view, (double)j));
        status = make_map(level, report, scene, view);
    }
    level->noise_ratio = pow(10.0, scene->injection.noise_floor_db / 10.0);
    if (status == SONJECT_OK && scene->injection.estimate_noise)
        level->noise_ratio =
            estimate_noise_floor(level->intensity, level->level, view->rows, view->columns);
    if (status != SONJECT_OK)
        patch_level_clear(level);
    return status;
}

/* Over the seabed that the peak of an object's echo lies on. */
static double peak_over_seabed(const struct tracer *tracer, const struct object_echo *echo)
{
    return echo->peak_energy > 0.0
               ? echo->peak_energy / seabed_cell_energy(&tracer->view, &tracer->response,
                                                        tracer->scene->seabed.lambert,
                                                        echo->peak_range_m)
               : 0.0;
}

/* In energy; 1 where nothing is heard. */
static double gain_of(const sonject_object_params *object, double energy, double over_seabed)
{
    const double asked = pow(10.0, object->level_db / 10.0);
    if (object->level_kind == SONJECT_LEVEL_TARGET_STRENGTH && energy > 0.0)
        return asked / energy;
    if (object->level_kind == SONJECT_LEVEL_OVER_SEABED && over_seabed > 0.0)
        return asked / over_seabed;
    return 1.0;
}

static double decibels(double ratio)
{
    return ratio > 0.0 ? 10.0 * log10(ratio) : -INFINITY;
}

/* Sums over the objects at a pixel. */
struct pixel_gain {
    double energy, scaled; /* of first hits alone, and the same with the gains */
    double hidden, scaled_hidden;
};

static struct pixel_gain gains_at(const struct echoes *echoes, const double *gains, size_t i)
{
    struct pixel_gain sums = {0.0, 0.0, 0.0, 0.0};
    const size_t row = i / echoes->columns;
    const size_t column = i % echoes->columns;
    for (uint32_t number = 0; number < echoes->object_count; number++) {
        const struct object_echo *echo = &echoes->objects[number];
        if (!echo->energy || column < echo->first_column ||
            column >= echo->first_column + echo->columns)
            continue;
        const size_t at = row * echo->columns + column - echo->first_column;
        sums.energy += (double)echo->energy[at];
        sums.scaled += gains[number] * (double)echo->energy[at];
        sums.hidden += (double)echo->lost[at];
        sums.scaled_hidden += gains[number] * (double)echo->lost[at];
    }
    return sums;
}

/* What came by the seabed has the gain of the object that is heard there, or whose shadow it fills,
 * or where there is neither the objects' mean. */
static double pixel_gain(const struct pixel_gain *sums, double mean)
{
    if (sums->energy > 0.0)
        return sums->scaled / sums->energy;
    return sums->hidden > 0.0 ? sums->scaled_hidden / sums->hidden : mean;
}

static void scale_pixel(struct echoes *echoes, const double *gains, double mean, size_t i)
{
    const struct pixel_gain sums = gains_at(echoes, gains, i);
    const double gain = pixel_gain(&sums, mean);
    const float amplitude = (float)sqrt(gain);
    echoes->energy[i] += (float)((gain - 1.0) * (double)echoes->target_energy[i]);
    echoes->target_energy[i] *= (float)gain;
    echoes->target_real[i] *= amplitude;
    echoes->target_imaginary[i] *= amplitude;
    if (echoes->coherent_real) {
        echoes->coherent_real[i] *= amplitude;
        echoes->coherent_imaginary[i] *= amplitude;
    }
    for (uint32_t order = 0; order < echoes->orders; order++) {
        float *kept = &echoes->order_energy[order][i];
        *kept = order == 0 ? *kept + (float)(sums.scaled - sums.energy) : *kept * (float)gain;
    }
}

static void scale_objects(struct echoes *echoes, const double *gains)
{
    for (uint32_t number = 0; number < echoes->object_count; number++) {
        struct object_echo *echo = &echoes->objects[number];
        echo->peak_energy *= gains[number];
        for (size_t i = 0; echo->energy && i < echoes->rows * echo->columns; i++)
            echo->energy[i] *= (float)gains[number];
    }
}

sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injection_result *result)
{
    const struct scene *scene = tracer->scene;
    double *gains = allocate_array(echoes->object_count, sizeof *gains);
    double mean = 0.0;
    bool is_scaled = false;
    CHECK_MEMORY(tracer->report, gains, "the objects' levels");
    for (uint32_t i = 0; i < echoes->object_count; i++) {
        const struct object_echo *echo = &echoes->objects[i];
        const double over_seabed = peak_over_seabed(tracer, echo);
        const double grazing = water_way_grazing(&tracer->view.water, tracer->objects[i].origin[1],
                                                 tracer->objects[i].origin[2]);
        sonject_object_truth *truth = &result->objects[i];
        gains[i] = gain_of(&scene->objects[i], echo->peak_energy, over_seabed);
        mean += gains[i] / echoes->object_count;
        is_scaled = is_scaled || scene->objects[i].level_kind != SONJECT_LEVEL_PHYSICAL;
        truth->level_kind = scene->objects[i].level_kind;
        truth->level_gain_db = decibels(gains[i]);
        truth->over_seabed_db = decibels(gains[i] * over_seabed);
        truth->seabed_strength_db = decibels(scene->seabed.lambert * sin(grazing) * sin(grazing));
    }
    for (size_t i = 0; is_scaled && i < echoes->rows * echoes->columns; i++)
        scale_pixel(echoes, gains, mean, i);
    if (is_scaled)
        scale_objects(echoes, gains);
    free(gains);
    return SONJECT_OK;
}
