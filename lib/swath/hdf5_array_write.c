/* New HDF5 files of one array. */
#include <errno.h>
#include <stdlib.h>

#include "base/file.h"
#include "swath/hdf5_set.h"

static hid_t create_set(hid_t file, const struct raster_layout *layout, hid_t type)
{
    const hsize_t sides[2] = {layout->rows, layout->columns};
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hid_t set = -1;
    if (space >= 0 && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        set = H5Dcreate2(file, "image", type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (creation >= 0)
        H5Pclose(creation);
    if (space >= 0)
        H5Sclose(space);
    return set;
}

static bool fill_file(hid_t file, const struct raster_layout *layout,
                      const struct raster_attribute *notes, size_t note_count, const void *pixels)
{
    const struct hdf5_set described = {
        .number = layout->type == PIXEL_UINT8    ? HDF5_UINT8
                  : layout->type == PIXEL_UINT16 ? HDF5_UINT16
                                                 : HDF5_FLOAT32,
        .is_complex = layout->channels == 2,
        .part_names = {"r", "i"},
    };
    const hid_t type = hdf5_set_memory_type(&described);
    const hid_t set = type < 0 ? -1 : create_set(file, layout, type);
    bool is_done = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pixels) >= 0;
    for (size_t i = 0; is_done && i < note_count; i++)
        is_done = hdf5_write_text(set, notes[i].name, notes[i].value);
    is_done = is_done && H5Fflush(file, H5F_SCOPE_LOCAL) >= 0;
    if (!is_done)
        hdf5_abandon(file);
    if (set >= 0)
        H5Dclose(set);
    if (type >= 0)
        H5Tclose(type);
    return is_done;
}

static bool write_part(const char *part, const struct raster_layout *layout,
                       const struct raster_attribute *notes, size_t note_count, const void *pixels)
{
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    const hid_t file = creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0
                           ? H5Fcreate(part, H5F_ACC_TRUNC, creation, H5P_DEFAULT)
                           : -1;
    bool is_done = file >= 0 && fill_file(file, layout, notes, note_count, pixels);
    if (file >= 0)
        is_done = H5Fclose(file) >= 0 && is_done;
    if (creation >= 0)
        H5Pclose(creation);
    return is_done;
}

sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels)
{
    struct hdf5_session session;
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a file name");
    hdf5_enter(&session);
    errno = 0;
    const bool is_done = write_part(part, layout, notes, note_count, pixels);
    const int error = errno;
    hdf5_leave(&session);
    sonject_status status = SONJECT_OK;
    if (is_done) {
        status = file_publish(report, part, path);
    } else {
        file_discard(part);
        status = error != 0 ? file_failure(report, path, "write", error)
                            : report_failure(report, SONJECT_ERROR_STORAGE,
                                             "%s: cannot write: HDF5 failed", path);
    }
    free(part);
    return status;
}
