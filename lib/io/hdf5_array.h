/* Two-dimensional data sets of HDF5 files: float64, float32, uint8, uint16 or int16, or complex, a
 * compound of two equal floats r and i (h5py's) or real and imag (MATLAB's). Rows are the first
 * index; in data sets of MATLAB (v7.3, told by the attribute MATLAB_class), which keeps its columns
 * together, rows are MATLAB's, the second index. */
#ifndef SONJECT_IO_HDF5_ARRAY_H
#define SONJECT_IO_HDF5_ARRAY_H

#include <sonject/context.h>

#include "base/report.h"
#include "image/raster.h"
#include "io/raster_file.h"

struct hdf5_array;

/* Opens a data set by its path within the file; NULL: the only one of more than one row and column.
 * Refused (INPUT): a damaged file, no such data set or several (lists them), other types, data in
 * other files, filters that sonject does not know or that change numbers. Links are not followed.
 * Errors: INPUT, MEMORY, UNSUPPORTED (builds without HDF5). On success *array is the caller's, for
 * hdf5_array_close; on failure NULL. */
sonject_status hdf5_array_open(struct report *report, const char *path, const char *name,
                               struct hdf5_array **array);
void hdf5_array_close(struct hdf5_array **array);

void hdf5_array_layout(const struct hdf5_array *array, struct raster_layout *layout);

/* 32767 of int16, 0 of other types. */
uint32_t hdf5_array_largest(const struct hdf5_array *array);

/* A text attribute of the data set, copied into value; false if it has none of that name or it does
 * not fit. */
bool hdf5_array_attribute(const struct hdf5_array *array, const char *name, char *value,
                          size_t capacity);

/* Samples of a region, row after row. Errors: INPUT (cut short, damaged, a negative whole number),
 * MEMORY. */
sonject_status hdf5_array_read(struct report *report, const struct hdf5_array *array,
                               const struct region *region, void *pixels);

/* Writes at path a copy of the file with the region's samples replaced; HDF5 itself changes them in
 * a copy of all bytes. A float64 whose value as a float32 stays the same keeps all its bits.
 * Published whole or not at all. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status hdf5_array_copy_with_patch(struct report *report, const struct hdf5_array *array,
                                          const char *path, const struct region *region,
                                          const void *pixels, sonject_progress_function progress,
                                          void *user);

/* Writes a new file with the one data set "image", complex as r and i, whose attributes
 * the notes become. Published whole or not at
 * all. Errors: STORAGE, MEMORY, UNSUPPORTED (builds without HDF5). */
sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels);

#endif
