/* Intersections of rays with a triangle mesh. A packet of WIDTH rays walks the hierarchy together.
 * Rays of different headings walk alone, and so does each ray through a part that only few reach.
 * The nearest triangle is found; of equally near ones, that of the lowest number. The order of the
 * walk and the packet of a ray therefore change nothing. */
#ifndef SONJECT_KERNELS_MESH_H
#define SONJECT_KERNELS_MESH_H

#include "mesh_beam.h"

/* The largest number of rays that walk alone. A packet of one ray is alone from the start. */
#define MESH_ALONE (WIDTH * 3 / 8)

FUNCTION struct mesh_view mesh_view_of(GLOBAL const struct mesh_record *mesh,
                                       GLOBAL const struct mesh_branch *branches,
                                       GLOBAL const struct mesh_leaf *leaves,
                                       GLOBAL const struct mesh_corner_normals *normals)
{
    struct mesh_view view;
    view.branches = branches + mesh->first_branch;
    view.leaves = leaves + mesh->first_leaf;
    view.normals = mesh->is_smooth ? normals + mesh->first_normals : 0;
    view.padding = 0.5f * MESH_PADDING * mesh->radius;
    return view;
}

struct mesh_hit {
    vfloat distance; /* FAR_AWAY: none */
    vint triangle;   /* number, -1: none */
};

/* The children still to be visited. */
struct mesh_stack {
    int child[MESH_STACK];
    vfloat entry[MESH_STACK]; /* distance to its box; FAR_AWAY for rays that miss it */
    int count;
};

/* Returns one slot's vector for all rays, in their own axes, from rows of `slots`. */
FUNCTION struct vector3 splat_rows(GLOBAL const float *values, int slots, const int rows[3],
                                   int slot)
{
    return vector3_of(SPLAT(values[rows[0] * slots + slot]), SPLAT(values[rows[1] * slots + slot]),
                      SPLAT(values[rows[2] * slots + slot]));
}

/* Returns which rays meet the box of a slot; *entry: see meets_box. */
FUNCTION mask packet_meets(const struct mesh_ray *ray, const struct mesh_heading *heading,
                           GLOBAL const float *faces, int slots, int slot, vfloat maximum,
                           vfloat *entry)
{
    return meets_box(ray, splat_rows(faces, slots, heading->rows.first, slot),
                     splat_rows(faces, slots, heading->rows.last, slot), maximum, entry);
}

/* Puts the group's children that some ray may meet on the stack, the farthest first. set: bits of
 * the slots to be tested. */
FUNCTION void open_group(const struct mesh_ray *ray, const struct mesh_heading *heading,
                         GLOBAL const struct mesh_branch *branch, int group, RECORD_WORD set,
                         vfloat maximum, struct mesh_stack *stack)
{
    const int step = runs_down(heading, branch->axes >> 2 * group & 3) ? 1 : -1;
    int slot = group * MESH_GROUP + (step > 0 ? 0 : MESH_GROUP - 1);
    for (int k = 0; k < MESH_GROUP; k++, slot += step) {
        if ((set >> slot & 1u) == 0)
            continue;
        vfloat entry;
        const mask is_met =
            packet_meets(ray, heading, branch->faces[0], MESH_SLOTS, slot, maximum, &entry);
        if (ANY(is_met)) {
            stack->child[stack->count] = branch->child[slot];
            stack->entry[stack->count++] = SELECT(is_met, entry, SPLAT(FAR_AWAY));
        }
    }
}

/* Returns the slots of a group to be tested: all that are filled, if some ray may meet its box. */
FUNCTION RECORD_WORD group_slots(const struct mesh_ray *ray, const struct mesh_heading *heading,
                                 GLOBAL const struct mesh_branch *branch, int group, vfloat maximum)
{
    const int children = branch->children[group];
    vfloat entry;
    if (children > 1 && !ANY(packet_meets(ray, heading, branch->group_faces[0], MESH_GROUPS, group,
                                          maximum, &entry)))
        return 0;
    return ((1u << children) - 1u) << group * MESH_GROUP;
}

FUNCTION void open_branch(const struct mesh_ray *ray, const struct mesh_heading *heading,
                          const struct ray_bounds *beam, GLOBAL const struct mesh_branch *branch,
                          vfloat maximum, struct mesh_stack *stack)
{
    const RECORD_WORD met =
        WIDTH > 1 ? boxes_met(beam, branch->faces[0], MESH_SLOTS, SPLAT(FAR_AWAY)) : 0;
    const int step = runs_down(heading, branch->axes >> 2 * MESH_GROUPS & 3) ? 1 : -1;
    int group = step > 0 ? 0 : MESH_GROUPS - 1;
    for (int k = 0; k < MESH_GROUPS; k++, group += step) {
        const RECORD_WORD slots = (1u << MESH_GROUP) - 1u;
        const RECORD_WORD set = WIDTH > 1 ? met & slots << group * MESH_GROUP
                                          : group_slots(ray, heading, branch, group, maximum);
        if (set != 0)
            open_group(ray, heading, branch, group, set, maximum, stack);
    }
}

/* Tests one triangle. is_any: a ray that meets something is done, and needs no distance. */
FUNCTION void test_slot(const struct mesh_ray *ray, const int axes[3],
                        GLOBAL const struct mesh_leaf *leaf, int slot, int number, int is_any,
                        struct mesh_hit *hit)
{
    struct mesh_corners corners;
    vfloat distance;
    corners.a = splat_rows(leaf->a[0], MESH_SLOTS, axes, slot);
    corners.b = splat_rows(leaf->b[0], MESH_SLOTS, axes, slot);
    corners.c = splat_rows(leaf->c[0], MESH_SLOTS, axes, slot);
    mask is_nearest = meets_triangle(ray, &corners, &distance);
    if (!ANY(is_nearest))
        return;
    is_nearest = is_nearest & MASK_OF(distance > ray->minimum) &
                 (MASK_OF(distance < hit->distance) |
                  (MASK_OF(distance == hit->distance) &
                   (MASK_OF(hit->triangle < 0) | MASK_OF(hit->triangle > number))));
    hit->distance = SELECT(is_nearest, is_any ? SPLAT(-FAR_AWAY) : distance, hit->distance);
    hit->triangle = SELECT(is_nearest, SPLAT_VINT(number), hit->triangle);
}

FUNCTION void test_leaf(const struct mesh_ray *ray, const struct mesh_heading *heading,
                        GLOBAL const struct mesh_leaf *leaf, int first_number, int is_any,
                        struct mesh_hit *hit)
{
    for (int first = 0, group = 0; first < leaf->triangles; first += MESH_GROUP, group++) {
        vfloat entry;
        if (!ANY(packet_meets(ray, heading, leaf->group_faces[0], MESH_GROUPS, group, hit->distance,
                              &entry)))
            continue;
        const int left = leaf->triangles - first;
        const int last = first + (left < MESH_GROUP ? left : MESH_GROUP);
        for (int slot = first; slot < last; slot++)
            test_slot(ray, heading->axes, leaf, slot, first_number + slot, is_any, hit);
    }
}

FUNCTION int has_at_most(RECORD_WORD set, int count)
{
    for (int i = 0; i < count; i++)
        set &= set - 1; /* 0 stays 0 */
    return set == 0;
}

/* Visits a child with each ray of the set alone. */
FUNCTION void walk_each_ray(struct mesh_view mesh, const struct mesh_ray_lanes *lanes, int child,
                            RECORD_WORD set, int is_any, struct mesh_hit *hit)
{
    float distances[WIDTH];
    int triangles[WIDTH];
    STORE_VFLOAT(hit->distance, distances);
    STORE_VINT(hit->triangle, triangles);
    for (; set != 0; set &= set - 1) {
        const int lane = lowest_bit(set);
        struct single_hit alone;
        alone.distance = distances[lane];
        alone.triangle = triangles[lane];
        walk_single_ray(mesh, lanes, lane, child, is_any, &alone);
        distances[lane] = is_any && alone.triangle >= 0 ? -FAR_AWAY : alone.distance;
        triangles[lane] = alone.triangle;
    }
    hit->distance = LOAD_VFLOAT(distances);
    hit->triangle = LOAD_VINT(triangles);
}

/* Walks the hierarchy from the root. */
FUNCTION struct mesh_hit walk_mesh(struct mesh_view mesh, struct vector3 point,
                                   struct vector3 direction, vfloat minimum, vfloat maximum,
                                   int is_any)
{
    const vint own_z = own_z_of(direction);
    const struct mesh_ray ray = mesh_ray_of(point, direction, own_z, minimum, mesh.padding);
    struct mesh_heading heading;
    struct mesh_hit hit;
    hit.distance = maximum;
    hit.triangle = SPLAT_VINT(-1);
    struct mesh_ray_lanes lanes;
    int has_lanes = 0;
    const int is_common = find_packet_heading(&ray, own_z, &heading);
    if (MESH_ALONE > 0 && !is_common) {
        store_mesh_ray(&ray, own_z, &lanes);
        walk_each_ray(mesh, &lanes, 0, lane_bits(MASK_OF(minimum <= maximum)), is_any, &hit);
        return hit;
    }
    struct ray_bounds beam;
    if (WIDTH > 1)
        beam = mesh_beam_of(&ray, &heading);
    struct mesh_stack stack;
    stack.count = 0;
    open_branch(&ray, &heading, &beam, mesh.branches, maximum, &stack);
    while (stack.count > 0) {
        stack.count--;
        const int child = stack.child[stack.count];
        const RECORD_WORD set = lane_bits(MASK_OF(stack.entry[stack.count] <= hit.distance));
        if (set == 0)
            continue;
        if (MESH_ALONE > 0 && has_at_most(set, MESH_ALONE)) {
            if (!has_lanes)
                store_mesh_ray(&ray, own_z, &lanes);
            has_lanes = 1;
            walk_each_ray(mesh, &lanes, child, set, is_any, &hit);
        } else if (child >= 0) {
            open_branch(&ray, &heading, &beam, &mesh.branches[child], hit.distance, &stack);
        } else {
            test_leaf(&ray, &heading, &mesh.leaves[~child], ~child * MESH_SLOTS, is_any, &hit);
        }
    }
    return hit;
}

/* Returns the nearest triangle beyond `minimum` and not beyond `maximum`. Both count from `point`,
 * the rays' closest approach to the frame's origin. direction: unit. */
FUNCTION struct mesh_hit mesh_nearest_hit(struct mesh_view mesh, struct vector3 point,
                                          struct vector3 direction, vfloat minimum, vfloat maximum)
{
    struct mesh_hit hit = walk_mesh(mesh, point, direction, minimum, maximum, 0);
    hit.distance = SELECT(MASK_OF(hit.triangle >= 0), hit.distance, SPLAT(FAR_AWAY));
    return hit;
}

/* Returns where anything is met beyond `minimum` and not beyond `maximum`. A ray whose maximum is
 * below its minimum is not followed. */
FUNCTION mask mesh_is_in_the_way(struct mesh_view mesh, struct vector3 point,
                                 struct vector3 direction, vfloat minimum, vfloat maximum)
{
    return MASK_OF(walk_mesh(mesh, point, direction, minimum, maximum, 1).triangle >= 0);
}

#endif
