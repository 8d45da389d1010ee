/* What a scene says, read back key by key. */
#define _POSIX_C_SOURCE 200809L

#include <sonject/sonject.h>

#include <stdio.h>
#include <unistd.h>

#include "scene_context.h"

#define HEAD                                                                                       \
    "sonject: 1\n"                                                                                 \
    "input: {geometry: {row_spacing: 2.5 cm, column_spacing: 0.1, first_slant_range: 40},\n"       \
    "  channel: 1, calibration: auto, path: a.npy}\n"                                              \
    "sonar: {frequency: 100 kHz, bandwidth: 30e3, altitude: \"10 m\"}\n"

/* A scene of the text's file, named after a folder that is not there. */
static sonject_scene *read_text(sonject_context *context, const char *text)
{
    sonject_scene *scene = NULL;
    const sonject_scene_read_params params = {.struct_size = sizeof params, .text = text};
    EXPECT_OK(&context->report, sonject_scene_read(context, "away/scene.yaml", &params, &scene));
    return scene;
}

static void expect(sonject_context *context, const sonject_scene *scene, const char *key,
                   const char *expected)
{
    char *json = NULL;
    EXPECT_OK(&context->report, sonject_scene_get(scene, key, &json));
    if (strcmp(json, expected) != 0)
        fail_msg("%s is %s, not %s", key, json, expected);
    sonject_text_release(&json);
}

static void values_are_numbers_texts_sections_and_lists(void **state)
{
    static const struct {
        const char *key, *value, *json;
    } cases[] = {
        {"sonar.altitude", "0.2 km", "200.0"},
        {"sonar.altitude", "later", "\"later\""},
        {"sonar.altitude", "inf", "\"inf\""},
        {"seabed.lambert", "-20 dB", "0.01"},
        {"objects[0].heading", "20 deg", "20.0"},
        {"objects[0].heading", "-0.5 rad", "-28.647889756541161"},
        {"objects[0].pitch", "35", "35.0"},
        {"objects[0].name", "\"5\"", "\"5\""},
        {"objects[0].burial", "{fraction: 0.5}", "{\"fraction\": 0.5}"},
        {"objects[0].position", "centre", "\"centre\""},
        {"objects[0].material", "steel", "\"steel\""},
        {"objects[0].parts", "[{parts: [{shape: sphere, diameter: 50 cm}]}]",
         "[{\"parts\": [{\"shape\": \"sphere\", \"diameter\": 0.5}]}]"},
        {"injection.seed", "18446744073709551615", "\"18446744073709551615\""},
        {"injection.seed", "9007199254740993", "9007199254740993"},
        {"injection.interactions", "2", "2"},
        {"injection.order_energies", "true", "true"},
        {"injection.order_energies", "perhaps", "\"perhaps\""},
        {"medium.profile", "{heights: [0, 1 km], sound_speeds: [1.5 km/s, 1490.0]}",
         "{\"heights\": [0.0, 1000.0], \"sound_speeds\": [1500.0, 1490.0]}"},
        {"seabed.relief[0].heights.unit", "cm", "\"cm\""},
        {"bands.low", "{sonar: {frequency: 10 kHz}}", "{\"sonar\": {\"frequency\": 10000.0}}"},
    };
    sonject_context *context = *state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        sonject_scene *scene = read_text(context, HEAD);
        set(context, scene, "objects[0]", "{}");
        if (strstr(cases[i].key, "relief"))
            set(context, scene, "seabed.relief[0]", "{}");
        expect(context, scene, cases[i].key, strstr(cases[i].key, "altitude") ? "10.0" : "null");
        set(context, scene, cases[i].key, cases[i].value);
        expect(context, scene, cases[i].key, cases[i].json);
        sonject_scene_release(&scene);
    }
}

static void the_whole_is_in_the_order_of_the_text(void **state)
{
    sonject_context *context = *state;
    sonject_scene *scene = NULL;
    EXPECT_OK(&context->report, sonject_scene_create(context, &scene));
    expect(context, scene, "", "{\"sonject\": 1}");
    set(context, scene, "sonar", "{bandwidth: 30 kHz, frequency: 1e5}");
    expect(context, scene, "",
           "{\"sonject\": 1, \"sonar\": {\"bandwidth\": 30000.0, \"frequency\": 100000.0}}");
    expect(context, scene, "objects[0].heading", "null");
    expect(context, scene, "sonar[0]", "null");
    expect(context, scene, "sonar.frequency[0]", "null");
    sonject_scene_release(&scene);
}

/* Names of the text are meant from its folder, names that are set from the working folder. */
static void names_of_files_are_absolute(void **state)
{
    char folder[1024], expected[1100];
    char *text = NULL;
    sonject_context *context = *state;
    sonject_scene *scene = read_text(context, HEAD);
    assert_non_null(getcwd(folder, sizeof folder));
    snprintf(expected, sizeof expected, "\"%s/away/a.npy\"", folder);
    expect(context, scene, "input.path", expected);
    expect(context, scene, "input.calibration", "\"auto\"");
    set(context, scene, "input.path", "auto");
    snprintf(expected, sizeof expected, "\"%s/auto\"", folder);
    expect(context, scene, "input.path", expected);
    set(context, scene, "input.path", "b.npy");
    set(context, scene, "objects[0]", "{shape: mesh, mesh: c.stl}");
    snprintf(expected, sizeof expected, "\"%s/b.npy\"", folder);
    expect(context, scene, "input.path", expected);
    snprintf(expected, sizeof expected, "{\"shape\": \"mesh\", \"mesh\": \"%s/c.stl\"}", folder);
    expect(context, scene, "objects[0]", expected);
    EXPECT_OK(&context->report, sonject_scene_text(scene, &text));
    snprintf(expected, sizeof expected, "%s/b.npy", folder);
    assert_non_null(strstr(text, expected));
    snprintf(expected, sizeof expected, "%s/c.stl", folder);
    assert_non_null(strstr(text, expected));
    assert_non_null(strstr(text, "\"calibration\": auto"));
    sonject_text_release(&text);
    /* The scene itself keeps the names as they were given. */
    assert_int_equal(chdir("/"), 0);
    expect(context, scene, "input.path", "\"/b.npy\"");
    sonject_scene_release(&scene);
}

static void a_table_in_memory_is_told_by_its_numbers(void **state)
{
    static const double values[] = {0, 0.1, 1, 2e-4};
    sonject_context *context = *state;
    sonject_scene *scene = read_text(context, HEAD);
    EXPECT_OK(&context->report, sonject_scene_set_table(scene, "sonar.motion.file",
                                                        "along_track_m, sway_m", values, 2, 2));
    expect(context, scene, "sonar.motion",
           "{\"file\": {\"columns\": \"along_track_m, sway_m\", \"values\": [[0.0, "
           "0.10000000000000001], [1.0, 0.00020000000000000001]]}}");
    set(context, scene, "seabed.relief", "[{heights: {unit: m}}]");
    EXPECT_OK(&context->report,
              sonject_scene_set_table(scene, "seabed.relief[0].heights.file", NULL, values, 1, 1));
    expect(context, scene, "seabed.relief[0].heights",
           "{\"unit\": \"m\", \"file\": {\"columns\": null, \"values\": [[0.0]]}}");
    sonject_scene_release(&scene);
}

static void keys_that_are_none_are_refused(void **state)
{
    char *json = "set before";
    sonject_context *context = *state;
    sonject_scene *scene = read_text(context, HEAD);
    assert_int_equal(sonject_scene_get(scene, "sonar.altitud", &json), SONJECT_ERROR_INPUT);
    assert_null(json);
    assert_string_equal(sonject_context_message(context),
                        "sonar.altitud: there is no such key; did you mean 'altitude'?");
    assert_int_equal(sonject_scene_get(scene, NULL, &json), SONJECT_ERROR_ARGUMENT);
    assert_int_equal(sonject_scene_get(scene, "sonar", NULL), SONJECT_ERROR_ARGUMENT);
    assert_int_equal(sonject_scene_get(NULL, "sonar", &json), SONJECT_ERROR_ARGUMENT);
    sonject_scene_release(&scene);
}

TEST_PROGRAM(make_context, release_context, TEST(values_are_numbers_texts_sections_and_lists),
             TEST(the_whole_is_in_the_order_of_the_text),
             TEST(a_table_in_memory_is_told_by_its_numbers), TEST(keys_that_are_none_are_refused),
             TEST(names_of_files_are_absolute))
