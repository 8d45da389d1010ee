/* Tests whether meshes close, which side is outside, and smooth normals. */
#include "claims.h"
#include "kernel/mesh_samples.h"
#include "mesh_arrays.h"

static struct report report;

static struct mesh prepare(const struct mesh_sample *sample)
{
    struct mesh mesh;
    mesh_of_sample(sample, 1.0, 0.0, &mesh);
    return mesh;
}

static void reverse(struct mesh_sample *sample, size_t triangle)
{
    const uint32_t second = sample->corners[3 * triangle + 1];
    sample->corners[3 * triangle + 1] = sample->corners[3 * triangle + 2];
    sample->corners[3 * triangle + 2] = second;
}

struct expected {
    size_t open, crowded, twisted, turned, pieces, vertices, degenerate;
    double volume; /* 0: the mesh is open */
};

/* Tolerance of the volume: coordinates are rounded to 6e-8 of themselves. */
static void expect_topology(const struct mesh_sample *sample, struct expected expected)
{
    struct mesh mesh = prepare(sample);
    const struct mesh_topology *topology = &mesh.topology;
    assert_int_equal(topology->open_edges, expected.open);
    assert_int_equal(topology->crowded_edges, expected.crowded);
    assert_int_equal(topology->twisted_edges, expected.twisted);
    assert_int_equal(topology->turned, expected.turned);
    assert_int_equal(topology->pieces, expected.pieces);
    assert_int_equal(mesh.vertex_count, expected.vertices);
    assert_int_equal(mesh.degenerate, expected.degenerate);
    assert_int_equal(topology->is_closed, expected.volume > 0.0);
    assert_true(fabs(topology->volume - expected.volume) < 1e-6);
    const sonject_status status = mesh_require_closed(&report, "box.stl", &mesh);
    assert_int_equal(status, expected.volume > 0.0 ? SONJECT_OK : SONJECT_ERROR_INPUT);
    mesh_clear(&mesh);
}

TEST(test_orientation)
{
    struct mesh_sample sample;
    sample_box(&sample);
    expect_topology(&sample, (struct expected){.pieces = 1, .vertices = 8, .volume = 1.44});
    for (size_t i = 0; i < 12; i++)
        reverse(&sample, i); /* inside out */
    expect_topology(&sample,
                    (struct expected){.turned = 12, .pieces = 1, .vertices = 8, .volume = 1.44});
    for (size_t i = 0; i < 12; i += 5)
        reverse(&sample, i); /* three of them outwards again */
    expect_topology(&sample,
                    (struct expected){.turned = 9, .pieces = 1, .vertices = 8, .volume = 1.44});
    sample_clear(&sample);
}

/* Makes the box with separate corners for each triangle, moved by up to off_m/2 along each axis. */
static struct mesh prepare_loose_box(double off_m, bool is_reversed)
{
    struct mesh_sample box;
    double positions[3 * 36];
    uint32_t corners[36];
    sample_box(&box);
    for (size_t i = 0; i < 36; i++) {
        corners[is_reversed ? 35 - i : i] = (uint32_t)i;
        for (size_t axis = 0; axis < 3; axis++)
            positions[3 * i + axis] = box.positions[3 * (size_t)box.corners[i] + axis] +
                                      (i % 7 ? off_m * (double)((i + axis) % 5) / 8.0 : 0.0);
    }
    sample_clear(&box);
    const struct mesh_sample loose = {
        .positions = positions, .corners = corners, .vertices = 36, .triangles = 12};
    return prepare(&loose);
}

/* Seams may be 2.4 um, a millionth of the box's diagonal. A seam's farthest corners are sqrt(3)/2
 * of off_m apart. */
TEST(narrow_seams_close_in_any_order_and_thin_walls_stay)
{
    for (int is_reversed = 0; is_reversed < 2; is_reversed++) {
        struct mesh mesh = prepare_loose_box(1e-6, is_reversed);
        assert_true(mesh.topology.is_closed);
        assert_int_equal(mesh.vertex_count, 8);
        assert_true(mesh.welded > 0);
        mesh_clear(&mesh);
        mesh = prepare_loose_box(1e-4, is_reversed);
        assert_false(mesh.topology.is_closed);
        mesh_clear(&mesh);
    }
    /* two sides of a closed mesh that are closer than the sides of a seam may be */
    struct mesh_sample sample;
    sample_box(&sample);
    for (size_t i = 0; i < 8; i++)
        sample.positions[3 * i + 2] *= 1e-6;
    struct mesh mesh = prepare(&sample);
    assert_true(mesh.topology.is_closed);
    assert_int_equal(mesh.vertex_count, 8);
    assert_int_equal(mesh.welded, 0);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* Two boxes face outward, however the file has them. A small box inside a large one that is
 * oriented against it is a cavity, also in a file that is inside out. */
static void expect_two_boxes(double aside, bool first_is_inward, bool second_is_inward,
                             struct expected expected)
{
    struct mesh_sample outer, inner;
    double positions[48];
    uint32_t corners[72];
    sample_box(&outer);
    sample_box(&inner);
    for (size_t i = 0; i < 12; i++) {
        if (first_is_inward)
            reverse(&outer, i);
        if (second_is_inward)
            reverse(&inner, i);
    }
    for (size_t i = 0; i < 24; i++) {
        positions[i] = outer.positions[i];
        positions[24 + i] = 0.5 * inner.positions[i] + aside;
    }
    for (size_t i = 0; i < 36; i++) {
        corners[i] = outer.corners[i];
        corners[36 + i] = 8 + inner.corners[i];
    }
    const struct mesh_sample both = {positions, corners, 16, 24};
    expected.pieces = 2;
    expected.vertices = 16;
    expect_topology(&both, expected);
    sample_clear(&outer);
    sample_clear(&inner);
}

TEST(pieces_face_outward_unless_another_holds_them)
{
    const double cavity = 1.44 * 0.875, two = 1.44 * 1.125;
    expect_two_boxes(0.0, false, true, (struct expected){.volume = cavity});
    expect_two_boxes(0.0, true, false, (struct expected){.turned = 24, .volume = cavity});
    expect_two_boxes(5.0, false, false, (struct expected){.volume = two});
    expect_two_boxes(5.0, false, true, (struct expected){.turned = 12, .volume = two});
    expect_two_boxes(5.0, true, false, (struct expected){.turned = 12, .volume = two});
    expect_two_boxes(5.0, true, true, (struct expected){.turned = 24, .volume = two});
}

TEST(test_open)
{
    struct mesh_sample sample;
    sample_box(&sample);
    sample.triangles = 11;
    expect_topology(&sample, (struct expected){.open = 3, .pieces = 1, .vertices = 8});
    assert_non_null(strstr(report.message, "box.stl: the mesh does not enclose a volume: 3 edges"));
    for (size_t i = 0; i < 11; i += 5)
        reverse(&sample, i); /* the smaller part */
    expect_topology(&sample, (struct expected){.open = 3, .turned = 3, .pieces = 1, .vertices = 8});
    sample_clear(&sample);
}

/* A fin on an edge of the box, which then has three triangles. */
TEST(test_crowded)
{
    struct mesh_sample sample;
    double positions[27] = {0.0};
    uint32_t corners[39];
    sample_box(&sample);
    memcpy(positions, sample.positions, 24 * sizeof *positions);
    positions[24] = 5.0;
    memcpy(corners, sample.corners, 36 * sizeof *corners);
    corners[36] = 0;
    corners[37] = 1;
    corners[38] = 8;
    const struct mesh_sample finned = {positions, corners, 9, 13};
    expect_topology(&finned, (struct expected){
                                 .open = 2, .crowded = 1, .turned = 0, .pieces = 2, .vertices = 9});
    sample_clear(&sample);
}

/* A band with half a turn cannot be oriented. */
TEST(test_twisted)
{
    enum {
        STEPS = 12
    };
    double positions[6 * STEPS];
    uint32_t corners[6 * STEPS];
    for (uint32_t i = 0; i < STEPS; i++) {
        const double u = 2.0 * 3.14159265358979 * i / STEPS;
        for (uint32_t side = 0; side < 2; side++) {
            const double across = side ? 0.3 : -0.3;
            double *at = &positions[6 * i + 3 * side];
            at[0] = (1.0 + across * cos(0.5 * u)) * cos(u);
            at[1] = (1.0 + across * cos(0.5 * u)) * sin(u);
            at[2] = across * sin(0.5 * u);
        }
        const uint32_t swap = i == STEPS - 1;
        const uint32_t next = (i + 1) % STEPS;
        const uint32_t both[6] = {
            2 * i, 2 * i + 1, 2 * next + (1 ^ swap), 2 * i, 2 * next + (1 ^ swap), 2 * next + swap};
        memcpy(&corners[6 * i], both, sizeof both);
    }
    const struct mesh_sample band = {positions, corners, 2 * STEPS, 2 * STEPS};
    expect_topology(
        &band,
        (struct expected){
            .open = 2 * STEPS, .twisted = 1, .turned = STEPS, .pieces = 1, .vertices = 2 * STEPS});
}

/* Triangles with two equal corners are removed, and the mesh stays closed. A triangle whose corners
 * lie on a line stays, for its neighbours' sake. */
TEST(test_degenerate)
{
    struct mesh_sample sample;
    double positions[33];
    uint32_t corners[48];
    sample_box(&sample);
    memcpy(positions, sample.positions, 24 * sizeof *positions);
    memcpy(&positions[24], sample.positions, 3 * sizeof *positions); /* vertex 8 equals vertex 0 */
    for (size_t axis = 0; axis < 3; axis++) /* vertex 9: on the edge of 0 and 3 */
        positions[27 + axis] = 0.5 * (sample.positions[axis] + sample.positions[9 + axis]);
    positions[30] = positions[31] = positions[32] = 1e5; /* vertex 10: unused */
    memcpy(corners, sample.corners, 36 * sizeof *corners);
    /* the diagonal 0-3 of face 0 2 3 1 is cut at 9 on one side only, with a sliver to fill */
    const uint32_t more[12] = {0, 2, 9, 9, 2, 3, 0, 9, 3, 0, 8, 5};
    memcpy(corners, more, 3 * sizeof *corners);
    memcpy(&corners[36], &more[3], 9 * sizeof *corners);
    const struct mesh_sample mended = {positions, corners, 11, 15};
    expect_topology(&mended,
                    (struct expected){.pieces = 1, .vertices = 9, .degenerate = 1, .volume = 1.44});
    struct mesh mesh = prepare(&mended);
    assert_int_equal(mesh.triangle_count, 14);
    assert_true((double)mesh.radius_m < 1.3);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* Two vertices have 100,000 triangles each. No work grows with the square of this number. */
TEST(test_crowded_vertex)
{
    enum {
        RIM = 100000
    };
    struct mesh_sample cone = {zeroed(RIM + 2, 3 * sizeof(double)),
                               zeroed(2 * RIM, 3 * sizeof(uint32_t)), RIM + 2, 2 * RIM};
    cone.positions[2] = 1.0;
    for (uint32_t i = 0; i < RIM; i++) {
        const double angle = 2.0 * 3.14159265358979 * i / RIM;
        cone.positions[6 + 3 * i] = cos(angle);
        cone.positions[7 + 3 * i] = sin(angle);
        const uint32_t a = 2 + i;
        const uint32_t b = 2 + (i + 1) % RIM;
        const uint32_t both[6] = {0, a, b, 1, b, a};
        memcpy(&cone.corners[6 * i], both, sizeof both);
    }
    struct mesh mesh;
    mesh_of_sample(&cone, 1.0, 0.5, &mesh);
    assert_true(mesh.topology.is_closed);
    mesh_clear(&mesh);
    sample_clear(&cone);
}

/* A sphere's normals point away from its middle. A box's normals, 90 degrees apart, are the facets'
 * if the smooth angle is smaller, and mixed if it is larger. */
TEST(test_normals)
{
    struct mesh_sample sample;
    float *normals;
    sample_sphere(&sample, 5);
    struct mesh mesh = prepare(&sample);
    EXPECT_OK(&report, mesh_smooth_normals(&report, mesh.vertices, mesh.vertex_count, mesh.corners,
                                           mesh.triangle_count, 0.3, &normals));
    double worst = 0.0;
    for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
        const float *vertex = &mesh.vertices[3 * (size_t)mesh.corners[i]];
        for (size_t axis = 0; axis < 3; axis++)
            worst = fmax(worst, fabs((double)normals[3 * i + axis] - (double)vertex[axis]));
    }
    /* uneven facets: a few percent of the 0.08 rad that an edge spans */
    assert_true(worst < 0.005);
    free(normals);
    mesh_clear(&mesh);
    sample_clear(&sample);

    sample_box(&sample);
    mesh = prepare(&sample);
    for (int is_mixed = 0; is_mixed < 2; is_mixed++) {
        EXPECT_OK(&report,
                  mesh_smooth_normals(&report, mesh.vertices, mesh.vertex_count, mesh.corners,
                                      mesh.triangle_count, is_mixed ? 1.6 : 1.5, &normals));
        for (size_t i = 0; i < 36; i++) {
            float most = 0.0f;
            for (size_t axis = 0; axis < 3; axis++)
                most = fmaxf(most, fabsf(normals[3 * i + axis]));
            /* three faces of 90 degrees each: (1, 1, 1) / sqrt(3) */
            assert_true(fabsf(most - (is_mixed ? 0.57735027f : 1.0f)) < 1e-6f);
        }
        free(normals);
    }
    mesh_clear(&mesh);
    sample_clear(&sample);
}

TEST_PROGRAM(NULL, NULL)
