/* Hierarchies over many targets: the tree over objects, and groups of spheres around them. */
#include "trace/object_buffer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/hierarchy.h"

typedef char branch_is_packed[sizeof(struct object_branch) == 112 * 4 ? 1 : -1];
typedef char tree_is_packed[sizeof(struct object_tree_record) == 8 * 4 ? 1 : -1];

/* Rays start within so many radii of the tree, at least FAR_LEAST_M; others test every object. */
#define FAR_RADII   16.0
#define FAR_LEAST_M 100.0

/* The share of an object's radius that hits may lie outside its box: far more than rounding. */
#define REACH_SLACK 0.01

#define GRAIN 0.5 /* times the objects' mean size: rays as close meet the same objects */

/* A box about an object's centre, by its reach each way in axes of the frame, m. */
struct reach {
    double lower[3], upper[3]; /* lower <= 0 <= upper */
};

/* A branch that is still to be filled. */
struct pending {
    struct split_range range;
    uint32_t branch, level; /* the root's level is 1 */
};

struct builder {
    struct split_item *objects; /* boxes and numbers of the objects */
    struct object_branch *branches;
    struct pending *pending;
    uint32_t branch_count, pending_count;
    float padding;
};

static size_t objects_in(const struct split_range *range)
{
    return range->last - range->first;
}

/* Returns how many objects a child of a branch at `level` may hold. */
static size_t most_below(uint32_t level)
{
    size_t most = 1;
    for (uint32_t i = level; i < OBJECT_TREE_LEVELS; i++)
        most *= OBJECT_TREE_SLOTS;
    return most;
}

/* Returns the part to cut next: the fullest of those above the limit, else the widest; -1: none. */
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

/* Cuts a range into up to OBJECT_TREE_SLOTS parts of no more than `limit` objects. The range has at
 * most OBJECT_TREE_SLOTS times as many. */
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
        SPLIT_BOX_STORE(slot < count ? &parts[slot].box : &nowhere, builder->padding, branch->faces,
                        slot);
        branch->child[slot] = -1;
        if (slot >= count)
            continue;
        branch->child[slot] = objects_in(&parts[slot]) == 1
                                  ? ~(int32_t)builder->objects[parts[slot].first].number
                                  : add_branch(builder, &parts[slot], pending->level + 1);
    }
}

/* Fills the tree. A branch has at least two children, so there are fewer branches than objects. */
static void fill_tree(struct builder *builder, uint32_t count)
{
    const struct split_range all = {0, count, split_box_of(builder->objects, 0, count)};
    add_branch(builder, &all, 1);
    while (builder->pending_count > 0) {
        const struct pending pending = builder->pending[--builder->pending_count];
        fill_branch(builder, &pending);
    }
}

/* Returns the reach of a mesh by the box along its own axes, of other shapes by their extents. */
static struct reach reach_of(const struct placement *placement)
{
    const struct shape_size *size = &placement->size;
    struct reach reach;
    for (int k = 0; k < 3; k++) {
        double forward[3] = {0.0, 0.0, 0.0};
        double back[3] = {0.0, 0.0, 0.0};
        forward[k] = 1.0;
        back[k] = -1.0;
        const double turned = fabs(placement->axes[0][k]) * size->half_length_m +
                              fabs(placement->axes[1][k]) * size->half_width_m +
                              fabs(placement->axes[2][k]) * size->half_height_m;
        const double upper = size->mesh ? turned : placement_extent(placement, forward);
        const double lower = size->mesh ? turned : placement_extent(placement, back);
        reach.upper[k] = fmax(0.0, fmin(upper, placement->bounding_radius_m));
        reach.lower[k] = -fmax(0.0, fmin(lower, placement->bounding_radius_m));
    }
    return reach;
}

static double centre_of(const struct object_record *record, int axis)
{
    return axis == 0 ? record->centre_x : axis == 1 ? record->centre_y : record->centre_z;
}

static void set_middle(const struct object_record *records, const struct reach *reaches,
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

/* Sets the boxes about the middle. Returns the mean of their longest sides, m. */
static double set_boxes(struct split_item *objects, const struct object_record *records,
                        const struct reach *reaches, uint32_t count, const double middle[3])
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

sonject_status object_tree_build(const struct tracer *tracer, const struct object_record *records,
                                 const struct part_list *parts, struct object_tree *tree)
{
    const uint32_t count = parts->count;
    struct object_tree_record record;
    struct builder builder;
    double middle[3], radius;
    memset(tree, 0, sizeof *tree);
    memset(&builder, 0, sizeof builder);
    if (count <= OBJECTS_IN_LOOP)
        return SONJECT_OK;
    struct reach *reaches = allocate_array(count, sizeof *reaches);
    builder.objects = allocate_array(count, sizeof *builder.objects);
    builder.branches = allocate_array(count, sizeof *builder.branches);
    builder.pending = allocate_array(count, sizeof *builder.pending);
    if (reaches && builder.objects && builder.branches && builder.pending) {
        for (uint32_t i = 0; i < count; i++)
            reaches[i] = reach_of(placement_of(tracer, parts, i));
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
    free(reaches);
    free(builder.objects);
    free(builder.branches);
    free(builder.pending);
    CHECK_MEMORY(tracer->report, tree->words, "the hierarchy of objects");
    return SONJECT_OK;
}

#define FEW_SPHERES_WANTED  32
#define MANY_SPHERES_WANTED 1024

typedef char every_part_has_room[TARGET_SPHERES_MAX >= SCENE_SHAPES_MAX ? 1 : -1];

/* Tells half the length along the nose, and the radius of the circle around the cross-section. */
static void overall_size(const struct placement *placement, double *half_length, double *radius)
{
    static const double nose[3] = {1.0, 0.0, 0.0};
    static const double tail[3] = {-1.0, 0.0, 0.0};
    *half_length = fmax(shape_extent(&placement->size, placement->shape, nose),
                        shape_extent(&placement->size, placement->shape, tail));
    *radius = placement->size.radius_about_nose_m;
    if (placement->shape == SHAPE_SPHERE)
        *half_length = 0.0;
}

/* Returns the number of spheres for a part. Each hit goes through few spheres one by one, so that
 * more would cost more than they save. Groups hold them where there are more parts anyway. */
static uint32_t spheres_for(double half_length, double radius, uint32_t parts)
{
    const double all = parts <= FEW_SPHERES_MAX ? FEW_SPHERES_WANTED : MANY_SPHERES_WANTED;
    const double wanted = ceil(half_length / fmax(radius, 1e-9) - 1e-6);
    const double allowed = fmax(1.0, floor(all / (double)parts));
    return (uint32_t)fmax(1.0, fmin(wanted, allowed));
}

static void cover_part(struct target_spheres *spheres, const struct tracer *tracer, uint32_t number,
                       const double origin[3])
{
    const struct placement *placement = &tracer->placements[number];
    double half_length, radius;
    overall_size(placement, &half_length, &radius);
    const uint32_t count = spheres_for(half_length, radius, tracer->part_count);
    const double half_part = half_length / count;
    const double sphere_radius = hypot(radius, half_part) * (1.0 + 1e-5);
    for (uint32_t i = 0; i < count; i++) {
        const double along = (2.0 * i + 1.0) * half_part - half_length;
        double centre[3];
        for (int k = 0; k < 3; k++)
            centre[k] = placement->centre[k] + along * placement->axes[0][k];
        if (centre[2] + sphere_radius <= tracer_lowest_seabed(tracer))
            continue;
        struct sphere_record *record = &spheres->records[spheres->count++];
        record->centre_x = (float)(centre[0] - origin[0]);
        record->centre_y = (float)(centre[1] - origin[1]);
        record->centre_z = (float)(centre[2] - origin[2]);
        record->radius = (float)sphere_radius;
    }
}

static struct split_box box_of_sphere(const struct sphere_record *sphere)
{
    const float r = sphere->radius;
    const struct split_box box = {{sphere->centre_x - r, sphere->centre_y - r, sphere->centre_z - r,
                                   0.0f, -sphere->centre_x - r, -sphere->centre_y - r,
                                   -sphere->centre_z - r, 0.0f}};
    return box;
}

/* Brings spheres that lie together into the same group; all groups but the last are full. */
static void sort_into_groups(struct split_item *spheres, const struct split_range *range)
{
    const size_t groups = (range->last - range->first + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
    struct split_range lower, upper;
    if (groups < 2)
        return;
    /* halves are whole groups of groups, so that these lie together too */
    const size_t super = (groups + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
    const size_t lower_groups = super < 2 ? (groups + 1) / 2 : (super + 1) / 2 * SPHERES_OF_GROUP;
    split_cut_at(spheres, range, SPHERES_OF_GROUP * lower_groups, &lower, &upper);
    sort_into_groups(spheres, &lower); /* at most seven deep */
    sort_into_groups(spheres, &upper);
}

static void set_sphere(struct sphere_group *group, size_t slot, const struct sphere_record *sphere)
{
    group->centre_x[slot] = sphere->centre_x;
    group->centre_y[slot] = sphere->centre_y;
    group->centre_z[slot] = sphere->centre_z;
    group->radius[slot] = sphere->radius;
}

/* Returns a sphere around the spheres [first, last). */
static struct sphere_record sphere_around(const struct sphere_record *spheres,
                                          const struct split_item *sorted, size_t first,
                                          size_t last)
{
    const struct split_box box = split_box_of(sorted, first, last);
    struct sphere_record around;
    around.centre_x = 0.5f * (box.edges[0] - box.edges[4]);
    around.centre_y = 0.5f * (box.edges[1] - box.edges[5]);
    around.centre_z = 0.5f * (box.edges[2] - box.edges[6]);
    around.radius = 0.0f;
    for (size_t i = first; i < last; i++) {
        const struct sphere_record *sphere = &spheres[sorted[i].number];
        const double distance = hypot(hypot((double)sphere->centre_x - around.centre_x,
                                            (double)sphere->centre_y - around.centre_y),
                                      (double)sphere->centre_z - around.centre_z);
        around.radius = (float)fmax(around.radius, 1.0001 * (distance + sphere->radius));
    }
    return around;
}

static void init_groups(struct target_spheres *spheres, struct split_item *sorted)
{
    struct sphere_group *groups =
        (struct sphere_group *)(void *)(spheres->records + spheres->count);
    struct sphere_group *bounds = groups + spheres->groups;
    for (uint32_t i = 0; i < spheres->count; i++) {
        sorted[i].box = box_of_sphere(&spheres->records[i]);
        sorted[i].number = i;
    }
    const struct split_range all = {0, spheres->count, split_box_of(sorted, 0, spheres->count)};
    sort_into_groups(sorted, &all);
    for (size_t i = 0; i < spheres->count; i++)
        set_sphere(&groups[i / SPHERES_OF_GROUP], i % SPHERES_OF_GROUP,
                   &spheres->records[sorted[i].number]);
    for (size_t i = 0; i < spheres->groups; i++) {
        const size_t last = (i + 1) * SPHERES_OF_GROUP;
        const struct sphere_record around =
            sphere_around(spheres->records, sorted, i * SPHERES_OF_GROUP,
                          last < spheres->count ? last : spheres->count);
        set_sphere(&bounds[i / SPHERES_OF_GROUP], i % SPHERES_OF_GROUP, &around);
    }
}

sonject_status target_spheres_init(struct target_spheres *spheres, const struct tracer *tracer,
                                   const double origin[3])
{
    const size_t most = tracer->part_count > FEW_SPHERES_MAX ? TARGET_SPHERES_MAX : FEW_SPHERES_MAX;
    const size_t bounds = (TARGET_GROUPS_MAX + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
    const size_t room = most * sizeof *spheres->records +
                        (TARGET_GROUPS_MAX + bounds) * sizeof(struct sphere_group) +
                        tracer->part_count * sizeof(struct target_record);
    memset(spheres, 0, sizeof *spheres);
    spheres->records = allocate_array(room, 1);
    struct split_item *sorted = allocate_array(most, sizeof *sorted);
    if (!spheres->records || !sorted) {
        free(sorted);
        free(spheres->records);
        spheres->records = NULL;
        return report_out_of_memory(tracer->report, "objects");
    }
    for (uint32_t i = 0; i < tracer->part_count; i++)
        cover_part(spheres, tracer, i, origin);
    spheres->bytes = spheres->count * sizeof *spheres->records;
    if (spheres->count > FEW_SPHERES_MAX) {
        spheres->groups = (spheres->count + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
        const size_t around = (spheres->groups + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
        init_groups(spheres, sorted);
        spheres->bytes += (spheres->groups + around) * sizeof(struct sphere_group);
    }
    free(sorted);
    return SONJECT_OK;
}
