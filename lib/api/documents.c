#define _POSIX_C_SOURCE 200809L
#include "api/documents.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <jansson.h>

#include <sonject/version.h>

#include "api/earlier_result.h"
#include "api/label_files.h"
#include "base/file.h"
#include "base/json_document.h"
#include "label/contact_record.h"

/* Horizontal range of a level seabed at a slant range; NaN before the first return. */
static double level_ground_range(const struct run_facts *facts, double slant_range_m)
{
    const double altitude = facts->scene->sonar.altitude_m;
    return slant_range_m >= altitude ? sqrt((slant_range_m - altitude) * (slant_range_m + altitude))
                                     : NAN;
}

/* Boxes of truth files count swath pixels, and say where they lie in metres. */
static json_t *swath_box_document(const struct run_facts *facts, const sonject_box *box)
{
    if (box->rows == 0)
        return json_null();
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const uint64_t row = facts->swath->patch.first_row + box->first_row;
    const uint64_t column = facts->swath->patch.first_column + box->first_column;
    const double near =
        geometry->first_slant_range_m + ((double)column - 0.5) * geometry->column_spacing_m;
    const double width = (double)box->columns * geometry->column_spacing_m;
    const double ground = level_ground_range(facts, near);
    json_t *document = json_object();
    json_add(&document, "row", json_count(row));
    json_add(&document, "column", json_count(column));
    json_add(&document, "rows", json_count(box->rows));
    json_add(&document, "columns", json_count(box->columns));
    json_add(
        &document, "along_track_m",
        json_number(geometry->first_along_track_m + ((double)row - 0.5) * geometry->row_spacing_m));
    json_add(&document, "slant_range_m", json_number(near));
    json_add(&document, "ground_range_m", json_number(ground));
    json_add(&document, "length_m", json_number((double)box->rows * geometry->row_spacing_m));
    json_add(&document, "width_m", json_number(width));
    json_add(&document, "ground_width_m",
             json_number(level_ground_range(facts, near + width) - ground));
    return document;
}

#define DEGREES_PER_RADIAN 57.29577951308232

/* How the echo's level came about, and against which seabed. */
static json_t *level_document(const struct run_facts *facts, uint32_t index)
{
    static const char *const kinds[] = {"physical", "target_strength", "over_seabed"};
    const sonject_object_params *object = &facts->scene->objects[index];
    const sonject_object_truth *truth = &facts->result->objects[index];
    const bool is_physical = truth->level_kind == SONJECT_LEVEL_PHYSICAL;
    json_t *document = json_object();
    json_add(&document, "set_by", json_string(kinds[truth->level_kind]));
    json_add(&document, "asked_db", is_physical ? json_null() : json_number(object->level_db));
    json_add(&document, "gain_db", json_number(truth->level_gain_db));
    json_add(&document, "over_seabed_db", json_number(truth->over_seabed_db));
    json_add(&document, "seabed_strength_db", json_number(truth->seabed_strength_db));
    return document;
}

/* Which edge a box of the patch touches: "swath", where the swath goes on "patch", or null. */
static json_t *cut_document(const struct run_facts *facts, bool is_cut, const sonject_box *box)
{
    const struct region *patch = &facts->swath->patch;
    const struct raster_layout *layout = &facts->swath->layout;
    const bool goes_on = (box->first_row == 0 && patch->first_row > 0) ||
                         (box->first_column == 0 && patch->first_column > 0) ||
                         (box->first_row + box->rows == patch->rows &&
                          patch->first_row + patch->rows < layout->rows) ||
                         (box->first_column + box->columns == patch->columns &&
                          patch->first_column + patch->columns < layout->columns);
    return is_cut ? json_string(goes_on ? "patch" : "swath") : json_null();
}

/* Where a row and a range of the swath lie on the map; null where the recording does not tell. */
static json_t *position_document(const struct run_facts *facts, double row, double ground_range_m)
{
    const struct track *track = &facts->swath->track;
    struct place place;
    return track_place(track, row, ground_range_m, facts->scene->geometry.side == SONJECT_SIDE_PORT,
                       &place)
               ? place_document(track->is_geographic, &place)
               : json_null();
}

static json_t *dimensions_document(const sonject_object_truth *truth)
{
    json_t *document = json_object();
    json_add(&document, "length_m", json_number(truth->overall_length_m));
    json_add(&document, "width_m", json_number(truth->overall_width_m));
    json_add(&document, "height_m", json_number(truth->overall_height_m));
    return document;
}

/* The size that a key gives, or where the shape has no such key what is left of its extent. */
static json_t *size_document(double given_m, double extent_m)
{
    return json_number(given_m > 0.0 ? given_m : extent_m);
}

static json_t *object_document(const struct run_facts *facts, uint32_t index)
{
    const sonject_object_params *object = &facts->scene->objects[index];
    const sonject_object_truth *truth = &facts->result->objects[index];
    json_t *pose = json_object();
    json_add(&pose, "heading_deg", json_number(object->heading_rad * DEGREES_PER_RADIAN));
    json_add(&pose, "pitch_deg", json_number(object->pitch_rad * DEGREES_PER_RADIAN));
    json_add(&pose, "roll_deg", json_number(object->roll_rad * DEGREES_PER_RADIAN));
    json_t *document = json_object();
    json_add(&document, "id", json_count(index + 1));
    json_add(&document, "name", json_text(object->name));
    json_add(&document, "class", json_text(object->class_name));
    json_add(&document, "shape", json_string(shape_name(object->shape)));
    json_add(&document, "length_m", size_document(object->length_m, truth->overall_length_m));
    json_add(&document, "width_m", size_document(object->width_m, truth->overall_width_m));
    json_add(&document, "diameter_m", json_number(object->diameter_m));
    json_add(&document, "body_height_m", size_document(object->height_m, truth->overall_height_m));
    json_add(&document, "top_diameter_m", json_number(object->top_diameter_m));
    json_add(&document, "front_height_m", json_number(object->front_height_m));
    json_add(&document, "cuts", json_count(object->cut_count));
    json_add(&document, "pose", pose);
    json_add(&document, "burial_m", json_number(truth->burial_m));
    json_add(&document, "along_track_m", json_number(truth->along_track_m));
    json_add(&document, "slant_range_m", json_number(truth->slant_range_m));
    json_add(&document, "ground_range_m", json_number(truth->ground_range_m));
    json_add(&document, "height_m", json_number(truth->height_m));
    json_add(&document, "grazing_deg", json_number(truth->grazing_rad * DEGREES_PER_RADIAN));
    json_add(&document, "transmission_loss_db", json_number(truth->transmission_loss_db));
    json_add(&document, "row", json_number(truth->row + (double)facts->swath->patch.first_row));
    json_add(&document, "column",
             json_number(truth->column + (double)facts->swath->patch.first_column));
    json_add(&document, "visible", json_boolean(truth->is_visible));
    json_add(&document, "highlight_cut", json_boolean(truth->highlight_is_cut));
    json_add(&document, "shadow_cut", json_boolean(truth->shadow_is_cut));
    json_add(&document, "highlight_cut_by",
             cut_document(facts, truth->highlight_is_cut, &truth->highlight));
    json_add(&document, "shadow_cut_by", cut_document(facts, truth->shadow_is_cut, &truth->shadow));
    json_add(&document, "highlight_visible", json_number(truth->highlight_visible));
    json_add(&document, "shadow_visible", json_number(truth->shadow_visible));
    json_add(&document, "dimensions", dimensions_document(truth));
    json_add(&document, "position",
             position_document(facts, truth->row + (double)facts->swath->patch.first_row,
                               truth->ground_range_m));
    json_add(&document, "highlight", swath_box_document(facts, &truth->highlight));
    json_add(&document, "shadow", swath_box_document(facts, &truth->shadow));
    json_add(&document, "box", swath_box_document(facts, &truth->both));
    json_add(&document, "highlight_pixels", json_count(truth->highlight_pixels));
    json_add(&document, "shadow_pixels", json_count(truth->shadow_pixels));
    json_add(&document, "target_strength_db", json_number(truth->target_strength_db));
    json_add(&document, "highlight_contrast_db", json_number(truth->highlight_contrast_db));
    json_add(&document, "shadow_contrast_db", json_number(truth->shadow_contrast_db));
    json_add(&document, "highlight_along_m", json_number(truth->highlight_along_m));
    json_add(&document, "highlight_range_m", json_number(truth->highlight_range_m));
    json_add(&document, "shadow_along_m", json_number(truth->shadow_along_m));
    json_add(&document, "shadow_range_m", json_number(truth->shadow_range_m));
    json_add(&document, "gap_range_m", json_number(truth->gap_range_m));
    json_add(&document, "dim_range_m", json_number(truth->dim_range_m));
    json_add(&document, "level", level_document(facts, index));
    return document;
}

/* The measured image around the objects, and what was put in with it. */
static json_t *blending_document(const sonject_statistics *statistics)
{
    const bool has_texture = isfinite(statistics->seabed_shape);
    json_t *seabed = json_object();
    json_add(&seabed, "amplitude_contrast", json_number(statistics->seabed_amplitude_contrast));
    json_add(&seabed, "looks", json_number(statistics->seabed_looks));
    json_add(&seabed, "k_shape", has_texture ? json_number(statistics->seabed_shape) : json_null());
    json_add(&seabed, "row_correlation", json_number(statistics->seabed_row_correlation));
    json_add(&seabed, "column_correlation", json_number(statistics->seabed_column_correlation));
    json_t *document = json_object();
    json_add(&document, "seabed_estimated", seabed);
    json_add(&document, "along_track_resolution_m",
             json_number(statistics->along_track_resolution_m));
    json_add(&document, "range_resolution_m", json_number(statistics->range_resolution_m));
    json_add(&document, "looks", json_number(statistics->looks));
    json_add(&document, "noise_floor_db", json_number(statistics->noise_floor_db));
    json_add(&document, "saturation_amplitude", json_number(statistics->saturation_amplitude));
    return document;
}

/* Where the patch's corners lie on the map: first row near and far, last row far and near; null
 * where that is not known. */
static json_t *corners_document(const struct run_facts *facts)
{
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const struct region *patch = &facts->swath->patch;
    json_t *corners = json_array();
    if (facts->swath->track.fix_count == 0) {
        json_decref(corners);
        return json_null();
    }
    for (int corner = 0; corner < 4; corner++) {
        const bool is_last = corner >= 2;
        const bool is_far = corner == 1 || corner == 2;
        const double row = (double)(patch->first_row + (is_last ? patch->rows - 1 : 0));
        const double column = (double)(patch->first_column + (is_far ? patch->columns - 1 : 0));
        const double range = geometry->first_slant_range_m + column * geometry->column_spacing_m;
        json_append(&corners, position_document(facts, row, level_ground_range(facts, range)));
    }
    return corners;
}

sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path)
{
    json_t *patch = json_object();
    json_add(&patch, "row", json_count(facts->swath->patch.first_row));
    json_add(&patch, "column", json_count(facts->swath->patch.first_column));
    json_add(&patch, "rows", json_count(facts->swath->patch.rows));
    json_add(&patch, "columns", json_count(facts->swath->patch.columns));
    json_add(&patch, "corners", corners_document(facts));
    json_t *objects = json_array();
    for (uint32_t i = 0; i < facts->result->object_count; i++)
        json_append(&objects, object_document(facts, i));
    json_t *document = json_object();
    json_add(&document, "image", json_text(facts->image_name));
    json_add(&document, "range_axis", json_string("slant"));
    json_add(&document, "patch", patch);
    json_add(&document, "blending", blending_document(&facts->result->statistics));
    json_add(&document, "objects", objects);
    return json_document_write(report, document, path);
}

static uint64_t peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}

static json_t *times_document(const struct run_facts *facts)
{
    const sonject_statistics *statistics = &facts->result->statistics;
    json_t *document = json_object();
    json_add(&document, "read", json_number(facts->read_s));
    json_add(&document, "trace", json_number(statistics->trace_s));
    json_add(&document, "form", json_number(statistics->form_s));
    json_add(&document, "inject", json_number(statistics->inject_s));
    json_add(&document, "write", json_number(facts->write_s));
    json_add(&document, "total", json_number(facts->total_s));
    return document;
}

static json_t *options_document(const struct scene *scene)
{
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    json_t *document = json_object();
    json_add(&document, "mode", json_string(resynthesises ? "resynthesise" : "composite"));
    json_add(
        &document, "columns",
        json_string(scene->injection.column_rule == SONJECT_COLUMNS_PAPER ? "paper" : "focused"));
    json_add(&document, "ray_scale", json_number(scene->injection.ray_scale));
    json_add(&document, "influence_db", json_number(scene->injection.influence_db));
    json_add(
        &document, "match_response",
        json_string(scene->injection.match_response == SONJECT_MATCH_IMAGE ? "image" : "nominal"));
    json_add(&document, "match_looks",
             scene->injection.match_looks == 0.0 ? json_string("image")
                                                 : json_number(scene->injection.match_looks));
    json_add(&document, "match_saturation",
             json_string(scene->injection.match_saturation == SONJECT_MATCH_IMAGE ? "image"
                                                                                  : "full_scale"));
    json_add(&document, "seabed_lambert_db", json_number(10.0 * log10(scene->seabed.lambert)));
    json_add(&document, "interactions", json_count(scene->injection.interactions));
    json_add(&document, "estimator",
             json_string(scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE ? "brute_force"
                                                                                     : "connect"));
    return document;
}

static json_t *comparison_document(const sonject_statistics *statistics)
{
    json_t *document = json_object();
    json_add(&document, "level_change_db", json_number(statistics->level_change_db));
    json_add(&document, "input_contrast", json_number(statistics->input_contrast));
    json_add(&document, "output_contrast", json_number(statistics->output_contrast));
    json_add(&document, "histogram_distance", json_number(statistics->histogram_distance));
    json_add(&document, "correlation", json_number(statistics->correlation));
    return document;
}

/* All bands of the scene's file. */
static json_t *bands_document(const struct scene *scene)
{
    json_t *names = json_array();
    for (const char *name = scene->bands; *name;) {
        const size_t length = strcspn(name, "\n");
        json_append(&names, json_stringn(name, length));
        name += length + (name[length] == '\n');
    }
    return names;
}

json_t *device_document(const struct device *device)
{
    json_t *document = json_object();
    json_add(&document, "name", json_text(device->name));
    json_add(&document, "platform", json_text(device->platform));
    json_add(&document, "driver", json_text(device->driver));
    json_add(&document, "width", json_count(device->width));
    return document;
}

sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path)
{
    const sonject_statistics *statistics = &facts->result->statistics;
    json_t *document = json_object();
    json_add(&document, "sonject", json_string(sonject_version()));
    json_add(&document, "scene_hash", json_string(facts->scene_hash));
    json_add(&document, "seed", json_seed(facts->scene->injection.seed));
    json_add(&document, "device", device_document(facts->device));
    json_add(&document, "options", options_document(facts->scene));
    if (facts->scene->band) {
        json_add(&document, "band", json_text(facts->scene->band));
        json_add(&document, "bands", bands_document(facts->scene));
    }
    json_add(&document, "image", json_text(facts->image_name));
    json_add(&document, "labels", labels_document(facts->label_formats));
    json_add(&document, "image_is_lossless", json_boolean(facts->swath->is_lossless));
    json_add(&document, "times_s", times_document(facts));
    json_add(&document, "pings", json_count(statistics->pings));
    json_add(&document, "rays", json_count(statistics->rays));
    json_add(&document, "ray_queries", json_count(statistics->ray_queries));
    json_add(&document, "impulses", json_count(statistics->impulses));
    json_add(&document, "peak_memory_bytes", json_count(peak_memory()));
    json_add(&document, "noise_floor_db", json_number(statistics->noise_floor_db));
    json_add(&document, "blending", blending_document(statistics));
    json_add(&document, "input_clipped_pixels", json_count(statistics->input_clipped));
    json_add(&document, "output_clipped_pixels", json_count(statistics->output_clipped));
    json_add(&document, "changed_pixels", json_count(statistics->changed_pixels));
    json_add(&document, "seabed_comparison",
             facts->scene->injection.mode == SONJECT_MODE_RESYNTHESISE
                 ? comparison_document(statistics)
                 : json_null());
    const sonject_status status =
        earlier_describe(report, &document, facts->inputs, facts->files, facts->scene);
    if (status == SONJECT_OK)
        return json_document_write(report, document, path);
    json_decref(document);
    return status;
}
