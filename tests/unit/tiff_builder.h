/* TIFF files of every build that sonject reads, written by libtiff, and what it would not write:
 * entries of their directories that are changed. */
#ifndef TIFF_BUILDER_H
#define TIFF_BUILDER_H

#include <tiffio.h>

#include "base/byte_order.h"
#include "image/raster.h"
#include "temporary_folder.h"

#define TIFF_PRIVATE_TAG  65000
#define TIFF_PRIVATE_TEXT "what only the maker of this file knows"

struct tiff_build {
    struct raster_layout layout;
    bool is_big, is_big_endian, is_tiled, is_separate, has_second_page;
    uint16_t compression, predictor;
    uint32_t block_rows, block_columns;
    /* for what is to be refused; 0: as the layout says */
    uint16_t bits, sample_format, photometric, extra_channel, fill_order;
    uint32_t second_page_kind; /* 1: a smaller copy of the first */
};

static inline void tiff_set_tags(TIFF *file, const struct tiff_build *build)
{
    static const TIFFFieldInfo own = {TIFF_PRIVATE_TAG, -1, -1, TIFF_ASCII,
                                      FIELD_CUSTOM,     1,  0,  (char *)"PrivateText"};
    static uint16_t colours[256];
    const enum pixel_type type = build->layout.type;
    const uint16_t extra = build->extra_channel;
    TIFFMergeFieldInfo(file, &own, 1);
    TIFFSetField(file, TIFFTAG_IMAGEWIDTH, (uint32_t)build->layout.columns);
    TIFFSetField(file, TIFFTAG_IMAGELENGTH, (uint32_t)build->layout.rows);
    TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, build->bits ? build->bits : 8 * pixel_bytes(type));
    TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, build->layout.channels);
    TIFFSetField(file, TIFFTAG_COMPRESSION, build->compression);
    TIFFSetField(file, TIFFTAG_PHOTOMETRIC,
                 build->photometric ? build->photometric - 1 : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(file, TIFFTAG_PLANARCONFIG,
                 build->is_separate ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    TIFFSetField(file, TIFFTAG_SAMPLEFORMAT,
                 build->sample_format    ? build->sample_format
                 : type == PIXEL_FLOAT32 ? SAMPLEFORMAT_IEEEFP
                                         : SAMPLEFORMAT_UINT);
    if (build->predictor > 1)
        TIFFSetField(file, TIFFTAG_PREDICTOR, build->predictor);
    if (build->fill_order)
        TIFFSetField(file, TIFFTAG_FILLORDER, build->fill_order);
    if (build->photometric == PHOTOMETRIC_PALETTE + 1)
        TIFFSetField(file, TIFFTAG_COLORMAP, colours, colours, colours);
    if (build->layout.channels > 1)
        TIFFSetField(file, TIFFTAG_EXTRASAMPLES, 1, &extra);
    if (build->is_tiled) {
        TIFFSetField(file, TIFFTAG_TILEWIDTH, build->block_columns);
        TIFFSetField(file, TIFFTAG_TILELENGTH, build->block_rows);
    } else {
        TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, build->block_rows);
    }
    TIFFSetField(file, TIFF_PRIVATE_TAG, TIFF_PRIVATE_TEXT);
}

/* The pixels of each block, of which those beyond the image are 0. */
static inline void tiff_put_page(TIFF *file, const struct tiff_build *build,
                                 const unsigned char *pixels)
{
    const struct raster_layout *layout = &build->layout;
    const uint64_t width = build->is_tiled ? build->block_columns : layout->columns;
    const uint64_t height = build->block_rows < layout->rows ? build->block_rows : layout->rows;
    const size_t sample = pixel_bytes(layout->type);
    const size_t in_block = build->is_separate ? sample : layout->channels * sample;
    unsigned char *block = calloc((size_t)(width * height), in_block);
    uint32_t number = 0;
    assert_non_null(block);
    tiff_set_tags(file, build);
    for (uint32_t plane = 0; plane < (build->is_separate ? layout->channels : 1); plane++)
        for (uint64_t row = 0; row < layout->rows; row += height)
            for (uint64_t column = 0; column < layout->columns; column += width, number++) {
                const uint64_t left = layout->rows - row;
                const uint64_t rows = !build->is_tiled && left < height ? left : height;
                memset(block, 0, (size_t)(width * height) * in_block);
                for (uint64_t i = 0; i < rows && i < left; i++)
                    for (uint64_t j = 0; j < width && column + j < layout->columns; j++)
                        memcpy(block + (i * width + j) * in_block,
                               pixels +
                                   (((row + i) * layout->columns + column + j) * layout->channels +
                                    plane) *
                                       sample,
                               in_block);
                const tmsize_t bytes = (tmsize_t)(build->bits ? (rows * width * build->bits + 7) / 8
                                                              : rows * width * in_block);
                assert_true((build->bits ? TIFFWriteRawStrip(file, number, block, bytes)
                             : build->is_tiled
                                 ? TIFFWriteEncodedTile(file, number, block, bytes)
                                 : TIFFWriteEncodedStrip(file, number, block, bytes)) == bytes);
            }
    free(block);
}

static inline void build_tiff(const char *path, const struct tiff_build *build, const void *pixels)
{
    const char mode[] = {'w', build->is_big_endian ? 'b' : 'l', build->is_big ? '8' : '4', 0};
    (void)remove(path);
    TIFF *file = TIFFOpen(path, mode);
    assert_non_null(file);
    tiff_put_page(file, build, pixels);
    if (build->has_second_page) {
        assert_true(TIFFWriteDirectory(file));
        TIFFSetField(file, TIFFTAG_SUBFILETYPE, build->second_page_kind);
        tiff_put_page(file, build, pixels);
    }
    TIFFClose(file);
}

/* Where the entry of a tag is in the first directory, or the first of its values. */
static inline size_t tiff_place(const unsigned char *bytes, uint16_t tag, bool of_values)
{
    const bool is_big_endian = bytes[0] == 'M';
    const bool is_big = number_from_bytes(bytes + 2, 2, is_big_endian) == 43;
    const size_t wide = is_big ? 8 : 4;
    const size_t list = (size_t)number_from_bytes(bytes + wide, wide, is_big_endian);
    const size_t count = (size_t)number_from_bytes(bytes + list, is_big ? 8 : 2, is_big_endian);
    for (size_t i = 0; i < count; i++) {
        const size_t entry = list + (is_big ? 8 : 2) + i * (is_big ? 20 : 12);
        if (number_from_bytes(bytes + entry, 2, is_big_endian) != tag)
            continue;
        const size_t values = entry + 4 + wide;
        const bool is_list = number_from_bytes(bytes + entry + 4, wide, is_big_endian) > 1;
        return !of_values ? entry
               : is_list  ? (size_t)number_from_bytes(bytes + values, wide, is_big_endian)
                          : values;
    }
    fail_msg("there is no tag %u", tag);
    return 0;
}

/* Makes a tag say another number, of 32 bits (a large file: of 64). */
static inline void tiff_say(unsigned char *bytes, uint16_t tag, uint64_t number)
{
    const bool is_big_endian = bytes[0] == 'M';
    const bool is_big = number_from_bytes(bytes + 2, 2, is_big_endian) == 43;
    const size_t entry = tiff_place(bytes, tag, false);
    number_to_bytes(is_big ? 16 : 4, bytes + entry + 2, 2, is_big_endian);
    number_to_bytes(number, bytes + entry + (is_big ? 12 : 8), is_big ? 8 : 4, is_big_endian);
}

#endif
