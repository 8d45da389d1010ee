#include "io/fits_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "io/byte_file.h"
#include "io/fits_sums.h"

#define BLOCKS_MAX 1000 /* of a header: 36000 cards */
#define SIDE_MAX   2147483647.0
#define OFFSET_16  32768.0 /* which files add to signed numbers, since FITS has no unsigned ones */

static const char first_card[] = "SIMPLE  =";

/* What a header says: NaN where it says nothing that is a number. */
struct header {
    double bits, axes, columns, rows, planes, zero, scale, blank;
    bool is_ended;
};

bool fits_begins(const unsigned char *bytes, size_t count)
{
    return count >= sizeof first_card - 1 && memcmp(bytes, first_card, sizeof first_card - 1) == 0;
}

static sonject_status refuse(struct report *report, const struct sample_rows *rows,
                             const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", rows->path, what);
}

/* The number that stands behind a card's "= "; NaN if it is none. */
static double number_of_card(const char *card)
{
    char text[FITS_CARD_BYTES];
    const char *rest;
    double number;
    memcpy(text, card + 10, FITS_CARD_BYTES - 10);
    text[FITS_CARD_BYTES - 10] = '\0';
    if (!text_to_number(text + strspn(text, " "), &number, &rest))
        return NAN;
    rest += strspn(rest, " ");
    return *rest == '\0' || *rest == '/' ? number : NAN;
}

static void take_card(struct header *header, const char *card)
{
    const struct {
        const char *name;
        double *number;
    } numbers[] = {{"BITPIX  ", &header->bits},    {"NAXIS   ", &header->axes},
                   {"NAXIS1  ", &header->columns}, {"NAXIS2  ", &header->rows},
                   {"NAXIS3  ", &header->planes},  {"BZERO   ", &header->zero},
                   {"BSCALE  ", &header->scale},   {"BLANK   ", &header->blank}};
    header->is_ended = memcmp(card, "END     ", 8) == 0;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (memcmp(card, numbers[i].name, 8) == 0 && memcmp(card + 8, "= ", 2) == 0)
            *numbers[i].number = number_of_card(card);
}

/* Says where the numbers begin, too. */
static bool read_cards(struct sample_rows *rows, struct header *header)
{
    char block[FITS_BLOCK_BYTES];
    for (int i = 0; i < BLOCKS_MAX && !header->is_ended; i++) {
        if (!byte_file_read(rows->file, rows->first_place, block, sizeof block))
            return false;
        rows->first_place += sizeof block;
        for (size_t card = 0; card < sizeof block && !header->is_ended; card += FITS_CARD_BYTES)
            take_card(header, block + card);
    }
    return header->is_ended;
}

static bool is_number(double number, double wanted)
{
    return number >= wanted && number <= wanted;
}

static bool is_side(double number)
{
    return number >= 1.0 && number <= SIDE_MAX && floor(number) >= number;
}

static sonject_status take_samples(struct report *report, const struct header *header,
                                   struct sample_rows *rows)
{
    const bool has_offset = is_number(header->bits, 16.0) && is_number(header->zero, OFFSET_16);
    rows->layout.channels = 1;
    rows->is_big_endian = true;
    if (!is_number(header->scale, 1.0) || (!has_offset && !is_number(header->zero, 0.0)))
        return refuse(report, rows,
                      "says that its numbers are scaled (BSCALE, BZERO): write it without a scale");
    if (!isnan(header->blank) && header->bits > 0.0)
        return refuse(report, rows,
                      "says that samples of one number mean none (BLANK): write it without them");
    if (is_number(header->bits, 8.0)) {
        rows->layout.type = PIXEL_UINT8;
    } else if (is_number(header->bits, 16.0)) {
        rows->layout.type = PIXEL_UINT16;
        rows->is_offset = has_offset;
        rows->largest = has_offset ? 0 : INT16_MAX;
        rows->above_is_negative = true;
    } else if (is_number(header->bits, -32.0)) {
        rows->layout.type = PIXEL_FLOAT32;
    } else {
        return refuse(report, rows,
                      "has numbers of a type that sonject does not read: write 8 or 16 bit whole "
                      "numbers or 32 bit floating point (BITPIX 8, 16 or -32)");
    }
    return SONJECT_OK;
}

static sonject_status put_sums_right(struct report *report, const struct sample_rows *rows,
                                     FILE *copy, const char *path)
{
    return fits_sums_update(report, rows->file, copy, rows->first_place,
                            rows->row_bytes * rows->layout.rows, rows->path, path);
}

static sonject_status read_header(struct report *report, struct sample_rows *rows)
{
    struct header header = {NAN, NAN, NAN, NAN, NAN, 0.0, 1.0, NAN, false};
    size_t bytes = 0;
    if (!read_cards(rows, &header))
        return refuse(report, rows, "is cut short or damaged: its header does not end");
    if (isnan(header.bits) || isnan(header.axes))
        return refuse(report, rows, "is damaged: its header lacks BITPIX or NAXIS");
    const bool is_plane = is_number(header.axes, 2.0) ||
                          (is_number(header.axes, 3.0) && is_number(header.planes, 1.0));
    if (!is_plane || !is_side(header.columns) || !is_side(header.rows))
        return refuse(report, rows,
                      "has no image of rows and columns in its first part: write one there");
    rows->layout.columns = (uint64_t)header.columns;
    rows->layout.rows = (uint64_t)header.rows;
    const sonject_status status = take_samples(report, &header, rows);
    if (status != SONJECT_OK)
        return status;
    const struct region whole = {0, 0, rows->layout.rows, rows->layout.columns};
    if (!region_bytes(&rows->layout, &whole, &bytes) || rows->first_place > rows->file_bytes ||
        rows->file_bytes - rows->first_place < bytes)
        return refuse(report, rows, "is cut short: copy it again");
    rows->row_bytes = bytes / rows->layout.rows;
    rows->finish_copy = put_sums_right;
    return SONJECT_OK;
}

sonject_status fits_file_open(struct report *report, const char *path, struct sample_rows *rows)
{
    return sample_rows_open(report, path, read_header, rows);
}
