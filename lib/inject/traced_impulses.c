#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "inject/echoes.h"
#include "scene/point_response.h"
#include "trace/chains.h"
#include "trace/checkpoint.h"
#include "trace/fan.h"
#include "trace/glints.h"
#include "trace/multibounce.h"
#include "trace/rough.h"

#define STRIPS_A_LAUNCH 64 /* strips; between launches the caller may cancel */

/* The state of a trace. */
struct tracing {
    struct tracer *tracer;
    const struct echo_request *request;
    const struct impulse_sink *sink;
    struct rough_trace rough;
    float *tiles;          /* the objects' tiles */
    float *chunk, *second; /* lines that are handed out */
    uint32_t regions;      /* regions of multi-bounce echoes so far */
};

static sonject_status emit(const struct tracing *tracing, const struct impulse_lines *lines)
{
    return !tracing->sink || checkpoint_is_cut_short(tracing->tracer->checkpoint)
               ? SONJECT_OK
               : tracing->sink->take(tracing->sink->taker, lines);
}

/* Returns the next strips of a grid, at most `most`; count 0 after the last. */
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

/* Subtracts the energy that objects hide from a chunk of strips. */
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

/* Finds the energy in view of a chunk's strips, whose rays have all been traced. */
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

/* Traces the seabed's echoes by the rough trace as it is now set: of the seabed itself, or again of
 * a level or even one. */
static sonject_status trace_seabed(struct tracing *tracing, enum impulse_kind kind,
                                   const char *stage)
{
    struct rough_trace *trace = &tracing->rough;
    const bool is_again = kind != IMPULSES_SEABED;
    const bool has_view = !is_again && wants_field(tracing);
    const uint64_t pings = tracing->tracer->counts.pings;
    struct impulse_lines lines = {kind,
                                  0,
                                  trace->grid,
                                  {trace->grid.strips.first, 0},
                                  trace->grid.bins,
                                  has_view ? 2 : 1,
                                  {tracing->chunk, tracing->second}};
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK &&
           (lines.strips = next_strips(&trace->grid, lines.strips, trace->chunk)).count > 0) {
        const int32_t done = lines.strips.first + lines.strips.count - trace->grid.strips.first;
        status = rough_trace_strips(trace, tracing->tracer, lines.strips, tracing->chunk);
        if (status == SONJECT_OK && has_view)
            status = find_in_view(tracing, lines.strips);
        THEN(status, emit(tracing, &lines));
        THEN(status, echo_request_tell(tracing->request, tracing->tracer->report,
                                       is_again ? ROUGH_SHARE + OBJECT_SHARE
                                                : ROUGH_SHARE * done / trace->grid.strips.count,
                                       stage));
    }
    if (is_again)
        tracing->tracer->counts.pings = pings; /* the pings are the same */
    return status;
}

static sonject_status emit_tile(const struct tracing *tracing, uint32_t number)
{
    const struct rough_tile *tile = &tracing->rough.tiles[number];
    const size_t cells = line_grid_cells(&tile->grid);
    struct impulse_lines lines = {IMPULSES_OBJECT, number,      tile->grid, tile->grid.strips,
                                  tile->grid.bins, TILE_PLANES, {NULL}};
    for (size_t i = 0; i < TILE_PLANES; i++)
        lines.plane[i] = tracing->tiles + tile->offset + i * cells;
    return emit(tracing, &lines);
}

static sonject_status trace_glints(const struct tracing *tracing, uint32_t part)
{
    struct glints glints;
    CHECK(glints_begin(&glints, tracing->tracer, part));
    const size_t chunk = line_grid_cells(&glints.grid) > 0
                             ? (size_t)glints.chunk * (size_t)glints.grid.bins.count
                             : 0;
    float *parts = allocate_array(2 * chunk, sizeof(float));
    struct impulse_lines lines = {
        IMPULSES_GLINT,   part, glints.grid,           {glints.grid.strips.first, 0},
        glints.grid.bins, 2,    {parts, parts + chunk}};
    sonject_status status =
        parts ? SONJECT_OK : report_out_of_memory(tracing->tracer->report, "glints");
    while (status == SONJECT_OK && chunk > 0 &&
           (lines.strips = next_strips(&glints.grid, lines.strips, glints.chunk)).count > 0) {
        status = glints_trace(&glints, tracing->tracer, lines.strips, parts, parts + chunk);
        THEN(status, emit(tracing, &lines));
    }
    free(parts);
    glints_end(&glints);
    return status;
}

static sonject_status emit_region(struct tracing *tracing, const struct multibounce *multibounce,
                                  const struct multibounce_region *region)
{
    const size_t most = TILE_STRIPS * (size_t)region->bins.count;
    float *parts = allocate_array(2 * most, sizeof *parts);
    CHECK_MEMORY(tracing->tracer->report, parts, "multi-bounce echoes");
    struct impulse_lines lines = {IMPULSES_MULTIBOUNCE,      tracing->regions++, multibounce->grid,
                                  {region->strips.first, 0}, region->bins,       2,
                                  {parts, parts + most}};
    lines.grid.strips = region->strips;
    lines.grid.bins = region->bins;
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK &&
           (lines.strips = next_strips(&lines.grid, lines.strips, TILE_STRIPS)).count > 0) {
        lines.bins = multibounce_bins_filled(multibounce, region, lines.strips);
        multibounce_read(multibounce, lines.strips, lines.bins, parts, parts + most);
        status = emit(tracing, &lines);
    }
    free(parts);
    return status;
}

static sonject_status trace_multibounce(struct tracing *tracing, uint32_t object)
{
    struct multibounce multibounce;
    CHECK(multibounce_begin(&multibounce, tracing->tracer, object));
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < multibounce.region_count; i++)
        status = emit_region(tracing, &multibounce, &multibounce.regions[i]);
    multibounce_end(&multibounce);
    return status;
}

static sonject_status trace_objects(struct tracing *tracing)
{
    const uint32_t count = tracing->tracer->scene->object_count;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < count; i++) {
        const struct placed_object *object = &tracing->tracer->objects[i];
        status = emit_tile(tracing, i);
        const uint32_t parts = tracer_follows(tracing->tracer, i) ? object->part_count : 0;
        for (uint32_t k = 0; status == SONJECT_OK && k < parts; k++)
            status = trace_glints(tracing, object->first_part + k);
        if (status == SONJECT_OK && parts > 0)
            status = trace_multibounce(tracing, i);
        THEN(status, echo_request_tell(tracing->request, tracing->tracer->report,
                                       ROUGH_SHARE + OBJECT_SHARE * (i + 1) / count,
                                       "tracing the objects"));
    }
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

static void tracing_clear(struct tracing *tracing)
{
    rough_trace_end(&tracing->rough);
    free(tracing->tiles);
    free(tracing->chunk);
    free(tracing->second);
}

/* Traces the even seabed that each ping hears, and the part that objects hide. */
static sonject_status trace_beam(struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_sink *sink)
{
    struct point_response response;
    struct tracing beam = {.tracer = tracer, .request = request, .sink = sink};
    response_of_pings(&response, tracer);
    CHECK(rough_trace_begin_beam(&beam.rough, tracer, &response));
    sonject_status status = allocate_chunks(&beam);
    THEN(status, trace_seabed(&beam, IMPULSES_BEAM, "tracing the beam"));
    THEN(status, rough_trace_tiles(&beam.rough, tracer, beam.tiles));
    for (uint32_t i = 0; status == SONJECT_OK && i < tracer->scene->object_count; i++) {
        const struct rough_tile *tile = &beam.rough.tiles[i];
        const float *lost = beam.tiles + tile->offset + TILE_LOST * line_grid_cells(&tile->grid);
        const struct impulse_lines lines = {IMPULSES_HIDDEN, i, tile->grid, tile->grid.strips,
                                            tile->grid.bins, 1, {lost}};
        status = emit(&beam, &lines);
    }
    tracing_clear(&beam);
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
    struct impulse_lines lines = {
        IMPULSES_CHAINS, trace->first_order, trace->grid, trace->grid.strips, trace->grid.bins, 1,
        {energy}};
    sonject_status status =
        energy ? SONJECT_OK
               : report_out_of_memory(tracing->tracer->report, "multiple interactions");
    for (uint32_t plane = 0; status == SONJECT_OK && plane < trace->orders; plane++) {
        status = chain_trace_read(trace, tracing->tracer, plane, energy);
        THEN(status, emit(tracing, &lines));
        lines.number++;
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
    struct tracing tracing = {.tracer = tracer, .request = request, .sink = sink};
    CHECK(rough_trace_begin(&tracing.rough, tracer, seabed_map(tracer, request)));
    sonject_status status = allocate_chunks(&tracing);
    THEN(status, trace_seabed(&tracing, IMPULSES_SEABED, "tracing the seabed"));
    THEN(status, rough_trace_images(&tracing.rough, tracer));
    THEN(status, rough_trace_tiles(&tracing.rough, tracer, tracing.tiles));
    THEN(status, trace_objects(&tracing));
    if (status == SONJECT_OK && has_beam_shadows(tracer))
        status = trace_beam(tracer, request, sink);
    if (status == SONJECT_OK && tracer->relief) {
        rough_trace_flatten(&tracing.rough);
        status = trace_seabed(&tracing, IMPULSES_LEVEL, "tracing the level seabed");
    }
    tracing_clear(&tracing);
    THEN(status, trace_chains(&tracing));
    return status;
}

#define EDGE_LOSS       0.02   /* largest share of energy that an edge pixel may lack */
#define EDGE_DEVIATIONS 1.4522 /* erfc(x) / 2 = EDGE_LOSS, G^2 being exp(-(r / sigma)^2) */
#define ROUNDING        1e-6

/* Returns a bandwidth in kHz. The pulse's range resolution is inverse to the bandwidth. */
static double bandwidth_for(const struct tracer *tracer, double share)
{
    return 1e-3 * tracer->scene->sonar.bandwidth_hz * share;
}

/* Checks that bins are fine enough for the tracer's pulse, and margins wide enough: a pixel at the
 * patch's edge lacks at most EDGE_LOSS. Half of what a reach omits lies on the margin's side. */
static sonject_status check_bins(const struct tracer *tracer, const struct line_grid *grid,
                                 const char *path)
{
    const struct point_response *response = &tracer->response;
    const double spacing = tracer->view.column_spacing_m;
    const double bin = spacing / grid->bins_per_pixel;
    const double margin = -grid->bins.first * bin;
    const double fine = response->range_deviation_m / line_grid_shortest_deviation(grid, spacing);
    const double reach = response->pulse_kind == SONJECT_PULSE_GAUSSIAN
                             ? EDGE_DEVIATIONS * response->range_deviation_m
                             : range_energy_reach(response, 2.0 * EDGE_LOSS);
    /* A margin that ends at range 0 holds all that any pulse reaches. */
    const double wide = tracer->view.first_range_m - margin < bin ? HUGE_VAL : margin / reach;
    if (fine >= 1.0 - ROUNDING && wide >= 1.0 - ROUNDING)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but with that pulse %s was traced for %.4g to "
                          "%.4g kHz: trace again with another bandwidth",
                          bandwidth_for(tracer, 1.0), path, bandwidth_for(tracer, 1.0 / wide),
                          bandwidth_for(tracer, fine));
}

/* Checks strips and their margins for the cross-range response. */
static sonject_status check_strips(const struct tracer *tracer, const struct line_grid *grid,
                                   const char *path)
{
    const double strip = tracer->view.row_spacing_m / grid->strips_per_row;
    const double margin = -grid->strips.first * strip;
    if (tracer->response.strip_m < strip * (1.0 - ROUNDING))
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "sonar.resolution: %g cm, but %s was traced in strips of %.4g cm: "
                              "trace again with a finer one",
                              1e2 * tracer->response.strip_m, path, 1e2 * strip);
    const double farthest = view_processor_range(&tracer->view, (double)tracer->view.columns - 1.0);
    const double reach = cross_range_energy_reach(&tracer->response, farthest, 2.0 * EDGE_LOSS);
    const bool is_moved = tracer->response.motion != NULL;
    if (reach <= margin)
        return SONJECT_OK;
    return input_failure(tracer->report, is_moved ? "sonar.motion" : "sonar.resolution",
                         "the response reaches %.4g m, but %s was traced to %.4g m beyond the "
                         "patch: trace again with %s",
                         reach, path, margin, is_moved ? "this motion" : "a coarser resolution");
}

/* Checks glints, whose bins are finer and equally wide for all parts. */
static sonject_status check_glints(const struct tracer *tracer, const struct tracer *traced,
                                   const char *path)
{
    struct line_grid grid;
    uint32_t part = 0;
    while (part < traced->part_count && !material_is_smooth(&traced->placements[part].material))
        part++;
    if (part == traced->part_count)
        return SONJECT_OK;
    glint_strips_init(&grid, traced, part);
    const double shortest = glint_shortest_deviation(&grid, tracer->view.column_spacing_m);
    if (tracer->response.range_deviation_m >= shortest * (1.0 - ROUNDING))
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but the glints of %s were traced for at most "
                          "%.4g kHz: trace again with another bandwidth",
                          bandwidth_for(tracer, 1.0), path,
                          bandwidth_for(tracer, tracer->response.range_deviation_m / shortest));
}

sonject_status check_response_fits(const struct tracer *tracer, const struct tracer *traced)
{
    const char *path = traced->checkpoint->files[0]->path;
    struct line_grid grid;
    line_grid_for_patch(&grid, &traced->view, &traced->response);
    CHECK(check_bins(tracer, &grid, path));
    CHECK(check_strips(tracer, &grid, path));
    return check_glints(tracer, traced, path);
}

void note_other_aspects(const struct tracer *tracer, const struct tracer *traced)
{
    const struct point_response *response = &tracer->response, *before = &traced->response;
    const double sine = aspects_sine(tracer), sine_before = aspects_sine(traced);
    bool is_other = fabs(sine - sine_before) > ROUNDING * sine_before;
    if (sine_before > 0.0) {
        is_other |= response->terms != before->terms;
        for (int term = 0; term < response->terms && !is_other; term++)
            is_other = response->weights[term] != before->weights[term];
    }
    if (is_other)
        report_note(tracer->report,
                    "%s: shadows and rough highlights keep the resolution and the response that "
                    "were traced: trace again for those of the new ones",
                    traced->checkpoint->files[0]->path);
}
