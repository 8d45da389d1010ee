/* Files of sums: what one process traced of a shard, or of everything, in one go.
 *
 *   "sonject sums 08\n"
 *   blocks: kind, bytes (64 bits each), digest (XXH3 of kind, bytes and content, 32 digits in 40
 *   bytes), content
 *     sums  how many sums there are; then runs of those that are not all 0: number of the first,
 *           how many, 64-bit integers. A block for each time that tracing hands sums on.
 *     head  the last block: struct sums_head, then where the scene came from, terminated texts:
 *           its file, the working folder, the file's text, overrides; none where it was in no file
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
#include "schema/scene_file.h"

#define SUMS_DIGEST_CAPACITY 40

/* Whose tallies these are: checkpoints of which any differs cannot be added up. */
struct sums_identity {
    char version[40]; /* of sonject */
    char code[SUMS_DIGEST_CAPACITY];
    char scene[SUMS_DIGEST_CAPACITY]; /* everything that the result depends on,
                                          but not the image file's name */
    char image[SUMS_DIGEST_CAPACITY]; /* size and pixels of the patch alone */
};

struct sums_head {
    struct sums_identity identity;
    char launches[SUMS_DIGEST_CAPACITY]; /* of what was launched, by whichever shard */
    uint64_t shard, shards;              /* shard: from 1 */
    uint64_t first, last; /* the shard's strips that it traced, over all launches: last is the next
                             checkpoint's first */
    uint64_t is_last;     /* 1: to the shard's end */
    uint64_t records;     /* blocks of sums */
    uint64_t rays, queries, impulses;
};

/* What a scene was read from as a file of sums keeps it, lying in that; all NULL: it had no text,
 * or arrays beside it. */
struct kept_scene {
    const char *path, *folder, *text;
    const char **overrides;
    size_t override_count;
};

/* A file in the making. */
struct sums_writer {
    struct report *report;
    const char *path;   /* of the file; NULL: a shard's, named by what it holds */
    const char *folder; /* of that */
    char *private_name; /* owned; NULL while all is in memory */
    FILE *file;
    unsigned char *bytes; /* that are not in the file yet; owned */
    size_t count, capacity, block;
    uint64_t records;
};

/* Begins the file `path`; or where that is NULL a file of tallies for a folder, which is made when
 * there is much to write. Borrows both. On success to be given to sums_writer_clear, which drops
 * what was not published; on failure nothing is held. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_begin(struct sums_writer *writer, struct report *report,
                                 const char *path, const char *folder);
void sums_writer_clear(struct sums_writer *writer);

/* A block of sums: begin, runs in any order, end. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_begin_sums(struct sums_writer *writer, uint64_t count);
sonject_status sums_writer_run(struct sums_writer *writer, uint64_t first, const int64_t *values,
                               size_t count);
sonject_status sums_writer_end_sums(struct sums_writer *writer);

/* The same of all sums at once. */
sonject_status sums_writer_sums(struct sums_writer *writer, const int64_t *values, size_t count);

/* Gives the file its head, but for head->records, which is counted, and its name. source may be
 * NULL. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_publish(struct sums_writer *writer, const struct sums_head *head,
                                   const struct scene_source *source);

struct sums_block {
    uint64_t at, bytes; /* of its content in the file */
};

/* A file that was found whole. */
struct sums_file {
    char *path;
    struct sums_head head;
    struct kept_scene scene;
    struct sums_block *sums; /* head.records */
    char *content;           /* of the head's block; owned */
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

/* A run's folder of checkpoints: files named shard-I-of-K-FIRST-LAST.sums. */
struct sums_folder {
    struct sums_file *files; /* owned */
    size_t count;
};

/* Opens the checkpoints in a folder that may be missing, in the order of their names: of one shard
 * or of all (shard 0), at most so many. drops_damaged: files that are damaged are removed, with
 * news of it, so that they are traced anew; one under another shard's name is refused all the same.
 * To be given to sums_folder_clear, also on failure. Errors: as sums_file_open. */
sonject_status sums_folder_read(struct sums_folder *folder, struct report *report, const char *path,
                                uint64_t shard, size_t most, bool drops_damaged);
void sums_folder_clear(struct sums_folder *folder);

/* How many shards the names in the folder speak of, the first that is not `but`; 0: no such name.
 * Errors: STORAGE, MEMORY. */
sonject_status sums_folder_shards(struct report *report, const char *path, uint64_t but,
                                  uint64_t *shards);

/* Removes checkpoints, parts of them that dead processes left, and the folder if nothing else is in
 * it. Never fails. */
void sums_folder_remove(const char *path);

/* How far a shard got: the checkpoints that follow one another from its first strip on, as far as
 * they go. Old processes may have left others, of which some overlap. */
struct sums_chain {
    const struct sums_file **files; /* owned; count of them, the last one first */
    size_t count;
    uint64_t next; /* strip to trace next */
    bool is_complete;
};

/* chain->files is the caller's for free(), also on failure. Errors: MEMORY. */
sonject_status sums_chain_find(struct sums_chain *chain, struct report *report,
                               const struct sums_folder *folder, uint64_t shard);

/* Blocks, as tests make them, too. */
#define SUMS_MAGIC       "sonject sums 08\n"
#define SUMS_MAGIC_BYTES 16

enum block_kind {
    BLOCK_SUMS = 1,
    BLOCK_HEAD = 2
};

struct block_head {
    uint64_t kind, bytes;
    char digest[SUMS_DIGEST_CAPACITY];
};

/* Fills in the digest of a block whose kind and number of bytes are there. False where memory
 * lacks. */
bool block_digest(struct block_head *head, const void *content);

#endif
