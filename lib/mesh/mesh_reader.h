/* Mesh files, inside: the triangles that readers gather, the words of text files, and the readers,
 * one a format. */
#ifndef SONJECT_MESH_MESH_READER_H
#define SONJECT_MESH_MESH_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct mesh;

/* Vertices and the triples of them that make triangles. Starts as zeros but for who is told of
 * failures, is for mesh_soup_clear. */
struct mesh_soup {
    struct report *report;
    const char *path;  /* for messages */
    double *positions; /* vertices x 3, in the file's unit and axes; owned */
    uint32_t *corners; /* triangles x 3: numbers of vertices; owned */
    size_t vertices, triangles;
    size_t vertex_capacity, triangle_capacity;
};

/* Adds one. Errors: INPUT (more than a mesh may have), MEMORY. */
sonject_status mesh_soup_add_vertex(struct mesh_soup *soup, const double position[3]);
sonject_status mesh_soup_add_triangle(struct mesh_soup *soup, uint32_t a, uint32_t b, uint32_t c);

/* Adds corner number `place` (0, 1, ...) of a polygon and, from the third on, the triangle that it
 * closes: a fan from the first corner, right for convex polygons. fan: scratch of the polygon. */
sonject_status mesh_soup_add_polygon_corner(struct mesh_soup *soup, size_t place, uint32_t corner,
                                            uint32_t fan[2]);
void mesh_soup_clear(struct mesh_soup *soup);

/* Makes the triangles of a soup a mesh, whose options are set and which has nothing else yet.
 * Errors: INPUT, MEMORY. *mesh is for mesh_clear, whatever is returned. */
sonject_status mesh_of_soup(const struct mesh_soup *soup, struct mesh *mesh);

/* A soup's vertices by position, so that equal ones are found. */
struct weld {
    struct mesh_soup *soup; /* borrowed; empty at first */
    double tolerance; /* distance of vertices that are one; 0: they are equal to the last bit */
    uint32_t *slots;  /* number of a vertex + 1, 0: free; owned */
    size_t capacity;  /* a power of two */
};

/* The number of the vertex at the position (-0 is 0), added to the soup unless one is there, or
 * within the tolerance: then the first of those. Errors: as mesh_soup_add_vertex. */
sonject_status weld_vertex(struct weld *weld, const double position[3], uint32_t *number);
void weld_clear(struct weld *weld);

/* Words and numbers of a text file, with the line that they stand on. */
struct words {
    struct mesh_soup *soup; /* what is read, and who is told */
    const char *at, *end;   /* *end is 0 */
    size_t line;            /* of at, from 1 */
};

/* Skips blanks; a backslash before a line's end is one. True if a word follows on this line. */
bool words_on_line(struct words *words);

/* Skips blanks, line ends and, unless comment is 0, lines from that character on. True if a word
 * follows. */
bool words_left(struct words *words, char comment);
void words_skip_line(struct words *words);

/* Takes the word, in any case of letters, if it is next on this line. */
bool words_accept(struct words *words, const char *word);

/* "path, line n: expected <what>, found '<word>'". Returns INPUT. */
sonject_status words_failure(const struct words *words, const char *what);

/* A finite number / a whole number that makes up the next word; `what` for the message. A whole
 * number may end in '/'. Errors: INPUT. */
sonject_status words_number(struct words *words, const char *what, double *number);
sonject_status words_whole(struct words *words, const char *what, int64_t *number);

/* The three coordinates of a vertex. */
sonject_status words_position(struct words *words, double position[3]);

/* One in single precision, as binary files have it. */
double single_from_bytes(const char *bytes, bool is_big_endian);

/* Readers: bytes are the whole file and one 0 byte beyond count. What they allocate is at most a
 * constant times the size of the file. Afterwards vertices are finite and corners are numbers of
 * vertices. Errors: INPUT (what is wrong, and where), MEMORY.
 *
 * STL, text or binary: vertices are welded. */
sonject_status stl_read(struct mesh_soup *soup, const char *bytes, size_t count);

/* Wavefront OBJ: its polygons; what else it may hold is passed over. */
sonject_status obj_read(struct mesh_soup *soup, const char *bytes, size_t count);

/* PLY, text or binary of either byte order: its vertices and faces. */
sonject_status ply_read(struct mesh_soup *soup, const char *bytes, size_t count);

/* The soup's file by its name's extension: .stl, .obj, .ply, in any case of letters. Errors: and
 * STORAGE, UNSUPPORTED (another extension). */
sonject_status mesh_file_read(struct mesh_soup *soup);

#endif
