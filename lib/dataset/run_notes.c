/* What a run tells of its scene and result. */
#include <math.h>

#include "base/json_document.h"
#include "base/report.h"
#include "dataset/run.h"
#include "swath/geometry_notes.h"

static void tell_accuracy(struct report *report, const sonject_statistics *statistics)
{
    if (!isnan(statistics->energy_error))
        report_log(report,
                   "accuracy: energies of changed pixels have errors of %.2g %%, with %.3g times "
                   "the usual number of rays",
                   100.0 * statistics->energy_error, statistics->ray_scale);
}

static void tell_noise_floor(struct report *report, const struct scene *scene,
                             const sonject_statistics *statistics)
{
    if (statistics->noise_floor_source == SONJECT_SOURCE_PATCH)
        report_log(report, "noise floor estimated from the patch: %.1f dB over the mean seabed",
                   statistics->noise_floor_db);
    else if (scene->injection
                 .estimate_noise) /* a call in memory may be one of many, so it only logs */
        (scene->input_path ? report_note : report_log)(
            report,
            "no shadow in the patch shows the noise floor, so %.1f dB under the mean seabed is "
            "assumed: compare injected shadows with real ones, and set injection.noise_floor",
            -statistics->noise_floor_db);
}

static void tell_clipped(struct report *report, const sonject_statistics *statistics)
{
    if (statistics->input_clipped > 0)
        report_log(report,
                   "%llu pixels of the patch are at the image's full scale: their true amplitude "
                   "may be larger",
                   (unsigned long long)statistics->input_clipped);
    if (statistics->output_clipped > 0)
        report_log(report, "%llu changed pixels are cut at the image's full scale",
                   (unsigned long long)statistics->output_clipped);
}

static void tell_empty(struct report *report, const struct swath *swath)
{
    char text[PING_LIST_CAPACITY];
    if (swath->skipped.count > 0)
        report_note(report, "pings without samples give no row: %s",
                    ping_list_text(&swath->skipped, text));
    if (swath->empty.count > 0)
        report_note(report, "empty rows stay as they are: %s", ping_list_text(&swath->empty, text));
}

/* Notes a frequency for which the model of sediments was not made. */
static void tell_sediment(struct report *report, const struct scene *scene)
{
    const double frequency_khz = 1e-3 * scene->sonar.centre_frequency_hz;
    if (!isnan(scene->seabed.grain_size_phi) && !(frequency_khz >= 10.0 && frequency_khz <= 100.0))
        report_note(
            report,
            "seabed.sediment: its model is valid from 10 to 100 kHz, and says little about %g kHz",
            frequency_khz);
}

static void tell_altitudes(struct report *report, const struct scene *scene)
{
    if (scene->altitudes_m[1] > 0.0)
        report_note(report,
                    "the altitude varies from %.2f to %.2f m over the objects' pings; the mean, "
                    "%.2f m, is used, so some shadows are too short or too long: limit patch to "
                    "the rows around one object",
                    scene->altitudes_m[0], scene->altitudes_m[1], scene->sonar.altitude_m);
}

void tell_scene(struct report *report, const struct scene *scene, const struct swath *swath)
{
    if (swath->tells_geometry && !scene->has_files_geometry)
        tell_other_geometry(report, scene->input_path, &swath->files_geometry, &scene->geometry);
    tell_grey_levels(report, scene->input_path, swath->grey_db, &scene->transfer);
    tell_sediment(report, scene);
    tell_altitudes(report, scene);
    char hash[HASH_TEXT_CAPACITY] = "";
    if (*scene->calibrated_hash && scene->altitude_by == ALTITUDE_OF_RETURNS &&
        file_hash(report, scene->input_path, hash) != SONJECT_OK)
        *hash = '\0'; /* who reads the file says why it cannot be read */
    tell_calibration_doubts(report, scene, hash);
}

/* Notes objects that no labeller would find, and objects of which little but white is left. */
static void tell_seen(struct report *report, const struct scene *scene,
                      const struct injection_result *result)
{
    for (uint32_t i = 0; i < result->object_count; i++) {
        const sonject_object_truth *truth = &result->objects[i];
        const double highlight_db = truth->highlight_visibility_db;
        const double shadow_db = truth->shadow_visibility_db;
        const bool is_cut = truth->highlight_clipped > CLIPPED_MUCH;
        const bool is_drowned = highlight_db < STANDS_OUT_DB;
        if (!truth->is_visible)
            report_note(report, "nothing of '%s' is in view", scene->objects[i].name);
        else if (!(isnan(highlight_db) && isnan(shadow_db)) && !(highlight_db > 0.0) &&
                 !(shadow_db < 0.0))
            report_note(report,
                        "'%s' cannot be seen: neither its highlight nor its shadow stands out from "
                        "the seabed; raise objects[].level, or check seabed.lambert",
                        scene->objects[i].name);
        else if (is_drowned && is_cut)
            report_note(report,
                        "no highlight of '%s' can stand out: the seabed there is %.1f dB below the "
                        "image's ceiling; choose a darker place",
                        scene->objects[i].name, truth->ceiling_over_seabed_db);
        else if (is_drowned)
            report_note(report,
                        "the highlight of '%s' does not stand out from the seabed: raise "
                        "objects[].level, or choose a darker place",
                        scene->objects[i].name);
        if (truth->highlight_is_cut && truth->level_kind != SONJECT_LEVEL_PHYSICAL)
            report_note(report,
                        "the highlight of '%s' reaches the patch's edge: its level counts for the "
                        "part in view; move it inward",
                        scene->objects[i].name);
        if (is_cut && !is_drowned)
            report_note(
                report,
                "%.0f %% of the highlight of '%s' is cut at the image's ceiling, %.1f dB over the "
                "seabed there: objects[].level of {over_seabed: %.0f dB} would leave room",
                100.0 * truth->highlight_clipped, scene->objects[i].name,
                truth->ceiling_over_seabed_db,
                floor(truth->ceiling_over_seabed_db - CEILING_ROOM_DB));
    }
}

void tell_result(struct report *report, const struct scene *scene, const struct swath *swath,
                 const struct injection_result *result)
{
    const sonject_statistics *statistics = &result->statistics;
    tell_empty(report, swath);
    tell_noise_floor(report, scene, statistics);
    tell_accuracy(report, statistics);
    tell_scene(report, scene, swath);
    tell_seen(report, scene, result);
    tell_clipped(report, statistics);
}
