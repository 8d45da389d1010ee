/* Tests how far shapes reach, against clouds of points in them, and meshes, against the shapes that
 * they stand for. Tests how objects rest on the seabed. */
#include "claims.h"
#include "kernel/mesh_samples.h"
#include "kernel/reference_solids.h"
#include "mesh_arrays.h"
#include "scene/placement.h"
#include "schema/keys.h"

#define POINTS 150000

static double product(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static sonject_object_params random_object(const struct solid_row *row)
{
    sonject_object_params object;
    object_init(&object);
    object.shape = row->shape;
    object.diameter_m = sample_uniform(0.5, 1.0);
    object.length_m = sample_uniform(0.4, 1.0);
    object.width_m = sample_uniform(0.4, 1.0);
    object.height_m = sample_uniform(0.4, 1.0);
    object.top_diameter_m = sample_uniform(0.0, 1.0);
    if (row->fit)
        row->fit(&object, 0.1);
    object.heading_rad = sample_uniform(-PI, PI);
    object.pitch_rad = sample_uniform(-PI, PI);
    object.roll_rad = sample_uniform(-PI, PI);
    return object;
}

/* Draws a point of a box a little larger than the shape, or of a sheet's plane. Returns whether the
 * shape holds the point. */
static bool random_point(const struct shape_size *size, const struct body *body, double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = sample_uniform(-1.05, 1.05) * size->bounding_radius_m;
    if (body->is_thin && !body->is_round)
        p[2] = 0.0;
    return body_holds(body, (struct point){p[0], p[1], p[2]});
}

/* No point exceeds the extent, and some nearly reach it, as corners are rarely drawn. */
TEST(test_clouds_of_points)
{
    for (int i = 0; i < 3 * solid_row_count; i++) {
        const struct solid_row *row = &solid_rows[i / 3];
        const sonject_object_params object = random_object(row);
        struct shape_size size;
        struct body body;
        double directions[12][3], farthest[12], extents[12];
        shape_size_init(&size, &object);
        body_init(&body, &object, 0.0);
        for (int k = 0; k < 12; k++) {
            sample_direction(directions[k]);
            farthest[k] = -INFINITY;
            extents[k] = shape_extent(&size, row->shape, directions[k]);
        }
        for (int n = 0; n < POINTS; n++) {
            double p[3];
            if (!random_point(&size, &body, p))
                continue;
            assert_true(product(p, p) <= size.bounding_radius_m * size.bounding_radius_m);
            assert_true(hypot(p[1], p[2]) <= size.radius_about_nose_m + 1e-9);
            for (int k = 0; k < 12; k++)
                farthest[k] = fmax(farthest[k], product(directions[k], p));
        }
        double gap = 0.0;
        for (int k = 0; k < 12; k++) {
            if (farthest[k] > extents[k] + 1e-9)
                fail_msg("%s: reaches %.9g m, not %.9g m", row->name, farthest[k], extents[k]);
            gap = fmax(gap, (extents[k] - farthest[k]) / size.bounding_radius_m);
        }
        print_message("%s: points come within %.3f of its size\n", row->name, gap);
        assert_true(gap < 0.15);
    }
}

static double extent_along(const sonject_object_params *object, double x, double y, double z)
{
    const double v[3] = {x, y, z};
    struct shape_size size;
    shape_size_init(&size, object);
    return shape_extent(&size, object->shape, v);
}

static void expect_extent(const sonject_object_params *object, double x, double y, double z,
                          double expected)
{
    const double extent = extent_along(object, x, y, z);
    if (!(fabs(extent - expected) < 1e-9))
        fail_msg("%s reaches %.12g m, not %.12g m", shape_name(object->shape), extent, expected);
}

/* The closed forms are those of a sphere, a box's corner, and a ring. */
TEST(test_closed_forms)
{
    const double s = sqrt(0.5);
    sonject_object_params object;
    object_init(&object);
    object.diameter_m = 2.0;
    expect_extent(&object, s, 0.0, s, 1.0);
    object.shape = SHAPE_BOX;
    object.length_m = object.width_m = object.height_m = 2.0;
    expect_extent(&object, 0.8, 0.0, 0.6, 1.4);
    object.shape = SHAPE_TORUS;
    object.height_m = 0.5;
    expect_extent(&object, 0.0, 0.0, 1.0, 0.25);
    expect_extent(&object, 1.0, 0.0, 0.0, 1.0);
    expect_extent(&object, s, 0.0, s, s * 0.75 + 0.25);
}

/* A cylinder with round ends lies within the sphere through its tips. */
TEST(test_bounding_radius)
{
    struct shape_size size;
    sonject_object_params object;
    object_init(&object);
    object.shape = SHAPE_CYLINDER;
    object.length_m = 2.0;
    object.diameter_m = 0.5;
    object.nose_end = object.tail_end = SONJECT_END_SPHERICAL;
    shape_size_init(&size, &object);
    assert_true(fabs(size.bounding_radius_m - 1.0) < 2e-6);
    object.tail_end = SONJECT_END_OPEN;
    shape_size_init(&size, &object);
    assert_true(fabs(size.bounding_radius_m - hypot(1.0, 0.25)) < 2e-6);
}

static void make_view(struct patch_view *view, struct scene *scene, sonject_side side)
{
    struct report report = {.host = NULL};
    static struct water_layer layer = {0.0, 1500.0, 1.0};
    static const struct water water = {&layer, 1, 1, 1500.0};
    scene_init(scene);
    scene->geometry.first_slant_range_m = 40.0;
    scene->geometry.side = side;
    assert_int_equal(patch_view_init(view, &report, scene, &water, 0.0, 0.0, 400, 400), SONJECT_OK);
}

static double lowest_point(const struct placement *placement, const sonject_object_params *object,
                           double *highest)
{
    double lowest = INFINITY;
    struct body body;
    body_init(&body, object, 0.0);
    *highest = -INFINITY;
    for (int n = 0; n < POINTS; n++) {
        double p[3];
        if (!random_point(&placement->size, &body, p))
            continue;
        const double *own = p;
        double height = placement->centre[2];
        for (int axis = 0; axis < 3; axis++)
            height += own[axis] * placement->axes[axis][2];
        lowest = fmin(lowest, height);
        *highest = fmax(*highest, height);
    }
    return lowest;
}

/* Places the only object of a scene. */
static sonject_status place(struct placement *placement, double *burial_m, struct report *report,
                            const struct patch_view *view, sonject_object_params *object)
{
    struct placements placements;
    struct scene scene = {.objects = object, .object_count = 1};
    const sonject_status status = placements_init(&placements, report, &scene, view, 0.0, 0.0);
    memset(placement, 0, sizeof *placement);
    *burial_m = NAN;
    if (status == SONJECT_OK) {
        *placement = placements.parts[0];
        *burial_m = -placements.objects[0].bottom_m;
    }
    placements_clear(&placements);
    return status;
}

/* Whatever the shape, pose and side of the sonar, the lowest point is as deep as asked for. */
TEST(test_objects_rest_on_the_seabed)
{
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 3 * solid_row_count; i++) {
            struct report report = {.host = NULL};
            struct patch_view view;
            struct scene scene;
            struct placement placement;
            double highest, burial;
            sonject_object_params object = random_object(&solid_rows[i / 3]);
            make_view(&view, &scene, side ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT);
            EXPECT_OK(&report, place(&placement, &burial, &report, &view, &object));
            const double slack = 0.15 * placement.bounding_radius_m;
            const double lowest = lowest_point(&placement, &object, &highest);
            assert_true(lowest > -1e-9 && lowest < slack);
            const double height = highest - lowest;
            object.burial_kind = SONJECT_BURIAL_FRACTION;
            object.burial_fraction = 0.5;
            assert_int_equal(place(&placement, &burial, &report, &view, &object), SONJECT_OK);
            lowest_point(&placement, &object, &highest);
            assert_true(fabs(highest - 0.5 * height) < slack);
            assert_true(fabs(burial - 0.5 * height) < slack);
            object.burial_kind = SONJECT_BURIAL_PROUD;
            object.proud_height_m = 0.05;
            assert_int_equal(place(&placement, &burial, &report, &view, &object), SONJECT_OK);
            lowest_point(&placement, &object, &highest);
            assert_true(highest < 0.05 + 1e-9 && highest > 0.05 - slack);
            scene_clear(&scene);
        }
}

TEST(test_nothing_stands_prouder_than_it_is_high)
{
    struct report report = {.host = NULL};
    struct patch_view view;
    struct scene scene;
    struct placement placement;
    double burial;
    sonject_object_params object;
    object_init(&object);
    object.diameter_m = 0.5;
    object.burial_kind = SONJECT_BURIAL_PROUD;
    object.proud_height_m = 0.5;
    make_view(&view, &scene, SONJECT_SIDE_PORT);
    assert_int_equal(place(&placement, &burial, &report, &view, &object), SONJECT_OK);
    assert_true(fabs(placement.centre[2] - 0.25) < 1e-12);
    object.proud_height_m = 0.501;
    assert_int_equal(place(&placement, &burial, &report, &view, &object), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "burial.proud"));
    scene_clear(&scene);
}

static void make_mesh(struct mesh *mesh, struct mesh_sample *sample)
{
    mesh_of_sample(sample, 1.0, 0.0, mesh);
    sample_clear(sample);
}

/* Compares the extents of a shape and of its mesh. */
static void compare_extents(const struct mesh *mesh, const sonject_object_params *object,
                            double tolerance_m)
{
    struct shape_size size, of_mesh;
    shape_size_init(&size, object);
    of_mesh = size;
    shape_size_of_mesh(&of_mesh, mesh);
    for (int i = 0; i < 300; i++) {
        double v[3];
        sample_direction(v);
        const double extent = shape_extent(&of_mesh, SHAPE_MESH, v);
        const double expected = shape_extent(&size, object->shape, v);
        if (!(fabs(extent - expected) <= tolerance_m))
            fail_msg("reaches %.9g m, not %.9g m", extent, expected);
    }
}

TEST(test_extents_of_meshes)
{
    struct mesh mesh;
    struct mesh_sample sample;
    sonject_object_params object;
    object_init(&object);
    object.shape = SHAPE_BOX;
    object.length_m = 2.0;
    object.width_m = 1.2;
    object.height_m = 0.6;
    sample_box(&sample);
    make_mesh(&mesh, &sample);
    compare_extents(&mesh, &object, 2e-7); /* vertices are rounded by 6e-8 along each axis */
    mesh_clear(&mesh);
    object_init(&object);
    object.diameter_m = 2.0;
    sample_sphere(&sample, 5);
    make_mesh(&mesh, &sample);
    /* between vertices extents are short by the depth of facets under the sphere, up to 0.0008
     * (sides of 90 deg/32 at the octahedron's corners, up to twice as long at its middles) */
    compare_extents(&mesh, &object, 8e-4);
    mesh_clear(&mesh);
}

TEST_PROGRAM(NULL, NULL)
