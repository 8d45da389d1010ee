#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "mesh/mesh_reader.h"

/* 10^7 triangles take some 0.5 GB as binary STL and up to five times that as text. */
#define FILE_BYTES_MAX ((size_t)4 << 30)

typedef sonject_status reader(struct report *report, const char *path, const char *bytes,
                              size_t count, struct mesh_soup *soup);

/* extension: in small letters. */
static bool ends_with(const char *path, const char *extension)
{
    const size_t length = strlen(path);
    const size_t tail = strlen(extension);
    if (length < tail)
        return false;
    for (size_t i = 0; i < tail; i++) {
        const char c = path[length - tail + i];
        if ((c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c) != extension[i])
            return false;
    }
    return true;
}

sonject_status mesh_file_read(struct report *report, const char *path, struct mesh_soup *soup)
{
    reader *read = ends_with(path, ".stl")   ? stl_read
                   : ends_with(path, ".obj") ? obj_read
                   : ends_with(path, ".ply") ? ply_read
                                             : NULL;
    char *bytes;
    size_t count;
    if (!read)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: meshes are read from STL, OBJ and PLY files; convert it to PLY",
                              path);
    CHECK(file_read_whole(report, path, FILE_BYTES_MAX, &bytes, &count));
    sonject_status status = read(report, path, bytes, count, soup);
    free(bytes);
    return status;
}
