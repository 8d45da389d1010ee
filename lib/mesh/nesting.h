/* The outer side of a mesh's closed pieces. */
#ifndef SONJECT_MESH_NESTING_H
#define SONJECT_MESH_NESTING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A closed piece, whose triangles run alike. */
struct mesh_piece {
    const uint32_t *triangles; /* their numbers; borrowed */
    size_t count;
    double volume;            /* times six; negative: it faces inward */
    float lower[3], upper[3]; /* its bounding box, once mesh_find_outsides has run */
    bool must_turn;           /* false at first */
};

/* Finds the pieces that must turn: those that face inward and lie in no other piece, and what they
 * hold themselves. vertices, corners: as for mesh_topology_find. */
void mesh_find_outsides(const float *vertices, const uint32_t *corners, struct mesh_piece *pieces,
                        size_t count);

#endif
