#include "claims.h"

#include <sys/stat.h>

#include <jansson.h>

#include "swath/raster_file.h"
#include "work.h"

#define ROWS    24
#define COLUMNS 32

static const char scene_text[] =
    "sonject: 1\n"
    "input:\n"
    "  path: swath.npy\n"
    "  geometry: {row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 25 m}\n"
    "sonar: {frequency: 100 kHz, bandwidth: 15 kHz, altitude: 10 m}\n"
    "injection: {order_energies: true}\n"
    "objects:\n"
    "  - {name: ball, shape: sphere, diameter: 0.4 m, material: {reflection: 0.5, lambert: 0.05}}\n"
    "  - {name: buoy, target: buoy.yaml, position: {along_track: 0.3 m, slant_range: 25.9 m}}\n";
static const char target_text[] = "sonject_target: 1\n"
                                  "class: buoy\n"
                                  "parts:\n"
                                  "  - {shape: cylinder, length: 0.2 m, diameter: 0.1 m}\n"
                                  "  - {shape: sphere, diameter: 0.1 m, at: {up: 0.1 m}}\n";

static const char campaign_text[] =
    "sonject_campaign: 1\n"
    "scene: scene.yaml\n"
    "images: 2\n"
    "chip: {rows: 20, columns: 24}\n"
    "outputs: [masks]\n"
    "labels: [yolo]\n"
    "swaths: [{path: swath.npy}]\n"
    "draw: {'objects[].burial': {uniform: [0 cm, 5 cm]}}\n"
    "targets: [{class: ball, object: {shape: sphere, diameter: 0.3 m}}]\n";

static uint64_t add_to_digest(uint64_t digest, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        digest = (digest ^ ((const unsigned char *)bytes)[i]) * UINT64_C(0x100000001B3);
    return digest;
}

/* Fills the image with random amplitudes by a linear congruential generator. */
static void fill_pixels(float pixels[ROWS * COLUMNS])
{
    uint32_t state = 1;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        state = state * 1664525u + 1013904223u;
        pixels[i] = 0.02f + (float)(state >> 8) / 16777216.0f;
    }
}

static void write_image(const char *path)
{
    static const struct raster_layout layout = {ROWS, COLUMNS, 1, PIXEL_FLOAT32};
    struct report report = {.host = NULL};
    float pixels[ROWS * COLUMNS];
    fill_pixels(pixels);
    EXPECT_OK(&report, raster_format_write(&report, path, &layout, NULL, 0, pixels));
}

static void set_path(struct work *work, char path[WORK_PATH], const char *name)
{
    snprintf(path, WORK_PATH, "%s/%s", work->folder->path, name);
}

sonject_status work_do(struct work *work, const struct work_piece *piece)
{
    const sonject_context_params params = {.struct_size = sizeof params};
    sonject_context *context;
    sonject_scene *scene = NULL;
    work->message[0] = '\0';
    work->digest = UINT64_C(0xCBF29CE484222325);
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK && piece->has_scene)
        status = sonject_scene_read(context, work->scene, NULL, &scene);
    THEN(status, piece->act(work, context, scene));
    if (context && status != SONJECT_OK)
        snprintf(work->message, sizeof work->message, "%s", sonject_context_message(context));
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    return status;
}

static sonject_status write_seabed(sonject_context *context, sonject_scene *scene,
                                   const char *image)
{
    const sonject_status status =
        sonject_scene_set(scene, "input",
                          "{synthetic: {rows: 40, columns: 40}, geometry: {row_spacing: 0.025, "
                          "column_spacing: 0.025, first_slant_range: 44}}");
    return status == SONJECT_OK ? sonject_seabed_write(context, scene, image) : status;
}

static sonject_status make_seabed(struct work *work, sonject_context *context, sonject_scene *scene)
{
    return write_seabed(context, scene, work->seabed);
}

int work_prepare(struct work *work)
{
    static const struct work_piece seabed = {"seabed", make_seabed, true};
    memset(work, 0, sizeof *work);
    if (make_temporary_folder((void **)&work->folder) != 0)
        return 1;
    set_path(work, work->scene, "scene.yaml");
    set_path(work, work->campaign, "campaign.yaml");
    set_path(work, work->image, "swath.npy");
    set_path(work, work->seabed, "seabed.tif");
    set_path(work, work->impulses, "impulses");
    set_path(work, work->results, "results");
    write_bytes(work->scene, scene_text, strlen(scene_text));
    write_bytes(work->campaign, campaign_text, strlen(campaign_text));
    write_bytes(temporary_file(work->folder, "buoy.yaml"), target_text, strlen(target_text));
    write_image(work->image);
    return work_do(work, &seabed) != SONJECT_OK;
}

int work_remove(struct work *work)
{
    return remove_temporary_folder((void **)&work->folder);
}

static sonject_status read_scene(struct work *work, sonject_context *context, sonject_scene *scene)
{
    uint32_t count = 0;
    char *text = NULL, *json = NULL;
    (void)context;
    sonject_status status = sonject_scene_object_count(scene, &count);
    THEN(status, sonject_scene_text(scene, &text));
    THEN(status, sonject_scene_get(scene, "objects", &json));
    work->digest = add_to_digest(work->digest, &count, sizeof count);
    if (json)
        work->digest = add_to_digest(work->digest, json, strlen(json));
    sonject_text_release(&text);
    sonject_text_release(&json);
    return status;
}

/* Injects into grey levels, made from amplitudes first. */
static sonject_status inject(struct work *work, sonject_context *context, sonject_scene *scene)
{
    static const char transfer[] = "{kind: gamma, parameter: 2}";
    sonject_result *result = NULL;
    float amplitudes[ROWS * COLUMNS];
    uint16_t pixels[ROWS * COLUMNS];
    sonject_pixels patch = {
        .struct_size = sizeof patch, .rows = ROWS, .columns = COLUMNS, .data = amplitudes};
    fill_pixels(amplitudes);
    sonject_status status = sonject_pixels_convert(context, &patch, SONJECT_PIXELS_UINT16, transfer,
                                                   pixels, sizeof pixels);
    patch.kind = SONJECT_PIXELS_UINT16;
    patch.data = pixels;
    patch.transfer = transfer;
    THEN(status, sonject_inject(context, scene, &patch, NULL, NULL, &result));
    assert_true((status == SONJECT_OK) == (result != NULL));
    if (status == SONJECT_OK) {
        status = sonject_result_layer(result, SONJECT_LAYER_IMAGE, pixels, sizeof pixels);
        work->digest = add_to_digest(work->digest, pixels, sizeof pixels);
    }
    sonject_result_release(&result);
    return status;
}

static sonject_status measure(struct work *work, sonject_context *context, sonject_scene *scene)
{
    const sonject_measure_params params = {.struct_size = sizeof params, .image = work->seabed};
    sonject_measurement measurement = {.struct_size = sizeof measurement};
    (void)scene;
    const sonject_status status = sonject_measure(context, &params, &measurement);
    work->digest = add_to_digest(work->digest, &measurement, sizeof measurement);
    return status;
}

static sonject_status check(struct work *work, sonject_context *context, sonject_scene *scene)
{
    char *text = NULL;
    const sonject_status status = sonject_check(context, scene, &text);
    assert_true((status == SONJECT_OK) == (text != NULL));
    if (text)
        work->digest = add_to_digest(work->digest, text, strlen(text));
    sonject_text_release(&text);
    return status;
}

static sonject_status run(struct work *work, sonject_context *context, sonject_scene *scene)
{
    const sonject_run_params params = {.struct_size = sizeof params, .folder = work->results};
    return sonject_run(context, scene, &params, NULL, NULL, NULL);
}

static sonject_status share_out(struct work *work, sonject_context *context, sonject_scene *scene)
{
    sonject_run_params params = {
        .struct_size = sizeof params, .folder = work->results, .shard_count = 2};
    const sonject_merge_params merging = {.struct_size = sizeof merging, .folder = work->results};
    sonject_status status = SONJECT_OK;
    for (params.shard_index = 2; status == SONJECT_OK && params.shard_index > 0;
         params.shard_index--)
        status = sonject_run(context, scene, &params, NULL, NULL, NULL);
    return status == SONJECT_OK ? sonject_merge(context, NULL, &merging, NULL, NULL, NULL) : status;
}

static sonject_status make_campaign(struct work *work, sonject_context *context,
                                    sonject_scene *scene)
{
    sonject_campaign *campaign = NULL;
    const sonject_campaign_run_params params = {.struct_size = sizeof params,
                                                .folder = work->results};
    (void)scene;
    sonject_status status = sonject_campaign_read(context, work->campaign, NULL, &campaign);
    THEN(status, sonject_campaign_run(context, campaign, &params, NULL, NULL, NULL));
    sonject_campaign_release(&campaign);
    return status;
}

static sonject_status trace(struct work *work, sonject_context *context, sonject_scene *scene)
{
    return sonject_trace(context, scene, work->impulses, NULL, NULL);
}

static sonject_status form(struct work *work, sonject_context *context, sonject_scene *scene)
{
    const sonject_form_params params = {
        .struct_size = sizeof params, .file = work->impulses, .folder = work->results};
    (void)scene;
    return sonject_form(context, NULL, &params, NULL, NULL, NULL);
}

static sonject_status draw(struct work *work, sonject_context *context, sonject_scene *scene)
{
    char picture[WORK_PATH + 16];
    const sonject_quicklook_params params = {
        .struct_size = sizeof params, .image = work->image, .picture = picture};
    (void)scene;
    snprintf(picture, sizeof picture, "%s/look.png", work->results);
    (void)mkdir(work->results, 0777);
    return sonject_quicklook(context, &params);
}

static sonject_status make_result_seabed(struct work *work, sonject_context *context,
                                         sonject_scene *scene)
{
    char image[WORK_PATH + 16];
    snprintf(image, sizeof image, "%s/seabed.tif", work->results);
    (void)mkdir(work->results, 0777);
    return write_seabed(context, scene, image);
}

const struct work_piece work_read = {"read", read_scene, true},
                        work_inject = {"inject", inject, true},
                        work_measure = {"measure", measure, false},
                        work_check = {"check", check, true}, work_run = {"run", run, true},
                        work_quicklook = {"quicklook", draw, false},
                        work_seabed = {"seabed", make_result_seabed, true},
                        work_trace = {"trace", trace, true}, work_form = {"form", form, false},
                        work_shards = {"shards", share_out, true},
                        work_campaign = {"campaign", make_campaign, false};

/* True for files that tell times. */
static bool differs_each_time(const char *name)
{
    return strcmp(name, "run.json") == 0 || strcmp(name, "times.json") == 0;
}

static uint64_t digest_of_file(const struct work *work, const char *name)
{
    char path[WORK_PATH + 300];
    size_t count;
    snprintf(path, sizeof path, "%s/%s", work->results, name);
    unsigned char *bytes = bytes_of_file(path, &count);
    uint64_t digest = add_to_digest(1, bytes, count);
    if (differs_each_time(name)) { /* checks only that the file is whole */
        json_t *document = json_loadb((const char *)bytes, count, 0, NULL);
        if (!document)
            fail_msg("%s is not whole", name);
        json_decref(document);
        digest = 0;
    }
    free(bytes);
    return digest;
}

/* Lists the files below a folder of the results. below: "" or "name/". */
static void list_below(const struct work *work, const char *below,
                       struct work_file files[WORK_FILES], size_t *count)
{
    char path[WORK_PATH + 300], name[300];
    snprintf(path, sizeof path, "%s/%s", work->results, below);
    DIR *list = opendir(path);
    if (!list)
        return;
    for (const struct dirent *entry = readdir(list); entry; entry = readdir(list)) {
        struct stat facts;
        if (!is_entry(entry))
            continue;
        if (strstr(entry->d_name, ".part"))
            fail_msg("%s%s is left", below, entry->d_name);
        snprintf(name, sizeof name, "%s%s", below, entry->d_name);
        snprintf(path, sizeof path, "%s/%s", work->results, name);
        if (stat(path, &facts) == 0 && S_ISDIR(facts.st_mode)) {
            strcat(name, "/");
            list_below(work, name, files, count);
        } else if (!strstr(name, ".sums")) { /* checkpoints of what was traced may stay */
            if (*count == WORK_FILES || strlen(name) >= sizeof files->name)
                fail_msg("too many files, or too long a name: %s", name);
            strcpy(files[*count].name, name);
            files[(*count)++].digest = digest_of_file(work, name);
        }
    }
    closedir(list);
}

static size_t list_results(const struct work *work, struct work_file files[WORK_FILES])
{
    size_t count = 0;
    list_below(work, "", files, &count);
    return count;
}

void work_expect(struct work *work)
{
    work->expected_digest = work->digest;
    work->expected_count = list_results(work, work->expected);
    (void)remove_folder(work->results);
}

static void check_file(const struct work *work, const struct work_file *file)
{
    for (size_t i = 0; i < work->expected_count; i++) {
        if (strcmp(work->expected[i].name, file->name) != 0)
            continue;
        if (work->expected[i].digest != file->digest)
            fail_msg("%s is not what it should be", file->name);
        return;
    }
    fail_msg("%s should not be there", file->name);
}

void work_check_results(struct work *work, bool is_done)
{
    struct work_file files[WORK_FILES];
    const size_t count = list_results(work, files);
    if (is_done && work->digest != work->expected_digest)
        fail_msg("other numbers than those of an undisturbed call");
    for (size_t i = 0; i < count; i++) {
        check_file(work, &files[i]);
        is_done |=
            strcmp(files[i].name, "run.json") == 0 || strcmp(files[i].name, "dataset.json") == 0;
    }
    if (is_done)
        assert_int_equal(count, work->expected_count);
    (void)remove_folder(work->results);
}
