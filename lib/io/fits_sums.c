#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "io/fits_sums.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "base/file.h"
#include "io/byte_file.h"
#include "io/byte_order.h"

#define TEXT_PLACE  11 /* of a text's first letter in its card, behind the quote */
#define CODE_BYTES  16
#define LETTERS_MIN 8                    /* of a text, blanks among them */
#define RIGHT_SUM   UINT32_C(0xFFFFFFFF) /* of the words of all, with CHECKSUM */

/* Of a file's header and numbers; places of the cards, 0 where there is none. */
struct sums {
    uint64_t data_card, code_card;
    uint32_t header, data;
};

/* Ones' complement: what is carried out comes in again. */
static uint32_t add_sums(uint32_t a, uint32_t b)
{
    const uint64_t sum = (uint64_t)a + b;
    return (uint32_t)(sum & RIGHT_SUM) + (uint32_t)(sum >> 32);
}

/* Blocks; those of which the end is missing are as if filled with zeros. */
static uint32_t sum_blocks(FILE *file, uint64_t place, uint64_t bytes)
{
    unsigned char block[FITS_BLOCK_BYTES];
    uint32_t sum = 0;
    bool is_good = fseeko(file, (off_t)place, SEEK_SET) == 0;
    for (uint64_t at = 0; is_good && at < bytes; at += sizeof block) {
        memset(block, 0, sizeof block);
        is_good = fread(block, 1, sizeof block, file) == sizeof block;
        for (size_t i = 0; i < sizeof block; i += 4)
            sum = add_sums(sum, (uint32_t)number_from_bytes(block + i, 4, true));
    }
    return sum;
}

static void find_cards(FILE *file, uint64_t header_bytes, struct sums *sums)
{
    char card[FITS_CARD_BYTES];
    memset(sums, 0, sizeof *sums);
    for (uint64_t place = 0; place < header_bytes; place += sizeof card) {
        if (!byte_file_read(file, place, card, sizeof card) || memcmp(card, "END     ", 8) == 0)
            return;
        if (memcmp(card, "DATASUM = '", TEXT_PLACE) == 0 && card[TEXT_PLACE] >= '0' &&
            card[TEXT_PLACE] <= '9')
            sums->data_card = place;
        if (memcmp(card, "CHECKSUM= '", TEXT_PLACE) == 0 && card[TEXT_PLACE + CODE_BYTES] == '\'')
            sums->code_card = place;
    }
}

static bool data_sum_is_right(FILE *file, const struct sums *sums)
{
    char card[FITS_CARD_BYTES];
    uint64_t number = 0;
    size_t i = TEXT_PLACE;
    if (sums->data_card == 0)
        return true;
    if (!byte_file_read(file, sums->data_card, card, sizeof card))
        return false;
    for (; i < sizeof card && card[i] >= '0' && card[i] <= '9' && number <= RIGHT_SUM; i++)
        number = 10 * number + (uint64_t)(card[i] - '0');
    return number == sums->data;
}

static bool is_blank(const char *text, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (text[i] != ' ')
            return false;
    return true;
}

/* The number in the card's text; what stands behind the text stays where there is room. */
static void put_number(char *card, uint32_t number)
{
    char digits[12];
    const size_t count = (size_t)snprintf(digits, sizeof digits, "%lu", (unsigned long)number);
    const size_t least = TEXT_PLACE + (count < LETTERS_MIN ? LETTERS_MIN : count);
    const char *quote = memchr(card + TEXT_PLACE, '\'', FITS_CARD_BYTES - TEXT_PLACE);
    size_t end = quote ? (size_t)(quote - card) : 0;
    const bool has_room = end >= least || (quote && is_blank(card + end + 1, least - end));
    end = end < least ? least : end;
    memset(card + TEXT_PLACE, ' ', (has_room ? end : FITS_CARD_BYTES) - TEXT_PLACE);
    memcpy(card + TEXT_PLACE, digits, count);
    card[end] = '\'';
}

static bool is_sign(unsigned letter)
{
    return (letter > '9' && letter < 'A') || (letter > 'Z' && letter < 'a');
}

/* Letters and digits that add to the number what as many zeros do not. */
static void encode(uint32_t number, char code[CODE_BYTES])
{
    for (size_t i = 0; i < 4; i++) {
        const unsigned byte = number >> (24 - 8 * i) & 0xFF;
        unsigned letters[4] = {'0' + byte / 4 + byte % 4, '0' + byte / 4, '0' + byte / 4,
                               '0' + byte / 4};
        for (size_t pair = 0; pair < 4; pair += 2)
            while (is_sign(letters[pair]) || is_sign(letters[pair + 1])) {
                letters[pair]++;
                letters[pair + 1]--;
            }
        for (size_t j = 0; j < 4; j++) /* a card's text begins with the last byte of a word */
            code[(4 * j + i + 1) % CODE_BYTES] = (char)letters[j];
    }
}

static bool put(FILE *file, uint64_t place, const char *bytes, size_t count)
{
    return fseeko(file, (off_t)place, SEEK_SET) == 0 && fwrite(bytes, 1, count, file) == count;
}

static bool update(FILE *copy, const struct sums *sums, uint64_t header_bytes, uint64_t data_bytes)
{
    char card[FITS_CARD_BYTES];
    char code[CODE_BYTES];
    const uint64_t place = sums->code_card + TEXT_PLACE;
    const uint32_t data = sum_blocks(copy, header_bytes, data_bytes);
    if (ferror(copy))
        return false;
    if (data == sums->data)
        return true; /* codes are not unique */
    if (sums->data_card > 0) {
        if (!byte_file_read(copy, sums->data_card, card, sizeof card))
            return false;
        put_number(card, data);
        if (!put(copy, sums->data_card, card, sizeof card))
            return false;
    }
    if (sums->code_card == 0)
        return true;
    memset(code, '0', sizeof code);
    if (!put(copy, place, code, sizeof code))
        return false;
    encode(~add_sums(sum_blocks(copy, 0, header_bytes), data) & RIGHT_SUM, code);
    return !ferror(copy) && put(copy, place, code, sizeof code);
}

sonject_status fits_sums_update(struct report *report, FILE *source, FILE *copy,
                                uint64_t header_bytes, uint64_t data_bytes, const char *path,
                                const char *name)
{
    struct sums sums;
    find_cards(source, header_bytes, &sums);
    if (ferror(source))
        return file_failure(report, path, "read", errno);
    if (sums.data_card == 0 && sums.code_card == 0)
        return SONJECT_OK;
    sums.header = sum_blocks(source, 0, header_bytes);
    sums.data = sum_blocks(source, header_bytes, data_bytes);
    if (!data_sum_is_right(source, &sums) ||
        (sums.code_card > 0 && add_sums(sums.header, sums.data) != RIGHT_SUM))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is damaged: its sums (DATASUM, CHECKSUM) are those of other "
                              "bytes: copy it again",
                              path);
    errno = 0;
    return update(copy, &sums, header_bytes, data_bytes)
               ? SONJECT_OK
               : file_failure(report, name, "write", errno != 0 ? errno : EIO);
}
