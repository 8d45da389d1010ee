#include "inject/scene_hash.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sonject/version.h>

#include "base/json_document.h"
#include "device/device.h"
#include "schema/keys.h"

/* Hashes a member by itself, since padding of a structure is not part of its value. */
#define ADD(hash, member) hash_add(hash, &(member), sizeof(member))

/* A digest in the making: one of a section of the scene's keys, and one of all sections. */
struct digest {
    struct hash *section, *whole;
    json_t **inputs; /* gets the sections' digests; NULL: not wanted */
};

static void end_section(struct digest *digest, const char *name)
{
    char text[HASH_TEXT_CAPACITY];
    hash_restart(digest->section, text);
    hash_add_text(digest->whole, text);
    if (digest->inputs)
        json_add(digest->inputs, name, json_string(text));
}

/* Adds a number. NaN has many patterns and one meaning: nothing was given. */
static void add_number(struct hash *hash, double number)
{
    const double told = isnan(number) ? (double)NAN : number;
    ADD(hash, told);
}

/* Returns whether a section has a structure of its own, and with it a digest of its own. */
static bool is_part(const struct field *field)
{
    return field->kind == FIELD_SECTION && (field->offset != 0 || field->is_in_scene);
}

/* Adds all that a section's keys set in its structure, but for parts. Files count by their
 * contents, which the scene holds. */
static void add_rows(struct hash *hash, const struct section *section, const void *structure,
                     const struct scene *scene)
{
    /* 0: not by its bytes, or not at all */
    static const uint8_t value_bytes[] = {[FIELD_COUNT64] = sizeof(uint64_t),
                                          [FIELD_COUNT32] = sizeof(uint32_t),
                                          [FIELD_WORD] = sizeof(uint32_t),
                                          [FIELD_SPECIAL] = sizeof(uint32_t),
                                          [FIELD_BOOL] = sizeof(bool)};
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        const void *of = field->is_in_scene ? (const void *)scene : structure;
        const void *member = (const char *)of + field->offset;
        const void *below;
        if (field->kind == FIELD_QUANTITY)
            add_number(hash, *(const double *)member);
        else if (field->kind == FIELD_LABEL)
            hash_add_text(hash, member);
        else if (field->kind == FIELD_TEXT)
            hash_add_text(hash, *(char *const *)member ? *(char *const *)member : "");
        else if (field->kind == FIELD_ENTRIES)
            hash_add(hash, (const char *)structure + field->count_offset, sizeof(uint32_t));
        else if (field->kind != FIELD_SPECIAL || field->offset != 0)
            hash_add(hash, member, value_bytes[field->kind]);
        for (uint32_t k = 0; !is_part(field) && k < field_entry_count(field, structure); k++) {
            const struct section *inner = field_below(field, structure, scene, k, &below);
            if (inner)
                add_rows(hash, inner, below, scene);
        }
    }
}

static void add_section(struct digest *digest, const char *name, const struct section *section,
                        const void *structure, const struct scene *scene)
{
    char inside[64];
    const void *below;
    add_rows(digest->section, section, structure, scene);
    end_section(digest, name);
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        snprintf(inside, sizeof inside, "%s.%s", name, field->key);
        const struct section *inner = field_below(field, structure, scene, 0, &below);
        if (inner && is_part(field))
            add_section(digest, inside, inner, below, scene);
    }
}

/* Adds the scene's keys. The seed has its own digest. The element level's array is in no image. */
static void add_keys(struct digest *digest, const struct scene *scene)
{
    sonject_injection_params injection = scene->injection;
    ADD(digest->section, injection.seed);
    end_section(digest, "injection.seed");
    injection.seed = 0;
    for (size_t i = 0; i < scene_section.count; i++) {
        const struct field *field = &scene_section.fields[i];
        const void *below;
        const struct section *inner = field_below(field, scene, scene, 0, &below);
        if (inner && inner != &elements_section)
            add_section(digest, field->key, inner, inner == &injection_section ? &injection : below,
                        scene);
    }
}

static void add_table(struct hash *hash, const double *positions, const void *values,
                      size_t value_bytes, size_t count)
{
    const uint64_t told = count;
    ADD(hash, told);
    hash_add(hash, positions, count * sizeof *positions);
    hash_add(hash, values, count * value_bytes);
}

static void add_response(struct digest *digest, const char *name,
                         const struct response_table *table)
{
    ADD(digest->section, table->is_time);
    add_table(digest->section, table->positions, table->values, sizeof *table->values,
              table->count);
    end_section(digest, name);
}

static void add_relief(struct digest *digest, const struct relief_features *relief)
{
    struct hash *hash = digest->section;
    for (uint32_t i = 0; i < relief->count; i++)
        add_rows(hash, &relief_section, &relief->features[i], NULL);
    if (relief->heights_m) /* the keys have the grid */
        hash_add(hash, relief->heights_m,
                 (size_t)relief->grid.rows * relief->grid.columns * sizeof *relief->heights_m);
    end_section(digest, "seabed.relief");
}

/* Adds the objects by their numbers, and the parts of all objects together. */
static void add_objects(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    char name[32];
    for (uint32_t i = 0; i < scene->object_count; i++) {
        add_rows(hash, &object_section, &scene->objects[i], scene);
        snprintf(name, sizeof name, "objects[%lu]", (unsigned long)i);
        end_section(digest, name);
    }
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const struct scene_part *part = &scene->parts[i];
        ADD(hash, part->object);
        ADD(hash, part->axes);
        ADD(hash, part->centre);
        add_rows(hash, &object_section, &part->shape, scene);
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

/* Adds what is read from files, or has no keys. */
static void add_tables(struct digest *digest, const struct scene *scene)
{
    struct hash *hash = digest->section;
    const struct motion_table *tables[] = {&scene->motion.sway_table, &scene->motion.yaw_table};
    add_response(digest, "sonar.pulse.file", &scene->pulse_table);
    add_response(digest, "sonar.measured_response", &scene->cross_range_table);
    for (int i = 0; i < 2; i++)
        add_table(hash, tables[i]->along_track_m, tables[i]->values, sizeof *tables[i]->values,
                  tables[i]->count);
    end_section(digest, "sonar.motion.file");
    add_table(hash, scene->pings.rows, scene->pings.altitudes_m, sizeof(double),
              scene->pings.count);
    if (scene->pings.first_ranges_m)
        hash_add(hash, scene->pings.first_ranges_m, scene->pings.count * sizeof(double));
    end_section(digest, "input.pings");
    for (size_t i = 0; i < scene->water_layer_count; i++)
        add_rows(hash, &layer_section, &scene->water_layers[i], scene);
    end_section(digest, "medium.layers");
    add_relief(digest, &scene->relief);
}

static void add_scene(struct digest *digest, const struct scene *scene, const char *input_identity)
{
    hash_add_text(digest->section, sonject_version());
    end_section(digest, "sonject");
    add_keys(digest, scene);
    add_tables(digest, scene);
    add_objects(digest, scene);
    add_meshes(digest->section, scene);
    end_section(digest, "objects[].mesh");
    hash_add_text(digest->section, input_identity);
    end_section(digest, "input's pixels");
    if (digest->inputs) { /* clear values say more than digests */
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
    struct scene traced = *scene;
    traced.sonar.bandwidth_hz = traced.sonar.along_track_resolution_m = 0.0;
    traced.sonar.taylor_sidelobe_db = 0.0;
    traced.sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    traced.sonar.taylor_terms = 0;
    section_defaults(&pulse_section, &traced.pulse, NULL);
    memset(&traced.pulse_table, 0, sizeof traced.pulse_table);
    memset(&traced.cross_range_table, 0, sizeof traced.cross_range_table);
    memset(&traced.motion, 0, sizeof traced.motion);
    return scene_hash(report, &traced, input_identity, text);
}

sonject_status code_hash(struct report *report, char hash_text[HASH_TEXT_CAPACITY])
{
    struct hash *hash = hash_begin();
    CHECK_MEMORY(report, hash, "a hash");
    hash_add_text(hash, sonject_version());
    for (size_t i = 0; i < PROGRAM_COUNT; i++)
        hash_add(hash, embedded_sources[i].text, embedded_sources[i].bytes);
    hash_end(hash, hash_text);
    return SONJECT_OK;
}
