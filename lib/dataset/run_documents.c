/* The documents of a run: truth.json and run.json. */
#include "dataset/run.h"

#include <math.h>
#include <string.h>

#include <sonject/run.h>
#include <sonject/version.h>

#include "base/json_document.h"
#include "base/system/process.h"
#include "base/units.h"

/* Returns the horizontal range of level seabed at a slant range, m; NaN before the first return. */
static double level_ground_range(const struct run_facts *facts, double slant_range_m)
{
    const double altitude = facts->scene->sonar.altitude_m;
    return slant_range_m >= altitude ? sqrt((slant_range_m - altitude) * (slant_range_m + altitude))
                                     : NAN;
}

/* Describes a box of the patch in pixels of the swath and in metres. */
static json_t *swath_box_document(const struct run_facts *facts, const sonject_box *box)
{
    if (box->rows == 0)
        return json_null();
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const uint64_t row = facts->swath->patch.first_row + box->first_row;
    const uint64_t column = facts->swath->patch.first_column + box->first_column;
    const double along =
        geometry->first_along_track_m + ((double)row - 0.5) * geometry->row_spacing_m;
    const double near = fmin(geometry_range(geometry, (double)column - 0.5),
                             geometry_range(geometry, (double)(column + box->columns) - 0.5));
    const double width = (double)box->columns * geometry->column_spacing_m;
    const double ground = level_ground_range(facts, near);
    return JSON_OBJECT(
        {"row", json_count(row)}, {"column", json_count(column)}, JSON_COUNT(box, rows),
        JSON_COUNT(box, columns), {"along_track_m", json_number(along)},
        {"slant_range_m", json_number(near)}, {"ground_range_m", json_number(ground)},
        {"length_m", json_number((double)box->rows * geometry->row_spacing_m)},
        {"width_m", json_number(width)},
        {"ground_width_m", json_number(level_ground_range(facts, near + width) - ground)});
}

/* Describes how the echo's level was set, and the seabed that it refers to. */
static json_t *level_document(const sonject_object_params *object,
                              const sonject_object_truth *truth)
{
    static const char *const kinds[] = {"physical", "target_strength", "over_seabed"};
    const bool is_physical = truth->level_kind == SONJECT_LEVEL_PHYSICAL;
    return JSON_OBJECT({"set_by", json_string(kinds[truth->level_kind])},
                       {"asked_db", is_physical ? json_null() : json_number(object->level_db)},
                       {"gain_db", json_number(truth->level_gain_db)},
                       JSON_NUMBER(truth, over_seabed_db), JSON_NUMBER(truth, seabed_strength_db),
                       JSON_NUMBER(truth, ceiling_over_seabed_db));
}

/* Returns the edge that a box touches: "swath", "patch" where the swath goes on, or null. */
static json_t *cut_document(const struct run_facts *facts, bool is_cut, const sonject_box *box)
{
    const struct region *patch = facts->chip ? facts->chip : &facts->swath->patch;
    const struct raster_layout *layout = facts->chip ? facts->whole : &facts->swath->layout;
    const bool goes_on = (box->first_row == 0 && patch->first_row > 0) ||
                         (box->first_column == 0 && patch->first_column > 0) ||
                         (box->first_row + box->rows == patch->rows &&
                          patch->first_row + patch->rows < layout->rows) ||
                         (box->first_column + box->columns == patch->columns &&
                          patch->first_column + patch->columns < layout->columns);
    return is_cut ? json_string(goes_on ? "patch" : "swath") : json_null();
}

/* Returns the map position of a row and a ground range; null where the recording gives none. */
static json_t *position_document(const struct run_facts *facts, double row, double ground_range_m)
{
    const struct track *track = &facts->swath->track;
    struct place place;
    if (!track_place(track, row, ground_range_m, facts->scene->geometry.side == SONJECT_SIDE_PORT,
                     &place))
        return json_null();
    return JSON_OBJECT(
        {track->is_geographic ? "longitude_deg" : "easting_m", json_number(place.x)},
        {track->is_geographic ? "latitude_deg" : "northing_m", json_number(place.y)});
}

/* Returns the size that a key gives, or the extent where the shape has no such key. */
static json_t *size_document(double given_m, double extent_m)
{
    return json_number(given_m > 0.0 ? given_m : extent_m);
}

static json_t *object_document(const struct run_facts *facts, uint32_t index)
{
    const sonject_object_params *object = &facts->scene->objects[index];
    const sonject_object_truth *truth = &facts->result->objects[index];
    const double row = truth->row + (double)facts->swath->patch.first_row;
    const double column = truth->column + (double)facts->swath->patch.first_column;
    json_t *pose =
        JSON_OBJECT({"heading_deg", json_number(object->heading_rad * DEGREES_PER_RADIAN)},
                    {"pitch_deg", json_number(object->pitch_rad * DEGREES_PER_RADIAN)},
                    {"roll_deg", json_number(object->roll_rad * DEGREES_PER_RADIAN)});
    json_t *dimensions = JSON_OBJECT({"length_m", json_number(truth->overall_length_m)},
                                     {"width_m", json_number(truth->overall_width_m)},
                                     {"height_m", json_number(truth->overall_height_m)});
    return JSON_OBJECT(
        {"id", json_count(index + 1)}, {"name", json_text(object->name)},
        {"class", json_text(object->class_name)}, {"shape", json_string(shape_name(object->shape))},
        {"length_m", size_document(object->length_m, truth->overall_length_m)},
        {"width_m", size_document(object->width_m, truth->overall_width_m)},
        JSON_NUMBER(object, diameter_m),
        {"body_height_m", size_document(object->height_m, truth->overall_height_m)},
        JSON_NUMBER(object, top_diameter_m), JSON_NUMBER(object, front_height_m), {"pose", pose},
        JSON_NUMBER(truth, burial_m), JSON_NUMBER(truth, along_track_m),
        JSON_NUMBER(truth, slant_range_m), JSON_NUMBER(truth, ground_range_m),
        JSON_NUMBER(truth, height_m),
        {"grazing_deg", json_number(truth->grazing_rad * DEGREES_PER_RADIAN)},
        JSON_NUMBER(truth, transmission_loss_db), {"row", json_number(row)},
        {"column", json_number(column)}, {"visible", json_boolean(truth->is_visible)},
        {"highlight_cut", json_boolean(truth->highlight_is_cut)},
        {"shadow_cut", json_boolean(truth->shadow_is_cut)},
        {"highlight_cut_by", cut_document(facts, truth->highlight_is_cut, &truth->highlight)},
        {"shadow_cut_by", cut_document(facts, truth->shadow_is_cut, &truth->shadow)},
        JSON_NUMBER(truth, highlight_visible), JSON_NUMBER(truth, highlight_clipped),
        JSON_NUMBER(truth, shadow_visible), {"dimensions", dimensions},
        {"position", position_document(facts, row, truth->ground_range_m)},
        {"highlight", swath_box_document(facts, &truth->highlight)},
        {"shadow", swath_box_document(facts, &truth->shadow)},
        {"box", swath_box_document(facts, &truth->both)}, JSON_COUNT(truth, highlight_pixels),
        JSON_COUNT(truth, shadow_pixels), JSON_NUMBER(truth, target_strength_db),
        JSON_NUMBER(truth, highlight_contrast_db), JSON_NUMBER(truth, shadow_contrast_db),
        JSON_NUMBER(truth, highlight_along_m), JSON_NUMBER(truth, highlight_range_m),
        JSON_NUMBER(truth, shadow_along_m), JSON_NUMBER(truth, shadow_range_m),
        JSON_NUMBER(truth, gap_range_m), JSON_NUMBER(truth, dim_range_m),
        JSON_NUMBER(truth, highlight_visibility_db), JSON_NUMBER(truth, shadow_visibility_db),
        {"level", level_document(object, truth)});
}

/* Describes the measured image around the objects, and the values used to put objects in. */
static json_t *blending_document(const sonject_statistics *statistics)
{
    json_t *seabed =
        JSON_OBJECT({"amplitude_contrast", json_number(statistics->seabed_amplitude_contrast)},
                    {"looks", json_number(statistics->seabed_looks)},
                    {"k_shape", json_number(statistics->seabed_shape)},
                    {"row_correlation", json_number(statistics->seabed_row_correlation)},
                    {"column_correlation", json_number(statistics->seabed_column_correlation)});
    return JSON_OBJECT(
        {"seabed_estimated", seabed}, JSON_NUMBER(statistics, along_track_resolution_m),
        JSON_NUMBER(statistics, range_resolution_m), JSON_NUMBER(statistics, looks),
        JSON_NUMBER(statistics, noise_floor_db), JSON_NUMBER(statistics, saturation_amplitude));
}

/* Returns the patch's corners on the map, or null: first row near, far; last row far, near. */
static json_t *corners_document(const struct run_facts *facts)
{
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const struct region *patch = &facts->swath->patch;
    if (facts->swath->track.fix_count == 0)
        return json_null();
    json_t *corners = json_array();
    for (int corner = 0; corner < 4; corner++) {
        const bool is_last = corner >= 2;
        const bool is_far = corner == 1 || corner == 2;
        const double row = (double)(patch->first_row + (is_last ? patch->rows - 1 : 0));
        const bool is_last_column = is_far != geometry_is_reversed(geometry);
        const double column =
            (double)(patch->first_column + (is_last_column ? patch->columns - 1 : 0));
        const double range = geometry_range(geometry, column);
        json_append(&corners, position_document(facts, row, level_ground_range(facts, range)));
    }
    return corners;
}

static json_t *pings_document(const struct ping_list *list)
{
    json_t *numbers = json_array();
    for (uint64_t i = 0; i < list->count; i++)
        json_append(&numbers, json_count(list->numbers[i]));
    return numbers;
}

json_t *truth_document(const struct run_facts *facts)
{
    const struct region *patch = &facts->swath->patch;
    json_t *place = JSON_OBJECT(
        {"row", json_count(patch->first_row)}, {"column", json_count(patch->first_column)},
        JSON_COUNT(patch, rows), JSON_COUNT(patch, columns), {"corners", corners_document(facts)},
        {"empty_rows", pings_document(&facts->swath->empty)},
        {"skipped_pings", pings_document(&facts->swath->skipped)});
    json_t *objects = json_array();
    for (uint32_t i = 0; i < facts->result->object_count; i++)
        json_append(&objects, object_document(facts, i));
    json_t *document =
        JSON_OBJECT({"image", json_text(facts->image_name)}, {"range_axis", json_string("slant")},
                    {"range_grows",
                     json_string(geometry_is_reversed(&facts->scene->geometry) ? "left" : "right")},
                    {"patch", place}, JSON_NUMBER(&facts->result->statistics, energy_error),
                    {"blending", blending_document(&facts->result->statistics)},
                    {"numbers", sources_document(facts->scene, &facts->result->statistics)},
                    {"objects", objects});
    if (facts->jpeg_quality > 0)
        json_add(&document, "jpeg_quality", json_integer(facts->jpeg_quality));
    return document;
}

sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path)
{
    return json_document_write(report, SONJECT_OK, truth_document(facts), TRUTH_DIGITS, path);
}

static json_t *options_document(const struct scene *scene, const sonject_statistics *statistics)
{
    const sonject_injection_params *injection = &scene->injection;
    const bool resynthesises = injection->mode == SONJECT_MODE_RESYNTHESISE;
    const bool matches_response = injection->match_response == SONJECT_MATCH_IMAGE;
    const bool matches_saturation = injection->match_saturation == SONJECT_MATCH_IMAGE;
    const bool is_brute = injection->estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    return JSON_OBJECT(
        {"mode", json_string(resynthesises ? "resynthesise" : "composite")},
        {"columns",
         json_string(scene->injection.column_rule == SONJECT_COLUMNS_PAPER ? "paper" : "focused")},
        JSON_NUMBER(statistics, ray_scale), JSON_NUMBER(injection, influence_db),
        {"match_response", json_string(matches_response ? "image" : "nominal")},
        {"match_looks", injection->match_looks == 0.0 ? json_string("image")
                                                      : json_number(injection->match_looks)},
        {"match_saturation", json_string(matches_saturation ? "image" : "full_scale")},
        {"seabed_lambert_db", json_number(10.0 * log10(statistics->seabed_lambert))},
        JSON_COUNT(injection, interactions),
        {"estimator", json_string(is_brute ? "brute_force" : "connect")});
}

/* Returns the names of all bands of the scene's file. */
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

static const struct {
    const char *name;
    uint32_t format;
} label_names[] = {{"yolo", SONJECT_LABELS_YOLO}, {"voc", SONJECT_LABELS_VOC}};

static json_t *labels_document(uint32_t formats)
{
    json_t *names = json_array();
    for (size_t i = 0; i < COUNT(label_names); i++)
        if (formats & label_names[i].format)
            json_append(&names, json_string(label_names[i].name));
    return names;
}

uint32_t labels_of_document(const json_t *run)
{
    size_t i;
    const json_t *name;
    uint32_t formats = 0;
    json_array_foreach(json_object_get(run, "labels"), i, name)
    {
        for (size_t k = 0; json_is_string(name) && k < COUNT(label_names); k++)
            if (strcmp(json_string_value(name), label_names[k].name) == 0)
                formats |= label_names[k].format;
    }
    return formats;
}

sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path)
{
    const sonject_statistics *statistics = &facts->result->statistics;
    json_t *times = JSON_OBJECT(
        {"read", json_number(facts->read_s)}, {"trace", json_number(statistics->trace_s)},
        {"form", json_number(statistics->form_s)}, {"inject", json_number(statistics->inject_s)},
        {"write", json_number(facts->write_s)}, {"total", json_number(facts->total_s)});
    const bool resynthesises = facts->scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    json_t *comparison = resynthesises ? JSON_OBJECT(JSON_NUMBER(statistics, level_change_db),
                                                     JSON_NUMBER(statistics, input_contrast),
                                                     JSON_NUMBER(statistics, output_contrast),
                                                     JSON_NUMBER(statistics, histogram_distance),
                                                     JSON_NUMBER(statistics, correlation))
                                       : json_null();
    const char *band = facts->scene->band;
    json_t *document = JSON_OBJECT(
        {"sonject", json_string(sonject_version())}, {"scene_hash", json_string(facts->scene_hash)},
        {"seed", json_seed(facts->scene->injection.seed)},
        {"device", device_document(facts->device)},
        {"options", options_document(facts->scene, statistics)},
        {"band", band ? json_text(band) : json_null()},
        {"bands", band ? bands_document(facts->scene) : json_null()},
        {"image", json_text(facts->image_name)}, {"labels", labels_document(facts->label_formats)},
        {"times_s", times}, JSON_COUNT(statistics, pings), JSON_COUNT(statistics, rays),
        JSON_COUNT(statistics, ray_queries), JSON_COUNT(statistics, impulses),
        {"peak_memory_bytes", json_count(peak_memory_bytes())},
        JSON_NUMBER(statistics, noise_floor_db), {"blending", blending_document(statistics)},
        {"numbers", sources_document(facts->scene, statistics)},
        {"input_clipped_pixels", json_count(statistics->input_clipped)},
        {"output_clipped_pixels", json_count(statistics->output_clipped)},
        JSON_COUNT(statistics, changed_pixels), {"seabed_comparison", comparison});
    if (!band) {
        json_object_del(document, "band");
        json_object_del(document, "bands");
    }
    const sonject_status status =
        earlier_describe(report, &document, facts->inputs, facts->files, facts->scene);
    return json_document_write(report, status, document, 12, path);
}
