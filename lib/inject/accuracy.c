#include "inject/accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"

#define REACH       2    /* pixels on either side */
#define PILOT_SCALE 0.5  /* over the usual number of rays; pilots of fewer rays predict badly */
#define MARGIN      1.15 /* pilots predict the error to 12 % */
#define SCALE_STEPS 64.0 /* steps of the ray scale, so that run.json has a short number */

/* Returns the number of rays of a result over that of both pilots. */
static double rays_of_result(const struct pilots *pilots)
{
    return pilots->scene->injection.ray_scale / (2.0 * PILOT_SCALE);
}

/* Returns the mean of both pilots' energies over a window around a pixel. Few rays may miss a
 * single pixel, and its neighbours within the point response share its fate. */
static double energy_about(const struct pilots *pilots, size_t window, size_t row, size_t column)
{
    const struct injected_window *const one = &pilots->result[0].windows[window];
    const float *const other = pilots->result[1].windows[window].energy;
    const size_t first_row = row > REACH ? row - REACH : 0;
    const size_t first_column = column > REACH ? column - REACH : 0;
    double sum = 0.0, count = 0.0;
    for (size_t i = first_row; i <= row + REACH && i < one->at.rows; i++)
        for (size_t k = first_column; k <= column + REACH && k < one->at.columns; k++) {
            sum += one->energy[i * one->at.columns + k] + other[i * one->at.columns + k];
            count += 2.0;
        }
    return sum / count;
}

/* Returns the mean square of the relative difference between a result and the mean of both pilots,
 * or, where result is NULL, between the pilots. Differences are over the energy around a pixel plus
 * noise, and pixels are those that the pilots change. NaN if there are none. */
static double mean_square_difference(const struct pilots *pilots,
                                     const struct injection_result *result)
{
    const struct injection_result *const one = &pilots->result[0], *const two = &pilots->result[1];
    const double noise_ratio = pow(10.0, one->statistics.noise_floor_db / 10.0);
    double sum = 0.0, count = 0.0;
    for (size_t k = 0; k < one->window_count; k++) {
        const struct window at = one->windows[k].at;
        for (size_t i = 0; i < at.rows * at.columns; i++) {
            const size_t row = i / at.columns, column = i % at.columns;
            const size_t pixel = (at.first_row + row) * one->columns + at.first_column + column;
            if (!one->influence[pixel] && !two->influence[pixel])
                continue;
            const double a = one->windows[k].energy[i], b = two->windows[k].energy[i];
            const double difference = result ? result->windows[k].energy[i] - 0.5 * (a + b) : a - b;
            const double ratio =
                difference / (energy_about(pilots, k, row, column) +
                              noise_ratio * one->seabed_energy[at.first_column + column]);
            sum += ratio * ratio;
            count += 1.0;
        }
    }
    return sum / count;
}

double pilots_error_of(const struct pilots *pilots, const struct injection_result *result)
{
    if (result->window_count != pilots->result[0].window_count)
        return NAN;
    /* Variances fall as one over the number of rays. */
    return sqrt(mean_square_difference(pilots, result) / (1.0 + rays_of_result(pilots)));
}

static sonject_status choose_rays(struct pilots *pilots, struct report *report,
                                  const struct scene *scene)
{
    const double accuracy = scene->injection.accuracy;
    const double variance = 0.5 * mean_square_difference(pilots, NULL); /* one pilot's */
    const double wanted = PILOT_SCALE * MARGIN * MARGIN * variance / (accuracy * accuracy);
    if (wanted > RAY_SCALE_MAX) {
        const double least = accuracy * sqrt(wanted / RAY_SCALE_MAX);
        return scene_locate(scene, report,
                            report_failure(report, SONJECT_ERROR_INPUT,
                                           "takes %.0f times the usual number of rays, and at most "
                                           "%g times can be traced: ask for %.2g %% or more",
                                           wanted, RAY_SCALE_MAX, 100.0 * least),
                            "injection.accuracy");
    }
    /* If nothing is changed, no rays are asked for. */
    pilots->scene->injection.ray_scale =
        isnan(wanted) ? 1.0 : fmax(ceil(wanted * SCALE_STEPS) / SCALE_STEPS, PILOT_SCALE);
    pilots->scene->injection.ray_seed = scene->injection.ray_seed;
    return SONJECT_OK;
}

static sonject_status run_pilots(struct pilots *pilots, struct report *report,
                                 struct device *device, const struct scene *scene,
                                 const struct injection_input *input,
                                 sonject_progress_function progress, void *user)
{
    /* Only the ray seeds differ: what grows on objects is the same in both. */
    static const uint64_t turns[2] = {0x9e3779b97f4a7c15u, 0xd1b54a32d192ed03u};
    struct progress_share none = {progress, user, 0.0, 0.0};
    struct injection_input alone = *input;
    struct scene *pilot = pilots->scene = allocate_array(1, sizeof *pilot);
    sonject_status status = SONJECT_OK;
    CHECK_MEMORY(report, pilot, "a pilot");
    *pilot = *scene;
    pilot->injection.accuracy = 0.0;
    pilot->injection.ray_scale = PILOT_SCALE;
    alone.checkpoint = NULL;
    alone.traced = NULL;
    for (int i = 0; status == SONJECT_OK && i < 2; i++) {
        pilot->injection.ray_seed = scene->injection.ray_seed ^ turns[i];
        status = injection_run(report, device, pilot, &alone, progress_share_tell, &none,
                               &pilots->result[i]);
        free(pilots->result[i].image);
        pilots->result[i].image = NULL;
    }
    return status;
}

sonject_status pilots_find(struct pilots *own, struct report *report, struct device *device,
                           const struct scene **scene, struct injection_input *input,
                           sonject_progress_function progress, void *user)
{
    const struct scene **traced = input->traced ? &input->traced : scene;
    memset(own, 0, sizeof *own);
    if (!((*traced)->injection.accuracy > 0.0))
        return SONJECT_OK;
    sonject_status status = run_pilots(own, report, device, *traced, input, progress, user);
    THEN(status, choose_rays(own, report, *traced));
    if (status != SONJECT_OK) {
        pilots_clear(own);
        return status;
    }
    *traced = own->scene;
    input->pilots = own;
    return SONJECT_OK;
}

void pilots_clear(struct pilots *pilots)
{
    for (int i = 0; i < 2; i++)
        injection_result_clear(&pilots->result[i]);
    free(pilots->scene);
    memset(pilots, 0, sizeof *pilots);
}
