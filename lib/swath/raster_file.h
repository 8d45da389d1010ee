/* New image files, by libtiff, libpng, libjpeg, HDF5, and as NumPy arrays. The decoder
 * (swath/decoder.h) reads image files. */
#ifndef SONJECT_SWATH_RASTER_FILE_H
#define SONJECT_SWATH_RASTER_FILE_H

#include "base/report.h"
#include "image/canvas.h"
#include "image/raster.h"
#include "swath/decoder.h"
#include "swath/image_head.h"

/* The note of the largest number that a file may hold, if that is not its type's. */
#define FULL_SCALE_NOTE "sonject:full_scale"

/* A named text that is stored with an image, as a line "name=value" of its description. Neither
 * part may hold a newline. */
struct raster_attribute {
    const char *name;
    const char *value;
};

#define GREY_ATTRIBUTE "sonject:grey"
#define GREY_TEXT      64 /* bytes of the attribute's value */

/* Converts pixels in place to 8 bit grey levels in dB. ends_db: black and white over full_scale.
 * Notes if most pixels are white or black, unless report is NULL. Returns an attribute that tells
 * the levels, with the value `text`. */
struct raster_attribute raster_make_grey(struct report *report, struct raster_layout *layout,
                                         void *pixels, double full_scale, const double ends_db[2],
                                         char text[GREY_TEXT]);

struct swath_copy;

/* Writes a patched copy of source as PNG, with the same description. Streams in strips of at most
 * about 64 MB. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status raster_file_copy_with_patch(struct report *report, struct decoded_image *source,
                                           const struct swath_copy *copy);

/* Writes a raster to path; the extension chooses the format. channel_names: layout->channels names,
 * or NULL. The file appears whole or not at all. Errors: STORAGE, UNSUPPORTED (format), MEMORY. */
sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels);

/* Writes 8 bit grey pixels as raster_file_write does, as a JPEG of quality 1...100. */
sonject_status raster_file_write_jpeg(struct report *report, const char *path,
                                      const struct raster_layout *layout,
                                      const struct raster_attribute *attributes,
                                      size_t attribute_count, const void *pixels, int quality);

/* Writes a drawn picture if the drawing's status is OK, and frees its pixels. Returns status, or
 * the failure to write, as raster_file_write. */
sonject_status picture_write(struct report *report, sonject_status status, struct canvas *picture,
                             const char *path);

/* Writes to path a raster that is 0 except in region, which gets pixels: masks of a swath that may
 * be larger than memory. palette: PNG_PALETTE_BYTES for the colours of a PNG of 8 bit numbers,
 * which are read as they were written; NULL: grey. Streams as raster_file_copy_with_patch does. The
 * file appears whole or not at all. Errors: STORAGE, UNSUPPORTED (format), MEMORY. */
sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels,
                                        const uint8_t *palette);

/* Writes a NumPy array of float32, complex64 or an integer type; the last index runs fastest. The
 * file appears whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status npy_write(struct report *report, const char *path, enum pixel_type type,
                         bool is_complex, const uint64_t *sides, int side_count,
                         const void *numbers);

/* Writes a new HDF5 file with one data set, "image", complex as r and i. The notes become its
 * attributes. The file appears whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels);

/* New files of whole rasters, in lossless formats. */

/* Returns whether files of that extension keep attributes. */
bool raster_format_keeps_attributes(const char *path);

/* Writes the raster, complex if it has 2 channels. The file appears whole or not at all. Errors:
 * INPUT (the extension names no format for such samples), STORAGE, MEMORY, UNSUPPORTED. */
sonject_status raster_format_write(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels);

#endif
