/* Where to cut a set of triangles in two, so that rays have least to test. */
#ifndef SONJECT_MESH_SPLIT_H
#define SONJECT_MESH_SPLIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A box as its lower corner and the negative of its upper one (0...2 and 4...6), so that one
 * minimum of all eight numbers unites two boxes. 3 and 7 are unused and 0. */
struct split_box {
    float edges[8];
};

/* A triangle's box and number. */
struct split_triangle {
    struct split_box box;
    uint32_t number;
};

/* Triangles [first, last) of an array. */
struct split_range {
    size_t first, last;
    struct split_box box; /* of the triangles */
};

void split_box_unite(struct split_box *box, const struct split_box *other);
struct split_box split_box_empty(void);

/* Writes a box, its faces moved outwards, into a slot of a record with lower_x[]...upper_z[]. */
#define SPLIT_BOX_STORE(box, padding, record, slot)                                                \
    do {                                                                                           \
        (record)->lower_x[slot] = (box)->edges[0] - (padding);                                     \
        (record)->lower_y[slot] = (box)->edges[1] - (padding);                                     \
        (record)->lower_z[slot] = (box)->edges[2] - (padding);                                     \
        (record)->upper_x[slot] = -(box)->edges[4] + (padding);                                    \
        (record)->upper_y[slot] = -(box)->edges[5] + (padding);                                    \
        (record)->upper_z[slot] = -(box)->edges[6] + (padding);                                    \
    } while (0)

/* Half the surface; 0 for an empty box. */
float split_box_area(const struct split_box *box);

/* The box of all triangles of the range. */
struct split_box split_box_of(const struct split_triangle *triangles, size_t first, size_t last);

/* Cuts the range (2 triangles or more) in two where the surface-area heuristic says, rearranging
 * its triangles; where that gives a half of more than half_limit, or all middles are the same, at
 * the median. */
void split_cut(struct split_triangle *triangles, const struct split_range *range, size_t half_limit,
               struct split_range *lower, struct split_range *upper);

/* Cuts the range behind its first lower_count triangles (1...count - 1) by their middles along the
 * box's longest axis. */
void split_cut_at(struct split_triangle *triangles, const struct split_range *range,
                  size_t lower_count, struct split_range *lower, struct split_range *upper);

#endif
