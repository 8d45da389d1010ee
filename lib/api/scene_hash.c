#include "api/scene_hash.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sonject/version.h>

#include "base/json_document.h"
#include "cl/sources.h"
#include "inject/impulse_file.h"

/* Members one by one: the padding of a structure is not part of its value. */
#define ADD(hash, member) hash_add(hash, &(member), sizeof(member))

/* A digest in the making: of a section of the scene's keys, and of all sections. */
struct digest {
    struct hash *section, *whole;
    json_t **inputs; /* that get each section's; NULL: they are not asked for */
};

static void end_section(struct digest *digest, const char *name)
{
    char text[HASH_TEXT_CAPACITY];
    hash_restart(digest->section, text);
    hash_add_text(digest->whole, text);
    if (digest->inputs)
        json_add(digest->inputs, name, json_string(text));
}

static void add_material(struct hash *hash, const sonject_material_params *material)
{
    /* NaN has many patterns and one meaning: the seabed's own, what the sea surface's lambert
     * leaves
     */
    const double lambert = isnan(material->lambert) ? -1.0 : material->lambert;
    const double glossy_albedo = isnan(material->glossy_albedo) ? -1.0 : material->glossy_albedo;
    ADD(hash, material->reflection_kind);
    ADD(hash, material->reflection);
    ADD(hash, material->roughness_m);
    ADD(hash, lambert);
    ADD(hash, material->lambert_exponent);
    ADD(hash, glossy_albedo);
    ADD(hash, material->glossy_slope);
    ADD(hash, material->density_ratio);
    ADD(hash, material->speed_ratio);
    ADD(hash, material->loss);
}

static void add_water_layers(struct hash *hash, const struct scene *scene)
{
    const uint64_t count = scene->water_layer_count;
    ADD(hash, count);
    for (size_t i = 0; i < scene->water_layer_count; i++) {
        ADD(hash, scene->water_layers[i].bottom_m);
        ADD(hash, scene->water_layers[i].speed_mps);
        ADD(hash, scene->water_layers[i].density);
    }
}

static void add_sonar(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    const sonject_sonar_params *sonar = &scene->sonar;
    ADD(hash, sonar->response_window);
    ADD(hash, sonar->centre_frequency_hz);
    ADD(hash, sonar->bandwidth_hz);
    ADD(hash, sonar->altitude_m);
    ADD(hash, sonar->along_track_resolution_m);
    ADD(hash, sonar->transducer_side_m);
    ADD(hash, sonar->taylor_sidelobe_db);
    ADD(hash, sonar->taylor_terms);
    ADD(hash, sonar->kind);
    ADD(hash, sonar->aperture_rad);
    ADD(hash, sonar->array_length_m);
    ADD(hash, sonar->array_height_m);
    ADD(hash, sonar->array_heading_rad);
    ADD(hash, sonar->array_pitch_rad);
    ADD(hash, sonar->array_depression_rad);
    end_section(digest, "sonar");
}

static void add_response_table(struct hash *hash, const struct response_table *table)
{
    const uint64_t count = table->count;
    ADD(hash, count);
    ADD(hash, table->is_time);
    hash_add(hash, table->positions, table->count * sizeof *table->positions);
    hash_add(hash, table->values, table->count * sizeof *table->values);
}

static void add_motion_table(struct hash *hash, const struct motion_table *table)
{
    const uint64_t count = table->count;
    ADD(hash, count);
    hash_add(hash, table->along_track_m, table->count * sizeof *table->along_track_m);
    hash_add(hash, table->values, table->count * sizeof *table->values);
}

/* Only where there is some: scenes that know of none keep their hashes. */
static void add_yaw(struct hash *hash, const struct aperture_motion *motion)
{
    const sonject_motion_params *params = &motion->params;
    if (!aperture_motion_has_yaw(motion))
        return;
    ADD(hash, params->yaw_advance_m);
    ADD(hash, params->yaw_bias_rad);
    ADD(hash, params->yaw_random_rms_rad);
    ADD(hash, params->yaw_random_correlation_m);
    ADD(hash, params->yaw_seed);
    ADD(hash, params->yaw_count);
    for (uint32_t i = 0; i < params->yaw_count && i < SONJECT_YAWS_CAPACITY; i++) {
        ADD(hash, params->yaws[i].amplitude_rad);
        ADD(hash, params->yaws[i].wavelength_m);
        ADD(hash, params->yaws[i].phase_rad);
    }
    add_motion_table(hash, &motion->yaw_table);
}

static void add_motion(struct hash *hash, const struct aperture_motion *motion)
{
    const sonject_motion_params *params = &motion->params;
    ADD(hash, params->sway_count);
    for (uint32_t i = 0; i < params->sway_count && i < SONJECT_SWAYS_CAPACITY; i++) {
        ADD(hash, params->sways[i].amplitude_m);
        ADD(hash, params->sways[i].wavelength_m);
        ADD(hash, params->sways[i].phase_rad);
    }
    ADD(hash, params->random_rms_m);
    ADD(hash, params->random_correlation_m);
    ADD(hash, params->seed);
    add_motion_table(hash, &motion->sway_table);
    add_yaw(hash, motion);
}

static void add_responses(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    ADD(hash, scene->pulse.kind);
    ADD(hash, scene->pulse.window);
    ADD(hash, scene->pulse.taylor_terms);
    ADD(hash, scene->pulse.taylor_sidelobe_db);
    add_response_table(hash, &scene->pulse_table);
    end_section(digest, "sonar.pulse");
    add_response_table(hash, &scene->cross_range_table);
    end_section(digest, "sonar.measured_response");
    add_motion(hash, &scene->motion);
    end_section(digest, "sonar.motion");
}

/* Only where there is some: scenes that know of none keep their hashes. */
static void add_relief(struct hash *hash, const struct relief_features *relief)
{
    for (uint32_t i = 0; i < relief->count; i++) {
        const struct relief_feature *feature = &relief->features[i];
        ADD(hash, feature->kind);
        ADD(hash, feature->height_m);
        ADD(hash, feature->wavelength_m);
        ADD(hash, feature->heading_rad);
        ADD(hash, feature->phase_rad);
        ADD(hash, feature->sharpness);
        ADD(hash, feature->irregularity);
        ADD(hash, feature->seed);
        ADD(hash, feature->radius_m);
        ADD(hash, feature->width_m);
        ADD(hash, feature->position_kind);
        ADD(hash, feature->position_along);
        ADD(hash, feature->position_range);
        hash_add_text(hash, feature->object);
    }
    if (!relief->heights_m)
        return;
    ADD(hash, relief->grid.rows);
    ADD(hash, relief->grid.columns);
    ADD(hash, relief->grid.first_along_track_m);
    ADD(hash, relief->grid.first_ground_range_m);
    ADD(hash, relief->grid.row_spacing_m);
    ADD(hash, relief->grid.column_spacing_m);
    hash_add(hash, relief->heights_m,
             (size_t)relief->grid.rows * relief->grid.columns * sizeof *relief->heights_m);
}

static void add_sea(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    ADD(hash, scene->medium.sound_speed_mps);
    ADD(hash, scene->medium.reference_sound_speed_mps);
    ADD(hash, scene->medium.absorption_db_per_m);
    add_water_layers(hash, scene);
    end_section(digest, "medium");
    ADD(hash, scene->seabed.map);
    ADD(hash, scene->seabed.lambert);
    ADD(hash, scene->seabed.level_radius_m);
    ADD(hash, scene->seabed.despeckle_radius_m);
    ADD(hash, scene->seabed.forward_rule);
    add_material(hash, &scene->seabed.forward);
    end_section(digest, "seabed");
    add_relief(hash, &scene->relief);
    end_section(digest, "seabed.relief");
    ADD(hash, scene->surface.water_depth_m);
    add_material(hash, &scene->surface.material);
    end_section(digest, "surface");
}

static void add_image(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    const sonject_geometry_params *geometry = &scene->geometry;
    ADD(hash, geometry->side);
    ADD(hash, geometry->row_spacing_m);
    ADD(hash, geometry->column_spacing_m);
    ADD(hash, geometry->first_along_track_m);
    ADD(hash, geometry->first_slant_range_m);
    end_section(digest, "input.geometry");
    ADD(hash, scene->transfer.kind);
    ADD(hash, scene->transfer.parameter);
    ADD(hash, scene->transfer.offset);
    ADD(hash, scene->transfer.full_scale);
    end_section(digest, "input.transfer");
    ADD(hash, scene->patch.first_row);
    ADD(hash, scene->patch.first_column);
    ADD(hash, scene->patch.rows);
    ADD(hash, scene->patch.columns);
    end_section(digest, "patch");
    ADD(hash, scene->input_kind);
    ADD(hash, scene->input_is_complex);
    ADD(hash, scene->channel);
    hash_add_text(hash, scene->array ? scene->array : "");
    end_section(digest, "input");
}

static void add_object(struct hash *hash, const sonject_object_params *object)
{
    ADD(hash, object->shape);
    hash_add_text(hash, object->name);
    hash_add_text(hash, object->class_name);
    ADD(hash, object->length_m);
    ADD(hash, object->width_m);
    ADD(hash, object->diameter_m);
    ADD(hash, object->position_kind);
    ADD(hash, object->position_along);
    ADD(hash, object->position_range);
    ADD(hash, object->heading_rad);
    ADD(hash, object->pitch_rad);
    ADD(hash, object->roll_rad);
    ADD(hash, object->burial_kind);
    ADD(hash, object->burial_m);
    ADD(hash, object->burial_fraction);
    ADD(hash, object->proud_height_m);
    ADD(hash, object->height_m);
    ADD(hash, object->top_diameter_m);
    ADD(hash, object->front_height_m);
    ADD(hash, object->nose_end);
    ADD(hash, object->tail_end);
    ADD(hash, object->nose_end_depth_m);
    ADD(hash, object->tail_end_depth_m);
    ADD(hash, object->mesh);
    ADD(hash, object->user_shape);
    ADD(hash, object->level_kind);
    ADD(hash, object->level_db);
    ADD(hash, object->cut_count);
    for (uint32_t i = 0; i < object->cut_count && i < SONJECT_CUTS_CAPACITY; i++) {
        ADD(hash, object->cuts[i].azimuth_rad);
        ADD(hash, object->cuts[i].elevation_rad);
        ADD(hash, object->cuts[i].distance_m);
    }
    add_material(hash, &object->material);
}

/* Objects by their numbers, and what they are made of all together. */
static void add_objects(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    char name[32];
    for (uint32_t i = 0; i < scene->object_count; i++) {
        add_object(hash, &scene->objects[i]);
        snprintf(name, sizeof name, "objects[%lu]", (unsigned long)i);
        end_section(digest, name);
    }
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const struct scene_part *part = &scene->parts[i];
        ADD(hash, part->object);
        ADD(hash, part->axes);
        ADD(hash, part->centre);
        add_object(hash, &part->shape);
    }
    end_section(digest, "objects[].parts");
}

static void add_meshes(struct hash *hash, const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh *mesh = &scene->meshes[i];
        const uint64_t counts[2] = {mesh->vertex_count, mesh->triangle_count};
        ADD(hash, counts);
        ADD(hash, mesh->options.smooth_angle_rad);
        hash_add(hash, mesh->vertices, 3 * mesh->vertex_count * sizeof *mesh->vertices);
        hash_add(hash, mesh->corners, 3 * mesh->triangle_count * sizeof *mesh->corners);
    }
}

static void add_user_shapes(struct hash *hash, const struct user_shapes *shapes)
{
    for (uint32_t i = 0; i < shapes->count; i++) {
        const struct user_shape *shape = &shapes->shapes[i];
        hash_add_text(hash, shapes->snippets[shape->snippet].code);
        ADD(hash, shape->is_open);
        ADD(hash, shape->bounding_radius_m);
        ADD(hash, shape->half_length_m);
        ADD(hash, shape->half_width_m);
        ADD(hash, shape->half_height_m);
        ADD(hash, shape->parameters);
    }
}

static void add_injection(struct hash *hash, const sonject_injection_params *injection)
{
    ADD(hash, injection->mode);
    ADD(hash, injection->column_rule);
    ADD(hash, injection->estimate_noise);
    ADD(hash, injection->noise_floor_db);
    ADD(hash, injection->influence_db);
    ADD(hash, injection->ray_scale);
    ADD(hash, injection->interactions);
    ADD(hash, injection->estimator);
    ADD(hash, injection->order_energies);
    ADD(hash, injection->match_response);
    ADD(hash, injection->match_looks);
    ADD(hash, injection->match_saturation);
}

static void add_scene(struct digest *digest, const struct scene *scene, const char *input_identity)
{
    hash_add_text(digest->section, sonject_version());
    end_section(digest, "sonject");
    ADD(digest->section, scene->injection.seed);
    end_section(digest, "injection.seed");
    add_injection(digest->section, &scene->injection);
    end_section(digest, "injection");
    add_sonar(digest, scene);
    add_responses(digest, scene);
    add_sea(digest, scene);
    add_image(digest, scene);
    add_objects(digest, scene);
    add_meshes(digest->section, scene);
    end_section(digest, "objects[].mesh");
    add_user_shapes(digest->section, &scene->user_shapes);
    end_section(digest, "objects[].user_shape");
    hash_add_text(digest->section, input_identity);
    end_section(digest, "input's pixels");
    if (digest->inputs) { /* these say more by themselves */
        json_add(digest->inputs, "sonject", json_string(sonject_version()));
        json_add(digest->inputs, "injection.seed", json_seed(scene->injection.seed));
    }
}

static sonject_status digest_scene(struct report *report, const struct scene *scene,
                                   const char *input_identity, char text[HASH_TEXT_CAPACITY],
                                   json_t **inputs)
{
    struct digest digest = {hash_begin(), hash_begin(), inputs};
    char ignored[HASH_TEXT_CAPACITY];
    const bool is_whole = digest.section && digest.whole;
    if (is_whole)
        add_scene(&digest, scene, input_identity);
    if (digest.section)
        hash_end(digest.section, ignored);
    if (digest.whole)
        hash_end(digest.whole, text);
    return is_whole ? SONJECT_OK : report_out_of_memory(report, "a hash");
}

sonject_status scene_hash(struct report *report, const struct scene *scene,
                          const char *input_identity, char text[HASH_TEXT_CAPACITY])
{
    return digest_scene(report, scene, input_identity, text, NULL);
}

sonject_status scene_inputs(struct report *report, const struct scene *scene,
                            const char *input_identity, char text[HASH_TEXT_CAPACITY],
                            json_t **inputs)
{
    *inputs = json_object();
    const sonject_status status = digest_scene(report, scene, input_identity, text, inputs);
    return status == SONJECT_OK && !*inputs ? report_out_of_memory(report, "a hash") : status;
}

sonject_status traced_scene_hash(struct report *report, const struct scene *scene,
                                 const char *input_identity, char text[HASH_TEXT_CAPACITY])
{
    static const struct impulse_head none;
    struct scene traced = *scene;
    impulse_head_take_sonar(&none, &traced.sonar);
    sonject_pulse_params_init(&traced.pulse);
    memset(&traced.pulse_table, 0, sizeof traced.pulse_table);
    memset(&traced.cross_range_table, 0, sizeof traced.cross_range_table);
    memset(&traced.motion, 0, sizeof traced.motion);
    return scene_hash(report, &traced, input_identity, text);
}

sonject_status code_hash(struct report *report, char hash_text[HASH_TEXT_CAPACITY])
{
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(report, "a hash");
    hash_add_text(hash, sonject_version());
    for (size_t i = 0; i < PROGRAM_COUNT; i++)
        hash_add(hash, embedded_sources[i].text, embedded_sources[i].bytes);
    hash_end(hash, hash_text);
    return SONJECT_OK;
}
