#include <stdlib.h>
#include <string.h>

#include "base/hdf5_values.h"
#include "base/memory.h"
#include "inject/beam_shadows.h"
#include "inject/echoes.h"
#include "inject/impulse_reading.h"
#include "inject/reimaging.h"

#define CELLS_AT_A_TIME ((size_t)1 << 22)
#define CELLS_MAX       ((uint64_t)1 << 33)
#define SPAN_MAX        ((int64_t)1 << 28)
#define INFLATION_MAX   1100 /* bytes that one byte of deflated data can stand for, and some */

/* A set that is open. */
struct set_reading {
    const struct impulse_file *file;
    char name[IMPULSE_GROUP_CAPACITY];
    struct impulse_lines lines;
    hid_t planes[IMPULSE_PLANES_MAX];
    float *values[IMPULSE_PLANES_MAX];
};

static bool read_grid(hid_t group, struct line_grid *grid)
{
    int32_t per_row = 0;
    int32_t per_pixel = 0;
    const bool is_done =
        hdf5_read_integer(group, "strips_per_row", 1, SPAN_MAX, &per_row) &&
        hdf5_read_integer(group, "bins_per_pixel", 1, SPAN_MAX, &per_pixel) &&
        hdf5_read_integer(group, "first_strip", -SPAN_MAX, SPAN_MAX, &grid->strips.first) &&
        hdf5_read_integer(group, "strips", 0, SPAN_MAX, &grid->strips.count) &&
        hdf5_read_integer(group, "first_bin", -SPAN_MAX, SPAN_MAX, &grid->bins.first) &&
        hdf5_read_integer(group, "bins", 0, SPAN_MAX, &grid->bins.count);
    grid->strips_per_row = (uint32_t)per_row;
    grid->bins_per_pixel = (uint32_t)per_pixel;
    return is_done && (uint64_t)grid->strips.count * (uint64_t)grid->bins.count <= CELLS_MAX;
}

/* 32-bit floats, strips x bins, and no more of them than the stored bytes can stand for. */
static bool plane_is_sound(hid_t plane, const struct line_grid *grid)
{
    hsize_t extent[2] = {0, 0};
    const hid_t type = H5Dget_type(plane);
    const hid_t space = H5Dget_space(plane);
    const bool is_sound =
        type >= 0 && space >= 0 && H5Tget_class(type) == H5T_FLOAT && H5Tget_size(type) == 4 &&
        H5Sget_simple_extent_ndims(space) == 2 &&
        H5Sget_simple_extent_dims(space, extent, NULL) == 2 &&
        extent[0] == (hsize_t)grid->strips.count && extent[1] == (hsize_t)grid->bins.count &&
        H5Dget_storage_size(plane) >= extent[0] * extent[1] * sizeof(float) / INFLATION_MAX;
    if (type >= 0)
        H5Tclose(type);
    if (space >= 0)
        H5Sclose(space);
    return is_sound;
}

static void close_set(struct set_reading *set)
{
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++) {
        if (set->planes[i] >= 0)
            H5Dclose(set->planes[i]);
        set->planes[i] = -1;
        free(set->values[i]);
        set->values[i] = NULL;
    }
}

/* Opens the set of a kind and number with so many planes; a file without it leaves *is_there
 * false. */
static sonject_status open_set(struct set_reading *set, const struct impulse_file *file,
                               enum impulse_kind kind, uint32_t number, uint32_t planes,
                               bool *is_there)
{
    memset(set, 0, sizeof *set);
    set->file = file;
    set->lines.kind = kind;
    set->lines.number = number;
    set->lines.planes = planes;
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
        set->planes[i] = -1;
    impulse_group_name(kind, number, set->name);
    const hid_t group = impulse_group_open(file->file, set->name);
    *is_there = group >= 0;
    if (group < 0)
        return SONJECT_OK;
    bool is_sound = read_grid(group, &set->lines.grid);
    for (uint32_t i = 0; is_sound && line_grid_cells(&set->lines.grid) > 0 && i < planes; i++) {
        const char *name = impulse_plane_names(kind)[i];
        if (H5Lexists(group, name, H5P_DEFAULT) > 0)
            set->planes[i] = H5Dopen2(group, name, H5P_DEFAULT);
        is_sound = set->planes[i] >= 0 && plane_is_sound(set->planes[i], &set->lines.grid);
    }
    H5Gclose(group);
    if (is_sound)
        return SONJECT_OK;
    close_set(set);
    return impulse_file_refuse(file, set->name, "is damaged");
}

static bool read_plane(hid_t plane, const struct impulse_lines *lines, float *values)
{
    const hsize_t first[2] = {(hsize_t)(lines->strips.first - lines->grid.strips.first), 0};
    const hsize_t count[2] = {(hsize_t)lines->strips.count, (hsize_t)lines->grid.bins.count};
    const hid_t memory = H5Screate_simple(2, count, NULL);
    const hid_t space = H5Dget_space(plane);
    const bool is_done =
        memory >= 0 && space >= 0 &&
        H5Sselect_hyperslab(space, H5S_SELECT_SET, first, NULL, count, NULL) >= 0 &&
        H5Dread(plane, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, values) >= 0;
    if (space >= 0)
        H5Sclose(space);
    if (memory >= 0)
        H5Sclose(memory);
    return is_done;
}

static sonject_status read_strips(struct set_reading *set)
{
    struct hdf5_session session;
    bool is_done = true;
    if (line_grid_cells(&set->lines.grid) == 0)
        return SONJECT_OK;
    hdf5_enter(&session);
    for (uint32_t i = 0; is_done && i < set->lines.planes; i++)
        is_done = read_plane(set->planes[i], &set->lines, set->values[i]);
    hdf5_leave(&session);
    return is_done ? SONJECT_OK : impulse_file_refuse(set->file, set->name, "is damaged");
}

/* Objects and chains come in one piece. */
static int32_t strips_at_a_time(const struct impulse_lines *lines)
{
    const size_t most = CELLS_AT_A_TIME / ((size_t)lines->grid.bins.count + 1) + 1;
    return lines->kind == IMPULSES_OBJECT || lines->kind == IMPULSES_HIDDEN ||
                   lines->kind == IMPULSES_CHAINS || (size_t)lines->grid.strips.count < most
               ? lines->grid.strips.count
               : (int32_t)most;
}

static sonject_status allocate_values(struct set_reading *set, int32_t strips)
{
    for (uint32_t i = 0; i < set->lines.planes; i++) {
        set->values[i] =
            allocate_array((size_t)strips * (size_t)set->lines.grid.bins.count, sizeof(float));
        if (!set->values[i])
            return report_out_of_memory(set->file->report, "impulses");
        set->lines.plane[i] = set->values[i];
    }
    return SONJECT_OK;
}

/* Reads an open set strip by strip, hands it out and closes it. */
static sonject_status hand_out(struct set_reading *set, const struct impulse_sink *sink)
{
    struct impulse_lines *lines = &set->lines;
    const int32_t end = lines->grid.strips.first + lines->grid.strips.count;
    const int32_t most = strips_at_a_time(lines);
    struct hdf5_session session;
    sonject_status status = allocate_values(set, most);
    lines->strips.first = lines->grid.strips.first;
    do {
        lines->strips.count = most < end - lines->strips.first ? most : end - lines->strips.first;
        if (status == SONJECT_OK)
            status = read_strips(set);
        if (status == SONJECT_OK)
            status = sink->take(sink->taker, lines);
        lines->strips.first += lines->strips.count;
    } while (status == SONJECT_OK && lines->strips.first < end);
    hdf5_enter(&session);
    close_set(set);
    hdf5_leave(&session);
    return status;
}

/* What is read for, and the grids of the seabed's and the beam's lines, which others share. */
struct delivery {
    struct impulse_file *file;
    struct tracer *tracer;
    const struct echo_request *request;
    const struct impulse_sink *sink;
    struct line_grid seabed, beam;
};

static bool span_is_inside(struct span inner, struct span outer)
{
    return inner.first >= outer.first && inner.first + inner.count <= outer.first + outer.count;
}

/* Whether tracing could have laid a set's grid, and the tracer's response can be formed on it. */
static sonject_status check_grid(const struct delivery *delivery, const struct set_reading *set)
{
    const struct line_grid *grid = &set->lines.grid;
    const struct line_grid *of =
        set->lines.kind == IMPULSES_HIDDEN ? &delivery->beam : &delivery->seabed;
    const char *path = delivery->file->path;
    bool is_possible =
        grid->strips_per_row == of->strips_per_row && grid->bins_per_pixel == of->bins_per_pixel;
    switch (set->lines.kind) {
    case IMPULSES_SEABED:
        return reimaging_check_patch(grid, delivery->tracer, path);
    case IMPULSES_GLINT:
        if (line_grid_cells(grid) > 0)
            return reimaging_check_glints(grid, delivery->tracer, path);
        is_possible = false;
        break;
    case IMPULSES_BEAM:
        return reimaging_check_beam(grid, delivery->tracer, path);
    case IMPULSES_OBJECT:
    case IMPULSES_HIDDEN:
        is_possible = is_possible &&
                      (line_grid_cells(grid) == 0 || (span_is_inside(grid->strips, of->strips) &&
                                                      span_is_inside(grid->bins, of->bins)));
        break;
    case IMPULSES_LEVEL:
    case IMPULSES_CHAINS:
        is_possible = is_possible && grid->strips.first == of->strips.first &&
                      grid->strips.count == of->strips.count &&
                      grid->bins.first == of->bins.first && grid->bins.count == of->bins.count;
    }
    return is_possible ? SONJECT_OK
                       : impulse_file_refuse(delivery->file, set->name,
                                             "has a grid that is not this scene's");
}

static sonject_status deliver_set(struct delivery *delivery, enum impulse_kind kind,
                                  uint32_t number, uint32_t planes, bool is_required)
{
    struct hdf5_session session;
    struct set_reading set;
    bool is_there = false;
    hdf5_enter(&session);
    sonject_status status = open_set(&set, delivery->file, kind, number, planes, &is_there);
    if (status == SONJECT_OK && !is_there && is_required)
        status = impulse_file_refuse(delivery->file, set.name, "is missing");
    if (status == SONJECT_OK && is_there) {
        status = check_grid(delivery, &set);
        if (status != SONJECT_OK)
            close_set(&set);
        else if (kind == IMPULSES_SEABED)
            delivery->seabed = set.lines.grid;
        else if (kind == IMPULSES_BEAM)
            delivery->beam = set.lines.grid;
    }
    hdf5_leave(&session);
    return status == SONJECT_OK && is_there ? hand_out(&set, delivery->sink) : status;
}

static sonject_status deliver_objects(struct delivery *delivery)
{
    const uint32_t count = delivery->tracer->scene->object_count;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < count; i++) {
        const struct placed_object *object = &delivery->tracer->objects[i];
        status = deliver_set(delivery, IMPULSES_OBJECT, i, 3, true);
        for (uint32_t k = 0; status == SONJECT_OK && k < object->part_count; k++)
            status = deliver_set(delivery, IMPULSES_GLINT, object->first_part + k, 2, false);
        if (status == SONJECT_OK)
            status = echo_request_tell(delivery->request, delivery->tracer->report,
                                       ROUGH_SHARE + (1.0 - ROUGH_SHARE) * (i + 1) / count,
                                       "forming the objects");
    }
    return status;
}

static sonject_status deliver_beam(struct delivery *delivery)
{
    sonject_status status = deliver_set(delivery, IMPULSES_BEAM, 0, 1, true);
    for (uint32_t i = 0; status == SONJECT_OK && i < delivery->tracer->scene->object_count; i++)
        status = deliver_set(delivery, IMPULSES_HIDDEN, i, 1, true);
    return status;
}

static sonject_status deliver_chains(struct delivery *delivery)
{
    sonject_status status = SONJECT_OK;
    for (uint32_t order = 1; status == SONJECT_OK && order <= SCENE_INTERACTIONS_MAX; order++)
        status = deliver_set(delivery, IMPULSES_CHAINS, order, 1, false);
    return status;
}

static sonject_status deliver(void *giver, struct tracer *tracer,
                              const struct echo_request *request, const struct impulse_sink *sink)
{
    const uint32_t planes = request->field == SEABED_FIELD_NONE ? 1 : 2;
    struct delivery delivery;
    memset(&delivery, 0, sizeof delivery);
    delivery.file = giver;
    delivery.tracer = tracer;
    delivery.request = request;
    delivery.sink = sink;
    sonject_sonar_params traced = tracer->scene->sonar;
    impulse_head_take_sonar(&delivery.file->head, &traced);
    sonject_status status = check_sonar(&traced, tracer->report, NULL) == SONJECT_OK
                                ? SONJECT_OK
                                : impulse_file_refuse(delivery.file, "/sonar", "is damaged");
    if (status == SONJECT_OK)
        status = deliver_set(&delivery, IMPULSES_SEABED, 0, planes, true);
    if (status == SONJECT_OK)
        status = echo_request_tell(request, tracer->report, ROUGH_SHARE, "forming the seabed");
    if (status == SONJECT_OK)
        status = deliver_objects(&delivery);
    if (status == SONJECT_OK && has_beam_shadows(tracer))
        status = deliver_beam(&delivery);
    if (status == SONJECT_OK && tracer->relief)
        status = deliver_set(&delivery, IMPULSES_LEVEL, 0, 1, true);
    if (status == SONJECT_OK)
        status = deliver_chains(&delivery);
    tracer->counts = delivery.file->head.counts;
    return status;
}

struct impulse_source impulse_file_source(struct impulse_file *file)
{
    const struct impulse_source source = {deliver, file};
    return source;
}
