#include "swath/image_kind.h"

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/file.h"

struct beginning {
    enum image_kind kind;
    unsigned char bytes[8];
    size_t count;
};

/* What users may have at hand that sonject does not read. */
struct foreign {
    const char *name;
    const char *bytes;
    size_t place, count;
};

static const struct foreign foreign_kinds[] = {
    {"a DPX", "SDPX", 0, 4},
    {"a DPX", "XPDS", 0, 4},
    {"a Cineon", "\x80\x2A\x5F\xD7", 0, 4},
    {"a PSD", "8BPS", 0, 4},
    {"a GIF", "GIF8", 0, 4},
    {"a WebP", "WEBP", 8, 4},
    {"a Radiance", "#?RADIANCE", 0, 10},
    {"a Radiance", "#?RGBE", 0, 6},
    {"an SGI", "\x01\xDA", 0, 2},
    {"an IFF", "FOR4", 0, 4},
    {"a DDS", "DDS ", 0, 4},
    {"a Softimage", "\x53\x80\xF6\x34", 0, 4},
    {"a HEIF", "ftyphei", 4, 7},
    {"a HEIF", "ftypmif1", 4, 8},
    {"a colour PFM", "PF\n", 0, 3},
    {"a PBM", "P4", 0, 2},
    {"a PPM", "P6", 0, 2},
    {"a PGM in ASCII (P2)", "P2", 0, 2},
    {"a JPEG 2000", "\xFF\x4F\xFF\x51", 0, 4},
    {"a JPEG 2000", "jP  ", 4, 4},
    {"a FITS", "SIMPLE  =", 0, 9},
    {"a Targa", "\0\0\x03", 0, 3},
    {"a Targa", "\0\0\x0B", 0, 3},
    {"a NITF", "NITF", 0, 4},
    {"a JSF", "\x01\x16", 0, 2},
    {"a zip or .npz", "PK\x03\x04", 0, 4},
};

static const struct beginning beginnings[] = {{IMAGE_TIFF, {'I', 'I', 42, 0}, 4},
                                              {IMAGE_TIFF, {'M', 'M', 0, 42}, 4},
                                              {IMAGE_TIFF, {'I', 'I', 43, 0}, 4},
                                              {IMAGE_TIFF, {'M', 'M', 0, 43}, 4},
                                              {IMAGE_PNG, {0x89, 'P', 'N', 'G'}, 4},
                                              {IMAGE_JPEG, {0xFF, 0xD8, 0xFF, 0}, 3},
                                              {IMAGE_OPENEXR, {0x76, 0x2F, 0x31, 0x01}, 4},
                                              {IMAGE_BMP, {'B', 'M'}, 2},
                                              {IMAGE_PNM, {'P', '5'}, 2},
                                              {IMAGE_PNM, {'P', 'f'}, 2}};

struct extension {
    enum image_kind kind;
    const char *letters;
};

static const struct extension extensions[] = {{IMAGE_TIFF, "tif"},
                                              {IMAGE_TIFF, "tiff"},
                                              {IMAGE_PNG, "png"},
                                              {IMAGE_JPEG, "jpg"},
                                              {IMAGE_JPEG, "jpeg"}};

static const char *foreign_name(const unsigned char *head, size_t count)
{
    for (size_t i = 0; i < sizeof foreign_kinds / sizeof *foreign_kinds; i++) {
        const struct foreign *kind = &foreign_kinds[i];
        if (count >= kind->place + kind->count &&
            memcmp(head + kind->place, kind->bytes, kind->count) == 0)
            return kind->name;
    }
    return NULL;
}

sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count)
{
    static const char readable[] =
        "TIFF, PNG, JPEG, OpenEXR, PGM (P5), PFM (Pf), BMP, XTF, NumPy (.npy), HDF5 and MATLAB "
        "(.mat)";
    const char *name = foreign_name(head, count);
    if (name)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is %s file, which sonject does not read; it reads %s: convert "
                              "it to one of these",
                              path, name, readable);
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: is %s; sonject reads %s: convert it to one of these", path,
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

static bool is_same_but_for_case(const char *text, const char *letters)
{
    for (; *letters; text++, letters++)
        if (*text != *letters && *text != *letters - 'a' + 'A')
            return false;
    return *text == '\0';
}

bool image_kind_of_name(const char *path, enum image_kind *kind)
{
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof extensions / sizeof *extensions; i++)
        if (is_same_but_for_case(dot + 1, extensions[i].letters)) {
            *kind = extensions[i].kind;
            return true;
        }
    return false;
}
