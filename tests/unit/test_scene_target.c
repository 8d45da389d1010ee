/* Files of targets put into scenes that are in memory: the same scene as by a scene file, and a
 * scene that stays as it was where the file is refused. */
#define _POSIX_C_SOURCE 200809L

#include <sonject/sonject.h>

#include "api/handles.h"
#include "claims.h"
#include "inject/scene_hash.h"
#include "scene_folder.h"

#define TARGETS SOURCE_ROOT "/tools/targets/"
#define IMAGE                                                                                      \
    "sonject: 1\n"                                                                                 \
    "input: {uniform: {rows: 40, columns: 50}, geometry: {row_spacing: 0.1, column_spacing: 0.1, " \
    "first_slant_range: 40}}\n"                                                                    \
    "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
#define OBJECTS                                                                                    \
    "objects:\n"                                                                                   \
    "  - {target: " TARGETS "crab_pot_frame.yaml, heading: 0.5 rad, burial: {fraction: 0.25}}\n"   \
    "  - {target: " TARGETS "rock.yaml, name: stone, pitch: 0.1 rad, roll: 0.2 rad,\n"             \
    "     position: {along_track: 1, slant_range: 42}, level: {over_seabed: 12}}\n"                \
    "  - {target: " TARGETS "boulder_relief.yaml, class: rock, position: {row: 7, column: 9}}\n"   \
    "  - {target: " TARGETS "tyre.yaml, burial: 0.125}\n"

static void hash_of(const struct scene *scene, char text[HASH_TEXT_CAPACITY])
{
    struct report report = {{0}, NULL, NULL};
    assert_int_equal(scene_hash(&report, scene, "", text), SONJECT_OK);
}

/* A scene in memory, of IMAGE. */
static sonject_scene *make_scene(sonject_context *context, struct scene_folder *folder)
{
    sonject_scene *scene = NULL;
    write_scene(folder, IMAGE, strlen(IMAGE));
    assert_int_equal(sonject_scene_read(context, folder->file, NULL, &scene), SONJECT_OK);
    return scene;
}

static sonject_scene_read_params allowing(void)
{
    sonject_scene_read_params params;
    sonject_scene_read_params_init(&params);
    params.allows_user_shapes = 1;
    return params;
}

static void add(sonject_context *context, sonject_scene *scene, const char *path,
                const sonject_object_params *placing)
{
    uint32_t index = 99;
    uint32_t count = 0;
    const sonject_scene_read_params params = allowing();
    if (sonject_scene_add_target(scene, path, &params, placing, &index) != SONJECT_OK)
        fail_msg("refused: %s", sonject_context_message(context));
    assert_int_equal(sonject_scene_object_count(scene, &count), SONJECT_OK);
    assert_int_equal(index, count - 1);
}

static void add_all(sonject_context *context, sonject_scene *scene)
{
    sonject_object_params placing;
    sonject_object_params_init(&placing);
    placing.heading_rad = 0.5;
    placing.burial_kind = SONJECT_BURIAL_FRACTION;
    placing.burial_fraction = 0.25;
    placing.diameter_m = 7.0; /* the file's counts */
    add(context, scene, TARGETS "crab_pot_frame.yaml", &placing);

    sonject_object_params_init(&placing);
    strcpy(placing.name, "stone");
    placing.pitch_rad = 0.1;
    placing.roll_rad = 0.2;
    placing.position_kind = SONJECT_POSITION_METRES;
    placing.position_along = 1.0;
    placing.position_range = 42.0;
    placing.level_kind = SONJECT_LEVEL_OVER_SEABED;
    placing.level_db = 12.0;
    add(context, scene, TARGETS "rock.yaml", &placing);

    sonject_object_params_init(&placing);
    strcpy(placing.class_name, "rock");
    placing.position_kind = SONJECT_POSITION_PIXELS;
    placing.position_along = 7.0;
    placing.position_range = 9.0;
    add(context, scene, TARGETS "boulder_relief.yaml", &placing);

    sonject_object_params_init(&placing);
    placing.burial_m = 0.125;
    add(context, scene, TARGETS "tyre.yaml", &placing);
}

static void test_the_scene_is_that_of_a_scene_file(void **state)
{
    char expected[HASH_TEXT_CAPACITY];
    char made[HASH_TEXT_CAPACITY];
    struct scene_folder *folder = *state;
    struct sonject_scene *scene;
    sonject_context *context = NULL;
    assert_int_equal(sonject_context_create(NULL, &context), SONJECT_OK);
    scene = make_scene(context, folder);
    add_all(context, scene);
    hash_of(&scene->scene, made);
    write_scene(folder, IMAGE OBJECTS, strlen(IMAGE OBJECTS));
    if (scene_file_read_with(&folder->report, folder->file, NULL, 0, true, &folder->scene) !=
        SONJECT_OK)
        fail_msg("refused: %s", folder->report.message);
    hash_of(&folder->scene, expected);
    assert_string_equal(made, expected);
    assert_string_equal(scene->scene.objects[1].name, "stone");
    assert_string_equal(scene->scene.objects[2].class_name, "rock");
    assert_string_equal(scene->scene.objects[3].name, folder->scene.objects[3].name);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
}

/* Refused after some of it was taken into the scene already. */
static const struct {
    const char *text, *words;
} refused[] = {
    {"sonject_target: 1\nparts:\n"
     "  - {shape: mesh, mesh: " TARGETS "rock.obj}\n"
     "  - {shape: user, user: {file: " TARGETS "boulder_relief.cl, bounding_radius: 1}}\n"
     "  - {shape: sphere}\n",
     "target.yaml:5:5: parts[2].diameter: missing"},
    {"sonject_target: 1\nshape: mesh\nmesh: " TARGETS "rock.obj\ndiameter: 1\n", "diameter"},
    {"", "there is nothing in it"},
    {"sonject: 1\n", "unknown key"},
    {"sonject_target: 1\ntarget: other.yaml\n", "unknown key"},
};

static void test_refused_files_leave_the_scene(void **state)
{
    char path[SCENE_FOLDER_CAPACITY + 16];
    char before[HASH_TEXT_CAPACITY];
    char after[HASH_TEXT_CAPACITY];
    struct scene_folder *folder = *state;
    sonject_context *context = NULL;
    const sonject_scene_read_params params = allowing();
    assert_int_equal(sonject_context_create(NULL, &context), SONJECT_OK);
    struct sonject_scene *scene = make_scene(context, folder);
    add_all(context, scene);
    hash_of(&scene->scene, before);
    snprintf(path, sizeof path, "%s/target.yaml", folder->folder);
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        uint32_t index = 99;
        write_file(folder, "target.yaml", refused[i].text, strlen(refused[i].text));
        assert_int_equal(sonject_scene_add_target(scene, path, &params, NULL, &index),
                         SONJECT_ERROR_INPUT);
        if (!strstr(sonject_context_message(context), refused[i].words))
            fail_msg("\"%s\" is not in %s", refused[i].words, sonject_context_message(context));
        assert_int_equal(index, 99);
        hash_of(&scene->scene, after);
        assert_string_equal(after, before);
    }
    (void)unlink(path);
    add_all(context, scene); /* goes on as if nothing had been */
    assert_int_equal(scene->scene.mesh_count, 1);
    assert_int_equal(scene->scene.user_shapes.snippet_count, 1);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
}

static void test_what_the_caller_gives_is_checked(void **state)
{
    struct scene_folder *folder = *state;
    sonject_context *context = NULL;
    sonject_object_params placing;
    assert_int_equal(sonject_context_create(NULL, &context), SONJECT_OK);
    sonject_scene *scene = make_scene(context, folder);
    static const char tyre[] = TARGETS "tyre.yaml";
    assert_int_equal(sonject_scene_add_target(NULL, tyre, NULL, NULL, NULL),
                     SONJECT_ERROR_ARGUMENT);
    assert_int_equal(sonject_scene_add_target(scene, NULL, NULL, NULL, NULL),
                     SONJECT_ERROR_ARGUMENT);
    assert_int_equal(
        sonject_scene_add_target(scene, TARGETS "boulder_relief.yaml", NULL, NULL, NULL),
        SONJECT_ERROR_INPUT);
    assert_non_null(strstr(sonject_context_message(context), "--allow-user-shapes"));
    assert_int_equal(sonject_scene_add_target(scene, "none.yaml", NULL, NULL, NULL),
                     SONJECT_ERROR_INPUT);
    assert_string_equal(sonject_context_message(context),
                        "none.yaml: there is no such target file; check its name");
    sonject_object_params_init(&placing);
    placing.burial_kind = SONJECT_BURIAL_FRACTION;
    placing.burial_fraction = 2.0;
    assert_int_equal(sonject_scene_add_target(scene, tyre, NULL, &placing, NULL),
                     SONJECT_ERROR_INPUT);
    sonject_object_params_init(&placing);
    memset(placing.name, 'x', sizeof placing.name); /* without an end */
    assert_int_equal(sonject_scene_add_target(scene, tyre, NULL, &placing, NULL),
                     SONJECT_ERROR_INPUT);
    assert_int_equal(sonject_scene_add_target(scene, tyre, NULL, NULL, NULL), SONJECT_OK);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder, TEST(test_the_scene_is_that_of_a_scene_file),
             TEST(test_refused_files_leave_the_scene), TEST(test_what_the_caller_gives_is_checked))
