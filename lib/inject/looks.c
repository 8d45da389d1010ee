#include "inject/looks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "form/form.h"
#include "inject/echoes.h"
#include "scene/point_response.h"

#define CHUNK 256 /* strips drawn at a time */

static int32_t limit(double value, struct span span)
{
    const double last = span.first + span.count;
    return (int32_t)(value < span.first ? span.first : value > last ? last : value);
}

/* The part of the patch's grid that the window's pixels are formed from. */
static void cut_grid(struct line_grid *grid, const struct tracer *tracer,
                     const struct window *window)
{
    const double per_row = grid->strips_per_row;
    const double per_pixel = grid->bins_per_pixel;
    const double reach =
        form_reach(&tracer->view, &tracer->response, FORM_SPECKLE, grid->strips_per_row) + per_row;
    const double pulse = pulse_reach_bins(&tracer->view, &tracer->response, grid->bins_per_pixel);
    const struct span strips = grid->strips;
    const struct span bins = grid->bins;
    grid->strips.first = limit((double)window->first_row * per_row - reach, strips);
    grid->strips.count =
        limit((double)(window->first_row + window->rows) * per_row + reach, strips) -
        grid->strips.first;
    grid->bins.first = limit((double)window->first_column * per_pixel - pulse, bins);
    grid->bins.count =
        limit((double)(window->first_column + window->columns - 1) * per_pixel + pulse + 1.0,
              bins) -
        grid->bins.first;
}

/* Copies the window out of formed planes that start at the lines' own first column. */
static void copy_window(const struct form_lines *lines, const struct window *window,
                        const float *formed, size_t patch_columns, float *plane)
{
    for (size_t row = window->first_row; row < window->first_row + window->rows; row++)
        memcpy(plane + row * patch_columns + window->first_column,
               formed + row * lines->columns + window->first_column - lines->first_column,
               window->columns * sizeof *plane);
}

/* Energies of cells that make the formed noise's mean energy 1 at every range. */
static void fill_energies(const struct line_grid *grid, const struct tracer *tracer,
                          float *energies)
{
    const struct patch_view *view = &tracer->view;
    const double cell =
        view->row_spacing_m / grid->strips_per_row * view->column_spacing_m / grid->bins_per_pixel;
    const size_t bins = (size_t)grid->bins.count;
    for (size_t bin = 0; bin < bins; bin++) {
        /* half a bin at least: a beam has no width at range 0 */
        const double range =
            fmax(view_processor_range(view, ((double)grid->bins.first + (double)bin) /
                                                grid->bins_per_pixel),
                 0.5 * view->column_spacing_m / grid->bins_per_pixel);
        energies[bin] = (float)(cell / (cross_range_energy_width(&tracer->response, range) *
                                        range_energy_width(&tracer->response)));
    }
    for (size_t i = bins; i < CHUNK * bins; i++)
        energies[i] = energies[i - bins];
}

static sonject_status draw_noise(struct form_lines *lines, const struct tracer *tracer,
                                 uint32_t stream)
{
    const struct line_grid *grid = &lines->grid;
    float *energies = allocate_array((size_t)CHUNK * (size_t)grid->bins.count, sizeof *energies);
    CHECK_MEMORY(tracer->report, energies, "noise");
    fill_energies(grid, tracer, energies);
    sonject_status status = SONJECT_OK;
    for (int32_t done = 0; status == SONJECT_OK && done < grid->strips.count; done += CHUNK) {
        const int32_t left = grid->strips.count - done;
        status =
            form_lines_add_speckle(lines, grid->strips.first + done, left < CHUNK ? left : CHUNK,
                                   energies, tracer->scene->injection.seed, stream);
    }
    free(energies);
    return status;
}

sonject_status coloured_noise(struct tracer *tracer, uint32_t stream, const struct window *window,
                              float *real_part, float *imaginary_part)
{
    struct line_grid grid;
    struct form_lines lines;
    if (window->rows == 0 || window->columns == 0)
        return SONJECT_OK;
    line_grid_for_patch(&grid, &tracer->view, &tracer->response);
    cut_grid(&grid, tracer, window);
    CHECK(form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view, &tracer->response,
                           FORM_SPECKLE, &grid));
    const size_t formed = lines.rows * lines.columns;
    float *a = allocate_array(formed, sizeof *a);
    float *b = allocate_array(formed, sizeof *b);
    sonject_status status =
        a && b ? draw_noise(&lines, tracer, stream) : report_out_of_memory(tracer->report, "noise");
    THEN(status, form_lines_finish(&lines, a, b));
    if (status == SONJECT_OK) {
        copy_window(&lines, window, a, tracer->view.columns, real_part);
        copy_window(&lines, window, b, tracer->view.columns, imaginary_part);
    }
    free(a);
    free(b);
    form_lines_end(&lines);
    return status;
}

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
