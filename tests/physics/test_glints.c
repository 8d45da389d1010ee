/* Glints against the closed forms of physical optics. Levels are systematic: 0.2 dB. */
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

static void open_at(struct bench *bench, double range_m)
{
    bench_open(bench, ROWS, COLUMNS, range_m);
}

static double slant_range(const struct bench *bench)
{
    return placement_range(&bench->placements[0], &bench->tracer.view);
}

/* The largest amplitude of the first object's glints without W. Objects hang over the seabed:
 * burial counts from the lowest point. */
static double glint_peak(struct bench *bench, double *range_m)
{
    bench_ready(bench);
    struct echo_line line = bench_glint_line(bench, 0);
    const double peak = echo_line_peak(bench, &line, range_m);
    echo_line_clear(&line);
    return peak;
}

/* The brightest pixel of the formed image, and where it is. */
struct pixel {
    double amplitude;
    size_t row, column;
};

static struct pixel brightest_pixel(struct bench *bench, struct echoes *echoes)
{
    struct pixel brightest = {0.0, 0, 0};
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, echoes);
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++) {
        const double amplitude = hypot(echoes->target_real[i], echoes->target_imaginary[i]);
        if (amplitude > brightest.amplitude) {
            brightest.amplitude = amplitude;
            brightest.row = i / echoes->columns;
            brightest.column = i % echoes->columns;
        }
    }
    return brightest;
}

/* G at the middle of the column nearest to a range: a glint rarely falls on one. */
static double pulse_at_nearest_column(const struct bench *bench, double range_m)
{
    const double column = view_column_of_range(&bench->tracer.view, range_m);
    return range_response(&bench->tracer.response,
                          (column - floor(column + 0.5)) * bench->tracer.view.column_spacing_m);
}

/* Rigid sphere, all sub-strips together: a/2, or with the wavefront's own curvature in elevation
 * (the fan is a line of circular fans) a/2 / sqrt(1 + a/r). */
static void test_sphere(void **unused)
{
    (void)unused;
    static const double radii[] = {0.15, 0.3, 0.5};
    static const double ranges[] = {RANGE, 450.0};
    for (size_t i = 0; i < 6; i++) {
        const double a = radii[i % 3];
        struct bench bench;
        open_at(&bench, ranges[i / 3]);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a)->burial_m = -1.0;
        double range;
        const double peak = glint_peak(&bench, &range);
        const double nearest = slant_range(&bench) - a;
        print_message("sphere of radius %.2f m at %.0f m\n", a, ranges[i / 3]);
        expect_close("level re a/2, dB", decibels_of_amplitude(peak / (0.5 * a)),
                     -decibels_of_amplitude(sqrt(1.0 + a / nearest)), LEVEL_DB);
        /* to a bin: 1/16 of the pulse's deviation */
        expect_close("range, m", range, nearest, 0.002);
        bench_close(&bench);
    }
}

/* Down to half a wavelength: a/2 within what physical optics' false echo of the terminator and
 * cells of an eighth of a wavelength make of it, 2 dB. */
static void test_smallest_sphere(void **unused)
{
    (void)unused;
    static const double radii[] = {0.2505, 0.4, 0.5, 0.8}; /* wavelengths */
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
        const double a = radii[i] * WAVELENGTH;
        struct bench bench;
        double range;
        open_at(&bench, RANGE);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a)->burial_m = -1.0;
        const double peak = glint_peak(&bench, &range);
        print_message("sphere of radius %.1f mm\n", 1e3 * a);
        expect_close("level re a/2, dB", decibels_of_amplitude(peak / (0.5 * a)), 0.0, 2.0);
        bench_close(&bench);
    }
}

/* Expected energy of a Lambert sphere over its radius squared, in pixels that are long. */
static double rough_energy(double a, uint64_t seed)
{
    struct bench bench;
    struct echoes echoes;
    double sum = 0.0;
    bench_open(&bench, 41, 41, RANGE);
    bench.scene.geometry.row_spacing_m = 0.1;
    bench.scene.injection.seed = seed;
    sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a);
    object->burial_m = -0.1;
    object->material.reflection = 0.0;
    object->material.lambert = 0.1;
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    for (size_t i = 0; i < echoes.rows * echoes.columns; i++)
        sum += (double)echoes.target_energy[i];
    echoes_clear(&echoes);
    bench_close(&bench);
    return sum / (a * a);
}

/* The smallest rough sphere is met by 16 rays: each run has its energy to a quarter, and all of
 * them their mean, to 4 standard errors and 1 % of what is small against the large one. */
static void test_smallest_rough_sphere(void **unused)
{
    (void)unused;
    const int seeds = 16;
    const double large = rough_energy(0.2, 1);
    double sum = 0.0, square = 0.0;
    for (int i = 0; i < seeds; i++) {
        const double ratio = rough_energy(0.2505 * WAVELENGTH, (uint64_t)i + 1) / large;
        sum += ratio / seeds;
        square += ratio * ratio / seeds;
    }
    const double deviation = sqrt(square - sum * sum);
    expect_close("mean over the large sphere's", sum, 1.0,
                 4.0 * deviation / sqrt(seeds - 1.0) + 0.01);
    expect_below("deviation of one run", deviation, 0.4);
}

/* A wrong sound speed in the processor scales ranges by c_ref/c and, since amplitudes are
 * normalised by the square of the apparent range, amplitudes by its square. */
static void test_wrong_sound_speed(void **unused)
{
    (void)unused;
    const double a = 0.3;
    const double ratio = 1425.0 / 1500.0;
    struct bench bench;
    open_at(&bench, RANGE);
    bench.scene.medium.reference_sound_speed_mps = 1425.0;
    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a)->burial_m = -1.0;
    double range;
    const double peak = glint_peak(&bench, &range);
    expect_close("level re a/2 (c_ref/c)^2, dB",
                 decibels_of_amplitude(peak / (0.5 * a * ratio * ratio)), 0.0, LEVEL_DB);
    expect_close("apparent range, m", range, (slant_range(&bench) - a) * ratio, 0.002);
    bench_close(&bench);
}

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

/* |integral of sinc(x/delta) exp(ikx^2/a) dx| / sqrt(lambda a/2). */
static double sphere_factor(double a, double delta)
{
    double complex sum = 0.0;
    const double step = delta / 400.0;
    for (double x = -a + 0.5 * step; x < a; x += step)
        sum += sinc(x / delta) * cexp(I * 2.0 * PI / WAVELENGTH * x * x / a) * step;
    return cabs(sum) / sqrt(WAVELENGTH * a / 2.0);
}

/* The same without the parabola and with the pulse: 1/lambda times the integral of
 * sinc(x/delta) exp(2ikd) G(offset - d) over the disc, d the depth of the sphere's front. */
static double sphere_pixel(const struct bench *bench, double a, double delta, double offset)
{
    double complex sum = 0.0;
    const double step = WAVELENGTH / 40.0;
    for (double x = 0.5 * step; x < a; x += step)
        for (double w = 0.5 * step; x * x + w * w < a * a; w += step) {
            const double depth = a - sqrt(a * a - x * x - w * w);
            sum += 4.0 * step * step * sinc(x / delta) *
                   cexp(2.0 * I * bench_wavenumber(bench) * depth) *
                   range_response(&bench->tracer.response, offset - depth);
        }
    return cabs(sum) / WAVELENGTH;
}

static void test_sphere_in_the_image(void **unused)
{
    (void)unused;
    static const double radii[] = {0.15, 0.3, 0.15, 0.3};
    for (size_t i = 0; i < 4; i++) {
        const double a = radii[i];
        struct bench bench;
        struct echoes echoes;
        open_at(&bench, RANGE);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a);
        object->burial_m = -1.0;
        if (i < 2) { /* puts the nearest point on the middle of a column */
            bench_ready(&bench);
            const double column = view_column_of_range(&bench.tracer.view, slant_range(&bench) - a);
            object->position_kind = SONJECT_POSITION_METRES;
            object->position_along = 100.0 * 0.025;
            object->position_range = RANGE + (floor(column) - column) * 0.025;
        }
        bench_ready(&bench);
        const struct pixel pixel = brightest_pixel(&bench, &echoes);
        const double offset = view_apparent_range(&bench.tracer.view, (double)pixel.column) -
                              (slant_range(&bench) - a);
        const double level = decibels_of_amplitude(pixel.amplitude / (0.5 * a));
        print_message("radius %.2f m, pixel %.4f m behind the nearest point\n", a, offset);
        expect_close("row", (double)pixel.row, 100.0, 0.0);
        expect_close("level re a/2, dB", level,
                     decibels_of_amplitude(sphere_pixel(&bench, a, 0.025, offset) / (0.5 * a)),
                     0.06);
        if (i < 2)
            expect_close("closed form re a/2, dB", level,
                         decibels_of_amplitude(sphere_factor(a, 0.025)), LEVEL_DB);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* sqrt(R1 R2)/2 at the specular point: a capsule off broadside shows the ball of one end. The joint
 * of ball and tube is at least 2.5 Fresnel radii sqrt(lambda a/2) from the point here. */
static void test_capsule_end(void **unused)
{
    (void)unused;
    static const double degrees[][2] = {{30.0, 0.0}, {-45.0, 15.0}, {60.0, -20.0}, {90.0, 10.0}};
    for (size_t i = 0; i < 4; i++) {
        struct bench bench;
        open_at(&bench, RANGE);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_CAPSULE, 2.3, 0.0, 0.6);
        object->burial_m = -2.0;
        object->heading_rad = degrees[i][0] * PI / 180.0;
        object->pitch_rad = degrees[i][1] * PI / 180.0;
        print_message("heading %.0f, pitch %.0f degrees\n", degrees[i][0], degrees[i][1]);
        expect_close("level re a/2, dB", decibels_of_amplitude(glint_peak(&bench, NULL) / 0.15),
                     0.0, LEVEL_DB);
        bench_close(&bench);
    }
}

/* A wall seen broadside is a plane in x; the tube's curvature and the wavefront's add:
 * 1/R = 1/a + 1/r. sigma = R L^2 / (2 lambda). */
static void test_cylinder_broadside(void **unused)
{
    (void)unused;
    struct bench bench;
    struct echoes echoes;
    open_at(&bench, RANGE);
    bench_add(&bench, SONJECT_SHAPE_CYLINDER, 1.0, 0.0, 0.3)->burial_m = -1.0;
    const double peak = glint_peak(&bench, NULL);
    const double curvature = 1.0 / (1.0 / 0.15 + 1.0 / RANGE);
    expect_close("no W, dB re 1 m^2", decibels_of_amplitude(peak),
                 decibels_of_energy(curvature / (2.0 * WAVELENGTH)), LEVEL_DB);
    const struct pixel pixel = brightest_pixel(&bench, &echoes);
    (void)pixel;
    /* a pixel on its middle: the sinc's integral over it is delta within 1/(pi^2 20) */
    const size_t column =
        (size_t)(view_column_of_range(&bench.tracer.view, slant_range(&bench) - 0.15) + 0.5);
    const size_t at = 100 * COLUMNS + column;
    const double pulse = pulse_at_nearest_column(&bench, slant_range(&bench) - 0.15);
    expect_close("a pixel, dB re 1 m^2",
                 decibels_of_amplitude(hypot(echoes.target_real[at], echoes.target_imaginary[at])),
                 decibels_of_energy(curvature * 0.025 * 0.025 / (2.0 * WAVELENGTH)) +
                     decibels_of_amplitude(pulse),
                 LEVEL_DB);
    echoes_clear(&echoes);
    bench_close(&bench);
}

/* Off axis: sqrt(a cos(theta) / 2 lambda) |integral over the axis of exp(2iks sin(theta)) G|, which
 * without the pulse is (a L^2 / 2 lambda) (sin beta/beta)^2 cos(theta), beta = k L sin(theta). */
static double tilted_cylinder(const struct bench *bench, double a, double length, double theta)
{
    const double k = bench_wavenumber(bench);
    const double step = 1e-4;
    double largest = 0.0;
    for (double middle = 0.0; middle <= 0.5 * length * sin(theta); middle += 0.001) {
        double complex sum = 0.0;
        for (double s = -0.5 * length + 0.5 * step; s < 0.5 * length; s += step)
            sum += cexp(2.0 * I * k * s * sin(theta)) *
                   range_response(&bench->tracer.response, middle - s * sin(theta)) * step;
        largest = fmax(largest, cabs(sum));
    }
    const double curvature = a * cos(theta) / (1.0 + a * cos(theta) / RANGE);
    return sqrt(curvature / (2.0 * WAVELENGTH)) * largest;
}

/* Angle between the line of sight and the plane across the axis, which is level while the sight is
 * not: sin(theta) = sin(heading) cos(depression). */
static double aspect_of(const struct bench *bench, double heading)
{
    return asin(sin(heading) * bench->placements[0].centre[1] / slant_range(bench));
}

static void test_cylinder_off_axis(void **unused)
{
    (void)unused;
    static const double degrees[] = {0.1, 0.2, 0.3, 0.62, 1.06};
    for (size_t i = 0; i < sizeof degrees / sizeof *degrees; i++) {
        struct bench bench;
        open_at(&bench, RANGE);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_CYLINDER, 1.0, 0.0, 0.3);
        object->burial_m = -1.0;
        object->heading_rad = degrees[i] * PI / 180.0;
        const double level = decibels_of_amplitude(glint_peak(&bench, NULL));
        const double theta = aspect_of(&bench, object->heading_rad);
        const double beta = bench_wavenumber(&bench) * sin(theta);
        const double closed = decibels_of_amplitude(fabs(sin(beta) / beta)) +
                              decibels_of_energy(cos(theta) * 0.15 / (2.0 * WAVELENGTH));
        print_message("heading %.2f degrees, closed form %.2f dB\n", degrees[i], closed);
        expect_close("dB re 1 m^2", level,
                     decibels_of_amplitude(tilted_cylinder(&bench, 0.15, 1.0, theta)), LEVEL_DB);
        if (degrees[i] <= 0.3) /* the pulse is long against L sin(theta) */
            expect_close("closed form, dB re 1 m^2", level, closed, LEVEL_DB);
        bench_close(&bench);
    }
}

/* With W, a tilted wall shows a delta^2/(2 lambda) a pixel while sin(theta) < lambda/4 delta
 * (8.6 degrees), and nothing beyond. */
static void test_cylinder_leaves_the_aspects(void **unused)
{
    (void)unused;
    static const double degrees[] = {3.0, 5.0, 13.0};
    for (size_t i = 0; i < 3; i++) {
        const double theta = degrees[i] * PI / 180.0;
        struct bench bench;
        struct echoes echoes;
        open_at(&bench, RANGE);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_CYLINDER, 3.0, 0.0, 0.3);
        object->burial_m = -1.0;
        object->heading_rad = theta;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        /* mean energy along the middle of the wall, over columns; the pulse's energy spread over
         * columns is the integral of G^2 */
        double sum = 0.0;
        for (size_t row = 90; row <= 110; row++)
            for (size_t column = 0; column < COLUMNS; column++) {
                const double range = view_apparent_range(&bench.tracer.view, (double)column);
                const double wall = slant_range(&bench) - 0.15 / cos(theta) +
                                    ((double)row - 100.0) * 0.025 * tan(theta);
                if (fabs(range - wall) < 0.08)
                    sum += pow(echoes.target_real[row * COLUMNS + column], 2.0) +
                           pow(echoes.target_imaginary[row * COLUMNS + column], 2.0);
            }
        const double energy = sum / 21.0 * 0.025 / range_energy_width(&bench.tracer.response);
        const double curvature = 0.15 * cos(theta) / (1.0 + 0.15 / RANGE);
        const double expected = curvature * 0.025 * 0.025 / (2.0 * WAVELENGTH);
        print_message("heading %.0f degrees\n", degrees[i]);
        if (degrees[i] < 8.0)
            expect_close("pixel, dB re a delta^2/2 lambda", decibels_of_energy(energy / expected),
                         0.0, LEVEL_DB);
        else
            /* the ends' wide-angle echo leaks into the middle: ends 1.5 m away */
            expect_below("pixel, dB re a delta^2/2 lambda", decibels_of_energy(energy / expected),
                         -30.0);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* Turns a flat face towards the sonar: nose on the way back, which climbs by the depression. */
static void face_sonar(struct bench *bench, sonject_object_params *object, double forward)
{
    object->heading_rad = -0.5 * PI;
    object->pitch_rad = 0.0;
    for (int i = 0; i < 50; i++) { /* turning moves the centre: its lowest point is held */
        bench_ready(bench);
        const double *centre = bench->placements[0].centre;
        const double depression = atan2(bench->tracer.view.altitude_m - centre[2], centre[1]);
        object->pitch_rad = depression + forward;
    }
    bench_ready(bench);
}

/* A flat face of half height b that faces the sonar, seen by a line of fans: curvature of the
 * wavefront in elevation only, so sum = integral of width(w) exp(ikw^2/r) dw, amplitude -i/lambda
 * times that. (From a point source both directions would curve: r sin(ka^2/2r) for the disc.) */
static double complex flat_face(double r, double b, double (*width)(double w, double b), double k)
{
    double complex sum = 0.0;
    const int steps = 20000;
    for (int i = 0; i < steps; i++) {
        const double w = -b + 2.0 * b * (i + 0.5) / steps;
        sum += width(w, b) * cexp(I * k * w * w / r) * 2.0 * b / steps;
    }
    return -I / WAVELENGTH * sum;
}

static double disc_width(double w, double b)
{
    return 2.0 * sqrt(b * b - w * w);
}

static double square_width(double w, double b)
{
    (void)w;
    return 2.0 * b;
}

static double wrapped(double phase)
{
    return remainder(phase, 2.0 * PI);
}

static void expect_face(struct bench *bench, double complex face, double distance, double area)
{
    struct echo_line line = bench_glint_line(bench, 0);
    double range;
    const double peak = echo_line_peak(bench, &line, &range);
    const struct complex_value value = echo_line_at(bench, &line, distance);
    expect_close("level, dB re 1 m^2", decibels_of_amplitude(peak),
                 decibels_of_amplitude(cabs(face)), LEVEL_DB);
    expect_close("closed form of a plane wave, dB re (A/lambda)^2",
                 decibels_of_amplitude(peak / (area / WAVELENGTH)),
                 decibels_of_amplitude(cabs(face) / (area / WAVELENGTH)), LEVEL_DB);
    expect_close("range, m", range, distance, 0.002);
    const double phase = atan2(value.imaginary_part, value.real_part);
    expect_close("phase over 2kr and the face's own, rad",
                 wrapped(phase - 2.0 * bench_wavenumber(bench) * distance - carg(face)), 0.0, 0.05);
    echo_line_clear(&line);
}

static void test_flat_faces(void **unused)
{
    (void)unused;
    static const double radii[] = {0.05, 0.15, 0.3};
    for (size_t i = 0; i < 3; i++) {
        const double a = radii[i];
        struct bench bench;
        open_at(&bench, RANGE);
        sonject_object_params *object =
            bench_add(&bench, SONJECT_SHAPE_CYLINDER, 0.2, 0.0, 2.0 * a);
        object->burial_m = -1.0;
        face_sonar(&bench, object, 0.0);
        print_message("disc of radius %.2f m\n", a);
        const double distance = slant_range(&bench) - 0.1;
        expect_face(&bench, flat_face(distance, a, disc_width, bench_wavenumber(&bench)), distance,
                    PI * a * a);
        bench_close(&bench);
        open_at(&bench, RANGE);
        object = bench_add(&bench, SONJECT_SHAPE_PLANE, 2.0 * a, 2.0 * a, 0.0);
        object->burial_m = -1.0;
        face_sonar(&bench, object, -0.5 * PI); /* its normal, not its nose, faces the sonar */
        print_message("square of half side %.2f m\n", a);
        expect_face(&bench,
                    flat_face(slant_range(&bench), a, square_width, bench_wavenumber(&bench)),
                    slant_range(&bench), 4.0 * a * a);
        bench_close(&bench);
    }
}

/* A plane reflects as its image source does: +R exp(2ikr) for both curvatures, which the sphere has
 * whatever the fan: +(a/2) exp(2ik(r - a)). So a mirror's -i/lambda has the right sign, and a path
 * longer by lambda/8 (there and back lambda/4) turns the phase by +pi/2. */
static void test_phase(void **unused)
{
    (void)unused;
    double before = 0.0;
    double before_range = 0.0;
    for (int step = 0; step < 5; step++) {
        struct bench bench;
        open_at(&bench, RANGE);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6);
        object->burial_m = -1.0;
        object->position_kind = SONJECT_POSITION_METRES;
        object->position_range = RANGE + step * WAVELENGTH / 8.0;
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        const double nearest = slant_range(&bench) - 0.3;
        const struct complex_value value = echo_line_at(&bench, &line, nearest);
        const double phase = atan2(value.imaginary_part, value.real_part);
        /* the pulse is 1.1 % of a cycle longer than a tone: the next order of stationary phase is
         * 1/(2ka) = 1/250 rad */
        expect_close("phase less 2kr, rad",
                     wrapped(phase - 2.0 * bench_wavenumber(&bench) * nearest), 0.0, 0.05);
        if (step > 0)
            expect_close("phase step, rad", wrapped(phase - before),
                         wrapped(4.0 * PI / WAVELENGTH * (nearest - before_range)), 0.02);
        before = phase;
        before_range = nearest;
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* A pressure-release face turns the sign, roughness takes exp(-P^2/2), P = 2 k eta. */
static void test_reflection_and_roughness(void **unused)
{
    (void)unused;
    static const double heights[] = {0.0, 0.5e-3, 1e-3, 2e-3};
    for (size_t i = 0; i < 4; i++) {
        struct bench bench;
        open_at(&bench, RANGE);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6);
        object->burial_m = -1.0;
        object->material.reflection = -0.7;
        object->material.roughness_m = heights[i];
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        const double nearest = slant_range(&bench) - 0.3;
        const struct complex_value value = echo_line_at(&bench, &line, nearest);
        const double p = 2.0 * bench_wavenumber(&bench) * heights[i];
        expect_close("level, dB",
                     decibels_of_amplitude(hypot(value.real_part, value.imaginary_part)),
                     decibels_of_amplitude(0.7 * 0.15 * exp(-0.5 * p * p)), LEVEL_DB);
        expect_close("phase less 2kr, rad",
                     fabs(wrapped(atan2(value.imaginary_part, value.real_part) -
                                  2.0 * bench_wavenumber(&bench) * nearest)),
                     PI, 0.05);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* Doubling rays changes no glint. */
static void test_ray_count(void **unused)
{
    (void)unused;
    double level[3];
    static const double scales[] = {1.0, 4.0, 16.0};
    for (size_t i = 0; i < 3; i++) {
        struct bench bench;
        open_at(&bench, RANGE);
        bench.scene.injection.ray_scale = scales[i];
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_CAPSULE, 1.0, 0.0, 0.3);
        object->burial_m = -1.0;
        object->heading_rad = 0.2;
        level[i] = decibels_of_amplitude(glint_peak(&bench, NULL));
        bench_close(&bench);
    }
    expect_close("4 times the rays, dB", level[1], level[0], 0.06);
    expect_close("16 times the rays, dB", level[2], level[0], 0.06);
}

/* What is left where a smooth convex body returns nothing. The in-cell integral puts it at
 * -64...-74 dB re 1 m^2 at 64 rays per 25 x 25 mm and lower by 6 to 12 dB for 4 times the rays
 * (a plain sum: -44...-49); the default spacing of 1/8 wavelength is 180 rays. A seabed pixel at
 * -27 dB lies at -73. */
static void test_residual(void **unused)
{
    (void)unused;
    static const double scales[] = {1.0, 4.0};
    for (size_t i = 0; i < 2; i++) {
        struct bench bench;
        struct echoes echoes;
        open_at(&bench, RANGE);
        bench.scene.injection.ray_scale = scales[i];
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.8)->burial_m = -1.0;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        /* between the glint and the terminator (0.4 m behind), clear of both pulses (-108 dB at
         * 3.1 columns), over the rows of the sphere */
        const size_t first =
            (size_t)ceil(view_column_of_range(&bench.tracer.view, slant_range(&bench) - 0.4) + 5.0);
        const size_t last =
            (size_t)floor(view_column_of_range(&bench.tracer.view, slant_range(&bench)) - 5.0);
        double sum = 0.0;
        size_t count = 0;
        assert_true(last > first);
        for (size_t row = 100 - 14; row <= 100 + 14; row++)
            for (size_t column = first; column <= last; column++, count++)
                sum += pow(echoes.target_real[row * COLUMNS + column], 2.0) +
                       pow(echoes.target_imaginary[row * COLUMNS + column], 2.0);
        print_message("%.0f times the rays, %zu pixels\n", scales[i], count);
        expect_below("residual, dB re 1 m^2", decibels_of_energy(sum / (double)count),
                     scales[i] > 1.0 ? -70.0 : -64.0);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_smallest_sphere),
        cmocka_unit_test(test_smallest_rough_sphere),
        cmocka_unit_test(test_wrong_sound_speed),
        cmocka_unit_test(test_sphere_in_the_image),
        cmocka_unit_test(test_capsule_end),
        cmocka_unit_test(test_cylinder_broadside),
        cmocka_unit_test(test_cylinder_off_axis),
        cmocka_unit_test(test_cylinder_leaves_the_aspects),
        cmocka_unit_test(test_flat_faces),
        cmocka_unit_test(test_phase),
        cmocka_unit_test(test_reflection_and_roughness),
        cmocka_unit_test(test_ray_count),
        cmocka_unit_test(test_residual),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
