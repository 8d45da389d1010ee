#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "swath/hdf5_array.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "swath/hdf5_set.h"

#define RUN_BYTES ((size_t)16 << 20) /* of samples in memory at a time, beside the image */

struct hdf5_array {
    char *path;
    struct hdf5_set set;
    struct raster_layout layout;
    hid_t file, dataset;
    bool writes;
};

/* What reads or writes a run of samples, in the file's order. */
struct transfer {
    struct report *report;
    const struct hdf5_array *array;
    const struct region *region;
    bool writes;
    unsigned char *pixels;
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
    sonject_status status = hdf5_set_choose(report, array->path, array->file, name, &array->set);
    if (status != SONJECT_OK)
        return status;
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

sonject_status hdf5_array_open(struct report *report, const char *path, const char *place,
                               const char *name, bool writes, struct hdf5_array **array)
{
    struct hdf5_session session;
    struct hdf5_array *opened = allocate_array(1, sizeof *opened);
    *array = NULL;
    if (opened)
        opened->path = copy_text(path);
    if (!opened || !opened->path) {
        free(opened);
        return report_out_of_memory(report, "a file");
    }
    opened->file = opened->dataset = -1;
    opened->writes = writes;
    hdf5_enter(&session);
    const sonject_status status = open_array(report, opened, place, name);
    hdf5_leave(&session);
    if (status == SONJECT_OK)
        *array = opened;
    else
        hdf5_array_close(&opened);
    return status;
}

void hdf5_array_close(struct hdf5_array **array)
{
    struct hdf5_session session;
    if (!array || !*array)
        return;
    hdf5_enter(&session);
    if ((*array)->writes && (*array)->file >= 0)
        hdf5_abandon((*array)->file);
    if ((*array)->dataset >= 0)
        H5Dclose((*array)->dataset);
    if ((*array)->file >= 0)
        H5Fclose((*array)->file);
    hdf5_leave(&session);
    free((*array)->path);
    free(*array);
    *array = NULL;
}

void hdf5_array_layout(const struct hdf5_array *array, struct raster_layout *layout)
{
    *layout = array->layout;
}

uint32_t hdf5_array_largest(const struct hdf5_array *array)
{
    return array->set.number == HDF5_INT16 ? INT16_MAX : 0;
}

bool hdf5_array_is_turned(const struct hdf5_array *array)
{
    return array->set.is_matlab;
}

bool hdf5_array_attribute(const struct hdf5_array *array, const char *name, char **value)
{
    struct hdf5_session session;
    hdf5_enter(&session);
    const bool is_there = hdf5_read_text(array->dataset, name, value);
    hdf5_leave(&session);
    return is_there;
}

/* Between a sample of the run and one of the image; false if the image's type cannot hold it. */
static bool exchange(const struct transfer *transfer, void *run, size_t at, size_t pixel)
{
    const enum hdf5_number number = transfer->array->set.number;
    if (number == HDF5_FLOAT64) {
        double *stored = (double *)run + at;
        float *shown = (float *)transfer->pixels + pixel;
        if (transfer->writes)
            *stored = kept_or_new(*stored, *shown);
        return transfer->writes || float_of_double(*stored, shown);
    }
    const size_t bytes = pixel_bytes(transfer->array->layout.type);
    unsigned char *stored = (unsigned char *)run + at * bytes;
    unsigned char *shown = transfer->pixels + pixel * bytes;
    memcpy(transfer->writes ? stored : shown, transfer->writes ? shown : stored, bytes);
    uint16_t sample = 0;
    if (number == HDF5_INT16)
        memcpy(&sample, stored, sizeof sample);
    return sample <= INT16_MAX;
}

static sonject_status refuse_sample(const struct transfer *transfer, uint64_t pixel)
{
    const struct region *region = transfer->region;
    const char *why = transfer->writes ? "more than the file's largest number of 32767"
                      : transfer->array->set.number == HDF5_FLOAT64
                          ? "beyond what float32 holds: scale the array"
                          : "negative: sonject reads magnitudes, so convert the file first";
    return report_failure(
        transfer->report, SONJECT_ERROR_INPUT, "%s: the sample at row %llu, column %llu is %s",
        transfer->array->path, (unsigned long long)(region->first_row + pixel / region->columns),
        (unsigned long long)(region->first_column + pixel % region->columns), why);
}

/* All samples of a run: `count` lines of the file's first index, from `first` of the region on. */
static sonject_status exchange_run(const struct transfer *transfer, void *run, uint64_t first,
                                   uint64_t count)
{
    const struct region *region = transfer->region;
    const bool is_turned = transfer->array->set.is_matlab;
    const uint32_t channels = transfer->array->layout.channels;
    const uint64_t across = is_turned ? region->rows : region->columns;
    for (uint64_t i = 0; i < count; i++)
        for (uint64_t j = 0; j < across; j++) {
            const uint64_t pixel =
                is_turned ? j * region->columns + first + i : (first + i) * region->columns + j;
            for (uint32_t k = 0; k < channels; k++)
                if (!exchange(transfer, run, (size_t)(i * across + j) * channels + k,
                              (size_t)pixel * channels + k))
                    return refuse_sample(transfer, pixel);
        }
    return SONJECT_OK;
}

/* Reads or writes the run's samples in the file. */
static bool move_run(const struct transfer *transfer, hid_t type, uint64_t first, uint64_t count,
                     void *run, bool writes)
{
    const struct region *region = transfer->region;
    const bool is_turned = transfer->array->set.is_matlab;
    const hsize_t start[2] = {(is_turned ? region->first_column : region->first_row) + first,
                              is_turned ? region->first_row : region->first_column};
    const hsize_t counts[2] = {count, is_turned ? region->rows : region->columns};
    const hid_t space = H5Dget_space(transfer->array->dataset);
    const hid_t memory = H5Screate_simple(2, counts, NULL);
    bool is_done = space >= 0 && memory >= 0 &&
                   H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, counts, NULL) >= 0;
    if (is_done)
        is_done =
            (writes
                 ? H5Dwrite(transfer->array->dataset, type, memory, space, H5P_DEFAULT, run)
                 : H5Dread(transfer->array->dataset, type, memory, space, H5P_DEFAULT, run)) >= 0;
    if (memory >= 0)
        H5Sclose(memory);
    if (space >= 0)
        H5Sclose(space);
    return is_done;
}

static sonject_status transfer_samples(const struct transfer *transfer)
{
    const struct hdf5_array *array = transfer->array;
    const struct region *region = transfer->region;
    const uint64_t lines = array->set.is_matlab ? region->columns : region->rows;
    const uint64_t across = array->set.is_matlab ? region->rows : region->columns;
    const hid_t type = hdf5_set_memory_type(&array->set);
    const size_t line_bytes = type < 0 ? 0 : (size_t)across * H5Tget_size(type);
    const uint64_t some = line_bytes > 0 && line_bytes < RUN_BYTES ? RUN_BYTES / line_bytes : 1;
    const uint64_t at_once = some < lines ? some : lines;
    void *run = line_bytes > 0 ? allocate_array((size_t)at_once, line_bytes) : NULL;
    sonject_status status =
        run ? SONJECT_OK : report_out_of_memory(transfer->report, "samples of an array");
    for (uint64_t first = 0; status == SONJECT_OK && first < lines; first += at_once) {
        errno = 0;
        const uint64_t count = lines - first < at_once ? lines - first : at_once;
        const bool needs_old = !transfer->writes || array->set.number == HDF5_FLOAT64;
        if (needs_old && !move_run(transfer, type, first, count, run, false))
            status = cannot_move(transfer->report, array);
        else
            status = exchange_run(transfer, run, first, count);
        if (status == SONJECT_OK && transfer->writes &&
            !move_run(transfer, type, first, count, run, true))
            status = cannot_move(transfer->report, array);
    }
    free(run);
    if (type >= 0)
        H5Tclose(type);
    return status;
}

static sonject_status transfer_region(struct transfer transfer)
{
    struct hdf5_session session;
    if (!region_is_inside(&transfer.array->layout, transfer.region))
        return report_failure(transfer.report, SONJECT_ERROR_INPUT,
                              "%s: the region is not inside the image", transfer.array->path);
    hdf5_enter(&session);
    const sonject_status status = transfer_samples(&transfer);
    hdf5_leave(&session);
    return status;
}

sonject_status hdf5_array_read(struct report *report, const struct hdf5_array *array,
                               const struct region *region, void *pixels)
{
    return transfer_region((struct transfer){report, array, region, false, pixels});
}

sonject_status hdf5_array_change(struct report *report, const struct hdf5_array *array,
                                 const struct region *region, const void *pixels)
{
    return transfer_region((struct transfer){report, array, region, true, (unsigned char *)pixels});
}

sonject_status hdf5_array_finish(struct report *report, struct hdf5_array *array)
{
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
