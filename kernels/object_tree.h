/* The nearest of many objects, and of equally near ones that of the lowest number. A loop over all
 * of them finds the same, to the bit. Neither the order of the walk nor the packet of a ray changes
 * anything (kernels/MATH.md, "Many objects"). */
#ifndef SONJECT_KERNELS_OBJECT_TREE_H
#define SONJECT_KERNELS_OBJECT_TREE_H

#include "interval.h"
#include "layout.h"
#include "mesh_ray.h"

#define OBJECT_TREE_STACK ((OBJECT_TREE_SLOTS - 1) * OBJECT_TREE_LEVELS + 1)

FUNCTION GLOBAL const struct object_tree_record *tree_of_objects(
    GLOBAL const struct object_record *objects)
{
    return (GLOBAL const struct object_tree_record *)((GLOBAL const RECORD_WORD *)objects +
                                                      objects->tree_words);
}

FUNCTION int has_object_tree(GLOBAL const struct object_record *objects, int count)
{
    return count > OBJECTS_IN_LOOP && objects->tree_words != 0u;
}

/* Returns the next number after i of a surface that some lane met, or `count`. Loops over few
 * surfaces visit all of them, loops over many only those that were met. */
FUNCTION int surface_after(int i, int count, vint surface, mask is_met)
{
    if (count <= OBJECTS_IN_LOOP)
        return i + 1;
    const mask is_later = is_met & MASK_OF(surface > i);
    return (int)least_lane(SELECT(is_later, VFLOAT_OF(surface), SPLAT((float)count)));
}

/* Goes through the surfaces from number `first` on that some lane met. */
#define FOR_SURFACES_MET(i, first, count, surface, is_met)                                         \
    for (int i = surface_after((first)-1, count, surface, is_met); i < (count);                    \
         i = surface_after(i, count, surface, is_met))

/* The search of a packet's rays. */
struct object_search {
    vfloat limit;     /* m: objects beyond do not matter */
    int is_any;       /* the first object found within the limit will do */
    vint left_behind; /* object that is not tested */
    mask is_ray;
};

/* One packet on its way through the tree, lane by lane, for rays that are tested alone. Distances
 * count from the rays' closest approaches to the tree's middle. */
struct tree_rays {
    float point[3][WIDTH], inverse[3][WIDTH], minimum[WIDTH], reach[WIDTH];
};

FUNCTION int bound_axis(vfloat point, vfloat direction, mask is_ray, float first_point,
                        float first_direction, vfloat *to_first, vfloat *to_last, vfloat *least,
                        vfloat *most, float *gap, float *turn, int *is_common)
{
    const vfloat points = SELECT(is_ray, point, SPLAT(first_point));
    const vfloat directions = SELECT(is_ray, direction, SPLAT(first_direction));
    const float lower = least_lane(points);
    const float upper = -least_lane(-points);
    const float slow = least_lane(directions);
    const float fast = -least_lane(-directions);
    /* rounding is monotonic, so these bound the rays' own inverses, if all run the same way */
    const vfloat of_slow = one_over_component(SPLAT(slow));
    const vfloat of_fast = one_over_component(SPLAT(fast));
    const int is_downward = fast <= -1.0e-20f;
    *is_common &= is_downward || slow > -1.0e-20f;
    *to_first = SPLAT(is_downward ? lower : upper);
    *to_last = SPLAT(is_downward ? upper : lower);
    *least = smaller(of_slow, of_fast);
    *most = larger(of_slow, of_fast);
    *gap = upper - lower > *gap ? upper - lower : *gap;
    *turn = fast - slow > *turn ? fast - slow : *turn;
    return is_downward;
}

/* Finds bounds over a packet. Returns 0 if its rays run too far apart to be bounded. */
FUNCTION int beam_of_rays(GLOBAL const struct object_tree_record *tree, struct vector3 point,
                          struct vector3 direction, vfloat minimum, mask is_ray,
                          struct ray_bounds *beam)
{
    float lanes[3][WIDTH], ways[3][WIDTH];
    float gap = 0.0f, turn = 0.0f;
    int is_common = 1;
    const int lane = lowest_bit(lane_bits(is_ray));
    store_vector3(point, lanes);
    store_vector3(direction, ways);
    const int down_x =
        bound_axis(point.x, direction.x, is_ray, lanes[0][lane], ways[0][lane], &beam->to_first.x,
                   &beam->to_last.x, &beam->least.x, &beam->most.x, &gap, &turn, &is_common);
    const int down_y =
        bound_axis(point.y, direction.y, is_ray, lanes[1][lane], ways[1][lane], &beam->to_first.y,
                   &beam->to_last.y, &beam->least.y, &beam->most.y, &gap, &turn, &is_common);
    const int down_z =
        bound_axis(point.z, direction.z, is_ray, lanes[2][lane], ways[2][lane], &beam->to_first.z,
                   &beam->to_last.z, &beam->least.z, &beam->most.z, &gap, &turn, &is_common);
    const int axes[3] = {0, 1, 2};
    beam->rows = face_rows_of(axes, down_x, down_y, down_z);
    beam->minimum = SPLAT(least_lane(SELECT(is_ray, minimum, SPLAT(FAR_AWAY))));
    return is_common && gap <= tree->grain && turn * tree->radius <= tree->grain;
}

/* Returns the children whose boxes one lane's ray may meet: bit i is child i. */
FUNCTION RECORD_WORD single_children(const struct tree_rays *rays, int lane,
                                     GLOBAL const struct object_branch *branch)
{
    struct mesh_ray ray;
    ray.point = splat_vector3(rays->point, lane);
    ray.inverse = splat_vector3(rays->inverse, lane);
    ray.minimum = SPLAT(rays->minimum[lane]);
    const int axes[3] = {0, 1, 2};
    const struct face_rows rows =
        face_rows_of(axes, rays->inverse[0][lane] < 0.0f, rays->inverse[1][lane] < 0.0f,
                     rays->inverse[2][lane] < 0.0f);
    const vfloat reach = SPLAT(rays->reach[lane]);
    RECORD_WORD met = 0;
    for (int slot = 0; slot < OBJECT_TREE_SLOTS; slot += WIDTH) {
        vfloat entry;
        const mask is_met = meets_box(
            &ray, load_faces(branch->faces[0], OBJECT_TREE_SLOTS, rows.first, slot),
            load_faces(branch->faces[0], OBJECT_TREE_SLOTS, rows.last, slot), reach, &entry);
        met |= lane_bits(is_met) << slot;
    }
    return met;
}

/* The branches still to be visited, and the rays that visit them. */
struct tree_stack {
    int branch[OBJECT_TREE_STACK];
    RECORD_WORD rays[OBJECT_TREE_STACK];
    int count;
};

FUNCTION void test_object(GLOBAL const struct object_record *objects, int number,
                          struct vector3 point, struct vector3 direction, float minimum,
                          const struct object_search *search, struct nearest_hit *nearest)
{
    const mask is_ahead = search->is_ray & MASK_OF(search->left_behind != number);
    const vfloat distance = object_distance(&objects[number], point, direction, SPLAT(minimum));
    const mask is_nearest =
        is_ahead & (MASK_OF(distance < nearest->distance) |
                    (MASK_OF(distance == nearest->distance) & MASK_OF(nearest->object > number)));
    nearest->distance = SELECT(is_nearest, distance, nearest->distance);
    nearest->object = SELECT(is_nearest, SPLAT_VINT(number), nearest->object);
}

/* Returns how far along its way each ray still looks. */
FUNCTION vfloat search_bound(const struct object_search *search, const struct nearest_hit *nearest)
{
    const mask is_found = MASK_OF(nearest->distance <= search->limit);
    const vfloat found = search->is_any ? SPLAT(-FAR_AWAY) : nearest->distance;
    return SELECT(search->is_ray, SELECT(is_found, found, search->limit), SPLAT(-FAR_AWAY));
}

/* Tests all objects, one after the other. */
FUNCTION void test_all_objects(GLOBAL const struct object_record *objects, int count,
                               struct vector3 point, struct vector3 direction, float minimum,
                               const struct object_search *search, struct nearest_hit *nearest)
{
    for (int i = 0; i < count; i++)
        test_object(objects, i, point, direction, minimum, search, nearest);
}

/* Returns the nearest object beyond `minimum` of each ray that is wanted. If search->is_any, that
 * is some object within the limit, if there is one. */
NOINLINE struct nearest_hit walk_objects(GLOBAL const struct object_record *objects, int count,
                                         struct vector3 point, struct vector3 direction,
                                         float minimum, const struct object_search *search)
{
    GLOBAL const struct object_tree_record *tree = tree_of_objects(objects);
    GLOBAL const struct object_branch *branches = (GLOBAL const struct object_branch *)(tree + 1);
    struct nearest_hit nearest;
    nearest.distance = SPLAT(FAR_AWAY);
    nearest.object = SPLAT_VINT(-1);
    if (!ANY(search->is_ray))
        return nearest;
    const struct vector3 relative =
        vector3_of(point.x - tree->middle_x, point.y - tree->middle_y, point.z - tree->middle_z);
    const mask is_far = ~MASK_OF(dot3(relative, relative) <= tree->farthest * tree->farthest);
    if (ANY(is_far & search->is_ray)) {
        test_all_objects(objects, count, point, direction, minimum, search, &nearest);
        return nearest;
    }
    const vfloat approach = -dot3(relative, direction);
    const struct vector3 closest = along3(relative, direction, approach);
    const vfloat first = (minimum - approach) - tree->slack;
    struct ray_bounds beam;
#if WIDTH > 1
    const int is_beam = beam_of_rays(tree, closest, direction, first, search->is_ray, &beam);
    if (!is_beam && count <= OBJECTS_IN_PACKET) {
        test_all_objects(objects, count, point, direction, minimum, search, &nearest);
        return nearest;
    }
#else
    const int is_beam = 0;
#endif
    struct tree_rays rays;
    if (!is_beam) {
        store_vector3(closest, rays.point);
        store_vector3(one_over_components(direction), rays.inverse);
        STORE_VFLOAT(first, rays.minimum);
    }
    struct tree_stack stack;
    stack.count = 1;
    stack.branch[0] = 0;
    stack.rays[0] = lane_bits(search->is_ray);
    while (stack.count > 0) {
        stack.count--;
        GLOBAL const struct object_branch *branch = &branches[stack.branch[stack.count]];
        const RECORD_WORD packet = stack.rays[stack.count];
        const vfloat reach = (search_bound(search, &nearest) - approach) + tree->slack;
        RECORD_WORD met = 0;
        RECORD_WORD meeting[OBJECT_TREE_SLOTS];
        if (is_beam) {
            met = boxes_met(&beam, branch->faces[0], OBJECT_TREE_SLOTS, SPLAT(-least_lane(-reach)));
        } else {
            STORE_VFLOAT(reach, rays.reach);
            for (int slot = 0; slot < OBJECT_TREE_SLOTS; slot++)
                meeting[slot] = 0;
            for (RECORD_WORD left = packet; left != 0; left &= left - 1) {
                const int lane = lowest_bit(left);
                const RECORD_WORD children = single_children(&rays, lane, branch);
                for (RECORD_WORD some = children; some != 0; some &= some - 1)
                    meeting[lowest_bit(some)] |= 1u << lane;
                met |= children;
            }
        }
        for (; met != 0; met &= met - 1) {
            const int slot = lowest_bit(met);
            const int child = branch->child[slot];
            if (child < 0) {
                test_object(objects, ~child, point, direction, minimum, search, &nearest);
            } else {
                stack.branch[stack.count] = child;
                stack.rays[stack.count++] = is_beam ? packet : meeting[slot];
            }
        }
    }
    return nearest;
}

/* Returns what walk_objects finds, copied by members. A called function returns through memory, and
 * without the copy its caller's hits would lie there too, even among few objects. */
FUNCTION struct nearest_hit search_objects(GLOBAL const struct object_record *objects, int count,
                                           struct vector3 point, struct vector3 direction,
                                           float minimum, const struct object_search *search)
{
    const struct nearest_hit found =
        walk_objects(objects, count, point, direction, minimum, search);
    struct nearest_hit nearest;
    nearest.distance = found.distance;
    nearest.object = found.object;
    return nearest;
}

#endif
