#include "swath/plain_head.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/byte_order.h"
#include "base/file.h"
#include "base/text.h"

#define HEAD_MAX 8192 /* bytes, comments among them */
#define BMP_HEAD 54   /* bytes that all of Windows' versions have */
#define LEVELS   256  /* of grey */
#define SIDE_MAX ((uint64_t)1 << 31)

/* The beginning of a file, with a 0 behind it. */
struct head {
    char text[HEAD_MAX + 1];
    uint64_t file_bytes;
};

static sonject_status refuse(struct report *report, const char *path, const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, what);
}

static sonject_status read_head(struct report *report, const char *path, struct head *head)
{
    FILE *file = byte_file_open(path, &head->file_bytes);
    memset(head->text, 0, sizeof head->text);
    if (!file)
        return file_refuse(report, path, errno);
    errno = 0;
    (void)fread(head->text, 1, HEAD_MAX, file);
    const int error = ferror(file) ? errno : 0;
    fclose(file);
    return error == 0 ? SONJECT_OK : file_failure(report, path, "read", error);
}

/* place: of the first sample. */
static sonject_status check_length(struct report *report, const char *path, const struct head *head,
                                   uint64_t place, uint64_t rows, uint64_t row_bytes)
{
    if (head->file_bytes < place || (head->file_bytes - place) / row_bytes < rows)
        return refuse(report, path, "is cut short: copy it again");
    if (head->file_bytes - place != rows * row_bytes)
        return refuse(report, path,
                      "is longer than its head says, so one of the two is wrong: write it anew");
    return SONJECT_OK;
}

sonject_status bmp_check(struct report *report, const char *path)
{
    struct head head;
    CHECK(read_head(report, path, &head));
    const unsigned char *bytes = (const unsigned char *)head.text;
    const int64_t columns = (int32_t)(uint32_t)number_from_bytes(bytes + 18, 4, false);
    const int64_t height = (int32_t)(uint32_t)number_from_bytes(bytes + 22, 4, false);
    if (head.file_bytes < BMP_HEAD)
        return refuse(report, path, "is cut short: copy it again");
    const uint64_t image_head = number_from_bytes(bytes + 14, 4, false);
    const uint64_t levels = number_from_bytes(bytes + 46, 4, false);
    const uint64_t place = number_from_bytes(bytes + 10, 4, false);
    if (columns <= 0 || height == 0 || image_head < BMP_HEAD - 14)
        return refuse(report, path, "is damaged, or older than Windows 3: write it anew");
    if (number_from_bytes(bytes + 28, 2, false) != 8 ||
        number_from_bytes(bytes + 30, 4, false) != 0 || (levels != 0 && levels != LEVELS) ||
        place != 14 + image_head + 4 * LEVELS)
        return refuse(report, path,
                      "is not a plain grey image: write it as 8 bit grey of 256 levels without "
                      "compression");
    return check_length(report, path, &head, place, (uint64_t)(height < 0 ? -height : height),
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

sonject_status pnm_check(struct report *report, const char *path)
{
    struct head head;
    double columns = 0.0;
    double rows = 0.0;
    double largest = 0.0;
    CHECK(read_head(report, path, &head));
    const char *at = head.text + 2;
    if (!take_number(&at, &columns) || !take_number(&at, &rows) || !take_number(&at, &largest) ||
        !is_blank(*at) || !(columns >= 1.0 && columns < (double)SIDE_MAX) ||
        !(rows >= 1.0 && rows < (double)SIDE_MAX))
        return refuse(report, path, "is damaged: its head does not tell its size");
    const bool is_float = head.text[1] == 'f';
    if (fabs(largest) != (is_float ? 1.0 : 255.0))
        return refuse(report, path,
                      is_float
                          ? "says that its numbers are scaled: write it with a scale of 1.0 or "
                            "-1.0"
                          : "is no PGM of 8 bits (largest number 255): write it as TIFF");
    return check_length(report, path, &head, (uint64_t)(at + 1 - head.text), (uint64_t)rows,
                        (uint64_t)columns * (is_float ? 4 : 1));
}
