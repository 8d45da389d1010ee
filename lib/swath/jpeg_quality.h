/* How coarsely a JPEG is coded. */
#ifndef SONJECT_SWATH_JPEG_QUALITY_H
#define SONJECT_SWATH_JPEG_QUALITY_H

#define JPEG_QUALITY_UNTOLD 95

/* The quality, 1...100 as the Independent JPEG Group's library scales it, whose table for luminance
 * is the file's or close to it; JPEG_QUALITY_UNTOLD where none is; 0 where the file is no JPEG. */
int jpeg_quality(const char *path);

#endif
