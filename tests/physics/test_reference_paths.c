/* The reference for several interactions (reference_paths.h), which others are held to: its
 * surfaces against marching along the ray by the distance to them, its energies against closed
 * forms and quadrature. */
#include "reference_paths.h"
#include "sea.h"

static struct reference_energy energy; /* too large for a stack */

/* ---- surfaces ---- */

/* From a point outside to an object, in its own axes. */
static double distance_to(const struct reference_object *object, struct reference_vector p)
{
    const double half = 0.5 * object->length, level = hypot(p.y, p.z);
    switch (object->shape) {
    case REFERENCE_SPHERE:
        return hypot(level, p.x) - object->radius;
    case REFERENCE_CAPSULE:
        return hypot(level, fmax(0.0, fabs(p.x) - half + object->radius)) - object->radius;
    case REFERENCE_CYLINDER: {
        const double aside = level - object->radius, beyond = fabs(p.x) - half;
        if (aside <= 0.0 || beyond <= 0.0)
            return fmax(aside, beyond);
        return hypot(aside, beyond);
    }
    }
    return NAN;
}

static double distance_in_scene(const struct reference_object *object, struct reference_vector p)
{
    const struct reference_vector from = reference_sum(p, -1.0, object->centre);
    return distance_to(object, reference_vector(reference_dot(from, object->axes[0]),
                                                reference_dot(from, object->axes[1]),
                                                reference_dot(from, object->axes[2])));
}

/* INFINITY for a miss; sets *nearest to the least distance passed. */
static double march(const struct reference_object *object, struct reference_vector origin,
                    struct reference_vector direction, double *nearest)
{
    double along = 0.0;
    *nearest = INFINITY;
    for (int i = 0; i < 20000 && along < 30.0; i++) {
        const double gap = distance_in_scene(object, reference_sum(origin, along, direction));
        *nearest = fmin(*nearest, gap);
        if (gap < 1e-11)
            return along;
        along += gap;
    }
    return INFINITY;
}

/* The normal must be the way in which the distance grows; differences over 1 um are good to 1e-5
   away from edges, where the distance's gradient jumps. */
static void assert_normal(const struct reference_object *object, const struct reference_hit *hit)
{
    const struct reference_vector at = reference_sum(hit->point, 1e-5, hit->normal);
    const double step = 1e-6, *normal = &hit->normal.x;
    const struct reference_vector axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int i = 0; i < 3; i++) {
        const double slope = (distance_in_scene(object, reference_sum(at, step, axes[i])) -
                              distance_in_scene(object, reference_sum(at, -step, axes[i]))) /
                             (2.0 * step);
        assert_true(fabs(slope - normal[i]) < 1e-4);
    }
}

/* The part of n times an irrational number beyond its whole part: spreads evenly over 0 .. 1. */
static double spread(int n, double irrational)
{
    return fmod(n * irrational, 1.0);
}

/* A ray from 6 m away, from anywhere, to somewhere about the object. */
static struct reference_vector ray_about(const struct reference_object *object, int n,
                                         struct reference_vector *direction)
{
    const double azimuth = spread(n, 0.6180339887498949) * 2.0 * PI;
    const double z = 2.0 * spread(n, 0.7548776662466927) - 1.0, level = sqrt(1.0 - z * z);
    const struct reference_vector way = {level * cos(azimuth), level * sin(azimuth), z};
    const struct reference_vector aside = {spread(n, 0.8191725133961645) - 0.5,
                                           spread(n, 0.6710436067037893) - 0.5,
                                           spread(n, 0.5497004779019703) - 0.5};
    const struct reference_vector origin = reference_sum(object->centre, 6.0, way);
    const struct reference_vector aim = reference_sum(object->centre, 1.8, aside);
    *direction = reference_unit(reference_sum(aim, -1.0, origin));
    return origin;
}

/* Returns whether the ray meets the object. */
static bool assert_ray(const struct reference_scene *scene, int n)
{
    const struct reference_object *object = &scene->objects[0];
    struct reference_vector direction;
    const struct reference_vector origin = ray_about(object, n, &direction);
    double nearest;
    const double expected = march(object, origin, direction, &nearest);
    struct reference_hit hit;
    const bool met = reference_nearest(scene, origin, direction, &hit) && hit.on_object;
    if (isinf(expected)) {
        assert_true(!met || nearest < 1e-6);
        return false;
    }
    assert_true(met);
    assert_true(fabs(hit.distance - expected) < 1e-6); /* marching stalls when grazing */
    assert_true(reference_dot(hit.normal, direction) <= 0.0);
    assert_normal(object, &hit);
    const struct reference_vector there = reference_sum(origin, hit.distance, direction);
    assert_int_equal(reference_blocked(scene, origin, reference_sum(there, 1e-6, direction)), 1);
    assert_int_equal(reference_blocked(scene, origin, reference_sum(there, -1e-6, direction)), 0);
    return true;
}

static void rays_meet_surfaces(void)
{
    for (int shape = REFERENCE_SPHERE; shape <= REFERENCE_CYLINDER; shape++) {
        struct reference_scene scene = {.seabed_lambert = 0.1};
        struct reference_object *object =
            reference_add_object(&scene, (enum reference_shape)shape, 0.4, 0.1);
        object->centre = reference_vector(3.0, -2.0, 20.0);
        object->length = 2.3;
        reference_turn(object, 0.6, 0.4);
        int hits = 0;
        for (int n = 0; n < 4000; n++)
            hits += assert_ray(&scene, n) ? 1 : 0;
        assert_true(hits > 500 && hits < 3500);
    }
}

/* From inside, the surface faces the ray too. */
static void inner_surfaces_are_met(void)
{
    for (int shape = REFERENCE_SPHERE; shape <= REFERENCE_CYLINDER; shape++) {
        struct reference_scene scene = {.seabed_lambert = 0.1};
        struct reference_object *object =
            reference_add_object(&scene, (enum reference_shape)shape, 0.5, 0.1);
        object->centre = reference_vector(0.0, 0.0, 5.0);
        object->length = 2.0;
        const struct reference_vector inside = {0.1, 0.0, 5.0}, up = {0.0, 0.0, 1.0},
                                      along = {1.0, 0.0, 0.0};
        struct reference_hit hit;
        assert_true(reference_nearest(&scene, inside, up, &hit) && hit.on_object);
        assert_true(hit.normal.z < 0.0);
        const double height = shape == REFERENCE_SPHERE ? sqrt(0.24) : 0.5;
        assert_true(fabs(hit.distance - height) < 1e-12);
        assert_true(reference_nearest(&scene, inside, along, &hit) && hit.on_object);
        assert_true(fabs(hit.normal.x + 1.0) < 1e-12);
        const double reach = shape == REFERENCE_SPHERE ? 0.4 : 0.9;
        assert_true(fabs(hit.distance - reach) < 1e-12);
        /* What starts on it goes on to the other side, not to itself. */
        assert_true(reference_nearest(&scene, hit.point, hit.normal, &hit));
        const double across = shape == REFERENCE_SPHERE ? 1.0 : 2.0;
        assert_true(fabs(hit.distance - across) < 1e-8);
    }
}

/* ---- energies ---- */

/* Integral of mu sin^2(grazing) over width x ground range: mu width h (grazing angles' span), as
   dy = r dr / y and sin(grazing) = h / r. */
static void seabed_has_lamberts_level(void)
{
    const struct reference_scene scene = {.seabed_lambert = 0.002};
    const struct reference_request request = {.limit = 3,
                                              .rays = 4000000,
                                              .seed = 1,
                                              .altitude = 10.0,
                                              .first_x = -1.0,
                                              .last_x = 2.0,
                                              .first_elevation = asin(10.0 / 65.0),
                                              .last_elevation = asin(10.0 / 11.0),
                                              .bins = 100,
                                              .first_range = 12.0,
                                              .bin_width = 0.5};
    reference_trace(&scene, &request, &energy);
    for (int bin = 0; bin < request.bins; bin++) {
        const double near = request.first_range + bin * request.bin_width;
        const double angles = asin(10.0 / near) - asin(10.0 / (near + request.bin_width));
        const struct estimate value = energy.bins[REFERENCE_SEABED_SEABED][0][bin];
        const double rays = (double)(request.rays / REFERENCE_BATCHES) * angles /
                            (request.last_elevation - request.first_elevation);
        /* Strata are all in or all out, but for two; what these two miss by has at most the error
           sqrt(2 / 4 / 32) = 1/8 of a ray, unseen if batches happen to be alike. */
        expect_estimate("seabed", value, 0.002 * 3.0 * 10.0 * angles,
                        4.0 / 8.0 / rays * 0.002 * 3.0 * 10.0 * angles);
        assert_true(value.error < 2e-3 * value.mean);
        assert_true(energy.bins[REFERENCE_SEABED_SEABED][1][bin].mean == 0.0); /* it is plane */
    }
}

/* Whatever its size: the sonar at its centre. One-way spreading once to the sonar and once from the
   source: mu x (dA / r^2) / r^2. */
static void a_closed_sphere_keeps_its_albedo(void)
{
    const double lambert[2] = {0.25, 1.0 / PI};
    for (int i = 0; i < 2; i++) {
        struct reference_scene scene = {.seabed_lambert = 0.1};
        reference_add_object(&scene, REFERENCE_SPHERE, 5.0, lambert[i])->centre.z = 20.0;
        const struct reference_request request = {.limit = 6,
                                                  .rays = 200000,
                                                  .seed = 2,
                                                  .altitude = 20.0,
                                                  .first_x = -1e-6,
                                                  .last_x = 1e-6,
                                                  .first_elevation = -1.0,
                                                  .last_elevation = 2.0,
                                                  .pressure = true,
                                                  .bins = 1,
                                                  .bin_width = 1.0};
        reference_trace(&scene, &request, &energy);
        for (int order = 1; order <= 6; order++)
            /* 1e-6: the track's length over the radius, and the lift off surfaces */
            expect_estimate("sphere", energy.all_ranges[REFERENCE_OBJECT_OBJECT][order - 1],
                            2e-6 * 3.0 / 5.0 * lambert[i] / 25.0 * pow(PI * lambert[i], order - 1),
                            1e-6 * 2e-6 * 3.0 / 5.0 * lambert[i] / 25.0 *
                                pow(PI * lambert[i], order - 1));
    }
}

/* Cross-section per steradian of a Lambert sphere, integral of cos cos over what both see, for the
   angle between the ways to source and receiver. */
static double sphere_phase(double cosine)
{
    const double angle = acos(fmax(-1.0, fmin(1.0, cosine)));
    return 2.0 / 3.0 * (sin(angle) + (PI - angle) * cosine);
}

#define SMALL_RADIUS 0.0002
#define SMALL_HEIGHT 2.0
#define SMALL_BINS   10
#define SMALL_NEAR   47.0 /* the mirror image in the seabed is at 46.9 m */
#define SMALL_WIDTH  0.5

/* Path sonar, sphere, seabed, sonar in target-strength normalisation, by range bin; polar midpoint
   rule about the sphere's foot on the seabed. */
static void small_sphere_quadrature(double altitude, double lambert, double seabed_lambert,
                                    struct reference_vector sphere, double bins[SMALL_BINS])
{
    const struct reference_vector sonar = {0.0, 0.0, altitude};
    const struct reference_vector to_sonar = reference_sum(sonar, -1.0, sphere);
    const double r1 = sqrt(reference_dot(to_sonar, to_sonar));
    const int rings = 3000, sectors = 720;
    const double farthest = 60.0;
    for (int i = 0; i < rings; i++) {
        const double s = (i + 0.5) / rings, radius = farthest * s * s; /* denser near the foot */
        const double area = radius * 2.0 * farthest * s / rings * 2.0 * PI / sectors;
        for (int j = 0; j < sectors; j++) {
            const double azimuth = 2.0 * PI * (j + 0.5) / sectors;
            const struct reference_vector at = {sphere.x + radius * cos(azimuth),
                                                sphere.y + radius * sin(azimuth), 0.0};
            const struct reference_vector leg = reference_sum(at, -1.0, sphere);
            const struct reference_vector back = reference_sum(sonar, -1.0, at);
            const double d = sqrt(reference_dot(leg, leg)), r2 = sqrt(reference_dot(back, back));
            const double range = 0.5 * (r1 + d + r2);
            const double bin = floor((range - SMALL_NEAR) / SMALL_WIDTH);
            if (!(bin >= 0.0 && bin < SMALL_BINS))
                continue;
            const double phase = sphere_phase(reference_dot(leg, to_sonar) / (d * r1));
            bins[(int)bin] += lambert * SMALL_RADIUS * SMALL_RADIUS * phase / (r1 * r1) *
                              (sphere.z / d) / (d * d) * area * seabed_lambert * (altitude / r2) /
                              (r2 * r2) * pow(range, 4.0);
        }
    }
}

/* A small sphere well above the seabed is a point scatterer. */
static void second_order_agrees_with_quadrature(void)
{
    struct reference_scene scene = {.seabed_lambert = 0.1};
    struct reference_object *sphere =
        reference_add_object(&scene, REFERENCE_SPHERE, SMALL_RADIUS, 0.2);
    sphere->centre = reference_vector(0.0, 36.0, SMALL_HEIGHT);
    const double altitude = 30.0, range = hypot(36.0, altitude - SMALL_HEIGHT);
    const double middle = atan2(altitude - SMALL_HEIGHT, 36.0);
    const double half = 1.01 * asin(SMALL_RADIUS / range); /* all of the sphere, and a rim */
    const struct reference_request request = {.limit = 2,
                                              .rays = 2000000,
                                              .seed = 3,
                                              .altitude = altitude,
                                              .first_x = -1.01 * SMALL_RADIUS,
                                              .last_x = 1.01 * SMALL_RADIUS,
                                              .first_elevation = middle - half,
                                              .last_elevation = middle + half,
                                              .bins = SMALL_BINS,
                                              .first_range = SMALL_NEAR,
                                              .bin_width = SMALL_WIDTH};
    reference_trace(&scene, &request, &energy);
    double expected[SMALL_BINS] = {0.0};
    small_sphere_quadrature(altitude, 0.2, 0.1, sphere->centre, expected);
    for (int bin = 0; bin < SMALL_BINS; bin++) {
        const struct estimate value = energy.bins[REFERENCE_OBJECT_SEABED][1][bin];
        const double near = SMALL_NEAR + bin * SMALL_WIDTH;
        print_message("%.1f m, order 2 over quadrature: %.4f +- %.4f\n", near,
                      value.mean / expected[bin], value.error / expected[bin]);
        /* 0.1 %: the rule's steps, doubled, change less; the sphere's radius is 1e-4 of its height
         */
        expect_estimate("small sphere", value, expected[bin], 0.001 * expected[bin]);
        assert_true(value.error < 0.02 * value.mean);
    }
}

/* A path and its reverse bring the same energy, were it not for the sonar's way along the track;
   that changes 1e-4 where a path's hits are 1 m apart and 100 m away. The range bins bound the
   seabed that takes part, so the fan can hold all of it. */
static void reverse_paths_are_equal(void)
{
    struct reference_scene scene = {.seabed_lambert = 0.3};
    const double altitude = 70.0, ground = 70.0;
    struct reference_object *sphere = reference_add_object(&scene, REFERENCE_SPHERE, 0.5, 0.2);
    sphere->centre = reference_vector(0.2, ground, 0.6);
    const double range = hypot(ground, altitude - 0.6);
    /* Half a path within the bins exceeds the range of the sphere's centre by less than 0.75 m, and
       by way of the centre it is up to its radius longer: 2.5 m for the whole path. So the seabed
       is less than 2.5 m aside, 8.6 m nearer (1 - cos 45 deg a metre) and 1.5 m farther (1 + cos 45
       deg); the fan holds a little more. */
    const struct reference_request request = {.limit = 2,
                                              .rays = 5000000,
                                              .seed = 4,
                                              .altitude = altitude,
                                              .first_x = -2.8,
                                              .last_x = 3.2,
                                              .first_elevation = atan(altitude / (ground + 1.8)),
                                              .last_elevation = atan(altitude / (ground - 10.3)),
                                              .bins = 4,
                                              .first_range = range - 0.05,
                                              .bin_width = 0.2};
    reference_trace(&scene, &request, &energy);
    for (int bin = 0; bin < request.bins; bin++) {
        const struct estimate there = energy.bins[REFERENCE_SEABED_OBJECT][1][bin];
        const struct estimate back = energy.bins[REFERENCE_OBJECT_SEABED][1][bin];
        const struct estimate difference = {there.mean - back.mean, hypot(there.error, back.error)};
        print_message("bin %d, order 2, seabed first over object first: %.4f +- %.4f\n", bin,
                      there.mean / back.mean, difference.error / back.mean);
        assert_true(there.error < 0.04 * there.mean && back.error < 0.04 * back.mean);
        if (fabs(difference.mean) > 4.0 * difference.error + 1e-3 * back.mean)
            fail_msg("bin %d: %g there, %g back", bin, there.mean, back.mean);
    }
}

CLAIMS(CLAIM(rays_meet_surfaces), CLAIM(inner_surfaces_are_met), CLAIM(seabed_has_lamberts_level),
       CLAIM(a_closed_sphere_keeps_its_albedo), CLAIM(second_order_agrees_with_quadrature),
       CLAIM(reverse_paths_are_equal))
