/* PLY files: a header that says which elements follow. Only vertices and faces are kept. */
#include <math.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "mesh/mesh_reader.h"

#define ELEMENTS_MAX   16
#define PROPERTIES_MAX 64

enum type { /* signed types are even */
    INT8,
    UINT8,
    INT16,
    UINT16,
    INT32,
    UINT32,
    FLOAT32,
    FLOAT64
};

static const struct {
    const char *name, *other_name;
    size_t bytes;
} types[] = {[INT8] = {"char", "int8", 1},        [UINT8] = {"uchar", "uint8", 1},
             [INT16] = {"short", "int16", 2},     [UINT16] = {"ushort", "uint16", 2},
             [INT32] = {"int", "int32", 4},       [UINT32] = {"uint", "uint32", 4},
             [FLOAT32] = {"float", "float32", 4}, [FLOAT64] = {"double", "float64", 8}};

enum role {
    OTHER,
    X, /* X + axis: coordinate of a vertex */
    Y,
    Z,
    CORNERS /* a face's list of vertices */
};

struct property {
    enum role role;
    enum type type; /* type of a list's elements, if it is a list */
    enum type length_type;
    bool is_list;
};

struct element {
    uint64_t count;
    struct property properties[PROPERTIES_MAX];
    int property_count;
    bool is_vertex, is_face;
};

struct header {
    enum {
        TEXT,
        LITTLE_ENDIAN_BYTES,
        BIG_ENDIAN_BYTES
    } format;
    struct element elements[ELEMENTS_MAX];
    int element_count;
};

static sonject_status accept_type(struct words *words, enum type *type)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (words_accept(words, types[i].name) || words_accept(words, types[i].other_name)) {
            *type = (enum type)i;
            return SONJECT_OK;
        }
    return words_failure(words, "a type such as float or uchar");
}

static enum role accept_role(struct words *words, const struct element *element, bool is_list)
{
    if (element->is_vertex && !is_list)
        return words_accept(words, "x")   ? X
               : words_accept(words, "y") ? Y
               : words_accept(words, "z") ? Z
                                          : OTHER;
    const bool is_corners =
        element->is_face && is_list &&
        (words_accept(words, "vertex_indices") || words_accept(words, "vertex_index"));
    return is_corners ? CORNERS : OTHER;
}

/* Reads the words that follow "property". */
static sonject_status read_property(struct words *words, struct header *header)
{
    if (header->element_count == 0)
        return words_failure(words, "'element' before 'property'");
    struct element *element = &header->elements[header->element_count - 1];
    if (element->property_count == PROPERTIES_MAX)
        return words_failure(words, "at most 64 properties of an element");
    struct property *property = &element->properties[element->property_count++];
    property->is_list = words_accept(words, "list");
    if (property->is_list) {
        CHECK(accept_type(words, &property->length_type));
        if (property->length_type >= FLOAT32)
            return words_failure(words, "a list whose length is a whole number");
    }
    CHECK(accept_type(words, &property->type));
    property->role = accept_role(words, element, property->is_list);
    if (property->role == CORNERS && property->type >= FLOAT32)
        return words_failure(words, "vertex numbers that are whole");
    return SONJECT_OK;
}

/* Reads the words that follow "element". */
static sonject_status read_element(struct words *words, struct header *header)
{
    if (header->element_count == ELEMENTS_MAX)
        return words_failure(words, "at most 16 elements");
    struct element *element = &header->elements[header->element_count++];
    int64_t count = 0;
    if (!words_on_line(words))
        return words_failure(words, "the name of an element");
    element->is_vertex = words_accept(words, "vertex");
    element->is_face = !element->is_vertex && words_accept(words, "face");
    while (words->at < words->end && !strchr(" \t\r\n", *words->at))
        words->at++; /* another name */
    CHECK(words_whole(words, "the number of elements", &count));
    if (count < 0)
        return words_failure(words, "a number of elements that is not negative");
    element->count = (uint64_t)count;
    return SONJECT_OK;
}

static sonject_status read_format(struct words *words, struct header *header)
{
    if (words_accept(words, "ascii"))
        header->format = TEXT;
    else if (words_accept(words, "binary_little_endian"))
        header->format = LITTLE_ENDIAN_BYTES;
    else if (words_accept(words, "binary_big_endian"))
        header->format = BIG_ENDIAN_BYTES;
    else
        return words_failure(words, "ascii, binary_little_endian or binary_big_endian");
    return words_accept(words, "1.0") ? SONJECT_OK : words_failure(words, "version 1.0");
}

/* Reads the lines of the header, and leaves words at the first byte behind it. */
static sonject_status read_header(struct words *words, struct header *header)
{
    memset(header, 0, sizeof *header);
    if (!words_accept(words, "ply"))
        return words_failure(words, "'ply'");
    for (;;) {
        words_skip_line(words);
        if (!words_left(words, '\0'))
            return words_failure(words, "'end_header'");
        if (words_accept(words, "end_header"))
            break;
        if (words_accept(words, "format"))
            CHECK(read_format(words, header));
        else if (words_accept(words, "element"))
            CHECK(read_element(words, header));
        else if (words_accept(words, "property"))
            CHECK(read_property(words, header));
        else if (!words_accept(words, "comment") && !words_accept(words, "obj_info"))
            return words_failure(words, "a line of a PLY header");
    }
    words_skip_line(words);
    return SONJECT_OK;
}

static bool has_roles(const struct element *element, unsigned wanted)
{
    unsigned found = 0;
    for (int i = 0; i < element->property_count; i++)
        found |= 1u << element->properties[i].role;
    return (found & wanted) == wanted;
}

/* Checks that there are vertices with x, y, z and faces with corners, and that the file is long
 * enough for the header's counts. */
static sonject_status check_header(const struct words *words, const struct header *header)
{
    const struct mesh_soup *soup = words->soup;
    const uint64_t left = (uint64_t)(words->end - words->at);
    int vertices = 0;
    int faces = 0;
    for (int i = 0; i < header->element_count; i++) {
        const struct element *element = &header->elements[i];
        size_t least = 0; /* bytes that one element takes in the file */
        for (int k = 0; k < element->property_count; k++) {
            const struct property *property = &element->properties[k];
            const enum type type = property->is_list ? property->length_type : property->type;
            least += header->format == TEXT ? 2 : types[type].bytes;
        }
        vertices += element->is_vertex && has_roles(element, 1u << X | 1u << Y | 1u << Z);
        faces += element->is_face && has_roles(element, 1u << CORNERS);
        /* the last word of a text needs no blank behind it */
        if (least > 0 && element->count > (left + 1) / least)
            return input_failure(soup->report, soup->path,
                                 "the header says %llu elements of a kind, the file holds %llu "
                                 "at most: it is cut short, copy or export it again",
                                 (unsigned long long)element->count,
                                 (unsigned long long)(left / least));
    }
    if (vertices == 1 && faces == 1)
        return SONJECT_OK;
    return input_failure(soup->report, soup->path,
                         "the header has no %s: export the mesh as vertices and faces",
                         vertices != 1 ? "one element 'vertex' with x, y and z"
                                       : "one element 'face' with a list vertex_indices");
}

static double number_of_bytes(const char *at, enum type type, bool is_big_endian)
{
    const uint64_t bits =
        number_from_bytes((const unsigned char *)at, types[type].bytes, is_big_endian);
    double value = (double)bits;
    if (type == FLOAT64)
        memcpy(&value, &bits, sizeof value);
    else if (type == FLOAT32)
        value = single_from_bytes(at, is_big_endian);
    else if (type % 2 == 0 && bits >> (8 * types[type].bytes - 1) != 0)
        value -= ldexp(1.0, 8 * (int)types[type].bytes);
    return value;
}

/* Reads the next number of the body. Only binary files may give one that is not finite. */
static sonject_status next_number(struct words *words, const struct header *header, enum type type,
                                  double *number)
{
    const bool is_text = header->format == TEXT;
    const size_t left = (size_t)(words->end - words->at);
    if (is_text ? !words_left(words, '\0') : left < types[type].bytes)
        return input_failure(
            words->soup->report, words->soup->path,
            "it ends before all elements that its header promises: it is cut short, "
            "copy or export it again");
    if (is_text)
        return words_number(words, "a finite number", number);
    *number = number_of_bytes(words->at, type, header->format == BIG_ENDIAN_BYTES);
    words->at += types[type].bytes;
    return SONJECT_OK;
}

/* Reads a list's elements. Corners of a face make triangles. */
static sonject_status read_list(struct words *words, const struct header *header,
                                const struct property *property)
{
    struct mesh_soup *soup = words->soup;
    double length = 0.0;
    uint32_t fan[2];
    CHECK(next_number(words, header, property->length_type, &length));
    if (!(length >= 0.0) || length != floor(length))
        return words_failure(words, "the length of a list");
    for (size_t i = 0; (double)i < length; i++) {
        double number = 0.0;
        CHECK(next_number(words, header, property->type, &number));
        if (property->role != CORNERS)
            continue;
        if (!(number >= 0.0) || number >= 4294967295.0 || number != floor(number))
            return input_failure(soup->report, soup->path, "a face has vertex number %g", number);
        CHECK(mesh_soup_add_polygon_corner(soup, i, (uint32_t)number, fan));
    }
    if (property->role == CORNERS && length < 3.0)
        return input_failure(soup->report, soup->path, "a face has %g vertices", length);
    return SONJECT_OK;
}

static sonject_status read_one(struct words *words, const struct header *header,
                               const struct element *element)
{
    struct mesh_soup *soup = words->soup;
    double position[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < element->property_count; i++) {
        const struct property *property = &element->properties[i];
        double number = 0.0;
        CHECK(property->is_list ? read_list(words, header, property)
                                : next_number(words, header, property->type, &number));
        if (property->role >= X && property->role <= Z)
            position[property->role - X] = number;
    }
    if (!element->is_vertex)
        return SONJECT_OK;
    if (!isfinite(position[0]) || !isfinite(position[1]) || !isfinite(position[2]))
        return report_failure(soup->report, SONJECT_ERROR_INPUT,
                              "%s, vertex %zu: a coordinate is not a finite number; export the "
                              "mesh again",
                              soup->path, soup->vertices + 1);
    return mesh_soup_add_vertex(soup, position);
}

sonject_status ply_read(struct mesh_soup *soup, const char *bytes, size_t count)
{
    struct words words = {soup, bytes, bytes + count, 1};
    struct header header;
    CHECK(read_header(&words, &header));
    CHECK(check_header(&words, &header));
    for (int i = 0; i < header.element_count; i++) {
        const struct element *element = &header.elements[i];
        if (element->property_count == 0)
            continue; /* it takes no bytes */
        for (uint64_t k = 0; k < element->count; k++)
            CHECK(read_one(&words, &header, element));
    }
    if (header.format == TEXT ? words_left(&words, '\0') : words.at < words.end)
        return input_failure(soup->report, soup->path,
                             "it holds more than its header says: the header's counts are "
                             "wrong, export the mesh again");
    for (size_t i = 0; i < 3 * soup->triangles; i++)
        if (soup->corners[i] >= soup->vertices)
            return input_failure(soup->report, soup->path,
                                 "a face has vertex number %lu, but numbers run from 0 to %zu",
                                 (unsigned long)soup->corners[i], soup->vertices - 1);
    return SONJECT_OK;
}
