/* The files of a scene's hydrophone time series. */
#include "dataset/run.h"

#include <math.h>
#include <stdlib.h>

#include <jansson.h>

#include <sonject/elements.h>
#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "inject/injection.h"
#include "inject/scene_hash.h"
#include "inject/swath.h"
#include "scene/element_plan.h"
#include "swath/raster_file.h"

#define SERIES_FILE "series.npy"
#define DOCUMENT    "elements.json"

static json_t *array_document(const sonject_elements_params *elements)
{
    return JSON_OBJECT(
        JSON_COUNT(elements, pings), JSON_NUMBER(elements, first_ping_m),
        JSON_NUMBER(elements, ping_spacing_m), JSON_NUMBER(elements, transmitter_offset_m),
        JSON_NUMBER(elements, transmitter_length_m), JSON_COUNT(elements, hydrophones),
        JSON_NUMBER(elements, first_hydrophone_m), JSON_NUMBER(elements, hydrophone_spacing_m),
        JSON_NUMBER(elements, hydrophone_length_m), JSON_NUMBER(elements, aspect_limit_rad));
}

/* Describes the place of the scene's image, for users who want to image the same area. */
static json_t *image_document(const struct scene *scene, const struct injection_input *input)
{
    const sonject_geometry_params *geometry = &scene->geometry;
    return JSON_OBJECT(
        {"rows", json_integer((json_int_t)input->rows)},
        {"columns", json_integer((json_int_t)input->columns)},
        {"row_spacing_m", json_number(geometry->row_spacing_m)},
        {"column_spacing_m", json_number(geometry->column_spacing_m)},
        {"first_along_track_m",
         json_number(geometry->first_along_track_m + input->first_row * geometry->row_spacing_m)},
        {"first_slant_range_m",
         json_number(
             fmin(geometry_range(geometry, input->first_column),
                  geometry_range(geometry, input->first_column + (double)(input->columns - 1))))},
        {"range_grows", json_string(geometry_is_reversed(geometry) ? "left" : "right")});
}

static json_t *series_document(const struct scene *scene, const struct injection_input *input,
                               const sonject_element_layout *layout)
{
    const sonject_elements_params *elements = &layout->elements;
    const bool is_pressure = !isnan(elements->source_level_db);
    const bool is_chirp = elements->pulse == SONJECT_SERIES_CHIRP;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    return JSON_OBJECT(
        {"sonject", json_string(sonject_version())}, {"series", json_string(SERIES_FILE)},
        {"axes", json_pack("[s, s, s]", "ping", "hydrophone", "sample")},
        {"form", json_string(elements->form == SONJECT_SERIES_PASSBAND ? "passband" : "baseband")},
        {"pulse", json_string(is_chirp ? "chirp" : "compressed")},
        {"chirp_duration_s", is_chirp ? json_number(elements->chirp_duration_s) : json_null()},
        {"phase",
         json_string("an echo of delay tau has phase +2 pi f0 tau; pass band: real part of base "
                     "band times exp(-i 2 pi f0 t)")},
        {"normalisation",
         json_string(is_pressure
                         ? "pressure in Pa, sqrt(2) times the rms of a tone, less absorption"
                         : "pressure over that of the source at 1 m, without absorption")},
        {"source_level_db", is_pressure ? json_number(elements->source_level_db) : json_null()},
        {"heard", json_string(resynthesises ? "targets and seabed" : "targets")},
        {"samples", json_count(layout->samples)}, JSON_NUMBER(elements, sampling_rate_hz),
        JSON_NUMBER(elements, first_time_s), JSON_NUMBER(layout, sound_speed_mps),
        JSON_NUMBER(layout, centre_frequency_hz), JSON_NUMBER(layout, bandwidth_hz),
        JSON_NUMBER(layout, along_track_resolution_m),
        {"altitude_m", json_number(scene->sonar.altitude_m)},
        {"side",
         json_string(scene->geometry.side == SONJECT_SIDE_STARBOARD ? "starboard" : "port")},
        {"array", array_document(elements)}, {"image", image_document(scene, input)});
}

/* Finds the scene's inputs, and a digest of what elements.json says of array and series. */
static sonject_status find_inputs(struct report *report, const struct scene *scene,
                                  const struct swath *swath, const json_t *document,
                                  json_t **inputs)
{
    char digest[HASH_TEXT_CAPACITY];
    CHECK(scene_inputs(report, scene, swath->identity, digest, inputs));
    CHECK(json_document_hash(report, document, JSON_COMPACT | JSON_REAL_PRECISION(17), digest));
    json_add(inputs, "elements", json_string(digest));
    return *inputs ? SONJECT_OK : report_out_of_memory(report, "inputs");
}

/* Writes the files, elements.json last, so a folder that has it is complete. document: released. */
static sonject_status write_files(struct report *report, const struct scene *scene,
                                  const sonject_element_layout *layout, json_t *inputs,
                                  json_t *document, const float *series, const char *folder)
{
    const uint64_t shape[3] = {layout->elements.pings, layout->elements.hydrophones,
                               layout->samples};
    char series_path[PATH_CAPACITY], document_path[PATH_CAPACITY];
    sonject_status status = path_in(report, series_path, folder, SERIES_FILE);
    THEN(status, path_in(report, document_path, folder, DOCUMENT));
    THEN(status, folder_make(report, folder));
    json_t *earlier = status == SONJECT_OK ? earlier_withdraw(folder, DOCUMENT) : NULL;
    json_t *files = json_array();
    THEN(status, npy_write(report, series_path, PIXEL_FLOAT32,
                           layout->elements.form == SONJECT_SERIES_BASEBAND, shape, 3, series));
    THEN(status, file_list_add(&files, report, folder, SERIES_FILE, true));
    THEN(status, earlier_describe(report, &document, inputs, files, scene));
    status = json_document_write(report, status, document, 17, document_path);
    earlier_tidy(folder, DOCUMENT, earlier, files);
    json_decref(files);
    return status;
}

static sonject_status compute(struct report *report, struct device_slot *slot,
                              const struct scene *scene, const struct injection_input *input,
                              sonject_progress_function progress, void *user,
                              sonject_element_layout *layout, float **series)
{
    struct device *device = NULL;
    CHECK(device_slot_open(report, slot, &device));
    *series = allocate_array(element_plan_samples(layout), 2 * sizeof **series);
    CHECK_MEMORY(report, *series,
                 "the time series: narrow the window of times, or "
                 "give fewer pings");
    return element_echoes_compute(report, device, scene, input, progress, user, layout, *series);
}

static sonject_status run_swath_elements(struct report *report, struct device_slot *slot,
                                         const struct scene *scene, const struct swath *swath,
                                         const sonject_run_params *params,
                                         sonject_progress_function progress, void *user)
{
    const struct injection_input input = swath_input(swath);
    sonject_element_layout layout;
    json_t *inputs = NULL;
    float *series = NULL;
    bool is_finished = false;
    CHECK(element_echoes_describe(report, scene, &input, &layout));
    json_t *document = series_document(scene, &input, &layout);
    sonject_status status = find_inputs(report, scene, swath, document, &inputs);
    if (status == SONJECT_OK) {
        static const char *const names[] = {SERIES_FILE, NULL};
        const struct earlier_request earlier = {.folder = params->folder,
                                                .document = DOCUMENT,
                                                .names = names,
                                                .inputs = inputs,
                                                .scene = scene,
                                                .overwrites = params->overwrites != 0};
        status = earlier_check(report, &earlier, &is_finished);
    }
    if (status == SONJECT_OK && !is_finished)
        status = compute(report, slot, scene, &input, progress, user, &layout, &series);
    if (status == SONJECT_OK && !is_finished)
        status = write_files(report, scene, &layout, inputs, json_incref(document), series,
                             params->folder);
    json_decref(document);
    json_decref(inputs);
    free(series);
    return status;
}

sonject_status run_elements(struct report *report, struct device_slot *slot,
                            const struct scene *scene, const sonject_run_params *params,
                            sonject_progress_function progress, void *user)
{
    struct swath swath;
    CHECK(swath_open(report, scene, &swath));
    const sonject_status status =
        run_swath_elements(report, slot, scene, &swath, params, progress, user);
    swath_close(&swath);
    return status;
}
