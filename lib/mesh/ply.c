#include <math.h>
#include <string.h>

#include "io/byte_order.h"
#include "mesh/mesh_reader.h"
#include "mesh/ply_header.h"

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
