#define _POSIX_C_SOURCE 200809L
#include "dataset/documents.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <jansson.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "dataset/earlier_result.h"
#include "dataset/label_files.h"
#include "dataset/labels.h"

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
    return JSON_OBJECT(
        {"row", json_count(row)}, {"column", json_count(column)}, {"rows", json_count(box->rows)},
        {"columns", json_count(box->columns)},
        {"along_track_m", json_number(geometry->first_along_track_m +
                                      ((double)row - 0.5) * geometry->row_spacing_m)},
        {"slant_range_m", json_number(near)}, {"ground_range_m", json_number(ground)},
        {"length_m", json_number((double)box->rows * geometry->row_spacing_m)},
        {"width_m", json_number(width)},
        {"ground_width_m", json_number(level_ground_range(facts, near + width) - ground)});
}

#define DEGREES_PER_RADIAN 57.29577951308232

/* How the echo's level came about, and against which seabed. */
static json_t *level_document(const struct run_facts *facts, uint32_t index)
{
    static const char *const kinds[] = {"physical", "target_strength", "over_seabed"};
    const sonject_object_params *object = &facts->scene->objects[index];
    const sonject_object_truth *truth = &facts->result->objects[index];
    const bool is_physical = truth->level_kind == SONJECT_LEVEL_PHYSICAL;
    return JSON_OBJECT({"set_by", json_string(kinds[truth->level_kind])},
                       {"asked_db", is_physical ? json_null() : json_number(object->level_db)},
                       {"gain_db", json_number(truth->level_gain_db)},
                       {"over_seabed_db", json_number(truth->over_seabed_db)},
                       {"seabed_strength_db", json_number(truth->seabed_strength_db)});
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
    return JSON_OBJECT({"length_m", json_number(truth->overall_length_m)},
                       {"width_m", json_number(truth->overall_width_m)},
                       {"height_m", json_number(truth->overall_height_m)});
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
    json_t *pose =
        JSON_OBJECT({"heading_deg", json_number(object->heading_rad * DEGREES_PER_RADIAN)},
                    {"pitch_deg", json_number(object->pitch_rad * DEGREES_PER_RADIAN)},
                    {"roll_deg", json_number(object->roll_rad * DEGREES_PER_RADIAN)});
    return JSON_OBJECT(
        {"id", json_count(index + 1)}, {"name", json_text(object->name)},
        {"class", json_text(object->class_name)}, {"shape", json_string(shape_name(object->shape))},
        {"length_m", size_document(object->length_m, truth->overall_length_m)},
        {"width_m", size_document(object->width_m, truth->overall_width_m)},
        {"diameter_m", json_number(object->diameter_m)},
        {"body_height_m", size_document(object->height_m, truth->overall_height_m)},
        {"top_diameter_m", json_number(object->top_diameter_m)},
        {"front_height_m", json_number(object->front_height_m)},
        {"cuts", json_count(object->cut_count)}, {"pose", pose},
        {"burial_m", json_number(truth->burial_m)},
        {"along_track_m", json_number(truth->along_track_m)},
        {"slant_range_m", json_number(truth->slant_range_m)},
        {"ground_range_m", json_number(truth->ground_range_m)},
        {"height_m", json_number(truth->height_m)},
        {"grazing_deg", json_number(truth->grazing_rad * DEGREES_PER_RADIAN)},
        {"transmission_loss_db", json_number(truth->transmission_loss_db)},
        {"row", json_number(truth->row + (double)facts->swath->patch.first_row)},
        {"column", json_number(truth->column + (double)facts->swath->patch.first_column)},
        {"visible", json_boolean(truth->is_visible)},
        {"highlight_cut", json_boolean(truth->highlight_is_cut)},
        {"shadow_cut", json_boolean(truth->shadow_is_cut)},
        {"highlight_cut_by", cut_document(facts, truth->highlight_is_cut, &truth->highlight)},
        {"shadow_cut_by", cut_document(facts, truth->shadow_is_cut, &truth->shadow)},
        {"highlight_visible", json_number(truth->highlight_visible)},
        {"shadow_visible", json_number(truth->shadow_visible)},
        {"dimensions", dimensions_document(truth)},
        {"position", position_document(facts, truth->row + (double)facts->swath->patch.first_row,
                                       truth->ground_range_m)},
        {"highlight", swath_box_document(facts, &truth->highlight)},
        {"shadow", swath_box_document(facts, &truth->shadow)},
        {"box", swath_box_document(facts, &truth->both)},
        {"highlight_pixels", json_count(truth->highlight_pixels)},
        {"shadow_pixels", json_count(truth->shadow_pixels)},
        {"target_strength_db", json_number(truth->target_strength_db)},
        {"highlight_contrast_db", json_number(truth->highlight_contrast_db)},
        {"shadow_contrast_db", json_number(truth->shadow_contrast_db)},
        {"highlight_along_m", json_number(truth->highlight_along_m)},
        {"highlight_range_m", json_number(truth->highlight_range_m)},
        {"shadow_along_m", json_number(truth->shadow_along_m)},
        {"shadow_range_m", json_number(truth->shadow_range_m)},
        {"gap_range_m", json_number(truth->gap_range_m)},
        {"dim_range_m", json_number(truth->dim_range_m)}, {"level", level_document(facts, index)});
}

/* The measured image around the objects, and what was put in with it. */
static json_t *blending_document(const sonject_statistics *statistics)
{
    const bool has_texture = isfinite(statistics->seabed_shape);
    json_t *seabed =
        JSON_OBJECT({"amplitude_contrast", json_number(statistics->seabed_amplitude_contrast)},
                    {"looks", json_number(statistics->seabed_looks)},
                    {"k_shape", has_texture ? json_number(statistics->seabed_shape) : json_null()},
                    {"row_correlation", json_number(statistics->seabed_row_correlation)},
                    {"column_correlation", json_number(statistics->seabed_column_correlation)});
    return JSON_OBJECT(
        {"seabed_estimated", seabed},
        {"along_track_resolution_m", json_number(statistics->along_track_resolution_m)},
        {"range_resolution_m", json_number(statistics->range_resolution_m)},
        {"looks", json_number(statistics->looks)},
        {"noise_floor_db", json_number(statistics->noise_floor_db)},
        {"saturation_amplitude", json_number(statistics->saturation_amplitude)});
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
    json_t *patch = JSON_OBJECT({"row", json_count(facts->swath->patch.first_row)},
                                {"column", json_count(facts->swath->patch.first_column)},
                                {"rows", json_count(facts->swath->patch.rows)},
                                {"columns", json_count(facts->swath->patch.columns)},
                                {"corners", corners_document(facts)});
    json_t *objects = json_array();
    for (uint32_t i = 0; i < facts->result->object_count; i++)
        json_append(&objects, object_document(facts, i));
    json_t *document =
        JSON_OBJECT({"image", json_text(facts->image_name)}, {"range_axis", json_string("slant")},
                    {"patch", patch}, {"blending", blending_document(&facts->result->statistics)},
                    {"objects", objects});
    return json_document_write(report, document, 12, path);
}

static uint64_t peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}

static json_t *times_document(const struct run_facts *facts)
{
    const sonject_statistics *statistics = &facts->result->statistics;
    return JSON_OBJECT(
        {"read", json_number(facts->read_s)}, {"trace", json_number(statistics->trace_s)},
        {"form", json_number(statistics->form_s)}, {"inject", json_number(statistics->inject_s)},
        {"write", json_number(facts->write_s)}, {"total", json_number(facts->total_s)});
}

static json_t *options_document(const struct scene *scene)
{
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    return JSON_OBJECT(
        {"mode", json_string(resynthesises ? "resynthesise" : "composite")},
        {"columns",
         json_string(scene->injection.column_rule == SONJECT_COLUMNS_PAPER ? "paper" : "focused")},
        {"ray_scale", json_number(scene->injection.ray_scale)},
        {"influence_db", json_number(scene->injection.influence_db)},
        {"match_response",
         json_string(scene->injection.match_response == SONJECT_MATCH_IMAGE ? "image" : "nominal")},
        {"match_looks", scene->injection.match_looks == 0.0
                            ? json_string("image")
                            : json_number(scene->injection.match_looks)},
        {"match_saturation",
         json_string(scene->injection.match_saturation == SONJECT_MATCH_IMAGE ? "image"
                                                                              : "full_scale")},
        {"seabed_lambert_db", json_number(10.0 * log10(scene->seabed.lambert))},
        {"interactions", json_count(scene->injection.interactions)},
        {"estimator",
         json_string(scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE ? "brute_force"
                                                                                 : "connect")});
}

static json_t *comparison_document(const sonject_statistics *statistics)
{
    return JSON_OBJECT({"level_change_db", json_number(statistics->level_change_db)},
                       {"input_contrast", json_number(statistics->input_contrast)},
                       {"output_contrast", json_number(statistics->output_contrast)},
                       {"histogram_distance", json_number(statistics->histogram_distance)},
                       {"correlation", json_number(statistics->correlation)});
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
    return JSON_OBJECT({"name", json_text(device->name)}, {"platform", json_text(device->platform)},
                       {"driver", json_text(device->driver)}, {"width", json_count(device->width)});
}

sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path)
{
    const sonject_statistics *statistics = &facts->result->statistics;
    json_t *document = JSON_OBJECT(
        {"sonject", json_string(sonject_version())}, {"scene_hash", json_string(facts->scene_hash)},
        {"seed", json_seed(facts->scene->injection.seed)},
        {"device", device_document(facts->device)}, {"options", options_document(facts->scene)});
    if (facts->scene->band) {
        json_add(&document, "band", json_text(facts->scene->band));
        json_add(&document, "bands", bands_document(facts->scene));
    }
    json_add(&document, "image", json_text(facts->image_name));
    json_add(&document, "labels", labels_document(facts->label_formats));
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
        return json_document_write(report, document, 12, path);
    json_decref(document);
    return status;
}
