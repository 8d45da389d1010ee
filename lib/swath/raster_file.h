/* New image files, by libtiff, libpng, libjpeg, HDF5, and as NumPy arrays. What reads them is
 * the decoder (swath/decoder.h). */
#ifndef SONJECT_SWATH_RASTER_FILE_H
#define SONJECT_SWATH_RASTER_FILE_H

#include "base/report.h"
#include "image/raster.h"
#include "swath/decoder.h"
#include "swath/image_head.h"

/* A named text that is stored with an image, as a line "name=value" of its description. Neither
 * part may hold a newline. */
struct raster_attribute {
    const char *name;
    const char *value;
};

#define GREY_ATTRIBUTE "sonject:grey"
#define GREY_TEXT      64 /* bytes of its value */

/* Makes pixels, in their place, 8 bit grey levels in dB, black and white at these over full scale.
 * Returns the attribute that tells it, whose value is `text`. */
struct raster_attribute raster_make_grey(struct raster_layout *layout, void *pixels,
                                         const double ends_db[2], char text[GREY_TEXT]);

struct swath_copy;

/* Writes a PNG as the copy of source: its samples, patched, and its description. Streams in strips
 * of at most about 64 MB. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status raster_file_copy_with_patch(struct report *report, struct decoded_image *source,
                                           const struct swath_copy *copy);

/* Writes a whole raster at path; the extension chooses the format. channel_names: layout->channels
 * names, or NULL. Published whole or not at all. Errors: STORAGE, UNSUPPORTED (format), MEMORY. */
sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels);

/* The same of grey pixels of 8 bits as a JPEG of that quality, 1...100. */
sonject_status raster_file_write_jpeg(struct report *report, const char *path,
                                      const struct raster_layout *layout,
                                      const struct raster_attribute *attributes,
                                      size_t attribute_count, const void *pixels, int quality);

/* Writes at path a raster that is 0 everywhere but in region, which gets pixels: masks of a swath
 * that may be larger than memory. palette: PNG_PALETTE_BYTES for the colours of a PNG of 8 bit
 * numbers, which are read as they were written; NULL: grey. Streams as raster_file_copy_with_patch
 * does; published whole or not at all. Errors: STORAGE, UNSUPPORTED (format), MEMORY. */
sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels,
                                        const uint8_t *palette);

/* A NumPy array of a float32, complex64 or whole type, the last index running fastest. Published
 * whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status npy_write(struct report *report, const char *path, enum pixel_type type,
                         bool is_complex, const uint64_t *sides, int side_count,
                         const void *numbers);

/* Writes a new HDF5 file with the one data set "image", complex as r and i, whose attributes the
 * notes become. Published whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels);

/* New files of whole rasters, in formats that lose nothing. */

/* True if files of that extension keep attributes. */
bool raster_format_keeps_attributes(const char *path);

/* Writes the raster: complex where it has 2 channels. Published whole or not at all. Errors: INPUT
 * (the extension tells no format that holds such samples), STORAGE, MEMORY, UNSUPPORTED. */
sonject_status raster_format_write(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels);

#endif
