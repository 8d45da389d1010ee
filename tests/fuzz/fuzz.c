/* The fuzzers. Each gives a reader the bytes that libFuzzer thinks of. The reader must take them or
 * say why not, and hold nothing after a failure. KIND: the fuzzer to run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "dataset/campaign.h"
#include "dataset/contact_files.h"
#include "image/raster.h"
#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"
#include "schema/scene_file.h"
#include "schema/tables.h"
#include "swath/swath_format.h"

/* The largest image that is read, bytes. Compressed files may hold a thousand times their size. */
#define BYTES_READ_MAX ((size_t)1 << 24)

struct fuzzer {
    const char *kind;
    void (*run)(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count);
    const struct swath_format *format;
    sonject_status (*read_mesh)(struct mesh_soup *soup, const char *bytes, size_t count);
};

/* libFuzzer's entry. Returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void fail(const char *what, const char *detail)
{
    fprintf(stderr, "%s: %s\n", what, detail);
    abort();
}

/* Writes a file without flushing it to disk. */
static void put_file(const char *path, const uint8_t *bytes, size_t count)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, count, file) != count || fclose(file) != 0)
        fail("cannot write", path);
}

/* Returns a copy of just that size plus one 0 byte, so that reading on is found. Caller frees. */
static char *text_of(const uint8_t *bytes, size_t count)
{
    char *text = malloc(count + 1);
    if (!text)
        fail("out of memory", "the input's copy");
    if (count > 0)
        memcpy(text, bytes, count);
    text[count] = '\0';
    return text;
}

/* Aborts unless the status is OK, or one for bad input that has a message. The message has one
 * line, or with has_lines one for each mistake. */
static void expect(sonject_status status, const struct report *report, bool has_lines)
{
    if (status == SONJECT_OK)
        return;
    if (status != SONJECT_ERROR_INPUT && status != SONJECT_ERROR_STORAGE &&
        status != SONJECT_ERROR_UNSUPPORTED)
        fail(sonject_status_name(status), report->message);
    if (report->message[0] == '\0')
        fail("no message", sonject_status_name(status));
    for (const char *at = report->message; *at; at++)
        if ((unsigned char)*at < 0x20 && !(has_lines && *at == '\n' && (unsigned char)at[1] > 0x20))
            fail("not one line", report->message);
}

/* Reads a scene whose targets are in ../targets. */
static void read_scene(const char *text)
{
    struct report report = {.host = NULL};
    struct scene scene;
    const struct scene_source source = {.path = "scenes/fuzz.yaml", .text = text};
    scene_init(&scene);
    expect(scene_source_read(&source, &report, &scene), &report, true);
    scene_clear(&scene);
}

static void fuzz_scene(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count)
{
    char *text = text_of(bytes, count);
    (void)fuzzer;
    read_scene(text);
    free(text);
}

/* Reads a target's file, as a scene does. */
static void fuzz_target(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count)
{
    static const char text[] =
        "sonject: 1\ninput: {uniform: {rows: 4, columns: 5}, geometry: {row_spacing: 1, "
        "column_spacing: 1, first_slant_range: 40}}\n"
        "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
        "objects: [{target: ../targets/fuzz.yaml}]\n";
    (void)fuzzer;
    put_file("targets/fuzz.yaml", bytes, count);
    read_scene(text);
}

/* Reads the same file as a campaign's table of bodies. */
static void read_bodies(void)
{
    struct report report = {.host = NULL};
    struct distribution bodies;
    struct tree tree;
    const struct tree_node name = {.kind = TREE_TEXT, .text = (char *)"fuzz.csv"};
    tree_init(&tree, &report, "fuzz.yaml");
    struct reader reader = {.report = &report, .tree = &tree};
    memset(&bodies, 0, sizeof bodies);
    const sonject_status status = body_table_read(&reader, &name, &bodies);
    expect(status, &report, false);
    for (size_t i = 0; status == SONJECT_OK && i < bodies.count; i++)
        if (!body_table_row(&bodies, bodies.texts[i]))
            abort();
    distribution_clear(&bodies);
}

static void fuzz_table(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count)
{
    static const struct table_format format = {
        .names = {"depth", "time", "speed", "other"}, .samples_max = 100, .bytes_max = 4000};
    struct report report = {.host = NULL};
    struct number_table table;
    (void)fuzzer;
    put_file("fuzz.csv", bytes, count);
    read_bodies();
    const sonject_status status = number_table_read(&report, "fuzz.csv", NULL, &format, &table);
    expect(status, &report, false);
    if (status != SONJECT_OK)
        return;
    for (size_t column = 0; column < TABLE_COLUMNS_MAX; column++)
        for (size_t i = 0; table.values[column] && i < table.count; i++)
            if (isnan(table.values[column][i])) /* infinite values are left to the table's users */
                abort();
    number_table_clear(&table);
}

/* Reads labels in each format, whose image is a.npy. */
static void fuzz_labels(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count)
{
    static const char *const files[][2] = {{"l.json", "l.json"},
                                           {"l.csv", "l.csv"},
                                           {"l.yaml", "l.yaml"},
                                           {"yolo/a.txt", "yolo"},
                                           {"voc/a.xml", "voc"}};
    (void)fuzzer;
    for (size_t i = 0; i < COUNT(files); i++) {
        struct report report = {.host = NULL};
        struct contact_set set;
        put_file(files[i][0], bytes, count);
        const struct contact_choice choice = {.part = LABELLED_BOTH};
        const sonject_status status = contact_set_read(&report, files[i][1], &choice, &set);
        expect(status, &report, true);
        if (status == SONJECT_OK && (set.count == 0) != (set.quantiles.count > 0))
            abort();
        for (size_t k = 0; status == SONJECT_OK && k < set.count; k++) {
            const struct labelled_contact *contact = &set.contacts[k];
            if (contact->image >= set.image_count || contact->box.rows == 0 ||
                contact->box.columns == 0)
                abort();
        }
        contact_set_clear(&set);
    }
}

/* Makes a hierarchy of a mesh file's bytes. */
static void fuzz_mesh(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count)
{
    struct report report = {.host = NULL};
    struct mesh_soup soup = {.report = &report, .path = "fuzz"};
    struct mesh mesh = {0};
    char *text = text_of(bytes, count);
    sonject_status status = fuzzer->read_mesh(&soup, text, count);
    expect(status, &report, false);
    if (status == SONJECT_OK) {
        for (size_t i = 0; i < 3 * soup.vertices; i++)
            if (!isfinite(soup.positions[i]))
                abort();
        for (size_t i = 0; i < 3 * soup.triangles; i++)
            if (soup.corners[i] >= soup.vertices)
                abort();
        mesh_options_init(&mesh.options);
        mesh.options.smooth_angle_rad = 0.5;
        status = mesh_of_soup(&soup, &mesh);
        expect(status, &report, false);
        if (status == SONJECT_OK)
            expect(mesh_require_closed(&report, "fuzz", &mesh), &report, false);
        mesh_clear(&mesh);
    }
    mesh_soup_clear(&soup);
    free(text);
}

/* Checks that all lines that the file claims to hold are in it. MATLAB's numbers, which may be
 * compressed, have no lines. */
static void expect_inside(const struct swath_file *file, size_t bytes)
{
    const struct sample_lines *lines = &file->lines;
    const struct raster_layout *layout = &file->layout;
    const uint64_t count = lines->is_transposed ? layout->columns : layout->rows;
    for (uint64_t i = 0; (lines->places || lines->line_bytes > 0) && i < count; i++) {
        const uint64_t place =
            lines->places ? lines->places[i] : lines->first_place + i * lines->line_bytes;
        const uint64_t line = lines->places ? bytes / count : lines->line_bytes;
        if (place > file->bytes || line > file->bytes - place)
            abort();
    }
}

static void read_all(struct swath_file *file)
{
    struct report report = {.host = NULL};
    const struct region whole = {0, 0, file->layout.rows, file->layout.columns};
    size_t size;
    if (!region_bytes(&file->layout, &whole, &size))
        abort();
    expect_inside(file, size);
    void *pixels = size <= BYTES_READ_MAX ? allocate_array(size, 1) : NULL;
    if (pixels)
        expect(file->format->read(&report, file, &whole, pixels), &report, false);
    if (swath_file_recording(file))
        (void)recording_geometry_of(&file->recording, 0, file->layout.rows);
    free(pixels);
}

/* Reads image files in this process: each choice of a channel or an array, its samples and its
 * geometry. */
static void fuzz_swath(const struct fuzzer *fuzzer, const uint8_t *bytes, size_t count)
{
    static const int32_t channels[] = {SONJECT_CHANNEL_ONLY, SONJECT_CHANNEL_ONLY,
                                       SONJECT_CHANNEL_PORT, 1};
    put_file("fuzz.swath", bytes, count);
    for (int i = 0; i < 4; i++) {
        struct report report = {.host = NULL};
        if ((i == 1 && !fuzzer->format->has_names) || (i > 1 && !fuzzer->format->has_channels))
            continue;
        struct swath_file *file = allocate_array(1, sizeof *file);
        if (!file || !(file->path = copy_text("fuzz.swath")))
            abort();
        file->format = fuzzer->format;
        file->stream = byte_file_open(file->path, &file->bytes);
        if (!file->stream)
            abort();
        if (file->format->is_of(file, bytes, count)) {
            const sonject_status status =
                file->format->open(&report, file, channels[i], i == 1 ? "swath" : NULL);
            expect(status, &report, false);
            if (status == SONJECT_OK)
                read_all(file);
        }
        swath_file_close(&file);
    }
}

static const struct fuzzer fuzzers[] = {
    {"scene", fuzz_scene, NULL, NULL},      {"target", fuzz_target, NULL, NULL},
    {"xtf", fuzz_swath, &xtf_format, NULL}, {"jsf", fuzz_swath, &jsf_format, NULL},
    {"npy", fuzz_swath, &npy_format, NULL}, {"mat", fuzz_swath, &mat_format, NULL},
    {"stl", fuzz_mesh, NULL, stl_read},     {"obj", fuzz_mesh, NULL, obj_read},
    {"ply", fuzz_mesh, NULL, ply_read},     {"table", fuzz_table, NULL, NULL},
    {"labels", fuzz_labels, NULL, NULL}};

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < sizeof fuzzers / sizeof *fuzzers; i++)
        if (strcmp(fuzzers[i].kind, KIND) == 0)
            fuzzers[i].run(&fuzzers[i], bytes, count);
    return 0;
}
