/* Lines and facts as records of a file of sums. */
/* The lines of a file, in the order of tracing, for the former of an image. */
#include "inject/impulse_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "inject/echoes.h"
#include "inject/reimaging.h"
#include "inject/seabed_echoes.h"

#define SPAN_MAX ((int64_t)1 << 28)

typedef char impulse_facts_are_packed[sizeof(struct impulse_facts) == 128 ? 1 : -1];

void impulse_facts_note_sonar(struct impulse_facts *facts, const sonject_sonar_params *sonar)
{
    facts->bandwidth_hz = sonar->bandwidth_hz;
    facts->along_track_resolution_m = sonar->along_track_resolution_m;
    facts->taylor_sidelobe_db = sonar->taylor_sidelobe_db;
    facts->response_window = sonar->response_window;
    facts->taylor_terms = sonar->taylor_terms;
}

void impulse_facts_take_sonar(const struct impulse_facts *facts, sonject_sonar_params *sonar)
{
    sonar->bandwidth_hz = facts->bandwidth_hz;
    sonar->along_track_resolution_m = facts->along_track_resolution_m;
    sonar->taylor_sidelobe_db = facts->taylor_sidelobe_db;
    sonar->response_window = (uint32_t)facts->response_window;
    sonar->taylor_terms = (uint32_t)facts->taylor_terms;
}

sonject_status impulse_lines_write(void *taker, const struct impulse_lines *lines)
{
    struct sums_writer *writer = taker;
    const struct line_grid *grid = &lines->grid;
    const size_t cells = (size_t)lines->strips.count * (size_t)grid->bins.count;
    const int64_t head[LINES_HEAD_WORDS] = {
        (int64_t)lines->kind, lines->number,       grid->strips_per_row, grid->bins_per_pixel,
        grid->strips.first,   grid->strips.count,  grid->bins.first,     grid->bins.count,
        lines->strips.first,  lines->strips.count, lines->planes};
    const size_t count = LINES_HEAD_WORDS + (lines->planes * cells + 1) / 2;
    int64_t *words = allocate_array(count, sizeof *words);
    CHECK_MEMORY(writer->report, words, "impulses");
    memcpy(words, head, sizeof head);
    float *floats = (float *)(void *)(words + LINES_HEAD_WORDS);
    for (uint32_t i = 0; cells > 0 && i < lines->planes; i++)
        memcpy(floats + i * cells, lines->plane[i], cells * sizeof *floats);
    const sonject_status status = sums_writer_sums(writer, words, count);
    free(words);
    return status;
}

sonject_status impulse_file_publish(struct sums_writer *writer, const struct sums_head *head,
                                    const struct scene_source *source,
                                    const struct impulse_facts *facts, const char *image_path)
{
    struct sums_head whole = *head;
    const size_t count = sizeof *facts / sizeof(int64_t) + strlen(image_path) / sizeof(int64_t) + 1;
    int64_t *words = allocate_array(count, sizeof *words);
    CHECK_MEMORY(writer->report, words, "impulses");
    memcpy(words, facts, sizeof *facts);
    memcpy((char *)words + sizeof *facts, image_path, strlen(image_path));
    sonject_status status = sums_writer_sums(writer, words, count);
    free(words);
    whole.shard = whole.shards = whole.is_last = 1;
    whole.rays = facts->counts.rays;
    whole.queries = facts->counts.queries;
    whole.impulses = facts->counts.impulses;
    return status == SONJECT_OK ? sums_writer_publish(writer, &whole, source) : status;
}

static sonject_status read_facts(struct impulse_file *file)
{
    const struct sums_file *sums = &file->sums;
    int64_t *words;
    uint64_t count;
    if (sums->head.launches[0] != '\0' || sums->head.shards != 1)
        return report_failure(file->report, SONJECT_ERROR_INPUT,
                              "%s: a shard's sums, not what sonject trace leaves: sonject merge "
                              "forms it",
                              sums->path);
    CHECK(sums_file_record(sums, file->report, sums->head.records - 1, &words, &count));
    file->last = words;
    file->image_path = (const char *)words + sizeof file->facts;
    if (count * sizeof *words > sizeof file->facts)
        memcpy(&file->facts, words, sizeof file->facts);
    if (count * sizeof *words > sizeof file->facts &&
        ((const char *)words)[count * sizeof *words - 1] == '\0' &&
        memchr(file->facts.image_hash, '\0', sizeof file->facts.image_hash))
        return SONJECT_OK;
    return report_failure(file->report, SONJECT_ERROR_INPUT,
                          "%s: not what sonject trace leaves: trace again", sums->path);
}

sonject_status impulse_file_open(struct report *report, const char *path, struct impulse_file *file)
{
    memset(file, 0, sizeof *file);
    file->report = report;
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such file of sums; check its name", path);
    sonject_status status = sums_file_open(&file->sums, report, path);
    THEN(status, read_facts(file));
    if (status != SONJECT_OK)
        impulse_file_close(file);
    return status;
}

void impulse_file_close(struct impulse_file *file)
{
    sums_file_close(&file->sums);
    free(file->last);
    memset(file, 0, sizeof *file);
}

/* What is read for, and the grids of the seabed's and the beam's lines, which others share. */
struct delivery {
    struct impulse_file *file;
    struct tracer *tracer;
    const struct echo_request *request;
    const struct impulse_sink *sink;
    struct line_grid seabed, beam;
    uint64_t next;              /* record */
    int64_t *words;             /* of the record before it; owned; NULL: there are no more lines */
    struct impulse_lines lines; /* in them */
};

static sonject_status refuse(const struct delivery *delivery)
{
    return report_failure(delivery->tracer->report, SONJECT_ERROR_INPUT,
                          "%s: its impulses are not those of this scene: trace again",
                          delivery->file->sums.path);
}

static bool span_is_inside(struct span inner, struct span outer)
{
    return inner.first >= outer.first && inner.first + inner.count <= outer.first + outer.count;
}

/* Whether the words are lines. */
static bool parse(struct impulse_lines *lines, const int64_t *words, uint64_t count)
{
    static const int64_t lowest[LINES_HEAD_WORDS] = {0,         0, 1,         1, -SPAN_MAX, 0,
                                                     -SPAN_MAX, 0, -SPAN_MAX, 0, 1};
    static const int64_t highest[LINES_HEAD_WORDS] = {
        IMPULSE_KINDS - 1, UINT32_MAX, SPAN_MAX, SPAN_MAX, SPAN_MAX,          SPAN_MAX,
        SPAN_MAX,          SPAN_MAX,   SPAN_MAX, SPAN_MAX, IMPULSE_PLANES_MAX};
    if (count < LINES_HEAD_WORDS)
        return false;
    for (size_t i = 0; i < LINES_HEAD_WORDS; i++)
        if (words[i] < lowest[i] || words[i] > highest[i])
            return false;
    memset(lines, 0, sizeof *lines);
    lines->kind = (enum impulse_kind)words[0];
    lines->number = (uint32_t)words[1];
    lines->grid.strips_per_row = (uint32_t)words[2];
    lines->grid.bins_per_pixel = (uint32_t)words[3];
    lines->grid.strips = (struct span){(int32_t)words[4], (int32_t)words[5]};
    lines->grid.bins = (struct span){(int32_t)words[6], (int32_t)words[7]};
    lines->strips = (struct span){(int32_t)words[8], (int32_t)words[9]};
    lines->planes = (uint32_t)words[10];
    const uint64_t cells = (uint64_t)words[9] * (uint64_t)words[7];
    const float *floats = (const float *)(const void *)(words + LINES_HEAD_WORDS);
    if (count != LINES_HEAD_WORDS + (lines->planes * cells + 1) / 2)
        return false;
    for (uint32_t i = 0; i < lines->planes; i++)
        lines->plane[i] = floats + i * cells;
    return span_is_inside(lines->strips, lines->grid.strips);
}

/* The next lines; none where the facts come. */
static sonject_status read_next(struct delivery *delivery)
{
    uint64_t count;
    free(delivery->words);
    delivery->words = NULL;
    if (delivery->next + 1 >= delivery->file->sums.head.records)
        return SONJECT_OK;
    CHECK(sums_file_record(&delivery->file->sums, delivery->tracer->report, delivery->next++,
                           &delivery->words, &count));
    return parse(&delivery->lines, delivery->words, count) ? SONJECT_OK : refuse(delivery);
}

static bool grids_are_equal(const struct line_grid *a, const struct line_grid *b)
{
    return a->strips_per_row == b->strips_per_row && a->bins_per_pixel == b->bins_per_pixel &&
           a->strips.first == b->strips.first && a->strips.count == b->strips.count &&
           a->bins.first == b->bins.first && a->bins.count == b->bins.count;
}

/* Whether tracing could have laid the lines' grid, and the tracer's response can be formed on it.
 */
static sonject_status check_grid(const struct delivery *delivery)
{
    const struct impulse_lines *lines = &delivery->lines;
    const struct line_grid *grid = &lines->grid;
    const struct line_grid *of =
        lines->kind == IMPULSES_HIDDEN ? &delivery->beam : &delivery->seabed;
    const char *path = delivery->file->sums.path;
    bool is_possible = lines->strips.count == grid->strips.count; /* they come in one piece */
    switch (lines->kind) {
    case IMPULSES_SEABED:
        return reimaging_check_patch(grid, delivery->tracer, path);
    case IMPULSES_BEAM:
        return reimaging_check_beam(grid, delivery->tracer, path);
    case IMPULSES_GLINT:
        return line_grid_cells(grid) > 0 ? reimaging_check_glints(grid, delivery->tracer, path)
                                         : refuse(delivery);
    case IMPULSES_OBJECT:
    case IMPULSES_HIDDEN:
        is_possible = is_possible && grid->strips_per_row == of->strips_per_row &&
                      grid->bins_per_pixel == of->bins_per_pixel &&
                      (line_grid_cells(grid) == 0 || (span_is_inside(grid->strips, of->strips) &&
                                                      span_is_inside(grid->bins, of->bins)));
        break;
    case IMPULSES_LEVEL:
        is_possible = grids_are_equal(grid, of);
        break;
    case IMPULSES_CHAINS:
        is_possible = is_possible && grids_are_equal(grid, of);
    }
    return is_possible ? SONJECT_OK : refuse(delivery);
}

/* Hands out the lines of a set, from its first strip to its last. */
static sonject_status deliver_set(struct delivery *delivery, enum impulse_kind kind,
                                  uint32_t number, uint32_t planes, bool is_required)
{
    const struct impulse_lines *lines = &delivery->lines;
    if (!delivery->words || lines->kind != kind || lines->number != number)
        return is_required ? refuse(delivery) : SONJECT_OK;
    const struct line_grid grid = lines->grid;
    int32_t strip = grid.strips.first;
    sonject_status status = check_grid(delivery);
    if (kind == IMPULSES_SEABED)
        delivery->seabed = grid;
    else if (kind == IMPULSES_BEAM)
        delivery->beam = grid;
    do {
        if (status == SONJECT_OK &&
            (!delivery->words || lines->kind != kind || lines->number != number ||
             lines->planes != planes || lines->strips.first != strip ||
             !grids_are_equal(&lines->grid, &grid)))
            status = refuse(delivery);
        THEN(status, delivery->sink->take(delivery->sink->taker, lines));
        strip += lines->strips.count;
        THEN(status, read_next(delivery));
    } while (status == SONJECT_OK && strip < grid.strips.first + grid.strips.count);
    return status;
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
        THEN(status, echo_request_tell(delivery->request, delivery->tracer->report,
                                       ROUGH_SHARE + (1.0 - ROUGH_SHARE) * (i + 1) / count,
                                       "forming the objects"));
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
    impulse_facts_take_sonar(&delivery.file->facts, &traced);
    sonject_status status =
        check_sonar(&traced, tracer->report, NULL) == SONJECT_OK ? SONJECT_OK : refuse(&delivery);
    THEN(status, read_next(&delivery));
    THEN(status, deliver_set(&delivery, IMPULSES_SEABED, 0, planes, true));
    THEN(status, echo_request_tell(request, tracer->report, ROUGH_SHARE, "forming the seabed"));
    THEN(status, deliver_objects(&delivery));
    if (status == SONJECT_OK && has_beam_shadows(tracer))
        status = deliver_beam(&delivery);
    if (status == SONJECT_OK && tracer->relief)
        status = deliver_set(&delivery, IMPULSES_LEVEL, 0, 1, true);
    THEN(status, deliver_chains(&delivery));
    if (status == SONJECT_OK && delivery.words)
        status = refuse(&delivery);
    free(delivery.words);
    tracer->counts = delivery.file->facts.counts;
    return status;
}

struct impulse_source impulse_file_source(struct impulse_file *file)
{
    const struct impulse_source source = {deliver, file};
    return source;
}
