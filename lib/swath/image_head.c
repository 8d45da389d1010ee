#include "swath/image_head.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/text.h"
#include "swath/swath_format.h"

#define HEAD_MAX 8192 /* bytes, comments among them */
#define BMP_HEAD 54   /* bytes that all of Windows' versions have */
#define LEVELS   256  /* of grey */
#define SIDE_MAX ((uint64_t)1 << 31)

struct beginning {
    enum image_kind kind;
    const char *bytes;
    size_t count;
};

static const struct beginning beginnings[] = {
    {IMAGE_TIFF, "II\x2A\0", 4}, {IMAGE_TIFF, "MM\0\x2A", 4}, {IMAGE_TIFF, "II\x2B\0", 4},
    {IMAGE_TIFF, "MM\0\x2B", 4}, {IMAGE_PNG, "\x89PNG", 4},   {IMAGE_JPEG, "\xFF\xD8\xFF", 3},
    {IMAGE_BMP, "BM", 2},        {IMAGE_PGM, "P5", 2}};

/* What users may have at hand that sonject does not read. */
static const struct {
    const char *name;
    const char *bytes;
    size_t count;
} foreign_kinds[] = {
    {"a DPX", "SDPX", 4},
    {"a DPX", "XPDS", 4},
    {"a GIF", "GIF8", 4},
    {"an OpenEXR", "v/1\x01", 4},
    {"a PFM", "Pf", 2},
    {"a PFM", "PF", 2},
    {"a PBM", "P4", 2},
    {"a PPM", "P6", 2},
    {"a PGM in ASCII (P2)", "P2", 2},
    {"a JPEG 2000", "\xFF\x4F\xFF\x51", 4},
    {"a JPEG 2000", "\0\0\0\x0CjP  ", 8},
    {"a FITS", "SIMPLE  =", 9},
    {"a Targa", "\0\0\x03", 3},
    {"a Targa", "\0\0\x0B", 3},
    {"a NITF", "NITF", 4},
    {"a JSF", "\x01\x16", 2},
    {"a zip or .npz", "PK\x03\x04", 4},
};

sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count)
{
#define FORMAT_FILES(name, files) ", " files
    static const char listed[] = SWATH_FORMATS(FORMAT_FILES);
    const char *readable = listed + strlen(", ");
    for (size_t i = 0; i < sizeof foreign_kinds / sizeof *foreign_kinds; i++)
        if (count >= foreign_kinds[i].count &&
            memcmp(head, foreign_kinds[i].bytes, foreign_kinds[i].count) == 0)
            return input_failure(report, path,
                                 "is %s file, which sonject does not read; it reads %s: convert it "
                                 "to one of these",
                                 foreign_kinds[i].name, readable);
    return input_failure(report, path, "is %s; sonject reads %s: convert it to one of these",
                         count == 0 ? "empty" : "of no format that sonject knows", readable);
}

bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind)
{
    for (size_t i = 0; i < sizeof beginnings / sizeof *beginnings; i++)
        if (count >= beginnings[i].count &&
            memcmp(bytes, beginnings[i].bytes, beginnings[i].count) == 0) {
            *kind = beginnings[i].kind;
            return true;
        }
    return false;
}

/* The beginning of a file, with a 0 behind it. */
struct head {
    char text[HEAD_MAX + 1];
    uint64_t file_bytes;
};

static sonject_status read_head(struct report *report, const char *name, const char *path,
                                struct head *head)
{
    FILE *file = byte_file_open(path, &head->file_bytes);
    memset(head->text, 0, sizeof head->text);
    if (!file)
        return file_refuse(report, name, errno);
    errno = 0;
    (void)fread(head->text, 1, HEAD_MAX, file);
    const int error = ferror(file) ? errno : 0;
    fclose(file);
    return error == 0 ? SONJECT_OK : file_failure(report, name, "read", error);
}

/* place: of the first sample. */
static sonject_status check_file_length(struct report *report, const char *name,
                                        const struct head *head, uint64_t place, uint64_t rows,
                                        uint64_t row_bytes)
{
    if (head->file_bytes < place || (head->file_bytes - place) / row_bytes < rows)
        return input_failure(report, name, "is cut short: copy it again");
    if (head->file_bytes - place != rows * row_bytes)
        return input_failure(
            report, name,
            "is longer than its head says, so one of the two is wrong: write it anew");
    return SONJECT_OK;
}

sonject_status bmp_check(struct report *report, const char *name, const char *path)
{
    struct head head;
    CHECK(read_head(report, name, path, &head));
    const unsigned char *bytes = (const unsigned char *)head.text;
    const int64_t columns = (int32_t)(uint32_t)number_from_bytes(bytes + 18, 4, false);
    const int64_t height = (int32_t)(uint32_t)number_from_bytes(bytes + 22, 4, false);
    const uint64_t image_head = number_from_bytes(bytes + 14, 4, false);
    const uint64_t levels = number_from_bytes(bytes + 46, 4, false);
    const uint64_t place = number_from_bytes(bytes + 10, 4, false);
    if (head.file_bytes < BMP_HEAD)
        return input_failure(report, name, "is cut short: copy it again");
    if (columns <= 0 || height == 0 || image_head < BMP_HEAD - 14)
        return input_failure(report, name, "is damaged, or older than Windows 3: write it anew");
    if (number_from_bytes(bytes + 28, 2, false) != 8 ||
        number_from_bytes(bytes + 30, 4, false) != 0 || (levels != 0 && levels != LEVELS) ||
        place != 14 + image_head + 4 * LEVELS)
        return input_failure(report, name,
                             "is not a plain grey image: write it as 8 bit grey of 256 levels "
                             "without compression");
    return check_file_length(report, name, &head, place, (uint64_t)(height < 0 ? -height : height),
                             ((uint64_t)columns + 3) / 4 * 4);
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

sonject_status pgm_check(struct report *report, const char *name, const char *path)
{
    struct head head;
    double columns = 0.0;
    double rows = 0.0;
    double largest = 0.0;
    CHECK(read_head(report, name, path, &head));
    const char *at = head.text + 2;
    if (!take_number(&at, &columns) || !take_number(&at, &rows) || !take_number(&at, &largest) ||
        !is_blank(*at) || !(columns >= 1.0 && columns < (double)SIDE_MAX) ||
        !(rows >= 1.0 && rows < (double)SIDE_MAX))
        return input_failure(report, name, "is damaged: its head does not tell its size");
    if (largest != 255.0)
        return input_failure(report, name,
                             "is no PGM of 8 bits (largest number 255): write it as TIFF");
    return check_file_length(report, name, &head, (uint64_t)(at + 1 - head.text), (uint64_t)rows,
                             (uint64_t)columns);
}
