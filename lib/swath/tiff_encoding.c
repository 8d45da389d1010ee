/* New TIFF images by libtiff. */
#include <stdint.h>

#include "swath/image_library.h"
#include "swath/tiff_stream.h"

#define STRIP_BYTES ((uint64_t)1 << 18)
#define CLASSIC_MAX (UINT32_MAX - ((uint64_t)64 << 20)) /* less 64 MB for the directory */

static uint64_t row_bytes(const struct raster_layout *layout)
{
    return layout->columns * layout->channels * pixel_bytes(layout->type);
}

static void set_tags(TIFF *file, const struct image_encoding *encoding)
{
    const struct raster_layout *layout = &encoding->layout;
    const uint64_t rows = STRIP_BYTES / row_bytes(layout);
    const uint16_t unspecified = EXTRASAMPLE_UNSPECIFIED;
    TIFFSetField(file, TIFFTAG_IMAGEWIDTH, (uint32_t)layout->columns);
    TIFFSetField(file, TIFFTAG_IMAGELENGTH, (uint32_t)layout->rows);
    TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, (int)(8 * pixel_bytes(layout->type)));
    TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(file, TIFFTAG_PHOTOMETRIC,
                 layout->channels == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, (int)layout->channels);
    TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, (uint32_t)(rows > 0 ? rows : 1));
    TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(file, TIFFTAG_SOFTWARE, "sonject");
    if (layout->channels == 2)
        TIFFSetField(file, TIFFTAG_EXTRASAMPLES, 1, &unspecified);
    TIFFSetField(file, TIFFTAG_SAMPLEFORMAT,
                 layout->type == PIXEL_FLOAT32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    if (*encoding->description)
        TIFFSetField(file, TIFFTAG_IMAGEDESCRIPTION, encoding->description);
}

/* An image that is being written. */
struct tiff_output {
    TIFF *file;
    size_t row_bytes;
    uint32_t row; /* the next row to write */
};

static bool write_rows(void *tiff_output, const unsigned char *rows, uint64_t count)
{
    struct tiff_output *output = tiff_output;
    for (uint64_t i = 0; i < count; i++, output->row++)
        if (TIFFWriteScanline(output->file, (void *)(rows + i * output->row_bytes), output->row,
                              0) < 0)
            return false;
    return true;
}

sonject_status tiff_encode(struct report *report, const struct image_encoding *encoding)
{
    const struct raster_layout *layout = &encoding->layout;
    const bool is_large = layout->rows > CLASSIC_MAX / row_bytes(layout);
    struct library_fault fault;
    struct tiff_output output = {tiff_open(encoding->path, is_large ? "w8" : "w", &fault),
                                 (size_t)row_bytes(layout), 0};
    bool is_written = false;
    sonject_status status = SONJECT_OK;
    if (output.file) {
        set_tags(output.file, encoding);
        status = encode_rows(report, encoding, write_rows, &output, &is_written);
        is_written = is_written && status == SONJECT_OK && TIFFFlush(output.file);
        TIFFClose(output.file);
    }
    return status != SONJECT_OK || is_written ? status : encoding_failure(report, encoding, &fault);
}
