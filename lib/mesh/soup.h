/* Triangles as they come from a file: vertices and the triples of them that make triangles. */
#ifndef SONJECT_MESH_SOUP_H
#define SONJECT_MESH_SOUP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct mesh_soup {
    double *positions; /* vertices x 3, in the file's unit and axes; owned */
    uint32_t *corners; /* triangles x 3: numbers of vertices; owned */
    size_t vertices, triangles;
    size_t vertex_capacity, triangle_capacity;
};

/* Most of them: what a mesh may have, and as many vertices as files without shared ones need. */
#define SOUP_TRIANGLES_MAX ((size_t)1 << 26)
#define SOUP_VERTICES_MAX  ((size_t)1 << 28)

void mesh_soup_clear(struct mesh_soup *soup);

/* Adds one. False when memory is out or there are too many: mesh_soup_failure says which. */
bool mesh_soup_add_vertex(struct mesh_soup *soup, const double position[3]);
bool mesh_soup_add_triangle(struct mesh_soup *soup, uint32_t a, uint32_t b, uint32_t c);

/* Adds corner number `place` (0, 1, ...) of a polygon and, from the third on, the triangle that it
 * closes: a fan from the first corner, right for convex polygons. fan: scratch of the polygon. */
bool mesh_soup_add_polygon_corner(struct mesh_soup *soup, size_t place, uint32_t corner,
                                  uint32_t fan[2]);

/* The message for what could not be added. Returns INPUT (too many) or MEMORY. */
sonject_status mesh_soup_failure(struct report *report, const char *path,
                                 const struct mesh_soup *soup);

/* Vertices by position, so that equal ones are found. */
struct weld {
    uint32_t *slots;  /* number of a vertex + 1, 0: free; owned */
    size_t capacity;  /* a power of two */
    double tolerance; /* distance of vertices that are one; 0: they are equal to the last bit */
};

/* The number of the vertex at the position (-0 is 0), added to the soup unless one is there, or
 * within the tolerance: then the first of those. Start with an empty weld and an empty soup. False
 * when memory is out. */
bool weld_vertex(struct weld *weld, struct mesh_soup *soup, const double position[3],
                 uint32_t *number);
void weld_clear(struct weld *weld);

#endif
