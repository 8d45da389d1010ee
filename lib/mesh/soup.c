#include "mesh/soup.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

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

static size_t slot_of(const struct weld *weld, const double position[3])
{
    uint64_t bits[3];
    memcpy(bits, position, sizeof bits);
    const uint64_t hash = mix(bits[0] + mix(bits[1] + mix(bits[2] + UINT64_C(0x9e3779b97f4a7c15))));
    return (size_t)hash & (weld->capacity - 1);
}

/* Where the position is or would be put. */
static size_t find_slot(const struct weld *weld, const struct mesh_soup *soup,
                        const double position[3])
{
    size_t slot = slot_of(weld, position);
    while (weld->slots[slot] != 0 && memcmp(&soup->positions[3 * (size_t)(weld->slots[slot] - 1)],
                                            position, 3 * sizeof *position) != 0)
        slot = (slot + 1) & (weld->capacity - 1);
    return slot;
}

static bool widen(struct weld *weld, const struct mesh_soup *soup)
{
    struct weld wider;
    wider.capacity = weld->capacity > 0 ? 4 * weld->capacity : 1024;
    wider.slots = allocate_array(wider.capacity, sizeof *wider.slots);
    if (!wider.slots)
        return false;
    for (size_t i = 0; i < soup->vertices; i++)
        wider.slots[find_slot(&wider, soup, &soup->positions[3 * i])] = (uint32_t)(i + 1);
    free(weld->slots);
    *weld = wider;
    return true;
}

bool weld_vertex(struct weld *weld, struct mesh_soup *soup, const double position[3],
                 uint32_t *number)
{
    const double point[3] = {position[0] + 0.0, position[1] + 0.0, position[2] + 0.0};
    if (2 * soup->vertices >= weld->capacity && !widen(weld, soup))
        return false;
    const size_t slot = find_slot(weld, soup, point);
    if (weld->slots[slot] == 0) {
        if (!mesh_soup_add_vertex(soup, point))
            return false;
        weld->slots[slot] = (uint32_t)soup->vertices;
    }
    *number = weld->slots[slot] - 1;
    return true;
}

void weld_clear(struct weld *weld)
{
    free(weld->slots);
    memset(weld, 0, sizeof *weld);
}
