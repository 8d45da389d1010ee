#include "inject/checkpoints.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/report.h"
#include "base/system/process.h"
#include "inject/accuracy.h"
#include "inject/scene_hash.h"
#include "trace/checkpoint.h"

#define CHECKPOINT_S 60.0
#define NAMES_MOST   12 /* most shards that a message names */

/* The tracing of one call. */
struct tracing {
    const struct checkpoint_job *job;
    struct report *report;
    const struct scene *scene; /* the job's, and its input, after pilots */
    struct injection_input input;
    struct pilots pilots;
    char *folder;          /* the folder `work`; owned */
    struct sums_head head; /* head of what the call traces, or merges */
    struct checkpoint checkpoint;
    double checkpoint_start_s;
    double fraction; /* fraction that was told last */
    const char *stage;
    bool is_cancelled, is_over; /* the caller cancelled; the time is up */
};

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

sonject_status refuse_foreign_sums(struct report *report, const char *path, const char *what)
{
    return input_failure(
        report, path, "traced by %s: choose another folder, or delete the work in this one", what);
}

/* Identifies the tallies of this call. */
static sonject_status identify(struct tracing *tracing)
{
    const struct checkpoint_job *job = tracing->job;
    struct sums_identity *identity = &tracing->head.identity;
    tracing->head.shard = job->request->shards > 0 ? job->request->shard : 1;
    tracing->head.shards = job->request->shards > 0 ? job->request->shards : 1;
    strncpy(identity->version, sonject_version(), sizeof identity->version - 1);
    strncpy(identity->scene, job->scene_hash, sizeof identity->scene - 1);
    strncpy(identity->image, job->image_hash, sizeof identity->image - 1);
    return code_hash(tracing->report, identity->code);
}

/* Begins a call. Afterwards, also on failure, the pilots are to be cleared. */
static sonject_status begin(struct tracing *tracing, const struct checkpoint_job *job)
{
    const struct run_request *request = job->request;
    memset(tracing, 0, sizeof *tracing);
    tracing->job = job;
    tracing->report = job->report;
    tracing->scene = request->scene;
    tracing->input = *job->input;
    if (request->traced != request->scene)
        tracing->input.traced = request->traced;
    tracing->input.checkpoint = &tracing->checkpoint;
    return identify(tracing);
}

/* Finds the number of rays before anything is traced, once it is known that anything has to be. */
static sonject_status find_rays(struct tracing *tracing)
{
    const struct checkpoint_job *job = tracing->job;
    return tracing->input.pilots
               ? SONJECT_OK
               : pilots_find(&tracing->pilots, job->report, job->device, &tracing->scene,
                             &tracing->input, job->progress, job->user);
}

/* Returns NULL where the tallies are of the same scene, image and version, or what differs. */
static const char *difference(const struct sums_identity *found, const struct sums_identity *mine)
{
    if (strcmp(found->version, mine->version) != 0 || strcmp(found->code, mine->code) != 0)
        return "another version of sonject";
    return strcmp(found->scene, mine->scene) == 0 ? NULL : "another scene or image";
}

/* Checks that the folder holds no work of another number of shards; a whole run is one. */
static sonject_status check_shards(const struct tracing *tracing)
{
    uint64_t others;
    const uint64_t mine = tracing->head.shards;
    CHECK(sums_folder_shards(tracing->report, tracing->folder, mine, &others));
    if (others == 0)
        return SONJECT_OK;
    return input_failure(tracing->report, tracing->folder,
                         "holds work of a run in %llu shard%s, this is one in %llu: choose "
                         "another folder, or delete that work",
                         (unsigned long long)others, others == 1 ? "" : "s",
                         (unsigned long long)mine);
}

/* Checks that the folder's tallies are this scene's. Drops a whole run's of another scene. */
static sonject_status check_folder(struct tracing *tracing, struct sums_folder *folder)
{
    struct report *report = tracing->report;
    const struct run_request *request = tracing->job->request;
    const struct sums_identity *mine = &tracing->head.identity;
    for (size_t i = 0; i < folder->count; i++) {
        const struct sums_file *file = &folder->files[i];
        const char *what = difference(&file->head.identity, mine);
        if (what && (request->shards > 0 || request->merges))
            return refuse_foreign_sums(report, file->path, what);
        if (what) {
            report_log(report, "%s was traced by %s and is dropped", tracing->folder, what);
            sums_folder_clear(folder);
            sums_folder_remove(tracing->folder);
        }
    }
    return SONJECT_OK;
}

/* Tells the progress of a trace. Notes a wish to stop: the trace then goes through its launches
 * without tracing. */
static int tell(void *user, double fraction, const char *stage)
{
    struct tracing *tracing = user;
    const struct checkpoint_job *job = tracing->job;
    tracing->fraction = fraction;
    tracing->stage = stage;
    if (!tracing->is_cancelled && job->progress && job->progress(job->user, fraction, stage))
        tracing->is_cancelled = true;
    if (!tracing->is_cancelled || !tracing->checkpoint.launches || tracing->checkpoint.files)
        return tracing->is_cancelled;
    tracing->checkpoint.is_stopping = true;
    return 0;
}

static int ask(void *user)
{
    struct tracing *tracing = user;
    const struct run_request *request = tracing->job->request;
    const double now = clock_seconds();
    const double checkpoint = request->checkpoint_s > 0.0 ? request->checkpoint_s : CHECKPOINT_S;
    if (tracing->stage)
        tell(tracing, tracing->fraction, tracing->stage);
    if (request->exit_after_s > 0.0 && now - tracing->job->start_s >= request->exit_after_s)
        tracing->is_over = true;
    return tracing->is_cancelled || tracing->is_over ||
           now - tracing->checkpoint_start_s >= checkpoint;
}

static sonject_status begin_checkpoint(struct tracing *tracing, uint64_t first)
{
    tracing->head.first = first;
    CHECK(checkpoint_begin(&tracing->checkpoint, tracing->report, NULL, tracing->folder,
                           &tracing->head));
    tracing->checkpoint.ask = ask;
    tracing->checkpoint.user = tracing;
    tracing->checkpoint_start_s = clock_seconds();
    return SONJECT_OK;
}

/* Ends a checkpoint and keeps what it traced, to the end or not. CANCELLED ends the call. */
static sonject_status end_checkpoint(struct tracing *tracing, sonject_status traced, uint64_t *next,
                                     bool *is_complete)
{
    struct checkpoint *checkpoint = &tracing->checkpoint;
    const struct run_request *request = tracing->job->request;
    sonject_status status = traced;
    const bool is_through = !checkpoint->launches; /* all launches were gone through */
    *next = checkpoint->next;
    *is_complete = is_through && checkpoint->next >= checkpoint->strips;
    if (is_through && (traced == SONJECT_OK || traced == SONJECT_CANCELLED))
        status = *is_complete || checkpoint->next > checkpoint->head.first
                     ? checkpoint_publish(checkpoint, request->source)
                     : SONJECT_OK;
    if (status == SONJECT_OK && tracing->is_cancelled)
        status = report_failure(tracing->report, SONJECT_CANCELLED, "cancelled while tracing");
    else if (status == SONJECT_OK && tracing->is_over && !*is_complete)
        status = report_failure(tracing->report, SONJECT_CANCELLED, "stopped after %g s",
                                request->exit_after_s);
    checkpoint_clear(checkpoint);
    return status;
}

sonject_status trace_into_file(const struct checkpoint_job *job, const char *path)
{
    struct tracing tracing;
    sonject_status status = begin(&tracing, job);
    THEN(status, find_rays(&tracing));
    THEN(status, checkpoint_begin(&tracing.checkpoint, job->report, path, NULL, &tracing.head));
    THEN(status, injection_trace(job->report, job->device, tracing.scene, &tracing.input,
                                 job->progress, job->user));
    THEN(status, checkpoint_publish(&tracing.checkpoint, job->request->source));
    checkpoint_clear(&tracing.checkpoint);
    pilots_clear(&tracing.pilots);
    return status;
}

/* Traces from a strip of the shard to its end, checkpoint by checkpoint. */
static sonject_status trace_rest(struct tracing *tracing, uint64_t next, bool is_complete)
{
    const struct checkpoint_job *job = tracing->job;
    if (!is_complete)
        CHECK(find_rays(tracing));
    while (!is_complete) {
        CHECK(begin_checkpoint(tracing, next));
        const sonject_status status = injection_trace(tracing->report, job->device, tracing->scene,
                                                      &tracing->input, tell, tracing);
        CHECK(end_checkpoint(tracing, status, &next, &is_complete));
    }
    return SONJECT_OK;
}

/* Forms the result, tracing what tracing->checkpoint does not hold. Forms another response than was
 * traced where the request says so. */
static sonject_status form_traced(struct tracing *tracing, struct injection_result *result)
{
    CHECK(find_rays(tracing));
    return injection_run(tracing->report, tracing->job->device, tracing->scene, &tracing->input,
                         tell, tracing, result);
}

/* Traces all in one go and forms the result. If stopped, keeps the tallies and traces the rest. */
static sonject_status trace_and_form(struct tracing *tracing, struct injection_result *result,
                                     bool *is_formed)
{
    uint64_t next;
    bool is_complete;
    CHECK(find_rays(tracing));
    CHECK(begin_checkpoint(tracing, 0));
    const sonject_status status = form_traced(tracing, result);
    *is_formed = status == SONJECT_OK;
    if (*is_formed) {
        checkpoint_clear(&tracing->checkpoint);
        return SONJECT_OK;
    }
    CHECK(end_checkpoint(tracing, status, &next, &is_complete));
    return trace_rest(tracing, next, is_complete);
}

/* Lists all tallies in the order of shards. files: room for all files of the folder. */
static sonject_status collect(const struct tracing *tracing, const struct sums_folder *folder,
                              const struct sums_file **files, size_t *count)
{
    const uint64_t shards = tracing->head.shards;
    struct growing_text missing = {NULL, 0, 0, false};
    uint32_t missing_count = 0;
    sonject_status status = SONJECT_OK;
    for (uint64_t shard = 1; status == SONJECT_OK && shard <= shards; shard++) {
        struct sums_chain chain;
        status = sums_chain_find(&chain, tracing->report, folder, shard);
        if (status == SONJECT_OK && !chain.is_complete && missing_count++ < NAMES_MOST)
            growing_text_add(&missing, "%s%llu%s", missing_count > 1 ? ", " : "",
                             (unsigned long long)shard, chain.count > 0 ? " (not finished)" : "");
        for (size_t i = 0; i < chain.count; i++)
            files[(*count)++] = chain.files[i];
        free(chain.files);
    }
    if (status == SONJECT_OK && missing_count > NAMES_MOST)
        growing_text_add(&missing, " and %u more", (unsigned)(missing_count - NAMES_MOST));
    char *names = growing_text_end(&missing);
    if (status == SONJECT_OK && !names)
        status = report_out_of_memory(tracing->report, "shards");
    if (status == SONJECT_OK && missing_count > 0)
        status = input_failure(
            tracing->report, tracing->folder,
            "of %llu shards, these are missing: %s; run each with --shard, then merge again",
            (unsigned long long)shards, names);
    free(names);
    return status;
}

/* Forms the sum of the folder's checkpoints. */
static sonject_status add_up(struct tracing *tracing, const struct sums_folder *folder,
                             struct injection_result *result)
{
    size_t count = 0;
    const struct sums_file **files = allocate_array(folder->count, sizeof *files);
    CHECK_MEMORY(tracing->report, files, "shards");
    sonject_status status = collect(tracing, folder, files, &count);
    THEN(status, checkpoint_begin_adding(&tracing->checkpoint, tracing->report, files, count));
    THEN(status, form_traced(tracing, result));
    checkpoint_clear(&tracing->checkpoint);
    free(files);
    return status;
}

/* Forms the contents of a file of everything. */
static sonject_status form_sums(struct tracing *tracing, struct injection_result *result)
{
    const struct sums_file *const *file = &tracing->job->request->sums;
    CHECK(checkpoint_begin_adding(&tracing->checkpoint, tracing->report, file, 1));
    const sonject_status status = form_traced(tracing, result);
    checkpoint_clear(&tracing->checkpoint);
    return status;
}

static sonject_status merge(struct tracing *tracing, struct injection_result *result)
{
    struct sums_folder folder;
    sonject_status status =
        sums_folder_read(&folder, tracing->report, tracing->folder, 0, SIZE_MAX, false);
    if (status == SONJECT_OK && folder.count == 0)
        status = input_failure(tracing->report, tracing->folder,
                               "holds no shards: run them with --shard I/K first");
    THEN(status, check_folder(tracing, &folder));
    if (status == SONJECT_OK) {
        tracing->head.shards = folder.files[0].head.shards;
        status = tracing->head.shards <= SHARDS_MAX
                     ? check_shards(tracing)
                     : input_failure(tracing->report, folder.files[0].path, "more shards than %d",
                                     SHARDS_MAX);
    }
    THEN(status, add_up(tracing, &folder, result));
    sums_folder_clear(&folder);
    return status;
}

/* Runs a shard, or all of a run: takes what is there, and traces the rest. */
static sonject_status run_shard(struct tracing *tracing, struct injection_result *result,
                                bool *is_formed)
{
    struct sums_folder folder;
    struct sums_chain chain = {NULL, 0, 0, false};
    const bool is_whole = tracing->job->request->shards == 0;
    CHECK(check_shards(tracing));
    sonject_status status = sums_folder_read(&folder, tracing->report, tracing->folder,
                                             tracing->head.shard, SIZE_MAX, true);
    THEN(status, check_folder(tracing, &folder));
    THEN(status, sums_chain_find(&chain, tracing->report, &folder, tracing->head.shard));
    free(chain.files);
    sums_folder_clear(&folder);
    if (status == SONJECT_OK && chain.count > 0)
        report_log(tracing->report, "continues the work in %s", tracing->folder);
    THEN(status, is_whole && chain.count == 0 ? trace_and_form(tracing, result, is_formed)
                                              : trace_rest(tracing, chain.next, chain.is_complete));
    if (status != SONJECT_OK || !is_whole || *is_formed)
        return status;
    status = sums_folder_read(&folder, tracing->report, tracing->folder, 1, SIZE_MAX, false);
    THEN(status, add_up(tracing, &folder, result));
    *is_formed = status == SONJECT_OK;
    sums_folder_clear(&folder);
    return status;
}

sonject_status inject_by_checkpoints(const struct checkpoint_job *job,
                                     struct injection_result *result, bool *is_formed)
{
    struct tracing tracing;
    sonject_status status = begin(&tracing, job);
    tracing.folder = checkpoints_folder(job->request->folder);
    if (status == SONJECT_OK && !tracing.folder)
        status = report_out_of_memory(job->report, "a file name");
    *is_formed = status == SONJECT_OK && (job->request->merges || job->request->sums);
    THEN(status, job->request->merges ? merge(&tracing, result)
                 : job->request->sums ? form_sums(&tracing, result)
                                      : run_shard(&tracing, result, is_formed));
    free(tracing.folder);
    pilots_clear(&tracing.pilots);
    return status;
}
