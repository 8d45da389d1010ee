#include "mesh/ply_header.h"

#include <string.h>

size_t ply_type_bytes(enum ply_type type)
{
    static const size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[type];
}

size_t ply_least_bytes(const struct ply_header *header, const struct ply_element *element)
{
    size_t bytes = 0;
    for (int i = 0; i < element->property_count; i++) {
        const struct ply_property *property = &element->properties[i];
        const enum ply_type type = property->is_list ? property->length_type : property->type;
        bytes += header->format == PLY_TEXT ? 2 : ply_type_bytes(type);
    }
    return bytes;
}

static sonject_status take_type(struct words *words, enum ply_type *type)
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
            if (words_take(words, types[i].name)) {
                *type = types[i].type;
                return SONJECT_OK;
            }
    return words_failure(words, "a type such as float or uchar");
}

static enum ply_role take_role(struct words *words, const struct ply_element *element, bool is_list)
{
    static const char *const axes[] = {"x", "y", "z"};
    if (!words_on_line(words))
        return PLY_OTHER;
    if (element->is_vertex && !is_list)
        for (int axis = 0; axis < 3; axis++)
            if (words_take(words, axes[axis]))
                return (enum ply_role)(PLY_X + axis);
    if (element->is_face && is_list &&
        (words_take(words, "vertex_indices") || words_take(words, "vertex_index")))
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
    property->is_list = words_on_line(words) && words_take(words, "list");
    if (property->is_list) {
        CHECK(take_type(words, &property->length_type));
        if (property->length_type >= PLY_FLOAT32)
            return words_failure(words, "a list whose length is a whole number");
    }
    CHECK(take_type(words, &property->type));
    property->role = take_role(words, element, property->is_list);
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
    element->is_vertex = words_take(words, "vertex");
    element->is_face = !element->is_vertex && words_take(words, "face");
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
    if (words_take(words, "ascii"))
        header->format = PLY_TEXT;
    else if (words_take(words, "binary_little_endian"))
        header->format = PLY_LITTLE_ENDIAN;
    else if (words_take(words, "binary_big_endian"))
        header->format = PLY_BIG_ENDIAN;
    else
        return words_failure(words, "ascii, binary_little_endian or binary_big_endian");
    if (!words_on_line(words) || !words_take(words, "1.0"))
        return words_failure(words, "version 1.0");
    return SONJECT_OK;
}

static sonject_status read_line(struct words *words, struct ply_header *header, bool *is_end)
{
    *is_end = words_take(words, "end_header");
    if (*is_end || words_take(words, "comment") || words_take(words, "obj_info"))
        return SONJECT_OK;
    if (words_take(words, "format"))
        return read_format(words, header);
    if (words_take(words, "element"))
        return read_element(words, header);
    if (words_take(words, "property"))
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

sonject_status ply_header_read(struct words *words, struct ply_header *header)
{
    bool is_end = false;
    memset(header, 0, sizeof *header);
    if (!words_on_line(words) || !words_take(words, "ply"))
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
