#include "scene/relief_ripples.h"

#include <math.h>

#include "image/random_field.h"

#define PI 3.14159265358979323846

/* As in lib/image/ripples.c: the wander is relative to the regular train of crests; where the two
 * cancel a crest forks. Lengths are deviations of the blur in wavelengths. */
#define WANDERS        2
#define STREAM_WANDERS 0x5eabed60u /* none that the tracer or a synthetic seabed uses */
static const double wander_lengths[WANDERS] = {1.5, 0.5};
static const double wander_strengths[WANDERS] = {1.1, 0.25};

#define FULL_STRENGTH 0.6 /* relative height from which a crest has its full height */

/* The second harmonic narrows crests and widens troughs; beyond a quarter of the first there would
 * be a second crest in each trough. The mean stays 0 and trough to crest 2. */
static double profile(double cosine, double sharpness)
{
    return cosine + 0.25 * sharpness * (2.0 * cosine * cosine - 1.0);
}

static sonject_status make_fields(const struct relief *relief, struct report *report,
                                  const struct relief_feature *feature,
                                  struct random_field *fields[WANDERS])
{
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < WANDERS && feature->irregularity > 0.0; i++) {
        const double length = wander_lengths[i] * feature->wavelength_m;
        const struct blur along_track = {BLUR_GAUSSIAN, length / relief->row_step_m};
        const struct blur range = {BLUR_GAUSSIAN, length / relief->column_step_m};
        status = random_field_create(report, feature->seed, STREAM_WANDERS + i, relief->columns,
                                     along_track, range, &fields[i]);
    }
    return status;
}

/* The scene's rows come in their order, also where the view is mirrored. */
static void add_row(const struct relief *relief, const struct relief_feature *feature,
                    struct random_field *fields[WANDERS], double along, double *heights)
{
    const float *wander_cosine[WANDERS];
    const float *wander_sine[WANDERS];
    const double wavenumber = 2.0 * PI / feature->wavelength_m;
    for (int i = 0; i < WANDERS; i++)
        if (fields[i])
            random_field_next_row(fields[i], &wander_cosine[i], &wander_sine[i]);
    for (uint32_t column = 0; column < relief->columns; column++) {
        const double y = relief->first_y_m + column * relief->column_step_m;
        const double phase =
            wavenumber * (along * cos(feature->heading_rad) + y * sin(feature->heading_rad)) +
            feature->phase_rad;
        double a = 1.0;
        double b = 0.0;
        for (int i = 0; i < WANDERS; i++)
            if (fields[i]) {
                const double strength = feature->irregularity * wander_strengths[i];
                a += strength * (double)wander_cosine[i][column];
                b += strength * (double)wander_sine[i][column];
            }
        const double length = hypot(a, b) + 1e-20;
        const double cosine = (cos(phase) * a - sin(phase) * b) / length;
        heights[column] += 0.5 * feature->height_m * fmin(1.0, length / FULL_STRENGTH) *
                           profile(cosine, feature->sharpness);
    }
}

sonject_status relief_add_ripples(const struct relief *relief, struct report *report,
                                  const struct relief_feature *feature, bool is_mirrored,
                                  double *heights)
{
    struct random_field *fields[WANDERS] = {NULL, NULL};
    const sonject_status status = make_fields(relief, report, feature, fields);
    for (uint32_t i = 0; status == SONJECT_OK && i < relief->rows; i++) {
        const uint32_t row = is_mirrored ? relief->rows - 1 - i : i;
        const double x = relief->first_x_m + row * relief->row_step_m;
        add_row(relief, feature, fields, is_mirrored ? -x : x,
                heights + (size_t)row * relief->columns);
    }
    for (int i = 0; i < WANDERS; i++)
        random_field_release(&fields[i]);
    return status;
}
