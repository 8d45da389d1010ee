/* Tests what counts as the same inputs of a run. */
#include "claims.h"
#include "inject/scene_hash.h"
#include "scene_keys.h"

static void hash_of(const struct scene *scene, const char *identity, char text[HASH_TEXT_CAPACITY])
{
    struct report report = {.host = NULL};
    assert_int_equal(scene_hash(&report, scene, identity, text), SONJECT_OK);
}

/* True for keys that no image depends on, whose case has the value that is there without them, or
 * that say what another key can say. */
static bool is_without_effect(const char *path)
{
    static const char *const others[] = {
        "sonject",
        "band", /* the keys that the band gives count */
        "bands",
        "input.path",        /* the swath's identity tells files apart */
        "input.calibration", /* the keys that the calibration gives count */
        "seabed.relief[].mound.position",
        "objects[].level",
        "objects[].position",
        "objects[].user.file", /* the file's text counts, as code does */
        "objects[].mesh.file", /* counts as mesh does */
        "objects[].mesh.open",
    };
    for (size_t i = 0; i < COUNT(others); i++)
        if (strcmp(path, others[i]) == 0)
            return true;
    return strncmp(path, "elements.", 9) == 0; /* inputs of the series alone */
}

/* Returns a second value of a key that must be there and has no member of its own; NULL: none. */
static const char *second_value(const char *path)
{
    static const char *const values[][2] = {
        {".user.code", "float3 shape_normal(); float shape_distance();"},
        {".mesh", "{file: '" SOURCE_ROOT "/tools/targets/rock.obj', unit: cm}"},
    };
    const size_t length = strlen(path);
    for (size_t i = 0; i < COUNT(values); i++) {
        const size_t end = strlen(values[i][0]);
        if (length >= end && strcmp(path + length - end, values[i][0]) == 0)
            return values[i][1];
    }
    return NULL;
}

/* Changes the member that a key sets. */
static void change(const struct scene *scene, const struct key_case *key)
{
    char *member = (char *)(uintptr_t)structure_of(scene, key) + key->offset;
    double number;
    if (key->type == TYPE_DOUBLE) {
        memcpy(&number, member, sizeof number);
        number = number == 0.0 ? 1.0 : 2.0 * number;
        memcpy(member, &number, sizeof number);
    } else {
        *member ^= 1;
    }
}

/* Two scenes differ in one key. One scene lacks the key or, where it must be, has another value. */
TEST(test_every_key_counts)
{
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct key_case *key = &cases[i];
        const char *second = second_value(key->path);
        const bool has_one = read_case(key, second) == SONJECT_OK;
        if (second && !has_one)
            fail_msg("%s: %s", key->path, folder->report.message);
        if (has_one)
            hash_of(&folder->scene, "image", one);
        if (read_case(key, key->value) != SONJECT_OK)
            fail_msg("%s: %s", key->path, folder->report.message);
        hash_of(&folder->scene, "image", other);
        if (is_without_effect(key->path))
            continue;
        if (!has_one) {
            change(&folder->scene, key);
            hash_of(&folder->scene, "image", one);
        }
        if (strcmp(one, other) == 0)
            fail_msg("%s is not counted", key->path);
    }
}

/* Members that only C can set, and values in tables, count. */
TEST(test_what_no_key_names_counts)
{
    const double numbers[] = {-2.0, -1.0, 1.0, 2.0};
    struct report report = {.host = NULL};
    struct scene scene;
    sonject_object_params object;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    scene_init(&scene);
    object_init(&object);
    assert_int_equal(scene_append_object(&scene, &report, &object), SONJECT_OK);
    assert_int_equal(
        response_table_set(&scene.pulse_table, &report, numbers, numbers, numbers, 4, false),
        SONJECT_OK);
    assert_int_equal(motion_table_set(&scene.motion.yaw_table, &report, numbers, numbers, 4),
                     SONJECT_OK);
    scene.motion.params.sway_count = SONJECT_SWAYS_CAPACITY;
    scene.motion.params.yaw_count = SONJECT_YAWS_CAPACITY;
    void *const members[] = {&scene.surface.material.reflection_kind,
                             &scene.surface.material.density_ratio,
                             &scene.seabed.forward.reflection_kind,
                             &scene.injection.estimate_noise,
                             &scene.input_kind,
                             &scene.objects[0].material.reflection_kind,
                             &scene.objects[0].burial_kind,
                             &scene.objects[0].mesh,
                             &scene.motion.params.sways[SONJECT_SWAYS_CAPACITY - 1].phase_rad,
                             &scene.motion.params.yaws[SONJECT_YAWS_CAPACITY - 1].phase_rad,
                             &scene.motion.yaw_table.along_track_m[3],
                             &scene.motion.yaw_table.values[3],
                             &scene.pulse_table.is_time,
                             &scene.pulse_table.positions[3],
                             &scene.pulse_table.values[3].imaginary_part};
    hash_of(&scene, NULL, one);
    for (size_t i = 0; i < COUNT(members); i++) {
        *(unsigned char *)members[i] ^= 1;
        hash_of(&scene, NULL, other);
        *(unsigned char *)members[i] ^= 1;
        if (strcmp(one, other) == 0)
            fail_msg("member %zu is not counted", i);
    }
    hash_of(&scene, "an image", other);
    assert_string_not_equal(one, other);
    scene.object_count = 0;
    hash_of(&scene, NULL, other);
    assert_string_not_equal(one, other);
    scene_clear(&scene);
}

/* A NaN of any sign and payload is the seabed's own mu0. Bytes between members do not count. */
TEST(test_nan_is_one_value_and_padding_none)
{
    struct scene scene;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    const uint64_t patterns[] = {UINT64_C(0x7FF8000000000000), UINT64_C(0xFFF8000000000001)};
    scene_init(&scene);
    memcpy(&scene.seabed.forward.lambert, &patterns[0], sizeof patterns[0]);
    hash_of(&scene, NULL, one);
    memcpy(&scene.seabed.forward.lambert, &patterns[1], sizeof patterns[1]);
    hash_of(&scene, NULL, other);
    assert_string_equal(one, other);
    memset((char *)&scene.seabed.map + sizeof scene.seabed.map, 0x55,
           offsetof(sonject_seabed_params, lambert) - sizeof scene.seabed.map);
    hash_of(&scene, NULL, other);
    assert_string_equal(one, other);
    scene.seabed.forward.lambert = 0.0;
    hash_of(&scene, NULL, other);
    assert_string_not_equal(one, other);
    scene_clear(&scene);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
