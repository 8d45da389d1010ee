#include "trace/object_tree.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/split.h"

typedef char branch_is_packed[sizeof(struct object_branch) == 112 * 4 ? 1 : -1];
typedef char tree_is_packed[sizeof(struct object_tree_record) == 8 * 4 ? 1 : -1];

/* Rays start within so many radii of the tree, else they test every object; at least FAR_LEAST_M.
 */
#define FAR_RADII   16.0
#define FAR_LEAST_M 100.0

/* What hits may lie outside an object's box, of its radius: far more than rounding. */
#define REACH_SLACK 0.01

#define GRAIN 0.5 /* of the objects' mean size: rays that lie so close meet the same ones */

/* A branch that is still to be filled. */
struct pending {
    struct split_range range;
    uint32_t branch, level; /* the root's level is 1 */
};

struct builder {
    struct split_triangle *objects; /* an object's box and number */
    struct object_branch *branches;
    struct pending *pending;
    uint32_t branch_count, pending_count;
    float padding;
};

static size_t objects_in(const struct split_range *range)
{
    return range->last - range->first;
}

/* Most objects below a child of a branch at `level`. */
static size_t most_below(uint32_t level)
{
    size_t most = 1;
    for (uint32_t i = level; i < OBJECT_TREE_LEVELS; i++)
        most *= OBJECT_TREE_SLOTS;
    return most;
}

/* The part to be cut next: the fullest of those above the limit, else the widest; -1: none. */
static int next_cut(const struct split_range *parts, int count, size_t limit)
{
    int chosen = -1;
    size_t fullest = limit;
    float widest = -1.0f;
    for (int i = 0; i < count; i++)
        if (objects_in(&parts[i]) > fullest) {
            fullest = objects_in(&parts[i]);
            chosen = i;
        }
    for (int i = 0; chosen < 0 && i < count; i++)
        if (objects_in(&parts[i]) > 1 && split_box_area(&parts[i].box) > widest)
            widest = split_box_area(&parts[i].box);
    for (int i = 0; chosen < 0 && widest >= 0.0f && i < count; i++)
        if (objects_in(&parts[i]) > 1 && split_box_area(&parts[i].box) == widest)
            chosen = i;
    return chosen;
}

/* Cuts a range into up to OBJECT_TREE_SLOTS parts of no more than `limit` objects (the range: at
 * most so many times that). */
static int cut_into_slots(struct builder *builder, const struct split_range *range, size_t limit,
                          struct split_range *parts)
{
    int count = 1;
    parts[0] = *range;
    while (count < OBJECT_TREE_SLOTS) {
        const int chosen = next_cut(parts, count, limit);
        if (chosen < 0)
            break;
        const struct split_range cut = parts[chosen];
        const size_t half = (objects_in(&cut) + 1) / 2;
        split_cut(builder->objects, &cut, half > limit ? half : limit, &parts[chosen],
                  &parts[count]);
        count++;
    }
    return count;
}

static int32_t add_branch(struct builder *builder, const struct split_range *range, uint32_t level)
{
    struct pending *pending = &builder->pending[builder->pending_count++];
    pending->range = *range;
    pending->branch = builder->branch_count++;
    pending->level = level;
    return (int32_t)pending->branch;
}

static void fill_branch(struct builder *builder, const struct pending *pending)
{
    static const struct split_box nowhere = {
        {1.0e30f, 1.0e30f, 1.0e30f, 0.0f, -1.0e30f, -1.0e30f, -1.0e30f, 0.0f}};
    struct split_range parts[OBJECT_TREE_SLOTS];
    struct object_branch *branch = &builder->branches[pending->branch];
    const int count = cut_into_slots(builder, &pending->range, most_below(pending->level), parts);
    for (int slot = 0; slot < OBJECT_TREE_SLOTS; slot++) {
        SPLIT_BOX_STORE(slot < count ? &parts[slot].box : &nowhere, builder->padding, branch, slot);
        branch->child[slot] = -1;
        if (slot >= count)
            continue;
        branch->child[slot] = objects_in(&parts[slot]) == 1
                                  ? ~(int32_t)builder->objects[parts[slot].first].number
                                  : add_branch(builder, &parts[slot], pending->level + 1);
    }
}

/* Every branch has at least two children, so there are fewer branches than objects. */
static void fill_tree(struct builder *builder, uint32_t count)
{
    const struct split_range all = {0, count, split_box_of(builder->objects, 0, count)};
    add_branch(builder, &all, 1);
    while (builder->pending_count > 0) {
        const struct pending pending = builder->pending[--builder->pending_count];
        fill_branch(builder, &pending);
    }
}

static double centre_of(const struct object_record *record, int axis)
{
    return axis == 0 ? record->centre_x : axis == 1 ? record->centre_y : record->centre_z;
}

static void set_middle(const struct object_record *records, const struct object_reach *reaches,
                       uint32_t count, double middle[3], double *radius)
{
    double half[3];
    for (int axis = 0; axis < 3; axis++) {
        double lower = INFINITY;
        double upper = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            lower = fmin(lower, centre_of(&records[i], axis) + reaches[i].lower[axis]);
            upper = fmax(upper, centre_of(&records[i], axis) + reaches[i].upper[axis]);
        }
        middle[axis] = (float)(0.5 * (lower + upper));
        half[axis] = 0.51 * (upper - lower);
    }
    *radius = hypot(half[0], hypot(half[1], half[2]));
}

/* Boxes about the middle; the mean of their longest sides. */
static double set_boxes(struct split_triangle *objects, const struct object_record *records,
                        const struct object_reach *reaches, uint32_t count, const double middle[3])
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const double slack = REACH_SLACK * records[i].bounding_radius;
        double longest = 0.0;
        objects[i].number = i;
        objects[i].box = split_box_empty();
        objects[i].box.edges[3] = objects[i].box.edges[7] = 0.0f;
        for (int axis = 0; axis < 3; axis++) {
            const double centre = centre_of(&records[i], axis) - middle[axis];
            const double lower = centre + reaches[i].lower[axis] - slack;
            const double upper = centre + reaches[i].upper[axis] + slack;
            objects[i].box.edges[axis] = (float)lower;
            objects[i].box.edges[4 + axis] = (float)-upper;
            longest = fmax(longest, upper - lower);
        }
        sum += longest;
    }
    return sum / count;
}

sonject_status object_tree_build(struct report *report, const struct object_record *records,
                                 const struct object_reach *reaches, uint32_t count,
                                 struct object_tree *tree)
{
    struct object_tree_record record;
    struct builder builder;
    double middle[3], radius;
    memset(tree, 0, sizeof *tree);
    memset(&builder, 0, sizeof builder);
    if (count <= OBJECTS_IN_LOOP)
        return SONJECT_OK;
    builder.objects = allocate_array(count, sizeof *builder.objects);
    builder.branches = allocate_array(count, sizeof *builder.branches);
    builder.pending = allocate_array(count, sizeof *builder.pending);
    const bool has_room = builder.objects && builder.branches && builder.pending;
    if (has_room) {
        set_middle(records, reaches, count, middle, &radius);
        record.middle_x = (float)middle[0];
        record.middle_y = (float)middle[1];
        record.middle_z = (float)middle[2];
        record.grain = (float)(GRAIN * set_boxes(builder.objects, records, reaches, count, middle));
        record.radius = (float)radius;
        record.farthest = (float)fmax(FAR_RADII * radius, FAR_LEAST_M);
        record.slack = 2.0f * OBJECT_TREE_PADDING * record.farthest;
        builder.padding = OBJECT_TREE_PADDING * record.farthest;
        fill_tree(&builder, count);
        record.branches = (int32_t)builder.branch_count;
        tree->count = (sizeof record + builder.branch_count * sizeof *builder.branches) / 4;
        tree->words = allocate_array(tree->count, sizeof *tree->words);
    }
    if (tree->words) {
        memcpy(tree->words, &record, sizeof record);
        memcpy(tree->words + sizeof record / 4, builder.branches,
               builder.branch_count * sizeof *builder.branches);
    }
    free(builder.objects);
    free(builder.branches);
    free(builder.pending);
    if (tree->words)
        return SONJECT_OK;
    tree->count = 0;
    return report_out_of_memory(report, "the hierarchy of objects");
}

void object_tree_clear(struct object_tree *tree)
{
    free(tree->words);
    memset(tree, 0, sizeof *tree);
}
