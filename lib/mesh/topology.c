#include "mesh/topology.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define NO_PARTNER UINT32_MAX

/* The edge that starts at corner k of a triangle is number 3 * triangle + k. */
static uint32_t edge_start(const uint32_t *corners, size_t edge)
{
    return corners[edge];
}

static uint32_t edge_end(const uint32_t *corners, size_t edge)
{
    return corners[edge % 3 == 2 ? edge - 2 : edge + 1];
}

sonject_status mesh_corners_by_vertex(struct report *report, const uint32_t *vertex_of_corner,
                                      size_t corner_count, size_t vertex_count, uint32_t **starts,
                                      uint32_t **list)
{
    *starts = allocate_array(vertex_count + 2, sizeof **starts);
    *list = allocate_array(corner_count, sizeof **list);
    if (!*starts || !*list) {
        free(*starts);
        free(*list);
        *starts = *list = NULL;
        return report_out_of_memory(report, "the edges of a mesh");
    }
    /* counted two places on, so that filling leaves the starts where they belong */
    uint32_t *next = *starts + 1;
    for (size_t i = 0; i < corner_count; i++)
        next[vertex_of_corner[i] + 1]++;
    for (size_t v = 1; v <= vertex_count; v++)
        next[v] += next[v - 1];
    for (size_t i = 0; i < corner_count; i++)
        (*list)[next[vertex_of_corner[i]]++] = (uint32_t)i;
    return SONJECT_OK;
}

/* An edge by its higher vertex; those of one lower vertex are compared. */
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

static void sort_edges(struct edge *edges, size_t count)
{
    if (count > 24) {
        qsort(edges, count, sizeof *edges, compare_edges);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        const struct edge edge = edges[i];
        size_t place = i;
        for (; place > 0 && compare_edges(&edges[place - 1], &edge) > 0; place--)
            edges[place] = edges[place - 1];
        edges[place] = edge;
    }
}

/* Pairs the edges of one lower vertex. */
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

/* partners[edge]: the other triangle's, NO_PARTNER unless there is exactly one. */
static sonject_status find_partners(struct report *report, size_t vertex_count,
                                    const uint32_t *corners, size_t edge_count,
                                    struct mesh_topology *topology, uint32_t *partners)
{
    uint32_t *lowers = allocate_array(edge_count, sizeof *lowers);
    struct edge *edges = NULL;
    uint32_t *starts = NULL;
    uint32_t *list = NULL;
    sonject_status status = SONJECT_ERROR_MEMORY;
    if (lowers) {
        for (size_t i = 0; i < edge_count; i++) {
            const uint32_t start = edge_start(corners, i);
            const uint32_t end = edge_end(corners, i);
            lowers[i] = start < end ? start : end;
            partners[i] = NO_PARTNER;
        }
        status = mesh_corners_by_vertex(report, lowers, edge_count, vertex_count, &starts, &list);
    }
    free(lowers);
    if (status == SONJECT_OK)
        edges = allocate_array(edge_count, sizeof *edges);
    for (size_t v = 0; edges && v < vertex_count; v++) {
        const size_t count = starts[v + 1] - starts[v];
        for (size_t i = 0; i < count; i++) {
            const uint32_t number = list[starts[v] + i];
            const uint32_t start = edge_start(corners, number);
            edges[i].number = number;
            edges[i].higher = start == v ? edge_end(corners, number) : start;
        }
        sort_edges(edges, count);
        pair_edges(topology, (uint32_t)v, edges, count, partners);
    }
    if (!edges)
        status = report_out_of_memory(report, "the edges of a mesh");
    free(edges);
    free(starts);
    free(list);
    return status;
}

enum visit {
    UNSEEN = 0,
    AS_IT_IS = 1,
    REVERSED = 2
};

/* Six times the volume between a triangle and the origin. */
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

/* Follows a piece from its first triangle over all edges of two; returns how many triangles it has.
 * *turned: how many run against the first. */
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
            const bool is_against =
                edge_start(walk->corners, edge) == edge_start(walk->corners, partner);
            const unsigned char wanted =
                is_against == (walk->visits[triangle] == AS_IT_IS) ? REVERSED : AS_IT_IS;
            if (walk->visits[next] == UNSEEN) {
                walk->visits[next] = wanted;
                walk->list[count++] = (uint32_t)next;
                *turned += wanted == REVERSED;
            } else if (walk->visits[next] != wanted && edge < partner) {
                topology->twisted_edges++;
                topology->edge[0] = edge_start(walk->corners, edge);
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

/* Orients one piece; returns six times the volume that it encloses. */
static double orient_piece(struct walk *walk, size_t count, size_t turned,
                           struct mesh_topology *topology)
{
    double volume = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double share = six_volumes(walk->vertices, walk->corners, walk->list[i]);
        volume += walk->visits[walk->list[i]] == REVERSED ? -share : share;
    }
    /* where some had to be turned, turn those that leave the outside outside; in a piece that does
     * not close, the fewer */
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

static void orient(struct walk *walk, size_t triangle_count, struct mesh_topology *topology)
{
    double volume = 0.0;
    for (size_t i = 0; i < triangle_count; i++) {
        size_t turned;
        if (walk->visits[i] != UNSEEN)
            continue;
        const size_t count = follow_piece(walk, (uint32_t)i, &turned, topology);
        volume += orient_piece(walk, count, turned, topology);
        topology->pieces++;
    }
    topology->is_closed =
        topology->open_edges == 0 && topology->crowded_edges == 0 && topology->twisted_edges == 0;
    if (!topology->is_closed)
        return;
    if (volume < 0.0 && topology->turned == 0) {
        for (size_t i = 0; i < triangle_count; i++)
            reverse(walk->corners, i);
        topology->turned = triangle_count;
        volume = -volume;
    }
    topology->volume = volume / 6.0;
}

sonject_status mesh_topology_find(struct report *report, const float *vertices, size_t vertex_count,
                                  uint32_t *corners, size_t triangle_count,
                                  struct mesh_topology *topology)
{
    memset(topology, 0, sizeof *topology);
    uint32_t *partners = allocate_array(3 * triangle_count, sizeof *partners);
    struct walk walk = {vertices, corners, partners, allocate_array(triangle_count, 1),
                        allocate_array(triangle_count, sizeof *walk.list)};
    sonject_status status;
    if (partners && walk.visits && walk.list)
        status =
            find_partners(report, vertex_count, corners, 3 * triangle_count, topology, partners);
    else
        status = report_out_of_memory(report, "the edges of a mesh");
    if (status == SONJECT_OK)
        orient(&walk, triangle_count, topology);
    free(partners);
    free(walk.visits);
    free(walk.list);
    return status;
}
