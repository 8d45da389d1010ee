#define _POSIX_C_SOURCE 200809L
#include "base/folder.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

#define NAMES_MAX ((size_t)1 << 20)

void folder_names_clear(struct folder_names *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->names[i]);
    free(list->names);
    memset(list, 0, sizeof *list);
}

static bool add_name(struct folder_names *list, const char *name)
{
    if ((list->count & (list->count + 1)) == 0) { /* 0, 1, 3, 7...: room for twice as many */
        char **more = list->count < NAMES_MAX
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

static bool is_wanted(const char *name, const char *prefix)
{
    return strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
           strncmp(name, prefix, strlen(prefix)) == 0;
}

sonject_status folder_names_read(struct folder_names *list, struct report *report, const char *path,
                                 const char *prefix)
{
    memset(list, 0, sizeof *list);
    DIR *folder = opendir(path);
    if (!folder)
        return errno == ENOENT || errno == ENOTDIR ? SONJECT_OK
                                                   : file_failure(report, path, "read", errno);
    sonject_status status = SONJECT_OK;
    struct dirent *entry;
    while (status == SONJECT_OK && (errno = 0, entry = readdir(folder)) != NULL)
        if (is_wanted(entry->d_name, prefix) && !add_name(list, entry->d_name))
            status = report_out_of_memory(report, path);
    if (status == SONJECT_OK && errno != 0)
        status = file_failure(report, path, "read", errno);
    closedir(folder);
    if (status != SONJECT_OK)
        folder_names_clear(list);
    else if (list->count > 0)
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    return status;
}
