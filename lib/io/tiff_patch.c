#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "io/tiff_patch.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

#include "base/memory.h"
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
    char reason[128];
    if (strerror_r(error, reason, sizeof reason) != 0)
        snprintf(reason, sizeof reason, "error %d", error);
    return report_failure(writer->report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s",
                          writer->patch->destination, reason);
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
    FILE *source = fopen(writer->patch->source, "rb");
    unsigned char *buffer = allocate_array(COPY_STEP, 1);
    sonject_status status;
    if (!source)
        status = report_failure(writer->report, SONJECT_ERROR_INPUT, "%s: cannot be opened",
                                writer->patch->source);
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

/* The part of the image that a block holds. */
static struct region block_region(const struct tiff_structure *structure, uint64_t block)
{
    const struct raster_layout *layout = &structure->layout;
    struct region region;
    region.first_row =
        block / structure->blocks_across % structure->blocks_down * structure->block_rows;
    region.first_column = block % structure->blocks_across * structure->block_columns;
    region.rows = layout->rows - region.first_row;
    region.columns = layout->columns - region.first_column;
    if (region.rows > structure->block_rows)
        region.rows = structure->block_rows;
    if (region.columns > structure->block_columns)
        region.columns = structure->block_columns;
    return region;
}

/* What is in both; empty (0 rows) if nothing is. */
static struct region common_region(const struct region *a, const struct region *b)
{
    struct region region = {0, 0, 0, 0};
    const uint64_t row = a->first_row > b->first_row ? a->first_row : b->first_row;
    const uint64_t column =
        a->first_column > b->first_column ? a->first_column : b->first_column;
    const uint64_t a_row_end = a->first_row + a->rows;
    const uint64_t b_row_end = b->first_row + b->rows;
    const uint64_t row_end = a_row_end < b_row_end ? a_row_end : b_row_end;
    const uint64_t a_column_end = a->first_column + a->columns;
    const uint64_t b_column_end = b->first_column + b->columns;
    const uint64_t column_end = a_column_end < b_column_end ? a_column_end : b_column_end;
    if (row < row_end && column < column_end) {
        region.first_row = row;
        region.first_column = column;
        region.rows = row_end - row;
        region.columns = column_end - column;
    }
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
    const unsigned char *from =
        (const unsigned char *)writer->patch->pixels +
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
            structure->offsets[block] +
            ((row - whole.first_row) * structure->block_columns +
             (common.first_column - whole.first_column)) *
                pixel;
        take_patch_row(writer, block, row, common.first_column, (size_t)common.columns,
                       row_values);
        tiff_order_bytes(structure, row_values, values);
        status = write_at(writer, place, row_values,
                          values * pixel_bytes(structure->layout.type));
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
                           pixels + ((size_t)(row - whole.first_row) *
                                         (size_t)structure->block_columns +
                                     (size_t)(common.first_column - whole.first_column)) *
                                        pixel);
        }
        status = add_block(writer, block, pixels);
    }
    free(decoded);
    free(pixels);
    return status;
}
