/* The reference for several interactions, held to closed forms, to quadrature, and its two
   estimators to one another. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "reference_paths.h"

#define PI     3.14159265358979323846
#define ERRORS 4.0 /* standard errors */

static struct reference_energy energy, other_energy; /* too large for a stack */

static void trace(const struct reference_scene *scene, const struct reference_request *request,
                  struct reference_energy *result)
{
    assert_int_equal(reference_trace(scene, request, result), 0);
}

/* `rounding` is relative to the expected value. */
static void assert_value(const char *what, int order, double place, struct reference_value value,
                         double expected, double rounding)
{
    const double tolerance = ERRORS * value.error + rounding * fabs(expected);
    if (!(fabs(value.mean - expected) <= tolerance))
        fail_msg("%s, order %d, %g: %.9g, not %.9g +- %.2g", what, order, place, value.mean,
                 expected, tolerance);
}

static double relative_error(struct reference_value value)
{
    return value.mean > 0.0 ? value.error / value.mean : INFINITY;
}

/* ---- Order 1 ---- */

/* Integral of mu sin^2(grazing) over width x ground range: mu width h (grazing angles' span), as
   dy = r dr / y and sin(grazing) = h / r. */
static void seabed_has_lamberts_level(void **state)
{
    (void)state;
    const struct reference_scene scene = {.seabed_lambert = 0.002};
    const struct reference_request request = {.estimator = REFERENCE_CONNECT,
                                              .limit = 3,
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
    trace(&scene, &request, &energy);
    for (int bin = 0; bin < request.bins; bin++) {
        const double near = request.first_range + bin * request.bin_width;
        const double angles = asin(10.0 / near) - asin(10.0 / (near + request.bin_width));
        const struct reference_value value = energy.bins[REFERENCE_SEABED_SEABED][0][bin];
        const double rays = (double)(request.rays / REFERENCE_BATCHES) * angles /
                            (request.last_elevation - request.first_elevation);
        /* Strata are all in or all out, but for two; what these two miss by has at most the error
           sqrt(2 / 4 / 32) = 1/8 of a ray, unseen if batches happen to be alike. */
        assert_value("seabed", 1, near, value, 0.002 * 3.0 * 10.0 * angles, ERRORS / 8.0 / rays);
        assert_true(relative_error(value) < 2e-3);
        assert_true(energy.bins[REFERENCE_ALL_ENDS][0][bin].mean == value.mean);
        assert_true(energy.bins[REFERENCE_ALL_ENDS][1][bin].mean == 0.0); /* it is plane */
    }
}

/* ---- Closed sphere ---- */

static struct reference_request sphere_request(void)
{
    const struct reference_request request = {.estimator = REFERENCE_CONNECT,
                                              .limit = 6,
                                              .rays = 1000000,
                                              .seed = 2,
                                              .altitude = 20.0,
                                              .first_x = -1e-6,
                                              .last_x = 1e-6,
                                              .first_elevation = -1.0,
                                              .last_elevation = 2.0,
                                              .pressure = true,
                                              .central = {0.0, 0.8, -0.6},
                                              .bins = 1,
                                              .first_range = 0.0,
                                              .bin_width = 1.0};
    return request;
}

/* Whatever its size: the sonar at its centre. One-way spreading once to the sonar and once from the
   source: mu x (dA / r^2) / r^2. */
static void closed_sphere_keeps_albedo(void **state)
{
    (void)state;
    const double lambert[2] = {0.25, 1.0 / PI};
    for (int i = 0; i < 2; i++) {
        struct reference_scene scene = {.seabed_lambert = 0.1};
        reference_add_object(&scene, REFERENCE_SPHERE, 5.0, lambert[i])->centre.z = 20.0;
        struct reference_request request = sphere_request();
        request.rays = 200000;
        trace(&scene, &request, &energy);
        const double first = 2e-6 * 3.0 / 5.0 * lambert[i] / 25.0;
        for (int order = 1; order <= 6; order++) {
            const struct reference_value value = energy.all_ranges[REFERENCE_ALL_ENDS][order - 1];
            /* 1e-6: the track's length over the radius, and the lift off surfaces */
            assert_value("sphere", order, lambert[i], value,
                         first * pow(PI * lambert[i], order - 1), 1e-6);
            assert_true(value.mean == energy.all_ranges[REFERENCE_OBJECT_OBJECT][order - 1].mean);
        }
    }
}

/* Seen from any point of a square inside, all surface scatters alike after the first hit, whose
   light falls alike everywhere: orders from 2 on have the point's closed form. Here directions and
   their weights matter, unlike at the centre. */
static void assert_square_inside_sphere(enum reference_estimator estimator, uint64_t rays,
                                        double precision)
{
    struct reference_scene scene = {.seabed_lambert = 0.1};
    const double lambert = 0.25;
    reference_add_object(&scene, REFERENCE_SPHERE, 5.0, lambert)->centre.z = 20.0;
    struct reference_request request = sphere_request();
    request.estimator = estimator;
    request.rays = rays;
    request.source_side = 5.0;
    trace(&scene, &request, &energy);
    const double first = 2e-6 * 3.0 / 5.0 * lambert / 25.0;
    for (int order = 2; order <= 6; order++) {
        const struct reference_value value = energy.all_ranges[REFERENCE_ALL_ENDS][order - 1];
        const double expected = first * pow(PI * lambert, order - 1);
        print_message("order %d over closed form: %.5f +- %.5f\n", order, value.mean / expected,
                      value.error / expected);
        assert_value("square inside sphere", order, request.source_side, value, expected, 1e-6);
        assert_true(relative_error(value) < precision);
    }
}

static void connected_square_keeps_albedo(void **state)
{
    (void)state;
    assert_square_inside_sphere(REFERENCE_CONNECT, 1500000, 5e-4);
}

static void met_square_keeps_albedo(void **state)
{
    (void)state;
    assert_square_inside_sphere(REFERENCE_BRUTE_FORCE, 2000000, 1e-2);
}

/* ---- Order 2, against quadrature ---- */

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
static void second_order_agrees_with_quadrature(void **state)
{
    (void)state;
    struct reference_scene scene = {.seabed_lambert = 0.1};
    struct reference_object *sphere =
        reference_add_object(&scene, REFERENCE_SPHERE, SMALL_RADIUS, 0.2);
    sphere->centre = reference_vector(0.0, 36.0, SMALL_HEIGHT);
    const double altitude = 30.0, range = hypot(36.0, altitude - SMALL_HEIGHT);
    const double middle = atan2(altitude - SMALL_HEIGHT, 36.0);
    const double half = 1.01 * asin(SMALL_RADIUS / range); /* all of the sphere, and a rim */
    const struct reference_request request = {.estimator = REFERENCE_CONNECT,
                                              .limit = 2,
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
    trace(&scene, &request, &energy);
    double expected[SMALL_BINS] = {0.0};
    small_sphere_quadrature(altitude, 0.2, 0.1, sphere->centre, expected);
    for (int bin = 0; bin < SMALL_BINS; bin++) {
        const struct reference_value value = energy.bins[REFERENCE_OBJECT_SEABED][1][bin];
        const double near = SMALL_NEAR + bin * SMALL_WIDTH;
        print_message("%.1f m, order 2 over quadrature: %.4f +- %.4f\n", near,
                      value.mean / expected[bin], value.error / expected[bin]);
        /* 0.1 %: the rule's steps, doubled, change less; the sphere's radius is 1e-4 of its height
         */
        assert_value("small sphere", 2, near, value, expected[bin], 0.001);
        assert_true(relative_error(value) < 0.02);
    }
}

/* A path and its reverse bring the same energy, were it not for the sonar's way along the track;
   that changes 1e-4 where a path's hits are 1 m apart and 100 m away. The range bins bound the
   seabed that takes part, so the fan can hold all of it. */
static void reverse_paths_are_equal(void **state)
{
    (void)state;
    struct reference_scene scene = {.seabed_lambert = 0.3};
    const double altitude = 70.0, ground = 70.0;
    struct reference_object *sphere = reference_add_object(&scene, REFERENCE_SPHERE, 0.5, 0.2);
    sphere->centre = reference_vector(0.2, ground, 0.6);
    const double range = hypot(ground, altitude - 0.6);
    /* Half a path within the bins exceeds the range of the sphere's centre by less than 0.75 m, and
       by way of the centre it is up to its radius longer: 2.5 m for the whole path. So the seabed
       is less than 2.5 m aside, 8.6 m nearer (1 - cos 45 deg a metre) and 1.5 m farther (1 + cos 45
       deg); the fan holds a little more. */
    const struct reference_request request = {.estimator = REFERENCE_CONNECT,
                                              .limit = 2,
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
    trace(&scene, &request, &energy);
    for (int bin = 0; bin < request.bins; bin++) {
        const struct reference_value there = energy.bins[REFERENCE_SEABED_OBJECT][1][bin];
        const struct reference_value back = energy.bins[REFERENCE_OBJECT_SEABED][1][bin];
        const struct reference_value total = energy.bins[REFERENCE_ALL_ENDS][1][bin];
        const struct reference_value difference = {there.mean - back.mean,
                                                   hypot(there.error, back.error)};
        print_message("bin %d, order 2, seabed first over object first: %.4f +- %.4f\n", bin,
                      there.mean / back.mean, difference.error / back.mean);
        assert_true(relative_error(there) < 0.04 && relative_error(back) < 0.04);
        if (fabs(difference.mean) > ERRORS * difference.error + 1e-3 * back.mean)
            fail_msg("bin %d: %g there, %g back", bin, there.mean, back.mean);
        assert_true(fabs(total.mean - there.mean - back.mean) <= 1e-12 * total.mean);
    }
}

/* ---- The two estimators ---- */

/* The paper's figure 7, its grazing angle too, but half as far, so that rays meet the source more
   often, and brighter, so that three orders are heard. */
static struct reference_scene capsule_scene(void)
{
    struct reference_scene scene = {.seabed_lambert = 0.2};
    struct reference_object *capsule = reference_add_object(&scene, REFERENCE_CAPSULE, 0.15, 0.25);
    capsule->length = 2.3;
    capsule->centre = reference_vector(0.0, sqrt(600.0), 0.05); /* buried 0.1 m */
    reference_turn(capsule, 35.0 * PI / 180.0, 0.0);
    return scene;
}

/* Bins in which both know their energy, and its error, from enough paths. */
static int assert_estimators_agree(const struct reference_scene *scene,
                                   struct reference_request *request)
{
    request->estimator = REFERENCE_CONNECT;
    trace(scene, request, &energy);
    request->estimator = REFERENCE_BRUTE_FORCE;
    request->seed++;
    request->rays *= 4;
    trace(scene, request, &other_energy);
    int compared = 0;
    for (int order = 1; order <= request->limit; order++) {
        double square = 0.0;
        int count = 0;
        for (int bin = 0; bin < request->bins; bin++) {
            const struct reference_value connected =
                energy.bins[REFERENCE_ALL_ENDS][order - 1][bin];
            const struct reference_value met =
                other_energy.bins[REFERENCE_ALL_ENDS][order - 1][bin];
            if (relative_error(connected) > 0.2 || relative_error(met) > 0.2)
                continue;
            const double error = hypot(connected.error, met.error);
            const double deviation = (met.mean - connected.mean) / error;
            square += deviation * deviation;
            count++;
            if (fabs(deviation) > ERRORS)
                fail_msg("order %d, bin %d: %g connected, %g met, +- %g", order, bin,
                         connected.mean, met.mean, error);
        }
        const struct reference_value all = energy.all_ranges[REFERENCE_ALL_ENDS][order - 1];
        const struct reference_value all_met =
            other_energy.all_ranges[REFERENCE_ALL_ENDS][order - 1];
        const double error = hypot(all.error, all_met.error);
        print_message("order %d: %d bins, deviations' rms %.2f errors; in all %.4f +- %.4f\n",
                      order, count, sqrt(square / (count > 0 ? count : 1)), all_met.mean / all.mean,
                      error / all.mean);
        assert_true(fabs(all_met.mean - all.mean) <= ERRORS * error);
        assert_true(count > 0);
        compared += count;
    }
    return compared;
}

static void connecting_and_meeting_agree(void **state)
{
    (void)state;
    const struct reference_scene scene = capsule_scene();
    struct reference_request request = {.limit = 3,
                                        .rays = 3000000,
                                        .seed = 5,
                                        .altitude = 5.0,
                                        .first_x = -1.3,
                                        .last_x = 1.3,
                                        .first_elevation = asin(5.0 / 26.5),
                                        .last_elevation = asin(5.0 / 23.5),
                                        .source_side = 8.0,
                                        .central = {0.0, sqrt(0.96), -0.2},
                                        .pressure = true,
                                        .bins = 16,
                                        .first_range = 23.5,
                                        .bin_width = 0.25};
    assert_true(assert_estimators_agree(&scene, &request) >= 28);
}

/* Every shape, of its own albedo, hides and lights the others; close by, so that little is rare. */
static void estimators_agree_among_objects(void **state)
{
    (void)state;
    struct reference_scene scene = {.seabed_lambert = 0.25};
    reference_add_object(&scene, REFERENCE_SPHERE, 0.6, 0.3)->centre =
        reference_vector(-1.0, 10.0, 0.5);
    struct reference_object *cylinder = reference_add_object(&scene, REFERENCE_CYLINDER, 0.4, 0.15);
    cylinder->length = 1.8;
    cylinder->centre = reference_vector(0.6, 10.4, 0.7);
    reference_turn(cylinder, 0.5, 0.3);
    struct reference_object *wall = reference_add_object(&scene, REFERENCE_RECTANGLE, 0.0, 0.2);
    wall->length = 3.0;
    wall->width = 4.0;
    wall->centre = reference_vector(0.0, 11.5, 0.7);
    reference_turn(wall, PI / 2.0, 1.2);
    struct reference_object *capsule = reference_add_object(&scene, REFERENCE_CAPSULE, 0.2, 0.3);
    capsule->length = 1.5;
    capsule->centre = reference_vector(0.2, 9.2, 0.3);
    reference_turn(capsule, -0.7, 0.2);
    struct reference_request request = {.limit = 4,
                                        .rays = 300000,
                                        .seed = 7,
                                        .altitude = 8.0,
                                        .first_x = -1.8,
                                        .last_x = 1.8,
                                        .first_elevation = 0.4,
                                        .last_elevation = 0.85,
                                        .source_side = 4.0,
                                        .central = {0.0, 0.8, -0.6},
                                        .pressure = true,
                                        .bins = 20,
                                        .first_range = 11.0,
                                        .bin_width = 0.25};
    assert_true(assert_estimators_agree(&scene, &request) >= 40);
}

/* ---- Requests ---- */

static void unsound_requests_are_refused(void **state)
{
    (void)state;
    const struct reference_scene scene = {.seabed_lambert = 0.25};
    const struct reference_request sound = sphere_request();
    struct reference_request request = sound;
    request.limit = REFERENCE_ORDERS + 1;
    assert_int_equal(reference_trace(&scene, &request, &energy), -1);
    request = sound;
    request.bins = REFERENCE_BINS + 1;
    assert_int_equal(reference_trace(&scene, &request, &energy), -1);
    request = sound;
    request.rays = REFERENCE_BATCHES - 1;
    assert_int_equal(reference_trace(&scene, &request, &energy), -1);
    request = sound;
    request.estimator = REFERENCE_BRUTE_FORCE; /* no ray meets a point */
    assert_int_equal(reference_trace(&scene, &request, &energy), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seabed_has_lamberts_level),
        cmocka_unit_test(closed_sphere_keeps_albedo),
        cmocka_unit_test(connected_square_keeps_albedo),
        cmocka_unit_test(met_square_keeps_albedo),
        cmocka_unit_test(second_order_agrees_with_quadrature),
        cmocka_unit_test(reverse_paths_are_equal),
        cmocka_unit_test(connecting_and_meeting_agree),
        cmocka_unit_test(estimators_agree_among_objects),
        cmocka_unit_test(unsound_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
