/* What tracing leaves for image formation, in a file of sums (trace/sums_file.h), so that images
 * can be formed later, with another pulse or cross-range response too. Its head has shard 1 of 1,
 * the hash of what tracing depends on and the scene's text, and no digest of launches. Its
 * records, 64-bit words each:
 *
 *   lines  LINES_HEAD_WORDS numbers: kind, number, strips_per_row, bins_per_pixel, the grid's first
 *          strip and strips, its first bin and bins, first strip and strips of these lines, planes;
 *          then the planes' 32-bit floats, one plane after the other, and one 0 where they are odd.
 *          In the order in which tracing hands them out (impulses.h).
 *   facts  the last record: struct impulse_facts, then the image's path, terminated */
#ifndef SONJECT_INJECT_IMPULSE_FILE_H
#define SONJECT_INJECT_IMPULSE_FILE_H

#include "inject/impulses.h"
#include "trace/sums_file.h"
#include "trace/tracer.h"

/* What was traced, and what the grids were laid for. */
struct impulse_facts {
    char image_hash[SUMS_DIGEST_CAPACITY]; /* of size and patch pixels */
    uint64_t image_rows, image_columns;
    double bandwidth_hz, along_track_resolution_m, taylor_sidelobe_db;
    uint64_t response_window, taylor_terms;
    struct trace_counts counts;
};

/* Between the members that image formation alone depends on and a sonar. */
void impulse_facts_note_sonar(struct impulse_facts *facts, const sonject_sonar_params *sonar);
void impulse_facts_take_sonar(const struct impulse_facts *facts, sonject_sonar_params *sonar);

/* A sink whose taker is a struct sums_writer, to which it appends the lines. Errors: STORAGE,
 * MEMORY. */
sonject_status impulse_lines_write(void *writer, const struct impulse_lines *lines);

/* Appends the last record and gives the file its name. head: whose the impulses are; source may be
 * NULL; image_path: "" if the image is made. Errors: STORAGE, MEMORY. */
sonject_status impulse_file_publish(struct sums_writer *writer, const struct sums_head *head,
                                    const struct scene_source *source,
                                    const struct impulse_facts *facts, const char *image_path);

struct impulse_file {
    struct report *report;
    struct sums_file sums;
    struct impulse_facts facts;
    void *last;             /* record; owned */
    const char *image_path; /* in it */
};

/* Reads a file from end to end; lines are read again when they are asked for. Borrows report. On
 * success to be given to impulse_file_close; on failure nothing is held. Errors: INPUT (no such
 * file, or not one that sonject_trace wrote, or damaged), STORAGE, MEMORY. */
sonject_status impulse_file_open(struct report *report, const char *path,
                                 struct impulse_file *file);
void impulse_file_close(struct impulse_file *file);

/* Hands out the file's impulses, and its counts to the tracer. The tracer's scene must be the one
 * that was traced, but for the sonar's pulse and cross-range response. Errors: INPUT (damaged, a
 * grid that is not the scene's, a response that cannot be formed: reimaging.h), MEMORY, CANCELLED,
 * and the sink's own. */
struct impulse_source impulse_file_source(struct impulse_file *file);

#define LINES_HEAD_WORDS 11

#endif
