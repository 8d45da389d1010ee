#include "trace/object_buffer.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cl/launch.h"
#include "user/user_program.h"

#define WORD        4
#define ALIGNED(n)  (((n) + 15) & ~(size_t)15) /* words: as wide as vectors are */
#define WORDS_MOST  ((size_t)UINT32_MAX)
#define WORDS_OF(x) (sizeof(x) / WORD)

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

/* The records of users' shapes follow, one for each part that shows one. */
static size_t user_words(const struct tracer *tracer)
{
    size_t words = 0;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        if (tracer->placements[i].size.user_shape)
            words += ALIGNED(WORDS_OF(struct user_record));
    return words;
}

static void write_users(struct tracer *tracer, struct object_record *records, uint32_t *words,
                        size_t at)
{
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct user_shape *shape = tracer->placements[i].size.user_shape;
        if (!shape)
            continue;
        const struct user_record record = user_record_of(shape);
        records[i].mesh_words = (uint32_t)(at - i * WORDS_OF(struct object_record));
        memcpy(words + at, &record, sizeof record);
        at += ALIGNED(WORDS_OF(record));
    }
}

/* Where each mesh that some part shows begins, in words; 0: nobody shows it. Returns the words of
 * the whole buffer. */
static size_t lay_out(const struct tracer *tracer, size_t begin[SCENE_MESHES_MAX])
{
    size_t words = ALIGNED(tracer->part_count * WORDS_OF(struct object_record));
    memset(begin, 0, SCENE_MESHES_MAX * sizeof *begin);
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct mesh *mesh = tracer->placements[i].size.mesh;
        if (!mesh || begin[mesh - tracer->scene->meshes] != 0)
            continue;
        begin[mesh - tracer->scene->meshes] = words;
        words += mesh_words(mesh);
    }
    return words;
}

sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    cl_mem *buffer)
{
    size_t begin[SCENE_MESHES_MAX];
    const size_t meshes_end = lay_out(tracer, begin);
    const size_t count = meshes_end + user_words(tracer);
    if (count > WORDS_MOST || count * WORD > tracer->device->allocation_limit)
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "the meshes are too large for the device: use fewer triangles");
    uint32_t *words = allocate_array(count, sizeof *words);
    if (!words)
        return report_out_of_memory(tracer->report, "the objects");
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct mesh *mesh = tracer->placements[i].size.mesh;
        if (mesh)
            records[i].mesh_words = (uint32_t)(begin[mesh - tracer->scene->meshes] -
                                               i * WORDS_OF(struct object_record));
    }
    write_users(tracer, records, words, meshes_end);
    memcpy(words, records, tracer->part_count * sizeof *records);
    for (uint32_t i = 0; i < tracer->scene->mesh_count; i++)
        if (begin[i] != 0)
            write_mesh(words + begin[i], &tracer->scene->meshes[i]);
    const sonject_status status =
        buffer_create(tracer->report, tracer->device, count * WORD, words, buffer);
    free(words);
    return status;
}
