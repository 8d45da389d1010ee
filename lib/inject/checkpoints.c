#include "inject/checkpoints.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/memory.h"
#include "inject/checkpoint_tracing.h"
#include "inject/kept_scene.h"

#define NAMES_MOST 12 /* shards that a message names */

char *checkpoints_folder(const char *folder)
{
    return path_join(folder, "work");
}

void checkpoints_remove(const char *folder)
{
    char *work = checkpoints_folder(folder);
    if (work)
        sums_folder_remove(work);
    free(work);
}

/* Which shards a merge lacks; "" is none. */
static void note_shard(struct growing_text *text, uint32_t *count, uint64_t shard, bool is_begun)
{
    if (*count < NAMES_MOST)
        growing_text_add(text, "%s%llu%s", *count > 0 ? ", " : "", (unsigned long long)shard,
                         is_begun ? " (not finished)" : "");
    ++*count;
}

static sonject_status refuse_incomplete(struct tracing *tracing, struct growing_text *text,
                                        uint32_t count, uint64_t shards)
{
    char *names = growing_text_end(text);
    CHECK_MEMORY(tracing->report, names, "shards");
    char more[32] = "";
    if (count > NAMES_MOST)
        snprintf(more, sizeof more, " and %u more", (unsigned)(count - NAMES_MOST));
    report_failure(tracing->report, SONJECT_ERROR_INPUT,
                   "%s: missing of %llu shards: %s%s; run each with --shard and merge again",
                   tracing->folder, (unsigned long long)shards, names, more);
    free(names);
    return SONJECT_ERROR_INPUT;
}

/* All that all shards traced, in the order of shards. */
struct collection {
    const struct sums_file **files; /* owned */
    size_t count;
};

static sonject_status collect(struct tracing *tracing, const struct sums_folder *folder,
                              struct collection *all)
{
    const uint64_t shards = tracing->head.shards;
    struct growing_text missing;
    uint32_t missing_count = 0;
    sonject_status status = SONJECT_OK;
    memset(&missing, 0, sizeof missing);
    all->count = 0;
    all->files = allocate_array(folder->count, sizeof *all->files);
    CHECK_MEMORY(tracing->report, all->files, "shards");
    for (uint64_t shard = 1; status == SONJECT_OK && shard <= shards; shard++) {
        struct sums_chain chain;
        status = sums_chain_find(&chain, tracing->report, folder, shard);
        if (status != SONJECT_OK)
            break;
        if (!chain.is_complete)
            note_shard(&missing, &missing_count, shard, chain.count > 0);
        for (size_t i = 0; i < chain.count; i++)
            all->files[all->count++] = chain.files[i];
        sums_chain_clear(&chain);
    }
    if (status == SONJECT_OK && missing_count > 0)
        return refuse_incomplete(tracing, &missing, missing_count, shards);
    free(missing.characters);
    return status;
}

/* Forms what the checkpoints in the folder are together. */
static sonject_status add_up(struct tracing *tracing, const struct sums_folder *folder,
                             struct injection_result *result)
{
    struct collection all;
    sonject_status status = collect(tracing, folder, &all);
    THEN(status,
         checkpoint_begin_adding(&tracing->checkpoint, tracing->report, all.files, all.count));
    if (status == SONJECT_OK) {
        status = form_traced(tracing, result);
        checkpoint_clear(&tracing->checkpoint);
    }
    free(all.files);
    return status;
}

/* A shard, or all of a run: what is there already, and then the rest. */
static sonject_status run_shard(struct tracing *tracing, struct injection_result *result,
                                bool *is_formed)
{
    struct sums_folder folder;
    struct sums_chain chain = {NULL, 0, 0, false};
    const bool is_whole = tracing->job->request->shards == 0;
    CHECK(check_shards(tracing));
    sonject_status status =
        sums_folder_read(&folder, tracing->report, tracing->folder, tracing->head.shard, true);
    THEN(status, check_folder(tracing, &folder));
    THEN(status, sums_chain_find(&chain, tracing->report, &folder, tracing->head.shard));
    if (status == SONJECT_OK && chain.count > 0)
        report_news(tracing->report, "goes on with what is in %s", tracing->folder);
    if (status == SONJECT_OK && is_whole && chain.count == 0)
        status = trace_and_form(tracing, result, is_formed);
    else if (status == SONJECT_OK)
        status = trace_rest(tracing, chain.next, chain.is_complete);
    sums_chain_clear(&chain);
    sums_folder_clear(&folder);
    if (status != SONJECT_OK || !is_whole || *is_formed)
        return status;
    status = sums_folder_read(&folder, tracing->report, tracing->folder, 1, false);
    THEN(status, add_up(tracing, &folder, result));
    *is_formed = status == SONJECT_OK;
    sums_folder_clear(&folder);
    return status;
}

static sonject_status merge(struct tracing *tracing, struct injection_result *result,
                            bool *is_formed)
{
    struct sums_folder folder;
    sonject_status status = sums_folder_read(&folder, tracing->report, tracing->folder, 0, false);
    if (status == SONJECT_OK && folder.count == 0)
        status =
            report_failure(tracing->report, SONJECT_ERROR_INPUT,
                           "%s: holds no shards: run them with --shard I/K first", tracing->folder);
    THEN(status, check_merged(tracing, &folder));
    THEN(status, add_up(tracing, &folder, result));
    *is_formed = status == SONJECT_OK;
    sums_folder_clear(&folder);
    return status;
}

sonject_status inject_by_checkpoints(const struct checkpoint_job *job,
                                     struct injection_result *result, bool *is_formed)
{
    struct tracing tracing;
    memset(&tracing, 0, sizeof tracing);
    tracing.job = job;
    tracing.report = job->report;
    tracing.folder = checkpoints_folder(job->request->folder);
    *is_formed = false;
    sonject_status status = tracing.folder ? take_sums_head(&tracing)
                                           : report_out_of_memory(tracing.report, "a file name");
    THEN(status, kept_scene_join(&tracing.source, tracing.report, job->request->source));
    THEN(status, job->request->merges ? merge(&tracing, result, is_formed)
                                      : run_shard(&tracing, result, is_formed));
    free(tracing.folder);
    free((void *)tracing.source.texts);
    return status;
}
