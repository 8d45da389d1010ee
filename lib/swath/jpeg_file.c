/* JPEG by libjpeg: grey images are read; grey and coloured ones are written. */
#include "swath/image_library.h"

#include <errno.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

#include "base/file.h"
#include "base/memory.h"
#include "swath/swath_file.h"

#define QUALITY_DIFFERENCE 0.2 /* largest mean relative difference of close tables */

#define COMMENT_MAX 65533 /* bytes of a comment, which holds the description, or of EXIF data */
#define EXIF_MARKER (JPEG_APP0 + 1)
#define EXIF_HEAD   6 /* bytes before the data */

/* The quality of whole swaths: coarser coding would show in all noise, not only at the target. */
#define FINEST_QUALITY 98

/* The receiver of libjpeg's errors. */
struct listener {
    struct jpeg_error_mgr manager; /* first, because libjpeg passes on its address */
    jmp_buf back;
    FILE *file;
    struct library_fault fault;
};

struct jpeg_image {
    const char *name, *path; /* name: for messages */
    struct raster_layout layout;
    struct listener listener;
    struct jpeg_decompress_struct jpeg; /* all 0: not created */
    struct jpeg_compress_struct scaled; /* for comparing tables; all 0: not created */
    uint64_t next_row;                  /* the next row to decode */
    unsigned char *row;                 /* owned; the row decoded last */
};

static void hear(j_common_ptr jpeg)
{
    struct listener *listener = (struct listener *)jpeg->err;
    const bool is_of_file = listener->file && (ferror(listener->file) || !jpeg->is_decompressor);
    listener->fault.error = jpeg->err->msg_code == JERR_OUT_OF_MEMORY ? ENOMEM
                            : is_of_file                              ? errno
                                                                      : 0;
    jpeg->err->format_message(jpeg, listener->fault.message); /* JMSG_LENGTH_MAX bytes or fewer */
    longjmp(listener->back, 1);
}

/* Treats warnings (negative levels) as errors. They mean a damaged file, and libjpeg would go on
 * with made-up pixels. */
static void hear_warning(j_common_ptr jpeg, int level)
{
    if (level < 0)
        hear(jpeg);
}

static struct jpeg_error_mgr *listen(struct listener *listener, FILE *file)
{
    memset(listener, 0, sizeof *listener);
    listener->file = file;
    jpeg_std_error(&listener->manager);
    listener->manager.error_exit = hear;
    listener->manager.emit_message = hear_warning;
    return &listener->manager;
}

static sonject_status tell_fault(struct report *report, const struct jpeg_image *image)
{
    if (image->listener.fault.error == ENOMEM)
        return report_out_of_memory(report, image->name);
    errno = image->listener.fault.error; /* for file_check_disk */
    return input_failure(report, image->name, "cut short or damaged at row %llu: %s",
                         (unsigned long long)image->next_row, image->listener.fault.message);
}

static void end_decoding(struct jpeg_image *image)
{
    jpeg_destroy_decompress(&image->jpeg);
    memset(&image->jpeg, 0, sizeof image->jpeg);
    if (image->listener.file)
        fclose(image->listener.file);
    image->listener.file = NULL;
}

static bool read_head(struct jpeg_image *image)
{
    if (setjmp(image->listener.back) != 0)
        return false;
    jpeg_create_decompress(&image->jpeg);
    jpeg_stdio_src(&image->jpeg, image->listener.file);
    jpeg_save_markers(&image->jpeg, JPEG_COM, COMMENT_MAX);
    jpeg_save_markers(&image->jpeg, EXIF_MARKER, COMMENT_MAX);
    jpeg_read_header(&image->jpeg, TRUE);
    if (image->jpeg.num_components == 1)
        jpeg_start_decompress(&image->jpeg);
    return true;
}

/* Opens the file, or opens it again if rows are wanted that were decoded before. */
static sonject_status begin_decoding(struct report *report, struct jpeg_image *image)
{
    end_decoding(image);
    image->next_row = 0;
    errno = 0;
    FILE *file = file_open(image->path, "rb");
    if (!file)
        return input_failure(report, image->name, "cannot be opened");
    image->jpeg.err = listen(&image->listener, file);
    return read_head(image) ? SONJECT_OK : tell_fault(report, image);
}

static sonject_status take_layout(struct report *report, struct jpeg_image *image)
{
    if (image->jpeg.num_components != 1)
        return input_failure(report, image->name,
                             "has %d channels; sonject reads 1 (amplitude) or 2 (real, imaginary); "
                             "convert it to one channel first",
                             image->jpeg.num_components);
    image->layout = (struct raster_layout){.rows = image->jpeg.output_height,
                                           .columns = image->jpeg.output_width,
                                           .channels = 1,
                                           .type = PIXEL_UINT8};
    image->row = allocate_array(1, (size_t)image->layout.columns);
    CHECK_MEMORY(report, image->row, image->name);
    return SONJECT_OK;
}

/* Finds the quality whose table, as libjpeg scales its own, differs least from the file's. Must run
 * before all rows are decoded, because libjpeg then forgets the table. */
static bool take_quality(struct jpeg_image *image, int *nearest)
{
    const JQUANT_TBL *table = image->jpeg.quant_tbl_ptrs[image->jpeg.comp_info->quant_tbl_no];
    volatile double least = QUALITY_DIFFERENCE * DCTSIZE2; /* setjmp would leave others unknown */
    *nearest = JPEG_QUALITY_UNTOLD;
    image->scaled.err = image->jpeg.err;
    if (setjmp(image->listener.back) != 0)
        return false;
    jpeg_create_compress(&image->scaled);
    image->scaled.in_color_space = JCS_GRAYSCALE;
    image->scaled.input_components = 1;
    jpeg_set_defaults(&image->scaled);
    for (int quality = 100; quality > 0; quality--) {
        double sum = 0.0;
        jpeg_set_quality(&image->scaled, quality, TRUE);
        const UINT16 *usual = image->scaled.quant_tbl_ptrs[0]->quantval;
        for (size_t i = 0; i < DCTSIZE2; i++)
            sum += abs((int)usual[i] - (int)table->quantval[i]) / (double)usual[i];
        if (sum < least) {
            least = sum;
            *nearest = quality;
        }
    }
    return true;
}

/* Decodes rows up to the region's end. Copies the region's pixels unless pixels is NULL. */
static bool decode_region(struct jpeg_image *image, const struct region *region,
                          unsigned char *pixels)
{
    if (setjmp(image->listener.back) != 0)
        return false;
    for (; image->next_row < region->first_row + region->rows; image->next_row++) {
        jpeg_read_scanlines(&image->jpeg, &image->row, 1);
        if (pixels && image->next_row >= region->first_row)
            memcpy(pixels + (size_t)((image->next_row - region->first_row) * region->columns),
                   image->row + region->first_column, (size_t)region->columns);
    }
    if (image->next_row == image->layout.rows)
        jpeg_finish_decompress(&image->jpeg); /* warns of surplus bytes */
    return true;
}

static sonject_status check_exif(struct report *report, const struct jpeg_image *image)
{
    for (jpeg_saved_marker_ptr marker = image->jpeg.marker_list; marker; marker = marker->next)
        if (marker->marker == EXIF_MARKER && marker->data_length > EXIF_HEAD &&
            memcmp(marker->data, "Exif\0", EXIF_HEAD) == 0)
            CHECK(image_check_exif(report, image->name, marker->data + EXIF_HEAD,
                                   marker->data_length - EXIF_HEAD));
    return SONJECT_OK;
}

static sonject_status take_description(struct report *report, const struct jpeg_image *image,
                                       char **description)
{
    jpeg_saved_marker_ptr comment = image->jpeg.marker_list;
    while (comment && comment->marker != JPEG_COM)
        comment = comment->next;
    const size_t bytes = comment ? comment->data_length : 0;
    *description = allocate_array(bytes + 1, 1);
    CHECK_MEMORY(report, *description, image->name);
    if (bytes > 0)
        memcpy(*description, comment->data, bytes);
    return SONJECT_OK;
}

static sonject_status close_image(struct report *report, void *opened)
{
    struct jpeg_image *image = opened;
    (void)report;
    end_decoding(image);
    jpeg_destroy_compress(&image->scaled);
    free(image->row);
    free(image);
    return SONJECT_OK;
}

/* Decodes all rows, so that a file that is cut short is found at once, not after hours of work. */
static sonject_status open_image(struct report *report, const char *name, const char *path,
                                 const char *array, bool writes, void **opened,
                                 struct image_facts *facts)
{
    struct jpeg_image *image = *opened = allocate_array(1, sizeof *image);
    (void)array, (void)writes;
    CHECK_MEMORY(report, image, name);
    image->name = name;
    image->path = path;
    CHECK(begin_decoding(report, image));
    CHECK(take_layout(report, image));
    CHECK(check_exif(report, image));
    CHECK(take_description(report, image, &facts->description));
    facts->layout = image->layout;
    const struct region whole = {0, 0, image->layout.rows, image->layout.columns};
    return take_quality(image, &facts->jpeg_quality) && decode_region(image, &whole, NULL)
               ? SONJECT_OK
               : tell_fault(report, image);
}

static sonject_status read_pixels(struct report *report, void *opened, const struct region *region,
                                  void *pixels)
{
    struct jpeg_image *image = opened;
    if (region->first_row < image->next_row)
        CHECK(begin_decoding(report, image));
    return decode_region(image, region, pixels) ? SONJECT_OK : tell_fault(report, image);
}

const struct image_library jpeg_library = {open_image, close_image, read_pixels, NULL};

/* ---- New images. */

struct jpeg_output {
    const struct image_encoding *encoding;
    struct listener listener;
    struct jpeg_compress_struct jpeg;
};

static bool write_head(struct jpeg_output *output)
{
    const struct image_encoding *encoding = output->encoding;
    struct jpeg_compress_struct *jpeg = &output->jpeg;
    if (setjmp(output->listener.back) != 0)
        return false;
    jpeg_create_compress(jpeg);
    jpeg_stdio_dest(jpeg, output->listener.file);
    jpeg->image_width = (JDIMENSION)encoding->layout.columns;
    jpeg->image_height = (JDIMENSION)encoding->layout.rows;
    jpeg->input_components = (int)encoding->layout.channels;
    jpeg->in_color_space = encoding->layout.channels == 3 ? JCS_RGB : JCS_GRAYSCALE;
    jpeg_set_defaults(jpeg);
    jpeg_set_quality(jpeg, encoding->quality > 0 ? encoding->quality : FINEST_QUALITY, TRUE);
    jpeg_start_compress(jpeg, TRUE);
    if (*encoding->description)
        jpeg_write_marker(jpeg, JPEG_COM, (const JOCTET *)encoding->description,
                          (unsigned)strlen(encoding->description));
    return true;
}

static bool write_rows(void *jpeg_output, const unsigned char *rows, uint64_t count)
{
    struct jpeg_output *output = jpeg_output;
    const struct raster_layout *layout = &output->encoding->layout;
    if (setjmp(output->listener.back) != 0)
        return false;
    for (uint64_t row = 0; row < count; row++) {
        JSAMPROW pixels = (JSAMPROW)rows + row * layout->columns * layout->channels;
        jpeg_write_scanlines(&output->jpeg, &pixels, 1);
    }
    return true;
}

static bool write_end(struct jpeg_output *output)
{
    if (setjmp(output->listener.back) != 0)
        return false;
    jpeg_finish_compress(&output->jpeg);
    return true;
}

sonject_status jpeg_encode(struct report *report, const struct image_encoding *encoding)
{
    struct jpeg_output output = {.encoding = encoding};
    bool is_written = false;
    sonject_status status = SONJECT_OK;
    if (strlen(encoding->description) > COMMENT_MAX)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: JPEG keeps no more than %d bytes of notes: write .tif or .png",
                              encoding->name, COMMENT_MAX);
    errno = 0;
    FILE *file = file_open(encoding->path, "wb");
    output.jpeg.err = listen(&output.listener, file);
    output.listener.fault.error = errno;
    if (file && write_head(&output))
        status = encode_rows(report, encoding, write_rows, &output, &is_written);
    is_written = is_written && status == SONJECT_OK && write_end(&output);
    jpeg_destroy_compress(&output.jpeg);
    return encoding_end(report, encoding, file, &output.listener.fault, is_written, status);
}
