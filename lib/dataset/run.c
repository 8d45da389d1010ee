#define _POSIX_C_SOURCE 200809L
#include "dataset/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/report.h"
#include "dataset/earlier_result.h"
#include "inject/checkpoints.h"
#include "inject/impulses.h"
#include "inject/scene_hash.h"
#include "inject/swath.h"
#include "schema/scene_file.h"

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
    char path[PATH_CAPACITY];
    CHECK(path_in(report, path, folder, "truth.json"));
    CHECK(write_truth(report, facts, path));
    CHECK(file_list_add(&facts->files, report, folder, "truth.json", true));
    CHECK(write_labels(report, facts, folder));
    const double now = clock_seconds();
    facts->write_s = now - write_start;
    facts->total_s = now - run_start;
    CHECK(path_in(report, path, folder, RUN_DOCUMENT));
    return write_run(report, facts, path);
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
    char path[PATH_CAPACITY];
    CHECK(path_in(report, path, folder, "%s", facts->image_name));
    json_t *earlier = earlier_withdraw(folder, RUN_DOCUMENT);
    facts->files = json_array();
    sonject_status status = write_layers(report, facts, folder);
    THEN(status, swath_write(report, facts->scene, facts->swath, result, path, tell_stage, &writing,
                             &result->statistics.output_clipped));
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

/* Whether scene and image are those that the impulses were traced from, but for what image
 * formation alone depends on. Errors: INPUT, MEMORY. */
static sonject_status check_traced(struct report *report, const struct impulse_file *impulses,
                                   const struct scene *scene, const struct swath *swath)
{
    const struct impulse_facts *facts = &impulses->facts;
    char hash[HASH_TEXT_CAPACITY];
    if (facts->image_rows != swath->layout.rows || facts->image_columns != swath->layout.columns ||
        strcmp(facts->image_hash, swath->identity) != 0)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: not the image that was traced, %s of %llu x %llu pixels (XXH3 %s): name that one "
            "with input.path, or trace again",
            scene->input_path ? scene->input_path : "the made seabed",
            *impulses->image_path ? impulses->image_path : "a made one",
            (unsigned long long)facts->image_rows, (unsigned long long)facts->image_columns,
            facts->image_hash);
    const sonject_status status = traced_scene_hash(report, scene, swath->identity, hash);
    if (status == SONJECT_OK && strcmp(hash, impulses->sums.head.identity.scene) != 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the scene, or a file that it names, is not what was traced: trace "
                              "again");
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

static sonject_status describe(struct report *report, const struct scene *scene,
                               const struct swath *swath, struct sums_head *head,
                               struct impulse_facts *facts)
{
    char hash[HASH_TEXT_CAPACITY];
    memset(head, 0, sizeof *head);
    memset(facts, 0, sizeof *facts);
    strncpy(head->identity.version, sonject_version(), sizeof head->identity.version - 1);
    facts->image_rows = swath->layout.rows;
    facts->image_columns = swath->layout.columns;
    strncpy(facts->image_hash, swath->identity, sizeof facts->image_hash - 1);
    impulse_facts_note_sonar(facts, &scene->sonar);
    CHECK(traced_scene_hash(report, scene, swath->identity, hash));
    memcpy(head->identity.scene, hash, sizeof hash);
    return SONJECT_OK;
}

/* The lines go to the file and, where one is wanted, to its export. */
struct two_files {
    struct sums_writer *sums;
    struct impulse_export *export;
};

static sonject_status write_lines(void *taker, const struct impulse_lines *lines)
{
    const struct two_files *files = taker;
    const sonject_status status = impulse_lines_write(files->sums, lines);
    return status == SONJECT_OK && files->export ? impulse_export_lines(files->export, lines)
                                                 : status;
}

static sonject_status trace_swath(struct report *report, struct device_slot *slot,
                                  const struct run_request *request, const struct swath *swath,
                                  const char *file, const char *export_file)
{
    const struct scene *scene = request->scene;
    const char *image_path = scene->input_path ? scene->input_path : "";
    const struct injection_input input = swath_input(swath);
    struct device *device;
    struct sums_head head;
    struct impulse_facts facts;
    struct sums_writer writer;
    struct two_files files = {&writer, NULL};
    const struct impulse_sink sink = {write_lines, &files};
    memset(&writer, 0, sizeof writer);
    sonject_status status = describe(report, scene, swath, &head, &facts);
    THEN(status, sums_writer_begin(&writer, report, file, NULL));
    if (status == SONJECT_OK && export_file && *export_file)
        status = impulse_export_begin(report, export_file, &files.export);
    THEN(status, device_slot_open(report, slot, &device));
    THEN(status, injection_trace(report, device, scene, &input, &sink, request->progress,
                                 request->user, &facts.counts));
    if (status == SONJECT_OK && files.export)
        status = impulse_export_publish(files.export, scene, &input, &facts, head.identity.scene,
                                        image_path);
    THEN(status, impulse_file_publish(&writer, &head, request->source, &facts, image_path));
    impulse_export_release(&files.export);
    sums_writer_clear(&writer);
    return status;
}

sonject_status trace_scene(struct report *report, struct device_slot *slot,
                           const struct run_request *request, const char *file,
                           const char *export_file)
{
    struct swath swath;
    CHECK(swath_open(report, request->scene, &swath));
    const sonject_status status = trace_swath(report, slot, request, &swath, file, export_file);
    swath_close(&swath);
    return status;
}

/* Keys that image formation alone depends on, and where the image lies. */
static const char *const formed_keys[] = {
    "sonar.bandwidth",         "sonar.pulse",  "sonar.resolution", "sonar.response",
    "sonar.measured_response", "sonar.motion", "input.path"};

static bool names_formed_key(const char *override)
{
    const size_t length = strcspn(override, "=");
    for (size_t i = 0; i < sizeof formed_keys / sizeof *formed_keys; i++) {
        const size_t key = strlen(formed_keys[i]);
        if (strncmp(override, formed_keys[i], key) == 0 && key <= length &&
            (key == length || strchr(". ", override[key])))
            return true;
    }
    return false;
}

static sonject_status check_overrides(struct report *report, const struct scene *scene,
                                      const sonject_form_params *params)
{
    if (params->override_count > 0 && scene)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "a scene that is given takes no overrides");
    for (uint32_t i = 0; i < params->override_count; i++) {
        const char *override = params->overrides[i];
        if (!names_formed_key(override))
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "--set %.*s: needs a new trace; image formation takes "
                "sonar.bandwidth, sonar.pulse, sonar.resolution, sonar.response, "
                "sonar.measured_response, sonar.motion and "
                "input.path",
                (int)(strcspn(override, "=") < 200 ? strcspn(override, "=") : 200), override);
    }
    return SONJECT_OK;
}

static sonject_status check_version(struct report *report, const char *path,
                                    const struct sums_identity *identity)
{
    if (strcmp(identity->version, sonject_version()) == 0)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: traced by sonject %s, but this is %s: trace again", path,
                          identity->version, sonject_version());
}

/* All overrides, the file's first, in one list to be given to free(). */
static const char **join_overrides(const struct kept_scene *kept, const sonject_form_params *params)
{
    const char **all = allocate_array(kept->override_count + params->override_count, sizeof(*all));
    for (size_t i = 0; all && i < kept->override_count; i++)
        all[i] = kept->overrides[i];
    for (uint32_t i = 0; all && i < params->override_count; i++)
        all[kept->override_count + i] = params->overrides[i];
    return all;
}

sonject_status read_traced_scene(struct report *report, const struct kept_scene *kept,
                                 const sonject_form_params *params, struct scene *scene)
{
    if (!kept->text)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: traced from a scene that was in no file: give the scene",
                              params->file);
    char *here = working_folder();
    const bool is_here = here && strcmp(here, kept->folder) == 0;
    char *path = is_here ? copy_text(kept->path) : path_join(kept->folder, kept->path);
    const char **overrides = join_overrides(kept, params);
    struct scene_text source;
    memset(&source, 0, sizeof source);
    source.path = path;
    source.text = kept->text;
    source.bytes = strlen(kept->text);
    source.overrides = overrides;
    source.override_count = kept->override_count + params->override_count;
    source.moved_folder = is_here ? NULL : kept->folder;
    source.moved_overrides = kept->override_count;
    source.allows_user_shapes = params->allows_user_shapes != 0;
    const sonject_status status = path && overrides
                                      ? scene_text_read(report, &source, scene)
                                      : report_out_of_memory(report, "the scene's text");
    free(here);
    free(path);
    free(overrides);
    return status;
}

static sonject_status form_file(struct report *report, struct device_slot *slot,
                                const struct scene *scene, const sonject_form_params *params,
                                struct run_request *request, int *was_finished)
{
    const struct sums_file *sums = &request->impulses->sums;
    struct scene read;
    scene_init(&read);
    sonject_status status = check_version(report, params->file, &sums->head.identity);
    if (status == SONJECT_OK && !scene)
        status = read_traced_scene(report, &sums->scene, params, &read);
    request->scene = scene ? scene : &read;
    THEN(status, run_scene(report, slot, request, was_finished));
    scene_clear(&read);
    return status;
}

sonject_status form_scene(struct report *report, struct device_slot *slot,
                          const struct scene *scene, const sonject_form_params *params,
                          const struct run_request *request, int *was_finished)
{
    struct impulse_file impulses;
    struct run_request forming = *request;
    forming.impulses = &impulses;
    CHECK(check_overrides(report, scene, params));
    CHECK(impulse_file_open(report, params->file, &impulses));
    const sonject_status status = form_file(report, slot, scene, params, &forming, was_finished);
    impulse_file_close(&impulses);
    return status;
}
