/* --transfer KIND[:P[:OFFSET]] */
#ifndef SONJECT_TOOLS_TRANSFER_ARGUMENT_H
#define SONJECT_TOOLS_TRANSFER_ARGUMENT_H

#include <stdbool.h>
#include <stddef.h>

#include <sonject/image.h>

#define TRANSFER_NOTES                                                                             \
    "Transfer functions: amplitude, intensity, decibel:DB_PER_UNIT[:OFFSET_DB], gamma:EXPONENT,\n" \
    "schlick:B."

/* Copies the piece of text up to the colon and gives what follows it, NULL at the end. */
const char *next_piece(const char *text, char *piece, size_t capacity);

/* Reads a transfer function; false after a message, which names the verb. */
bool transfer_parse(const char *verb, const char *text, sonject_transfer_params *transfer);

#endif
