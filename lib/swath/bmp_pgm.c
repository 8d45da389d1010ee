/* BMP and PGM (P5), grey of 8 bits: a head, and then rows of plain bytes. Neither has checksums, so
 * a file is taken only if it is as long as its head says. */
#include "swath/image_library.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#define HEAD_MAX 8192 /* bytes, comments among them */
#define BMP_HEAD 54   /* bytes that all of Windows' versions have */
#define LEVELS   256  /* of grey */
#define SIDE_MAX ((uint64_t)1 << 31)

struct grey_image {
    const char *name; /* in messages */
    FILE *file;
    struct raster_layout layout;
    uint64_t place, row_bytes; /* of the first row in the file, and from one to the next */
    bool is_upside_down;       /* the last row comes first */
    uint8_t levels[LEVELS];    /* what the file's numbers are */
};

/* The beginning of a file, with a 0 behind it. */
struct head {
    char text[HEAD_MAX + 1];
    uint64_t file_bytes;
};

static sonject_status check_file_length(struct report *report, const struct grey_image *image,
                                        const struct head *head)
{
    const uint64_t rows = image->layout.rows;
    if (head->file_bytes < image->place ||
        (head->file_bytes - image->place) / image->row_bytes < rows)
        return input_failure(report, image->name, "is cut short: copy it again");
    if (head->file_bytes - image->place != rows * image->row_bytes)
        return input_failure(
            report, image->name,
            "is longer than its head says, so one of the two is wrong: write it anew");
    return SONJECT_OK;
}

/* The levels of four bytes each: blue, green, red, and one that means nothing. False: colours. */
static bool take_levels(struct grey_image *image, const unsigned char *palette)
{
    for (size_t i = 0; i < LEVELS; i++, palette += 4) {
        if (palette[0] != palette[1] || palette[0] != palette[2])
            return false;
        image->levels[i] = palette[0];
    }
    return true;
}

static sonject_status take_bmp(struct report *report, struct grey_image *image,
                               const struct head *head)
{
    const unsigned char *bytes = (const unsigned char *)head->text;
    const int64_t columns = (int32_t)(uint32_t)number_from_bytes(bytes + 18, 4, false);
    const int64_t height = (int32_t)(uint32_t)number_from_bytes(bytes + 22, 4, false);
    const uint64_t image_head = number_from_bytes(bytes + 14, 4, false);
    const uint64_t levels = number_from_bytes(bytes + 46, 4, false);
    image->place = number_from_bytes(bytes + 10, 4, false);
    if (head->file_bytes < BMP_HEAD)
        return input_failure(report, image->name, "is cut short: copy it again");
    if (columns <= 0 || height == 0 || image_head < BMP_HEAD - 14)
        return input_failure(report, image->name,
                             "is damaged, or older than Windows 3: write it anew");
    if (number_from_bytes(bytes + 28, 2, false) != 8 ||
        number_from_bytes(bytes + 30, 4, false) != 0 || (levels != 0 && levels != LEVELS) ||
        image->place != 14 + image_head + 4 * LEVELS || image->place > HEAD_MAX ||
        !take_levels(image, bytes + 14 + image_head))
        return input_failure(report, image->name,
                             "is not a plain grey image: write it as 8 bit grey of 256 levels "
                             "without compression");
    image->layout.columns = (uint64_t)columns;
    image->layout.rows = (uint64_t)(height < 0 ? -height : height);
    image->is_upside_down = height > 0;
    image->row_bytes = ((uint64_t)columns + 3) / 4 * 4;
    return check_file_length(report, image, head);
}

static bool is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* The next number, behind blanks and comments from # to the line's end. False: there is none. */
static bool take_number(const char **at, double *number)
{
    for (; is_blank(**at) || **at == '#'; ++*at)
        if (**at == '#')
            *at += strcspn(*at, "\n\r");
    return text_to_number(*at, number, at);
}

static sonject_status take_pgm(struct report *report, struct grey_image *image,
                               const struct head *head)
{
    double columns = 0.0;
    double rows = 0.0;
    double largest = 0.0;
    const char *at = head->text + 2;
    if (!take_number(&at, &columns) || !take_number(&at, &rows) || !take_number(&at, &largest) ||
        !is_blank(*at) || !(columns >= 1.0 && columns < (double)SIDE_MAX) ||
        !(rows >= 1.0 && rows < (double)SIDE_MAX))
        return input_failure(report, image->name, "is damaged: its head does not tell its size");
    if (largest != LEVELS - 1.0)
        return input_failure(report, image->name,
                             "is no PGM of 8 bits (largest number 255): write it as TIFF");
    for (size_t i = 0; i < LEVELS; i++)
        image->levels[i] = (uint8_t)i;
    image->layout.columns = image->row_bytes = (uint64_t)columns;
    image->layout.rows = (uint64_t)rows;
    image->place = (uint64_t)(at + 1 - head->text);
    return check_file_length(report, image, head);
}

static sonject_status close_image(struct report *report, void *opened)
{
    struct grey_image *image = opened;
    (void)report;
    if (image->file)
        fclose(image->file);
    free(image);
    return SONJECT_OK;
}

static sonject_status read_head(struct report *report, const char *path, struct grey_image *image)
{
    struct head head = {"", 0};
    image->file = byte_file_open(path, &head.file_bytes);
    if (!image->file)
        return file_refuse(report, image->name, errno);
    errno = 0;
    (void)fread(head.text, 1, HEAD_MAX, image->file);
    if (ferror(image->file))
        return file_failure(report, image->name, "read", errno);
    image->layout = (struct raster_layout){.channels = 1, .type = PIXEL_UINT8};
    return head.text[0] == 'B' ? take_bmp(report, image, &head) : take_pgm(report, image, &head);
}

static sonject_status open_image(struct report *report, const char *name, const char *path,
                                 const char *array, bool writes, void **opened,
                                 struct image_facts *facts)
{
    struct grey_image *image = *opened = allocate_array(1, sizeof *image);
    (void)array, (void)writes;
    CHECK_MEMORY(report, image, name);
    image->name = name;
    const sonject_status status = read_head(report, path, image);
    facts->layout = image->layout;
    return status;
}

static sonject_status read_pixels(struct report *report, void *opened, const struct region *region,
                                  void *pixels)
{
    struct grey_image *image = opened;
    uint8_t *at = pixels;
    for (uint64_t i = 0; i < region->rows; i++, at += region->columns) {
        const uint64_t row = region->first_row + i;
        const uint64_t stored = image->is_upside_down ? image->layout.rows - 1 - row : row;
        errno = 0;
        if (!byte_file_read(image->file,
                            image->place + stored * image->row_bytes + region->first_column, at,
                            (size_t)region->columns))
            return input_failure(report, image->name, "cut short or damaged at row %llu",
                                 (unsigned long long)row);
        for (uint64_t column = 0; column < region->columns; column++)
            at[column] = image->levels[at[column]];
    }
    return SONJECT_OK;
}

const struct image_library bmp_pgm_library = {open_image, close_image, read_pixels, NULL};
