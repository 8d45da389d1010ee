/* The element level of a scene's own input, as files. */
#include "api/handles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include <sonject/elements.h>
#include <sonject/version.h>

#include "api/swath.h"
#include "base/file.h"
#include "base/memory.h"
#include "inject/element_echoes.h"
#include "io/numpy_file.h"
#include "scene/element_plan.h"

#define SERIES_FILE "series.npy"

static void add(json_t *object, const char *key, json_t *value)
{
    json_object_set_new(object, key, value);
}

static json_t *array_document(const sonject_elements_params *elements)
{
    json_t *document = json_object();
    add(document, "pings", json_integer((json_int_t)elements->pings));
    add(document, "first_ping_m", json_real(elements->first_ping_m));
    add(document, "ping_spacing_m", json_real(elements->ping_spacing_m));
    add(document, "transmitter_offset_m", json_real(elements->transmitter_offset_m));
    add(document, "transmitter_length_m", json_real(elements->transmitter_length_m));
    add(document, "hydrophones", json_integer((json_int_t)elements->hydrophones));
    add(document, "first_hydrophone_m", json_real(elements->first_hydrophone_m));
    add(document, "hydrophone_spacing_m", json_real(elements->hydrophone_spacing_m));
    add(document, "hydrophone_length_m", json_real(elements->hydrophone_length_m));
    add(document, "aspect_limit_rad", json_real(elements->aspect_limit_rad));
    return document;
}

/* Where the scene's image lies, for those who want to see the same. */
static json_t *image_document(const struct scene *scene, const struct injection_input *input)
{
    const sonject_geometry_params *geometry = &scene->geometry;
    json_t *document = json_object();
    add(document, "rows", json_integer((json_int_t)input->rows));
    add(document, "columns", json_integer((json_int_t)input->columns));
    add(document, "row_spacing_m", json_real(geometry->row_spacing_m));
    add(document, "column_spacing_m", json_real(geometry->column_spacing_m));
    add(document, "first_along_track_m",
        json_real(geometry->first_along_track_m + input->first_row * geometry->row_spacing_m));
    add(document, "first_slant_range_m",
        json_real(geometry->first_slant_range_m +
                  input->first_column * geometry->column_spacing_m));
    return document;
}

static json_t *series_document(const struct scene *scene, const struct injection_input *input,
                               const sonject_element_layout *layout)
{
    const sonject_elements_params *elements = &layout->elements;
    const bool is_pressure = !isnan(elements->source_level_db);
    const bool is_chirp = elements->pulse == SONJECT_SERIES_CHIRP;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    json_t *document = json_object();
    add(document, "sonject", json_string(sonject_version()));
    add(document, "series", json_string(SERIES_FILE));
    add(document, "axes", json_pack("[s, s, s]", "ping", "hydrophone", "sample"));
    add(document, "form",
        json_string(elements->form == SONJECT_SERIES_PASSBAND ? "passband" : "baseband"));
    add(document, "pulse", json_string(is_chirp ? "chirp" : "compressed"));
    add(document, "chirp_duration_s",
        is_chirp ? json_real(elements->chirp_duration_s) : json_null());
    add(document, "phase",
        json_string("an echo of delay tau has phase +2 pi f0 tau; pass band: real part of base "
                    "band times exp(-i 2 pi f0 t)"));
    add(document, "normalisation",
        json_string(is_pressure ? "pressure in Pa, sqrt(2) times the rms of a tone, less absorption"
                                : "pressure over that of the source at 1 m, without absorption"));
    add(document, "source_level_db",
        is_pressure ? json_real(elements->source_level_db) : json_null());
    add(document, "heard", json_string(resynthesises ? "targets and seabed" : "targets"));
    add(document, "samples", json_integer((json_int_t)layout->samples));
    add(document, "sampling_rate_hz", json_real(elements->sampling_rate_hz));
    add(document, "first_time_s", json_real(elements->first_time_s));
    add(document, "sound_speed_mps", json_real(layout->sound_speed_mps));
    add(document, "centre_frequency_hz", json_real(layout->centre_frequency_hz));
    add(document, "bandwidth_hz", json_real(layout->bandwidth_hz));
    add(document, "along_track_resolution_m", json_real(layout->along_track_resolution_m));
    add(document, "altitude_m", json_real(scene->sonar.altitude_m));
    add(document, "side",
        json_string(scene->geometry.side == SONJECT_SIDE_STARBOARD ? "starboard" : "port"));
    add(document, "array", array_document(elements));
    add(document, "image", image_document(scene, input));
    return document;
}

static sonject_status write_document(struct report *report, json_t *document, const char *path)
{
    char *text = json_dumps(document, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    json_decref(document);
    if (!text)
        return report_out_of_memory(report, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}

static sonject_status write_files(struct report *report, const struct scene *scene,
                                  const struct injection_input *input,
                                  const sonject_element_layout *layout, const float *series,
                                  const char *folder)
{
    const uint64_t shape[3] = {layout->elements.pings, layout->elements.hydrophones,
                               layout->samples};
    char *series_path = path_join(folder, SERIES_FILE);
    char *document_path = path_join(folder, "elements.json");
    sonject_status status = series_path && document_path ? folder_make(report, folder)
                                                         : report_out_of_memory(report, "a path");
    if (status == SONJECT_OK) {
        /* elements.json comes last: a folder that has one is complete */
        file_discard(document_path);
        status = numpy_file_write(report, series_path, shape,
                                  layout->elements.form == SONJECT_SERIES_BASEBAND, series);
    }
    if (status == SONJECT_OK)
        status = write_document(report, series_document(scene, input, layout), document_path);
    free(series_path);
    free(document_path);
    return status;
}

static sonject_status compute_and_write(struct sonject_context *context, const struct scene *scene,
                                        const struct injection_input *input, const char *folder,
                                        sonject_progress_function progress, void *user)
{
    struct report *report = &context->report;
    struct device *device = NULL;
    sonject_element_layout layout;
    sonject_status status = element_echoes_describe(report, scene, input, &layout);
    if (status == SONJECT_OK)
        status = context_device(context, &device);
    if (status != SONJECT_OK)
        return status;
    float *series = allocate_array(element_plan_samples(&layout), 2 * sizeof *series);
    status =
        series
            ? element_echoes_compute(report, device, scene, input, progress, user, &layout, series)
            : report_out_of_memory(report, "the time series: narrow the window of times, or "
                                           "give fewer pings");
    if (status == SONJECT_OK)
        status = write_files(report, scene, input, &layout, series, folder);
    free(series);
    return status;
}

sonject_status sonject_elements_run(sonject_context *context, const sonject_scene *scene,
                                    const sonject_run_params *params,
                                    sonject_progress_function progress, void *user)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    struct report *report = &context->report;
    if (!scene)
        return null_argument(report, "scene");
    sonject_run_params taken;
    sonject_run_params_init(&taken);
    sonject_status status =
        params_take(report, &taken, sizeof taken, params, sizeof taken, "run parameters");
    if (status != SONJECT_OK)
        return status;
    if (!taken.folder || !taken.folder[0])
        return null_argument(report, "folder");
    struct swath swath;
    status = swath_open(report, &scene->scene, &swath);
    if (status != SONJECT_OK)
        return status;
    const struct injection_input input = swath_input(&swath);
    status = compute_and_write(context, &scene->scene, &input, taken.folder, progress, user);
    swath_close(&swath);
    return status;
}
