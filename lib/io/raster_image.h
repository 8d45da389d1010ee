/* Image files by OpenImageIO, as raster_file.h says, one layer below it: what the module of image
 * files is made of. Implemented in C++; no exception leaves it. */
#ifndef SONJECT_IO_RASTER_IMAGE_H
#define SONJECT_IO_RASTER_IMAGE_H

#include "io/raster_file.h"

#ifdef __cplusplus
extern "C" {
#endif

struct raster_image;

/* As raster_file_open; layout and is_lossless are set on success. */
sonject_status raster_image_open(struct report *report, const char *path,
                                 struct raster_image **image, struct raster_layout *layout,
                                 bool *is_lossless);
void raster_image_close(struct raster_image **image);

/* As the functions of raster_file.h that are named like these. */
bool raster_image_attribute(const struct raster_image *image, const char *name, char *value,
                            size_t capacity);
sonject_status raster_image_read(struct report *report, struct raster_image *image,
                                 const struct region *region, void *pixels);
sonject_status raster_image_copy_with_patch(struct report *report, const char *source,
                                            const char *path, const struct region *region,
                                            const void *pixels, sonject_progress_function progress,
                                            void *user);
sonject_status raster_image_write(struct report *report, const char *path,
                                  const struct raster_layout *layout,
                                  const char *const *channel_names,
                                  const struct raster_attribute *attributes, size_t attribute_count,
                                  const void *pixels);
sonject_status raster_image_write_placed(struct report *report, const char *path,
                                         const struct raster_layout *layout,
                                         const struct region *region, const void *pixels,
                                         const uint8_t *palette);

#ifdef __cplusplus
}
#endif

#endif
