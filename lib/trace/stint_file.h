/* Files of tallies: what one process traced of a shard in one go, a stint.
 *
 *   "sonject stint 2\n"
 *   blocks: kind, bytes (64 bits each), digest (XXH3 of kind, bytes and content, 32 digits in 40
 *   bytes), content
 *     head  struct stint_head, then the scene's source (texts, each terminated; nothing where the
 *           scene came from no file)
 *     sums  how many sums there are; then runs of those that are not all 0: number of the first,
 *           how many, 64-bit integers. A block for each time that tracing hands sums on.
 *     end   struct stint_end; nothing follows it
 *
 * Integers are those of the machine; one of the other byte order finds the file damaged. Nothing in
 * it depends on the device or the time, so two processes that traced the same write the same. */
#ifndef SONJECT_TRACE_STINT_FILE_H
#define SONJECT_TRACE_STINT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/hash.h"
#include "base/report.h"

#define STINT_DIGEST_CAPACITY 40

/* Whose tallies these are: stints of which any differs cannot be added up. */
struct stint_identity {
    char version[40]; /* of sonject */
    char code[STINT_DIGEST_CAPACITY];
    char scene[STINT_DIGEST_CAPACITY];  /* everything that the result depends on,
                                           but not the image file's name */
    char device[STINT_DIGEST_CAPACITY]; /* "" unless the result depends on it: user shapes */
};

struct stint_head {
    struct stint_identity identity;
    uint64_t shard, shards; /* shard: from 1 */
};

struct stint_end {
    uint64_t first, last; /* the shard's strips that it traced, over all launches: last is the next
                             stint's first */
    uint64_t is_last;     /* 1: to the shard's end */
    uint64_t records;     /* blocks of sums */
    uint64_t rays, queries, impulses;
    char course[STINT_DIGEST_CAPACITY]; /* of what was launched, by whichever shard */
};

/* The scene's text and where it came from: texts one after the other. */
struct stint_source {
    const char *texts;
    size_t bytes;
};

/* A file in the making. */
struct stint_writer {
    struct report *report;
    char *folder, *private_name; /* owned; private_name: NULL while all is in memory */
    FILE *file;
    unsigned char *bytes; /* that are not in the file yet; owned */
    size_t count, capacity, block;
    struct stint_head head;
    uint64_t records;
};

/* Begins a file of tallies for a folder, which must exist once it is published. On success to be
 * given to stint_writer_clear, which drops what was not published. Errors: MEMORY. */
sonject_status stint_writer_begin(struct stint_writer *writer, struct report *report,
                                  const char *folder, const struct stint_head *head,
                                  struct stint_source source);
void stint_writer_clear(struct stint_writer *writer);

/* A block of sums: begin, runs in any order, end. Errors: STORAGE, MEMORY. */
sonject_status stint_writer_begin_sums(struct stint_writer *writer, uint64_t count);
sonject_status stint_writer_run(struct stint_writer *writer, uint64_t first, const int64_t *values,
                                size_t count);
sonject_status stint_writer_end_sums(struct stint_writer *writer);

/* The same of all sums at once. */
sonject_status stint_writer_sums(struct stint_writer *writer, const int64_t *values, size_t count);

/* Gives the file its name. end->records is filled in. Errors: STORAGE, MEMORY. */
sonject_status stint_writer_publish(struct stint_writer *writer, struct stint_end *end);

struct stint_block {
    uint64_t at, bytes; /* of its content in the file */
};

/* A file that was found whole. */
struct stint_file {
    char *path;
    struct stint_head head;
    struct stint_source source; /* owned */
    struct stint_end end;
    struct stint_block *sums; /* end.records */
};

/* Reads a file from end to end. On success to be given to stint_file_close; on failure nothing is
 * held. Errors: INPUT (none of these files, damaged, cut short), STORAGE, MEMORY. */
sonject_status stint_file_open(struct stint_file *file, struct report *report, const char *path);
void stint_file_close(struct stint_file *file);

/* Takes a run of sums; false where it cannot lie there. */
typedef bool stint_run_function(void *user, uint64_t first, const int64_t *values, size_t count);

/* Hands out the runs of a block of `count` sums. Errors: INPUT (damaged since; other sums),
 * STORAGE, MEMORY. */
sonject_status stint_file_runs(const struct stint_file *file, struct report *report,
                               uint64_t record, uint64_t count, stint_run_function *take,
                               void *user);

#endif
