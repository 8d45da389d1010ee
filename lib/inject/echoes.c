#include "inject/echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "form/form.h"
#include "inject/beam_shadows.h"
#include "inject/chain_echoes.h"
#include "inject/coherent_seabed.h"
#include "inject/level_seabed.h"
#include "trace/glints.h"
#include "trace/rough_mirrored.h"

sonject_status echo_request_tell(const struct echo_request *request, struct report *report,
                                 double fraction, const char *stage)
{
    if (request->progress && request->progress(request->user, fraction, stage))
        return report_failure(report, SONJECT_CANCELLED, "cancelled while %s", stage);
    return SONJECT_OK;
}

static sonject_status allocate_planes(struct echoes *echoes, struct tracer *tracer,
                                      const struct echo_request *request)
{
    const size_t pixels = tracer->view.rows * tracer->view.columns;
    const bool wants_field = request->field != SEABED_FIELD_NONE;
    echoes->rows = tracer->view.rows;
    echoes->columns = tracer->view.columns;
    echoes->object_count = tracer->scene->object_count;
    echoes->objects = allocate_array(echoes->object_count, sizeof *echoes->objects);
    echoes->seabed_energy = allocate_array(pixels, sizeof(float));
    echoes->lost_energy = allocate_array(pixels, sizeof(float));
    echoes->target_energy = allocate_array(pixels, sizeof(float));
    echoes->energy = allocate_array(pixels, sizeof(float));
    echoes->target_real = allocate_array(pixels, sizeof(float));
    echoes->target_imaginary = allocate_array(pixels, sizeof(float));
    echoes->seabed_real = wants_field ? allocate_array(pixels, sizeof(float)) : NULL;
    echoes->seabed_imaginary = wants_field ? allocate_array(pixels, sizeof(float)) : NULL;
    if (!echoes->objects || !echoes->seabed_energy || !echoes->lost_energy ||
        !echoes->target_energy || !echoes->energy || !echoes->target_real ||
        !echoes->target_imaginary ||
        (wants_field && (!echoes->seabed_real || !echoes->seabed_imaginary)))
        return report_out_of_memory(tracer->report, "the patch");
    return SONJECT_OK;
}

void echoes_clear(struct echoes *echoes)
{
    for (uint32_t i = 0; echoes->objects && i < echoes->object_count; i++) {
        free(echoes->objects[i].energy);
        free(echoes->objects[i].lost);
        free(echoes->objects[i].covered);
    }
    free(echoes->objects);
    free(echoes->seabed_energy);
    free(echoes->level_energy);
    free(echoes->lost_energy);
    free(echoes->target_energy);
    free(echoes->energy);
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        free(echoes->order_energy[i]);
    free(echoes->target_real);
    free(echoes->target_imaginary);
    free(echoes->seabed_real);
    free(echoes->seabed_imaginary);
    memset(echoes, 0, sizeof *echoes);
}

/* Takes what the objects hide off the energies of a chunk of strips. */
static void subtract_lost(const struct rough_trace *trace, uint32_t objects, const float *tiles,
                          struct span strips, float *energy)
{
    for (uint32_t i = 0; i < objects; i++) {
        const struct rough_tile *tile = &trace->tiles[i];
        const size_t width = (size_t)tile->grid.bins.count;
        const float *lost =
            tiles + tile->offset + TILE_LOST * width * (size_t)tile->grid.strips.count;
        for (int32_t row = 0; row < tile->grid.strips.count; row++) {
            const int32_t strip = tile->grid.strips.first + row - strips.first;
            if (strip < 0 || strip >= strips.count)
                continue;
            float *line = energy + (size_t)strip * (size_t)trace->grid.bins.count +
                          (tile->grid.bins.first - trace->grid.bins.first);
            for (size_t bin = 0; bin < width; bin++)
                line[bin] = fmaxf(0.0f, line[bin] - lost[(size_t)row * width + bin]);
        }
    }
}

struct seabed_work {
    struct rough_trace *trace;
    struct form_lines energy_lines, field_lines;
    float *chunk, *chunk_imaginary; /* energies, or the coherent field, of some strips */
    float *tiles;
};

/* Adds a chunk of strips to the seabed's realisation. */
static sonject_status add_seabed_field(struct seabed_work *work, struct tracer *tracer,
                                       const struct echo_request *request, struct span strips)
{
    const sonject_status status = rough_trace_tiles(work->trace, tracer, work->tiles);
    if (status != SONJECT_OK)
        return status;
    subtract_lost(work->trace, tracer->scene->object_count, work->tiles, strips, work->chunk);
    if (request->field == SEABED_FIELD_SPECKLE)
        return form_lines_add_speckle(&work->field_lines, strips.first, strips.count, work->chunk,
                                      tracer->scene->injection.seed, STREAM_SEABED_SPECKLE);
    coherent_seabed_lines(work->trace, tracer, strips, request->reflectivity_real,
                          request->reflectivity_imaginary, work->chunk, work->chunk_imaginary);
    return form_lines_add(&work->field_lines, strips.first, strips.count, work->chunk,
                          work->chunk_imaginary);
}

static sonject_status trace_chunks(struct seabed_work *work, struct echoes *echoes,
                                   struct tracer *tracer, const struct echo_request *request)
{
    struct rough_trace *trace = work->trace;
    const int32_t end = trace->grid.strips.first + trace->grid.strips.count;
    struct span strips = {trace->grid.strips.first, rough_trace_chunk(trace)};
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK && strips.first < end) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        const double start = clock_seconds();
        status = rough_trace_strips(trace, tracer, strips, work->chunk);
        const double traced = clock_seconds();
        echoes->trace_s += traced - start;
        if (status == SONJECT_OK)
            status =
                form_lines_add(&work->energy_lines, strips.first, strips.count, work->chunk, NULL);
        if (status == SONJECT_OK && request->field != SEABED_FIELD_NONE)
            status = add_seabed_field(work, tracer, request, strips);
        echoes->form_s += clock_seconds() - traced;
        strips.first += strips.count;
        if (status == SONJECT_OK)
            status = echo_request_tell(request, tracer->report,
                                       ROUGH_SHARE * (strips.first - trace->grid.strips.first) /
                                           trace->grid.strips.count,
                                       "tracing the seabed");
    }
    return status;
}

/* Energies (and realisation) of the seabed; leaves the objects' tiles in `tiles`. */
static sonject_status compute_seabed(struct echoes *echoes, struct tracer *tracer,
                                     const struct echo_request *request, struct rough_trace *trace,
                                     float *tiles)
{
    struct seabed_work work;
    memset(&work, 0, sizeof work);
    work.trace = trace;
    work.tiles = tiles;
    const size_t chunk = (size_t)rough_trace_chunk(trace) * (size_t)trace->grid.bins.count;
    const bool wants_field = request->field != SEABED_FIELD_NONE;
    float *unused = allocate_array(echoes->rows * echoes->columns, sizeof *unused);
    work.chunk = allocate_array(chunk, sizeof(float));
    work.chunk_imaginary = allocate_array(wants_field ? chunk : 0, sizeof(float));
    sonject_status status = unused && work.chunk && work.chunk_imaginary
                                ? SONJECT_OK
                                : report_out_of_memory(tracer->report, "the seabed");
    if (status == SONJECT_OK)
        status = form_lines_begin(&work.energy_lines, tracer->report, tracer->device, &tracer->view,
                                  &tracer->response, FORM_ENERGY, &trace->grid);
    if (status == SONJECT_OK && wants_field)
        status = form_lines_begin(&work.field_lines, tracer->report, tracer->device, &tracer->view,
                                  &tracer->response, FORM_SPECKLE, &trace->grid);
    if (status == SONJECT_OK)
        status = trace_chunks(&work, echoes, tracer, request);
    double start = clock_seconds();
    if (status == SONJECT_OK)
        status = rough_trace_mirrored(trace, tracer);
    echoes->trace_s += clock_seconds() - start;
    start = clock_seconds();
    if (status == SONJECT_OK)
        status = form_lines_finish(&work.energy_lines, echoes->seabed_energy, unused);
    if (status == SONJECT_OK && wants_field)
        status =
            form_lines_finish(&work.field_lines, echoes->seabed_real, echoes->seabed_imaginary);
    if (status == SONJECT_OK)
        status = rough_trace_tiles(trace, tracer, tiles);
    echoes->form_s += clock_seconds() - start;
    form_lines_end(&work.energy_lines);
    form_lines_end(&work.field_lines);
    free(work.chunk);
    free(work.chunk_imaginary);
    free(unused);
    return status;
}

/* Adds a window's plane into a plane of the whole patch. */
static void add_window(float *patch, size_t patch_columns, const float *window, size_t rows,
                       size_t first_column, size_t columns)
{
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
            patch[row * patch_columns + first_column + column] += window[row * columns + column];
}

/* Pixels of the window in which some ray met the object. */
static void mark_covered(struct object_echo *echo, const struct rough_trace *trace,
                         const struct rough_tile *tile, const float *footprint, size_t rows)
{
    for (int32_t strip = 0; strip < tile->grid.strips.count; strip++)
        for (int32_t bin = 0; bin < tile->grid.bins.count; bin++) {
            if (footprint[(size_t)strip * (size_t)tile->grid.bins.count + (size_t)bin] == 0.0f)
                continue;
            const double row =
                floor((double)(tile->grid.strips.first + strip) / trace->grid.strips_per_row);
            const double column =
                floor((double)(tile->grid.bins.first + bin) / trace->grid.bins_per_pixel + 0.5) -
                (double)echo->first_column;
            if (row >= 0.0 && row < (double)rows && column >= 0.0 && column < (double)echo->columns)
                echo->covered[(size_t)row * echo->columns + (size_t)column] = 1;
        }
}

static sonject_status form_rough_object(struct echoes *echoes, struct tracer *tracer,
                                        const struct rough_trace *trace, const float *tiles,
                                        uint32_t number)
{
    struct object_echo *echo = &echoes->objects[number];
    const struct rough_tile *tile = &trace->tiles[number];
    const size_t plane = line_grid_cells(&tile->grid);
    const float *energy = tiles + tile->offset + TILE_ENERGY * plane;
    const float *footprint = tiles + tile->offset + TILE_FOOTPRINT * plane;
    const float *lost = tiles + tile->offset + TILE_LOST * plane;
    struct form_lines lines;
    if (plane == 0)
        return SONJECT_OK;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_ENERGY, &tile->grid);
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
    if (status == SONJECT_OK)
        status =
            form_lines_add(&lines, tile->grid.strips.first, tile->grid.strips.count, energy, lost);
    if (status == SONJECT_OK)
        status = form_lines_finish(&lines, echo->energy, echo->lost);
    form_lines_end(&lines);
    if (status != SONJECT_OK)
        return status;
    mark_covered(echo, trace, tile, footprint, echoes->rows);
    add_window(echoes->lost_energy, echoes->columns, echo->lost, echoes->rows, echo->first_column,
               echo->columns);
    return SONJECT_OK;
}

/* The glints of an object's parts, which interfere, over the columns of its echo. */
struct object_glint {
    float *real_part, *imaginary_part;
};

/* Adds a formed window to the target's field and, where it is given, to an object's glint. */
static sonject_status finish_field(struct echoes *echoes, struct form_lines *lines,
                                   const struct object_echo *echo, struct object_glint *glint)
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
        for (size_t i = 0; glint && i < pixels; i++) {
            const size_t column = lines->first_column + i % lines->columns;
            if (column < echo->first_column || column >= echo->first_column + echo->columns)
                continue;
            const size_t at = i / lines->columns * echo->columns + column - echo->first_column;
            glint->real_part[at] += real_part[i];
            glint->imaginary_part[at] += imaginary_part[i];
        }
    }
    free(real_part);
    free(imaginary_part);
    return status;
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

/* The rough part's realisation. */
static sonject_status draw_rough_object(struct echoes *echoes, struct tracer *tracer,
                                        const struct rough_trace *trace, const float *tiles,
                                        uint32_t number)
{
    const struct rough_tile *tile = &trace->tiles[number];
    struct form_lines lines;
    if (tile->grid.bins.count == 0 || !has_rough_part(tracer, number))
        return SONJECT_OK;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_SPECKLE, &tile->grid);
    if (status != SONJECT_OK)
        return status;
    status = form_lines_add_speckle(&lines, tile->grid.strips.first, tile->grid.strips.count,
                                    tiles + tile->offset, tracer->scene->injection.seed,
                                    STREAM_OBJECT_SPECKLE + number);
    if (status == SONJECT_OK)
        status = finish_field(echoes, &lines, NULL, NULL);
    form_lines_end(&lines);
    return status;
}

static sonject_status trace_glints(struct echoes *echoes, struct tracer *tracer,
                                   struct glints *glints, struct form_lines *lines)
{
    const size_t chunk = (size_t)glints_chunk(glints) * (size_t)glints->grid.bins.count;
    float *real_part = allocate_array(chunk, sizeof(float));
    float *imaginary_part = allocate_array(chunk, sizeof(float));
    sonject_status status =
        real_part && imaginary_part ? SONJECT_OK : report_out_of_memory(tracer->report, "glints");
    const int32_t end = glints->grid.strips.first + glints->grid.strips.count;
    struct span strips = {glints->grid.strips.first, glints_chunk(glints)};
    while (status == SONJECT_OK && strips.first < end) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        const double start = clock_seconds();
        status = glints_trace(glints, tracer, strips, real_part, imaginary_part);
        const double traced = clock_seconds();
        echoes->trace_s += traced - start;
        if (status == SONJECT_OK)
            status = form_lines_add(lines, strips.first, strips.count, real_part, imaginary_part);
        echoes->form_s += clock_seconds() - traced;
        strips.first += strips.count;
    }
    free(real_part);
    free(imaginary_part);
    return status;
}

static sonject_status compute_part_glints(struct echoes *echoes, struct tracer *tracer,
                                          uint32_t part, struct object_glint *glint)
{
    const struct object_echo *echo = &echoes->objects[tracer->placements[part].object];
    struct glints glints;
    struct form_lines lines;
    sonject_status status = glints_begin(&glints, tracer, part);
    if (status != SONJECT_OK)
        return status;
    if (glints.grid.strips.count > 0) {
        status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                  &tracer->response, FORM_GLINT, &glints.grid);
        if (status == SONJECT_OK) {
            status = trace_glints(echoes, tracer, &glints, &lines);
            if (status == SONJECT_OK)
                status = finish_field(echoes, &lines, echo, glint);
            form_lines_end(&lines);
        }
    }
    glints_end(&glints);
    return status;
}

static sonject_status compute_glints(struct echoes *echoes, struct tracer *tracer, uint32_t number)
{
    const struct placed_object *object = &tracer->objects[number];
    struct object_echo *echo = &echoes->objects[number];
    const size_t pixels = echo->energy ? echoes->rows * echo->columns : 0;
    struct object_glint glint = {allocate_array(pixels, sizeof(float)),
                                 allocate_array(pixels, sizeof(float))};
    sonject_status status = glint.real_part && glint.imaginary_part
                                ? SONJECT_OK
                                : report_out_of_memory(tracer->report, "an object's glints");
    for (uint32_t i = 0; status == SONJECT_OK && i < object->part_count; i++)
        status = compute_part_glints(echoes, tracer, object->first_part + i, &glint);
    for (size_t i = 0; status == SONJECT_OK && i < pixels; i++)
        echo->energy[i] += glint.real_part[i] * glint.real_part[i] +
                           glint.imaginary_part[i] * glint.imaginary_part[i];
    free(glint.real_part);
    free(glint.imaginary_part);
    return status;
}

static sonject_status compute_objects(struct echoes *echoes, struct tracer *tracer,
                                      const struct echo_request *request,
                                      const struct rough_trace *trace, const float *tiles)
{
    const bool is_brute_force = tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < echoes->object_count; i++) {
        const double start = clock_seconds();
        const double traced_before = echoes->trace_s;
        const double formed_before = echoes->form_s;
        status = form_rough_object(echoes, tracer, trace, tiles, i);
        if (status == SONJECT_OK)
            status = compute_glints(echoes, tracer, i);
        /* brute force draws all that is rough at once */
        if (status == SONJECT_OK && !is_brute_force)
            status = draw_rough_object(echoes, tracer, trace, tiles, i);
        echoes->form_s =
            formed_before + (clock_seconds() - start - (echoes->trace_s - traced_before));
        if (status == SONJECT_OK) {
            const struct object_echo *echo = &echoes->objects[i];
            add_window(echoes->target_energy, echoes->columns, echo->energy,
                       echo->energy ? echoes->rows : 0, echo->first_column, echo->columns);
            status = echo_request_tell(request, tracer->report,
                                       ROUGH_SHARE + OBJECT_SHARE * (i + 1) / echoes->object_count,
                                       "tracing the objects");
        }
    }
    return status;
}

sonject_status echoes_compute(struct echoes *echoes, struct tracer *tracer,
                              const struct echo_request *request)
{
    memset(echoes, 0, sizeof *echoes);
    struct rough_trace trace;
    sonject_status status = allocate_planes(echoes, tracer, request);
    if (status == SONJECT_OK)
        status = rough_trace_begin(&trace, tracer, seabed_map(tracer, request));
    if (status == SONJECT_OK) {
        float *tiles = allocate_array(trace.tile_elements, sizeof *tiles);
        status = tiles ? SONJECT_OK : report_out_of_memory(tracer->report, "the objects' echoes");
        if (status == SONJECT_OK)
            status = compute_seabed(echoes, tracer, request, &trace, tiles);
        if (status == SONJECT_OK)
            status = compute_objects(echoes, tracer, request, &trace, tiles);
        if (status == SONJECT_OK)
            status = beam_shadows_compute(echoes, tracer, request);
        if (status == SONJECT_OK && tracer->relief)
            status = level_seabed_compute(echoes, tracer, request, &trace);
        if (status == SONJECT_OK)
            status = chain_echoes_compute(echoes, tracer, request);
        free(tiles);
        rough_trace_end(&trace);
    }
    if (status != SONJECT_OK)
        echoes_clear(echoes);
    return status;
}
