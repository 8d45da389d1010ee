/* Tests meshes in scene files: how their numbers are meant, that one is kept however many shapes
 * show it, and messages about meshes that cannot be read. */
#include "claims.h"

#include <sys/stat.h>

#include "base/system/file_system.h"
#include "inject/scene_hash.h"
#include "scene_folder.h"

#define SCENE BASE "objects:\n"

/* A corner of a box: four faces, 1 x 2 x 3 units. */
static const char corner[] = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n"
                             "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

static void expect_size(double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    const struct mesh *mesh = &folder->scene.meshes[folder->scene.objects[0].mesh];
    for (int axis = 0; axis < 3; axis++) {
        const double size = (double)mesh->upper_m[axis] - (double)mesh->lower_m[axis];
        if (fabs(size / expected[axis] - 1.0) > 1e-6) /* a few roundings to single precision */
            fail_msg("axis %d is %g m long and not %g", axis, size, expected[axis]);
    }
}

TEST(test_units_and_axes)
{
    static const struct {
        const char *keys;
        double size[3];
    } cases[] = {
        {"corner.obj", {1.0, 2.0, 3.0}},
        {"{file: corner.obj}", {1.0, 2.0, 3.0}},
        {"{file: corner.obj, unit: m}", {1.0, 2.0, 3.0}},
        {"{file: corner.obj, unit: cm}", {0.01, 0.02, 0.03}},
        {"{file: corner.obj, unit: 2.54 cm}", {0.0254, 0.0508, 0.0762}},
        {"{file: corner.obj, unit: 0.5}", {0.5, 1.0, 1.5}},
        {"{file: corner.obj, up: y}", {1.0, 3.0, 2.0}},
        {"{file: corner.obj, up: -z, nose: y}", {2.0, 1.0, 3.0}},
        {"{file: corner.obj, nose: -z, up: x, unit: mm}", {0.003, 0.002, 0.001}},
    };
    write_file("corner.obj", corner, sizeof corner - 1);
    for (size_t i = 0; i < COUNT(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, SCENE "  - shape: mesh\n    mesh: %s\n", cases[i].keys);
        expect_scene_taken(text);
        assert_int_equal(folder->scene.objects[0].shape, SHAPE_MESH);
        expect_size(cases[i].size[0], cases[i].size[1], cases[i].size[2]);
    }
}

/* In all 24 ways to choose nose and up the mesh is turned, not mirrored: own y = up x nose. */
TEST(test_axes_turn)
{
    static const char *const names[] = {"x", "y", "z", "-x", "-y", "-z"};
    write_file("corner.obj", corner, sizeof corner - 1);
    for (int nose = 0; nose < 6; nose++)
        for (int up = 0; up < 6; up++) {
            char text[1000];
            snprintf(text, sizeof text,
                     SCENE "  - {shape: mesh, mesh: {file: corner.obj, nose: %s, up: %s}}\n",
                     names[nose], names[up]);
            if (nose % 3 == up % 3) {
                expect_scene_refused(text,
                                     ":5:25: objects[0].mesh: nose and up are the same axis of the "
                                     "file; give both, such as nose: x, up: y");
                continue;
            }
            expect_scene_taken(text);
            const int *axes = folder->scene.meshes[0].options.axes;
            double n[3] = {0.0, 0.0, 0.0};
            double u[3] = {0.0, 0.0, 0.0};
            n[nose % 3] = nose < 3 ? 1.0 : -1.0;
            u[up % 3] = up < 3 ? 1.0 : -1.0;
            const double y[3] = {u[1] * n[2] - u[2] * n[1], u[2] * n[0] - u[0] * n[2],
                                 u[0] * n[1] - u[1] * n[0]};
            const double *const wanted[3] = {n, y, u};
            for (int axis = 0; axis < 3; axis++)
                assert_true(wanted[axis][abs(axes[axis]) - 1] == (axes[axis] < 0 ? -1.0 : 1.0));
        }
}

/* Objects, parts and targets that name one file share one mesh. Other options or another content
 * make another mesh. Names count from the file that holds them. */
TEST(test_meshes_are_shared)
{
    static const char target[] = "sonject_target: 1\nshape: mesh\nmesh: corner.obj\n";
    static const char scene[] =
        SCENE "  - {shape: mesh, mesh: parts/corner.obj}\n"
              "  - target: parts/target.yaml\n"
              "  - parts:\n"
              "      - {shape: mesh, mesh: {file: parts/../parts/corner.obj}}\n"
              "      - {shape: mesh, mesh: {file: parts/corner.obj, unit: cm}}\n"
              "  - {shape: mesh, mesh: {file: parts/corner.obj, smooth: 40 deg}}\n"
              "  - {shape: mesh, mesh: {file: parts/copy.obj, up: z}}\n";
    assert_int_equal(folder_make_one(file_in("parts")), 0);
    write_file("parts/corner.obj", corner, sizeof corner - 1);
    write_file("parts/copy.obj", corner, sizeof corner - 1);
    write_file("parts/target.yaml", target, sizeof target - 1);
    expect_scene_taken(scene);
    const struct scene *read = &folder->scene;
    assert_int_equal(read->mesh_count, 4);
    assert_int_equal(read->objects[0].mesh, 0);
    assert_int_equal(read->objects[1].mesh, 0);
    assert_int_equal(read->parts[0].shape.mesh, 0);
    assert_int_equal(read->parts[1].shape.mesh, 1);
    assert_int_equal(read->objects[3].mesh, 2);
    assert_true(read->meshes[0].normals == NULL && read->meshes[2].normals != NULL);
    assert_int_equal(read->objects[4].mesh, 3);
}

/* Reads a scene of one mesh from the store, which gets it back. Returns the mesh's vertices. */
static const float *read_stored(struct mesh_store *store, const char *keys)
{
    struct report report = {.host = NULL};
    struct scene scene;
    char text[512];
    snprintf(text, sizeof text, SCENE "  - {shape: mesh, mesh: %s}\n", keys);
    const struct scene_source source = {.path = folder->file, .text = text};
    scene_init(&scene);
    scene.mesh_store = store;
    if (scene_source_read(&source, &report, &scene) != SONJECT_OK)
        fail_msg("refused: %s", report.message);
    assert_int_equal(scene.mesh_count, 1);
    const float *vertices = scene.meshes[0].vertices;
    scene_clear(&scene);
    return vertices;
}

TEST(test_meshes_are_kept_from_scene_to_scene)
{
    struct mesh_store store;
    memset(&store, 0, sizeof store);
    write_file("corner.obj", corner, sizeof corner - 1);
    const float *first = read_stored(&store, "corner.obj");
    assert_ptr_equal(read_stored(&store, "corner.obj"), first);
    assert_int_equal(store.count, 1);
    const uint64_t bytes = store.bytes;
    /* other options, or a file that has changed, make another mesh */
    assert_ptr_not_equal(read_stored(&store, "{file: corner.obj, unit: cm}"), first);
    assert_int_equal(store.count, 2);
    write_file("corner.obj", corner, sizeof corner - 2);
    assert_ptr_not_equal(read_stored(&store, "corner.obj"), first);
    assert_int_equal(store.count, 3);
    assert_int_equal(store.bytes, 3 * bytes);
    /* the oldest mesh leaves a store that is full */
    for (int i = 0; i < MESH_STORE_MESHES; i++) {
        char keys[64];
        snprintf(keys, sizeof keys, "{file: corner.obj, unit: %d}", i + 2);
        (void)read_stored(&store, keys);
    }
    assert_int_equal(store.count, MESH_STORE_MESHES);
    assert_int_equal(store.bytes, MESH_STORE_MESHES * bytes);
    for (size_t i = 0; i < store.count; i++)
        assert_true(store.meshes[i].options.unit_m > 1.5);
    mesh_store_clear(&store);
    assert_int_equal(store.bytes, 0);
}

#define MESH(keys) SCENE "  - shape: mesh\n    mesh: " keys "\n"

TEST(test_what_is_refused)
{
    static const struct refusal wrong[] = {
        {SCENE "  - shape: mesh\n", ":5:5: objects[0].mesh: missing; a mesh needs it"},
        {SCENE "  - {shape: sphere, diameter: 1, mesh: corner.obj}\n",
         ":5:40: objects[0].mesh: a sphere has none; remove it"},
        {SCENE "  - {shape: mesh, mesh: corner.obj, length: 1}\n",
         ":5:45: objects[0].length: a mesh has none; remove it"},
        {MESH("{unit: mm}"),
         ":6:11: objects[0].mesh.file: missing; add it (mesh file of triangles: STL, "
         "OBJ or PLY)"},
        {MESH("{file: corner.obj, unit: -1}"),
         ":6:36: objects[0].mesh.unit: must be a length of 1e-9 to 1e9 m, not -1 m"},
    };
    write_file("corner.obj", corner, sizeof corner - 1);
    expect_all_refused(wrong, COUNT(wrong));
    assert_int_equal(folder->scene.mesh_count, 0);
}

static void expect_bad_mesh(const char *name, sonject_status status, const char *what)
{
    char text[1000];
    snprintf(text, sizeof text, MESH("{file: %s}"), name);
    expect_bad_file(text, ":6:18: objects[0].mesh.file", name, status, what);
    assert_int_equal(folder->scene.mesh_count, 0);
}

TEST(test_meshes_that_cannot_be_read)
{
    static const char binary[84 + 50] = {[80] = 2};
    expect_bad_mesh("absent.obj", SONJECT_ERROR_INPUT, "there is no file");
    assert_int_equal(folder_make_one(file_in("folder.stl")), 0);
    expect_bad_mesh("folder.stl", SONJECT_ERROR_STORAGE, "s a directory");
#ifdef HAS_POSIX
    assert_int_equal(mkfifo(file_in("pipe.stl"), 0666), 0);
    expect_bad_mesh("pipe.stl", SONJECT_ERROR_INPUT, "not a regular file");
#endif
    write_file("a.stl", binary, sizeof binary);
    expect_bad_mesh("a.stl", SONJECT_ERROR_INPUT, "the header says 2 triangles, the file holds 1");
}

/* A scene takes as many meshes as it may have, but not one more. */
TEST(test_too_many_meshes)
{
    char text[16384] = SCENE;
    size_t length = strlen(text);
    write_file("corner.obj", corner, sizeof corner - 1);
    for (int i = 0; i <= SCENE_MESHES_MAX; i++) {
        if (i == SCENE_MESHES_MAX)
            expect_scene_taken(text);
        length +=
            (size_t)snprintf(text + length, sizeof text - length,
                             "  - {shape: mesh, mesh: {file: corner.obj, unit: %d mm}}\n", i + 1);
    }
    assert_int_equal(folder->scene.mesh_count, SCENE_MESHES_MAX);
    expect_scene_refused(text,
                         ":69:32: objects[64].mesh.file: meshes must be at most 64 in a scene; "
                         "split it");
}

/* A sheet is refused unless it is said to be one, even if it was read before. */
TEST(test_open_meshes)
{
    static const char sheet[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char both[] = SCENE "  - {shape: mesh, mesh: {file: sheet.obj, open: true}}\n"
                                     "  - {shape: mesh, mesh: {file: sheet.obj}}\n";
    write_file("sheet.obj", sheet, sizeof sheet - 1);
    expect_bad_mesh("sheet.obj", SONJECT_ERROR_INPUT, "does not enclose a volume");
    expect_scene_taken(MESH("{file: sheet.obj, open: true}"));
    assert_false(folder->scene.meshes[0].topology.is_closed);
    expect_bad_file(both, ":6:32: objects[1].mesh.file", "sheet.obj", SONJECT_ERROR_INPUT,
                    "does not enclose a volume");
}

/* A file in millimetres needs a unit, which may then be any. */
TEST(test_a_size_that_no_target_has_asks_for_the_unit)
{
    static const char sheet[] = "v 0 0 0\nv 1500 0 0\nv 0 700 0\nf 1 2 3\n";
    write_file("bomb.obj", sheet, sizeof sheet - 1);
    expect_bad_mesh("bomb.obj", SONJECT_ERROR_INPUT, "does not enclose");
    expect_scene_refused(
        MESH("{file: bomb.obj, open: true}"),
        ":6:18: objects[0].mesh.file: the mesh is 1.5e+03 m long if its numbers are "
        "metres, and sonars are for targets of 1 cm to 100 m: give its unit, such as "
        "unit: mm, or unit: m if that is right");
    expect_scene_taken(MESH("{file: bomb.obj, open: true, unit: m}"));
    expect_scene_taken(MESH("{file: bomb.obj, open: true, unit: mm}"));
}

static void hash_of(const struct scene *scene, char text[HASH_TEXT_CAPACITY])
{
    struct report report = {.host = NULL};
    assert_int_equal(scene_hash(&report, scene, NULL, text), SONJECT_OK);
}

/* The mesh's content counts, not the path of its file. */
TEST(test_the_hash_covers_the_mesh)
{
    static const char text[] = MESH("{file: corner.obj, smooth: 30 deg}");
    char first[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    char changed[sizeof corner];
    write_file("corner.obj", corner, sizeof corner - 1);
    write_file("copy.obj", corner, sizeof corner - 1);
    expect_scene_taken(text);
    hash_of(&folder->scene, first);
    expect_scene_taken(MESH("{file: copy.obj, smooth: 30 deg}"));
    hash_of(&folder->scene, other);
    assert_string_equal(first, other);
    memcpy(changed, corner, sizeof corner);
    *strchr(changed, '3') = '4'; /* same number of bytes */
    write_file("corner.obj", changed, sizeof changed - 1);
    expect_scene_taken(text);
    hash_of(&folder->scene, other);
    assert_string_not_equal(first, other);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
