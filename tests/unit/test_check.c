/* Ranges of a scene's values, and the defaults. */

#include "claims.h"
#include "first_key.h"
#include "scene/surface_material.h"
#include "schema/keys.h"

/* One of each structure, all good. */
struct all {
    sonject_sonar_params sonar;
    sonject_medium_params medium;
    sonject_seabed_params seabed;
    sonject_geometry_params geometry;
    sonject_transfer_params transfer;
    sonject_injection_params injection;
    sonject_synthetic_params synthetic;
    sonject_patch_params patch;
    sonject_object_params sphere, capsule, plane, cylinder, wedge, stump, torus;
};

static void make_good(struct all *all)
{
    memset(all, 0, sizeof *all);
    sonject_sonar_params_init(&all->sonar);
    all->sonar.array_length_m = 0.5; /* for the real kind */
    sonject_medium_params_init(&all->medium);
    sonject_seabed_params_init(&all->seabed);
    sonject_geometry_params_init(&all->geometry);
    all->geometry.first_slant_range_m = 40.0;
    sonject_transfer_params_init(&all->transfer);
    sonject_injection_params_init(&all->injection);
    sonject_synthetic_params_init(&all->synthetic);
    all->patch.rows = all->patch.columns = 10;
    sonject_object_params_init(&all->sphere);
    all->capsule = all->plane = all->sphere;
    all->capsule.shape = SONJECT_SHAPE_CAPSULE;
    all->capsule.length_m = 2.0;
    all->plane.shape = SONJECT_SHAPE_PLANE;
    all->plane.length_m = all->plane.width_m = 1.0;
    all->cylinder = all->capsule;
    all->cylinder.shape = SONJECT_SHAPE_CYLINDER;
    all->cylinder.nose_end = all->cylinder.tail_end = SONJECT_END_SPHERICAL;
    all->cylinder.nose_end_depth_m = all->cylinder.tail_end_depth_m = 0.125;
    all->wedge = all->plane;
    all->wedge.shape = SONJECT_SHAPE_WEDGE;
    all->wedge.height_m = 0.5;
    all->stump = all->sphere;
    all->stump.shape = SONJECT_SHAPE_TRUNCATED_CONE;
    all->stump.height_m = 0.5;
    all->torus = all->sphere;
    all->torus.shape = SONJECT_SHAPE_TORUS;
    all->torus.height_m = 0.125;
    all->sphere.cut_count = 2;
    all->sphere.cuts[0].distance_m = 0.2;
    all->sphere.cuts[1].azimuth_rad = 3.0;
    all->sphere.level_kind = SONJECT_LEVEL_TARGET_STRENGTH;
    all->capsule.burial_kind = SONJECT_BURIAL_FRACTION;
    all->capsule.material.reflection_kind = SONJECT_REFLECTION_FLUID;
    all->plane.burial_kind = SONJECT_BURIAL_PROUD;
}

static sonject_status check_all(const struct all *all, struct report *report,
                                struct check_listener *key)
{
    const struct {
        const struct section *section;
        const void *structure;
    } parts[] = {{&sonar_section, &all->sonar},         {&medium_section, &all->medium},
                 {&seabed_section, &all->seabed},       {&geometry_section, &all->geometry},
                 {&transfer_section, &all->transfer},   {&injection_section, &all->injection},
                 {&synthetic_section, &all->synthetic}, {&patch_section, &all->patch},
                 {&object_section, &all->sphere},       {&object_section, &all->capsule},
                 {&object_section, &all->plane},        {&object_section, &all->cylinder},
                 {&object_section, &all->wedge},        {&object_section, &all->stump},
                 {&object_section, &all->torus}};
    for (size_t i = 0; i < COUNT(parts); i++)
        CHECK(section_check(parts[i].section, parts[i].structure, report, key));
    return SONJECT_OK;
}

static void expect_refused(const struct all *all, const char *name, const char *what)
{
    struct report report = {{0}, NULL, NULL};
    struct first_key first = FIRST_KEY;
    if (check_all(all, &report, &first.listener) != SONJECT_ERROR_INPUT)
        fail_msg("%s of %s was taken", what, name);
    if (strncmp(first.key, name, strlen(name)) != 0)
        fail_msg("%s of %s was blamed on %s", what, name, first.key);
    if (strncmp(report.message, first.key, strlen(first.key)) != 0 ||
        report.message[strlen(first.key)] != ' ')
        fail_msg("the message does not start with %s: %s", first.key, report.message);
}

static void expect_taken(const struct all *all, const char *name, double value)
{
    struct report report = {{0}, NULL, NULL};
    if (check_all(all, &report, NULL) != SONJECT_OK)
        fail_msg("%s of %g was refused: %s", name, value, report.message);
}

#define NONE       NAN /* no such limit */
#define AT(member) offsetof(struct all, member)

/* A number, the smallest and largest that are taken, and what lies just beyond. */
static const struct number {
    const char *key;
    size_t offset;
    double below, least, most, above;
} numbers[] = {
    {"frequency", AT(sonar.centre_frequency_hz), 0.0, 20e3, 1e9, 2e9},
    {"bandwidth", AT(sonar.bandwidth_hz), 0.0, 1.0, 199999.0, 200000.0},
    {"altitude", AT(sonar.altitude_m), 0.0, 1e-6, 1e6, 2e6},
    {"resolution", AT(sonar.along_track_resolution_m), -0.1, 0.0, 1e6, 2e6},
    {"transducer", AT(sonar.transducer_side_m), -0.1, 0.0, 1e6, 2e6},
    {"aperture", AT(sonar.aperture_rad), NONE, -1.0, 0.5 * PI, 1.6},
    {"array.length", AT(sonar.array_length_m), -0.1, 0.0, 1e6, 2e6},
    {"array.height", AT(sonar.array_height_m), -0.1, 0.0, 1e6, 2e6},
    {"array.heading", AT(sonar.array_heading_rad), -0.8, -0.25 * PI, 0.25 * PI, 0.8},
    {"array.pitch", AT(sonar.array_pitch_rad), -0.8, -0.25 * PI, 0.25 * PI, 0.8},
    {"array.depression", AT(sonar.array_depression_rad), -0.1, 0.0, 0.5 * PI, 1.6},
    {"sound_speed", AT(medium.sound_speed_mps), 99.0, 100.0, 10000.0, 10001.0},
    {"reference_sound_speed", AT(medium.reference_sound_speed_mps), 99.0, 0.0, 10000.0, 10001.0},
    {"absorption", AT(medium.absorption_db_per_m), -0.1, 0.0, 100.0, 100.1},
    {"lambert", AT(seabed.lambert), 0.0, 1e-9, 0.3183098861837907, 0.3184},
    {"level_radius", AT(seabed.level_radius_m), 0.0, 1e-6, 1e6, 2e6},
    {"despeckle_radius", AT(seabed.despeckle_radius_m), 0.0, 1e-6, 1e6, 2e6},
    {"row_spacing", AT(geometry.row_spacing_m), 0.0, 1e-6, 1e6, 2e6},
    {"column_spacing", AT(geometry.column_spacing_m), 0.0, 1e-6, 1e6, 2e6},
    {"first_slant_range", AT(geometry.first_slant_range_m), -0.1, 0.0, 1e6, 2e6},
    {"first_along_track", AT(geometry.first_along_track_m), -2e6, -1e6, 1e6, 2e6},
    {"parameter", AT(transfer.parameter), NONE, -1e9, 1e9, NONE},
    {"offset", AT(transfer.offset), NONE, -1e9, 1e9, NONE},
    {"noise_floor", AT(injection.noise_floor_db), NONE, -1e9, -0.1, 0.0},
    {"influence", AT(injection.influence_db), -201.0, -200.0, 0.0, 0.1},
    {"rays", AT(injection.ray_scale), 0.015, 1.0 / 64.0, 4096.0, 4097.0},
    {"texture_length", AT(synthetic.texture_length_m), 0.0, 1e-6, 1e6, 2e6},
    {"ripple_wavelength", AT(synthetic.ripple_wavelength_m), 0.0, 1e-6, 1e6, 2e6},
    {"ripple_contrast", AT(synthetic.ripple_contrast), -0.1, 0.0, 1.0, 1.1},
    {"ripple_heading", AT(synthetic.ripple_heading_rad), NONE, -9.0, 9.0, NONE},
    {"patch_contrast", AT(synthetic.patch_contrast_db), -0.1, 0.0, 100.0, 101.0},
    {"patch_length", AT(synthetic.patch_length_m), 0.0, 1e-6, 1e6, 2e6},
    {"mean_amplitude", AT(synthetic.mean_amplitude), 0.0, 1e-6, 1e6, 2e6},
    {"diameter", AT(sphere.diameter_m), 0.0, 1e-6, 1e6, 2e6},
    {"length", AT(capsule.length_m), 0.49, 0.5, 1e6, 2e6},
    {"diameter", AT(capsule.diameter_m), 0.0, 1e-6, 2.0, NONE},
    {"length", AT(plane.length_m), 0.0, 1e-6, 1e6, 2e6},
    {"width", AT(plane.width_m), 0.0, 1e-6, 1e6, 2e6},
    {"width", AT(sphere.width_m), NONE, 0.0, 1.0, NONE},
    {"length", AT(cylinder.length_m), 0.249, 0.25, 1e6, 2e6},
    {"nose_end.depth", AT(cylinder.nose_end_depth_m), -0.01, 0.0, 0.25, 0.251},
    {"tail_end.depth", AT(cylinder.tail_end_depth_m), -0.01, 0.0, 0.25, 0.251},
    {"length", AT(wedge.length_m), 0.0, 1e-6, 1e6, 2e6},
    {"width", AT(wedge.width_m), 0.0, 1e-6, 1e6, 2e6},
    {"height", AT(wedge.height_m), 0.0, 1e-6, 1e6, 2e6},
    {"front_height", AT(wedge.front_height_m), -0.01, 0.0, 0.5, 0.51},
    {"diameter", AT(stump.diameter_m), 0.0, 1e-6, 1e6, 2e6},
    {"top_diameter", AT(stump.top_diameter_m), -0.01, 0.0, 1e6, 2e6},
    {"height", AT(stump.height_m), 0.0, 1e-6, 1e6, 2e6},
    {"diameter", AT(torus.diameter_m), 0.25, 0.2501, 1e6, 2e6},
    {"height", AT(torus.height_m), 0.0, 1e-6, 0.24, NONE},
    {"height", AT(sphere.height_m), NONE, 0.0, 1.0, NONE},
    {"cuts", AT(sphere.cuts[0].azimuth_rad), NONE, -2.0, 2.0, NONE},
    {"cuts", AT(sphere.cuts[0].elevation_rad), NONE, -2.0, 2.0, NONE},
    /* the sphere's radius is 0.25 m, and the other cut takes the side away */
    {"cuts", AT(sphere.cuts[0].distance_m), -0.2501, 0.0, 1e6, 2e6},
    {"cuts", AT(sphere.cuts[1].distance_m), -0.2501, 0.0, 1e6, 2e6},
    {"burial.fraction", AT(capsule.burial_fraction), -0.01, 0.0, 1.0, 1.01},
    {"match.looks", AT(injection.match_looks), 0.9, 1.0, 64.0, 65.0},
    {"level", AT(sphere.level_db), -201.0, -200.0, 200.0, 201.0},
    {"burial.proud", AT(plane.proud_height_m), -0.01, 0.0, 1e6, 2e6},
    {"heading", AT(sphere.heading_rad), NONE, -9.0, 9.0, NONE},
    {"pitch", AT(sphere.pitch_rad), NONE, -9.0, 9.0, NONE},
    {"roll", AT(sphere.roll_rad), NONE, -9.0, 9.0, NONE},
    {"burial", AT(sphere.burial_m), -2e6, -1e6, 1e6, 2e6},
    {"material.reflection", AT(sphere.material.reflection), -1.01, -1.0, 1.0, 1.01},
    {"material.roughness", AT(sphere.material.roughness_m), -0.1, 0.0, 1.0, 1.1},
    /* reflection^2 / pi = 0.257831 */
    {"material.lambert", AT(sphere.material.lambert), -0.1, 0.0, 0.2578, 0.2579},
    {"material.exponent", AT(sphere.material.lambert_exponent), 0.9, 1.0, 64.0, 64.1},
    /* reflection^2 - pi * lambert = 0.495841 */
    {"material.glossy.albedo", AT(sphere.material.glossy_albedo), -0.1, 0.0, 0.4958, 0.4959},
    {"material.glossy.slope", AT(sphere.material.glossy_slope), 0.009, 0.01, 1.0, 1.1},
    {"material.fluid.density", AT(capsule.material.density_ratio), 0.0009, 0.001, 100.0, 101.0},
    {"material.fluid.speed", AT(capsule.material.speed_ratio), 0.009, 0.01, 20.0, 20.1},
    {"material.fluid.loss", AT(capsule.material.loss), -0.1, 0.0, 1.0, 1.1},
    {"forward.reflection", AT(seabed.forward.reflection), -1.01, -1.0, 1.0, 1.01},
    {"forward.roughness", AT(seabed.forward.roughness_m), -0.1, 0.0, 1.0, 1.1},
    {"forward.exponent", AT(seabed.forward.lambert_exponent), 0.9, 1.0, 64.0, 64.1},
    /* 1 - pi * 10^-2.7 = 0.993732 */
    {"forward.glossy.albedo", AT(seabed.forward.glossy_albedo), -0.1, 0.0, 0.9937, 0.9938},
    {"forward.glossy.slope", AT(seabed.forward.glossy_slope), 0.009, 0.01, 1.0, 1.1},
};

static void put(struct all *all, const struct number *number, double value)
{
    make_good(all);
    memcpy((char *)all + number->offset, &value, sizeof value);
}

static void test_limits(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(numbers); i++) {
        const struct number *number = &numbers[i];
        struct all all;
        put(&all, number, number->least);
        expect_taken(&all, number->key, number->least);
        put(&all, number, number->most);
        expect_taken(&all, number->key, number->most);
        put(&all, number, number->below);
        expect_refused(&all, number->key, "the value below");
        put(&all, number, number->above);
        expect_refused(&all, number->key, "the value above");
    }
}

static void test_only_finite_numbers(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    (void)state;
    for (size_t i = 0; i < COUNT(numbers); i++)
        for (size_t j = 0; j < COUNT(bad); j++) {
            struct all all;
            put(&all, &numbers[i], bad[j]);
            expect_refused(&all, numbers[i].key, "a value that is not finite");
        }
}

static void test_speckle_may_be_rayleigh(void **state)
{
    struct all all;
    (void)state;
    make_good(&all);
    all.synthetic.speckle_shape = INFINITY;
    expect_taken(&all, "speckle_shape", INFINITY);
    all.synthetic.speckle_shape = -INFINITY;
    expect_refused(&all, "speckle_shape", "minus infinity");
    all.synthetic.speckle_shape = NAN;
    expect_refused(&all, "speckle_shape", "NaN");
    all.synthetic.speckle_shape = 0.0;
    expect_refused(&all, "speckle_shape", "zero");
}

static void test_choices(void **state)
{
    static const struct {
        const char *key;
        size_t offset;
        uint32_t last;
    } choices[] = {
        {"response", AT(sonar.response_window), SONJECT_WINDOW_TAYLOR},
        {"kind", AT(sonar.kind), SONJECT_SONAR_REAL},
        {"map", AT(seabed.map), SONJECT_MAP_COHERENT},
        {"side", AT(geometry.side), SONJECT_SIDE_STARBOARD},
        {"kind", AT(transfer.kind), SONJECT_TRANSFER_SCHLICK},
        {"mode", AT(injection.mode), SONJECT_MODE_RESYNTHESISE},
        {"columns", AT(injection.column_rule), SONJECT_COLUMNS_PAPER},
        {"noise_floor", AT(injection.estimate_noise), 1},
        {"complex", AT(synthetic.complex_pixels), 1},
        {"order_energies", AT(injection.order_energies), 1},
        {"match.response", AT(injection.match_response), SONJECT_MATCH_IMAGE},
        {"match.saturation", AT(injection.match_saturation), SONJECT_MATCH_IMAGE},
        {"level", AT(sphere.level_kind), SONJECT_LEVEL_OVER_SEABED},
        {"position", AT(sphere.position_kind), SONJECT_POSITION_PIXELS},
        {"burial", AT(sphere.burial_kind), SONJECT_BURIAL_PROUD},
        {"nose_end", AT(cylinder.nose_end), SONJECT_END_SPHERICAL},
        {"tail_end", AT(cylinder.tail_end), SONJECT_END_SPHERICAL},
        {"cuts", AT(sphere.cut_count), SONJECT_CUTS_CAPACITY},
        {"material.reflection", AT(sphere.material.reflection_kind), SONJECT_REFLECTION_FLUID},
        {"forward.reflection", AT(seabed.forward.reflection_kind), SONJECT_REFLECTION_FLUID},
    };
    struct all all;
    (void)state;
    for (size_t i = 0; i < COUNT(choices); i++) {
        for (uint32_t value = 0; value <= choices[i].last; value++) {
            make_good(&all);
            memcpy((char *)&all + choices[i].offset, &value, sizeof value);
            expect_taken(&all, choices[i].key, value);
        }
        for (uint32_t value = choices[i].last + 1; value; value <<= 1) {
            make_good(&all);
            memcpy((char *)&all + choices[i].offset, &value, sizeof value);
            expect_refused(&all, choices[i].key, "an unknown choice");
        }
    }
    make_good(&all);
    all.sphere.shape = SONJECT_SHAPE_USER + 1;
    expect_refused(&all, "shape", "an unknown choice");
    assert_null(shape_name(SONJECT_SHAPE_USER + 1));
    assert_string_equal(shape_name(SONJECT_SHAPE_CYLINDER), "cylinder");
}

/* pi * lambert + glossy_albedo against what there is: reflection^2, or 1 where there is no smooth
 * part or a fluid's. */
static void test_no_surface_returns_more_than_it_receives(void **state)
{
    struct all all;
    sonject_material_params *material = &all.sphere.material;
    (void)state;
    make_good(&all);
    material->reflection = -0.5;
    material->lambert = 0.0795; /* 0.25 / pi = 0.0795775 */
    expect_taken(&all, "material.lambert", 0.0795);
    material->lambert = 0.0796;
    expect_refused(&all, "material.lambert", "more than reflection^2 / pi");
    material->lambert = 0.0;
    material->glossy_albedo = 0.25;
    expect_taken(&all, "material.glossy.albedo", 0.25);
    material->glossy_albedo = 0.2501;
    expect_refused(&all, "material.glossy.albedo", "more than reflection^2");
    material->reflection_kind = SONJECT_REFLECTION_FLUID;
    material->glossy_albedo = 1.0;
    expect_taken(&all, "material.glossy.albedo", 1.0);
    material->lambert = 0.001;
    expect_refused(&all, "material.glossy.albedo", "more than is left");
    material->lambert = NAN;
    expect_refused(&all, "material.lambert", "NaN, which only a seabed may have");
    make_good(&all);
    material->reflection = 0.0;
    material->lambert = 0.3183;
    expect_taken(&all, "material.lambert", 0.3183);
    material->lambert = 0.3184;
    expect_refused(&all, "material.lambert", "more than all energy");
}

static void test_the_seabeds_forward_material(void **state)
{
    struct all all;
    sonject_material_params *forward = &all.seabed.forward;
    (void)state;
    make_good(&all);
    assert_true(isnan(forward->lambert));
    all.seabed.lambert = 0.02;
    forward->reflection = 0.2;
    expect_refused(&all, "forward.lambert", "the seabed's own, 0.0628 of 0.04");
    forward->reflection = 0.3;
    expect_taken(&all, "forward.lambert", 0.02);
    forward->glossy_albedo = 0.0271; /* 0.09 - pi * 0.02 = 0.027168 */
    expect_taken(&all, "forward.glossy.albedo", 0.0271);
    forward->glossy_albedo = 0.0272;
    expect_refused(&all, "forward.glossy.albedo", "more than is left");
    forward->lambert = 0.0;
    expect_taken(&all, "forward.lambert", 0.0);
    forward->glossy_albedo = 0.0;
    forward->lambert = 0.0287; /* 0.09 / pi = 0.028648 */
    expect_refused(&all, "forward.lambert", "a number of its own that is too large");
    forward->reflection_kind = SONJECT_REFLECTION_FLUID;
    expect_taken(&all, "forward.lambert", 0.0287);
    forward->lambert = INFINITY;
    expect_refused(&all, "forward.lambert", "infinity");
}

/* What its lambert leaves is the surface's cone unless a number is given. */
static void test_the_sea_surfaces_rough_part(void **state)
{
    struct report report = {{0}, NULL, NULL};
    struct first_key first = FIRST_KEY;
    sonject_surface_params surface;
    sonject_material_params *material = &surface.material;
    (void)state;
    sonject_surface_params_init(&surface);
    assert_true(surface.water_depth_m == 0.0 && material->reflection == -1.0);
    assert_true(material->roughness_m == 0.0 && material->lambert == 0.0);
    assert_true(isnan(material->glossy_albedo) && material->glossy_slope == 0.2);
    assert_true(surface_material(&surface).glossy_albedo == 1.0);
    material->reflection = -0.5;
    material->lambert = 0.05;
    assert_int_equal(check_surface(&surface, &report, &first.listener), SONJECT_OK);
    const double left = 0.25 - 3.14159265358979 * 0.05;
    assert_true(fabs(surface_material(&surface).glossy_albedo - left) < 1e-12); /* digits of pi */
    material->glossy_albedo = 0.0;
    assert_true(surface_material(&surface).glossy_albedo == 0.0);
    material->glossy_albedo = 0.1;
    assert_int_equal(check_surface(&surface, &report, &first.listener), SONJECT_ERROR_INPUT);
    assert_string_equal(first.key, "glossy.albedo");
    first.key[0] = 0;
    material->glossy_albedo = NAN;
    material->lambert = 0.0796; /* 0.25 / pi = 0.0795775 */
    assert_int_equal(check_surface(&surface, &report, &first.listener), SONJECT_ERROR_INPUT);
    assert_string_equal(first.key, "lambert");
    material->reflection = 0.0;
    material->lambert = 0.0;
    assert_true(surface_material(&surface).glossy_albedo == 0.0);
    material->reflection_kind = SONJECT_REFLECTION_FLUID;
    assert_true(surface_material(&surface).glossy_albedo == 1.0);
}

static void test_sizes_of_swath_and_patch(void **state)
{
    struct report report = {{0}, NULL, NULL};
    struct all all;
    const uint32_t side = UINT32_C(1) << 20;
    (void)state;
    assert_int_equal(check_uniform(1, side, &report, NULL), SONJECT_OK);
    assert_int_equal(check_uniform(2048, side, &report, NULL), SONJECT_OK);
    assert_int_equal(check_uniform(2049, side, &report, NULL), SONJECT_ERROR_INPUT);
    assert_int_equal(check_uniform(side, side, &report, NULL), SONJECT_ERROR_INPUT);
    assert_int_equal(check_uniform(0, 1, &report, NULL), SONJECT_ERROR_INPUT);
    assert_int_equal(check_uniform(1, 0, &report, NULL), SONJECT_ERROR_INPUT);
    assert_int_equal(check_uniform(side + 1, 1, &report, NULL), SONJECT_ERROR_INPUT);
    make_good(&all);
    all.synthetic.rows = all.synthetic.columns = UINT32_MAX;
    expect_refused(&all, "rows", "too large a size");
    make_good(&all);
    memset(&all.patch, 0, sizeof all.patch);
    expect_taken(&all, "patch", 0.0);
    all.patch.first_row = 1;
    expect_refused(&all, "rows", "no rows");
    all.patch.rows = 1;
    expect_refused(&all, "columns", "no columns");
    all.patch.columns = UINT64_C(1) << 40;
    expect_taken(&all, "patch", 0.0);
    all.patch.first_row = UINT64_MAX;
    expect_refused(&all, "row", "2^64 - 1");
}

static void test_names(void **state)
{
    struct all all;
    (void)state;
    make_good(&all);
    memset(all.sphere.name, 'x', sizeof all.sphere.name);
    expect_refused(&all, "name", "no end");
    all.sphere.name[63] = 0;
    expect_taken(&all, "name", 63.0);
    strcpy(all.sphere.class_name, "a\nb");
    expect_refused(&all, "class", "a line break");
    strcpy(all.sphere.class_name, "\xFF");
    expect_refused(&all, "class", "no UTF-8");
}

/* What the public headers promise. */
static void test_defaults(void **state)
{
    struct scene scene;
    struct report report = {{0}, NULL, NULL};
    sonject_object_params object;
    (void)state;
    scene_init(&scene);
    assert_int_equal(scene.sonar.struct_size, sizeof scene.sonar);
    assert_true(scene.sonar.centre_frequency_hz == 100e3 && scene.sonar.bandwidth_hz == 30e3);
    assert_true(scene.sonar.altitude_m == 10.0 && scene.sonar.transducer_side_m == 0.0);
    assert_int_equal(scene.sonar.response_window, SONJECT_WINDOW_RECTANGULAR);
    assert_true(scene.medium.sound_speed_mps == 1500.0 && scene.medium.absorption_db_per_m == 0.0);
    assert_null(scene.water_layers);
    assert_true(fabs(10.0 * log10(scene.seabed.lambert) + 27.0) < 1e-12); /* rounding of log10 */
    assert_true(scene.seabed.level_radius_m == 3.0 && scene.seabed.despeckle_radius_m == 0.1);
    assert_true(scene.geometry.row_spacing_m == 0.025 && scene.geometry.column_spacing_m == 0.025);
    assert_int_equal(scene.geometry.side, SONJECT_SIDE_PORT);
    assert_int_equal(scene.injection.mode, SONJECT_MODE_COMPOSITE);
    assert_int_equal(scene.injection.column_rule, SONJECT_COLUMNS_FOCUSED);
    assert_true(scene.injection.estimate_noise == 1 && scene.injection.seed == 1);
    assert_true(scene.injection.influence_db == -40.0 && scene.injection.ray_scale == 1.0);
    assert_int_equal(scene.injection.interactions, 1);
    assert_int_equal(scene.injection.estimator, SONJECT_ESTIMATOR_CONNECT);
    assert_int_equal(scene.injection.order_energies, 0);
    assert_int_equal(scene.seabed.forward_rule, SONJECT_FORWARD_MODEL);
    assert_true(isnan(scene.seabed.forward.lambert) && scene.seabed.forward.reflection == 0.0);
    assert_int_equal(scene.synthetic.rows, 400);
    assert_int_equal(scene.input_kind, SONJECT_INPUT_MEMORY);
    assert_int_equal(scene.transfer.kind, SONJECT_TRANSFER_AMPLITUDE);
    assert_int_equal(check_geometry(&scene.geometry, &report, NULL), SONJECT_ERROR_INPUT);
    sonject_object_params_init(&object);
    assert_true(object.shape == SONJECT_SHAPE_SPHERE && object.diameter_m == 0.5);
    assert_true(object.material.reflection == 0.9 && object.material.roughness_m == 1e-3);
    assert_true(object.material.lambert == 0.1 && object.burial_m == 0.0);
    assert_true(object.material.lambert_exponent == 1.0 && object.material.glossy_albedo == 0.0);
    scene_clear(&scene);
}

static void test_objects_are_copied_up_to_the_limit(void **state)
{
    struct scene scene;
    struct report report = {{0}, NULL, NULL};
    sonject_object_params object;
    (void)state;
    scene_init(&scene);
    sonject_object_params_init(&object);
    for (uint32_t i = 0; i < SCENE_OBJECTS_MAX; i++) {
        object.diameter_m = i;
        assert_int_equal(scene_append_object(&scene, &report, &object), SONJECT_OK);
    }
    assert_int_equal(scene_append_object(&scene, &report, &object), SONJECT_ERROR_INPUT);
    assert_int_equal(scene.object_count, SCENE_OBJECTS_MAX);
    for (uint32_t i = 0; i < SCENE_OBJECTS_MAX; i++)
        assert_true(scene.objects[i].diameter_m == i);
    scene_clear(&scene);
    assert_int_equal(scene.object_count, 0);
    assert_null(scene.objects);
}

TEST_PROGRAM(NULL, NULL, TEST(test_limits), TEST(test_only_finite_numbers),
             TEST(test_speckle_may_be_rayleigh), TEST(test_choices),
             TEST(test_no_surface_returns_more_than_it_receives),
             TEST(test_the_seabeds_forward_material), TEST(test_the_sea_surfaces_rough_part),
             TEST(test_sizes_of_swath_and_patch), TEST(test_names), TEST(test_defaults),
             TEST(test_objects_are_copied_up_to_the_limit))
