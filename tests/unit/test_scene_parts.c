/* Tests objects of parts in scene files: groups, surfaces that are inherited, files of targets, and
 * refusals. */
#include "claims.h"
#include "scene_folder.h"

#define OBJECT BASE "objects:\n  - " /* five lines; keys begin in column 5 */

static const struct scene_part *part_at(uint32_t index)
{
    assert_true(index < folder->scene.part_count);
    return &folder->scene.parts[index];
}

static void expect_vector(const double vector[3], double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (!(fabs(vector[i] - expected[i]) < 1e-15)) /* sines and cosines of right angles */
            fail_msg("(%g, %g, %g) is not (%g, %g, %g)", vector[0], vector[1], vector[2], x, y, z);
}

TEST(test_parts_belong_to_their_objects)
{
    expect_scene_taken(BASE
                       "objects:\n"
                       "  - parts: [{shape: sphere, diameter: 1}, {shape: disc, diameter: 2}]\n"
                       "  - {shape: sphere, diameter: 3}\n"
                       "  - parts: [{shape: sphere, diameter: 4, name: last}]\n");
    static const uint32_t objects[] = {0, 0, 2};
    static const double diameters[] = {1.0, 2.0, 4.0};
    assert_int_equal(folder->scene.object_count, 3);
    assert_int_equal(folder->scene.part_count, 3);
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(part_at(i)->object, objects[i]);
        assert_true(part_at(i)->shape.diameter_m == diameters[i]);
        expect_vector(part_at(i)->centre, 0.0, 0.0, 0.0);
    }
    assert_string_equal(part_at(2)->shape.name, "last");
    assert_int_equal(folder->scene.objects[0].shape, SHAPE_PARTS);
    assert_int_equal(folder->scene.objects[1].shape, SHAPE_SPHERE);
}

/* A group is turned to its own y. Parts ahead of its origin come to lie across the object. A part
 * raised there, ahead of the group, still points up. */
TEST(test_groups_place_and_turn)
{
    expect_scene_taken(OBJECT "parts:\n"
                              "    - at: {along: 10, up: 1}\n"
                              "      heading: 90 deg\n"
                              "      parts:\n"
                              "      - at: {along: 2}\n"
                              "        pitch: 90 deg\n"
                              "        parts:\n"
                              "        - {shape: cylinder, length: 1, diameter: 1,\n"
                              "           at: {along: 0.5}, heading: 90 deg}\n"
                              "    - {shape: sphere, diameter: 1}\n");
    const struct scene_part *cylinder = part_at(0);
    expect_vector(cylinder->centre, 10.0, 2.0, 1.5);
    expect_vector(cylinder->axes[0], -1.0, 0.0, 0.0);
    expect_vector(cylinder->axes[1], 0.0, 0.0, -1.0);
    expect_vector(cylinder->axes[2], 0.0, -1.0, 0.0);
    expect_vector(part_at(1)->centre, 0.0, 0.0, 0.0);
    expect_vector(part_at(1)->axes[0], 1.0, 0.0, 0.0);
}

/* A part inherits from object and group, and may change keys. Their order does not matter. */
TEST(test_surfaces_are_inherited)
{
    expect_scene_taken(OBJECT "parts:\n"
                              "    - {shape: sphere, diameter: 1}\n"
                              "    - parts: [{shape: sphere, diameter: 1},\n"
                              "        {shape: sphere, diameter: 1, material: concrete}]\n"
                              "      material: rubber\n"
                              "    - {shape: sphere, diameter: 1, material: {roughness: "
                              "7 mm}}\n"
                              "    material: {reflection: 0.75, roughness: 2 mm}\n");
    sonject_material_params named;
    assert_true(part_at(0)->shape.material.reflection == 0.75);
    assert_true(part_at(0)->shape.material.roughness_m == 0.002);
    assert_true(material_named("rubber", &named));
    assert_true(part_at(1)->shape.material.density_ratio == named.density_ratio);
    assert_true(material_named("concrete", &named));
    assert_true(part_at(2)->shape.material.density_ratio == named.density_ratio);
    assert_true(part_at(3)->shape.material.reflection == 0.75);
    assert_true(part_at(3)->shape.material.roughness_m == 0.007);
}

/* Writes the text of `levels` lists of parts within each other. */
static void nested_object(char *text, size_t capacity, int levels)
{
    size_t length = (size_t)snprintf(text, capacity, "%sobjects: [{", BASE);
    for (int i = 0; i < levels; i++)
        length += (size_t)snprintf(text + length, capacity - length, "parts: [{at: {up: 1}, ");
    length += (size_t)snprintf(text + length, capacity - length, "shape: sphere, diameter: 1");
    for (int i = 0; i < levels; i++)
        length += (size_t)snprintf(text + length, capacity - length, "}]");
    snprintf(text + length, capacity - length, "}]\n");
}

TEST(test_nesting_is_bounded)
{
    char text[2000];
    nested_object(text, sizeof text, 8);
    expect_scene_taken(text);
    expect_vector(part_at(0)->centre, 0.0, 0.0, 8.0);
    nested_object(text, sizeof text, 9);
    expect_scene_refused(text,
                         ":4:195: objects[0].parts[0].parts[0].parts[0].parts[0].parts[0].parts[0]."
                         "parts[0].parts[0].parts: nested too deeply; parts may be 8 levels deep");
}

TEST(test_overrides_reach_parts)
{
    const char *overrides[] = {"objects[0].parts[1].parts[0].diameter=70 cm",
                               "objects[0].parts[2]={shape: disc, diameter: 1}"};
    const char text[] = OBJECT "parts: [{shape: sphere, diameter: 1},\n"
                               "      {parts: [{shape: sphere, diameter: 1}]}]\n";
    EXPECT_OK(&folder->report, read_scene_text(text, overrides, COUNT(overrides)));
    assert_int_equal(folder->scene.part_count, 3);
    assert_true(part_at(1)->shape.diameter_m == 0.7);
    assert_int_equal(part_at(2)->shape.shape, SHAPE_DISC);
}

TEST(test_what_is_refused)
{
    static const struct refusal wrong[] = {
        {OBJECT "parts:\n", ":5:11: objects[0].parts: must be a list; start each part with '- '"},
        {OBJECT "parts: []\n", ":5:12: objects[0].parts: is empty; give at least one part"},
        {OBJECT "parts: [{name: nothing}]\n",
         ":5:13: objects[0].parts[0]: none of shape and parts is there; give one"},
        {OBJECT "parts: [{shape: sphere, diameter: 1, parts: [{shape: sphere, diameter: 1}]}]\n",
         ":5:13: objects[0].parts[0]: more than one of shape and parts is there; give one"},
        {OBJECT "parts: [{shape: sphere, diameter: 1}]\n    shape: sphere\n    diameter: 1\n",
         ":5:5: objects[0]: more than one of shape, parts and target is there; give one"},
        {OBJECT "parts: [{shape: sphere, diameter: 1}]\n    length: 1\n",
         ":6:13: objects[0].length: the parts have shapes of their own; remove it"},
        {OBJECT "parts: [{diameter: 1, parts: [{shape: sphere, diameter: 1}]}]\n",
         ":5:24: objects[0].parts[0].diameter: the parts have shapes of their own; remove it"},
        {OBJECT "parts: [{shape: sphere, diameter: 1}, {shape: sphere, diameter: -1}]\n",
         ":5:69: objects[0].parts[1].diameter: must be 1e-06...1e+06 m, not -1"},
        {OBJECT "parts: [{shape: parts}]\n",
         ":5:21: objects[0].parts[0].shape: 'parts' is not one of " SHAPE_WORDS},
        {OBJECT "parts: [{shape: sphere, diameter: 1, heading: inf}]\n",
         ":5:51: objects[0].parts[0].heading: must be a finite number, not inf"},
        {OBJECT "parts: [{shape: sphere, diameter: 1}]\n    material: {lambert: 1}\n",
         ":6:25: objects[0].material.lambert: must be 0...0.2578 (reflection^2 / pi), or the "
         "surface "
         "returns more than it receives; it is 1"},
    };
    expect_all_refused(wrong, COUNT(wrong));
}

TEST(test_too_many_parts)
{
    static const char part[] = "  - {shape: sphere, diameter: 1}\n";
    char *text = zeroed(2000 + 1001 * sizeof part, 1);
    char *end = text + sprintf(text, "%sobjects:\n- parts:\n", BASE);
    for (int i = 0; i < 1000; i++)
        end += sprintf(end, "%s", part);
    expect_scene_taken(text);
    sprintf(end, "%s", part);
    expect_scene_refused(text,
                         ":1006:5: objects[0].parts[1000]: is one part too many: a scene may have "
                         "1000; split it");
    free(text);
}

static void write_target(const char *text)
{
    write_file("target.yaml", text, strlen(text));
}

TEST(test_targets_are_files)
{
    write_target("sonject_target: 1\nname: twin\nclass: clutter\n"
                 "material: {reflection: 0.75, roughness: 2 mm}\n"
                 "parts: [{shape: sphere, diameter: 1, at: {along: 1}},\n"
                 "  {shape: disc, diameter: 2, material: {reflection: 0.875}}]\n");
    expect_scene_taken(BASE "objects:\n"
                            "  - target: target.yaml\n"
                            "  - {name: other, class: mine, target: target.yaml, heading: "
                            "90 deg, material: {roughness: 7 mm}, burial: 10 cm}\n");
    const sonject_object_params *objects = folder->scene.objects;
    assert_int_equal(folder->scene.part_count, 4);
    for (uint32_t i = 0; i < 4; i++) {
        const struct scene_part *part = part_at(i);
        assert_int_equal(part->object, i / 2);
        assert_true(part->shape.diameter_m == (i % 2 ? 2.0 : 1.0));
        assert_true(part->shape.material.reflection == (i % 2 ? 0.875 : 0.75));
        assert_true(part->shape.material.roughness_m == (i / 2 ? 0.007 : 0.002));
    }
    assert_string_equal(objects[0].name, "twin");
    assert_string_equal(objects[0].class_name, "clutter");
    assert_string_equal(objects[1].name, "other");
    assert_string_equal(objects[1].class_name, "mine");
    assert_true(objects[1].heading_rad > 1.5 && objects[1].burial_m == 0.1);
    assert_true(objects[0].shape == SHAPE_PARTS && objects[1].shape == SHAPE_PARTS);
}

TEST(test_targets_may_have_one_shape)
{
    write_target("sonject_target: 1\nshape: torus\ndiameter: 1\nheight: 0.2\n");
    expect_scene_taken(OBJECT "target: target.yaml\n");
    assert_int_equal(folder->scene.objects[0].shape, SHAPE_TORUS);
    assert_true(folder->scene.objects[0].height_m == 0.2);
    assert_int_equal(folder->scene.part_count, 0);
}

/* Messages about the target name its file. */
TEST(test_targets_that_are_wrong)
{
    static const struct refusal wrong[] = {
        {"", ":1:1: there is nothing in it"},
        {"~\n", ":1:1: there is nothing in it; start with 'sonject_target: 1'"},
        {"shape: sphere\ndiameter: 1\n",
         ":1:1: sonject_target: missing; add it (version of the format, 1)"},
        {"sonject_target: 2\nshape: sphere\ndiameter: 1\n",
         ":1:17: sonject_target: must be 1, the version of the format that is read here"},
        {"sonject_target: 1\n", ":1:1: none of shape and parts is there; give one"},
        {"sonject_target: 1\nparts: [{shape: sphere, diameter: -1}]\n",
         ":2:35: parts[0].diameter: must be 1e-06...1e+06 m, not -1"},
        {"sonject_target: 1\nwidth: 1\nparts: [{shape: sphere, diameter: 1}]\n",
         ":2:8: width: the parts have shapes of their own; remove it"},
        {"sonject_target: 1\ntarget: target.yaml\nshape: sphere\ndiameter: 1\n",
         ":2:1: target: unknown key; known here are sonject_target, name, class, shape, "
         "length, "
         "width, diameter, height, top_diameter, front_height, nose_end, tail_end, mesh, material, "
         "fouling, parts"},
    };
    static const char scene[] = OBJECT "target: target.yaml\n";
    write_scene(scene, strlen(scene));
    for (size_t i = 0; i < COUNT(wrong); i++) {
        write_target(wrong[i].text);
        assert_int_equal(read_scene(NULL, 0), SONJECT_ERROR_INPUT);
        const char *path = file_in("target.yaml");
        const size_t length = strlen(path);
        if (strncmp(folder->report.message, path, length) != 0 ||
            strcmp(folder->report.message + length, wrong[i].message) != 0)
            fail_msg("the message is\n%s\nand not\n%s%s", folder->report.message, path,
                     wrong[i].message);
        assert_int_equal(folder->scene.object_count, 0);
        assert_int_equal(folder->scene.part_count, 0);
    }
}

TEST(test_scenes_that_name_targets_wrongly)
{
    char message[TEMPORARY_CAPACITY + 100];
    snprintf(message, sizeof message,
             ":5:13: objects[0].target: there is no file %s/absent.yaml; check its name",
             folder->folder.path);
    expect_scene_refused(OBJECT "target: absent.yaml\n", message);
    expect_scene_refused(OBJECT "target:\n",
                         ":5:12: objects[0].target: has no value; write one or remove the key");
    write_target("sonject_target: 1\nparts: [{shape: sphere, diameter: 1}]\n");
    expect_scene_refused(OBJECT "target: target.yaml\n    diameter: 1\n",
                         ":6:15: objects[0].diameter: the target's file has the shape; remove "
                         "it");
    expect_scene_refused(OBJECT "target: target.yaml\n    parts: [{shape: disc, diameter: 1}]\n",
                         ":5:5: objects[0]: more than one of shape, parts and target is there; "
                         "give one");
}

/* A file that is longer than any target is refused. */
TEST(test_large_targets_are_refused)
{
    const size_t bytes = 1024 * 1024 + 2;
    char *text = zeroed(bytes + 1, 1);
    memset(text, '#', bytes);
    text[bytes] = 0;
    write_target(text);
    free(text);
    static const char scene[] = OBJECT "target: target.yaml\n";
    assert_int_equal(read_scene_text(scene, NULL, 0), SONJECT_ERROR_INPUT);
    const char *path = file_in("target.yaml");
    assert_memory_equal(folder->report.message, path, strlen(path));
    assert_non_null(strstr(folder->report.message, "larger than"));
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
