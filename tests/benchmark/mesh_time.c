/* A mesh of 10^6 triangles from its file to the image, by the public interface: read, made ready,
 * traced and formed in a patch of 400 x 400 pixels with warm program caches, one interaction.
 * Beside it, in the same run, the time to read the file's bytes alone and the same image of a torus
 * of its size. Times by the clock and, in brackets, by the processors, since other programs may run
 * too. Limits none: it prints. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <sonject/sonject.h>

#include "base/report.h"
#include "kernel/mesh_samples.h"
#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"

#define AROUND  1000
#define ACROSS  500 /* 2 x around x across triangles */
#define REPEATS 3
#define PIXELS  400

struct stopwatch {
    double clock_s, processor_s;
};

static struct stopwatch now(void)
{
    const struct stopwatch watch = {clock_seconds(), (double)clock() / CLOCKS_PER_SEC};
    return watch;
}

static void keep_best(struct stopwatch *best, struct stopwatch start, int is_first)
{
    const struct stopwatch end = now();
    const double clock_s = end.clock_s - start.clock_s;
    const double processor_s = end.processor_s - start.processor_s;
    if (is_first || clock_s < best->clock_s)
        best->clock_s = clock_s;
    if (is_first || processor_s < best->processor_s)
        best->processor_s = processor_s;
}

static void expect(sonject_context *context, sonject_status status)
{
    if (status == SONJECT_OK)
        return;
    fprintf(stderr, "%s\n", sonject_context_message(context));
    exit(1);
}

static void put_number(FILE *file, const void *number, size_t bytes)
{
    if (fwrite(number, 1, bytes, file) != bytes) {
        perror("mesh file");
        exit(1);
    }
}

/* Binary files of the machine's own byte order, which is little-endian wherever this runs. */
static void write_stl(FILE *file, const struct mesh_sample *sample)
{
    const char header[80] = "a ring";
    const uint32_t count = (uint32_t)sample->triangles;
    put_number(file, header, sizeof header);
    put_number(file, &count, sizeof count);
    for (size_t i = 0; i < sample->triangles; i++) {
        float facet[12] = {0.0f};
        for (size_t k = 0; k < 9; k++)
            facet[3 + k] = (float)sample->positions[3 * sample->corners[3 * i + k / 3] + k % 3];
        put_number(file, facet, sizeof facet);
        put_number(file, "\0\0", 2);
    }
}

static void write_ply(FILE *file, const struct mesh_sample *sample)
{
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\n"
            "property float y\nproperty float z\nelement face %zu\n"
            "property list uchar int vertex_indices\nend_header\n",
            sample->vertices, sample->triangles);
    for (size_t i = 0; i < 3 * sample->vertices; i++) {
        const float value = (float)sample->positions[i];
        put_number(file, &value, sizeof value);
    }
    for (size_t i = 0; i < sample->triangles; i++) {
        put_number(file, "\3", 1);
        put_number(file, &sample->corners[3 * i], 3 * sizeof *sample->corners);
    }
}

static void write_obj(FILE *file, const struct mesh_sample *sample)
{
    for (size_t i = 0; i < sample->vertices; i++)
        fprintf(file, "v %.6f %.6f %.6f\n", sample->positions[3 * i], sample->positions[3 * i + 1],
                sample->positions[3 * i + 2]);
    for (size_t i = 0; i < sample->triangles; i++)
        fprintf(file, "f %u %u %u\n", sample->corners[3 * i] + 1, sample->corners[3 * i + 1] + 1,
                sample->corners[3 * i + 2] + 1);
}

static void write_file(const char *path, const struct mesh_sample *sample,
                       void (*write)(FILE *file, const struct mesh_sample *sample))
{
    FILE *file = fopen(path, "wb");
    if (!file) {
        perror(path);
        exit(1);
    }
    write(file, sample);
    if (fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

static void time_bytes(const char *path, struct stopwatch *best, size_t *bytes)
{
    for (int i = 0; i < REPEATS; i++) {
        struct report report = {{0}, NULL, NULL};
        char *text = NULL;
        const struct stopwatch start = now();
        if (file_read_whole(&report, path, (size_t)1 << 30, &text, bytes) != SONJECT_OK)
            exit(1);
        keep_best(best, start, i == 0);
        free(text);
    }
}

/* Parsed and welded, no more. */
static void time_reader(const char *path, struct stopwatch *best)
{
    for (int i = 0; i < REPEATS; i++) {
        struct report report = {{0}, NULL, NULL};
        struct mesh_soup soup = {.report = &report, .path = path};
        const struct stopwatch start = now();
        if (mesh_file_read(&soup) != SONJECT_OK)
            exit(1);
        keep_best(best, start, i == 0);
        mesh_soup_clear(&soup);
    }
}

static void time_hierarchy(const char *path, struct stopwatch *topology_s,
                           struct stopwatch *hierarchy_s)
{
    struct report report = {{0}, NULL, NULL};
    struct mesh_options options;
    struct mesh mesh;
    mesh_options_init(&options);
    if (mesh_load(&report, path, &options, &mesh) != SONJECT_OK)
        exit(1);
    for (int i = 0; i < REPEATS; i++) {
        struct mesh_topology topology;
        struct mesh_hierarchy hierarchy;
        struct stopwatch start = now();
        if (mesh_topology_find(&report, mesh.vertices, mesh.vertex_count, mesh.corners,
                               mesh.triangle_count, &topology) != SONJECT_OK)
            exit(1);
        keep_best(topology_s, start, i == 0);
        start = now();
        if (mesh_hierarchy_build(&report, mesh.vertices, mesh.corners, mesh.triangle_count,
                                 mesh.radius_m, &hierarchy) != SONJECT_OK)
            exit(1);
        keep_best(hierarchy_s, start, i == 0);
        mesh_hierarchy_clear(&hierarchy);
    }
    mesh_clear(&mesh);
}

/* A scene with the mesh of a file, or with a torus where there is none. */
static sonject_scene *make_scene(sonject_context *context, const char *path, int is_rough)
{
    char text[1200], shape[600] = "torus, diameter: 2, height: 0.7";
    const sonject_scene_read_params params = {.struct_size = sizeof params, .text = text};
    sonject_scene *scene;
    if (path)
        snprintf(shape, sizeof shape, "mesh, mesh: \"%s\"", path);
    snprintf(text, sizeof text,
             "sonject: 1\n"
             "input: {uniform: {rows: %d, columns: %d}, geometry: {row_spacing: 0.025,\n"
             "  column_spacing: 0.025, first_slant_range: 45}}\n"
             "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
             "objects: [{shape: %s%s}]\n",
             PIXELS, PIXELS, shape, is_rough ? ", material: {reflection: 0, lambert: 0.1}" : "");
    expect(context, sonject_scene_read(context, NULL, &params, &scene));
    return scene;
}

struct image_times {
    struct stopwatch scene_s, whole_s;
    double trace_s, form_s;
};

static void time_image(sonject_context *context, const char *path, int is_rough,
                       struct image_times *times)
{
    memset(times, 0, sizeof *times);
    for (int i = 0; i <= REPEATS; i++) { /* once to fill the caches */
        sonject_result *result;
        sonject_statistics statistics;
        const struct stopwatch start = now();
        sonject_scene *scene = make_scene(context, path, is_rough);
        keep_best(&times->scene_s, start, i <= 1);
        expect(context, sonject_inject(context, scene, NULL, NULL, NULL, &result));
        keep_best(&times->whole_s, start, i <= 1);
        memset(&statistics, 0, sizeof statistics);
        statistics.struct_size = sizeof statistics;
        expect(context, sonject_result_statistics(result, &statistics));
        times->trace_s = statistics.trace_s;
        times->form_s = statistics.form_s;
        sonject_result_release(&result);
        sonject_scene_release(&scene);
    }
}

static void print_image(const char *what, const struct image_times *times)
{
    printf("%s: %.2f s (%.2f s); of this scene %.2f s (%.2f s), trace %.2f s, form %.2f s\n", what,
           times->whole_s.clock_s, times->whole_s.processor_s, times->scene_s.clock_s,
           times->scene_s.processor_s, times->trace_s, times->form_s);
}

static void time_file(sonject_context *context, const char *path, int all)
{
    struct stopwatch bytes_s, reader_s, topology_s, hierarchy_s;
    struct image_times times;
    size_t bytes = 0;
    time_bytes(path, &bytes_s, &bytes);
    time_reader(path, &reader_s);
    time_hierarchy(path, &topology_s, &hierarchy_s);
    printf("%s, %.1f MB: bytes alone %.3f s (%.3f s); read %.2f s (%.2f s), topology %.2f s "
           "(%.2f s), hierarchy %.2f s (%.2f s)\n",
           strrchr(path, '.') + 1, 1e-6 * (double)bytes, bytes_s.clock_s, bytes_s.processor_s,
           reader_s.clock_s, reader_s.processor_s, topology_s.clock_s, topology_s.processor_s,
           hierarchy_s.clock_s, hierarchy_s.processor_s);
    time_image(context, path, 1, &times);
    print_image("  file to image, rough", &times);
    if (!all)
        return;
    time_image(context, path, 0, &times);
    print_image("  file to image, smooth", &times);
}

int main(void)
{
    static void (*const writers[])(FILE *, const struct mesh_sample *) = {write_stl, write_ply,
                                                                          write_obj};
    static const char *const names[] = {"ring.stl", "ring.ply", "ring.obj"};
    const char *temporary = getenv("TMPDIR");
    char folder[512], path[600];
    struct mesh_sample sample;
    struct image_times times;
    sonject_context *context;
    snprintf(folder, sizeof folder, "%s/sonject-mesh-XXXXXX", temporary ? temporary : "/tmp");
    if (!mkdtemp(folder) || sonject_context_create(NULL, &context) != SONJECT_OK)
        return 1;
    sample_ring(&sample, AROUND, ACROSS);
    printf("mesh of %zu triangles, patch of %d x %d pixels\n", sample.triangles, PIXELS, PIXELS);
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        write_file(path, &sample, writers[i]);
        time_file(context, path, i == 0);
        unlink(path);
    }
    for (int is_rough = 1; is_rough >= 0; is_rough--) {
        time_image(context, NULL, is_rough, &times);
        print_image(is_rough ? "torus to image, rough" : "torus to image, smooth", &times);
    }
    rmdir(folder);
    sample_clear(&sample);
    sonject_context_release(&context);
    return 0;
}
