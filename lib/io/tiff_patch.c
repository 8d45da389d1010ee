#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "io/tiff_patch.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

#include "base/file.h"
#include "base/memory.h"
#include "io/byte_file.h"
#include "io/byte_order.h"
#include "io/tiff_encode.h"
#include "io/tiff_structure.h"

#define COPY_STEP ((size_t)4 << 20)

struct tiff_writer {
    struct report *report;
    const struct tiff_patch *patch;
    struct tiff_structure structure;
    FILE *file;
    uint64_t end; /* of the destination, where blocks are added */
};

static sonject_status write_failure(const struct tiff_writer *writer, int error)
{
    return file_failure(writer->report, writer->patch->name, "write", error);
}

static sonject_status write_at(struct tiff_writer *writer, uint64_t place, const void *bytes,
                               size_t count)
{
    if (fseeko(writer->file, (off_t)place, SEEK_SET) != 0 ||
        fwrite(bytes, 1, count, writer->file) != count)
        return write_failure(writer, errno);
    return SONJECT_OK;
}

static sonject_status copy_bytes(struct tiff_writer *writer, FILE *source, unsigned char *buffer)
{
    const struct tiff_patch *patch = writer->patch;
    const uint64_t total = writer->structure.file_bytes;
    for (uint64_t done = 0; done < total;) {
        const size_t some = total - done < COPY_STEP ? (size_t)(total - done) : COPY_STEP;
        if (fread(buffer, 1, some, source) != some)
            return report_failure(writer->report, SONJECT_ERROR_INPUT,
                                  "%s: cannot be read to its end", patch->source);
        if (fwrite(buffer, 1, some, writer->file) != some)
            return write_failure(writer, errno);
        done += some;
        if (patch->progress &&
            patch->progress(patch->progress_user, (double)done / (double)total, "write") != 0)
            return report_failure(writer->report, SONJECT_CANCELLED, "cancelled");
    }
    return SONJECT_OK;
}

static sonject_status copy_file(struct tiff_writer *writer)
{
    uint64_t bytes = 0;
    FILE *source = byte_file_open(writer->patch->source, &bytes);
    unsigned char *buffer = allocate_array(COPY_STEP, 1);
    sonject_status status;
    if (!source)
        status = file_refuse(writer->report, writer->patch->source, errno);
    else if (!buffer)
        status = report_out_of_memory(writer->report, "a copy");
    else
        status = copy_bytes(writer, source, buffer);
    if (source)
        fclose(source);
    free(buffer);
    writer->end = writer->structure.file_bytes;
    return status;
}

static uint64_t smaller(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t larger(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* The part of the image that a block holds. */
static struct region block_region(const struct tiff_structure *structure, uint64_t block)
{
    const struct raster_layout *layout = &structure->layout;
    struct region region;
    region.first_row =
        block / structure->blocks_across % structure->blocks_down * structure->block_rows;
    region.first_column = block % structure->blocks_across * structure->block_columns;
    region.rows = smaller(structure->block_rows, layout->rows - region.first_row);
    region.columns = smaller(structure->block_columns, layout->columns - region.first_column);
    return region;
}

/* What two regions that meet have in common. */
static struct region common_region(const struct region *a, const struct region *b)
{
    struct region region;
    region.first_row = larger(a->first_row, b->first_row);
    region.first_column = larger(a->first_column, b->first_column);
    region.rows = smaller(a->first_row + a->rows, b->first_row + b->rows) - region.first_row;
    region.columns =
        smaller(a->first_column + a->columns, b->first_column + b->columns) - region.first_column;
    return region;
}

/* Puts the patch's values for one row of a block into values: those of all channels, or of the
 * block's own one if channels are separate. */
static void take_patch_row(const struct tiff_writer *writer, uint64_t block, uint64_t row,
                           uint64_t column, size_t columns, unsigned char *values)
{
    const struct tiff_structure *structure = &writer->structure;
    const struct region *region = &writer->patch->region;
    const size_t size = pixel_bytes(structure->layout.type);
    const size_t channels = structure->layout.channels;
    const size_t plane = (size_t)(block / (structure->blocks_across * structure->blocks_down));
    const unsigned char *from = (const unsigned char *)writer->patch->pixels +
                                ((size_t)(row - region->first_row) * (size_t)region->columns +
                                 (size_t)(column - region->first_column)) *
                                    channels * size;
    if (!structure->is_separate) {
        memcpy(values, from, columns * channels * size);
        return;
    }
    for (size_t i = 0; i < columns; i++)
        memcpy(values + i * size, from + (i * channels + plane) * size, size);
}

/* Replaces pixels that lie plainly in the file. row_values: room for the region's columns. */
static sonject_status patch_in_place(struct tiff_writer *writer, uint64_t block,
                                     unsigned char *row_values)
{
    const struct tiff_structure *structure = &writer->structure;
    const struct region whole = block_region(structure, block);
    const struct region common = common_region(&whole, &writer->patch->region);
    const size_t values = (size_t)common.columns * tiff_block_channels(structure);
    const uint64_t pixel = tiff_block_channels(structure) * pixel_bytes(structure->layout.type);
    sonject_status status = SONJECT_OK;
    for (uint64_t i = 0; status == SONJECT_OK && i < common.rows; i++) {
        const uint64_t row = common.first_row + i;
        const uint64_t place =
            structure->offsets[block] + ((row - whole.first_row) * structure->block_columns +
                                         (common.first_column - whole.first_column)) *
                                            pixel;
        take_patch_row(writer, block, row, common.first_column, (size_t)common.columns, row_values);
        tiff_order_bytes(structure, row_values, values);
        status = write_at(writer, place, row_values, values * pixel_bytes(structure->layout.type));
    }
    return status;
}

/* Spreads what was read of the image over a block, which may be wider and hold fewer channels. */
static void fill_block(const struct tiff_structure *structure, uint64_t block,
                       const struct region *whole, const unsigned char *decoded,
                       unsigned char *pixels)
{
    const size_t size = pixel_bytes(structure->layout.type);
    const size_t channels = structure->layout.channels;
    const size_t in_block = tiff_block_channels(structure);
    const size_t plane = (size_t)(block / (structure->blocks_across * structure->blocks_down));
    for (size_t row = 0; row < whole->rows; row++)
        for (size_t i = 0; i < whole->columns; i++)
            memcpy(pixels + (row * (size_t)structure->block_columns + i) * in_block * size,
                   decoded + ((row * (size_t)whole->columns + i) * channels +
                              (structure->is_separate ? plane : 0)) *
                                 size,
                   in_block * size);
}

static sonject_status add_block(struct tiff_writer *writer, uint64_t block, unsigned char *pixels)
{
    struct tiff_structure *structure = &writer->structure;
    size_t count = 0;
    unsigned char *coded =
        tiff_encode_block(structure, pixels, tiff_block_rows(structure, block), &count);
    if (!coded)
        return report_out_of_memory(writer->report, "a tile or strip");
    const sonject_status status = write_at(writer, writer->end, coded, count);
    structure->offsets[block] = writer->end;
    structure->counts[block] = count;
    writer->end += count;
    free(coded);
    return status;
}

/* Reads a block, replaces the region's pixels in it and writes it behind the end of the file. */
static sonject_status patch_anew(struct tiff_writer *writer, uint64_t block)
{
    const struct tiff_structure *structure = &writer->structure;
    const struct region whole = block_region(structure, block);
    const struct region common = common_region(&whole, &writer->patch->region);
    const size_t pixel = tiff_block_channels(structure) * pixel_bytes(structure->layout.type);
    size_t decoded_bytes = 0;
    if (!region_bytes(&structure->layout, &whole, &decoded_bytes))
        return report_out_of_memory(writer->report, "a tile or strip");
    unsigned char *decoded = allocate_array(decoded_bytes, 1);
    unsigned char *pixels = allocate_array((size_t)tiff_block_bytes(structure, block), 1);
    sonject_status status = decoded && pixels
                                ? writer->patch->read(writer->patch->read_user, &whole, decoded)
                                : report_out_of_memory(writer->report, "a tile or strip");
    if (status == SONJECT_OK) {
        fill_block(structure, block, &whole, decoded, pixels);
        for (uint64_t i = 0; i < common.rows; i++) {
            const uint64_t row = common.first_row + i;
            take_patch_row(writer, block, row, common.first_column, (size_t)common.columns,
                           pixels +
                               ((size_t)(row - whole.first_row) * (size_t)structure->block_columns +
                                (size_t)(common.first_column - whole.first_column)) *
                                   pixel);
        }
        status = add_block(writer, block, pixels);
    }
    free(decoded);
    free(pixels);
    return status;
}

static sonject_status patch_blocks(struct tiff_writer *writer, bool is_in_place,
                                   unsigned char *row_values)
{
    const struct tiff_structure *structure = &writer->structure;
    const struct region *region = &writer->patch->region;
    const uint64_t in_plane = structure->blocks_across * structure->blocks_down;
    const uint64_t row_end = (region->first_row + region->rows - 1) / structure->block_rows + 1;
    const uint64_t column_end =
        (region->first_column + region->columns - 1) / structure->block_columns + 1;
    sonject_status status = SONJECT_OK;
    for (uint64_t plane = 0; plane < structure->block_count; plane += in_plane)
        for (uint64_t i = region->first_row / structure->block_rows; i < row_end; i++)
            for (uint64_t j = region->first_column / structure->block_columns;
                 status == SONJECT_OK && j < column_end; j++) {
                const uint64_t block = plane + i * structure->blocks_across + j;
                status = is_in_place ? patch_in_place(writer, block, row_values)
                                     : patch_anew(writer, block);
            }
    return status;
}

static int compare_extents(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

/* True where blocks lie apart. Some writers store equal blocks once: such a block must not be
 * changed in place, for it is seen in several places of the image. */
static sonject_status check_apart(struct tiff_writer *writer, bool *are_apart)
{
    const struct tiff_structure *structure = &writer->structure;
    const size_t count = (size_t)structure->block_count;
    uint64_t(*extents)[2] = allocate_array(count, sizeof *extents);
    if (!extents)
        return report_out_of_memory(writer->report, "the list of tiles or strips");
    for (size_t i = 0; i < count; i++) {
        extents[i][0] = structure->offsets[i];
        extents[i][1] = structure->offsets[i] + structure->counts[i];
    }
    qsort(extents, count, sizeof *extents, compare_extents);
    *are_apart = true;
    for (size_t i = 1; i < count; i++)
        if (extents[i][0] < extents[i - 1][1])
            *are_apart = false;
    free(extents);
    return SONJECT_OK;
}

/* Writes a list of places or sizes behind the end of the file and leads its directory entry there.
 */
static sonject_status add_list(struct tiff_writer *writer, uint64_t entry, const uint64_t *list)
{
    const struct tiff_structure *structure = &writer->structure;
    const size_t wide = structure->is_big ? 8 : 4;
    const size_t count = (size_t)structure->block_count;
    const bool is_big_endian = structure->is_big_endian;
    unsigned char *bytes = allocate_array(count, wide);
    unsigned char head[2 + 2 * 8];
    if (!bytes)
        return report_out_of_memory(writer->report, "the list of tiles or strips");
    for (size_t i = 0; i < count; i++)
        number_to_bytes(list[i], bytes + i * wide, wide, is_big_endian);
    number_to_bytes(structure->is_big ? 16 : 4, head, 2, is_big_endian);
    number_to_bytes(count, head + 2, wide, is_big_endian);
    sonject_status status = SONJECT_OK;
    if (count == 1) {
        memcpy(head + 2 + wide, bytes, wide);
    } else {
        writer->end += writer->end % 2;
        number_to_bytes(writer->end, head + 2 + wide, wide, is_big_endian);
        status = write_at(writer, writer->end, bytes, count * wide);
        writer->end += count * wide;
    }
    free(bytes);
    return status == SONJECT_OK ? write_at(writer, entry + 2, head, 2 + 2 * wide) : status;
}

static sonject_status add_lists(struct tiff_writer *writer)
{
    struct tiff_structure *structure = &writer->structure;
    sonject_status status = add_list(writer, structure->offsets_entry, structure->offsets);
    if (status == SONJECT_OK)
        status = add_list(writer, structure->counts_entry, structure->counts);
    if (status == SONJECT_OK && !structure->is_big && writer->end > UINT32_MAX)
        return report_failure(writer->report, SONJECT_ERROR_INPUT,
                              "%s: with the tiles or strips that change it would grow beyond the "
                              "4 GB that a TIFF can hold: convert it to BigTIFF",
                              writer->patch->source);
    return status;
}

static sonject_status patch_file(struct tiff_writer *writer)
{
    const struct tiff_structure *structure = &writer->structure;
    bool is_in_place = false;
    sonject_status status = copy_file(writer);
    if (status == SONJECT_OK)
        status = check_apart(writer, &is_in_place);
    if (status != SONJECT_OK)
        return status;
    is_in_place = is_in_place && structure->compression == TIFF_UNCOMPRESSED;
    unsigned char *row_values = allocate_array((size_t)writer->patch->region.columns,
                                               structure->layout.channels * sizeof(float));
    if (!row_values)
        return report_out_of_memory(writer->report, "a row");
    status = patch_blocks(writer, is_in_place, row_values);
    free(row_values);
    return status == SONJECT_OK && !is_in_place ? add_lists(writer) : status;
}

sonject_status tiff_copy_with_patch(struct report *report, const struct tiff_patch *patch)
{
    struct tiff_writer writer = {.report = report, .patch = patch};
    sonject_status status = tiff_structure_read(report, patch->source, &writer.structure);
    if (status != SONJECT_OK)
        return status;
    if (!region_is_inside(&writer.structure.layout, &patch->region)) {
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: the region is not inside the image", patch->source);
    } else {
        writer.file = fopen(patch->destination, "wb");
        status = writer.file ? patch_file(&writer) : write_failure(&writer, errno);
        if (writer.file && fclose(writer.file) != 0 && status == SONJECT_OK)
            status = write_failure(&writer, errno);
    }
    tiff_structure_clear(&writer.structure);
    return status;
}
