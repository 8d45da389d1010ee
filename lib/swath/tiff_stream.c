#include "swath/tiff_stream.h"

#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "swath/image_library.h"

static int hear(TIFF *file, void *user, const char *module, const char *format, va_list values)
{
    struct library_fault *fault = user;
    (void)file;
    (void)module;
    if (!*fault->message) {
        fault->error = errno;
        vsnprintf(fault->message, sizeof fault->message, format, values);
    }
    return 1;
}

/* Ignores libtiff's warnings, except of data behind the end of a file that is cut short. */
static int hear_warning(TIFF *file, void *user, const char *module, const char *format,
                        va_list values)
{
    return strstr(format, "IO error") ? hear(file, user, module, format, values) : 1;
}

/* Reads bytes. C's streams need a seek between reading and writing. */
static tmsize_t read_bytes(thandle_t stream, void *bytes, tmsize_t count)
{
    return fseek(stream, 0, SEEK_CUR) == 0 ? (tmsize_t)fread(bytes, 1, (size_t)count, stream) : -1;
}

static tmsize_t write_bytes(thandle_t stream, void *bytes, tmsize_t count)
{
    return fseek(stream, 0, SEEK_CUR) == 0 ? (tmsize_t)fwrite(bytes, 1, (size_t)count, stream) : -1;
}

/* Seeks from the beginning or the end, which is all that libtiff needs. */
static toff_t seek_place(thandle_t stream, toff_t place, int from)
{
    const bool is_there =
        from == SEEK_SET ? byte_file_seek(stream, place) : fseek(stream, 0, from) == 0;
    return is_there ? byte_file_place(stream) : (toff_t)-1;
}

static toff_t file_size(thandle_t stream)
{
    const toff_t place = byte_file_place(stream);
    const toff_t size = seek_place(stream, 0, SEEK_END);
    return byte_file_seek(stream, place) ? size : 0;
}

static int close_stream(thandle_t stream)
{
    return fclose(stream);
}

TIFF *tiff_open(const char *path, const char *mode, struct library_fault *fault)
{
    memset(fault, 0, sizeof *fault);
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return NULL;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)(2 * TIFF_BLOCK_BYTES_MAX));
    TIFFOpenOptionsSetErrorHandlerExtR(options, hear, fault);
    TIFFOpenOptionsSetWarningHandlerExtR(options, hear_warning, fault);
    errno = 0;
    TIFF *file = NULL;
    FILE *stream = file_open(path, *mode == 'w' ? "w+b" : strchr(mode, '+') ? "r+b" : "rb");
    if (stream) { /* no buffer: a full disk is found as bytes are written */
        setvbuf(stream, NULL, _IONBF, 0);
        file = TIFFClientOpenExt(path, mode, stream, read_bytes, write_bytes, seek_place,
                                 close_stream, file_size, NULL, NULL, options);
    } else {
        fault->error = errno;
        strcpy(fault->message, "cannot be opened");
    }
    if (stream && !file)
        fclose(stream);
    TIFFOpenOptionsFree(options);
    return file;
}

/* ---- New TIFF images. */

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
