#include "io/png_chunks.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "io/byte_file.h"
#include "io/byte_order.h"

#define SIGNATURE_BYTES      8
#define INTERLACED_BYTES_MAX ((uint64_t)1 << 30) /* interlaced pictures are decoded whole */
#define DEFLATE_RATIO_MAX    1032
#define SIDE_MAX             1000000 /* of libpng */
#define HEADER_BYTES         25      /* of the IHDR chunk with length, name and checksum */
#define COLOURS_PLACE        17      /* in them, of the kind of colour */
#define COLOURS_BY_PALETTE   3
#define NUMBERS_CHUNK        "soNu" /* in pictures of numbers: the header of a grey PNG */
#define TEXTS_MAX            16     /* that are read */
#define TEXT_BYTES_MAX       65536

struct png_reader {
    FILE *file;
    uint64_t file_bytes;
    uint64_t place;       /* of the current chunk */
    uint64_t chunk_bytes; /* with length, name and checksum */
    char name[5];
    bool has_palette;
    uint32_t checksums[256]; /* of the 256 bytes */
};

static void make_checksums(struct png_reader *reader)
{
    for (uint32_t byte = 0; byte < 256; byte++) {
        uint32_t sum = byte;
        for (int bit = 0; bit < 8; bit++)
            sum = sum & 1 ? sum >> 1 ^ UINT32_C(0xEDB88320) : sum >> 1;
        reader->checksums[byte] = sum;
    }
}

static bool open_png(struct png_reader *reader, const char *path)
{
    static const unsigned char signature[SIGNATURE_BYTES] = {0x89, 'P',  'N',  'G',
                                                             '\r', '\n', 0x1A, '\n'};
    unsigned char head[SIGNATURE_BYTES];
    memset(reader, 0, sizeof *reader);
    make_checksums(reader);
    reader->file = byte_file_open(path, &reader->file_bytes);
    reader->chunk_bytes = SIGNATURE_BYTES; /* what the first chunk lies behind */
    return reader->file && byte_file_read(reader->file, 0, head, sizeof head) &&
           memcmp(head, signature, sizeof head) == 0;
}

static void close_png(struct png_reader *reader)
{
    if (reader->file)
        fclose(reader->file);
}

/* False where the file ends before the chunk does. */
static bool next_chunk(struct png_reader *reader)
{
    unsigned char head[8];
    reader->place += reader->chunk_bytes;
    if (!byte_file_read(reader->file, reader->place, head, sizeof head))
        return false;
    reader->chunk_bytes = number_from_bytes(head, 4, true) + 12;
    memcpy(reader->name, head + 4, 4);
    return reader->chunk_bytes <= reader->file_bytes - reader->place;
}

/* True if the current chunk's checksum is that of its name and content. */
static bool is_intact(const struct png_reader *reader)
{
    unsigned char bytes[16384];
    uint32_t sum = UINT32_C(0xFFFFFFFF);
    uint64_t place = reader->place + 4;
    const uint64_t end = reader->place + reader->chunk_bytes - 4;
    while (place < end) {
        const size_t some = end - place < sizeof bytes ? (size_t)(end - place) : sizeof bytes;
        if (!byte_file_read(reader->file, place, bytes, some))
            return false;
        for (size_t i = 0; i < some; i++)
            sum = reader->checksums[(sum ^ bytes[i]) & 0xFF] ^ sum >> 8;
        place += some;
    }
    return byte_file_read(reader->file, end, bytes, 4) &&
           number_from_bytes(bytes, 4, true) == (sum ^ UINT32_C(0xFFFFFFFF));
}

static bool is_chunk(const struct png_reader *reader, const char *name)
{
    return strcmp(reader->name, name) == 0;
}

static sonject_status cut_short(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged PNG: cut short", path);
}

static sonject_status refuse_palette(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: has a palette; convert it to one channel first", path);
}

static sonject_status check_colours(struct report *report, const char *path, unsigned bits,
                                    unsigned colours)
{
    static const int channels[] = {1, 0, 3, 1, 2, 0, 4};
    if (colours == COLOURS_BY_PALETTE)
        return refuse_palette(report, path);
    if (colours > 6 || channels[colours] == 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: damaged PNG: unknown kind of colour", path);
    if (colours != 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has %d channels (%s); sonject reads PNG with 1 (amplitude): "
                              "convert it to one channel first",
                              path, channels[colours],
                              colours == 2   ? "red, green, blue"
                              : colours == 4 ? "grey, transparency"
                                             : "red, green, blue, transparency");
    if (bits != 8 && bits != 16)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has %u-bit pixels; sonject reads PNG with 8 or 16: convert it "
                              "to one of these",
                              path, bits);
    return SONJECT_OK;
}

/* *bytes gets what the pixels take before compression. */
static sonject_status check_header(struct report *report, const char *path,
                                   struct png_reader *reader, uint64_t *bytes)
{
    unsigned char header[13];
    if (!next_chunk(reader) || !is_chunk(reader, "IHDR") ||
        reader->chunk_bytes != sizeof header + 12 || !is_intact(reader) ||
        !byte_file_read(reader->file, reader->place + 8, header, sizeof header))
        return cut_short(report, path);
    const uint64_t columns = number_from_bytes(header, 4, true);
    const uint64_t rows = number_from_bytes(header + 4, 4, true);
    if (rows == 0 || columns == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: damaged PNG: it has no pixels",
                              path);
    if (rows > SIDE_MAX || columns > SIDE_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: claims %llu x %llu pixels; a PNG is read up to a million each "
                              "way: convert it to TIFF",
                              path, (unsigned long long)rows, (unsigned long long)columns);
    *bytes = rows * (columns * (header[8] / 8) + 1);
    if (header[12] != 0 && *bytes > INTERLACED_BYTES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is interlaced and larger than 1 GB: write it without "
                              "interlacing",
                              path);
    reader->has_palette = header[9] == COLOURS_BY_PALETTE && header[8] == 8;
    return reader->has_palette ? SONJECT_OK : check_colours(report, path, header[8], header[9]);
}

/* A copy of the header that calls the palette's indices grey levels, which they are too: added to
 * parts in its place. */
static bool take_numbers_header(struct png_reader *reader, struct byte_ranges *parts,
                                bool *has_memory)
{
    unsigned char header[2][HEADER_BYTES];
    if (reader->chunk_bytes != HEADER_BYTES + 12 || !is_intact(reader) ||
        !byte_file_read(reader->file, SIGNATURE_BYTES, header[0], HEADER_BYTES) ||
        !byte_file_read(reader->file, reader->place + 8, header[1], HEADER_BYTES) ||
        memcmp(header[0], header[1], COLOURS_PLACE) != 0 || header[1][COLOURS_PLACE] != 0)
        return false;
    *has_memory = byte_ranges_add(parts, reader->place + 8, HEADER_BYTES) && *has_memory;
    return true;
}

static sonject_status check_chunks(struct report *report, const char *path,
                                   struct png_reader *reader, struct byte_ranges *parts)
{
    uint64_t bytes = 0;
    uint64_t compressed = 0;
    int texts = 0;
    const sonject_status status = check_header(report, path, reader, &bytes);
    if (status != SONJECT_OK)
        return status;
    bool has_memory =
        byte_ranges_add(parts, 0, SIGNATURE_BYTES + (reader->has_palette ? 0 : HEADER_BYTES));
    bool has_numbers = !reader->has_palette;
    do {
        if (!next_chunk(reader))
            return cut_short(report, path);
        if (!has_numbers && is_chunk(reader, NUMBERS_CHUNK))
            has_numbers = take_numbers_header(reader, parts, &has_memory);
        if (is_chunk(reader, "tRNS"))
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "%s: has a transparent grey level; convert it to plain grey first", path);
        const bool is_pixels = is_chunk(reader, "IDAT");
        if (is_pixels && !has_numbers)
            return refuse_palette(report, path);
        const bool is_needed = is_pixels || is_chunk(reader, "IEND");
        const bool is_text = is_chunk(reader, "tEXt") && reader->chunk_bytes <= TEXT_BYTES_MAX &&
                             texts < TEXTS_MAX && is_intact(reader);
        if (is_needed && !is_intact(reader))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: damaged PNG: the checksum at byte %llu is wrong", path,
                                  (unsigned long long)reader->place);
        if (is_needed || is_text)
            has_memory = byte_ranges_add(parts, reader->place, reader->chunk_bytes) && has_memory;
        compressed += is_pixels ? reader->chunk_bytes : 0;
        texts += is_text;
    } while (!is_chunk(reader, "IEND"));
    if (bytes / DEFLATE_RATIO_MAX > compressed || compressed == 0)
        return cut_short(report, path);
    return has_memory ? SONJECT_OK : report_out_of_memory(report, path);
}

sonject_status png_check(struct report *report, const char *path, struct byte_ranges *parts)
{
    struct png_reader reader;
    const sonject_status status =
        open_png(&reader, path)
            ? check_chunks(report, path, &reader, parts)
            : report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be read as PNG", path);
    close_png(&reader);
    return status;
}

static bool copy_chunk(const struct png_reader *reader, FILE *result)
{
    return byte_file_copy(reader->file, reader->place, reader->chunk_bytes, result);
}

static uint32_t checksum(const struct png_reader *reader, const unsigned char *bytes, size_t count)
{
    uint32_t sum = UINT32_C(0xFFFFFFFF);
    for (size_t i = 0; i < count; i++)
        sum = reader->checksums[(sum ^ bytes[i]) & 0xFF] ^ sum >> 8;
    return sum ^ UINT32_C(0xFFFFFFFF);
}

/* At most PALETTE_BYTES of content. */
static bool write_chunk(const struct png_reader *reader, const char *name, const void *content,
                        uint32_t count, FILE *result)
{
    unsigned char bytes[8 + PNG_PALETTE_BYTES + 4];
    number_to_bytes(count, bytes, 4, true);
    memcpy(bytes + 4, name, 4);
    memcpy(bytes + 8, content, count);
    number_to_bytes(checksum(reader, bytes + 4, 4 + count), bytes + 8 + count, 4, true);
    return fwrite(bytes, 1, 12 + count, result) == 12 + count;
}

static bool colour(struct png_reader *grey, const uint8_t *palette, FILE *result)
{
    unsigned char header[HEADER_BYTES];
    bool is_good = byte_file_copy(grey->file, 0, SIGNATURE_BYTES, result) && next_chunk(grey) &&
                   grey->chunk_bytes == HEADER_BYTES &&
                   byte_file_read(grey->file, grey->place, header, HEADER_BYTES);
    if (!is_good)
        return false;
    unsigned char coloured[13];
    memcpy(coloured, header + 8, sizeof coloured);
    coloured[COLOURS_PLACE - 8] = COLOURS_BY_PALETTE;
    is_good = write_chunk(grey, "IHDR", coloured, sizeof coloured, result) &&
              write_chunk(grey, "PLTE", palette, PNG_PALETTE_BYTES, result) &&
              write_chunk(grey, NUMBERS_CHUNK, header, HEADER_BYTES, result);
    while (is_good && !is_chunk(grey, "IEND"))
        is_good = next_chunk(grey) && copy_chunk(grey, result);
    return is_good;
}

sonject_status png_colour(struct report *report, const char *grey, const uint8_t *palette,
                          const char *result, const char *name)
{
    struct png_reader from;
    errno = 0;
    FILE *to = fopen(result, "wb");
    bool is_good = to != NULL;
    is_good = open_png(&from, grey) && is_good;
    is_good = is_good && colour(&from, palette, to);
    if (to && fclose(to) != 0)
        is_good = false;
    const int error = errno;
    close_png(&from);
    return is_good ? SONJECT_OK : file_failure(report, name, "write", error != 0 ? error : EIO);
}

/* The chunks of pixels, all of them. */
static bool copy_pixels(struct png_reader *encoded, FILE *result)
{
    bool is_good = true;
    do {
        is_good =
            next_chunk(encoded) && (!is_chunk(encoded, "IDAT") || copy_chunk(encoded, result));
    } while (is_good && !is_chunk(encoded, "IEND"));
    return is_good;
}

static bool join(struct png_reader *source, struct png_reader *encoded, FILE *result)
{
    bool has_pixels = false;
    bool is_good = byte_file_copy(source->file, 0, SIGNATURE_BYTES, result) && next_chunk(source) &&
                   next_chunk(encoded) && copy_chunk(encoded, result);
    do {
        is_good = is_good && next_chunk(source);
        if (is_good && !is_chunk(source, "IDAT")) {
            is_good = copy_chunk(source, result);
        } else if (is_good && !has_pixels) {
            has_pixels = true;
            is_good = copy_pixels(encoded, result);
        }
    } while (is_good && !is_chunk(source, "IEND"));
    return is_good && has_pixels;
}

sonject_status png_join(struct report *report, const char *source, const char *encoded,
                        const char *result, const char *name)
{
    struct png_reader from;
    struct png_reader pixels;
    errno = 0;
    FILE *to = fopen(result, "wb");
    bool is_good = to != NULL;
    is_good = open_png(&from, source) && is_good;
    is_good = open_png(&pixels, encoded) && is_good;
    is_good = is_good && join(&from, &pixels, to);
    if (to && fclose(to) != 0)
        is_good = false;
    const int error = errno;
    close_png(&from);
    close_png(&pixels);
    return is_good ? SONJECT_OK : file_failure(report, name, "write", error != 0 ? error : EIO);
}
