/* Arrays of MATLAB files of version 5 (.mat: -v6 and -v7 of MATLAB, and those of scipy and Octave).
 * Arrays are two-dimensional, of double, single, uint8, uint16 or int16 numbers; double and single
 * may be complex. Rows and columns are MATLAB's. A copy differs from its source only in the array's
 * changed numbers; all other variables keep every byte. A variable is written again as a whole if
 * it is compressed, or if MATLAB packed its numbers into a smaller type. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <zlib.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/swath_format.h"

#define TAG_BYTES       8
#define HEADER_BYTES    128
#define HEAD_BYTES      512  /* enough for class, sides and name of a variable */
#define DEFLATE_RATIO   1040 /* more than the bytes that a deflated byte holds */
#define NAME_MAX_BYTES  64   /* final 0 included */
#define FLAG_COMPLEX    0x0800u
#define FLAG_LOGICAL    0x0200u
#define SUBSYSTEM_PLACE 116 /* in the header: offset of the data of MATLAB's own objects */

/* Types of elements and stored numbers. The values are the format's. */
enum mat_type {
    MAT_INT8 = 1,
    MAT_UINT8 = 2,
    MAT_INT16 = 3,
    MAT_UINT16 = 4,
    MAT_INT32 = 5,
    MAT_UINT32 = 6,
    MAT_SINGLE = 7,
    MAT_DOUBLE = 9,
    MAT_MATRIX = 14,
    MAT_COMPRESSED = 15
};

/* MATLAB's classes of variables. */
enum mat_class {
    MAT_CLASS_DOUBLE = 6,
    MAT_CLASS_SINGLE = 7,
    MAT_CLASS_UINT8 = 9,
    MAT_CLASS_INT16 = 10,
    MAT_CLASS_UINT16 = 11,
    MAT_CLASS_LAST_NUMERIC = 15
};

/* The numbers of a variable: the real or the imaginary part. */
struct part {
    uint32_t type;           /* stored mat_type */
    size_t tag, data, bytes; /* tag, data: offsets in the variable's element */
};

/* A variable in the file. */
struct variable {
    uint64_t place, bytes; /* the element in the file, tag included */
    bool is_compressed, is_complex;
    bool is_logical, is_plane; /* is_plane: two-dimensional */
    uint32_t kind;             /* MATLAB's class */
    uint64_t rows, columns;    /* of the first two dimensions */
    uint32_t wide;             /* number of dimensions with more than one number */
    size_t head;               /* bytes of the element before its numbers; 0: not an array */
    char name[NAME_MAX_BYTES];
};

struct mat_array {
    bool is_big_endian;
    struct variable variable; /* the one that is read */
    unsigned char *element;   /* owned; the variable, inflated, with its tag */
    size_t element_bytes;
    struct part parts[2];
};

/* Inflates a variable, or its beginning: at most capacity bytes; *count gets how many. Returns
 * false if the variable is damaged. Its checksum stands at its end, which is looked at if is_whole.
 * Elements have at most 2^32 bytes, which zlib's sizes hold. */
static bool inflate_variable(const unsigned char *compressed, size_t compressed_bytes,
                             bool is_whole, unsigned char *bytes, size_t capacity, size_t *count)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    stream.next_in = (Bytef *)compressed;
    stream.avail_in = (uInt)compressed_bytes;
    stream.next_out = bytes;
    stream.avail_out = (uInt)capacity;
    if (inflateInit(&stream) != Z_OK)
        return false;
    int answer = inflate(&stream, Z_NO_FLUSH);
    *count = capacity - stream.avail_out;
    if (is_whole && answer == Z_OK) {
        unsigned char beyond;
        stream.next_out = &beyond;
        stream.avail_out = sizeof beyond;
        answer = inflate(&stream, Z_NO_FLUSH);
    }
    inflateEnd(&stream);
    return answer == Z_STREAM_END || (!is_whole && (answer == Z_OK || answer == Z_BUF_ERROR));
}

/* Returns false for types other than floats and integers of up to 32 bits. */
static bool stored_type_of(uint32_t type, enum stored_type *stored)
{
    static const enum stored_type types[] = {
        [MAT_INT8] = STORED_INT8,      [MAT_UINT8] = STORED_UINT8, [MAT_INT16] = STORED_INT16,
        [MAT_UINT16] = STORED_UINT16,  [MAT_INT32] = STORED_INT32, [MAT_UINT32] = STORED_UINT32,
        [MAT_SINGLE] = STORED_FLOAT32, [8] = STORED_FLOAT64,       [MAT_DOUBLE] = STORED_FLOAT64};
    if (type == 0 || type == 8 || type > MAT_DOUBLE)
        return false;
    *stored = types[type];
    return true;
}

/* Returns the type of a variable's unpacked numbers; 0 if sonject does not read the variable. */
static uint32_t own_type(const struct variable *variable)
{
    static const uint32_t types[] = {[MAT_CLASS_DOUBLE] = MAT_DOUBLE,
                                     [MAT_CLASS_SINGLE] = MAT_SINGLE,
                                     [MAT_CLASS_UINT8] = MAT_UINT8,
                                     [MAT_CLASS_INT16] = MAT_INT16,
                                     [MAT_CLASS_UINT16] = MAT_UINT16};
    if (!variable->is_plane || variable->is_logical || variable->kind > MAT_CLASS_UINT16 ||
        (variable->is_complex && variable->kind > MAT_CLASS_SINGLE))
        return 0;
    return types[variable->kind];
}

static bool is_mat(struct swath_file *file, const unsigned char *head, size_t count)
{
    static const char mark[] = "MATLAB 5";
    (void)file;
    return count >= sizeof mark - 1 && memcmp(head, mark, sizeof mark - 1) == 0;
}

static sonject_status damaged(struct report *report, const struct swath_file *file, uint64_t place)
{
    return input_failure(report, file->path,
                         "cut short or damaged at byte %llu: copy or export it again",
                         (unsigned long long)place);
}

/* Takes the element at *place of the bytes. *part gets where its data lie, and *place becomes the
 * next element's. Returns false if the bytes do not hold the element. */
static bool take_element(const unsigned char *bytes, size_t count, bool is_big_endian,
                         size_t *place, struct part *part)
{
    if (*place > count || count - *place < TAG_BYTES)
        return false;
    const unsigned char *tag = bytes + *place;
    const uint32_t first = (uint32_t)number_from_bytes(tag, 4, is_big_endian);
    const bool is_small = first >> 16 != 0;
    part->tag = *place;
    part->type = is_small ? first & 0xFFFF : first;
    part->bytes = is_small ? first >> 16 : (size_t)number_from_bytes(tag + 4, 4, is_big_endian);
    part->data = *place + (is_small ? 4 : TAG_BYTES);
    if ((is_small && part->bytes > 4) || part->bytes > count - part->data)
        return false;
    *place = is_small ? *place + TAG_BYTES : part->data + (part->bytes + 7) / 8 * 8;
    return true;
}

/* Reads class, sides and name from the beginning of an element. Returns false unless the element is
 * an array of numbers. */
static bool read_head(const unsigned char *bytes, size_t count, bool is_big_endian,
                      struct variable *variable)
{
    struct part flags, sides, name;
    size_t place = TAG_BYTES;
    if (count < TAG_BYTES || number_from_bytes(bytes, 4, is_big_endian) != MAT_MATRIX ||
        !take_element(bytes, count, is_big_endian, &place, &flags) || flags.type != MAT_UINT32 ||
        flags.bytes != 8)
        return false;
    const uint64_t word = number_from_bytes(bytes + flags.data, 4, is_big_endian);
    variable->kind = (uint32_t)word & 0xFF;
    variable->is_complex = (word & FLAG_COMPLEX) != 0;
    variable->is_logical = (word & FLAG_LOGICAL) != 0;
    if (variable->kind < MAT_CLASS_DOUBLE || variable->kind > MAT_CLASS_LAST_NUMERIC ||
        !take_element(bytes, count, is_big_endian, &place, &sides) || sides.type != MAT_INT32 ||
        sides.bytes < 8 || !take_element(bytes, count, is_big_endian, &place, &name) ||
        name.type != MAT_INT8 || name.bytes >= sizeof variable->name)
        return false;
    variable->rows = number_from_bytes(bytes + sides.data, 4, is_big_endian);
    variable->columns = number_from_bytes(bytes + sides.data + 4, 4, is_big_endian);
    for (size_t i = 0; i + 4 <= sides.bytes; i += 4)
        variable->wide += number_from_bytes(bytes + sides.data + i, 4, is_big_endian) > 1;
    memcpy(variable->name, bytes + name.data, name.bytes);
    variable->is_plane = sides.bytes == 8;
    variable->head = place;
    return variable->rows > 0 && variable->columns > 0 && variable->rows <= INT32_MAX &&
           variable->columns <= INT32_MAX;
}

/* Finds out what a variable is, after inflating the beginning of a compressed one. */
static sonject_status look_at(struct report *report, const struct swath_file *file,
                              struct variable *variable)
{
    unsigned char stored[HEAD_BYTES];
    unsigned char inflated[HEAD_BYTES];
    const unsigned char *head = stored;
    const uint64_t from = variable->place + (variable->is_compressed ? TAG_BYTES : 0);
    const uint64_t there = variable->place + variable->bytes - from;
    size_t count = there < HEAD_BYTES ? (size_t)there : HEAD_BYTES;
    if (!byte_file_read(file->stream, from, stored, count))
        return damaged(report, file, from);
    if (variable->is_compressed) {
        if (!inflate_variable(stored, count, false, inflated, sizeof inflated, &count))
            return damaged(report, file, from);
        head = inflated;
    }
    if (!read_head(head, count, file->mat->is_big_endian, variable))
        variable->head = 0;
    return SONJECT_OK;
}

/* Walks through the file's variables and keeps the wanted one. */
static sonject_status choose_variable(struct report *report, struct swath_file *file,
                                      const char *array)
{
    struct array_list list = {array, 0, 0, ""};
    unsigned char tag[TAG_BYTES];
    for (uint64_t place = HEADER_BYTES; place < file->bytes;) {
        struct variable variable = {.place = place};
        if (file->bytes - place < TAG_BYTES ||
            !byte_file_read(file->stream, place, tag, sizeof tag))
            return damaged(report, file, place);
        const uint64_t type = number_from_bytes(tag, 4, file->mat->is_big_endian);
        variable.bytes = TAG_BYTES + number_from_bytes(tag + 4, 4, file->mat->is_big_endian);
        variable.is_compressed = type == MAT_COMPRESSED;
        if ((type != MAT_COMPRESSED && type != MAT_MATRIX) || variable.bytes > file->bytes - place)
            return damaged(report, file, place);
        CHECK(look_at(report, file, &variable));
        const bool is_read = own_type(&variable) != 0;
        if (variable.head > 0 &&
            array_list_add(&list, variable.name, is_read ? variable.rows : 0, variable.columns,
                           variable.wide > 1 && !variable.is_logical))
            file->mat->variable = variable;
        place += variable.bytes;
    }
    return array_list_check(report, file->path, &list);
}

/* Inflates the whole variable. Refuses a size that its compressed bytes cannot hold. */
static sonject_status inflate_element(struct report *report, const struct swath_file *file,
                                      const unsigned char *stored, size_t count)
{
    struct mat_array *mat = file->mat;
    unsigned char tag[TAG_BYTES];
    size_t got = 0;
    if (!inflate_variable(stored, count, false, tag, sizeof tag, &got) || got != sizeof tag)
        return damaged(report, file, mat->variable.place);
    const uint64_t bytes = TAG_BYTES + number_from_bytes(tag + 4, 4, mat->is_big_endian);
    if (bytes / DEFLATE_RATIO > count || bytes > UINT32_MAX)
        return damaged(report, file, mat->variable.place);
    mat->element_bytes = (size_t)bytes;
    mat->element = allocate_array(mat->element_bytes, 1);
    CHECK_MEMORY(report, mat->element, "an array");
    if (!inflate_variable(stored, count, true, mat->element, mat->element_bytes, &got) ||
        got != mat->element_bytes)
        return damaged(report, file, mat->variable.place);
    return SONJECT_OK;
}

static sonject_status load_element(struct report *report, const struct swath_file *file)
{
    struct mat_array *mat = file->mat;
    const struct variable *variable = &mat->variable;
    unsigned char *stored =
        variable->bytes <= SIZE_MAX ? allocate_array((size_t)variable->bytes, 1) : NULL;
    CHECK_MEMORY(report, stored, "an array");
    sonject_status status = SONJECT_OK;
    if (!byte_file_read(file->stream, variable->place, stored, (size_t)variable->bytes)) {
        status = damaged(report, file, variable->place);
    } else if (variable->is_compressed) {
        status =
            inflate_element(report, file, stored + TAG_BYTES, (size_t)variable->bytes - TAG_BYTES);
    } else {
        mat->element = stored;
        mat->element_bytes = (size_t)variable->bytes;
        return SONJECT_OK;
    }
    free(stored);
    return status;
}

/* Finds the places of the numbers in the element. */
static sonject_status find_parts(struct report *report, const struct swath_file *file)
{
    struct mat_array *mat = file->mat;
    size_t place = mat->variable.head;
    const uint64_t count = mat->variable.rows * mat->variable.columns;
    for (int i = 0; i < (mat->variable.is_complex ? 2 : 1); i++) {
        struct part *part = &mat->parts[i];
        enum stored_type type;
        if (!take_element(mat->element, mat->element_bytes, mat->is_big_endian, &place, part) ||
            !stored_type_of(part->type, &type) || part->bytes % stored_bytes(type) != 0 ||
            part->bytes / stored_bytes(type) != count)
            return damaged(report, file, mat->variable.place);
    }
    return SONJECT_OK;
}

static sonject_status open_mat(struct report *report, struct swath_file *file, int32_t channel,
                               const char *array)
{
    unsigned char header[HEADER_BYTES];
    struct mat_array *mat = file->mat = allocate_array(1, sizeof *mat);
    (void)channel;
    CHECK_MEMORY(report, mat, "a file");
    if (!byte_file_read(file->stream, 0, header, sizeof header))
        return damaged(report, file, 0);
    mat->is_big_endian = header[126] == 'M' && header[127] == 'I';
    if (!mat->is_big_endian && !(header[126] == 'I' && header[127] == 'M'))
        return damaged(report, file, 126);
    CHECK(choose_variable(report, file, array));
    const struct variable *variable = &mat->variable;
    if (!variable->is_plane)
        return input_failure(report, file->path,
                             "the array %s has more than two dimensions: save it as one of rows "
                             "and columns",
                             variable->name);
    if (own_type(variable) == 0)
        return input_failure(
            report, file->path,
            "the array %s is of numbers that sonject does not read: save it as double, single, "
            "uint8, uint16 or int16, complex ones as double or single",
            variable->name);
    file->layout =
        (struct raster_layout){variable->rows, variable->columns, variable->is_complex ? 2 : 1,
                               variable->kind == MAT_CLASS_UINT8    ? PIXEL_UINT8
                               : variable->kind <= MAT_CLASS_SINGLE ? PIXEL_FLOAT32
                                                                    : PIXEL_UINT16};
    file->largest = variable->kind == MAT_CLASS_INT16 ? INT16_MAX : 0;
    CHECK(load_element(report, file));
    return find_parts(report, file);
}

void mat_array_release(struct mat_array **array)
{
    if (*array)
        free((*array)->element);
    free(*array);
    *array = NULL;
}

/* Moves samples between a region's pixels and an element, whose parts are given. */
static sonject_status exchange(struct report *report, const struct swath_file *file,
                               const struct part *parts, unsigned char *element,
                               const struct region *region, void *pixels, bool writes)
{
    const uint64_t first = region->first_column * file->layout.rows + region->first_row;
    struct stored_samples stored = {.row_step = 1,
                                    .column_step = (ptrdiff_t)file->layout.rows,
                                    .is_big_endian = file->mat->is_big_endian,
                                    .largest = file->largest};
    for (uint32_t k = 0; k < file->layout.channels; k++) {
        (void)stored_type_of(parts[k].type, &stored.types[k]);
        stored.bytes[k] = element + parts[k].data + first * stored_bytes(stored.types[k]);
    }
    return samples_exchange(report, file->path, &file->layout, &stored, region, region, pixels,
                            writes);
}

static sonject_status read_mat(struct report *report, struct swath_file *file,
                               const struct region *region, void *pixels)
{
    return exchange(report, file, file->mat->parts, file->mat->element, region, pixels, false);
}

/* Returns the element with its numbers in the variable's own type, for free(). parts gets the
 * places of the numbers. NULL if memory or the format cannot hold the element. */
static unsigned char *unpack(const struct swath_file *file, struct part *parts, size_t *bytes)
{
    const struct mat_array *mat = file->mat;
    const uint32_t type = own_type(&mat->variable);
    const uint64_t count = file->layout.rows * file->layout.columns;
    enum stored_type own = STORED_UINT8;
    (void)stored_type_of(type, &own);
    const uint64_t each = TAG_BYTES + (count * stored_bytes(own) + 7) / 8 * 8;
    const uint64_t total = mat->parts[0].tag + each * file->layout.channels;
    unsigned char *element = total - TAG_BYTES <= UINT32_MAX && total <= SIZE_MAX
                                 ? allocate_array((size_t)total, 1)
                                 : NULL;
    if (!element)
        return NULL;
    memcpy(element, mat->element, mat->parts[0].tag);
    number_to_bytes(total - TAG_BYTES, element + 4, 4, mat->is_big_endian);
    for (uint32_t k = 0; k < file->layout.channels; k++) {
        const size_t tag = mat->parts[0].tag + (size_t)each * k;
        const struct part part = {type, tag, tag + TAG_BYTES, (size_t)count * stored_bytes(own)};
        enum stored_type packed = own;
        (void)stored_type_of(mat->parts[k].type, &packed);
        number_to_bytes(type, element + tag, 4, mat->is_big_endian);
        number_to_bytes(part.bytes, element + tag + 4, 4, mat->is_big_endian);
        for (size_t i = 0; i < count; i++)
            samples_convert(packed, mat->element + mat->parts[k].data + i * stored_bytes(packed),
                            own, element + part.data + i * stored_bytes(own), mat->is_big_endian);
        parts[k] = part;
    }
    *bytes = (size_t)total;
    return element;
}

/* Makes the variable's element for the copy, for free(). */
static sonject_status make_element(struct report *report, const struct swath_file *file,
                                   const struct swath_copy *copy, unsigned char **element,
                                   size_t *bytes)
{
    const struct mat_array *mat = file->mat;
    struct part parts[2] = {mat->parts[0], mat->parts[1]};
    bool is_packed = false;
    for (uint32_t k = 0; k < file->layout.channels; k++)
        is_packed |= parts[k].type != own_type(&mat->variable);
    *bytes = mat->element_bytes;
    *element = is_packed ? unpack(file, parts, bytes) : allocate_array(*bytes, 1);
    CHECK_MEMORY(report, *element, "an array");
    if (!is_packed)
        memcpy(*element, mat->element, *bytes);
    CHECK(exchange(report, file, parts, *element, copy->region, (void *)copy->pixels, true));
    if (!mat->variable.is_compressed)
        return SONJECT_OK;
    uLongf count = compressBound((uLong)*bytes);
    unsigned char *tagged = allocate_array((size_t)count + TAG_BYTES, 1);
    CHECK_MEMORY(report, tagged, "a compressed array");
    const bool is_done = compress2(tagged + TAG_BYTES, &count, *element, (uLong)*bytes,
                                   Z_DEFAULT_COMPRESSION) == Z_OK &&
                         count <= UINT32_MAX;
    number_to_bytes(MAT_COMPRESSED, tagged, 4, mat->is_big_endian);
    number_to_bytes(count, tagged + 4, 4, mat->is_big_endian);
    free(*element);
    *element = tagged;
    *bytes = (size_t)count + TAG_BYTES;
    return is_done ? SONJECT_OK : report_out_of_memory(report, "a compressed array");
}

/* Corrects the header's offset of MATLAB's own data, which move with the variable's size. */
static bool move_subsystem(const struct swath_file *file, FILE *out, uint64_t bytes)
{
    const struct variable *variable = &file->mat->variable;
    unsigned char word[8];
    if (!byte_file_read(file->stream, SUBSYSTEM_PLACE, word, sizeof word))
        return false;
    const uint64_t place = number_from_bytes(word, 8, file->mat->is_big_endian);
    if (place < variable->place + variable->bytes || place >= file->bytes ||
        bytes == variable->bytes)
        return true;
    number_to_bytes(place - variable->bytes + bytes, word, 8, file->mat->is_big_endian);
    return byte_file_seek(out, SUBSYSTEM_PLACE) && fwrite(word, 1, sizeof word, out) == sizeof word;
}

static sonject_status write_copy(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy, FILE *out,
                                 const unsigned char *element, size_t bytes)
{
    const struct variable *variable = &file->mat->variable;
    const uint64_t end = variable->place + variable->bytes;
    CHECK(swath_copy_bytes(report, file, copy, 0, variable->place, out));
    if (fwrite(element, 1, bytes, out) != bytes)
        return file_failure(report, copy->path, "write", errno);
    CHECK(swath_copy_bytes(report, file, copy, end, file->bytes, out));
    if (move_subsystem(file, out, bytes))
        return SONJECT_OK;
    return ferror(out) ? file_failure(report, copy->path, "write", errno)
                       : input_failure(report, file->path, "cannot be read to its end");
}

static sonject_status copy_mat(struct report *report, const struct swath_file *file,
                               const struct swath_copy *copy)
{
    unsigned char *element = NULL;
    size_t bytes = 0;
    FILE *out = NULL;
    sonject_status status = make_element(report, file, copy, &element, &bytes);
    if (status == SONJECT_OK && !(out = file_open(copy->part, "w+b")))
        status = file_failure(report, copy->path, "write", errno);
    THEN(status, write_copy(report, file, copy, out, element, bytes));
    free(element);
    return swath_close_copy(report, copy, out, status);
}

const struct swath_format mat_format = {false, true, is_mat, open_mat, read_mat, copy_mat};
