/* What the fuzzers share. A fuzzer gives a reader whatever bytes libFuzzer thinks of; the reader
 * must take them or say in one line why not, and hold nothing after a failure. */
#ifndef SONJECT_TESTS_FUZZ_H
#define SONJECT_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

/* libFuzzer's entry: 0. Each fuzzer defines it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

/* Writes the file, which is not flushed to disk. Ends the program if that fails. */
void fuzz_write(const char *path, const uint8_t *bytes, size_t count);

/* A copy with one 0 byte beyond it, of just that size, so that reading on is found; for free(). */
char *fuzz_text(const uint8_t *bytes, size_t count);

/* Ends the program unless the status is OK, or one that bad input may have with one line of
 * message. */
void fuzz_expect(sonject_status status, const struct report *report);

/* The same, with a line for each mistake. */
void fuzz_expect_lines(sonject_status status, const struct report *report);

#endif
