/* The reference for several interactions (reference_paths.h), which others are held to: its
 * energies against closed forms and quadrature. */
#include "reference_paths.h"
#include "sea.h"

static struct reference_energy energy; /* too large for a stack */

/* Integral of mu sin^2(grazing) over width x ground range: mu width h (grazing angles' span), as
   dy = r dr / y and sin(grazing) = h / r. */
CLAIM(seabed_has_lamberts_level)
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
CLAIM(a_closed_sphere_keeps_its_albedo)
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
CLAIM(second_order_agrees_with_quadrature)
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
