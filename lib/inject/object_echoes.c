#include "inject/object_echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Adds a window's plane into a plane of the whole patch. */
static void add_window(float *patch, size_t patch_columns, const float *window, size_t rows,
                       size_t first_column, size_t columns)
{
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
            patch[row * patch_columns + first_column + column] += window[row * columns + column];
}

/* Pixels of the window in which some ray met the object. */
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

/* Energies of the tile between pixels. */
static sonject_status form_rough_peak(struct peak_lattice *lattice, struct tracer *tracer,
                                      const struct impulse_lines *tile)
{
    sonject_status status = peak_lattice_init(lattice, tracer, &tile->grid, &tile->grid);
    THEN(status, peak_lattice_begin(lattice, tracer, FORM_ENERGY, &tile->grid));
    THEN(status, form_lines_add(&lattice->lines, tile->strips.first - lattice->grid.strips.first,
                                tile->strips.count, tile->plane[TILE_ENERGY], NULL));
    return status == SONJECT_OK ? peak_lattice_finish(lattice) : status;
}

static sonject_status form_rough(struct echoes *echoes, struct tracer *tracer,
                                 const struct impulse_lines *tile)
{
    struct object_echo *echo = &echoes->objects[tile->number];
    struct form_lines lines;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_TWO_ENERGIES, &tile->grid);
    if (status != SONJECT_OK)
        return status;
    const size_t pixels = echoes->rows * lines.columns;
    echo->first_column = lines.first_column;
    echo->columns = lines.columns;
    echo->energy = allocate_array(pixels, sizeof(float));
    echo->lost = allocate_array(pixels, sizeof(float));
    echo->covered = allocate_array(pixels, 1);
    if (!echo->energy || !echo->lost || !echo->covered)
        status = report_out_of_memory(tracer->report, "an object's echo");
    THEN(status, form_lines_add(&lines, tile->strips.first, tile->strips.count,
                                tile->plane[TILE_ENERGY], tile->plane[TILE_LOST]));
    THEN(status, form_lines_finish(&lines, echo->energy, echo->lost));
    form_lines_end(&lines);
    if (status != SONJECT_OK)
        return status;
    mark_covered(echo, &tile->grid, tile->plane[TILE_FOOTPRINT], echoes->rows);
    add_window(echoes->lost_energy, echoes->columns, echo->lost, echoes->rows, echo->first_column,
               echo->columns);
    return SONJECT_OK;
}

static bool has_rough_part(const struct tracer *tracer, uint32_t number)
{
    const struct placed_object *object = &tracer->objects[number];
    for (uint32_t i = 0; i < object->part_count; i++) {
        const sonject_material_params *material =
            tracer->placements[object->first_part + i].material;
        if (material->lambert != 0.0 || material->glossy_albedo != 0.0)
            return true;
    }
    return false;
}

/* Brute force draws all that is rough at once. */
static bool draws_rough(const struct tracer *tracer, const struct impulse_lines *tile)
{
    return tracer->scene->injection.estimator != SONJECT_ESTIMATOR_BRUTE_FORCE &&
           line_grid_cells(&tile->grid) > 0 && has_rough_part(tracer, tile->number);
}

static sonject_status begin_object(struct object_former *former, struct echoes *echoes,
                                   struct tracer *tracer, const struct impulse_lines *tile)
{
    const size_t cells = line_grid_cells(&tile->grid);
    former->is_open = true;
    former->number = tile->number;
    former->grid = tile->grid;
    sonject_status status = cells > 0 ? form_rough(echoes, tracer, tile) : SONJECT_OK;
    if (status == SONJECT_OK && cells > 0 && has_rough_part(tracer, tile->number))
        status = form_rough_peak(&former->rough_peak, tracer, tile);
    if (status != SONJECT_OK)
        return status;
    const struct object_echo *echo = &echoes->objects[tile->number];
    const size_t pixels = echo->energy ? echoes->rows * echo->columns : 0;
    former->glint_real = allocate_array(pixels, sizeof(float));
    former->glint_imaginary = allocate_array(pixels, sizeof(float));
    if (!former->glint_real || !former->glint_imaginary)
        return report_out_of_memory(tracer->report, "an object's glints");
    if (draws_rough(tracer, tile)) {
        former->rough_energy = allocate_array(cells, sizeof(float));
        CHECK_MEMORY(tracer->report, former->rough_energy, "an object's echo");
        memcpy(former->rough_energy, tile->plane[TILE_ENERGY], cells * sizeof(float));
    }
    return SONJECT_OK;
}

/* Adds a formed window to the object's glint. */
static void add_glint(struct object_former *former, const struct echoes *echoes,
                      const struct form_lines *lines, const float *real_part,
                      const float *imaginary_part)
{
    const struct object_echo *echo = &echoes->objects[former->number];
    for (size_t i = 0; i < echoes->rows * lines->columns; i++) {
        const size_t column = lines->first_column + i % lines->columns;
        if (column < echo->first_column || column >= echo->first_column + echo->columns)
            continue;
        const size_t at = i / lines->columns * echo->columns + column - echo->first_column;
        former->glint_real[at] += real_part[i];
        former->glint_imaginary[at] += imaginary_part[i];
    }
}

/* Adds formed lines to the target's field and, where it is given, to an object's glint. */
static sonject_status finish_field(struct echoes *echoes, struct form_lines *lines,
                                   struct object_former *glint)
{
    const size_t pixels = echoes->rows * lines->columns;
    float *real_part = allocate_array(pixels, sizeof(float));
    float *imaginary_part = allocate_array(pixels, sizeof(float));
    sonject_status status = real_part && imaginary_part
                                ? form_lines_finish(lines, real_part, imaginary_part)
                                : report_out_of_memory(lines->report, "an object's echo");
    if (status == SONJECT_OK) {
        add_window(echoes->target_real, echoes->columns, real_part, echoes->rows,
                   lines->first_column, lines->columns);
        add_window(echoes->target_imaginary, echoes->columns, imaginary_part, echoes->rows,
                   lines->first_column, lines->columns);
        if (glint)
            add_glint(glint, echoes, lines, real_part, imaginary_part);
        if (glint && echoes->coherent_real) {
            add_window(echoes->coherent_real, echoes->columns, real_part, echoes->rows,
                       lines->first_column, lines->columns);
            add_window(echoes->coherent_imaginary, echoes->columns, imaginary_part, echoes->rows,
                       lines->first_column, lines->columns);
        }
    }
    free(real_part);
    free(imaginary_part);
    return status;
}

/* The same lines between pixels. */
static sonject_status find_glint_peak(struct object_former *former, struct tracer *tracer,
                                      const struct impulse_lines *lines)
{
    struct peak_lattice *lattice = &former->glint_peak;
    sonject_status status = SONJECT_OK;
    if (line_grid_cells(&former->grid) == 0)
        return SONJECT_OK;
    if (!lattice->plane[0])
        status = peak_lattice_init(lattice, tracer, &former->grid, &lines->grid);
    if (status == SONJECT_OK && impulse_lines_begin(lines))
        status = peak_lattice_begin(lattice, tracer, FORM_SPECKLE, &lines->grid);
    THEN(status, form_lines_add(&lattice->lines, lines->strips.first - lattice->grid.strips.first,
                                lines->strips.count, lines->plane[0], lines->plane[1]));
    return status == SONJECT_OK && impulse_lines_end(lines) ? peak_lattice_finish(lattice) : status;
}

static sonject_status form_glint(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines)
{
    sonject_status status = find_glint_peak(former, tracer, lines);
    if (status == SONJECT_OK && impulse_lines_begin(lines))
        status = form_lines_begin(&former->lines, tracer->report, tracer->device, &tracer->view,
                                  &tracer->response, FORM_GLINT, &lines->grid);
    THEN(status, form_lines_add(&former->lines, lines->strips.first, lines->strips.count,
                                lines->plane[0], lines->plane[1]));
    if (status == SONJECT_OK && impulse_lines_end(lines)) {
        status = finish_field(echoes, &former->lines, former);
        form_lines_end(&former->lines);
    }
    return status;
}

/* The rough part's realisation. */
static sonject_status draw_rough(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer)
{
    struct form_lines lines;
    CHECK(form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view, &tracer->response,
                           FORM_SPECKLE, &former->grid));
    sonject_status status = form_lines_add_speckle(
        &lines, former->grid.strips.first, former->grid.strips.count, former->rough_energy,
        tracer->scene->injection.seed, STREAM_OBJECT_SPECKLE + former->number);
    THEN(status, finish_field(echoes, &lines, NULL));
    form_lines_end(&lines);
    return status;
}

sonject_status object_echoes_finish(struct object_former *former, struct echoes *echoes,
                                    struct tracer *tracer)
{
    if (!former->is_open)
        return SONJECT_OK;
    struct object_echo *echo = &echoes->objects[former->number];
    const size_t pixels = echo->energy ? echoes->rows * echo->columns : 0;
    echo->peak_energy = peak_of_echo(&former->glint_peak, &former->rough_peak, &echo->peak_range_m);
    for (size_t i = 0; i < pixels; i++)
        echo->energy[i] += former->glint_real[i] * former->glint_real[i] +
                           former->glint_imaginary[i] * former->glint_imaginary[i];
    const sonject_status status =
        former->rough_energy ? draw_rough(former, echoes, tracer) : SONJECT_OK;
    add_window(echoes->target_energy, echoes->columns, echo->energy,
               echo->energy ? echoes->rows : 0, echo->first_column, echo->columns);
    object_former_clear(former);
    return status;
}

sonject_status object_echoes_add(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines)
{
    if (lines->kind == IMPULSES_GLINT)
        return form_glint(former, echoes, tracer, lines);
    CHECK(object_echoes_finish(former, echoes, tracer));
    return begin_object(former, echoes, tracer, lines);
}

void object_former_clear(struct object_former *former)
{
    free(former->rough_energy);
    free(former->glint_real);
    free(former->glint_imaginary);
    form_lines_end(&former->lines);
    peak_lattice_clear(&former->glint_peak);
    peak_lattice_clear(&former->rough_peak);
    memset(former, 0, sizeof *former);
}
