/* Where rays meet meshes, against a reference in double precision that tries every triangle; that
 * nothing leaks through a closed mesh; that bits do not depend on width, company or device. */
#include "claims.h"
#include "kernel/mesh_native.h"
#include "kernel/mesh_probe.h"
#include "kernel/mesh_samples.h"
#include "kernel/probe_device.h"
#include "physics/bench.h"

#define RAYS 51200 /* a multiple of 16 */

/* Planes of rays and what they find. */
struct flight {
    float *input, *output;
    uint32_t rays;
};

static struct flight make_flight(uint32_t rays)
{
    struct flight flight = {calloc(rays, PROBE_INPUTS * sizeof(float)),
                            calloc(rays, PROBE_OUTPUTS * sizeof(float)), rays};
    assert_non_null(flight.input);
    assert_non_null(flight.output);
    return flight;
}

static void clear_flight(struct flight *flight)
{
    free(flight->input);
    free(flight->output);
}

/* A ray from a point, to be met beyond it and not beyond `reach`. */
static void set_ray(const struct flight *flight, uint32_t ray, const double from[3],
                    const double direction[3], double reach)
{
    double approach = 0.0;
    for (int axis = 0; axis < 3; axis++)
        approach -= from[axis] * direction[axis];
    for (uint32_t axis = 0; axis < 3; axis++) {
        flight->input[axis * flight->rays + ray] = (float)(from[axis] + approach * direction[axis]);
        flight->input[(PROBE_DIRECTION + axis) * flight->rays + ray] = (float)direction[axis];
    }
    flight->input[PROBE_MINIMUM * flight->rays + ray] = (float)-approach;
    flight->input[PROBE_MAXIMUM * flight->rays + ray] = (float)(reach - approach);
}

static void set_ray_to(const struct flight *flight, uint32_t ray, const double from[3],
                       const double to[3], double reach)
{
    double direction[3], square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        direction[axis] = to[axis] - from[axis];
        square += direction[axis] * direction[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        direction[axis] /= sqrt(square);
    set_ray(flight, ray, from, direction, reach);
}

static int32_t triangle_of(const struct flight *flight, uint32_t ray)
{
    int32_t triangle;
    memcpy(&triangle, &flight->output[PROBE_TRIANGLE * flight->rays + ray], sizeof triangle);
    return triangle;
}

static int is_blocked(const struct flight *flight, uint32_t ray)
{
    int32_t blocked;
    memcpy(&blocked, &flight->output[PROBE_BLOCKED * flight->rays + ray], sizeof blocked);
    return blocked != 0;
}

static void ask(const struct mesh *mesh, struct flight *flight)
{
    for (int question = MESH_NEAREST; question <= MESH_SURFACE; question++)
        mesh_native_wide(mesh, (enum mesh_question)question, flight->input, flight->output,
                         flight->rays, 0, flight->rays);
}

static void prepare(const struct mesh_sample *sample, double smooth_angle, struct mesh *mesh)
{
    static struct report report;
    struct mesh_options options;
    mesh_options_init(&options);
    options.smooth_angle_rad = smooth_angle;
    EXPECT_OK(&report, mesh_from_arrays(&report, "sample", sample->positions, sample->vertices,
                                        sample->corners, sample->triangles, &options, mesh));
}

/* Random chords through the mesh's sphere; one in four passes close by its middle, one in four runs
 * along an axis. */
static void lay_chords(const struct flight *flight)
{
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        double from[3], direction[3];
        sample_direction(from);
        sample_direction(direction);
        const double reach = ray % 4 == 0 ? 1e-3 : sample_uniform(0.0, 1.1);
        for (int axis = 0; axis < 3; axis++) {
            if (ray % 4 == 1)
                direction[axis] = axis == (int)(ray / 4 % 3) ? (ray & 16 ? 1.0 : -1.0) : 0.0;
            from[axis] = reach * from[axis];
        }
        for (int axis = 0; axis < 3; axis++)
            from[axis] -= 50.0 * direction[axis];
        set_ray(flight, ray, from, direction, 1e6);
    }
}

/* The nearest triangle in double precision, for the very numbers that the kernel was given. */
struct reference {
    double distance; /* HUGE_VAL: none */
    double margin; /* least distance, in m, by which a triangle before that was met or missed: below
                      what single precision tells, either answer is right */
};

struct edge_look {
    double inside;   /* signed area, positive inside */
    double distance; /* of the ray from the edge */
};

static struct edge_look look_at_edge(const double a[2], const double b[2])
{
    const double x = b[0] - a[0];
    const double y = b[1] - a[1];
    const double square = x * x + y * y;
    const double share = square > 0.0 ? fmin(fmax(-(a[0] * x + a[1] * y) / square, 0.0), 1.0) : 0.0;
    const struct edge_look look = {a[0] * b[1] - a[1] * b[0],
                                   hypot(a[0] + share * x, a[1] + share * y)};
    return look;
}

static void try_triangle(const double seen[3][3], double minimum, struct reference *best)
{
    double area = 0.0, distance = 0.0, margin = HUGE_VAL;
    int positive = 0;
    for (int corner = 0; corner < 3; corner++) {
        const struct edge_look look = look_at_edge(seen[(corner + 1) % 3], seen[(corner + 2) % 3]);
        area += look.inside;
        distance += look.inside * seen[corner][2];
        positive += look.inside > 0.0;
        margin = fmin(margin, look.distance);
    }
    const int is_met = area != 0.0 && (positive == 3 || positive == 0);
    distance /= area;
    if (is_met && distance > minimum && distance < best->distance) {
        best->distance = distance;
        best->margin = fmin(best->margin, margin);
    } else if (margin < 1e-5) {
        best->margin = fmin(best->margin, margin);
    }
}

static struct reference find_reference(const struct mesh *mesh, const struct flight *flight,
                                       uint32_t ray)
{
    double point[3], direction[3], across[3], upward[3];
    struct reference best = {HUGE_VAL, HUGE_VAL};
    for (uint32_t axis = 0; axis < 3; axis++) {
        point[axis] = (double)flight->input[axis * flight->rays + ray];
        direction[axis] = (double)flight->input[(PROBE_DIRECTION + axis) * flight->rays + ray];
    }
    const int least = fabs(direction[0]) < 0.6 ? 0 : 1;
    double length = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        across[axis] = (axis == least) - direction[least] * direction[axis];
        length += across[axis] * across[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        across[axis] /= sqrt(length);
    for (int axis = 0; axis < 3; axis++)
        upward[axis] = direction[(axis + 1) % 3] * across[(axis + 2) % 3] -
                       direction[(axis + 2) % 3] * across[(axis + 1) % 3];
    const double minimum = (double)flight->input[PROBE_MINIMUM * flight->rays + ray];
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double seen[3][3] = {{0.0}};
        for (size_t corner = 0; corner < 3; corner++) {
            const float *vertex = &mesh->vertices[3 * (size_t)mesh->corners[3 * i + corner]];
            for (int axis = 0; axis < 3; axis++) {
                const double from_point = (double)vertex[axis] - point[axis];
                seen[corner][0] += from_point * across[axis];
                seen[corner][1] += from_point * upward[axis];
                seen[corner][2] += from_point * direction[axis];
            }
        }
        try_triangle((const double(*)[3])seen, minimum, &best);
    }
    return best;
}

/* Of the angle between the ray and the normal of the facet that it met. */
static double facet_cosine(const struct flight *flight, uint32_t ray)
{
    double cosine = 0.0;
    for (uint32_t axis = 0; axis < 3; axis++)
        cosine += (double)flight->output[(PROBE_FACET + axis) * flight->rays + ray] *
                  (double)flight->input[(PROBE_DIRECTION + axis) * flight->rays + ray];
    return fabs(cosine);
}

static void compare_with_reference(const struct mesh *mesh, struct flight *flight)
{
    uint32_t hits = 0, undecided = 0;
    double worst = 0.0;
    ask(mesh, flight);
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        const struct reference expected = find_reference(mesh, flight, ray);
        const double distance = (double)flight->output[ray];
        const int is_hit = triangle_of(flight, ray) >= 0;
        assert_int_equal(is_blocked(flight, ray), is_hit);
        if (expected.margin < 1e-6 * (double)mesh->radius_m) {
            undecided++; /* so close by an edge that single precision may see either side */
            continue;
        }
        if (is_hit != (expected.distance < HUGE_VAL))
            fail_msg("ray %u: %s, expected distance %.9g", (unsigned)ray, is_hit ? "hit" : "miss",
                     expected.distance);
        if (!is_hit)
            continue;
        /* 3e-7 of rounding across the ray is as much over the cosine along it */
        const double error = fabs(distance - expected.distance) /
                             fmax(1.0, 3e-2 / fmax(facet_cosine(flight, ray), 1e-9));
        worst = fmax(worst, error / (double)mesh->radius_m);
        hits++;
    }
    print_message("%u rays: %u hits, %u undecided, worst distance %.3g of the radius\n",
                  (unsigned)flight->rays, (unsigned)hits, (unsigned)undecided, worst);
    assert_true(worst < 1e-5);
    assert_true(hits > flight->rays / 20);
    assert_true(undecided < flight->rays / 50);
}

static void test_closed_meshes(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    lay_chords(&flight);
    for (int kind = 0; kind < 3; kind++) {
        if (kind == 0)
            sample_sphere(&sample, 3);
        else if (kind == 1)
            sample_box(&sample);
        else
            sample_ring(&sample, 24, 12);
        prepare(&sample, 0.0, &mesh);
        assert_true(mesh.topology.is_closed);
        compare_with_reference(&mesh, &flight);
        mesh_clear(&mesh);
        sample_clear(&sample);
    }
    clear_flight(&flight);
}

static void test_strewn_triangles(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    sample_litter(&sample, 500);
    prepare(&sample, 0.0, &mesh);
    lay_chords(&flight);
    compare_with_reference(&mesh, &flight);
    mesh_clear(&mesh);
    sample_clear(&sample);
    clear_flight(&flight);
}

/* A point on a triangle's edge, or its corner; which one goes by the ray's number. */
static void choose_target(const struct mesh *mesh, uint32_t ray, double target[3])
{
    const size_t first = 3 * (ray % mesh->triangle_count);
    const float *a = &mesh->vertices[3 * (size_t)mesh->corners[first + ray % 3]];
    const float *b = &mesh->vertices[3 * (size_t)mesh->corners[first + (ray + 1) % 3]];
    const double share = ray % 7 < 3 ? 0.0 : sample_uniform(0.0, 1.0);
    for (int axis = 0; axis < 3; axis++)
        target[axis] = (1.0 - share) * (double)a[axis] + share * (double)b[axis];
}

static void expect_all_met(const struct mesh *mesh, struct flight *flight, const char *way)
{
    ask(mesh, flight);
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        if (triangle_of(flight, ray) < 0 || !is_blocked(flight, ray))
            fail_msg("%s: ray %u slips through triangle %u", way, (unsigned)ray,
                     (unsigned)(ray % mesh->triangle_count));
    }
}

/* Between a point inside a closed mesh and one outside every ray meets it, also one that is aimed
 * exactly at a corner or an edge. */
static void cross_surface(const struct mesh *mesh, const double inside[3], struct flight *flight)
{
    double target[3], outside[3];
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        choose_target(mesh, ray, target);
        set_ray_to(flight, ray, inside, target, 1e6);
    }
    expect_all_met(mesh, flight, "out");
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        double square = 0.0;
        choose_target(mesh, ray, target);
        for (int axis = 0; axis < 3; axis++)
            square += (target[axis] - inside[axis]) * (target[axis] - inside[axis]);
        for (int axis = 0; axis < 3; axis++)
            outside[axis] = inside[axis] + 4.0 * (target[axis] - inside[axis]) / sqrt(square);
        set_ray_to(flight, ray, outside, target, 4.0);
    }
    expect_all_met(mesh, flight, "in");
}

static void test_no_leaks(void **state)
{
    static const double middles[][3] = {
        {0.0, 0.0, 0.0}, {0.01, -0.02, 0.003}, {0.3, 0.1, -0.2}, {0.0, 0.0, 0.2999}};
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    for (size_t i = 0; i < 4; i++) {
        sample_sphere(&sample, 4);
        prepare(&sample, 0.0, &mesh);
        cross_surface(&mesh, middles[i], &flight);
        mesh_clear(&mesh);
        sample_clear(&sample);
        sample_box(&sample);
        prepare(&sample, 0.0, &mesh);
        cross_surface(&mesh, middles[i], &flight);
        mesh_clear(&mesh);
        sample_clear(&sample);
    }
    sample_ring(&sample, 300, 150);
    prepare(&sample, 0.0, &mesh);
    for (int i = 0; i < 8; i++) {
        const double angle = sample_uniform(-PI, PI);
        const double inside[3] = {0.65 * cos(angle), 0.65 * sin(angle), 0.0};
        cross_surface(&mesh, inside, &flight);
    }
    mesh_clear(&mesh);
    sample_clear(&sample);
    clear_flight(&flight);
}

/* Rays from 400 m, some of them grazing, on a fine sphere against its equation: they meet it
 * between the sphere and the largest one inside. */
static void test_sphere(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    sample_sphere(&sample, 7);
    prepare(&sample, 0.5, &mesh);
    /* the longest edges: in the middle of an octant the octahedron's are seen from 1/sqrt(3) */
    const double edge = sqrt(2.0) / 128.0 * sqrt(3.0);
    const double sagitta = edge * edge / 6.0; /* how far the middle of a facet lies inside */
    for (uint32_t ray = 0; ray < flight.rays; ray++) {
        double from[3], to[3];
        sample_direction(from);
        sample_direction(to);
        const double reach = ray & 1 ? 0.999 : 0.9;
        for (int axis = 0; axis < 3; axis++) {
            from[axis] *= 400.0;
            to[axis] *= reach;
        }
        set_ray_to(&flight, ray, from, to, 1e6);
    }
    ask(&mesh, &flight);
    uint32_t compared = 0;
    double worst_facet = 0.0, worst_smooth = 0.0, worst_lift = 0.0;
    for (uint32_t ray = 0; ray < flight.rays; ray++) {
        double square = 0.0, facet = 0.0, smooth = 0.0, lifted = 0.0, length = 0.0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            const double p = (double)flight.input[axis * flight.rays + ray];
            square += p * p;
        }
        if (square > 0.9999 - 2.0 * sagitta)
            continue; /* may pass beside the inner sphere */
        const double cosine = sqrt(1.0 - square);
        const double error = (double)flight.output[ray] + cosine;
        /* it meets the sphere's inside, later */
        assert_true(error > -1e-5);
        assert_true(error < cosine - sqrt((1.0 - sagitta) * (1.0 - sagitta) - square) + 1e-5);
        for (uint32_t axis = 0; axis < 3; axis++) {
            const double hit = (double)flight.output[(PROBE_HIT + axis) * flight.rays + ray];
            const double up = (double)flight.output[(PROBE_LIFTED + axis) * flight.rays + ray];
            facet += hit * (double)flight.output[(PROBE_FACET + axis) * flight.rays + ray];
            smooth += hit * (double)flight.output[(PROBE_SMOOTH + axis) * flight.rays + ray];
            lifted += up * up;
            length += hit * hit;
        }
        worst_facet = fmax(worst_facet, acos(fmin(facet / sqrt(length), 1.0)));
        worst_smooth = fmax(worst_smooth, acos(fmin(smooth / sqrt(length), 1.0)));
        worst_lift = fmax(worst_lift, fabs(sqrt(lifted) - 1.0));
        compared++;
    }
    print_message("%u of %u rays; smooth normal off by %.3g rad, lifted point by %.3g\n",
                  (unsigned)compared, (unsigned)flight.rays, worst_smooth, worst_lift);
    assert_true(compared > flight.rays / 2);
    assert_true(worst_facet < 2.0 * edge);
    /* normals at corners are means of facets' that lie about them unevenly by an edge or less;
     * single precision's acos near 1 adds 5e-4 */
    assert_true(worst_smooth < 0.1 * edge + 5e-4);
    /* half the sagitta of the lifted surface (outside the sphere by as much as facets are inside)
     */
    assert_true(worst_lift < 1.1 * sagitta);
    clear_flight(&flight);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* A smooth normal never shows the ray a side that it did not meet. */
static void test_terminator(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    sample_sphere(&sample, 1); /* so coarse that normals differ from facets by 25 degrees */
    prepare(&sample, 1.5, &mesh);
    lay_chords(&flight);
    ask(&mesh, &flight);
    uint32_t bent = 0;
    for (uint32_t ray = 0; ray < flight.rays; ray++) {
        double smooth = 0.0, facet = 0.0, both = 0.0, length = 0.0, out = 0.0;
        if (triangle_of(&flight, ray) < 0)
            continue;
        for (uint32_t axis = 0; axis < 3; axis++) {
            const double d = (double)flight.input[(PROBE_DIRECTION + axis) * flight.rays + ray];
            const double n = (double)flight.output[(PROBE_SMOOTH + axis) * flight.rays + ray];
            const double f = (double)flight.output[(PROBE_FACET + axis) * flight.rays + ray];
            smooth -= d * n;
            facet -= d * f;
            both += n * f;
            length += n * n;
            out += f * ((double)flight.output[(PROBE_LIFTED + axis) * flight.rays + ray] -
                        (double)flight.output[(PROBE_HIT + axis) * flight.rays + ray]);
        }
        assert_true(facet > -1e-6); /* from outside */
        assert_true(fabs(length - 1.0) < 1e-6);
        assert_true(both > 0.0);
        /* as unit vectors are: 1e-6; bending by at most 1 % of the ray shortens by as little */
        assert_true(smooth >= fmin(0.0098, facet) - 1e-6);
        assert_true(out > -1e-6);
        bent += smooth < 0.0101;
    }
    print_message("%u normals bent\n", (unsigned)bent);
    assert_true(bent > 100);
    clear_flight(&flight);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* Sets rays from what the flight met (lifted, or on the facets) along directions that the smooth
 * normal faces and the facet does not; those of rays without such a direction go nowhere. Returns
 * how many are set. */
static uint32_t lay_shadow_rays(const struct flight *flight, enum probe_output start,
                                const struct flight *shadows)
{
    uint32_t count = 0;
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        double n[3], f[3], from[3], way[3], along = 0.0, length = 0.0, facing = 0.0;
        const float *met = flight->output + ray;
        static const double nowhere[3] = {50.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
        set_ray(shadows, ray, nowhere, up, 1.0);
        for (uint32_t axis = 0; axis < 3; axis++) {
            n[axis] = (double)met[(PROBE_SMOOTH + axis) * flight->rays];
            f[axis] = (double)met[(PROBE_FACET + axis) * flight->rays];
            from[axis] = (double)met[((uint32_t)start + axis) * flight->rays] + 2e-5 * f[axis];
            along += n[axis] * f[axis];
        }
        /* nearly across the smooth normal, on the side where the facet turns away */
        for (int axis = 0; axis < 3; axis++) {
            way[axis] = n[axis] * along - f[axis];
            length += way[axis] * way[axis];
        }
        if (triangle_of(flight, ray) < 0 || length < 1e-6)
            continue;
        for (int axis = 0; axis < 3; axis++) {
            way[axis] = way[axis] / sqrt(length) + 0.05 * n[axis];
            facing += way[axis] * f[axis];
        }
        if (facing > -0.01)
            continue;
        for (int axis = 0; axis < 3; axis++)
            way[axis] /= sqrt(1.0 + 0.05 * 0.05);
        set_ray(shadows, ray, from, way, 1e6);
        count++;
    }
    return count;
}

/* A sphere of facets lets sound past wherever the smooth surface does, if it starts lifted. */
static void test_shadows_of_facets(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    struct flight shadows = make_flight(RAYS);
    uint32_t blocked[2] = {0, 0};
    uint32_t count = 0;
    sample_sphere(&sample, 3);
    prepare(&sample, 1.5, &mesh);
    lay_chords(&flight);
    ask(&mesh, &flight);
    for (int is_lifted = 0; is_lifted < 2; is_lifted++) {
        count = lay_shadow_rays(&flight, is_lifted ? PROBE_LIFTED : PROBE_HIT, &shadows);
        ask(&mesh, &shadows);
        for (uint32_t ray = 0; ray < RAYS; ray++)
            blocked[is_lifted] += (uint32_t)is_blocked(&shadows, ray);
    }
    print_message("%u shadow rays, blocked %u from facets, %u lifted\n", (unsigned)count,
                  (unsigned)blocked[0], (unsigned)blocked[1]);
    assert_true(count > RAYS / 4);
    assert_true(blocked[0] > count / 10 * 9); /* all but those that start at an edge */
    assert_true(blocked[1] < count / 100);
    clear_flight(&flight);
    clear_flight(&shadows);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* Half of the rays lie side by side, as in a fan; half are strewn. Some are aimed at corners, where
 * several triangles are equally near. */
static void lay_mixed(const struct mesh *mesh, const struct flight *flight)
{
    lay_chords(flight);
    for (uint32_t ray = 0; ray < flight->rays / 2; ray++) {
        const double from[3] = {20.0, -1.0 + 2.0 * (ray / 200) / 256.0, 5.0};
        const double to[3] = {0.0, from[1], -1.1 + 2.2 * (ray % 200) / 200.0};
        const float *corner = &mesh->vertices[3 * (size_t)(ray % mesh->vertex_count)];
        const double exactly[3] = {(double)corner[0], (double)corner[1], (double)corner[2]};
        set_ray_to(flight, ray, from, ray % 5 == 0 ? exactly : to, ray % 3 == 0 ? 20.0 : 1e6);
    }
}

/* Rays with a reach: what lies beyond is not met, at it is. */
static void test_reach(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    sample_ring(&sample, 100, 50);
    prepare(&sample, 0.0, &mesh);
    lay_mixed(&mesh, &flight);
    ask(&mesh, &flight);
    float *nearest = calloc(flight.rays, sizeof *nearest);
    assert_non_null(nearest);
    memcpy(nearest, flight.output, flight.rays * sizeof *nearest);
    float *maximum = flight.input + PROBE_MAXIMUM * flight.rays;
    for (uint32_t ray = 0; ray < flight.rays; ray++)
        if (nearest[ray] < FAR_AWAY)
            maximum[ray] = ray & 1 ? nearest[ray] : nextafterf(nearest[ray], -1e9f);
    ask(&mesh, &flight);
    for (uint32_t ray = 0; ray < flight.rays; ray++) {
        const int is_met = (ray & 1) != 0 && nearest[ray] < FAR_AWAY;
        assert_int_equal(triangle_of(&flight, ray) >= 0, is_met);
        assert_int_equal(is_blocked(&flight, ray), is_met);
    }
    /* from the hit on, the next one is farther */
    memcpy(flight.input + PROBE_MINIMUM * flight.rays, nearest, flight.rays * sizeof *nearest);
    for (uint32_t ray = 0; ray < flight.rays; ray++)
        maximum[ray] = 1e6f;
    ask(&mesh, &flight);
    for (uint32_t ray = 0; ray < flight.rays; ray++)
        assert_true(flight.output[ray] > nearest[ray] || nearest[ray] == FAR_AWAY);
    free(nearest);
    clear_flight(&flight);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

static void expect_same(const char *what, const struct flight *flight, const float *expected)
{
    for (uint32_t plane = 0; plane < PROBE_OUTPUTS; plane++)
        for (uint32_t ray = 0; ray < flight->rays; ray++)
            if (memcmp(&flight->output[plane * flight->rays + ray],
                       &expected[plane * flight->rays + ray], sizeof(float)) != 0)
                fail_msg("%s: plane %u of ray %u differs", what, (unsigned)plane, (unsigned)ray);
}

static void compare_device(const char *name, unsigned width, const struct mesh *mesh,
                           struct flight *flight, const float *expected)
{
    static struct report report;
    struct device *device;
    struct probe_device probe;
    char what[160];
    sonject_context_params params;
    sonject_context_params_init(&params);
    params.device_name = name;
    assert_int_equal(device_open(&report, &params, &device), SONJECT_OK);
    probe_device_begin(&probe, &report, device, width, mesh);
    memset(flight->output, 0, PROBE_OUTPUTS * (size_t)flight->rays * sizeof *flight->output);
    probe_device_run(&probe, "nearest", flight->input, flight->output, flight->rays, 1);
    probe_device_run(&probe, "blocked", flight->input, flight->output, flight->rays, 1);
    probe_device_run(&probe, "surface", flight->input, flight->output, flight->rays, 1);
    snprintf(what, sizeof what, "%s at %u lanes", name, width);
    expect_same(what, flight, expected);
    probe_device_end(&probe);
    device_close(&device);
}

static void test_bits(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    char names[BENCH_DEVICES][128];
    const size_t devices = bench_devices(names);
    struct flight flight = make_flight(RAYS);
    float *expected = calloc(RAYS, PROBE_OUTPUTS * sizeof *expected);
    assert_non_null(expected);
    sample_ring(&sample, 200, 100);
    prepare(&sample, 0.4, &mesh);
    lay_mixed(&mesh, &flight);
    for (int question = MESH_NEAREST; question <= MESH_SURFACE; question++)
        mesh_native_one(&mesh, (enum mesh_question)question, flight.input, expected, flight.rays, 0,
                        flight.rays);
    ask(&mesh, &flight);
    expect_same("16 lanes of plain C", &flight, expected);
    for (size_t i = 0; i < devices; i++) {
        uint32_t widths[BENCH_WIDTHS];
        bench_device = names[i];
        const size_t count = bench_widths(widths);
        for (size_t w = 0; w < count; w++)
            compare_device(names[i], widths[w], &mesh, &flight, expected);
    }
    bench_device = NULL;
    free(expected);
    clear_flight(&flight);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* Every ray along an edge of a triangle, which it sees edge-on. */
static void lay_along_edges(const struct mesh *mesh, const struct flight *flight)
{
    for (uint32_t ray = 0; ray < flight->rays; ray++) {
        const size_t first = 3 * (ray / 3 % mesh->triangle_count);
        const float *a = &mesh->vertices[3 * (size_t)mesh->corners[first + ray % 3]];
        const float *b = &mesh->vertices[3 * (size_t)mesh->corners[first + (ray + 1) % 3]];
        double from[3], to[3];
        for (int axis = 0; axis < 3; axis++) {
            to[axis] = (double)b[axis];
            from[axis] = (double)a[axis] + 1e3 * ((double)a[axis] - (double)b[axis]);
        }
        set_ray_to(flight, ray, from, to, 1e6);
    }
}

/* The same rays in other places. */
static void expect_same_in_any_company(const struct mesh *mesh, struct flight *flight,
                                       struct flight *strewn)
{
    ask(mesh, flight);
    /* 7919 is prime and no factor of RAYS: each ray gets another place */
    for (uint32_t ray = 0; ray < RAYS; ray++)
        for (uint32_t plane = 0; plane < PROBE_INPUTS; plane++)
            strewn->input[plane * RAYS + (uint32_t)((uint64_t)ray * 7919 % RAYS)] =
                flight->input[plane * RAYS + ray];
    ask(mesh, strewn);
    for (uint32_t ray = 0; ray < RAYS; ray++)
        for (uint32_t plane = 0; plane < PROBE_OUTPUTS; plane++)
            assert_memory_equal(
                &strewn->output[plane * RAYS + (uint32_t)((uint64_t)ray * 7919 % RAYS)],
                &flight->output[plane * RAYS + ray], sizeof(float));
}

/* What a ray finds does not depend on the rays beside it. */
static void test_company(void **state)
{
    struct mesh_sample sample;
    struct mesh mesh;
    struct flight flight = make_flight(RAYS);
    struct flight strewn = make_flight(RAYS);
    sample_ring(&sample, 150, 80);
    prepare(&sample, 0.4, &mesh);
    lay_mixed(&mesh, &flight);
    expect_same_in_any_company(&mesh, &flight, &strewn);
    lay_along_edges(&mesh, &flight);
    expect_same_in_any_company(&mesh, &flight, &strewn);
    mesh_clear(&mesh);
    sample_clear(&sample);
    sample_litter(&sample, 30000);
    prepare(&sample, 0.0, &mesh);
    lay_along_edges(&mesh, &flight);
    expect_same_in_any_company(&mesh, &flight, &strewn);
    clear_flight(&flight);
    clear_flight(&strewn);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

TEST_PROGRAM(NULL, NULL, TEST(test_closed_meshes), TEST(test_strewn_triangles), TEST(test_no_leaks),
             TEST(test_sphere), TEST(test_terminator), TEST(test_shadows_of_facets),
             TEST(test_reach), TEST(test_bits), TEST(test_company))
