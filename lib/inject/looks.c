#include "inject/looks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

uint32_t look_weights(double looks, double *weight, double *last)
{
    const double count = ceil(looks);
    const double others = count - 1.0;
    *weight = 1.0;
    *last = 1.0;
    if (others < 1.0)
        return 1;
    /* others a + b = 1 and others a^2 + b^2 = 1 / looks */
    const double root = others * others - others * count * (1.0 - 1.0 / looks);
    *weight = (others + sqrt(fmax(0.0, root))) / (others * count);
    *last = 1.0 - others * *weight;
    return (uint32_t)count;
}

/* Planes of the patch, real parts and imaginary parts. */
enum look_plane {
    PHASE_REAL,
    PHASE_IMAGINARY,
    NOISE_REAL,
    NOISE_IMAGINARY,
    TARGET_REAL,
    TARGET_IMAGINARY,
    PHASE_ENERGY, /* weighted mean over the looks */
    INTENSITY,
    LOOK_PLANES
};

struct look_work {
    struct tracer *tracer;
    const struct patch_level *level;
    const struct echoes *echoes;
    const float *pixels;
    const struct window *window;
    struct injection_result *result;
    float *planes[LOOK_PLANES];
};

static uint32_t stream_of(uint32_t look, uint32_t first_look, uint32_t which)
{
    return look == 0 ? first_look : STREAM_LOOKS + 3 * (look - 1) + which;
}

static sonject_status draw(const struct look_work *work, uint32_t stream, enum look_plane plane)
{
    return coloured_noise(work->tracer, stream, work->window, work->planes[plane],
                          work->planes[plane + 1]);
}

static sonject_status draw_phase(const struct look_work *work, uint32_t look)
{
    return draw(work, stream_of(look, STREAM_INPUT_PHASE, 0), PHASE_REAL);
}

/* The target's echo in a look: the traced realisation in the first; in the others glints, and the
 * rough part's energy drawn anew. */
static void target_in_look(const struct look_work *work, uint32_t look, size_t i, double *real_part,
                           double *imaginary_part)
{
    const struct echoes *echoes = work->echoes;
    *real_part = (double)echoes->target_real[i];
    *imaginary_part = (double)echoes->target_imaginary[i];
    if (look == 0)
        return;
    const double a = (double)echoes->coherent_real[i];
    const double b = (double)echoes->coherent_imaginary[i];
    const double rough = sqrt(fmax(0.0, (double)echoes->target_energy[i] - a * a - b * b));
    *real_part = a + rough * (double)work->planes[TARGET_REAL][i];
    *imaginary_part = b + rough * (double)work->planes[TARGET_IMAGINARY][i];
}

static void add_look(const struct look_work *work, uint32_t look, double weight, size_t i)
{
    const struct patch_level *level = work->level;
    const double gain =
        sqrt((double)level->level[i] / (double)level->cell_energy[i % work->echoes->columns]);
    const double visibility = (double)work->result->visibility[i];
    const double phase_energy = (double)work->planes[PHASE_ENERGY][i];
    const double seabed =
        phase_energy > 0.0 ? sqrt(visibility / phase_energy) * (double)work->pixels[i] : 0.0;
    const double noise =
        sqrt(fmax(0.0, 1.0 - visibility) * level->noise_ratio * (double)level->level[i]);
    double target_real, target_imaginary;
    target_in_look(work, look, i, &target_real, &target_imaginary);
    const double a = seabed * (double)work->planes[PHASE_REAL][i] + gain * target_real +
                     noise * (double)work->planes[NOISE_REAL][i];
    const double b = seabed * (double)work->planes[PHASE_IMAGINARY][i] + gain * target_imaginary +
                     noise * (double)work->planes[NOISE_IMAGINARY][i];
    work->planes[INTENSITY][i] += (float)(weight * (a * a + b * b));
}

typedef void pixel_function(const struct look_work *work, uint32_t look, double weight, size_t i);

static void each_touched(const struct look_work *work, pixel_function *function, uint32_t look,
                         double weight)
{
    const struct window *window = work->window;
    for (size_t row = window->first_row; row < window->first_row + window->rows; row++)
        for (size_t column = window->first_column; column < window->first_column + window->columns;
             column++)
            if (work->result->influence[row * work->echoes->columns + column])
                function(work, look, weight, row * work->echoes->columns + column);
}

static void add_phase_energy(const struct look_work *work, uint32_t look, double weight, size_t i)
{
    const float a = work->planes[PHASE_REAL][i];
    const float b = work->planes[PHASE_IMAGINARY][i];
    (void)look;
    work->planes[PHASE_ENERGY][i] += (float)(weight * (double)(a * a + b * b));
}

/* The field keeps the first look's phase. */
static void store(const struct look_work *work, uint32_t look, double weight, size_t i)
{
    float *field = work->result->field + 2 * i;
    const float before = work->result->image[i];
    const float after = sqrtf(work->planes[INTENSITY][i]);
    (void)look;
    (void)weight;
    work->result->image[i] = after;
    if (before > 0.0f) {
        field[0] *= after / before;
        field[1] *= after / before;
    }
}

static sonject_status add_looks(const struct look_work *work, double looks)
{
    double weight, last;
    const uint32_t count = look_weights(looks, &weight, &last);
    sonject_status status = SONJECT_OK;
    for (uint32_t look = 0; status == SONJECT_OK && look < count; look++) {
        status = draw_phase(work, look);
        if (status == SONJECT_OK)
            each_touched(work, add_phase_energy, look, look + 1 == count ? last : weight);
    }
    for (uint32_t look = 0; status == SONJECT_OK && look < count; look++) {
        status = draw_phase(work, look);
        THEN(status, draw(work, stream_of(look, STREAM_NOISE, 1), NOISE_REAL));
        if (status == SONJECT_OK && look > 0)
            status = draw(work, stream_of(look, 0, 2), TARGET_REAL);
        if (status == SONJECT_OK)
            each_touched(work, add_look, look, look + 1 == count ? last : weight);
    }
    return status;
}

sonject_status compose_looks(struct tracer *tracer, double looks, const struct patch_level *level,
                             const struct echoes *echoes, const float *pixels,
                             const struct window *window, struct injection_result *result)
{
    struct look_work work = {tracer, level, echoes, pixels, window, result, {NULL}};
    const size_t count = echoes->rows * echoes->columns;
    bool is_complete = true;
    for (int i = 0; i < LOOK_PLANES; i++) {
        work.planes[i] = allocate_array(count, sizeof(float));
        is_complete = is_complete && work.planes[i];
    }
    const sonject_status status =
        is_complete ? add_looks(&work, looks) : report_out_of_memory(tracer->report, "looks");
    if (status == SONJECT_OK)
        each_touched(&work, store, 0, 0.0);
    for (int i = 0; i < LOOK_PLANES; i++)
        free(work.planes[i]);
    return status;
}
