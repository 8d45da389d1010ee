#include "swath/image_head.h"

#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "swath/swath_format.h"

#define EXIF_ENTRY       12 /* bytes of a tag */
#define EXIF_ORIENTATION 0x0112

struct beginning {
    enum image_kind kind;
    const char *bytes;
    size_t count;
};

static const struct beginning beginnings[] = {
    {IMAGE_TIFF, "II\x2A\0", 4}, {IMAGE_TIFF, "MM\0\x2A", 4}, {IMAGE_TIFF, "II\x2B\0", 4},
    {IMAGE_TIFF, "MM\0\x2B", 4}, {IMAGE_PNG, "\x89PNG", 4},   {IMAGE_JPEG, "\xFF\xD8\xFF", 3}};

/* Formats that users may have at hand but sonject does not read. */
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
    {"a PGM", "P2", 2},
    {"a PGM", "P5", 2},
    {"a BMP", "BM", 2},
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
                                 "to one of these, such as TIFF or PNG",
                                 foreign_kinds[i].name, readable);
    return input_failure(report, path,
                         "is %s; sonject reads %s: convert it to one of these, such as TIFF or PNG",
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

sonject_status image_check_upright(struct report *report, const char *path, uint64_t orientation)
{
    if (orientation < 2 || orientation > 8)
        return SONJECT_OK;
    return input_failure(report, path,
                         "is turned or mirrored by viewers, as its orientation tag (%u) says, and "
                         "masks would not lie on it: write it upright, without the tag",
                         (unsigned)orientation);
}

sonject_status image_check_exif(struct report *report, const char *path, const unsigned char *tiff,
                                size_t count)
{
    if (count < 10)
        return SONJECT_OK;
    const bool is_big_endian = tiff[0] == 'M';
    size_t place = (size_t)number_from_bytes(tiff + 4, 4, is_big_endian);
    if (place > count - 2)
        return SONJECT_OK;
    uint64_t entries = number_from_bytes(tiff + place, 2, is_big_endian);
    for (place += 2; entries > 0 && count - place >= EXIF_ENTRY; entries--, place += EXIF_ENTRY)
        if (number_from_bytes(tiff + place, 2, is_big_endian) == EXIF_ORIENTATION)
            return image_check_upright(report, path,
                                       number_from_bytes(tiff + place + 8, 2, is_big_endian));
    return SONJECT_OK;
}
