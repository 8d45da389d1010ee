#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "io/exr_chunks.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "io/byte_file.h"
#include "io/byte_order.h"
#include "io/exr_header.h"

#define PLACE_BYTES 8
#define HEAD_BYTES  8    /* of a chunk: its first row, the bytes that follow */
#define RATIO_MAX   1032 /* of compression: that of deflate, which no other kind reaches */

struct exr_file {
    struct report *report;
    const char *path;
    FILE *file;
    uint64_t file_bytes;
    struct exr_header header;
    uint64_t chunk_count;
    uint64_t chunks_place; /* behind the header and the table of places */
    unsigned char *places; /* owned: the table */
};

/* False if it is not what it must be there. */
static bool find_chunk(const struct exr_file *exr, uint64_t number, struct byte_range *chunk)
{
    unsigned char head[HEAD_BYTES];
    const struct exr_header *header = &exr->header;
    const uint64_t first = number * header->chunk_rows;
    const uint64_t left = header->rows - first;
    const uint64_t rows = left < header->chunk_rows ? left : header->chunk_rows;
    const uint64_t plain_bytes = rows * header->columns * header->pixel_bytes;
    chunk->place = number_from_bytes(exr->places + PLACE_BYTES * number, PLACE_BYTES, false);
    if (chunk->place < exr->chunks_place || chunk->place > exr->file_bytes - HEAD_BYTES ||
        !byte_file_read(exr->file, chunk->place, head, sizeof head))
        return false;
    const int64_t first_row = (int32_t)(uint32_t)number_from_bytes(head, 4, false);
    const uint64_t bytes = number_from_bytes(head + 4, 4, false);
    const bool is_plain = bytes == plain_bytes;
    const bool is_compressed = header->compression != 0 && bytes > 0 && bytes < plain_bytes &&
                               bytes >= plain_bytes / RATIO_MAX;
    chunk->count = HEAD_BYTES + bytes;
    return first_row == header->first_row + (int64_t)first && (is_plain || is_compressed) &&
           chunk->count <= exr->file_bytes - chunk->place;
}

static sonject_status check_chunks(const struct exr_file *exr)
{
    const struct exr_header *header = &exr->header;
    uint64_t bytes = 0;
    for (uint64_t i = 0; i < exr->chunk_count; i++) {
        struct byte_range chunk;
        const bool is_found = find_chunk(exr, i, &chunk);
        bytes += is_found ? chunk.count : 0;
        /* chunks that share their bytes would make a long work of a small file */
        if (!is_found || bytes > exr->file_bytes - exr->chunks_place)
            return report_failure(exr->report, SONJECT_ERROR_INPUT,
                                  "%s: cut short or damaged at rows %llu...%llu: copy it again",
                                  exr->path, (unsigned long long)(i * header->chunk_rows),
                                  (unsigned long long)((i + 1) * header->chunk_rows - 1));
    }
    return SONJECT_OK;
}

static sonject_status read_places(struct exr_file *exr)
{
    const struct exr_header *header = &exr->header;
    exr->chunk_count = (header->rows + header->chunk_rows - 1) / header->chunk_rows;
    if (exr->chunk_count > (exr->file_bytes - header->bytes) / (PLACE_BYTES + HEAD_BYTES))
        return report_failure(exr->report, SONJECT_ERROR_INPUT,
                              "%s: cut short or damaged: it cannot hold %llu rows: copy it again",
                              exr->path, (unsigned long long)header->rows);
    exr->chunks_place = header->bytes + PLACE_BYTES * exr->chunk_count;
    exr->places = allocate_array((size_t)exr->chunk_count, PLACE_BYTES);
    if (!exr->places)
        return report_out_of_memory(exr->report, exr->path);
    return byte_file_read(exr->file, header->bytes, exr->places,
                          (size_t)exr->chunk_count * PLACE_BYTES)
               ? SONJECT_OK
               : report_failure(exr->report, SONJECT_ERROR_INPUT, "%s: cannot be read", exr->path);
}

/* To be given to close_exr, also after a failure. */
static sonject_status open_exr(struct exr_file *exr, struct report *report, const char *path)
{
    memset(exr, 0, sizeof *exr);
    exr->report = report;
    exr->path = path;
    exr->file = byte_file_open(path, &exr->file_bytes);
    if (!exr->file)
        return file_refuse(report, path, errno);
    sonject_status status = exr_header_read(report, path, exr->file, exr->file_bytes, &exr->header);
    if (status == SONJECT_OK)
        status = read_places(exr);
    return status == SONJECT_OK ? check_chunks(exr) : status;
}

static void close_exr(struct exr_file *exr)
{
    if (exr->file)
        fclose(exr->file);
    free(exr->places);
}

sonject_status exr_check(struct report *report, const char *path)
{
    struct exr_file exr;
    const sonject_status status = open_exr(&exr, report, path);
    close_exr(&exr);
    return status;
}

/* Header, table and chunks, and the table once more when their places are known. */
static bool join(struct exr_file *source, const struct exr_file *encoded,
                 const struct region *region, FILE *result)
{
    const uint64_t chunk_rows = source->header.chunk_rows;
    const size_t table_bytes = (size_t)(PLACE_BYTES * source->chunk_count);
    uint64_t place = source->chunks_place;
    bool is_good = byte_file_copy(source->file, 0, place, result);
    for (uint64_t i = 0; is_good && i < source->chunk_count; i++) {
        const uint64_t number = source->header.is_upwards ? source->chunk_count - 1 - i : i;
        const uint64_t first = number * chunk_rows;
        const bool is_new =
            first < region->first_row + region->rows && first + chunk_rows > region->first_row;
        const struct exr_file *from = is_new ? encoded : source;
        struct byte_range chunk;
        is_good = find_chunk(from, number, &chunk) &&
                  byte_file_copy(from->file, chunk.place, chunk.count, result);
        number_to_bytes(place, source->places + PLACE_BYTES * number, PLACE_BYTES, false);
        place += chunk.count;
    }
    return is_good && fseeko(result, (off_t)source->header.bytes, SEEK_SET) == 0 &&
           fwrite(source->places, 1, table_bytes, result) == table_bytes;
}

static sonject_status write_joined(struct exr_file *source, const struct exr_file *encoded,
                                   const struct region *region, const char *result,
                                   const char *name)
{
    errno = 0;
    FILE *file = fopen(result, "wb");
    bool is_good = file && join(source, encoded, region, file);
    int error = errno;
    if (file && fclose(file) != 0 && is_good) {
        is_good = false;
        error = errno;
    }
    return is_good ? SONJECT_OK
                   : file_failure(source->report, name, "write", error != 0 ? error : EIO);
}

sonject_status exr_join(struct report *report, const char *source, const char *encoded,
                        const struct region *region, const char *result, const char *name)
{
    struct exr_file from;
    struct exr_file pixels;
    memset(&pixels, 0, sizeof pixels);
    sonject_status status = open_exr(&from, report, source);
    if (status == SONJECT_OK)
        status = open_exr(&pixels, report, encoded);
    if (status == SONJECT_OK &&
        (from.header.rows != pixels.header.rows || from.header.columns != pixels.header.columns ||
         from.header.first_row != pixels.header.first_row ||
         from.header.pixel_bytes != pixels.header.pixel_bytes ||
         from.header.compression != pixels.header.compression))
        status = report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be coded anew", source);
    if (status == SONJECT_OK)
        status = write_joined(&from, &pixels, region, result, name);
    close_exr(&from);
    close_exr(&pixels);
    return status;
}
