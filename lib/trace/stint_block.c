#include "trace/stint_block.h"

#include <string.h>

bool block_digest(struct block_head *head, const void *content)
{
    char digest[HASH_TEXT_CAPACITY];
    struct hash *hash = hash_begin();
    if (!hash)
        return false;
    hash_add(hash, &head->kind, sizeof head->kind);
    hash_add(hash, &head->bytes, sizeof head->bytes);
    hash_add(hash, content, (size_t)head->bytes);
    hash_end(hash, digest);
    memset(head->digest, 0, sizeof head->digest);
    memcpy(head->digest, digest, sizeof digest);
    return true;
}
