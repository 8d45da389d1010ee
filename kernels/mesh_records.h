/* Records of triangle meshes that host and device share. All members have four bytes. The host
 * asserts every size (lib/mesh/hierarchy.c). Coordinates are metres in the mesh's frame: the
 * object's axes about the middle of the mesh's bounding box.
 *
 * The hierarchy has branches of up to 16 children and leaves of up to 16 triangles, each in up to
 * four groups of four. A packet of rays tests the groups' boxes of a leaf and then their members;
 * those of a branch are for packets of one ray. A ray that walks alone tests all 16 at once, one in
 * each lane. */
#ifndef SONJECT_KERNELS_MESH_RECORDS_H
#define SONJECT_KERNELS_MESH_RECORDS_H

#include "layout.h"

#define MESH_GROUPS 4
#define MESH_GROUP  4  /* children or triangles in a group */
#define MESH_SLOTS  16 /* MESH_GROUPS * MESH_GROUP */
#define MESH_LEVELS 16 /* most branches from the root to a leaf, the root included */

/* The padding of boxes, as a share of the mesh's radius. It exceeds the rounding of the tests of
 * boxes and triangles (MATH.md, "Meshes"), so that no order of the walk loses a triangle. */
#define MESH_PADDING 3.814697265625e-6f /* 2^-18 */

/* The coordinate of the boxes of empty slots, which no ray reaches. */
#define MESH_NOWHERE 1.0e30f

struct mesh_branch {
    float faces[BOX_FACES][MESH_SLOTS];
    RECORD_INT child[MESH_SLOTS]; /* >= 0: number of a branch; < 0: ~ number of a leaf */
    float group_faces[BOX_FACES][MESH_GROUPS];
    RECORD_INT children[MESH_GROUPS]; /* number in each group, in its first slots; 0: no group */
    RECORD_INT axes; /* 2 bits each: the axis along which the members of groups 0...3 ascend, then
                        that of the groups; 0: x, 1: y, 2: z */
    RECORD_INT unused[3];
};

/* The x, y and z of corners a, b, c of each triangle, anticlockwise as seen from outside. The
 * triangles fill the first slots. The other slots hold zeros, which no ray meets. */
struct mesh_leaf {
    float a[3][MESH_SLOTS], b[3][MESH_SLOTS], c[3][MESH_SLOTS];
    float group_faces[BOX_FACES][MESH_GROUPS];
    RECORD_INT triangles;
    RECORD_INT unused[7];
};

/* Unit normals of the smooth surface at the corners of one slot's triangle. */
struct mesh_corner_normals {
    float a[3], b[3], c[3];
};

/* One mesh among the arrays of all meshes. Any number of objects may refer to it. Branch 0 is the
 * root. A triangle's number is that of its leaf times MESH_SLOTS plus its slot. */
struct mesh_record {
    RECORD_WORD first_branch, branches;
    RECORD_WORD first_leaf, leaves;
    RECORD_WORD first_normals; /* leaves * MESH_SLOTS elements, if the mesh is smooth */
    RECORD_INT is_smooth;
    float radius;        /* m, about the frame's origin; it holds every corner */
    RECORD_INT is_sheet; /* not closed: facets have no inside and reflect on both sides */
};

#endif
