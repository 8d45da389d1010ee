/* Tests the water of scene files: layers, profiles, absorption. */
#include "claims.h"
#include "scene_folder.h"

#define SURFACE "surface: {depth: 25 m}\n"
#define CAST    SOURCE_ROOT "/tests/unit/cast.csv"

static void expect_layer(const struct scene *scene, size_t i, double bottom, double speed,
                         double density)
{
    assert_true(i < scene->water_layer_count);
    const struct water_layer *layer = &scene->water_layers[i];
    if (!(layer->bottom_m == bottom && layer->speed_mps == speed && layer->density == density))
        fail_msg("layer %zu: %.17g m, %.17g m/s, %.17g", i, layer->bottom_m, layer->speed_mps,
                 layer->density);
}

TEST(test_layers)
{
    expect_scene_taken(BASE "medium:\n"
                            "  reference_sound_speed: 1500 m/s\n"
                            "  layers:\n"
                            "    - {bottom: 0 m, sound_speed: 1490 m/s, density: 1025}\n"
                            "    - {bottom: 1200 cm, sound_speed: 1.52 km/s,\n"
                            "       density: 1.024 g/cm3}\n");
    assert_int_equal(folder->scene.water_layer_count, 2);
    expect_layer(&folder->scene, 0, 0.0, 1490.0, 1025.0);
    expect_layer(&folder->scene, 1, 12.0, 1520.0, 1024.0);
    assert_true(folder->scene.medium.reference_sound_speed_mps == 1500.0);
    expect_scene_taken(BASE "medium: {layers: [{bottom: 0, sound_speed: 1490}, "
                            "{sound_speed: 1510, bottom: 3}]}\n");
    expect_layer(&folder->scene, 1, 3.0, 1510.0, 1.0);
    expect_scene_taken(BASE "medium: {sound_speed: 1490}\n");
    assert_null(folder->scene.water_layers);
    assert_int_equal(folder->scene.water_layer_count, 0);
}

/* Expects 1490 m/s at 3 m over the seabed, and 1490.25 m/s at 12 m. */
static void expect_corners(const char *text)
{
    const struct scene *scene = &folder->scene;
    expect_scene_taken(text);
    const size_t count = scene->water_layer_count;
    /* 0.25 m/s: 3.36 steps of 1490 / 20000 m/s, so four layers */
    assert_int_equal(count, 6);
    expect_layer(scene, 0, 0.0, 1490.0, 1.0);
    assert_true(scene->water_layers[1].bottom_m == 3.0);
    expect_layer(scene, 5, 12.0, 1490.25, 1.0);
}

TEST(test_profiles)
{
    expect_corners(BASE "medium: {profile: {file: " CAST "}}\n");
    expect_corners(BASE "medium: {profile: {heights: [3, 12 m], sound_speeds: [1490, "
                        "1.49025 km/s]}}\n");
    expect_corners(BASE "medium: {profile: {heights: [20, 12, 3], sound_speeds: [1490.25, "
                        "1490.25, 1490]}}\n");
    expect_corners(BASE "medium: {profile: {depths: [13 m, 22 m], sound_speeds: [1490.25, "
                        "1490]}}\n" SURFACE);
    expect_corners(BASE "medium: {profile: {depths: [22, 13, 0], sound_speeds: [1490, "
                        "1490.25, 1490.25]}}\n" SURFACE);
}

/* A file is looked for beside the scene file, but an override's file where the user is. */
TEST(test_files_are_looked_for_beside_the_scene)
{
    static const char warm[] = "height_m sound_speed_mps\n1 1500\n2 warm\n";
    static const char good[] = "height_m sound_speed_mps\n1 1500\n2 1500\n";
    char beside[TEMPORARY_CAPACITY + 64];
    const char *absent = "medium.profile.file=cast-of-nobody.csv";
    const char *there = "medium.profile.file=" CAST;
    static const char text[] = BASE "medium: {profile: {file: cast.csv}}\n";
    write_file("cast.csv", good, strlen(good));
    strcpy(beside, file_in("cast.csv"));
    expect_scene_taken(text);
    assert_int_equal(folder->scene.water_layer_count, 1);
    expect_layer(&folder->scene, 0, 0.0, 1500.0, 1.0);
    write_file("cast.csv", warm, strlen(warm));
    assert_int_equal(read_scene_text(text, NULL, 0), SONJECT_ERROR_INPUT);
    assert_int_equal(strncmp(folder->report.message, beside, strlen(beside)), 0);
    assert_string_equal(folder->report.message + strlen(beside),
                        ":3: sound_speed_mps: 'warm' is not a number");
    assert_int_equal(unlink(beside), 0);
    char message[2 * TEMPORARY_CAPACITY];
    snprintf(message, sizeof message,
             ":4:26: medium.profile.file: there is no file %s; check its name", beside);
    expect_scene_refused(text, message);
    assert_int_equal(read_scene(&absent, 1), SONJECT_ERROR_INPUT);
    assert_string_equal(folder->report.message,
                        "--set medium.profile.file: there is no file cast-of-nobody.csv; check its "
                        "name");
    assert_int_equal(read_scene(&there, 1), SONJECT_OK);
}

TEST(test_absorption)
{
    const double *absorption = &folder->scene.medium.absorption_db_per_m;
    expect_scene_taken(BASE "medium: {}\n");
    assert_true(*absorption == 0.0);
    expect_scene_taken(BASE "medium: {absorption: 0.03 dB/m}\n");
    assert_true(*absorption == 0.03);
    expect_scene_taken(BASE "medium: {absorption: 34 dB/km}\n");
    assert_true(*absorption == 0.034);
    expect_scene_taken(BASE "medium: {absorption: {temperature: 12 C, salinity: 34, depth: "
                            "20 m, ph: 7.9}}\n");
    assert_true(*absorption == sonject_absorption(100e3, 12.0, 34.0, 20.0, 7.9));
    expect_scene_taken(BASE "medium: {absorption: {temperature: -1, salinity: 5, depth: "
                            "0.2 km}}\n");
    assert_true(*absorption == sonject_absorption(100e3, -1.0, 5.0, 200.0, 8.0));
    const char *frequency = "sonar.frequency=455 kHz";
    assert_int_equal(read_scene(&frequency, 1), SONJECT_OK);
    assert_true(*absorption == sonject_absorption(455e3, -1.0, 5.0, 200.0, 8.0));
}

#define MEDIUM  BASE "medium:\n" /* the medium's keys begin on line 5 */
#define LAYERS  MEDIUM "  layers:\n"
#define PROFILE MEDIUM "  profile: "

TEST(test_what_is_wrong)
{
    static const struct refusal wrong[] = {
        {MEDIUM "  sound_speed: 1500\n  layers: [{bottom: 0, sound_speed: 1500}]\n",
         ":5:3: medium: more than one of sound_speed, layers and profile is there; give one"},
        {MEDIUM "  layers: []\n",
         ":5:11: medium.layers: must be a list, such as [{bottom: 0 m, sound_speed: 1490 m/s}, "
         "{bottom: 12 m, ...}]"},
        {LAYERS "    - {bottom: 0}\n",
         ":6:7: medium.layers[0].sound_speed: missing; add it (sound speed of the layer)"},
        {LAYERS "    - {bottom: 1 m, sound_speed: 1500}\n",
         ":6:16: medium.layers[0].bottom: must be 0 m: the first layer lies on the seabed; not "
         "1 m"},
        {LAYERS "    - {bottom: 0, sound_speed: 1500}\n    - {bottom: 0, sound_speed: 1500}\n",
         ":7:16: medium.layers[1].bottom: must lie over the one before it, 0 m, by at least 1e-06 "
         "m, not at 0 m"},
        {LAYERS "    - {bottom: 0, sound_speed: 1500}\n"
                "    - {bottom: 1, sound_speed: 1500, density: 1000}\n",
         ":7:47: medium.layers[1].density: give it for all layers or for none"},
        {LAYERS "    - {bottom: 0, sound_speed: 1500, density: 1000}\n"
                "    - {bottom: 1, sound_speed: 1500}\n",
         ":7:7: medium.layers[1].density: give it for all layers or for none"},
        {LAYERS "    - {bottom: 0, sound_speed: 1500, density: 0}\n",
         ":6:47: medium.layers[0].density: must be 1e-06...1e+06 kg/m3, not 0"},
        {PROFILE "{}\n",
         ":5:12: medium.profile: none of file, heights and depths is there; give one"},
        {PROFILE "{heights: [1, 2], depths: [1, 2], sound_speeds: [1500, 1500]}\n",
         ":5:12: medium.profile: more than one of file, heights and depths is there; give one"},
        {PROFILE "{sound_speeds: [1500, 1500], file: " CAST "}\n",
         ":5:27: medium.profile.sound_speeds: the file gives them, too; remove one of the two"},
        {PROFILE "{heights: [1, 2]}\n",
         ":5:12: medium.profile.sound_speeds: missing; heights need it"},
        {PROFILE "{heights: [1, 2], sound_speeds: [1500]}\n",
         ":5:44: medium.profile.sound_speeds: has 1 entries, but heights has 2"},
        {PROFILE "{depths: [1], sound_speeds: [1500]}\n",
         ":5:21: medium.profile.depths: a profile needs at least two samples, not 1"},
        {PROFILE "{heights: [1, 2], sound_speeds: []}\n",
         ":5:44: medium.profile.sound_speeds: must be a list, such as [1490 m/s, 1500 m/s]"},
        {PROFILE "{heights: [1, 2 kg], sound_speeds: [1500, 1500]}\n",
         ":5:26: medium.profile.heights[1]: unit 'kg' is not one of m, km, cm, mm"},
        {PROFILE "{heights: [1, 2], sound_speeds: [15, 1500]}\n",
         ":5:45: medium.profile.sound_speeds[0]: must be 100...10000 m/s, not 15"},
        {PROFILE "{heights: [1, 3, 2], sound_speeds: [1500, 1500, 1500]}\n",
         ":5:29: medium.profile.heights[2]: must go on rising from one to the next by at least "
         "1e-06 m; 2 follows 3"},
        {PROFILE "{depths: [1, 2], sound_speeds: [1500, 1500]}\n",
         ":5:21: medium.profile.depths: depths count from the sea surface; set depth in "
         "surface"},
        {PROFILE "{depths: [40, 30], sound_speeds: [1500, 1500]}\n" SURFACE,
         ":5:21: medium.profile.depths: must lie over the seabed: the whole profile is below it "
         "(-5 m)"},
        {PROFILE "{heights: [0, 9], sound_speeds: [1200, 1800]}\n",
         ":5:22: medium.profile.heights: needs more than 4096 layers; take fewer samples, or "
         "layers"},
        {MEDIUM "  absorption: -1 dB/m\n",
         ":5:15: medium.absorption: must be 0...100 dB/m, not -1"},
        {START INPUT "sonar: {frequency: 2 MHz, bandwidth: 30 kHz, altitude: 10 m}\nmedium:\n"
                     "  absorption: {temperature: 12, salinity: 35, depth: 1}\n",
         ":5:15: medium.absorption: is known from 200 Hz to 1 MHz, not at the sonar's 2e+06 Hz; "
         "give it in dB/m"},
    };
    expect_all_refused(wrong, COUNT(wrong));
    assert_null(folder->scene.water_layers);
}

TEST(test_too_many_of_them)
{
    const size_t capacity = 300000;
    char *text = zeroed(capacity, 1);
    size_t length = (size_t)sprintf(text, "%s", LAYERS);
    for (int i = 0; i < 4097; i++)
        length += (size_t)sprintf(text + length, "    - {bottom: %d, sound_speed: 1500}\n", i);
    expect_scene_refused(text, ":6:5: medium.layers: has 4097 entries; at most 4096 are possible");
    length = (size_t)sprintf(text, "%s", PROFILE "{heights: [0");
    for (int i = 1; i < 4097; i++)
        length += (size_t)sprintf(text + length, ", %d", i);
    sprintf(text + length, "%s", "], sound_speeds: [1500, 1500]}\n");
    expect_scene_refused(text, ":5:22: medium.profile.heights: has 4097 entries; at most "
                               "4096 are possible");
    free(text);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
