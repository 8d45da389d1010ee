#define _POSIX_C_SOURCE 200809L
#include "api/documents.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <jansson.h>

#include <sonject/version.h>

#include "base/file.h"

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *count(uint64_t value)
{
    return json_integer((json_int_t)value);
}

/* Adds a member; jansson itself frees a value that cannot be added, and a document that lacks
 * something fails when it is written. */
static void add(json_t *object, const char *key, json_t *value)
{
    json_object_set_new(object, key, value);
}

static sonject_status write_document(struct report *report, json_t *document, const char *path)
{
    char *text = json_dumps(document, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(document);
    if (!text)
        return report_out_of_memory(report, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}

/* Boxes of truth files count swath pixels, and say where they lie in metres. */
static json_t *box_document(const struct run_facts *facts, const sonject_box *box)
{
    if (box->rows == 0)
        return json_null();
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const uint64_t row = facts->swath->patch.first_row + box->first_row;
    const uint64_t column = facts->swath->patch.first_column + box->first_column;
    json_t *document = json_object();
    add(document, "row", count(row));
    add(document, "column", count(column));
    add(document, "rows", count(box->rows));
    add(document, "columns", count(box->columns));
    add(document, "along_track_m",
        number(geometry->first_along_track_m + ((double)row - 0.5) * geometry->row_spacing_m));
    add(document, "slant_range_m",
        number(geometry->first_slant_range_m +
               ((double)column - 0.5) * geometry->column_spacing_m));
    add(document, "length_m", number((double)box->rows * geometry->row_spacing_m));
    add(document, "width_m", number((double)box->columns * geometry->column_spacing_m));
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
    add(document, "set_by", json_string(kinds[truth->level_kind]));
    add(document, "asked_db", is_physical ? json_null() : number(object->level_db));
    add(document, "gain_db", number(truth->level_gain_db));
    add(document, "over_seabed_db", number(truth->over_seabed_db));
    add(document, "seabed_strength_db", number(truth->seabed_strength_db));
    return document;
}

static json_t *object_document(const struct run_facts *facts, uint32_t index)
{
    const sonject_object_params *object = &facts->scene->objects[index];
    const sonject_object_truth *truth = &facts->result->objects[index];
    json_t *pose = json_object();
    add(pose, "heading_deg", number(object->heading_rad * DEGREES_PER_RADIAN));
    add(pose, "pitch_deg", number(object->pitch_rad * DEGREES_PER_RADIAN));
    add(pose, "roll_deg", number(object->roll_rad * DEGREES_PER_RADIAN));
    json_t *document = json_object();
    add(document, "id", count(index + 1));
    add(document, "name", json_string(object->name));
    add(document, "class", json_string(object->class_name));
    add(document, "shape", json_string(shape_name(object->shape)));
    add(document, "length_m", number(object->length_m));
    add(document, "width_m", number(object->width_m));
    add(document, "diameter_m", number(object->diameter_m));
    add(document, "body_height_m", number(object->height_m));
    add(document, "top_diameter_m", number(object->top_diameter_m));
    add(document, "front_height_m", number(object->front_height_m));
    add(document, "cuts", count(object->cut_count));
    add(document, "pose", pose);
    add(document, "burial_m", number(truth->burial_m));
    add(document, "along_track_m", number(truth->along_track_m));
    add(document, "slant_range_m", number(truth->slant_range_m));
    add(document, "ground_range_m", number(truth->ground_range_m));
    add(document, "height_m", number(truth->height_m));
    add(document, "grazing_deg", number(truth->grazing_rad * DEGREES_PER_RADIAN));
    add(document, "transmission_loss_db", number(truth->transmission_loss_db));
    add(document, "row", number(truth->row + (double)facts->swath->patch.first_row));
    add(document, "column", number(truth->column + (double)facts->swath->patch.first_column));
    add(document, "visible", json_boolean(truth->is_visible));
    add(document, "highlight_cut", json_boolean(truth->highlight_is_cut));
    add(document, "shadow_cut", json_boolean(truth->shadow_is_cut));
    add(document, "highlight", box_document(facts, &truth->highlight));
    add(document, "shadow", box_document(facts, &truth->shadow));
    add(document, "box", box_document(facts, &truth->both));
    add(document, "highlight_pixels", count(truth->highlight_pixels));
    add(document, "shadow_pixels", count(truth->shadow_pixels));
    add(document, "target_strength_db", number(truth->target_strength_db));
    add(document, "highlight_contrast_db", number(truth->highlight_contrast_db));
    add(document, "shadow_contrast_db", number(truth->shadow_contrast_db));
    add(document, "level", level_document(facts, index));
    return document;
}

/* The measured image around the objects, and what was put in with it. */
static json_t *blending_document(const sonject_statistics *statistics)
{
    const bool has_texture = isfinite(statistics->seabed_shape);
    json_t *seabed = json_object();
    add(seabed, "amplitude_contrast", number(statistics->seabed_amplitude_contrast));
    add(seabed, "looks", number(statistics->seabed_looks));
    add(seabed, "k_shape", has_texture ? number(statistics->seabed_shape) : json_null());
    add(seabed, "row_correlation", number(statistics->seabed_row_correlation));
    add(seabed, "column_correlation", number(statistics->seabed_column_correlation));
    json_t *document = json_object();
    add(document, "seabed_estimated", seabed);
    add(document, "along_track_resolution_m", number(statistics->along_track_resolution_m));
    add(document, "range_resolution_m", number(statistics->range_resolution_m));
    add(document, "looks", number(statistics->looks));
    add(document, "noise_floor_db", number(statistics->noise_floor_db));
    add(document, "saturation_amplitude", number(statistics->saturation_amplitude));
    return document;
}

sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path)
{
    json_t *patch = json_object();
    add(patch, "row", count(facts->swath->patch.first_row));
    add(patch, "column", count(facts->swath->patch.first_column));
    add(patch, "rows", count(facts->swath->patch.rows));
    add(patch, "columns", count(facts->swath->patch.columns));
    json_t *objects = json_array();
    for (uint32_t i = 0; i < facts->result->object_count; i++)
        json_array_append_new(objects, object_document(facts, i));
    json_t *document = json_object();
    add(document, "image", json_string(facts->image_name));
    add(document, "range_axis", json_string("slant"));
    add(document, "patch", patch);
    add(document, "blending", blending_document(&facts->result->statistics));
    add(document, "objects", objects);
    return write_document(report, document, path);
}

/* The number of the object's class among the classes in order of first use, from 1. */
static uint32_t category_of(const struct scene *scene, uint32_t index)
{
    uint32_t category = 0;
    for (uint32_t i = 0; i <= index; i++) {
        uint32_t first = 0;
        while (strcmp(scene->objects[first].class_name, scene->objects[i].class_name) != 0)
            first++;
        category += first == i;
        if (i < index &&
            strcmp(scene->objects[i].class_name, scene->objects[index].class_name) == 0)
            return category;
    }
    return category;
}

static json_t *coco_annotation(const struct run_facts *facts, uint32_t index)
{
    const sonject_object_truth *truth = &facts->result->objects[index];
    const struct region *patch = &facts->swath->patch;
    json_t *box = json_array();
    json_array_append_new(box, count(patch->first_column + truth->both.first_column));
    json_array_append_new(box, count(patch->first_row + truth->both.first_row));
    json_array_append_new(box, count(truth->both.columns));
    json_array_append_new(box, count(truth->both.rows));
    json_t *annotation = json_object();
    add(annotation, "id", count(index + 1));
    add(annotation, "image_id", count(1));
    add(annotation, "category_id", count(category_of(facts->scene, index)));
    add(annotation, "bbox", box);
    add(annotation, "area", count(truth->highlight_pixels + truth->shadow_pixels));
    add(annotation, "segmentation", json_array());
    add(annotation, "iscrowd", count(0));
    return annotation;
}

sonject_status write_coco(struct report *report, const struct run_facts *facts, const char *path)
{
    const struct scene *scene = facts->scene;
    json_t *image = json_object();
    add(image, "id", count(1));
    add(image, "file_name", json_string(facts->image_name));
    add(image, "width", count(facts->swath->layout.columns));
    add(image, "height", count(facts->swath->layout.rows));
    json_t *images = json_array();
    json_array_append_new(images, image);
    json_t *annotations = json_array();
    json_t *categories = json_array();
    uint32_t known = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const uint32_t category = category_of(scene, i);
        if (category > known) {
            json_t *entry = json_object();
            known = category;
            add(entry, "id", count(category));
            add(entry, "name", json_string(scene->objects[i].class_name));
            json_array_append_new(categories, entry);
        }
        if (facts->result->objects[i].is_visible)
            json_array_append_new(annotations, coco_annotation(facts, i));
    }
    json_t *document = json_object();
    add(document, "images", images);
    add(document, "annotations", annotations);
    add(document, "categories", categories);
    return write_document(report, document, path);
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
    add(document, "read", number(facts->read_s));
    add(document, "trace", number(statistics->trace_s));
    add(document, "form", number(statistics->form_s));
    add(document, "inject", number(statistics->inject_s));
    add(document, "write", number(facts->write_s));
    add(document, "total", number(facts->total_s));
    return document;
}

static json_t *options_document(const struct scene *scene)
{
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    json_t *document = json_object();
    add(document, "mode", json_string(resynthesises ? "resynthesise" : "composite"));
    add(document, "columns",
        json_string(scene->injection.column_rule == SONJECT_COLUMNS_PAPER ? "paper" : "focused"));
    add(document, "ray_scale", number(scene->injection.ray_scale));
    add(document, "influence_db", number(scene->injection.influence_db));
    add(document, "match_response",
        json_string(scene->injection.match_response == SONJECT_MATCH_IMAGE ? "image" : "nominal"));
    add(document, "match_looks",
        scene->injection.match_looks == 0.0 ? json_string("image")
                                            : number(scene->injection.match_looks));
    add(document, "match_saturation",
        json_string(scene->injection.match_saturation == SONJECT_MATCH_IMAGE ? "image"
                                                                             : "full_scale"));
    add(document, "seabed_lambert_db", number(10.0 * log10(scene->seabed.lambert)));
    add(document, "interactions", count(scene->injection.interactions));
    add(document, "estimator",
        json_string(scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE ? "brute_force"
                                                                                : "connect"));
    return document;
}

static json_t *comparison_document(const sonject_statistics *statistics)
{
    json_t *document = json_object();
    add(document, "level_change_db", number(statistics->level_change_db));
    add(document, "input_contrast", number(statistics->input_contrast));
    add(document, "output_contrast", number(statistics->output_contrast));
    add(document, "histogram_distance", number(statistics->histogram_distance));
    add(document, "correlation", number(statistics->correlation));
    return document;
}

/* JSON's readers take integers of 63 bits at the most; larger seeds are written as text. */
static json_t *seed_document(uint64_t seed)
{
    char text[24];
    if (seed <= (uint64_t)INT64_MAX)
        return count(seed);
    snprintf(text, sizeof text, "%llu", (unsigned long long)seed);
    return json_string(text);
}

sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path)
{
    const sonject_statistics *statistics = &facts->result->statistics;
    json_t *device = json_object();
    add(device, "name", json_string(facts->device->name));
    add(device, "platform", json_string(facts->device->platform));
    add(device, "driver", json_string(facts->device->driver));
    add(device, "width", count(facts->device->width));
    json_t *document = json_object();
    add(document, "sonject", json_string(sonject_version()));
    add(document, "scene_hash", json_string(facts->scene_hash));
    add(document, "seed", seed_document(facts->scene->injection.seed));
    add(document, "device", device);
    add(document, "options", options_document(facts->scene));
    add(document, "image", json_string(facts->image_name));
    add(document, "image_is_lossless", json_boolean(facts->swath->is_lossless));
    add(document, "times_s", times_document(facts));
    add(document, "pings", count(statistics->pings));
    add(document, "rays", count(statistics->rays));
    add(document, "ray_queries", count(statistics->ray_queries));
    add(document, "impulses", count(statistics->impulses));
    add(document, "peak_memory_bytes", count(peak_memory()));
    add(document, "noise_floor_db", number(statistics->noise_floor_db));
    add(document, "blending", blending_document(statistics));
    add(document, "input_clipped_pixels", count(statistics->input_clipped));
    add(document, "output_clipped_pixels", count(statistics->output_clipped));
    add(document, "changed_pixels", count(statistics->changed_pixels));
    add(document, "seabed_comparison",
        facts->scene->injection.mode == SONJECT_MODE_RESYNTHESISE ? comparison_document(statistics)
                                                                  : json_null());
    return write_document(report, document, path);
}

bool run_is_finished(const char *path, const char *scene_hash)
{
    struct report ignored = {{0}, NULL, NULL};
    char *text = NULL;
    size_t bytes = 0;
    if (!file_exists(path) ||
        file_read_whole(&ignored, path, (size_t)1 << 20, &text, &bytes) != SONJECT_OK)
        return false;
    json_t *document = json_loads(text, 0, NULL);
    const char *hash = json_string_value(json_object_get(document, "scene_hash"));
    const bool is_same = hash && strcmp(hash, scene_hash) == 0;
    json_decref(document);
    free(text);
    return is_same;
}
