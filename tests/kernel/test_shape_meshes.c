/* Every analytic shape against a fine mesh of itself, which is made here from its outline, both
 * whole and cut: where rays meet both, and how their surfaces face. */
#include "claims.h"
#include "physics/bench.h"
#include "random_rays.h"

#include "device/opencl.h"

#define SECTORS 360
#define POINTS  400 /* of an outline, at the most */
#define RAYS    20000
/* Corners lie on the surface: between them a facet lies under it by 1 - cos(half a step) of the
 * radius of curvature. */
#define HALF_STEP (PI / SECTORS)
#define SAGITTA   (0.5 * HALF_STEP * HALF_STEP)

/* A surface of revolution: (axial, radial), from one end of the axis to the other, or round. */
struct outline {
    double points[POINTS][2];
    size_t count;
};

static void add_point(struct outline *outline, double axial, double radial)
{
    assert_true(outline->count < POINTS);
    outline->points[outline->count][0] = axial;
    outline->points[outline->count++][1] = radial;
}

/* From `start` to `end`, angles about a centre on the axis or off it, from the axis's direction. */
static void add_arc(struct outline *outline, double axial, double radial, double radius,
                    double start, double end)
{
    const int steps = (int)ceil(fabs(end - start) / (2.0 * HALF_STEP));
    for (int i = 0; i <= steps; i++) {
        const double angle = start + (end - start) * i / steps;
        add_point(outline, axial + radius * cos(angle), radial + radius * sin(angle));
    }
}

/* A spherical end of some depth whose pole lies at `pole`, outwards +1 or -1. */
static void add_end(struct outline *outline, double pole, double outwards, double radius,
                    double depth, bool from_pole)
{
    const double curved = (radius * radius + depth * depth) / (2.0 * depth);
    const double opening = atan2(radius, curved - depth);
    const double axis = outwards > 0.0 ? 0.0 : PI;
    const double rim = outwards > 0.0 ? opening : PI - opening;
    add_arc(outline, pole - outwards * curved, 0.0, curved, from_pole ? axis : rim,
            from_pole ? rim : axis);
}

struct soup {
    double *positions;
    uint32_t *corners;
    size_t vertices, triangles;
};

static void add_triangle(struct soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t corners[3] = {a, b, c};
    memcpy(&soup->corners[3 * soup->triangles++], corners, sizeof corners);
}

/* Turns an outline about z (or about x): rings of SECTORS vertices. is_round: the outline's last
 * point is joined to its first. Points on the axis make degenerate triangles, which a mesh drops.
 */
static struct soup revolve(const struct outline *outline, bool about_x, bool is_round)
{
    struct soup soup = {calloc(3 * outline->count * SECTORS, sizeof(double)),
                        calloc(6 * outline->count * SECTORS, sizeof(uint32_t)), 0, 0};
    assert_true(soup.positions && soup.corners);
    for (size_t i = 0; i < outline->count; i++)
        for (int k = 0; k < SECTORS; k++) {
            const double axial = outline->points[i][0];
            const double radial = fabs(outline->points[i][1]) < 1e-12 ? 0 : outline->points[i][1];
            const double a = radial * cos(2.0 * PI * k / SECTORS);
            const double b = radial * sin(2.0 * PI * k / SECTORS);
            const double about_z[3] = {a, b, axial}, along_x[3] = {axial, a, b};
            memcpy(&soup.positions[3 * soup.vertices++], about_x ? along_x : about_z,
                   sizeof about_z);
        }
    for (size_t i = 0; i + (is_round ? 0 : 1) < outline->count; i++)
        for (uint32_t k = 0; k < SECTORS; k++) {
            const uint32_t here = (uint32_t)i * SECTORS;
            const uint32_t next = (uint32_t)((i + 1) % outline->count) * SECTORS;
            const uint32_t j = (k + 1) % SECTORS;
            add_triangle(&soup, here + k, here + j, next + j);
            add_triangle(&soup, here + k, next + j, next + k);
        }
    return soup;
}

/* A prism along y over a quadrangle of (x, z). */
static struct soup prism(const double corners[4][2], double width)
{
    static const uint32_t triangles[12][3] = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6},
                                              {0, 4, 5}, {0, 5, 1}, {1, 5, 6}, {1, 6, 2},
                                              {2, 6, 7}, {2, 7, 3}, {3, 7, 4}, {3, 4, 0}};
    struct soup soup = {calloc(24, sizeof(double)), calloc(36, sizeof(uint32_t)), 8, 12};
    assert_true(soup.positions && soup.corners);
    for (int i = 0; i < 8; i++) {
        soup.positions[3 * i] = corners[i % 4][0];
        soup.positions[3 * i + 1] = i < 4 ? -0.5 * width : 0.5 * width;
        soup.positions[3 * i + 2] = corners[i % 4][1];
    }
    memcpy(soup.corners, triangles, sizeof triangles);
    return soup;
}

static struct soup mesh_of_cylinder(const sonject_object_params *shape)
{
    struct outline outline = {.count = 0};
    const double half = 0.5 * shape->length_m, radius = 0.5 * shape->diameter_m;
    if (shape->tail_end == SONJECT_END_SPHERICAL) {
        add_end(&outline, -half, -1.0, radius, shape->tail_end_depth_m, true);
    } else {
        add_point(&outline, -half, 0.0);
        add_point(&outline, -half, radius);
    }
    if (shape->nose_end == SONJECT_END_SPHERICAL) {
        add_end(&outline, half, 1.0, radius, shape->nose_end_depth_m, false);
    } else {
        add_point(&outline, half, radius);
        add_point(&outline, half, 0.0);
    }
    return revolve(&outline, true, false);
}

static struct soup mesh_of_cone(const sonject_object_params *shape)
{
    struct outline outline = {.count = 0};
    const double half = 0.5 * shape->height_m;
    add_point(&outline, -half, 0.0);
    add_point(&outline, -half, 0.5 * shape->diameter_m);
    add_point(&outline, half, 0.5 * shape->top_diameter_m);
    add_point(&outline, half, 0.0);
    return revolve(&outline, false, false);
}

static struct soup mesh_of_ellipsoid(double length, double width, double height)
{
    struct outline outline = {.count = 0};
    add_arc(&outline, 0.0, 0.0, 1.0, PI, 0.0);
    struct soup soup = revolve(&outline, false, false);
    for (size_t i = 0; i < soup.vertices; i++) {
        soup.positions[3 * i] *= 0.5 * length;
        soup.positions[3 * i + 1] *= 0.5 * width;
        soup.positions[3 * i + 2] *= 0.5 * height;
    }
    return soup;
}

static struct soup mesh_of_torus(const sonject_object_params *shape)
{
    struct outline outline = {.count = 0};
    const double tube = 0.5 * shape->height_m, ring = 0.5 * shape->diameter_m - tube;
    add_arc(&outline, 0.0, ring, tube, 0.0, 2.0 * PI);
    outline.count--; /* the first again */
    return revolve(&outline, false, true);
}

static struct soup mesh_of_prism(const sonject_object_params *shape)
{
    const double half = 0.5 * shape->length_m, low = -0.5 * shape->height_m;
    const double front =
        shape->shape == SONJECT_SHAPE_WEDGE ? shape->front_height_m : shape->height_m;
    const double corners[4][2] = {
        {-half, low}, {half, low}, {half, low + front}, {-half, low + shape->height_m}};
    return prism(corners, shape->width_m);
}

static struct soup mesh_of(const sonject_object_params *shape)
{
    sonject_object_params round = *shape;
    switch (shape->shape) {
    case SONJECT_SHAPE_SPHERE:
        return mesh_of_ellipsoid(shape->diameter_m, shape->diameter_m, shape->diameter_m);
    case SONJECT_SHAPE_ELLIPSOID:
        return mesh_of_ellipsoid(shape->length_m, shape->width_m, shape->height_m);
    case SONJECT_SHAPE_CAPSULE:
        round.nose_end = round.tail_end = SONJECT_END_SPHERICAL;
        round.nose_end_depth_m = round.tail_end_depth_m = 0.5 * shape->diameter_m;
        return mesh_of_cylinder(&round);
    case SONJECT_SHAPE_CYLINDER:
        return mesh_of_cylinder(shape);
    case SONJECT_SHAPE_BOX:
    case SONJECT_SHAPE_WEDGE:
        return mesh_of_prism(shape);
    case SONJECT_SHAPE_TORUS:
        return mesh_of_torus(shape);
    default:
        return mesh_of_cone(shape);
    }
}

static sonject_object_params object_of(sonject_shape shape)
{
    sonject_object_params object;
    sonject_object_params_init(&object);
    object.shape = shape;
    object.burial_m = -1.0;
    object.heading_rad = 0.6;
    object.pitch_rad = 0.3;
    object.roll_rad = -0.4;
    return object;
}

static void add_mesh_of(struct bench *bench, const sonject_object_params *shape)
{
    struct mesh_options options;
    struct soup soup = mesh_of(shape);
    bench->scene.meshes = calloc(1, sizeof *bench->scene.meshes);
    assert_non_null(bench->scene.meshes);
    bench->scene.mesh_count = 1;
    mesh_options_init(&options);
    EXPECT_OK(&bench->report,
              mesh_from_arrays(&bench->report, "shape", soup.positions, soup.vertices, soup.corners,
                               soup.triangles, &options, &bench->scene.meshes[0]));
    EXPECT_OK(&bench->report,
              mesh_require_closed(&bench->report, "shape", &bench->scene.meshes[0]));
    free(soup.positions);
    free(soup.corners);
}

/* Both in one scene, as kernels are given them; for free(). */
static struct object_record *records_of(struct bench *bench, const sonject_object_params *shape)
{
    struct rough_trace trace;
    size_t bytes;
    sonject_object_params mesh = *shape;
    mesh.shape = SONJECT_SHAPE_MESH;
    bench_open(bench, 128, 128, 50.0);
    add_mesh_of(bench, shape);
    EXPECT_OK(&bench->report, scene_append_object(&bench->scene, &bench->report, shape));
    EXPECT_OK(&bench->report, scene_append_object(&bench->scene, &bench->report, &mesh));
    bench_ready(bench);
    /* their lowest points, on which they rest, differ by the facets' sagitta */
    bench->placements[1].centre[2] = bench->placements[0].centre[2];
    EXPECT_OK(&bench->report, rough_trace_begin(&trace, &bench->tracer, NULL));
    assert_int_equal(clGetMemObjectInfo(trace.launch.buffers[ROUGH_OBJECTS], CL_MEM_SIZE,
                                        sizeof bytes, &bytes, NULL),
                     CL_SUCCESS);
    struct object_record *records = malloc(bytes);
    assert_non_null(records);
    EXPECT_OK(&bench->report, buffer_read(&bench->report, bench->tracer.device,
                                          trace.launch.buffers[ROUGH_OBJECTS], 0, bytes, records));
    rough_trace_end(&trace);
    return records;
}

/* Rays from 50 m and 500 m, many of them grazing. What a facet's depth under the surface can
 * explain is a distance of twice that over the cosine. Apart from edges and outlines, which a
 * facet's depth shifts, everything must agree: those take less than 1/1000 of the rays. */
static void expect_same_shape(const char *name, const sonject_object_params *shape)
{
    struct bench bench;
    struct object_record *records = records_of(&bench, shape);
    const double radius = records[1].bounding_radius;
    const double depth = 2.0 * SAGITTA * radius + 3e-6;
    const struct point centre = {records[0].centre_x, records[0].centre_y, records[0].centre_z};
    int hits = 0, strays = 0;
    double steepest = 0.0;
    for (int i = 0; i < RAYS; i++) {
        const struct point aim = add(centre, random_direction(), uniform(0.0, 1.05 * radius));
        const float range = i % 2 ? 50.0f : 500.0f;
        const struct ray ray = ray_towards(aim, range);
        const float analytic = object_distance(&records[0], ray.p, ray.d, -range);
        const float facets = object_distance(&records[1], ray.p, ray.d, -range);
        if (analytic > 0.5f * FAR_AWAY && facets > 0.5f * FAR_AWAY)
            continue;
        hits++;
        const struct vector3 normal = object_normal(&records[0], ray.p, ray.d, analytic);
        const struct vector3 facing = object_normal(&records[1], ray.p, ray.d, facets);
        const double cosine = fabs((double)dot3(normal, ray.d));
        const double turn = acos(fmin(1.0, (double)dot3(normal, facing)));
        if (analytic > 0.5f * FAR_AWAY || facets > 0.5f * FAR_AWAY ||
            fabs((double)analytic - facets) > depth / cosine || turn > 3.0 * HALF_STEP)
            strays++;
        else
            steepest = fmax(steepest, fabs((double)analytic - facets) * cosine);
    }
    print_message("%s: %d hits, %d beside edges, depth under the surface at most %.2g m\n", name,
                  hits, strays, steepest);
    assert_true(hits > RAYS / 10);
    assert_true(strays * 1000 < hits);
    free(records);
    bench_close(&bench);
}

static void test_round_shapes(void **state)
{
    sonject_object_params shape = object_of(SONJECT_SHAPE_SPHERE);
    shape.diameter_m = 0.6;
    expect_same_shape("sphere", &shape);
    shape = object_of(SONJECT_SHAPE_ELLIPSOID);
    shape.length_m = 1.4;
    shape.width_m = 0.8;
    shape.height_m = 0.5;
    expect_same_shape("ellipsoid", &shape);
    shape = object_of(SONJECT_SHAPE_TORUS);
    shape.diameter_m = 0.9;
    shape.height_m = 0.25;
    expect_same_shape("torus", &shape);
}

static void test_cylinders(void **state)
{
    sonject_object_params shape = object_of(SONJECT_SHAPE_CAPSULE);
    shape.length_m = 2.3;
    shape.diameter_m = 0.3;
    expect_same_shape("capsule", &shape);
    shape.shape = SONJECT_SHAPE_CYLINDER;
    expect_same_shape("cylinder", &shape);
    shape.nose_end = SONJECT_END_SPHERICAL;
    shape.nose_end_depth_m = 0.05;
    expect_same_shape("cylinder, one end dished", &shape);
    shape.tail_end = SONJECT_END_SPHERICAL;
    shape.tail_end_depth_m = 0.12;
    expect_same_shape("cylinder, two different ends", &shape);
}

static void test_cones(void **state)
{
    sonject_object_params shape = object_of(SONJECT_SHAPE_CONE);
    shape.diameter_m = 0.8;
    shape.height_m = 0.5;
    expect_same_shape("cone", &shape);
    shape.shape = SONJECT_SHAPE_TRUNCATED_CONE;
    shape.top_diameter_m = 0.3;
    expect_same_shape("truncated cone", &shape);
    shape.top_diameter_m = 1.1;
    expect_same_shape("truncated cone upside down", &shape);
}

static void test_prisms(void **state)
{
    sonject_object_params shape = object_of(SONJECT_SHAPE_BOX);
    shape.length_m = 1.2;
    shape.width_m = 0.7;
    shape.height_m = 0.4;
    expect_same_shape("box", &shape);
    shape.shape = SONJECT_SHAPE_WEDGE;
    shape.front_height_m = 0.1;
    expect_same_shape("wedge", &shape);
}

/* One or two planes, through the middle and off it. */
static void expect_same_cut_shape(const char *name, sonject_object_params shape)
{
    shape.cut_count = 1;
    shape.cuts[0] = (sonject_cut){0.7, 0.4, 0.03};
    expect_same_shape(name, &shape);
    shape.cut_count = 2;
    shape.cuts[1] = (sonject_cut){-2.0, 1.1, 0.06};
    expect_same_shape(name, &shape);
}

static void test_cut_shapes(void **state)
{
    sonject_object_params shape = object_of(SONJECT_SHAPE_SPHERE);
    shape.diameter_m = 0.6;
    expect_same_cut_shape("cut sphere", shape);
    shape = object_of(SONJECT_SHAPE_TORUS);
    shape.diameter_m = 0.9;
    shape.height_m = 0.25;
    expect_same_cut_shape("cut torus", shape);
    shape = object_of(SONJECT_SHAPE_BOX);
    shape.length_m = 1.2;
    shape.width_m = 0.7;
    shape.height_m = 0.4;
    expect_same_cut_shape("cut box", shape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_shapes), cmocka_unit_test(test_cylinders),
        cmocka_unit_test(test_cones),        cmocka_unit_test(test_prisms),
        cmocka_unit_test(test_cut_shapes),
    };
    return bench_run_on_devices(tests, COUNT(tests));
}
