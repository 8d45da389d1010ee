/* Faces of more than three corners. Readers list them as fans of triangles about their first
 * corner, which is right for convex ones. The others are cut into triangles anew, by clipping ears.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "mesh/hierarchy.h"
#include "mesh/mesh_reader.h"

/* The most corners of a face that is not convex: clipping takes up to the cube of their number. */
#define CORNERS_MAX 1000

/* The corners of a face that are left, counter-clockwise in its plane. */
struct outline {
    size_t count;
    uint32_t *numbers;   /* of vertices; owned */
    double (*points)[2]; /* owned */
};

sonject_status mesh_soup_add_polygon_corner(struct mesh_soup *soup, size_t place, uint32_t corner,
                                            uint32_t fan[2])
{
    if (place == 3) {
        CHECK_MEMORY(soup->report,
                     mesh_reserve((void **)&soup->polygons, soup->polygon_count,
                                  &soup->polygon_capacity, sizeof *soup->polygons),
                     soup->path);
        soup->polygons[soup->polygon_count++] = (struct mesh_polygon){soup->triangles - 1, 1};
    }
    CHECK(place >= 2 ? mesh_soup_add_triangle(soup, fan[0], fan[1], corner) : SONJECT_OK);
    if (place >= 3)
        soup->polygons[soup->polygon_count - 1].triangles++;
    fan[place == 0 ? 0 : 1] = corner;
    return SONJECT_OK;
}

/* Adds twice the area of a triangle along its normal. */
static void add_area(double normal[3], const struct mesh_soup *soup, size_t triangle)
{
    const uint32_t *corners = &soup->corners[3 * triangle];
    const double *a = &soup->positions[3 * (size_t)corners[0]];
    const double *b = &soup->positions[3 * (size_t)corners[1]];
    const double *c = &soup->positions[3 * (size_t)corners[2]];
    for (int axis = 0; axis < 3; axis++) {
        const int y = (axis + 1) % 3, z = (axis + 2) % 3;
        normal[axis] += (b[y] - a[y]) * (c[z] - a[z]) - (b[z] - a[z]) * (c[y] - a[y]);
    }
}

/* Returns whether all triangles of a fan face where the whole face does. */
static bool is_convex(const struct mesh_soup *soup, const struct mesh_polygon *polygon,
                      double normal[3])
{
    memset(normal, 0, 3 * sizeof *normal);
    for (size_t i = 0; i < polygon->triangles; i++)
        add_area(normal, soup, polygon->first + i);
    for (size_t i = 0; i < polygon->triangles; i++) {
        double own[3] = {0.0, 0.0, 0.0};
        add_area(own, soup, polygon->first + i);
        if (own[0] * normal[0] + own[1] * normal[1] + own[2] * normal[2] < 0.0)
            return false;
    }
    return true;
}

/* Sets the outline: the corners without the axis to which the normal is nearest. */
static void set_outline(struct outline *outline, const struct mesh_soup *soup,
                        const struct mesh_polygon *polygon, const double normal[3])
{
    int drop = 0;
    for (int axis = 1; axis < 3; axis++)
        drop = fabs(normal[axis]) > fabs(normal[drop]) ? axis : drop;
    const int x = (drop + 1) % 3, y = (drop + 2) % 3;
    outline->count = polygon->triangles + 2;
    for (size_t i = 0; i < outline->count; i++) {
        const size_t triangle = polygon->first + (i < 2 ? 0 : i - 2);
        outline->numbers[i] = soup->corners[3 * triangle + (i < 2 ? i : 2)];
        const double *position = &soup->positions[3 * (size_t)outline->numbers[i]];
        outline->points[i][0] = normal[drop] < 0.0 ? -position[x] : position[x];
        outline->points[i][1] = position[y];
    }
}

/* Returns twice the area of a triangle, negative if it runs clockwise. */
static double area_of(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Returns whether a corner may be cut off: its triangle lies inside the outline and holds no other
 * corner. The last triangle may be flat. Corners at the same place, where an outline touches
 * itself, do not count. */
static bool is_ear(const struct outline *outline, size_t before, size_t at, size_t after)
{
    double(*points)[2] = outline->points;
    const double area = area_of(points[before], points[at], points[after]);
    if (outline->count == 3 ? area < 0.0 : !(area > 0.0))
        return false;
    for (size_t i = 0; i < outline->count; i++) {
        const double *point = points[i];
        if (memcmp(point, points[before], sizeof points[0]) != 0 &&
            memcmp(point, points[at], sizeof points[0]) != 0 &&
            memcmp(point, points[after], sizeof points[0]) != 0 &&
            area_of(points[before], points[at], point) >= 0.0 &&
            area_of(points[at], points[after], point) >= 0.0 &&
            area_of(points[after], points[before], point) >= 0.0)
            return false;
    }
    return true;
}

/* Cuts off one corner, and writes its triangle. Returns false if no corner is an ear. */
static bool clip_ear(struct outline *outline, uint32_t triangle[3])
{
    const size_t count = outline->count;
    for (size_t at = 0; at < count; at++) {
        const size_t before = (at + count - 1) % count, after = (at + 1) % count;
        if (!is_ear(outline, before, at, after))
            continue;
        triangle[0] = outline->numbers[before];
        triangle[1] = outline->numbers[at];
        triangle[2] = outline->numbers[after];
        outline->count--;
        memmove(&outline->numbers[at], &outline->numbers[at + 1],
                (outline->count - at) * sizeof *outline->numbers);
        memmove(&outline->points[at], &outline->points[at + 1],
                (outline->count - at) * sizeof *outline->points);
        return true;
    }
    return false;
}

static sonject_status cut_polygon(struct mesh_soup *soup, const struct mesh_polygon *polygon)
{
    double normal[3];
    struct outline outline = {0, NULL, NULL};
    if (is_convex(soup, polygon, normal))
        return SONJECT_OK;
    const size_t corners = polygon->triangles + 2;
    const unsigned long first = (unsigned long)soup->corners[3 * polygon->first];
    bool is_cut = corners <= CORNERS_MAX;
    if (is_cut) {
        outline.numbers = allocate_array(corners, sizeof *outline.numbers);
        outline.points = allocate_array(corners, sizeof *outline.points);
    }
    const bool has_memory = !is_cut || (outline.numbers && outline.points);
    if (is_cut && has_memory) {
        set_outline(&outline, soup, polygon, normal);
        for (size_t i = 0; i < polygon->triangles && is_cut; i++)
            is_cut = clip_ear(&outline, &soup->corners[3 * (polygon->first + i)]);
    }
    free(outline.numbers);
    free(outline.points);
    CHECK_MEMORY(soup->report, has_memory, soup->path);
    return is_cut ? SONJECT_OK
                  : input_failure(soup->report, soup->path,
                                  "a face of %zu corners about vertex %lu is not convex, and %s: "
                                  "export the mesh as triangles",
                                  corners, first + 1,
                                  corners > CORNERS_MAX ? "has more than 1000 corners"
                                                        : "crosses itself");
}

sonject_status mesh_soup_cut_polygons(struct mesh_soup *soup)
{
    for (size_t i = 0; i < soup->polygon_count; i++)
        CHECK(cut_polygon(soup, &soup->polygons[i]));
    return SONJECT_OK;
}
