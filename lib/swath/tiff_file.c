#include "swath/tiff_file.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/file.h"
#include "base/memory.h"

#define BLOCKS_MAX      ((uint32_t)1 << 25)
#define BLOCK_BYTES_MAX ((uint64_t)256 << 20) /* of a tile or strip, decoded */

/* Blocks are tiles or strips; strips are as wide as the image, and the last one may be short. */
struct tiff_blocks {
    struct report *report;
    const char *name; /* in messages */
    TIFF *file;
    struct tiff_fault fault;
    uint32_t rows, columns; /* of the image */
    uint16_t channels, bits, compression;
    uint16_t planes; /* each with blocks of its own: of one channel, or of all */
    bool is_tiled;
    uint32_t block_rows, block_columns;
    uint32_t count;
};

static int hear(TIFF *file, void *user, const char *module, const char *format, va_list values)
{
    struct tiff_fault *fault = user;
    (void)file;
    (void)module;
    if (!*fault->message) {
        fault->error = errno;
        vsnprintf(fault->message, sizeof fault->message, format, values);
    }
    return 1;
}

/* What libtiff goes on without: of that, only what lies behind the end of a file that is cut. */
static int hear_warning(TIFF *file, void *user, const char *module, const char *format,
                        va_list values)
{
    return strstr(format, "IO error") ? hear(file, user, module, format, values) : 1;
}

TIFF *tiff_open(const char *path, const char *mode, struct tiff_fault *fault)
{
    memset(fault, 0, sizeof *fault);
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return NULL;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)(2 * BLOCK_BYTES_MAX));
    TIFFOpenOptionsSetErrorHandlerExtR(options, hear, fault);
    TIFFOpenOptionsSetWarningHandlerExtR(options, hear_warning, fault);
    errno = 0;
    TIFF *file = TIFFOpenExt(path, mode, options);
    TIFFOpenOptionsFree(options);
    return file;
}

static sonject_status damaged(const struct tiff_blocks *blocks, const char *how)
{
    return report_failure(blocks->report, SONJECT_ERROR_INPUT, "%s: damaged TIFF: %s", blocks->name,
                          how);
}

static sonject_status refuse(const struct tiff_blocks *blocks, const char *what)
{
    return report_failure(blocks->report, SONJECT_ERROR_INPUT, "%s: %s", blocks->name, what);
}

/* Of what libtiff could not do. */
static sonject_status tell_fault(const struct tiff_blocks *blocks)
{
    errno = blocks->fault.error; /* the disk's failures are told by it */
    return damaged(blocks, *blocks->fault.message ? blocks->fault.message : "cannot be read");
}

static sonject_status check_type(const struct tiff_blocks *blocks)
{
    uint16_t format = SAMPLEFORMAT_UINT;
    TIFFGetFieldDefaulted(blocks->file, TIFFTAG_SAMPLEFORMAT, &format);
    if (format == SAMPLEFORMAT_COMPLEXINT || format == SAMPLEFORMAT_COMPLEXIEEEFP)
        return refuse(blocks, "stores complex numbers as one channel; convert it to two 32-bit "
                              "float channels (real, imaginary)");
    const bool is_unsigned = format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID;
    if (((blocks->bits == 8 || blocks->bits == 16) && is_unsigned) ||
        (blocks->bits == 32 && format == SAMPLEFORMAT_IEEEFP))
        return SONJECT_OK;
    return report_failure(
        blocks->report, SONJECT_ERROR_INPUT,
        "%s: has %u-bit %s pixels; sonject reads 8 and 16 bit unsigned and 32 bit float: "
        "convert it to one of these",
        blocks->name, blocks->bits,
        is_unsigned ? "unsigned" : (format == SAMPLEFORMAT_INT ? "signed" : "floating-point"));
}

static sonject_status check_colours(const struct tiff_blocks *blocks)
{
    uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    uint16_t extras = 0;
    const uint16_t *kinds = NULL;
    TIFFGetField(blocks->file, TIFFTAG_PHOTOMETRIC, &photometric);
    TIFFGetFieldDefaulted(blocks->file, TIFFTAG_EXTRASAMPLES, &extras, &kinds);
    if (photometric == PHOTOMETRIC_PALETTE)
        return refuse(blocks, "has a palette; convert it to one channel first");
    if (blocks->channels != 1 && blocks->channels != 2)
        return report_failure(blocks->report, SONJECT_ERROR_INPUT,
                              "%s: has %u channels; sonject reads 1 (amplitude) or 2 (real, "
                              "imaginary); convert it to one channel first",
                              blocks->name, blocks->channels);
    if (blocks->channels == 2 && extras > 0 && kinds[0] != EXTRASAMPLE_UNSPECIFIED)
        return refuse(blocks, "the second channel is transparency; convert it to one channel "
                              "first");
    if (photometric != PHOTOMETRIC_MINISBLACK)
        return report_failure(
            blocks->report, SONJECT_ERROR_INPUT,
            "%s: %s (photometric interpretation %u); convert it to one where 0 "
            "is black",
            blocks->name, photometric == PHOTOMETRIC_MINISWHITE ? "0 is white" : "not a grey image",
            photometric);
    return SONJECT_OK;
}

static sonject_status check_coding(const struct tiff_blocks *blocks)
{
    const uint16_t known[] = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                              COMPRESSION_DEFLATE, COMPRESSION_PACKBITS};
    uint16_t fill_order = FILLORDER_MSB2LSB;
    uint16_t predictor = PREDICTOR_NONE;
    uint32_t strip_rows = 0;
    bool is_known = false;
    TIFFGetFieldDefaulted(blocks->file, TIFFTAG_FILLORDER, &fill_order);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        is_known = is_known || blocks->compression == known[i];
    if (!is_known)
        return report_failure(blocks->report, SONJECT_ERROR_INPUT,
                              "%s: its compression (number %u) is not one that sonject reads: "
                              "convert it to deflate, LZW or none",
                              blocks->name, blocks->compression);
    if (fill_order != FILLORDER_MSB2LSB)
        return damaged(blocks, "it says impossible things about how pixels are stored");
    TIFFGetField(blocks->file, TIFFTAG_PREDICTOR, &predictor);
    if (predictor == PREDICTOR_FLOATINGPOINT && TIFFIsByteSwapped(blocks->file))
        return refuse(blocks, "keeps floating-point differences in the other byte order, which "
                              "libtiff cannot write: write it anew in this machine's");
    /* OpenImageIO then takes turns between the planes, row by row, and cannot go back in a strip.
     */
    TIFFGetFieldDefaulted(blocks->file, TIFFTAG_ROWSPERSTRIP, &strip_rows);
    if (blocks->planes > 1 && !blocks->is_tiled && blocks->compression != COMPRESSION_NONE &&
        strip_rows > INT32_MAX)
        return refuse(blocks, "is compressed in planes and does not say how many rows a strip has: "
                              "write it anew, without compression or with rows per strip");
    if (blocks->count > BLOCKS_MAX)
        return refuse(blocks, "has more than 2^25 tiles or strips: write it with larger ones");
    if ((blocks->is_tiled ? TIFFTileSize64(blocks->file) : TIFFStripSize64(blocks->file)) >
        BLOCK_BYTES_MAX)
        return refuse(blocks, "its tiles or strips hold more than 256 MB each: write it with "
                              "smaller ones");
    return SONJECT_OK;
}

static void look_at_blocks(struct tiff_blocks *blocks)
{
    TIFF *file = blocks->file;
    uint16_t planes = PLANARCONFIG_CONTIG;
    blocks->channels = 1;
    blocks->bits = 1;
    blocks->compression = COMPRESSION_NONE;
    TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &blocks->columns);
    TIFFGetField(file, TIFFTAG_IMAGELENGTH, &blocks->rows);
    TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &blocks->channels);
    TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &blocks->bits);
    TIFFGetFieldDefaulted(file, TIFFTAG_COMPRESSION, &blocks->compression);
    TIFFGetFieldDefaulted(file, TIFFTAG_PLANARCONFIG, &planes);
    blocks->planes = planes == PLANARCONFIG_SEPARATE ? blocks->channels : 1;
    blocks->is_tiled = TIFFIsTiled(file) != 0;
    blocks->block_columns = blocks->columns;
    if (blocks->is_tiled) {
        TIFFGetField(file, TIFFTAG_TILEWIDTH, &blocks->block_columns);
        TIFFGetField(file, TIFFTAG_TILELENGTH, &blocks->block_rows);
    } else {
        TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &blocks->block_rows);
    }
    if (!blocks->is_tiled && blocks->block_rows > blocks->rows)
        blocks->block_rows = blocks->rows;
    blocks->count = blocks->is_tiled ? TIFFNumberOfTiles(file) : TIFFNumberOfStrips(file);
}

/* Rows that a block holds whose first one is this. */
static uint32_t rows_of_block(const struct tiff_blocks *blocks, uint32_t row)
{
    const uint32_t left = blocks->rows - row;
    return blocks->is_tiled || left > blocks->block_rows ? blocks->block_rows : left;
}

static uint64_t bytes_of_block(const struct tiff_blocks *blocks, uint32_t row)
{
    return blocks->is_tiled ? TIFFTileSize64(blocks->file)
                            : TIFFVStripSize64(blocks->file, rows_of_block(blocks, row));
}

static int compare_places(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

/* Blocks must lie apart: one that is seen in several places of the image cannot be changed in one
 * of them. places: room for a place and an end for each. */
static sonject_status check_places(const struct tiff_blocks *blocks, uint64_t file_bytes,
                                   uint64_t (*places)[2])
{
    const uint32_t in_plane = blocks->count / blocks->planes;
    const uint32_t across = (blocks->columns - 1) / blocks->block_columns + 1;
    for (uint32_t i = 0; i < blocks->count; i++) {
        const uint32_t row = i % in_plane / across * blocks->block_rows;
        const uint64_t count = TIFFGetStrileByteCount(blocks->file, i);
        places[i][0] = TIFFGetStrileOffset(blocks->file, i);
        places[i][1] = places[i][0] + count;
        if (count == 0)
            return damaged(blocks, "some of its tiles or strips were never written");
        if (places[i][0] > file_bytes || count > file_bytes - places[i][0])
            return damaged(blocks, "cut short: some of its tiles or strips are not there");
        if (blocks->compression == COMPRESSION_NONE && count < bytes_of_block(blocks, row))
            return damaged(blocks, "some of its tiles or strips are too short");
    }
    qsort(places, blocks->count, sizeof *places, compare_places);
    for (uint32_t i = 1; i < blocks->count; i++)
        if (places[i][0] < places[i - 1][1])
            return refuse(blocks, "keeps several of its tiles or strips in the same place: write "
                                  "it anew, each on its own");
    return SONJECT_OK;
}

/* Further pages stay as they are; smaller copies of the first one would not show what is put in. */
static sonject_status check_other_pages(const struct tiff_blocks *blocks)
{
    uint16_t count = 0;
    const uint64_t *places = NULL;
    uint32_t kind = 0;
    bool has_copies = TIFFGetField(blocks->file, TIFFTAG_SUBIFD, &count, &places) && count > 0;
    while (!has_copies && !TIFFLastDirectory(blocks->file)) {
        if (!TIFFReadDirectory(blocks->file))
            return damaged(blocks, "the list of its pages is broken or cut short");
        has_copies = TIFFGetField(blocks->file, TIFFTAG_SUBFILETYPE, &kind) &&
                     (kind & FILETYPE_REDUCEDIMAGE) != 0;
    }
    return has_copies ? refuse(blocks, "holds smaller copies of the image (overviews), which would "
                                       "go on showing the seabed without the target: take them "
                                       "out first")
                      : SONJECT_OK;
}

static sonject_status check(struct tiff_blocks *blocks, uint64_t file_bytes)
{
    look_at_blocks(blocks);
    sonject_status status = check_type(blocks);
    THEN(status, check_colours(blocks));
    THEN(status, check_coding(blocks));
    if (status != SONJECT_OK)
        return status;
    if (blocks->rows == 0 || blocks->block_rows == 0 || blocks->block_columns == 0 ||
        blocks->count < blocks->planes)
        return damaged(blocks, "its tiles or strips have no size");
    uint64_t(*places)[2] = allocate_array(blocks->count, sizeof *places);
    status = places ? check_places(blocks, file_bytes, places)
                    : report_out_of_memory(blocks->report, blocks->name);
    free(places);
    return status == SONJECT_OK ? check_other_pages(blocks) : status;
}

sonject_status tiff_check(struct report *report, const char *name, const char *path)
{
    struct tiff_blocks blocks = {.report = report, .name = name};
    struct file_identity identity;
    sonject_status status = file_identify(report, path, &identity);
    if (status != SONJECT_OK)
        return status;
    blocks.file = tiff_open(path, "rm", &blocks.fault);
    if (!blocks.file)
        return tell_fault(&blocks);
    status = check(&blocks, identity.bytes);
    TIFFClose(blocks.file);
    return status == SONJECT_OK && *blocks.fault.message ? tell_fault(&blocks) : status;
}

/* Puts what a block of a plane shares with the region into the block's pixels. */
static void fill_block(const struct tiff_blocks *blocks, uint32_t row, uint32_t column,
                       uint16_t plane, const struct region *region, const unsigned char *pixels,
                       unsigned char *block)
{
    const size_t sample = blocks->bits / 8;
    const size_t pixel = blocks->channels * sample;
    const size_t in_block = blocks->planes > 1 ? sample : pixel;
    const uint64_t first = region->first_column > column ? region->first_column : column;
    const uint64_t region_end = region->first_column + region->columns;
    const uint64_t block_end = (uint64_t)column + blocks->block_columns;
    const uint64_t end = region_end < block_end ? region_end : block_end;
    for (uint32_t i = 0; i < rows_of_block(blocks, row); i++)
        for (uint64_t j = first;
             row + i >= region->first_row && row + i - region->first_row < region->rows && j < end;
             j++)
            memcpy(
                block + ((size_t)i * blocks->block_columns + (j - column)) * in_block,
                pixels +
                    ((row + i - region->first_row) * region->columns + (j - region->first_column)) *
                        pixel +
                    plane * sample,
                in_block);
}

/* Reads by one file and writes by another: a codec of libtiff's does one of the two. */
static bool change_block(const struct tiff_blocks *blocks, TIFF *writer, uint32_t row,
                         uint32_t column, uint16_t plane, const struct region *region,
                         const void *pixels, unsigned char *block)
{
    const tmsize_t bytes = (tmsize_t)bytes_of_block(blocks, row);
    const uint32_t number = blocks->is_tiled ? TIFFComputeTile(writer, column, row, 0, plane)
                                             : TIFFComputeStrip(writer, row, plane);
    if ((blocks->is_tiled ? TIFFReadEncodedTile(blocks->file, number, block, bytes)
                          : TIFFReadEncodedStrip(blocks->file, number, block, bytes)) != bytes)
        return false;
    fill_block(blocks, row, column, plane, region, pixels, block);
    return (blocks->is_tiled ? TIFFWriteEncodedTile(writer, number, block, bytes)
                             : TIFFWriteEncodedStrip(writer, number, block, bytes)) == bytes;
}

static bool change_blocks(const struct tiff_blocks *blocks, TIFF *writer,
                          const struct region *region, const void *pixels, unsigned char *block)
{
    const uint64_t row_end = region->first_row + region->rows;
    const uint64_t column_end = region->first_column + region->columns;
    const uint32_t height = blocks->block_rows;
    const uint32_t width = blocks->block_columns;
    for (uint16_t plane = 0; plane < blocks->planes; plane++)
        for (uint64_t row = region->first_row / height * height; row < row_end; row += height)
            for (uint64_t column = region->first_column / width * width; column < column_end;
                 column += width)
                if (!change_block(blocks, writer, (uint32_t)row, (uint32_t)column, plane, region,
                                  pixels, block))
                    return false;
    return true;
}

/* Writing ends with the lists of places and sizes; were the directory to be written anew, tags
 * could be lost. */
static bool flush_lists(TIFF *writer)
{
    const uint64_t directory = TIFFCurrentDirOffset(writer);
    return TIFFFlush(writer) && TIFFCurrentDirOffset(writer) == directory;
}

sonject_status tiff_change(struct report *report, const char *name, const char *path,
                           const struct region *region, const void *pixels)
{
    struct tiff_blocks blocks = {.report = report, .name = name};
    struct tiff_fault fault = {"", 0};
    unsigned char *block = NULL;
    bool is_done = false;
    blocks.file = tiff_open(path, "rm", &blocks.fault);
    TIFF *writer = blocks.file ? tiff_open(path, "r+m", &fault) : NULL;
    if (writer) {
        look_at_blocks(&blocks);
        block = allocate_array((size_t)bytes_of_block(&blocks, 0), 1);
        is_done =
            block && change_blocks(&blocks, writer, region, pixels, block) && flush_lists(writer);
        TIFFClose(writer);
    }
    if (blocks.file)
        TIFFClose(blocks.file);
    free(block);
    if (is_done)
        return SONJECT_OK;
    if (writer && !block)
        return report_out_of_memory(report, name);
    if (*blocks.fault.message)
        return tell_fault(&blocks);
    if (fault.error != 0)
        return file_failure(report, name, "write", fault.error);
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: its pixels cannot be replaced: %s: convert it to BigTIFF", name,
                          fault.message);
}
