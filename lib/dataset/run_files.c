#include "dataset/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/run.h>
#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/system/process.h"
#include "base/units.h"
#include "dataset/labels.h"
#include "image/plot.h"
#include "swath/geometry_notes.h"
#include "swath/image_head.h"
#include "swath/raster_file.h"

#define QUICKLOOK        "quicklook.png"
#define QUICKLOOK_PANELS 3

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

/* How the echo's level came about, and against which seabed. */
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
    if (!track_place(track, row, ground_range_m, facts->scene->geometry.side == SONJECT_SIDE_PORT,
                     &place))
        return json_null();
    return JSON_OBJECT(
        {track->is_geographic ? "longitude_deg" : "easting_m", json_number(place.x)},
        {track->is_geographic ? "latitude_deg" : "northing_m", json_number(place.y)});
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
        JSON_NUMBER(object, top_diameter_m), JSON_NUMBER(object, front_height_m),
        {"cuts", json_count(object->cut_count)}, {"pose", pose}, JSON_NUMBER(truth, burial_m),
        JSON_NUMBER(truth, along_track_m), JSON_NUMBER(truth, slant_range_m),
        JSON_NUMBER(truth, ground_range_m), JSON_NUMBER(truth, height_m),
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

/* The measured image around the objects, and what was put in with it. */
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

/* Where the patch's corners lie on the map: first row near and far, last row far and near; null
 * where that is not known. */
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
    return json_document_write(report, truth_document(facts), TRUTH_DIGITS, path);
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
    if (status == SONJECT_OK)
        return json_document_write(report, document, 12, path);
    json_decref(document);
    return status;
}

static sonject_status write_mask(struct report *report, const struct swath *swath,
                                 const uint8_t *mask, const uint8_t *palette, const char *path)
{
    const struct raster_layout layout = {swath->layout.rows, swath->layout.columns, 1, PIXEL_UINT8};
    return raster_file_write_placed(report, path, &layout, &swath->patch, mask, palette);
}

/* The numbers of objects, each in a colour of its own: 0 is black; neighbours lie a golden angle
 * apart on the wheel of six sectors of colours. */
static sonject_status write_label_mask(struct report *report, const struct swath *swath,
                                       const uint8_t *labels, const char *path)
{
    static const uint8_t order[6][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1},
                                        {2, 1, 0}, {1, 2, 0}, {0, 2, 1}};
    uint8_t palette[PNG_PALETTE_BYTES] = {0, 0, 0};
    for (unsigned number = 1; number < 256; number++) {
        const unsigned hue = number * 949 % 1536;
        const uint8_t rising = (uint8_t)(hue % 256);
        const uint8_t parts[3] = {255, (uint8_t)(hue / 256 % 2 ? 255 - rising : rising), 64};
        for (int i = 0; i < 3; i++)
            palette[3 * number + (unsigned)i] = parts[order[hue / 256][i]];
    }
    return write_mask(report, swath, labels, palette, path);
}

static sonject_status write_float_layer(struct report *report, const struct run_facts *facts,
                                        uint32_t channels, const float *pixels, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    const struct region *patch = &facts->swath->patch;
    const struct raster_layout layout = {patch->rows, patch->columns, channels, PIXEL_FLOAT32};
    struct geometry_notes notes;
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX + 2];
    const sonject_geometry_params geometry =
        geometry_crop(&facts->scene->geometry, (double)patch->first_row,
                      (double)patch->first_column, (double)patch->columns);
    geometry_notes_init(&notes, &facts->scene->sonar, &geometry);
    memcpy(attributes, notes.attributes, sizeof notes.attributes);
    attributes[notes.count] = (struct raster_attribute){"sonject:phase_sign", "exp(+i 2 pi f t)"};
    attributes[notes.count + 1] = (struct raster_attribute){
        "sonject:normalisation",
        channels == 2 ? "target_strength, |pixel|^2 in m^2" : "target_strength, pixel in m^2"};
    return raster_file_write(report, path, &layout, channels == 2 ? complex_names : NULL,
                             attributes, notes.count + 2, pixels);
}

static sonject_status write_plane(struct report *report, const struct run_facts *facts,
                                  enum injected_plane plane, const char *path)
{
    const struct injection_result *result = facts->result;
    const uint32_t channels = plane == INJECTED_FIELD ? 2 : 1;
    float *pixels = allocate_array(result->rows, result->columns * channels * sizeof *pixels);
    CHECK_MEMORY(report, pixels, "a layer");
    injection_result_plane(result, plane, pixels);
    const sonject_status status = write_float_layer(report, facts, channels, pixels, path);
    free(pixels);
    return status;
}

static void amplitude_of(const float *pixels, size_t count, bool is_complex, float *amplitude)
{
    for (size_t i = 0; i < count; i++)
        amplitude[i] = is_complex ? hypotf(pixels[2 * i], pixels[2 * i + 1]) : pixels[i];
}

/* What the page needs to show each panel by itself, and to tell what a pixel of it is. */
static json_t *quicklook_document(const struct plot_frame *frame, const struct plot_place *places,
                                  uint32_t height, uint32_t width)
{
    json_t *panels = json_array();
    for (int i = 0; i < QUICKLOOK_PANELS; i++)
        json_append(&panels,
                    JSON_OBJECT(JSON_COUNT(places + i, left), JSON_COUNT(places + i, top),
                                JSON_COUNT(places + i, width), JSON_COUNT(places + i, height)));
    return JSON_OBJECT({"height", json_count(height)}, {"width", json_count(width)},
                       {"panels", panels}, JSON_NUMBER(frame, first_along_track_m),
                       JSON_NUMBER(frame, row_spacing_m), JSON_NUMBER(frame, first_range_m),
                       JSON_NUMBER(frame, column_spacing_m));
}

/* Amplitudes before and after, and 20 log10 of their ratio, 0 where nothing changed. */
static sonject_status write_quicklook(struct report *report, struct run_facts *facts,
                                      const char *path)
{
    const struct injection_result *result = facts->result;
    const size_t count = result->rows * result->columns;
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const struct region *patch = &facts->swath->patch;
    float *before = allocate_array(count, 3 * sizeof *before);
    CHECK_MEMORY(report, before, "the quicklook");
    float *after = before + count;
    float *difference = after + count;
    amplitude_of(facts->swath->pixels, count, result->is_complex, before);
    amplitude_of(result->image, count, result->is_complex, after);
    for (size_t i = 0; i < count; i++)
        difference[i] = result->influence[i] && before[i] > 0.0f && after[i] > 0.0f
                            ? 20.0f * log10f(after[i] / before[i])
                            : 0.0f;
    const struct plot_panel panels[QUICKLOOK_PANELS] = {
        {"before", before, false}, {"after", after, false}, {"difference, dB", difference, true}};
    const struct plot_frame frame = {
        .rows = patch->rows,
        .columns = patch->columns,
        .first_along_track_m =
            geometry->first_along_track_m + (double)patch->first_row * geometry->row_spacing_m,
        .row_spacing_m = geometry->row_spacing_m,
        .first_range_m = geometry_range(geometry, (double)patch->first_column),
        .column_spacing_m = geometry_is_reversed(geometry) ? -geometry->column_spacing_m
                                                           : geometry->column_spacing_m,
        .range_label = "slant range, m",
        .difference_db = 20.0};
    uint8_t *picture = NULL;
    uint32_t height, width;
    struct plot_place places[QUICKLOOK_PANELS];
    sonject_status status =
        plot_panels(report, &frame, panels, QUICKLOOK_PANELS, &picture, &height, &width, places);
    if (status == SONJECT_OK) {
        const struct raster_layout layout = {height, width, 3, PIXEL_UINT8};
        status = raster_file_write(report, path, &layout, NULL, NULL, 0, picture);
        json_add(&facts->page, "quicklook", quicklook_document(&frame, places, height, width));
    }
    free(picture);
    free(before);
    return status;
}

sonject_status write_layer(struct report *report, const struct run_facts *facts, enum layer layer,
                           const char *path)
{
    const struct injection_result *result = facts->result;
    switch (layer) {
    case LAYER_FIELD:
        return write_plane(report, facts, INJECTED_FIELD, path);
    case LAYER_ENERGY:
        return write_plane(report, facts, INJECTED_ENERGY, path);
    case LAYER_HIGHLIGHT:
        return write_mask(report, facts->swath, result->highlight, NULL, path);
    case LAYER_SHADOW:
        return write_mask(report, facts->swath, result->shadow, NULL, path);
    case LAYER_LABELS:
        return write_label_mask(report, facts->swath, result->labels, path);
    default:
        return write_mask(report, facts->swath, result->influence, NULL, path);
    }
}

/* An order's energy, summed over the patch, and that of its brightest pixel. */
static json_t *order_document(const struct injection_result *result, uint32_t order)
{
    const size_t count = result->rows * result->columns;
    float *pixels = allocate_array(count, sizeof *pixels);
    double sum = 0.0, most = 0.0;
    if (!pixels)
        return NULL;
    injection_result_plane(result, INJECTED_ORDER + order - 1, pixels);
    for (size_t i = 0; i < count; i++) {
        sum += (double)pixels[i];
        most = fmax(most, (double)pixels[i]);
    }
    free(pixels);
    return JSON_OBJECT({"sum_m2", json_number(sum)}, {"brightest_m2", json_number(most)});
}

/* Orders that this result has not may be there from a run before. */
sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder)
{
    static const char *const names[LAYERS] = {"patch.tif",  "energy.tif", "highlight.png",
                                              "shadow.png", "labels.png", "influence.png"};
    char name[32], path[PATH_CAPACITY];
    for (int layer = 0; layer < LAYERS; layer++) {
        CHECK(path_in(report, path, folder, "%s", names[layer]));
        CHECK(write_layer(report, facts, (enum layer)layer, path));
        CHECK(file_list_add(&facts->files, report, folder, names[layer], true));
    }
    CHECK(path_in(report, path, folder, QUICKLOOK));
    CHECK(write_quicklook(report, facts, path));
    CHECK(file_list_add(&facts->files, report, folder, QUICKLOOK, true));
    for (uint32_t order = 1; order <= SCENE_INTERACTIONS_MAX; order++) {
        snprintf(name, sizeof name, "energy_order_%u.tif", (unsigned)order);
        CHECK(path_in(report, path, folder, "%s", name));
        if (order > facts->result->orders) {
            file_discard(path);
            continue;
        }
        CHECK(write_plane(report, facts, INJECTED_ORDER + order - 1, path));
        json_add(&facts->page, name, order_document(facts->result, order));
        CHECK(file_list_add(&facts->files, report, folder, name, true));
    }
    return SONJECT_OK;
}

static const struct {
    const char *name;
    uint32_t format; /* that it belongs to; 0: always written */
} label_files[LABEL_FILES] = {
    {"coco.json", 0},
    {"contacts.csv", 0},
    {"image.txt", SONJECT_LABELS_YOLO},
    {"classes.txt", SONJECT_LABELS_YOLO},
    {"image.xml", SONJECT_LABELS_VOC},
};

sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder)
{
    const struct swath *swath = facts->swath;
    const struct label_request request = {
        facts->scene,          facts->result, facts->image_name, swath->layout.rows,
        swath->layout.columns, swath->patch,  &swath->track};
    struct image_labels labels;
    struct class_names classes = {NULL, 0};
    char path[PATH_CAPACITY];
    sonject_status status = image_labels_find(&labels, report, &request, &classes);
    for (int file = 0; status == SONJECT_OK && file < LABEL_FILES; file++) {
        const uint32_t format = label_files[file].format;
        status = path_in(report, path, folder, "%s", label_files[file].name);
        if (status == SONJECT_OK && format && !(format & facts->label_formats)) {
            file_discard(path);
            continue;
        }
        THEN(status, labels_write(report, &labels, &classes, (enum label_file)file, path));
        THEN(status, file_list_add(&facts->files, report, folder, label_files[file].name, true));
    }
    class_names_clear(&classes);
    image_labels_clear(&labels);
    return status;
}
