/* All mistakes of a scene or campaign file are told at once, each by one line, in its order. */
#define _POSIX_C_SOURCE 200809L

#include "claims.h"
#include "dataset/campaign.h"
#include "scene_folder.h"

static size_t lines_of(const char *message)
{
    size_t lines = *message != 0;
    for (; *message; message++)
        lines += *message == '\n';
    return lines;
}

static void test_six_mistakes_are_six_lines(void **state)
{
    expect_scene_refused(
        *state,
        "sonject: 1\n"
        "input:\n"
        "  uniform: {rows: 4, columns: 5}\n"
        "  geometry: {row_spacing: 1, column_spacing: 1 knot, first_slant_range: 40}\n"
        "sonar:\n"
        "  frequency: 100 kHz\n"
        "  bandwith: 30 kHz\n"
        "  altitude: -3 m\n"
        "objects:\n"
        "  - shape: cilinder\n"
        "    diameter: 1 m\n"
        "    heading: 30 deg\n"
        "    heading: 40 deg\n"
        "  - {shape: box, length: 1, width: 1}\n",
        ":4:46: input.geometry.column_spacing: unit 'knot' is not one of m, km, cm, mm\n"
        ":7:3: sonar.bandwith: unknown key; did you mean 'bandwidth'?\n"
        ":8:13: sonar.altitude: must be 1e-06...1e+06 m, not -3\n"
        ":10:12: objects[0].shape: 'cilinder' is not one of " SHAPE_WORDS
        "; did you mean 'cylinder'?\n"
        ":13:5: objects[0].heading: given twice, first on line 12; remove one\n"
        ":14:5: objects[1].height: missing; a box needs it");
}

/* Each is one mistake, whatever else is wrong. */
static void test_mistakes_do_not_hide_each_other_nor_add_any(void **state)
{
    static const struct {
        const char *right, *wrong;
    } pieces[] = {
        {"input: {uniform: {rows: 4, columns: 5}, ", "input: {uniform: {rows: 0, columns: 5}, "},
        {"geometry: {row_spacing: 1, column_spacing: 1, first_slant_range: 40}}\n",
         "geometry: {row_spacing: 1, column_spacing: 1, first_slant_rang: 40}}\n"},
        {"sonar: {frequency: 100e3, ", "sonar: {frequency: 100 m, "},
        {"bandwidth: 30e3, ", "bandwidth: 0, "},
        {"altitude: 10}\n", "}\n"},
        {"surface: {depth: 30, ", "surface: {depth: [30], "},
        {"lambert: 0.01}\n", "lambert: 0.5}\n"},
        {"medium: {absorption: {temperature: 9, salinity: 35, depth: 20}}\n",
         "medium: {absorption: {temperature: 90, salinity: 35, depth: 20}}\n"},
        {"elements: {sampling_rate: 1 MHz}\n", "elements: {sampling_rate: 1 m}\n"},
        {"objects:\n  - {shape: sphere, diameter: 1, ", "objects:\n  - {shape: sphere, "},
        {"burial: 0, ", "burial: {fraction: 2}, "},
        {"material: steel}\n", "material: {fluid: {density: 2}, roughness: 3}}\n"},
    };
    static const size_t lines_of_last = 3; /* no speed, no fluid without it, the roughness */
    struct scene_folder *folder = *state;
    for (unsigned set = 0; set < 1u << COUNT(pieces); set++) {
        char text[2000] = "sonject: 1\n";
        size_t expected = 0;
        for (size_t i = 0; i < COUNT(pieces); i++) {
            const bool is_wrong = set >> i & 1;
            strcat(text, is_wrong ? pieces[i].wrong : pieces[i].right);
            expected += !is_wrong ? 0 : i + 1 < COUNT(pieces) ? 1 : lines_of_last - 1;
        }
        write_scene(folder, text, strlen(text));
        read_scene(folder, NULL, 0);
        if (lines_of(folder->report.message) != expected)
            fail_msg("%zu mistakes in\n%s\nare told as\n%s", expected, text,
                     folder->report.message);
    }
}

static void test_overrides_come_behind_the_file(void **state)
{
    static const char *const overrides[] = {"sonar.altitude=deep", "objects[3].heading=1",
                                            "medium.sound_sped=1500"};
    struct scene_folder *folder = *state;
    char expected[10 * SCENE_FOLDER_CAPACITY];
    write_scene(folder, BASE "patch: 5\n", strlen(BASE "patch: 5\n"));
    assert_int_equal(read_scene(folder, overrides, COUNT(overrides)), SONJECT_ERROR_INPUT);
    sprintf(expected,
            "%s:4:8: patch: must be a section of 'key: value' lines, not a single value\n"
            "--set sonar.altitude: 'deep' is not a number with a unit of m, km, cm, mm\n"
            "--set objects[3].heading: objects has 0 entries, counted from 0; [0] would add one\n"
            "--set medium.sound_sped: unknown key; did you mean 'sound_speed'?",
            folder->file);
    assert_string_equal(folder->report.message, expected);
}

static void test_a_targets_mistakes_stand_where_it_is_named(void **state)
{
    struct scene_folder *folder = *state;
    char target[SCENE_FOLDER_CAPACITY + 64];
    char expected[10 * SCENE_FOLDER_CAPACITY];
    static const char text[] = BASE "objects:\n"
                                    "  - {target: t.yaml, heading: north}\n"
                                    "  - {target: t.yaml}\n"
                                    "  - {target: absent.yaml}\n"
                                    "seabed: {lambert: loud}\n";
    static const char described[] =
        "sonject_target: 1\nclass: \"a\\tb\"\nparts:\n  - {shape: sphere}\n  - {shape: shpere}\n";
    write_file(folder, "t.yaml", described, strlen(described));
    strcpy(target, file_in(folder, "t.yaml"));
    write_scene(folder, text, strlen(text));
    assert_int_equal(read_scene(folder, NULL, 0), SONJECT_ERROR_INPUT);
    unlink(target);
    sprintf(expected,
            "%s:2:8: class: must be UTF-8 text without control characters\n"
            "%s:4:5: parts[0].diameter: missing; a sphere needs it\n"
            "%s:5:13: parts[1].shape: 'shpere' is not one of %s; did you mean "
            "'sphere'?\n"
            "%s:5:31: objects[0].heading: 'north' is not a number with a unit of deg, rad\n"
            "%s:7:14: objects[2].target: there is no file %s/absent.yaml; check its name\n"
            "%s:8:19: seabed.lambert: 'loud' is not a number with a unit of dB",
            target, target, target, shape_words(), folder->file, folder->file, folder->folder,
            folder->file);
    assert_string_equal(folder->report.message, expected);
}

static void test_lines_beyond_fifty_are_counted(void **state)
{
    struct scene_folder *folder = *state;
    char text[4000] = BASE "seabed:\n";
    for (int i = 0; i < 60; i++)
        sprintf(text + strlen(text), "  unheard_of_%d: 1\n", i);
    write_scene(folder, text, strlen(text));
    assert_int_equal(read_scene(folder, NULL, 0), SONJECT_ERROR_INPUT);
    /* fifty, or, where the folder's name is long, as many as there is room for */
    const char *message = folder->report.message;
    const int told = (int)lines_of(message) - 1;
    char rest[32];
    sprintf(rest, "\nand %d more", 60 - told);
    assert_string_equal(strrchr(message, '\n'), rest);
    assert_true(told == 50 || (told < 50 && strlen(message) > REPORT_CAPACITY - REPORT_LINE));
}

static void test_broken_yaml_ends_the_reading(void **state)
{
    struct scene_folder *folder = *state;
    static const char text[] = "sonject: 5\nsonar: {frequency: 1 m}\ninput: [\n";
    write_scene(folder, text, strlen(text));
    assert_int_equal(read_scene(folder, NULL, 0), SONJECT_ERROR_INPUT);
    assert_int_equal(lines_of(folder->report.message), 1);
}

static void test_campaign_files_tell_all(void **state)
{
    struct scene_folder *folder = *state;
    struct campaign campaign;
    char path[SCENE_FOLDER_CAPACITY + 64];
    char expected[10 * SCENE_FOLDER_CAPACITY];
    static const char *const lines[] = {
        ":3:9: images: must be 1...10000000, not 0",
        ":4:14: chip.rows: must be all, or a whole number of 16...8192",
        ":5:10: labels[0]: 'yoolo' is not one of yolo, voc; did you mean 'yolo'?",
        ":7:5: swaths[0].path: missing; add it (image file)",
        ":9:5: targets[0].object: missing; add it (keys of an object that are not drawn)",
        ":9:40: targets[0].draw.hedding: scenes have no such key; did you mean 'heading'?",
        ":9:52: targets[0].draw.sonar.altitude: is of scenes: write it in the scene's file or the "
        "campaign's draw",
        ":10:8: draw.sonar.frequncy: scenes have no such key; did you mean 'frequency'?",
        ":11:3: draw.level: is of objects: write objects[].level in draw, or level in "
        "targets[].draw",
        ":12:3: draw.objects[1].pitch: is of objects: write objects[].pitch in draw, or pitch in "
        "targets[].draw",
        ":13:11: draw.seabed: is a section: draw its keys, such as seabed.lambert: {uniform: ...}",
        ":14:3: draw.class: scenes have no such key; there are sonject, band, bands, input, patch, "
        "sonar, seabed, surface, medium, injection, elements, objects"};
    static const char text[] =
        "sonject_campaign: 1\nscene: s.yaml\nimages: 0\nchip: {rows: 4, columns: 64}\n"
        "labels: [\"yoolo\"]\nswaths:\n  - {split: all}\ntargets:\n"
        "  - {class: ball, weight: 1,    draw: {hedding: 3, sonar.altitude: 3}}\n"
        "draw: {sonar.frequncy: 3,\n  level: {over_seabed: 3 dB},\n  \"objects[1].pitch\": 0,\n"
        "  seabed: {lambert: {uniform: [-30 dB, -20 dB]}},\n  class: 3}\n";
    write_file(folder, "campaign.yaml", text, strlen(text));
    strcpy(path, file_in(folder, "campaign.yaml"));
    assert_int_equal(campaign_read(&folder->report, path, NULL, NULL, 0, &campaign),
                     SONJECT_ERROR_INPUT);
    campaign_clear(&campaign);
    unlink(path);
    expected[0] = 0;
    for (size_t i = 0; i < COUNT(lines); i++)
        sprintf(expected + strlen(expected), "%s%s%s", i ? "\n" : "", path, lines[i]);
    assert_string_equal(folder->report.message, expected);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder, TEST(test_six_mistakes_are_six_lines),
             TEST(test_mistakes_do_not_hide_each_other_nor_add_any),
             TEST(test_overrides_come_behind_the_file),
             TEST(test_a_targets_mistakes_stand_where_it_is_named),
             TEST(test_lines_beyond_fifty_are_counted), TEST(test_broken_yaml_ends_the_reading),
             TEST(test_campaign_files_tell_all))
