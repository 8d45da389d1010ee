#include "io/pnm_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "io/byte_file.h"

#define HEADER_MAX 8192 /* bytes, comments among them */
#define SIDE_MAX   (UINT64_C(1) << 31)

/* A header that is being read; text ends with a 0. */
struct header {
    char text[HEADER_MAX + 1];
    const char *at;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

bool pnm_begins(const unsigned char *bytes, size_t count)
{
    return count >= 3 && bytes[0] == 'P' && (bytes[1] == '5' || bytes[1] == 'f') &&
           (is_blank((char)bytes[2]) || bytes[2] == '#');
}

/* Blanks, and comments from # to the line's end. */
static void skip_blanks(struct header *header)
{
    for (;;) {
        if (is_blank(*header->at)) {
            header->at++;
        } else if (*header->at == '#') {
            while (*header->at != '\0' && *header->at != '\n' && *header->at != '\r')
                header->at++;
        } else {
            return;
        }
    }
}

static bool take_count(struct header *header, uint64_t largest, uint64_t *count)
{
    skip_blanks(header);
    if (*header->at < '0' || *header->at > '9')
        return false;
    for (*count = 0; *header->at >= '0' && *header->at <= '9'; header->at++) {
        *count = *count * 10 + (uint64_t)(*header->at - '0');
        if (*count > largest)
            return false;
    }
    return *count > 0;
}

static sonject_status refuse(struct report *report, const struct sample_rows *rows,
                             const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", rows->path, what);
}

static bool read_header_text(const struct sample_rows *rows, struct header *header)
{
    const size_t count = rows->file_bytes < HEADER_MAX ? (size_t)rows->file_bytes : HEADER_MAX;
    memset(header->text, 0, sizeof header->text);
    header->at = header->text + 2;
    return byte_file_read(rows->file, 0, header->text, count);
}

/* The largest number of a PGM, or the scale of a PFM, whose sign tells the byte order. */
static sonject_status take_samples(struct report *report, struct header *header,
                                   struct sample_rows *rows)
{
    uint64_t largest = 0;
    double scale = 0.0;
    rows->layout.channels = 1;
    if (header->text[1] == '5') {
        if (!take_count(header, 65535, &largest))
            return refuse(report, rows, "is damaged: its largest number is not one of 1 to 65535");
        rows->layout.type = largest < 256 ? PIXEL_UINT8 : PIXEL_UINT16;
        rows->largest = (uint32_t)largest;
        rows->is_big_endian = true;
        return SONJECT_OK;
    }
    skip_blanks(header);
    if (!text_to_number(header->at, &scale, &header->at) || fabs(scale) != 1.0)
        return refuse(report, rows,
                      "says that its numbers are scaled: sonject reads a scale of 1.0 or -1.0, so "
                      "write it anew");
    rows->layout.type = PIXEL_FLOAT32;
    rows->is_big_endian = scale > 0.0;
    return SONJECT_OK;
}

static sonject_status read_header(struct report *report, struct sample_rows *rows)
{
    struct header header;
    size_t bytes = 0;
    if (!read_header_text(rows, &header))
        return refuse(report, rows, "cannot be read");
    if (!take_count(&header, SIDE_MAX, &rows->layout.columns) ||
        !take_count(&header, SIDE_MAX, &rows->layout.rows))
        return refuse(report, rows, "is damaged: its header lacks width or height");
    const sonject_status status = take_samples(report, &header, rows);
    if (status != SONJECT_OK)
        return status;
    if (!is_blank(*header.at))
        return refuse(report, rows, "is damaged: its header does not end");
    rows->first_place = (uint64_t)(header.at + 1 - header.text);
    const struct region whole = {0, 0, rows->layout.rows, rows->layout.columns};
    if (!region_bytes(&rows->layout, &whole, &bytes) || rows->first_place > rows->file_bytes ||
        rows->file_bytes - rows->first_place < bytes)
        return refuse(report, rows, "is cut short: copy it again");
    rows->row_bytes = bytes / rows->layout.rows;
    rows->is_upside_down = header.text[1] == 'f';
    return SONJECT_OK;
}

sonject_status pnm_file_open(struct report *report, const char *path, struct sample_rows *rows)
{
    return sample_rows_open(report, path, read_header, rows);
}

bool pnm_file_attribute(const struct sample_rows *rows, const char *name, char *value,
                        size_t capacity)
{
    struct header header;
    const size_t length = strlen(name);
    if (!read_header_text(rows, &header))
        return false;
    if (rows->first_place < HEADER_MAX)
        header.text[rows->first_place] = '\0';
    for (const char *line = strstr(header.text, "\n# "); line; line = strstr(line, "\n# ")) {
        line += 3;
        if (strncmp(line, name, length) != 0 || line[length] != '=')
            continue;
        const char *text = line + length + 1;
        const size_t count = strcspn(text, "\r\n");
        if (count >= capacity)
            return false;
        memcpy(value, text, count);
        value[count] = '\0';
        return true;
    }
    return false;
}
