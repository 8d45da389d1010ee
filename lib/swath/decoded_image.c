/* Images that the decoder reads and changes, in two formats: rasters and HDF5. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "swath/image_library.h"
#include "swath/raster_file.h"
#include "swath/swath_format.h"

#define SIDE_MAX            ((uint64_t)1 << 31)
#define ANNOUNCED_BYTES_MAX ((uint64_t)1 << 30)
#define INFLATION_MAX       1100 /* a little above the largest ratio of deflated data */

/* Refuses a file that announces more samples than its bytes can hold, however well packed. */
static sonject_status check_reply(struct report *report, const struct decoded_image *image,
                                  const struct raster_layout *layout)
{
    const uint64_t largest = UINT64_MAX / 2 / INFLATION_MAX;
    const uint64_t most =
        INFLATION_MAX * (image->bytes < largest ? image->bytes : largest) + ANNOUNCED_BYTES_MAX;
    if (layout->rows == 0 || layout->rows >= SIDE_MAX || layout->columns == 0 ||
        layout->columns >= SIDE_MAX || layout->channels < 1 || layout->channels > 2 ||
        layout->type < PIXEL_UINT8 || layout->type > PIXEL_FLOAT32)
        return input_failure(report, image->path, "is damaged: copy it again");
    if (layout->rows <= most / layout->columns / (layout->channels * pixel_bytes(layout->type)))
        return SONJECT_OK;
    return input_failure(report, image->path,
                         "announces %llu x %llu samples, more than its %llu bytes can hold: it is "
                         "damaged or was never filled",
                         (unsigned long long)layout->rows, (unsigned long long)layout->columns,
                         (unsigned long long)image->bytes);
}

/* Asks the decoder to open an image. The path is made absolute, because the child has a working
 * folder of its own. */
static sonject_status ask_to_open(struct report *report, struct decoded_image *image,
                                  enum decoder_function function, const char *place,
                                  struct decoder_reply *reply)
{
    char *whole = path_absolute(place);
    struct growing_text texts = {0};
    size_t count = 0;
    image->description = allocate_array(DESCRIPTION_MAX, 1);
    growing_text_add(&texts, "%s%c%s%c%s", image->path, 0, whole ? whole : "", 0,
                     image->array ? image->array : "");
    char *in = growing_text_end(&texts);
    const struct decoder_request request = {.function = (uint32_t)function,
                                            .bytes = texts.length + 1};
    const sonject_status status =
        in && whole && image->description
            ? decoder_ask(report, image->decoder, image->path, &request, in, reply,
                          image->description, DESCRIPTION_MAX - 1, &count)
            : report_out_of_memory(report, image->path);
    free(in);
    free(whole);
    image->handle = reply->handle;
    image->start = image->decoder->starts;
    return status;
}

static sonject_status open_at(struct report *report, struct decoded_image *image,
                              enum decoder_function function, const char *path, const char *place,
                              const char *array)
{
    struct decoder_reply reply = {0};
    struct path_facts identity;
    image->decoder = report->host ? report->host->decoder : &image->own;
    image->path = copy_text(path);
    image->array = array ? copy_text(array) : NULL;
    CHECK_MEMORY(report, image->path && (image->array || !array), "a file");
    CHECK(file_identify(report, place, &identity));
    image->bytes = identity.bytes;
    CHECK(decoder_start(report, image->decoder, path));
    CHECK(ask_to_open(report, image, function, place, &reply));
    CHECK(check_reply(report, image, &reply.layout));
    image->layout = reply.layout;
    image->largest = reply.largest;
    image->is_column_major = reply.is_column_major != 0;
    image->jpeg_quality = reply.jpeg_quality;
    return SONJECT_OK;
}

static sonject_status open_image(struct report *report, enum decoder_function function,
                                 const char *path, const char *place, const char *array,
                                 struct decoded_image **image)
{
    *image = allocate_array(1, sizeof **image);
    CHECK_MEMORY(report, *image, "a file");
    const sonject_status status = open_at(report, *image, function, path, place, array);
    if (status != SONJECT_OK)
        decoded_image_close(image);
    return status;
}

sonject_status decoded_image_open(struct report *report, const char *path, const char *array,
                                  struct decoded_image **image)
{
    return open_image(report, DECODER_OPEN_IMAGE, path, path, array, image);
}

/* Sends a request about an image. out: NULL if no bytes come back. Refused if the image's decoder
 * has ended, and in a process forked from the one that opened the image. */
static sonject_status ask(struct report *report, const struct decoded_image *image,
                          struct decoder_request *request, const void *in, void *out, size_t bytes)
{
    struct decoder *decoder = image->decoder;
    struct decoder_reply reply;
    size_t count = 0;
    if (image->handle == 0 || (!decoder->is_in_process &&
                               (decoder->child.number == 0 || decoder->starts != image->start ||
                                decoder->child.owner != process_number())))
        return input_failure(report, image->path,
                             "the program that reads it ended earlier: copy it again");
    request->handle = image->handle;
    CHECK(decoder_ask(report, decoder, image->path, request, in, &reply, out, bytes, &count));
    return count == bytes ? SONJECT_OK : input_failure(report, image->path, "is cut short");
}

void decoded_image_close(struct decoded_image **image)
{
    struct report unheard = {.host = NULL};
    struct decoder_request request = {.function = DECODER_CLOSE};
    if (!image || !*image)
        return;
    if ((*image)->handle != 0)
        (void)ask(&unheard, *image, &request, NULL, NULL, 0);
    decoder_stop(&(*image)->own);
    free((*image)->description);
    free((*image)->path);
    free((*image)->array);
    free(*image);
    *image = NULL;
}

/* A transfer of a region's samples, piece by piece. A piece is some rows, or some columns if the
 * file stores column after column. */
struct passage {
    struct report *report;
    const struct decoded_image *image;
    const struct region *region;
    bool writes;
    unsigned char *pixels;
    sonject_progress_function progress;
    void *user;
};

/* Copies samples between a packed piece and its place in the region. */
static void move_piece(const struct passage *passage, const struct region *piece,
                       unsigned char *packed)
{
    const struct region *region = passage->region;
    const size_t pixel = passage->image->layout.channels * pixel_bytes(passage->image->layout.type);
    const size_t row = (size_t)piece->columns * pixel;
    const uint64_t first = (piece->first_row - region->first_row) * region->columns +
                           (piece->first_column - region->first_column);
    unsigned char *place = passage->pixels + (size_t)first * pixel;
    for (uint64_t i = 0; i < piece->rows; i++) {
        memcpy(passage->writes ? packed : place, passage->writes ? place : packed, row);
        packed += row;
        place += (size_t)region->columns * pixel;
    }
}

static sonject_status pass_piece(const struct passage *passage, const struct region *piece,
                                 unsigned char *packed, size_t bytes)
{
    struct decoder_request request = {.function = passage->writes ? DECODER_WRITE : DECODER_READ,
                                      .region = *piece,
                                      .bytes = passage->writes ? bytes : 0};
    if (passage->writes) {
        move_piece(passage, piece, packed);
        return ask(passage->report, passage->image, &request, packed, NULL, 0);
    }
    CHECK(ask(passage->report, passage->image, &request, NULL, packed, bytes));
    move_piece(passage, piece, packed);
    return SONJECT_OK;
}

static sonject_status pass(const struct passage *passage)
{
    const struct region *region = passage->region;
    const struct raster_layout *layout = &passage->image->layout;
    const bool is_column_major = passage->image->is_column_major;
    const size_t pixel = layout->channels * pixel_bytes(layout->type);
    const uint64_t lines = is_column_major ? region->columns : region->rows;
    const size_t line = (size_t)(is_column_major ? region->rows : region->columns) * pixel;
    const uint64_t some = line < DECODER_PIECE_BYTES ? DECODER_PIECE_BYTES / line : 1;
    const uint64_t at_once = some < lines ? some : lines;
    unsigned char *packed = allocate_array((size_t)at_once, line);
    CHECK_MEMORY(passage->report, packed, "samples of an array");
    sonject_status status = SONJECT_OK;
    for (uint64_t first = 0; status == SONJECT_OK && first < lines; first += at_once) {
        const uint64_t count = lines - first < at_once ? lines - first : at_once;
        const struct region piece = {region->first_row + (is_column_major ? 0 : first),
                                     region->first_column + (is_column_major ? first : 0),
                                     is_column_major ? region->rows : count,
                                     is_column_major ? count : region->columns};
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
    return pass(&(struct passage){report, image, region, false, pixels, NULL, NULL});
}

static sonject_status patch_copy(struct report *report, const struct decoded_image *image,
                                 const struct swath_copy *copy)
{
    struct decoded_image *patched;
    struct decoder_request request = {.function = DECODER_CLOSE};
    CHECK(open_image(report, DECODER_OPEN_COPY, image->path, copy->part, image->array, &patched));
    sonject_status status =
        layouts_are_alike(&image->layout, &patched->layout)
            ? pass(&(struct passage){report, patched, copy->region, true,
                                     (unsigned char *)copy->pixels, copy->progress, copy->user})
            : input_failure(report, image->path, "changed while it was read");
    THEN(status, ask(report, patched, &request, NULL, NULL, 0));
    if (status == SONJECT_OK)
        patched->handle = 0;
    decoded_image_close(&patched);
    return status;
}

/* Reads the patch from the copy and compares. A file that contradicts itself may fool the writer,
 * but not the reader as well. If the samples overlap the file's own description, the copy may have
 * become an image of other size or type. */
static sonject_status check_copy(struct report *report, const struct decoded_image *image,
                                 const struct swath_copy *copy)
{
    struct report unheard = {.host = report->host};
    struct decoded_image *made = NULL;
    size_t bytes = 0;
    void *found =
        region_bytes(&image->layout, copy->region, &bytes) ? allocate_array(bytes, 1) : NULL;
    CHECK_MEMORY(report, found, "the patch");
    sonject_status status = decoded_image_open(&unheard, copy->part, image->array, &made);
    if (status == SONJECT_OK && !layouts_are_alike(&image->layout, &made->layout))
        status = SONJECT_ERROR_INPUT;
    THEN(status, decoded_image_read(&unheard, made, copy->region, found));
    if (status == SONJECT_OK && memcmp(found, copy->pixels, bytes) != 0)
        status = SONJECT_ERROR_INPUT;
    decoded_image_close(&made);
    free(found);
    if (status == SONJECT_ERROR_INPUT)
        return input_failure(report, image->path, "damaged: its pixels cannot be replaced");
    return status == SONJECT_OK ? status : report_failure(report, status, "%s", unheard.message);
}

/* Copies all bytes, then lets the decoder change samples in the copy. */
static sonject_status copy_with_patch(struct report *report, const struct swath_file *file,
                                      const struct swath_copy *copy)
{
    struct swath_copy quiet = *copy;
    FILE *out = file_open(copy->part, "wb");
    if (!out)
        return file_failure(report, copy->path, "write", errno);
    quiet.progress = NULL;
    CHECK(swath_close_copy(report, copy, out,
                           swath_copy_bytes(report, file, &quiet, 0, file->bytes, out)));
    if (file->bytes != file->decoded->bytes)
        return input_failure(report, file->path, "changed while it was read");
    CHECK(patch_copy(report, file->decoded, copy));
    return check_copy(report, file->decoded, copy);
}

static sonject_status copy_image(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy)
{
    return file->image == IMAGE_TIFF ? copy_with_patch(report, file, copy)
                                     : raster_file_copy_with_patch(report, file->decoded, copy);
}

/* Returns the largest number that a note states (FULL_SCALE_NOTE); 0 if none does. */
static uint32_t noted_largest(const struct swath_file *file)
{
    char text[32];
    const char *rest;
    double number;
    return swath_file_attribute(file, FULL_SCALE_NOTE, text, sizeof text) &&
                   text_to_number(text, &number, &rest) && *rest == '\0' && number >= 1.0 &&
                   number <= (double)UINT32_MAX &&
                   (file->layout.type == PIXEL_FLOAT32 ||
                    number <= pixel_full_scale(file->layout.type))
               ? (uint32_t)number
               : 0;
}

static sonject_status open_decoded(struct report *report, struct swath_file *file, int32_t channel,
                                   const char *array)
{
    (void)channel;
    CHECK(decoded_image_open(report, file->path, array, &file->decoded));
    file->layout = file->decoded->layout;
    file->largest = file->decoded->largest > 0 ? file->decoded->largest : noted_largest(file);
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

/* Looks for the mark at byte 0, or behind a user's block at byte 512, 1024, 2048, ... */
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
