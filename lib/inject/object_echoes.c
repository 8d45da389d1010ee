/* The formed echoes of objects by one interaction: rough surfaces and glints. Each echo's peak is
 * found wherever pixels lie: on a lattice finer than the point response, and between its points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/echoes.h"
#include "scene/point_response.h"
#include "trace/multibounce.h"

#define POINTS_PER_RESOLUTION 4 /* a parabola in dB between points errs by 0.02 dB */
#define MARGIN                2 /* points around the tile */

/* Returns points every `step` cells that cover a tile, whose cells have another size, and the cells
 * to both sides into which its echo may be shifted. */
static struct span points_over(struct span tile, double cells_per_tile_cell, int32_t step,
                               double shift_cells)
{
    const int32_t margin = (int32_t)ceil(shift_cells / step) + MARGIN;
    struct span points;
    points.first = (int32_t)floor(tile.first * cells_per_tile_cell / step) - margin;
    points.count = (int32_t)ceil((tile.first + tile.count) * cells_per_tile_cell / step) + margin -
                   points.first;
    return points;
}

static int32_t cells_of(double resolution_m, double cell_m)
{
    return (int32_t)fmax(1.0, floor(resolution_m / (POINTS_PER_RESOLUTION * cell_m)));
}

/* Returns the rows of points that a tile's echo may peak in, `step` of the grid's strips apart.
 * Parts of a slanting face may add up only in pings ahead or astern of it, as far as a real
 * aperture's beam hears the field of glints. No point lies beyond both tile and patch. */
static struct span rows_of_points(const struct tracer *tracer, const struct line_grid *tile,
                                  const struct line_grid *grid, enum form_kind kind, int32_t step)
{
    const struct patch_view *view = &tracer->view;
    const struct point_response *response = &tracer->response;
    const double per_tile_strip = (double)grid->strips_per_row / tile->strips_per_row;
    const double shift = kind == FORM_FIELD && response->array_length_m > 0.0
                             ? form_reach(view, response, kind, grid->strips_per_row)
                             : cross_range_shift(response, view->farthest_m) *
                                   grid->strips_per_row / view->row_spacing_m;
    const struct span patch = {0, (int32_t)(view->rows * grid->strips_per_row)};
    const struct span seen = span_join(points_over(tile->strips, per_tile_strip, step, 0.0),
                                       points_over(patch, 1.0, step, 0.0));
    return span_overlap(points_over(tile->strips, per_tile_strip, step, shift), seen);
}

/* Lays points over a tile, a quarter of the resolution apart in strips and bins of the grid, but at
 * least one strip and bin. A field's details may be as fine along the track as W's band allows:
 * parts of a long target add up in a few pings of a beam that is much wider. */
static sonject_status peak_lattice_init(struct peak_lattice *lattice, const struct tracer *tracer,
                                        const struct line_grid *tile, const struct line_grid *grid,
                                        enum form_kind kind)
{
    const struct patch_view *view = &tracer->view;
    const double strip = view->row_spacing_m / grid->strips_per_row;
    const double bin = view->column_spacing_m / grid->bins_per_pixel;
    const double range =
        view_processor_range(view, (double)tile->bins.first / tile->bins_per_pixel);
    const double width =
        cross_range_energy_width(&tracer->response, fmax(range, view->first_range_m));
    const int32_t strips =
        cells_of(kind == FORM_FIELD ? fmin(width, tracer->response.strip_m) : width, strip);
    const int32_t bins = cells_of(range_energy_width(&tracer->response), bin);
    const struct span rows = rows_of_points(tracer, tile, grid, kind, strips);
    const struct span columns =
        points_over(tile->bins, (double)grid->bins_per_pixel / tile->bins_per_pixel, bins,
                    range_shift(&tracer->response) / bin);
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
    /* Rows lie in the middle of their strips, columns on bins. */
    lattice->view.first_x_m =
        view_x_of_row(view, -0.5) + ((double)rows.first + 0.5) * lattice->view.row_spacing_m;
    lattice->view.first_range_m =
        view->first_range_m + columns.first * lattice->view.column_spacing_m;
    lattice->planes = allocate_array(2 * lattice->view.rows, lattice->view.columns * sizeof(float));
    CHECK_MEMORY(tracer->report, lattice->planes, "an echo's peak");
    return SONJECT_OK;
}

/* Begins to form lines of a grid with these strips and bins. */
static sonject_status peak_lattice_begin(struct peak_lattice *lattice, struct tracer *tracer,
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

/* Adds the formed lines to the planes. */
static sonject_status peak_lattice_finish(struct peak_lattice *lattice)
{
    struct formed formed;
    const sonject_status status = form_end(&lattice->lines, &formed);
    const struct window *at = &formed.at;
    for (size_t row = 0; status == SONJECT_OK && row < 2 * at->rows; row++) {
        const size_t to_row = row / at->rows * lattice->view.rows + at->first_row + row % at->rows;
        float *to = lattice->planes + to_row * lattice->view.columns + at->first_column;
        for (size_t column = 0; column < at->columns; column++)
            to[column] += formed.planes[row * at->columns + column];
    }
    free(formed.planes);
    return status;
}

/* The two lattices of one echo. Energy counts at the points of `own`, a field or energies, with the
 * other's energy there. */
struct echo_points {
    const struct peak_lattice *own, *other;
    bool own_is_field;
};

static double energy_at_point(const struct peak_lattice *lattice, bool is_field, size_t i)
{
    const double a = (double)lattice->planes[i];
    const double b = (double)lattice->planes[lattice->view.rows * lattice->view.columns + i];
    return is_field ? a * a + b * b : a;
}

/* Returns the energy between a lattice's points, linear in both directions; 0 beyond the points. */
static double energy_between(const struct peak_lattice *lattice, bool is_field, double row,
                             double column)
{
    const struct patch_view *view = &lattice->view;
    double sum = 0.0;
    if (!lattice->planes || row < 0.0 || column < 0.0 || row >= (double)view->rows - 1.0 ||
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

/* Returns the peak of the parabola through the levels of a point and its neighbours. At the
 * lattice's edge and where there is no peak, returns the point's own energy. */
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

/* Finds the peak where `own` has at least half of the peak's energy. *peak only grows. */
static void find_peak(const struct echo_points *points, double *peak, double *range_m)
{
    const struct patch_view *view = &points->own->view;
    double brightest = *peak;
    size_t at = 0;
    for (size_t i = 0; points->own->planes && i < view->rows * view->columns; i++) {
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

/* Returns the largest expected cross-section, m^2, of glints (a field, m) and rough surfaces
 * (energies, m^2) together, or 0 if there is no echo. *range_m gets its processor range. */
static double peak_of_echo(const struct peak_lattice *glint, const struct peak_lattice *rough,
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

/* Returns the pixels of the patch that an object's echo holds. */
static struct window window_of(const struct object_echo *echo, const struct echoes *echoes)
{
    const struct window at = {0, echoes->rows, echo->first_column, echo->columns};
    return at;
}

/* Marks the window's pixels in which some ray met the object. The echo lies within the response's
 * width of these, or where the response shifts it. */
static void mark_covered(struct object_echo *echo, const struct line_grid *grid,
                         const float *footprint, size_t rows)
{
    for (int32_t strip = 0; strip < grid->strips.count; strip++)
        for (int32_t bin = 0; bin < grid->bins.count; bin++) {
            if (footprint[(size_t)strip * (size_t)grid->bins.count + (size_t)bin] == 0.0f)
                continue;
            const double row = floor((double)(grid->strips.first + strip) / grid->strips_per_row);
            const double column =
                floor((double)(grid->bins.first + bin) / grid->bins_per_pixel + 0.5) -
                (double)echo->first_column;
            if (row >= 0.0 && row < (double)rows && column >= 0.0 && column < (double)echo->columns)
                echo->covered[(size_t)row * echo->columns + (size_t)column] = 1;
        }
}

/* Forms the tile's energies on a lattice. */
static sonject_status form_rough_peak(struct peak_lattice *lattice, struct tracer *tracer,
                                      const struct impulse_lines *tile)
{
    sonject_status status =
        peak_lattice_init(lattice, tracer, &tile->grid, &tile->grid, FORM_ENERGY);
    THEN(status, peak_lattice_begin(lattice, tracer, FORM_ENERGY, &tile->grid));
    THEN(status, form_lines_add(&lattice->lines, tile->strips.first - lattice->grid.strips.first,
                                tile->strips.count, impulse_lines_bins(tile),
                                tile->plane[TILE_ENERGY], NULL));
    return status == SONJECT_OK ? peak_lattice_finish(lattice) : status;
}

static sonject_status form_rough(struct echoes *echoes, struct tracer *tracer,
                                 const struct impulse_lines *tile)
{
    struct object_echo *echo = &echoes->objects[tile->number];
    struct form_lines lines;
    CHECK(form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view, &tracer->response,
                           FORM_TWO_ENERGIES, &tile->grid));
    const size_t pixels = echoes->rows * lines.at.columns;
    const size_t first = lines.at.first_row * lines.at.columns;
    echo->first_column = lines.at.first_column;
    echo->columns = lines.at.columns;
    echo->energy = allocate_array(pixels, sizeof(float));
    echo->lost = allocate_array(pixels, sizeof(float));
    echo->covered = allocate_array(pixels, 1);
    sonject_status status = echo->energy && echo->lost && echo->covered
                                ? form_lines_add(&lines, tile->strips.first, tile->strips.count,
                                                 impulse_lines_bins(tile), tile->plane[TILE_ENERGY],
                                                 tile->plane[TILE_LOST])
                                : report_out_of_memory(tracer->report, "an object's echo");
    THEN(status, form_lines_finish(&lines, echo->energy + first, echo->lost + first));
    form_lines_end(&lines);
    if (status == SONJECT_OK) {
        const struct patch_view *view = &tracer->view;
        const struct point_response *response = &tracer->response;
        const double along = cross_range_energy_width(response, view->farthest_m) +
                             cross_range_shift(response, view->farthest_m);
        const double across = range_energy_width(response) + range_shift(response);
        const struct window at = window_of(echo, echoes);
        echoes_add_window(echoes->lost_energy, echoes, echo->lost, &at);
        echo->lobe_rows = (size_t)fmax(1.0, floor(along / view->row_spacing_m));
        echo->lobe_columns = (size_t)fmax(1.0, floor(across / view->column_spacing_m));
        mark_covered(echo, &tile->grid, tile->plane[TILE_FOOTPRINT], echoes->rows);
    }
    return status;
}

static bool has_rough_part(const struct tracer *tracer, uint32_t number)
{
    const struct placed_object *object = &tracer->objects[number];
    for (uint32_t i = 0; i < object->part_count; i++)
        if (material_is_rough(&tracer->placements[object->first_part + i].material))
            return true;
    return false;
}

/* Returns whether an object's glints may lie anywhere, by way of other objects. */
static bool leads_anywhere(const struct tracer *tracer, uint32_t number)
{
    const struct placed_object *object = &tracer->objects[number];
    for (uint32_t i = 0; i < object->part_count; i++)
        if (multibounce_may_echo(tracer, object->first_part + i))
            return true;
    return false;
}

static sonject_status begin_object(struct object_former *former, struct echoes *echoes,
                                   struct tracer *tracer, const struct impulse_lines *tile)
{
    const size_t cells = line_grid_cells(&tile->grid);
    const bool is_rough = cells > 0 && has_rough_part(tracer, tile->number);
    former->is_open = true;
    former->number = tile->number;
    former->grid = tile->grid;
    if (cells > 0)
        CHECK(form_rough(echoes, tracer, tile));
    if (is_rough)
        CHECK(form_rough_peak(&former->rough_peak, tracer, tile));
    const struct object_echo *echo = &echoes->objects[tile->number];
    const bool is_anywhere = leads_anywhere(tracer, tile->number);
    former->first_column = is_anywhere ? 0 : echo->first_column;
    former->columns = is_anywhere ? echoes->columns : echo->columns;
    former->glint = allocate_array(2 * echoes->rows * former->columns, sizeof(float));
    CHECK_MEMORY(tracer->report, former->glint, "an object's glints");
    /* Brute force draws all rough echoes at once. */
    if (!is_rough || tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE)
        return SONJECT_OK;
    former->rough_energy = allocate_array(cells, sizeof(float));
    CHECK_MEMORY(tracer->report, former->rough_energy, "an object's echo");
    memcpy(former->rough_energy, tile->plane[TILE_ENERGY], cells * sizeof(float));
    return SONJECT_OK;
}

/* Adds formed pixels to the object's glint, and to the coherent part of all looks. */
static void add_glint(struct object_former *former, struct echoes *echoes,
                      const struct formed *formed)
{
    for (size_t i = 0; i < formed->count; i++) {
        const size_t column = formed->at.first_column + i % formed->at.columns;
        if (column < former->first_column || column >= former->first_column + former->columns)
            continue;
        const size_t row = formed->at.first_row + i / formed->at.columns;
        const size_t at = row * former->columns + column - former->first_column;
        former->glint[at] += formed->planes[i];
        former->glint[echoes->rows * former->columns + at] += formed->planes[formed->count + i];
    }
    const struct span rows = {(int32_t)formed->at.first_row, (int32_t)formed->at.rows};
    former->glint_rows = span_join(former->glint_rows, rows);
    if (echoes->coherent_real)
        echoes_add_field(echoes, formed, echoes->coherent_real, echoes->coherent_imaginary);
}

/* Forms lines of glints on a lattice. */
static sonject_status find_glint_peak(struct object_former *former, struct tracer *tracer,
                                      const struct impulse_lines *lines)
{
    struct peak_lattice *lattice = &former->glint_peak;
    sonject_status status = SONJECT_OK;
    if (line_grid_cells(&former->grid) == 0)
        return SONJECT_OK;
    if (!lattice->planes)
        status = peak_lattice_init(lattice, tracer, &former->grid, &lines->grid, FORM_FIELD);
    if (status == SONJECT_OK && impulse_lines_begin(lines))
        status = peak_lattice_begin(lattice, tracer, FORM_FIELD, &lines->grid);
    THEN(status, form_lines_add(&lattice->lines, lines->strips.first - lattice->grid.strips.first,
                                lines->strips.count, impulse_lines_bins(lines), lines->plane[0],
                                lines->plane[1]));
    return status == SONJECT_OK && impulse_lines_end(lines) ? peak_lattice_finish(lattice) : status;
}

static sonject_status form_glint(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines)
{
    struct formed formed;
    CHECK(find_glint_peak(former, tracer, lines));
    if (impulse_lines_begin(lines))
        CHECK(form_lines_begin(&former->lines, tracer->report, tracer->device, &tracer->view,
                               &tracer->response, FORM_GLINT, &lines->grid));
    CHECK(form_lines_add(&former->lines, lines->strips.first, lines->strips.count,
                         impulse_lines_bins(lines), lines->plane[0], lines->plane[1]));
    if (!impulse_lines_end(lines))
        return SONJECT_OK;
    const sonject_status status = form_end(&former->lines, &formed);
    if (status == SONJECT_OK) {
        echoes_add_field(echoes, &formed, echoes->target_real, echoes->target_imaginary);
        add_glint(former, echoes, &formed);
    }
    free(formed.planes);
    return status;
}

/* Adds the energy of the object's glints to that of all objects, and to the object's own echo
 * within its columns. */
static void add_glint_energy(const struct object_former *former, struct echoes *echoes)
{
    struct object_echo *echo = &echoes->objects[former->number];
    const size_t first_row = (size_t)former->glint_rows.first;
    const size_t end_row = first_row + (size_t)former->glint_rows.count;
    const float *imaginary_part = former->glint + echoes->rows * former->columns;
    for (size_t row = first_row; row < end_row; row++)
        for (size_t k = 0; k < former->columns; k++) {
            const size_t i = row * former->columns + k;
            const size_t column = former->first_column + k;
            const float energy =
                former->glint[i] * former->glint[i] + imaginary_part[i] * imaginary_part[i];
            echoes->target_energy[row * echoes->columns + column] += energy;
            if (column >= echo->first_column && column < echo->first_column + echo->columns)
                echo->energy[row * echo->columns + column - echo->first_column] += energy;
        }
}

sonject_status object_echoes_finish(struct object_former *former, struct echoes *echoes,
                                    struct tracer *tracer)
{
    if (!former->is_open)
        return SONJECT_OK;
    struct object_echo *echo = &echoes->objects[former->number];
    echo->peak_energy = peak_of_echo(&former->glint_peak, &former->rough_peak, &echo->peak_range_m);
    const struct window at = window_of(echo, echoes);
    if (echo->energy)
        echoes_add_window(echoes->target_energy, echoes, echo->energy, &at);
    add_glint_energy(former, echoes);
    if (former->rough_energy) {
        struct formed drawn;
        const sonject_status status = form_speckle(tracer, &former->grid, former->rough_energy,
                                                   STREAM_OBJECT_SPECKLE + former->number, &drawn);
        if (status == SONJECT_OK)
            echoes_add_field(echoes, &drawn, echoes->target_real, echoes->target_imaginary);
        free(drawn.planes);
        CHECK(status);
    }
    object_former_clear(former);
    return SONJECT_OK;
}

sonject_status object_echoes_add(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines)
{
    if (lines->kind != IMPULSES_OBJECT)
        return form_glint(former, echoes, tracer, lines);
    CHECK(object_echoes_finish(former, echoes, tracer));
    return begin_object(former, echoes, tracer, lines);
}

void object_former_clear(struct object_former *former)
{
    struct peak_lattice *const lattices[] = {&former->glint_peak, &former->rough_peak};
    for (int i = 0; i < 2; i++) {
        form_lines_end(&lattices[i]->lines);
        free(lattices[i]->planes);
    }
    free(former->rough_energy);
    free(former->glint);
    form_lines_end(&former->lines);
    memset(former, 0, sizeof *former);
}
