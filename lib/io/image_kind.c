#include "io/image_kind.h"

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "io/jpeg_segments.h"
#include "io/png_chunks.h"
#include "io/tiff_structure.h"

struct beginning {
    enum image_kind kind;
    unsigned char bytes[4];
    size_t count;
};

static const struct beginning beginnings[] = {
    {IMAGE_TIFF, {'I', 'I', 42, 0}, 4},    {IMAGE_TIFF, {'M', 'M', 0, 42}, 4},
    {IMAGE_TIFF, {'I', 'I', 43, 0}, 4},    {IMAGE_TIFF, {'M', 'M', 0, 43}, 4},
    {IMAGE_PNG, {0x89, 'P', 'N', 'G'}, 4}, {IMAGE_JPEG, {0xFF, 0xD8, 0xFF, 0}, 3}};

struct extension {
    enum image_kind kind;
    const char *letters;
};

static const struct extension extensions[] = {{IMAGE_TIFF, "tif"},
                                              {IMAGE_TIFF, "tiff"},
                                              {IMAGE_PNG, "png"},
                                              {IMAGE_JPEG, "jpg"},
                                              {IMAGE_JPEG, "jpeg"}};

sonject_status image_kind_of(struct report *report, const char *path, enum image_kind *kind)
{
    unsigned char head[4] = {0};
    uint64_t bytes;
    FILE *file = byte_file_open(path, &bytes);
    if (!file) {
        (void)file_failure(report, path, "open", errno);
        return SONJECT_ERROR_INPUT;
    }
    const size_t got = fread(head, 1, sizeof head, file);
    fclose(file);
    for (size_t i = 0; i < sizeof beginnings / sizeof *beginnings; i++)
        if (got >= beginnings[i].count &&
            memcmp(head, beginnings[i].bytes, beginnings[i].count) == 0) {
            *kind = beginnings[i].kind;
            return SONJECT_OK;
        }
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: is not a TIFF, PNG or JPEG image%s: convert it to one of these",
                          path, got == 0 ? ", but empty" : "");
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

static sonject_status check_tiff(struct report *report, const char *path)
{
    struct tiff_structure structure;
    const sonject_status status = tiff_structure_read(report, path, &structure);
    if (status == SONJECT_OK)
        tiff_structure_clear(&structure);
    return status;
}

sonject_status image_kind_check(struct report *report, const char *path, enum image_kind kind,
                                struct byte_ranges *parts)
{
    switch (kind) {
    case IMAGE_PNG:
        return png_check(report, path, parts);
    case IMAGE_JPEG:
        return jpeg_check(report, path, parts);
    case IMAGE_TIFF:
        break;
    }
    return check_tiff(report, path);
}
