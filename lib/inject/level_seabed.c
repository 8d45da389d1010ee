#include "inject/level_seabed.h"

#include <math.h>

#include "base/memory.h"

#define PATTERN_FLOOR 1e-6f /* a black pixel's share in view must still be known */

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
static void take_pattern(struct echoes *echoes, const float *map)
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

sonject_status level_seabed_take(struct seabed_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_lines *lines)
{
    if (!echoes->level_energy)
        echoes->level_energy = allocate_array(echoes->rows * echoes->columns, sizeof(float));
    CHECK_MEMORY(tracer->report, echoes->level_energy, "the level seabed");
    const sonject_status status = form_energies_as_they_come(
        &former->energies, tracer, &tracer->response, lines, echoes->level_energy);
    if (status == SONJECT_OK && impulse_lines_end(lines) && request->map && is_composite(request))
        take_pattern(echoes, request->map);
    return status;
}
