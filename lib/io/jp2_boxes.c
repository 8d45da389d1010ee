#include "io/jp2_boxes.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "io/byte_order.h"
#include "io/jp2_codestream.h"

#define BOXES_MAX       4096
#define HEAD_BYTES      8  /* of a box: its length and kind */
#define LONG_HEAD_BYTES 16 /* with a long length */
#define IMAGE_BYTES     14 /* of the content of the image's head */
#define KINDS_BYTES_MAX 1024

struct box {
    uint64_t place, bytes;
    uint64_t head_bytes; /* of them, before the content */
    char kind[4];
};

struct jp2_file {
    struct report *report;
    const char *path;
    FILE *file;
    uint64_t file_bytes;
    bool has_boxes;
    unsigned char image_head[IMAGE_BYTES];
    struct box coded; /* the box of the coded image */
    struct byte_range codestream;
};

static sonject_status refuse(const struct jp2_file *jp2, const char *what)
{
    return report_failure(jp2->report, SONJECT_ERROR_INPUT, "%s: %s", jp2->path, what);
}

static sonject_status refuse_cut(const struct jp2_file *jp2)
{
    return refuse(jp2, "damaged JPEG 2000: cut short, or its boxes are not as they must be");
}

static bool is_kind(const struct box *box, const char *kind)
{
    return memcmp(box->kind, kind, sizeof box->kind) == 0;
}

/* The box at that place, which ends at end or before. */
static bool read_box(const struct jp2_file *jp2, uint64_t place, uint64_t end, struct box *box)
{
    unsigned char head[LONG_HEAD_BYTES];
    const uint64_t left = end - place;
    if (left < HEAD_BYTES || !byte_file_read(jp2->file, place, head, HEAD_BYTES))
        return false;
    box->place = place;
    box->bytes = number_from_bytes(head, 4, true);
    box->head_bytes = HEAD_BYTES;
    memcpy(box->kind, head + 4, sizeof box->kind);
    if (box->bytes == 0) { /* up to the file's end */
        box->bytes = left;
        return end == jp2->file_bytes;
    }
    if (box->bytes == 1) {
        if (left < LONG_HEAD_BYTES || !byte_file_read(jp2->file, place, head, sizeof head))
            return false;
        box->bytes = number_from_bytes(head + 8, 8, true);
        box->head_bytes = LONG_HEAD_BYTES;
    }
    return box->bytes >= box->head_bytes && box->bytes <= left;
}

/* The list of formats that the file keeps to. */
static sonject_status check_kinds(const struct jp2_file *jp2, const struct box *box)
{
    unsigned char kinds[KINDS_BYTES_MAX];
    const uint64_t count = box->bytes - box->head_bytes;
    if (!is_kind(box, "ftyp") || count < 8 || count > sizeof kinds ||
        !byte_file_read(jp2->file, box->place + box->head_bytes, kinds, (size_t)count))
        return refuse_cut(jp2);
    for (size_t i = 0; i + 4 <= count; i += 4)
        if (i != 4 && memcmp(kinds + i, "jp2 ", 4) == 0) /* between them is a version */
            return SONJECT_OK;
    return refuse(jp2, "is of another part of JPEG 2000: write it as .jp2");
}

/* What is in the head's box: the image's own head first, and neither palette nor transparency. */
static sonject_status read_heads(struct jp2_file *jp2, const struct box *outer)
{
    const uint64_t end = outer->place + outer->bytes;
    struct box box;
    uint64_t place = outer->place + outer->head_bytes;
    for (int i = 0; place < end; place += box.bytes, i++) {
        if (i == BOXES_MAX || !read_box(jp2, place, end, &box))
            return refuse_cut(jp2);
        if ((i == 0) != is_kind(&box, "ihdr"))
            return refuse_cut(jp2);
        if (i == 0 &&
            (box.bytes - box.head_bytes != IMAGE_BYTES ||
             !byte_file_read(jp2->file, place + box.head_bytes, jp2->image_head, IMAGE_BYTES)))
            return refuse_cut(jp2);
        if (is_kind(&box, "pclr") || is_kind(&box, "cmap") || is_kind(&box, "cdef"))
            return refuse(jp2, "has a palette or transparency: convert it to plain grey first");
    }
    return place > outer->place + outer->head_bytes ? SONJECT_OK : refuse_cut(jp2);
}

static sonject_status read_boxes(struct jp2_file *jp2)
{
    static const unsigned char mark[12] = {0, 0, 0, 12, 'j', 'P', ' ', ' ', 0x0D, 0x0A, 0x87, 0x0A};
    unsigned char first[sizeof mark];
    struct box box;
    sonject_status status = SONJECT_OK;
    int heads = 0;
    int images = 0;
    uint64_t place = sizeof mark;
    if (!byte_file_read(jp2->file, 0, first, sizeof first) || memcmp(first, mark, sizeof mark) != 0)
        return refuse_cut(jp2);
    for (int i = 0; status == SONJECT_OK && place < jp2->file_bytes; place += box.bytes, i++) {
        if (i == BOXES_MAX || !read_box(jp2, place, jp2->file_bytes, &box))
            return refuse_cut(jp2);
        if (i == 0) {
            status = check_kinds(jp2, &box);
        } else if (is_kind(&box, "jp2h")) {
            heads++;
            status = read_heads(jp2, &box);
        } else if (is_kind(&box, "jp2c")) {
            images++;
            jp2->coded = box;
            if (heads == 0)
                return refuse_cut(jp2);
        }
    }
    if (status == SONJECT_OK && images > 1)
        return refuse(jp2, "holds several images: write one a file");
    if (status == SONJECT_OK && (heads != 1 || images != 1))
        return refuse_cut(jp2);
    jp2->codestream.place = jp2->coded.place + jp2->coded.head_bytes;
    jp2->codestream.count = jp2->coded.bytes - jp2->coded.head_bytes;
    return status;
}

static bool heads_agree(const struct jp2_file *jp2, const struct jp2_image *image)
{
    const unsigned char *head = jp2->image_head;
    return number_from_bytes(head, 4, true) == image->rows &&
           number_from_bytes(head + 4, 4, true) == image->columns &&
           number_from_bytes(head + 8, 2, true) == 1 && head[10] == image->bits - 1 &&
           head[11] == 7; /* the one way of coding that there is */
}

static sonject_status open_jp2(struct jp2_file *jp2, struct report *report, const char *path,
                               struct jp2_image *image)
{
    unsigned char head[4];
    memset(jp2, 0, sizeof *jp2);
    jp2->report = report;
    jp2->path = path;
    jp2->file = byte_file_open(path, &jp2->file_bytes);
    if (!jp2->file)
        return file_refuse(report, path, errno);
    if (!byte_file_read(jp2->file, 0, head, sizeof head))
        return refuse_cut(jp2);
    jp2->has_boxes = !jp2_codestream_begins(head, sizeof head);
    jp2->codestream.count = jp2->file_bytes;
    sonject_status status = jp2->has_boxes ? read_boxes(jp2) : SONJECT_OK;
    if (status == SONJECT_OK)
        status = jp2_codestream_check(report, path, jp2->file, &jp2->codestream, image);
    if (status == SONJECT_OK && jp2->has_boxes && !heads_agree(jp2, image))
        status = refuse(jp2, "damaged JPEG 2000: its head and its coded image do not agree");
    return status;
}

static void close_jp2(struct jp2_file *jp2)
{
    if (jp2->file)
        fclose(jp2->file);
}

sonject_status jp2_check(struct report *report, const char *path, struct byte_ranges *parts)
{
    struct jp2_file jp2;
    struct jp2_image image;
    sonject_status status = open_jp2(&jp2, report, path, &image);
    if (status == SONJECT_OK && !byte_ranges_add(parts, jp2.codestream.place, jp2.codestream.count))
        status = report_out_of_memory(report, path);
    close_jp2(&jp2);
    return status;
}

/* Where the source has a long length, so has the result. */
static bool write_box_head(const struct jp2_file *source, uint64_t content_bytes, FILE *result)
{
    unsigned char head[LONG_HEAD_BYTES];
    const uint64_t bytes = content_bytes + HEAD_BYTES;
    const bool is_long = source->coded.head_bytes == LONG_HEAD_BYTES || bytes > UINT32_MAX;
    memcpy(head + 4, source->coded.kind, sizeof source->coded.kind);
    number_to_bytes(is_long ? 1 : bytes, head, 4, true);
    number_to_bytes(content_bytes + LONG_HEAD_BYTES, head + HEAD_BYTES, 8, true);
    const size_t count = is_long ? LONG_HEAD_BYTES : HEAD_BYTES;
    return fwrite(head, 1, count, result) == count;
}

static bool join(const struct jp2_file *source, const struct jp2_file *encoded, FILE *result)
{
    const struct byte_range *image = &encoded->codestream;
    const uint64_t behind = source->coded.place + source->coded.bytes;
    if (!source->has_boxes)
        return byte_file_copy(encoded->file, image->place, image->count, result);
    return byte_file_copy(source->file, 0, source->coded.place, result) &&
           write_box_head(source, image->count, result) &&
           byte_file_copy(encoded->file, image->place, image->count, result) &&
           byte_file_copy(source->file, behind, source->file_bytes - behind, result);
}

static sonject_status write_joined(const struct jp2_file *source, const struct jp2_file *encoded,
                                   const char *result, const char *name)
{
    errno = 0;
    FILE *file = fopen(result, "wb");
    bool is_good = file && join(source, encoded, file);
    int error = errno;
    if (file && fclose(file) != 0 && is_good) {
        is_good = false;
        error = errno;
    }
    return is_good ? SONJECT_OK
                   : file_failure(source->report, name, "write", error != 0 ? error : EIO);
}

sonject_status jp2_join(struct report *report, const char *source, const char *encoded,
                        const char *result, const char *name)
{
    struct jp2_file from;
    struct jp2_file pixels;
    struct jp2_image image;
    struct jp2_image fresh;
    memset(&pixels, 0, sizeof pixels);
    sonject_status status = open_jp2(&from, report, source, &image);
    if (status == SONJECT_OK)
        status = open_jp2(&pixels, report, encoded, &fresh);
    if (status == SONJECT_OK &&
        (image.rows != fresh.rows || image.columns != fresh.columns || image.bits != fresh.bits))
        status = report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be coded anew", source);
    if (status == SONJECT_OK)
        status = write_joined(&from, &pixels, result, name);
    close_jp2(&from);
    close_jp2(&pixels);
    return status;
}
