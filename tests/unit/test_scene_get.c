/* Tests a scene's values, read back key by key. */
#include <sonject/sonject.h>

#include <stdio.h>
#include <unistd.h>

#include "base/system/file_system.h"
#include "scene_context.h"

#define HEAD                                                                                       \
    "sonject: 1\n"                                                                                 \
    "input: {geometry: {row_spacing: 2.5 cm, column_spacing: 0.1, first_slant_range: 40},\n"       \
    "  channel: 1, calibration: auto, path: a.npy}\n"                                              \
    "sonar: {frequency: 100 kHz, bandwidth: 30e3, altitude: \"10 m\"}\n"

#define AWAY "away/scene.yaml" /* a folder that is not there */

static void expect(const sonject_scene *scene, const char *key, const char *expected)
{
    char *json = NULL;
    EXPECT_OK(&context->report, sonject_scene_get(scene, key, &json));
    if (strcmp(json, expected) != 0)
        fail_msg("%s is %s, not %s", key, json, expected);
    sonject_text_release(&json);
}

TEST(values_are_numbers_texts_sections_and_lists)
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
    for (size_t i = 0; i < COUNT(cases); i++) {
        sonject_scene *scene = read_text(AWAY, HEAD);
        set(scene, "objects[0]", "{}");
        if (strstr(cases[i].key, "relief"))
            set(scene, "seabed.relief[0]", "{}");
        expect(scene, cases[i].key, strstr(cases[i].key, "altitude") ? "10.0" : "null");
        set(scene, cases[i].key, cases[i].value);
        expect(scene, cases[i].key, cases[i].json);
        sonject_scene_release(&scene);
    }
}

TEST(the_whole_is_in_the_order_of_the_text)
{
    sonject_scene *scene = NULL;
    EXPECT_OK(&context->report, sonject_scene_create(context, &scene));
    expect(scene, "", "{\"sonject\": 1}");
    set(scene, "sonar", "{bandwidth: 30 kHz, frequency: 1e5}");
    expect(scene, "",
           "{\"sonject\": 1, \"sonar\": {\"bandwidth\": 30000.0, \"frequency\": 100000.0}}");
    expect(scene, "objects[0].heading", "null");
    expect(scene, "sonar[0]", "null");
    expect(scene, "sonar.frequency[0]", "null");
    sonject_scene_release(&scene);
}

TEST(a_table_in_memory_is_told_by_its_numbers)
{
    static const double values[] = {0, 0.1, 1, 2e-4};
    sonject_scene *scene = read_text(AWAY, HEAD);
    EXPECT_OK(&context->report, sonject_scene_set_table(scene, "sonar.motion.file",
                                                        "along_track_m, sway_m", values, 2, 2));
    expect(scene, "sonar.motion",
           "{\"file\": {\"columns\": \"along_track_m, sway_m\", \"values\": [[0.0, "
           "0.10000000000000001], [1.0, 0.00020000000000000001]]}}");
    set(scene, "seabed.relief", "[{heights: {unit: m}}]");
    EXPECT_OK(&context->report,
              sonject_scene_set_table(scene, "seabed.relief[0].heights.file", NULL, values, 1, 1));
    expect(scene, "seabed.relief[0].heights",
           "{\"unit\": \"m\", \"file\": {\"columns\": null, \"values\": [[0.0]]}}");
    sonject_scene_release(&scene);
}

TEST(keys_that_are_none_are_refused)
{
    char *json = "set before";
    sonject_scene *scene = read_text(AWAY, HEAD);
    assert_int_equal(sonject_scene_get(scene, "sonar.altitud", &json), SONJECT_ERROR_INPUT);
    assert_null(json);
    assert_string_equal(sonject_context_message(context),
                        "sonar.altitud: there is no such key; did you mean 'altitude'?");
    assert_int_equal(sonject_scene_get(scene, NULL, &json), SONJECT_ERROR_ARGUMENT);
    assert_int_equal(sonject_scene_get(scene, "sonar", NULL), SONJECT_ERROR_ARGUMENT);
    assert_int_equal(sonject_scene_get(NULL, "sonar", &json), SONJECT_ERROR_ARGUMENT);
    sonject_scene_release(&scene);
}

/* After any failed call that makes something, nothing of an earlier call is left. */
TEST(failed_calls_set_what_they_make_to_null_and_tell_why)
{
    const sonject_scene_read_params reading = {.struct_size = sizeof reading, .text = HEAD};
    sonject_scene *scene = (void *)&reading;
    sonject_result *result = (void *)&reading;
    char *json = (void *)&reading;
    assert_int_equal(sonject_scene_create(NULL, &scene), SONJECT_ERROR_ARGUMENT);
    assert_null(scene);
    scene = (void *)&reading;
    assert_int_equal(sonject_scene_read(NULL, NULL, &reading, &scene), SONJECT_ERROR_ARGUMENT);
    assert_null(scene);
    assert_int_equal(sonject_inject(NULL, NULL, NULL, NULL, NULL, &result), SONJECT_ERROR_ARGUMENT);
    assert_null(result);
    assert_int_equal(sonject_scene_get(NULL, "sonar", &json), SONJECT_ERROR_ARGUMENT);
    assert_null(json);
    assert_int_equal(sonject_inject(context, NULL, NULL, NULL, NULL, NULL), SONJECT_ERROR_ARGUMENT);
    assert_string_equal(sonject_context_message(context), "result must not be NULL");
    assert_int_equal(sonject_scene_read(context, NULL, &reading, NULL), SONJECT_ERROR_ARGUMENT);
    assert_string_equal(sonject_context_message(context), "scene must not be NULL");
    assert_int_equal(sonject_scene_read(context, NULL, NULL, &scene), SONJECT_ERROR_ARGUMENT);
    assert_string_equal(sonject_context_message(context), "path, without a text, must not be NULL");
}

/* Writes the working folder as JSON has it, with '\' twice. */
static void write_working_folder(char *text, size_t capacity)
{
    char *folder = working_folder();
    assert_true(folder && 2 * strlen(folder) < capacity);
    for (const char *at = folder; *at; at++) {
        if (*at == '\\')
            *text++ = '\\';
        *text++ = *at;
    }
    *text = '\0';
    free(folder);
}

/* Names in the text count from the text's folder, names that are set from the working folder. */
TEST(names_of_files_are_absolute)
{
    char folder[1024], expected[1100];
    char *text = NULL;
    sonject_scene *scene = read_text(AWAY, HEAD);
    write_working_folder(folder, sizeof folder);
    snprintf(expected, sizeof expected, "\"%s/away/a.npy\"", folder);
    expect(scene, "input.path", expected);
    expect(scene, "input.calibration", "\"auto\"");
    set(scene, "input.path", "auto");
    snprintf(expected, sizeof expected, "\"%s/auto\"", folder);
    expect(scene, "input.path", expected);
    set(scene, "input.path", "b.npy");
    set(scene, "objects[0]", "{shape: mesh, mesh: c.stl}");
    snprintf(expected, sizeof expected, "\"%s/b.npy\"", folder);
    expect(scene, "input.path", expected);
    snprintf(expected, sizeof expected, "{\"shape\": \"mesh\", \"mesh\": \"%s/c.stl\"}", folder);
    expect(scene, "objects[0]", expected);
    EXPECT_OK(&context->report, sonject_scene_text(scene, &text));
    snprintf(expected, sizeof expected, "%s/b.npy", folder);
    assert_non_null(strstr(text, expected));
    snprintf(expected, sizeof expected, "%s/c.stl", folder);
    assert_non_null(strstr(text, expected));
    assert_non_null(strstr(text, "\"calibration\": auto"));
    sonject_text_release(&text);
    /* The scene itself keeps the names as they were given. */
    assert_int_equal(chdir(".."), 0);
    write_working_folder(folder, sizeof folder);
    snprintf(expected, sizeof expected, "\"%s/b.npy\"", folder);
    expect(scene, "input.path", expected);
    sonject_scene_release(&scene);
}

TEST_PROGRAM(make_context, release_context)
