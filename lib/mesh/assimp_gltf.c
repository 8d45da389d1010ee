/* What is looked at in a glTF document before it goes to Assimp, and what is left out of it. */
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/memory.h"
#include "mesh/assimp_check.h"

#define NODES_DEEP_MAX 256
#define HELD_BYTES_MAX (4.0 * 1073741824.0)

/* Counts of a glTF document, wherever they stand. Nesting is limited by the JSON reader. */
static sonject_status check_gltf_counts(const struct suspect *file, json_t *value)
{
    static const char *const counts[] = {"count", "byteLength", "byteOffset", "byteStride"};
    sonject_status status = SONJECT_OK;
    const char *key;
    json_t *entry;
    size_t i;
    if (json_is_array(value))
        json_array_foreach(value, i, entry) if (status == SONJECT_OK) status =
            check_gltf_counts(file, entry);
    if (!json_is_object(value))
        return status;
    if (json_object_get(value, "KHR_draco_mesh_compression") ||
        json_object_get(value, "EXT_meshopt_compression"))
        return suspect_refuse(file, "its meshes are compressed; export it without");
    json_object_foreach(value, key, entry)
    {
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++)
            if (strcmp(key, counts[k]) == 0 &&
                (!json_is_integer(entry) || suspect_is_too_many(file, json_integer_value(entry))))
                return suspect_refuse_count(file, counts[k]);
        if (status == SONJECT_OK)
            status = check_gltf_counts(file, entry);
    }
    return status;
}

/* Adds what a document's reference to one of its lists makes Assimp hold, in bytes. */
static void add_reference(json_t *list, json_t *number, const char *size_key, double bytes,
                          double *total)
{
    if (json_is_array(number) || json_is_object(number)) {
        const char *key;
        json_t *entry;
        size_t i;
        json_array_foreach(number, i, entry) add_reference(list, entry, size_key, bytes, total);
        json_object_foreach(number, key, entry) add_reference(list, entry, size_key, bytes, total);
    } else if (json_is_integer(number) && json_integer_value(number) >= 0) {
        json_t *entry = json_array_get(list, (size_t)json_integer_value(number));
        *total += bytes * (double)json_integer_value(json_object_get(entry, size_key));
    }
}

/* The same for all references within a value: many may be to one large list. */
static void add_references(json_t *document, json_t *value, double *total)
{
    static const char *const to_accessors[] = {"attributes", "indices"};
    const char *key;
    json_t *entry;
    size_t i;
    json_array_foreach(value, i, entry) add_references(document, entry, total);
    json_object_foreach(value, key, entry)
    {
        for (size_t k = 0; k < sizeof to_accessors / sizeof *to_accessors; k++)
            if (strcmp(key, to_accessors[k]) == 0)
                add_reference(json_object_get(document, "accessors"), entry, "count", 64.0, total);
        add_references(document, entry, total);
    }
}

/* Notes who holds the nodes of a list; false where one is none or is held already. */
static bool take_nodes(json_t *list, uint32_t *holders, size_t count, uint32_t holder)
{
    json_t *entry;
    size_t i;
    json_array_foreach(list, i, entry)
    {
        const json_int_t number = json_is_integer(entry) ? json_integer_value(entry) : -1;
        if (number < 0 || (uint64_t)number >= count || holders[number] != 0)
            return false;
        holders[number] = holder;
    }
    return true;
}

/* Whether no node is within itself or too many others. holders: number + 1 of the node that holds
 * one, 0: none. */
static bool is_flat(const uint32_t *holders, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        int depth = 0;
        for (size_t node = i; holders[node] != 0; node = holders[node] - 1)
            if (++depth > NODES_DEEP_MAX)
                return false;
    }
    return true;
}

/* Nodes form trees: none is within two others or within itself, or shown and within another. */
static sonject_status check_gltf_nodes(const struct suspect *file, json_t *document)
{
    json_t *nodes = json_object_get(document, "nodes");
    json_t *node, *scene;
    const size_t count = json_array_size(nodes);
    size_t i;
    uint32_t *holders = allocate_array(count + 1, sizeof *holders);
    uint32_t *shown = allocate_array(count + 1, sizeof *shown);
    bool is_good = holders && shown;
    const bool has_memory = is_good;
    for (i = 0; is_good && i < count; i++) {
        node = json_array_get(nodes, i);
        is_good = take_nodes(json_object_get(node, "children"), holders, count, (uint32_t)(i + 1));
    }
    is_good = is_good && is_flat(holders, count);
    for (i = 0; is_good && i < json_array_size(json_object_get(document, "scenes")); i++) {
        scene = json_array_get(json_object_get(document, "scenes"), i);
        memcpy(shown, holders, count * sizeof *shown);
        is_good = take_nodes(json_object_get(scene, "nodes"), shown, count, 1);
    }
    free(holders);
    free(shown);
    if (!has_memory)
        return report_out_of_memory(file->report, file->path);
    return is_good ? SONJECT_OK
                   : suspect_refuse(file,
                                    "its nodes do not form trees of at most 256 levels; export the "
                                    "mesh again");
}

/* A member that is a whole number from 0; without one, the given value. */
static int64_t number_of(json_t *object, const char *key, int64_t missing)
{
    json_t *number = json_object_get(object, key);
    return json_is_integer(number) && json_integer_value(number) >= 0 ? json_integer_value(number)
                                                                      : missing;
}

/* Whether elements of so many bytes of an accessor lie within its part of a buffer. Numbers are
 * limited by check_gltf_counts. */
static bool accessor_is_inside(json_t *document, json_t *accessor, int64_t element)
{
    json_t *view = json_array_get(json_object_get(document, "bufferViews"),
                                  (size_t)number_of(accessor, "bufferView", UINT32_MAX));
    json_t *buffer = json_array_get(json_object_get(document, "buffers"),
                                    (size_t)number_of(view, "buffer", UINT32_MAX));
    const int64_t bytes = number_of(view, "byteLength", 0);
    const int64_t stride = number_of(view, "byteStride", element);
    const int64_t count = number_of(accessor, "count", 0);
    return stride >= element && count > 0 &&
           number_of(accessor, "byteOffset", 0) + (count - 1) * stride + element <= bytes &&
           number_of(view, "byteOffset", 0) + bytes <= number_of(buffer, "byteLength", 0);
}

static bool has_type(json_t *accessor, const char *type)
{
    const char *text = json_string_value(json_object_get(accessor, "type"));
    return text && strcmp(text, type) == 0 && !json_object_get(accessor, "sparse");
}

/* Coordinates are triples of floats, corners whole numbers, and both are there. */
static bool primitive_is_sound(json_t *document, json_t *primitive)
{
    json_t *accessors = json_object_get(document, "accessors");
    json_t *attributes = json_object_get(primitive, "attributes");
    json_t *points =
        json_array_get(accessors, (size_t)number_of(attributes, "POSITION", UINT32_MAX));
    json_t *indices = json_object_get(primitive, "indices");
    json_t *corners =
        json_array_get(accessors, (size_t)number_of(primitive, "indices", UINT32_MAX));
    const int64_t kind = number_of(corners, "componentType", 0);
    const int64_t size = kind == 5121 ? 1 : kind == 5123 ? 2 : kind == 5125 ? 4 : 0;
    if (!has_type(points, "VEC3") || number_of(points, "componentType", 0) != 5126 ||
        !accessor_is_inside(document, points, 12))
        return false;
    return !indices ||
           (size > 0 && has_type(corners, "SCALAR") && accessor_is_inside(document, corners, size));
}

static sonject_status check_gltf_meshes(const struct suspect *file, json_t *document)
{
    json_t *mesh, *primitive, *buffer;
    size_t i, k;
    bool is_good = true;
    json_array_foreach(json_object_get(document, "buffers"), i, buffer) is_good =
        is_good && (json_object_get(buffer, "uri") ||
                    number_of(buffer, "byteLength", 0) <= (int64_t)file->binary);
    json_array_foreach(json_object_get(document, "meshes"), i, mesh)
        json_array_foreach(json_object_get(mesh, "primitives"), k, primitive) is_good =
            is_good && primitive_is_sound(document, primitive);
    return is_good
               ? SONJECT_OK
               : suspect_refuse(file, "a mesh's coordinates must be floats and its corners whole "
                                      "numbers, both within their buffers and not sparse");
}

static void keep_only(json_t *object, const char *const *keys)
{
    const char *key;
    json_t *entry;
    void *next;
    json_object_foreach_safe(object, next, key, entry)
    {
        const char *const *known = keys;
        while (*known && strcmp(*known, key) != 0)
            known++;
        if (!*known)
            json_object_del(object, key);
    }
}

static void keep_only_in(json_t *list, const char *const *keys)
{
    json_t *entry;
    size_t i;
    json_array_foreach(list, i, entry) keep_only(entry, keys);
}

/* Leaves what makes up shapes: no pictures, bones, movements or extensions reach Assimp. */
static void keep_shapes(json_t *document)
{
    static const char *const in_document[] = {
        "asset", "scene", "scenes", "nodes", "meshes", "buffers", "bufferViews", "accessors", NULL};
    static const char *const in_asset[] = {"version", NULL};
    static const char *const in_scene[] = {"nodes", NULL};
    static const char *const in_node[] = {"children", "mesh",  "matrix", "translation",
                                          "rotation", "scale", NULL};
    static const char *const in_mesh[] = {"primitives", NULL};
    static const char *const in_primitive[] = {"attributes", "indices", "mode", NULL};
    static const char *const in_attributes[] = {"POSITION", NULL};
    static const char *const in_buffer[] = {"uri", "byteLength", NULL};
    static const char *const in_view[] = {"buffer", "byteOffset", "byteLength", "byteStride", NULL};
    static const char *const in_accessor[] = {
        "bufferView", "byteOffset", "componentType", "count", "type", "sparse", NULL};
    json_t *mesh, *primitive;
    size_t i, k;
    keep_only(document, in_document);
    keep_only(json_object_get(document, "asset"), in_asset);
    keep_only_in(json_object_get(document, "scenes"), in_scene);
    keep_only_in(json_object_get(document, "nodes"), in_node);
    keep_only_in(json_object_get(document, "meshes"), in_mesh);
    keep_only_in(json_object_get(document, "buffers"), in_buffer);
    keep_only_in(json_object_get(document, "bufferViews"), in_view);
    keep_only_in(json_object_get(document, "accessors"), in_accessor);
    json_array_foreach(json_object_get(document, "meshes"), i, mesh)
        json_array_foreach(json_object_get(mesh, "primitives"), k, primitive)
    {
        keep_only(primitive, in_primitive);
        keep_only(json_object_get(primitive, "attributes"), in_attributes);
    }
}

static sonject_status check_document(const struct suspect *file, json_t *document)
{
    const char *version =
        json_string_value(json_object_get(json_object_get(document, "asset"), "version"));
    double held = 0.0;
    sonject_status status = version && strncmp(version, "2.", 2) == 0
                                ? check_gltf_counts(file, document)
                                : suspect_refuse(file, "is not a glTF document of version 2");
    keep_shapes(document);
    if (status == SONJECT_OK)
        status = check_gltf_nodes(file, document);
    if (status == SONJECT_OK)
        add_references(document, document, &held);
    if (held > HELD_BYTES_MAX)
        return suspect_refuse(file,
                              "shows its lists again too many times; export it as plain meshes");
    return status == SONJECT_OK ? check_gltf_meshes(file, document) : status;
}

sonject_status check_gltf_text(const struct suspect *file, const char *text, size_t count,
                               char **left)
{
    json_error_t error;
    json_t *document = json_loadb(text, count, JSON_REJECT_DUPLICATES, &error);
    *left = NULL;
    if (!document)
        return report_failure(file->report, SONJECT_ERROR_INPUT, "%s, line %d: %s", file->path,
                              error.line, error.text);
    sonject_status status = check_document(file, document);
    if (status == SONJECT_OK) {
        const size_t flags = JSON_COMPACT | JSON_REAL_PRECISION(17);
        const size_t length = json_dumpb(document, NULL, 0, flags);
        *left = allocate_array(length + 1, 1);
        if (!*left)
            status = report_out_of_memory(file->report, file->path);
        else
            json_dumpb(document, *left, length, flags);
    }
    json_decref(document);
    return status;
}
