/* Tests scene files that are good: every key, every way to write it, overrides. */
#include "claims.h"
#include "scene_keys.h"

static void expect_arrived(const struct key_case *key, const void *structure)
{
    const char *place = (const char *)structure + key->offset;
    if (key->type == TYPE_NOTHING)
        return;
    if (key->type == TYPE_TEXT || key->type == TYPE_PATH) {
        const char *text = place;
        if (key->type == TYPE_PATH)
            memcpy(&text, place, sizeof text);
        assert_string_equal(text, key->value);
    } else if (!(number_at(structure, key) == key->number)) {
        fail_msg("%s: %s gave %.17g, not %.17g", key->path, key->value, number_at(structure, key),
                 key->number);
    }
}

static void expect_case(const struct key_case *key)
{
    const sonject_status status = read_case(key, key->value);
    if (status != SONJECT_OK)
        fail_msg("%s=%s: %s", key->path, key->value, folder->report.message);
    expect_arrived(key, structure_of(&folder->scene, key));
}

/* Expects a key's value not to be the default, which would show nothing. */
static void expect_not_the_default(const struct key_case *key)
{
    const char *name = strrchr(key->path, '.');
    if (key->type == TYPE_NOTHING || key->type == TYPE_TEXT || key->type == TYPE_PATH)
        return;
    if (name && (strcmp(name, ".position") == 0 || strcmp(name, ".level") == 0))
        return; /* the key's only word is the default; its keys have cases of their own */
    if (read_case(key, NULL) != SONJECT_OK)
        return; /* the section cannot do without the key */
    const void *structure = structure_of(&folder->scene, key);
    if (structure && number_at(structure, key) == key->number)
        fail_msg("%s: %s is there without the key, too", key->path, key->value);
}

TEST(test_every_key_arrives)
{
    for (size_t i = 0; i < COUNT(cases); i++) {
        expect_case(&cases[i]);
        expect_not_the_default(&cases[i]);
    }
}

/* No key can be added to the tables without a case. */
TEST(test_every_key_has_a_case)
{
    json_t *keys = list_keys();
    size_t i;
    json_t *key;
    json_array_foreach(keys, i, key)
    {
        assert_true(text_of(key, "unit")[0] && text_of(key, "meaning")[0]);
        if (json_is_true(json_object_get(key, "has_value")) && !has_case(text_of(key, "path")))
            fail_msg("%s has no case", text_of(key, "path"));
    }
    json_decref(keys);
}

TEST(test_defaults_stay_where_nothing_is_said)
{
    struct scene defaults;
    scene_init(&defaults);
    expect_scene_taken(small);
    assert_memory_equal(&folder->scene.medium, &defaults.medium, sizeof defaults.medium);
    assert_memory_equal(&folder->scene.seabed, &defaults.seabed, sizeof defaults.seabed);
    assert_memory_equal(&folder->scene.injection, &defaults.injection, sizeof defaults.injection);
    assert_memory_equal(&folder->scene.patch, &defaults.patch, sizeof defaults.patch);
    assert_int_equal(folder->scene.input_kind, SONJECT_INPUT_UNIFORM);
    assert_int_equal(folder->scene.object_count, 1);
    assert_true(folder->scene.objects[0].material.reflection == 0.9);
    assert_true(folder->scene.objects[0].length_m == 0.0);
    assert_int_equal(folder->scene.sonar.response_window, SONJECT_WINDOW_TAYLOR);
    assert_true(folder->scene.sonar.taylor_sidelobe_db == 35.0);
    assert_int_equal(folder->scene.sonar.taylor_terms, 5);
}

TEST(test_words_and_forms)
{
    const char *overrides[] = {"sonar.response={taylor: {sidelobes: 30 dB, terms: 4}}",
                               "injection.noise_floor=-20",
                               "objects[0].position={row: 1, column: 2}", "seabed.lambert=-30 dB"};
    const char *back[] = {"sonar.response=rectangular", "injection.noise_floor=estimate",
                          "objects[0].position={along_track: 1, slant_range: 41}"};
    assert_int_equal(read_scene_text(small, overrides, COUNT(overrides)), SONJECT_OK);
    assert_int_equal(folder->scene.sonar.response_window, SONJECT_WINDOW_TAYLOR);
    assert_int_equal(folder->scene.injection.estimate_noise, 0);
    assert_int_equal(folder->scene.objects[0].position_kind, SONJECT_POSITION_PIXELS);
    assert_true(fabs(folder->scene.seabed.lambert / 1e-3 - 1.0) < 1e-15); /* rounding of pow */
    assert_int_equal(read_scene(back, COUNT(back)), SONJECT_OK);
    assert_int_equal(folder->scene.sonar.response_window, SONJECT_WINDOW_RECTANGULAR);
    assert_int_equal(folder->scene.injection.estimate_noise, 1);
    assert_int_equal(folder->scene.objects[0].position_kind, SONJECT_POSITION_METRES);
}

/* A name fills in a material, keys beside the name change it, a seabed keeps its backscatter. */
TEST(test_named_materials)
{
    const char *overrides[] = {"objects[0].material={name: concrete, roughness: 7 mm}",
                               "seabed.forward={sediment: medium_sand, rule: map, roughness: 5 mm}",
                               "seabed.lambert=-30 dB"};
    const char *as_constant[] = {"objects[0].material={name: coarse-sand, reflection: 0.75}",
                                 "seabed.forward={sediment: silt, lambert: 0.0625, fluid: {loss: "
                                 "0.03125}}"};
    sonject_material_params expected;
    const sonject_material_params *material;
    EXPECT_OK(&folder->report, read_scene_text(small, overrides, COUNT(overrides)));
    assert_true(material_named("concrete", &expected));
    expected.roughness_m = 0.007;
    assert_memory_equal(&folder->scene.objects[0].material, &expected, sizeof expected);
    assert_true(material_named("medium sand", &expected));
    material = &folder->scene.seabed.forward;
    assert_true(isnan(material->lambert) && material->roughness_m == 0.005);
    assert_true(material->density_ratio == expected.density_ratio);
    assert_true(material->speed_ratio == expected.speed_ratio && material->loss == expected.loss);
    assert_true(fabs(folder->scene.seabed.lambert / 1e-3 - 1.0) < 1e-15); /* rounding of pow */
    EXPECT_OK(&folder->report, read_scene(as_constant, COUNT(as_constant)));
    material = &folder->scene.objects[0].material;
    assert_int_equal(material->reflection_kind, SONJECT_REFLECTION_CONSTANT);
    assert_true(material->reflection == 0.75);
    assert_true(material_named("coarse sand", &expected));
    assert_true(material->roughness_m == expected.roughness_m);
    assert_true(material_named("silt", &expected));
    material = &folder->scene.seabed.forward;
    assert_true(material->lambert == 0.0625 && material->loss == 0.03125);
    assert_true(material->density_ratio == expected.density_ratio);
}

TEST(test_a_fluid_replaces_a_constant_reflection)
{
    const char *fluid = "objects[0].material={name: steel, fluid: {density: 8, speed: 4}}";
    assert_int_equal(read_scene_text(small, &fluid, 1), SONJECT_OK);
    assert_int_equal(folder->scene.objects[0].material.reflection_kind, SONJECT_REFLECTION_FLUID);
}

TEST(test_paths_are_meant_from_where_they_stand)
{
    const char *absolute = "input.path=/data/a #1: b.tif";
    const char *relative = "input.path= data/swath.tif";
    char expected[TEMPORARY_CAPACITY + 16];
    expect_scene_taken(file);
    snprintf(expected, sizeof expected, "%s/swath.tif", folder->folder.path);
    assert_string_equal(folder->scene.input_path, expected);
    assert_int_equal(folder->scene.input_kind, SONJECT_INPUT_FILE);
    assert_int_equal(read_scene(&absolute, 1), SONJECT_OK);
    assert_string_equal(folder->scene.input_path, "/data/a #1: b.tif");
    assert_int_equal(read_scene(&relative, 1), SONJECT_OK);
    assert_string_equal(folder->scene.input_path, "data/swath.tif");
}

TEST(test_overrides_change_and_add)
{
    const char *overrides[] = {"objects[0].heading=30 deg", "objects[1]={shape: plane, length: 1}",
                               "objects[1].width = 2 m",    "sonar.altitude=11",
                               "sonar.altitude=12 m",       "injection.seed='77'"};
    const char *none = "objects=[]";
    assert_int_equal(read_scene_text(small, overrides, COUNT(overrides)), SONJECT_OK);
    assert_int_equal(folder->scene.object_count, 2);
    assert_true(folder->scene.objects[0].heading_rad == 30.0 / 180.0 * PI);
    assert_true(folder->scene.objects[1].width_m == 2.0);
    assert_true(folder->scene.objects[1].diameter_m == 0.0); /* none, not the default */
    assert_true(folder->scene.sonar.altitude_m == 12.0);
    assert_int_equal(folder->scene.injection.seed, 77);
    assert_int_equal(read_scene(&none, 1), SONJECT_OK);
    assert_int_equal(folder->scene.object_count, 0);
}

TEST(test_sections_may_be_empty)
{
    char text[1000];
    snprintf(text, sizeof text, "%smedium:\nseabed: {}\ninjection: ~\n", small);
    expect_scene_taken(text);
    *strstr(text, "objects:") = 0;
    strcat(text, "objects:\n");
    expect_scene_taken(text);
    assert_int_equal(folder->scene.object_count, 0);
    *strstr(text, "objects:") = 0;
    expect_scene_taken(text);
    assert_int_equal(folder->scene.object_count, 0);
}

TEST(test_byte_order_mark_and_line_ends)
{
    char text[1000] = "\xEF\xBB\xBF";
    size_t length = 3;
    for (const char *c = small; *c; c++) {
        if (*c == '\n')
            text[length++] = '\r';
        text[length++] = *c;
    }
    text[length] = 0;
    expect_scene_taken(text);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
