#include "swath/decoded_image.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/raster_file.h"
#include "swath/swath_format.h"

#define SIDE_MAX ((uint64_t)1 << 31)

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
    struct decoded_image *opened = *image = allocate_array(1, sizeof *opened);
    CHECK_MEMORY(report, opened, "a file");
    if (array)
        opened->array = copy_text(array);
    sonject_status status =
        !array || opened->array ? SONJECT_OK : report_out_of_memory(report, "a file");
    THEN(status,
         decoder_open(report, DECODER_OPEN_IMAGE, path, NULL, array, &opened->file, &reply));
    THEN(status, check_reply(report, &opened->file, &reply));
    if (status != SONJECT_OK) {
        decoded_image_close(image);
        return status;
    }
    opened->layout = reply.layout;
    opened->largest = reply.largest;
    opened->is_turned = reply.is_turned != 0;
    return SONJECT_OK;
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
    struct decoder_request request = {
        .function = DECODER_ATTRIBUTE, .bytes = strlen(name) + 1, .capacity = capacity};
    struct decoder_reply reply;
    struct decoder_bytes out = {value, capacity, 0};
    if (decoder_ask(&unheard, &image->file, &request, name, &reply, &out) != SONJECT_OK ||
        out.count == 0)
        return false;
    value[out.count - 1] = '\0';
    return true;
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

static sonject_status patch_copy(struct report *report, const struct decoded_image *image,
                                 const struct swath_copy *copy)
{
    struct decoder_file file;
    struct decoder_reply reply;
    struct decoder_request request = {.function = DECODER_FINISH};
    CHECK(decoder_open(report, DECODER_OPEN_COPY, image->file.path, copy->part, image->array, &file,
                       &reply));
    sonject_status status =
        pass(&(struct passage){report, image, &file, copy->region, true,
                               (unsigned char *)copy->pixels, copy->progress, copy->user});
    THEN(status, decoder_ask(report, &file, &request, NULL, &reply, NULL));
    decoder_close(&file);
    return status;
}

/* Whatever went into the copy must come out of it: a file that says contradictory things of itself
 * may fool the writer, but not the reader as well. */
static sonject_status check_copy(struct report *report, const struct decoded_image *image,
                                 const struct swath_copy *copy)
{
    struct report unheard = {{0}, NULL, report->host};
    struct decoded_image *made = NULL;
    size_t bytes = 0;
    void *found =
        region_bytes(&image->layout, copy->region, &bytes) ? allocate_array(bytes, 1) : NULL;
    CHECK_MEMORY(report, found, "the patch");
    sonject_status status = decoded_image_open(&unheard, copy->part, image->array, &made);
    THEN(status, decoded_image_read(&unheard, made, copy->region, found));
    if (status == SONJECT_OK && memcmp(found, copy->pixels, bytes) != 0)
        status = SONJECT_ERROR_INPUT;
    decoded_image_close(&made);
    free(found);
    if (status == SONJECT_ERROR_INPUT)
        return report_failure(report, status, "%s: damaged: its pixels cannot be replaced",
                              image->file.path);
    return status == SONJECT_OK ? status : report_failure(report, status, "%s", unheard.message);
}

/* The decoder changes samples in a copy of all bytes. */
static sonject_status copy_with_patch(struct report *report, const struct swath_file *file,
                                      const struct swath_copy *copy)
{
    struct swath_copy quiet = *copy;
    FILE *out = fopen(copy->part, "wb");
    if (!out)
        return file_failure(report, copy->path, "write", errno);
    quiet.progress = NULL;
    CHECK(swath_close_copy(report, copy, out,
                           swath_copy_bytes(report, file, &quiet, 0, file->bytes, out)));
    if (file->bytes != file->decoded->file.bytes)
        return swath_refuse(report, file, "changed while it was read");
    CHECK(patch_copy(report, file->decoded, copy));
    return check_copy(report, file->decoded, copy);
}

static sonject_status copy_image(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy)
{
    return file->image == IMAGE_TIFF
               ? copy_with_patch(report, file, copy)
               : raster_file_copy_with_patch(report, file->decoded, file->image, copy);
}

static sonject_status open_decoded(struct report *report, struct swath_file *file, int32_t channel,
                                   const char *array)
{
    (void)channel;
    CHECK(decoded_image_open(report, file->path, array, &file->decoded));
    file->layout = file->decoded->layout;
    file->largest = file->decoded->largest;
    return SONJECT_OK;
}

static sonject_status read_decoded(struct report *report, struct swath_file *file,
                                   const struct region *region, void *pixels)
{
    return decoded_image_read(report, file->decoded, region, pixels);
}

static bool is_image(struct swath_file *file, const unsigned char *head, size_t count)
{
    return image_kind_of_beginning(head, count, &file->image);
}

/* Its mark stands at byte 0, or at 512, 1024, 2048, ..., behind a user's block. */
static bool is_hdf5(struct swath_file *file, const unsigned char *head, size_t count)
{
    static const unsigned char mark[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
    unsigned char bytes[sizeof mark];
    (void)head, (void)count;
    for (uint64_t place = 0; place < file->bytes; place = place == 0 ? 512 : 2 * place)
        if (byte_file_read(file->stream, place, bytes, sizeof bytes) &&
            memcmp(bytes, mark, sizeof mark) == 0)
            return true;
    return false;
}

const struct swath_format image_format = {false,        false,        is_image,
                                          open_decoded, read_decoded, copy_image};
const struct swath_format hdf5_format = {false,        true,         is_hdf5,
                                         open_decoded, read_decoded, copy_with_patch};
