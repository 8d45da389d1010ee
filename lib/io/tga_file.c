#include "io/tga_file.h"

#include "io/byte_file.h"
#include "io/byte_order.h"

#define KIND_PALETTE  1
#define KIND_COLOUR   2
#define KIND_GREY     3
#define KIND_CODED    8 /* added to the others where equal samples are stored as runs */
#define ALPHA_BITS    0x0F
#define FROM_RIGHT    0x10
#define FROM_TOP      0x20
#define UNUSED_BITS   0xC0
#define BITS_OF_GREY  8
#define BITS_OF_PIXEL 16 /* the place of that byte */
#define DESCRIPTOR    17

static uint64_t word_at(const unsigned char *head, size_t place)
{
    return number_from_bytes(head + place, 2, false);
}

static bool is_depth(unsigned bits)
{
    return bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

bool tga_begins(const unsigned char *bytes, size_t count)
{
    if (count < TGA_HEAD_BYTES)
        return false;
    const unsigned kind = bytes[2] & ~(unsigned)KIND_CODED;
    const bool has_palette = bytes[1] == 1;
    const bool is_plain = bytes[1] == 0 && number_from_bytes(bytes + 3, 5, false) == 0;
    const bool is_kind = kind == KIND_PALETTE ? has_palette
                                              : (kind == KIND_COLOUR || kind == KIND_GREY) &&
                                                    (is_plain || has_palette);
    return is_kind && word_at(bytes, 12) > 0 && word_at(bytes, 14) > 0 &&
           is_depth(bytes[BITS_OF_PIXEL]) && (bytes[DESCRIPTOR] & UNUSED_BITS) == 0;
}

static sonject_status refuse(struct report *report, const struct sample_rows *rows,
                             const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", rows->path, what);
}

static sonject_status read_header(struct report *report, struct sample_rows *rows)
{
    unsigned char head[TGA_HEAD_BYTES];
    if (!byte_file_read(rows->file, 0, head, sizeof head))
        return refuse(report, rows, "is cut short: copy it again");
    if (!tga_begins(head, sizeof head))
        return refuse(report, rows, "is damaged: its head is none of Targa");
    if ((head[2] & ~(unsigned)KIND_CODED) != KIND_GREY || head[1] != 0 ||
        head[BITS_OF_PIXEL] != BITS_OF_GREY || (head[DESCRIPTOR] & ALPHA_BITS) != 0)
        return refuse(report, rows,
                      "is not a plain grey Targa: write it as 8 bit grey without colours, palette "
                      "or transparency");
    if (head[2] & KIND_CODED)
        return refuse(report, rows,
                      "is coded in runs of equal samples: write it as Targa without compression "
                      "(RLE), or convert it to TIFF");
    rows->layout.columns = word_at(head, 12);
    rows->layout.rows = word_at(head, 14);
    rows->layout.channels = 1;
    rows->layout.type = PIXEL_UINT8;
    rows->is_reversed = (head[DESCRIPTOR] & FROM_RIGHT) != 0;
    rows->is_upside_down = (head[DESCRIPTOR] & FROM_TOP) == 0;
    rows->row_bytes = rows->layout.columns;
    rows->first_place = TGA_HEAD_BYTES + (uint64_t)head[0]; /* behind a note of so many bytes */
    if (rows->first_place > rows->file_bytes ||
        rows->file_bytes - rows->first_place < rows->layout.rows * rows->row_bytes)
        return refuse(report, rows, "is cut short: copy it again");
    return SONJECT_OK;
}

sonject_status tga_file_open(struct report *report, const char *path, struct sample_rows *rows)
{
    return sample_rows_open(report, path, read_header, rows);
}
