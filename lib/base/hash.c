#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

struct hash {
    XXH3_state_t *state;
};

struct hash *hash_begin(void)
{
    struct hash *hash = malloc(sizeof *hash);
    if (!hash)
        return NULL;
    hash->state = XXH3_createState();
    if (!hash->state || XXH3_128bits_reset(hash->state) != XXH_OK) {
        XXH3_freeState(hash->state);
        free(hash);
        return NULL;
    }
    return hash;
}

void hash_add(struct hash *hash, const void *bytes, size_t count)
{
    if (count > 0)
        XXH3_128bits_update(hash->state, bytes, count);
}

void hash_add_text(struct hash *hash, const char *text)
{
    if (text)
        hash_add(hash, text, strlen(text) + 1);
}

void hash_restart(struct hash *hash, char text[HASH_TEXT_CAPACITY])
{
    const XXH128_hash_t digest = XXH3_128bits_digest(hash->state);
    snprintf(text, HASH_TEXT_CAPACITY, "%016llx%016llx", (unsigned long long)digest.high64,
             (unsigned long long)digest.low64);
    XXH3_128bits_reset(hash->state);
}

void hash_end(struct hash *hash, char text[HASH_TEXT_CAPACITY])
{
    hash_restart(hash, text);
    XXH3_freeState(hash->state);
    free(hash);
}
