/* Stands in for raster_*.cpp in builds without OpenImageIO: everything answers UNSUPPORTED. */
#include "io/raster_file.h"

#include <stddef.h>

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no image files: build it with OpenImageIO",
                          path);
}

sonject_status raster_file_open(struct report *report, const char *path, struct raster_file **file)
{
    *file = NULL;
    return refuse(report, path);
}

void raster_file_close(struct raster_file **file)
{
    (void)file;
}

void raster_file_layout(const struct raster_file *file, struct raster_layout *layout)
{
    (void)file;
    (void)layout;
}

bool raster_file_is_lossless(const struct raster_file *file)
{
    (void)file;
    return false;
}

bool raster_file_attribute(const struct raster_file *file, const char *name, char *value,
                           size_t capacity)
{
    (void)file;
    (void)name;
    (void)value;
    (void)capacity;
    return false;
}

sonject_status raster_file_read(struct report *report, struct raster_file *file,
                                const struct region *region, void *pixels)
{
    (void)file;
    (void)region;
    (void)pixels;
    return refuse(report, "an image");
}

sonject_status raster_file_copy_with_patch(struct report *report, const char *source,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user)
{
    (void)source;
    (void)region;
    (void)pixels;
    (void)progress;
    (void)user;
    return refuse(report, path);
}

sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels)
{
    (void)layout;
    (void)channel_names;
    (void)attributes;
    (void)attribute_count;
    (void)pixels;
    return refuse(report, path);
}

sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels)
{
    (void)layout;
    (void)region;
    (void)pixels;
    return refuse(report, path);
}
