#include "inject/echo_peak.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/point_response.h"

#define POINTS_PER_RESOLUTION 4 /* a parabola in dB between them errs by 0.02 dB */
#define MARGIN                2 /* points around the tile */

/* Points every `step` cells that hold a tile's cells, in cells of another size. */
static struct span points_over(struct span tile, double cells_per_tile_cell, int32_t step)
{
    struct span points;
    points.first = (int32_t)floor(tile.first * cells_per_tile_cell / step) - MARGIN;
    points.count = (int32_t)ceil((tile.first + tile.count) * cells_per_tile_cell / step) + MARGIN -
                   points.first;
    return points;
}

static int32_t cells_of(double resolution_m, double cell_m)
{
    return (int32_t)fmax(1.0, floor(resolution_m / (POINTS_PER_RESOLUTION * cell_m)));
}

sonject_status peak_lattice_init(struct peak_lattice *lattice, const struct tracer *tracer,
                                 const struct line_grid *tile, const struct line_grid *grid)
{
    const struct patch_view *view = &tracer->view;
    const double strip = view->row_spacing_m / grid->strips_per_row;
    const double bin = view->column_spacing_m / grid->bins_per_pixel;
    const double range =
        view_processor_range(view, (double)tile->bins.first / tile->bins_per_pixel);
    const int32_t strips = cells_of(
        cross_range_energy_width(&tracer->response, fmax(range, view->first_range_m)), strip);
    const int32_t bins = cells_of(range_energy_width(&tracer->response), bin);
    const struct span rows =
        points_over(tile->strips, (double)grid->strips_per_row / tile->strips_per_row, strips);
    const struct span columns =
        points_over(tile->bins, (double)grid->bins_per_pixel / tile->bins_per_pixel, bins);
    memset(lattice, 0, sizeof *lattice);
    lattice->grid.strips_per_row = (uint32_t)strips;
    lattice->grid.bins_per_pixel = (uint32_t)bins;
    lattice->grid.strips.first = rows.first * strips;
    lattice->grid.bins.first = columns.first * bins;
    lattice->view = *view;
    lattice->view.rows = (size_t)rows.count;
    lattice->view.columns = (size_t)columns.count;
    lattice->view.row_spacing_m = strips * strip;
    lattice->view.column_spacing_m = bins * bin;
    /* rows are in the middle of their strips, columns on bins */
    lattice->view.first_x_m =
        view_x_of_row(view, -0.5) + ((double)rows.first + 0.5) * lattice->view.row_spacing_m;
    lattice->view.first_range_m =
        view->first_range_m + columns.first * lattice->view.column_spacing_m;
    for (int i = 0; i < 2; i++)
        lattice->plane[i] =
            allocate_array(lattice->view.rows, lattice->view.columns * sizeof(float));
    return lattice->plane[0] && lattice->plane[1]
               ? SONJECT_OK
               : report_out_of_memory(tracer->report, "an echo's peak");
}

void peak_lattice_clear(struct peak_lattice *lattice)
{
    form_lines_end(&lattice->lines);
    free(lattice->plane[0]);
    free(lattice->plane[1]);
    memset(lattice, 0, sizeof *lattice);
}

sonject_status peak_lattice_begin(struct peak_lattice *lattice, struct tracer *tracer,
                                  enum form_kind kind, const struct line_grid *grid)
{
    struct line_grid counted = *grid;
    counted.strips.first -= lattice->grid.strips.first;
    counted.bins.first -= lattice->grid.bins.first;
    counted.strips_per_row = lattice->grid.strips_per_row;
    counted.bins_per_pixel = lattice->grid.bins_per_pixel;
    return form_lines_begin(&lattice->lines, tracer->report, tracer->device, &lattice->view,
                            &tracer->response, kind, &counted);
}

sonject_status peak_lattice_finish(struct peak_lattice *lattice)
{
    struct form_lines *lines = &lattice->lines;
    const size_t width = lattice->view.columns;
    const size_t count = lines->rows * lines->columns;
    float *parts[2] = {allocate_array(count, sizeof(float)), allocate_array(count, sizeof(float))};
    const sonject_status status = parts[0] && parts[1]
                                      ? form_lines_finish(lines, parts[0], parts[1])
                                      : report_out_of_memory(lines->report, "an echo's peak");
    for (size_t i = 0; status == SONJECT_OK && i < 2 * count; i++) {
        const size_t at = i % count;
        lattice->plane[i / count][at / lines->columns * width + lines->first_column +
                                  at % lines->columns] += parts[i / count][at];
    }
    free(parts[0]);
    free(parts[1]);
    form_lines_end(lines);
    return status;
}

/* Two lattices of one echo: a field or energies at the first one's points, and the other's energy
 * there. */
struct echo_points {
    const struct peak_lattice *own, *other;
    bool own_is_field;
};

static double energy_at_point(const struct peak_lattice *lattice, bool is_field, size_t i)
{
    const double a = (double)lattice->plane[0][i];
    const double b = (double)lattice->plane[1][i];
    return is_field ? a * a + b * b : a;
}

/* Between the points of a lattice, linear in both directions; 0 beyond them. */
static double energy_between(const struct peak_lattice *lattice, bool is_field, double row,
                             double column)
{
    const struct patch_view *view = &lattice->view;
    double sum = 0.0;
    if (!lattice->plane[0] || row < 0.0 || column < 0.0 || row >= (double)view->rows - 1.0 ||
        column >= (double)view->columns - 1.0)
        return 0.0;
    for (int k = 0; k < 4; k++) {
        const double r = floor(row) + k / 2;
        const double c = floor(column) + k % 2;
        sum += (1.0 - fabs(row - r)) * (1.0 - fabs(column - c)) *
               energy_at_point(lattice, is_field, (size_t)r * view->columns + (size_t)c);
    }
    return sum;
}

static double energy_of_both(const struct echo_points *points, size_t row, size_t column)
{
    const struct patch_view *own = &points->own->view;
    const struct patch_view *other = &points->other->view;
    return energy_at_point(points->own, points->own_is_field, row * own->columns + column) +
           energy_between(points->other, !points->own_is_field,
                          view_row_of_x(other, view_x_of_row(own, (double)row)),
                          view_column_of_range(other, view_processor_range(own, (double)column)));
}

/* The peak of the parabola through the levels of a point and its neighbours; the point's own energy
 * where that has none. */
static double peak_around(const struct echo_points *points, size_t row, size_t column)
{
    const struct patch_view *view = &points->own->view;
    const double energy = energy_of_both(points, row, column);
    double level[3][3];
    if (row == 0 || column == 0 || row + 1 == view->rows || column + 1 == view->columns)
        return energy;
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 3; c++)
            level[r][c] = log(energy_of_both(points, row + r - 1, column + c - 1) / energy);
    const double x = 0.5 * (level[2][1] - level[0][1]);
    const double y = 0.5 * (level[1][2] - level[1][0]);
    const double xx = level[2][1] + level[0][1];
    const double yy = level[1][2] + level[1][0];
    const double xy = 0.25 * (level[2][2] + level[0][0] - level[2][0] - level[0][2]);
    const double curvature = xx * yy - xy * xy;
    const double rise = -0.5 * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / curvature;
    return xx < 0.0 && curvature > 0.0 && rise < log(2.0) ? energy * exp(rise) : energy;
}

/* Of the peaks where most is of the first lattice; *peak grows. */
static void find_peak(const struct echo_points *points, double *peak, double *range_m)
{
    const struct patch_view *view = &points->own->view;
    double brightest = *peak;
    size_t at = 0;
    for (size_t i = 0; points->own->plane[0] && i < view->rows * view->columns; i++) {
        if (energy_at_point(points->own, points->own_is_field, i) < 0.5 * brightest)
            continue;
        const double energy = energy_of_both(points, i / view->columns, i % view->columns);
        if (energy > brightest) {
            brightest = energy;
            at = i;
        }
    }
    if (!(brightest > *peak))
        return;
    *peak = peak_around(points, at / view->columns, at % view->columns);
    *range_m = view_processor_range(view, (double)(at % view->columns));
}

double peak_of_echo(const struct peak_lattice *glint, const struct peak_lattice *rough,
                    double *range_m)
{
    const struct echo_points of_glint = {glint, rough, true};
    const struct echo_points of_rough = {rough, glint, false};
    double peak = 0.0;
    *range_m = 0.0;
    find_peak(&of_glint, &peak, range_m);
    find_peak(&of_rough, &peak, range_m);
    return peak;
}
