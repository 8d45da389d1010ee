#define _POSIX_C_SOURCE 200809L
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/stages.h>
#include <sonject/version.h>

#include "api/run_scene.h"
#include "api/scene_hash.h"
#include "base/file.h"
#include "base/memory.h"
#include "io/scene_file.h"

void sonject_trace_params_init(sonject_trace_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

void sonject_form_params_init(sonject_form_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

sonject_status take_source(struct impulse_head *head, struct report *report,
                           const struct scene_source *source)
{
    if (!source->text)
        return SONJECT_OK;
    head->scene_text = copy_text(source->text);
    head->scene_path = copy_text(source->path);
    head->scene_folder = working_folder();
    head->overrides = allocate_array(source->override_count, sizeof *head->overrides);
    bool is_whole = head->scene_text && head->scene_path && head->scene_folder && head->overrides;
    for (size_t i = 0; is_whole && i < source->override_count; i++) {
        head->overrides[i] = copy_text(source->overrides[i]);
        is_whole = head->overrides[i] != NULL;
        head->override_count = i + 1;
    }
    return is_whole ? SONJECT_OK : report_out_of_memory(report, "the scene's text");
}

static sonject_status describe(struct impulse_head *head, struct report *report,
                               const struct sonject_scene *scene, const struct swath *swath)
{
    const sonject_geometry_params *geometry = &scene->scene.geometry;
    memset(head, 0, sizeof *head);
    head->seed = scene->scene.injection.seed;
    head->image_rows = swath->layout.rows;
    head->image_columns = swath->layout.columns;
    memcpy(head->image_hash, swath->identity, sizeof head->image_hash);
    head->sonar = scene->scene.sonar;
    head->first_row = swath->patch.first_row;
    head->first_column = swath->patch.first_column;
    head->rows = swath->patch.rows;
    head->columns = swath->patch.columns;
    head->row_spacing_m = geometry->row_spacing_m;
    head->column_spacing_m = geometry->column_spacing_m;
    head->first_slant_range_m = geometry->first_slant_range_m;
    head->image_path = copy_text(scene->scene.input_path ? scene->scene.input_path : "");
    CHECK_MEMORY(report, head->image_path, "a path");
    CHECK(traced_scene_hash(report, &scene->scene, swath->identity, head->scene_hash));
    return take_source(head, report, &scene->source);
}

static sonject_status trace_swath(struct sonject_context *context,
                                  const struct sonject_scene *scene, const struct swath *swath,
                                  const char *path, sonject_progress_function progress, void *user)
{
    struct report *report = &context->report;
    struct device *device;
    struct impulse_head head;
    struct impulse_writer *writer = NULL;
    const struct injection_input input = swath_input(swath);
    sonject_status status = describe(&head, report, scene, swath);
    THEN(status, impulse_writer_begin(report, path, &writer));
    THEN(status, context_device(context, &device));
    if (status == SONJECT_OK) {
        const struct impulse_sink sink = impulse_writer_sink(writer);
        status = injection_trace(report, device, &scene->scene, &input, &sink, progress, user,
                                 &head.counts);
    }
    THEN(status, impulse_writer_publish(writer, &head));
    impulse_writer_release(&writer);
    impulse_head_clear(&head);
    return status;
}

sonject_status sonject_trace(sonject_context *context, const sonject_scene *scene,
                             const sonject_trace_params *params, sonject_progress_function progress,
                             void *user)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    if (!scene)
        return null_argument(&context->report, "scene");
    sonject_trace_params taken;
    struct swath swath;
    sonject_trace_params_init(&taken);
    CHECK(params_take(&context->report, &taken, sizeof taken, params, sizeof taken,
                      "trace parameters"));
    if (!taken.file || !taken.file[0])
        return null_argument(&context->report, "file");
    CHECK(swath_open(&context->report, &scene->scene, &swath));
    sonject_status status = trace_swath(context, scene, &swath, taken.file, progress, user);
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

static sonject_status check_overrides(struct report *report, const sonject_scene *scene,
                                      const sonject_form_params *params)
{
    if (params->override_count > 0 && !params->overrides)
        return null_argument(report, "overrides");
    if (params->override_count > 0 && scene)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "a scene that is given takes no overrides");
    for (uint32_t i = 0; i < params->override_count; i++) {
        const char *override = params->overrides[i];
        if (!override)
            return null_argument(report, "an override");
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
                                    const struct impulse_head *head)
{
    if (strcmp(head->version, sonject_version()) == 0)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: traced by sonject %s, but this is %s: trace again", path,
                          head->version, sonject_version());
}

sonject_status check_traced(struct report *report, const struct impulse_file *impulses,
                            const struct scene *scene, const struct swath *swath)
{
    const struct impulse_head *head = impulse_file_head(impulses);
    char hash[HASH_TEXT_CAPACITY];
    if (head->image_rows != swath->layout.rows || head->image_columns != swath->layout.columns ||
        strcmp(head->image_hash, swath->identity) != 0)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: not the image that was traced, %s of %llu x %llu pixels (XXH3 %s): name that one "
            "with input.path, or trace again",
            scene->input_path ? scene->input_path : "the made seabed",
            *head->image_path ? head->image_path : "a made one",
            (unsigned long long)head->image_rows, (unsigned long long)head->image_columns,
            head->image_hash);
    const sonject_status status = traced_scene_hash(report, scene, swath->identity, hash);
    if (status == SONJECT_OK && strcmp(hash, head->scene_hash) != 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the scene, or a file that it names, is not what was traced: trace "
                              "again");
    return status;
}

/* All overrides, the file's first, in one list to be given to free(). */
static const char **join_overrides(const struct impulse_head *head,
                                   const sonject_form_params *params)
{
    const char **all = allocate_array(head->override_count + params->override_count, sizeof(*all));
    for (size_t i = 0; all && i < head->override_count; i++)
        all[i] = head->overrides[i];
    for (uint32_t i = 0; all && i < params->override_count; i++)
        all[head->override_count + i] = params->overrides[i];
    return all;
}

sonject_status read_traced_scene(struct report *report, const struct impulse_head *head,
                                 const sonject_form_params *params, struct scene *scene)
{
    if (!head->scene_text)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: traced from a scene that was in no file: give the scene",
                              params->file);
    char *here = working_folder();
    const bool is_here = here && strcmp(here, head->scene_folder) == 0;
    char *path =
        is_here ? copy_text(head->scene_path) : path_join(head->scene_folder, head->scene_path);
    const char **overrides = join_overrides(head, params);
    struct scene_text source;
    memset(&source, 0, sizeof source);
    source.path = path;
    source.text = head->scene_text;
    source.bytes = strlen(head->scene_text);
    source.overrides = overrides;
    source.override_count = head->override_count + params->override_count;
    source.moved_folder = is_here ? NULL : head->scene_folder;
    source.moved_overrides = head->override_count;
    source.allows_user_shapes = params->allows_user_shapes != 0;
    const sonject_status status = path && overrides
                                      ? scene_text_read(report, &source, scene)
                                      : report_out_of_memory(report, "the scene's text");
    free(here);
    free(path);
    free(overrides);
    return status;
}

static sonject_status form_file(struct sonject_context *context, const sonject_scene *scene,
                                const sonject_form_params *params, struct impulse_file *impulses,
                                sonject_progress_function progress, void *user, int *was_finished)
{
    struct report *report = &context->report;
    const struct impulse_head *head = impulse_file_head(impulses);
    struct run_request request;
    struct scene read;
    memset(&request, 0, sizeof request);
    request.impulses = impulses;
    request.folder = params->folder;
    request.label_formats = params->labels;
    request.overwrites = params->overwrites != 0;
    request.progress = progress;
    request.user = user;
    scene_init(&read);
    sonject_status status = check_version(report, params->file, head);
    if (status == SONJECT_OK && !scene)
        status = read_traced_scene(report, head, params, &read);
    request.scene = scene ? &scene->scene : &read;
    THEN(status, run_scene(context, &request, was_finished));
    if (!scene)
        scene_clear(&read);
    return status;
}

sonject_status sonject_form(sonject_context *context, const sonject_scene *scene,
                            const sonject_form_params *params, sonject_progress_function progress,
                            void *user, int *was_finished)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    sonject_form_params taken;
    struct impulse_file *impulses;
    sonject_form_params_init(&taken);
    CHECK(params_take(&context->report, &taken, sizeof taken, params,
                      offsetof(sonject_form_params, allows_user_shapes), "form parameters"));
    if (!taken.file || !taken.file[0] || !taken.folder || !taken.folder[0])
        return null_argument(&context->report, "file and folder");
    if (taken.labels & ~LABEL_FORMATS)
        return report_failure(&context->report, SONJECT_ERROR_ARGUMENT,
                              "labels must be a sum of sonject_labels");
    sonject_status status = check_overrides(&context->report, scene, &taken);
    THEN(status, impulse_file_open(&context->report, taken.file, &impulses));
    if (status != SONJECT_OK)
        return status;
    status = form_file(context, scene, &taken, impulses, progress, user, was_finished);
    impulse_file_close(&impulses);
    return status;
}
