#include "swath/jpeg_quality.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define ENTRIES    64
#define TABLES     4
#define DIFFERENCE 0.2 /* of entries, in the mean, up to which a table is close */

/* The example of ITU-T T.81, table K.1, in the order of the file, zigzag. */
static const uint8_t luminance[ENTRIES] = {
    16, 11, 12,  14,  12,  10, 16, 14,  13,  14,  18,  17,  16, 19,  24,  40,
    26, 24, 22,  22,  24,  49, 35, 37,  29,  40,  58,  51,  61, 60,  57,  51,
    56, 55, 64,  72,  92,  78, 64, 68,  87,  69,  55,  56,  80, 109, 81,  87,
    95, 98, 103, 104, 103, 62, 77, 113, 121, 112, 100, 120, 92, 101, 103, 99};

static int entry_at(int quality, size_t i)
{
    const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
    const int entry = (luminance[i] * scale + 50) / 100;
    return entry < 1 ? 1 : entry > 255 ? 255 : entry;
}

/* The quality whose table differs least. */
static int nearest_quality(const uint16_t table[ENTRIES])
{
    int nearest = JPEG_QUALITY_UNTOLD;
    double least = DIFFERENCE * ENTRIES;
    for (int quality = 100; quality > 0; quality--) {
        double sum = 0.0;
        for (size_t i = 0; i < ENTRIES; i++)
            sum += abs(entry_at(quality, i) - (int)table[i]) / (double)entry_at(quality, i);
        if (sum < least) {
            least = sum;
            nearest = quality;
        }
    }
    return nearest;
}

/* Tables of a segment, each behind a byte with its size and number. */
static void take_tables(const uint8_t *bytes, size_t count, uint16_t tables[TABLES][ENTRIES])
{
    for (size_t at = 0; at < count;) {
        const size_t wide = bytes[at] >> 4 ? 2 : 1;
        const size_t number = bytes[at++] & 15;
        if (number >= TABLES || count - at < wide * ENTRIES)
            return;
        for (size_t i = 0; i < ENTRIES; i++, at += wide)
            tables[number][i] = (uint16_t)(wide == 2 ? bytes[at] << 8 | bytes[at + 1] : bytes[at]);
    }
}

/* Whether a segment is a frame's head, which says the table of each component. */
static bool is_frame(int mark)
{
    return mark >= 0xC0 && mark <= 0xCF && mark != 0xC4 && mark != 0xC8 && mark != 0xCC;
}

int jpeg_quality(const char *path)
{
    uint16_t tables[TABLES][ENTRIES] = {{0}};
    static const size_t place_of_table = 8; /* of the first component, in a frame's head */
    uint8_t bytes[65536];
    int quality = 0;
    size_t number = 0;
    FILE *file = fopen(path, "rb");
    if (file && fread(bytes, 1, 2, file) == 2 && bytes[0] == 0xFF && bytes[1] == 0xD8)
        quality = JPEG_QUALITY_UNTOLD;
    while (quality > 0 && fread(bytes, 1, 4, file) == 4 && bytes[0] == 0xFF && bytes[1] != 0xDA) {
        const int mark = bytes[1];
        const size_t count = (size_t)(bytes[2] << 8 | bytes[3]);
        if (count < 2 || fread(bytes, 1, count - 2, file) != count - 2)
            break;
        if (mark == 0xDB)
            take_tables(bytes, count - 2, tables);
        else if (is_frame(mark) && count - 2 > place_of_table)
            number = bytes[place_of_table] % TABLES;
    }
    if (quality > 0 && tables[number][0] > 0)
        quality = nearest_quality(tables[number]);
    if (file)
        fclose(file);
    return quality;
}
