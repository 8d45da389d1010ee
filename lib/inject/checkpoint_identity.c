/* Whose tallies are whose. */
#include <string.h>

#include <sonject/version.h>

#include "inject/checkpoint_tracing.h"
#include "inject/scene_hash.h"

static sonject_status take_code(struct report *report, char code[SUMS_DIGEST_CAPACITY])
{
    char digest[HASH_TEXT_CAPACITY];
    const sonject_status status = code_hash(report, digest);
    if (status == SONJECT_OK)
        memcpy(code, digest, sizeof digest);
    return status;
}

/* Code of users may answer differently on another device. */
static sonject_status take_device(struct report *report, const struct checkpoint_job *job,
                                  char device[SUMS_DIGEST_CAPACITY])
{
    char digest[HASH_TEXT_CAPACITY];
    if (job->request->scene->user_shapes.count == 0)
        return SONJECT_OK;
    struct hash *hash = hash_begin();
    CHECK_MEMORY(report, hash, "a hash");
    hash_add_text(hash, job->device->name);
    hash_add_text(hash, job->device->platform);
    hash_add_text(hash, job->device->driver);
    hash_end(hash, digest);
    memcpy(device, digest, sizeof digest);
    return SONJECT_OK;
}

sonject_status take_sums_head(struct tracing *tracing)
{
    const struct checkpoint_job *job = tracing->job;
    struct sums_identity *identity = &tracing->head.identity;
    tracing->head.shard = job->request->shards > 0 ? job->request->shard : 1;
    tracing->head.shards = job->request->shards > 0 ? job->request->shards : 1;
    strncpy(identity->version, sonject_version(), sizeof identity->version - 1);
    strncpy(identity->scene, job->scene_hash, sizeof identity->scene - 1);
    CHECK(take_code(tracing->report, identity->code));
    return take_device(tracing->report, job, identity->device);
}

/* NULL where the tallies are of the same scene, image and version, and traced on that device; else
 * what differs. */
static const char *difference(const struct sums_identity *found, const struct sums_identity *mine,
                              const char *device)
{
    if (strcmp(found->version, mine->version) != 0 || strcmp(found->code, mine->code) != 0)
        return "another version of sonject";
    if (strcmp(found->scene, mine->scene) != 0)
        return "another scene or image";
    return strcmp(found->device, device) == 0
               ? NULL
               : "another device, on which code of shapes may answer differently";
}

sonject_status refuse_foreign_sums(struct report *report, const char *path, const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: traced by %s: choose another folder, or delete the work in this one",
                          path, what);
}

sonject_status check_folder(struct tracing *tracing, struct sums_folder *folder)
{
    struct report *report = tracing->report;
    const struct sums_identity *mine = &tracing->head.identity;
    const bool is_shard = tracing->job->request->shards > 0;
    for (size_t i = 0; i < folder->count; i++) {
        const struct sums_file *file = &folder->files[i];
        const char *what = difference(&file->head.identity, mine, mine->device);
        if (what && is_shard)
            return refuse_foreign_sums(report, file->path, what);
        if (what) {
            report_news(report, "%s was traced by %s and is dropped", tracing->folder, what);
            sums_folder_clear(folder);
            sums_folder_remove(tracing->folder);
        }
    }
    return SONJECT_OK;
}

sonject_status check_shards(struct tracing *tracing)
{
    uint64_t others;
    const uint64_t mine = tracing->head.shards;
    const sonject_status status =
        sums_folder_shards(tracing->report, tracing->folder, mine, &others);
    if (status != SONJECT_OK || others == 0)
        return status;
    return report_failure(tracing->report, SONJECT_ERROR_INPUT,
                          "%s: holds work of a run in %llu shard%s, this is one in %llu: choose "
                          "another folder, or delete that work",
                          tracing->folder, (unsigned long long)others, others == 1 ? "" : "s",
                          (unsigned long long)mine);
}

sonject_status check_merged(struct tracing *tracing, const struct sums_folder *folder)
{
    const struct sums_head *first = &folder->files[0].head;
    for (size_t i = 0; i < folder->count; i++) {
        const struct sums_file *file = &folder->files[i];
        const char *what =
            difference(&file->head.identity, &tracing->head.identity, first->identity.device);
        if (what)
            return refuse_foreign_sums(tracing->report, file->path, what);
    }
    tracing->head.shards = first->shards;
    return first->shards <= SHARDS_MAX
               ? check_shards(tracing)
               : report_failure(tracing->report, SONJECT_ERROR_INPUT, "%s: more shards than %d",
                                folder->files[0].path, SHARDS_MAX);
}
