/* Tests where rays meet meshes, against a reference in double precision that tries every triangle.
 * Tests that nothing leaks through a closed mesh, and that bits do not depend on lanes and
 * neighbours (on devices: test_bits.c). */
#include "base/report.h"
#include "claims.h"
#include "kernel/mesh_native.h"
#include "kernel/mesh_probe.h"
#include "kernel/mesh_samples.h"
#include "kernel/random_rays.h"
#include "mesh_arrays.h"

#define RAYS 51200 /* a multiple of 8 */

/* Planes of rays and of their results. */
struct flight {
    float input[PROBE_INPUTS][RAYS], output[PROBE_OUTPUTS][RAYS];
};

static struct flight flight, other_flight;

/* Returns a vector of a ray from three planes, one after the other. */
static struct point vector_at(const float (*planes)[RAYS], uint32_t ray)
{
    const struct point vector = {planes[0][ray], planes[1][ray], planes[2][ray]};
    return vector;
}

static struct point direction_of(const struct flight *rays, uint32_t ray)
{
    return vector_at((const float(*)[RAYS])rays->input + PROBE_DIRECTION, ray);
}

static struct point found_at(const struct flight *rays, enum probe_output what, uint32_t ray)
{
    return vector_at((const float(*)[RAYS])rays->output + what, ray);
}

static struct point unit(struct point v)
{
    return scaled(v, 1.0 / sqrt(dot(v, v)));
}

static struct point vertex(const struct mesh *mesh, size_t triangle, size_t corner)
{
    const float *v = &mesh->vertices[3 * (size_t)mesh->corners[3 * triangle + corner % 3]];
    const struct point point = {v[0], v[1], v[2]};
    return point;
}

/* Sets a ray that starts at a point and meets what lies up to `reach`, m, beyond the point. */
static void set_ray(struct flight *rays, uint32_t ray, struct point from, struct point direction,
                    double reach)
{
    const double approach = -dot(from, direction);
    const struct point closest = add(from, direction, approach);
    const double values[PROBE_INPUTS] = {closest.x,   closest.y,   closest.z, direction.x,
                                         direction.y, direction.z, -approach, reach - approach};
    for (int plane = 0; plane < PROBE_INPUTS; plane++)
        rays->input[plane][ray] = (float)values[plane];
}

static void set_ray_to(struct flight *rays, uint32_t ray, struct point from, struct point to,
                       double reach)
{
    set_ray(rays, ray, from, unit(add(to, from, -1.0)), reach);
}

static int32_t whole_at(const struct flight *rays, enum probe_output what, uint32_t ray)
{
    int32_t value;
    memcpy(&value, &rays->output[what][ray], sizeof value);
    return value;
}

static bool is_met(const struct flight *rays, uint32_t ray)
{
    return whole_at(rays, PROBE_TRIANGLE, ray) >= 0;
}

static bool is_blocked(const struct flight *rays, uint32_t ray)
{
    return whole_at(rays, PROBE_BLOCKED, ray) != 0;
}

static void ask(const struct mesh *mesh, struct flight *rays)
{
    for (int question = MESH_NEAREST; question <= MESH_SURFACE; question++)
        mesh_native_wide(mesh, (enum mesh_question)question, rays->input[0], rays->output[0], RAYS,
                         0, RAYS);
}

/* Makes a mesh of the sample, and clears the sample. */
static void prepare(struct mesh_sample *sample, double smooth_angle, struct mesh *mesh)
{
    mesh_of_sample(sample, 1.0, smooth_angle, mesh);
    sample_clear(sample);
}

static struct point axis_of(int axis, double length)
{
    const struct point along = {axis == 0 ? length : 0.0, axis == 1 ? length : 0.0,
                                axis == 2 ? length : 0.0};
    return along;
}

/* Lays random chords through the mesh's sphere. One in four passes close to the sphere's middle,
 * one in four runs along an axis. */
static void lay_chords(struct flight *rays)
{
    for (uint32_t ray = 0; ray < RAYS; ray++) {
        const double reach = ray % 4 == 0 ? 1e-3 : uniform(0.0, 1.1);
        const struct point near = scaled(random_direction(), reach);
        const struct point direction =
            ray % 4 == 1 ? axis_of((int)(ray / 4 % 3), ray & 16 ? 1.0 : -1.0) : random_direction();
        set_ray(rays, ray, add(near, direction, -50.0), direction, 1e6);
    }
}

/* The nearest triangle in double precision, for the very numbers that the kernel was given. */
struct reference {
    double distance; /* HUGE_VAL: no hit */
    double margin; /* least distance, m, of the ray from an edge of a triangle that it met or nearly
                      met; where single precision cannot tell so little, either answer is right */
};

/* Tries one triangle. seen: its corners in the ray's frame, whose z is along the ray, m. */
static void try_triangle(const struct point seen[3], double minimum, struct reference *best)
{
    double area = 0.0, distance = 0.0, margin = HUGE_VAL;
    int positive = 0;
    for (int corner = 0; corner < 3; corner++) {
        const struct point a = seen[(corner + 1) % 3], b = seen[(corner + 2) % 3];
        const double x = b.x - a.x, y = b.y - a.y;
        const double square = x * x + y * y;
        const double share =
            square > 0.0 ? fmin(fmax(-(a.x * x + a.y * y) / square, 0.0), 1.0) : 0.0;
        const double inside = a.x * b.y - a.y * b.x; /* signed area, positive inside */
        area += inside;
        distance += inside * seen[corner].z;
        positive += inside > 0.0;
        margin = fmin(margin, hypot(a.x + share * x, a.y + share * y)); /* distance from the edge */
    }
    const bool is_hit = area != 0.0 && (positive == 3 || positive == 0);
    distance /= area;
    if (is_hit && distance > minimum && distance < best->distance) {
        best->distance = distance;
        best->margin = fmin(best->margin, margin);
    } else if (margin < 1e-5) {
        best->margin = fmin(best->margin, margin);
    }
}

static struct reference find_reference(const struct mesh *mesh, const struct flight *rays,
                                       uint32_t ray)
{
    struct reference best = {HUGE_VAL, HUGE_VAL};
    const struct point point = vector_at((const float(*)[RAYS])rays->input, ray);
    const struct point d = direction_of(rays, ray);
    const struct point least = axis_of(fabs(d.x) < 0.6 ? 0 : 1, 1.0);
    const struct point across = unit(add(least, d, -dot(least, d)));
    const struct point upward = {d.y * across.z - d.z * across.y, d.z * across.x - d.x * across.z,
                                 d.x * across.y - d.y * across.x};
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        struct point seen[3];
        for (size_t corner = 0; corner < 3; corner++) {
            const struct point v = add(vertex(mesh, i, corner), point, -1.0);
            seen[corner] = (struct point){dot(v, across), dot(v, upward), dot(v, d)};
        }
        try_triangle(seen, (double)rays->input[PROBE_MINIMUM][ray], &best);
    }
    return best;
}

/* Compares every third ray. These rays are of all kinds. */
static void compare_with_reference(const struct mesh *mesh, struct flight *rays)
{
    uint32_t hits = 0, undecided = 0;
    double worst = 0.0;
    ask(mesh, rays);
    for (uint32_t ray = 0; ray < RAYS; ray += 3) {
        const struct reference expected = find_reference(mesh, rays, ray);
        const bool is_hit = is_met(rays, ray);
        assert_int_equal(is_blocked(rays, ray), is_hit);
        if (expected.margin < 1e-6 * (double)mesh->radius_m) {
            undecided++; /* too close to an edge for single precision to tell the side */
            continue;
        }
        if (is_hit != (expected.distance < HUGE_VAL))
            fail_msg("ray %u: %s, expected distance %.9g", (unsigned)ray, is_hit ? "hit" : "miss",
                     expected.distance);
        if (!is_hit)
            continue;
        /* a rounding of 3e-7 across the ray grows by 1/cosine along it */
        const double cosine = fabs(dot(found_at(rays, PROBE_FACET, ray), direction_of(rays, ray)));
        const double error = fabs((double)rays->output[PROBE_DISTANCE][ray] - expected.distance) /
                             fmax(1.0, 3e-2 / fmax(cosine, 1e-9));
        worst = fmax(worst, error / (double)mesh->radius_m);
        hits++;
    }
    print_message("%u rays: %u hits, %u undecided, worst distance %.3g of the radius\n",
                  (unsigned)RAYS / 3, (unsigned)hits, (unsigned)undecided, worst);
    assert_true(worst < 1e-5);
    assert_true(hits > RAYS / 60);
    assert_true(undecided < RAYS / 150);
}

TEST(test_rays_meet_the_nearest_triangle)
{
    struct mesh_sample samples[4];
    sample_sphere(&samples[0], 3);
    sample_box(&samples[1]);
    sample_ring(&samples[2], 24, 12);
    sample_litter(&samples[3], 500);
    lay_chords(&flight);
    for (int kind = 0; kind < 4; kind++) {
        struct mesh mesh;
        prepare(&samples[kind], 0.0, &mesh);
        assert_int_equal(mesh.topology.is_closed, kind < 3);
        compare_with_reference(&mesh, &flight);
        mesh_clear(&mesh);
    }
}

/* Returns a point on a triangle's edge, or its corner, chosen by the ray's number. */
static struct point choose_target(const struct mesh *mesh, uint32_t ray)
{
    const size_t triangle = ray % mesh->triangle_count;
    const struct point a = vertex(mesh, triangle, ray % 3);
    const struct point b = vertex(mesh, triangle, ray % 3 + 1);
    const double share = ray % 7 < 3 ? 0.0 : uniform(0.0, 1.0);
    return add(scaled(a, 1.0 - share), b, share);
}

/* Every ray between a point inside a closed mesh and one outside meets the mesh, even if the ray is
 * aimed exactly at a corner or an edge. */
static void cross_surface(const struct mesh *mesh, struct point inside)
{
    for (int is_inwards = 0; is_inwards < 2; is_inwards++) {
        for (uint32_t ray = 0; ray < RAYS; ray++) {
            const struct point target = choose_target(mesh, ray);
            const struct point outside = add(inside, unit(add(target, inside, -1.0)), 4.0);
            set_ray_to(&flight, ray, is_inwards ? outside : inside, target, is_inwards ? 4.0 : 1e6);
        }
        ask(mesh, &flight);
        for (uint32_t ray = 0; ray < RAYS; ray++)
            if (!is_met(&flight, ray) || !is_blocked(&flight, ray))
                fail_msg("%s: ray %u slips through triangle %u", is_inwards ? "in" : "out",
                         (unsigned)ray, (unsigned)(ray % mesh->triangle_count));
    }
}

TEST(test_nothing_leaks_through_a_closed_mesh)
{
    static const struct point middles[] = {
        {0.0, 0.0, 0.0}, {0.01, -0.02, 0.003}, {0.3, 0.1, -0.2}, {0.0, 0.0, 0.2999}};
    struct mesh_sample samples[3];
    sample_sphere(&samples[0], 4);
    sample_box(&samples[1]);
    sample_ring(&samples[2], 300, 150);
    for (int kind = 0; kind < 3; kind++) {
        struct mesh mesh;
        prepare(&samples[kind], 0.0, &mesh);
        for (int i = 0; i < (kind < 2 ? 4 : 8); i++) {
            const double angle = uniform(-PI, PI);
            const struct point in_tube = {0.65 * cos(angle), 0.65 * sin(angle), 0.0};
            cross_surface(&mesh, kind < 2 ? middles[i] : in_tube);
        }
        mesh_clear(&mesh);
    }
}

/* Rays from 400 m, some of them grazing, must meet a fine sphere of facets between the true sphere
 * and the largest sphere inside the facets. */
TEST(test_a_fine_sphere_is_a_sphere)
{
    struct mesh_sample sample;
    struct mesh mesh;
    sample_sphere(&sample, 7);
    prepare(&sample, 0.5, &mesh);
    /* the longest edges, in the middle of an octant: an octahedron's, seen from 1/sqrt(3) */
    const double edge = sqrt(2.0) / 128.0 * sqrt(3.0);
    const double sagitta = edge * edge / 6.0; /* depth of a facet's middle below the sphere */
    for (uint32_t ray = 0; ray < RAYS; ray++)
        set_ray_to(&flight, ray, scaled(random_direction(), 400.0),
                   scaled(random_direction(), ray & 1 ? 0.999 : 0.9), 1e6);
    ask(&mesh, &flight);
    uint32_t compared = 0;
    double worst_facet = 0.0, worst_smooth = 0.0, worst_lift = 0.0;
    for (uint32_t ray = 0; ray < RAYS; ray++) {
        const struct point closest = vector_at((const float(*)[RAYS])flight.input, ray);
        const double square = dot(closest, closest);
        if (square > 0.9999 - 2.0 * sagitta)
            continue; /* the ray may pass beside the inner sphere */
        const double cosine = sqrt(1.0 - square);
        const double error = (double)flight.output[PROBE_DISTANCE][ray] + cosine;
        /* the ray meets the inside of the sphere, so later */
        assert_true(error > -1e-5);
        assert_true(error < cosine - sqrt((1.0 - sagitta) * (1.0 - sagitta) - square) + 1e-5);
        const struct point out = unit(found_at(&flight, PROBE_HIT, ray));
        const struct point lifted = found_at(&flight, PROBE_LIFTED, ray);
        const double facet = dot(out, found_at(&flight, PROBE_FACET, ray));
        const double smooth = dot(out, found_at(&flight, PROBE_SMOOTH, ray));
        worst_facet = fmax(worst_facet, acos(fmin(facet, 1.0)));
        worst_smooth = fmax(worst_smooth, acos(fmin(smooth, 1.0)));
        worst_lift = fmax(worst_lift, fabs(sqrt(dot(lifted, lifted)) - 1.0));
        compared++;
    }
    print_message("%u of %u rays; smooth normal off by %.3g rad, lifted point by %.3g\n",
                  (unsigned)compared, (unsigned)RAYS, worst_smooth, worst_lift);
    assert_true(compared > RAYS / 2);
    assert_true(worst_facet < 2.0 * edge);
    /* a corner's normal is the mean of facets' that lie about it unevenly by an edge or less;
     * single precision's acos near 1 adds 5e-4 */
    assert_true(worst_smooth < 0.1 * edge + 5e-4);
    /* half the sagitta of the lifted surface, which is as far outside the sphere as facets are
     * inside */
    assert_true(worst_lift < 1.1 * sagitta);
    mesh_clear(&mesh);
}

TEST(test_smooth_normals_show_the_side_that_was_met)
{
    struct mesh_sample sample;
    struct mesh mesh;
    uint32_t bent = 0;
    sample_sphere(&sample, 1); /* coarse enough that normals differ from facets by 25 degrees */
    prepare(&sample, 1.5, &mesh);
    lay_chords(&flight);
    ask(&mesh, &flight);
    for (uint32_t ray = 0; ray < RAYS; ray++) {
        if (!is_met(&flight, ray))
            continue;
        const struct point d = direction_of(&flight, ray);
        const struct point n = found_at(&flight, PROBE_SMOOTH, ray);
        const struct point f = found_at(&flight, PROBE_FACET, ray);
        const struct point lift =
            add(found_at(&flight, PROBE_LIFTED, ray), found_at(&flight, PROBE_HIT, ray), -1.0);
        assert_true(-dot(d, f) > -1e-6); /* met from outside */
        assert_true(fabs(dot(n, n) - 1.0) < 1e-6);
        assert_true(dot(n, f) > 0.0);
        /* 1e-6: rounding of unit vectors; a bend adds at most 1 % of the ray, and changes the
         * normal's length by as little */
        assert_true(-dot(d, n) >= fmin(0.0098, -dot(d, f)) - 1e-6);
        assert_true(dot(f, lift) > -1e-6);
        bent += -dot(d, n) < 0.0101;
    }
    print_message("%u normals bent\n", (unsigned)bent);
    assert_true(bent > 100);
    mesh_clear(&mesh);
}

/* Sets shadow rays from the points that rays met (lifted, or on the facets), in directions that the
 * smooth normal faces and the facet does not. Rays without such a direction go nowhere. Returns the
 * number of rays that are set. */
static uint32_t lay_shadow_rays(const struct flight *rays, enum probe_output start,
                                struct flight *shadows)
{
    uint32_t count = 0;
    for (uint32_t ray = 0; ray < RAYS; ray++) {
        const struct point n = found_at(rays, PROBE_SMOOTH, ray);
        const struct point f = found_at(rays, PROBE_FACET, ray);
        /* nearly across the smooth normal, on the side where the facet turns away */
        struct point way = add(scaled(n, dot(n, f)), f, -1.0);
        const double square = dot(way, way);
        set_ray(shadows, ray, axis_of(0, 50.0), axis_of(2, 1.0), 1.0);
        if (!is_met(rays, ray) || square < 1e-6)
            continue;
        way = add(scaled(way, 1.0 / sqrt(square)), n, 0.05);
        if (dot(way, f) > -0.01)
            continue;
        set_ray(shadows, ray, add(found_at(rays, start, ray), f, 2e-5),
                scaled(way, 1.0 / sqrt(1.0 + 0.05 * 0.05)), 1e6);
        count++;
    }
    return count;
}

/* Sound that starts lifted passes a sphere of facets wherever it passes the smooth surface. */
TEST(test_lifted_rays_pass_the_facets)
{
    struct mesh_sample sample;
    struct mesh mesh;
    uint32_t blocked[2] = {0, 0}, count = 0;
    sample_sphere(&sample, 3);
    prepare(&sample, 1.5, &mesh);
    lay_chords(&flight);
    ask(&mesh, &flight);
    for (int is_lifted = 0; is_lifted < 2; is_lifted++) {
        count = lay_shadow_rays(&flight, is_lifted ? PROBE_LIFTED : PROBE_HIT, &other_flight);
        ask(&mesh, &other_flight);
        for (uint32_t ray = 0; ray < RAYS; ray++)
            blocked[is_lifted] += is_blocked(&other_flight, ray);
    }
    print_message("%u shadow rays, blocked %u from facets, %u lifted\n", (unsigned)count,
                  (unsigned)blocked[0], (unsigned)blocked[1]);
    assert_true(count > RAYS / 4);
    assert_true(blocked[0] > count / 10 * 9); /* all but rays that start at an edge */
    assert_true(blocked[1] < count / 100);
    mesh_clear(&mesh);
}

/* Lays half of the rays side by side, as in a fan, and strews the others. Some are aimed at
 * corners, where several triangles are equally near. */
static void lay_mixed(const struct mesh *mesh)
{
    lay_chords(&flight);
    for (uint32_t ray = 0; ray < RAYS / 2; ray++) {
        const float *v = &mesh->vertices[3 * (size_t)(ray % mesh->vertex_count)];
        const struct point from = {20.0, -1.0 + 2.0 * (ray / 200) / 256.0, 5.0};
        const struct point to = {0.0, from.y, -1.1 + 2.2 * (ray % 200) / 200.0};
        const struct point corner = {v[0], v[1], v[2]};
        set_ray_to(&flight, ray, from, ray % 5 == 0 ? corner : to, ray % 3 == 0 ? 20.0 : 1e6);
    }
}

/* Rays meet what lies at the end of their reach, but nothing beyond. */
TEST(test_reach_ends_at_what_is_met)
{
    static float nearest[RAYS];
    struct mesh_sample sample;
    struct mesh mesh;
    float *maximum = flight.input[PROBE_MAXIMUM];
    sample_ring(&sample, 100, 50);
    prepare(&sample, 0.0, &mesh);
    lay_mixed(&mesh);
    ask(&mesh, &flight);
    memcpy(nearest, flight.output[PROBE_DISTANCE], sizeof nearest);
    for (uint32_t ray = 0; ray < RAYS; ray++)
        if (nearest[ray] < FAR_AWAY)
            maximum[ray] = ray & 1 ? nearest[ray] : nextafterf(nearest[ray], -1e9f);
    ask(&mesh, &flight);
    for (uint32_t ray = 0; ray < RAYS; ray++) {
        const bool expected = (ray & 1) != 0 && nearest[ray] < FAR_AWAY;
        assert_int_equal(is_met(&flight, ray), expected);
        assert_int_equal(is_blocked(&flight, ray), expected);
    }
    /* rays that begin at the hit find the next one farther away */
    memcpy(flight.input[PROBE_MINIMUM], nearest, sizeof nearest);
    for (uint32_t ray = 0; ray < RAYS; ray++)
        maximum[ray] = 1e6f;
    ask(&mesh, &flight);
    for (uint32_t ray = 0; ray < RAYS; ray++)
        assert_true(flight.output[PROBE_DISTANCE][ray] > nearest[ray] || nearest[ray] == FAR_AWAY);
    mesh_clear(&mesh);
}

static void expect_same(const char *what, const struct flight *found, const struct flight *expected)
{
    for (int plane = 0; plane < PROBE_OUTPUTS; plane++)
        for (uint32_t ray = 0; ray < RAYS; ray++)
            if (memcmp(&found->output[plane][ray], &expected->output[plane][ray], sizeof(float)) !=
                0)
                fail_msg("%s: plane %d of ray %u differs", what, plane, (unsigned)ray);
}

TEST(test_lanes_meet_what_one_ray_meets)
{
    struct mesh_sample sample;
    struct mesh mesh;
    sample_ring(&sample, 200, 100);
    prepare(&sample, 0.4, &mesh);
    lay_mixed(&mesh);
    for (int question = MESH_NEAREST; question <= MESH_SURFACE; question++)
        mesh_native_one(&mesh, (enum mesh_question)question, flight.input[0],
                        other_flight.output[0], RAYS, 0, RAYS);
    ask(&mesh, &flight);
    expect_same("8 lanes of plain C", &flight, &other_flight);
    mesh_clear(&mesh);
}

/* Lays every ray along an edge of a triangle, which the ray sees edge-on. */
static void lay_along_edges(const struct mesh *mesh)
{
    for (uint32_t ray = 0; ray < RAYS; ray++) {
        const size_t triangle = ray / 3 % mesh->triangle_count;
        const struct point a = vertex(mesh, triangle, ray % 3);
        const struct point b = vertex(mesh, triangle, ray % 3 + 1);
        set_ray_to(&flight, ray, add(a, add(a, b, -1.0), 1e3), b, 1e6);
    }
}

/* Expects rays to find the same in other places. 7919 is prime and no factor of RAYS. */
static void expect_same_in_any_order(const struct mesh *mesh)
{
    ask(mesh, &flight);
    for (uint32_t ray = 0; ray < RAYS; ray++)
        for (int plane = 0; plane < PROBE_INPUTS; plane++)
            other_flight.input[plane][(uint64_t)ray * 7919 % RAYS] = flight.input[plane][ray];
    ask(mesh, &other_flight);
    for (uint32_t ray = 0; ray < RAYS; ray++)
        for (int plane = 0; plane < PROBE_OUTPUTS; plane++)
            assert_memory_equal(&other_flight.output[plane][(uint64_t)ray * 7919 % RAYS],
                                &flight.output[plane][ray], sizeof(float));
}

TEST(test_packet_order_never_changes_hits)
{
    struct mesh_sample sample;
    struct mesh mesh;
    sample_ring(&sample, 150, 80);
    prepare(&sample, 0.4, &mesh);
    lay_mixed(&mesh);
    expect_same_in_any_order(&mesh);
    lay_along_edges(&mesh);
    expect_same_in_any_order(&mesh);
    mesh_clear(&mesh);
    sample_litter(&sample, 30000);
    prepare(&sample, 0.0, &mesh);
    lay_along_edges(&mesh);
    expect_same_in_any_order(&mesh);
    mesh_clear(&mesh);
}

TEST_PROGRAM(NULL, NULL)
