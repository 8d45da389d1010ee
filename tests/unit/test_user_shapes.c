/* Code of users' shapes before it meets a compiler: what is refused and where; scene files that
 * hold code, and that they need consent. */
#include "claims.h"
#include "scene_folder.h"
#include "user/snippet.h"

#define DISTANCE "float shape_distance(float3 p, float3 d, float t, const float *a) { return t; }\n"
#define NORMAL   "float3 shape_normal(float3 p, const float *a) { return p; }\n"
#define GOOD     DISTANCE NORMAL

static void expect_code_refused(const char *code, const char *message)
{
    struct report report = {{0}, NULL, NULL};
    struct user_snippet snippet;
    if (snippet_make(&report, "my.cl", 1, code, &snippet) != SONJECT_ERROR_INPUT)
        fail_msg("not refused: %s", code);
    assert_string_equal(report.message, message);
    assert_null(snippet.code);
}

static void expect_code_taken(const char *code)
{
    struct report report = {{0}, NULL, NULL};
    struct user_snippet snippet;
    if (snippet_make(&report, "my.cl", 1, code, &snippet) != SONJECT_OK)
        fail_msg("%s\nrefused: %s", code, report.message);
    snippet_clear(&snippet);
}

#define NOT_HERE "#include is not possible here; write here what is in that file"

TEST(test_code_that_is_not_whole_is_refused_with_its_line)
{
    static const char *const cases[][2] = {
        {GOOD "#include \"more.cl\"\n", "my.cl:3: " NOT_HERE},
        {"\n \t#  include <more.cl>\n" GOOD, "my.cl:2: " NOT_HERE},
        {"", "my.cl:1: there is no function shape_distance in it; write one"},
        {DISTANCE, "my.cl:1: there is no function shape_normal in it; write one"},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_code_refused(cases[i][0], cases[i][1]);
}

TEST(test_sound_code_is_taken)
{
    static const char *const codes[] = {
        GOOD,
        "#define LONG(x) \\\n  ((x) * {\\\n)\n#if defined(LONG) && 1\n" GOOD
        "#else\n#error none\n#endif",
        GOOD "// no #include, but a # at the end: #",
    };
    for (size_t i = 0; i < COUNT(codes); i++)
        expect_code_taken(codes[i]);
}

TEST(test_size_and_names_are_limited)
{
    struct report report = {{0}, NULL, NULL};
    struct user_snippet snippet;
    char name[SNIPPET_NAME_MAX + 2];
    char *code = calloc(SNIPPET_BYTES_MAX + 2, 1);
    assert_non_null(code);
    memset(code, ' ', SNIPPET_BYTES_MAX + 1);
    memcpy(code, GOOD, strlen(GOOD));
    expect_code_refused(code, "my.cl: the code of a shape must be at most 64 KiB");
    code[SNIPPET_BYTES_MAX] = '\0';
    expect_code_taken(code);
    free(code);
    memset(name, 'n', sizeof name);
    name[sizeof name - 1] = '\0';
    assert_int_equal(snippet_make(&report, name, 1, GOOD, &snippet), SONJECT_ERROR_INPUT);
    assert_int_equal(snippet_make(&report, "a\nb", 1, GOOD, &snippet), SONJECT_ERROR_INPUT);
    assert_int_equal(snippet_make(&report, "", 1, GOOD, &snippet), SONJECT_ERROR_INPUT);
    assert_int_equal(snippet_make(&report, "a\"b\\.cl", 9, GOOD, &snippet), SONJECT_OK);
    assert_string_equal(snippet.name, "a\"b\\.cl");
    snippet_clear(&snippet);
}

static void append(struct user_shapes *shapes, const char *name, const char *code)
{
    struct report report = {{0}, NULL, NULL};
    const sonject_user_shape_params params = {.name = name, .code = code, .bounding_radius_m = 1.0};
    EXPECT_OK(&report, user_shapes_append(shapes, &report, &params));
}

TEST(test_equal_codes_are_one)
{
    struct user_shapes shapes;
    memset(&shapes, 0, sizeof shapes);
    append(&shapes, "a.cl", GOOD);
    append(&shapes, "b.cl", GOOD);
    append(&shapes, "c.cl", GOOD "\n");
    assert_int_equal(shapes.count, 3);
    assert_int_equal(shapes.snippet_count, 2);
    assert_int_equal(shapes.shapes[1].snippet, 0);
    assert_int_equal(shapes.shapes[2].snippet, 1);
    user_shapes_clear(&shapes);
}

#define OBJECTS BASE "objects:\n"
#define CODE                                                                                       \
    "    user:\n"                                                                                  \
    "      bounding_radius: 50 cm\n"                                                               \
    "      parameters: [0.5, -2]\n"                                                                \
    "      code: |\n"                                                                              \
    "        " DISTANCE "        " NORMAL

static sonject_status read_with_consent(const char *text)
{
    write_scene(text, strlen(text));
    return read_scene_with(NULL, 0, true);
}

static void expect_refused_with_consent(const char *text, const char *message)
{
    assert_int_equal(read_with_consent(text), SONJECT_ERROR_INPUT);
    const size_t length = strlen(folder->report.message);
    assert_true(length >= strlen(message));
    assert_string_equal(folder->report.message + length - strlen(message), message);
}

#define NO_CONSENT                                                                                 \
    "user: is code that would run with your rights; if you trust who wrote it, use "               \
    "--allow-user-shapes"

TEST(test_code_in_files_needs_consent)
{
    expect_scene_refused(OBJECTS "  - shape: user\n" CODE, ":7:7: objects[0]." NO_CONSENT);
    expect_scene_refused(OBJECTS "  - parts:\n    - {shape: user, user: {}}\n",
                         ":6:27: objects[0].parts[0]." NO_CONSENT);
    /* a target's file, in an object's or in that of parts */
    write_scene(OBJECTS "  - target: " SOURCE_ROOT "/tools/targets/boulder_relief.yaml\n",
                strlen(OBJECTS "  - target: " SOURCE_ROOT "/tools/targets/boulder_relief.yaml\n"));
    assert_int_equal(read_scene(NULL, 0), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(folder->report.message, "boulder_relief.yaml:9:3: " NO_CONSENT));
}

TEST(test_code_arrives_with_its_lines)
{
    assert_int_equal(read_with_consent(OBJECTS "  - shape: user\n" CODE "  - parts:\n"
                                               "    - shape: sphere\n"
                                               "      diameter: 1\n"
                                               "    - shape: user\n"
                                               "      user: {file: " SOURCE_ROOT
                                               "/tools/targets/boulder_relief.cl,\n"
                                               "        bounding_radius: 1, half_height: 0.25,"
                                               " open: true}\n"),
                     SONJECT_OK);
    const struct user_shapes *shapes = &folder->scene.user_shapes;
    assert_int_equal(shapes->count, 2);
    assert_int_equal(folder->scene.objects[0].user_shape, 0);
    assert_int_equal(folder->scene.parts[1].shape.user_shape, 1);
    assert_string_equal(shapes->snippets[0].code, GOOD);
    assert_int_equal(shapes->snippets[0].first_line, 10);
    assert_string_equal(shapes->snippets[0].name, folder->file);
    assert_true(shapes->shapes[0].parameters[0] == 0.5f);
    assert_true(shapes->shapes[0].parameters[1] == -2.0f);
    assert_true(shapes->shapes[0].half_height_m == 0.5 && !shapes->shapes[0].is_open);
    assert_true(shapes->shapes[1].half_height_m == 0.25 && shapes->shapes[1].is_open);
    assert_true(shapes->shapes[1].half_width_m == 1.0);
    /* the line of an error in a block is that of the file */
    expect_refused_with_consent(OBJECTS "  - shape: user\n" CODE "        #include <more.cl>\n",
                                "scene.yaml:12: " NOT_HERE);
}

TEST(test_wrong_sections_are_refused)
{
#define OF_USER(keys) OBJECTS "  - {shape: user, user: {" keys "}}\n"
    static const char *const cases[][2] = {
        {OBJECTS "  - shape: user\n", "objects[0].user: missing; a user needs it"},
        {OBJECTS "  - diameter: 1\n    shape: sphere\n" CODE,
         "objects[0].user: a sphere has none; remove it"},
        {OF_USER("bounding_radius: 1"),
         "objects[0].user: none of file and code is there; give one"},
        {OF_USER("bounding_radius: 1, code: x, parameters: [nan]"),
         "parameters[0]: 'nan' is not a number"},
        {OF_USER("bounding_radius: 1, code: x, parameters: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, "
                 "12, 13, 14, 15, 16, 17]"),
         "parameters: has 17 entries; at most 16 are possible"},
        {OF_USER("bounding_radius: 1, file: absent.cl"), "absent.cl; check its name"},
        {OF_USER("bounding_radius: 1, code: x"),
         "scene.yaml:5: there is no function shape_distance in it; write one"},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_refused_with_consent(cases[i][0], cases[i][1]);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
