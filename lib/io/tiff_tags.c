#include "io/tiff_tags.h"

#include <errno.h>
#include <string.h>

#include "base/file.h"
#include "io/byte_file.h"
#include "io/byte_order.h"

#define ENTRIES_MAX 4096

static const uint16_t tag_numbers[TAG_TOTAL] = {254, 256, 257, 258, 259, 262, 266, 273, 277, 278,
                                                279, 284, 317, 322, 323, 324, 325, 330, 338, 339};

sonject_status tiff_reader_open(struct report *report, const char *path, struct tiff_reader *reader)
{
    memset(reader, 0, sizeof *reader);
    reader->report = report;
    reader->path = path;
    reader->file = byte_file_open(path, &reader->file_bytes);
    return reader->file ? SONJECT_OK : file_refuse(report, path, errno);
}

void tiff_reader_close(struct tiff_reader *reader)
{
    if (reader->file)
        fclose(reader->file);
    reader->file = NULL;
}

sonject_status tiff_damaged(const struct tiff_reader *reader, const char *how)
{
    return report_failure(reader->report, SONJECT_ERROR_INPUT, "%s: damaged TIFF: %s", reader->path,
                          how);
}

bool tiff_read_at(const struct tiff_reader *reader, uint64_t place, void *bytes, size_t count)
{
    return place <= reader->file_bytes && count <= reader->file_bytes - place &&
           byte_file_read(reader->file, place, bytes, count);
}

static bool number_at(const struct tiff_reader *reader, uint64_t place, size_t size,
                      uint64_t *number)
{
    unsigned char bytes[8];
    if (!tiff_read_at(reader, place, bytes, size))
        return false;
    *number = number_from_bytes(bytes, size, reader->is_big_endian);
    return true;
}

/* Bytes of a value, 0 for a type that this does not know. */
static size_t type_bytes(uint64_t type)
{
    static const unsigned char bytes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

/* BYTE, SHORT, LONG, IFD, LONG8 or IFD8. */
static bool is_count_type(uint64_t type)
{
    return type == 1 || type == 3 || type == 4 || type == 13 || type == 16 || type == 18;
}

size_t tiff_place_bytes(const struct tiff_reader *reader)
{
    return reader->is_big ? 8 : 4;
}

/* Reads an entry into the reader's tags, if it is among these. False if its values are not there,
 * whatever it is. */
static bool read_entry(struct tiff_reader *reader, uint64_t place)
{
    uint64_t number, type, count;
    const size_t wide = tiff_place_bytes(reader);
    if (!number_at(reader, place, 2, &number) || !number_at(reader, place + 2, 2, &type) ||
        !number_at(reader, place + 4, wide, &count))
        return false;
    const size_t size = type_bytes(type);
    uint64_t values = place + 4 + wide;
    if (size > 0 && count > wide / size) {
        if (!number_at(reader, values, wide, &values) || values > reader->file_bytes ||
            count > (reader->file_bytes - values) / size)
            return false;
    }
    for (int i = 0; i < TAG_TOTAL; i++)
        if (tag_numbers[i] == number && is_count_type(type)) {
            const struct tag tag = {count, size, place, values};
            reader->tags[i] = tag;
        }
    return true;
}

bool tiff_read_directory(struct tiff_reader *reader, uint64_t place, uint64_t *next)
{
    uint64_t entries;
    const size_t head = reader->is_big ? 8 : 2;
    const size_t entry_bytes = 4 + 2 * tiff_place_bytes(reader);
    memset(reader->tags, 0, sizeof reader->tags);
    if (!number_at(reader, place, head, &entries) || entries > ENTRIES_MAX)
        return false;
    place += head;
    for (uint64_t i = 0; i < entries; i++, place += entry_bytes)
        if (!read_entry(reader, place))
            return false;
    return number_at(reader, place, tiff_place_bytes(reader), next);
}

bool tiff_tag_value(const struct tiff_reader *reader, enum tag_name name, uint64_t otherwise,
                    uint64_t *value)
{
    const struct tag *tag = &reader->tags[name];
    *value = otherwise;
    return tag->count == 0 || number_at(reader, tag->values, tag->size, value);
}

bool tiff_tag_common_value(const struct tiff_reader *reader, enum tag_name name, uint64_t otherwise,
                           uint64_t *value)
{
    const struct tag *tag = &reader->tags[name];
    if (!tiff_tag_value(reader, name, otherwise, value))
        return false;
    for (uint64_t i = 1; i < tag->count && i < 2; i++) {
        uint64_t other;
        if (!number_at(reader, tag->values + i * tag->size, tag->size, &other) || other != *value)
            return false;
    }
    return true;
}

sonject_status tiff_read_header(struct tiff_reader *reader, uint64_t *first)
{
    unsigned char head[4];
    uint64_t version, width;
    *first = 0;
    if (!tiff_read_at(reader, 0, head, sizeof head))
        return tiff_damaged(reader, "cut short");
    reader->is_big_endian = head[0] == 'M';
    version = number_from_bytes(head + 2, 2, reader->is_big_endian);
    reader->is_big = version == 43;
    if (version != 42 && version != 43)
        return tiff_damaged(reader, "unknown version");
    if (reader->is_big && (!number_at(reader, 4, 4, &width) ||
                           (reader->is_big_endian ? width >> 16 != 8 : width != 8)))
        return tiff_damaged(reader, "its places are not 8 bytes wide");
    if (!number_at(reader, reader->is_big ? 8 : 4, tiff_place_bytes(reader), first))
        return tiff_damaged(reader, "cut short");
    return SONJECT_OK;
}
