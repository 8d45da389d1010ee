/* Files of sums: what tracing leaves. A checkpoint, which is what one process traced of a shard in
 * one go, or all that a trace found (inject/impulse_file.h says what its sums are).
 *
 *   "sonject sums 03\n"
 *   blocks: kind, bytes (64 bits each), digest (XXH3 of kind, bytes and content, 32 digits in 40
 *   bytes), content
 *     head  struct sums_head, then the scene's source (texts, each terminated; nothing where the
 *           scene came from no file)
 *     sums  how many sums there are; then runs of those that are not all 0: number of the first,
 *           how many, 64-bit integers. A block for each time that tracing hands sums on.
 *     end   struct sums_end; nothing follows it
 *
 * Integers are those of the machine; one of the other byte order finds the file damaged. Nothing in
 * it depends on the device or the time, so two processes that traced the same write the same. */
#ifndef SONJECT_TRACE_SUMS_FILE_H
#define SONJECT_TRACE_SUMS_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/hash.h"
#include "base/report.h"

#define SUMS_DIGEST_CAPACITY 40

/* Whose tallies these are: checkpoints of which any differs cannot be added up. */
struct sums_identity {
    char version[40]; /* of sonject */
    char code[SUMS_DIGEST_CAPACITY];
    char scene[SUMS_DIGEST_CAPACITY];  /* everything that the result depends on,
                                           but not the image file's name */
    char device[SUMS_DIGEST_CAPACITY]; /* "" unless the result depends on it: user shapes */
};

struct sums_head {
    struct sums_identity identity;
    uint64_t shard, shards; /* shard: from 1 */
};

struct sums_end {
    uint64_t first, last; /* the shard's strips that it traced, over all launches: last is the next
                             checkpoint's first */
    uint64_t is_last;     /* 1: to the shard's end */
    uint64_t records;     /* blocks of sums */
    uint64_t rays, queries, impulses;
    char launches[SUMS_DIGEST_CAPACITY]; /* of what was launched, by whichever shard */
};

/* The scene's text and where it came from: texts one after the other. */
struct sums_source {
    const char *texts;
    size_t bytes;
};

/* A file in the making. */
struct sums_writer {
    struct report *report;
    const char *path;            /* of the file; NULL: a shard's, named by what it holds */
    char *folder, *private_name; /* owned; private_name: NULL while all is in memory */
    FILE *file;
    unsigned char *bytes; /* that are not in the file yet; owned */
    size_t count, capacity, block;
    struct sums_head head;
    uint64_t records;
};

/* Begins a file of tallies for a folder, which must exist once it is published. On success to be
 * given to sums_writer_clear, which drops what was not published. Errors: MEMORY. */
sonject_status sums_writer_begin(struct sums_writer *writer, struct report *report,
                                 const char *folder, const struct sums_head *head,
                                 struct sums_source source);

/* The same for a file of that name, which is borrowed. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_begin_file(struct sums_writer *writer, struct report *report,
                                      const char *path, const struct sums_head *head,
                                      struct sums_source source);
void sums_writer_clear(struct sums_writer *writer);

/* A block of sums: begin, runs in any order, end. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_begin_sums(struct sums_writer *writer, uint64_t count);
sonject_status sums_writer_run(struct sums_writer *writer, uint64_t first, const int64_t *values,
                               size_t count);
sonject_status sums_writer_end_sums(struct sums_writer *writer);

/* The same of all sums at once. */
sonject_status sums_writer_sums(struct sums_writer *writer, const int64_t *values, size_t count);

/* Gives the file its name. end->records is filled in. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_publish(struct sums_writer *writer, struct sums_end *end);

struct sums_block {
    uint64_t at, bytes; /* of its content in the file */
    uint64_t count;     /* of its sums */
};

/* A file that was found whole. */
struct sums_file {
    char *path;
    struct sums_head head;
    struct sums_source source; /* owned */
    struct sums_end end;
    struct sums_block *sums; /* end.records */
};

/* Reads a file from end to end. On success to be given to sums_file_close; on failure nothing is
 * held. Errors: INPUT (none of these files, damaged, cut short), STORAGE, MEMORY. */
sonject_status sums_file_open(struct sums_file *file, struct report *report, const char *path);
void sums_file_close(struct sums_file *file);

/* Takes a run of sums; false where it cannot lie there. */
typedef bool sums_run_function(void *user, uint64_t first, const int64_t *values, size_t count);

/* Hands out the runs of a block of `count` sums. Errors: INPUT (damaged since; other sums),
 * STORAGE, MEMORY. */
sonject_status sums_file_runs(const struct sums_file *file, struct report *report, uint64_t record,
                              uint64_t count, sums_run_function *take, void *user);

/* All sums of a block, for free(); NULL on failure. Errors: as sums_file_runs. */
sonject_status sums_file_record(const struct sums_file *file, struct report *report,
                                uint64_t record, int64_t **values, uint64_t *count);

/* What reader and writer share. */
#define SUMS_MAGIC       "sonject sums 03\n"
#define SUMS_MAGIC_BYTES 16

enum block_kind {
    BLOCK_HEAD = 1,
    BLOCK_SUMS = 2,
    BLOCK_END = 3
};

struct block_head {
    uint64_t kind, bytes;
    char digest[SUMS_DIGEST_CAPACITY];
};

typedef char block_head_is_packed[sizeof(struct block_head) == 56 ? 1 : -1];
typedef char sums_head_is_packed[sizeof(struct sums_head) == 176 ? 1 : -1];
typedef char sums_end_is_packed[sizeof(struct sums_end) == 96 ? 1 : -1];

/* Fills in the digest of a block whose kind and number of bytes are there. False where memory
 * lacks. */
bool block_digest(struct block_head *head, const void *content);

#endif
