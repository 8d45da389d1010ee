#include "inject/seabed_echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/coherent_seabed.h"

#define PATTERN_FLOOR 1e-6f /* a black pixel's share in view must still be known */

sonject_status form_energies_as_they_come(struct form_lines *energies, struct tracer *tracer,
                                          const struct point_response *response,
                                          const struct impulse_lines *lines, float *formed)
{
    sonject_status status = SONJECT_OK;
    if (impulse_lines_begin(lines))
        status = form_lines_begin(energies, tracer->report, tracer->device, &tracer->view, response,
                                  FORM_ENERGY, &lines->grid);
    THEN(status,
         form_lines_add(energies, lines->strips.first, lines->strips.count, lines->plane[0], NULL));
    if (status != SONJECT_OK || !impulse_lines_end(lines))
        return status;
    status = form_lines_finish(energies, formed, NULL);
    form_lines_end(energies);
    return status;
}

/* The measured complex reflectivity with the energies that are in view. */
static sonject_status add_coherent(struct seabed_former *former, struct tracer *tracer,
                                   const struct echo_request *request,
                                   const struct impulse_lines *lines)
{
    const size_t cells = (size_t)lines->strips.count * (size_t)lines->grid.bins.count;
    free(former->in_view);
    free(former->imaginary);
    former->in_view = allocate_array(cells, sizeof(float));
    former->imaginary = allocate_array(cells, sizeof(float));
    if (!former->in_view || !former->imaginary)
        return report_out_of_memory(tracer->report, "the seabed");
    memcpy(former->in_view, lines->plane[1], cells * sizeof(float));
    coherent_seabed_lines(&lines->grid, tracer, lines->strips, request->reflectivity_real,
                          request->reflectivity_imaginary, former->in_view, former->imaginary);
    return form_lines_add(&former->field, lines->strips.first, lines->strips.count, former->in_view,
                          former->imaginary);
}

static sonject_status form_field(struct seabed_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_lines *lines)
{
    sonject_status status = SONJECT_OK;
    if (impulse_lines_begin(lines))
        status = form_lines_begin(&former->field, tracer->report, tracer->device, &tracer->view,
                                  &tracer->response, FORM_SPECKLE, &lines->grid);
    THEN(status, request->field == SEABED_FIELD_COHERENT
                     ? add_coherent(former, tracer, request, lines)
                     : form_lines_add_speckle(
                           &former->field, lines->strips.first, lines->strips.count,
                           lines->plane[1], tracer->scene->injection.seed, STREAM_SEABED_SPECKLE));
    if (status == SONJECT_OK && impulse_lines_end(lines)) {
        status = form_lines_finish(&former->field, echoes->seabed_real, echoes->seabed_imaginary);
        form_lines_end(&former->field);
    }
    return status;
}

sonject_status seabed_echoes_add(struct seabed_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_lines *lines)
{
    sonject_status status = form_energies_as_they_come(&former->energies, tracer, &tracer->response,
                                                       lines, echoes->seabed_energy);
    if (status == SONJECT_OK && request->field != SEABED_FIELD_NONE)
        status = form_field(former, echoes, tracer, request, lines);
    return status;
}

void seabed_former_clear(struct seabed_former *former)
{
    form_lines_end(&former->energies);
    form_lines_end(&former->field);
    free(former->in_view);
    free(former->imaginary);
    memset(former, 0, sizeof *former);
}

static bool is_composite(const struct echo_request *request)
{
    return request->field == SEABED_FIELD_NONE;
}

const float *seabed_map(const struct tracer *tracer, const struct echo_request *request)
{
    return tracer->relief && is_composite(request) ? NULL : request->map;
}

static void multiply(float *plane, const float *map, size_t rows, size_t columns,
                     size_t first_column, size_t map_columns)
{
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
            plane[row * columns + column] *=
                fmaxf(map[row * map_columns + first_column + column], PATTERN_FLOOR);
}

/* Gives energies that were traced with an even reflectivity the map's pattern. */
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

sonject_status level_seabed_add(struct seabed_former *former, struct echoes *echoes,
                                struct tracer *tracer, const struct echo_request *request,
                                const struct impulse_lines *lines)
{
    if (!echoes->level_energy)
        echoes->level_energy = allocate_array(echoes->rows * echoes->columns, sizeof(float));
    CHECK_MEMORY(tracer->report, echoes->level_energy, "the level seabed");
    const sonject_status status = form_energies_as_they_come(
        &former->energies, tracer, &tracer->response, lines, echoes->level_energy);
    if (status == SONJECT_OK && impulse_lines_end(lines) && request->map && is_composite(request))
        set_pattern(echoes, request->map);
    return status;
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

/* The even seabed; with its last lines, what was found from broadside is forgotten. */
static sonject_status form_seabed(struct beam_former *former, struct echoes *echoes,
                                  struct tracer *tracer, const struct point_response *response,
                                  const struct impulse_lines *lines)
{
    const size_t pixels = echoes->rows * echoes->columns;
    if (!former->seabed)
        former->seabed = allocate_array(pixels, sizeof(float));
    CHECK_MEMORY(tracer->report, former->seabed, "the beam's shadows");
    const sonject_status status =
        form_energies_as_they_come(&former->lines, tracer, response, lines, former->seabed);
    if (status != SONJECT_OK || !impulse_lines_end(lines))
        return status;
    memset(echoes->lost_energy, 0, pixels * sizeof(float));
    for (uint32_t i = 0; i < echoes->object_count; i++)
        if (echoes->objects[i].lost)
            memset(echoes->objects[i].lost, 0,
                   echoes->rows * echoes->objects[i].columns * sizeof(float));
    return SONJECT_OK;
}

/* What an object hides, on `columns` columns from first_column on: its share of what the ping would
 * hear. */
static void add_lost(const float *seabed, struct echoes *echoes, struct object_echo *echo,
                     const float *hidden, size_t first_column, size_t columns)
{
    for (size_t row = 0; row < echoes->rows; row++)
        for (size_t k = 0; k < columns; k++) {
            const size_t column = first_column + k;
            const size_t pixel = row * echoes->columns + column;
            const float all = seabed[pixel];
            const float share = all > 0.0f ? hidden[row * columns + k] / all : 0.0f;
            const float lost = echoes->seabed_energy[pixel] * (share < 1.0f ? share : 1.0f);
            echoes->lost_energy[pixel] += lost;
            if (echo->lost && column >= echo->first_column &&
                column - echo->first_column < echo->columns)
                echo->lost[row * echo->columns + (column - echo->first_column)] = lost;
        }
}

static sonject_status form_hidden(struct beam_former *former, struct echoes *echoes,
                                  struct tracer *tracer, const struct point_response *response,
                                  const struct impulse_lines *lines)
{
    if (line_grid_cells(&lines->grid) == 0)
        return SONJECT_OK;
    CHECK(form_lines_begin(&former->lines, tracer->report, tracer->device, &tracer->view, response,
                           FORM_ENERGY, &lines->grid));
    const size_t columns = former->lines.columns;
    float *hidden = allocate_array(echoes->rows * columns, sizeof *hidden);
    sonject_status status = hidden ? form_lines_add(&former->lines, lines->strips.first,
                                                    lines->strips.count, lines->plane[0], NULL)
                                   : report_out_of_memory(tracer->report, "the beam's shadows");
    THEN(status, form_lines_finish(&former->lines, hidden, NULL));
    if (status == SONJECT_OK)
        add_lost(former->seabed, echoes, &echoes->objects[lines->number], hidden,
                 former->lines.first_column, columns);
    form_lines_end(&former->lines);
    free(hidden);
    return status;
}

sonject_status beam_shadows_add(struct beam_former *former, struct echoes *echoes,
                                struct tracer *tracer, const struct impulse_lines *lines)
{
    struct point_response response;
    response_of_pings(&response, tracer);
    return lines->kind == IMPULSES_BEAM ? form_seabed(former, echoes, tracer, &response, lines)
                                        : form_hidden(former, echoes, tracer, &response, lines);
}

void beam_former_clear(struct beam_former *former)
{
    form_lines_end(&former->lines);
    free(former->seabed);
    memset(former, 0, sizeof *former);
}
