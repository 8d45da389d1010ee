/* Lines and facts as records of a file of sums; and whether impulses that were traced for one pulse
 * and cross-range response give an image with another. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "inject/echoes.h"
#include "scene/point_response.h"
#include "schema/keys.h"
#include "trace/glints.h"

#define EDGE_LOSS         0.02   /* of an edge pixel's energy, which half its margin lacks */
#define EDGE_DEVIATIONS   1.4522 /* erfc(x) / 2 = EDGE_LOSS, G^2 being exp(-(r / sigma)^2) */
#define ROUNDING          1e-6
#define CELLS_A_PIXEL_MAX 4096
#define SPAN_MAX          ((int64_t)1 << 28)

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
    const size_t bytes = count * sizeof *words;
    file->last = words;
    file->image_path = (const char *)words + sizeof file->facts;
    if (bytes > sizeof file->facts)
        memcpy(&file->facts, words, sizeof file->facts);
    if (bytes > sizeof file->facts && ((const char *)words)[bytes - 1] == '\0' &&
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
    const char *path; /* of it */
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
                          delivery->path);
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

/* The pulse's range resolution is inverse to the bandwidth. */
static double bandwidth_for(const struct tracer *tracer, double share)
{
    return 1e-3 * tracer->scene->sonar.bandwidth_hz * share;
}

/* Bins fine enough for the tracer's pulse, and margins so wide that a pixel at the patch's edge
 * lacks at most EDGE_LOSS of its energy. Half of what is not within the margin lies beyond it. */
static sonject_status check_bins(const struct delivery *delivery)
{
    const struct tracer *tracer = delivery->tracer;
    const struct point_response *response = &tracer->response;
    const struct line_grid *grid = &delivery->lines.grid;
    const double spacing = tracer->view.column_spacing_m;
    const double bin = spacing / grid->bins_per_pixel;
    const double margin = -grid->bins.first * bin;
    const double fine = response->range_deviation_m / line_grid_shortest_deviation(grid, spacing);
    const double reach = response->pulse_kind == SONJECT_PULSE_GAUSSIAN
                             ? EDGE_DEVIATIONS * response->range_deviation_m
                             : range_energy_reach(response, 2.0 * EDGE_LOSS);
    /* a margin that ends at range 0 holds all that any pulse reaches */
    const double wide = tracer->view.first_range_m - margin < bin ? HUGE_VAL : margin / reach;
    if (fine >= 1.0 - ROUNDING && wide >= 1.0 - ROUNDING)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but with that pulse %s was traced for %.4g to "
                          "%.4g kHz: trace again with another bandwidth",
                          bandwidth_for(tracer, 1.0), delivery->path,
                          bandwidth_for(tracer, 1.0 / wide), bandwidth_for(tracer, fine));
}

/* The same of strips and the cross-range response. */
static sonject_status check_strips(const struct delivery *delivery)
{
    const struct tracer *tracer = delivery->tracer;
    const struct line_grid *grid = &delivery->lines.grid;
    const double strip = tracer->view.row_spacing_m / grid->strips_per_row;
    const double margin = -grid->strips.first * strip;
    if (tracer->response.strip_m < strip * (1.0 - ROUNDING))
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "sonar.resolution: %g cm, but %s was traced in strips of %.4g cm: "
                              "trace again with a finer one",
                              1e2 * tracer->response.strip_m, delivery->path, 1e2 * strip);
    const double farthest = view_processor_range(&tracer->view, (double)tracer->view.columns - 1.0);
    const double reach = cross_range_energy_reach(&tracer->response, farthest, 2.0 * EDGE_LOSS);
    const bool is_moved = tracer->response.motion != NULL;
    if (reach <= margin)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "%s: the response reaches %.4g m, but %s was traced to %.4g m beyond the "
                          "patch: trace again with %s",
                          is_moved ? "sonar.motion" : "sonar.resolution", reach, delivery->path,
                          margin, is_moved ? "this motion" : "a coarser resolution");
}

/* Of a part's glints, whose bins are finer. */
static sonject_status check_glints(const struct delivery *delivery)
{
    const struct tracer *tracer = delivery->tracer;
    const double shortest =
        glint_shortest_deviation(&delivery->lines.grid, tracer->view.column_spacing_m);
    if (tracer->response.range_deviation_m >= shortest * (1.0 - ROUNDING))
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but the glints of %s were traced for at most "
                          "%.4g kHz: trace again with another bandwidth",
                          bandwidth_for(tracer, 1.0), delivery->path,
                          bandwidth_for(tracer, tracer->response.range_deviation_m / shortest));
}

/* A span that begins at or before the first of `count` and ends at or behind the last. */
static bool span_holds(struct span span, double count)
{
    return span.first <= 0 && (double)span.first + span.count >= count;
}

/* Whether tracing could have laid the lines' grid, and the tracer's response can be formed on it.
 */
static sonject_status check_grid(const struct delivery *delivery)
{
    const struct impulse_lines *lines = &delivery->lines;
    const struct line_grid *grid = &lines->grid;
    const struct line_grid *of =
        lines->kind == IMPULSES_HIDDEN ? &delivery->beam : &delivery->seabed;
    const struct patch_view *view = &delivery->tracer->view;
    bool is_possible = lines->strips.count == grid->strips.count; /* they come in one piece */
    if (grid->strips_per_row > CELLS_A_PIXEL_MAX || grid->bins_per_pixel > CELLS_A_PIXEL_MAX)
        return report_failure(delivery->tracer->report, SONJECT_ERROR_INPUT,
                              "%s: is damaged: its grids are finer than tracing lays them",
                              delivery->path);
    switch (lines->kind) {
    case IMPULSES_SEABED:
    case IMPULSES_BEAM:
        if (!span_holds(grid->strips, (double)view->rows * grid->strips_per_row) ||
            !span_holds(grid->bins, (double)(view->columns - 1) * grid->bins_per_pixel + 1.0))
            return report_failure(delivery->tracer->report, SONJECT_ERROR_INPUT,
                                  "%s: is damaged: its seabed is not that of the patch",
                                  delivery->path);
        if (lines->kind == IMPULSES_BEAM) /* lines of single pings, not spread along the track */
            return SONJECT_OK;
        CHECK(check_bins(delivery));
        return check_strips(delivery);
    case IMPULSES_GLINT:
        return line_grid_cells(grid) > 0 ? check_glints(delivery) : refuse(delivery);
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
    const int32_t end = grid.strips.first + grid.strips.count;
    CHECK(check_grid(delivery));
    if (kind == IMPULSES_SEABED)
        delivery->seabed = grid;
    else if (kind == IMPULSES_BEAM)
        delivery->beam = grid;
    for (int32_t strip = grid.strips.first; true;) {
        if (!delivery->words || lines->kind != kind || lines->number != number ||
            lines->planes != planes || lines->strips.first != strip ||
            !grids_are_equal(&lines->grid, &grid))
            return refuse(delivery);
        CHECK(delivery->sink->take(delivery->sink->taker, lines));
        strip += lines->strips.count;
        CHECK(read_next(delivery));
        if (strip >= end)
            return SONJECT_OK;
    }
}

static sonject_status deliver_objects(struct delivery *delivery)
{
    const uint32_t count = delivery->tracer->scene->object_count;
    for (uint32_t i = 0; i < count; i++) {
        const struct placed_object *object = &delivery->tracer->objects[i];
        CHECK(deliver_set(delivery, IMPULSES_OBJECT, i, 3, true));
        for (uint32_t k = 0; k < object->part_count; k++)
            CHECK(deliver_set(delivery, IMPULSES_GLINT, object->first_part + k, 2, false));
        CHECK(echo_request_tell(delivery->request, delivery->tracer->report,
                                ROUGH_SHARE + (1.0 - ROUGH_SHARE) * (i + 1) / count,
                                "forming the objects"));
    }
    return SONJECT_OK;
}

static sonject_status deliver_all(struct delivery *delivery)
{
    struct tracer *tracer = delivery->tracer;
    const uint32_t planes = delivery->request->field == SEABED_FIELD_NONE ? 1 : 2;
    sonject_sonar_params traced = tracer->scene->sonar;
    impulse_facts_take_sonar(&delivery->file->facts, &traced);
    if (section_check(&sonar_section, &traced, tracer->report, NULL) != SONJECT_OK)
        return refuse(delivery);
    CHECK(read_next(delivery));
    CHECK(deliver_set(delivery, IMPULSES_SEABED, 0, planes, true));
    CHECK(echo_request_tell(delivery->request, tracer->report, ROUGH_SHARE, "forming the seabed"));
    CHECK(deliver_objects(delivery));
    if (has_beam_shadows(tracer))
        CHECK(deliver_set(delivery, IMPULSES_BEAM, 0, 1, true));
    for (uint32_t i = 0; has_beam_shadows(tracer) && i < tracer->scene->object_count; i++)
        CHECK(deliver_set(delivery, IMPULSES_HIDDEN, i, 1, true));
    if (tracer->relief)
        CHECK(deliver_set(delivery, IMPULSES_LEVEL, 0, 1, true));
    for (uint32_t order = 1; order <= SCENE_INTERACTIONS_MAX; order++)
        CHECK(deliver_set(delivery, IMPULSES_CHAINS, order, 1, false));
    return delivery->words ? refuse(delivery) : SONJECT_OK;
}

static sonject_status deliver(void *giver, struct tracer *tracer,
                              const struct echo_request *request, const struct impulse_sink *sink)
{
    struct delivery delivery = {.file = giver, .tracer = tracer, .request = request, .sink = sink};
    delivery.path = delivery.file->sums.path;
    const sonject_status status = deliver_all(&delivery);
    free(delivery.words);
    tracer->counts = delivery.file->facts.counts;
    return status;
}

struct impulse_source impulse_file_source(struct impulse_file *file)
{
    const struct impulse_source source = {deliver, file};
    return source;
}
