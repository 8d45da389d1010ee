#include "swath/decoded_image.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/file.h"
#include "base/memory.h"

#define SIDE_MAX      ((uint64_t)1 << 31)
#define ATTRIBUTE_MAX ((size_t)64 << 20) /* bytes of any that a decoder gives */

static sonject_status check_reply(struct report *report, const struct decoder_file *file,
                                  const struct decoder_reply *reply)
{
    const struct raster_layout *layout = &reply->layout;
    if (layout->rows == 0 || layout->rows >= SIDE_MAX || layout->columns == 0 ||
        layout->columns >= SIDE_MAX || layout->channels < 1 || layout->channels > 2 ||
        layout->type < PIXEL_UINT8 || layout->type > PIXEL_FLOAT32)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: is damaged: copy it again",
                              file->path);
    return decoder_check_announced(report, file, layout->rows, layout->columns,
                                   layout->channels * pixel_bytes(layout->type));
}

sonject_status decoded_image_open(struct report *report, const char *path, const char *array,
                                  struct decoded_image **image)
{
    struct decoder_reply reply;
    struct decoded_image *opened = allocate_array(1, sizeof *opened);
    *image = NULL;
    if (opened && array)
        opened->array = copy_text(array);
    if (!opened || (array && !opened->array)) {
        free(opened);
        return report_out_of_memory(report, "a file");
    }
    sonject_status status =
        decoder_open(report, DECODER_OPEN_IMAGE, path, NULL, array, &opened->file, &reply);
    if (status == SONJECT_OK)
        status = check_reply(report, &opened->file, &reply);
    opened->layout = reply.layout;
    opened->largest = reply.largest;
    opened->is_turned = reply.is_turned != 0;
    if (status == SONJECT_OK)
        *image = opened;
    else
        decoded_image_close(&opened);
    return status;
}

void decoded_image_close(struct decoded_image **image)
{
    if (!image || !*image)
        return;
    decoder_close(&(*image)->file);
    free((*image)->array);
    free(*image);
    *image = NULL;
}

bool decoded_image_attribute(struct decoded_image *image, const char *name, char *value,
                             size_t capacity)
{
    struct report unheard = {{0}, NULL, NULL};
    struct decoder_request request = {.function = DECODER_ATTRIBUTE, .bytes = strlen(name) + 1};
    struct decoder_reply reply;
    struct decoder_bytes out = {NULL, ATTRIBUTE_MAX, 0};
    const bool is_there =
        decoder_ask(&unheard, &image->file, &request, name, &reply, &out) == SONJECT_OK &&
        out.count > 0 && out.count <= capacity;
    if (is_there) {
        memcpy(value, out.bytes, out.count);
        value[out.count - 1] = '\0';
    }
    free(out.bytes);
    return is_there;
}

/* A region's samples pass piece by piece, each of some rows, or of some columns where these lie
 * together in the file. */
struct passage {
    struct report *report;
    const struct decoded_image *image;
    struct decoder_file *file;
    const struct region *region;
    bool writes;
    unsigned char *pixels;
    sonject_progress_function progress;
    void *user;
};

/* Between a piece, which is packed, and its place in the region. */
static void move_piece(const struct passage *passage, const struct region *piece,
                       unsigned char *packed)
{
    const size_t pixel = passage->image->layout.channels * pixel_bytes(passage->image->layout.type);
    const size_t row = (size_t)piece->columns * pixel;
    unsigned char *place =
        passage->pixels + ((size_t)(piece->first_row - passage->region->first_row) *
                               (size_t)passage->region->columns +
                           (size_t)(piece->first_column - passage->region->first_column)) *
                              pixel;
    for (uint64_t i = 0; i < piece->rows; i++) {
        memcpy(passage->writes ? packed : place, passage->writes ? place : packed, row);
        packed += row;
        place += (size_t)passage->region->columns * pixel;
    }
}

static sonject_status pass_piece(const struct passage *passage, const struct region *piece,
                                 unsigned char *packed, size_t bytes)
{
    struct decoder_request request = {.function = passage->writes ? DECODER_WRITE : DECODER_READ,
                                      .region = *piece,
                                      .bytes = passage->writes ? bytes : 0};
    struct decoder_reply reply;
    struct decoder_bytes out = {packed, bytes, 0};
    if (passage->writes)
        move_piece(passage, piece, packed);
    const sonject_status status =
        decoder_ask(passage->report, passage->file, &request, passage->writes ? packed : NULL,
                    &reply, passage->writes ? NULL : &out);
    if (status != SONJECT_OK || passage->writes)
        return status;
    if (out.count != bytes)
        return report_failure(passage->report, SONJECT_ERROR_INPUT, "%s: is cut short",
                              passage->file->path);
    move_piece(passage, piece, packed);
    return SONJECT_OK;
}

static sonject_status pass(const struct passage *passage)
{
    const struct region *region = passage->region;
    const struct raster_layout *layout = &passage->image->layout;
    const bool is_turned = passage->image->is_turned;
    if (!region_is_inside(layout, region))
        return report_failure(passage->report, SONJECT_ERROR_INPUT,
                              "%s: the region is not inside the image", passage->image->file.path);
    const size_t pixel = layout->channels * pixel_bytes(layout->type);
    const uint64_t lines = is_turned ? region->columns : region->rows;
    const size_t line = (size_t)(is_turned ? region->rows : region->columns) * pixel;
    const uint64_t some = line < DECODER_PIECE_BYTES ? DECODER_PIECE_BYTES / line : 1;
    const uint64_t at_once = some < lines ? some : lines;
    unsigned char *packed = allocate_array((size_t)at_once, line);
    sonject_status status =
        packed ? SONJECT_OK : report_out_of_memory(passage->report, "samples of an array");
    for (uint64_t first = 0; status == SONJECT_OK && first < lines; first += at_once) {
        const uint64_t count = lines - first < at_once ? lines - first : at_once;
        const struct region piece = {region->first_row + (is_turned ? 0 : first),
                                     region->first_column + (is_turned ? first : 0),
                                     is_turned ? region->rows : count,
                                     is_turned ? count : region->columns};
        if (passage->progress &&
            passage->progress(passage->user, (double)first / (double)lines, "write") != 0)
            status = report_failure(passage->report, SONJECT_CANCELLED, "cancelled");
        else
            status = pass_piece(passage, &piece, packed, (size_t)count * line);
    }
    free(packed);
    return status;
}

sonject_status decoded_image_read(struct report *report, struct decoded_image *image,
                                  const struct region *region, void *pixels)
{
    return pass(&(struct passage){report, image, &image->file, region, false, pixels, NULL, NULL});
}

static sonject_status copy_bytes(struct report *report, const struct decoded_image *image,
                                 const char *part, const char *path)
{
    uint64_t bytes = 0;
    sonject_status status = SONJECT_OK;
    FILE *from = byte_file_open(image->file.path, &bytes);
    if (!from)
        return file_refuse(report, image->file.path, errno);
    errno = 0;
    FILE *to = fopen(part, "wb");
    if (!to || (!byte_file_copy(from, 0, bytes, to) && ferror(to)))
        status = file_failure(report, path, "write", errno ? errno : EIO);
    else if (ferror(from))
        status = file_failure(report, image->file.path, "read", errno ? errno : EIO);
    else if (bytes != image->file.bytes)
        status = report_failure(report, SONJECT_ERROR_INPUT, "%s: changed while it was read",
                                image->file.path);
    if (to && fclose(to) != 0 && status == SONJECT_OK)
        status = file_failure(report, path, "write", errno);
    fclose(from);
    return status;
}

static sonject_status patch_copy(struct passage *passage, const char *part)
{
    struct decoder_file copy;
    struct decoder_reply reply;
    sonject_status status = decoder_open(passage->report, DECODER_OPEN_COPY, passage->file->path,
                                         part, passage->image->array, &copy, &reply);
    if (status != SONJECT_OK)
        return status;
    struct decoder_request request = {.function = DECODER_FINISH};
    passage->file = &copy;
    status = pass(passage);
    if (status == SONJECT_OK)
        status = decoder_ask(passage->report, &copy, &request, NULL, &reply, NULL);
    decoder_close(&copy);
    return status;
}

/* Whatever went into the copy must come out of it: a file that says contradictory things of itself
 * may fool the writer, but not the reader as well. */
static sonject_status check_copy(const struct passage *passage, const char *part)
{
    const struct decoded_image *image = passage->image;
    struct report unheard = {{0}, NULL, passage->report->host};
    struct decoded_image *copy = NULL;
    size_t bytes = 0;
    void *found =
        region_bytes(&image->layout, passage->region, &bytes) ? allocate_array(bytes, 1) : NULL;
    if (!found)
        return report_out_of_memory(passage->report, "the patch");
    sonject_status status = decoded_image_open(&unheard, part, image->array, &copy);
    if (status == SONJECT_OK)
        status = decoded_image_read(&unheard, copy, passage->region, found);
    if (status == SONJECT_OK && memcmp(found, passage->pixels, bytes) != 0)
        status = SONJECT_ERROR_INPUT;
    decoded_image_close(&copy);
    free(found);
    return status == SONJECT_OK ? SONJECT_OK
           : status == SONJECT_ERROR_INPUT
               ? report_failure(passage->report, status,
                                "%s: damaged: its pixels cannot be replaced", image->file.path)
               : report_failure(passage->report, status, "%s", unheard.message);
}

sonject_status decoded_image_copy_with_patch(struct report *report, struct decoded_image *image,
                                             const char *path, const struct region *region,
                                             const void *pixels, sonject_progress_function progress,
                                             void *user)
{
    struct passage passage = {report,   image, &image->file, region, true, (unsigned char *)pixels,
                              progress, user};
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a file name");
    sonject_status status = copy_bytes(report, image, part, path);
    if (status == SONJECT_OK)
        status = patch_copy(&passage, part);
    if (status == SONJECT_OK)
        status = check_copy(&passage, part);
    if (status == SONJECT_OK)
        status = file_publish(report, part, path);
    else
        file_discard(part);
    free(part);
    return status;
}
