#define _POSIX_C_SOURCE 200809L
#include "trace/sums_folder.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/folder.h"
#include "base/memory.h"

#define PREFIX "shard-" /* of all their names */

/* What a name says. */
struct sums_name {
    uint64_t shard, shards;
};

/* Files of an earlier format have their names, too, so that they are refused, not overlooked. */
static bool parse_name(const char *text, struct sums_name *name)
{
    uint64_t first, last;
    int end = 0;
    return sscanf(text, "shard-%" SCNu64 "-of-%" SCNu64 "-%" SCNu64 "-%" SCNu64 "%n", &name->shard,
                  &name->shards, &first, &last, &end) == 4 &&
           end > 0 && (strcmp(text + end, ".sums") == 0 || strcmp(text + end, ".stint") == 0);
}

static sonject_status open_one(struct sums_folder *folder, struct report *report, const char *path,
                               const struct sums_name *name, bool drops_damaged)
{
    struct sums_file *file = &folder->files[folder->count];
    const sonject_status status = sums_file_open(file, report, path);
    if (status == SONJECT_ERROR_INPUT && drops_damaged) {
        file_discard(path);
        report_news(report, "%s was damaged: it is traced again", path);
        report->message[0] = '\0';
        return SONJECT_OK;
    }
    if (status == SONJECT_OK &&
        (file->head.shard != name->shard || file->head.shards != name->shards)) {
        sums_file_close(file);
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is another shard's: give it back its name, or delete it", path);
    }
    folder->count += status == SONJECT_OK;
    return status;
}

sonject_status sums_folder_read(struct sums_folder *folder, struct report *report, const char *path,
                                uint64_t shard, bool drops_damaged)
{
    struct folder_names list;
    struct sums_name name;
    memset(folder, 0, sizeof *folder);
    sonject_status status = folder_names_read(&list, report, path, PREFIX);
    if (status != SONJECT_OK)
        return status;
    folder->files = allocate_array(list.count, sizeof *folder->files);
    if (!folder->files)
        status = report_out_of_memory(report, path);
    for (size_t i = 0; status == SONJECT_OK && i < list.count; i++) {
        if (!parse_name(list.names[i], &name) || (shard > 0 && name.shard != shard))
            continue;
        char *file = path_join(path, list.names[i]);
        status = file ? open_one(folder, report, file, &name, drops_damaged)
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

sonject_status sums_folder_first(struct sums_file *file, struct report *report, const char *path,
                                 bool *is_there)
{
    struct folder_names list;
    struct sums_name name;
    *is_there = false;
    sonject_status status = folder_names_read(&list, report, path, PREFIX);
    if (status != SONJECT_OK)
        return status;
    size_t first = 0;
    while (first < list.count && !parse_name(list.names[first], &name))
        first++;
    if (first < list.count) {
        char *found = path_join(path, list.names[first]);
        status = found ? sums_file_open(file, report, found)
                       : report_out_of_memory(report, "a file name");
        *is_there = status == SONJECT_OK;
        free(found);
    }
    folder_names_clear(&list);
    return status;
}

sonject_status sums_folder_shards(struct report *report, const char *path, uint64_t but,
                                  uint64_t *shards)
{
    struct folder_names list;
    struct sums_name name;
    *shards = 0;
    const sonject_status status = folder_names_read(&list, report, path, PREFIX);
    for (size_t i = 0; *shards == 0 && i < list.count; i++)
        if (parse_name(list.names[i], &name) && name.shards != but)
            *shards = name.shards;
    folder_names_clear(&list);
    return status;
}

/* By where they begin; what ends there too comes before what goes on from there. */
static int compare_spans(const void *a, const void *b)
{
    const struct sums_end *first = &(*(const struct sums_file *const *)a)->end;
    const struct sums_end *second = &(*(const struct sums_file *const *)b)->end;
    if (first->first != second->first)
        return first->first < second->first ? -1 : 1;
    return first->last < second->last ? -1 : first->last > second->last;
}

/* From which of the sorted files each is reached; its own number where it begins the shard; count:
 * it is not. */
static void reach(const struct sums_file *const *files, size_t count, size_t *from)
{
    for (size_t i = 0; i < count; i++) {
        from[i] = files[i]->end.first == 0 ? i : count;
        for (size_t k = i; from[i] == count && k-- > 0;)
            if (from[k] < count && files[k]->end.last == files[i]->end.first)
                from[i] = k;
    }
}

/* Whether a file's end is farther than another's. */
static bool is_farther(const struct sums_end *end, const struct sums_end *than)
{
    return end->is_last > than->is_last ||
           (end->is_last == than->is_last && end->last > than->last);
}

/* The last file of the chain that goes farthest; count: there is none. */
static size_t find_farthest(const struct sums_file *const *files, size_t count, const size_t *from)
{
    size_t last = count;
    for (size_t i = 0; i < count; i++)
        if (from[i] < count && (last == count || is_farther(&files[i]->end, &files[last]->end)))
            last = i;
    return last;
}

sonject_status sums_chain_find(struct sums_chain *chain, struct report *report,
                               const struct sums_folder *folder, uint64_t shard)
{
    size_t count = 0;
    memset(chain, 0, sizeof *chain);
    const struct sums_file **files = allocate_array(folder->count, sizeof *files);
    size_t *from = allocate_array(folder->count, sizeof *from);
    chain->files = allocate_array(folder->count, sizeof *chain->files);
    if (!files || !from || !chain->files) {
        free(files);
        free(from);
        sums_chain_clear(chain);
        return report_out_of_memory(report, "checkpoints");
    }
    for (size_t i = 0; i < folder->count; i++)
        if (folder->files[i].head.shard == shard)
            files[count++] = &folder->files[i];
    qsort(files, count, sizeof *files, compare_spans);
    reach(files, count, from);
    size_t last = find_farthest(files, count, from);
    if (last < count) {
        chain->next = files[last]->end.last;
        chain->is_complete = files[last]->end.is_last != 0;
        while (chain->files[chain->count++] = files[last], from[last] != last)
            last = from[last];
    }
    free(files);
    free(from);
    return SONJECT_OK;
}

void sums_chain_clear(struct sums_chain *chain)
{
    free(chain->files);
    memset(chain, 0, sizeof *chain);
}

void sums_folder_remove(const char *path)
{
    struct report ignored = {{0}, NULL, NULL};
    struct folder_names list;
    if (folder_names_read(&list, &ignored, path, PREFIX) != SONJECT_OK)
        return;
    for (size_t i = 0; i < list.count; i++) {
        struct sums_name name;
        char *file = parse_name(list.names[i], &name) ? path_join(path, list.names[i]) : NULL;
        if (file)
            file_discard(file);
        free(file);
    }
    folder_tidy(path);
    folder_names_clear(&list);
    rmdir(path);
}
