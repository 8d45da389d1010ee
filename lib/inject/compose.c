#include "inject/compose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Draws two planes of coloured noise, for free(). */
static sonject_status planes_of_noise(struct tracer *tracer, uint32_t stream,
                                      const struct window *window, float **planes)
{
    const size_t pixels = tracer->view.rows * tracer->view.columns;
    *planes = allocate_array(2 * pixels, sizeof **planes);
    CHECK_MEMORY(tracer->report, *planes, "noise");
    return coloured_noise(tracer, stream, window, *planes, *planes + pixels);
}

/* Gives the measured pixel a phase: its own, or, in an image of magnitudes, that of a speckle field
 * of the sonar's point response, so that the phase varies as a real one would. */
static void input_with_phase(const float *pixels, bool is_complex, const float *phase, size_t count,
                             size_t i, double *real_part, double *imaginary_part)
{
    if (is_complex) {
        *real_part = pixels[2 * i];
        *imaginary_part = pixels[2 * i + 1];
        return;
    }
    const double a = phase[i];
    const double b = phase[count + i];
    const double length = hypot(a, b);
    *real_part = length > 0.0 ? pixels[i] * a / length : pixels[i];
    *imaginary_part = length > 0.0 ? pixels[i] * b / length : 0.0;
}

/* Returns the share of the seabed's energy that objects hide. */
static double hidden_share(const struct echoes *echoes, size_t i)
{
    const double without = echoes->seabed_energy[i];
    return without > 0.0 ? fmin(1.0, echoes->lost_energy[i] / without) : 0.0;
}

/* Returns V: the seabed's energy over that of a level seabed without objects. Slopes that face the
 * sonar return more than that. */
static double visibility_of(const struct echoes *echoes, size_t i)
{
    const double left = 1.0 - hidden_share(echoes, i);
    if (!echoes->level_energy)
        return left;
    const double level = echoes->level_energy[i];
    return level > 0.0 ? left * (echoes->seabed_energy[i] / level) : left;
}

/* Returns whether the pixel is resynthesised, whatever it is. The water column has no seabed to
 * trace, and keeps its own pixels but for the targets' echoes. */
static bool is_resynthesised(const struct scene *scene, const struct patch_level *level,
                             const struct echoes *echoes, size_t i)
{
    return scene->injection.mode == SONJECT_MODE_RESYNTHESISE &&
           i % echoes->columns >= level->water_columns;
}

/* Returns the image energy per m^2 of cross-section. */
static double gain_at(const struct patch_level *level, const struct echoes *echoes, size_t i)
{
    return level->level[i] / (double)level->cell_energy[i % echoes->columns];
}

#define CLEARLY_HIDDEN                                                                             \
    0.1 /* share of a pixel's energy from which the pixel counts as hidden by as much */

/* Returns what objects and relief take from the seabed's energy, over its level. The pixel's own
 * energy would not do: the influence would end later at dark pixels than at bright ones, and its
 * edge would show. */
static double seabed_change(const struct patch_level *level, const struct echoes *echoes, size_t i)
{
    const double hidden = hidden_share(echoes, i);
    if (echoes->level_energy)
        return fabs(1.0 - visibility_of(echoes, i));
    return hidden > CLEARLY_HIDDEN
               ? hidden
               : (double)echoes->lost_energy[i] / (double)level->cell_energy[i % echoes->columns];
}

/* Marks the pixels that the objects change by more than the scene's influence level, or all pixels
 * in resynthesis. Returns the window that holds them. */
static struct window mark_influence(const struct scene *scene, const struct patch_level *level,
                                    const struct echoes *echoes, uint8_t *influence)
{
    const double threshold = pow(10.0, scene->injection.influence_db / 10.0);
    struct window window = {echoes->rows, 0, echoes->columns, 0};
    size_t end_row = 0;
    size_t end_column = 0;
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++) {
        const double change = gain_at(level, echoes, i) * (double)echoes->target_energy[i] +
                              seabed_change(level, echoes, i) * (double)level->level[i];
        if (!is_resynthesised(scene, level, echoes, i) &&
            !(change > 0.0 && change >= threshold * level->level[i]))
            continue;
        const size_t row = i / echoes->columns;
        const size_t column = i % echoes->columns;
        influence[i] = 255;
        window.first_row = row < window.first_row ? row : window.first_row;
        window.first_column = column < window.first_column ? column : window.first_column;
        end_row = row + 1;
        end_column = column + 1 > end_column ? column + 1 : end_column;
    }
    window.rows = end_row > window.first_row ? end_row - window.first_row : 0;
    window.columns = end_column > window.first_column ? end_column - window.first_column : 0;
    return window;
}

/* Fills a pixel that nothing changes with what plain seabed returns. */
static void leave_pixel(const struct patch_level *level, const struct echoes *echoes, size_t i,
                        struct injected_window *result)
{
    result->visibility[i] = 1.0f;
    result->energy[i] = level->cell_energy[i % echoes->columns];
    for (uint32_t order = 0; order < echoes->orders; order++)
        echoes->order_energy[order][i] = order == 0 ? result->energy[i] : 0.0f;
}

/* Composes a pixel in image units: the measured seabed or its new realisation, as far as it is in
 * view, the target, and noise. */
static void compose_pixel(const struct scene *scene, const struct patch_level *level,
                          const struct echoes *echoes, const float *pixels, const float *noise,
                          const float *phase, size_t i, struct injected_window *result)
{
    const size_t count = echoes->rows * echoes->columns;
    const double scale = sqrt(gain_at(level, echoes, i));
    const bool resynthesises = is_resynthesised(scene, level, echoes, i);
    const double visibility = visibility_of(echoes, i);
    double real_part = resynthesises ? scale * echoes->seabed_real[i] : 0.0;
    double imaginary_part = resynthesises ? scale * echoes->seabed_imaginary[i] : 0.0;
    if (!resynthesises)
        input_with_phase(pixels, result->is_complex, phase, count, i, &real_part, &imaginary_part);
    /* A new realisation holds only what is in view. */
    const double seabed = resynthesises ? 1.0 : sqrt(visibility);
    /* Noise goes with hidden seabed and is added again. A brighter pixel has enough noise. */
    const double lost =
        sqrt(fmax(0.0, 1.0 - visibility) * (noise_over_level(level, i) * level->level[i]));
    const double noise_real = noise ? noise[i] : 0.0;
    const double noise_imaginary = noise ? noise[count + i] : 0.0;
    real_part = seabed * real_part + scale * echoes->target_real[i] + lost * noise_real;
    imaginary_part =
        seabed * imaginary_part + scale * echoes->target_imaginary[i] + lost * noise_imaginary;
    if (result->is_complex) {
        result->image[2 * i] = (float)real_part;
        result->image[2 * i + 1] = (float)imaginary_part;
    } else {
        result->image[i] = (float)hypot(real_part, imaginary_part);
    }
    result->field[2 * i] = (float)(real_part / scale);
    result->field[2 * i + 1] = (float)(imaginary_part / scale);
    result->visibility[i] = (float)visibility;
    result->energy[i] = echoes->energy[i];
}

/* Cuts highlights where the image's own are cut. */
static void saturate(double amplitude, size_t count, struct injected_window *result)
{
    for (size_t i = 0; !result->is_complex && i < count; i++)
        if (result->influence[i] && (double)result->image[i] > amplitude)
            result->image[i] = (float)amplitude;
}

sonject_status compose(struct tracer *tracer, const struct image_match *match,
                       const struct patch_level *level, const struct echoes *echoes,
                       const float *pixels, bool is_complex, struct injected_window *result)
{
    const struct scene *scene = tracer->scene;
    const size_t count = echoes->rows * echoes->columns;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    const struct window touched = mark_influence(scene, level, echoes, result->influence);
    float *noise = NULL;
    float *phase = NULL;
    sonject_status status = SONJECT_OK;
    if (scene->object_count > 0 || echoes->level_energy)
        status = planes_of_noise(tracer, STREAM_NOISE, &touched, &noise);
    const bool has_own_pixels = !resynthesises || level->water_columns > 0;
    if (status == SONJECT_OK && !is_complex && has_own_pixels)
        status = planes_of_noise(tracer, STREAM_INPUT_PHASE, &touched, &phase);
    if (status == SONJECT_OK) {
        /* Pixels that nothing touches must keep every bit, so they are copied, not computed. */
        memcpy(result->image, pixels, count * (is_complex ? 2 : 1) * sizeof(float));
        for (size_t i = 0; i < count; i++)
            if (result->influence[i])
                compose_pixel(scene, level, echoes, pixels, noise, phase, i, result);
            else
                leave_pixel(level, echoes, i, result);
    }
    if (status == SONJECT_OK && match->looks > 1.0)
        status = compose_looks(tracer, match->looks, level, echoes, pixels, &touched, result);
    if (status == SONJECT_OK)
        saturate(match->saturation, count, result);
    free(noise);
    free(phase);
    return status;
}
