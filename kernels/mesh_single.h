/* One ray's walk through part of a mesh's hierarchy, with a child or a triangle in each lane. */
#ifndef SONJECT_KERNELS_MESH_SINGLE_H
#define SONJECT_KERNELS_MESH_SINGLE_H

#include "mesh_ray.h"

#define MESH_STACK (MESH_LEVELS * (MESH_SLOTS - 1) + 1)

/* The arrays of one mesh. */
struct mesh_view {
    GLOBAL const struct mesh_branch *branches;
    GLOBAL const struct mesh_leaf *leaves;
    GLOBAL const struct mesh_corner_normals *normals; /* 0: flat facets */
    float padding;                                    /* padding of a triangle's own box, m */
};

/* The values of all lanes of a packet, to be read one by one. */
struct mesh_ray_lanes {
    float point[3][WIDTH], inverse[3][WIDTH];
    float shear_x[WIDTH], shear_y[WIDTH];
    float minimum[WIDTH];
    int own_z[WIDTH];
    float padding;
};

FUNCTION void store_mesh_ray(const struct mesh_ray *ray, vint own_z, struct mesh_ray_lanes *lanes)
{
    store_vector3(ray->point, lanes->point);
    store_vector3(ray->inverse, lanes->inverse);
    STORE_VFLOAT(ray->shear_x, lanes->shear_x);
    STORE_VFLOAT(ray->shear_y, lanes->shear_y);
    STORE_VFLOAT(ray->minimum, lanes->minimum);
    STORE_VINT(own_z, lanes->own_z);
    lanes->padding = ray->padding;
}

/* Broadcasts one lane's ray to all lanes. */
FUNCTION struct mesh_ray one_mesh_ray(const struct mesh_ray_lanes *lanes, int lane)
{
    struct mesh_ray ray;
    ray.point = splat_vector3(lanes->point, lane);
    ray.inverse = splat_vector3(lanes->inverse, lane);
    ray.shear_x = SPLAT(lanes->shear_x[lane]);
    ray.shear_y = SPLAT(lanes->shear_y[lane]);
    ray.minimum = SPLAT(lanes->minimum[lane]);
    ray.padding = lanes->padding;
    return ray;
}

struct single_hit {
    float distance;
    int triangle; /* -1: none */
};

/* The children still to be visited, and the distances to their boxes. Of the children of a branch,
 * the nearest lies last. */
struct single_stack {
    int child[MESH_STACK];
    float entry[MESH_STACK];
    int count;
};

FUNCTION void open_branch_single(const struct mesh_ray *ray, const struct face_rows *rows,
                                 GLOBAL const struct mesh_branch *branch, float maximum,
                                 struct single_stack *stack)
{
    GLOBAL const float *faces = branch->faces[0];
    const int bottom = stack->count;
    for (int first = 0; first < MESH_SLOTS; first += WIDTH) {
        vfloat entry;
        RECORD_WORD met = lane_bits(
            meets_box(ray, load_faces(faces, MESH_SLOTS, rows->first, first),
                      load_faces(faces, MESH_SLOTS, rows->last, first), SPLAT(maximum), &entry));
        if (met == 0)
            continue;
        float entries[WIDTH];
        STORE_VFLOAT(entry, entries);
        for (; met != 0; met &= met - 1) {
            const int lane = lowest_bit(met);
            int place = stack->count++;
            for (; place > bottom && stack->entry[place - 1] < entries[lane]; place--) {
                stack->child[place] = stack->child[place - 1];
                stack->entry[place] = stack->entry[place - 1];
            }
            stack->child[place] = branch->child[first + lane];
            stack->entry[place] = entries[lane];
        }
    }
}

FUNCTION void test_leaf_single(const struct mesh_ray *ray, const int axes[3],
                               GLOBAL const struct mesh_leaf *leaf, int first_number, float minimum,
                               struct single_hit *hit)
{
    for (int first = 0; first < leaf->triangles; first += WIDTH) {
        struct mesh_corners corners;
        corners.a = load_faces(leaf->a[0], MESH_SLOTS, axes, first);
        corners.b = load_faces(leaf->b[0], MESH_SLOTS, axes, first);
        corners.c = load_faces(leaf->c[0], MESH_SLOTS, axes, first);
        vfloat distance;
        RECORD_WORD met = lane_bits(meets_triangle(ray, &corners, &distance));
        if (met == 0)
            continue;
        float distances[WIDTH];
        STORE_VFLOAT(distance, distances);
        for (; met != 0; met &= met - 1) {
            const int lane = lowest_bit(met);
            const int number = first_number + first + lane;
            const float at = distances[lane];
            if (at > minimum &&
                (at < hit->distance ||
                 (at == hit->distance && (hit->triangle < 0 || number < hit->triangle)))) {
                hit->distance = at;
                hit->triangle = number;
            }
        }
    }
}

/* Visits a child and all below it with the ray of one lane. is_any: the first hit found will do. */
FUNCTION void walk_single_ray(struct mesh_view mesh, const struct mesh_ray_lanes *lanes, int lane,
                              int child, int is_any, struct single_hit *hit)
{
    const struct mesh_ray ray = one_mesh_ray(lanes, lane);
    int axes[3];
    find_own_axes(lanes->own_z[lane], axes);
    const struct face_rows rows =
        face_rows_of(axes, lanes->inverse[0][lane] < 0.0f, lanes->inverse[1][lane] < 0.0f,
                     lanes->inverse[2][lane] < 0.0f);
    struct single_stack stack;
    stack.count = 1;
    stack.child[0] = child;
    stack.entry[0] = -FAR_AWAY;
    while (stack.count > 0) {
        stack.count--;
        if (stack.entry[stack.count] > hit->distance)
            continue;
        const int number = stack.child[stack.count];
        if (number >= 0) {
            open_branch_single(&ray, &rows, &mesh.branches[number], hit->distance, &stack);
            continue;
        }
        test_leaf_single(&ray, axes, &mesh.leaves[~number], ~number * MESH_SLOTS,
                         lanes->minimum[lane], hit);
        if (is_any && hit->triangle >= 0)
            return;
    }
}

#endif
