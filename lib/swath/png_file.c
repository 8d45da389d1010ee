/* PNG by libpng: grey images of 8 or 16 bits, and palette images of object numbers. */
#include "swath/image_library.h"

#include <errno.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#define DESCRIPTION "Description" /* keyword of the description */

/* The chunk that marks sonject's own palettes: their pixels are numbers, all others colours. */
#define NUMBERS_CHUNK "soNu"

struct png_image {
    const char *name, *path; /* name: for messages */
    struct raster_layout layout;
    struct library_fault fault;
    FILE *file;
    png_structp png;
    png_infop info;
    uint64_t next_row;  /* the next row to decode */
    unsigned char *row; /* owned; the row decoded last */
    unsigned char *all; /* owned; rows of an interlaced image; NULL: not interlaced */
};

static void hear(png_structp png, png_const_charp message)
{
    struct library_fault *fault = png_get_error_ptr(png);
    fault->error = errno;
    snprintf(fault->message, sizeof fault->message, "%s", message);
    png_longjmp(png, 1);
}

/* Ignores warnings, after which libpng goes on. */
static void ignore(png_structp png, png_const_charp message)
{
    (void)png, (void)message;
}

static void swap_bytes(png_structp png, int bits)
{
    const uint16_t one = 1;
    if (bits == 16 && *(const unsigned char *)&one == 1)
        png_set_swap(png);
}

static sonject_status tell_fault(struct report *report, const struct png_image *image)
{
    if (image->fault.error == ENOMEM)
        return report_out_of_memory(report, image->name);
    errno = image->fault.error; /* for file_check_disk */
    return input_failure(report, image->name, "cannot be read: %s", image->fault.message);
}

static void end_decoding(struct png_image *image)
{
    if (image->png)
        png_destroy_read_struct(&image->png, &image->info, NULL);
    if (image->file)
        fclose(image->file);
    image->file = NULL;
}

static bool read_head(struct png_image *image)
{
    if (setjmp(png_jmpbuf(image->png)) != 0)
        return false;
    png_init_io(image->png, image->file);
    png_set_keep_unknown_chunks(image->png, PNG_HANDLE_CHUNK_ALWAYS, (png_const_bytep)NUMBERS_CHUNK,
                                1);
    png_read_info(image->png, image->info);
    swap_bytes(image->png, png_get_bit_depth(image->png, image->info));
    png_set_interlace_handling(image->png);
    png_read_update_info(image->png, image->info);
    return true;
}

/* Opens the file, or opens it again if rows are wanted that were decoded before. */
static sonject_status begin_decoding(struct report *report, struct png_image *image)
{
    end_decoding(image);
    image->next_row = 0;
    errno = 0;
    image->file = file_open(image->path, "rb");
    if (!image->file)
        return input_failure(report, image->name, "cannot be opened");
    image->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &image->fault, hear, ignore);
    image->info = image->png ? png_create_info_struct(image->png) : NULL;
    CHECK_MEMORY(report, image->info, image->name);
    return read_head(image) ? SONJECT_OK : tell_fault(report, image);
}

static bool has_numbers(const struct png_image *image)
{
    png_unknown_chunkp chunks = NULL;
    const int count = png_get_unknown_chunks(image->png, image->info, &chunks);
    return count > 0 && memcmp(chunks->name, NUMBERS_CHUNK, 4) == 0;
}

static sonject_status take_layout(struct report *report, struct png_image *image)
{
    const int bits = png_get_bit_depth(image->png, image->info);
    const int channels = png_get_channels(image->png, image->info) +
                         (png_get_valid(image->png, image->info, PNG_INFO_tRNS) != 0);
    if (png_get_color_type(image->png, image->info) == PNG_COLOR_TYPE_PALETTE &&
        !has_numbers(image))
        return input_failure(report, image->name, "has a palette; convert it to one channel first");
    if (bits != 8 && bits != 16)
        return input_failure(report, image->name,
                             "has %d-bit pixels; sonject reads PNG with 8 or 16: convert it to one "
                             "of these",
                             bits);
    if (channels == 2)
        return input_failure(report, image->name,
                             "has 2 channels, grey and transparency; convert it to one channel "
                             "first");
    if (channels != 1)
        return input_failure(report, image->name,
                             "has %d channels; sonject reads 1 (amplitude) or 2 (real, imaginary); "
                             "convert it to one channel first",
                             channels);
    image->layout = (struct raster_layout){.rows = png_get_image_height(image->png, image->info),
                                           .columns = png_get_image_width(image->png, image->info),
                                           .channels = 1,
                                           .type = bits == 8 ? PIXEL_UINT8 : PIXEL_UINT16};
    return SONJECT_OK;
}

static sonject_status check_exif(struct report *report, const struct png_image *image)
{
    png_uint_32 count = 0;
    png_bytep exif = NULL;
    return png_get_eXIf_1(image->png, image->info, &count, &exif) != 0
               ? image_check_exif(report, image->name, exif, count)
               : SONJECT_OK;
}

/* Decodes all passes of an interlaced image. */
static bool decode_all(struct png_image *image, size_t row_bytes)
{
    if (setjmp(png_jmpbuf(image->png)) != 0)
        return false;
    for (int pass = 0; pass < PNG_INTERLACE_ADAM7_PASSES; pass++)
        for (uint64_t row = 0; row < image->layout.rows; row++)
            png_read_row(image->png, image->all + row * row_bytes, NULL);
    return true;
}

/* Decodes rows up to the region's end. Copies the region's pixels unless pixels is NULL. */
static bool decode_region(struct png_image *image, const struct region *region,
                          unsigned char *pixels)
{
    const size_t pixel = pixel_bytes(image->layout.type);
    const size_t row_bytes = (size_t)image->layout.columns * pixel;
    if (setjmp(png_jmpbuf(image->png)) != 0)
        return false;
    for (uint64_t row = image->all ? region->first_row : image->next_row;
         row < region->first_row + region->rows; row++) {
        if (!image->all) {
            png_read_row(image->png, image->row, NULL);
            image->next_row = row + 1;
        }
        if (pixels && row >= region->first_row)
            memcpy(pixels + (size_t)((row - region->first_row) * region->columns) * pixel,
                   (image->all ? image->all + row * row_bytes : image->row) +
                       (size_t)region->first_column * pixel,
                   (size_t)region->columns * pixel);
    }
    return true;
}

/* Decodes all rows. Only the decoder can tell that a file is cut short, and this way it does so at
 * once, not after hours of work. */
static sonject_status try_all_rows(struct report *report, struct png_image *image)
{
    const struct region whole = {0, 0, image->layout.rows, image->layout.columns};
    const size_t row_bytes = (size_t)whole.columns * pixel_bytes(image->layout.type);
    const bool is_interlaced =
        png_get_interlace_type(image->png, image->info) != PNG_INTERLACE_NONE;
    if (is_interlaced)
        image->all = allocate_array((size_t)whole.rows, row_bytes);
    else
        image->row = allocate_array(1, row_bytes);
    CHECK_MEMORY(report, image->row || image->all, image->name);
    if (is_interlaced ? decode_all(image, row_bytes) : decode_region(image, &whole, NULL))
        return SONJECT_OK;
    if (image->fault.error == 0)
        return input_failure(report, image->name, "cut short or damaged at row %llu: %s",
                             (unsigned long long)image->next_row, image->fault.message);
    return tell_fault(report, image);
}

static sonject_status take_description(struct report *report, const struct png_image *image,
                                       char **description)
{
    png_textp texts = NULL;
    int count = 0;
    const char *found = "";
    png_get_text(image->png, image->info, &texts, &count);
    for (int i = 0; i < count; i++)
        if (strcmp(texts[i].key, DESCRIPTION) == 0)
            found = texts[i].text;
    *description = copy_text(found);
    CHECK_MEMORY(report, *description, image->name);
    return SONJECT_OK;
}

static sonject_status png_close(struct report *report, void *opened)
{
    struct png_image *image = opened;
    (void)report;
    end_decoding(image);
    free(image->row);
    free(image->all);
    free(image);
    return SONJECT_OK;
}

static sonject_status png_open(struct report *report, const char *name, const char *path,
                               const char *array, bool writes, void **opened,
                               struct image_facts *facts)
{
    struct png_image *image = *opened = allocate_array(1, sizeof *image);
    (void)array, (void)writes;
    CHECK_MEMORY(report, image, name);
    image->name = name;
    image->path = path;
    CHECK(begin_decoding(report, image));
    CHECK(take_layout(report, image));
    CHECK(check_exif(report, image));
    CHECK(try_all_rows(report, image));
    facts->layout = image->layout;
    return take_description(report, image, &facts->description);
}

static sonject_status png_read(struct report *report, void *opened, const struct region *region,
                               void *pixels)
{
    struct png_image *image = opened;
    if (!image->all && region->first_row < image->next_row)
        CHECK(begin_decoding(report, image));
    return decode_region(image, region, pixels) ? SONJECT_OK : tell_fault(report, image);
}

const struct image_library png_library = {png_open, png_close, png_read, NULL};

/* ---- New images. */

struct png_output {
    const struct image_encoding *encoding;
    struct library_fault fault;
    FILE *file;
    png_structp png;
    png_infop info;
};

static void put_palette(struct png_output *output)
{
    static const png_unknown_chunk numbers = {NUMBERS_CHUNK, NULL, 0, PNG_HAVE_PLTE};
    png_color colours[PNG_PALETTE_BYTES / 3];
    for (size_t i = 0; i < PNG_PALETTE_BYTES / 3; i++) {
        const uint8_t *colour = output->encoding->palette + 3 * i;
        colours[i] = (png_color){colour[0], colour[1], colour[2]};
    }
    png_set_PLTE(output->png, output->info, colours, PNG_PALETTE_BYTES / 3);
    png_set_keep_unknown_chunks(output->png, PNG_HANDLE_CHUNK_ALWAYS,
                                (png_const_bytep)NUMBERS_CHUNK, 1);
    png_set_unknown_chunks(output->png, output->info, &numbers, 1);
}

static bool write_head(struct png_output *output)
{
    const struct image_encoding *encoding = output->encoding;
    const struct raster_layout *layout = &encoding->layout;
    const int bits = layout->type == PIXEL_UINT8 ? 8 : 16;
    /* PNG's plain texts are Latin-1; only its international ones are UTF-8 */
    png_text text = {.compression = text_is_beyond_ascii(encoding->description)
                                        ? PNG_ITXT_COMPRESSION_NONE
                                        : PNG_TEXT_COMPRESSION_NONE,
                     .key = DESCRIPTION,
                     .text = (char *)encoding->description};
    if (setjmp(png_jmpbuf(output->png)) != 0)
        return false;
    png_init_io(output->png, output->file);
    /* few values, or noise in a colour map: filters and a search for longer matches would take much
     * time and make files no smaller */
    if (encoding->is_drawn) {
        png_set_filter(output->png, 0, PNG_FILTER_NONE);
        png_set_compression_level(output->png, 1);
    }
    png_set_IHDR(output->png, output->info, (png_uint_32)layout->columns, (png_uint_32)layout->rows,
                 bits,
                 encoding->palette       ? PNG_COLOR_TYPE_PALETTE
                 : layout->channels == 3 ? PNG_COLOR_TYPE_RGB
                                         : PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (encoding->palette)
        put_palette(output);
    if (*encoding->description)
        png_set_text(output->png, output->info, &text, 1);
    png_write_info(output->png, output->info);
    swap_bytes(output->png, bits);
    return true;
}

static bool write_rows(void *png_output, const unsigned char *rows, uint64_t count)
{
    const struct png_output *output = png_output;
    const size_t row_bytes = png_get_rowbytes(output->png, output->info);
    if (setjmp(png_jmpbuf(output->png)) != 0)
        return false;
    for (uint64_t row = 0; row < count; row++)
        png_write_row(output->png, rows + row * row_bytes);
    return true;
}

static bool write_end(struct png_output *output)
{
    if (setjmp(png_jmpbuf(output->png)) != 0)
        return false;
    png_write_end(output->png, NULL);
    return true;
}

sonject_status png_encode(struct report *report, const struct image_encoding *encoding)
{
    struct png_output output = {.encoding = encoding};
    bool is_written = false;
    sonject_status status = SONJECT_OK;
    errno = 0;
    output.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &output.fault, hear, ignore);
    output.info = output.png ? png_create_info_struct(output.png) : NULL;
    output.file = output.info ? file_open(encoding->path, "wb") : NULL;
    output.fault.error = output.info ? errno : ENOMEM;
    if (output.file && write_head(&output))
        status = encode_rows(report, encoding, write_rows, &output, &is_written);
    is_written = is_written && status == SONJECT_OK && write_end(&output);
    if (output.png)
        png_destroy_write_struct(&output.png, &output.info);
    return encoding_end(report, encoding, output.file, &output.fault, is_written, status);
}
