#include "image/ripples.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "image/random_field.h"
#include "kernels/elementary.h"

#define PI             3.14159265358979323846
#define PROFILE_PHASES 256

/* The wander is relative to the regular train of crests: where the two cancel a crest forks.
 * Lengths are deviations of the blur in wavelengths. */
#define WANDERS 2
static const double wander_lengths[WANDERS] = {1.5, 0.5};
static const float wander_strengths[WANDERS] = {1.1f, 0.25f};

#define FULL_STRENGTH 0.6f /* relative height from which a crest has its full contrast */

/* The face towards the sonar is steeper than the back, and slopes saturate at the angle of
 * repose. */
#define SECOND_HARMONIC_COSINE 0.30f
#define SECOND_HARMONIC_SINE   0.10f
#define SATURATION             0.20f

#define SHADOW_FLOOR 0.003f /* -25 dB: no face of a measured ripple is empty */

struct ripples {
    struct random_field *wanders[WANDERS];
    float contrast;
    float profile_mean, profile_scale, profile_square; /* of facing(), see measure_profile */
    double row_cycles, column_cycles;                  /* phase from pixel to pixel */
    uint32_t columns, next_row;
    float *carrier[2]; /* cosine and sine of the column's phase */
};

/* Slope towards the sonar, of either sign, at a phase that is given by its cosine and sine. */
static float slope_towards_sonar(float cosine, float sine)
{
    const float double_sine = 2.0f * sine * cosine;
    const float double_cosine = cosine * cosine - sine * sine;
    const float slope =
        sine - 0.25f - SECOND_HARMONIC_COSINE * double_cosine + SECOND_HARMONIC_SINE * double_sine;
    return slope / sqrtf(SATURATION + slope * slope);
}

/* The slope with mean 0 over a ripple and lowest value -1, where full contrast is darkness. */
static float facing(const struct ripples *ripples, float cosine, float sine)
{
    return (slope_towards_sonar(cosine, sine) - ripples->profile_mean) * ripples->profile_scale;
}

static void measure_profile(struct ripples *ripples)
{
    float sum = 0.0f;
    float squares = 0.0f;
    float lowest = 0.0f;
    for (int i = 0; i < PROFILE_PHASES; i++) {
        float sine, cosine;
        sine_cosine_of_cycles((float)i / PROFILE_PHASES, &sine, &cosine);
        const float slope = slope_towards_sonar(cosine, sine);
        sum += slope;
        squares += slope * slope;
        lowest = fminf(lowest, slope);
    }
    ripples->profile_mean = sum / PROFILE_PHASES;
    ripples->profile_scale = 1.0f / (ripples->profile_mean - lowest);
    ripples->profile_square =
        (squares / PROFILE_PHASES - ripples->profile_mean * ripples->profile_mean) *
        ripples->profile_scale * ripples->profile_scale;
}

/* The sonar looks towards growing range, so the phase must not fall with range: crests that head
 * the other way are the same crests. */
static void set_direction(struct ripples *ripples, const sonject_synthetic_params *synthetic,
                          const sonject_geometry_params *geometry)
{
    float sine, cosine;
    const double turns = fmod(synthetic->ripple_heading_rad, 2.0 * PI) / (2.0 * PI);
    sine_cosine_of_cycles((float)turns, &sine, &cosine);
    const double sign = sine < 0.0f ? -1.0 : 1.0;
    ripples->row_cycles =
        sign * (double)cosine * geometry->row_spacing_m / synthetic->ripple_wavelength_m;
    ripples->column_cycles =
        sign * (double)sine * geometry->column_spacing_m / synthetic->ripple_wavelength_m;
}

static void phase_of(double cycles, float *cosine, float *sine)
{
    sine_cosine_of_cycles((float)(cycles - floor(cycles)), sine, cosine);
}

sonject_status ripples_create(struct report *report, const sonject_synthetic_params *synthetic,
                              const sonject_geometry_params *geometry, uint32_t stream,
                              struct ripples **ripples)
{
    *ripples = NULL;
    struct ripples *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(report, made, "ripples");
    made->columns = synthetic->columns;
    made->contrast = (float)synthetic->ripple_contrast;
    made->carrier[0] = allocate_array(made->columns, sizeof(float));
    made->carrier[1] = allocate_array(made->columns, sizeof(float));
    measure_profile(made);
    set_direction(made, synthetic, geometry);
    sonject_status status =
        made->carrier[0] && made->carrier[1] ? SONJECT_OK : report_out_of_memory(report, "ripples");
    for (uint32_t i = 0; status == SONJECT_OK && i < WANDERS; i++) {
        const double length = wander_lengths[i] * synthetic->ripple_wavelength_m;
        const struct blur along_track = {BLUR_GAUSSIAN, length / geometry->row_spacing_m};
        const struct blur range = {BLUR_GAUSSIAN, length / geometry->column_spacing_m};
        status = random_field_create(report, synthetic->seed, stream + i, made->columns,
                                     along_track, range, &made->wanders[i]);
    }
    if (status != SONJECT_OK) {
        ripples_release(&made);
        return status;
    }
    for (uint32_t column = 0; column < made->columns; column++)
        phase_of(made->column_cycles * column, &made->carrier[0][column],
                 &made->carrier[1][column]);
    *ripples = made;
    return SONJECT_OK;
}

void ripples_release(struct ripples **ripples)
{
    if (!*ripples)
        return;
    for (int i = 0; i < WANDERS; i++)
        random_field_release(&(*ripples)->wanders[i]);
    free((*ripples)->carrier[0]);
    free((*ripples)->carrier[1]);
    free(*ripples);
    *ripples = NULL;
}

void ripples_modulate_next_row(struct ripples *ripples, const float *presence, float *intensity)
{
    const float *wander_cosine[WANDERS];
    const float *wander_sine[WANDERS];
    float row_cosine, row_sine;
    for (int i = 0; i < WANDERS; i++)
        random_field_next_row(ripples->wanders[i], &wander_cosine[i], &wander_sine[i]);
    phase_of(ripples->row_cycles * ripples->next_row++, &row_cosine, &row_sine);
    for (uint32_t i = 0; i < ripples->columns; i++) {
        const float column_cosine = ripples->carrier[0][i];
        const float column_sine = ripples->carrier[1][i];
        const float train_cosine = row_cosine * column_cosine - row_sine * column_sine;
        const float train_sine = row_cosine * column_sine + row_sine * column_cosine;
        float x = 1.0f;
        float y = 0.0f;
        for (int j = 0; j < WANDERS; j++) {
            x += wander_strengths[j] * wander_cosine[j][i];
            y += wander_strengths[j] * wander_sine[j][i];
        }
        const float height = sqrtf(x * x + y * y) + 1e-20f;
        const float cosine = (train_cosine * x - train_sine * y) / height;
        const float sine = (train_cosine * y + train_sine * x) / height;
        const float strength = fminf(1.0f, height / FULL_STRENGTH);
        const float contrast = ripples->contrast * presence[i] * strength;
        const float amplitude = 1.0f + contrast * facing(ripples, cosine, sine);
        const float mean = 1.0f + contrast * contrast * ripples->profile_square;
        intensity[i] *= SHADOW_FLOOR + (1.0f - SHADOW_FLOOR) * amplitude * amplitude / mean;
    }
}
