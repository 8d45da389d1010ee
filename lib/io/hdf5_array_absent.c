/* Stands in for hdf5_array*.c in builds without HDF5. */
#include "io/hdf5_array.h"

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no HDF5 files: build it with HDF5", path);
}

sonject_status hdf5_array_open(struct report *report, const char *path, const char *name,
                               struct hdf5_array **array)
{
    (void)name;
    *array = NULL;
    return refuse(report, path);
}

void hdf5_array_close(struct hdf5_array **array)
{
    (void)array;
}

void hdf5_array_layout(const struct hdf5_array *array, struct raster_layout *layout)
{
    (void)array;
    (void)layout;
}

uint32_t hdf5_array_largest(const struct hdf5_array *array)
{
    (void)array;
    return 0;
}

bool hdf5_array_attribute(const struct hdf5_array *array, const char *name, char *value,
                          size_t capacity)
{
    (void)array;
    (void)name;
    (void)value;
    (void)capacity;
    return false;
}

sonject_status hdf5_array_read(struct report *report, const struct hdf5_array *array,
                               const struct region *region, void *pixels)
{
    (void)array;
    (void)region;
    (void)pixels;
    return refuse(report, "an array");
}

sonject_status hdf5_array_copy_with_patch(struct report *report, const struct hdf5_array *array,
                                          const char *path, const struct region *region,
                                          const void *pixels, sonject_progress_function progress,
                                          void *user)
{
    (void)array;
    (void)region;
    (void)pixels;
    (void)progress;
    (void)user;
    return refuse(report, path);
}

sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels)
{
    (void)layout;
    (void)notes;
    (void)note_count;
    (void)pixels;
    return refuse(report, path);
}
