/* Meshes that Assimp reads: that nodes put them where they belong, and what is refused before
 * Assimp sees it. Whole files of each format are read in test_mesh_file.c, spoilt ones in
 * test_mesh_hostile.c. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>

#include "mesh/mesh.h"
#include "temporary_folder.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static struct report report;

static sonject_status load(struct temporary_folder *folder, const char *name, const char *text,
                           struct mesh *mesh)
{
    struct mesh_options options;
    mesh_options_init(&options);
    report.message[0] = '\0';
    write_bytes(temporary_file(folder, name), text, strlen(text));
    return mesh_load(&report, folder->file, &options, mesh);
}

/* The corner of a box of 1 x 2 x 3, whose volume is 1: one accessor of coordinates, one of corners.
 */
#define GLTF_NUMBERS                                                                               \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAEBAAAACAAEAAAABAAMAAAADAAIAAQA"  \
    "CAAMA"
#define GLTF(nodes)                                                                                \
    "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, " nodes ", \"meshes\": [{\"primitives\": "  \
    "[{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}]}], \"buffers\": [{\"uri\": "            \
    "\"data:application/octet-stream;base64," GLTF_NUMBERS "\", \"byteLength\": 72}], "            \
    "\"bufferViews\": [{\"buffer\": 0, \"byteOffset\": 0, \"byteLength\": 48}, {\"buffer\": 0, "   \
    "\"byteOffset\": 48, \"byteLength\": 24}], \"accessors\": [{\"bufferView\": 0, "               \
    "\"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\", \"min\": [0, 0, 0], \"max\": [1, " \
    "2, 3]}, {\"bufferView\": 1, \"componentType\": 5123, \"count\": 12, \"type\": \"SCALAR\"}]}"

/* Where the mesh lies along each axis, and what it encloses: pieces that show their insides to each
 * other's outsides, or a mirror that is forgotten, give another volume. */
static void test_nodes_put_meshes_in_their_places(void **state)
{
    static const struct {
        const char *name, *text;
        size_t triangles;
        double lower[3], upper[3], volume;
    } cases[] = {
        {"a.off",
         "OFF\n8 6 12\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 2\n1 0 2\n1 1 2\n0 1 2\n4 0 3 2 1\n4 4 5 6 "
         "7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n",
         12,
         {0.0, 0.0, 0.0},
         {1.0, 1.0, 2.0},
         2.0},
        /* twice: moved, and within a turned and moved node stretched, which is a mirror */
        {"a.gltf",
         GLTF("\"scenes\": [{\"nodes\": [0, 2]}], \"nodes\": [{\"children\": [1], "
              "\"translation\": [0, 20, 0], \"rotation\": [0, 0, 0.70710678, 0.70710678]}, "
              "{\"mesh\": 0, \"scale\": [2, 1, -1]}, {\"mesh\": 0, \"matrix\": [1, 0, 0, 0, 0, 1, "
              "0, 0, 0, 0, 1, 0, 10, 0, 0, 1]}]"),
         8,
         {-2.0, 0.0, -3.0},
         {11.0, 22.0, 3.0},
         3.0},
        /* a mesh that no node shows is not there */
        {"a.GLTF",
         GLTF("\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0, \"scale\": [-1, 1, 1]}, "
              "{\"mesh\": 0, \"translation\": [9, 9, 9]}]"),
         4,
         {-1.0, 0.0, 0.0},
         {0.0, 2.0, 3.0},
         1.0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct mesh mesh;
        if (load(*state, cases[i].name, cases[i].text, &mesh) != SONJECT_OK)
            fail_msg("case %zu: %s", i, report.message);
        assert_int_equal(mesh.triangle_count, cases[i].triangles);
        assert_true(mesh.topology.is_closed);
        for (int axis = 0; axis < 3; axis++) {
            const double lower = mesh.centre_m[axis] + (double)mesh.lower_m[axis];
            const double upper = mesh.centre_m[axis] + (double)mesh.upper_m[axis];
            /* Assimp computes in single precision: 20 units of a few 2^-24 */
            if (fabs(lower - cases[i].lower[axis]) > 1e-5 ||
                fabs(upper - cases[i].upper[axis]) > 1e-5)
                fail_msg("case %zu: axis %d from %g to %g", i, axis, lower, upper);
        }
        if (fabs(mesh.volume_m3 - cases[i].volume) > 1e-5)
            fail_msg("case %zu: a volume of %g, not %g", i, mesh.volume_m3, cases[i].volume);
        assert_int_equal(mesh.topology.turned, 0);
        mesh_clear(&mesh);
    }
}

#define GLTF_TREE "\"scenes\": [{\"nodes\": [0]}], \"nodes\": "

static void test_what_is_refused(void **state)
{
    static const struct {
        const char *name, *text, *message;
    } cases[] = {
        {"a.off", "", "line 1: expected 'OFF'"},
        {"a.off", "# OFF\nBLENDER", "line 2: expected 'OFF', found 'BLENDER'"},
        {"a.off", "OFF\n4000000000 4 0\n0 0 0\n", "more than a file of"},
        {"a.off", "OFF 4 99999999999999 0\n0 0 0\n", "more than a file of"},
        {"a.off", "OFF -4 4 0\n0 0 0\n", "more than a file of"},
        {"a.off", "OFF 4\n", "expected numbers of vertices and faces"},
        {"a.gltf", "{\"asset\": {\"version\": \"1.0\"}}", "not a glTF document of version 2"},
        {"a.gltf", "[[[", "line 1: "},
        {"a.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"accessors\": [{\"count\": 4000000000}]}",
         "a count is more than"},
        {"a.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": -1}]}",
         "a byteLength is more than"},
        {"a.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 1e300}]}",
         "a byteLength is more than"},
        {"a.gltf",
         "{\"asset\": {\"version\": \"2.0\"}, \"x\": [{\"KHR_draco_mesh_compression\": {}}]}",
         "its meshes are compressed"},
        {"a.gltf", GLTF(GLTF_TREE "[{\"children\": [0]}]"), "do not form trees"},
        {"a.gltf", GLTF(GLTF_TREE "[{\"children\": [1, 1]}, {\"mesh\": 0}]"), "do not form trees"},
        {"a.gltf", GLTF(GLTF_TREE "[{\"children\": [7]}]"), "do not form trees"},
        {"a.gltf",
         GLTF("\"scenes\": [{\"nodes\": [0, 1]}], \"nodes\": [{\"children\": [1]}, {\"mesh\": 0}]"),
         "do not form trees"},
        {"a.gltf", GLTF(GLTF_TREE "[{\"mesh\": 0, \"translation\": [1e39, 0, 0]}]"), "a.gltf: "},
        {"a.glb", "glTF", "is not a whole GLB file"},
        {"a.glb", "glTF\2, and something else", "is not a whole GLB file"},
    };
    struct mesh mesh;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const sonject_status status = load(*state, cases[i].name, cases[i].text, &mesh);
        if (status != SONJECT_ERROR_INPUT || !strstr(report.message, cases[i].message) ||
            !strstr(report.message, cases[i].name) || strchr(report.message, '\n'))
            fail_msg("case %zu: status %d, '%s' is not '%s'", i, (int)status, report.message,
                     cases[i].message);
        assert_null(mesh.vertices);
    }
    assert_int_equal(load(*state, "a.blend", "BLENDER", &mesh), SONJECT_ERROR_UNSUPPORTED);
    assert_non_null(strstr(report.message, ".gltf"));
}

/* Few bytes that are shown again and again. */
static void test_repetitions(void **state)
{
    static char text[1 << 20];
    struct mesh mesh;
    size_t length =
        (size_t)snprintf(text, sizeof text,
                         "{\"asset\": {\"version\": \"2.0\"}, \"accessors\": [{\"count\": "
                         "60000}], \"meshes\": [{\"primitives\": [{}");
    while (length < sizeof text - 100)
        length += (size_t)snprintf(text + length, sizeof text - length,
                                   ", {\"attributes\": {\"POSITION\": 0}}");
    snprintf(text + length, sizeof text - length, "]}]}");
    assert_int_equal(load(*state, "a.gltf", text, &mesh), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "too many times"));
    length =
        (size_t)snprintf(text, sizeof text, "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{}");
    for (int i = 0; i < 300; i++)
        length +=
            (size_t)snprintf(text + length, sizeof text - length, ", {\"children\": [%d]}", i);
    snprintf(text + length, sizeof text - length, "]}");
    assert_int_equal(load(*state, "a.gltf", text, &mesh), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "256 levels"));
}

/* One place of a sound document changed. */
static void test_numbers_beyond_their_buffers(void **state)
{
    static const char good[] = GLTF("\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]");
    static const struct {
        const char *was, *is;
    } changes[] = {
        {"\"count\": 12", "\"count\": 13"},
        {"\"count\": 4,", "\"count\": 5,"},
        {"\"count\": 4,", "\"count\": 0,"},
        {"\"byteOffset\": 48", "\"byteOffset\": 49"},
        {"\"byteLength\": 24", "\"byteLength\": 23"},
        {"\"byteLength\": 24", "\"byteStride\": 1, \"byteLength\": 24"},
        {"\"bufferView\": 1", "\"bufferView\": 2"},
        {"\"bufferView\": 1", "\"nothing\": 1"},
        {"5123", "5126"},
        {"5126", "5123"},
        {"VEC3", "VEC4"},
        {"\"indices\": 1", "\"indices\": 9"},
        {"\"type\": \"VEC3\"", "\"type\": \"VEC3\", \"sparse\": {}"},
    };
    struct mesh mesh;
    for (size_t i = 0; i < COUNT(changes); i++) {
        char text[2 * sizeof good];
        const char *at = strstr(good, changes[i].was);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, changes[i].is,
                 at + strlen(changes[i].was));
        if (load(*state, "a.gltf", text, &mesh) != SONJECT_ERROR_INPUT ||
            !strstr(report.message, "within their buffers"))
            fail_msg("%s for %s: '%s'", changes[i].is, changes[i].was, report.message);
    }
}

/* No file makes another one be read, even if that is there. */
static void test_other_files_are_not_read(void **state)
{
    static const char text[] =
        "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], "
        "\"nodes\": [{\"mesh\": 0}], \"meshes\": [{\"primitives\": [{\"attributes\": "
        "{\"POSITION\": 0}}]}], \"buffers\": [{\"uri\": \"other.bin\", \"byteLength\": 36}], "
        "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], \"accessors\": [{\"bufferView\": "
        "0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}]}";
    static const float triangle[9] = {1.0f, 0.0f, 0.0f, 0.0f, 1.0f};
    struct mesh mesh;
    write_bytes(temporary_file(*state, "other.bin"), triangle, sizeof triangle);
    assert_int_equal(load(*state, "a.gltf", text, &mesh), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "other.bin"));
}

/* What Assimp has to say it says in messages, not on the streams of a program. */
static void test_nothing_is_printed(void **state)
{
    struct mesh mesh;
    struct stat written;
    const char *path = temporary_file(*state, "streams");
    const int file = open(path, O_CREAT | O_WRONLY, 0600);
    const int streams[2] = {dup(1), dup(2)};
    assert_true(file >= 0 && streams[0] >= 0 && streams[1] >= 0);
    fflush(stdout);
    dup2(file, 1);
    dup2(file, 2);
    const sonject_status good =
        load(*state, "a.gltf", GLTF("\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]"),
             &mesh);
    mesh_clear(&mesh);
    const sonject_status bad = load(*state, "a.gltf", "{\"asset\": {\"version\": \"2.0\"}}", &mesh);
    const sonject_status worse = load(*state, "a.off", "OFF 4 4 0\n0 0 0\n0 1", &mesh);
    fflush(stdout);
    fflush(stderr);
    dup2(streams[0], 1);
    dup2(streams[1], 2);
    close(streams[0]);
    close(streams[1]);
    assert_int_equal(fstat(file, &written), 0);
    close(file);
    assert_int_equal(good, SONJECT_OK);
    assert_int_equal(bad, SONJECT_ERROR_INPUT);
    assert_int_equal(worse, SONJECT_ERROR_INPUT);
    assert_int_equal(written.st_size, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nodes_put_meshes_in_their_places),
        cmocka_unit_test(test_what_is_refused),
        cmocka_unit_test(test_repetitions),
        cmocka_unit_test(test_numbers_beyond_their_buffers),
        cmocka_unit_test(test_other_files_are_not_read),
        cmocka_unit_test(test_nothing_is_printed),
    };
    return cmocka_run_group_tests(tests, make_temporary_folder, remove_temporary_folder);
}
