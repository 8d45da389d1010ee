/* A run's folder of stints: files named shard-I-of-K-FIRST-LAST.stint. */
#ifndef SONJECT_TRACE_STINT_FOLDER_H
#define SONJECT_TRACE_STINT_FOLDER_H

#include "trace/stint_file.h"

struct stint_folder {
    struct stint_file *files; /* owned */
    size_t count;
};

/* Opens the stints in a folder that may be missing, in the order of their names, of one shard or of
 * all (shard 0). drops_damaged: files that are damaged are removed, with news of it, so that they
 * are traced anew; one under another shard's name is refused all the same. To be given to
 * stint_folder_clear, also on failure. Errors: as stint_file_open.
 */
sonject_status stint_folder_read(struct stint_folder *folder, struct report *report,
                                 const char *path, uint64_t shard, bool drops_damaged);
void stint_folder_clear(struct stint_folder *folder);

/* Opens the first stint in a folder that may be missing, whosever it is; *is_there: there is one,
 * to be given to stint_file_close. Errors: as stint_file_open. */
sonject_status stint_folder_first(struct stint_file *file, struct report *report, const char *path,
                                  bool *is_there);

/* How many shards the names in the folder speak of, the first that is not `but`; 0: no such name.
 */
sonject_status stint_folder_shards(struct report *report, const char *path, uint64_t but,
                                   uint64_t *shards);

/* How far a shard got: the stints that follow one another from its first strip on, as far as they
 * go. Old processes may have left others, of which some overlap. */
struct stint_chain {
    const struct stint_file **files; /* owned; count of them */
    size_t count;
    uint64_t next; /* strip to trace next */
    bool is_complete;
};

/* Errors: MEMORY. */
sonject_status stint_chain_find(struct stint_chain *chain, struct report *report,
                                const struct stint_folder *folder, uint64_t shard);
void stint_chain_clear(struct stint_chain *chain);

/* Removes stints, parts of them that dead processes left, and the folder if nothing else is in it.
 */
void stint_folder_remove(const char *path);

#endif
