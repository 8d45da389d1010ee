#include "inject/echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/system/process.h"
#include "trace/checkpoint.h"

#define PATTERN_FLOOR 1e-6f /* floor of the map: a black pixel's share in view must be known */

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
    const struct {
        float **plane;
        bool is_wanted;
    } planes[] = {{&echoes->seabed_energy, true},
                  {&echoes->lost_energy, true},
                  {&echoes->target_energy, true},
                  {&echoes->energy, true},
                  {&echoes->target_real, true},
                  {&echoes->target_imaginary, true},
                  {&echoes->seabed_real, wants_field},
                  {&echoes->seabed_imaginary, wants_field},
                  {&echoes->coherent_real, request->wants_coherent},
                  {&echoes->coherent_imaginary, request->wants_coherent},
                  {&echoes->level_energy, tracer->relief != NULL}};
    const size_t most = sizeof planes / sizeof *planes;
    echoes->rows = tracer->view.rows;
    echoes->columns = tracer->view.columns;
    echoes->object_count = tracer->scene->object_count;
    echoes->objects = allocate_array(echoes->object_count, sizeof *echoes->objects);
    echoes->memory = allocate_array(pixels, most * sizeof(float));
    CHECK_MEMORY(tracer->report, echoes->objects && echoes->memory, "the patch");
    float *next = echoes->memory;
    for (size_t i = 0; i < most; i++)
        if (planes[i].is_wanted) {
            *planes[i].plane = next;
            next += pixels;
        }
    if (tracer->scene->injection.order_energies)
        echoes->orders = tracer->scene->injection.interactions;
    for (uint32_t i = 0; i < echoes->orders; i++) {
        echoes->order_energy[i] = allocate_array(pixels, sizeof(float));
        CHECK_MEMORY(tracer->report, echoes->order_energy[i], "energies of each order");
    }
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
    free(echoes->memory);
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        free(echoes->order_energy[i]);
    memset(echoes, 0, sizeof *echoes);
}

sonject_status form_end(struct form_lines *lines, struct formed *formed)
{
    formed->at = lines->at;
    formed->count = lines->at.rows * lines->at.columns;
    formed->planes = allocate_array(2 * formed->count, sizeof *formed->planes);
    const sonject_status status =
        formed->planes ? form_lines_finish(lines, formed->planes, formed->planes + formed->count)
                       : report_out_of_memory(lines->report, "image formation");
    form_lines_end(lines);
    return status;
}

void echoes_add_window(float *patch, const struct echoes *echoes, const float *window,
                       const struct window *at)
{
    for (size_t row = 0; row < at->rows; row++)
        for (size_t column = 0; column < at->columns; column++)
            patch[(at->first_row + row) * echoes->columns + at->first_column + column] +=
                window[row * at->columns + column];
}

void echoes_add_field(const struct echoes *echoes, const struct formed *formed, float *real_part,
                      float *imaginary_part)
{
    echoes_add_window(real_part, echoes, formed->planes, &formed->at);
    echoes_add_window(imaginary_part, echoes, formed->planes + formed->count, &formed->at);
}

sonject_status form_speckle(struct tracer *tracer, const struct line_grid *grid,
                            const float *energy, uint32_t stream, struct formed *formed)
{
    struct form_lines lines;
    formed->planes = NULL;
    CHECK(form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view, &tracer->response,
                           FORM_FIELD, grid));
    sonject_status status = form_lines_add_speckle(&lines, grid->strips.first, grid->strips.count,
                                                   energy, tracer->scene->injection.seed, stream);
    THEN(status, form_end(&lines, formed));
    form_lines_end(&lines);
    return status;
}

/* The image formation of impulses. */
struct forming {
    struct echoes *echoes;
    struct tracer *tracer;
    const struct echo_request *request;
    struct form_lines energies, field; /* for the set that comes in */
    struct object_former object;
    float *beam_seabed; /* even seabed as pings hear it; a plane of the patch's size */
    struct line_grid chains_grid;
    float *chains; /* sum of all orders on the grid; NULL: none came in */
};

/* Forms lines of energies, one plane, by a response, as they come. After the last lines `formed`
 * (rows x columns of the view) is complete. */
static sonject_status form_energies(struct forming *forming, const struct point_response *response,
                                    const struct impulse_lines *lines, float *formed)
{
    struct tracer *tracer = forming->tracer;
    struct form_lines *energies = &forming->energies;
    sonject_status status = SONJECT_OK;
    if (impulse_lines_begin(lines))
        status = form_lines_begin(energies, tracer->report, tracer->device, &tracer->view, response,
                                  FORM_ENERGY, &lines->grid);
    THEN(status, form_lines_add(energies, lines->strips.first, lines->strips.count,
                                impulse_lines_bins(lines), lines->plane[0], NULL));
    if (status == SONJECT_OK && impulse_lines_end(lines)) {
        status = form_lines_finish_view(energies, formed, NULL);
        form_lines_end(energies);
    }
    return status;
}

/* Adds the measured complex reflectivity with the energies in view. */
static sonject_status add_coherent(struct forming *forming, const struct impulse_lines *lines)
{
    const size_t cells = (size_t)lines->strips.count * (size_t)lines->grid.bins.count;
    float *parts = coherent_seabed_lines(forming->tracer, forming->request, lines);
    CHECK_MEMORY(forming->tracer->report, parts, "the seabed");
    const sonject_status status =
        form_lines_add(&forming->field, lines->strips.first, lines->strips.count,
                       impulse_lines_bins(lines), parts, parts + cells);
    free(parts);
    return status;
}

/* Adds the seabed's energy, and its realisation where that is wanted. */
static sonject_status add_seabed(struct forming *forming, const struct impulse_lines *lines)
{
    struct tracer *tracer = forming->tracer;
    struct echoes *echoes = forming->echoes;
    struct form_lines *field = &forming->field;
    CHECK(form_energies(forming, &tracer->response, lines, echoes->seabed_energy));
    if (forming->request->field == SEABED_FIELD_NONE)
        return SONJECT_OK;
    if (impulse_lines_begin(lines))
        CHECK(form_lines_begin(field, tracer->report, tracer->device, &tracer->view,
                               &tracer->response, FORM_FIELD, &lines->grid));
    CHECK(forming->request->field == SEABED_FIELD_COHERENT
              ? add_coherent(forming, lines)
              : form_lines_add_speckle(field, lines->strips.first, lines->strips.count,
                                       lines->plane[1], tracer->scene->injection.seed,
                                       STREAM_SEABED_SPECKLE));
    if (!impulse_lines_end(lines))
        return SONJECT_OK;
    const sonject_status status =
        form_lines_finish_view(field, echoes->seabed_real, echoes->seabed_imaginary);
    form_lines_end(field);
    return status;
}

const float *seabed_map(const struct tracer *tracer, const struct echo_request *request)
{
    return tracer->relief && request->field == SEABED_FIELD_NONE ? NULL : request->map;
}

static void multiply(float *plane, const float *map, size_t rows, size_t columns,
                     size_t first_column, size_t map_columns)
{
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
            plane[row * columns + column] *=
                fmaxf(map[row * map_columns + first_column + column], PATTERN_FLOOR);
}

/* Multiplies energies that were traced with an even reflectivity by the map's pattern. */
static void set_pattern(struct echoes *echoes, const float *map)
{
    const size_t rows = echoes->rows;
    const size_t columns = echoes->columns;
    multiply(echoes->seabed_energy, map, rows, columns, 0, columns);
    multiply(echoes->lost_energy, map, rows, columns, 0, columns);
    multiply(echoes->level_energy, map, rows, columns, 0, columns);
    for (uint32_t i = 0; i < echoes->object_count; i++)
        if (echoes->objects[i].lost)
            multiply(echoes->objects[i].lost, map, rows, echoes->objects[i].columns,
                     echoes->objects[i].first_column, columns);
}

/* Adds the level seabed, after the seabed and the objects. A composite changes the measured pixels
 * by the ratio of what relief and objects leave to the level seabed. */
static sonject_status add_level(struct forming *forming, const struct impulse_lines *lines)
{
    struct echoes *echoes = forming->echoes;
    const struct echo_request *request = forming->request;
    CHECK(form_energies(forming, &forming->tracer->response, lines, echoes->level_energy));
    if (impulse_lines_end(lines) && request->map && request->field == SEABED_FIELD_NONE)
        set_pattern(echoes, request->map);
    return SONJECT_OK;
}

bool has_beam_shadows(const struct tracer *tracer)
{
    return tracer->scene->sonar.kind == SONJECT_SONAR_REAL && !tracer->relief;
}

void response_of_pings(struct point_response *response, const struct tracer *tracer)
{
    sonject_sonar_params sonar = tracer->scene->sonar;
    sonar.kind = SONJECT_SONAR_SYNTHETIC;
    sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    sonar.along_track_resolution_m = tracer->view.row_spacing_m;
    point_response_init(response, &sonar, scene_reference_speed(tracer->scene),
                        tracer->view.row_spacing_m);
}

/* Adds each ping's even seabed, after the objects. The last lines clear broadside results. */
static sonject_status add_beam(struct forming *forming, const struct impulse_lines *lines)
{
    struct echoes *echoes = forming->echoes;
    const size_t pixels = echoes->rows * echoes->columns;
    struct point_response response;
    response_of_pings(&response, forming->tracer);
    if (!forming->beam_seabed)
        forming->beam_seabed = allocate_array(pixels, sizeof(float));
    CHECK_MEMORY(forming->tracer->report, forming->beam_seabed, "the beam's shadows");
    CHECK(form_energies(forming, &response, lines, forming->beam_seabed));
    if (!impulse_lines_end(lines))
        return SONJECT_OK;
    memset(echoes->lost_energy, 0, pixels * sizeof(float));
    for (uint32_t i = 0; i < echoes->object_count; i++)
        if (echoes->objects[i].lost)
            memset(echoes->objects[i].lost, 0,
                   echoes->rows * echoes->objects[i].columns * sizeof(float));
    return SONJECT_OK;
}

/* Adds what an object hides of an even seabed. The hidden share of what the ping would hear becomes
 * the lost share of the seabed's energy. */
static sonject_status add_hidden(struct forming *forming, const struct impulse_lines *lines)
{
    struct tracer *tracer = forming->tracer;
    struct echoes *echoes = forming->echoes;
    struct object_echo *echo = &echoes->objects[lines->number];
    struct point_response response;
    struct formed hidden = {.planes = NULL};
    response_of_pings(&response, tracer);
    if (line_grid_cells(&lines->grid) == 0)
        return SONJECT_OK;
    CHECK(form_lines_begin(&forming->energies, tracer->report, tracer->device, &tracer->view,
                           &response, FORM_ENERGY, &lines->grid));
    sonject_status status =
        form_lines_add(&forming->energies, lines->strips.first, lines->strips.count,
                       impulse_lines_bins(lines), lines->plane[0], NULL);
    THEN(status, form_end(&forming->energies, &hidden));
    for (size_t i = 0; status == SONJECT_OK && i < hidden.count; i++) {
        const size_t row = hidden.at.first_row + i / hidden.at.columns;
        const size_t column = hidden.at.first_column + i % hidden.at.columns;
        const size_t pixel = row * echoes->columns + column;
        const float all = forming->beam_seabed[pixel];
        const float share = all > 0.0f ? hidden.planes[i] / all : 0.0f;
        const float lost = echoes->seabed_energy[pixel] * (share < 1.0f ? share : 1.0f);
        echoes->lost_energy[pixel] += lost;
        if (echo->lost && column >= echo->first_column &&
            column - echo->first_column < echo->columns)
            echo->lost[row * echo->columns + (column - echo->first_column)] = lost;
    }
    free(hidden.planes);
    return status;
}

static void add_plane(float *sum, const float *plane, size_t count)
{
    for (size_t i = 0; i < count; i++)
        sum[i] += plane[i];
}

/* Adds paths of several interactions, and forms order_energy where that is wanted. */
static sonject_status add_chains(struct forming *forming, const struct impulse_lines *lines)
{
    const size_t cells = line_grid_cells(&lines->grid);
    float *kept = forming->echoes->order_energy[lines->number - 1];
    if (!forming->chains) {
        forming->chains_grid = lines->grid;
        forming->chains = allocate_array(cells, sizeof(float));
    }
    CHECK_MEMORY(forming->tracer->report, forming->chains, "multiple interactions");
    if (kept)
        CHECK(form_energies(forming, &forming->tracer->response, lines, kept));
    add_plane(forming->chains, lines->plane[0], cells);
    return SONJECT_OK;
}

/* Adds paths of several interactions to target_energy and to the target's realisation. Brute force,
 * which counts all rough echoes, makes them the seabed's realisation. */
static sonject_status finish_chains(struct forming *forming, bool is_brute_force)
{
    struct echoes *echoes = forming->echoes;
    const size_t pixels = echoes->rows * echoes->columns;
    const struct line_grid *grid = &forming->chains_grid;
    const struct impulse_lines all = {IMPULSES_CHAINS,  0, *grid, grid->strips, grid->bins, 1,
                                      {forming->chains}};
    struct formed drawn = {.planes = NULL};
    float *energy = allocate_array(pixels, sizeof *energy);
    CHECK_MEMORY(forming->tracer->report, energy, "multiple interactions");
    sonject_status status = form_energies(forming, &forming->tracer->response, &all, energy);
    THEN(status,
         form_speckle(forming->tracer, grid, forming->chains, STREAM_CHAIN_SPECKLE, &drawn));
    if (status == SONJECT_OK)
        add_plane(echoes->energy, energy, pixels);
    if (status == SONJECT_OK && is_brute_force) {
        memset(echoes->seabed_real, 0, pixels * sizeof(float));
        memset(echoes->seabed_imaginary, 0, pixels * sizeof(float));
        echoes_add_field(echoes, &drawn, echoes->seabed_real, echoes->seabed_imaginary);
    } else if (status == SONJECT_OK) {
        add_plane(echoes->target_energy, energy, pixels);
        echoes_add_field(echoes, &drawn, echoes->target_real, echoes->target_imaginary);
    }
    free(energy);
    free(drawn.planes);
    return status;
}

static sonject_status add_set(struct forming *forming, const struct impulse_lines *lines)
{
    switch (lines->kind) {
    case IMPULSES_SEABED:
        return add_seabed(forming, lines);
    case IMPULSES_LEVEL:
        return add_level(forming, lines);
    case IMPULSES_OBJECT:
    case IMPULSES_GLINT:
    case IMPULSES_MULTIBOUNCE:
        return object_echoes_add(&forming->object, forming->echoes, forming->tracer, lines);
    case IMPULSES_BEAM:
        return add_beam(forming, lines);
    case IMPULSES_HIDDEN:
        return add_hidden(forming, lines);
    case IMPULSES_CHAINS:
        return add_chains(forming, lines);
    }
    return SONJECT_OK;
}

static sonject_status take(void *taker, const struct impulse_lines *lines)
{
    struct forming *forming = taker;
    const double start = clock_seconds();
    const sonject_status status = add_set(forming, lines);
    forming->echoes->form_s += clock_seconds() - start;
    return status;
}

/* Sums up one interaction: the energy of the objects' echoes and of the seabed in view. By brute
 * force the chains bring all of that again but the glints. */
static sonject_status finish(struct forming *forming)
{
    struct echoes *echoes = forming->echoes;
    const bool is_brute_force =
        forming->tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    const double start = clock_seconds();
    CHECK(object_echoes_finish(&forming->object, echoes, forming->tracer));
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++) {
        const float in_view = fmaxf(0.0f, echoes->seabed_energy[i] - echoes->lost_energy[i]);
        echoes->energy[i] = is_brute_force ? 0.0f : echoes->target_energy[i] + in_view;
    }
    if (echoes->order_energy[0] && !is_brute_force)
        memcpy(echoes->order_energy[0], echoes->energy,
               echoes->rows * echoes->columns * sizeof(float));
    const sonject_status status =
        forming->chains ? finish_chains(forming, is_brute_force) : SONJECT_OK;
    echoes->form_s += clock_seconds() - start;
    return status;
}

sonject_status echoes_form(struct echoes *echoes, struct tracer *tracer,
                           const struct echo_request *request, struct tracer *traced,
                           const struct echo_request *of_traced)
{
    struct forming forming;
    const struct impulse_sink sink = {take, &forming};
    const double start = clock_seconds();
    memset(echoes, 0, sizeof *echoes);
    memset(&forming, 0, sizeof forming);
    forming.echoes = echoes;
    forming.tracer = tracer;
    forming.request = request;
    sonject_status status = allocate_planes(echoes, tracer, request);
    /* Rays are traced here, unless a checkpoint has what they would find. */
    THEN(status, trace_impulses(traced, of_traced, &sink));
    if (status == SONJECT_OK && !checkpoint_is_cut_short(traced->checkpoint))
        status = finish(&forming);
    form_lines_end(&forming.energies);
    form_lines_end(&forming.field);
    object_former_clear(&forming.object);
    free(forming.beam_seabed);
    free(forming.chains);
    echoes->trace_s = clock_seconds() - start - echoes->form_s;
    if (status != SONJECT_OK)
        echoes_clear(echoes);
    return status;
}
