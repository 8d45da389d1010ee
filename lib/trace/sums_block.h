/* Blocks, which files of tallies are made of: see sums_file.h. */
#ifndef SONJECT_TRACE_SUMS_BLOCK_H
#define SONJECT_TRACE_SUMS_BLOCK_H

#include "trace/sums_file.h"

#define SUMS_MAGIC       "sonject sums 03\n"
#define SUMS_MAGIC_BYTES 16

enum block_kind {
    BLOCK_HEAD = 1,
    BLOCK_SUMS = 2,
    BLOCK_END = 3
};

struct block_head {
    uint64_t kind, bytes;
    char digest[SUMS_DIGEST_CAPACITY];
};

typedef char block_head_is_packed[sizeof(struct block_head) == 56 ? 1 : -1];
typedef char sums_head_is_packed[sizeof(struct sums_head) == 176 ? 1 : -1];
typedef char sums_end_is_packed[sizeof(struct sums_end) == 96 ? 1 : -1];

/* Fills in the digest of a block whose kind and number of bytes are there. False where memory
 * lacks.
 */
bool block_digest(struct block_head *head, const void *content);

#endif
