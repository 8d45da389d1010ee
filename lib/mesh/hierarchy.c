#include "mesh/hierarchy.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/split.h"

/* The records that devices read, as C lays them out. */
typedef char branch_is_packed[sizeof(struct mesh_branch) == 144 * 4 ? 1 : -1];
typedef char leaf_is_packed[sizeof(struct mesh_leaf) == 176 * 4 ? 1 : -1];
typedef char normals_are_packed[sizeof(struct mesh_corner_normals) == 9 * 4 ? 1 : -1];
typedef char mesh_is_packed[sizeof(struct mesh_record) == 8 * 4 ? 1 : -1];

/* A branch that is still to be filled. */
struct pending {
    struct split_range range;
    uint32_t branch;
    uint32_t level; /* the root's is 1 */
};

struct builder {
    const float *vertices;
    const uint32_t *corners;
    struct split_triangle *triangles;
    struct mesh_hierarchy *hierarchy;
    size_t branch_capacity, leaf_capacity, triangle_capacity;
    struct pending *pending;
    size_t pending_count, pending_capacity;
    float padding;
};

static size_t triangles_in(const struct split_range *range)
{
    return range->last - range->first;
}

/* Makes room for one element more. */
static bool reserve(void **array, size_t count, size_t *capacity, size_t size)
{
    size_t bytes;
    if (count < *capacity)
        return true;
    const size_t larger = *capacity + *capacity / 2 + 64;
    if (!size_multiply(larger, size, &bytes))
        return false;
    void *moved = realloc(*array, bytes);
    if (!moved)
        return false;
    *array = moved;
    *capacity = larger;
    return true;
}

/* Most triangles below a child of a branch at `level`, so that halving ends in leaves in time. */
static size_t most_below(uint32_t level)
{
    size_t most = MESH_SLOTS;
    for (uint32_t i = level; i < MESH_LEVELS && most < MESH_TRIANGLES_MAX; i++)
        most *= MESH_SLOTS;
    return most;
}

/* Cuts a range into up to four parts, each time the one that most rays meet, leaving those that fit
 * into a leaf. None is left with more than `limit` triangles (the range: at most four times that).
 * Returns how many. */
static int cut_in_four(struct builder *builder, const struct split_range *range, size_t limit,
                       struct split_range *parts)
{
    int count = 1;
    parts[0] = *range;
    while (count < 4) {
        int widest = -1;
        float most = -1.0f;
        for (int i = 0; i < count; i++) {
            /* one that is too large goes first */
            const float area =
                triangles_in(&parts[i]) > limit ? INFINITY : split_box_area(&parts[i].box);
            if (triangles_in(&parts[i]) > MESH_SLOTS && area > most) {
                most = area;
                widest = i;
            }
        }
        if (widest < 0)
            break;
        const struct split_range cut = parts[widest];
        const size_t half = (triangles_in(&cut) + 1) / 2;
        split_cut(builder->triangles, &cut, half > limit ? half : limit, &parts[widest],
                  &parts[count]);
        count++;
    }
    return count;
}

static float middle_of(const struct split_range *range, int axis)
{
    return range->box.edges[axis] - range->box.edges[4 + axis];
}

/* Sorts ranges along the axis on which their middles are spread most; returns the axis. */
static int sort_ranges(struct split_range *ranges, int count)
{
    int widest = 0;
    float spread = -1.0f;
    for (int axis = 0; axis < 3; axis++) {
        float least = middle_of(&ranges[0], axis);
        float most = least;
        for (int i = 1; i < count; i++) {
            least = fminf(least, middle_of(&ranges[i], axis));
            most = fmaxf(most, middle_of(&ranges[i], axis));
        }
        if (most - least > spread) {
            spread = most - least;
            widest = axis;
        }
    }
    for (int i = 1; i < count; i++) {
        const struct split_range range = ranges[i];
        int place = i;
        for (; place > 0 && middle_of(&ranges[place - 1], widest) > middle_of(&range, widest);
             place--)
            ranges[place] = ranges[place - 1];
        ranges[place] = range;
    }
    return widest;
}

static void set_corner(const float *vertex, int slot, float *x, float *y, float *z)
{
    x[slot] = vertex[0];
    y[slot] = vertex[1];
    z[slot] = vertex[2];
}

static void fill_slot(const struct builder *builder, struct mesh_leaf *leaf, int slot,
                      uint32_t triangle)
{
    const uint32_t *corners = &builder->corners[3 * (size_t)triangle];
    set_corner(&builder->vertices[3 * (size_t)corners[0]], slot, leaf->a_x, leaf->a_y, leaf->a_z);
    set_corner(&builder->vertices[3 * (size_t)corners[1]], slot, leaf->b_x, leaf->b_y, leaf->b_z);
    set_corner(&builder->vertices[3 * (size_t)corners[2]], slot, leaf->c_x, leaf->c_y, leaf->c_z);
}

/* Brings triangles that lie together into the same group of four; all groups but the last are
 * full. */
static void group_leaf(struct split_triangle *triangles, const struct split_range *range)
{
    const size_t groups = (triangles_in(range) + MESH_GROUP - 1) / MESH_GROUP;
    struct split_range lower, upper;
    if (groups < 2)
        return;
    split_cut_at(triangles, range, MESH_GROUP * ((groups + 1) / 2), &lower, &upper);
    group_leaf(triangles, &lower); /* at most twice */
    group_leaf(triangles, &upper);
}

/* Adds a leaf; its code for mesh_branch.child. False when memory is out. */
static bool add_leaf(struct builder *builder, const struct split_range *range, int32_t *child)
{
    struct mesh_hierarchy *hierarchy = builder->hierarchy;
    const size_t number = hierarchy->leaf_count;
    if (!reserve((void **)&hierarchy->leaves, number, &builder->leaf_capacity,
                 sizeof *hierarchy->leaves) ||
        !reserve((void **)&hierarchy->triangles, number, &builder->triangle_capacity,
                 MESH_SLOTS * sizeof *hierarchy->triangles))
        return false;
    hierarchy->leaf_count++;
    struct mesh_leaf *leaf = &hierarchy->leaves[number];
    uint32_t *numbers = &hierarchy->triangles[number * MESH_SLOTS];
    memset(leaf, 0, sizeof *leaf);
    group_leaf(builder->triangles, range);
    leaf->triangles = (int32_t)triangles_in(range);
    for (int slot = 0; slot < MESH_SLOTS; slot++) {
        const size_t place = range->first + (size_t)slot;
        numbers[slot] = place < range->last ? builder->triangles[place].number : MESH_NO_TRIANGLE;
        if (place < range->last)
            fill_slot(builder, leaf, slot, numbers[slot]);
    }
    for (int group = 0; group * MESH_GROUP < leaf->triangles; group++) {
        const size_t first = range->first + (size_t)group * MESH_GROUP;
        const size_t last = first + MESH_GROUP < range->last ? first + MESH_GROUP : range->last;
        const struct split_box box = split_box_of(builder->triangles, first, last);
        SPLIT_BOX_STORE(&box, builder->padding, &leaf->groups, group);
    }
    *child = ~(int32_t)number;
    return true;
}

/* Adds a branch that is to be filled later. False when memory is out. */
static bool add_branch(struct builder *builder, const struct split_range *range, uint32_t level,
                       int32_t *child)
{
    struct mesh_hierarchy *hierarchy = builder->hierarchy;
    if (!reserve((void **)&hierarchy->branches, hierarchy->branch_count, &builder->branch_capacity,
                 sizeof *hierarchy->branches) ||
        !reserve((void **)&builder->pending, builder->pending_count, &builder->pending_capacity,
                 sizeof *builder->pending))
        return false;
    struct pending *pending = &builder->pending[builder->pending_count++];
    pending->range = *range;
    pending->branch = (uint32_t)hierarchy->branch_count;
    pending->level = level;
    *child = (int32_t)hierarchy->branch_count++;
    if (level > hierarchy->levels)
        hierarchy->levels = level;
    return true;
}

/* Fills a group's slots with its children. */
static bool fill_group(struct builder *builder, const struct pending *pending,
                       struct mesh_branch *branch, int group, const struct split_range *range)
{
    struct split_range children[MESH_GROUP];
    const int count = cut_in_four(builder, range, most_below(pending->level), children);
    branch->axes |= sort_ranges(children, count) << 2 * group;
    branch->children[group] = count;
    SPLIT_BOX_STORE(&range->box, builder->padding, &branch->groups, group);
    for (int i = 0; i < count; i++) {
        const int slot = group * MESH_GROUP + i;
        SPLIT_BOX_STORE(&children[i].box, builder->padding, branch, slot);
        if (triangles_in(&children[i]) <= MESH_SLOTS
                ? !add_leaf(builder, &children[i], &branch->child[slot])
                : !add_branch(builder, &children[i], pending->level + 1, &branch->child[slot]))
            return false;
    }
    return true;
}

static bool fill_branch(struct builder *builder, const struct pending *pending)
{
    static const struct split_box nowhere = {{MESH_NOWHERE, MESH_NOWHERE, MESH_NOWHERE, 0.0f,
                                              -MESH_NOWHERE, -MESH_NOWHERE, -MESH_NOWHERE, 0.0f}};
    struct split_range groups[MESH_GROUPS];
    struct mesh_branch branch;
    memset(&branch, 0, sizeof branch);
    for (int slot = 0; slot < MESH_SLOTS; slot++)
        SPLIT_BOX_STORE(&nowhere, 0.0f, &branch, slot);
    const int count =
        cut_in_four(builder, &pending->range, MESH_GROUP * most_below(pending->level), groups);
    branch.axes = sort_ranges(groups, count) << 2 * MESH_GROUPS;
    for (int group = 0; group < count; group++)
        if (!fill_group(builder, pending, &branch, group, &groups[group]))
            return false;
    builder->hierarchy->branches[pending->branch] = branch;
    return true;
}

static void set_triangles(struct builder *builder, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct split_box *box = &builder->triangles[i].box;
        *box = split_box_empty();
        for (size_t corner = 0; corner < 3; corner++) {
            const float *vertex = &builder->vertices[3 * (size_t)builder->corners[3 * i + corner]];
            const struct split_box point = {
                {vertex[0], vertex[1], vertex[2], 0.0f, -vertex[0], -vertex[1], -vertex[2], 0.0f}};
            split_box_unite(box, &point);
        }
        builder->triangles[i].number = (uint32_t)i;
    }
}

static bool build(struct builder *builder, size_t count)
{
    struct split_range all;
    int32_t root;
    set_triangles(builder, count);
    all.first = 0;
    all.last = count;
    all.box = split_box_of(builder->triangles, 0, count);
    if (!add_branch(builder, &all, 1, &root))
        return false;
    while (builder->pending_count > 0) {
        const struct pending pending = builder->pending[--builder->pending_count];
        if (!fill_branch(builder, &pending))
            return false;
    }
    return true;
}

sonject_status mesh_hierarchy_build(struct report *report, const float *vertices,
                                    const uint32_t *corners, size_t count, float radius,
                                    struct mesh_hierarchy *hierarchy)
{
    struct builder builder;
    memset(&builder, 0, sizeof builder);
    memset(hierarchy, 0, sizeof *hierarchy);
    builder.vertices = vertices;
    builder.corners = corners;
    builder.hierarchy = hierarchy;
    builder.padding = MESH_PADDING * radius;
    builder.triangles = allocate_array(count, sizeof *builder.triangles);
    const bool is_built = builder.triangles && build(&builder, count);
    free(builder.triangles);
    free(builder.pending);
    if (is_built)
        return SONJECT_OK;
    mesh_hierarchy_clear(hierarchy);
    return report_out_of_memory(report, "the hierarchy of a mesh");
}

void mesh_hierarchy_clear(struct mesh_hierarchy *hierarchy)
{
    free(hierarchy->branches);
    free(hierarchy->leaves);
    free(hierarchy->triangles);
    memset(hierarchy, 0, sizeof *hierarchy);
}
