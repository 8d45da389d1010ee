/* --shard I/K. */
#ifndef SONJECT_TOOLS_SHARD_ARGUMENT_H
#define SONJECT_TOOLS_SHARD_ARGUMENT_H

#include <stdbool.h>
#include <stdint.h>

/* "2/4": whole numbers, I from 1 to K; NULL leaves both as they are. A message where it is none of
 * that. */
bool shard_parse(const char *verb, const char *text, uint32_t *index, uint32_t *count);

#endif
