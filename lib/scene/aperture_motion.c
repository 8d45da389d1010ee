#include "scene/aperture_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "kernels/random.h"
#include "scene/response_table.h"

#define PI           3.14159265358979323846
#define RANDOM_WAVES 256        /* the sum of so many waves is as good as Gaussian */
#define RANDOM_SWAY  0x73776179 /* the two streams of random numbers, which no other part uses */
#define RANDOM_YAW   0x79617721

static void motion_table_clear(struct motion_table *table)
{
    free(table->along_track_m);
    free(table->values);
    memset(table, 0, sizeof *table);
}

sonject_status motion_table_set(struct motion_table *table, struct report *report,
                                const double *along_track_m, const double *values, size_t count)
{
    double *positions = allocate_array(count, sizeof *positions);
    double *copies = allocate_array(count, sizeof *copies);
    if (!positions || !copies) {
        free(positions);
        free(copies);
    }
    CHECK_MEMORY(report, positions && copies, "a table of motion");
    memcpy(positions, along_track_m, count * sizeof *positions);
    memcpy(copies, values, count * sizeof *copies);
    motion_table_clear(table);
    table->along_track_m = positions;
    table->values = copies;
    table->count = count;
    return SONJECT_OK;
}

void aperture_motion_clear(struct aperture_motion *motion)
{
    motion_table_clear(&motion->sway_table);
    motion_table_clear(&motion->yaw_table);
}

bool aperture_motion_has_yaw(const struct aperture_motion *motion)
{
    const sonject_motion_params *params = &motion->params;
    return params->yaw_count > 0 || params->yaw_bias_rad != 0.0 ||
           params->yaw_random_rms_rad != 0.0 || motion->yaw_table.count > 0;
}

bool aperture_motion_is_still(const struct aperture_motion *motion)
{
    return motion->params.sway_count == 0 && motion->params.random_rms_m == 0.0 &&
           motion->sway_table.count == 0 && !aperture_motion_has_yaw(motion);
}

double aperture_motion_step(const struct aperture_motion *motion)
{
    const struct motion_table *table = &motion->sway_table;
    double step = HUGE_VAL;
    for (uint32_t i = 0; i < motion->params.sway_count; i++)
        step = fmin(step, motion->params.sways[i].wavelength_m / 200.0);
    if (motion->params.random_rms_m > 0.0)
        step = fmin(step, motion->params.random_correlation_m / 100.0);
    for (size_t i = 0; i + 1 < table->count; i++)
        step = fmin(step, (table->along_track_m[i + 1] - table->along_track_m[i]) / 4.0);
    return fmax(step, SCALE_MIN_M / 200.0);
}

static double value_of_table(const struct motion_table *table, double x)
{
    const double *at = table->along_track_m;
    const size_t last = table->count - 1;
    if (x <= at[0] || x >= at[last])
        return table->values[x <= at[0] ? 0 : last];
    const size_t low = piece_at(at, table->count, x);
    const double share = (x - at[low]) / (at[low + 1] - at[low]);
    return table->values[low] + share * (table->values[low + 1] - table->values[low]);
}

/* Positions along-track, start + i step, and the sums at these. */
struct places {
    double start, step;
    size_t count;
    double *values;
};

static void add_wave(const struct places *places, double amplitude, double wavenumber, double phase)
{
    for (size_t i = 0; i < places->count; i++)
        places->values[i] +=
            amplitude * sin(wavenumber * (places->start + (double)i * places->step) + phase);
}

/* Adds waves of random phases whose wavenumbers are normal deviates. Their spectrum is Gaussian,
 * and so is the autocorrelation. */
static void add_random(const struct places *places, double rms, double correlation, uint64_t seed,
                       uint32_t stream)
{
    const struct random_key key =
        random_key_of((uint32_t)(seed & 0xffffffffu), (uint32_t)(seed >> 32), stream, 0);
    if (!(rms > 0.0))
        return;
    for (uint32_t wave = 0; wave < RANDOM_WAVES; wave++) {
        float u, v, phase, unused;
        two_uniforms(key, wave, 0, &u, &v);
        two_uniforms(key, wave, 1, &phase, &unused);
        const double deviate = sqrt(-2.0 * log(u)) * cos(2.0 * PI * v);
        add_wave(places, rms * sqrt(2.0 / RANDOM_WAVES), deviate / correlation, 2.0 * PI * phase);
    }
}

/* The sway or the yaw: the sum of a table, a bias, sines and random waves. */
struct motion {
    const struct motion_table *table;
    double bias;
    const sonject_wave *waves;
    uint32_t wave_count;
    double random_rms, random_correlation;
    uint64_t seed;
    uint32_t stream;
};

static void add_up(const struct motion *motion, const struct places *places)
{
    for (size_t i = 0; i < places->count; i++) {
        const double x = places->start + (double)i * places->step;
        places->values[i] = motion->table->count > 0 ? value_of_table(motion->table, x) : 0.0;
        places->values[i] += motion->bias;
    }
    for (uint32_t i = 0; i < motion->wave_count; i++)
        add_wave(places, motion->waves[i].amplitude, 2.0 * PI / motion->waves[i].wavelength_m,
                 motion->waves[i].phase_rad);
    add_random(places, motion->random_rms, motion->random_correlation, motion->seed,
               motion->stream);
}

void aperture_motion_sway(const struct aperture_motion *motion, double start_m, double step_m,
                          size_t count, double *sway_m)
{
    const sonject_motion_params *params = &motion->params;
    const struct motion sway = {&motion->sway_table,  0.0,
                                params->sways,        params->sway_count,
                                params->random_rms_m, params->random_correlation_m,
                                params->seed,         RANDOM_SWAY};
    add_up(&sway, &(struct places){start_m, step_m, count, sway_m});
}

void aperture_motion_yaw(const struct aperture_motion *motion, double start_m, double step_m,
                         size_t count, double *yaw_rad)
{
    const sonject_motion_params *params = &motion->params;
    const struct motion yaw = {&motion->yaw_table,
                               params->yaw_bias_rad,
                               params->yaws,
                               params->yaw_count,
                               params->yaw_random_rms_rad,
                               params->yaw_random_correlation_m,
                               params->yaw_seed,
                               RANDOM_YAW};
    add_up(&yaw, &(struct places){start_m, step_m, count, yaw_rad});
}
