/* Records of the hierarchy over many objects that host and device share. Four-byte members only;
 * the host asserts every size (lib/trace/object_tree.c). */
#ifndef SONJECT_KERNELS_OBJECT_TREE_RECORDS_H
#define SONJECT_KERNELS_OBJECT_TREE_RECORDS_H

#include "record_types.h"

#define OBJECTS_IN_LOOP    16 /* so many or fewer are tested one after the other */
#define OBJECTS_IN_PACKET  40 /* likewise, by rays that run apart from each other */
#define OBJECT_TREE_SLOTS  16 /* children of a branch */
#define OBJECT_TREE_LEVELS 6  /* most branches from the root to an object, the root included */

/* Boxes are padded by this fraction of the distance from which rays may come: more than the
 * rounding of all tests (MATH.md, "Many objects"). */
#define OBJECT_TREE_PADDING 3.814697265625e-6f /* 2^-18 */

/* Boxes of the children, about the tree's middle, m. */
struct object_branch {
    float lower_x[OBJECT_TREE_SLOTS], lower_y[OBJECT_TREE_SLOTS], lower_z[OBJECT_TREE_SLOTS];
    float upper_x[OBJECT_TREE_SLOTS], upper_y[OBJECT_TREE_SLOTS], upper_z[OBJECT_TREE_SLOTS];
    RECORD_INT child[OBJECT_TREE_SLOTS]; /* >= 0: number of a branch; < 0: ~ number of an object */
};

/* Its branches lie behind it, the root first. */
struct object_tree_record {
    float middle_x, middle_y, middle_z; /* m, in the frame */
    float farthest; /* m from the middle: rays that start farther away test every object */
    float slack;    /* m: more than the rounding of distances */
    float grain;    /* m: rays no further apart than this are tested together */
    float radius;   /* m about the middle: holds every box */
    RECORD_INT branches;
};

#endif
