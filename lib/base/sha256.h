/* SHA-256 (FIPS 180-4) of files, for documents that ask for it. */
#ifndef SONJECT_BASE_SHA256_H
#define SONJECT_BASE_SHA256_H

#include "base/report.h"

#define SHA256_TEXT_CAPACITY 65 /* 64 hexadecimal digits and the terminator */

/* Writes the digest of a file. Errors: STORAGE. */
sonject_status file_sha256(struct report *report, const char *path,
                           char text[SHA256_TEXT_CAPACITY]);

#endif
