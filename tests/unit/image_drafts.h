/* Drafts of images, and checks of what is read: TIFF files of every build that sonject reads, made
 * by libtiff, and files that libtiff would not write. Include this header first. */
#ifndef SONJECT_TESTS_IMAGE_DRAFTS_H
#define SONJECT_TESTS_IMAGE_DRAFTS_H

#include <tiffio.h>

#include "base/byte_order.h"
#include "claims.h"
#include "clean_folder.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"

#define ROWS       53
#define COLUMNS    71
#define BYTES_MOST 200000 /* largest size of an image or a file */

static const struct raster_layout grey8 = {ROWS, COLUMNS, 1, PIXEL_UINT8};
static const struct raster_layout grey16 = {ROWS, COLUMNS, 1, PIXEL_UINT16};
static const struct raster_layout real32 = {ROWS, COLUMNS, 1, PIXEL_FLOAT32};
static const struct raster_layout complex32 = {ROWS, COLUMNS, 2, PIXEL_FLOAT32};
static const struct region patch_region = {17, 23, 20, 31};

/* Returns memory filled with 0, valid while thirty others are asked for. */
static inline unsigned char *scratch(void)
{
    static unsigned char all[32][BYTES_MOST];
    static unsigned turn;
    unsigned char *bytes = all[turn++ % COUNT(all)];
    memset(bytes, 0, BYTES_MOST);
    return bytes;
}

static inline unsigned char *load(const char *path, size_t *count)
{
    unsigned char *bytes = scratch();
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    *count = fread(bytes, 1, BYTES_MOST, file);
    fclose(file);
    return bytes;
}

static inline struct region whole_of(const struct raster_layout *layout)
{
    return (struct region){0, 0, layout->rows, layout->columns};
}

static inline size_t pixel_size(const struct raster_layout *layout)
{
    return layout->channels * pixel_bytes(layout->type);
}

/* Returns the pixels of a region, which are noisy so that compression has to work. */
static inline unsigned char *make_pixels(const struct raster_layout *layout,
                                         const struct region *region, uint32_t seed)
{
    size_t bytes = 0;
    unsigned char *pixels = scratch();
    assert_true(region_bytes(layout, region, &bytes) && bytes <= BYTES_MOST);
    for (size_t i = 0; i < bytes; i++) {
        seed = seed * 1664525u + 1013904223u;
        if (layout->type == PIXEL_FLOAT32 && i % 4 == 0)
            ((float *)(void *)pixels)[i / 4] = (float)(seed >> 8) * 1e-5f - 60.0f;
        else if (layout->type != PIXEL_FLOAT32)
            pixels[i] = (unsigned char)(seed >> 24);
    }
    return pixels;
}

static inline unsigned char *make_image(const struct raster_layout *layout)
{
    const struct region whole = whole_of(layout);
    return make_pixels(layout, &whole, 1);
}

static inline sonject_status write_image(const char *path, const struct raster_layout *layout,
                                         const void *pixels)
{
    return raster_file_write(&report, path, layout, NULL, NULL, 0, pixels);
}

static inline sonject_status open_image(const char *path, struct swath_file **file)
{
    return swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, file);
}

static inline sonject_status copy_with_patch(const char *source, const char *path,
                                             const struct region *region, const void *pixels,
                                             sonject_progress_function progress, void *user)
{
    struct swath_file *file;
    sonject_status status = open_image(source, &file);
    if (status == SONJECT_OK)
        status = swath_file_copy_with_patch(&report, file, path, region, pixels, progress, user);
    swath_file_close(&file);
    return status;
}

static inline unsigned char *read_file(const char *path, const struct raster_layout *expected,
                                       const struct region *region)
{
    struct swath_file *file;
    struct raster_layout layout;
    unsigned char *pixels = scratch();
    EXPECT_OK(&report, open_image(path, &file));
    swath_file_layout(file, &layout);
    assert_int_equal(layout.rows, expected->rows);
    assert_int_equal(layout.columns, expected->columns);
    assert_int_equal(layout.channels, expected->channels);
    assert_int_equal(layout.type, expected->type);
    EXPECT_OK(&report, swath_file_read(&report, file, region, pixels));
    swath_file_close(&file);
    assert_null(file);
    return pixels;
}

/* Expects a file's pixels to be those of whole, but in region those of patch (NULL: no patch). */
static inline void expect_pixels(const char *path, const struct raster_layout *layout,
                                 const unsigned char *whole, const struct region *region,
                                 const unsigned char *patch)
{
    const struct region everything = whole_of(layout);
    const size_t size = pixel_size(layout);
    unsigned char *expected = memcpy(scratch(), whole, layout->rows * layout->columns * size);
    for (uint64_t row = 0; patch && row < region->rows; row++)
        memcpy(expected +
                   ((region->first_row + row) * layout->columns + region->first_column) * size,
               patch + row * region->columns * size, region->columns * size);
    const unsigned char *pixels = read_file(path, layout, &everything);
    for (uint64_t i = 0; i < layout->rows * layout->columns * size; i++)
        if (pixels[i] != expected[i])
            fail_msg("%s: the pixel at row %d, column %d is wrong", path,
                     (int)(i / size / layout->columns), (int)(i / size % layout->columns));
}

static inline void expect_message(const char *path, const char *part)
{
    if (!strstr(report.message, path) || !strstr(report.message, part))
        fail_msg("'%s' does not name '%s' and '%s'", report.message, path, part);
}

static inline void expect_no_open(const char *path, const char *part)
{
    struct swath_file *file = (struct swath_file *)&report;
    if (open_image(path, &file) != SONJECT_ERROR_INPUT)
        fail_msg("%s was not refused (%s)", path, part);
    assert_null(file);
    expect_message(path, part);
}

#define TIFF_PRIVATE_TAG  65000
#define TIFF_PRIVATE_TEXT "what only the maker of this file knows"

struct tiff_build {
    struct raster_layout layout;
    bool is_big, is_big_endian, is_tiled, is_separate, has_second_page;
    uint16_t compression, predictor;
    uint32_t block_rows, block_columns;
    /* for files to be refused; 0: as the layout says */
    uint16_t bits, sample_format, photometric, extra_channel, fill_order;
    uint32_t second_page_kind; /* 1: a smaller copy of the first */
    uint32_t more_tag, more_value;
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
    if (build->more_tag)
        TIFFSetField(file, build->more_tag, build->more_value);
    TIFFSetField(file, TIFF_PRIVATE_TAG, TIFF_PRIVATE_TEXT);
}

/* Writes the pixels of each block. Pixels beyond the image are 0. */
static inline void tiff_put_page(TIFF *file, const struct tiff_build *build,
                                 const unsigned char *pixels)
{
    const struct raster_layout *layout = &build->layout;
    const uint64_t width = build->is_tiled ? build->block_columns : layout->columns;
    const uint64_t height = build->block_rows < layout->rows ? build->block_rows : layout->rows;
    const size_t sample = pixel_bytes(layout->type);
    const size_t in_block = build->is_separate ? sample : layout->channels * sample;
    unsigned char *block = zeroed((size_t)(width * height), in_block);
    uint32_t number = 0;
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

/* Returns the place of a tag's entry in the first directory, or of its first value. */
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

/* Makes a tag say another number, of 32 bits (in a BigTIFF file: 64). */
static inline void tiff_say(unsigned char *bytes, uint16_t tag, uint64_t number)
{
    const bool is_big_endian = bytes[0] == 'M';
    const bool is_big = number_from_bytes(bytes + 2, 2, is_big_endian) == 43;
    const size_t entry = tiff_place(bytes, tag, false);
    number_to_bytes(is_big ? 16 : 4, bytes + entry + 2, 2, is_big_endian);
    number_to_bytes(number, bytes + entry + (is_big ? 12 : 8), is_big ? 8 : 4, is_big_endian);
}

#endif
