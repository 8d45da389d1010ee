#define _POSIX_C_SOURCE 200809L
#include "dataset/run.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/memory.h"
#include "inject/impulse_export.h"
#include "inject/scene_hash.h"
#include "schema/scene_file.h"

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
                                  const struct scene *scene, const struct scene_source *kept,
                                  const struct swath *swath, const sonject_trace_params *params,
                                  sonject_progress_function progress, void *user)
{
    const char *image_path = scene->input_path ? scene->input_path : "";
    const char *export_file =
        params->export_file && *params->export_file ? params->export_file : NULL;
    const struct injection_input input = swath_input(swath);
    struct device *device;
    struct sums_head head;
    struct impulse_facts facts;
    struct sums_writer writer;
    struct two_files files = {&writer, NULL};
    const struct impulse_sink sink = {write_lines, &files};
    memset(&writer, 0, sizeof writer);
    sonject_status status = describe(report, scene, swath, &head, &facts);
    THEN(status, sums_writer_begin(&writer, report, params->file, NULL));
    if (status == SONJECT_OK && export_file)
        status = impulse_export_begin(report, export_file, &files.export);
    THEN(status, device_slot_open(report, slot, &device));
    THEN(status,
         injection_trace(report, device, scene, &input, &sink, progress, user, &facts.counts));
    if (status == SONJECT_OK && files.export)
        status = impulse_export_publish(files.export, scene, &input, &facts, head.identity.scene,
                                        image_path);
    THEN(status, impulse_file_publish(&writer, &head, kept, &facts, image_path));
    impulse_export_release(&files.export);
    sums_writer_clear(&writer);
    return status;
}

sonject_status trace_scene(struct report *report, struct device_slot *slot,
                           const struct scene *scene, const struct scene_source *source,
                           const sonject_trace_params *params, sonject_progress_function progress,
                           void *user)
{
    struct swath swath;
    CHECK(swath_open(report, scene, &swath));
    const sonject_status status =
        trace_swath(report, slot, scene, source, &swath, params, progress, user);
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

sonject_status check_traced(struct report *report, const struct impulse_file *impulses,
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
