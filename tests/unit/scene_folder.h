/* A fresh folder with one scene file for tests. Include this header after claims.h. */
#ifndef SCENE_FOLDER_H
#define SCENE_FOLDER_H

#include "schema/scene_file.h"
#include "swath/decoder.h"
#include "temporary_folder.h"

/* Reads a scene file as the library's calls do. */
static inline sonject_status read_scene_file(struct report *report, const char *path,
                                             const char *const *overrides, size_t count,
                                             struct scene *scene)
{
    struct scene_source source;
    char *text;
    size_t bytes;
    memset(&source, 0, sizeof source);
    sonject_status status = scene_file_load(report, path, &text, &bytes);
    if (status == SONJECT_OK)
        status = scene_source_keep(&source, report, path, text, overrides, count);
    if (status == SONJECT_OK)
        status = scene_source_read(&source, report, scene);
    scene_source_clear(&source);
    return status;
}

#ifndef SOURCE_ROOT
#define SOURCE_ROOT "."
#endif

/* A complete scene of three lines, and its lines. */
#define START "sonject: 1\n"
#define INPUT                                                                                      \
    "input: {uniform: {rows: 4, columns: 5}, geometry: {row_spacing: 1, column_spacing: 1, "       \
    "first_slant_range: 40}}\n"
#define SONAR "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
#define BASE  START INPUT SONAR

struct scene_folder {
    struct temporary_folder folder;
    char file[TEMPORARY_CAPACITY + 16]; /* path of scene.yaml in the folder, where every scene is */
    struct report report;
    struct report_host host; /* the report's host; all readings share the decoder below */
    struct decoder decoder;
    struct scene scene; /* scene of the last reading, cleared before the next */
};

static struct scene_folder *folder; /* shared by the program's tests */

/* Set up and tear down a cmocka group. */
static inline int make_scene_folder(void **state)
{
    folder = calloc(1, sizeof *folder);
    if (!folder || !open_temporary_folder(&folder->folder))
        return 1;
    snprintf(folder->file, sizeof folder->file, "%s/scene.yaml", folder->folder.path);
    folder->host.decoder = &folder->decoder;
    folder->report.host = &folder->host;
    scene_init(&folder->scene);
    return 0;
}

static inline int remove_scene_folder(void **state)
{
    scene_clear(&folder->scene);
    decoder_stop(&folder->decoder);
    const int result = close_temporary_folder(&folder->folder);
    free(folder);
    return result;
}

/* Returns the path of a file in the folder, valid until the next call. */
static inline const char *file_in(const char *name)
{
    return temporary_file(&folder->folder, name);
}

static inline void write_file(const char *name, const void *bytes, size_t count)
{
    write_bytes(file_in(name), bytes, count);
}

static inline void write_scene(const char *text, size_t bytes)
{
    write_file("scene.yaml", text, bytes);
}

/* Reads the folder's scene. overrides may be NULL if count is 0. */
static inline sonject_status read_scene(const char *const *overrides, size_t count)
{
    scene_clear(&folder->scene);
    folder->report.message[0] = 0;
    return read_scene_file(&folder->report, folder->file, overrides, count, &folder->scene);
}

/* Writes the scene, then reads it. */
static inline sonject_status read_scene_text(const char *text, const char *const *overrides,
                                             size_t count)
{
    write_scene(text, strlen(text));
    return read_scene(overrides, count);
}

static inline void expect_scene_taken(const char *text)
{
    EXPECT_OK(&folder->report, read_scene_text(text, NULL, 0));
}

/* Counts lines by their ends, LF or CR. */
static inline size_t lines_of(const char *text, size_t bytes)
{
    size_t lines = bytes > 0;
    for (size_t i = 0; i < bytes; i++)
        lines += text[i] == '\n' || text[i] == '\r';
    return lines;
}

/* A character that stands for all shapes' words in expected messages. */
#define SHAPE_WORDS "\1"

static inline const char *shape_words(void)
{
#define SHAPE_WORD_BEHIND(NUMBER, name, traits) ", " #name
    static const char words[] = ALL_SHAPES(SHAPE_WORD_BEHIND);
    return words + strlen(", ");
}

/* Expects a refusal. message: each line after the file name, as ":2:3: sonar.altitude: ...". */
static inline void expect_scene_refused(const char *text, const char *message)
{
    char expected[REPORT_CAPACITY] = "";
    if (read_scene_text(text, NULL, 0) != SONJECT_ERROR_INPUT)
        fail_msg("not refused: %s", text);
    for (const char *line = message, *end; *line; line = *end ? end + 1 : end) {
        end = line + strcspn(line, "\n");
        strcat(strcat(expected, line == message ? "" : "\n"), folder->file);
        const char *listed = memchr(line, SHAPE_WORDS[0], (size_t)(end - line));
        sprintf(expected + strlen(expected), "%.*s%s%.*s", (int)((listed ? listed : end) - line),
                line, listed ? shape_words() : "", (int)(listed ? end - listed - 1 : 0),
                listed ? listed + 1 : "");
    }
    if (strcmp(folder->report.message, expected) != 0)
        fail_msg("the message is\n%s\nand not\n%s", folder->report.message, expected);
}

/* A scene that is refused, and its message as above. */
struct refusal {
    const char *text, *message;
};

static inline void expect_all_refused(const struct refusal *wrong, size_t count)
{
    for (size_t i = 0; i < count; i++)
        expect_scene_refused(wrong[i].text, wrong[i].message);
}

/* Expects a message of one line. It names the scene's file, the place and key, ":6:18:
 * objects[0].mesh.file", another file, and what is wrong with the other file. */
static inline void expect_bad_file(const char *text, const char *key, const char *name,
                                   sonject_status status, const char *what)
{
    char place[TEMPORARY_CAPACITY + 100];
    const char *message = folder->report.message;
    snprintf(place, sizeof place, "%s%s: ", folder->file, key);
    assert_int_equal(read_scene_text(text, NULL, 0), status);
    if (strncmp(message, place, strlen(place)) != 0 || !strstr(message, file_in(name)) ||
        !strstr(message, what) || strchr(message, '\n'))
        fail_msg("'%s' is not '%s... %s ... %s'", message, place, name, what);
}

/* Returns an example scene's text, such as that of "demo", and a 0. The caller frees it. */
static inline char *example_scene(const char *name, size_t *bytes)
{
    char path[TEMPORARY_CAPACITY];
    snprintf(path, sizeof path, SOURCE_ROOT "/tools/scenes/%s.yaml", name);
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("%s is not there", path);
    char *text = zeroed(65536, 1);
    *bytes = fread(text, 1, 65535, file);
    fclose(file);
    return text;
}

#endif
