#include "inject/traced_impulses.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/seabed_echoes.h"
#include "trace/chains.h"
#include "trace/checkpoint.h"
#include "trace/glints.h"
#include "trace/rough.h"

#define STRIPS_A_LAUNCH 64 /* between two looks at whether the caller cancels */

/* What tracing works with. */
struct tracing {
    struct tracer *tracer;
    const struct echo_request *request;
    const struct impulse_sink *sink;
    struct rough_trace rough;
    float *tiles;          /* the objects' */
    float *chunk, *second; /* lines that are handed out */
};

static sonject_status emit(const struct tracing *tracing, enum impulse_kind kind, uint32_t number,
                           const struct line_grid *grid, struct span strips, uint32_t planes,
                           const float *const *plane)
{
    struct impulse_lines lines;
    if (checkpoint_is_cut_short(tracing->tracer->checkpoint))
        return SONJECT_OK;
    memset(&lines, 0, sizeof lines);
    lines.kind = kind;
    lines.number = number;
    lines.grid = *grid;
    lines.strips = strips;
    lines.planes = planes;
    for (uint32_t i = 0; i < planes; i++)
        lines.plane[i] = plane[i];
    return tracing->sink->take(tracing->sink->taker, &lines);
}

/* The next strips of a grid, at most `most`; count 0 after the last. */
static struct span next_strips(const struct line_grid *grid, struct span before, int32_t most)
{
    const int32_t end = grid->strips.first + grid->strips.count;
    struct span strips = {before.first + before.count, most};
    if (strips.count > end - strips.first)
        strips.count = end - strips.first;
    return strips;
}

static bool wants_field(const struct tracing *tracing)
{
    return tracing->request->field != SEABED_FIELD_NONE;
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

/* What is left in view of the chunk's strips, whose rays have all been traced. */
static sonject_status find_in_view(struct tracing *tracing, struct span strips)
{
    const struct rough_trace *trace = &tracing->rough;
    CHECK(rough_trace_tiles(&tracing->rough, tracing->tracer, tracing->tiles));
    memcpy(tracing->second, tracing->chunk,
           (size_t)strips.count * (size_t)trace->grid.bins.count * sizeof(float));
    subtract_lost(trace, tracing->tracer->scene->object_count, tracing->tiles, strips,
                  tracing->second);
    return SONJECT_OK;
}

static sonject_status trace_seabed(struct tracing *tracing)
{
    struct rough_trace *trace = &tracing->rough;
    const float *const planes[] = {tracing->chunk, tracing->second};
    struct span strips = {trace->grid.strips.first, 0};
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK &&
           (strips = next_strips(&trace->grid, strips, trace->chunk)).count > 0) {
        status = rough_trace_strips(trace, tracing->tracer, strips, tracing->chunk);
        if (status == SONJECT_OK && wants_field(tracing))
            status = find_in_view(tracing, strips);
        THEN(status, emit(tracing, IMPULSES_SEABED, 0, &trace->grid, strips,
                          wants_field(tracing) ? 2 : 1, planes));
        THEN(status, echo_request_tell(
                         tracing->request, tracing->tracer->report,
                         ROUGH_SHARE * (strips.first + strips.count - trace->grid.strips.first) /
                             trace->grid.strips.count,
                         "tracing the seabed"));
    }
    THEN(status, rough_trace_mirrored(trace, tracing->tracer));
    THEN(status, rough_trace_tiles(trace, tracing->tracer, tracing->tiles));
    return status;
}

static sonject_status emit_tile(const struct tracing *tracing, uint32_t number)
{
    const struct rough_tile *tile = &tracing->rough.tiles[number];
    const size_t cells = line_grid_cells(&tile->grid);
    const float *planes[TILE_PLANES];
    for (size_t i = 0; i < TILE_PLANES; i++)
        planes[i] = tracing->tiles + tile->offset + i * cells;
    return emit(tracing, IMPULSES_OBJECT, number, &tile->grid, tile->grid.strips, TILE_PLANES,
                planes);
}

/* Chunks that are the same wherever the grid begins: its extent depends on echoes of corners, which
 * are not all known where another process traces some of them. */
static struct span next_glint_strips(const struct glints *glints, struct span before)
{
    const int32_t chunk = glints->chunk;
    const int32_t off = before.first + before.count - glints->traces[0].grid.strips.first;
    const int32_t rest = off % chunk < 0 ? off % chunk + chunk : off % chunk;
    return next_strips(&glints->grid, before, chunk - rest);
}

static sonject_status trace_glint_strips(const struct tracing *tracing, struct glints *glints,
                                         uint32_t part)
{
    const size_t chunk = (size_t)glints->chunk * (size_t)glints->grid.bins.count;
    float *real_part = allocate_array(chunk, sizeof(float));
    float *imaginary_part = allocate_array(chunk, sizeof(float));
    const float *const planes[] = {real_part, imaginary_part};
    struct span strips = {glints->grid.strips.first, 0};
    sonject_status status = real_part && imaginary_part
                                ? SONJECT_OK
                                : report_out_of_memory(tracing->tracer->report, "glints");
    while (status == SONJECT_OK && (strips = next_glint_strips(glints, strips)).count > 0) {
        status = glints_trace(glints, tracing->tracer, strips, real_part, imaginary_part);
        THEN(status, emit(tracing, IMPULSES_GLINT, part, &glints->grid, strips, 2, planes));
    }
    free(real_part);
    free(imaginary_part);
    return status;
}

static sonject_status trace_glints(const struct tracing *tracing, uint32_t part)
{
    struct glints glints;
    sonject_status status = glints_begin(&glints, tracing->tracer, part);
    if (status != SONJECT_OK)
        return status;
    if (line_grid_cells(&glints.grid) > 0)
        status = trace_glint_strips(tracing, &glints, part);
    glints_end(&glints);
    return status;
}

static sonject_status trace_objects(const struct tracing *tracing)
{
    const uint32_t count = tracing->tracer->scene->object_count;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < count; i++) {
        const struct placed_object *object = &tracing->tracer->objects[i];
        status = emit_tile(tracing, i);
        for (uint32_t k = 0; status == SONJECT_OK && k < object->part_count; k++)
            status = trace_glints(tracing, object->first_part + k);
        THEN(status, echo_request_tell(tracing->request, tracing->tracer->report,
                                       ROUGH_SHARE + OBJECT_SHARE * (i + 1) / count,
                                       "tracing the objects"));
    }
    return status;
}

/* What the same rays hear of a seabed that is level or even, by the rough trace as it now is. */
static sonject_status trace_again(struct tracing *tracing, enum impulse_kind kind,
                                  const char *stage)
{
    struct rough_trace *trace = &tracing->rough;
    const float *const planes[] = {tracing->chunk};
    const uint64_t pings = tracing->tracer->counts.pings;
    struct span strips = {trace->grid.strips.first, 0};
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK &&
           (strips = next_strips(&trace->grid, strips, trace->chunk)).count > 0) {
        status = rough_trace_strips(trace, tracing->tracer, strips, tracing->chunk);
        THEN(status, emit(tracing, kind, 0, &trace->grid, strips, 1, planes));
        THEN(status, echo_request_tell(tracing->request, tracing->tracer->report,
                                       ROUGH_SHARE + OBJECT_SHARE, stage));
    }
    tracing->tracer->counts.pings = pings; /* the same ones */
    return status;
}

static sonject_status allocate_chunks(struct tracing *tracing)
{
    const struct rough_trace *trace = &tracing->rough;
    const size_t chunk = (size_t)trace->chunk * (size_t)trace->grid.bins.count;
    tracing->tiles = allocate_array(trace->tile_elements, sizeof(float));
    tracing->chunk = allocate_array(chunk, sizeof(float));
    tracing->second = allocate_array(wants_field(tracing) ? chunk : 0, sizeof(float));
    return tracing->tiles && tracing->chunk && tracing->second
               ? SONJECT_OK
               : report_out_of_memory(tracing->tracer->report, "the seabed");
}

static sonject_status emit_hidden(const struct tracing *beam)
{
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < beam->tracer->scene->object_count; i++) {
        const struct rough_tile *tile = &beam->rough.tiles[i];
        const float *const planes[] = {beam->tiles + tile->offset +
                                       TILE_LOST * line_grid_cells(&tile->grid)};
        status = emit(beam, IMPULSES_HIDDEN, i, &tile->grid, tile->grid.strips, 1, planes);
    }
    return status;
}

static sonject_status trace_beam(struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_sink *sink)
{
    struct point_response response;
    struct tracing beam;
    memset(&beam, 0, sizeof beam);
    beam.tracer = tracer;
    beam.request = request;
    beam.sink = sink;
    response_of_pings(&response, tracer);
    CHECK(rough_trace_begin_beam(&beam.rough, tracer, &response));
    sonject_status status = allocate_chunks(&beam);
    THEN(status, trace_again(&beam, IMPULSES_BEAM, "tracing the beam"));
    THEN(status, rough_trace_tiles(&beam.rough, tracer, beam.tiles));
    THEN(status, emit_hidden(&beam));
    rough_trace_end(&beam.rough);
    free(beam.tiles);
    free(beam.chunk);
    free(beam.second);
    return status;
}

static sonject_status trace_fan(const struct tracing *tracing, struct chain_trace *trace,
                                uint32_t number)
{
    struct tracer *tracer = tracing->tracer;
    struct chain_fan fan;
    sonject_status status = chain_fan_init(&fan, tracer, &trace->grid, trace->has_map, number);
    const int32_t end = fan.strips.first + fan.strips.count;
    struct span strips = {fan.strips.first, STRIPS_A_LAUNCH};
    while (status == SONJECT_OK && strips.first < end) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        status = chain_trace_strips(trace, tracer, &fan, strips);
        strips.first += strips.count;
        const double done =
            (number + (double)(strips.first - fan.strips.first) / fan.strips.count) /
            chain_fan_count(tracer);
        THEN(status, echo_request_tell(tracing->request, tracer->report,
                                       ROUGH_SHARE + OBJECT_SHARE + CHAINS_SHARE * done,
                                       "tracing several interactions"));
    }
    return status;
}

static sonject_status emit_chains(const struct tracing *tracing, struct chain_trace *trace)
{
    float *energy = allocate_array(line_grid_cells(&trace->grid), sizeof *energy);
    const float *const planes[] = {energy};
    sonject_status status =
        energy ? SONJECT_OK
               : report_out_of_memory(tracing->tracer->report, "multiple interactions");
    for (uint32_t plane = 0; status == SONJECT_OK && plane < trace->planes; plane++) {
        status = chain_trace_read(trace, tracing->tracer, plane, energy);
        THEN(status, emit(tracing, IMPULSES_CHAINS, trace->first_order + plane, &trace->grid,
                          trace->grid.strips, 1, planes));
    }
    free(energy);
    return status;
}

static sonject_status trace_chains(const struct tracing *tracing)
{
    struct chain_trace trace;
    sonject_status status = chain_trace_begin(&trace, tracing->tracer, tracing->request->map);
    if (status != SONJECT_OK || trace.orders == 0)
        return status;
    for (uint32_t i = 0; status == SONJECT_OK && i < chain_fan_count(tracing->tracer); i++)
        status = trace_fan(tracing, &trace, i);
    THEN(status, emit_chains(tracing, &trace));
    chain_trace_end(&trace);
    return status;
}

sonject_status trace_impulses(struct tracer *tracer, const struct echo_request *request,
                              const struct impulse_sink *sink)
{
    struct tracing tracing;
    memset(&tracing, 0, sizeof tracing);
    tracing.tracer = tracer;
    tracing.request = request;
    tracing.sink = sink;
    CHECK(rough_trace_begin(&tracing.rough, tracer, seabed_map(tracer, request)));
    sonject_status status = allocate_chunks(&tracing);
    THEN(status, trace_seabed(&tracing));
    THEN(status, trace_objects(&tracing));
    if (status == SONJECT_OK && has_beam_shadows(tracer))
        status = trace_beam(tracer, request, sink);
    if (status == SONJECT_OK && tracer->relief) {
        rough_trace_flatten(&tracing.rough);
        status = trace_again(&tracing, IMPULSES_LEVEL, "tracing the level seabed");
    }
    rough_trace_end(&tracing.rough);
    free(tracing.tiles);
    free(tracing.chunk);
    free(tracing.second);
    THEN(status, trace_chains(&tracing));
    if (status == SONJECT_OK && tracer->checkpoint)
        status = checkpoint_finish(tracer->checkpoint, &tracer->counts);
    return status;
}

static sonject_status deliver(void *giver, struct tracer *tracer,
                              const struct echo_request *request, const struct impulse_sink *sink)
{
    (void)giver;
    return trace_impulses(tracer, request, sink);
}

struct impulse_source traced_impulses(void)
{
    const struct impulse_source source = {deliver, NULL};
    return source;
}
