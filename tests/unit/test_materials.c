/* Tests materials by name. */
#include "claims.h"

#include "scene/params.h"

#include "schema/keys.h"

static sonject_material_params take(const char *name)
{
    sonject_material_params material;
    memset(&material, 0x55, sizeof material); /* none of these bytes must remain */
    if (!material_named(name, &material))
        fail_msg("%s is not known", name);
    return material;
}

static void expect_same(const sonject_material_params *a, const sonject_material_params *b)
{
    assert_true(a->reflection_kind == b->reflection_kind);
    assert_true(a->reflection == b->reflection && a->roughness_m == b->roughness_m);
    assert_true(a->lambert == b->lambert && a->lambert_exponent == b->lambert_exponent);
    assert_true(a->glossy_albedo == b->glossy_albedo && a->glossy_slope == b->glossy_slope);
    assert_true(a->density_ratio == b->density_ratio && a->speed_ratio == b->speed_ratio);
    assert_true(a->loss == b->loss);
}

/* Expects values to be allowed, as if keys gave them. */
static void expect_sound(const char *name, const struct section *section,
                         const sonject_material_params *material)
{
    for (size_t i = 0; i < section->count; i++) {
        char what[300];
        const struct field *field = &section->fields[i];
        if (!field_is_valid(field, material, what))
            fail_msg("%s: %s %s", name, field->key, what);
        if (field->section) /* its fields are in the same structure */
            expect_sound(name, field->section, material);
    }
}

TEST(test_values_are_allowed)
{
    const char *name;
    for (uint32_t i = 0; (name = material_name(i)); i++) {
        struct report report = {.host = NULL};
        struct check check = {&report, NULL, SONJECT_OK};
        const sonject_material_params material = take(name);
        expect_sound(name, &material_section, &material);
        relate_energy(&check, "", &material, NAN);
        if (check.status != SONJECT_OK)
            fail_msg("%s: %s", name, report.message);
        /* materials have a smooth and a rough part, and nothing that the tables do not give */
        assert_true(material.roughness_m > 0.0 && material.lambert > 0.0);
        assert_true(material.lambert_exponent == 1.0);
        assert_true(material.glossy_albedo == 0.0);
    }
}

/* Tests the values in which materials differ. */
TEST(test_order_of_values)
{
    const sonject_material_params steel = take("steel");
    sonject_object_params initial;
    object_init(&initial);
    expect_same(&steel, &initial.material);
    /* sediments: from gravel to clay density, speed, loss and roughness fall */
    static const char *const sediments[] = {"gravel",    "coarse sand", "medium sand",
                                            "fine sand", "silt",        "clay"};
    for (size_t i = 0; i < COUNT(sediments); i++) {
        const sonject_material_params sediment = take(sediments[i]);
        assert_int_equal(sediment.reflection_kind, SONJECT_REFLECTION_FLUID);
        /* Mackenzie's constant, -27 dB */
        assert_true(sediment.lambert > 1.9952e-3 && sediment.lambert < 1.9953e-3 * 1.0001);
        if (i == 0)
            continue;
        const sonject_material_params coarser = take(sediments[i - 1]);
        assert_true(sediment.density_ratio < coarser.density_ratio);
        assert_true(sediment.speed_ratio < coarser.speed_ratio);
        assert_true(sediment.loss < coarser.loss);
        assert_true(sediment.roughness_m < coarser.roughness_m);
    }
    /* silt and clay are slower than the water, all sands faster */
    assert_true(take("fine sand").speed_ratio > 1.0 && take("silt").speed_ratio < 1.0);
}

/* The sea surface's cone is what its lambert leaves, unless a number is given. */
TEST(test_the_sea_surfaces_rough_part)
{
    struct scene scene;
    scene_init(&scene);
    sonject_surface_params *surface = &scene.surface;
    sonject_material_params *material = &surface->material;
    assert_true(surface_material(surface).glossy_albedo == 1.0);
    material->reflection = -0.5;
    material->lambert = 0.05;
    const double left = 0.25 - 3.14159265358979 * 0.05;
    assert_true(fabs(surface_material(surface).glossy_albedo - left) < 1e-12); /* digits of pi */
    material->glossy_albedo = 0.0;
    assert_true(surface_material(surface).glossy_albedo == 0.0);
    material->glossy_albedo = NAN;
    material->reflection = material->lambert = 0.0;
    assert_true(surface_material(surface).glossy_albedo == 0.0);
    material->reflection_kind = SONJECT_REFLECTION_FLUID;
    assert_true(surface_material(surface).glossy_albedo == 1.0);
}

TEST_PROGRAM(NULL, NULL)
