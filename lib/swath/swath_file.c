#include "swath/swath_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/decoded_image.h"
#include "swath/hdf5_mark.h"
#include "swath/image_kind.h"
#include "swath/mat_file.h"
#include "swath/npy_file.h"
#include "swath/raster_file.h"

enum swath_kind {
    SWATH_IMAGE,
    SWATH_XTF,
    SWATH_NPY,
    SWATH_HDF5,
    SWATH_MAT
};

struct swath_file {
    enum swath_kind kind;
    char *path;
    enum image_kind image; /* of SWATH_IMAGE */
    struct xtf_file xtf;
    struct sample_rows plain;      /* SWATH_NPY */
    struct decoded_image *decoded; /* SWATH_IMAGE, SWATH_HDF5 */
    struct mat_file mat;
};

static sonject_status tell_kind(struct report *report, const char *path, enum swath_kind *kind,
                                enum image_kind *image)
{
    unsigned char head[16] = {0};
    uint64_t bytes;
    FILE *stream = byte_file_open(path, &bytes);
    if (!stream) {
        return file_refuse(report, path, errno);
    }
    const size_t got = fread(head, 1, sizeof head, stream);
    const bool is_read = ferror(stream) == 0;
    fclose(stream);
    if (!is_read)
        return file_failure(report, path, "read", errno);
    *kind = xtf_begins(head, got)                       ? SWATH_XTF
            : npy_begins(head, got)                     ? SWATH_NPY
            : mat_begins(head, got)                     ? SWATH_MAT
            : image_kind_of_beginning(head, got, image) ? SWATH_IMAGE
            : hdf5_mark_is_in(path)                     ? SWATH_HDF5
                                                        : SWATH_IMAGE;
    return *kind == SWATH_IMAGE ? file_check_disk(report, path, image_kind_of(report, path, image))
                                : SONJECT_OK;
}

static bool has_channels(enum swath_kind kind)
{
    return kind == SWATH_XTF;
}

static bool has_names(enum swath_kind kind)
{
    return kind == SWATH_HDF5 || kind == SWATH_MAT;
}

/* SWATH_IMAGE of a file that cannot be read: who opens it says so. */
static enum swath_kind kind_if_any(const char *path)
{
    struct report report = {{0}, NULL, NULL};
    enum swath_kind kind = SWATH_IMAGE;
    enum image_kind image;
    return tell_kind(&report, path, &kind, &image) == SONJECT_OK ? kind : SWATH_IMAGE;
}

static sonject_status open_kind(struct report *report, struct swath_file *file, int32_t channel,
                                const char *array)
{
    if (channel != SONJECT_CHANNEL_ONLY && !has_channels(file->kind))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is no XTF file, so it has no channels: take the channel out",
                              file->path);
    if (array && !has_names(file->kind))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is neither HDF5 nor MATLAB, so its arrays have no names: take "
                              "the array out",
                              file->path);
    switch (file->kind) {
    case SWATH_XTF:
        return xtf_file_open(report, file->path, channel, &file->xtf);
    case SWATH_NPY:
        return npy_file_open(report, file->path, &file->plain);
    case SWATH_MAT:
        return mat_file_open(report, file->path, array, &file->mat);
    case SWATH_HDF5:
    case SWATH_IMAGE:
        break;
    }
    return decoded_image_open(report, file->path, array, &file->decoded);
}

sonject_status swath_file_open(struct report *report, const char *path, int32_t channel,
                               struct swath_file **file)
{
    return swath_file_open_array(report, path, channel, NULL, file);
}

sonject_status swath_file_open_array(struct report *report, const char *path, int32_t channel,
                                     const char *array, struct swath_file **file)
{
    return swath_file_open_beside(report, path, NULL, channel, array, file);
}

sonject_status swath_file_open_beside(struct report *report, const char *path, const char *other,
                                      int32_t channel, const char *array, struct swath_file **file)
{
    *file = NULL;
    struct swath_file *opened = allocate_array(1, sizeof *opened);
    char *copy = copy_text(path);
    sonject_status status = SONJECT_OK;
    if (!opened || !copy) {
        free(copy);
        free(opened);
        return report_out_of_memory(report, "a file");
    }
    opened->path = copy;
    errno = 0;
    status = tell_kind(report, opened->path, &opened->kind, &opened->image);
    if (status == SONJECT_OK) {
        const enum swath_kind beside = other ? kind_if_any(other) : SWATH_IMAGE;
        if (!has_channels(opened->kind) && has_channels(beside))
            channel = SONJECT_CHANNEL_ONLY;
        if (!has_names(opened->kind) && has_names(beside))
            array = NULL;
        status = file_check_disk(report, path, open_kind(report, opened, channel, array));
    }
    if (status == SONJECT_OK)
        *file = opened;
    else
        swath_file_close(&opened);
    return status;
}

void swath_file_close(struct swath_file **file)
{
    if (!file || !*file)
        return;
    xtf_file_close(&(*file)->xtf);
    sample_rows_clear(&(*file)->plain);
    decoded_image_close(&(*file)->decoded);
    mat_file_close(&(*file)->mat);
    free((*file)->path);
    free(*file);
    *file = NULL;
}

/* NULL: it is of another kind. */
static const struct sample_rows *sample_rows_of(const struct swath_file *file)
{
    if (file->kind == SWATH_XTF)
        return &file->xtf.rows;
    return file->plain.file ? &file->plain : NULL;
}

void swath_file_layout(const struct swath_file *file, struct raster_layout *layout)
{
    const struct sample_rows *rows = sample_rows_of(file);
    if (rows)
        *layout = rows->layout;
    else
        *layout = file->kind == SWATH_MAT ? file->mat.layout : file->decoded->layout;
}

const char *swath_file_new_extension(const struct swath_file *file)
{
    if (file->kind != SWATH_IMAGE || file->image == IMAGE_TIFF)
        return NULL;
    return file->image == IMAGE_PNG || file->image == IMAGE_JPEG ? ".png" : ".tif";
}

uint32_t swath_file_largest(const struct swath_file *file)
{
    const struct sample_rows *rows = sample_rows_of(file);
    if (rows)
        return rows->largest;
    return file->kind == SWATH_MAT ? mat_file_largest(&file->mat) : file->decoded->largest;
}

enum range_axis swath_file_range_axis(const struct swath_file *file)
{
    char axis[16] = "";
    if (file->kind == SWATH_XTF)
        return file->xtf.is_ground_range ? RANGE_GROUND : RANGE_SLANT;
    if (!swath_file_attribute(file, "sonject:range_axis", axis, sizeof axis))
        return RANGE_UNKNOWN;
    return strcmp(axis, "ground") == 0  ? RANGE_GROUND
           : strcmp(axis, "slant") == 0 ? RANGE_SLANT
                                        : RANGE_UNKNOWN;
}

const struct xtf_file *swath_file_xtf(const struct swath_file *file)
{
    return file->kind == SWATH_XTF ? &file->xtf : NULL;
}

bool swath_file_attribute(const struct swath_file *file, const char *name, char *value,
                          size_t capacity)
{
    return file->decoded && decoded_image_attribute(file->decoded, name, value, capacity);
}

static sonject_status read_kind(struct report *report, struct swath_file *file,
                                const struct region *region, void *pixels)
{
    const struct sample_rows *rows = sample_rows_of(file);
    if (rows)
        return sample_rows_read(report, rows, region, pixels);
    if (file->kind == SWATH_MAT)
        return mat_file_read(report, &file->mat, region, pixels);
    return decoded_image_read(report, file->decoded, region, pixels);
}

sonject_status swath_file_read(struct report *report, struct swath_file *file,
                               const struct region *region, void *pixels)
{
    errno = 0;
    return file_check_disk(report, file->path, read_kind(report, file, region, pixels));
}

static sonject_status copy_kind(struct report *report, const struct swath_file *file,
                                const char *path, const struct region *region, const void *pixels,
                                sonject_progress_function progress, void *user)
{
    const struct sample_rows *rows = sample_rows_of(file);
    if (rows)
        return sample_rows_copy_with_patch(report, rows, path, region, pixels, progress, user);
    if (file->kind == SWATH_HDF5)
        return decoded_image_copy_with_patch(report, file->decoded, path, region, pixels, progress,
                                             user);
    if (file->kind == SWATH_MAT)
        return mat_file_copy_with_patch(report, &file->mat, path, region, pixels, progress, user);
    return raster_file_copy_with_patch(report, file->decoded, file->image, path, region, pixels,
                                       progress, user);
}

sonject_status swath_file_copy_with_patch(struct report *report, const struct swath_file *file,
                                          const char *path, const struct region *region,
                                          const void *pixels, sonject_progress_function progress,
                                          void *user)
{
    errno = 0;
    return file_check_disk(report, file->path,
                           copy_kind(report, file, path, region, pixels, progress, user));
}
