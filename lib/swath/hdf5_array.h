/* Two-dimensional data sets of HDF5 files: float64, float32, uint8, uint16 or int16, or complex, a
 * compound of two equal floats r and i (h5py's) or real and imag (MATLAB's). Rows are the first
 * index; in data sets of MATLAB (v7.3, told by the attribute MATLAB_class), which keeps its columns
 * together, rows are MATLAB's, the second index. */
#ifndef SONJECT_SWATH_HDF5_ARRAY_H
#define SONJECT_SWATH_HDF5_ARRAY_H

#include "swath/image_library.h"
#include "swath/raster_file.h"

/* What reads and changes them. Refused are a damaged file, no such data set or several (lists
 * them), other types, data in other files, filters that sonject does not know or that change
 * numbers. Links are not followed. Errors: UNSUPPORTED (builds without HDF5). */
sonject_status hdf5_library_find(struct report *report, const char *path,
                                 const struct image_library **library);

/* Writes a new file with the one data set "image", complex as r and i, whose attributes
 * the notes become. Published whole or not at
 * all. Errors: STORAGE, MEMORY, UNSUPPORTED (builds without HDF5). */
sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels);

#endif
