/* Files that a document names, with what tells them from others later. */
#ifndef SONJECT_BASE_FILE_LIST_H
#define SONJECT_BASE_FILE_LIST_H

#include <jansson.h>

#include "base/hash.h"
#include "base/report.h"

/* Digest of a regular file's bytes. Errors: STORAGE, MEMORY. */
sonject_status file_hash(struct report *report, const char *path, char text[HASH_TEXT_CAPACITY]);

/* A file under a name: {"name", "bytes", "xxh3"}, and "changed_ns" (since 1970) if it is to have
 * the time of its last change. For json_decref. Errors: STORAGE, MEMORY. */
sonject_status file_entry(struct report *report, const char *path, const char *name, bool has_time,
                          json_t **entry);

/* Whether the file is as an entry says: of the size, and of the hash; that of a file of 16 MB or
 * more counts as the same where the time is, unless all are hashed. A file that is not there is
 * not. Errors: STORAGE (it cannot be read), MEMORY. */
sonject_status file_entry_holds(struct report *report, const json_t *entry, const char *path,
                                bool hashes_all, bool *holds);

/* Adds the entry of a file of a folder, or of one below it. Errors: STORAGE, MEMORY. */
sonject_status file_list_add(json_t **list, struct report *report, const char *folder,
                             const char *name, bool has_time);

/* Whether all files of a list are in the folder as it says; *name is of the first that is not, NULL
 * where all are, and the list's. Errors: STORAGE, MEMORY. */
sonject_status file_list_check(const json_t *list, struct report *report, const char *folder,
                               bool hashes_all, const char **name);

/* Removes the files of a list from the folder but for those that another list names, too. Never
 * fails. */
void file_list_discard(const json_t *list, const json_t *kept, const char *folder);

#endif
