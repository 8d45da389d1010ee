/* What the heads of BMP, PGM and PFM files say, beside how long the files are: these formats have
 * no checksums, and OpenImageIO takes what their heads say. */
#ifndef SONJECT_SWATH_PLAIN_HEAD_H
#define SONJECT_SWATH_PLAIN_HEAD_H

#include "base/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Refuses (INPUT) files whose length is not what the head says, and numbers that OpenImageIO would
 * not hand on as they are stored: those of a PGM that is not of 8 bits are scaled there, so that
 * half of a 16-bit one's come out by one too small. */
sonject_status bmp_check(struct report *report, const char *path);
sonject_status pnm_check(struct report *report, const char *path);

#ifdef __cplusplus
}
#endif

#endif
