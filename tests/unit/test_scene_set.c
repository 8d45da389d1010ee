/* Tests keys that calls set. They give the same scene as a file does, and a refused key leaves the
 * scene as it was. */
#include <sonject/sonject.h>

#include "inject/scene_hash.h"
#include "scene_context.h"
#include "temporary_folder.h"

#define HEAD                                                                                       \
    "sonject: 1\n"                                                                                 \
    "input: {geometry: {row_spacing: 0.1, column_spacing: 0.1, first_slant_range: 40}}\n"          \
    "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"

static const struct scene *use(const sonject_scene *scene)
{
    const struct scene *used = NULL;
    EXPECT_OK(&context->report, scene_use(&context->report, scene, &used));
    return used;
}

static void hash_of(const sonject_scene *scene, char text[HASH_TEXT_CAPACITY])
{
    EXPECT_OK(&context->report, scene_hash(&context->report, use(scene), "", text));
}

/* Expects equal hashes, and releases both scenes. */
static void expect_same(sonject_scene *first, sonject_scene *second)
{
    char hashes[2][HASH_TEXT_CAPACITY];
    hash_of(first, hashes[0]);
    hash_of(second, hashes[1]);
    assert_string_equal(hashes[0], hashes[1]);
    sonject_scene_release(&first);
    sonject_scene_release(&second);
}

TEST(a_scene_that_is_set_is_that_of_a_text_that_says_so)
{
    sonject_scene *scene = NULL;
    EXPECT_OK(&context->report, sonject_scene_create(context, &scene));
    set(scene, "input.geometry", "{row_spacing: 0.1, column_spacing: 0.1, first_slant_range: 40}");
    set(scene, "sonar.frequency", "1 kHz");
    set(scene, "sonar", "{frequency: 100e3, bandwidth: 30e3, altitude: 1}");
    set(scene, "sonar.altitude", "11");
    set(scene, "sonar.altitude", "10");
    set(scene, "objects[0]", "{shape: box}");
    set(scene, "objects[0].length", "2");
    set(scene, "objects[1]", "{shape: sphere, diameter: 1}");
    set(scene, "objects[0]", "{\"shape\": \"sphere\", \"diameter\": 0.5}");
    set(scene, "objects[0].heading", "0.1 rad");
    expect_same(scene,
                read_text(NULL, HEAD "objects:\n  - {shape: sphere, diameter: 0.5, heading: 0.1 "
                                     "rad}\n  - {shape: sphere, diameter: 1}\n"));
}

TEST(what_is_set_replaces_what_was_used_before)
{
    sonject_scene *scene = read_text(NULL, HEAD);
    assert_true(use(scene)->input_kind == SONJECT_INPUT_MEMORY);
    set(scene, "sonar.altitude", "0.1000000000000000055511151231257827");
    assert_true(use(scene)->sonar.altitude_m == 0.1);
    set(scene, "sonar.aperture", "0.12345678901234568 rad");
    assert_true(use(scene)->sonar.aperture_rad == 0.12345678901234568);
    set(scene, "input.uniform", "{rows: 4, columns: 5}");
    assert_true(use(scene)->input_kind == SONJECT_INPUT_UNIFORM);
    sonject_scene_release(&scene);
}

TEST(a_call_beats_all_that_was_given_with_the_text)
{
    static const char *const given[] = {"sonar.altitude=5",
                                        "sonar={frequency: 100e3, bandwidth: 30e3, altitude: 6}"};
    sonject_scene *scene = NULL;
    sonject_scene_read_params params = {.struct_size = sizeof params, .text = HEAD};
    params.overrides = given;
    params.override_count = COUNT(given);
    EXPECT_OK(&context->report, sonject_scene_read(context, NULL, &params, &scene));
    assert_true(use(scene)->sonar.altitude_m == 6.0);
    set(scene, "sonar.altitude", "7");
    assert_true(use(scene)->sonar.altitude_m == 7.0);
    sonject_scene_release(&scene);
}

TEST(keys_that_are_none_are_refused_at_once)
{
    static const struct {
        const char *key, *value, *message;
    } cases[] = {
        {"sonar.altitud", "3", "set sonar.altitud: there is no such key; did you mean 'altitude'?"},
        {"altitude", "3", "set altitude: there is no such key"},
        {"sonar", "{altitud: 3}",
         "set sonar: sonar.altitud: unknown key; did you mean 'altitude'?"},
        {"objects[0]", "{shape: sphere, parts: [{shap: box}]}",
         "set objects[0]: objects[0].parts[0].shap: unknown key; did you mean 'shape'?"},
        {"objects[0", "{}", "set objects[0: not a key path; ']' is missing"},
        {"sonar.altitude", "", "set sonar.altitude: has no value; write key.path=value"},
        {"sonar.altitude=", "3", "sonar.altitude=: not a key; its value goes by itself"},
        {"", "3", NULL},
        {"objects[0]", "{shape: ", NULL},
    };
    sonject_scene *scene = read_text(NULL, HEAD "objects: [{shape: sphere, diameter: 1}]\n");
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_int_equal(sonject_scene_set(scene, cases[i].key, cases[i].value),
                         SONJECT_ERROR_INPUT);
        if (cases[i].message)
            assert_string_equal(sonject_context_message(context), cases[i].message);
    }
    assert_int_equal(sonject_scene_set(scene, NULL, "3"), SONJECT_ERROR_ARGUMENT);
    set(scene, "objects[1]", "{shape: sphere, diameter: 2}");
    expect_same(scene,
                read_text(NULL, HEAD "objects: [{shape: sphere, diameter: 1}, {shape: sphere, "
                                     "diameter: 2}]\n"));
}

TEST(values_are_checked_by_the_call_that_uses_the_scene)
{
    sonject_scene *scene = read_text(NULL, HEAD);
    uint32_t count;
    set(scene, "sonar.altitude", "-3 m");
    set(scene, "surface.depth", "ten");
    for (int uses = 0; uses < 2; uses++) {
        assert_int_equal(sonject_scene_object_count(scene, &count), SONJECT_ERROR_INPUT);
        assert_string_equal(sonject_context_message(context),
                            "set sonar.altitude: must be 1e-06...1e+06 m, not -3\n"
                            "set surface.depth: 'ten' is not a number with a unit of m, km, cm, "
                            "mm");
    }
    set(scene, "sonar.altitude", "3 m");
    set(scene, "surface.depth", "10 m");
    assert_int_equal(sonject_scene_object_count(scene, &count), SONJECT_OK);
    sonject_scene_release(&scene);
}

TEST(a_target_is_that_of_a_file)
{
    sonject_scene *scene = read_text(NULL, HEAD);
    set(scene, "objects[0]",
        "{target: " SOURCE_ROOT "/tools/targets/crab_pot_frame.yaml, burial: {fraction: 0.25}}");
    expect_same(scene,
                read_text(NULL, HEAD "objects:\n  - {target: " SOURCE_ROOT
                                     "/tools/targets/crab_pot_frame.yaml, burial: {fraction: "
                                     "0.25}}\n"));
}

TEST(a_mesh_is_kept_while_its_own_keys_stay)
{
    sonject_scene *scene = read_text(NULL, HEAD);
    uint32_t count;
    set(scene, "objects[0]",
        "{shape: mesh, mesh: {file: " SOURCE_ROOT "/tests/unit/tetrahedron.obj, unit: m}}");
    use(scene)->meshes[0].welded = 12345; /* a number that no reading of the file gives */
    set(scene, "injection.seed", "5");
    assert_true(use(scene)->meshes[0].welded == 12345);
    set(scene, "injection.seed", "-5");
    assert_int_equal(sonject_scene_object_count(scene, &count), SONJECT_ERROR_INPUT);
    set(scene, "injection.seed", "6");
    assert_true(use(scene)->meshes[0].welded == 12345);
    set(scene, "objects[0].mesh.unit", "0.5 m");
    assert_true(use(scene)->meshes[0].welded != 12345);
    sonject_scene_release(&scene);
}

TEST(the_text_of_a_scene_is_the_scene)
{
    char *text = NULL;
    sonject_scene *scene = read_text(NULL, HEAD);
    set(scene, "objects[0]", "{name: \"a \\\"b\\\"\", shape: sphere, diameter: 1}");
    set(scene, "objects[0].position", "{row: 3, column: 4}");
    EXPECT_OK(&context->report, sonject_scene_text(scene, &text));
    expect_same(scene, read_text(NULL, text));
    sonject_text_release(&text);
}

TEST(a_table_in_memory_is_that_of_a_file)
{
    static const double response[] = {-0.2, 0, 0.1, -0.1, 0.5, 0.2, 0, 1, 0, 0.2, 0.1, 0};
    static const double motion[] = {0, 1e-4, 1, 2e-4};
    static const double profile[] = {0, 1500, 10, 1501};
    static const double pings[] = {0, 6, 10, 7};
    static const struct {
        const char *key, *columns;
        const double *values;
        size_t count, columns_count;
        const char *beside, *value; /* another key that is needed */
    } cases[] = {
        {"sonar.pulse.file", "range_m, real, imaginary", response, 12, 3, "sonar.pulse.kind",
         "table"},
        {"sonar.measured_response", "along_track_m real imaginary", response, 12, 3, NULL, NULL},
        {"sonar.motion.file", "along_track_m;sway_m", motion, 4, 2, NULL, NULL},
        {"sonar.motion.yaw.file", "along_track_m, yaw_rad", motion, 4, 2,
         "sonar.motion.yaw.advance", "1 m"},
        {"medium.profile.file", "height_m, sound_speed_mps", profile, 4, 2, NULL, NULL},
        {"input.pings", "row, altitude_m", pings, 4, 2, "input",
         "{path: a.tif, geometry: {row_spacing: 1, column_spacing: 1, first_slant_range: 40}}"},
    };
    struct temporary_folder folder;
    assert_true(open_temporary_folder(&folder));
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *path = temporary_file(&folder, "table.csv");
        FILE *file = open_new_file(path);
        assert_non_null(file);
        fprintf(file, "%s\n", cases[i].columns);
        for (size_t j = 0; j < cases[i].count; j++)
            fprintf(file, "%.17g%c", cases[i].values[j],
                    (j + 1) % cases[i].columns_count ? strchr(cases[i].columns, ';')   ? ';'
                                                       : strchr(cases[i].columns, ',') ? ','
                                                                                       : ' '
                                                     : '\n');
        assert_int_equal(fclose(file), 0);
        sonject_scene *scenes[2];
        for (int k = 0; k < 2; k++) {
            scenes[k] = read_text(NULL, HEAD);
            if (cases[i].beside)
                set(scenes[k], cases[i].beside, cases[i].value);
        }
        set(scenes[0], cases[i].key, path);
        EXPECT_OK(&context->report,
                  sonject_scene_set_table(scenes[1], cases[i].key, cases[i].columns,
                                          cases[i].values, cases[i].count / cases[i].columns_count,
                                          cases[i].columns_count));
        expect_same(scenes[0], scenes[1]);
    }
    assert_int_equal(close_temporary_folder(&folder), 0);
}

TEST(heights_in_memory_are_a_relief)
{
    static const double heights[] = {0.1f, 0.2f, 0.3f, 0, 0, 0.25};
    sonject_scene *scene = read_text(NULL, HEAD);
    set(scene, "seabed.relief[0].heights",
        "{unit: m, row_spacing: 2, column_spacing: 3, first_ground_range: 40}");
    EXPECT_OK(&context->report,
              sonject_scene_set_table(scene, "seabed.relief[0].heights.file", NULL, heights, 2, 3));
    const struct scene *used = use(scene);
    assert_int_equal(used->relief.grid.rows, 2);
    assert_int_equal(used->relief.grid.columns, 3);
    for (size_t i = 0; i < COUNT(heights); i++)
        assert_true(used->relief.heights_m[i] == (float)heights[i]);
    sonject_scene_release(&scene);
}

TEST(tables_that_are_none_are_refused)
{
    static const double values[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    static const struct {
        const char *key, *columns, *message; /* message of the call, or else `used` of the use */
        const char *used;
    } cases[] = {
        {"sonar.altitude", "a, b", "sonar.altitude: takes no array", NULL},
        {"sonar.motion.file", NULL, "sonar.motion.file: name the columns", NULL},
        {"seabed.relief[0].heights.file", "a, b", "heights have no names", NULL},
        {"seabed.relief[2].heights.file", NULL, "[0] would add one", NULL},
        {"sonar.motion.file", "along_track_m, sway", NULL, "among them along_track_m, and sway_m"},
        {"sonar.motion.file", "along_track_m, sway_m, x", NULL, "as many names as columns"},
        {"sonar.motion.file", "sway_m, along_track_m", NULL, NULL},
        {"medium.profile.file", "height_m, sound_speed_mps", NULL,
         "medium.profile.file, given as an array:1: sound_speed_mps: must be 100...10000"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        sonject_scene *scene = read_text(NULL, HEAD);
        uint32_t count;
        const sonject_status status =
            sonject_scene_set_table(scene, cases[i].key, cases[i].columns, values, 4, 2);
        const char *expected = cases[i].message ? cases[i].message : cases[i].used;
        assert_int_equal(status, cases[i].message ? SONJECT_ERROR_INPUT : SONJECT_OK);
        assert_int_equal(sonject_scene_object_count(scene, &count),
                         cases[i].used ? SONJECT_ERROR_INPUT : SONJECT_OK);
        if (cases[i].message)
            assert_int_equal(
                sonject_scene_set_table(scene, cases[i].key, cases[i].columns, values, 4, 2),
                SONJECT_ERROR_INPUT);
        if (expected && !strstr(sonject_context_message(context), expected))
            fail_msg("'%s' is not in '%s'", expected, sonject_context_message(context));
        sonject_scene_release(&scene);
    }
}

TEST_PROGRAM(make_context, release_context)
