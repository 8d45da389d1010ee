#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "swath/hdf5_array.h"

#ifdef HAS_HDF5
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/hdf5_set.h"
#include "swath/samples.h"

#define RUN_BYTES ((size_t)16 << 20) /* of samples in memory at a time, beside the image */

struct hdf5_array {
    char *path;
    struct hdf5_set set;
    struct raster_layout layout;
    hid_t file, dataset;
    bool writes;
};

static hid_t open_file(const char *path, unsigned mode)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const hid_t file = access < 0 ? -1 : H5Fopen(path, mode, access);
    if (access >= 0)
        H5Pclose(access);
    return file;
}

static void set_layout(struct hdf5_array *array)
{
    const struct hdf5_set *set = &array->set;
    array->layout.rows = set->sides[set->is_matlab ? 1 : 0];
    array->layout.columns = set->sides[set->is_matlab ? 0 : 1];
    array->layout.channels = set->is_complex ? 2 : 1;
    array->layout.type = set->number == HDF5_UINT8   ? PIXEL_UINT8
                         : set->number <= HDF5_INT16 ? PIXEL_UINT16
                                                     : PIXEL_FLOAT32;
}

/* The disk's failures, and the limits' of memory, are told from the file's by errno, which is to be
 * 0 before. */
static sonject_status cannot_move(struct report *report, const struct hdf5_array *array)
{
    const int error = errno;
    if (error == ENOMEM)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: reading its array takes more memory than it can if it is sound "
                              "and stored in chunks of some megabytes: store it anew",
                              array->path);
    if (error == ENOSPC || error == EDQUOT || error == EFBIG || file_error_is_of_system(error))
        return file_failure(report, array->path, array->writes ? "copy" : "read", error);
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: its array is cut short or damaged: copy it again", array->path);
}

static sonject_status open_array(struct report *report, struct hdf5_array *array, const char *place,
                                 const char *name)
{
    array->file = open_file(place, array->writes ? H5F_ACC_RDWR : H5F_ACC_RDONLY);
    if (array->file < 0)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: HDF5 cannot open it: it is damaged or cut short (copy it again), or "
            "open for writing elsewhere",
            array->path);
    CHECK(hdf5_set_choose(report, array->path, array->file, name, &array->set));
    if (!hdf5_set_is_read(&array->set))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: the array %s is of a type that sonject does not read: save it "
                              "as float64, float32, uint8, uint16 or int16, complex ones as r and "
                              "i, or real and imag, of float64 or float32",
                              array->path, array->set.name);
    array->dataset = H5Dopen2(array->file, array->set.name, H5P_DEFAULT);
    if (array->dataset < 0)
        return cannot_move(report, array);
    set_layout(array);
    return hdf5_set_check_storage(report, array->path, array->dataset);
}

static void close_array(void *image)
{
    struct hdf5_array *array = image;
    struct hdf5_session session;
    hdf5_enter(&session);
    if (array->writes && array->file >= 0)
        hdf5_abandon(array->file);
    if (array->dataset >= 0)
        H5Dclose(array->dataset);
    if (array->file >= 0)
        H5Fclose(array->file);
    hdf5_leave(&session);
    free(array->path);
    free(array);
}

static sonject_status open_image(struct report *report, const char *name, const char *path,
                                 const char *array, bool writes, void **image,
                                 struct image_facts *facts)
{
    struct hdf5_session session;
    struct hdf5_array *opened = allocate_array(1, sizeof *opened);
    *image = NULL;
    if (opened)
        opened->path = copy_text(name);
    if (!opened || !opened->path) {
        free(opened);
        return report_out_of_memory(report, "a file");
    }
    opened->file = opened->dataset = -1;
    opened->writes = writes;
    hdf5_enter(&session);
    const sonject_status status = open_array(report, opened, path, array);
    hdf5_leave(&session);
    if (status != SONJECT_OK) {
        close_array(opened);
        return status;
    }
    *image = opened;
    facts->layout = opened->layout;
    facts->largest = opened->set.number == HDF5_INT16 ? INT16_MAX : 0;
    facts->is_turned = opened->set.is_matlab;
    return SONJECT_OK;
}

static char *read_attribute(void *image, const char *name)
{
    const struct hdf5_array *array = image;
    struct hdf5_session session;
    char *text = NULL;
    hdf5_enter(&session);
    const bool is_there = hdf5_read_text(array->dataset, name, &text);
    hdf5_leave(&session);
    return is_there ? text : NULL;
}

/* Reads or writes count lines of the file's first index, from first of the region on. */
static bool move_run(const struct hdf5_array *array, const struct region *region, hid_t type,
                     uint64_t first, uint64_t count, void *run, bool writes)
{
    const bool is_turned = array->set.is_matlab;
    const hsize_t start[2] = {(is_turned ? region->first_column : region->first_row) + first,
                              is_turned ? region->first_row : region->first_column};
    const hsize_t counts[2] = {count, is_turned ? region->rows : region->columns};
    const hid_t space = H5Dget_space(array->dataset);
    const hid_t memory = H5Screate_simple(2, counts, NULL);
    bool is_done = space >= 0 && memory >= 0 &&
                   H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, counts, NULL) >= 0;
    if (is_done)
        is_done = (writes ? H5Dwrite(array->dataset, type, memory, space, H5P_DEFAULT, run)
                          : H5Dread(array->dataset, type, memory, space, H5P_DEFAULT, run)) >= 0;
    if (memory >= 0)
        H5Sclose(memory);
    if (space >= 0)
        H5Sclose(space);
    return is_done;
}

static sonject_status transfer_run(struct report *report, const struct hdf5_array *array,
                                   const struct region *region, hid_t type, uint64_t first,
                                   uint64_t count, unsigned char *run, void *pixels, bool writes)
{
    static const enum stored_type types[] = {
        [HDF5_UINT8] = STORED_UINT8,     [HDF5_UINT16] = STORED_UINT16,
        [HDF5_INT16] = STORED_INT16,     [HDF5_FLOAT32] = STORED_FLOAT32,
        [HDF5_FLOAT64] = STORED_FLOAT64,
    };
    const bool is_turned = array->set.is_matlab;
    const enum stored_type stored = types[array->set.number];
    const ptrdiff_t pixel = (ptrdiff_t)array->layout.channels;
    const ptrdiff_t line = pixel * (ptrdiff_t)(is_turned ? region->rows : region->columns);
    const struct stored_samples samples = {
        .bytes = {run, run + stored_bytes(stored)},
        .types = {stored, stored},
        .row_step = is_turned ? pixel : line,
        .column_step = is_turned ? line : pixel,
        .is_big_endian = machine_is_big_endian(),
    };
    const struct region part = {
        region->first_row + (is_turned ? 0 : first), region->first_column + (is_turned ? first : 0),
        is_turned ? region->rows : count, is_turned ? count : region->columns};
    errno = 0;
    const bool needs_old = !writes || stored == STORED_FLOAT64;
    if (needs_old && !move_run(array, region, type, first, count, run, false))
        return cannot_move(report, array);
    CHECK(samples_exchange(report, array->path, &array->layout, &samples, &part, region, pixels,
                           writes));
    return !writes || move_run(array, region, type, first, count, run, true)
               ? SONJECT_OK
               : cannot_move(report, array);
}

static sonject_status transfer(struct report *report, const struct hdf5_array *array,
                               const struct region *region, void *pixels, bool writes)
{
    struct hdf5_session session;
    const bool is_turned = array->set.is_matlab;
    const uint64_t lines = is_turned ? region->columns : region->rows;
    const uint64_t across = is_turned ? region->rows : region->columns;
    hdf5_enter(&session);
    const hid_t type = hdf5_set_memory_type(&array->set);
    const size_t line_bytes = type < 0 ? 0 : (size_t)across * H5Tget_size(type);
    const uint64_t some = line_bytes > 0 && line_bytes < RUN_BYTES ? RUN_BYTES / line_bytes : 1;
    const uint64_t at_once = some < lines ? some : lines;
    void *run = line_bytes > 0 ? allocate_array((size_t)at_once, line_bytes) : NULL;
    sonject_status status = run ? SONJECT_OK : report_out_of_memory(report, "samples of an array");
    for (uint64_t first = 0; status == SONJECT_OK && first < lines; first += at_once)
        status =
            transfer_run(report, array, region, type, first,
                         lines - first < at_once ? lines - first : at_once, run, pixels, writes);
    free(run);
    if (type >= 0)
        H5Tclose(type);
    hdf5_leave(&session);
    return status;
}

static sonject_status read_samples(struct report *report, void *image, const struct region *region,
                                   void *pixels)
{
    return transfer(report, image, region, pixels, false);
}

static sonject_status change_samples(struct report *report, void *image,
                                     const struct region *region, const void *pixels)
{
    return transfer(report, image, region, (void *)pixels, true);
}

static sonject_status finish_array(struct report *report, void *image)
{
    struct hdf5_array *array = image;
    struct hdf5_session session;
    hdf5_enter(&session);
    errno = 0;
    bool is_done = H5Fflush(array->file, H5F_SCOPE_LOCAL) >= 0;
    if (!is_done)
        hdf5_abandon(array->file);
    H5Dclose(array->dataset);
    is_done = H5Fclose(array->file) >= 0 && is_done;
    array->dataset = array->file = -1;
    const sonject_status status = is_done ? SONJECT_OK : cannot_move(report, array);
    hdf5_leave(&session);
    return status;
}

sonject_status hdf5_library_find(struct report *report, const char *path,
                                 const struct image_library **library)
{
    static const struct image_library hdf5 = {open_image,   close_array,    read_attribute,
                                              read_samples, change_samples, finish_array};
    (void)report, (void)path;
    *library = &hdf5;
    return SONJECT_OK;
}

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

#else
static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no HDF5 files: build it with HDF5", path);
}

sonject_status hdf5_library_find(struct report *report, const char *path,
                                 const struct image_library **library)
{
    *library = NULL;
    return refuse(report, path);
}

sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels)
{
    (void)layout, (void)notes, (void)note_count, (void)pixels;
    return refuse(report, path);
}
#endif
