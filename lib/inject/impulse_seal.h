/* The first 512 bytes of a file of impulses, which HDF5 leaves to others (its user block): a line
 * "sonject impulses, XXH3 " and 32 hexadecimal digits, the hash of all bytes that follow the block,
 * and zeros. HDF5 may stumble over a file that is damaged, so it is given none. */
#ifndef SONJECT_INJECT_IMPULSE_SEAL_H
#define SONJECT_INJECT_IMPULSE_SEAL_H

#include "base/report.h"

#define IMPULSE_SEAL_BYTES 512

/* Writes the block into a file whose other bytes are there. Errors: STORAGE (the message names
 * path), MEMORY. */
sonject_status impulse_seal_write(struct report *report, const char *file, const char *path);

/* Reads the file once through. Errors: INPUT (no such block, not that hash), STORAGE, MEMORY. */
sonject_status impulse_seal_check(struct report *report, const char *path);

#endif
