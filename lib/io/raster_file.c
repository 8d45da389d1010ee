#include "io/raster_file.h"

#include <stdlib.h>

#include "base/memory.h"
#include "io/image_kind.h"
#include "io/raster_module.h"

struct raster_file {
    const struct raster_module *module;
    struct raster_image *image;
    struct raster_layout layout;
    bool is_lossless;
};

sonject_status raster_file_open(struct report *report, const char *path, struct raster_file **file)
{
    const struct raster_module *module = NULL;
    enum image_kind kind;
    *file = NULL;
    sonject_status status = image_kind_of(report, path, &kind);
    if (status == SONJECT_OK)
        status = raster_module_find(report, path, &module);
    if (status != SONJECT_OK)
        return status;
    struct raster_file *opened = allocate_array(1, sizeof *opened);
    if (!opened)
        return report_out_of_memory(report, path);
    opened->module = module;
    status = module->open(report, path, &opened->image, &opened->layout, &opened->is_lossless);
    if (status == SONJECT_OK)
        *file = opened;
    else
        free(opened);
    return status;
}

void raster_file_close(struct raster_file **file)
{
    if (!file || !*file)
        return;
    (*file)->module->close(&(*file)->image);
    free(*file);
    *file = NULL;
}

void raster_file_layout(const struct raster_file *file, struct raster_layout *layout)
{
    *layout = file->layout;
}

bool raster_file_is_lossless(const struct raster_file *file)
{
    return file->is_lossless;
}

bool raster_file_attribute(const struct raster_file *file, const char *name, char *value,
                           size_t capacity)
{
    return file->module->attribute(file->image, name, value, capacity);
}

sonject_status raster_file_read(struct report *report, struct raster_file *file,
                                const struct region *region, void *pixels)
{
    return file->module->read(report, file->image, region, pixels);
}

sonject_status raster_file_copy_with_patch(struct report *report, const char *source,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user)
{
    const struct raster_module *module = NULL;
    const sonject_status status = raster_module_find(report, path, &module);
    return status != SONJECT_OK
               ? status
               : module->copy_with_patch(report, source, path, region, pixels, progress, user);
}

sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels)
{
    const struct raster_module *module = NULL;
    const sonject_status status = raster_module_find(report, path, &module);
    return status != SONJECT_OK ? status
                                : module->write(report, path, layout, channel_names, attributes,
                                                attribute_count, pixels);
}

sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels,
                                        const uint8_t *palette)
{
    const struct raster_module *module = NULL;
    const sonject_status status = raster_module_find(report, path, &module);
    return status != SONJECT_OK
               ? status
               : module->write_placed(report, path, layout, region, pixels, palette);
}
