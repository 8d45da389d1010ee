#include "trace/fouling.h"

#include <math.h>

#include "kernels/fouling.h"
#include "kernels/random.h"

#define PI    3.14159265358979323846
#define WAVES FOULING_WAVES

static const sonject_fouling_params *fouling_of(const struct tracer *tracer, uint32_t object)
{
    return &tracer->scene->objects[object].fouling;
}

bool object_is_fouled(const struct tracer *tracer, uint32_t object)
{
    const sonject_fouling_params *fouling = fouling_of(tracer, object);
    return fouling->albedo_db > 0.0 || fouling->relief_m > 0.0;
}

/* Returns the nepers of energy that one wave adds at its crest. The squares of all waves' gains add
 * up to twice the field's variance. */
static double gain_of(const sonject_fouling_params *fouling)
{
    return sqrt(2.0 / WAVES) * fouling->albedo_db * log(10.0) / 10.0;
}

/* Returns the albedo over its mean where all crests meet. I0(x), the mean of exp(x cos) over a
 * cycle, is a wave's factor in the mean. */
static double peak_of(const sonject_fouling_params *fouling)
{
    const double gain = gain_of(fouling);
    double mean = 1.0;
    double term = 1.0;
    for (int k = 1; term > 1e-16 * mean; k++)
        mean += term *= 0.25 * gain * gain / ((double)k * k);
    return pow(exp(gain) / mean, WAVES);
}

/* Draws a wave of Gaussian spectrum. Its wavenumbers are three normal deviates (G. Box and M.
 * Muller). axes: the object's axes. to_part: the way from its origin to the part's centre, m. */
static void draw_wave(struct fouling_wave *wave, struct random_key key, uint32_t number,
                      double length_m, double axes[3][3], const double to_part[3])
{
    double along[3] = {0.0, 0.0, 0.0}; /* cycles per m, in the axes of the view */
    float u, v;
    for (uint32_t k = 0; k < 3; k++) {
        two_uniforms(key, number, k, &u, &v);
        const double own =
            sqrt(-2.0 * log((double)u)) * cos(2.0 * PI * (double)v) / (2.0 * PI * length_m);
        for (int i = 0; i < 3; i++)
            along[i] += own * axes[k][i];
    }
    two_uniforms(key, number, 3, &u, &v);
    const double turns =
        (double)u + along[0] * to_part[0] + along[1] * to_part[1] + along[2] * to_part[2];
    *wave = (struct fouling_wave){(float)along[0], (float)along[1], (float)along[2],
                                  (float)(turns - floor(turns))};
}

void fouling_record_init(struct fouling_record *record, const struct tracer *tracer,
                         const struct placement *part)
{
    const sonject_fouling_params *fouling = fouling_of(tracer, part->object);
    const uint64_t seed = tracer->scene->injection.seed;
    const struct random_key key =
        random_key_of((uint32_t)seed, (uint32_t)(seed >> 32), STREAM_FOULING + part->object, 0);
    double axes[3][3], to_part[3];
    object_axes(axes, &tracer->scene->objects[part->object], tracer->view.is_mirrored);
    for (int i = 0; i < 3; i++)
        to_part[i] = part->centre[i] - tracer->objects[part->object].origin[i];
    record->albedo_gain = (float)gain_of(fouling);
    record->albedo_peak = (float)peak_of(fouling);
    record->slope_gain = (float)(2.0 * PI * sqrt(2.0 / WAVES) * fouling->relief_m);
    for (uint32_t i = 0; i < WAVES; i++) {
        draw_wave(&record->albedo[i], key, i, fouling->albedo_length_m, axes, to_part);
        draw_wave(&record->relief[i], key, WAVES + i, fouling->relief_length_m, axes, to_part);
    }
}

double fouling_brightest(const struct tracer *tracer, uint32_t part)
{
    const sonject_fouling_params *fouling = fouling_of(tracer, tracer->placements[part].object);
    return peak_of(fouling) * (fouling->relief_m > 0.0 ? (double)FACET_BRIGHTEST : 1.0);
}
