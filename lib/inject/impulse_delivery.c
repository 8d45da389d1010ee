#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/beam_shadows.h"
#include "inject/echoes.h"
#include "inject/impulse_reading.h"
#include "inject/reimaging.h"

#define CELLS_AT_A_TIME ((size_t)1 << 22)
#define SPAN_MAX        ((int64_t)1 << 28)

/* A set that is read. */
struct set_reading {
    struct impulse_file *file;
    char name[IMPULSE_GROUP_CAPACITY];
    struct impulse_lines lines;
    float *values[IMPULSE_PLANES_MAX];
};

static bool read_grid(struct impulse_file *file, const char *group, struct line_grid *grid)
{
    int32_t per_row = 0;
    int32_t per_pixel = 0;
    const bool is_done =
        impulse_file_integer(file, group, "strips_per_row", 1, SPAN_MAX, &per_row) &&
        impulse_file_integer(file, group, "bins_per_pixel", 1, SPAN_MAX, &per_pixel) &&
        impulse_file_integer(file, group, "first_strip", -SPAN_MAX, SPAN_MAX,
                             &grid->strips.first) &&
        impulse_file_integer(file, group, "strips", 0, SPAN_MAX, &grid->strips.count) &&
        impulse_file_integer(file, group, "first_bin", -SPAN_MAX, SPAN_MAX, &grid->bins.first) &&
        impulse_file_integer(file, group, "bins", 0, SPAN_MAX, &grid->bins.count);
    grid->strips_per_row = (uint32_t)per_row;
    grid->bins_per_pixel = (uint32_t)per_pixel;
    return is_done;
}

/* Whether the plane is there, and of that size. */
static bool plane_is_sound(struct set_reading *set, const char *name)
{
    static const struct region none = {0, 0, 0, 0};
    const struct line_grid *grid = &set->lines.grid;
    struct decoder_reply reply;
    return impulse_file_ask(set->file, DECODER_PLANE, set->name, name, &none, &reply, NULL) &&
           reply.layout.rows == (uint64_t)grid->strips.count &&
           reply.layout.columns == (uint64_t)grid->bins.count;
}

static void free_values(struct set_reading *set)
{
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
        free(set->values[i]);
}

/* Looks at the set of a kind and number with so many planes; a file without it leaves *is_there
 * false. */
static sonject_status open_set(struct set_reading *set, struct impulse_file *file,
                               enum impulse_kind kind, uint32_t number, uint32_t planes,
                               bool *is_there)
{
    struct decoder_reply reply;
    memset(set, 0, sizeof *set);
    set->file = file;
    set->lines.kind = kind;
    set->lines.number = number;
    set->lines.planes = planes;
    impulse_group_name(kind, number, set->name);
    if (!impulse_file_ask(file, DECODER_HAS_GROUP, set->name, "", NULL, &reply, NULL))
        return impulse_file_refuse(file, set->name, "is damaged");
    *is_there = reply.value != 0;
    if (!*is_there)
        return SONJECT_OK;
    struct line_grid *grid = &set->lines.grid;
    bool is_sound = read_grid(file, set->name, grid);
    for (uint32_t i = 0; is_sound && line_grid_cells(grid) > 0 && i < planes; i++)
        is_sound = plane_is_sound(set, impulse_plane_names(kind)[i]);
    if (!is_sound)
        return impulse_file_refuse(file, set->name, "is damaged");
    return decoder_check_announced(file->report, &file->file, (uint64_t)grid->strips.count,
                                   (uint64_t)grid->bins.count, sizeof(float));
}

/* Some strips of a plane, a piece at a time. */
static bool read_plane(struct set_reading *set, const char *name, float *values)
{
    const struct impulse_lines *lines = &set->lines;
    const uint64_t bins = (uint64_t)lines->grid.bins.count;
    const uint64_t end = (uint64_t)lines->strips.count;
    const uint64_t some = DECODER_PIECE_BYTES / sizeof(float) / bins + 1;
    bool is_done = true;
    for (uint64_t i = 0; is_done && i < end; i += some) {
        const struct region piece = {(uint64_t)(lines->strips.first - lines->grid.strips.first) + i,
                                     0, some < end - i ? some : end - i, bins};
        const size_t bytes = (size_t)(piece.rows * bins) * sizeof(float);
        struct decoder_reply reply;
        struct decoder_bytes out = {values + i * bins, bytes, 0};
        is_done =
            impulse_file_ask(set->file, DECODER_PLANE, set->name, name, &piece, &reply, &out) &&
            out.count == bytes;
    }
    return is_done;
}

static sonject_status read_strips(struct set_reading *set)
{
    bool is_done = true;
    if (line_grid_cells(&set->lines.grid) == 0)
        return SONJECT_OK;
    for (uint32_t i = 0; is_done && i < set->lines.planes; i++)
        is_done = read_plane(set, impulse_plane_names(set->lines.kind)[i], set->values[i]);
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

/* Reads a set strip by strip and hands it out. */
static sonject_status hand_out(struct set_reading *set, const struct impulse_sink *sink)
{
    struct impulse_lines *lines = &set->lines;
    const int32_t end = lines->grid.strips.first + lines->grid.strips.count;
    const int32_t most = strips_at_a_time(lines);
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
    free_values(set);
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
    const char *path = delivery->file->file.path;
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
    struct set_reading set;
    bool is_there = false;
    sonject_status status = open_set(&set, delivery->file, kind, number, planes, &is_there);
    if (status == SONJECT_OK && !is_there && is_required)
        status = impulse_file_refuse(delivery->file, set.name, "is missing");
    if (status == SONJECT_OK && is_there) {
        status = check_grid(delivery, &set);
        if (kind == IMPULSES_SEABED)
            delivery->seabed = set.lines.grid;
        else if (kind == IMPULSES_BEAM)
            delivery->beam = set.lines.grid;
    }
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
