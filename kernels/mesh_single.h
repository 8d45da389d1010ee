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
    float point[3][WIDTH], direction[3][WIDTH], inverse[3][WIDTH];
    float across[3][WIDTH], upward[3][WIDTH], seen[3][WIDTH];
    float minimum[WIDTH];
    float padding;
};

FUNCTION void store_mesh_ray(const struct mesh_ray *ray, struct mesh_ray_lanes *lanes)
{
    store_vector3(ray->point, lanes->point);
    store_vector3(ray->direction, lanes->direction);
    store_vector3(ray->inverse, lanes->inverse);
    store_vector3(ray->across, lanes->across);
    store_vector3(ray->upward, lanes->upward);
    store_vector3(ray->seen, lanes->seen);
    STORE_VFLOAT(ray->minimum, lanes->minimum);
    lanes->padding = ray->padding;
}

/* Broadcasts one lane's ray to all lanes. */
FUNCTION struct mesh_ray one_mesh_ray(const struct mesh_ray_lanes *lanes, int lane)
{
    struct mesh_ray ray;
    ray.point = splat_vector3(lanes->point, lane);
    ray.direction = splat_vector3(lanes->direction, lane);
    ray.inverse = splat_vector3(lanes->inverse, lane);
    ray.across = splat_vector3(lanes->across, lane);
    ray.upward = splat_vector3(lanes->upward, lane);
    ray.seen = splat_vector3(lanes->seen, lane);
    ray.minimum = SPLAT(lanes->minimum[lane]);
    ray.padding = lanes->padding;
    return ray;
}

struct single_hit {
    float distance;
    int triangle; /* -1: none */
};

/* The children still to be visited, and the distances to their boxes. */
struct single_stack {
    int child[MESH_STACK];
    float entry[MESH_STACK];
    int count;
};

FUNCTION void open_branch_single(const struct mesh_ray *ray,
                                 GLOBAL const struct mesh_branch *branch, float maximum,
                                 struct single_stack *stack)
{
    for (int first = 0; first < MESH_SLOTS; first += WIDTH) {
        const vfloat entry = box_entry(
            ray, load_vector3(branch->lower_x, branch->lower_y, branch->lower_z, first),
            load_vector3(branch->upper_x, branch->upper_y, branch->upper_z, first), SPLAT(maximum));
        RECORD_WORD met = lane_bits(MASK_OF(entry < FAR_AWAY));
        if (met == 0)
            continue;
        float entries[WIDTH];
        STORE_VFLOAT(entry, entries);
        for (; met != 0; met &= met - 1) {
            const int lane = lowest_bit(met);
            stack->child[stack->count] = branch->child[first + lane];
            stack->entry[stack->count++] = entries[lane];
        }
    }
}

FUNCTION void test_leaf_single(const struct mesh_ray *ray, GLOBAL const struct mesh_leaf *leaf,
                               int first_number, float minimum, struct single_hit *hit)
{
    for (int first = 0; first < leaf->triangles; first += WIDTH) {
        const struct mesh_corners corners = leaf_corners(leaf, first);
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
            open_branch_single(&ray, &mesh.branches[number], hit->distance, &stack);
            continue;
        }
        test_leaf_single(&ray, &mesh.leaves[~number], ~number * MESH_SLOTS, lanes->minimum[lane],
                         hit);
        if (is_any && hit->triangle >= 0)
            return;
    }
}

#endif
