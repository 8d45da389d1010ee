/* The inside of reading mesh files: the soup of triangles that readers gather, the words of text
 * files, and the readers, one a format. */
#ifndef SONJECT_MESH_MESH_READER_H
#define SONJECT_MESH_MESH_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct mesh;

/* A face of more than three corners: its triangles, at first a fan about its first corner. */
struct mesh_polygon {
    size_t first, triangles;
};

/* Vertices, and triples of them that make triangles. A soup starts as zeros except for report and
 * path, and ends with mesh_soup_clear. */
struct mesh_soup {
    struct report *report;
    const char *path;              /* for messages */
    double *positions;             /* vertices x 3, in the file's unit and axes; owned */
    uint32_t *corners;             /* triangles x 3: numbers of vertices; owned */
    struct mesh_polygon *polygons; /* owned */
    size_t vertices, triangles, polygon_count;
    size_t vertex_capacity, triangle_capacity, polygon_capacity;
};

/* Adds one vertex, or triangle. Errors: INPUT (more than a mesh may have), MEMORY. */
sonject_status mesh_soup_add_vertex(struct mesh_soup *soup, const double position[3]);
sonject_status mesh_soup_add_triangle(struct mesh_soup *soup, uint32_t a, uint32_t b, uint32_t c);

/* Adds corner number `place` (0, 1, ...) of a polygon. From the third on, it closes a triangle of a
 * fan from the first corner. fan: scratch of the polygon. Errors: as mesh_soup_add_triangle. */
sonject_status mesh_soup_add_polygon_corner(struct mesh_soup *soup, size_t place, uint32_t corner,
                                            uint32_t fan[2]);

/* Cuts polygons that are not convex into other triangles, of the same number, which lie inside
 * them. All corners must be numbers of vertices. Errors: INPUT (a polygon that crosses itself, or
 * has too many corners), MEMORY. */
sonject_status mesh_soup_cut_polygons(struct mesh_soup *soup);
void mesh_soup_clear(struct mesh_soup *soup);

/* Makes a mesh of the triangles of a soup. Only the options of *mesh are set before. Errors: INPUT,
 * MEMORY. *mesh is for mesh_clear, also on failure. */
sonject_status mesh_of_soup(const struct mesh_soup *soup, struct mesh *mesh);

/* A table of a soup's vertices by position, which finds equal ones. */
struct weld {
    struct mesh_soup *soup; /* borrowed; empty at first */
    double tolerance;       /* distance of vertices that count as one; 0: equal to the last bit */
    uint32_t *slots;        /* number of a vertex + 1, 0: free; owned */
    size_t capacity;        /* a power of two */
};

/* Finds the number of the vertex at the position (-0 is 0). It is the first vertex there, or within
 * the tolerance, else a new vertex of the soup. Errors: as mesh_soup_add_vertex. */
sonject_status weld_vertex(struct weld *weld, const double position[3], uint32_t *number);
void weld_clear(struct weld *weld);

/* The words and numbers of a text file, with the line that they stand on. */
struct words {
    struct mesh_soup *soup; /* takes what is read and reports failures */
    const char *at, *end;   /* *end is 0 */
    size_t line;            /* line of at, from 1 */
};

/* Skips blanks, and line ends after a backslash. Returns whether a word follows on this line. */
bool words_on_line(struct words *words);

/* Skips blanks, line ends and, unless comment is 0, lines from that character on. Returns whether a
 * word is left. */
bool words_left(struct words *words, char comment);
void words_skip_line(struct words *words);

/* Takes the word, in any case of letters, if it is next on this line. Returns whether it was. */
bool words_accept(struct words *words, const char *word);

/* Reports "path, line n: expected <what>, found '<word>'". Returns INPUT. */
sonject_status words_failure(const struct words *words, const char *what);

/* Reads a finite number, or a whole number, that makes up the next word. `what` is for the message.
 * A whole number may end in '/'. Errors: INPUT. */
sonject_status words_number(struct words *words, const char *what, double *number);
sonject_status words_whole(struct words *words, const char *what, int64_t *number);

/* Reads the three coordinates of a vertex. Errors: INPUT. */
sonject_status words_position(struct words *words, double position[3]);

/* Returns a number of single precision, as binary files have it. */
double single_from_bytes(const char *bytes, bool is_big_endian);

/* Readers. bytes: the whole file and one 0 byte beyond count. They allocate at most a constant
 * times the size of the file. Afterwards vertices are finite and corners are numbers of vertices.
 * Errors: INPUT (what is wrong, and where), MEMORY.
 *
 * Reads STL, text or binary. Vertices are welded. */
sonject_status stl_read(struct mesh_soup *soup, const char *bytes, size_t count);

/* Reads the polygons of Wavefront OBJ and passes over all else. */
sonject_status obj_read(struct mesh_soup *soup, const char *bytes, size_t count);

/* Reads the vertices and faces of PLY, text or binary of either byte order. */
sonject_status ply_read(struct mesh_soup *soup, const char *bytes, size_t count);

/* Reads the soup's file by its extension, .stl, .obj or .ply in any case of letters. Errors: those
 * of the readers, STORAGE, UNSUPPORTED (another extension). */
sonject_status mesh_file_read(struct mesh_soup *soup);

#endif
