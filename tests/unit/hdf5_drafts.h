/* Data sets of HDF5 files in the making. */
#ifndef SONJECT_TESTS_HDF5_DRAFTS_H
#define SONJECT_TESTS_HDF5_DRAFTS_H

#include "base/hdf5_values.h"
#include "claims.h"

/* sides[0] x sides[1] doubles, or pairs of them with those names; in chunks with all filters where
 * these have sides. axis: a note of the range axis, NULL: none. */
static inline void put_set(hid_t parent, const char *name, const hsize_t sides[2],
                           const double *numbers, const char *const *pair, bool is_matlab,
                           const hsize_t *chunk, const char *axis)
{
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t type = pair ? H5Tcreate(H5T_COMPOUND, 16) : H5Tcopy(H5T_NATIVE_DOUBLE);
    for (size_t i = 0; pair && i < 2; i++)
        H5Tinsert(type, pair[i], 8 * i, H5T_NATIVE_DOUBLE);
    if (chunk) {
        H5Pset_chunk(creation, 2, chunk);
        H5Pset_shuffle(creation);
        H5Pset_deflate(creation, 4);
        H5Pset_fletcher32(creation);
    }
    const hid_t set = H5Dcreate2(parent, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
    assert_true(!axis || hdf5_write_text(set, "sonject:range_axis", axis));
    assert_true(!is_matlab || hdf5_write_text(set, "MATLAB_class", "double"));
    H5Dclose(set);
    H5Tclose(type);
    H5Pclose(creation);
    H5Sclose(space);
}

#endif
