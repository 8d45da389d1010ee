/* Calibrations that scenes ask for by input.calibration: auto, made once and kept, and the sources
 * of the numbers that a run used. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/run.h"
#include "measure/calibration.h"
#include "schema/keys.h"
#include "schema/scene_file.h"

#define MADE_FOR "  made_for: " /* the last line, among the measured values */

/* Returns the geometry of the swath, the same for each patch. Zeros: the file gives it. */
static sonject_geometry_params swath_geometry(const struct scene *scene)
{
    static const sonject_geometry_params unknown;
    sonject_geometry_params geometry = scene->geometry;
    if (scene->has_pings_range)
        geometry.first_slant_range_m = scene->pings.first_ranges_m[0];
    return scene->has_files_geometry ? unknown : geometry;
}

/* Makes the line that tells what a scene's calibration is made for, and that the text is as it was
 * written. Errors: MEMORY. */
static sonject_status made_for_line(struct report *report, const struct scene *scene,
                                    const char *swath_hash, const char *text, size_t bytes,
                                    char line[sizeof MADE_FOR + HASH_TEXT_CAPACITY])
{
    const sonject_geometry_params geometry = swath_geometry(scene);
    const double numbers[] = {geometry.row_spacing_m, geometry.column_spacing_m,
                              geometry.first_slant_range_m};
    char digits[HASH_TEXT_CAPACITY];
    struct hash *hash = hash_begin();
    CHECK_MEMORY(report, hash, "a hash");
    hash_add_text(hash, sonject_version());
    hash_add_text(hash, swath_hash);
    hash_add_text(hash, scene->array ? scene->array : "");
    hash_add(hash, &scene->channel, sizeof scene->channel);
    hash_add(hash, numbers, sizeof numbers);
    hash_add(hash, text, bytes);
    hash_end(hash, digits);
    snprintf(line, sizeof MADE_FOR + HASH_TEXT_CAPACITY, MADE_FOR "%s\n", digits);
    return SONJECT_OK;
}

/* Finds whether the file is there, made for that scene, and not changed. */
static sonject_status is_made_for(struct report *report, const char *path,
                                  const struct scene *scene, const char *swath_hash, bool *is_it)
{
    char line[sizeof MADE_FOR + HASH_TEXT_CAPACITY];
    const size_t length = sizeof line - 1;
    char *text = NULL;
    size_t bytes;
    *is_it = false;
    if (!file_exists(path))
        return SONJECT_OK;
    CHECK(file_read_whole(report, path, TREE_BYTES_MAX, &text, &bytes));
    sonject_status status = SONJECT_OK;
    if (bytes > length) {
        status = made_for_line(report, scene, swath_hash, text, bytes - length, line);
        *is_it = status == SONJECT_OK && memcmp(text + bytes - length, line, length) == 0;
    }
    free(text);
    return status;
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
    char line[sizeof MADE_FOR + HASH_TEXT_CAPACITY];
    struct growing_text made = {NULL, 0, 0, false};
    char *text = NULL;
    bool is_it = false;
    CHECK(path_in(report, path, folder, "%s.yaml", name));
    CHECK(path_in(report, picture, folder, "%s.png", name));
    CHECK(file_hash(report, scene->input_path, hash));
    const struct image_options options = {scene->channel, scene->array, scene->transfer,
                                          !scene->has_files_geometry, swath_geometry(scene)};
    const sonject_calibrate_params params = {.struct_size = sizeof params,
                                             .image = scene->input_path,
                                             .channel = channel_text(scene->channel, channel),
                                             .array = scene->array,
                                             .picture = picture};
    CHECK(is_made_for(report, path, scene, hash, &is_it));
    if (is_it || (file_exists(path) && !replaces))
        return SONJECT_OK;
    CHECK(folder_make(report, folder));
    sonject_status status = calibrate_image(report, &params, &options, NULL, true, &text);
    THEN(status, made_for_line(report, scene, hash, text, strlen(text), line));
    if (status == SONJECT_OK) {
        growing_text_add(&made, "%s%s", text, line);
        status = growing_text_write(report, &made, path);
    }
    free(text);
    if (status == SONJECT_OK)
        report_note(report, "calibration made: %s, with a picture beside it", path);
    return status;
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
    report_log(report, "calibration %s gives %s", scene->calibration, *keys ? keys : "nothing");
}

void tell_calibration_doubts(struct report *report, const struct scene *scene, const char *hash)
{
    const double share = scene->recorded_over_first_return;
    const char *side = scene->geometry.side == SONJECT_SIDE_PORT ? "port" : "starboard";
    const bool is_of_other_side =
        *scene->calibrated_side && strcmp(scene->calibrated_side, side) != 0;
    if (is_of_other_side)
        report_note(report,
                    "%s was measured on the %s side, and this is %s: calibrate that (sonject "
                    "calibrate --channel %s), or write input.calibration: auto",
                    scene->calibration, scene->calibrated_side, side, side);
    if (scene->altitude_by == ALTITUDE_OF_RETURNS && *scene->calibrated_hash && *hash &&
        strcmp(scene->calibrated_hash, hash) != 0)
        report_note(report,
                    "%s was measured on another swath than %s, and altitudes by first returns are "
                    "those of its pings: calibrate this swath (sonject calibrate %s -o FILE), and "
                    "name that file as input.calibration",
                    scene->calibration, scene->input_path, scene->input_path);
    if (scene->calibrated_leftward && !is_of_other_side && scene->geometry.nadir_column <= 0.0)
        report_note(report,
                    "%s found the water column at the image's right edge, and here range grows to "
                    "the right: if it grows to the left, give input.geometry.nadir_column%s",
                    scene->calibration,
                    *scene->calibrated_side ? " with row_spacing and column_spacing, in place of "
                                              "from_file"
                                            : "");
    if (share > 0.0 && fabs(share - 1.0) > ALTITUDES_ALIKE &&
        scene->altitude_by == ALTITUDE_RECORDED && scene->pings.count == 0)
        report_note(
            report,
            "the recorded altitude, %.2f m here, is %.0f %% %s the first return in %s, so shadows "
            "become too %s: if the first return is right, write sonar.altitude: first_return",
            scene->sonar.altitude_m, 100.0 * fabs(share - 1.0), share < 1.0 ? "below" : "above",
            scene->calibration, share < 1.0 ? "long" : "short");
}

/* ---- Sources of numbers. */

const char *source_word(uint32_t source)
{
    static const char *const words[] = {
        [SONJECT_SOURCE_DEFAULT] = "default",         [SONJECT_SOURCE_SCENE] = "scene",
        [SONJECT_SOURCE_CALIBRATION] = "calibration", [SONJECT_SOURCE_PATCH] = "patch",
        [SONJECT_SOURCE_FALLBACK] = "fallback",       [SONJECT_SOURCE_FILE] = "file"};
    return words[source < COUNT(words) ? source : 0];
}

static json_t *number_from(double value, uint32_t source)
{
    return JSON_OBJECT({"value", json_number(value)}, {"from", json_string(source_word(source))});
}

static json_t *transfer_document(const struct scene *scene)
{
    const sonject_transfer_params *transfer = &scene->transfer;
    json_t *document = JSON_OBJECT(
        {"kind", json_string(transfer_word(transfer->kind))},
        {"from", json_string(source_word(scene_key_source(scene, "input.transfer.kind")))});
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
    if (scene->calibration)
        json_add(&document, "calibration", json_text(path_name(scene->calibration)));
    if (scene->input_kind == SONJECT_INPUT_FILE)
        json_add(&document, "transfer", transfer_document(scene));
    json_add(&document, "noise_floor_db",
             number_from(statistics->noise_floor_db, statistics->noise_floor_source));
    json_add(&document, "looks", number_from(statistics->looks, statistics->looks_source));
    json_add(&document, "altitude_m",
             number_from(scene->sonar.altitude_m, scene->altitude_by == ALTITUDE_RECORDED
                                                      ? (uint32_t)SONJECT_SOURCE_FILE
                                                  : scene->altitude_by == ALTITUDE_OF_RETURNS
                                                      ? (uint32_t)SONJECT_SOURCE_CALIBRATION
                                                      : scene_key_source(scene, "sonar.altitude")));
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
