/* Files that hold a swath: images, channels of XTF and JSF files, arrays of NumPy, HDF5 and MATLAB
 * files.
 */
#ifndef SONJECT_SWATH_SWATH_FILE_H
#define SONJECT_SWATH_SWATH_FILE_H

#include "base/report.h"
#include "image/raster.h"
#include "swath/recording.h"

struct swath_file;

/* Opens for reading; the file's first bytes tell what it is. channel: of a recording; must be
 * SONJECT_CHANNEL_ONLY for other files. array: its name in an HDF5 or MATLAB file, NULL for the
 * only one; must be NULL for other files. Errors: INPUT (as decoded_image_open and the formats'
 * files say), UNSUPPORTED, STORAGE, MEMORY. On success *file is the caller's, for swath_file_close;
 * on failure NULL. */
sonject_status swath_file_open_array(struct report *report, const char *path, int32_t channel,
                                     const char *array, struct swath_file **file);

/* Whether it is a file of a recording's channels; false also for one that cannot be read. */
bool swath_file_has_channels(const char *path);

/* The same where channel and array may be meant for another file that is opened too, or for both:
 * each takes what its kind has. other: NULL for none. */
sonject_status swath_file_open_beside(struct report *report, const char *path, const char *other,
                                      int32_t channel, const char *array, struct swath_file **file);
void swath_file_close(struct swath_file **file);

void swath_file_layout(const struct swath_file *file, struct raster_layout *layout);

/* NULL: copies keep the file's format and all else that it says. Else they are new images, of which
 * this is the extension. */
const char *swath_file_new_extension(const struct swath_file *file);

/* The quality, 1...100 as libjpeg scales it, whose table for luminance is a JPEG's or close to it;
 * JPEG_QUALITY_UNTOLD where none is; 0 of other files. */
#define JPEG_QUALITY_UNTOLD 95
int swath_file_jpeg_quality(const struct swath_file *file);

/* The largest number that the file may hold where that is less than its type's; 0 elsewhere. */
uint32_t swath_file_largest(const struct swath_file *file);

/* Which range axis a file says that its columns have. */
enum range_axis {
    RANGE_UNKNOWN,
    RANGE_SLANT,
    RANGE_GROUND
};
enum range_axis swath_file_range_axis(const struct swath_file *file);

/* The recording behind it; NULL for other kinds. */
const struct recording *swath_file_recording(const struct swath_file *file);

/* A text that sonject stored with an image, copied into value; false if it has none of that name or
 * it does not fit. */
bool swath_file_attribute(const struct swath_file *file, const char *name, char *value,
                          size_t capacity);

/* Reads a region's stored pixels, row after row, channels interleaved. Errors: INPUT (cut short,
 * damaged), STORAGE, MEMORY. */
sonject_status swath_file_read(struct report *report, struct swath_file *file,
                               const struct region *region, void *pixels);

/* All of them, and how they lie. On success *pixels is for free(), on failure NULL. Errors as of
 * swath_file_read; INPUT for more than 2^31 pixels. */
sonject_status swath_file_read_all(struct report *report, struct swath_file *file,
                                   struct raster_layout *layout, void **pixels);

/* Writes at path a copy of the file with region replaced by pixels, everything else as it was, or
 * a new image (swath_file_new_extension). Published whole or not at all. progress may be NULL.
 * Errors: INPUT, STORAGE, MEMORY, CANCELLED.
 */
sonject_status swath_file_copy_with_patch(struct report *report, const struct swath_file *file,
                                          const char *path, const struct region *region,
                                          const void *pixels, sonject_progress_function progress,
                                          void *user);

#endif
