/* Stands in for hdf5_array*.c in builds without HDF5. */
#include "swath/hdf5_array.h"

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no HDF5 files: build it with HDF5", path);
}

sonject_status hdf5_array_open(struct report *report, const char *path, const char *place,
                               const char *name, bool writes, struct hdf5_array **array)
{
    (void)place;
    (void)name;
    (void)writes;
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

bool hdf5_array_is_turned(const struct hdf5_array *array)
{
    (void)array;
    return false;
}

uint32_t hdf5_array_largest(const struct hdf5_array *array)
{
    (void)array;
    return 0;
}

bool hdf5_array_attribute(const struct hdf5_array *array, const char *name, char **value)
{
    (void)array;
    (void)name;
    (void)value;
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

sonject_status hdf5_array_change(struct report *report, const struct hdf5_array *array,
                                 const struct region *region, const void *pixels)
{
    return hdf5_array_read(report, array, region, (void *)pixels);
}

sonject_status hdf5_array_finish(struct report *report, struct hdf5_array *array)
{
    (void)array;
    return refuse(report, "an array");
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
