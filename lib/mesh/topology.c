/* The topology of a mesh: whether triangles close and which side is outside; and the normals of the
 * smooth surface that triangles stand for. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/mesh.h"
#include "mesh/nesting.h"

#define FACETS_MAX 256
#define NO_PARTNER UINT32_MAX

/* A facet's unit normal and the angles at its corners. */
struct facet {
    float normal[3];
    float angles[3];
};

static void difference(const float *from, const float *to, double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)to[axis] - (double)from[axis];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void measure_facet(const float *a, const float *b, const float *c, struct facet *facet)
{
    double ab[3], ac[3], bc[3], normal[3];
    difference(a, b, ab);
    difference(a, c, ac);
    difference(b, c, bc);
    cross(ab, ac, normal);
    const double twice_area = sqrt(dot(normal, normal));
    memset(facet, 0, sizeof *facet);
    if (!(twice_area > 0.0))
        return;
    for (int axis = 0; axis < 3; axis++)
        facet->normal[axis] = (float)(normal[axis] / twice_area);
    facet->angles[0] = (float)atan2(twice_area, dot(ab, ac));
    facet->angles[1] = (float)atan2(twice_area, -dot(ab, bc));
    facet->angles[2] = (float)atan2(twice_area, dot(ac, bc));
}

/* Finds the mean normal of the facets at corners list[0...count - 1] that are near facet `own`. */
static void mean_normal(const struct facet *facets, const uint32_t *list, size_t count, size_t own,
                        float least_cosine, float *normal)
{
    const float *facing = facets[own].normal;
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < count; i++) {
        const struct facet *facet = &facets[list[i] / 3];
        const float cosine = facing[0] * facet->normal[0] + facing[1] * facet->normal[1] +
                             facing[2] * facet->normal[2];
        if (cosine < least_cosine)
            continue;
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += (double)(facet->angles[list[i] % 3] * facet->normal[axis]);
    }
    const double length = sqrt(dot(sum, sum));
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = length > 0.0 ? (float)(sum[axis] / length) : facing[axis];
}

/* Corners (3 * triangle + 0...2) sorted by vertex. Vertex v has the corners list[starts[v]] to
 * list[starts[v + 1] - 1], in ascending order. */
struct corner_lists {
    uint32_t *starts, *list; /* owned */
};

static void clear_lists(struct corner_lists *lists)
{
    free(lists->starts);
    free(lists->list);
}

/* Sorts corners into lists for clear_lists, also on failure. Returns false if memory lacks. */
static bool sort_corners(struct corner_lists *lists, const uint32_t *vertex_of_corner,
                         size_t corner_count, size_t vertex_count)
{
    lists->starts = allocate_array(vertex_count + 2, sizeof *lists->starts);
    lists->list = allocate_array(corner_count, sizeof *lists->list);
    if (!lists->starts || !lists->list)
        return false;
    /* counts lie two places on, so that filling leaves the starts where they belong */
    uint32_t *next = lists->starts + 1;
    for (size_t i = 0; i < corner_count; i++)
        next[vertex_of_corner[i] + 1]++;
    for (size_t v = 1; v <= vertex_count; v++)
        next[v] += next[v - 1];
    for (size_t i = 0; i < corner_count; i++)
        lists->list[next[vertex_of_corner[i]]++] = (uint32_t)i;
    return true;
}

sonject_status mesh_smooth_normals(struct report *report, const float *vertices,
                                   size_t vertex_count, const uint32_t *corners,
                                   size_t triangle_count, double angle, float **normals)
{
    const float least_cosine = (float)cos(angle);
    struct corner_lists lists = {NULL, NULL};
    struct facet *facets = allocate_array(triangle_count, sizeof *facets);
    float *made = allocate_array(3 * triangle_count, 3 * sizeof *made);
    const bool has_memory =
        facets && made && sort_corners(&lists, corners, 3 * triangle_count, vertex_count);
    for (size_t i = 0; has_memory && i < triangle_count; i++)
        measure_facet(&vertices[3 * (size_t)corners[3 * i]],
                      &vertices[3 * (size_t)corners[3 * i + 1]],
                      &vertices[3 * (size_t)corners[3 * i + 2]], &facets[i]);
    for (size_t i = 0; has_memory && i < 3 * triangle_count; i++) {
        const uint32_t first = lists.starts[corners[i]];
        const size_t count = lists.starts[corners[i] + 1] - first;
        if (count > FACETS_MAX)
            memcpy(&made[3 * i], facets[i / 3].normal, 3 * sizeof *made);
        else
            mean_normal(facets, lists.list + first, count, i / 3, least_cosine, &made[3 * i]);
    }
    clear_lists(&lists);
    free(facets);
    *normals = has_memory ? made : NULL;
    if (!has_memory)
        free(made);
    CHECK_MEMORY(report, has_memory, "the normals of a mesh");
    return SONJECT_OK;
}

/* Returns the vertex where an edge ends. Edge 3 * triangle + k starts at corner k of a triangle. */
static uint32_t edge_end(const uint32_t *corners, size_t edge)
{
    return corners[edge % 3 == 2 ? edge - 2 : edge + 1];
}

/* An edge by its higher vertex. Only edges of one lower vertex are compared. */
struct edge {
    uint32_t higher, number;
};

static int compare_edges(const void *first, const void *second)
{
    const struct edge *a = first;
    const struct edge *b = second;
    if (a->higher != b->higher)
        return a->higher < b->higher ? -1 : 1;
    return a->number < b->number ? -1 : a->number > b->number;
}

/* Sorts the edges of one lower vertex. Most vertices have few, so insertion is fast. */
static void sort_edges(struct edge *edges, size_t count)
{
    if (count > 24)
        qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t i = 1; count <= 24 && i < count; i++) {
        const struct edge edge = edges[i];
        size_t place = i;
        for (; place > 0 && compare_edges(&edges[place - 1], &edge) > 0; place--)
            edges[place] = edges[place - 1];
        edges[place] = edge;
    }
}

/* Pairs the edges of one lower vertex, and counts those that are not two. */
static void pair_edges(struct mesh_topology *topology, uint32_t lower, const struct edge *edges,
                       size_t count, uint32_t *partners)
{
    for (size_t first = 0; first < count;) {
        size_t last = first + 1;
        while (last < count && edges[last].higher == edges[first].higher)
            last++;
        if (last - first == 2) {
            partners[edges[first].number] = edges[first + 1].number;
            partners[edges[first + 1].number] = edges[first].number;
        } else {
            topology->open_edges += last - first == 1;
            topology->crowded_edges += last - first > 2;
            topology->edge[0] = lower;
            topology->edge[1] = edges[first].higher;
        }
        first = last;
    }
}

/* Sets partners[edge] to the same edge of the other triangle, or to NO_PARTNER unless there is
 * exactly one. Returns false if memory lacks. */
static bool find_partners(size_t vertex_count, const uint32_t *corners, size_t edge_count,
                          struct mesh_topology *topology, uint32_t *partners)
{
    struct corner_lists lists = {NULL, NULL};
    uint32_t *lowers = allocate_array(edge_count, sizeof *lowers);
    struct edge *edges = allocate_array(edge_count, sizeof *edges);
    for (size_t i = 0; lowers && i < edge_count; i++) {
        const uint32_t end = edge_end(corners, i);
        lowers[i] = corners[i] < end ? corners[i] : end;
        partners[i] = NO_PARTNER;
    }
    const bool has_memory =
        lowers && edges && sort_corners(&lists, lowers, edge_count, vertex_count);
    free(lowers);
    for (size_t v = 0; has_memory && v < vertex_count; v++) {
        const size_t count = lists.starts[v + 1] - lists.starts[v];
        for (size_t i = 0; i < count; i++) {
            const uint32_t number = lists.list[lists.starts[v] + i];
            edges[i].number = number;
            edges[i].higher = corners[number] == v ? edge_end(corners, number) : corners[number];
        }
        sort_edges(edges, count);
        pair_edges(topology, (uint32_t)v, edges, count, partners);
    }
    free(edges);
    clear_lists(&lists);
    return has_memory;
}

enum visit {
    UNSEEN = 0,
    AS_IT_IS = 1,
    REVERSED = 2
};

/* Returns six times the volume between a triangle and the origin. */
static double six_volumes(const float *vertices, const uint32_t *corners, size_t triangle)
{
    double p[3][3];
    for (size_t corner = 0; corner < 3; corner++)
        for (size_t axis = 0; axis < 3; axis++)
            p[corner][axis] = (double)vertices[3 * (size_t)corners[3 * triangle + corner] + axis];
    return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
           p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
}

struct walk {
    const float *vertices;
    uint32_t *corners;
    const uint32_t *partners;
    unsigned char *visits;
    uint32_t *list; /* triangles of the piece, in the order in which they were met */
};

/* Follows a piece from its first triangle over all edges of two. Returns the number of its
 * triangles. *turned: number of those that run against the first. */
static size_t follow_piece(struct walk *walk, uint32_t first, size_t *turned,
                           struct mesh_topology *topology)
{
    size_t count = 1;
    *turned = 0;
    walk->list[0] = first;
    walk->visits[first] = AS_IT_IS;
    for (size_t done = 0; done < count; done++) {
        const size_t triangle = walk->list[done];
        for (size_t edge = 3 * triangle; edge < 3 * triangle + 3; edge++) {
            const uint32_t partner = walk->partners[edge];
            if (partner == NO_PARTNER)
                continue;
            const size_t next = partner / 3;
            const bool is_against = walk->corners[edge] == walk->corners[partner];
            const unsigned char wanted =
                is_against == (walk->visits[triangle] == AS_IT_IS) ? REVERSED : AS_IT_IS;
            if (walk->visits[next] == UNSEEN) {
                walk->visits[next] = wanted;
                walk->list[count++] = (uint32_t)next;
                *turned += wanted == REVERSED;
            } else if (walk->visits[next] != wanted && edge < partner) {
                topology->twisted_edges++;
                topology->edge[0] = walk->corners[edge];
                topology->edge[1] = edge_end(walk->corners, edge);
            }
        }
    }
    return count;
}

static void reverse(uint32_t *corners, size_t triangle)
{
    const uint32_t second = corners[3 * triangle + 1];
    corners[3 * triangle + 1] = corners[3 * triangle + 2];
    corners[3 * triangle + 2] = second;
}

/* Orients one piece and returns six times the volume that it encloses. */
static double orient_piece(struct walk *walk, size_t count, size_t turned,
                           struct mesh_topology *topology)
{
    double volume = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double share = six_volumes(walk->vertices, walk->corners, walk->list[i]);
        volume += walk->visits[walk->list[i]] == REVERSED ? -share : share;
    }
    /* turns the triangles that leave the outside outside if some must turn; if open, the fewer */
    const bool turn_others =
        turned > 0 &&
        (topology->open_edges + topology->crowded_edges == 0 ? volume < 0.0 : 2 * turned > count);
    for (size_t i = 0; i < count; i++) {
        if ((walk->visits[walk->list[i]] == REVERSED) != turn_others) {
            reverse(walk->corners, walk->list[i]);
            topology->turned++;
        }
    }
    return turn_others ? -volume : volume;
}

/* Turns the pieces of a closed mesh that face inward, and finds its volume. */
static void face_outward(struct walk *walk, struct mesh_piece *pieces,
                         struct mesh_topology *topology)
{
    mesh_find_outsides(walk->vertices, walk->corners, pieces, topology->pieces);
    for (size_t i = 0; i < topology->pieces; i++) {
        const struct mesh_piece *piece = &pieces[i];
        for (size_t k = 0; piece->must_turn && k < piece->count; k++)
            reverse(walk->corners, piece->triangles[k]);
        topology->turned += piece->must_turn ? piece->count : 0;
        topology->volume += (piece->must_turn ? -piece->volume : piece->volume) / 6.0;
    }
}

static bool orient(struct walk *walk, size_t triangle_count, struct mesh_topology *topology)
{
    const bool may_close = topology->open_edges + topology->crowded_edges == 0;
    struct mesh_piece *pieces = NULL;
    size_t capacity = 0;
    bool has_memory = true;
    for (size_t i = 0; i < triangle_count && has_memory; i++) {
        size_t turned;
        if (walk->visits[i] != UNSEEN)
            continue;
        const size_t count = follow_piece(walk, (uint32_t)i, &turned, topology);
        const double volume = orient_piece(walk, count, turned, topology);
        has_memory = !may_close ||
                     mesh_reserve((void **)&pieces, topology->pieces, &capacity, sizeof *pieces);
        if (may_close && has_memory)
            pieces[topology->pieces] =
                (struct mesh_piece){walk->list, count, volume, {0.0f}, {0.0f}, false};
        topology->pieces++;
        walk->list += count;
    }
    topology->is_closed = may_close && topology->twisted_edges == 0;
    if (has_memory && topology->is_closed)
        face_outward(walk, pieces, topology);
    free(pieces);
    return has_memory;
}

sonject_status mesh_topology_find(struct report *report, const float *vertices, size_t vertex_count,
                                  uint32_t *corners, size_t triangle_count,
                                  struct mesh_topology *topology)
{
    memset(topology, 0, sizeof *topology);
    uint32_t *partners = allocate_array(3 * triangle_count, sizeof *partners);
    uint32_t *list = allocate_array(triangle_count, sizeof *list);
    struct walk walk = {vertices, corners, partners, allocate_array(triangle_count, 1), list};
    const bool has_memory =
        partners && walk.visits && list &&
        find_partners(vertex_count, corners, 3 * triangle_count, topology, partners) &&
        orient(&walk, triangle_count, topology);
    free(partners);
    free(walk.visits);
    free(list);
    CHECK_MEMORY(report, has_memory, "the edges of a mesh");
    return SONJECT_OK;
}
