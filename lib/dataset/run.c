#include "dataset/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/file_list.h"
#include "base/json_document.h"
#include "dataset/earlier_result.h"
#include "dataset/run_files.h"
#include "inject/checkpoints.h"
#include "inject/scene_hash.h"
#include "inject/swath.h"

/* Shares of a run's progress. */
#define TRACE_START 0.1
#define WRITE_START 0.8

/* Maps a stage's own fraction into the run's. */
struct stage_progress {
    sonject_progress_function progress;
    void *user;
    double start, share;
};

static int tell_stage(void *user, double fraction, const char *stage)
{
    const struct stage_progress *outer = user;
    return outer->progress
               ? outer->progress(outer->user, outer->start + outer->share * fraction, stage)
               : 0;
}

void tell_noise_floor(struct report *report, const struct scene *scene,
                      const sonject_statistics *statistics)
{
    if (scene->injection.estimate_noise)
        report_news(report, "noise floor estimated from the patch: %.1f dB over the mean seabed",
                    statistics->noise_floor_db);
}

static void tell_clipped(struct report *report, const sonject_statistics *statistics)
{
    if (statistics->input_clipped > 0)
        report_news(report,
                    "%llu pixels of the patch are at the image's full scale, so their true "
                    "amplitude may be larger",
                    (unsigned long long)statistics->input_clipped);
    if (statistics->output_clipped > 0)
        report_news(report, "%llu changed pixels are cut at the image's full scale",
                    (unsigned long long)statistics->output_clipped);
}

static sonject_status write_documents(struct report *report, struct run_facts *facts,
                                      const char *folder, double run_start, double write_start)
{
    char *truth = path_join(folder, "truth.json");
    char *run = path_join(folder, RUN_DOCUMENT);
    sonject_status status = truth && run ? SONJECT_OK : report_out_of_memory(report, "a path");
    THEN(status, write_truth(report, facts, truth));
    THEN(status, file_list_add(&facts->files, report, folder, "truth.json", true));
    THEN(status, write_labels(report, facts, folder));
    if (status == SONJECT_OK) {
        const double now = clock_seconds();
        facts->write_s = now - write_start;
        facts->total_s = now - run_start;
        status = write_run(report, facts, run);
    }
    free(truth);
    free(run);
    return status;
}

/* An earlier result stays whole until this one is there to be written. A folder with run.json is
 * always complete. */
static sonject_status write_results(struct report *report, struct run_facts *facts,
                                    struct injection_result *result, const char *folder,
                                    double run_start, sonject_progress_function progress,
                                    void *user)
{
    const double start = clock_seconds();
    struct stage_progress writing = {progress, user, WRITE_START, 1.0 - WRITE_START};
    char *path = path_join(folder, facts->image_name);
    CHECK_MEMORY(report, path, "a path");
    json_t *earlier = earlier_withdraw(folder, RUN_DOCUMENT);
    facts->files = json_array();
    sonject_status status = write_layers(report, facts, folder);
    THEN(status, swath_write(report, facts->scene, facts->swath, result, path, tell_stage, &writing,
                             &result->statistics.output_clipped));
    free(path);
    if (status == SONJECT_OK && facts->scene->input_kind == SONJECT_INPUT_FILE &&
        facts->swath->new_extension)
        report_news(report,
                    "note: %s is written anew: of the input's metadata it keeps the description",
                    facts->image_name);
    THEN(status, file_list_add(&facts->files, report, folder, facts->image_name, true));
    THEN(status, write_documents(report, facts, folder, run_start, start));
    earlier_tidy(folder, earlier, facts->files);
    json_decref(facts->files);
    facts->files = NULL;
    return status;
}

/* Traces and writes. */
static sonject_status run_swath(struct report *report, struct device_slot *slot,
                                const struct run_request *request, const struct swath *swath,
                                struct run_facts *facts, double start)
{
    struct device *device;
    struct injection_result result;
    const struct scene *scene = request->scene;
    struct stage_progress stage = {request->progress, request->user, TRACE_START,
                                   WRITE_START - TRACE_START};
    const struct injection_input input = swath_input(swath);
    bool is_formed = true;
    sonject_status status = device_slot_open(report, slot, &device);
    if (status == SONJECT_OK && request->impulses) {
        const struct impulse_source source = impulse_file_source(request->impulses);
        status =
            injection_form(report, device, scene, &input, &source, tell_stage, &stage, &result);
    } else if (status == SONJECT_OK) {
        const struct checkpoint_job job = {report, device, request,    facts->scene_hash,
                                           &input, start,  tell_stage, &stage};
        status = inject_by_checkpoints(&job, &result, &is_formed);
    }
    if (status != SONJECT_OK || !is_formed)
        return status;
    tell_noise_floor(report, scene, &result.statistics);
    result.statistics.input_clipped = swath->clipped;
    facts->result = &result;
    facts->device = device;
    status = write_results(report, facts, &result, request->folder, start, request->progress,
                           request->user);
    if (status == SONJECT_OK && !request->impulses)
        checkpoints_remove(request->folder);
    if (status == SONJECT_OK)
        tell_clipped(report, &result.statistics);
    injection_result_clear(&result);
    return status;
}

/* The image that the scene's targets go into. Where impulses are formed with another response it
 * stays the one that they were traced for, also a made one. */
static sonject_status open_swath(struct report *report, const struct run_request *request,
                                 struct swath *swath)
{
    struct scene traced = *request->scene;
    if (request->impulses)
        impulse_facts_take_sonar(&request->impulses->facts, &traced.sonar);
    const sonject_status status = swath_open(report, &traced, swath);
    if (status != SONJECT_OK || !request->impulses)
        return status;
    const sonject_status same = check_traced(report, request->impulses, request->scene, swath);
    if (same != SONJECT_OK)
        swath_close(swath);
    return same;
}

/* What the result is made of, and whether the folder holds it. facts->inputs is the caller's. */
static sonject_status check_earlier(struct report *report, struct device_slot *slot,
                                    const struct run_request *request, const struct swath *swath,
                                    struct run_facts *facts, char hash[HASH_TEXT_CAPACITY],
                                    bool *is_finished)
{
    struct device *device = NULL;
    CHECK(scene_inputs(report, request->scene, swath->identity, hash, &facts->inputs));
    if (request->scene->user_shapes.count > 0)
        CHECK(device_slot_open(report, slot, &device));
    json_add(&facts->inputs, "image", json_text(facts->image_name));
    if (device)
        json_add(&facts->inputs, "device", device_document(device));
    const struct earlier_request earlier = {
        request->folder,        RUN_DOCUMENT,        facts->inputs,  request->scene,
        request->label_formats, request->overwrites, request->merges};
    return facts->inputs ? earlier_check(report, &earlier, is_finished)
                         : report_out_of_memory(report, "a run's inputs");
}

sonject_status run_scene(struct report *report, struct device_slot *slot,
                         const struct run_request *request, int *was_finished)
{
    const double start = clock_seconds();
    struct swath swath;
    struct run_facts facts;
    char hash[HASH_TEXT_CAPACITY];
    bool is_finished = false;
    memset(&facts, 0, sizeof facts);
    CHECK(open_swath(report, request, &swath));
    char *image_name = swath_image_name(request->scene, &swath);
    facts.scene = request->scene;
    facts.swath = &swath;
    facts.scene_hash = hash;
    facts.image_name = image_name;
    facts.label_formats = request->label_formats;
    sonject_status status =
        image_name ? check_earlier(report, slot, request, &swath, &facts, hash, &is_finished)
                   : report_out_of_memory(report, "a path");
    if (status == SONJECT_OK && !is_finished)
        status = folder_make(report, request->folder);
    if (status == SONJECT_OK && !is_finished) {
        facts.read_s = clock_seconds() - start;
        status = run_swath(report, slot, request, &swath, &facts, start);
    }
    if (was_finished)
        *was_finished = is_finished;
    json_decref(facts.inputs);
    free(image_name);
    swath_close(&swath);
    return status;
}
