#include "trace/object_buffer.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cl/launch.h"
#include "trace/relief_words.h"

#define WORD        4
#define ALIGNED(n)  (((n) + 15) & ~(size_t)15) /* words: as wide as vectors are */
#define WORDS_MOST  ((size_t)UINT32_MAX)
#define WORDS_OF(x) (sizeof(x) / WORD)

static size_t mesh_words(const struct mesh *mesh)
{
    return ALIGNED(WORDS_OF(struct mesh_record) +
                   mesh->hierarchy.branch_count * WORDS_OF(struct mesh_branch) +
                   mesh->hierarchy.leaf_count * WORDS_OF(struct mesh_leaf));
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
}

static size_t record_words(const struct tracer *tracer)
{
    return ALIGNED(tracer->part_count * WORDS_OF(struct object_record));
}

uint32_t object_buffer_relief_words(const struct tracer *tracer)
{
    /* no part, no record: 0 must go on to mean that there is no relief */
    const size_t words = record_words(tracer);
    return !tracer->relief ? 0 : words > 0 ? (uint32_t)words : (uint32_t)ALIGNED(1);
}

/* Where each mesh that some part shows begins, in words; 0: nobody shows it. Returns the words of
 * the whole buffer. */
static size_t lay_out(const struct tracer *tracer, size_t begin[SCENE_MESHES_MAX])
{
    size_t words = record_words(tracer);
    if (tracer->relief)
        words = object_buffer_relief_words(tracer) + ALIGNED(relief_word_count(tracer->relief));
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
    const size_t count = lay_out(tracer, begin);
    if (count > WORDS_MOST || count * WORD > tracer->device->allocation_limit)
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "the meshes and the relief are too large for the device: use fewer "
                              "triangles or a smaller patch");
    uint32_t *words = allocate_array(count, sizeof *words);
    if (!words)
        return report_out_of_memory(tracer->report, "the objects");
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct mesh *mesh = tracer->placements[i].size.mesh;
        if (mesh)
            records[i].mesh_words = (uint32_t)(begin[mesh - tracer->scene->meshes] -
                                               i * WORDS_OF(struct object_record));
    }
    memcpy(words, records, tracer->part_count * sizeof *records);
    if (tracer->relief)
        relief_words_init(words + object_buffer_relief_words(tracer), tracer->relief);
    for (uint32_t i = 0; i < tracer->scene->mesh_count; i++)
        if (begin[i] != 0)
            write_mesh(words + begin[i], &tracer->scene->meshes[i]);
    const sonject_status status =
        buffer_create(tracer->report, tracer->device, count * WORD, words, buffer);
    free(words);
    return status;
}
