/* Glints of the shapes against closed forms of physical optics, sqrt(R1 R2)/2 above all. Levels are
 * systematic: 0.2 dB. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>
#include <stdlib.h>

#include "bench.h"

#define ROWS       201
#define COLUMNS    201
#define RANGE      50.0
#define LEVEL_DB   0.2
#define WAVELENGTH 0.015

static sonject_object_params *open_with(struct bench *bench, sonject_shape shape, double length,
                                        double width, double height, double diameter)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    sonject_object_params *object = bench_add(bench, shape, length, width, diameter);
    object->height_m = height;
    object->burial_m = -1.0;
    return object;
}

static double slant_range(const struct bench *bench)
{
    return placement_range(&bench->placements[0], &bench->tracer.view);
}

static double peak_of(struct bench *bench, double *range_m)
{
    struct echo_line line = bench_glint_line(bench, 0);
    const double peak = echo_line_peak(bench, &line, range_m);
    echo_line_clear(&line);
    return peak;
}

/* Turns the object's nose to the sonar, and then by `forward` up. */
static void face_sonar(struct bench *bench, sonject_object_params *object, double forward)
{
    object->heading_rad = -0.5 * PI;
    object->pitch_rad = 0.0;
    for (int i = 0; i < 50; i++) { /* turning moves the centre: its lowest point is held */
        bench_ready(bench);
        const double *centre = bench->placements[0].centre;
        object->pitch_rad = atan2(bench->tracer.view.altitude_m - centre[2], centre[1]) + forward;
    }
    bench_ready(bench);
}

/* Unit vector from the centre to the sonar abreast of it, in the object's own frame. */
static void sight_in_object(const struct bench *bench, double own[3])
{
    const struct placement *placement = &bench->placements[0];
    const double back[3] = {0.0, -placement->centre[1],
                            bench->tracer.view.altitude_m - placement->centre[2]};
    for (int axis = 0; axis < 3; axis++)
        own[axis] = (placement->axes[axis][1] * back[1] + placement->axes[axis][2] * back[2]) /
                    slant_range(bench);
}

/* Semi-axes a, b, c seen along n: the front is h = sqrt(a^2 nx^2 + b^2 ny^2 + c^2 nz^2) before the
 * centre, where sqrt(R1 R2) = abc/h^2. */
static void test_ellipsoid(void **unused)
{
    (void)unused;
    static const double poses[][3] = {
        {0.0, 0.0, 0.0}, {40.0, 0.0, 0.0}, {70.0, 25.0, 0.0}, {-100.0, -15.0, 60.0}};
    for (size_t i = 0; i < 4; i++) {
        struct bench bench;
        sonject_object_params *object =
            open_with(&bench, SONJECT_SHAPE_ELLIPSOID, 1.0, 0.7, 0.5, 0.0);
        object->heading_rad = poses[i][0] * PI / 180.0;
        object->pitch_rad = poses[i][1] * PI / 180.0;
        object->roll_rad = poses[i][2] * PI / 180.0;
        bench_ready(&bench);
        double n[3], range;
        sight_in_object(&bench, n);
        const double h = sqrt(pow(0.5 * n[0], 2.0) + pow(0.35 * n[1], 2.0) + pow(0.25 * n[2], 2.0));
        const double peak = peak_of(&bench, &range);
        print_message("heading %.0f, pitch %.0f, roll %.0f degrees\n", poses[i][0], poses[i][1],
                      poses[i][2]);
        expect_close("level re sqrt(R1 R2)/2, dB",
                     decibels_of_amplitude(peak / (0.5 * 0.5 * 0.35 * 0.25 / (h * h))), 0.0,
                     LEVEL_DB);
        /* to a bin; the front is hit a little before the plane through the centre */
        expect_close("range, m", range, slant_range(&bench) - h, 0.003);
        bench_close(&bench);
    }
}

/* A ring edge on shows its outer equator: R1 = R + b, R2 = b. */
static void test_torus_edge_on(void **unused)
{
    (void)unused;
    struct bench bench;
    sonject_object_params *object = open_with(&bench, SONJECT_SHAPE_TORUS, 0.0, 0.0, 0.3, 1.0);
    face_sonar(&bench, object, 0.0);
    double range;
    const double peak = peak_of(&bench, &range);
    expect_close("level re sqrt(b (R + b))/2, dB",
                 decibels_of_amplitude(peak / (0.5 * sqrt(0.15 * 0.5))), 0.0, LEVEL_DB);
    expect_close("range, m", range, slant_range(&bench) - 0.5, 0.002);
    bench_close(&bench);
}

/* Face on, a whole circle of the ring is equally near: rho = R. The front there is a parabola of
 * radius b across the ring, so the amplitude is 1/lambda 2 pi R sqrt(lambda b/2), less what the
 * wavefront's curvature in elevation takes: |mean over the circle of exp(ik (R sin)^2/r)|. */
static void test_torus_face_on(void **unused)
{
    (void)unused;
    struct bench bench;
    sonject_object_params *object = open_with(&bench, SONJECT_SHAPE_TORUS, 0.0, 0.0, 0.3, 1.0);
    face_sonar(&bench, object, -0.5 * PI);
    const double distance = slant_range(&bench) - 0.15;
    const double k = bench_wavenumber(&bench);
    double complex mean = 0.0;
    for (int i = 0; i < 3600; i++)
        mean += cexp(I * k * pow(0.35 * sin(2.0 * PI * i / 3600.0), 2.0) / distance) / 3600.0;
    const double closed = 2.0 * PI * 0.35 * sqrt(0.5 * WAVELENGTH * 0.15) / WAVELENGTH * cabs(mean);
    double range;
    const double peak = peak_of(&bench, &range);
    expect_close("level re the ring's, dB", decibels_of_amplitude(peak / closed), 0.0, LEVEL_DB);
    expect_close("range, m", range, distance, 0.003);
    bench_close(&bench);
}

/* What a body of revolution or a flat face does that is `depth` behind its front at (x, w) across
 * the sight: 1/lambda times the integral of exp(2ik depth + ik w^2/r) G(offset - depth), the
 * wavefront being curved in elevation alone. depth < 0: nothing is there. */
struct profile {
    double (*depth)(double x, double w, const double *sizes);
    const double *sizes;
    double half_side; /* of the square that holds it */
};

static double optics(const struct bench *bench, const struct profile *profile, double distance,
                     double offset)
{
    const double k = bench_wavenumber(bench);
    const double step = WAVELENGTH / 24.0;
    double complex sum = 0.0;
    for (double x = -profile->half_side + 0.5 * step; x < profile->half_side; x += step)
        for (double w = -profile->half_side + 0.5 * step; w < profile->half_side; w += step) {
            const double depth = profile->depth(x, w, profile->sizes);
            if (depth >= 0.0)
                sum += cexp(I * k * (2.0 * depth + w * w / distance)) * step * step *
                       range_response(&bench->tracer.response, offset - depth);
        }
    return cabs(sum) / WAVELENGTH;
}

static double level_at(struct bench *bench, double range)
{
    struct echo_line line = bench_glint_line(bench, 0);
    const struct complex_value value = echo_line_at(bench, &line, range);
    echo_line_clear(&line);
    return hypot(value.real_part, value.imaginary_part);
}

static double disc_depth(double x, double w, const double *sizes)
{
    return hypot(x, w) <= sizes[0] ? 0.0 : -1.0;
}

static double rectangle_depth(double x, double w, const double *sizes)
{
    return fabs(x) <= sizes[0] && fabs(w) <= sizes[1] ? 0.0 : -1.0;
}

static void expect_front(struct bench *bench, const char *what,
                         double (*depth)(double, double, const double *), const double *sizes,
                         double distance)
{
    const struct profile profile = {depth, sizes, 0.35};
    double range;
    const double peak = peak_of(bench, &range);
    expect_close(what, decibels_of_amplitude(peak / optics(bench, &profile, distance, 0.0)), 0.0,
                 LEVEL_DB);
    expect_close("range, m", range, distance, 0.002);
    bench_close(bench);
}

/* Flat faces square to the sight: of a disc, a box, a wedge's slope, and of a cut. */
static void test_flat_faces(void **unused)
{
    (void)unused;
    static const double radii[] = {0.05, 0.15, 0.3};
    struct bench bench;
    sonject_object_params *object;
    for (size_t i = 0; i < 3; i++) {
        object = open_with(&bench, SONJECT_SHAPE_DISC, 0.0, 0.0, 0.0, 2.0 * radii[i]);
        face_sonar(&bench, object, -0.5 * PI);
        if (i == 0) /* small: the closed form of a plane wave, (A/lambda)^2 */
            expect_close("small disc, dB re A/lambda",
                         decibels_of_amplitude(peak_of(&bench, NULL) /
                                               (PI * radii[0] * radii[0] / WAVELENGTH)),
                         0.0, LEVEL_DB);
        expect_front(&bench, "disc, dB re its own", disc_depth, &radii[i], slant_range(&bench));
    }
    static const double box[] = {0.2, 0.1};
    object = open_with(&bench, SONJECT_SHAPE_BOX, 0.6, 0.4, 0.2, 0.0);
    face_sonar(&bench, object, 0.0);
    expect_front(&bench, "box, dB re its own", rectangle_depth, box, slant_range(&bench) - 0.3);
    static const double slope[] = {0.15, 0.25};
    object = open_with(&bench, SONJECT_SHAPE_WEDGE, 0.4, 0.3, 0.3, 0.0);
    face_sonar(&bench, object, -atan2(0.4, 0.3));
    expect_front(&bench, "wedge, dB re its own", rectangle_depth, slope, slant_range(&bench));
    object = open_with(&bench, SONJECT_SHAPE_CYLINDER, 1.0, 0.0, 0.0, 0.3);
    object->cut_count = 1;
    object->cuts[0].distance_m = 0.1;
    face_sonar(&bench, object, 0.0);
    expect_front(&bench, "cut cylinder, dB re its own", disc_depth, &radii[1],
                 slant_range(&bench) - 0.1);
}

static double cone_depth(double x, double w, const double *sizes)
{
    const double rho = hypot(x, w);
    return rho <= sizes[0] ? rho * sizes[1] : -1.0;
}

/* Tip on, a cone shows its tip, lambda tan^2(alpha)/8 pi, and its rim, where its side ends
 * abruptly, a tan(alpha)/2. The side is flat enough for cells of lambda/8 to hold the rim's phase.
 */
static void test_cone_tip_on(void **unused)
{
    (void)unused;
    static const double sizes[] = {0.3, 1.0 / 3.0}; /* radius, height over radius */
    const struct profile profile = {cone_depth, sizes, 0.31};
    struct bench bench;
    sonject_object_params *object = open_with(&bench, SONJECT_SHAPE_CONE, 0.0, 0.0, 0.1, 0.6);
    face_sonar(&bench, object, -0.5 * PI);
    const double tip = slant_range(&bench) - 0.05;
    double range;
    const double peak = peak_of(&bench, &range);
    const double at_tip = level_at(&bench, tip);
    expect_close("rim's range, m", range, tip + 0.1, 0.003);
    const double u = 0.25 * PI * sizes[1];
    expect_close("rim, dB re its own",
                 decibels_of_amplitude(peak / optics(&bench, &profile, tip, range - tip)),
                 2.0 * decibels_of_amplitude(sin(u) / u), LEVEL_DB);
    expect_close("tip, dB re lambda tan^2(alpha)/8 pi",
                 decibels_of_amplitude(at_tip / (WAVELENGTH * 9.0 / (8.0 * PI))), 0.0, LEVEL_DB);
    expect_below("tip, dB re a tan(alpha)/2", decibels_of_amplitude(at_tip / 0.45), -30.0);
    bench_close(&bench);
}

/* A capsule is a cylinder with two half spheres, image for image. */
static void test_capsule_is_a_cylinder_with_round_ends(void **unused)
{
    (void)unused;
    struct echoes images[2];
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        sonject_object_params *object = open_with(
            &bench, i ? SONJECT_SHAPE_CYLINDER : SONJECT_SHAPE_CAPSULE, 1.4, 0.0, 0.0, 0.4);
        object->nose_end = object->tail_end = i ? SONJECT_END_SPHERICAL : SONJECT_END_FLAT;
        object->heading_rad = 0.6;
        object->pitch_rad = 0.1;
        object->burial_m = 0.1;
        object->material.lambert = 0.05;
        object->material.roughness_m = 1e-3;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &images[i]);
        bench_close(&bench);
    }
    double largest = 0.0;
    double off = 0.0;
    for (size_t i = 0; i < images[0].rows * images[0].columns; i++) {
        largest = fmax(largest, hypot(images[0].target_real[i], images[0].target_imaginary[i]));
        off = fmax(off, hypot(images[0].target_real[i] - images[1].target_real[i],
                              images[0].target_imaginary[i] - images[1].target_imaginary[i]));
    }
    assert_true(largest > 0.01);
    /* rounding of 2e-7 m turns phases by 1e-4, and moves some rays off the outline */
    expect_below("difference over the largest amplitude, dB", decibels_of_amplitude(off / largest),
                 -60.0);
    echoes_clear(&images[0]);
    echoes_clear(&images[1]);
}

/* Broadside, a tube shows what a solid cylinder does; along its axis it lets the sound through. */
static void test_open_tube(void **unused)
{
    (void)unused;
    double broadside[2], along[2];
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        sonject_object_params *object =
            open_with(&bench, SONJECT_SHAPE_CYLINDER, 1.0, 0.0, 0.0, 0.3);
        object->nose_end = object->tail_end = i ? SONJECT_END_OPEN : SONJECT_END_FLAT;
        bench_ready(&bench);
        broadside[i] = peak_of(&bench, NULL);
        face_sonar(&bench, object, 0.0);
        along[i] = peak_of(&bench, NULL);
        bench_close(&bench);
    }
    expect_close("broadside, dB re solid", decibels_of_amplitude(broadside[1] / broadside[0]), 0.0,
                 0.01);
    expect_below("end on, dB re solid", decibels_of_amplitude(along[1] / along[0]), -20.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ellipsoid),
        cmocka_unit_test(test_torus_edge_on),
        cmocka_unit_test(test_torus_face_on),
        cmocka_unit_test(test_flat_faces),
        cmocka_unit_test(test_cone_tip_on),
        cmocka_unit_test(test_capsule_is_a_cylinder_with_round_ends),
        cmocka_unit_test(test_open_tube),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
