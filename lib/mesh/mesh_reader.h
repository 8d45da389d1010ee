/* Readers of mesh files, one a format. Each fills a zeroed soup, to be given to mesh_soup_clear
 * whatever it returns. bytes: the whole file and one 0 byte beyond count. What they allocate is at
 * most a constant times the size of the file. Vertices are finite and corners are numbers of
 * vertices. Errors: INPUT (what is wrong, and where), MEMORY. */
#ifndef SONJECT_MESH_READER_H
#define SONJECT_MESH_READER_H

#include "mesh/soup.h"

/* STL, text or binary. Vertices are welded. */
sonject_status stl_read(struct report *report, const char *path, const char *bytes, size_t count,
                        struct mesh_soup *soup);

/* Wavefront OBJ: its polygons; what else it may hold is passed over. */
sonject_status obj_read(struct report *report, const char *path, const char *bytes, size_t count,
                        struct mesh_soup *soup);

/* PLY, text or binary of either byte order: its vertices and faces. */
sonject_status ply_read(struct report *report, const char *path, const char *bytes, size_t count,
                        struct mesh_soup *soup);

/* The file by its name's extension: .stl, .obj, .ply, in any case of letters. Errors: and STORAGE,
 * UNSUPPORTED (another extension). */
sonject_status mesh_file_read(struct report *report, const char *path, struct mesh_soup *soup);

#endif
