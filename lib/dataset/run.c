#include "dataset/run.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/report.h"
#include "base/system/process.h"
#include "inject/scene_hash.h"
#include "schema/scene_file.h"

/* Fractions of a run's progress at which tracing and writing start. */
#define TRACE_START 0.1
#define WRITE_START 0.8

/* The receivers of a result's notes. */
struct result_notes {
    struct report *report;
    json_t *page; /* NULL where memory is out */
};

static void add_note(void *user, uint32_t level, const char *line)
{
    struct result_notes *notes = user;
    json_append(&notes->page, json_string(line));
    report_line(notes->report, level, line);
}

/* Tells the result to the log and to the page. */
static void note_result(struct report *report, struct run_facts *facts)
{
    struct result_notes notes = {report, json_array()};
    const struct report_host host = {.log_user = &notes};
    struct report noting = {.log = add_note, .host = &host};
    tell_result(&noting, facts->scene, facts->swath, facts->result);
    json_add(&facts->page, "notes", notes.page);
}

static sonject_status write_documents(struct report *report, struct run_facts *facts,
                                      const char *folder, double run_start, double write_start)
{
    char path[PATH_CAPACITY];
    CHECK(path_in(report, path, folder, TRUTH_DOCUMENT));
    CHECK(write_truth(report, facts, path));
    CHECK(file_list_add(&facts->files, report, folder, TRUTH_DOCUMENT, true));
    CHECK(write_labels(report, facts, folder));
    CHECK(path_in(report, path, folder, REPORT_PAGE));
    CHECK(write_run_page(report, facts, path));
    CHECK(file_list_add(&facts->files, report, folder, REPORT_PAGE, true));
    const double now = clock_seconds();
    facts->write_s = now - write_start;
    facts->total_s = now - run_start;
    CHECK(path_in(report, path, folder, RUN_DOCUMENT));
    return write_run(report, facts, path);
}

/* Writes the result's files. An earlier result stays whole until the new one is ready. A folder
 * with run.json is always complete. */
static sonject_status write_results(struct report *report, struct run_facts *facts,
                                    struct injection_result *result, const char *folder,
                                    double run_start, sonject_progress_function progress,
                                    void *user)
{
    const double start = clock_seconds();
    struct progress_share writing = {progress, user, WRITE_START, 1.0 - WRITE_START};
    char path[PATH_CAPACITY];
    CHECK(path_in(report, path, folder, "%s", facts->image_name));
    json_t *earlier = earlier_withdraw(folder, RUN_DOCUMENT);
    facts->files = json_array();
    facts->page = json_object();
    sonject_status status = write_layers(report, facts, folder);
    THEN(status, swath_write(report, facts->scene, facts->swath, result, path, progress_share_tell,
                             &writing, &result->statistics.output_clipped));
    if (status == SONJECT_OK)
        note_result(report, facts);
    if (status == SONJECT_OK && facts->scene->input_kind == SONJECT_INPUT_FILE &&
        facts->swath->new_extension)
        report_note(report,
                    "%s is a new file: of the input's metadata it keeps only the description",
                    facts->image_name);
    THEN(status, file_list_add(&facts->files, report, folder, facts->image_name, true));
    THEN(status, calibration_files_list(report, facts->scene, folder, &facts->files));
    THEN(status, write_documents(report, facts, folder, run_start, start));
    earlier_tidy(folder, RUN_DOCUMENT, earlier, facts->files);
    json_decref(facts->files);
    json_decref(facts->page);
    facts->files = facts->page = NULL;
    return status;
}

/* Traces the swath and writes the results. */
static sonject_status run_swath(struct report *report, struct device_slot *slot,
                                const struct run_request *request, const struct swath *swath,
                                struct run_facts *facts, double start)
{
    struct device *device = NULL;
    struct injection_result result;
    const struct scene *scene = request->scene;
    struct progress_share stage = {request->progress, request->user, TRACE_START,
                                   WRITE_START - TRACE_START};
    const struct injection_input input = swath_input(swath);
    bool is_formed = true;
    sonject_status status = device_slot_open(report, slot, &device);
    const struct checkpoint_job job = {report,          device, request, facts->scene_hash,
                                       swath->identity, &input, start,   progress_share_tell,
                                       &stage};
    THEN(status, inject_by_checkpoints(&job, &result, &is_formed));
    if (status != SONJECT_OK || !is_formed)
        return status;
    swath_leave_empty(swath, &result);
    tell_calibration(report, scene);
    result.statistics.input_clipped = swath->clipped;
    facts->result = &result;
    facts->device = device;
    status = write_results(report, facts, &result, request->folder, start, request->progress,
                           request->user);
    if (status == SONJECT_OK && !request->sums)
        checkpoints_remove(request->folder);
    injection_result_clear(&result);
    return status;
}

/* Checks that scene and image are those of the sums, except for keys of image formation alone.
 * Errors: INPUT, MEMORY. */
static sonject_status check_traced(struct report *report, const struct run_request *request,
                                   const struct swath *swath)
{
    const struct sums_identity *identity = &request->sums->head.identity;
    const struct scene *traced = request->traced;
    const char *made = "the made seabed";
    char hash[HASH_TEXT_CAPACITY], wanted[HASH_TEXT_CAPACITY];
    if (strcmp(identity->image, swath->identity) != 0)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: not the image that was traced, %s (XXH3 %s): name that one with input.path, or "
            "trace again",
            request->scene->input_path ? request->scene->input_path : made,
            traced->input_path ? traced->input_path : made, identity->image);
    CHECK(scene_hash(report, traced, swath->identity, hash));
    bool is_same = strcmp(hash, identity->scene) == 0;
    CHECK(traced_scene_hash(report, traced, swath->identity, wanted));
    CHECK(traced_scene_hash(report, request->scene, swath->identity, hash));
    is_same = is_same && strcmp(hash, wanted) == 0;
    return is_same ? SONJECT_OK
                   : report_failure(report, SONJECT_ERROR_INPUT,
                                    "the scene, or a file that it names, is not what was traced: "
                                    "trace again");
}

/* Opens the image for the scene's targets. Sums may be formed with another response; the image,
 * also a made one, then stays the one that they were traced for. */
static sonject_status open_swath(struct report *report, const struct run_request *request,
                                 struct swath *swath)
{
    struct scene opened = *request->scene;
    if (request->sums)
        opened.sonar = request->traced->sonar;
    const sonject_status status = swath_open(report, &opened, swath);
    if (status != SONJECT_OK || !request->sums)
        return status;
    const sonject_status same = check_traced(report, request, swath);
    if (same != SONJECT_OK)
        swath_close(swath);
    return same;
}

/* Finds the inputs of the result, and whether the folder holds it. facts->inputs: the caller's. */
static sonject_status check_earlier(struct report *report, const struct run_request *request,
                                    const struct swath *swath, struct run_facts *facts,
                                    char hash[HASH_TEXT_CAPACITY], bool *is_finished)
{
    CHECK(scene_inputs(report, request->scene, swath->identity, hash, &facts->inputs));
    json_add(&facts->inputs, "image", json_text(facts->image_name));
    const char *names[RUN_FILES + 2] = {facts->image_name};
    run_file_names(names + 1);
    const struct earlier_request earlier = {.folder = request->folder,
                                            .document = RUN_DOCUMENT,
                                            .names = names,
                                            .inputs = facts->inputs,
                                            .scene = request->scene,
                                            .label_formats = request->label_formats,
                                            .overwrites = request->overwrites,
                                            .hashes_all = request->merges};
    return facts->inputs ? earlier_check(report, &earlier, is_finished)
                         : report_out_of_memory(report, "a run's inputs");
}

/* Looks again whether the folder holds the result, after a failure: another process, which ran the
 * same, may have ended meanwhile and removed the checkpoints that both shared. */
static sonject_status check_again(struct report *report, const struct run_request *request,
                                  const struct swath *swath, struct run_facts *facts,
                                  char hash[HASH_TEXT_CAPACITY], sonject_status failure,
                                  bool *is_finished)
{
    struct report unused = {.host = NULL};
    json_decref(facts->inputs);
    facts->inputs = NULL;
    if (check_earlier(&unused, request, swath, facts, hash, is_finished) != SONJECT_OK ||
        !*is_finished)
        return failure;
    checkpoints_remove(request->folder);
    report->message[0] = '\0';
    return SONJECT_OK;
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
    char image[PATH_CAPACITY];
    sonject_status status = image_name ? path_in(report, image, request->folder, "%s", image_name)
                                       : report_out_of_memory(report, "a path");
    THEN(status, file_check_replaced(report, image));
    THEN(status, check_earlier(report, request, &swath, &facts, hash, &is_finished));
    if (status == SONJECT_OK && !is_finished)
        status = folder_make(report, request->folder);
    if (status == SONJECT_OK && !is_finished) {
        facts.read_s = clock_seconds() - start;
        status = run_swath(report, slot, request, &swath, &facts, start);
        if (status == SONJECT_ERROR_STORAGE || status == SONJECT_ERROR_INPUT)
            status = check_again(report, request, &swath, &facts, hash, status, &is_finished);
    }
    if (was_finished)
        *was_finished = is_finished;
    json_decref(facts.inputs);
    free(image_name);
    swath_close(&swath);
    return status;
}

static sonject_status trace_swath(struct report *report, struct device_slot *slot,
                                  const struct run_request *request, const struct swath *swath,
                                  const char *file)
{
    const struct injection_input input = swath_input(swath);
    struct device *device = NULL;
    char hash[HASH_TEXT_CAPACITY];
    CHECK(scene_hash(report, request->scene, swath->identity, hash));
    CHECK(device_slot_open(report, slot, &device));
    const struct checkpoint_job job = {report,          device, request,         hash,
                                       swath->identity, &input, clock_seconds(), request->progress,
                                       request->user};
    return trace_into_file(&job, file);
}

sonject_status trace_scene(struct report *report, struct device_slot *slot,
                           const struct run_request *request, const char *file)
{
    struct swath swath;
    CHECK(swath_open(report, request->scene, &swath));
    const sonject_status status = trace_swath(report, slot, request, &swath, file);
    swath_close(&swath);
    return status;
}

/* Keys that only image formation depends on, and the path of the image. */
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

/* Checks that the file holds all that this version would trace. */
static sonject_status check_sums(struct report *report, const struct sums_file *sums)
{
    const struct sums_head *head = &sums->head;
    char code[HASH_TEXT_CAPACITY];
    CHECK(code_hash(report, code));
    if (strcmp(head->identity.version, sonject_version()) != 0 ||
        strcmp(head->identity.code, code) != 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: traced by another version, sonject %s: trace again", sums->path,
                              head->identity.version);
    if (head->shards == 1 && head->first == 0 && head->is_last)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: holds only a part of a traced scene: sonject merge forms all parts",
                          sums->path);
}

/* Returns all overrides, the file's first, in one list for free(). */
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
                                 const sonject_form_params *params, const char *calibration,
                                 struct scene *scene)
{
    if (!kept->text)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: traced from a scene that was in no file: give the scene",
                              params->file);
    char *here = working_folder();
    const bool is_here = here && strcmp(here, kept->folder) == 0;
    char *path = is_here ? copy_text(kept->path) : path_join(kept->folder, kept->path);
    const char **overrides = join_overrides(kept, params);
    const struct scene_source source = {.path = path,
                                        .text = kept->text,
                                        .overrides = overrides,
                                        .override_count =
                                            kept->override_count + params->override_count,
                                        .moved_folder = is_here ? NULL : kept->folder,
                                        .moved_overrides = kept->override_count,
                                        .made_calibration = calibration};
    const sonject_status status = path && overrides
                                      ? scene_source_read(&source, report, scene)
                                      : report_out_of_memory(report, "the scene's text");
    free(here);
    free(path);
    free(overrides);
    return status;
}

/* Forms an image from a file of sums. traced, formed: get the scenes; cleared by the caller. */
static sonject_status form_file(struct report *report, struct device_slot *slot,
                                const struct sonject_form_params *params,
                                struct run_request *request, struct scene *traced,
                                struct scene *formed, int *was_finished)
{
    const struct kept_scene *kept = &request->sums->scene;
    sonject_form_params as_traced = *params;
    as_traced.override_count = 0;
    CHECK(check_sums(report, request->sums));
    request->traced = request->scene;
    if (kept->text || !request->scene) {
        CHECK(read_traced_scene(report, kept, &as_traced, NULL, traced));
        request->traced = traced;
    }
    if (!request->scene && params->override_count > 0) {
        CHECK(read_traced_scene(report, kept, params, NULL, formed));
        request->scene = formed;
    }
    if (!request->scene)
        request->scene = request->traced;
    return run_scene(report, slot, request, was_finished);
}

sonject_status form_scene(struct report *report, struct device_slot *slot,
                          const struct scene *scene, const sonject_form_params *params,
                          const struct run_request *request, int *was_finished)
{
    struct sums_file sums;
    struct scene traced, formed;
    struct run_request forming = *request;
    CHECK(check_overrides(report, scene, params));
    if (!file_exists(params->file))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such file of sums; check its name", params->file);
    CHECK(sums_file_open(&sums, report, params->file));
    scene_init(&traced);
    scene_init(&formed);
    forming.scene = scene;
    forming.sums = &sums;
    const sonject_status status =
        form_file(report, slot, params, &forming, &traced, &formed, was_finished);
    scene_clear(&traced);
    scene_clear(&formed);
    sums_file_close(&sums);
    return status;
}
