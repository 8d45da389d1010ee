#include "io/exr_header.h"

#include <string.h>

#include "io/byte_file.h"
#include "io/byte_order.h"

#define MARK_BYTES     8    /* magic number, version, flags */
#define OTHER_KINDS    0x1A /* flags: tiles, depths, several parts */
#define WORD_BYTES     256  /* of the longest name, with its 0 */
#define ATTRIBUTES_MAX 4096
#define CONTENT_MAX    4096 /* bytes of what is read */
#define CHANNEL_BYTES  16   /* behind its name */
#define TYPE_HALF      1
#define TYPES          3
#define COLUMNS_MAX    (1 << 20) /* the library holds 32 rows at a time */
#define COORDINATE_MAX (1 << 30)
#define ALL_FOUND      0xF /* of the attributes that are needed */

/* A header in the reading. */
struct reader {
    struct report *report;
    const char *path;
    FILE *file;
    uint64_t file_bytes;
    struct exr_header *header;
    unsigned found; /* a bit for each of the attributes that are needed */
};

struct attribute {
    char name[WORD_BYTES], kind[WORD_BYTES];
    uint64_t place, bytes; /* of its content */
};

static sonject_status refuse(const struct reader *reader, const char *what)
{
    return report_failure(reader->report, SONJECT_ERROR_INPUT, "%s: %s", reader->path, what);
}

/* Bytes up to the word's 0, with it; 0 where it is too long or does not end. */
static size_t take_word(const unsigned char *from, size_t count, char word[WORD_BYTES])
{
    const unsigned char *end = memchr(from, 0, count < WORD_BYTES ? count : WORD_BYTES);
    if (!end)
        return 0;
    memcpy(word, from, (size_t)(end - from) + 1);
    return (size_t)(end - from) + 1;
}

/* The header ends with one of no name. False where the file ends before it. */
static bool read_attribute(const struct reader *reader, uint64_t place, struct attribute *attribute)
{
    unsigned char head[2 * WORD_BYTES + 4];
    const uint64_t left = reader->file_bytes > place ? reader->file_bytes - place : 0;
    const size_t count = left < sizeof head ? (size_t)left : sizeof head;
    if (!byte_file_read(reader->file, place, head, count))
        return false;
    const size_t name = take_word(head, count, attribute->name);
    attribute->place = place + name;
    attribute->bytes = 0;
    if (name <= 1)
        return name == 1;
    const size_t kind = take_word(head + name, count - name, attribute->kind);
    if (kind == 0 || count - name - kind < 4)
        return false;
    attribute->place = place + name + kind + 4;
    attribute->bytes = number_from_bytes(head + name + kind, 4, false);
    return attribute->bytes <= reader->file_bytes - attribute->place;
}

/* These return what is wrong, or NULL. */

static const char *take_channels(struct exr_header *header, const unsigned char *list, size_t count)
{
    char name[WORD_BYTES];
    size_t at = 0;
    while (at < count && list[at] != 0) {
        const size_t letters = take_word(list + at, count - at, name);
        const unsigned char *facts = list + at + letters;
        if (letters == 0 || count - at - letters < CHANNEL_BYTES)
            return "is damaged: its list of channels does not end";
        const uint64_t type = number_from_bytes(facts, 4, false);
        if (type >= TYPES)
            return "is damaged: its samples are of no type that there is";
        if (number_from_bytes(facts + 8, 4, false) != 1 ||
            number_from_bytes(facts + 12, 4, false) != 1)
            return "has a channel of fewer pixels than others: store all channels of each pixel";
        header->pixel_bytes += type == TYPE_HALF ? 2 : 4;
        at += letters + CHANNEL_BYTES;
    }
    return header->pixel_bytes > 0 ? NULL : "is damaged: it has no channels";
}

static const char *take_compression(struct exr_header *header, const unsigned char *byte,
                                    size_t count)
{
    (void)count;
    header->compression = *byte;
    return NULL;
}

static const char *take_window(struct exr_header *header, const unsigned char *corners,
                               size_t count)
{
    int64_t corner[4];
    (void)count;
    for (size_t i = 0; i < 4; i++) {
        corner[i] = (int32_t)(uint32_t)number_from_bytes(corners + 4 * i, 4, false);
        if (corner[i] > COORDINATE_MAX || corner[i] < -COORDINATE_MAX)
            return "is damaged: its window is nowhere";
    }
    if (corner[2] < corner[0] || corner[3] < corner[1])
        return "is damaged: it has no pixels";
    header->first_row = corner[1];
    header->columns = (uint64_t)(corner[2] - corner[0] + 1);
    header->rows = (uint64_t)(corner[3] - corner[1] + 1);
    return NULL;
}

static const char *take_order(struct exr_header *header, const unsigned char *byte, size_t count)
{
    (void)count;
    header->is_upwards = *byte == 1;
    return *byte > 1 ? "is damaged: its rows are in no order" : NULL;
}

static const struct {
    const char *name, *kind;
    uint64_t least, most; /* bytes */
    const char *(*take)(struct exr_header *header, const unsigned char *content, size_t count);
} needed[] = {{"channels", "chlist", 1, CONTENT_MAX, take_channels},
              {"compression", "compression", 1, 1, take_compression},
              {"dataWindow", "box2i", 16, 16, take_window},
              {"lineOrder", "lineOrder", 1, 1, take_order}};

/* Its library believes what a preview says of its size. */
static const char *check_preview(const struct reader *reader, const struct attribute *attribute)
{
    unsigned char sides[8];
    if (attribute->bytes < sizeof sides ||
        !byte_file_read(reader->file, attribute->place, sides, sizeof sides))
        return "is damaged: its preview is cut short";
    const uint64_t columns = number_from_bytes(sides, 4, false);
    const uint64_t rows = number_from_bytes(sides + 4, 4, false);
    const uint64_t bytes = attribute->bytes - sizeof sides;
    return bytes % 4 == 0 && columns * rows == bytes / 4
               ? NULL
               : "is damaged: its preview is of another size than it says";
}

static const char *take_attribute(struct reader *reader, const struct attribute *attribute)
{
    unsigned char content[CONTENT_MAX];
    if (strcmp(attribute->kind, "preview") == 0)
        return check_preview(reader, attribute);
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        if (strcmp(attribute->name, needed[i].name) != 0)
            continue;
        const size_t count = (size_t)attribute->bytes;
        if ((reader->found & 1u << i) || strcmp(attribute->kind, needed[i].kind) != 0 ||
            attribute->bytes < needed[i].least || attribute->bytes > needed[i].most ||
            !byte_file_read(reader->file, attribute->place, content, count))
            return "is damaged, or has very many channels: its header is not as it must be";
        reader->found |= 1u << i;
        return needed[i].take(reader->header, content, count);
    }
    return NULL;
}

static sonject_status read_attributes(struct reader *reader)
{
    struct attribute attribute = {{0}, {0}, MARK_BYTES, 0};
    for (int i = 0; i < ATTRIBUTES_MAX; i++) {
        if (!read_attribute(reader, attribute.place + attribute.bytes, &attribute))
            break;
        reader->header->bytes = attribute.place;
        if (attribute.name[0] == '\0')
            return reader->found == ALL_FOUND
                       ? SONJECT_OK
                       : refuse(reader, "is damaged: its header lacks what it must say");
        const char *fault = take_attribute(reader, &attribute);
        if (fault)
            return refuse(reader, fault);
    }
    return refuse(reader, "is cut short or damaged: its header does not end");
}

static sonject_status check_compression(const struct reader *reader)
{
    static const struct {
        const char *name;
        uint64_t rows; /* of a chunk; 0: it changes pixels */
    } kinds[] = {{"none", 1},  {"rle", 1}, {"zips", 1}, {"zip", 16}, {"piz", 32},
                 {"pxr24", 0}, {"b44", 0}, {"b44a", 0}, {"dwaa", 0}, {"dwab", 0}};
    const unsigned kind = reader->header->compression;
    if (kind >= sizeof kinds / sizeof *kinds)
        return refuse(reader, "is damaged: it is compressed in no way that there is");
    if (kinds[kind].rows == 0)
        return report_failure(reader->report, SONJECT_ERROR_INPUT,
                              "%s: is compressed by %s, which changes pixels: store it with zip, "
                              "piz, rle or none",
                              reader->path, kinds[kind].name);
    reader->header->chunk_rows = kinds[kind].rows;
    return SONJECT_OK;
}

sonject_status exr_header_read(struct report *report, const char *path, FILE *file,
                               uint64_t file_bytes, struct exr_header *header)
{
    struct reader reader = {report, path, file, file_bytes, header, 0};
    unsigned char mark[MARK_BYTES];
    memset(header, 0, sizeof *header);
    if (!byte_file_read(file, 0, mark, sizeof mark) || mark[4] != 2)
        return refuse(&reader, "is damaged, or of another version of OpenEXR: write it anew");
    if (mark[5] & OTHER_KINDS)
        return refuse(&reader, "has tiles, several parts or depths: store one image in scanlines");
    sonject_status status = read_attributes(&reader);
    if (status == SONJECT_OK)
        status = check_compression(&reader);
    if (status == SONJECT_OK && header->columns > COLUMNS_MAX)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: has more than the %d columns that are read of OpenEXR: cut "
                                "it into several",
                                path, COLUMNS_MAX);
    return status;
}
