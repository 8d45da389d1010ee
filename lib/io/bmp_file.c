#include "io/bmp_file.h"

#include <stdlib.h>

#include "io/byte_file.h"
#include "io/byte_order.h"

#define FILE_HEAD_BYTES  14
#define IMAGE_HEAD_BYTES 40 /* of the oldest head that tells all of it; later ones are longer */
#define HEAD_BYTES       (FILE_HEAD_BYTES + IMAGE_HEAD_BYTES)
#define IMAGE_HEAD_MAX   1024
#define LEVELS           256
#define LEVEL_BYTES      4

bool bmp_begins(const unsigned char *bytes, size_t count)
{
    /* bytes 6 to 9 are reserved, and the image's head follows those of the file */
    return count >= 16 && bytes[0] == 'B' && bytes[1] == 'M' &&
           number_from_bytes(bytes + 6, 4, false) == 0;
}

static sonject_status refuse(struct report *report, const struct sample_rows *rows,
                             const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", rows->path, what);
}

static uint64_t word_at(const unsigned char *head, size_t place, size_t bytes)
{
    return number_from_bytes(head + place, bytes, false);
}

/* The palette gives each level its own grey. levels: as the file says; 0 means all. */
static bool is_grey(const struct sample_rows *rows, uint64_t place, uint64_t levels)
{
    unsigned char palette[LEVELS * LEVEL_BYTES];
    if (levels == 0)
        levels = LEVELS;
    if (levels < 2 || levels > LEVELS ||
        !byte_file_read(rows->file, place, palette, (size_t)levels * LEVEL_BYTES))
        return false;
    for (size_t i = 0; i < levels; i++)
        for (size_t colour = 0; colour < 3; colour++)
            if (palette[i * LEVEL_BYTES + colour] != i)
                return false;
    return true;
}

static sonject_status read_header(struct report *report, struct sample_rows *rows)
{
    unsigned char head[HEAD_BYTES];
    size_t bytes = 0;
    if (!byte_file_read(rows->file, 0, head, sizeof head))
        return refuse(report, rows, "is cut short: copy it again");
    const uint64_t head_bytes = word_at(head, 14, 4);
    const int64_t width = (int32_t)(uint32_t)word_at(head, 18, 4);
    const int64_t height = (int32_t)(uint32_t)word_at(head, 22, 4);
    const uint64_t levels = word_at(head, 46, 4);
    const uint64_t palette_place = FILE_HEAD_BYTES + head_bytes;
    if (head_bytes < IMAGE_HEAD_BYTES || head_bytes > IMAGE_HEAD_MAX || width <= 0 || height == 0)
        return refuse(report, rows, "is damaged, or older than Windows 3: write it anew");
    if (word_at(head, 28, 2) != 8 || word_at(head, 30, 4) != 0 ||
        !is_grey(rows, palette_place, levels))
        return refuse(report, rows,
                      "is not a plain grey image: write it as 8 bit grey without compression");
    rows->layout.columns = (uint64_t)width;
    rows->layout.rows = (uint64_t)(height < 0 ? -height : height);
    rows->layout.channels = 1;
    rows->layout.type = PIXEL_UINT8;
    rows->is_upside_down = height > 0;
    rows->largest = levels > 0 ? (uint32_t)levels - 1 : 0;
    rows->row_bytes = (rows->layout.columns + 3) / 4 * 4;
    rows->first_place = word_at(head, 10, 4);
    if (rows->first_place < palette_place + LEVEL_BYTES * (levels > 0 ? levels : LEVELS))
        return refuse(report, rows, "is damaged: its pixels begin within its head");
    const struct region whole = {0, 0, rows->layout.rows, rows->row_bytes};
    const struct raster_layout stored = {rows->layout.rows, rows->row_bytes, 1, PIXEL_UINT8};
    if (!region_bytes(&stored, &whole, &bytes) || rows->first_place > rows->file_bytes ||
        rows->file_bytes - rows->first_place < bytes)
        return refuse(report, rows, "is cut short: copy it again");
    return SONJECT_OK;
}

sonject_status bmp_file_open(struct report *report, const char *path, struct sample_rows *rows)
{
    return sample_rows_open(report, path, read_header, rows);
}
