/* A run's folder of checkpoints: files named shard-I-of-K-FIRST-LAST.sums. */
#ifndef SONJECT_TRACE_SUMS_FOLDER_H
#define SONJECT_TRACE_SUMS_FOLDER_H

#include "trace/sums_file.h"

struct sums_folder {
    struct sums_file *files; /* owned */
    size_t count;
};

/* Opens the checkpoints in a folder that may be missing, in the order of their names, of one shard
 * or of all (shard 0). drops_damaged: files that are damaged are removed, with news of it, so that
 * they are traced anew; one under another shard's name is refused all the same. To be given to
 * sums_folder_clear, also on failure. Errors: as sums_file_open.
 */
sonject_status sums_folder_read(struct sums_folder *folder, struct report *report, const char *path,
                                uint64_t shard, bool drops_damaged);
void sums_folder_clear(struct sums_folder *folder);

/* Opens the first checkpoint in a folder that may be missing, whosever it is; *is_there: there is
 * one, to be given to sums_file_close. Errors: as sums_file_open. */
sonject_status sums_folder_first(struct sums_file *file, struct report *report, const char *path,
                                 bool *is_there);

/* How many shards the names in the folder speak of, the first that is not `but`; 0: no such name.
 */
sonject_status sums_folder_shards(struct report *report, const char *path, uint64_t but,
                                  uint64_t *shards);

/* How far a shard got: the checkpoints that follow one another from its first strip on, as far as
 * they go. Old processes may have left others, of which some overlap. */
struct sums_chain {
    const struct sums_file **files; /* owned; count of them */
    size_t count;
    uint64_t next; /* strip to trace next */
    bool is_complete;
};

/* Errors: MEMORY. */
sonject_status sums_chain_find(struct sums_chain *chain, struct report *report,
                               const struct sums_folder *folder, uint64_t shard);
void sums_chain_clear(struct sums_chain *chain);

/* Removes checkpoints, parts of them that dead processes left, and the folder if nothing else is in
 * it.
 */
void sums_folder_remove(const char *path);

#endif
