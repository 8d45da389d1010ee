/* Calibrations that scenes ask for by input.calibration: auto, made once and kept; and where the
 * numbers that a run used came from. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/run.h"
#include "measure/calibration.h"
#include "schema/scene_file.h"

#define CALIBRATION_BYTES_MAX ((size_t)16 << 20)

/* Whether the file is there, and of that image. */
static sonject_status is_of_image(struct report *report, const char *path, const char *hash,
                                  const char *channel, bool *is_it)
{
    char line[2 * HASH_TEXT_CAPACITY];
    char *text = NULL;
    size_t bytes;
    *is_it = false;
    if (!file_exists(path))
        return SONJECT_OK;
    CHECK(file_read_whole(report, path, CALIBRATION_BYTES_MAX, &text, &bytes));
    snprintf(line, sizeof line, "\n  swath_xxh3: %s\n", hash);
    *is_it = strstr(text, line) != NULL;
    snprintf(line, sizeof line, "\n  channel: %s\n", channel ? channel : "");
    *is_it = *is_it && (!channel || strstr(text, line));
    free(text);
    return SONJECT_OK;
}

static const char *channel_text(int32_t channel, char text[16])
{
    if (channel == SONJECT_CHANNEL_PORT || channel == SONJECT_CHANNEL_STARBOARD)
        return strcpy(text, channel == SONJECT_CHANNEL_PORT ? "port" : "starboard");
    if (channel == SONJECT_CHANNEL_ONLY)
        return NULL;
    snprintf(text, 16, "%ld", (long)channel);
    return text;
}

sonject_status scene_calibrate(struct report *report, const struct scene *scene, const char *folder,
                               const char *name, bool replaces, char path[PATH_CAPACITY])
{
    char hash[HASH_TEXT_CAPACITY], channel[16], picture[PATH_CAPACITY];
    char *text = NULL;
    bool is_it = false;
    CHECK(path_in(report, path, folder, "%s.yaml", name));
    CHECK(path_in(report, picture, folder, "%s.png", name));
    CHECK(file_hash(report, scene->input_path, hash));
    const struct image_options options = {scene->channel, scene->array, scene->transfer, true,
                                          scene->geometry};
    const sonject_calibrate_params params = {.struct_size = sizeof params,
                                             .image = scene->input_path,
                                             .channel = channel_text(scene->channel, channel),
                                             .array = scene->array,
                                             .picture = picture,
                                             .output = path};
    CHECK(is_of_image(report, path, hash, params.channel, &is_it));
    if (is_it || (file_exists(path) && !replaces))
        return SONJECT_OK;
    CHECK(folder_make(report, folder));
    CHECK(calibrate_image(report, &params, &options, NULL, &text));
    free(text);
    report_log(report, "note: calibration made: %s, with a picture beside it", path);
    return SONJECT_OK;
}

sonject_status calibrated_scene_read(struct report *report, const struct scene_source *source,
                                     const struct scene *scene, const struct run_request *request,
                                     struct scene *calibrated)
{
    char path[PATH_CAPACITY];
    struct scene_source copy = *source;
    scene_init(calibrated);
    CHECK(scene_calibrate(report, scene, request->folder, CALIBRATION_NAME,
                          request->overwrites || !folder_has_result(request->folder), path));
    copy.made_calibration = path;
    return scene_source_read(&copy, report, calibrated);
}

sonject_status calibration_files_list(struct report *report, const struct scene *scene,
                                      const char *folder, json_t **files)
{
    static const char *const names[] = {CALIBRATION_NAME ".yaml", CALIBRATION_NAME ".png"};
    char path[PATH_CAPACITY];
    CHECK(path_in(report, path, folder, "%s", names[0]));
    if (!scene->calibration || strcmp(scene->calibration, path) != 0)
        return SONJECT_OK;
    for (size_t i = 0; i < COUNT(names); i++)
        CHECK(file_list_add(files, report, folder, names[i], true));
    return SONJECT_OK;
}

void tell_calibration(struct report *report, const struct scene *scene)
{
    char keys[REPORT_LINE];
    size_t length = 0;
    if (!scene->calibration)
        return;
    for (const char *from = scene->calibrated; *from && length + 3 < sizeof keys; from++) {
        if (*from != '\n') {
            keys[length++] = *from;
        } else if (from[1]) {
            keys[length++] = ',';
            keys[length++] = ' ';
        }
    }
    keys[length] = '\0';
    report_log(report, "calibration %s tells %s", scene->calibration, *keys ? keys : "nothing");
}

/* ---- Where numbers came from. */

static json_t *source_word(uint32_t source)
{
    static const char *const words[] = {"default", "scene", "calibration", "patch", "fallback"};
    return json_string(words[source < COUNT(words) ? source : 0]);
}

static json_t *number_from(double value, uint32_t source)
{
    return JSON_OBJECT({"value", json_number(value)}, {"from", source_word(source)});
}

static json_t *transfer_document(const struct scene *scene)
{
    static const char *const kinds[] = {"amplitude", "intensity", "decibel", "gamma", "schlick"};
    const sonject_transfer_params *transfer = &scene->transfer;
    json_t *document =
        JSON_OBJECT({"kind", json_string(kinds[transfer->kind])},
                    {"from", source_word(scene_key_source(scene, "input.transfer.kind"))});
    if (transfer->kind >= SONJECT_TRANSFER_DECIBEL)
        json_add(
            &document, "parameter",
            number_from(transfer->parameter, scene_key_source(scene, "input.transfer.parameter")));
    if (transfer->full_scale > 0.0)
        json_add(&document, "full_scale",
                 number_from(transfer->full_scale,
                             scene_key_source(scene, "input.transfer.full_scale")));
    return document;
}

json_t *sources_document(const struct scene *scene, const sonject_statistics *statistics)
{
    json_t *document = json_object();
    const char *name = scene->calibration ? strrchr(scene->calibration, '/') : NULL;
    if (scene->calibration)
        json_add(&document, "calibration", json_text(name ? name + 1 : scene->calibration));
    if (scene->input_kind == SONJECT_INPUT_FILE)
        json_add(&document, "transfer", transfer_document(scene));
    json_add(&document, "noise_floor_db",
             number_from(statistics->noise_floor_db, statistics->noise_floor_source));
    json_add(&document, "looks", number_from(statistics->looks, statistics->looks_source));
    json_add(&document, "altitude_m",
             number_from(scene->sonar.altitude_m, scene_key_source(scene, "sonar.altitude")));
    const bool is_modelled = !isnan(scene->seabed.grain_size_phi);
    json_add(
        &document, "seabed_lambert_db",
        number_from(10.0 * log10(statistics->seabed_lambert),
                    scene_key_source(scene, is_modelled ? "seabed.sediment" : "seabed.lambert")));
    if (is_modelled)
        json_add(&document, "seabed_sediment",
                 JSON_OBJECT({"grain_size_phi", json_number(scene->seabed.grain_size_phi)},
                             {"model", json_string("APL-UW TR 9407")}));
    return document;
}
