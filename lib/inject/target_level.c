#include "inject/target_level.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "inject/patch_level.h"

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
