#include "inject/compose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"
#include "scene/point_response.h"

#define LEVEL_FLOOR 1e-6   /* share of the mean intensity; blank corners of a swath have no level */
#define SHARE_LEAST 0.05f  /* least share of seabed around a pixel that gives its level */
#define DOUBTFUL    16.0f  /* over the level; one look of even seabed exceeds it once in e^16 */
#define BRIGHTEST   32.0f  /* over the seabed's level: brighter pixels are echoes */
#define ROOT_LEVEL  0.675f /* of one look, the mean fourth root's fourth power over the mean */
#define HOLE_RADII  4.0    /* radii of the level in a hole's least side; shadows are narrower */

double seabed_cell_energy(const struct patch_view *view, const struct point_response *response,
                          double mu, double processor_range_m)
{
    /* Half a cell beyond the first return. Before it there is no seabed, and straight below the
     * sonar cells would cover any area. */
    const double steepest = view_bottom_range(view) + 0.5 * range_energy_width(response);
    const double grazing = view_grazing(view, fmax(processor_range_m, steepest));
    const double sine = sin(grazing);
    const double cosine = fmax(1e-6, cos(grazing));
    const double area = cross_range_energy_width(response, processor_range_m) *
                        range_energy_width(response) / (view->range_ratio * cosine);
    return mu * sine * sine * area * view_energy_scale(view) *
           view_refraction_gain(view, processor_range_m);
}

void fill_cell_energies(const struct patch_view *view, const struct point_response *response,
                        float *energies)
{
    for (size_t j = 0; j < view->columns; j++)
        energies[j] = (float)seabed_cell_energy(view, response, view->seabed_lambert,
                                                view_processor_range(view, (double)j));
}

float *window_intensities(const struct window *at, const struct patch_view *view,
                          const float *pixels, bool is_complex)
{
    float *intensity = allocate_array(at->rows, at->columns * sizeof *intensity);
    for (size_t i = 0; intensity && i < at->rows * at->columns; i++) {
        const size_t pixel =
            (at->first_row + i / at->columns) * view->columns + at->first_column + i % at->columns;
        const double a = is_complex ? pixels[2 * pixel] : pixels[pixel];
        const double b = is_complex ? pixels[2 * pixel + 1] : 0.0;
        intensity[i] = (float)(a * a + b * b);
    }
    return intensity;
}

/* A region of the patch whose level is sought. Its first columns may be in the water column, and
 * those that the patch's image leaves blank at its sides, and its holes, are no seabed either. */
struct level_region {
    const struct scene *scene;
    const struct patch_view *view; /* the patch's */
    struct window at;
    size_t water_columns;
    const struct patch_facts *facts; /* the patch's */
    const uint8_t *holes;            /* 1 in holes; NULL: none */
};

static bool is_blank(const struct level_region *region, size_t i)
{
    const size_t column = region->at.first_column + i % region->at.columns;
    return column < region->facts->first_heard || column >= region->facts->end_heard ||
           (region->holes && region->holes[i]);
}

static bool is_water(const struct level_region *region, size_t i)
{
    return i % region->at.columns < region->water_columns;
}

static sonject_status smooth(struct report *report, const struct level_region *region,
                             const float *values, double radius_m, float *mean)
{
    return local_mean(report, values, region->at.rows, region->at.columns,
                      radius_m / region->view->row_spacing_m,
                      radius_m / region->view->column_spacing_m, mean);
}

/* Finds local means of some values of the pixels that have the weight 1, not 0. Values and weights
 * become these means and the shares of such pixels. */
static sonject_status smooth_weighted(struct report *report, const struct level_region *region,
                                      float *values, float *weights)
{
    const size_t count = region->at.rows * region->at.columns;
    const double radius = region->scene->seabed.level_radius_m;
    for (size_t i = 0; i < count; i++)
        values[i] *= weights[i];
    CHECK(smooth(report, region, values, radius, values));
    CHECK(smooth(report, region, weights, radius, weights));
    for (size_t i = 0; i < count; i++)
        values[i] = weights[i] > SHARE_LEAST ? values[i] / weights[i] : 0.0f;
    return SONJECT_OK;
}

/* Finds the local mean of the seabed alone. In the water column it is that of the seabed nearby.
 * Blank pixels have none. */
static sonject_status level_of_seabed(struct report *report, const struct level_region *region,
                                      const float *intensity, float *level)
{
    const size_t columns = region->at.columns;
    const size_t count = region->at.rows * columns;
    float *weights = allocate_array(count, sizeof *weights);
    CHECK_MEMORY(report, weights, "the patch");
    for (size_t i = 0; i < count; i++) {
        weights[i] = is_water(region, i) || is_blank(region, i) ? 0.0f : 1.0f;
        level[i] = intensity[i];
    }
    const sonject_status status = smooth_weighted(report, region, level, weights);
    for (size_t i = count; status == SONJECT_OK && i-- > 0;) {
        const bool has_neighbour = (i + 1) % columns != 0;
        if (!(weights[i] > SHARE_LEAST) && has_neighbour)
            level[i] = level[i + 1];
    }
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        if (is_blank(region, i) && !is_water(region, i))
            level[i] = 0.0f;
    free(weights);
    return status;
}

/* Returns whether any pixel may be an echo of an object. */
static bool may_have_echoes(const struct level_region *region, const float *intensity,
                            const float *level)
{
    const size_t count = region->at.rows * region->at.columns;
    size_t i = 0;
    while (i < count && !(intensity[i] > DOUBTFUL * level[i]))
        i++;
    return i < count;
}

/* Finds the level anew without echoes of what the image shows already. The mean of fourth roots,
 * in which echoes hardly count, tells what is one; zeros say nothing in coarse grey levels. Where
 * echoes fill all, the level stays. */
static sonject_status leave_out_echoes(struct report *report, const struct level_region *region,
                                       const float *intensity, float *level)
{
    const size_t count = region->at.rows * region->at.columns;
    float *values = allocate_array(2 * count, sizeof *values);
    CHECK_MEMORY(report, values, "the patch");
    float *weights = values + count;
    size_t echoes = 0;
    for (size_t i = 0; i < count; i++) {
        values[i] = sqrtf(sqrtf(intensity[i]));
        weights[i] = is_water(region, i) || intensity[i] == 0.0f ? 0.0f : 1.0f;
    }
    sonject_status status = smooth_weighted(report, region, values, weights);
    for (size_t i = 0; status == SONJECT_OK && i < count; i++) {
        const float square = values[i] * values[i];
        const bool is_seabed = !is_water(region, i) && !is_blank(region, i);
        const bool is_echo =
            square > 0.0f && intensity[i] > BRIGHTEST / ROOT_LEVEL * square * square;
        values[i] = intensity[i];
        weights[i] = !is_seabed || is_echo ? 0.0f : 1.0f;
        echoes += is_seabed && is_echo;
    }
    if (echoes > 0)
        THEN(status, smooth_weighted(report, region, values, weights));
    for (size_t i = 0; echoes > 0 && status == SONJECT_OK && i < count; i++)
        if (weights[i] > SHARE_LEAST && (is_water(region, i) || !is_blank(region, i)))
            level[i] = values[i];
    free(values);
    return status;
}

/* Finds the seabed's level. In mode resynthesise echoes count, since the new seabed must have their
 * energy. */
static sonject_status find_level(struct report *report, const struct level_region *region,
                                 const float *intensity, float *level)
{
    const size_t count = region->at.rows * region->at.columns;
    const bool has_blanks =
        region->holes || (count > 0 && (is_blank(region, 0) || is_blank(region, count - 1)));
    CHECK(region->water_columns > 0 || has_blanks
              ? level_of_seabed(report, region, intensity, level)
              : smooth(report, region, intensity, region->scene->seabed.level_radius_m, level));
    if (region->scene->injection.mode == SONJECT_MODE_COMPOSITE &&
        may_have_echoes(region, intensity, level))
        CHECK(leave_out_echoes(report, region, intensity, level));
    for (size_t i = 0; i < count; i++)
        level[i] = fmaxf(level[i], (float)(LEVEL_FLOOR * region->facts->mean_intensity));
    return SONJECT_OK;
}

/* Finds the map: the intensity, or its local mean, over the level. */
static sonject_status find_map(struct report *report, const struct level_region *region,
                               const float *intensity, const float *level, float *map)
{
    const size_t count = region->at.rows * region->at.columns;
    const sonject_seabed_params *seabed = &region->scene->seabed;
    if (seabed->map == SONJECT_MAP_DESPECKLED)
        CHECK(smooth(report, region, intensity, seabed->despeckle_radius_m, map));
    else
        memcpy(map, seabed->map == SONJECT_MAP_COHERENT ? level : intensity, count * sizeof *map);
    for (size_t i = 0; i < count; i++)
        map[i] /= level[i];
    return SONJECT_OK;
}

/* Returns the region that tells the level in the window, with seabed behind the water column. */
static struct level_region region_about(const struct scene *scene, const struct patch_view *view,
                                        const struct window *window,
                                        const struct patch_facts *facts)
{
    const sonject_seabed_params *seabed = &scene->seabed;
    const double radius = seabed->map == SONJECT_MAP_DESPECKLED
                              ? fmax(seabed->level_radius_m, seabed->despeckle_radius_m)
                              : seabed->level_radius_m;
    const size_t reach = local_mean_reach(radius / view->column_spacing_m);
    const size_t water = view_water_columns(view);
    struct level_region region = {.scene = scene, .view = view, .facts = facts};
    region.at.rows = widened_span(window->first_row, window->rows,
                                  local_mean_reach(radius / view->row_spacing_m), view->rows,
                                  &region.at.first_row);
    region.at.columns = widened_span(window->first_column, window->columns, reach, view->columns,
                                     &region.at.first_column);
    if (water > region.at.first_column) {
        const size_t end = water + reach < view->columns ? water + reach : view->columns;
        region.water_columns = water - region.at.first_column;
        if (region.at.columns < end - region.at.first_column)
            region.at.columns = end - region.at.first_column;
    }
    return region;
}

double noise_over_level(const struct patch_level *level, size_t i)
{
    return level->noise_over > 0.0
               ? level->noise_ratio * level->noise_over / (double)level->level[i]
               : level->noise_ratio;
}

void patch_level_clear(struct patch_level *level)
{
    free(level->intensity);
    memset(level, 0, sizeof *level);
}

/* Copies a part of a plane. The plane's pixels lie at `from`. */
static void cut(const struct window *from, const float *plane, const struct window *part,
                float *out)
{
    for (size_t row = 0; row < part->rows; row++)
        memcpy(out + row * part->columns,
               plane + (part->first_row - from->first_row + row) * from->columns +
                   part->first_column - from->first_column,
               part->columns * sizeof *out);
}

sonject_status patch_level_init(struct patch_level *level, const struct tracer *tracer,
                                const struct patch_view *view, const struct patch_facts *facts,
                                const float *pixels, bool is_complex)
{
    const struct window window = {tracer->view.first_row, tracer->view.rows,
                                  tracer->view.first_column, tracer->view.columns};
    struct level_region region = region_about(tracer->scene, view, &window, facts);
    struct report *report = tracer->report;
    const size_t wide = region.at.rows * region.at.columns;
    const size_t count = window.rows * window.columns;
    memset(level, 0, sizeof *level);
    float *intensity = window_intensities(&region.at, view, pixels, is_complex);
    float *planes = allocate_array(wide, 2 * sizeof *planes);
    uint8_t *holes = NULL;
    level->intensity = allocate_array(3 * count + window.columns, sizeof(float));
    sonject_status status = intensity && planes && level->intensity
                                ? SONJECT_OK
                                : report_out_of_memory(report, "the patch");
    THEN(status,
         find_holes(report, view, &region.at, HOLE_RADII * tracer->scene->seabed.level_radius_m,
                    pixels, is_complex, &holes));
    region.holes = holes;
    THEN(status, find_level(report, &region, intensity, planes));
    THEN(status, find_map(report, &region, intensity, planes, planes + wide));
    if (status == SONJECT_OK) {
        level->water_columns = view_water_columns(&tracer->view);
        const double over_db = tracer->scene->injection.noise_floor_over_db;
        level->noise_ratio = facts->noise_ratio;
        level->noise_over = isnan(over_db) ? 0.0 : pow(10.0, over_db / 10.0);
        level->level = level->intensity + count;
        level->map = level->level + count;
        level->cell_energy = level->map + count;
        cut(&region.at, intensity, &window, level->intensity);
        cut(&region.at, planes, &window, level->level);
        cut(&region.at, planes + wide, &window, level->map);
        fill_cell_energies(&tracer->view, &tracer->response, level->cell_energy);
    } else {
        patch_level_clear(level);
    }
    free(intensity);
    free(planes);
    free(holes);
    return status;
}

void patch_request_clear(struct patch_request *patch)
{
    free(patch->reflectivity);
    patch_level_clear(&patch->level);
}

sonject_status patch_request_init(struct patch_request *patch, struct tracer *tracer,
                                  const struct patch_view *view, const struct patch_facts *facts,
                                  const float *pixels, bool is_complex,
                                  sonject_progress_function progress, void *user)
{
    const struct scene *scene = tracer->scene;
    const size_t count = tracer->view.rows * tracer->view.columns;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    const bool is_coherent = resynthesises && scene->seabed.map == SONJECT_MAP_COHERENT;
    memset(patch, 0, sizeof *patch);
    CHECK(patch_level_init(&patch->level, tracer, view, facts, pixels, is_complex));
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
    /* The pixels over the root of the level have unit mean square. */
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

/* Returns an object's gain in energy; 1 if nothing is heard. */
static double gain_of(const sonject_object_params *object, double energy, double over_seabed)
{
    const double asked = pow(10.0, object->level_db / 10.0);
    if (object->level_kind == SONJECT_LEVEL_TARGET_STRENGTH && energy > 0.0)
        return asked / energy;
    if (object->level_kind == SONJECT_LEVEL_OVER_SEABED && over_seabed > 0.0)
        return asked / over_seabed;
    return 1.0;
}

/* The scaling of an object's echoes. */
struct scaled_object {
    double gain;
    double row, range_m; /* its place in the image; range_m: of its centre */
    double size_m;       /* 0: the object is not traced */
};

/* Returns the gain of echoes by way of the seabed, or of several objects: the mean of the objects'
 * gains. An object weighs by the square of its area over that of the distance from the seabed that
 * is heard in the pixel, so the nearest decides. Nothing is heard before the object itself. */
static double gain_about(const struct scaled_object *objects, uint32_t count,
                         const struct patch_view *view, size_t row, size_t column)
{
    const double range = view_processor_range(view, (double)column);
    double sum = 0.0, scaled = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const struct scaled_object *object = &objects[i];
        const double aside = 2.0 * ((double)row - object->row) * view->row_spacing_m;
        const double detour = range - object->range_m;
        const double area = 0.25 * object->size_m * object->size_m;
        const double share = area / (aside * aside + detour * detour + area);
        const bool is_before = detour < -object->size_m - view->column_spacing_m;
        const double weight = is_before ? 1e-6 * share * share : share * share;
        sum += weight;
        scaled += weight * object->gain;
    }
    return sum > 0.0 ? scaled / sum : 1.0;
}

#define NO_INDIRECT 1e-5 /* share of a pixel's echoes that rounding may leave over */

/* Scales a pixel's echoes: those of first hits by their objects' gains, the others by those about.
 */
static void scale_pixel(struct echoes *echoes, const struct patch_view *view,
                        const struct scaled_object *objects, size_t i)
{
    double energy = 0.0; /* first hits alone; `scaled`: with the gains */
    double scaled = 0.0;
    const size_t row = i / echoes->columns;
    const size_t column = i % echoes->columns;
    for (uint32_t number = 0; number < echoes->object_count; number++) {
        const struct object_echo *echo = &echoes->objects[number];
        if (!echo->energy || column < echo->first_column ||
            column >= echo->first_column + echo->columns)
            continue;
        const size_t at = row * echo->columns + column - echo->first_column;
        energy += (double)echo->energy[at];
        scaled += objects[number].gain * (double)echo->energy[at];
    }
    const double before = (double)echoes->target_energy[i];
    const bool is_direct = before - energy <= NO_INDIRECT * before;
    const double about =
        is_direct ? 1.0 : gain_about(objects, echoes->object_count, view, row, column);
    const double gain = !is_direct     ? (scaled + about * (before - energy)) / before
                        : energy > 0.0 ? scaled / energy
                                       : 1.0;
    const float amplitude = (float)sqrt(gain);
    echoes->energy[i] += (float)((gain - 1.0) * before);
    echoes->target_energy[i] *= (float)gain;
    echoes->target_real[i] *= amplitude;
    echoes->target_imaginary[i] *= amplitude;
    if (echoes->coherent_real) {
        echoes->coherent_real[i] *= amplitude;
        echoes->coherent_imaginary[i] *= amplitude;
    }
    for (uint32_t order = 0; order < echoes->orders; order++) {
        float *kept = &echoes->order_energy[order][i];
        *kept = order == 0 ? *kept + (float)(scaled - energy) : *kept * (float)about;
    }
}

/* Sets an object's place and gain, and its level in the truth. */
static void set_level(const struct tracer *tracer, const struct object_echo *echo, uint32_t number,
                      struct scaled_object *scaled, sonject_object_truth *truth)
{
    const sonject_object_params *object = &tracer->scene->objects[number];
    const struct placed_object *placed = &tracer->objects[number];
    const double lambert = tracer->view.seabed_lambert;
    scaled->row = view_row_of_x(&tracer->view, placed->origin[0]);
    scaled->range_m = ray_path_range(&tracer->view.water, placed->origin[1], placed->origin[2]) *
                      tracer->view.range_ratio;
    scaled->size_m = placed->size_m;
    /* Compare with the seabed that the echo's peak lies on. */
    const double range = echo->peak_energy > 0.0 ? echo->peak_range_m : scaled->range_m;
    const double over_seabed =
        echo->peak_energy > 0.0
            ? echo->peak_energy /
                  seabed_cell_energy(&tracer->view, &tracer->response, lambert, range)
            : 0.0;
    const double sine = sin(view_grazing(&tracer->view, range));
    scaled->gain = gain_of(object, echo->peak_energy, over_seabed);
    truth->level_kind = object->level_kind;
    truth->level_gain_db = decibels(scaled->gain);
    truth->over_seabed_db = decibels(scaled->gain * over_seabed);
    truth->seabed_strength_db = decibels(lambert * sine * sine);
}

static void scale_echoes(const struct tracer *tracer, struct echoes *echoes,
                         const struct scaled_object *objects)
{
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++)
        scale_pixel(echoes, &tracer->view, objects, i);
    for (uint32_t i = 0; i < echoes->object_count; i++) {
        struct object_echo *echo = &echoes->objects[i];
        echo->peak_energy *= objects[i].gain;
        for (size_t k = 0; echo->energy && k < echoes->rows * echo->columns; k++)
            echo->energy[k] *= (float)objects[i].gain;
    }
}

sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injected_window *result)
{
    struct scaled_object *objects = allocate_array(echoes->object_count, sizeof *objects);
    bool is_scaled = false;
    CHECK_MEMORY(tracer->report, objects, "the objects' levels");
    for (uint32_t i = 0; i < echoes->object_count; i++) {
        objects[i].gain = 1.0;
        if (!tracer_follows(tracer, i))
            continue;
        set_level(tracer, &echoes->objects[i], i, &objects[i], &result->objects[i]);
        is_scaled |= tracer->scene->objects[i].level_kind != SONJECT_LEVEL_PHYSICAL;
    }
    if (is_scaled)
        scale_echoes(tracer, echoes, objects);
    free(objects);
    return SONJECT_OK;
}
