/* The nearest of many objects. What is found is what a loop over all of them finds, to the bit: the
 * nearest, of equally near ones that of the lowest number, so neither the order of the walk nor the
 * packet of a ray changes anything (kernels/MATH.md, "Many objects"). */
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

/* The least value of all lanes. */
FUNCTION float least_lane(vfloat value)
{
#if WIDTH == 1
    return value;
#elif defined(__OPENCL_C_VERSION__)
#if WIDTH == 16
    const float8 eight = select(value.lo, value.hi, value.hi < value.lo);
    const float4 four = select(eight.lo, eight.hi, eight.hi < eight.lo);
#elif WIDTH == 8
    const float4 four = select(value.lo, value.hi, value.hi < value.lo);
#else
    const float4 four = value;
#endif
    const float2 two = select(four.lo, four.hi, four.hi < four.lo);
    return two.y < two.x ? two.y : two.x;
#else
    float lanes[WIDTH];
    STORE_VFLOAT(value, lanes);
    for (int span = WIDTH / 2; span > 0; span /= 2)
        for (int lane = 0; lane < span; lane++)
            lanes[lane] = lanes[lane + span] < lanes[lane] ? lanes[lane + span] : lanes[lane];
    return lanes[0];
#endif
}

/* The next number after i of a surface that some lane met, or `count`: loops over few surfaces
 * visit all of them, those over many only what is there. */
FUNCTION int surface_after(int i, int count, vint surface, mask is_met)
{
    if (count <= OBJECTS_IN_LOOP)
        return i + 1;
    const mask is_later = is_met & MASK_OF(surface > i);
    return (int)least_lane(SELECT(is_later, VFLOAT_OF(surface), SPLAT((float)count)));
}

/* What is looked for on the ways of a packet. */
struct object_search {
    vfloat limit;     /* m: what lies beyond does not matter */
    int is_any;       /* the first object found within the limit will do */
    vint left_behind; /* object that is not tested */
    mask is_ray;
};

/* One packet on its way through the tree, counted from its rays' closest approaches to the tree's
 * middle. Lane by lane, for a ray that is tested alone. */
struct tree_rays {
    float point[3][WIDTH], inverse[3][WIDTH], minimum[WIDTH], reach[WIDTH];
};

/* A packet whose rays run close together: bounds over them. */
struct tree_beam {
    vfloat to_first[3], to_last[3], least[3], most[3];
    vfloat minimum;
    int downward[3];
};

FUNCTION void bound_axis(vfloat point, vfloat direction, mask is_ray, float first_point,
                         float first_direction, int axis, struct tree_beam *beam, float *gap,
                         float *turn, int *is_common)
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
    beam->downward[axis] = is_downward;
    beam->to_first[axis] = SPLAT(is_downward ? lower : upper);
    beam->to_last[axis] = SPLAT(is_downward ? upper : lower);
    beam->least[axis] = smaller(of_slow, of_fast);
    beam->most[axis] = larger(of_slow, of_fast);
    *gap = upper - lower > *gap ? upper - lower : *gap;
    *turn = fast - slow > *turn ? fast - slow : *turn;
}

/* Bounds over the rays; 0: they run too far apart for it to be of use. */
FUNCTION int beam_of_rays(GLOBAL const struct object_tree_record *tree, struct vector3 point,
                          struct vector3 direction, vfloat minimum, mask is_ray,
                          struct tree_beam *beam)
{
    float lanes[3][WIDTH], ways[3][WIDTH];
    float gap = 0.0f, turn = 0.0f;
    int is_common = 1;
    const int lane = lowest_bit(lane_bits(is_ray));
    STORE_VFLOAT(point.x, lanes[0]);
    STORE_VFLOAT(point.y, lanes[1]);
    STORE_VFLOAT(point.z, lanes[2]);
    STORE_VFLOAT(direction.x, ways[0]);
    STORE_VFLOAT(direction.y, ways[1]);
    STORE_VFLOAT(direction.z, ways[2]);
    bound_axis(point.x, direction.x, is_ray, lanes[0][lane], ways[0][lane], 0, beam, &gap, &turn,
               &is_common);
    bound_axis(point.y, direction.y, is_ray, lanes[1][lane], ways[1][lane], 1, beam, &gap, &turn,
               &is_common);
    bound_axis(point.z, direction.z, is_ray, lanes[2][lane], ways[2][lane], 2, beam, &gap, &turn,
               &is_common);
    beam->minimum = SPLAT(least_lane(SELECT(is_ray, minimum, SPLAT(FAR_AWAY))));
    return is_common && gap <= tree->grain && turn * tree->radius <= tree->grain;
}

FUNCTION vfloat least_product(vfloat x, vfloat a, vfloat b)
{
    return smaller(x * a, x * b);
}

FUNCTION vfloat greatest_product(vfloat x, vfloat a, vfloat b)
{
    return larger(x * a, x * b);
}

/* Bit i: some ray of the beam may meet the box of child i before `reach`. */
FUNCTION RECORD_WORD beam_children(const struct tree_beam *beam,
                                   GLOBAL const struct object_branch *branch, vfloat reach)
{
    const int *down = beam->downward;
    RECORD_WORD met = 0;
    for (int slot = 0; slot < OBJECT_TREE_SLOTS; slot += WIDTH) {
        const vfloat x_first =
            LOAD_VFLOAT((down[0] ? branch->upper_x : branch->lower_x) + slot) - beam->to_first[0];
        const vfloat y_first =
            LOAD_VFLOAT((down[1] ? branch->upper_y : branch->lower_y) + slot) - beam->to_first[1];
        const vfloat z_first =
            LOAD_VFLOAT((down[2] ? branch->upper_z : branch->lower_z) + slot) - beam->to_first[2];
        const vfloat x_last =
            LOAD_VFLOAT((down[0] ? branch->lower_x : branch->upper_x) + slot) - beam->to_last[0];
        const vfloat y_last =
            LOAD_VFLOAT((down[1] ? branch->lower_y : branch->upper_y) + slot) - beam->to_last[1];
        const vfloat z_last =
            LOAD_VFLOAT((down[2] ? branch->lower_z : branch->upper_z) + slot) - beam->to_last[2];
        const vfloat entry =
            larger(larger(least_product(x_first, beam->least[0], beam->most[0]),
                          least_product(y_first, beam->least[1], beam->most[1])),
                   larger(least_product(z_first, beam->least[2], beam->most[2]), beam->minimum));
        const vfloat exit =
            smaller(smaller(greatest_product(x_last, beam->least[0], beam->most[0]),
                            greatest_product(y_last, beam->least[1], beam->most[1])),
                    smaller(greatest_product(z_last, beam->least[2], beam->most[2]), reach));
        met |= lane_bits(MASK_OF(entry <= exit)) << slot;
    }
    return met;
}

FUNCTION struct vector3 splat_lane3(const float lanes[3][WIDTH], int lane)
{
    struct vector3 v;
    v.x = SPLAT(lanes[0][lane]);
    v.y = SPLAT(lanes[1][lane]);
    v.z = SPLAT(lanes[2][lane]);
    return v;
}

/* Bit i: the ray of one lane may meet the box of child i. */
FUNCTION RECORD_WORD single_children(const struct tree_rays *rays, int lane,
                                     GLOBAL const struct object_branch *branch)
{
    struct mesh_ray ray;
    ray.point = splat_lane3(rays->point, lane);
    ray.inverse = splat_lane3(rays->inverse, lane);
    ray.minimum = SPLAT(rays->minimum[lane]);
    const vfloat reach = SPLAT(rays->reach[lane]);
    RECORD_WORD met = 0;
    for (int slot = 0; slot < OBJECT_TREE_SLOTS; slot += WIDTH) {
        struct vector3 lower, upper;
        lower.x = LOAD_VFLOAT(branch->lower_x + slot);
        lower.y = LOAD_VFLOAT(branch->lower_y + slot);
        lower.z = LOAD_VFLOAT(branch->lower_z + slot);
        upper.x = LOAD_VFLOAT(branch->upper_x + slot);
        upper.y = LOAD_VFLOAT(branch->upper_y + slot);
        upper.z = LOAD_VFLOAT(branch->upper_z + slot);
        met |= lane_bits(MASK_OF(box_entry(&ray, lower, upper, reach) < FAR_AWAY)) << slot;
    }
    return met;
}

/* What is still to be visited, and by which rays. */
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

/* How far along its way a ray still looks. */
FUNCTION vfloat search_bound(const struct object_search *search, const struct nearest_hit *nearest)
{
    const mask is_found = MASK_OF(nearest->distance <= search->limit);
    const vfloat found = search->is_any ? SPLAT(-FAR_AWAY) : nearest->distance;
    return SELECT(search->is_ray, SELECT(is_found, found, search->limit), SPLAT(-FAR_AWAY));
}

/* Every object, one after the other. */
FUNCTION void test_all_objects(GLOBAL const struct object_record *objects, int count,
                               struct vector3 point, struct vector3 direction, float minimum,
                               const struct object_search *search, struct nearest_hit *nearest)
{
    for (int i = 0; i < count; i++)
        test_object(objects, i, point, direction, minimum, search, nearest);
}

/* The nearest object beyond `minimum` of each ray that is wanted; where search->is_any, some object
 * within the limit if there is one. */
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
    struct vector3 relative;
    relative.x = point.x - tree->middle_x;
    relative.y = point.y - tree->middle_y;
    relative.z = point.z - tree->middle_z;
    const mask is_far = ~MASK_OF(dot3(relative, relative) <= tree->farthest * tree->farthest);
    if (ANY(is_far & search->is_ray)) {
        test_all_objects(objects, count, point, direction, minimum, search, &nearest);
        return nearest;
    }
    const vfloat approach = -dot3(relative, direction);
    const struct vector3 closest = along3(relative, direction, approach);
    const vfloat first = (minimum - approach) - tree->slack;
    struct tree_beam beam;
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
        const vfloat inverse_x = one_over_component(direction.x);
        const vfloat inverse_y = one_over_component(direction.y);
        const vfloat inverse_z = one_over_component(direction.z);
        STORE_VFLOAT(closest.x, rays.point[0]);
        STORE_VFLOAT(closest.y, rays.point[1]);
        STORE_VFLOAT(closest.z, rays.point[2]);
        STORE_VFLOAT(inverse_x, rays.inverse[0]);
        STORE_VFLOAT(inverse_y, rays.inverse[1]);
        STORE_VFLOAT(inverse_z, rays.inverse[2]);
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
            met = beam_children(&beam, branch, SPLAT(-least_lane(-reach)));
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

#endif
