#include "mesh/ply.h"

#include <math.h>
#include <string.h>

#include "base/byte_order.h"
#include "mesh/mesh_reader.h"

static size_t ply_type_bytes(enum ply_type type)
{
    static const size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[type];
}

/* Fewest bytes that one of the elements takes in the file. */
static size_t ply_least_bytes(const struct ply_header *header, const struct ply_element *element)
{
    size_t bytes = 0;
    for (int i = 0; i < element->property_count; i++) {
        const struct ply_property *property = &element->properties[i];
        const enum ply_type type = property->is_list ? property->length_type : property->type;
        bytes += header->format == PLY_TEXT ? 2 : ply_type_bytes(type);
    }
    return bytes;
}

static sonject_status accept_type(struct words *words, enum ply_type *type)
{
    static const struct {
        const char *name;
        enum ply_type type;
    } types[] = {{"char", PLY_INT8},      {"int8", PLY_INT8},       {"uchar", PLY_UINT8},
                 {"uint8", PLY_UINT8},    {"short", PLY_INT16},     {"int16", PLY_INT16},
                 {"ushort", PLY_UINT16},  {"uint16", PLY_UINT16},   {"int", PLY_INT32},
                 {"int32", PLY_INT32},    {"uint", PLY_UINT32},     {"uint32", PLY_UINT32},
                 {"float", PLY_FLOAT32},  {"float32", PLY_FLOAT32}, {"double", PLY_FLOAT64},
                 {"float64", PLY_FLOAT64}};
    if (words_on_line(words))
        for (size_t i = 0; i < sizeof types / sizeof *types; i++)
            if (words_accept(words, types[i].name)) {
                *type = types[i].type;
                return SONJECT_OK;
            }
    return words_failure(words, "a type such as float or uchar");
}

static enum ply_role accept_role(struct words *words, const struct ply_element *element,
                                 bool is_list)
{
    static const char *const axes[] = {"x", "y", "z"};
    if (!words_on_line(words))
        return PLY_OTHER;
    if (element->is_vertex && !is_list)
        for (int axis = 0; axis < 3; axis++)
            if (words_accept(words, axes[axis]))
                return (enum ply_role)(PLY_X + axis);
    if (element->is_face && is_list &&
        (words_accept(words, "vertex_indices") || words_accept(words, "vertex_index")))
        return PLY_CORNERS;
    return PLY_OTHER;
}

/* What follows "property". */
static sonject_status read_property(struct words *words, struct ply_header *header)
{
    if (header->element_count == 0)
        return words_failure(words, "'element' before 'property'");
    struct ply_element *element = &header->elements[header->element_count - 1];
    if (element->property_count == PLY_PROPERTIES_MAX)
        return words_failure(words, "at most 64 properties of an element");
    struct ply_property *property = &element->properties[element->property_count++];
    property->is_list = words_on_line(words) && words_accept(words, "list");
    if (property->is_list) {
        CHECK(accept_type(words, &property->length_type));
        if (property->length_type >= PLY_FLOAT32)
            return words_failure(words, "a list whose length is a whole number");
    }
    CHECK(accept_type(words, &property->type));
    property->role = accept_role(words, element, property->is_list);
    if (property->role == PLY_CORNERS && property->type >= PLY_FLOAT32)
        return words_failure(words, "vertex numbers that are whole");
    return SONJECT_OK;
}

/* What follows "element". */
static sonject_status read_element(struct words *words, struct ply_header *header)
{
    if (header->element_count == PLY_ELEMENTS_MAX)
        return words_failure(words, "at most 16 elements");
    struct ply_element *element = &header->elements[header->element_count++];
    int64_t count = 0;
    if (!words_on_line(words))
        return words_failure(words, "the name of an element");
    element->is_vertex = words_accept(words, "vertex");
    element->is_face = !element->is_vertex && words_accept(words, "face");
    while (words->at < words->end && !strchr(" \t\r\n", *words->at))
        words->at++; /* any other name */
    CHECK(words_whole(words, "the number of elements", &count));
    if (count < 0)
        return words_failure(words, "a number of elements that is not negative");
    element->count = (uint64_t)count;
    return SONJECT_OK;
}

static sonject_status read_format(struct words *words, struct ply_header *header)
{
    if (!words_on_line(words))
        return words_failure(words, "the name of a format");
    if (words_accept(words, "ascii"))
        header->format = PLY_TEXT;
    else if (words_accept(words, "binary_little_endian"))
        header->format = PLY_LITTLE_ENDIAN;
    else if (words_accept(words, "binary_big_endian"))
        header->format = PLY_BIG_ENDIAN;
    else
        return words_failure(words, "ascii, binary_little_endian or binary_big_endian");
    if (!words_on_line(words) || !words_accept(words, "1.0"))
        return words_failure(words, "version 1.0");
    return SONJECT_OK;
}

static sonject_status read_line(struct words *words, struct ply_header *header, bool *is_end)
{
    *is_end = words_accept(words, "end_header");
    if (*is_end || words_accept(words, "comment") || words_accept(words, "obj_info"))
        return SONJECT_OK;
    if (words_accept(words, "format"))
        return read_format(words, header);
    if (words_accept(words, "element"))
        return read_element(words, header);
    if (words_accept(words, "property"))
        return read_property(words, header);
    return words_failure(words, "a line of a PLY header");
}

static bool has_roles(const struct ply_element *element, unsigned wanted)
{
    unsigned found = 0;
    for (int i = 0; i < element->property_count; i++)
        found |= 1u << element->properties[i].role;
    return (found & wanted) == wanted;
}

static sonject_status check_header(const struct words *words, const struct ply_header *header)
{
    const uint64_t left = (uint64_t)(words->end - words->at);
    int vertices = 0;
    int faces = 0;
    for (int i = 0; i < header->element_count; i++) {
        const struct ply_element *element = &header->elements[i];
        const size_t least = ply_least_bytes(header, element);
        vertices +=
            element->is_vertex && has_roles(element, 1u << PLY_X | 1u << PLY_Y | 1u << PLY_Z);
        faces += element->is_face && has_roles(element, 1u << PLY_CORNERS);
        /* the last word of a text needs no blank behind it */
        if (least > 0 && element->count > (left + 1) / least)
            return report_failure(
                words->report, SONJECT_ERROR_INPUT,
                "%s: the header says %llu elements of a kind, the file holds %llu "
                "at most: it is cut short, copy or export it again",
                words->path, (unsigned long long)element->count,
                (unsigned long long)(left / least));
    }
    if (vertices == 1 && faces == 1)
        return SONJECT_OK;
    return report_failure(words->report, SONJECT_ERROR_INPUT,
                          "%s: the header has no %s: export the mesh as vertices and faces",
                          words->path,
                          vertices != 1 ? "one element 'vertex' with x, y and z"
                                        : "one element 'face' with a list vertex_indices");
}

/* Reads the header; words then stands at the first byte behind it. The header has vertices with
 * x, y, z and faces with corners, and the file is long enough for its counts. Errors: INPUT. */
static sonject_status ply_header_read(struct words *words, struct ply_header *header)
{
    bool is_end = false;
    memset(header, 0, sizeof *header);
    if (!words_on_line(words) || !words_accept(words, "ply"))
        return words_failure(words, "'ply'");
    words_skip_line(words);
    while (!is_end) {
        if (!words_left(words, '\0'))
            return words_failure(words, "'end_header'");
        CHECK(read_line(words, header, &is_end));
        words_skip_line(words);
    }
    return check_header(words, header);
}

static sonject_status cut_short(const struct words *words)
{
    return report_failure(
        words->report, SONJECT_ERROR_INPUT,
        "%s: it ends before all elements that its header promises: it is cut short, "
        "copy or export it again",
        words->path);
}

static double number_of_bytes(const char *at, enum ply_type type, bool is_big_endian)
{
    const uint64_t bits =
        number_from_bytes((const unsigned char *)at, ply_type_bytes(type), is_big_endian);
    const uint32_t low = (uint32_t)bits;
    float single;
    double value;
    switch (type) {
    case PLY_INT8:
        return bits < 0x80 ? (double)bits : (double)bits - 256.0;
    case PLY_INT16:
        return bits < 0x8000 ? (double)bits : (double)bits - 65536.0;
    case PLY_INT32:
        return bits < 0x80000000u ? (double)bits : (double)bits - 4294967296.0;
    case PLY_FLOAT32:
        memcpy(&single, &low, sizeof single);
        return (double)single;
    case PLY_FLOAT64:
        memcpy(&value, &bits, sizeof value);
        return value;
    default:
        return (double)bits;
    }
}

/* The next number of the body; not finite ones only from binary files. */
static sonject_status next_number(struct words *words, const struct ply_header *header,
                                  enum ply_type type, double *number)
{
    if (header->format == PLY_TEXT) {
        if (!words_left(words, '\0'))
            return cut_short(words);
        return words_number(words, "a finite number", number);
    }
    const size_t bytes = ply_type_bytes(type);
    if ((size_t)(words->end - words->at) < bytes)
        return cut_short(words);
    *number = number_of_bytes(words->at, type, header->format == PLY_BIG_ENDIAN);
    words->at += bytes;
    return SONJECT_OK;
}

/* A list's elements; those of faces make triangles. */
static sonject_status read_list(struct words *words, const struct ply_header *header,
                                const struct ply_property *property, struct mesh_soup *soup)
{
    double length = 0.0;
    uint32_t fan[2];
    CHECK(next_number(words, header, property->length_type, &length));
    if (!(length >= 0.0) || length != floor(length))
        return words_failure(words, "the length of a list");
    for (size_t i = 0; (double)i < length; i++) {
        double number = 0.0;
        CHECK(next_number(words, header, property->type, &number));
        if (property->role != PLY_CORNERS)
            continue;
        if (!(number >= 0.0) || number >= 4294967295.0 || number != floor(number))
            return report_failure(words->report, SONJECT_ERROR_INPUT,
                                  "%s: a face has vertex number %g", words->path, number);
        if (!mesh_soup_add_polygon_corner(soup, i, (uint32_t)number, fan))
            return mesh_soup_failure(words->report, words->path, soup);
    }
    if (property->role == PLY_CORNERS && length < 3.0)
        return report_failure(words->report, SONJECT_ERROR_INPUT, "%s: a face has %g vertices",
                              words->path, length);
    return SONJECT_OK;
}

static sonject_status read_one(struct words *words, const struct ply_header *header,
                               const struct ply_element *element, struct mesh_soup *soup)
{
    double position[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < element->property_count; i++) {
        const struct ply_property *property = &element->properties[i];
        double number = 0.0;
        CHECK(property->is_list ? read_list(words, header, property, soup)
                                : next_number(words, header, property->type, &number));
        if (property->role >= PLY_X && property->role <= PLY_Z)
            position[property->role - PLY_X] = number;
    }
    if (!element->is_vertex)
        return SONJECT_OK;
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(position[axis]))
            return report_failure(words->report, SONJECT_ERROR_INPUT,
                                  "%s, vertex %zu: a coordinate is not a finite number; export the "
                                  "mesh again",
                                  words->path, soup->vertices + 1);
    return mesh_soup_add_vertex(soup, position)
               ? SONJECT_OK
               : mesh_soup_failure(words->report, words->path, soup);
}

static sonject_status check_corners(struct report *report, const char *path,
                                    const struct mesh_soup *soup)
{
    for (size_t i = 0; i < 3 * soup->triangles; i++)
        if (soup->corners[i] >= soup->vertices)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: a face has vertex number %lu, but numbers run from 0 to %zu",
                                  path, (unsigned long)soup->corners[i], soup->vertices - 1);
    return SONJECT_OK;
}

sonject_status ply_read(struct report *report, const char *path, const char *bytes, size_t count,
                        struct mesh_soup *soup)
{
    struct words words = {report, path, bytes, bytes + count, 1};
    struct ply_header header;
    sonject_status status = ply_header_read(&words, &header);
    for (int i = 0; i < header.element_count && status == SONJECT_OK; i++) {
        const struct ply_element *element = &header.elements[i];
        if (element->property_count == 0)
            continue; /* takes no bytes */
        for (uint64_t k = 0; k < element->count && status == SONJECT_OK; k++)
            status = read_one(&words, &header, element, soup);
    }
    if (status == SONJECT_OK &&
        (header.format == PLY_TEXT ? words_left(&words, '\0') : words.at < words.end))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: it holds more than its header says: the header's counts are "
                                "wrong, export the mesh again",
                                path);
    return status == SONJECT_OK ? check_corners(report, path, soup) : status;
}
