#include "mesh/soup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define CELL_TOLERANCES 64.0 /* a cell of space, in which vertices are looked for */

void mesh_soup_clear(struct mesh_soup *soup)
{
    free(soup->positions);
    free(soup->corners);
    memset(soup, 0, sizeof *soup);
}

/* Makes room for one triple more. */
static bool reserve(void **array, size_t count, size_t most, size_t *capacity, size_t size)
{
    size_t bytes;
    if (count < *capacity && count < most)
        return true;
    const size_t larger = *capacity + *capacity / 2 + 64;
    if (count >= most || !size_multiply(larger, 3 * size, &bytes))
        return false;
    void *moved = realloc(*array, bytes);
    if (!moved)
        return false;
    *array = moved;
    *capacity = larger;
    return true;
}

bool mesh_soup_add_vertex(struct mesh_soup *soup, const double position[3])
{
    if (!reserve((void **)&soup->positions, soup->vertices, SOUP_VERTICES_MAX,
                 &soup->vertex_capacity, sizeof *soup->positions))
        return false;
    memcpy(&soup->positions[3 * soup->vertices], position, 3 * sizeof *position);
    soup->vertices++;
    return true;
}

bool mesh_soup_add_triangle(struct mesh_soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t triangle[3] = {a, b, c};
    if (!reserve((void **)&soup->corners, soup->triangles, SOUP_TRIANGLES_MAX,
                 &soup->triangle_capacity, sizeof *soup->corners))
        return false;
    memcpy(&soup->corners[3 * soup->triangles], triangle, sizeof triangle);
    soup->triangles++;
    return true;
}

bool mesh_soup_add_polygon_corner(struct mesh_soup *soup, size_t place, uint32_t corner,
                                  uint32_t fan[2])
{
    if (place >= 2 && !mesh_soup_add_triangle(soup, fan[0], fan[1], corner))
        return false;
    fan[place == 0 ? 0 : 1] = corner;
    return true;
}

sonject_status mesh_soup_failure(struct report *report, const char *path,
                                 const struct mesh_soup *soup)
{
    if (soup->triangles < SOUP_TRIANGLES_MAX && soup->vertices < SOUP_VERTICES_MAX)
        return report_out_of_memory(report, path);
    return report_failure(
        report, SONJECT_ERROR_INPUT,
        "%s: a mesh may have %zu triangles and %zu vertices, and this one has more: "
        "simplify it",
        path, SOUP_TRIANGLES_MAX, SOUP_VERTICES_MAX);
}

static uint64_t mix(uint64_t value)
{
    value ^= value >> 32;
    value *= UINT64_C(0xd6e8feb86659fd93);
    value ^= value >> 32;
    value *= UINT64_C(0xd6e8feb86659fd93);
    return value ^ value >> 32;
}

/* What positions that may be one have in common: their bits, or a cell of space. A position near a
 * cell's wall is looked for beyond it, too: `aside` steps of the tolerance. */
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

/* The slot from this one on that has the position's vertex, or is free. */
static size_t find_slot(const struct weld *weld, const struct mesh_soup *soup, size_t slot,
                        const double position[3])
{
    while (weld->slots[slot] != 0 &&
           !is_one(weld, &soup->positions[3 * (size_t)(weld->slots[slot] - 1)], position))
        slot = (slot + 1) & (weld->capacity - 1);
    return slot;
}

static void set_vertex(struct weld *weld, const struct mesh_soup *soup, size_t vertex)
{
    size_t slot = slot_of(weld, &soup->positions[3 * vertex], (const int[3]){0, 0, 0});
    while (weld->slots[slot] != 0)
        slot = (slot + 1) & (weld->capacity - 1);
    weld->slots[slot] = (uint32_t)(vertex + 1);
}

static bool widen(struct weld *weld, const struct mesh_soup *soup)
{
    struct weld wider = {NULL, weld->capacity > 0 ? 4 * weld->capacity : 1024, weld->tolerance};
    wider.slots = allocate_array(wider.capacity, sizeof *wider.slots);
    if (!wider.slots)
        return false;
    for (size_t i = 0; i < soup->vertices; i++)
        set_vertex(&wider, soup, i);
    free(weld->slots);
    *weld = wider;
    return true;
}

/* The vertex that is one with the position, counted from 1; 0: none is. */
static uint32_t find_vertex(const struct weld *weld, const struct mesh_soup *soup,
                            const double position[3])
{
    const int most = weld->tolerance > 0.0 ? 1 : 0;
    size_t before[27];
    size_t count = 0;
    for (int i = 0; i < (most ? 27 : 1); i++) {
        const int aside[3] = {most * (i % 3 - 1), most * (i / 3 % 3 - 1), most * (i / 9 - 1)};
        const size_t first = slot_of(weld, position, aside);
        size_t k = 0;
        while (k < count && before[k] != first)
            k++;
        if (k < count) /* most of them are one cell */
            continue;
        before[count++] = first;
        const uint32_t found = weld->slots[find_slot(weld, soup, first, position)];
        if (found)
            return found;
    }
    return 0;
}

bool weld_vertex(struct weld *weld, struct mesh_soup *soup, const double position[3],
                 uint32_t *number)
{
    const double point[3] = {position[0] + 0.0, position[1] + 0.0, position[2] + 0.0};
    if (2 * soup->vertices >= weld->capacity && !widen(weld, soup))
        return false;
    uint32_t found = find_vertex(weld, soup, point);
    if (found == 0) {
        if (!mesh_soup_add_vertex(soup, point))
            return false;
        found = (uint32_t)soup->vertices;
        set_vertex(weld, soup, found - 1);
    }
    *number = found - 1;
    return true;
}

void weld_clear(struct weld *weld)
{
    free(weld->slots);
    memset(weld, 0, sizeof *weld);
}
