#include "mesh/hierarchy.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define BINS_MOST 16

/* Devices read these records as C lays them out. */
typedef char branch_is_packed[sizeof(struct mesh_branch) == 144 * 4 ? 1 : -1];
typedef char leaf_is_packed[sizeof(struct mesh_leaf) == 176 * 4 ? 1 : -1];
typedef char normals_are_packed[sizeof(struct mesh_corner_normals) == 9 * 4 ? 1 : -1];
typedef char mesh_is_packed[sizeof(struct mesh_record) == 8 * 4 ? 1 : -1];

void split_box_unite(struct split_box *box, const struct split_box *other)
{
    for (int i = 0; i < 8; i++)
        box->edges[i] = other->edges[i] < box->edges[i] ? other->edges[i] : box->edges[i];
}

struct split_box split_box_empty(void)
{
    const struct split_box empty = {
        {FLT_MAX, FLT_MAX, FLT_MAX, 0.0f, FLT_MAX, FLT_MAX, FLT_MAX, 0.0f}};
    return empty;
}

static float extent(const struct split_box *box, int axis)
{
    return -box->edges[4 + axis] - box->edges[axis];
}

float split_box_area(const struct split_box *box)
{
    if (box->edges[0] > -box->edges[4])
        return 0.0f;
    const float x = extent(box, 0);
    const float y = extent(box, 1);
    const float z = extent(box, 2);
    return x * y + y * z + z * x;
}

struct split_box split_box_of(const struct split_item *triangles, size_t first, size_t last)
{
    struct split_box box = split_box_empty();
    for (size_t i = first; i < last; i++)
        split_box_unite(&box, &triangles[i].box);
    return box;
}

/* Returns twice the middle of a triangle's box. */
static float middle(const struct split_item *triangle, int axis)
{
    return triangle->box.edges[axis] - triangle->box.edges[4 + axis];
}

/* The middles of a range's triangles, sorted into equal bins along each axis. */
struct bins {
    int count;
    float lower[3], scale[3]; /* scale 0: all middles are the same along the axis */
    struct split_box boxes[3][BINS_MOST];
    uint32_t triangles[3][BINS_MOST];
};

static int bin_of(const struct bins *bins, const struct split_item *triangle, int axis)
{
    const int bin = (int)((middle(triangle, axis) - bins->lower[axis]) * bins->scale[axis]);
    return bin < bins->count ? bin : bins->count - 1;
}

static void fill_bins(struct bins *bins, const struct split_item *triangles,
                      const struct split_range *range)
{
    const size_t count = range->last - range->first;
    float lower[3] = {FLT_MAX, FLT_MAX, FLT_MAX};
    float upper[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (size_t i = range->first; i < range->last; i++)
        for (int axis = 0; axis < 3; axis++) {
            const float value = middle(&triangles[i], axis);
            lower[axis] = value < lower[axis] ? value : lower[axis];
            upper[axis] = value > upper[axis] ? value : upper[axis];
        }
    bins->count = count >= 64 ? BINS_MOST : count >= 16 ? 8 : 4; /* most ranges are small */
    for (int axis = 0; axis < 3; axis++) {
        const float width = upper[axis] - lower[axis];
        bins->lower[axis] = lower[axis];
        bins->scale[axis] = width > FLT_MIN * 64.0f ? 0.9999f * (float)bins->count / width : 0.0f;
        for (int bin = 0; bin < bins->count; bin++) {
            bins->boxes[axis][bin] = split_box_empty();
            bins->triangles[axis][bin] = 0;
        }
        for (size_t i = range->first; i < range->last; i++) {
            const int bin = bin_of(bins, &triangles[i], axis);
            split_box_unite(&bins->boxes[axis][bin], &triangles[i].box);
            bins->triangles[axis][bin]++;
        }
    }
}

struct cut {
    int axis, bin; /* the lower half is bins below `bin` */
    float cost;    /* triangles times area, of both halves */
    size_t lower_count;
};

/* Replaces *best by the best cut along one axis, if that is better. */
static void try_axis(const struct bins *bins, int axis, struct cut *best)
{
    float upper_cost[BINS_MOST];
    struct split_box box = split_box_empty();
    size_t count = 0;
    for (int bin = bins->count - 1; bin > 0; bin--) {
        split_box_unite(&box, &bins->boxes[axis][bin]);
        count += bins->triangles[axis][bin];
        upper_cost[bin] = split_box_area(&box) * (float)count;
    }
    const size_t all = count + bins->triangles[axis][0];
    box = split_box_empty();
    count = 0;
    for (int bin = 1; bin < bins->count; bin++) {
        split_box_unite(&box, &bins->boxes[axis][bin - 1]);
        count += bins->triangles[axis][bin - 1];
        const float cost = split_box_area(&box) * (float)count + upper_cost[bin];
        if (count > 0 && count < all && cost < best->cost) {
            best->axis = axis;
            best->bin = bin;
            best->cost = cost;
            best->lower_count = count;
        }
    }
}

static void swap(struct split_item *a, struct split_item *b)
{
    const struct split_item kept = *a;
    *a = *b;
    *b = kept;
}

/* Rearranges the range so that the lower half comes first. Returns where the upper half begins. */
static size_t part_at(struct split_item *triangles, const struct split_range *range,
                      const struct bins *bins, const struct cut *cut)
{
    size_t low = range->first;
    size_t high = range->last;
    for (;;) {
        while (low < high && bin_of(bins, &triangles[low], cut->axis) < cut->bin)
            low++;
        while (low < high && bin_of(bins, &triangles[high - 1], cut->axis) >= cut->bin)
            high--;
        if (low >= high)
            return low;
        swap(&triangles[low++], &triangles[--high]);
    }
}

/* Returns whether a lies before b. The lower number comes first of equal middles. */
static bool lies_before(const struct split_item *a, const struct split_item *b, int axis)
{
    const float at_a = middle(a, axis);
    const float at_b = middle(b, axis);
    return at_a < at_b || (at_a == at_b && a->number < b->number);
}

/* Rearranges the range so that the triangles before `begin` have the lower middles (Hoare's
 * selection). */
static void part_by_order(struct split_item *triangles, const struct split_range *range, int axis,
                          size_t begin)
{
    size_t first = range->first;
    size_t last = range->last - 1;
    while (first < last) {
        const struct split_item pivot = triangles[first + (last - first) / 2];
        size_t low = first;
        size_t high = last;
        for (;;) {
            while (lies_before(&triangles[low], &pivot, axis))
                low++;
            while (lies_before(&pivot, &triangles[high], axis))
                high--;
            if (low >= high)
                break;
            swap(&triangles[low++], &triangles[high--]);
        }
        if (begin <= high)
            last = high;
        else
            first = high + 1;
    }
}

static void set_halves(const struct split_item *triangles, const struct split_range *range,
                       size_t begin, struct split_range *lower, struct split_range *upper)
{
    const size_t last = range->last;
    *lower =
        (struct split_range){range->first, begin, split_box_of(triangles, range->first, begin)};
    *upper = (struct split_range){begin, last, split_box_of(triangles, begin, last)};
}

void split_cut_at(struct split_item *triangles, const struct split_range *range, size_t lower_count,
                  struct split_range *lower, struct split_range *upper)
{
    const size_t begin = range->first + lower_count;
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (extent(&range->box, axis) > extent(&range->box, longest))
            longest = axis;
    part_by_order(triangles, range, longest, begin);
    set_halves(triangles, range, begin, lower, upper);
}

void split_cut(struct split_item *triangles, const struct split_range *range, size_t half_limit,
               struct split_range *lower, struct split_range *upper)
{
    const size_t count = range->last - range->first;
    struct bins bins;
    struct cut best = {-1, 0, FLT_MAX, 0};
    fill_bins(&bins, triangles, range);
    for (int axis = 0; axis < 3; axis++)
        if (bins.scale[axis] > 0.0f)
            try_axis(&bins, axis, &best);
    if (best.axis < 0 || best.lower_count > half_limit || count - best.lower_count > half_limit)
        split_cut_at(triangles, range, count / 2, lower, upper);
    else
        set_halves(triangles, range, part_at(triangles, range, &bins, &best), lower, upper);
}

/* A branch that is still to be filled. */
struct pending {
    struct split_range range;
    uint32_t branch;
    uint32_t level; /* 1 at the root */
};

struct builder {
    const float *vertices;
    const uint32_t *corners;
    struct split_item *triangles;
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

bool mesh_reserve(void **array, size_t count, size_t *capacity, size_t size)
{
    size_t bytes;
    const size_t larger = *capacity + *capacity / 2 + 64;
    if (count < *capacity)
        return true;
    void *moved = size_multiply(larger, size, &bytes) ? realloc(*array, bytes) : NULL;
    if (!moved)
        return false;
    *array = moved;
    *capacity = larger;
    return true;
}

/* Returns the most triangles below a child of a branch at `level`: halving must end in leaves. */
static size_t most_below(uint32_t level)
{
    size_t most = MESH_SLOTS;
    for (uint32_t i = level; i < MESH_LEVELS && most < MESH_TRIANGLES_MAX; i++)
        most *= MESH_SLOTS;
    return most;
}

/* Cuts a range into up to four parts and returns their number. Each time it cuts the part that most
 * rays meet, but none that fits into a leaf. No part keeps more than `limit` triangles; the range
 * has at most four times as many. */
static int cut_in_four(struct builder *builder, const struct split_range *range, size_t limit,
                       struct split_range *parts)
{
    int count = 1;
    parts[0] = *range;
    while (count < 4) {
        int widest = -1;
        float most = -1.0f;
        for (int i = 0; i < count; i++) {
            /* a part that is too large goes first */
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

static void fill_slot(const struct builder *builder, struct mesh_leaf *leaf, int slot,
                      uint32_t triangle)
{
    const uint32_t *corners = &builder->corners[3 * (size_t)triangle];
    for (size_t axis = 0; axis < 3; axis++) {
        leaf->a[axis][slot] = builder->vertices[3 * (size_t)corners[0] + axis];
        leaf->b[axis][slot] = builder->vertices[3 * (size_t)corners[1] + axis];
        leaf->c[axis][slot] = builder->vertices[3 * (size_t)corners[2] + axis];
    }
}

/* Brings triangles that lie together into the same group of four; all groups but the last are
 * full. */
static void group_leaf(struct split_item *triangles, const struct split_range *range)
{
    const size_t groups = (triangles_in(range) + MESH_GROUP - 1) / MESH_GROUP;
    struct split_range lower, upper;
    if (groups < 2)
        return;
    split_cut_at(triangles, range, MESH_GROUP * ((groups + 1) / 2), &lower, &upper);
    group_leaf(triangles, &lower); /* at most two deep */
    group_leaf(triangles, &upper);
}

/* Adds a leaf and sets its code for mesh_branch.child. Returns false if memory lacks. */
static bool add_leaf(struct builder *builder, const struct split_range *range, int32_t *child)
{
    struct mesh_hierarchy *hierarchy = builder->hierarchy;
    const size_t number = hierarchy->leaf_count;
    if (!mesh_reserve((void **)&hierarchy->leaves, number, &builder->leaf_capacity,
                      sizeof *hierarchy->leaves) ||
        !mesh_reserve((void **)&hierarchy->triangles, number, &builder->triangle_capacity,
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
        SPLIT_BOX_STORE(&box, builder->padding, leaf->group_faces, group);
    }
    *child = ~(int32_t)number;
    return true;
}

/* Adds a branch that is to be filled later. Returns false if memory lacks. */
static bool add_branch(struct builder *builder, const struct split_range *range, uint32_t level,
                       int32_t *child)
{
    struct mesh_hierarchy *hierarchy = builder->hierarchy;
    if (!mesh_reserve((void **)&hierarchy->branches, hierarchy->branch_count,
                      &builder->branch_capacity, sizeof *hierarchy->branches) ||
        !mesh_reserve((void **)&builder->pending, builder->pending_count,
                      &builder->pending_capacity, sizeof *builder->pending))
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

/* Fills a group's slots with its children. Returns false if memory lacks. */
static bool fill_group(struct builder *builder, const struct pending *pending,
                       struct mesh_branch *branch, int group, const struct split_range *range)
{
    struct split_range children[MESH_GROUP];
    const int count = cut_in_four(builder, range, most_below(pending->level), children);
    branch->axes |= sort_ranges(children, count) << 2 * group;
    branch->children[group] = count;
    SPLIT_BOX_STORE(&range->box, builder->padding, branch->group_faces, group);
    for (int i = 0; i < count; i++) {
        const int slot = group * MESH_GROUP + i;
        SPLIT_BOX_STORE(&children[i].box, builder->padding, branch->faces, slot);
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
        SPLIT_BOX_STORE(&nowhere, 0.0f, branch.faces, slot);
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
    int32_t root;
    set_triangles(builder, count);
    const struct split_range all = {0, count, split_box_of(builder->triangles, 0, count)};
    bool has_memory = add_branch(builder, &all, 1, &root);
    while (has_memory && builder->pending_count > 0) {
        const struct pending pending = builder->pending[--builder->pending_count];
        has_memory = fill_branch(builder, &pending);
    }
    return has_memory;
}

sonject_status mesh_hierarchy_build(struct report *report, const float *vertices,
                                    const uint32_t *corners, size_t count, float radius,
                                    struct mesh_hierarchy *hierarchy)
{
    struct builder builder = {.vertices = vertices,
                              .corners = corners,
                              .triangles = allocate_array(count, sizeof *builder.triangles),
                              .hierarchy = hierarchy,
                              .padding = MESH_PADDING * radius};
    memset(hierarchy, 0, sizeof *hierarchy);
    const bool is_built = builder.triangles && build(&builder, count);
    free(builder.triangles);
    free(builder.pending);
    if (!is_built)
        mesh_hierarchy_clear(hierarchy);
    CHECK_MEMORY(report, is_built, "the hierarchy of a mesh");
    return SONJECT_OK;
}

void mesh_hierarchy_clear(struct mesh_hierarchy *hierarchy)
{
    free(hierarchy->branches);
    free(hierarchy->leaves);
    free(hierarchy->triangles);
    memset(hierarchy, 0, sizeof *hierarchy);
}
