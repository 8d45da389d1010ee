/* A data set of an open HDF5 file, and its samples in the order that images have. Calls come
 * between hdf5_enter and hdf5_leave. */
#ifndef SONJECT_SWATH_HDF5_SET_H
#define SONJECT_SWATH_HDF5_SET_H

#include "base/hdf5_values.h"
#include "image/raster.h"
#include "swath/hdf5_array.h"
#include "swath/samples.h"

#define HDF5_NAME_MAX 256 /* bytes of a data set's path, the final 0 among them */

enum hdf5_number {
    HDF5_UINT8,
    HDF5_UINT16,
    HDF5_INT16,
    HDF5_FLOAT32,
    HDF5_FLOAT64,
    HDF5_OTHER
};

/* What a data set is. */
struct hdf5_set {
    char name[HDF5_NAME_MAX];
    hsize_t sides[2]; /* in the file's order */
    enum hdf5_number number;
    bool is_complex;
    bool is_matlab;        /* the file's order is columns, rows */
    char part_names[2][8]; /* of a complex one's compound */
};

/* True if its numbers are of a type that sonject reads. */
bool hdf5_set_is_read(const struct hdf5_set *set);

/* Walks through the file's groups and keeps the data set that is wanted. Errors: INPUT. */
sonject_status hdf5_set_choose(struct report *report, const char *path, hid_t file,
                               const char *wanted, struct hdf5_set *set);

/* Checks how its samples are stored. Errors: INPUT (in other files, never filled, unknown filters).
 */
sonject_status hdf5_set_check_storage(struct report *report, const char *path, hid_t dataset);

/* The type in memory: numbers, or pairs of them. To be closed by H5Tclose. */
hid_t hdf5_set_memory_type(const struct hdf5_set *set);

#endif
