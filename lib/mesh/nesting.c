/* The outer side of closed pieces. A piece that no other holds faces outward, whatever its file
 * says. What it holds keeps its orientation to it, so a cavity stays a cavity. */
#include <math.h>
#include <string.h>

#include "mesh/nesting.h"

/* The pieces that may hold others, the largest ones, and the most triangles that are looked at. */
#define HOLDERS_MAX   64
#define TRIANGLES_MAX 200000000.0

struct nest {
    const float *vertices;
    const uint32_t *corners;
    struct mesh_piece *pieces;
    size_t count;
    size_t holders[HOLDERS_MAX], holder_count;
    double looked_at; /* triangles */
};

static const float *corner_of(const struct nest *nest, uint32_t triangle, size_t corner)
{
    return &nest->vertices[3 * (size_t)nest->corners[3 * (size_t)triangle + corner]];
}

static void find_bounds(const struct nest *nest, struct mesh_piece *piece)
{
    for (int axis = 0; axis < 3; axis++) {
        piece->lower[axis] = INFINITY;
        piece->upper[axis] = -INFINITY;
    }
    for (size_t i = 0; i < 3 * piece->count; i++) {
        const float *vertex = corner_of(nest, piece->triangles[i / 3], i % 3);
        for (int axis = 0; axis < 3; axis++) {
            piece->lower[axis] = fminf(piece->lower[axis], vertex[axis]);
            piece->upper[axis] = fmaxf(piece->upper[axis], vertex[axis]);
        }
    }
}

static void find_holders(struct nest *nest)
{
    for (size_t i = 0; i < nest->count; i++) {
        size_t place = nest->holder_count;
        while (place > 0 &&
               fabs(nest->pieces[nest->holders[place - 1]].volume) < fabs(nest->pieces[i].volume))
            place--;
        if (place == HOLDERS_MAX)
            continue;
        nest->holder_count += nest->holder_count < HOLDERS_MAX;
        memmove(&nest->holders[place + 1], &nest->holders[place],
                (nest->holder_count - place - 1) * sizeof *nest->holders);
        nest->holders[place] = i;
    }
}

/* Returns whether a ray from the point in a direction of no axis meets the triangle. */
static bool is_met(const struct nest *nest, uint32_t triangle, const float point[3])
{
    static const double along[3] = {0.2672612, 0.5345225, 0.8017837};
    double corners[3][3], sides[3];
    for (size_t corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            corners[corner][axis] =
                (double)corner_of(nest, triangle, corner)[axis] - (double)point[axis];
    /* volumes of the direction with the triangle's edges, as seen from the point */
    for (int i = 0; i < 3; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % 3];
        sides[i] = along[0] * (a[1] * b[2] - a[2] * b[1]) + along[1] * (a[2] * b[0] - a[0] * b[2]) +
                   along[2] * (a[0] * b[1] - a[1] * b[0]);
    }
    const double sum = sides[0] + sides[1] + sides[2];
    if (sum == 0.0 || sides[0] * sum < 0.0 || sides[1] * sum < 0.0 || sides[2] * sum < 0.0)
        return false;
    double ahead = 0.0;
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            ahead += sides[i] / sum * corners[(i + 2) % 3][axis] * along[axis];
    return ahead > 0.0;
}

/* Returns whether a piece lies inside another one. */
static bool holds(struct nest *nest, const struct mesh_piece *holder,
                  const struct mesh_piece *piece)
{
    size_t met = 0;
    for (int axis = 0; axis < 3; axis++)
        if (!(holder->lower[axis] < piece->lower[axis] && piece->upper[axis] < holder->upper[axis]))
            return false;
    nest->looked_at += (double)holder->count;
    if (nest->looked_at > TRIANGLES_MAX)
        return true; /* the file's own orientation stays */
    for (size_t i = 0; i < holder->count; i++)
        met += is_met(nest, holder->triangles[i], corner_of(nest, piece->triangles[0], 0));
    return met % 2 == 1;
}

static bool is_held(struct nest *nest, const struct mesh_piece *piece)
{
    for (size_t i = 0; i < nest->holder_count; i++) {
        const struct mesh_piece *holder = &nest->pieces[nest->holders[i]];
        if (holder != piece && holds(nest, holder, piece))
            return true;
    }
    return false;
}

void mesh_find_outsides(const float *vertices, const uint32_t *corners, struct mesh_piece *pieces,
                        size_t count)
{
    struct nest nest = {.vertices = vertices, .corners = corners, .pieces = pieces, .count = count};
    bool is_any_inward = false;
    for (size_t i = 0; i < count; i++)
        is_any_inward |= pieces[i].volume < 0.0;
    if (!is_any_inward)
        return;
    for (size_t i = 0; i < count; i++)
        find_bounds(&nest, &pieces[i]);
    find_holders(&nest);
    for (size_t i = 0; i < count; i++)
        pieces[i].must_turn = pieces[i].volume < 0.0 && !is_held(&nest, &pieces[i]);
    for (size_t i = 0; i < nest.holder_count; i++) {
        const struct mesh_piece *holder = &pieces[nest.holders[i]];
        for (size_t k = 0; k < count && holder->volume < 0.0 && holder->must_turn; k++)
            if (k != nest.holders[i] && holds(&nest, holder, &pieces[k]))
                pieces[k].must_turn = true;
    }
}
