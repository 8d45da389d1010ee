/* Triangles as a file lists them, and the search for vertices among them that are one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "mesh/hierarchy.h"
#include "mesh/mesh_reader.h"

/* The most vertices: as many as files without shared ones need for the most triangles. */
#define VERTICES_MAX ((size_t)1 << 28)

#define CELL_TOLERANCES 64.0 /* side of a cell of space, in tolerances */

void mesh_soup_clear(struct mesh_soup *soup)
{
    free(soup->positions);
    free(soup->corners);
    free(soup->polygons);
    memset(soup, 0, sizeof *soup);
}

static sonject_status check_count(const struct mesh_soup *soup, size_t count, size_t most)
{
    if (count < most)
        return SONJECT_OK;
    return input_failure(soup->report, soup->path,
                         "a mesh may have %zu triangles and %zu vertices, and this one has "
                         "more: simplify it",
                         MESH_TRIANGLES_MAX, VERTICES_MAX);
}

sonject_status mesh_soup_add_vertex(struct mesh_soup *soup, const double position[3])
{
    CHECK(check_count(soup, soup->vertices, VERTICES_MAX));
    CHECK_MEMORY(soup->report,
                 mesh_reserve((void **)&soup->positions, soup->vertices, &soup->vertex_capacity,
                              3 * sizeof *soup->positions),
                 soup->path);
    memcpy(&soup->positions[3 * soup->vertices++], position, 3 * sizeof *position);
    return SONJECT_OK;
}

sonject_status mesh_soup_add_triangle(struct mesh_soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t triangle[3] = {a, b, c};
    CHECK(check_count(soup, soup->triangles, MESH_TRIANGLES_MAX));
    CHECK_MEMORY(soup->report,
                 mesh_reserve((void **)&soup->corners, soup->triangles, &soup->triangle_capacity,
                              3 * sizeof *soup->corners),
                 soup->path);
    memcpy(&soup->corners[3 * soup->triangles++], triangle, sizeof triangle);
    return SONJECT_OK;
}

static uint64_t mix(uint64_t value)
{
    value ^= value >> 32;
    value *= UINT64_C(0xd6e8feb86659fd93);
    value ^= value >> 32;
    value *= UINT64_C(0xd6e8feb86659fd93);
    return value ^ value >> 32;
}

/* Returns the slot of a position by its bits, or by the cell of space that it is in. aside: steps
 * of the tolerance, by which a position near a cell's wall is sought beyond it, too. */
static size_t slot_of(const struct weld *weld, const double position[3], const int aside[3])
{
    uint64_t key[3];
    for (int axis = 0; axis < 3; axis++) {
        double place = position[axis];
        if (weld->tolerance > 0.0)
            place = floor((place + aside[axis] * weld->tolerance) /
                          (CELL_TOLERANCES * weld->tolerance)) +
                    0.0;
        memcpy(&key[axis], &place, sizeof key[axis]);
    }
    const uint64_t hash = mix(key[0] + mix(key[1] + mix(key[2] + UINT64_C(0x9e3779b97f4a7c15))));
    return (size_t)hash & (weld->capacity - 1);
}

static bool is_one(const struct weld *weld, const double a[3], const double b[3])
{
    double square = 0.0;
    for (int axis = 0; axis < 3; axis++)
        square += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return weld->tolerance > 0.0 ? square <= weld->tolerance * weld->tolerance
                                 : memcmp(a, b, 3 * sizeof *a) == 0;
}

static void set_vertex(struct weld *weld, size_t vertex)
{
    size_t slot = slot_of(weld, &weld->soup->positions[3 * vertex], (const int[3]){0, 0, 0});
    while (weld->slots[slot] != 0)
        slot = (slot + 1) & (weld->capacity - 1);
    weld->slots[slot] = (uint32_t)(vertex + 1);
}

static bool widen(struct weld *weld)
{
    struct weld wider = *weld;
    wider.capacity = weld->capacity > 0 ? 4 * weld->capacity : 1024;
    wider.slots = allocate_array(wider.capacity, sizeof *wider.slots);
    if (!wider.slots)
        return false;
    for (size_t i = 0; i < weld->soup->vertices; i++)
        set_vertex(&wider, i);
    free(weld->slots);
    *weld = wider;
    return true;
}

/* Returns the vertex that is one with the position, counted from 1; 0 if there is none. */
static uint32_t find_vertex(const struct weld *weld, const double position[3])
{
    const int most = weld->tolerance > 0.0 ? 1 : 0;
    size_t before[27];
    size_t count = 0;
    for (int i = 0; i < (most ? 27 : 1); i++) {
        const int aside[3] = {most * (i % 3 - 1), most * (i / 3 % 3 - 1), most * (i / 9 - 1)};
        size_t slot = slot_of(weld, position, aside);
        size_t k = 0;
        while (k < count && before[k] != slot)
            k++;
        if (k < count) /* most steps stay in one cell */
            continue;
        before[count++] = slot;
        for (; weld->slots[slot] != 0; slot = (slot + 1) & (weld->capacity - 1)) {
            const uint32_t found = weld->slots[slot];
            if (is_one(weld, &weld->soup->positions[3 * (size_t)(found - 1)], position))
                return found;
        }
    }
    return 0;
}

sonject_status weld_vertex(struct weld *weld, const double position[3], uint32_t *number)
{
    struct mesh_soup *soup = weld->soup;
    const double point[3] = {position[0] + 0.0, position[1] + 0.0, position[2] + 0.0};
    CHECK_MEMORY(soup->report, 2 * soup->vertices < weld->capacity || widen(weld), soup->path);
    uint32_t found = find_vertex(weld, point);
    if (found == 0) {
        CHECK(mesh_soup_add_vertex(soup, point));
        found = (uint32_t)soup->vertices;
        set_vertex(weld, found - 1);
    }
    *number = found - 1;
    return SONJECT_OK;
}

void weld_clear(struct weld *weld)
{
    free(weld->slots);
    memset(weld, 0, sizeof *weld);
}
