/* What counts as the same inputs of a run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "api/scene_hash.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static void hash_of(const struct scene *scene, const char *identity, char text[HASH_TEXT_CAPACITY])
{
    struct report report = {{0}, NULL, NULL};
    assert_int_equal(scene_hash(&report, scene, identity, text), SONJECT_OK);
}

static void make_scene(struct scene *scene)
{
    struct report report = {{0}, NULL, NULL};
    sonject_object_params object;
    scene_init(scene);
    sonject_object_params_init(&object);
    object.cut_count = SONJECT_CUTS_CAPACITY;
    assert_int_equal(scene_append_object(scene, &report, &object), SONJECT_OK);
}

#define SCENE(member)                                                                              \
    {                                                                                              \
#member, offsetof(struct scene, member), sizeof((struct scene *)0)->member                 \
    }
#define OBJECT(member)                                                                             \
    {                                                                                              \
#member, offsetof(sonject_object_params, member),                                          \
            sizeof((sonject_object_params *)0)->member                                             \
    }
#define MATERIAL(KIND, material)                                                                   \
    KIND(material.reflection_kind), KIND(material.reflection), KIND(material.roughness_m),         \
        KIND(material.lambert), KIND(material.lambert_exponent), KIND(material.glossy_albedo),     \
        KIND(material.glossy_slope), KIND(material.density_ratio), KIND(material.speed_ratio),     \
        KIND(material.loss)

struct member {
    const char *name;
    size_t offset, bytes;
};

static const struct member of_scene[] = {
    SCENE(sonar.response_window),
    SCENE(sonar.centre_frequency_hz),
    SCENE(sonar.bandwidth_hz),
    SCENE(sonar.altitude_m),
    SCENE(sonar.along_track_resolution_m),
    SCENE(sonar.transducer_side_m),
    SCENE(sonar.taylor_sidelobe_db),
    SCENE(pulse.kind),
    SCENE(pulse.window),
    SCENE(pulse.taylor_terms),
    SCENE(pulse.taylor_sidelobe_db),
    SCENE(motion.params.sway_count),
    SCENE(motion.params.random_rms_m),
    SCENE(motion.params.random_correlation_m),
    SCENE(motion.params.seed),
    SCENE(sonar.taylor_terms),
    SCENE(sonar.kind),
    SCENE(sonar.aperture_rad),
    SCENE(sonar.array_length_m),
    SCENE(sonar.array_height_m),
    SCENE(sonar.array_heading_rad),
    SCENE(sonar.array_pitch_rad),
    SCENE(sonar.array_depression_rad),
    SCENE(medium.sound_speed_mps),
    SCENE(medium.reference_sound_speed_mps),
    SCENE(medium.absorption_db_per_m),
    SCENE(seabed.map),
    SCENE(seabed.lambert),
    SCENE(seabed.level_radius_m),
    SCENE(seabed.despeckle_radius_m),
    SCENE(seabed.forward_rule),
    MATERIAL(SCENE, seabed.forward),
    SCENE(geometry.side),
    SCENE(geometry.row_spacing_m),
    SCENE(geometry.column_spacing_m),
    SCENE(geometry.first_along_track_m),
    SCENE(geometry.first_slant_range_m),
    SCENE(transfer.kind),
    SCENE(transfer.parameter),
    SCENE(transfer.offset),
    SCENE(injection.mode),
    SCENE(injection.column_rule),
    SCENE(injection.estimate_noise),
    SCENE(injection.noise_floor_db),
    SCENE(injection.influence_db),
    SCENE(injection.ray_scale),
    SCENE(injection.seed),
    SCENE(injection.interactions),
    SCENE(injection.estimator),
    SCENE(injection.order_energies),
    SCENE(injection.match_response),
    SCENE(injection.match_looks),
    SCENE(injection.match_saturation),
    SCENE(patch.first_row),
    SCENE(patch.first_column),
    SCENE(patch.rows),
    SCENE(patch.columns),
    SCENE(input_kind),
};

static const struct member of_object[] = {
    OBJECT(shape),
    OBJECT(length_m),
    OBJECT(width_m),
    OBJECT(diameter_m),
    OBJECT(position_kind),
    OBJECT(position_along),
    OBJECT(position_range),
    OBJECT(heading_rad),
    OBJECT(pitch_rad),
    OBJECT(roll_rad),
    OBJECT(burial_m),
    OBJECT(name),
    OBJECT(class_name),
    OBJECT(burial_kind),
    OBJECT(burial_fraction),
    OBJECT(proud_height_m),
    OBJECT(height_m),
    OBJECT(top_diameter_m),
    OBJECT(front_height_m),
    OBJECT(nose_end),
    OBJECT(tail_end),
    OBJECT(nose_end_depth_m),
    OBJECT(tail_end_depth_m),
    OBJECT(user_shape),
    OBJECT(level_kind),
    OBJECT(level_db),
    OBJECT(cut_count),
    OBJECT(cuts[0].azimuth_rad),
    OBJECT(cuts[0].elevation_rad),
    OBJECT(cuts[0].distance_m),
    OBJECT(cuts[1].azimuth_rad),
    OBJECT(cuts[1].elevation_rad),
    OBJECT(cuts[1].distance_m),
    MATERIAL(OBJECT, material),
};

/* Turns one bit of a member, which a double's value follows unless it is NaN. */
static void expect_counted(const struct scene *scene, void *structure, const struct member *member)
{
    char before[HASH_TEXT_CAPACITY], after[HASH_TEXT_CAPACITY];
    unsigned char *byte = (unsigned char *)structure + member->offset;
    double number = 0.0;
    if (member->bytes == sizeof number)
        memcpy(&number, byte, sizeof number);
    if (isnan(number))
        memset(byte, 0, member->bytes);
    hash_of(scene, NULL, before);
    byte[0] ^= 1;
    hash_of(scene, NULL, after);
    byte[0] ^= 1;
    if (strcmp(before, after) == 0)
        fail_msg("%s is not counted", member->name);
}

static void test_every_member_counts(void **state)
{
    struct scene scene;
    (void)state;
    make_scene(&scene);
    for (size_t i = 0; i < COUNT(of_scene); i++)
        expect_counted(&scene, &scene, &of_scene[i]);
    for (size_t i = 0; i < COUNT(of_object); i++)
        expect_counted(&scene, scene.objects, &of_object[i]);
    scene_clear(&scene);
}

static void test_layers_of_water_count(void **state)
{
    static const struct member of_layer[] = {
        {"bottom_m", offsetof(struct water_layer, bottom_m), sizeof(double)},
        {"speed_mps", offsetof(struct water_layer, speed_mps), sizeof(double)},
        {"density", offsetof(struct water_layer, density), sizeof(double)},
    };
    const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {12.0, 1500.0, 1.0}};
    struct scene scene;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    (void)state;
    make_scene(&scene);
    hash_of(&scene, NULL, one);
    scene.water_layers = malloc(sizeof layers);
    assert_non_null(scene.water_layers);
    memcpy(scene.water_layers, layers, sizeof layers);
    scene.water_layer_count = 1;
    hash_of(&scene, NULL, other);
    assert_string_not_equal(one, other);
    scene.water_layer_count = 2;
    hash_of(&scene, NULL, one);
    assert_string_not_equal(one, other);
    for (size_t i = 0; i < 2 * COUNT(of_layer); i++)
        expect_counted(&scene, &scene.water_layers[i / COUNT(of_layer)],
                       &of_layer[i % COUNT(of_layer)]);
    scene_clear(&scene);
}

static void test_measured_responses_and_motion_count(void **state)
{
    const double positions[] = {-2.0, -1.0, 1.0, 2.0};
    const double values[] = {0.0, 1.0, 0.5, 0.0};
    static const struct member of_sway[] = {
        {"amplitude_m", offsetof(sonject_sway, amplitude_m), sizeof(double)},
        {"wavelength_m", offsetof(sonject_sway, wavelength_m), sizeof(double)},
        {"phase_rad", offsetof(sonject_sway, phase_rad), sizeof(double)},
    };
    struct report report = {{0}, NULL, NULL};
    struct scene scene;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    (void)state;
    make_scene(&scene);
    struct response_table *const tables[] = {&scene.pulse_table, &scene.cross_range_table};
    for (size_t i = 0; i < COUNT(tables); i++) {
        hash_of(&scene, NULL, one);
        assert_int_equal(
            response_table_set(tables[i], &report, positions, values, values, 4, false),
            SONJECT_OK);
        hash_of(&scene, NULL, other);
        assert_string_not_equal(one, other);
        tables[i]->is_time = true;
        hash_of(&scene, NULL, one);
        assert_string_not_equal(one, other);
        static const struct member of_value[] = {
            {"real_part", offsetof(struct complex_number, real_part), sizeof(double)},
            {"imaginary_part", offsetof(struct complex_number, imaginary_part), sizeof(double)},
        };
        const struct member position = {"position", 0, sizeof(double)};
        expect_counted(&scene, &tables[i]->positions[3], &position);
        for (size_t j = 0; j < COUNT(of_value); j++)
            expect_counted(&scene, &tables[i]->values[3], &of_value[j]);
    }
    static const struct member of_yaw[] = {
        {"amplitude_rad", offsetof(sonject_yaw, amplitude_rad), sizeof(double)},
        {"wavelength_m", offsetof(sonject_yaw, wavelength_m), sizeof(double)},
        {"phase_rad", offsetof(sonject_yaw, phase_rad), sizeof(double)},
    };
    static const struct member of_yaws[] = {
        {"yaw_advance_m", offsetof(sonject_motion_params, yaw_advance_m), sizeof(double)},
        {"yaw_bias_rad", offsetof(sonject_motion_params, yaw_bias_rad), sizeof(double)},
        {"yaw_random_rms_rad", offsetof(sonject_motion_params, yaw_random_rms_rad), sizeof(double)},
        {"yaw_random_correlation_m", offsetof(sonject_motion_params, yaw_random_correlation_m),
         sizeof(double)},
        {"yaw_seed", offsetof(sonject_motion_params, yaw_seed), sizeof(uint64_t)},
    };
    struct motion_table *const motions[] = {&scene.motion.sway_table, &scene.motion.yaw_table};
    for (size_t i = 0; i < COUNT(motions); i++) {
        const struct member value = {"a table's value", 0, sizeof(double)};
        hash_of(&scene, NULL, one);
        assert_int_equal(motion_table_set(motions[i], &report, positions, values, 4), SONJECT_OK);
        hash_of(&scene, NULL, other);
        assert_string_not_equal(one, other);
        expect_counted(&scene, &motions[i]->along_track_m[3], &value);
        expect_counted(&scene, &motions[i]->values[3], &value);
    }
    for (size_t i = 0; i < COUNT(of_yaws); i++)
        expect_counted(&scene, &scene.motion.params, &of_yaws[i]);
    scene.motion.params.yaw_count = SONJECT_YAWS_CAPACITY;
    for (size_t i = 0; i < SONJECT_YAWS_CAPACITY * COUNT(of_yaw); i++)
        expect_counted(&scene, &scene.motion.params.yaws[i / COUNT(of_yaw)],
                       &of_yaw[i % COUNT(of_yaw)]);
    scene.motion.params.sway_count = SONJECT_SWAYS_CAPACITY;
    for (size_t i = 0; i < SONJECT_SWAYS_CAPACITY * COUNT(of_sway); i++)
        expect_counted(&scene, &scene.motion.params.sways[i / COUNT(of_sway)],
                       &of_sway[i % COUNT(of_sway)]);
    scene_clear(&scene);
}

static void test_parts_count(void **state)
{
    static const struct member of_part[] = {
        {"object", offsetof(struct scene_part, object), sizeof(uint32_t)},
        {"axes", offsetof(struct scene_part, axes), sizeof(double)},
        {"last of the axes", offsetof(struct scene_part, axes[2][2]), sizeof(double)},
        {"centre", offsetof(struct scene_part, centre), sizeof(double)},
        {"last of the centre", offsetof(struct scene_part, centre[2]), sizeof(double)},
    };
    struct report report = {{0}, NULL, NULL};
    struct scene scene;
    struct scene_part part;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    (void)state;
    make_scene(&scene);
    hash_of(&scene, NULL, one);
    memset(&part, 0, sizeof part);
    part.shape = scene.objects[0];
    for (int i = 0; i < 2; i++) {
        assert_int_equal(scene_append_part(&scene, &report, &part), SONJECT_OK);
        hash_of(&scene, NULL, other);
        assert_string_not_equal(one, other);
        memcpy(one, other, sizeof one);
    }
    for (size_t i = 0; i < COUNT(of_part); i++)
        expect_counted(&scene, &scene.parts[1], &of_part[i]);
    for (size_t i = 0; i < COUNT(of_object); i++)
        expect_counted(&scene, &scene.parts[1].shape, &of_object[i]);
    scene_clear(&scene);
}

static void test_input_and_number_of_objects_count(void **state)
{
    struct scene scene;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    (void)state;
    make_scene(&scene);
    hash_of(&scene, "some image", one);
    hash_of(&scene, "another image", other);
    assert_string_not_equal(one, other);
    scene.object_count = 0;
    hash_of(&scene, "some image", other);
    assert_string_not_equal(one, other);
    scene_clear(&scene);
}

/* The seabed's own mu0 is a NaN of any sign and payload; what is between members is nothing. */
static void test_nan_is_one_value_and_padding_none(void **state)
{
    struct scene scene;
    char one[HASH_TEXT_CAPACITY], other[HASH_TEXT_CAPACITY];
    const uint64_t patterns[] = {UINT64_C(0x7FF8000000000000), UINT64_C(0xFFF8000000000001)};
    (void)state;
    make_scene(&scene);
    memcpy(&scene.seabed.forward.lambert, &patterns[0], sizeof patterns[0]);
    hash_of(&scene, NULL, one);
    memcpy(&scene.seabed.forward.lambert, &patterns[1], sizeof patterns[1]);
    hash_of(&scene, NULL, other);
    assert_string_equal(one, other);
    scene.seabed.forward.struct_size++;
    scene.seabed.reserved++;
    scene.injection.reserved++;
    hash_of(&scene, NULL, other);
    assert_string_equal(one, other);
    scene.seabed.forward.lambert = 0.0;
    hash_of(&scene, NULL, other);
    assert_string_not_equal(one, other);
    scene_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_member_counts),
        cmocka_unit_test(test_layers_of_water_count),
        cmocka_unit_test(test_measured_responses_and_motion_count),
        cmocka_unit_test(test_parts_count),
        cmocka_unit_test(test_input_and_number_of_objects_count),
        cmocka_unit_test(test_nan_is_one_value_and_padding_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
