/* Tests that all mistakes of a scene file are told at once, a line each, in the file's order. */
#include "claims.h"
#include "scene_folder.h"

/* Each wrong piece is one mistake, whatever else is wrong. */
TEST(test_mistakes_do_not_hide_each_other_nor_add_any)
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
    static const size_t lines_of_last = 3; /* no speed, no fluid without a speed, the roughness */
    for (unsigned set = 0; set < 1u << COUNT(pieces); set++) {
        char text[2000] = "sonject: 1\n";
        size_t expected = 0;
        for (size_t i = 0; i < COUNT(pieces); i++) {
            const bool is_wrong = set >> i & 1;
            strcat(text, is_wrong ? pieces[i].wrong : pieces[i].right);
            expected += !is_wrong ? 0 : i + 1 < COUNT(pieces) ? 1 : lines_of_last - 1;
        }
        read_scene_text(text, NULL, 0);
        if (lines_of(folder->report.message, strlen(folder->report.message)) != expected)
            fail_msg("%zu mistakes in\n%s\nare told as\n%s", expected, text,
                     folder->report.message);
    }
}

TEST(test_a_targets_mistakes_stand_where_it_is_named)
{
    char target[TEMPORARY_CAPACITY + 64];
    char expected[10 * TEMPORARY_CAPACITY];
    static const char text[] = BASE "objects:\n"
                                    "  - {target: t.yaml, heading: north}\n"
                                    "  - {target: t.yaml}\n"
                                    "  - {target: absent.yaml}\n"
                                    "seabed: {lambert: loud}\n";
    static const char described[] =
        "sonject_target: 1\nclass: \"a\\tb\"\nparts:\n  - {shape: sphere}\n  - {shape: shpere}\n";
    write_file("t.yaml", described, strlen(described));
    strcpy(target, file_in("t.yaml"));
    assert_int_equal(read_scene_text(text, NULL, 0), SONJECT_ERROR_INPUT);
    sprintf(expected,
            "%s:2:8: class: must be UTF-8 text without control characters\n"
            "%s:4:5: parts[0].diameter: missing; a sphere needs it\n"
            "%s:5:13: parts[1].shape: 'shpere' is not one of %s; did you mean "
            "'sphere'?\n"
            "%s:5:31: objects[0].heading: 'north' is not a number with a unit of deg, rad\n"
            "%s:7:14: objects[2].target: there is no file %s/absent.yaml; check its name\n"
            "%s:8:19: seabed.lambert: 'loud' is not a number with a unit of dB",
            target, target, target, shape_words(), folder->file, folder->file, folder->folder.path,
            folder->file);
    assert_string_equal(folder->report.message, expected);
}

TEST(test_lines_beyond_fifty_are_counted)
{
    char text[4000] = BASE "seabed:\n";
    for (int i = 0; i < 60; i++)
        sprintf(text + strlen(text), "  unheard_of_%d: 1\n", i);
    assert_int_equal(read_scene_text(text, NULL, 0), SONJECT_ERROR_INPUT);
    /* fifty, or as many as there is room for where the folder's name is long */
    const char *message = folder->report.message;
    const int told = (int)lines_of(message, strlen(message)) - 1;
    char rest[32];
    sprintf(rest, "\nand %d more", 60 - told);
    assert_string_equal(strrchr(message, '\n'), rest);
    assert_true(told == 50 || (told < 50 && strlen(message) > REPORT_CAPACITY - REPORT_LINE));
}

TEST(test_broken_yaml_ends_the_reading)
{
    static const char text[] = "sonject: 5\nsonar: {frequency: 1 m}\ninput: [\n";
    assert_int_equal(read_scene_text(text, NULL, 0), SONJECT_ERROR_INPUT);
    assert_int_equal(lines_of(folder->report.message, strlen(folder->report.message)), 1);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
