/* A run's folder of checkpoints. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "trace/sums_file.h"

/* Reads a checkpoint's name, and returns false for other names. An earlier format had such names,
 * too; its files are refused, not overlooked. */
static bool parse_name(const char *text, uint64_t *shard, uint64_t *shards)
{
    uint64_t first, last;
    int end = 0;
    return sscanf(text, "shard-%" SCNu64 "-of-%" SCNu64 "-%" SCNu64 "-%" SCNu64 "%n", shard, shards,
                  &first, &last, &end) == 4 &&
           end > 0 && (strcmp(text + end, ".sums") == 0 || strcmp(text + end, ".stint") == 0);
}

/* Lists the names that begin like those of checkpoints, in their order. */
static sonject_status list_names(struct folder_names *list, struct report *report, const char *path)
{
    return folder_names_read(list, report, path, "shard-");
}

static sonject_status open_one(struct sums_folder *folder, struct report *report, const char *path,
                               uint64_t shard, uint64_t shards, bool drops_damaged)
{
    struct sums_file *file = &folder->files[folder->count];
    const sonject_status status = sums_file_open(file, report, path);
    if (status == SONJECT_ERROR_INPUT && drops_damaged) {
        file_discard(path);
        report_log(report, "%s was damaged: it is traced again", path);
        report->message[0] = '\0';
        return SONJECT_OK;
    }
    CHECK(status);
    folder->count++;
    return file->head.shard == shard && file->head.shards == shards
               ? SONJECT_OK
               : input_failure(report, path,
                               "is another shard's: give it back its name, or delete it");
}

sonject_status sums_folder_read(struct sums_folder *folder, struct report *report, const char *path,
                                uint64_t shard, size_t most, bool drops_damaged)
{
    struct folder_names list;
    uint64_t its, shards;
    memset(folder, 0, sizeof *folder);
    CHECK(list_names(&list, report, path));
    folder->files = allocate_array(list.count, sizeof *folder->files);
    sonject_status status = folder->files ? SONJECT_OK : report_out_of_memory(report, path);
    for (size_t i = 0; status == SONJECT_OK && i < list.count && folder->count < most; i++) {
        if (!parse_name(list.names[i], &its, &shards) || (shard != 0 && its != shard))
            continue;
        char *file = path_join(path, list.names[i]);
        status = file ? open_one(folder, report, file, its, shards, drops_damaged)
                      : report_out_of_memory(report, "a file name");
        free(file);
    }
    folder_names_clear(&list);
    return status;
}

void sums_folder_clear(struct sums_folder *folder)
{
    for (size_t i = 0; i < folder->count; i++)
        sums_file_close(&folder->files[i]);
    free(folder->files);
    memset(folder, 0, sizeof *folder);
}

sonject_status sums_folder_shards(struct report *report, const char *path, uint64_t but,
                                  uint64_t *shards)
{
    struct folder_names list;
    uint64_t shard, others;
    *shards = 0;
    CHECK(list_names(&list, report, path));
    for (size_t i = 0; *shards == 0 && i < list.count; i++)
        if (parse_name(list.names[i], &shard, &others) && others != but)
            *shards = others;
    folder_names_clear(&list);
    return SONJECT_OK;
}

void sums_folder_remove(const char *path)
{
    struct report ignored = {.host = NULL};
    struct folder_names list;
    uint64_t shard, shards;
    (void)list_names(&list, &ignored, path); /* the list is empty on failure */
    for (size_t i = 0; i < list.count; i++) {
        char *file =
            parse_name(list.names[i], &shard, &shards) ? path_join(path, list.names[i]) : NULL;
        if (file)
            file_discard(file);
        free(file);
    }
    folder_names_clear(&list);
    folder_tidy(path);
    folder_discard(path);
}

/* Orders checkpoints by their first strip, then by their last. */
static int compare_spans(const void *a, const void *b)
{
    const struct sums_head *first = &(*(const struct sums_file *const *)a)->head;
    const struct sums_head *second = &(*(const struct sums_file *const *)b)->head;
    if (first->first != second->first)
        return first->first < second->first ? -1 : 1;
    return first->last < second->last ? -1 : first->last > second->last;
}

/* Returns whether a file ends farther than another. */
static bool is_farther(const struct sums_head *head, const struct sums_head *than)
{
    return head->is_last != than->is_last ? head->is_last > than->is_last : head->last > than->last;
}

sonject_status sums_chain_find(struct sums_chain *chain, struct report *report,
                               const struct sums_folder *folder, uint64_t shard)
{
    size_t count = 0;
    memset(chain, 0, sizeof *chain);
    const struct sums_file **files = allocate_array(folder->count, sizeof *files);
    size_t *from =
        allocate_array(folder->count, sizeof *from); /* the file that each goes on from */
    chain->files = allocate_array(folder->count, sizeof *chain->files);
    const bool is_complete = files && from && chain->files;
    for (size_t i = 0; is_complete && i < folder->count; i++)
        if (folder->files[i].head.shard == shard)
            files[count++] = &folder->files[i];
    if (is_complete)
        qsort(files, count, sizeof *files, compare_spans);
    size_t last = count; /* last file of the chain that goes farthest; count: none */
    for (size_t i = 0; i < count; i++) {
        /* the file's own number where it begins the shard; count: it is not reached */
        from[i] = files[i]->head.first == 0 ? i : count;
        for (size_t k = i; from[i] == count && k-- > 0;)
            if (from[k] < count && files[k]->head.last == files[i]->head.first)
                from[i] = k;
        if (from[i] < count && (last == count || is_farther(&files[i]->head, &files[last]->head)))
            last = i;
    }
    if (last < count) {
        chain->next = files[last]->head.last;
        chain->is_complete = files[last]->head.is_last != 0;
        while (chain->files[chain->count++] = files[last], from[last] != last)
            last = from[last];
    }
    free(files);
    free(from);
    CHECK_MEMORY(report, is_complete, "checkpoints");
    return SONJECT_OK;
}
