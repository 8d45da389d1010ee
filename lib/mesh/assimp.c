/* What is looked at before a file goes to Assimp, which believes what files say about their own
 * sizes: what a file makes it hold is then in proportion to the file. */
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "mesh/assimp_import.h"
#include "mesh/mesh_reader.h"
#include "mesh/words.h"

#define FILE_BYTES_MAX ((size_t)256 << 20)
#define COUNT_LEAST    65536 /* that any file may have */
#define HELD_BYTES_MAX (4.0 * 1073741824.0)

struct suspect {
    struct report *report;
    const char *path;
    const char *bytes;
    size_t count;
};

static sonject_status refuse(const struct suspect *file, const char *what)
{
    return report_failure(file->report, SONJECT_ERROR_INPUT, "%s: %s", file->path, what);
}

static bool is_too_many(const struct suspect *file, int64_t number)
{
    const int64_t most = (int64_t)(file->count > COUNT_LEAST ? file->count : COUNT_LEAST);
    return number < 0 || number > most;
}

static sonject_status refuse_count(const struct suspect *file, const char *key)
{
    return report_failure(file->report, SONJECT_ERROR_INPUT,
                          "%s: a %s is more than a file of %zu bytes can hold", file->path, key,
                          file->count);
}

/* OFF: a word, then how many vertices and faces there are. */
static sonject_status check_off(const struct suspect *file)
{
    static const char *const names[] = {"off", "coff", "noff", "cnoff"};
    struct words words = {file->report, file->path, file->bytes, file->bytes + file->count, 1};
    bool is_known = false;
    if (words_left(&words, '#'))
        for (size_t i = 0; !is_known && i < sizeof names / sizeof *names; i++)
            is_known = words_take(&words, names[i]);
    if (!is_known)
        return words_failure(&words, "'OFF'");
    for (int i = 0; i < 2; i++) {
        int64_t number = 0;
        if (!words_left(&words, '#'))
            return words_failure(&words, "numbers of vertices and faces");
        const sonject_status status = words_whole(&words, "a number of elements", &number);
        if (status != SONJECT_OK)
            return status;
        if (is_too_many(file, number))
            return refuse_count(file, "number of elements");
    }
    return SONJECT_OK;
}

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
        return refuse(file, "its meshes are compressed; export it without");
    json_object_foreach(value, key, entry)
    {
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++)
            if (strcmp(key, counts[k]) == 0 &&
                (!json_is_integer(entry) || is_too_many(file, json_integer_value(entry))))
                return refuse_count(file, counts[k]);
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
    static const char *const to_accessors[] = {"attributes", "targets", "indices",
                                               "input",      "output",  "inverseBindMatrices"};
    const char *key;
    json_t *entry;
    size_t i;
    json_array_foreach(value, i, entry) add_references(document, entry, total);
    json_object_foreach(value, key, entry)
    {
        for (size_t k = 0; k < sizeof to_accessors / sizeof *to_accessors; k++)
            if (strcmp(key, to_accessors[k]) == 0)
                add_reference(json_object_get(document, "accessors"), entry, "count", 64.0, total);
        if (strcmp(key, "bufferView") == 0)
            add_reference(json_object_get(document, "bufferViews"), entry, "byteLength", 1.0,
                          total);
        add_references(document, entry, total);
    }
}

/* Marks the nodes of a list; false where one is none or is marked. */
static bool mark_nodes(json_t *list, bool *is_marked, size_t count)
{
    json_t *entry;
    size_t i;
    json_array_foreach(list, i, entry)
    {
        const json_int_t number = json_is_integer(entry) ? json_integer_value(entry) : -1;
        if (number < 0 || (uint64_t)number >= count || is_marked[number])
            return false;
        is_marked[number] = true;
    }
    return true;
}

/* Nodes form trees: none is within two others or within itself. */
static sonject_status check_gltf_nodes(const struct suspect *file, json_t *document)
{
    json_t *nodes = json_object_get(document, "nodes");
    json_t *node, *scene;
    const size_t count = json_array_size(nodes);
    size_t i;
    bool *is_child = calloc(count + 1, sizeof *is_child);
    bool *is_shown = calloc(count + 1, sizeof *is_shown);
    bool is_good = is_child && is_shown;
    if (!is_good) {
        free(is_child);
        free(is_shown);
        return report_out_of_memory(file->report, file->path);
    }
    json_array_foreach(nodes, i, node) is_good =
        is_good && mark_nodes(json_object_get(node, "children"), is_child, count);
    json_array_foreach(json_object_get(document, "scenes"), i, scene)
    {
        memcpy(is_shown, is_child, count * sizeof *is_shown);
        is_good = is_good && mark_nodes(json_object_get(scene, "nodes"), is_shown, count);
    }
    free(is_child);
    free(is_shown);
    return is_good ? SONJECT_OK
                   : refuse(file, "its nodes do not form a tree; export the mesh again");
}

static sonject_status check_gltf_text(const struct suspect *file, const char *text, size_t count)
{
    json_error_t error;
    json_t *document = json_loadb(text, count, JSON_REJECT_DUPLICATES, &error);
    if (!document)
        return report_failure(file->report, SONJECT_ERROR_INPUT, "%s, line %d: %s", file->path,
                              error.line, error.text);
    const char *version =
        json_string_value(json_object_get(json_object_get(document, "asset"), "version"));
    double held = 0.0;
    sonject_status status = version && strncmp(version, "2.", 2) == 0
                                ? check_gltf_counts(file, document)
                                : refuse(file, "is not a glTF document of version 2");
    if (status == SONJECT_OK)
        add_references(document, document, &held);
    if (held > HELD_BYTES_MAX)
        status = refuse(file, "shows its lists again too many times; export it as plain meshes");
    if (status == SONJECT_OK)
        status = check_gltf_nodes(file, document);
    json_decref(document);
    return status;
}

static sonject_status check_gltf(const struct suspect *file)
{
    return check_gltf_text(file, file->bytes, file->count);
}

static uint32_t word_at(const struct suspect *file, size_t place)
{
    const unsigned char *bytes = (const unsigned char *)file->bytes + place;
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* GLB: a head of three words, the length of the document, its kind, the document. */
static sonject_status check_glb(const struct suspect *file)
{
    if (file->count < 20 || memcmp(file->bytes, "glTF\2\0\0\0", 8) != 0 ||
        word_at(file, 8) != file->count || word_at(file, 12) > file->count - 20 ||
        memcmp(file->bytes + 16, "JSON", 4) != 0)
        return refuse(file, "is not a whole GLB file of version 2");
    return check_gltf_text(file, file->bytes + 20, word_at(file, 12));
}

static const struct {
    const char *extension;
    sonject_status (*check)(const struct suspect *file);
} formats[] = {{".off", check_off}, {".gltf", check_gltf}, {".glb", check_glb}};

sonject_status assimp_read(struct report *report, const char *path, struct mesh_soup *soup)
{
    struct suspect file = {report, path, NULL, 0};
    char *bytes;
    size_t format = 0;
    while (format < sizeof formats / sizeof *formats &&
           !mesh_path_ends_with(path, formats[format].extension))
        format++;
    if (format == sizeof formats / sizeof *formats)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: meshes are read from .stl, .obj, .ply, .off, .gltf and "
                              ".glb files: convert it",
                              path);
    sonject_status status = file_read_whole(report, path, FILE_BYTES_MAX, &bytes, &file.count);
    if (status != SONJECT_OK)
        return status;
    file.bytes = bytes;
    status = formats[format].check(&file);
    if (status == SONJECT_OK)
        status = assimp_import(report, path, bytes, file.count, soup);
    free(bytes);
    return status;
}
