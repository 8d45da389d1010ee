/* What is looked at before a file goes to Assimp, which believes what files say about their own
 * sizes: what a file makes it hold is then in proportion to the file. */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "mesh/assimp_check.h"
#include "mesh/assimp_import.h"
#include "mesh/mesh_reader.h"
#include "mesh/words.h"

#define FILE_BYTES_MAX ((size_t)256 << 20)
#define COUNT_LEAST    65536 /* that any file may have */

sonject_status suspect_refuse(const struct suspect *file, const char *what)
{
    return report_failure(file->report, SONJECT_ERROR_INPUT, "%s: %s", file->path, what);
}

bool suspect_is_too_many(const struct suspect *file, int64_t number)
{
    const int64_t most = (int64_t)(file->count > COUNT_LEAST ? file->count : COUNT_LEAST);
    return number < 0 || number > most;
}

sonject_status suspect_refuse_count(const struct suspect *file, const char *key)
{
    return report_failure(file->report, SONJECT_ERROR_INPUT,
                          "%s: a %s is more than a file of %zu bytes can hold", file->path, key,
                          file->count);
}

/* OFF: a word, then how many vertices and faces there are. */
static sonject_status check_off(struct suspect *file)
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
        if (suspect_is_too_many(file, number))
            return suspect_refuse_count(file, "number of elements");
    }
    return SONJECT_OK;
}

static sonject_status check_gltf(struct suspect *file)
{
    const sonject_status status = check_gltf_text(file, file->bytes, file->count, &file->made);
    if (status != SONJECT_OK)
        return status;
    file->bytes = file->made;
    file->count = strlen(file->made);
    return SONJECT_OK;
}

static uint32_t word_at(const struct suspect *file, size_t place)
{
    const unsigned char *bytes = (const unsigned char *)file->bytes + place;
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void put_word(char *bytes, size_t word)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (char)(word >> 8 * i & 255u);
}

/* GLB: a head of three words, the length of the document, its kind, the document, numbers. */
static sonject_status check_glb(struct suspect *file)
{
    char *left;
    if (file->count < 20 || memcmp(file->bytes, "glTF\2\0\0\0", 8) != 0 ||
        word_at(file, 8) != file->count || word_at(file, 12) > file->count - 20 ||
        memcmp(file->bytes + 16, "JSON", 4) != 0)
        return suspect_refuse(file, "is not a whole GLB file of version 2");
    const size_t end = 20 + (size_t)word_at(file, 12);
    const size_t rest = file->count - end;
    if (rest > 0 && (rest < 8 || word_at(file, end) != rest - 8 ||
                     memcmp(file->bytes + end + 4, "BIN", 4) != 0))
        return suspect_refuse(file, "is not a whole GLB file of version 2");
    file->binary = rest > 0 ? rest - 8 : 0;
    const sonject_status status = check_gltf_text(file, file->bytes + 20, end - 20, &left);
    if (status != SONJECT_OK)
        return status;
    const size_t length = strlen(left);
    const size_t padded = (length + 3) / 4 * 4;
    const size_t count = 20 + padded + rest;
    file->made = allocate_array(count, 1);
    if (file->made) {
        memcpy(file->made, file->bytes, 20);
        memset(file->made + 20, ' ', padded);
        memcpy(file->made + 20, left, length);
        memcpy(file->made + 20 + padded, file->bytes + end, rest);
        put_word(file->made + 8, count);
        put_word(file->made + 12, padded);
        file->bytes = file->made;
        file->count = count;
    }
    free(left);
    return file->made ? SONJECT_OK : report_out_of_memory(file->report, file->path);
}

static const struct {
    const char *extension;
    sonject_status (*check)(struct suspect *file);
} formats[] = {{".off", check_off}, {".gltf", check_gltf}, {".glb", check_glb}};

sonject_status assimp_read(struct report *report, const char *path, struct mesh_soup *soup)
{
    struct suspect file = {report, path, NULL, 0, 0, NULL};
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
        status = assimp_import(report, path, file.bytes, file.count, soup);
    free(file.made);
    free(bytes);
    return status;
}
