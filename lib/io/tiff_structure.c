#include "io/tiff_structure.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/byte_order.h"
#include "io/tiff_tags.h"

#define PAGES_MAX       65536
#define BLOCKS_MAX      ((uint64_t)1 << 25)
#define PIXELS_MAX      ((uint64_t)1 << 40)
#define BLOCK_BYTES_MAX ((uint64_t)256 << 20) /* of a block that is decoded whole */

/* Further pages stay as they are; smaller copies of the first one would not show what is put in. */
static sonject_status check_other_pages(struct tiff_reader *reader, uint64_t next)
{
    const struct tag first_subpages = reader->tags[TAG_SUBPAGES];
    bool has_copies = first_subpages.count > 0;
    for (int page = 0; next != 0 && !has_copies; page++) {
        uint64_t kind;
        if (page == PAGES_MAX || !tiff_read_directory(reader, next, &next) ||
            !tiff_tag_value(reader, TAG_KIND, 0, &kind))
            return tiff_damaged(reader, "the list of its pages is broken or cut short");
        has_copies = (kind & 1) != 0;
    }
    if (has_copies)
        return report_failure(
            reader->report, SONJECT_ERROR_INPUT,
            "%s: holds smaller copies of the image (overviews), which would go on "
            "showing the seabed without the target: take them out first",
            reader->path);
    return SONJECT_OK;
}

static sonject_status take_pixel_type(const struct tiff_reader *reader,
                                      struct raster_layout *layout)
{
    uint64_t bits, format;
    if (!tiff_tag_common_value(reader, TAG_BITS, 1, &bits) ||
        !tiff_tag_common_value(reader, TAG_SAMPLE_FORMAT, 1, &format))
        return tiff_damaged(reader, "its channels differ in type");
    if (bits == 8 && (format == 1 || format == 4))
        layout->type = PIXEL_UINT8;
    else if (bits == 16 && (format == 1 || format == 4))
        layout->type = PIXEL_UINT16;
    else if (bits == 32 && format == 3)
        layout->type = PIXEL_FLOAT32;
    else if (format == 5 || format == 6)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: stores complex numbers as one channel; convert it to two 32-bit "
                              "float channels (real, imaginary)",
                              reader->path);
    else
        return report_failure(
            reader->report, SONJECT_ERROR_INPUT,
            "%s: has %llu-bit %s pixels; sonject reads 8 and 16 bit unsigned and 32 bit float: "
            "convert it to one of these",
            reader->path, (unsigned long long)bits,
            format == 1 ? "unsigned" : (format == 2 ? "signed" : "floating-point"));
    return SONJECT_OK;
}

static sonject_status check_channels(const struct tiff_reader *reader, uint64_t channels)
{
    uint64_t photometric, extra;
    if (!tiff_tag_value(reader, TAG_PHOTOMETRIC, 1, &photometric) ||
        !tiff_tag_value(reader, TAG_EXTRA_CHANNELS, 0, &extra))
        return tiff_damaged(reader, "cut short");
    if (photometric == 3)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: has a palette; convert it to one channel first", reader->path);
    if (channels != 1 && channels != 2)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: has %llu channels; sonject reads 1 (amplitude) or 2 (real, "
                              "imaginary); convert it to one channel first",
                              reader->path, (unsigned long long)channels);
    if (channels == 2 && (extra == 1 || extra == 2))
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: the second channel is transparency; convert it to one channel "
                              "first",
                              reader->path);
    if (photometric != 1)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: %s (photometric interpretation %llu); convert it to one where 0 "
                              "is black",
                              reader->path, photometric == 0 ? "0 is white" : "not a grey image",
                              (unsigned long long)photometric);
    return SONJECT_OK;
}

static sonject_status take_layout(const struct tiff_reader *reader, struct raster_layout *layout)
{
    uint64_t channels;
    if (!tiff_tag_value(reader, TAG_WIDTH, 0, &layout->columns) ||
        !tiff_tag_value(reader, TAG_LENGTH, 0, &layout->rows) ||
        !tiff_tag_value(reader, TAG_CHANNELS, 1, &channels))
        return tiff_damaged(reader, "cut short");
    if (layout->rows == 0 || layout->columns == 0)
        return tiff_damaged(reader, "it has no pixels");
    if (layout->rows > PIXELS_MAX / layout->columns || layout->rows > INT32_MAX ||
        layout->columns > INT32_MAX)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: claims %llu x %llu pixels, which is more than 2^40",
                              reader->path, (unsigned long long)layout->rows,
                              (unsigned long long)layout->columns);
    const sonject_status status = check_channels(reader, channels);
    if (status != SONJECT_OK)
        return status;
    layout->channels = (uint32_t)channels;
    return take_pixel_type(reader, layout);
}

static sonject_status take_coding(const struct tiff_reader *reader,
                                  struct tiff_structure *structure)
{
    uint64_t compression, predictor, planes, fill_order;
    if (!tiff_tag_value(reader, TAG_COMPRESSION, 1, &compression) ||
        !tiff_tag_value(reader, TAG_PREDICTOR, 1, &predictor) ||
        !tiff_tag_value(reader, TAG_PLANES, 1, &planes) ||
        !tiff_tag_value(reader, TAG_FILL_ORDER, 1, &fill_order))
        return tiff_damaged(reader, "cut short");
    structure->is_separate = planes == 2 && structure->layout.channels > 1;
    structure->compression = compression == TIFF_OLD_DEFLATE ? TIFF_DEFLATE : (uint32_t)compression;
    structure->predictor = TIFF_PREDICTOR_NONE;
    if (structure->compression == TIFF_LZW || structure->compression == TIFF_DEFLATE)
        structure->predictor = (uint32_t)predictor;
    else if (structure->compression != TIFF_UNCOMPRESSED && structure->compression != TIFF_PACKBITS)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: its compression (number %llu) is not one that sonject reads: "
                              "convert it to deflate, LZW or none",
                              reader->path, (unsigned long long)compression);
    if (fill_order != 1 || planes < 1 || planes > 2 || structure->predictor < 1 ||
        structure->predictor > TIFF_PREDICTOR_FLOAT ||
        (structure->predictor == TIFF_PREDICTOR_FLOAT && structure->layout.type != PIXEL_FLOAT32))
        return tiff_damaged(reader, "it says impossible things about how pixels are stored");
    return SONJECT_OK;
}

static sonject_status take_blocks(const struct tiff_reader *reader,
                                  struct tiff_structure *structure)
{
    const struct raster_layout *layout = &structure->layout;
    structure->is_tiled = reader->tags[TAG_TILE_OFFSETS].count > 0;
    structure->block_columns = layout->columns;
    if (structure->is_tiled) {
        if (!tiff_tag_value(reader, TAG_TILE_WIDTH, 0, &structure->block_columns) ||
            !tiff_tag_value(reader, TAG_TILE_LENGTH, 0, &structure->block_rows))
            return tiff_damaged(reader, "cut short");
    } else if (!tiff_tag_value(reader, TAG_ROWS_PER_STRIP, layout->rows, &structure->block_rows)) {
        return tiff_damaged(reader, "cut short");
    } else if (structure->block_rows > layout->rows) {
        structure->block_rows = layout->rows;
    }
    if (structure->block_rows == 0 || structure->block_columns == 0 ||
        structure->block_rows > INT32_MAX || structure->block_columns > INT32_MAX ||
        structure->block_rows * structure->block_columns > PIXELS_MAX)
        return tiff_damaged(reader, "its tiles or strips have no size");
    structure->blocks_across = (layout->columns - 1) / structure->block_columns + 1;
    structure->blocks_down = (layout->rows - 1) / structure->block_rows + 1;
    if (structure->blocks_across > BLOCKS_MAX || structure->blocks_down > BLOCKS_MAX ||
        structure->blocks_across * structure->blocks_down > BLOCKS_MAX)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: has more than 2^25 tiles or strips: write it with larger ones",
                              reader->path);
    structure->block_count = structure->blocks_across * structure->blocks_down *
                             (structure->is_separate ? layout->channels : 1);
    const bool is_decoded_whole =
        structure->compression != TIFF_UNCOMPRESSED || structure->is_tiled;
    if (is_decoded_whole && tiff_block_bytes(structure, 0) > BLOCK_BYTES_MAX)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: its tiles or strips hold more than 256 MB each: write it with "
                              "smaller ones",
                              reader->path);
    return SONJECT_OK;
}

/* A tag's values, one for every block, to be given to free(). */
static sonject_status read_list(const struct tiff_reader *reader, enum tag_name name,
                                uint64_t block_count, uint64_t **list)
{
    const struct tag *tag = &reader->tags[name];
    unsigned char bytes[4096];
    if (tag->count < block_count)
        return tiff_damaged(reader, "the list of its tiles or strips is missing or too short");
    *list = allocate_array((size_t)block_count, sizeof **list);
    if (!*list)
        return report_out_of_memory(reader->report, reader->path);
    const size_t at_once = sizeof bytes / tag->size;
    for (size_t i = 0; i < block_count;) {
        const size_t left = (size_t)block_count - i;
        const size_t some = left < at_once ? left : at_once;
        if (!tiff_read_at(reader, tag->values + i * tag->size, bytes, some * tag->size))
            return tiff_damaged(reader, "the list of its tiles or strips cannot be read");
        for (size_t j = 0; j < some; j++, i++)
            (*list)[i] = number_from_bytes(bytes + j * tag->size, tag->size, reader->is_big_endian);
    }
    return SONJECT_OK;
}

static sonject_status check_blocks(const struct tiff_reader *reader,
                                   const struct tiff_structure *structure)
{
    for (uint64_t i = 0; i < structure->block_count; i++) {
        const uint64_t count = structure->counts[i];
        if (count == 0)
            return tiff_damaged(reader, "some of its tiles or strips were never written");
        if (structure->offsets[i] > reader->file_bytes ||
            count > reader->file_bytes - structure->offsets[i])
            return tiff_damaged(reader, "cut short: some of its tiles or strips are not there");
        if (structure->compression == TIFF_UNCOMPRESSED && count < tiff_block_bytes(structure, i))
            return tiff_damaged(reader, "some of its tiles or strips are too short");
    }
    return SONJECT_OK;
}

static sonject_status read_structure(struct tiff_reader *reader, struct tiff_structure *structure)
{
    uint64_t place, next;
    sonject_status status = tiff_read_header(reader, &place);
    if (status == SONJECT_OK && !tiff_read_directory(reader, place, &next))
        status = tiff_damaged(reader, "its directory is broken or cut short");
    if (status == SONJECT_OK)
        status = take_layout(reader, &structure->layout);
    if (status == SONJECT_OK)
        status = take_coding(reader, structure);
    if (status == SONJECT_OK)
        status = take_blocks(reader, structure);
    if (status != SONJECT_OK)
        return status;
    const enum tag_name offsets = structure->is_tiled ? TAG_TILE_OFFSETS : TAG_STRIP_OFFSETS;
    const enum tag_name counts = structure->is_tiled ? TAG_TILE_COUNTS : TAG_STRIP_COUNTS;
    structure->offsets_entry = reader->tags[offsets].entry;
    structure->counts_entry = reader->tags[counts].entry;
    status = read_list(reader, offsets, structure->block_count, &structure->offsets);
    if (status == SONJECT_OK)
        status = read_list(reader, counts, structure->block_count, &structure->counts);
    if (status == SONJECT_OK)
        status = check_blocks(reader, structure);
    return status == SONJECT_OK ? check_other_pages(reader, next) : status;
}

sonject_status tiff_structure_read(struct report *report, const char *path,
                                   struct tiff_structure *structure)
{
    struct tiff_reader reader;
    memset(structure, 0, sizeof *structure);
    sonject_status status = tiff_reader_open(report, path, &reader);
    if (status != SONJECT_OK)
        return status;
    status = read_structure(&reader, structure);
    structure->file_bytes = reader.file_bytes;
    structure->is_big = reader.is_big;
    structure->is_big_endian = reader.is_big_endian;
    tiff_reader_close(&reader);
    if (status != SONJECT_OK)
        tiff_structure_clear(structure);
    return status;
}

void tiff_structure_clear(struct tiff_structure *structure)
{
    free(structure->offsets);
    free(structure->counts);
    memset(structure, 0, sizeof *structure);
}

uint32_t tiff_block_channels(const struct tiff_structure *structure)
{
    return structure->is_separate ? 1 : structure->layout.channels;
}

uint64_t tiff_block_rows(const struct tiff_structure *structure, uint64_t block)
{
    const uint64_t down = block / structure->blocks_across % structure->blocks_down;
    const uint64_t left = structure->layout.rows - down * structure->block_rows;
    return structure->is_tiled || left > structure->block_rows ? structure->block_rows : left;
}

uint64_t tiff_block_bytes(const struct tiff_structure *structure, uint64_t block)
{
    return tiff_block_rows(structure, block) * structure->block_columns *
           tiff_block_channels(structure) * pixel_bytes(structure->layout.type);
}
