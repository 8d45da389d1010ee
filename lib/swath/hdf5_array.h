/* Two-dimensional data sets of HDF5 files: float64, float32, uint8, uint16 or int16, or complex, a
 * compound of two equal floats r and i (h5py's) or real and imag (MATLAB's). Rows are the first
 * index; in data sets of MATLAB (v7.3, told by the attribute MATLAB_class), which keeps its columns
 * together, rows are MATLAB's, the second index. */
#ifndef SONJECT_IO_HDF5_ARRAY_H
#define SONJECT_IO_HDF5_ARRAY_H

#include <sonject/context.h>

#include "base/report.h"
#include "image/raster.h"
#include "swath/raster_file.h"

struct hdf5_array;

/* A file that is open, and the data set in it that was chosen; read and changed by what the decoder
 * does (swath/decoder.h). */
struct hdf5_array;

/* Opens a data set of the file at place, path in messages, by its path within the file; NULL: the
 * only one of more than one row and column. Refused (INPUT): a damaged file, no such data set or
 * several (lists them), other types, data in other files, filters that sonject does not know or
 * that change numbers. Links are not followed. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED. On
 * success *array is the caller's, for hdf5_array_close; on failure NULL. */
sonject_status hdf5_array_open(struct report *report, const char *path, const char *place,
                               const char *name, bool writes, struct hdf5_array **array);

/* Changes of a file that was not finished go nowhere. */
void hdf5_array_close(struct hdf5_array **array);

void hdf5_array_layout(const struct hdf5_array *array, struct raster_layout *layout);

/* Whether columns lie together. */
bool hdf5_array_is_turned(const struct hdf5_array *array);

/* 32767 of int16, 0 of other types. */
uint32_t hdf5_array_largest(const struct hdf5_array *array);

/* A text attribute of the data set, to be given to free(); false if it has none of that name. */
bool hdf5_array_attribute(const struct hdf5_array *array, const char *name, char **value);

/* Samples of a region, row after row. Errors: INPUT (cut short, damaged, a negative whole number),
 * STORAGE, MEMORY. */
sonject_status hdf5_array_read(struct report *report, const struct hdf5_array *array,
                               const struct region *region, void *pixels);

/* Replaces them. A float64 whose value as a float32 stays the same keeps all its bits. */
sonject_status hdf5_array_change(struct report *report, const struct hdf5_array *array,
                                 const struct region *region, const void *pixels);

/* Brings all changes to the file and closes it. Errors: STORAGE, INPUT. */
sonject_status hdf5_array_finish(struct report *report, struct hdf5_array *array);

/* Writes a new file with the one data set "image", complex as r and i, whose attributes
 * the notes become. Published whole or not at
 * all. Errors: STORAGE, MEMORY, UNSUPPORTED (builds without HDF5). */
sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels);

#endif
