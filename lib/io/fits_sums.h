/* What the header of a FITS file may say of the sums over its bytes: DATASUM, over the numbers, and
 * CHECKSUM, which makes the sum over header and numbers come out right. */
#ifndef SONJECT_IO_FITS_SUMS_H
#define SONJECT_IO_FITS_SUMS_H

#include <stdio.h>

#include "base/report.h"

#define FITS_BLOCK_BYTES 2880
#define FITS_CARD_BYTES  80

/* Puts right what a copy with other numbers says; nothing where it says nothing. copy: open for
 * reading and writing. header_bytes: of both, in whole blocks. path: of the source, name: of the
 * copy, for messages. Errors: INPUT (the source's sums are wrong: it is damaged), STORAGE. */
sonject_status fits_sums_update(struct report *report, FILE *source, FILE *copy,
                                uint64_t header_bytes, uint64_t data_bytes, const char *path,
                                const char *name);

#endif
