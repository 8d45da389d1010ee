#include "inject/echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "form/form.h"
#include "scene/cross_range.h"

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
            fmax(view_apparent_range(view, ((double)grid->bins.first + (double)bin) /
                                               grid->bins_per_pixel),
                 0.5 * view->column_spacing_m / grid->bins_per_pixel);
        energies[bin] = (float)(cell / (cross_range_energy_width(&tracer->response, range) *
                                        range_energy_width(&tracer->response)));
    }
    for (size_t i = bins; i < CHUNK * bins; i++)
        energies[i] = energies[i - bins];
}

static sonject_status draw(struct form_lines *lines, const struct tracer *tracer, uint32_t stream)
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
        a && b ? draw(&lines, tracer, stream) : report_out_of_memory(tracer->report, "noise");
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
