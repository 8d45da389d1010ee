#include "scene/aperture_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/ranges.h"
#include "kernels/random.h"
#include "scene/scene.h"

#define PI           3.14159265358979323846
#define SWAY_MAX_M   1e3
#define SCALE_MIN_M  0.1        /* sway from one centimetre to the next is no motion of a sonar */
#define RANDOM_WAVES 256        /* whose sum is as good as Gaussian */
#define RANDOM_WAVE  0x73776179 /* stream of random numbers that no other part uses */

void sonject_motion_params_init(sonject_motion_params *motion)
{
    memset(motion, 0, sizeof *motion);
    motion->struct_size = sizeof *motion;
    motion->random_correlation_m = 1.0;
    for (int i = 0; i < SONJECT_SWAYS_CAPACITY; i++)
        motion->sways[i].wavelength_m = 1.0;
}

sonject_status check_motion(const sonject_motion_params *motion, struct report *report,
                            const char **key)
{
    struct check check = {report, key, SONJECT_OK};
    check_within(&check, "sway", motion->sway_count, 0.0, SONJECT_SWAYS_CAPACITY, " entries");
    for (uint32_t i = 0; i < motion->sway_count && i < SONJECT_SWAYS_CAPACITY; i++) {
        check_within(&check, "amplitude", motion->sways[i].amplitude_m, -SWAY_MAX_M, SWAY_MAX_M,
                     " m");
        check_within(&check, "wavelength", motion->sways[i].wavelength_m, SCALE_MIN_M, 1e6, " m");
        check_within(&check, "phase", motion->sways[i].phase_rad, -1e3, 1e3, " rad");
    }
    check_within(&check, "random.rms", motion->random_rms_m, 0.0, SWAY_MAX_M, " m");
    check_within(&check, "random.correlation", motion->random_correlation_m, SCALE_MIN_M, 1e6,
                 " m");
    return check.status;
}

bool motion_samples_are_good(const double *along_track_m, const double *sway_m, size_t count,
                             size_t *sample, const char **what)
{
    *sample = count;
    *what = "must have 2...65536 samples";
    if (count < 2 || count > MOTION_SAMPLES_MAX)
        return false;
    for (*sample = 0; *sample < count; ++*sample) {
        const size_t i = *sample;
        *what = "its position must be within +-1000 km";
        if (!(fabs(along_track_m[i]) <= 1e6))
            return false;
        *what = "its position must be above that of the sample before";
        if (i > 0 && !(along_track_m[i] > along_track_m[i - 1]))
            return false;
        *what = "its sway must be within +-1000 m";
        if (!(fabs(sway_m[i]) <= SWAY_MAX_M))
            return false;
    }
    return true;
}

sonject_status aperture_motion_set_table(struct aperture_motion *motion, struct report *report,
                                         const double *along_track_m, const double *sway_m,
                                         size_t count)
{
    double *positions = allocate_array(count, sizeof *positions);
    double *sways = allocate_array(count, sizeof *sways);
    if (!positions || !sways) {
        free(positions);
        free(sways);
        return report_out_of_memory(report, "a table of motion");
    }
    for (size_t i = 0; i < count; i++) {
        positions[i] = along_track_m[i];
        sways[i] = sway_m[i];
    }
    aperture_motion_clear(motion);
    motion->along_track_m = positions;
    motion->sway_m = sways;
    motion->count = count;
    return SONJECT_OK;
}

void aperture_motion_clear(struct aperture_motion *motion)
{
    free(motion->along_track_m);
    free(motion->sway_m);
    motion->along_track_m = NULL;
    motion->sway_m = NULL;
    motion->count = 0;
}

bool aperture_motion_is_still(const struct aperture_motion *motion)
{
    return motion->params.sway_count == 0 && motion->params.random_rms_m == 0.0 &&
           motion->count == 0;
}

double aperture_motion_step(const struct aperture_motion *motion)
{
    double step = HUGE_VAL;
    for (uint32_t i = 0; i < motion->params.sway_count; i++)
        step = fmin(step, motion->params.sways[i].wavelength_m / 200.0);
    if (motion->params.random_rms_m > 0.0)
        step = fmin(step, motion->params.random_correlation_m / 100.0);
    for (size_t i = 0; i + 1 < motion->count; i++)
        step = fmin(step, (motion->along_track_m[i + 1] - motion->along_track_m[i]) / 4.0);
    return fmax(step, SCALE_MIN_M / 200.0);
}

static double sway_of_table(const struct aperture_motion *motion, double x)
{
    size_t low = 0;
    size_t high = motion->count - 1;
    if (x <= motion->along_track_m[0])
        return motion->sway_m[0];
    if (x >= motion->along_track_m[high])
        return motion->sway_m[high];
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (motion->along_track_m[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    const double share = (x - motion->along_track_m[low]) /
                         (motion->along_track_m[high] - motion->along_track_m[low]);
    return motion->sway_m[low] + share * (motion->sway_m[high] - motion->sway_m[low]);
}

static void add_wave(double amplitude, double wavenumber, double phase, double start, double step,
                     size_t count, double *sway)
{
    for (size_t i = 0; i < count; i++)
        sway[i] += amplitude * sin(wavenumber * (start + (double)i * step) + phase);
}

/* Waves of random phases whose wavenumbers are normal deviates: their spectrum is Gaussian, and so
 * is the autocorrelation. */
static void add_random(const sonject_motion_params *params, double start, double step, size_t count,
                       double *sway)
{
    const struct random_key key = random_key_of((uint32_t)(params->seed & 0xffffffffu),
                                                (uint32_t)(params->seed >> 32), RANDOM_WAVE, 0);
    for (uint32_t wave = 0; wave < RANDOM_WAVES; wave++) {
        float u, v, phase, unused;
        two_uniforms(key, wave, 0, &u, &v);
        two_uniforms(key, wave, 1, &phase, &unused);
        const double deviate = sqrt(-2.0 * log(u)) * cos(2.0 * PI * v);
        add_wave(params->random_rms_m * sqrt(2.0 / RANDOM_WAVES),
                 deviate / params->random_correlation_m, 2.0 * PI * phase, start, step, count,
                 sway);
    }
}

void aperture_motion_sway(const struct aperture_motion *motion, double start_m, double step_m,
                          size_t count, double *sway_m)
{
    const sonject_motion_params *params = &motion->params;
    for (size_t i = 0; i < count; i++)
        sway_m[i] = motion->count > 0 ? sway_of_table(motion, start_m + (double)i * step_m) : 0.0;
    for (uint32_t i = 0; i < params->sway_count; i++)
        add_wave(params->sways[i].amplitude_m, 2.0 * PI / params->sways[i].wavelength_m,
                 params->sways[i].phase_rad, start_m, step_m, count, sway_m);
    if (params->random_rms_m > 0.0)
        add_random(params, start_m, step_m, count, sway_m);
}
