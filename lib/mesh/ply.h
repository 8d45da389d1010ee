/* The header of a PLY file: which elements it holds, and what each consists of. */
#ifndef SONJECT_MESH_PLY_H
#define SONJECT_MESH_PLY_H

#include "mesh/words.h"

#define PLY_ELEMENTS_MAX   16
#define PLY_PROPERTIES_MAX 64

enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT32,
    PLY_FLOAT64
};

enum ply_role {
    PLY_OTHER,
    PLY_X, /* PLY_X + axis: coordinate of a vertex */
    PLY_Y,
    PLY_Z,
    PLY_CORNERS /* a face's list of vertices */
};

struct ply_property {
    enum ply_role role;
    enum ply_type type; /* of a list: of its elements */
    enum ply_type length_type;
    bool is_list;
};

struct ply_element {
    uint64_t count;
    struct ply_property properties[PLY_PROPERTIES_MAX];
    int property_count;
    bool is_vertex, is_face;
};

struct ply_header {
    enum {
        PLY_TEXT,
        PLY_LITTLE_ENDIAN,
        PLY_BIG_ENDIAN
    } format;
    struct ply_element elements[PLY_ELEMENTS_MAX];
    int element_count;
};

#endif
