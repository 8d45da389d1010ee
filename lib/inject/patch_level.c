#include "inject/compose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/point_response.h"

#define LEVEL_FLOOR 1e-6  /* of the mean intensity: blank corners of a swath have no level */
#define WATER_SHARE 0.05f /* of seabed around a pixel that tells its level */

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
    memset(level, 0, sizeof *level);
}

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
                view->is_mirrored ? view->rows - 1 - row : row,
                (size_t)view_patch_column(view, (double)(i % view->columns)),
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

static sonject_status smooth(struct report *report, const struct patch_view *view,
                             const float *values, double radius_m, float *mean)
{
    return local_mean(report, values, view->rows, view->columns, radius_m / view->row_spacing_m,
                      radius_m / view->column_spacing_m, mean);
}

/* The local mean of the seabed alone; in the water column that of the seabed nearby. */
static sonject_status level_beside_water(struct patch_level *level, struct report *report,
                                         const struct scene *scene, const struct patch_view *view)
{
    const size_t count = view->rows * view->columns;
    const double radius = scene->seabed.level_radius_m;
    float *seabed = allocate_array(2 * count, sizeof *seabed);
    float *share = seabed + count;
    CHECK_MEMORY(report, seabed, "the patch");
    for (size_t i = 0; i < count; i++)
        seabed[i] = i % view->columns < level->water_columns ? 0.0f : 1.0f;
    sonject_status status = smooth(report, view, seabed, radius, share);
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        seabed[i] *= level->intensity[i];
    THEN(status, smooth(report, view, seabed, radius, level->level));
    for (size_t i = count; status == SONJECT_OK && i-- > 0;) {
        const bool has_neighbour = (i + 1) % view->columns != 0;
        level->level[i] = share[i] > WATER_SHARE ? level->level[i] / share[i]
                          : has_neighbour        ? level->level[i + 1]
                                                 : 0.0f;
    }
    free(seabed);
    return status;
}

/* Level and map of an intensity of a mean: the map is the intensity, or its local mean, over the
 * level. */
static sonject_status find_level(struct patch_level *level, struct report *report,
                                 const struct scene *scene, const struct patch_view *view,
                                 double mean)
{
    const size_t count = view->rows * view->columns;
    const sonject_seabed_params *seabed = &scene->seabed;
    CHECK(level->water_columns > 0
              ? level_beside_water(level, report, scene, view)
              : smooth(report, view, level->intensity, seabed->level_radius_m, level->level));
    for (size_t i = 0; i < count; i++)
        level->level[i] = fmaxf(level->level[i], (float)(LEVEL_FLOOR * mean));
    if (seabed->map == SONJECT_MAP_DESPECKLED)
        CHECK(smooth(report, view, level->intensity, seabed->despeckle_radius_m, level->map));
    else
        memcpy(level->map, seabed->map == SONJECT_MAP_COHERENT ? level->level : level->intensity,
               count * sizeof *level->map);
    for (size_t i = 0; i < count; i++)
        level->map[i] /= level->level[i];
    return SONJECT_OK;
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
    level->intensity = allocate_array(3 * count + view->columns, sizeof(float));
    CHECK_MEMORY(report, level->intensity, "the patch");
    level->level = level->intensity + count;
    level->map = level->level + count;
    level->cell_energy = level->map + count;
    sonject_status status = set_intensity(level, report, view, pixels, is_complex, &mean);
    THEN(status, find_level(level, report, scene, view, mean));
    if (status != SONJECT_OK) {
        patch_level_clear(level);
        return status;
    }
    const double lambert = view_seabed_lambert(view, scene);
    for (size_t j = 0; j < view->columns; j++)
        level->cell_energy[j] = (float)seabed_cell_energy(view, response, lambert,
                                                          view_processor_range(view, (double)j));
    level->noise_ratio = scene->injection.estimate_noise
                             ? estimate_noise_floor(level->intensity, level->level, view->rows,
                                                    view->columns, &level->measures_noise)
                             : pow(10.0, scene->injection.noise_floor_db / 10.0);
    return SONJECT_OK;
}

void patch_request_clear(struct patch_request *patch)
{
    free(patch->reflectivity);
    patch_level_clear(&patch->level);
}

sonject_status patch_request_init(struct patch_request *patch, struct tracer *tracer,
                                  const float *pixels, bool is_complex,
                                  sonject_progress_function progress, void *user)
{
    const struct scene *scene = tracer->scene;
    const size_t count = tracer->view.rows * tracer->view.columns;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    const bool is_coherent = resynthesises && scene->seabed.map == SONJECT_MAP_COHERENT;
    memset(patch, 0, sizeof *patch);
    CHECK(patch_level_init(&patch->level, tracer->report, scene, &tracer->view, &tracer->response,
                           pixels, is_complex));
    patch->request.map = patch->level.map;
    patch->request.field = is_coherent     ? SEABED_FIELD_COHERENT
                           : resynthesises ? SEABED_FIELD_SPECKLE
                                           : SEABED_FIELD_NONE;
    patch->request.progress = progress;
    patch->request.user = user;
    if (!is_coherent)
        return SONJECT_OK;
    patch->reflectivity = allocate_array(2 * count, sizeof *patch->reflectivity);
    if (!patch->reflectivity) {
        patch_request_clear(patch);
        return report_out_of_memory(tracer->report, "the reflectivity");
    }
    /* of unit mean square: the pixels over the root of the level */
    for (size_t i = 0; i < 2 * count; i++)
        patch->reflectivity[i % 2 * count + i / 2] = pixels[i] / sqrtf(patch->level.level[i / 2]);
    patch->request.reflectivity_real = patch->reflectivity;
    patch->request.reflectivity_imaginary = patch->reflectivity + count;
    return SONJECT_OK;
}

double decibels(double ratio)
{
    return ratio > 0.0 ? 10.0 * log10(ratio) : -INFINITY;
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

/* In energy, of a pixel. What came by the seabed has the gain of the object that is heard there, or
 * whose shadow it fills, or where there is neither the objects' mean. */
static void scale_pixel(struct echoes *echoes, const double *gains, double mean, size_t i)
{
    double energy = 0.0; /* of first hits alone, and the same with the gains */
    double scaled = 0.0;
    double hidden = 0.0;
    double scaled_hidden = 0.0;
    const size_t row = i / echoes->columns;
    const size_t column = i % echoes->columns;
    for (uint32_t number = 0; number < echoes->object_count; number++) {
        const struct object_echo *echo = &echoes->objects[number];
        if (!echo->energy || column < echo->first_column ||
            column >= echo->first_column + echo->columns)
            continue;
        const size_t at = row * echo->columns + column - echo->first_column;
        energy += (double)echo->energy[at];
        scaled += gains[number] * (double)echo->energy[at];
        hidden += (double)echo->lost[at];
        scaled_hidden += gains[number] * (double)echo->lost[at];
    }
    const double gain = energy > 0.0   ? scaled / energy
                        : hidden > 0.0 ? scaled_hidden / hidden
                                       : mean;
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
        *kept = order == 0 ? *kept + (float)(scaled - energy) : *kept * (float)gain;
    }
}

sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injection_result *result)
{
    const struct scene *scene = tracer->scene;
    double *gains = allocate_array(echoes->object_count, sizeof *gains);
    double mean = 0.0;
    bool is_scaled = false;
    const double lambert = view_seabed_lambert(&tracer->view, scene);
    CHECK_MEMORY(tracer->report, gains, "the objects' levels");
    for (uint32_t i = 0; i < echoes->object_count; i++) {
        const struct object_echo *echo = &echoes->objects[i];
        /* over the seabed that the peak of the echo lies on */
        const double over_seabed =
            echo->peak_energy > 0.0
                ? echo->peak_energy / seabed_cell_energy(&tracer->view, &tracer->response, lambert,
                                                         echo->peak_range_m)
                : 0.0;
        const double grazing = ray_path_grazing(&tracer->view.water, tracer->objects[i].origin[1],
                                                tracer->objects[i].origin[2]);
        sonject_object_truth *truth = &result->objects[i];
        gains[i] = gain_of(&scene->objects[i], echo->peak_energy, over_seabed);
        mean += gains[i] / echoes->object_count;
        is_scaled = is_scaled || scene->objects[i].level_kind != SONJECT_LEVEL_PHYSICAL;
        truth->level_kind = scene->objects[i].level_kind;
        truth->level_gain_db = decibels(gains[i]);
        truth->over_seabed_db = decibels(gains[i] * over_seabed);
        truth->seabed_strength_db = decibels(lambert * sin(grazing) * sin(grazing));
    }
    for (size_t i = 0; is_scaled && i < echoes->rows * echoes->columns; i++)
        scale_pixel(echoes, gains, mean, i);
    for (uint32_t i = 0; is_scaled && i < echoes->object_count; i++) {
        struct object_echo *echo = &echoes->objects[i];
        echo->peak_energy *= gains[i];
        for (size_t k = 0; echo->energy && k < echoes->rows * echo->columns; k++)
            echo->energy[k] *= (float)gains[i];
    }
    free(gains);
    return SONJECT_OK;
}
