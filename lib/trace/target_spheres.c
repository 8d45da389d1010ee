#include "trace/target_spheres.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "kernels/target_numbers.h"
#include "mesh/split.h"

#define FEW_SPHERES_WANTED  32
#define MANY_SPHERES_WANTED 1024

typedef char every_part_has_room[TARGET_SPHERES_MAX >= SCENE_SHAPES_MAX ? 1 : -1];

/* Size of the object along its nose, and of the circle around its section across it. */
static void overall_size(const struct placement *placement, double *half_length, double *radius)
{
    static const double nose[3] = {1.0, 0.0, 0.0};
    static const double tail[3] = {-1.0, 0.0, 0.0};
    struct shape_size uncut = placement->size;
    uncut.cut_count = 0;
    *half_length = fmax(shape_extent(&uncut, placement->shape, nose),
                        shape_extent(&uncut, placement->shape, tail));
    *radius = uncut.radius_about_nose_m;
    if (placement->shape == SONJECT_SHAPE_SPHERE)
        *half_length = 0.0;
    /* unless it is slender, a user's shape has its own sphere */
    if (placement->shape == SONJECT_SHAPE_USER && *half_length <= 2.0 * *radius) {
        *half_length = 0.0;
        *radius = placement->bounding_radius_m;
    }
}

/* Few spheres are all gone through at each hit, so more of them cost more than they save; where
 * there are more parts than that anyway, they are chosen from by groups. */
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
static void sort_into_groups(struct split_triangle *spheres, const struct split_range *range)
{
    const size_t groups = (range->last - range->first + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
    struct split_range lower, upper;
    if (groups < 2)
        return;
    /* halves of whole groups of groups, so that those lie together too */
    const size_t super = (groups + SPHERES_OF_GROUP - 1) / SPHERES_OF_GROUP;
    const size_t lower_groups = super < 2 ? (groups + 1) / 2 : (super + 1) / 2 * SPHERES_OF_GROUP;
    split_cut_at(spheres, range, SPHERES_OF_GROUP * lower_groups, &lower, &upper);
    sort_into_groups(spheres, &lower); /* at most seven times */
    sort_into_groups(spheres, &upper);
}

static void set_sphere(struct sphere_group *group, size_t slot, const struct sphere_record *sphere)
{
    group->centre_x[slot] = sphere->centre_x;
    group->centre_y[slot] = sphere->centre_y;
    group->centre_z[slot] = sphere->centre_z;
    group->radius[slot] = sphere->radius;
}

/* A sphere around spheres [first, last). */
static struct sphere_record sphere_around(const struct sphere_record *spheres,
                                          const struct split_triangle *sorted, size_t first,
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

static void init_groups(struct target_spheres *spheres, struct split_triangle *sorted)
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
                        (TARGET_GROUPS_MAX + bounds) * sizeof(struct sphere_group);
    memset(spheres, 0, sizeof *spheres);
    spheres->records = allocate_array(room, 1);
    struct split_triangle *sorted = allocate_array(most, sizeof *sorted);
    if (!spheres->records || !sorted) {
        free(sorted);
        target_spheres_clear(spheres);
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

void target_spheres_clear(struct target_spheres *spheres)
{
    free(spheres->records);
    memset(spheres, 0, sizeof *spheres);
}
