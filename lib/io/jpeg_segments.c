#include "io/jpeg_segments.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "io/byte_file.h"
#include "io/byte_order.h"

#define MARKER_IMAGE_START 0xD8
#define MARKER_IMAGE_END   0xD9
#define MARKER_SCAN_START  0xDA
#define MARKER_APPLICATION 0xE0 /* ...0xEF */
#define MARKER_COMMENT     0xFE

#define FILL_MAX 4096 /* bytes before a marker */

/* An image that is sent in several scans is decoded whole. */
#define PROGRESSIVE_PIXELS_MAX ((uint64_t)1 << 29)

/* Every block of 8 x 8 pixels takes a bit at least, in practice more. */
#define PIXELS_PER_BYTE_MAX 1024

struct jpeg_reader {
    FILE *file;
    uint64_t file_bytes;
    uint64_t place;         /* of the current segment's marker */
    uint64_t segment_bytes; /* with the marker */
    int marker;
};

static bool open_jpeg(struct jpeg_reader *reader, const char *path)
{
    unsigned char head[2];
    memset(reader, 0, sizeof *reader);
    reader->file = byte_file_open(path, &reader->file_bytes);
    reader->segment_bytes = sizeof head;
    return reader->file && byte_file_read(reader->file, 0, head, sizeof head) && head[0] == 0xFF &&
           head[1] == MARKER_IMAGE_START;
}

static void close_jpeg(struct jpeg_reader *reader)
{
    if (reader->file)
        fclose(reader->file);
}

/* Segments up to the first scan's; false where the file ends before, or is something else. */
static bool next_segment(struct jpeg_reader *reader)
{
    unsigned char head[4];
    reader->place += reader->segment_bytes;
    if (!byte_file_read(reader->file, reader->place, head, sizeof head) || head[0] != 0xFF)
        return false;
    for (int i = 0; head[1] == 0xFF; i++) /* markers may be preceded by some of these */
        if (i == FILL_MAX || !byte_file_read(reader->file, ++reader->place, head, sizeof head))
            return false;
    reader->marker = head[1];
    reader->segment_bytes = 2 + number_from_bytes(head + 2, 2, true);
    return reader->segment_bytes >= 4 &&
           reader->segment_bytes <= reader->file_bytes - reader->place;
}

static bool is_frame(int marker)
{
    return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

static sonject_status check_frame(struct report *report, const char *path,
                                  const struct jpeg_reader *reader)
{
    unsigned char frame[6];
    if (reader->segment_bytes < 4 + sizeof frame ||
        !byte_file_read(reader->file, reader->place + 4, frame, sizeof frame))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged JPEG: cut short", path);
    const uint64_t rows = number_from_bytes(frame + 1, 2, true);
    const uint64_t columns = number_from_bytes(frame + 3, 2, true);
    if (frame[5] != 1)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has %d channels; sonject reads JPEG with 1 (amplitude): convert "
                              "it to one channel first",
                              path, frame[5]);
    if (frame[0] != 8)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has %d-bit pixels; sonject reads JPEG with 8: convert it first",
                              path, frame[0]);
    if (rows == 0 || columns == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged JPEG: it has no pixels",
                              path);
    if (rows * columns / PIXELS_PER_BYTE_MAX > reader->file_bytes)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged JPEG: cut short", path);
    if (reader->marker == 0xC2 && rows * columns > PROGRESSIVE_PIXELS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is progressive and has more than 2^29 pixels: write it as "
                              "baseline JPEG",
                              path);
    return SONJECT_OK;
}

/* True if the end marker follows the first scan's start. It cannot occur within coded pixels, which
 * never have this byte behind 0xFF. */
static bool has_end(const struct jpeg_reader *reader)
{
    unsigned char bytes[16384];
    unsigned char before = 0;
    for (uint64_t place = reader->place + reader->segment_bytes; place < reader->file_bytes;
         place += sizeof bytes) {
        const uint64_t left = reader->file_bytes - place;
        const size_t some = left < sizeof bytes ? (size_t)left : sizeof bytes;
        if (!byte_file_read(reader->file, place, bytes, some))
            return false;
        for (size_t i = 0; i < some; before = bytes[i++])
            if (before == 0xFF && bytes[i] == MARKER_IMAGE_END)
                return true;
    }
    return false;
}

static bool is_application(const struct jpeg_reader *reader)
{
    return (reader->marker & 0xF0) == MARKER_APPLICATION;
}

/* Segments up to the first scan's. */
static sonject_status check_segments(struct report *report, const char *path,
                                     struct jpeg_reader *reader, struct byte_ranges *parts)
{
    bool has_frame = false;
    bool has_memory = byte_ranges_add(parts, 0, 2);
    while (next_segment(reader) && reader->marker != MARKER_SCAN_START) {
        if (is_frame(reader->marker)) {
            const sonject_status status = check_frame(report, path, reader);
            if (status != SONJECT_OK)
                return status;
            has_frame = true;
        }
        if (!is_application(reader))
            has_memory = byte_ranges_add(parts, reader->place, reader->segment_bytes) && has_memory;
    }
    if (reader->marker != MARKER_SCAN_START || !has_frame || !has_end(reader))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged JPEG: cut short", path);
    has_memory =
        byte_ranges_add(parts, reader->place, reader->file_bytes - reader->place) && has_memory;
    return has_memory ? SONJECT_OK : report_out_of_memory(report, path);
}

sonject_status jpeg_check(struct report *report, const char *path, struct byte_ranges *parts)
{
    struct jpeg_reader reader;
    const sonject_status status =
        open_jpeg(&reader, path)
            ? check_segments(report, path, &reader, parts)
            : report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be read as JPEG", path);
    close_jpeg(&reader);
    return status;
}

/* Pointers to other pictures in the same file (multi-picture format) would lead nowhere. */
static bool is_multi_picture(const struct jpeg_reader *reader)
{
    unsigned char head[4];
    return reader->marker == MARKER_APPLICATION + 2 &&
           byte_file_read(reader->file, reader->place + 4, head, sizeof head) &&
           memcmp(head, "MPF", 4) == 0;
}

/* Copies the notes of a file, or everything up to the first scan but these. */
static bool copy_segments(struct jpeg_reader *reader, bool copies_notes, FILE *result)
{
    while (next_segment(reader)) {
        const bool is_note =
            (reader->marker & 0xF0) == MARKER_APPLICATION || reader->marker == MARKER_COMMENT;
        if (reader->marker == MARKER_SCAN_START)
            return true;
        if (is_note == copies_notes && !is_multi_picture(reader) &&
            !byte_file_copy(reader->file, reader->place, reader->segment_bytes, result))
            return false;
    }
    return false;
}

static bool join(struct jpeg_reader *source, struct jpeg_reader *encoded, FILE *result)
{
    return byte_file_copy(source->file, 0, 2, result) && copy_segments(source, true, result) &&
           copy_segments(encoded, false, result) &&
           byte_file_copy(encoded->file, encoded->place, encoded->file_bytes - encoded->place,
                          result);
}

sonject_status jpeg_join(struct report *report, const char *source, const char *encoded,
                         const char *result, const char *name)
{
    struct jpeg_reader from;
    struct jpeg_reader pixels;
    errno = 0;
    FILE *to = fopen(result, "wb");
    bool is_good = to != NULL;
    is_good = open_jpeg(&from, source) && is_good;
    is_good = open_jpeg(&pixels, encoded) && is_good;
    is_good = is_good && join(&from, &pixels, to);
    if (to && fclose(to) != 0)
        is_good = false;
    const int error = errno;
    close_jpeg(&from);
    close_jpeg(&pixels);
    return is_good ? SONJECT_OK : file_failure(report, name, "write", error != 0 ? error : EIO);
}
