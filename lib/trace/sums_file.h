/* Files of sums. A file holds what one process traced of a shard, or of everything, in one go.
 *
 *   "sonject sums 08\n"
 *   blocks: kind, bytes (64 bits each), digest (XXH3 of kind, bytes and content, 32 digits in 40
 *   bytes), content
 *     sums  number of sums; then runs of sums that are not all 0: number of the first, length,
 *           64-bit integers. A block for each time that tracing hands sums on.
 *     head  the last block: struct sums_head, then terminated texts of the scene's source: its
 *           file, the working folder, the file's text, overrides. No texts without a file.
 *
 * Integers are in the machine's byte order; a machine of the other order finds the file damaged.
 * Nothing depends on device or time: two processes that trace the same write the same file. */
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

/* The identity of tallies. Checkpoints that differ in any member cannot be added up. */
struct sums_identity {
    char version[40]; /* version of sonject */
    char code[SUMS_DIGEST_CAPACITY];
    char scene[SUMS_DIGEST_CAPACITY]; /* all that results depend on but the image file's name */
    char image[SUMS_DIGEST_CAPACITY]; /* size and pixels of the patch alone */
};

struct sums_head {
    struct sums_identity identity;
    char launches[SUMS_DIGEST_CAPACITY]; /* digest of all launches, whatever the shard */
    uint64_t shard, shards;              /* shard: from 1 */
    uint64_t first, last; /* the shard's strips over all launches, from first to before last */
    uint64_t is_last;     /* 1: traced to the shard's end */
    uint64_t records;     /* number of blocks of sums */
    uint64_t rays, queries, impulses;
};

/* The source of a scene as a file of sums keeps it. Its texts lie in the file's content. All
 * members are NULL where the scene had no text, or arrays beside the text. */
struct kept_scene {
    const char *path, *folder, *text;
    const char **overrides;
    size_t override_count;
};

/* A file in the making. */
struct sums_writer {
    struct report *report;
    const char *path;   /* path of the file; NULL: a shard's file, named by its content */
    const char *folder; /* folder of a shard's file */
    char *private_name; /* owned; NULL while all is in memory */
    FILE *file;
    unsigned char *bytes; /* bytes that are not in the file yet; owned */
    size_t count, capacity, block;
    uint64_t records;
};

/* Begins the file `path`. If path is NULL, begins a shard's file for a folder, which is made when
 * there is much to write. Borrows both. After success the caller calls sums_writer_clear, which
 * drops what was not published; on failure nothing is held. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_begin(struct sums_writer *writer, struct report *report,
                                 const char *path, const char *folder);
void sums_writer_clear(struct sums_writer *writer);

/* Writes a block of sums: begin, pieces in any order, end. A piece is written as the runs in it
 * that are not all 0. Errors: STORAGE, MEMORY. */
sonject_status sums_writer_begin_sums(struct sums_writer *writer, uint64_t count);
sonject_status sums_writer_add(struct sums_writer *writer, uint64_t first, const int64_t *values,
                               size_t count);
sonject_status sums_writer_end_sums(struct sums_writer *writer);

/* Writes a block of all sums at once. */
sonject_status sums_writer_add_all(struct sums_writer *writer, const int64_t *values, size_t count);

/* Gives the file its head and its name. The writer counts head->records itself. source may be NULL.
 * Errors: STORAGE, MEMORY. */
sonject_status sums_writer_publish(struct sums_writer *writer, const struct sums_head *head,
                                   const struct scene_source *source);

struct sums_block {
    uint64_t at, bytes; /* place and size of its content in the file */
};

/* A file that was read and found whole. */
struct sums_file {
    char *path;
    struct sums_head head;
    struct kept_scene scene;
    struct sums_block *sums; /* head.records of them; owned */
    char *content;           /* content of the head's block; owned */
};

/* Reads a file from end to end. After success the caller calls sums_file_close; on failure nothing
 * is held. Errors: INPUT (not a file of sums, damaged, cut short), STORAGE, MEMORY. */
sonject_status sums_file_open(struct sums_file *file, struct report *report, const char *path);
void sums_file_close(struct sums_file *file);

/* Takes a run of sums; returns false where it cannot lie there. */
typedef bool sums_run_function(void *user, uint64_t first, const int64_t *values, size_t count);

/* Hands out the runs of a block of `count` sums. Errors: INPUT (damaged since it was opened, other
 * sums), STORAGE, MEMORY. */
sonject_status sums_file_runs(const struct sums_file *file, struct report *report, uint64_t record,
                              uint64_t count, sums_run_function *take, void *user);

/* A run's folder of checkpoints: files named shard-I-of-K-FIRST-LAST.sums. */
struct sums_folder {
    struct sums_file *files; /* owned */
    size_t count;
};

/* Opens the checkpoints in a folder, which may be missing, in the order of their names: at most
 * `most` of one shard, or of all (shard 0). drops_damaged: damaged files are reported and removed,
 * and so traced again. A file under another shard's name is always refused. The caller calls
 * sums_folder_clear, also on failure. Errors: as sums_file_open. */
sonject_status sums_folder_read(struct sums_folder *folder, struct report *report, const char *path,
                                uint64_t shard, size_t most, bool drops_damaged);
void sums_folder_clear(struct sums_folder *folder);

/* Finds the number of shards that the names in the folder tell, the first that is not `but`; 0 if
 * there is no such name. Errors: STORAGE, MEMORY. */
sonject_status sums_folder_shards(struct report *report, const char *path, uint64_t but,
                                  uint64_t *shards);

/* Removes checkpoints, unfinished ones of dead processes, and the folder if empty. Never fails. */
void sums_folder_remove(const char *path);

/* The progress of a shard: checkpoints that follow one another from its first strip on, as far as
 * they reach. Earlier processes may have left other checkpoints, some of which overlap. */
struct sums_chain {
    const struct sums_file **files; /* owned; count files, the last one first */
    size_t count;
    uint64_t next; /* the strip to trace next */
    bool is_complete;
};

/* Finds a shard's chain of checkpoints. chain->files is for free(), also on failure. Errors:
 * MEMORY. */
sonject_status sums_chain_find(struct sums_chain *chain, struct report *report,
                               const struct sums_folder *folder, uint64_t shard);

/* Blocks of a file. Tests make them, too. */
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

/* Fills in the digest of a block whose kind and bytes are set. Returns false if memory lacks. */
bool block_digest(struct block_head *head, const void *content);

#endif
