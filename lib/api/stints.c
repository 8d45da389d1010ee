#include "api/stints.h"

#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "api/stint_source.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/growing_text.h"
#include "base/memory.h"
#include "cl/sources.h"
#include "inject/traced_impulses.h"
#include "trace/stint.h"
#include "trace/stint_folder.h"

#define CHECKPOINT_S 60.0
#define NAMES_MOST   12 /* shards that a message names */

/* One call's tracing. */
struct tracing {
    const struct stint_job *job;
    struct report *report;
    char *folder; /* work; owned */
    struct stint_head head;
    struct stint_source source; /* owned texts */
    struct stint stint;
    double stint_start_s;
    double fraction; /* that was told last */
    const char *stage;
    bool is_cancelled, is_over; /* by the caller; its time */
};

char *stints_folder(const char *folder)
{
    return path_join(folder, "work");
}

void stints_remove(const char *folder)
{
    char *work = stints_folder(folder);
    if (work)
        stint_folder_remove(work);
    free(work);
}

static sonject_status take_code(struct report *report, char code[STINT_DIGEST_CAPACITY])
{
    char digest[HASH_TEXT_CAPACITY];
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(report, "a hash");
    for (int i = 0; i < PROGRAM_COUNT; i++)
        hash_add(hash, embedded_sources[i].text, embedded_sources[i].bytes);
    hash_end(hash, digest);
    memcpy(code, digest, sizeof digest);
    return SONJECT_OK;
}

/* Code of users may answer differently on another device. */
static sonject_status take_device(struct report *report, const struct stint_job *job,
                                  char device[STINT_DIGEST_CAPACITY])
{
    char digest[HASH_TEXT_CAPACITY];
    if (job->request->scene->user_shapes.count == 0)
        return SONJECT_OK;
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(report, "a hash");
    hash_add_text(hash, job->device->name);
    hash_add_text(hash, job->device->platform);
    hash_add_text(hash, job->device->driver);
    hash_end(hash, digest);
    memcpy(device, digest, sizeof digest);
    return SONJECT_OK;
}

static sonject_status take_head(struct tracing *tracing)
{
    const struct stint_job *job = tracing->job;
    struct stint_identity *identity = &tracing->head.identity;
    tracing->head.shard = job->request->shards > 0 ? job->request->shard : 1;
    tracing->head.shards = job->request->shards > 0 ? job->request->shards : 1;
    strncpy(identity->version, sonject_version(), sizeof identity->version - 1);
    strncpy(identity->scene, job->traced_hash, sizeof identity->scene - 1);
    strncpy(tracing->head.result, job->scene_hash, sizeof tracing->head.result - 1);
    const sonject_status status = take_code(tracing->report, identity->code);
    return status == SONJECT_OK ? take_device(tracing->report, job, identity->device) : status;
}

/* NULL where the tallies are of the same scene, image and version; else what differs. */
static const char *difference(const struct stint_identity *a, const struct stint_identity *b)
{
    if (strcmp(a->version, b->version) != 0 || strcmp(a->code, b->code) != 0)
        return "another version of sonject";
    return strcmp(a->scene, b->scene) == 0 ? NULL : "another scene or image";
}

sonject_status refuse_foreign_stint(struct report *report, const char *path, const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: traced by %s: choose another folder, or delete the work in this one",
                          path, what);
}

/* What is there must be ours; what an earlier whole run left of something else is dropped. */
static sonject_status check_folder(struct tracing *tracing, struct stint_folder *folder)
{
    struct report *report = tracing->report;
    const struct stint_identity *mine = &tracing->head.identity;
    const bool is_shard = tracing->job->request->shards > 0;
    for (size_t i = 0; i < folder->count; i++) {
        const struct stint_file *file = &folder->files[i];
        const char *what = difference(&file->head.identity, mine);
        if (!what && strcmp(file->head.identity.device, mine->device) != 0)
            what = "another device, on which code of shapes may answer differently";
        if (what && is_shard)
            return refuse_foreign_stint(report, file->path, what);
        if (what) {
            report_news(report, "%s was traced by %s and is dropped", tracing->folder, what);
            stint_folder_clear(folder);
            stint_folder_remove(tracing->folder);
        }
    }
    return SONJECT_OK;
}

/* Shards of another number, or of a whole run and of shards, do not go together. */
static sonject_status check_shards(struct tracing *tracing)
{
    uint64_t others;
    const uint64_t mine = tracing->head.shards;
    const sonject_status status =
        stint_folder_shards(tracing->report, tracing->folder, mine, &others);
    if (status != SONJECT_OK || others == 0)
        return status;
    return report_failure(tracing->report, SONJECT_ERROR_INPUT,
                          "%s: holds work of a run in %llu shard%s, this is one in %llu: choose "
                          "another folder, or delete that work",
                          tracing->folder, (unsigned long long)others, others == 1 ? "" : "s",
                          (unsigned long long)mine);
}

/* Progress of a trace: a wish to stop is noted, and the rest of the trace gone through without
 * tracing. */
static int tell(void *user, double fraction, const char *stage)
{
    struct tracing *tracing = user;
    const struct stint_job *job = tracing->job;
    tracing->fraction = fraction;
    tracing->stage = stage;
    if (!tracing->is_cancelled && job->progress && job->progress(job->user, fraction, stage))
        tracing->is_cancelled = true;
    if (!tracing->is_cancelled || !tracing->stint.course || tracing->stint.files)
        return tracing->is_cancelled;
    tracing->stint.is_stopping = true;
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
    return tracing->is_cancelled || tracing->is_over || now - tracing->stint_start_s >= checkpoint;
}

static sonject_status begin_stint(struct tracing *tracing, uint64_t first)
{
    const sonject_status status = stint_begin(&tracing->stint, tracing->report, tracing->folder,
                                              &tracing->head, tracing->source, first);
    tracing->stint.ask = ask;
    tracing->stint.user = tracing;
    tracing->stint_start_s = clock_seconds();
    return status;
}

/* Keeps what a stint traced that ended, whether it got to the end or not. */
static sonject_status keep_stint(struct tracing *tracing)
{
    const struct stint *stint = &tracing->stint;
    if (stint->next == stint->first && stint->next < stint->strips)
        return SONJECT_OK;
    const sonject_status status = folder_make(tracing->report, tracing->folder);
    return status == SONJECT_OK ? stint_publish(&tracing->stint) : status;
}

/* After a stint: publishes it where tracing was cut short or is a shard's; CANCELLED where the call
 * is to end. */
static sonject_status end_stint(struct tracing *tracing, sonject_status traced, uint64_t *next,
                                bool *is_complete)
{
    struct stint *stint = &tracing->stint;
    sonject_status status = traced;
    const bool is_through = !stint->course; /* all launches were gone through */
    if ((traced == SONJECT_OK || traced == SONJECT_CANCELLED) && is_through)
        status = keep_stint(tracing);
    *next = stint->next;
    *is_complete = is_through && stint->next >= stint->strips;
    if (status == SONJECT_OK && tracing->is_cancelled)
        status = report_failure(tracing->report, SONJECT_CANCELLED, "cancelled while tracing");
    else if (status == SONJECT_OK && tracing->is_over && !*is_complete)
        status = report_failure(tracing->report, SONJECT_CANCELLED, "stopped after %g s",
                                tracing->job->request->exit_after_s);
    stint_clear(stint);
    return status;
}

static sonject_status take_nothing(void *taker, const struct impulse_lines *lines)
{
    (void)taker;
    (void)lines;
    return SONJECT_OK;
}

/* Traces from a strip of the shard on, stint by stint, to its end. */
static sonject_status trace_rest(struct tracing *tracing, uint64_t next, bool is_complete)
{
    const struct stint_job *job = tracing->job;
    const struct impulse_sink nobody = {take_nothing, NULL};
    struct injection_input input = *job->input;
    sonject_status status = SONJECT_OK;
    input.stint = &tracing->stint;
    while (status == SONJECT_OK && !is_complete) {
        struct trace_counts counts;
        status = begin_stint(tracing, next);
        if (status != SONJECT_OK)
            return status;
        status = injection_trace(tracing->report, job->device, job->request->scene, &input, &nobody,
                                 tell, tracing, &counts);
        status = end_stint(tracing, status, &next, &is_complete);
    }
    return status;
}

static sonject_status form(struct tracing *tracing, struct injection_result *result)
{
    const struct stint_job *job = tracing->job;
    const struct impulse_source source = traced_impulses();
    struct injection_input input = *job->input;
    input.stint = &tracing->stint;
    return injection_form(tracing->report, job->device, job->request->scene, &input, &source, tell,
                          tracing, result);
}

/* A run that traces all in one go forms as it traces. */
static sonject_status trace_and_form(struct tracing *tracing, struct injection_result *result,
                                     bool *is_formed)
{
    uint64_t next;
    bool is_complete;
    sonject_status status = begin_stint(tracing, 0);
    if (status != SONJECT_OK)
        return status;
    status = form(tracing, result);
    *is_formed = status == SONJECT_OK;
    if (*is_formed) {
        stint_clear(&tracing->stint);
        return SONJECT_OK;
    }
    status = end_stint(tracing, status, &next, &is_complete);
    return status == SONJECT_OK ? trace_rest(tracing, next, is_complete) : status;
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
    if (!names)
        return report_out_of_memory(tracing->report, "shards");
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
    const struct stint_file **files; /* owned */
    size_t count;
};

static sonject_status collect(struct tracing *tracing, const struct stint_folder *folder,
                              struct collection *all)
{
    const uint64_t shards = tracing->head.shards;
    struct growing_text missing;
    uint32_t missing_count = 0;
    sonject_status status = SONJECT_OK;
    memset(&missing, 0, sizeof missing);
    all->count = 0;
    all->files = allocate_array(folder->count, sizeof *all->files);
    if (!all->files)
        return report_out_of_memory(tracing->report, "shards");
    for (uint64_t shard = 1; status == SONJECT_OK && shard <= shards; shard++) {
        struct stint_chain chain;
        status = stint_chain_find(&chain, tracing->report, folder, shard);
        if (status != SONJECT_OK)
            break;
        if (!chain.is_complete)
            note_shard(&missing, &missing_count, shard, chain.count > 0);
        for (size_t i = 0; i < chain.count; i++)
            all->files[all->count++] = chain.files[i];
        stint_chain_clear(&chain);
    }
    if (status == SONJECT_OK && missing_count > 0)
        return refuse_incomplete(tracing, &missing, missing_count, shards);
    free(missing.characters);
    return status;
}

/* Forms what the stints in the folder are together. */
static sonject_status add_up(struct tracing *tracing, const struct stint_folder *folder,
                             struct injection_result *result)
{
    struct collection all;
    sonject_status status = collect(tracing, folder, &all);
    if (status == SONJECT_OK)
        status = stint_begin_adding(&tracing->stint, tracing->report, all.files, all.count);
    if (status == SONJECT_OK) {
        status = form(tracing, result);
        stint_clear(&tracing->stint);
    }
    free(all.files);
    return status;
}

/* A shard, or all of a run: what is there already, and then the rest. */
static sonject_status run_shard(struct tracing *tracing, struct injection_result *result,
                                bool *is_formed)
{
    struct stint_folder folder;
    struct stint_chain chain = {NULL, 0, 0, false};
    const bool is_whole = tracing->job->request->shards == 0;
    sonject_status status =
        stint_folder_read(&folder, tracing->report, tracing->folder, tracing->head.shard, true);
    if (status == SONJECT_OK)
        status = check_folder(tracing, &folder);
    if (status == SONJECT_OK)
        status = check_shards(tracing);
    if (status == SONJECT_OK)
        status = stint_chain_find(&chain, tracing->report, &folder, tracing->head.shard);
    if (status == SONJECT_OK && chain.count > 0)
        report_news(tracing->report, "goes on with what is in %s", tracing->folder);
    if (status == SONJECT_OK && is_whole && chain.count == 0)
        status = trace_and_form(tracing, result, is_formed);
    else if (status == SONJECT_OK)
        status = trace_rest(tracing, chain.next, chain.is_complete);
    stint_chain_clear(&chain);
    stint_folder_clear(&folder);
    if (status != SONJECT_OK || !is_whole || *is_formed)
        return status;
    status = stint_folder_read(&folder, tracing->report, tracing->folder, 1, false);
    if (status == SONJECT_OK)
        status = add_up(tracing, &folder, result);
    *is_formed = status == SONJECT_OK;
    stint_folder_clear(&folder);
    return status;
}

/* All shards must be of one run, which is this scene's. */
static sonject_status check_merged(struct tracing *tracing, const struct stint_folder *folder)
{
    const struct stint_head *first = &folder->files[0].head;
    for (size_t i = 0; i < folder->count; i++) {
        const struct stint_file *file = &folder->files[i];
        const char *what = difference(&file->head.identity, &tracing->head.identity);
        if (!what && strcmp(file->head.identity.device, first->identity.device) != 0)
            what = "another device, on which code of shapes may answer differently";
        if (what)
            return refuse_foreign_stint(tracing->report, file->path, what);
    }
    tracing->head.shards = first->shards;
    return first->shards <= SHARDS_MAX
               ? check_shards(tracing)
               : report_failure(tracing->report, SONJECT_ERROR_INPUT, "%s: more shards than %d",
                                folder->files[0].path, SHARDS_MAX);
}

static sonject_status merge(struct tracing *tracing, struct injection_result *result,
                            bool *is_formed)
{
    struct stint_folder folder;
    sonject_status status = stint_folder_read(&folder, tracing->report, tracing->folder, 0, false);
    if (status == SONJECT_OK && folder.count == 0)
        status =
            report_failure(tracing->report, SONJECT_ERROR_INPUT,
                           "%s: holds no shards: run them with --shard I/K first", tracing->folder);
    if (status == SONJECT_OK)
        status = check_merged(tracing, &folder);
    if (status == SONJECT_OK)
        status = add_up(tracing, &folder, result);
    *is_formed = status == SONJECT_OK;
    stint_folder_clear(&folder);
    return status;
}

sonject_status inject_by_stints(const struct stint_job *job, struct injection_result *result,
                                bool *is_formed)
{
    struct tracing tracing;
    memset(&tracing, 0, sizeof tracing);
    tracing.job = job;
    tracing.report = &job->context->report;
    tracing.folder = stints_folder(job->request->folder);
    *is_formed = false;
    sonject_status status =
        tracing.folder ? take_head(&tracing) : report_out_of_memory(tracing.report, "a file name");
    if (status == SONJECT_OK)
        status = stint_source_take(&tracing.source, tracing.report, job->request->source);
    if (status == SONJECT_OK)
        status = job->request->merges ? merge(&tracing, result, is_formed)
                                      : run_shard(&tracing, result, is_formed);
    free(tracing.folder);
    free((void *)tracing.source.texts);
    return status;
}
