/* TIFF by libtiff: read, and changed in place. */
#include "swath/image_library.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "swath/tiff_stream.h"

#define BLOCKS_MAX ((uint32_t)1 << 25)

/* The block read last, kept because pieces of an image come one after the other. */
struct kept_block {
    unsigned char *pixels; /* owned */
    uint32_t number;
    bool is_there;
};

/* An open TIFF. Blocks are tiles or strips. Strips are full rows, and the last may be short. */
struct tiff_image {
    const char *name, *path; /* name: for messages */
    TIFF *file;
    struct library_fault fault;
    uint32_t rows, columns; /* the image's sides */
    uint16_t channels, bits, compression;
    uint16_t planes; /* 1 or a plane per channel; each has its own blocks */
    bool is_tiled;
    uint32_t block_rows, block_columns;
    uint32_t count;
    struct kept_block kept[2]; /* one per plane */
};

static sonject_status damaged(struct report *report, const struct tiff_image *image,
                              const char *how)
{
    return input_failure(report, image->name, "damaged TIFF: %s", how);
}

/* Reports what libtiff could not do. */
static sonject_status tell_fault(struct report *report, const struct tiff_image *image)
{
    errno = image->fault.error; /* for file_check_disk */
    return damaged(report, image, *image->fault.message ? image->fault.message : "cannot be read");
}

static sonject_status check_type(struct report *report, const struct tiff_image *image)
{
    uint16_t format = SAMPLEFORMAT_UINT;
    TIFFGetFieldDefaulted(image->file, TIFFTAG_SAMPLEFORMAT, &format);
    if (format == SAMPLEFORMAT_COMPLEXINT || format == SAMPLEFORMAT_COMPLEXIEEEFP)
        return input_failure(report, image->name,
                             "stores complex numbers as one channel; convert it to two 32-bit "
                             "float channels (real, imaginary)");
    const bool is_unsigned = format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID;
    if (((image->bits == 8 || image->bits == 16) && is_unsigned) ||
        (image->bits == 32 && format == SAMPLEFORMAT_IEEEFP))
        return SONJECT_OK;
    return input_failure(
        report, image->name,
        "has %u-bit %s pixels; sonject reads 8 and 16 bit unsigned and 32 bit float: convert it to "
        "one of these",
        image->bits,
        is_unsigned ? "unsigned" : (format == SAMPLEFORMAT_INT ? "signed" : "floating-point"));
}

static sonject_status check_colours(struct report *report, const struct tiff_image *image)
{
    uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    uint16_t extras = 0;
    const uint16_t *kinds = NULL;
    TIFFGetField(image->file, TIFFTAG_PHOTOMETRIC, &photometric);
    TIFFGetFieldDefaulted(image->file, TIFFTAG_EXTRASAMPLES, &extras, &kinds);
    if (photometric == PHOTOMETRIC_PALETTE)
        return input_failure(report, image->name, "has a palette; convert it to one channel first");
    if (image->channels != 1 && image->channels != 2)
        return input_failure(report, image->name,
                             "has %u channels; sonject reads 1 (amplitude) or 2 (real, imaginary); "
                             "convert it to one channel first",
                             image->channels);
    if (image->channels == 2 && extras > 0 && kinds[0] != EXTRASAMPLE_UNSPECIFIED)
        return input_failure(report, image->name,
                             "the second channel is transparency; convert it to one channel first");
    if (photometric != PHOTOMETRIC_MINISBLACK)
        return input_failure(
            report, image->name,
            "%s (photometric interpretation %u); convert it to one where 0 is black",
            photometric == PHOTOMETRIC_MINISWHITE ? "0 is white" : "not a grey image", photometric);
    return SONJECT_OK;
}

static sonject_status check_shape(struct report *report, const struct tiff_image *image)
{
    uint32_t depth = 1;
    uint32_t tile_depth = 1;
    uint16_t orientation = ORIENTATION_TOPLEFT;
    TIFFGetField(image->file, TIFFTAG_IMAGEDEPTH, &depth);
    TIFFGetField(image->file, TIFFTAG_TILEDEPTH, &tile_depth);
    if (depth > 1 || tile_depth > 1)
        return input_failure(report, image->name,
                             "is a volume of several slices: write the slice as its own image");
    TIFFGetField(image->file, TIFFTAG_ORIENTATION, &orientation);
    return image_check_upright(report, image->name, orientation);
}

static sonject_status check_coding(struct report *report, const struct tiff_image *image)
{
    static const uint16_t known[] = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                     COMPRESSION_DEFLATE, COMPRESSION_PACKBITS};
    uint16_t fill_order = FILLORDER_MSB2LSB;
    uint16_t predictor = PREDICTOR_NONE;
    bool is_known = false;
    TIFFGetFieldDefaulted(image->file, TIFFTAG_FILLORDER, &fill_order);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        is_known = is_known || image->compression == known[i];
    if (!is_known)
        return input_failure(report, image->name,
                             "its compression (number %u) is not one that sonject reads: convert "
                             "it to deflate, LZW or none",
                             image->compression);
    if (fill_order != FILLORDER_MSB2LSB)
        return damaged(report, image, "it says impossible things about how pixels are stored");
    TIFFGetField(image->file, TIFFTAG_PREDICTOR, &predictor);
    if (predictor == PREDICTOR_FLOATINGPOINT && TIFFIsByteSwapped(image->file))
        return input_failure(report, image->name,
                             "keeps floating-point differences in the other byte order, which "
                             "libtiff cannot write: write it again in this machine's");
    if (image->count > BLOCKS_MAX)
        return input_failure(report, image->name,
                             "has more than 2^25 tiles or strips: write it with larger ones");
    if ((image->is_tiled ? TIFFTileSize64(image->file) : TIFFStripSize64(image->file)) >
        TIFF_BLOCK_BYTES_MAX)
        return input_failure(
            report, image->name,
            "its tiles or strips hold more than 256 MB each: write it with smaller ones");
    if (image->rows == 0 || image->block_rows == 0 || image->block_columns == 0 ||
        image->count < image->planes)
        return damaged(report, image, "its tiles or strips have no size");
    return SONJECT_OK;
}

static void look_at_blocks(struct tiff_image *image)
{
    TIFF *file = image->file;
    uint16_t planes = PLANARCONFIG_CONTIG;
    image->channels = 1;
    image->bits = 1;
    image->compression = COMPRESSION_NONE;
    TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &image->columns);
    TIFFGetField(file, TIFFTAG_IMAGELENGTH, &image->rows);
    TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &image->channels);
    TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &image->bits);
    TIFFGetFieldDefaulted(file, TIFFTAG_COMPRESSION, &image->compression);
    TIFFGetFieldDefaulted(file, TIFFTAG_PLANARCONFIG, &planes);
    image->planes = planes == PLANARCONFIG_SEPARATE ? image->channels : 1;
    image->is_tiled = TIFFIsTiled(file) != 0;
    image->block_columns = image->columns;
    if (image->is_tiled) {
        TIFFGetField(file, TIFFTAG_TILEWIDTH, &image->block_columns);
        TIFFGetField(file, TIFFTAG_TILELENGTH, &image->block_rows);
    } else {
        TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &image->block_rows);
    }
    if (!image->is_tiled && image->block_rows > image->rows)
        image->block_rows = image->rows;
    image->count = image->is_tiled ? TIFFNumberOfTiles(file) : TIFFNumberOfStrips(file);
}

/* Returns the number of rows in the block whose first row is given. */
static uint32_t rows_of_block(const struct tiff_image *image, uint32_t row)
{
    const uint32_t left = image->rows - row;
    return image->is_tiled || left > image->block_rows ? image->block_rows : left;
}

static uint64_t bytes_of_block(const struct tiff_image *image, uint32_t row)
{
    return image->is_tiled ? TIFFTileSize64(image->file)
                           : TIFFVStripSize64(image->file, rows_of_block(image, row));
}

static int compare_places(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

/* Checks that blocks lie apart. A block in several places of the image could not be changed in just
 * one. places: room for the start and end of each block. */
static sonject_status check_places(struct report *report, const struct tiff_image *image,
                                   uint64_t file_bytes, uint64_t (*places)[2])
{
    const uint32_t in_plane = image->count / image->planes;
    const uint32_t across = (image->columns - 1) / image->block_columns + 1;
    for (uint32_t i = 0; i < image->count; i++) {
        const uint32_t row = i % in_plane / across * image->block_rows;
        const uint64_t count = TIFFGetStrileByteCount(image->file, i);
        places[i][0] = TIFFGetStrileOffset(image->file, i);
        places[i][1] = places[i][0] + count;
        if (count == 0)
            return damaged(report, image, "some of its tiles or strips were never written");
        if (places[i][0] > file_bytes || count > file_bytes - places[i][0])
            return damaged(report, image, "cut short: some of its tiles or strips are not there");
        if (image->compression == COMPRESSION_NONE && count < bytes_of_block(image, row))
            return damaged(report, image, "some of its tiles or strips are too short");
    }
    qsort(places, image->count, sizeof *places, compare_places);
    for (uint32_t i = 1; i < image->count; i++)
        if (places[i][0] < places[i - 1][1])
            return input_failure(report, image->name,
                                 "keeps several of its tiles or strips in the same place: write it "
                                 "again, each on its own");
    return SONJECT_OK;
}

/* Returns whether a block of the current page lies where the first page has one. places: the first
 * page's, sorted. */
static bool shares_blocks(const struct tiff_image *image, uint64_t (*places)[2])
{
    TIFF *file = image->file;
    const uint32_t count = TIFFIsTiled(file) ? TIFFNumberOfTiles(file) : TIFFNumberOfStrips(file);
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t start = TIFFGetStrileOffset(file, i);
        const uint64_t bytes = TIFFGetStrileByteCount(file, i);
        uint32_t low = 0;
        uint32_t high = bytes > 0 ? image->count : 0;
        while (low < high) {
            const uint32_t middle = low + (high - low) / 2;
            if (places[middle][1] <= start)
                low = middle + 1;
            else
                high = middle;
        }
        if (bytes > 0 && low < image->count &&
            (places[low][0] <= start || places[low][0] - start < bytes))
            return true;
    }
    return false;
}

static bool is_smaller_copy(const struct tiff_image *image)
{
    uint32_t kind = 0;
    return TIFFGetField(image->file, TIFFTAG_SUBFILETYPE, &kind) &&
           (kind & FILETYPE_REDUCEDIMAGE) != 0;
}

/* Refuses smaller copies of the first page, which would not show the target, a first page that is
 * one, and pages that would change with the first. Other pages stay as they are. Leaves the file at
 * its first page. */
static sonject_status check_other_pages(struct report *report, const struct tiff_image *image,
                                        uint64_t (*places)[2])
{
    uint16_t count = 0;
    const uint64_t *offsets = NULL;
    bool has_copies = TIFFGetField(image->file, TIFFTAG_SUBIFD, &count, &offsets) && count > 0;
    if (is_smaller_copy(image))
        return input_failure(report, image->name,
                             "begins with a smaller copy of its image: write the image first");
    while (!has_copies && !TIFFLastDirectory(image->file)) {
        if (!TIFFReadDirectory(image->file))
            return damaged(report, image, "the list of its pages is broken or cut short");
        has_copies = is_smaller_copy(image);
        if (!has_copies && shares_blocks(image, places))
            return input_failure(report, image->name,
                                 "keeps tiles or strips of several pages in the same place: write "
                                 "it again, each on its own");
    }
    if (has_copies)
        return input_failure(report, image->name,
                             "holds smaller copies of the image (overviews), which would go on "
                             "showing the seabed without the target: take them out first");
    return TIFFSetDirectory(image->file, 0) ? SONJECT_OK : tell_fault(report, image);
}

static sonject_status check(struct report *report, struct tiff_image *image, uint64_t file_bytes)
{
    look_at_blocks(image);
    CHECK(check_type(report, image));
    CHECK(check_colours(report, image));
    CHECK(check_shape(report, image));
    CHECK(check_coding(report, image));
    uint64_t(*places)[2] = allocate_array(image->count, sizeof *places);
    CHECK_MEMORY(report, places, image->name);
    sonject_status status = check_places(report, image, file_bytes, places);
    THEN(status, check_other_pages(report, image, places));
    free(places);
    return status;
}

static sonject_status close_image(struct report *report, void *opened)
{
    struct tiff_image *image = opened;
    (void)report;
    if (image->file)
        TIFFClose(image->file);
    for (int i = 0; i < 2; i++)
        free(image->kept[i].pixels);
    free(image);
    return SONJECT_OK;
}

static sonject_status open_image(struct report *report, const char *name, const char *path,
                                 const char *array, bool writes, void **opened,
                                 struct image_facts *facts)
{
    struct tiff_image *image = *opened = allocate_array(1, sizeof *image);
    struct path_facts identity;
    const char *description = NULL;
    (void)array, (void)writes;
    CHECK_MEMORY(report, image, name);
    image->name = name;
    image->path = path;
    CHECK(file_identify(report, path, &identity));
    image->file = tiff_open(path, "rm", &image->fault);
    if (!image->file)
        return tell_fault(report, image);
    CHECK(check(report, image, identity.bytes));
    if (*image->fault.message)
        return tell_fault(report, image);
    for (uint16_t i = 0; i < image->planes; i++) {
        image->kept[i].pixels = allocate_array((size_t)bytes_of_block(image, 0), 1);
        CHECK_MEMORY(report, image->kept[i].pixels, name);
    }
    facts->layout = (struct raster_layout){image->rows, image->columns, image->channels,
                                           image->bits == 8    ? PIXEL_UINT8
                                           : image->bits == 16 ? PIXEL_UINT16
                                                               : PIXEL_FLOAT32};
    if (TIFFGetField(image->file, TIFFTAG_IMAGEDESCRIPTION, &description) && description) {
        facts->description = copy_text(description);
        CHECK_MEMORY(report, facts->description, name);
    }
    return SONJECT_OK;
}

/* Copies the pixels that a block of a plane shares with the region, in one direction. */
static void move_pixels(const struct tiff_image *image, uint32_t row, uint32_t column,
                        uint16_t plane, const struct region *region, unsigned char *pixels,
                        unsigned char *block, bool writes)
{
    const size_t sample = image->bits / 8;
    const size_t pixel = image->channels * sample;
    const size_t in_block = image->planes > 1 ? sample : pixel;
    const uint64_t first = region->first_column > column ? region->first_column : column;
    const uint64_t region_end = region->first_column + region->columns;
    const uint64_t block_end = (uint64_t)column + image->block_columns;
    const uint64_t end = region_end < block_end ? region_end : block_end;
    const uint64_t at_once = image->planes > 1 ? 1 : end - first;
    for (uint32_t i = 0; i < rows_of_block(image, row); i++) {
        const uint64_t down = row + i - region->first_row;
        for (uint64_t j = first; row + i >= region->first_row && down < region->rows && j < end;
             j += at_once) {
            unsigned char *stored =
                block + ((size_t)i * image->block_columns + (j - column)) * in_block;
            unsigned char *given = pixels +
                                   (down * region->columns + (j - region->first_column)) * pixel +
                                   plane * sample;
            memcpy(writes ? stored : given, writes ? given : stored, (size_t)at_once * in_block);
        }
    }
}

/* Returns a block's pixels, which are kept; NULL if they cannot be read. */
static unsigned char *read_block(struct tiff_image *image, uint32_t number, uint16_t plane,
                                 tmsize_t bytes)
{
    struct kept_block *kept = &image->kept[plane];
    if (!kept->is_there || kept->number != number)
        kept->is_there =
            (image->is_tiled
                 ? TIFFReadEncodedTile(image->file, number, kept->pixels, bytes)
                 : TIFFReadEncodedStrip(image->file, number, kept->pixels, bytes)) == bytes;
    kept->number = number;
    return kept->is_there ? kept->pixels : NULL;
}

/* Reads a block through one file and writes it through another, the writer, if there is one. A
 * codec of libtiff either reads or writes. */
static bool exchange_block(struct tiff_image *image, TIFF *writer, uint32_t row, uint32_t column,
                           uint16_t plane, const struct region *region, unsigned char *pixels)
{
    const tmsize_t bytes = (tmsize_t)bytes_of_block(image, row);
    const uint32_t number = image->is_tiled ? TIFFComputeTile(image->file, column, row, 0, plane)
                                            : TIFFComputeStrip(image->file, row, plane);
    unsigned char *block = read_block(image, number, plane, bytes);
    if (!block)
        return false;
    move_pixels(image, row, column, plane, region, pixels, block, writer != NULL);
    if (!writer)
        return true;
    image->kept[plane].is_there = false; /* encoding may overwrite the block */
    return (image->is_tiled ? TIFFWriteEncodedTile(writer, number, block, bytes)
                            : TIFFWriteEncodedStrip(writer, number, block, bytes)) == bytes;
}

static bool exchange_blocks(struct tiff_image *image, TIFF *writer, const struct region *region,
                            unsigned char *pixels)
{
    const uint64_t row_end = region->first_row + region->rows;
    const uint64_t column_end = region->first_column + region->columns;
    const uint32_t height = image->block_rows;
    const uint32_t width = image->block_columns;
    for (uint16_t plane = 0; plane < image->planes; plane++)
        for (uint64_t row = region->first_row / height * height; row < row_end; row += height)
            for (uint64_t column = region->first_column / width * width; column < column_end;
                 column += width)
                if (!exchange_block(image, writer, (uint32_t)row, (uint32_t)column, plane, region,
                                    pixels))
                    return false;
    return true;
}

static sonject_status read_pixels(struct report *report, void *opened, const struct region *region,
                                  void *pixels)
{
    struct tiff_image *image = opened;
    if (exchange_blocks(image, NULL, region, pixels))
        return SONJECT_OK;
    errno = image->fault.error;
    return input_failure(report, image->name, "cut short or damaged at rows %llu...%llu: %s",
                         (unsigned long long)region->first_row,
                         (unsigned long long)(region->first_row + region->rows - 1),
                         image->fault.message);
}

/* Ends the writing with the lists of places and sizes. Returns false if libtiff rewrote the
 * directory, which could lose tags. */
static bool flush_lists(TIFF *writer)
{
    const uint64_t directory = TIFFCurrentDirOffset(writer);
    return TIFFFlush(writer) && TIFFCurrentDirOffset(writer) == directory;
}

/* Reopens the file for each change, because its lists of places move with the blocks. */
static sonject_status change_pixels(struct report *report, void *opened,
                                    const struct region *region, const void *pixels)
{
    struct tiff_image *image = opened;
    struct library_fault fault = {"", 0};
    bool is_done = false;
    TIFFClose(image->file);
    image->file = tiff_open(image->path, "rm", &image->fault);
    TIFF *writer = image->file ? tiff_open(image->path, "r+m", &fault) : NULL;
    if (writer) {
        is_done =
            exchange_blocks(image, writer, region, (unsigned char *)pixels) && flush_lists(writer);
        TIFFClose(writer);
    }
    if (is_done)
        return SONJECT_OK;
    if (*image->fault.message)
        return tell_fault(report, image);
    if (fault.error != 0)
        return file_failure(report, image->name, "write", fault.error);
    return input_failure(report, image->name,
                         "its pixels cannot be replaced: %s: convert it to BigTIFF", fault.message);
}

const struct image_library tiff_library = {open_image, close_image, read_pixels, change_pixels};
