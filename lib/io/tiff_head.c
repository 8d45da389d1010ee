#include "io/tiff_head.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/byte_order.h"
#include "io/tiff_structure.h"

#define STRIP_BYTES ((uint64_t)1 << 18)
#define ENTRIES_MAX 16
#define PIXELS_AT   16 /* pixels start at a multiple of this */

enum value_type {
    TYPE_TEXT = 2,
    TYPE_SHORT = 3,
    TYPE_LONG = 4,
    TYPE_LONG8 = 16
};

struct head_entry {
    uint16_t tag;
    enum value_type type;
    size_t count;
    const char *text;    /* of a TYPE_TEXT */
    uint64_t value;      /* of the others: the first one */
    uint64_t step, last; /* then each is larger by step, but for the last one if that is not 0 */
};

struct head {
    bool is_big;
    bool is_big_endian;
    size_t count;
    struct head_entry entries[ENTRIES_MAX];
};

static size_t wide_of(const struct head *head)
{
    return head->is_big ? 8 : 4;
}

static size_t type_bytes(enum value_type type)
{
    switch (type) {
    case TYPE_TEXT:
        return 1;
    case TYPE_SHORT:
        return 2;
    case TYPE_LONG:
        return 4;
    case TYPE_LONG8:
        break;
    }
    return 8;
}

/* What an entry takes behind the directory: nothing if its values fit into it. */
static size_t outside_bytes(const struct head *head, const struct head_entry *entry)
{
    const size_t bytes = entry->count * type_bytes(entry->type);
    return bytes <= wide_of(head) ? 0 : (bytes + 7) / 8 * 8;
}

static size_t directory_place(const struct head *head)
{
    return head->is_big ? 16 : 8;
}

static size_t outside_place(const struct head *head)
{
    const size_t bytes = directory_place(head) + (head->is_big ? 8 : 2) +
                         head->count * (4 + 2 * wide_of(head)) + wide_of(head);
    return (bytes + 7) / 8 * 8;
}

static size_t head_bytes(const struct head *head)
{
    size_t bytes = outside_place(head);
    for (size_t i = 0; i < head->count; i++)
        bytes += outside_bytes(head, &head->entries[i]);
    return (bytes + PIXELS_AT - 1) / PIXELS_AT * PIXELS_AT;
}

static void add_entry(struct head *head, uint16_t tag, enum value_type type, size_t count,
                      uint64_t value)
{
    const struct head_entry entry = {tag, type, count, NULL, value, 0, 0};
    head->entries[head->count++] = entry;
}

static void add_text(struct head *head, uint16_t tag, const char *text)
{
    const struct head_entry entry = {tag, TYPE_TEXT, strlen(text) + 1, text, 0, 0, 0};
    head->entries[head->count++] = entry;
}

static void add_list(struct head *head, uint16_t tag, size_t count, uint64_t first, uint64_t step,
                     uint64_t last)
{
    const struct head_entry entry = {
        tag, head->is_big ? TYPE_LONG8 : TYPE_LONG, count, NULL, first, step, last};
    head->entries[head->count++] = entry;
}

/* Lists the entries, ascending as the format demands. pixels: their place in the file. */
static void list_entries(struct head *head, const struct raster_layout *layout,
                         const char *description, uint64_t pixels)
{
    const uint64_t row_bytes = layout->columns * layout->channels * pixel_bytes(layout->type);
    const uint64_t wanted = row_bytes < STRIP_BYTES ? STRIP_BYTES / row_bytes : 1;
    const uint64_t strip_rows = wanted < layout->rows ? wanted : layout->rows;
    const size_t strips = (size_t)((layout->rows - 1) / strip_rows + 1);
    const uint64_t last_rows = layout->rows - (strips - 1) * strip_rows;
    head->count = 0;
    add_entry(head, 256, TYPE_LONG, 1, layout->columns);
    add_entry(head, 257, TYPE_LONG, 1, layout->rows);
    add_entry(head, 258, TYPE_SHORT, layout->channels, 8 * pixel_bytes(layout->type));
    add_entry(head, 259, TYPE_SHORT, 1, TIFF_UNCOMPRESSED);
    add_entry(head, 262, TYPE_SHORT, 1, layout->channels == 3 ? 2 : 1);
    if (*description)
        add_text(head, 270, description);
    add_list(head, 273, strips, pixels, strip_rows * row_bytes, 0);
    add_entry(head, 277, TYPE_SHORT, 1, layout->channels);
    add_entry(head, 278, TYPE_LONG, 1, strip_rows);
    add_list(head, 279, strips, strip_rows * row_bytes, 0, last_rows * row_bytes);
    add_entry(head, 284, TYPE_SHORT, 1, 1);
    add_text(head, 305, "sonject");
    if (layout->channels == 2)
        add_entry(head, 338, TYPE_SHORT, 1, 0);
    add_entry(head, 339, TYPE_SHORT, layout->channels, layout->type == PIXEL_FLOAT32 ? 3 : 1);
}

static void write_values(const struct head *head, const struct head_entry *entry,
                         unsigned char *bytes)
{
    const size_t size = type_bytes(entry->type);
    if (entry->type == TYPE_TEXT) {
        memcpy(bytes, entry->text, entry->count);
        return;
    }
    for (size_t i = 0; i < entry->count; i++) {
        const bool is_last = i + 1 == entry->count && entry->last != 0;
        number_to_bytes(is_last ? entry->last : entry->value + i * entry->step, bytes + i * size,
                        size, head->is_big_endian);
    }
}

static void write_head(const struct head *head, unsigned char *bytes)
{
    const size_t wide = wide_of(head);
    const size_t directory = directory_place(head);
    const size_t count_bytes = head->is_big ? 8 : 2;
    size_t outside = outside_place(head);
    memcpy(bytes, head->is_big_endian ? "MM" : "II", 2);
    number_to_bytes(head->is_big ? 43 : 42, bytes + 2, 2, head->is_big_endian);
    if (head->is_big)
        number_to_bytes(8, bytes + 4, 2, head->is_big_endian);
    number_to_bytes(directory, bytes + directory - wide, wide, head->is_big_endian);
    number_to_bytes(head->count, bytes + directory, count_bytes, head->is_big_endian);
    for (size_t i = 0; i < head->count; i++) {
        const struct head_entry *entry = &head->entries[i];
        unsigned char *place = bytes + directory + count_bytes + i * (4 + 2 * wide);
        number_to_bytes(entry->tag, place, 2, head->is_big_endian);
        number_to_bytes((uint64_t)entry->type, place + 2, 2, head->is_big_endian);
        number_to_bytes(entry->count, place + 4, wide, head->is_big_endian);
        if (outside_bytes(head, entry) == 0) {
            write_values(head, entry, place + 4 + wide);
        } else {
            number_to_bytes(outside, place + 4 + wide, wide, head->is_big_endian);
            write_values(head, entry, bytes + outside);
            outside += outside_bytes(head, entry);
        }
    }
}

unsigned char *tiff_make_head(const struct raster_layout *layout, const char *description,
                              size_t *count)
{
    const uint64_t pixel = layout->channels * pixel_bytes(layout->type);
    struct head head = {0};
    head.is_big_endian = machine_is_big_endian();
    list_entries(&head, layout, description, 0);
    head.is_big = layout->rows > (UINT32_MAX - head_bytes(&head)) / (layout->columns * pixel);
    list_entries(&head, layout, description, 0);
    *count = head_bytes(&head);
    list_entries(&head, layout, description, *count);
    unsigned char *bytes = allocate_array(*count, 1);
    if (bytes)
        write_head(&head, bytes);
    return bytes;
}
