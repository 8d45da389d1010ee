#include "cl/cache.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"

#define CACHE_FILE_LIMIT ((size_t)256 << 20)

char *cache_folder_for(const char *asked)
{
    if (asked)
        return asked[0] ? copy_text(asked) : NULL;
    const char *cache = getenv("XDG_CACHE_HOME");
    if (cache && cache[0] == '/')
        return path_join(cache, "sonject");
    const char *home = getenv("HOME");
    return home && home[0] ? path_join(home, ".cache/sonject") : NULL;
}

static char *path_of(const char *folder, const char *key)
{
    char name[HASH_TEXT_CAPACITY + 8];
    snprintf(name, sizeof name, "%s.bin", key);
    return path_join(folder, name);
}

/* A file is the digest of what follows, then the program. */
static bool digest_of(const unsigned char *bytes, size_t count, char digest[HASH_TEXT_CAPACITY])
{
    struct hash *hash = hash_begin();
    if (!hash)
        return false;
    hash_add(hash, bytes, count);
    hash_end(hash, digest);
    return true;
}

bool cache_read(const char *folder, const char *key, unsigned char **bytes, size_t *count)
{
    struct report ignored = {{0}, NULL, NULL};
    const size_t head = HASH_TEXT_CAPACITY - 1;
    char digest[HASH_TEXT_CAPACITY];
    char *file = NULL;
    size_t size = 0;
    char *path = path_of(folder, key);
    *bytes = NULL;
    if (path && file_exists(path) &&
        file_read_whole(&ignored, path, CACHE_FILE_LIMIT, &file, &size) == SONJECT_OK &&
        size > head && digest_of((unsigned char *)file + head, size - head, digest) &&
        memcmp(file, digest, head) == 0) {
        *count = size - head;
        *bytes = malloc(*count);
        if (*bytes)
            memcpy(*bytes, file + head, *count);
    }
    free(file);
    free(path);
    return *bytes != NULL;
}

void cache_write(const char *folder, const char *key, const unsigned char *bytes, size_t count)
{
    struct report ignored = {{0}, NULL, NULL};
    const size_t head = HASH_TEXT_CAPACITY - 1;
    char digest[HASH_TEXT_CAPACITY];
    char *path = path_of(folder, key);
    unsigned char *file = allocate_array(head + count, 1);
    if (path && file && digest_of(bytes, count, digest) &&
        folder_make(&ignored, folder) == SONJECT_OK) {
        memcpy(file, digest, head);
        memcpy(file + head, bytes, count);
        (void)file_write_whole(&ignored, path, file, head + count);
    }
    free(file);
    free(path);
}
