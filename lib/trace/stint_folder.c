#define _POSIX_C_SOURCE 200809L
#include "trace/stint_folder.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"

#define FILES_MAX ((size_t)1 << 20)

/* What a name says. */
struct stint_name {
    uint64_t shard, shards;
};

static bool parse_name(const char *text, struct stint_name *name)
{
    uint64_t first, last;
    int end = 0;
    return sscanf(text, "shard-%" SCNu64 "-of-%" SCNu64 "-%" SCNu64 "-%" SCNu64 ".stint%n",
                  &name->shard, &name->shards, &first, &last, &end) == 4 &&
           end > 0 && text[end] == '\0';
}

/* Names in a folder that begin like a stint's, to be given to free_names. */
struct name_list {
    char **names;
    size_t count;
};

static void free_names(struct name_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->names[i]);
    free(list->names);
    memset(list, 0, sizeof *list);
}

static bool add_name(struct name_list *list, const char *name)
{
    if ((list->count & (list->count + 1)) == 0) { /* 0, 1, 3, 7...: room for twice as many */
        char **more = list->count < FILES_MAX
                          ? realloc(list->names, (2 * list->count + 1) * sizeof *more)
                          : NULL;
        if (!more)
            return false;
        list->names = more;
    }
    list->names[list->count] = copy_text(name);
    if (!list->names[list->count])
        return false;
    list->count++;
    return true;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static sonject_status list_names(struct report *report, const char *path, struct name_list *list)
{
    memset(list, 0, sizeof *list);
    DIR *folder = opendir(path);
    if (!folder)
        return errno == ENOENT ? SONJECT_OK : file_failure(report, path, "read", errno);
    sonject_status status = SONJECT_OK;
    struct dirent *entry;
    while (status == SONJECT_OK && (errno = 0, entry = readdir(folder)) != NULL)
        if (strncmp(entry->d_name, "shard-", 6) == 0 && !add_name(list, entry->d_name))
            status = report_out_of_memory(report, path);
    if (status == SONJECT_OK && errno != 0)
        status = file_failure(report, path, "read", errno);
    closedir(folder);
    if (status != SONJECT_OK)
        free_names(list);
    else if (list->count > 0)
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    return status;
}

static sonject_status open_one(struct stint_folder *folder, struct report *report, const char *path,
                               const struct stint_name *name, bool drops_damaged)
{
    struct stint_file *file = &folder->files[folder->count];
    sonject_status status = stint_file_open(file, report, path);
    if (status == SONJECT_OK &&
        (file->head.shard != name->shard || file->head.shards != name->shards)) {
        stint_file_close(file);
        status =
            report_failure(report, SONJECT_ERROR_INPUT,
                           "%s: is another shard's: give it back its name, or delete it", path);
    }
    if (status == SONJECT_ERROR_INPUT && drops_damaged) {
        file_discard(path);
        report_news(report, "%s was damaged: it is traced again", path);
        report->message[0] = '\0';
        return SONJECT_OK;
    }
    folder->count += status == SONJECT_OK;
    return status;
}

sonject_status stint_folder_read(struct stint_folder *folder, struct report *report,
                                 const char *path, uint64_t shard, bool drops_damaged)
{
    struct name_list list;
    struct stint_name name;
    memset(folder, 0, sizeof *folder);
    sonject_status status = list_names(report, path, &list);
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
    free_names(&list);
    return status;
}

void stint_folder_clear(struct stint_folder *folder)
{
    for (size_t i = 0; i < folder->count; i++)
        stint_file_close(&folder->files[i]);
    free(folder->files);
    memset(folder, 0, sizeof *folder);
}

sonject_status stint_folder_shards(struct report *report, const char *path, uint64_t but,
                                   uint64_t *shards)
{
    struct name_list list;
    struct stint_name name;
    *shards = 0;
    const sonject_status status = list_names(report, path, &list);
    for (size_t i = 0; *shards == 0 && i < list.count; i++)
        if (parse_name(list.names[i], &name) && name.shards != but)
            *shards = name.shards;
    free_names(&list);
    return status;
}

/* From which file each is reached; its own number where it begins the shard; count: not reached. */
static void reach(const struct stint_folder *folder, uint64_t shard, size_t *from)
{
    bool is_changed = true;
    for (size_t i = 0; i < folder->count; i++)
        from[i] = folder->files[i].head.shard == shard && folder->files[i].end.first == 0
                      ? i
                      : folder->count;
    while (is_changed) {
        is_changed = false;
        for (size_t i = 0; i < folder->count; i++)
            for (size_t k = 0; from[i] < folder->count && k < folder->count; k++)
                if (from[k] == folder->count && folder->files[k].head.shard == shard &&
                    folder->files[k].end.first == folder->files[i].end.last) {
                    from[k] = i;
                    is_changed = true;
                }
    }
}

/* Whether a file's end is farther than another's. */
static bool is_farther(const struct stint_end *end, const struct stint_end *than)
{
    return end->is_last > than->is_last ||
           (end->is_last == than->is_last && end->last > than->last);
}

sonject_status stint_chain_find(struct stint_chain *chain, struct report *report,
                                const struct stint_folder *folder, uint64_t shard)
{
    memset(chain, 0, sizeof *chain);
    size_t *from = allocate_array(folder->count, sizeof *from);
    chain->files = allocate_array(folder->count, sizeof *chain->files);
    if (!from || !chain->files) {
        free(from);
        stint_chain_clear(chain);
        return report_out_of_memory(report, "stints");
    }
    reach(folder, shard, from);
    size_t last = folder->count;
    for (size_t i = 0; i < folder->count; i++)
        if (from[i] < folder->count &&
            (last == folder->count || is_farther(&folder->files[i].end, &folder->files[last].end)))
            last = i;
    if (last < folder->count) {
        chain->next = folder->files[last].end.last;
        chain->is_complete = folder->files[last].end.is_last != 0;
        while (chain->files[chain->count++] = &folder->files[last], from[last] != last)
            last = from[last];
    }
    free(from);
    return SONJECT_OK;
}

void stint_chain_clear(struct stint_chain *chain)
{
    free(chain->files);
    memset(chain, 0, sizeof *chain);
}

void stint_folder_remove(const char *path)
{
    struct report ignored = {{0}, NULL, NULL};
    struct name_list list;
    if (list_names(&ignored, path, &list) != SONJECT_OK)
        return;
    for (size_t i = 0; i < list.count; i++) {
        char *file = strstr(list.names[i], ".stint") ? path_join(path, list.names[i]) : NULL;
        if (file)
            file_discard(file);
        free(file);
    }
    free_names(&list);
    rmdir(path);
}
