#include "io/jp2_codestream.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "io/byte_order.h"

#define MARKER_START      0xFF4F
#define MARKER_SIZE       0xFF51
#define MARKER_CODING     0xFF52
#define MARKER_LENGTHS    0xFF55 /* of tiles' parts */
#define MARKER_PACKETS    0xFF57 /* lengths */
#define MARKER_TILE_PACKS 0xFF58 /* lengths, in a tile's part */
#define MARKER_STEPS      0xFF5C /* of quantisation */
#define MARKER_REGISTERED 0xFF63
#define MARKER_COMMENT    0xFF64
#define MARKER_TILE       0xFF90
#define MARKER_DATA       0xFF93
#define MARKER_END        0xFFD9

#define SIZE_BYTES      43 /* with the marker, for one component */
#define CODING_BYTES    14 /* with the marker, without sizes of precincts */
#define TILE_HEAD_BYTES 12
#define SEGMENTS_MAX    4096
#define LEVELS_MAX      32
#define LAYERS_MAX      256

/* What is decoded is held whole, as 32-bit numbers. */
#define PIXELS_MAX ((uint64_t)1 << 27)

/* Even images of one level have some bytes for these. Small ones may be that. */
#define PIXELS_PER_BYTE_MAX 1024
#define SMALL_PIXELS        ((uint64_t)1 << 22)

/* What the decoder keeps a structure for each of. */
#define TILES_MAX     16384
#define PRECINCTS_MAX ((uint64_t)1 << 16) /* of a tile */
#define PACKETS_MAX   ((uint64_t)1 << 20) /* of a tile */

struct reader {
    struct report *report;
    const char *path;
    FILE *file;
    uint64_t place, end; /* in the file */
    struct jp2_image *image;
    uint64_t tile_rows, tile_columns; /* pixels */
    uint64_t tiles;
    unsigned char *parts;    /* of each tile: that were found */
    unsigned char *expected; /* of each tile: that it says to have, or 0 */
};

static sonject_status refuse(const struct reader *reader, const char *what)
{
    return report_failure(reader->report, SONJECT_ERROR_INPUT, "%s: %s", reader->path, what);
}

static sonject_status refuse_cut(const struct reader *reader)
{
    return refuse(reader, "damaged JPEG 2000: cut short, or its parts are not where it says");
}

static uint64_t word_at(const unsigned char *bytes, size_t place, size_t count)
{
    return number_from_bytes(bytes + place, count, true);
}

/* Bytes from the place on, all of them within the coded image. */
static bool take(const struct reader *reader, unsigned char *bytes, size_t count)
{
    return reader->place <= reader->end && reader->end - reader->place >= count &&
           byte_file_read(reader->file, reader->place, bytes, count);
}

static uint64_t quotient_up(uint64_t dividend, uint64_t divisor)
{
    return dividend / divisor + (dividend % divisor > 0);
}

bool jp2_codestream_begins(const unsigned char *bytes, size_t count)
{
    return count >= 4 && word_at(bytes, 0, 2) == MARKER_START &&
           word_at(bytes, 2, 2) == MARKER_SIZE;
}

static sonject_status check_sample(const struct reader *reader, const unsigned char *size)
{
    const unsigned components = (unsigned)word_at(size, 38, 2);
    const unsigned bits = (size[40] & 0x7Fu) + 1;
    const bool is_signed = (size[40] & 0x80) != 0;
    if (components != 1)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: has %u components; sonject reads JPEG 2000 with 1 (amplitude): "
                              "convert it to one channel first",
                              reader->path, components);
    if ((bits != 8 && bits != 16) || is_signed)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: has %u-bit %s samples; sonject reads JPEG 2000 of 8 and 16 bit "
                              "unsigned: convert it to one of these",
                              reader->path, bits, is_signed ? "signed" : "unsigned");
    reader->image->bits = bits;
    return SONJECT_OK;
}

static sonject_status check_sides(const struct reader *reader)
{
    const uint64_t rows = reader->image->rows;
    const uint64_t columns = reader->image->columns;
    if (rows < JP2_SIDE_MIN || columns < JP2_SIDE_MIN)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: has fewer than the %d rows and columns that are read of JPEG "
                              "2000: convert it to TIFF",
                              reader->path, JP2_SIDE_MIN);
    if (rows > PIXELS_MAX / columns)
        return refuse(reader, "has more than the 2^27 pixels that are read of JPEG 2000: convert "
                              "it to TIFF, or cut it into several");
    const uint64_t pixels = rows * columns;
    if (pixels > SMALL_PIXELS && pixels / PIXELS_PER_BYTE_MAX > reader->end - reader->place)
        return refuse_cut(reader);
    return SONJECT_OK;
}

/* The first segment: the image's size, the tiles' and the samples' */
static sonject_status read_size(struct reader *reader)
{
    unsigned char size[SIZE_BYTES];
    if (!take(reader, size, sizeof size) || word_at(size, 0, 2) != MARKER_SIZE)
        return refuse_cut(reader);
    sonject_status status = check_sample(reader, size);
    if (status != SONJECT_OK)
        return status;
    if (word_at(size, 2, 2) != SIZE_BYTES - 2 || size[41] != 1 || size[42] != 1)
        return refuse(reader, "damaged JPEG 2000: its samples are not one a pixel");
    if (word_at(size, 14, 8) != 0 || word_at(size, 30, 8) != 0)
        return refuse(reader, "is a part of a larger grid (its image or its tiles have an offset): "
                              "write it anew without");
    reader->image->columns = word_at(size, 6, 4);
    reader->image->rows = word_at(size, 10, 4);
    const uint64_t columns = word_at(size, 22, 4);
    const uint64_t rows = word_at(size, 26, 4);
    status = check_sides(reader);
    if (status != SONJECT_OK)
        return status;
    if (columns == 0 || rows == 0 || columns > INT32_MAX || rows > INT32_MAX)
        return refuse(reader, "damaged JPEG 2000: its tiles have no size");
    reader->tile_columns = columns < reader->image->columns ? columns : reader->image->columns;
    reader->tile_rows = rows < reader->image->rows ? rows : reader->image->rows;
    reader->tiles =
        quotient_up(reader->image->columns, columns) * quotient_up(reader->image->rows, rows);
    if (reader->tiles > TILES_MAX)
        return refuse(reader, "has more than 16384 tiles: write it anew with larger ones");
    reader->place += SIZE_BYTES;
    return SONJECT_OK;
}

/* Of one tile, all its halved images together. Both of a precinct's sides are powers of 2. */
static uint64_t count_precincts(const struct reader *reader, unsigned levels,
                                const unsigned char *sides)
{
    uint64_t count = 0;
    for (unsigned i = 0; i <= levels; i++) {
        const uint64_t scale = UINT64_C(1) << (levels - i);
        const unsigned across = sides ? sides[i] & 15u : 15;
        const unsigned down = sides ? sides[i] >> 4 : 15;
        /* a tile may begin within a precinct, and end within one */
        count += ((quotient_up(reader->tile_columns, scale) >> across) + 2) *
                 ((quotient_up(reader->tile_rows, scale) >> down) + 2);
    }
    return count;
}

static sonject_status check_coding(const struct reader *reader, uint64_t bytes)
{
    unsigned char coding[CODING_BYTES + LEVELS_MAX + 1];
    const size_t count = bytes < sizeof coding ? (size_t)bytes : sizeof coding;
    if (bytes < CODING_BYTES || !take(reader, coding, count))
        return refuse_cut(reader);
    const unsigned levels = coding[9];
    const bool has_sides = (coding[4] & 1) != 0;
    const uint64_t layers = word_at(coding, 6, 2);
    if (levels > LEVELS_MAX || bytes != CODING_BYTES + (has_sides ? levels + 1u : 0) ||
        coding[5] > 4 || coding[8] != 0 || coding[12] > 0x3F || coding[13] > 1 || layers == 0)
        return refuse(reader, "damaged JPEG 2000: it is coded in no way that there is");
    const unsigned across = coding[10] + 2u;
    const unsigned down = coding[11] + 2u;
    const uint64_t precincts =
        count_precincts(reader, levels, has_sides ? coding + CODING_BYTES : NULL);
    if (across < 4 || down < 4 || across + down > 12 || layers > LAYERS_MAX ||
        precincts > PRECINCTS_MAX || layers * precincts > PACKETS_MAX)
        return refuse(reader, "is coded in too many parts (blocks, precincts or layers): write it "
                              "anew with an encoder's usual choices");
    return SONJECT_OK;
}

/* A marker and its segment's bytes, the marker's among them. */
static bool read_marker(const struct reader *reader, unsigned *marker, uint64_t *bytes)
{
    unsigned char head[4];
    if (!take(reader, head, sizeof head))
        return false;
    *marker = (unsigned)word_at(head, 0, 2);
    *bytes = 2 + word_at(head, 2, 2);
    return *marker == MARKER_DATA || (*bytes >= 4 && *bytes <= reader->end - reader->place);
}

/* Segments up to the first tile's: those that one component needs, or that say nothing of how the
 * image is decoded. */
static sonject_status read_head(struct reader *reader)
{
    int codings = 0;
    int steps = 0;
    for (int i = 0; i < SEGMENTS_MAX; i++) {
        unsigned marker;
        uint64_t bytes;
        if (!read_marker(reader, &marker, &bytes))
            return refuse_cut(reader);
        sonject_status status = SONJECT_OK;
        switch (marker) {
        case MARKER_TILE:
            return codings == 1 && steps == 1
                       ? SONJECT_OK
                       : refuse(reader, "damaged JPEG 2000: it does not say how it is coded");
        case MARKER_CODING:
            codings++;
            status = check_coding(reader, bytes);
            break;
        case MARKER_STEPS:
            steps++;
            break;
        case MARKER_LENGTHS:
        case MARKER_PACKETS:
        case MARKER_REGISTERED:
        case MARKER_COMMENT:
            break;
        default:
            return report_failure(reader->report, SONJECT_ERROR_INPUT,
                                  "%s: damaged JPEG 2000, or one of a kind that sonject does not "
                                  "read (marker %04X at byte %llu): convert it to TIFF",
                                  reader->path, marker, (unsigned long long)reader->place);
        }
        if (status != SONJECT_OK)
            return status;
        reader->place += bytes;
    }
    return refuse_cut(reader);
}

/* The segments of a tile's part up to its data, which begins before end. */
static sonject_status read_tile_head(struct reader *reader, uint64_t end)
{
    for (int i = 0; i < SEGMENTS_MAX; i++) {
        unsigned marker;
        uint64_t bytes;
        if (end - reader->place < 2 || !read_marker(reader, &marker, &bytes))
            return refuse_cut(reader);
        if (marker == MARKER_DATA)
            return SONJECT_OK;
        if (marker != MARKER_COMMENT && marker != MARKER_TILE_PACKS)
            return refuse(reader, "damaged JPEG 2000, or it codes each tile in another way: "
                                  "convert it to TIFF");
        if (bytes > end - reader->place)
            return refuse_cut(reader);
        reader->place += bytes;
    }
    return refuse_cut(reader);
}

static sonject_status read_tile_part(struct reader *reader)
{
    unsigned char head[TILE_HEAD_BYTES];
    const uint64_t last = reader->end - 2; /* where the end's marker is */
    if (!take(reader, head, sizeof head) || word_at(head, 0, 2) != MARKER_TILE ||
        word_at(head, 2, 2) != TILE_HEAD_BYTES - 2)
        return refuse_cut(reader);
    const uint64_t tile = word_at(head, 4, 2);
    const uint64_t bytes = word_at(head, 6, 4); /* 0: up to the end */
    const uint64_t end = bytes > 0 ? reader->place + bytes : last;
    if (tile >= reader->tiles || end > last || end - reader->place < TILE_HEAD_BYTES + 2 ||
        (bytes > 0 && bytes < TILE_HEAD_BYTES + 2))
        return refuse_cut(reader);
    if (head[10] != reader->parts[tile] || head[10] == UINT8_MAX ||
        (head[11] > 0 && reader->expected[tile] > 0 && head[11] != reader->expected[tile]))
        return refuse_cut(reader);
    reader->parts[tile]++;
    if (head[11] > 0)
        reader->expected[tile] = head[11];
    reader->place += TILE_HEAD_BYTES;
    const sonject_status status = read_tile_head(reader, end);
    reader->place = end;
    return status;
}

static sonject_status read_tiles(struct reader *reader)
{
    unsigned char marker[2];
    const uint64_t last = reader->end - 2;
    while (reader->place < last) {
        const sonject_status status = read_tile_part(reader);
        if (status != SONJECT_OK)
            return status;
    }
    if (!take(reader, marker, sizeof marker) || word_at(marker, 0, 2) != MARKER_END)
        return refuse_cut(reader);
    for (uint64_t i = 0; i < reader->tiles; i++)
        if (reader->parts[i] == 0 ||
            (reader->expected[i] > 0 && reader->parts[i] != reader->expected[i]))
            return refuse_cut(reader);
    return SONJECT_OK;
}

sonject_status jp2_codestream_check(struct report *report, const char *path, FILE *file,
                                    const struct byte_range *part, struct jp2_image *image)
{
    struct reader reader = {report, path, file, part->place, part->place + part->count, image, 0,
                            0,      0,    NULL, NULL};
    unsigned char start[4];
    if (!take(&reader, start, sizeof start) || !jp2_codestream_begins(start, sizeof start))
        return refuse_cut(&reader);
    reader.place += 2;
    sonject_status status = read_size(&reader);
    if (status == SONJECT_OK)
        status = read_head(&reader);
    if (status != SONJECT_OK)
        return status;
    reader.parts = allocate_array((size_t)reader.tiles, 1);
    reader.expected = allocate_array((size_t)reader.tiles, 1);
    status = reader.parts && reader.expected ? read_tiles(&reader)
                                             : report_out_of_memory(report, "tiles");
    free(reader.parts);
    free(reader.expected);
    return status;
}
