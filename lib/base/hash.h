/* 128-bit hashes (XXH3) for telling whether inputs are the same; not for security. */
#ifndef SONJECT_BASE_HASH_H
#define SONJECT_BASE_HASH_H

#include <stdbool.h>
#include <stddef.h>

#define HASH_TEXT_CAPACITY 33 /* 32 hexadecimal digits and the terminator */

struct hash;

/* Returns NULL if out of memory. */
struct hash *hash_begin(void);
void hash_add(struct hash *hash, const void *bytes, size_t count);

/* Adds a text with its terminator, so that "ab","c" differs from "a","bc"; NULL adds nothing. */
void hash_add_text(struct hash *hash, const char *text);

/* Writes the digits and starts again. */
void hash_restart(struct hash *hash, char text[HASH_TEXT_CAPACITY]);

/* Writes the digits and frees the hash. */
void hash_end(struct hash *hash, char text[HASH_TEXT_CAPACITY]);

#endif
