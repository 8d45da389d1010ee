/* Lines and facts as records of a file of sums. */
#include "inject/impulse_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

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

sonject_status impulse_file_publish(struct sums_writer *writer, const struct impulse_facts *facts,
                                    const char *image_path)
{
    struct sums_end end;
    const size_t count = sizeof *facts / sizeof(int64_t) + strlen(image_path) / sizeof(int64_t) + 1;
    int64_t *words = allocate_array(count, sizeof *words);
    CHECK_MEMORY(writer->report, words, "impulses");
    memcpy(words, facts, sizeof *facts);
    memcpy((char *)words + sizeof *facts, image_path, strlen(image_path));
    sonject_status status = sums_writer_sums(writer, words, count);
    free(words);
    memset(&end, 0, sizeof end);
    end.is_last = 1;
    end.rays = facts->counts.rays;
    end.queries = facts->counts.queries;
    end.impulses = facts->counts.impulses;
    return status == SONJECT_OK ? sums_writer_publish(writer, &end) : status;
}

static sonject_status read_facts(struct impulse_file *file)
{
    const struct sums_file *sums = &file->sums;
    int64_t *words;
    uint64_t count;
    if (sums->end.course[0] != '\0' || sums->head.shards != 1)
        return report_failure(file->report, SONJECT_ERROR_INPUT,
                              "%s: a shard's sums, not what sonject trace leaves: sonject merge "
                              "forms it",
                              sums->path);
    CHECK(sums_file_record(sums, file->report, sums->end.records - 1, &words, &count));
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
