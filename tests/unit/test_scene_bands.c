/* Tests bands: several sonars in one scene file. */
#include "claims.h"
#include "scene_folder.h"

#define TWO_BANDS                                                                                  \
    BASE "bands:\n"                                                                                \
         "  low: {sonar: {bandwidth: 20 kHz}}\n"                                                   \
         "  high:\n"                                                                               \
         "    sonar: {frequency: 400 kHz}\n"                                                       \
         "    seabed: {lambert: -20 dB}\n"

static const char *const low[] = {"band=low"};
static const char *const high[] = {"band=high"};

TEST(test_a_band_changes_its_keys_alone)
{
    assert_int_equal(read_scene_text(TWO_BANDS, low, 1), SONJECT_OK);
    assert_true(folder->scene.sonar.centre_frequency_hz == 100e3);
    assert_true(folder->scene.sonar.bandwidth_hz == 20e3);
    assert_int_equal(read_scene(high, 1), SONJECT_OK);
    assert_true(folder->scene.sonar.centre_frequency_hz == 400e3);
    assert_true(folder->scene.sonar.bandwidth_hz == 30e3);
    assert_true(folder->scene.sonar.altitude_m == 10.0);
    assert_true(folder->scene.seabed.lambert == 0.01);
}

TEST(test_a_band_may_stand_in_the_file)
{
    expect_scene_taken(TWO_BANDS "band: high\n");
    assert_true(folder->scene.sonar.centre_frequency_hz == 400e3);
}

TEST(what_is_set_beats_the_band)
{
    static const char *const set[] = {"band=high", "sonar.frequency=300 kHz",
                                      "seabed.lambert=-10 dB", "bands.high.sonar.bandwidth=25 kHz"};
    static const char *const whole[] = {"band=high",
                                        "sonar={altitude: 5, frequency: 90 kHz, bandwidth: 9 kHz}"};
    static const char *const within[] = {"band=one", "objects[0].heading=3 deg"};
    static const char *const own[] = {"band=one", "objects=[]"};
    static const char scene[] = BASE
        "objects: [{shape: sphere, diameter: 1, position: {row: 1, column: 1}}]\n"
        "bands: {one: {objects: [{shape: sphere, diameter: 2, position: {row: 1, column: 1}}]}}\n";
    assert_int_equal(read_scene_text(TWO_BANDS, set, COUNT(set)), SONJECT_OK);
    assert_true(folder->scene.sonar.centre_frequency_hz == 300e3);
    assert_true(folder->scene.sonar.bandwidth_hz == 25e3);
    assert_true(folder->scene.seabed.lambert == 0.1);
    assert_int_equal(read_scene(whole, COUNT(whole)), SONJECT_OK);
    assert_true(folder->scene.sonar.centre_frequency_hz == 90e3);
    assert_true(folder->scene.sonar.altitude_m == 5.0);
    assert_int_equal(read_scene_text(scene, own, COUNT(own)), SONJECT_OK);
    assert_int_equal(folder->scene.object_count, 0);
    assert_int_equal(read_scene(within, COUNT(within)), SONJECT_ERROR_INPUT);
    assert_non_null(
        strstr(folder->report.message, "the band has its own objects: set the whole of it"));
}

static void expect_names(const char *text, const char *const *overrides, size_t count,
                         const char *expected)
{
    char *names;
    const struct scene_source source = {.path = folder->file,
                                        .text = text,
                                        .overrides = (const char **)overrides,
                                        .override_count = count};
    assert_int_equal(scene_source_bands(&source, &folder->report, &names), SONJECT_OK);
    assert_string_equal(names, expected);
    free(names);
}

TEST(test_bands_that_are_left_are_named)
{
    expect_names(TWO_BANDS, NULL, 0, "low\nhigh\n");
    expect_names(TWO_BANDS, high, 1, "");
    expect_names(BASE, NULL, 0, "");
}

TEST(test_what_is_wrong_is_told)
{
    static const struct refusal wrong[] = {
        {TWO_BANDS, ":5:3: bands: choose one of low, high (--set band=low)"},
        {TWO_BANDS "band: middle\n", ":9:7: band: 'middle' is not one of low, high"},
        {BASE "band: low\n", ":4:7: band: there are no bands to choose from"},
        {BASE "bands: {}\n", ":4:8: bands: must be a section of bands: their names, and keys"},
        {BASE "bands: {../up: {}}\n",
         ":4:16: bands.../up: a band's name is that of a folder: 1 to 63 letters, "
         "digits, _ and -"},
        {BASE "bands: {low: 3}\nband: low\n",
         ":4:14: bands.low: must be a section of the scene's keys that this band "
         "changes"},
        {BASE "bands: {low: {bands: {}}}\nband: low\n",
         ":4:22: bands.low.bands: cannot be a band's own; remove it"},
        /* the message tells the place where the band was written */
        {BASE "bands:\n  low: {sonar: {bandwidth: 3 kg}}\nband: low\n",
         ":5:28: sonar.bandwidth: unit 'kg' is not one of Hz, kHz, MHz"},
    };
    expect_all_refused(wrong, COUNT(wrong));
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
