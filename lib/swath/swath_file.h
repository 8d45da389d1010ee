/* Files that hold a swath: images, XTF and JSF channels, arrays of NumPy, HDF5 and MATLAB files. */
#ifndef SONJECT_SWATH_SWATH_FILE_H
#define SONJECT_SWATH_SWATH_FILE_H

#include "base/report.h"
#include "image/raster.h"
#include "swath/recording.h"

struct swath_file;

/* Opens a file for reading. The first bytes tell the format. channel: a recording's channel; must
 * be SONJECT_CHANNEL_ONLY for other files. array: a name in an HDF5 or MATLAB file, NULL for the
 * only array; must be NULL for other files. Errors: INPUT (see decoded_image_open and the formats'
 * files), UNSUPPORTED, STORAGE, MEMORY. On success *file is the caller's, for swath_file_close; on
 * failure *file is NULL. */
sonject_status swath_file_open_array(struct report *report, const char *path, int32_t channel,
                                     const char *array, struct swath_file **file);

/* Returns whether the file is a recording with channels. False also if the file cannot be read. */
bool swath_file_has_channels(const char *path);

/* Opens a file where channel and array may be meant for another file that is opened too, or for
 * both. Each file takes what its format has. other: the other file's path; NULL for none. */
sonject_status swath_file_open_beside(struct report *report, const char *path, const char *other,
                                      int32_t channel, const char *array, struct swath_file **file);
void swath_file_close(struct swath_file **file);

void swath_file_layout(const struct swath_file *file, struct raster_layout *layout);

/* Returns NULL if copies keep the file's format and all its other contents. Otherwise copies are
 * new images, and the extension of these is returned. */
const char *swath_file_new_extension(const struct swath_file *file);

/* Returns the quality, 1...100 on libjpeg's scale, whose luminance table is a JPEG file's or close
 * to it. Returns JPEG_QUALITY_UNTOLD if no table is close, 0 for other files. */
#define JPEG_QUALITY_UNTOLD 95
int swath_file_jpeg_quality(const struct swath_file *file);

/* Returns the largest number that the file may hold if that is less than its type's; else 0. */
uint32_t swath_file_largest(const struct swath_file *file);

/* Returns that number, or the full scale of the type. */
double swath_file_full_scale(const struct swath_file *file);

/* Lowers a transfer function's full scale to the largest number that the file may hold. */
void swath_file_limit(const struct swath_file *file, sonject_transfer_params *transfer);

/* The range axis that a file states for its columns. */
enum range_axis {
    RANGE_UNKNOWN,
    RANGE_SLANT,
    RANGE_GROUND
};
enum range_axis swath_file_range_axis(const struct swath_file *file);

/* Returns the recording in the file; NULL for other files. */
const struct recording *swath_file_recording(const struct swath_file *file);

/* Copies to value a text that sonject stored with an image. Returns false if there is no text of
 * that name or value is too short. */
bool swath_file_attribute(const struct swath_file *file, const char *name, char *value,
                          size_t capacity);

/* Makes reading refuse (INPUT) integers that float32 would round. */
void swath_file_refuse_rounding(struct swath_file *file);

/* Reads a region's stored pixels, row after row, channels interleaved. Errors: INPUT (cut short,
 * damaged), STORAGE, MEMORY. */
sonject_status swath_file_read(struct report *report, struct swath_file *file,
                               const struct region *region, void *pixels);

/* Reads all pixels and their layout. On success *pixels is the caller's, for free(); on failure
 * *pixels is NULL. Errors: those of swath_file_read; INPUT for more than 2^31 pixels. */
sonject_status swath_file_read_all(struct report *report, struct swath_file *file,
                                   struct raster_layout *layout, void **pixels);

/* Writes a copy of the file to path, with region replaced by pixels. Everything else stays, or the
 * copy is a new image (swath_file_new_extension). The copy appears whole or not at all. progress
 * may be NULL. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status swath_file_copy_with_patch(struct report *report, const struct swath_file *file,
                                          const char *path, const struct region *region,
                                          const void *pixels, sonject_progress_function progress,
                                          void *user);

#endif
