#include "trace/object_buffer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/shapes/shape.h"
#include "trace/fan.h"
#include "trace/fouling.h"
#include "trace/rough.h"

#define MARGIN_M    1.0e-3 /* m beyond the heights, so that rays cross them between the bounds */
#define WORD        4
#define ALIGNED(n)  (((n) + 15) & ~(size_t)15) /* in words, as wide as vectors are */
#define WORDS_MOST  ((size_t)UINT32_MAX)
#define WORDS_OF(x) (sizeof(x) / WORD)

typedef char relief_record_is_packed[sizeof(struct relief_record) == 8 * 4 ? 1 : -1];

static size_t blocks_of(uint32_t points)
{
    return (points - 1 + RELIEF_BLOCK - 1) / RELIEF_BLOCK;
}

size_t relief_word_count(const struct relief *relief)
{
    return sizeof(struct relief_record) / 4 + 3 * (size_t)relief->rows * relief->columns +
           2 * blocks_of(relief->rows) * blocks_of(relief->columns);
}

/* Finds the highest and the lowest point of a block's cells, edges included. */
static void block_bounds(const struct relief *relief, size_t block_row, size_t block_column,
                         float bounds[2])
{
    const size_t first_row = block_row * RELIEF_BLOCK;
    const size_t first_column = block_column * RELIEF_BLOCK;
    bounds[0] = -INFINITY;
    bounds[1] = INFINITY;
    for (size_t row = first_row; row <= first_row + RELIEF_BLOCK && row < relief->rows; row++)
        for (size_t column = first_column;
             column <= first_column + RELIEF_BLOCK && column < relief->columns; column++) {
            const float height = relief->heights[row * relief->columns + column];
            bounds[0] = fmaxf(bounds[0], height);
            bounds[1] = fminf(bounds[1], height);
        }
}

void relief_words_init(uint32_t *words, const struct relief *relief)
{
    const size_t points = (size_t)relief->rows * relief->columns;
    struct relief_record record;
    memset(&record, 0, sizeof record);
    record.rows = (int32_t)relief->rows;
    record.columns = (int32_t)relief->columns;
    record.block_rows = (int32_t)blocks_of(relief->rows);
    record.block_columns = (int32_t)blocks_of(relief->columns);
    record.rows_per_metre = (float)(1.0 / relief->row_step_m);
    record.columns_per_metre = (float)(1.0 / relief->column_step_m);
    record.lowest = (float)(relief->lowest_m - MARGIN_M);
    record.highest = (float)(relief->highest_m + MARGIN_M);
    memcpy(words, &record, sizeof record);
    words += sizeof record / 4;
    memcpy(words, relief->heights, points * sizeof(float));
    memcpy(words + points, relief->slopes, 2 * points * sizeof(float));
    words += 3 * points;
    for (size_t row = 0; row < (size_t)record.block_rows; row++)
        for (size_t column = 0; column < (size_t)record.block_columns; column++, words += 2) {
            float bounds[2];
            block_bounds(relief, row, column, bounds);
            memcpy(words, bounds, sizeof bounds);
        }
}

/* Margins far above rounding: as a share of a radius, and in m. */
#define MARGIN       0.01
#define MARGIN_LEAST 0.001

/* The space where rays aimed at a part run. */
struct corridor {
    double first_x, last_x;         /* m, along-track */
    bool is_straight;               /* the members below count, too */
    double least_angle, most_angle; /* rad below the horizontal, from the sonar */
    double farthest;                /* m from the sonar's track */
};

static double padded_radius(const struct placement *placement)
{
    return (1.0 + MARGIN) * placement->bounding_radius_m + MARGIN_LEAST;
}

static double distance_from_track(const struct tracer *tracer, const struct placement *placement)
{
    return hypot(placement->centre[1], tracer->scene->sonar.altitude_m - placement->centre[2]);
}

static double angle_from_track(const struct tracer *tracer, const struct placement *placement)
{
    return atan2(tracer->scene->sonar.altitude_m - placement->centre[2], placement->centre[1]);
}

static struct corridor corridor_to(const struct tracer *tracer, uint32_t target,
                                   const struct line_grid *grid, bool is_straight)
{
    const struct patch_view *view = &tracer->view;
    const struct placement *placement = &tracer->placements[target];
    const double per_row = grid->strips_per_row;
    const double end = grid->strips.first + grid->strips.count;
    struct corridor corridor;
    memset(&corridor, 0, sizeof corridor);
    corridor.first_x = view_x_of_row(view, grid->strips.first / per_row - 0.5) - MARGIN_LEAST;
    corridor.last_x = view_x_of_row(view, end / per_row - 0.5) + MARGIN_LEAST;
    corridor.is_straight = is_straight && view->water.is_straight;
    if (corridor.is_straight) {
        const struct elevations edges = elevations_of_part(tracer, target, &view->water);
        const double angle = angle_from_track(tracer, placement);
        corridor.least_angle = angle - edges.highest - 1e-4;
        corridor.most_angle = angle - edges.lowest + 1e-4;
        corridor.farthest = distance_from_track(tracer, placement) + padded_radius(placement);
    }
    return corridor;
}

static bool is_in_corridor(const struct tracer *tracer, const struct corridor *corridor,
                           const struct placement *placement)
{
    const double radius = padded_radius(placement);
    if (placement->centre[0] + radius < corridor->first_x ||
        placement->centre[0] - radius > corridor->last_x)
        return false;
    if (!corridor->is_straight)
        return true;
    const double distance = distance_from_track(tracer, placement);
    if (distance <= radius)
        return true;
    const double angle = angle_from_track(tracer, placement);
    const double half = asin(radius / distance);
    return distance - radius <= corridor->farthest && angle + half >= corridor->least_angle &&
           angle - half <= corridor->most_angle;
}

struct part_list all_parts(const struct tracer *tracer)
{
    const struct part_list parts = {NULL, tracer->part_count, 0};
    return parts;
}

sonject_status parts_in_way(struct part_list *parts, const struct tracer *tracer, uint32_t target,
                            const struct line_grid *grid, bool is_straight)
{
    const struct corridor corridor = corridor_to(tracer, target, grid, is_straight);
    memset(parts, 0, sizeof *parts);
    parts->numbers = allocate_array(tracer->part_count, sizeof *parts->numbers);
    CHECK_MEMORY(tracer->report, parts->numbers, "objects");
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        if (i == target)
            parts->target = parts->count;
        else if (tracer->part_count > OBJECTS_IN_LOOP &&
                 !is_in_corridor(tracer, &corridor, &tracer->placements[i]))
            continue;
        parts->numbers[parts->count++] = i;
    }
    return SONJECT_OK;
}

void part_list_clear(struct part_list *parts)
{
    free(parts->numbers);
    memset(parts, 0, sizeof *parts);
}

void object_record_init(struct object_record *record, const struct tracer *tracer,
                        const struct placement *placement, const double origin[3])
{
    memset(record, 0, sizeof *record);
    record->centre_x = (float)(placement->centre[0] - origin[0]);
    record->centre_y = (float)(placement->centre[1] - origin[1]);
    record->centre_z = (float)(placement->centre[2] - origin[2]);
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            record->axes[3 * axis + k] = (float)placement->axes[axis][k];
    shape_record_init(record, &placement->size, placement->shape);
    surface_record_init(&record->surface, &placement->material, tracer->view.wavelength_m);
}

sonject_status object_records_create(struct object_record **records, const struct tracer *tracer,
                                     const struct part_list *parts, const double origin[3])
{
    *records = allocate_array(parts->count, sizeof **records);
    CHECK_MEMORY(tracer->report, *records, "objects");
    for (uint32_t i = 0; i < parts->count; i++)
        object_record_init(&(*records)[i], tracer, placement_of(tracer, parts, i), origin);
    return SONJECT_OK;
}

static size_t normal_words(const struct mesh *mesh)
{
    return mesh->normals ? mesh->hierarchy.leaf_count * MESH_SLOTS * WORDS_OF(*mesh->normals) : 0;
}

static size_t mesh_words(const struct mesh *mesh)
{
    return ALIGNED(WORDS_OF(struct mesh_record) +
                   mesh->hierarchy.branch_count * WORDS_OF(struct mesh_branch) +
                   mesh->hierarchy.leaf_count * WORDS_OF(struct mesh_leaf) + normal_words(mesh));
}

static void write_words(uint32_t *words, size_t *at, const void *elements, size_t count)
{
    memcpy(words + *at, elements, count * WORD);
    *at += count;
}

static void write_mesh(uint32_t *words, const struct mesh *mesh)
{
    const struct mesh_hierarchy *hierarchy = &mesh->hierarchy;
    const struct mesh_record record = mesh_record_of(mesh, 0, 0, 0);
    size_t at = 0;
    write_words(words, &at, &record, WORDS_OF(record));
    write_words(words, &at, hierarchy->branches,
                hierarchy->branch_count * WORDS_OF(*hierarchy->branches));
    write_words(words, &at, hierarchy->leaves,
                hierarchy->leaf_count * WORDS_OF(*hierarchy->leaves));
    if (mesh->normals)
        write_words(words, &at, mesh->normals, normal_words(mesh));
}

/* Writes the records of fouling, which changes only what rough parts return. Returns the word where
 * they end. words: NULL to find only that. */
static size_t write_fouling(const struct tracer *tracer, const struct part_list *parts,
                            struct object_record *records, uint32_t *words, size_t at)
{
    for (uint32_t i = 0; i < parts->count; i++) {
        const struct placement *part = placement_of(tracer, parts, i);
        struct fouling_record record;
        if (!object_is_fouled(tracer, part->object) || !material_is_rough(&part->material))
            continue;
        records[i].fouling_words = (uint32_t)(at - i * WORDS_OF(struct object_record));
        if (words) {
            fouling_record_init(&record, tracer, part);
            memcpy(words + at, &record, sizeof record);
        }
        at += ALIGNED(WORDS_OF(record));
    }
    return at;
}

static size_t record_words(uint32_t part_count)
{
    return ALIGNED(part_count * WORDS_OF(struct object_record));
}

uint32_t object_buffer_relief_words(const struct tracer *tracer, uint32_t part_count)
{
    /* without parts there is no record, but 0 must still mean that there is no relief */
    const size_t words = record_words(part_count);
    return !tracer->relief ? 0 : words > 0 ? (uint32_t)words : (uint32_t)ALIGNED(1);
}

/* Finds the word where each mesh that some part shows begins; 0: no part shows it. Returns the
 * words of records and meshes. */
static size_t lay_out(const struct tracer *tracer, const struct part_list *parts,
                      size_t begin[SCENE_MESHES_MAX])
{
    size_t words = record_words(parts->count);
    if (tracer->relief)
        words = object_buffer_relief_words(tracer, parts->count) +
                ALIGNED(relief_word_count(tracer->relief));
    memset(begin, 0, SCENE_MESHES_MAX * sizeof *begin);
    for (uint32_t i = 0; i < parts->count; i++) {
        const struct mesh *mesh = placement_of(tracer, parts, i)->size.mesh;
        if (!mesh || begin[mesh - tracer->scene->meshes] != 0)
            continue;
        begin[mesh - tracer->scene->meshes] = words;
        words += mesh_words(mesh);
    }
    return words;
}

static sonject_status write_buffer(struct tracer *tracer, struct object_record *records,
                                   const struct part_list *parts, const struct object_tree *tree,
                                   device_buffer *buffer)
{
    size_t begin[SCENE_MESHES_MAX];
    const size_t fouling_begin = lay_out(tracer, parts, begin);
    const size_t tree_begin = write_fouling(tracer, parts, records, NULL, fouling_begin);
    const size_t count = tree_begin + tree->count;
    if (count > WORDS_MOST || count * WORD > tracer->device->allocation_limit)
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "the meshes and the relief are too large for the device: use fewer "
                              "triangles or a smaller patch");
    uint32_t *words = allocate_array(count, sizeof *words);
    CHECK_MEMORY(tracer->report, words, "the objects");
    for (uint32_t i = 0; i < parts->count; i++) {
        const struct mesh *mesh = placement_of(tracer, parts, i)->size.mesh;
        if (mesh)
            records[i].mesh_words = (uint32_t)(begin[mesh - tracer->scene->meshes] -
                                               i * WORDS_OF(struct object_record));
    }
    write_fouling(tracer, parts, records, words, fouling_begin);
    if (tree->count > 0)
        records[0].tree_words = (uint32_t)tree_begin;
    memcpy(words, records, parts->count * sizeof *records);
    if (tracer->relief)
        relief_words_init(words + object_buffer_relief_words(tracer, parts->count), tracer->relief);
    for (uint32_t i = 0; i < tracer->scene->mesh_count; i++)
        if (begin[i] != 0)
            write_mesh(words + begin[i], &tracer->scene->meshes[i]);
    if (tree->count > 0)
        memcpy(words + tree_begin, tree->words, tree->count * WORD);
    const sonject_status status =
        buffer_create(tracer->report, tracer->device, count * WORD, words, buffer);
    free(words);
    return status;
}

sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    const struct part_list *parts, device_buffer *buffer)
{
    struct object_tree tree;
    *buffer = NULL;
    CHECK(object_tree_build(tracer, records, parts, &tree));
    const sonject_status status = write_buffer(tracer, records, parts, &tree, buffer);
    free(tree.words);
    return status;
}

sonject_status launch_add_objects(struct launch *launch, struct tracer *tracer,
                                  const struct part_list *parts, const double origin[3],
                                  const struct rough_trace *tiles)
{
    struct object_record *records;
    CHECK(object_records_create(&records, tracer, parts, origin));
    for (uint32_t i = 0; tiles && i < parts->count; i++)
        rough_tile_describe(tiles, placement_of(tracer, parts, i)->object, &records[i]);
    const sonject_status status =
        object_buffer_create(tracer, records, parts, &launch->buffers[LAUNCH_OBJECTS]);
    free(records);
    return status;
}

void fan_set_parts(struct fan_record *fan, const struct tracer *tracer,
                   const struct part_list *parts)
{
    fan->objects = (int32_t)parts->count;
    fan->relief_words = object_buffer_relief_words(tracer, parts->count);
    fan->only_object = (int32_t)parts->target;
}
