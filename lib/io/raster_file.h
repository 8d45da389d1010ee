/* Image files by OpenImageIO. Implemented in C++; no exception leaves it. */
#ifndef SONJECT_IO_RASTER_FILE_H
#define SONJECT_IO_RASTER_FILE_H

#include "base/report.h"
#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

struct raster_file;

/* A named text that is stored with an image, as a line "name=value" of its description. Neither
 * part may hold a newline. */
struct raster_attribute {
    const char *name;
    const char *value;
};

/* Opens for reading. Refuses (INPUT, with the file's name and what to do): what OpenImageIO cannot
 * read, more than 2^40 pixels, dimensions of 0, pixel types other than 8 and 16 bit unsigned and 32
 * bit float, palettes, channel counts other than 1 and 2. A missing file is INPUT as well. On
 * success *file is the caller's, for raster_file_close; on failure NULL. */
sonject_status raster_file_open(struct report *report, const char *path, struct raster_file **file);
void raster_file_close(struct raster_file **file);

void raster_file_layout(const struct raster_file *file, struct raster_layout *layout);

/* False where writing the format changes pixels (JPEG). */
bool raster_file_is_lossless(const struct raster_file *file);

/* Such a text of the open image, copied into value; false if it has none of that name or it does
 * not fit. */
bool raster_file_attribute(const struct raster_file *file, const char *name, char *value,
                           size_t capacity);

/* Reads a region's stored pixels, row after row, channels interleaved. Holds no more than the tiles
 * or scanlines of the region in memory, but all of a JPEG 2000. Errors: INPUT (cut short, damaged),
 * MEMORY. */
sonject_status raster_file_read(struct report *report, struct raster_file *file,
                                const struct region *region, void *pixels);

/* Writes at path a copy of source with region replaced by pixels: same format, type, tiling,
 * compression and metadata. Streams in strips of at most about 64 MB. path is published whole or
 * not at all. progress may be NULL. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status raster_file_copy_with_patch(struct report *report, const char *source,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user);

/* Writes a whole raster at path; the extension chooses the format. channel_names: layout->channels
 * names, or NULL. Published whole or not at all. Errors: STORAGE, UNSUPPORTED (format), MEMORY. */
sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels);

/* Writes at path a raster that is 0 everywhere but in region, which gets pixels: masks of a swath
 * that may be larger than memory. palette: PNG_PALETTE_BYTES for the colours of a PNG of 8 bit
 * numbers, which are read as they were written; NULL: grey. Streams as raster_file_copy_with_patch
 * does; published whole or not at all. Errors: STORAGE, UNSUPPORTED (format), MEMORY. */
sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels,
                                        const uint8_t *palette);

#ifdef __cplusplus
}
#endif

#endif
