/* Meshes and users' shapes that planes cut: how far they reach, how deep they lie, and when nothing
 * of them is left. Against the shapes that they are meshes of. */
#include "claims.h"
#include "first_key.h"
#include "kernel/mesh_samples.h"
#include "scene/placement.h"
#include "scene/shapes/shape.h"

static void make_mesh(struct mesh *mesh, struct mesh_sample *sample)
{
    struct report report = {{0}, NULL, NULL};
    struct mesh_options options;
    mesh_options_init(&options);
    EXPECT_OK(&report, mesh_from_arrays(&report, "sample", sample->positions, sample->vertices,
                                        sample->corners, sample->triangles, &options, mesh));
    sample_clear(sample);
}

static void draw_cuts(sonject_object_params *object, double farthest_m)
{
    object->cut_count = 1 + (sample_uniform(0.0, 1.0) < 0.5);
    for (uint32_t i = 0; i < object->cut_count; i++) {
        object->cuts[i].azimuth_rad = sample_uniform(-PI, PI);
        object->cuts[i].elevation_rad = asin(sample_uniform(-1.0, 1.0));
        object->cuts[i].distance_m = sample_uniform(-farthest_m, farthest_m);
    }
}

/* Whether the cuts leave something of some size: of slivers a small error moves the ends by much.
 */
static bool is_thick(const sonject_object_params *object)
{
    struct shape_size size;
    shape_size_init(&size, object);
    for (uint32_t i = 0; i < size.cut_count; i++)
        size.cuts[i].offset_m -= 0.2;
    return shape_is_left(&size, object->shape);
}

/* The shape itself, and a mesh of it. */
static void compare_extents(const struct mesh *mesh, sonject_object_params *object,
                            double tolerance_m)
{
    int left = 0;
    for (int i = 0; i < 300; i++) {
        struct shape_size size, of_mesh;
        double v[3];
        draw_cuts(object, 0.6);
        shape_size_init(&size, object);
        of_mesh = size;
        shape_size_of_mesh(&of_mesh, mesh);
        sample_direction(v);
        const bool is_left = shape_is_left(&size, object->shape);
        const double extent = shape_extent(&of_mesh, SONJECT_SHAPE_MESH, v);
        if (shape_is_left(&of_mesh, SONJECT_SHAPE_MESH) != isfinite(extent) ||
            (!is_left && isfinite(extent)))
            fail_msg("cuts %d: the shape is %sleft", i, is_left ? "" : "not ");
        if (!is_thick(object))
            continue;
        left++;
        const double expected = shape_extent(&size, object->shape, v);
        if (!(fabs(extent - expected) <= tolerance_m))
            fail_msg("cuts %d: reaches %.9g m, not %.9g m", i, extent, expected);
    }
    assert_true(left > 150 && left < 300);
}

static void test_extents(void **state)
{
    struct mesh mesh;
    struct mesh_sample sample;
    sonject_object_params object;
    sonject_object_params_init(&object);
    object.shape = SONJECT_SHAPE_BOX;
    object.length_m = 2.0;
    object.width_m = 1.2;
    object.height_m = 0.6;
    sample_box(&sample);
    make_mesh(&mesh, &sample);
    compare_extents(&mesh, &object, 2e-6); /* vertices to 6e-8, where planes meet at a slant */
    mesh_clear(&mesh);
    sonject_object_params_init(&object);
    object.diameter_m = 2.0;
    sample_sphere(&sample, 5);
    make_mesh(&mesh, &sample);
    /* facets lie up to 0.0008 under the sphere (sides of 90 deg/32 at the octahedron's corners, of
     * twice that at its middles); rims move by that over the cosine between plane and sphere */
    compare_extents(&mesh, &object, 0.004);
    mesh_clear(&mesh);
}

/* Of a user's shape the lesser of a box and a sphere is known. */
static void test_extents_of_user_shapes(void **state)
{
    static const double upward[3] = {0.0, 0.0, 1.0}, nose[3] = {1.0, 0.0, 0.0};
    const struct user_shape shape = {
        .bounding_radius_m = 1.0, .half_length_m = 1.0, .half_width_m = 1.0, .half_height_m = 0.8};
    struct shape_size size;
    sonject_object_params object;
    sonject_object_params_init(&object);
    object.shape = SONJECT_SHAPE_USER;
    object.cut_count = 1;
    object.cuts[0].elevation_rad = 0.5 * PI;
    object.cuts[0].distance_m = -0.6;
    shape_size_init(&size, &object);
    shape_size_of_user_shape(&size, &shape);
    assert_true(shape_is_left(&size, SONJECT_SHAPE_USER));
    assert_true(fabs(shape_extent(&size, SONJECT_SHAPE_USER, upward) + 0.6) < 1e-9);
    assert_true(fabs(shape_extent(&size, SONJECT_SHAPE_USER, nose) - 0.8) <
                1e-9);             /* of the sphere */
    size.cuts[0].offset_m = -0.85; /* of the sphere something would be left, of the box not */
    assert_false(shape_is_left(&size, SONJECT_SHAPE_USER));
}

/* Places the only object of a scene; its centre's height over the seabed. */
static double place(const struct patch_view *view, struct mesh *mesh,
                    const sonject_object_params *object)
{
    struct report report = {{0}, NULL, NULL};
    sonject_object_params copy = *object;
    struct placements placements;
    struct scene scene;
    memset(&scene, 0, sizeof scene);
    scene.objects = &copy;
    scene.object_count = 1;
    scene.meshes = mesh;
    scene.mesh_count = 1;
    EXPECT_OK(&report, placements_init(&placements, &report, &scene, view, 0.0, 0.0));
    const double height = placements.parts[0].centre[2];
    placements_clear(&placements);
    return height;
}

/* A cut mesh of a box lies as deep as the cut box. */
static void test_burial(void **state)
{
    static struct water_layer layer = {0.0, 1500.0, 1.0};
    static const struct water water = {&layer, 1, 1500.0};
    struct report report = {{0}, NULL, NULL};
    struct patch_view view;
    struct scene scene;
    struct mesh mesh;
    struct mesh_sample sample;
    scene_init(&scene);
    scene.geometry.first_slant_range_m = 40.0;
    assert_int_equal(patch_view_init(&view, &report, &scene, &water, 0.0, 0.0, 400, 400),
                     SONJECT_OK);
    int lower = 0;
    sample_box(&sample);
    make_mesh(&mesh, &sample);
    for (int i = 0; i < 200; i++) {
        sonject_object_params object;
        sonject_object_params_init(&object);
        object.shape = SONJECT_SHAPE_BOX;
        object.length_m = 2.0;
        object.width_m = 1.2;
        object.height_m = 0.6;
        object.pitch_rad = sample_uniform(-1.5, 1.5);
        object.roll_rad = sample_uniform(-3.0, 3.0);
        do
            draw_cuts(&object, 0.2);
        while (!is_thick(&object));
        object.burial_kind = i % 2 ? SONJECT_BURIAL_FRACTION : SONJECT_BURIAL_PROUD;
        object.burial_fraction = 0.3;
        object.proud_height_m = 0.05;
        const double expected = place(&view, &mesh, &object);
        object.shape = SONJECT_SHAPE_MESH;
        assert_true(fabs(place(&view, &mesh, &object) - expected) < 2e-6); /* as above */
        object.cut_count = 0;
        lower += fabs(place(&view, &mesh, &object) - expected) > 1e-3;
    }
    assert_true(lower > 100); /* the others lose a side only */
    mesh_clear(&mesh);
    scene_clear(&scene);
}

static void test_cuts_must_leave_something(void **state)
{
    struct report report = {{0}, NULL, NULL};
    struct first_key first = FIRST_KEY;
    struct scene scene;
    struct mesh mesh;
    struct mesh_sample sample;
    sonject_object_params object;
    sample_box(&sample);
    make_mesh(&mesh, &sample);
    scene_init(&scene);
    scene.meshes = &mesh;
    scene.mesh_count = 1;
    sonject_object_params_init(&object);
    object.shape = SONJECT_SHAPE_MESH;
    object.cut_count = 2;
    object.cuts[0].distance_m = -0.99;
    object.cuts[1].azimuth_rad = PI;
    object.cuts[1].distance_m = 1.0;
    assert_int_equal(check_object(&object, &report, &first.listener), SONJECT_OK);
    assert_int_equal(check_cuts_in_scene(&scene, &object, &report, &first.listener), SONJECT_OK);
    object.cuts[1].distance_m = 0.98;
    assert_int_equal(check_cuts_in_scene(&scene, &object, &report, &first.listener),
                     SONJECT_ERROR_INPUT);
    assert_string_equal(first.key, "cuts");
    assert_string_equal(report.message, "cuts leave nothing of the object; move one outwards");
    object.cut_count = 1;
    object.cuts[0].distance_m = -1.0; /* touches */
    assert_int_equal(check_cuts_in_scene(&scene, &object, &report, &first.listener),
                     SONJECT_ERROR_INPUT);
    mesh_clear(&mesh);
}

TEST_PROGRAM(NULL, NULL, TEST(test_extents), TEST(test_extents_of_user_shapes), TEST(test_burial),
             TEST(test_cuts_must_leave_something))
