/* Numbers on the command line: whole texts only, the same in every locale. */
#ifndef SONJECT_TOOLS_NUMBER_H
#define SONJECT_TOOLS_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* A finite decimal number such as "-2.5e3". */
bool number_parse(const char *text, double *value);

/* Decimal digits, up to 2^64 - 1. */
bool whole_number_parse(const char *text, uint64_t *value);

#endif
