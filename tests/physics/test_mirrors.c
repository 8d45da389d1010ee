/* Glints by way of plane mirrors: the seabed and the sea surface. The reference is worked out here
 * from image sources and stationary points, in double precision. Levels are systematic: 0.2 dB. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

#define ROWS       101
#define COLUMNS    201
#define RANGE      50.0
#define LEVEL_DB   0.2
#define PHASE      0.05 /* rad; stationary phase errs by 1/(2ka), 1/126 for a = 0.15 m */
#define WAVELENGTH 0.015

static void open_at(struct bench *bench, double range_m, size_t columns, uint32_t interactions)
{
    bench_open(bench, ROWS, columns, range_m);
    bench->scene.injection.interactions = interactions;
}

static void set_mirror(sonject_material_params *material, double reflection)
{
    material->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    material->reflection = reflection;
    material->roughness_m = 0.0;
    material->lambert = 0.0; /* nothing but the mirror */
}

/* Coarse sand: APL-UW TR 9407. */
static void set_sand(sonject_material_params *material)
{
    material->reflection_kind = SONJECT_REFLECTION_FLUID;
    material->reflection = 0.0;
    material->roughness_m = 0.0;
    material->lambert = 0.0;
    material->density_ratio = 2.231;
    material->speed_ratio = 1.2503;
    material->loss = 0.01638;
}

/* Rayleigh coefficient times what roughness leaves, at the sine of the grazing angle. */
static double complex reflection_at(const sonject_material_params *material, double sine)
{
    double complex reflection = material->reflection;
    if (material->reflection_kind == SONJECT_REFLECTION_FLUID) {
        const double complex index = (1.0 + I * material->loss) / material->speed_ratio;
        const double complex root = csqrt(index * index - (1.0 - sine * sine));
        reflection =
            (material->density_ratio * sine - root) / (material->density_ratio * sine + root);
    }
    const double p = 4.0 * PI / WAVELENGTH * material->roughness_m * sine;
    return reflection * exp(-0.5 * p * p);
}

/* An image of the sonar: its height, and how often each mirror folds the way to it. */
struct image {
    double height;
    int seabed, surface;
};

/* All images of up to two bounces: sonar, B, S, BS, SB (from the sonar outwards). */
#define IMAGES 5
static void find_images(const struct bench *bench, struct image images[IMAGES])
{
    const double h = bench->scene.sonar.altitude_m;
    const double depth = bench->scene.surface.water_depth_m;
    const struct image all[IMAGES] = {{h, 0, 0},
                                      {-h, 1, 0},
                                      {2.0 * depth - h, 0, 1},
                                      {2.0 * depth + h, 1, 1},
                                      {h - 2.0 * depth, 1, 1}};
    memcpy(images, all, sizeof all);
}

static bool has_image(const struct bench *bench, const struct image *image)
{
    const sonject_material_params *seabed = &bench->scene.seabed.forward;
    const bool has_seabed =
        seabed->reflection_kind == SONJECT_REFLECTION_FLUID || seabed->reflection != 0.0;
    return (image->seabed == 0 || has_seabed) &&
           (image->surface == 0 || bench->scene.surface.water_depth_m > 0.0);
}

/* Half the path from one image to another by way of a point of the first object, a sphere. */
static double half_path(const struct bench *bench, const struct image *one,
                        const struct image *other, double angle)
{
    const struct placement *sphere = &bench->placements[0];
    const double y = sphere->centre[1] - sphere->size.radius_m * cos(angle);
    const double z = sphere->centre[2] + sphere->size.radius_m * sin(angle);
    return 0.5 * (hypot(y, z - one->height) + hypot(y, z - other->height));
}

/* The point of the shortest path, an angle over the horizontal, by ternary search. */
static double specular_angle(const struct bench *bench, const struct image *one,
                             const struct image *other)
{
    double low = -0.5 * PI;
    double high = 0.5 * PI;
    for (int i = 0; i < 100; i++) {
        const double a = low + (high - low) / 3.0;
        const double b = high - (high - low) / 3.0;
        if (half_path(bench, one, other, a) < half_path(bench, one, other, b))
            high = b;
        else
            low = a;
    }
    return 0.5 * (low + high);
}

/* One family's echo: complex amplitude a/2 times the mirrors, normalised by half the path. */
struct family {
    double complex amplitude;
    double range;
};

static double complex mirrors_at(const struct bench *bench, const struct image *image, double y,
                                 double z)
{
    const double sine = fabs(image->height - z) / hypot(y, image->height - z);
    double complex product = 1.0;
    if (image->seabed)
        product *= reflection_at(&bench->scene.seabed.forward, sine);
    if (image->surface)
        product *= reflection_at(&bench->scene.surface.material, sine);
    return product;
}

static struct family family_of(const struct bench *bench, const struct image *one,
                               const struct image *other)
{
    const struct placement *sphere = &bench->placements[0];
    const double a = sphere->size.radius_m;
    const double angle = specular_angle(bench, one, other);
    const double y = sphere->centre[1] - a * cos(angle);
    const double z = sphere->centre[2] + a * sin(angle);
    const double r_one = hypot(y, z - one->height);
    const double r_other = hypot(y, z - other->height);
    struct family family;
    family.range = 0.5 * (r_one + r_other);
    family.amplitude = 0.5 * a * family.range * family.range / (r_one * r_other) *
                       mirrors_at(bench, one, y, z) * mirrors_at(bench, other, y, z) *
                       cexp(2.0 * I * bench_wavenumber(bench) * family.range);
    return family;
}

/* All families within the limit of interactions, seen through the pulse at a range. */
static double complex expected_at(const struct bench *bench, double range)
{
    struct image images[IMAGES];
    double complex sum = 0.0;
    find_images(bench, images);
    for (int i = 0; i < IMAGES; i++)
        for (int j = 0; j < IMAGES; j++) { /* the reverse is an echo of its own */
            const uint32_t order = (uint32_t)(1 + images[i].seabed + images[i].surface +
                                              images[j].seabed + images[j].surface);
            if (order > bench->scene.injection.interactions || !has_image(bench, &images[i]) ||
                !has_image(bench, &images[j]))
                continue;
            const struct family family = family_of(bench, &images[i], &images[j]);
            sum += family.amplitude * range_response(&bench->tracer.response, range - family.range);
        }
    return sum;
}

static double complex measured_at(const struct bench *bench, const struct echo_line *line,
                                  double range)
{
    const struct complex_value value = echo_line_at(bench, line, range);
    return value.real_part + I * value.imaginary_part;
}

/* Compares level and phase at the range of one pair of images. */
static void expect_echo(struct bench *bench, const struct echo_line *line, int one, int other)
{
    struct image images[IMAGES];
    find_images(bench, images);
    const double range = family_of(bench, &images[one], &images[other]).range;
    const double complex expected = expected_at(bench, range);
    const double complex measured = measured_at(bench, line, range);
    print_message("images %d and %d, range %.3f m\n", one, other, range);
    expect_close("level re a/2, dB",
                 decibels_of_amplitude(cabs(measured) / (0.5 * bench->placements[0].size.radius_m)),
                 decibels_of_amplitude(cabs(expected) / (0.5 * bench->placements[0].size.radius_m)),
                 LEVEL_DB);
    expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
}

/* A sphere high over a smooth seabed returns a/2 (1, 2R, R^2) at its three ranges. */
static void test_three_echoes(void **unused)
{
    (void)unused;
    static const double reflections[] = {1.0, -1.0, 0.5, 0.0};
    static const double ranges[] = {RANGE, 450.0};
    for (size_t i = 0; i < 8; i++) {
        const double r = reflections[i % 4];
        struct bench bench;
        open_at(&bench, ranges[i / 4], 401, 3);
        if (ranges[i / 4] > 100.0)
            bench.scene.sonar.altitude_m = 60.0;
        if (r == 0.0)
            set_sand(&bench.scene.seabed.forward);
        else
            set_mirror(&bench.scene.seabed.forward, r);
        bench.scene.seabed.forward.roughness_m = i % 4 == 2 ? 1e-3 : 0.0;
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = -3.0;
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        print_message("R %.1f (0: sand) at %.0f m\n", r, ranges[i / 4]);
        expect_echo(&bench, &line, 0, 0);
        expect_echo(&bench, &line, 0, 1);
        expect_echo(&bench, &line, 1, 1);
        if (i == 1) { /* the closed form itself: twice a/2, upside down */
            struct image images[IMAGES];
            find_images(&bench, images);
            const double range = family_of(&bench, &images[0], &images[1]).range;
            const double complex echo = measured_at(&bench, &line, range) *
                                        cexp(-2.0 * I * bench_wavenumber(&bench) * range);
            expect_close("level re a/2, dB", decibels_of_amplitude(cabs(echo) / 0.075),
                         decibels_of_amplitude(2.0), LEVEL_DB);
            expect_close("sign", creal(echo) / cabs(echo), -1.0, 0.01);
        }
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* The surface turns the sign of what it returns, whatever else is there. */
static void test_surface_echo(void **unused)
{
    (void)unused;
    struct bench bench;
    open_at(&bench, RANGE, COLUMNS, 3);
    bench.scene.surface.water_depth_m = 14.0;
    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = -3.0;
    bench_ready(&bench);
    struct echo_line line = bench_glint_line(&bench, 0);
    expect_echo(&bench, &line, 0, 0);
    expect_echo(&bench, &line, 0, 2);
    expect_echo(&bench, &line, 2, 2);
    struct image images[IMAGES];
    find_images(&bench, images);
    const double range = family_of(&bench, &images[0], &images[2]).range;
    const double complex echo =
        measured_at(&bench, &line, range) * cexp(-2.0 * I * bench_wavenumber(&bench) * range);
    expect_close("sign", creal(echo) / cabs(echo), -1.0, 0.01);
    expect_close("level re a/2, dB", decibels_of_amplitude(cabs(echo) / 0.075),
                 decibels_of_amplitude(2.0), LEVEL_DB);
    echo_line_clear(&line);
    bench_close(&bench);
}

/* Shallow water: every family of up to two mirrors a leg, and the limit of interactions. */
static void test_two_mirrors(void **unused)
{
    (void)unused;
    for (uint32_t interactions = 1; interactions <= 5; interactions++) {
        struct bench bench;
        open_at(&bench, RANGE, COLUMNS, interactions);
        /* with more interactions there are images of three bounces, farther than these ranges */
        bench.scene.sonar.altitude_m = 5.0;
        bench.scene.surface.water_depth_m = 9.0;
        set_mirror(&bench.scene.seabed.forward, 0.8);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = -1.35;
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        print_message("%u interactions\n", (unsigned)interactions);
        expect_echo(&bench, &line, 0, 0);
        if (interactions >= 2) {
            expect_echo(&bench, &line, 0, 1);
            expect_echo(&bench, &line, 0, 2);
        }
        if (interactions == 3 || interactions == 4) {
            expect_echo(&bench, &line, 1, 1);
            expect_echo(&bench, &line, 1, 2);
            expect_echo(&bench, &line, 2, 2);
            expect_echo(&bench, &line, 0, 3);
            expect_echo(&bench, &line, 0, 4);
        }
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* A pulse far longer than the paths differ: |e^{ikR1}/R1 + R e^{ikR2}/R2|^2, there and back. */
static void test_lloyd(void **unused)
{
    (void)unused;
    static const double reflections[] = {-1.0, 0.6};
    for (size_t i = 0; i < 24; i++) {
        const double reflection = reflections[i / 12];
        const double a = 0.1; /* edges that physical optics adds: 1/(2ka) of each family */
        struct bench bench;
        open_at(&bench, RANGE, COLUMNS, 3);
        bench.scene.sonar.bandwidth_hz = 100.0;
        /* so low that the sonar and its image see the same point of the sphere */
        bench.scene.sonar.altitude_m = 1.0;
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a);
        object->burial_m = -0.1 - 0.033 * (double)(i % 12); /* a fringe is 0.375 m high */
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        const double y = bench.placements[0].centre[1];
        const double z = bench.placements[0].centre[2];
        const double r1 = hypot(y, z - 1.0);
        const double r2 = hypot(y, z + 1.0);
        const double free_field = cabs(measured_at(&bench, &line, r1 - a)) / (r1 * r1);
        echo_line_clear(&line);
        set_mirror(&bench.scene.seabed.forward, reflection);
        line = bench_glint_line(&bench, 0);
        const double with_mirror = cabs(measured_at(&bench, &line, r1 - a)) / (r1 * r1);
        const double k = bench_wavenumber(&bench);
        const double complex one_way = cexp(I * k * r1) / r1 + reflection * cexp(I * k * r2) / r2;
        /* 0.2 dB of the brightest fringe, 4 */
        expect_close("amplitude re free field", with_mirror / free_field,
                     pow(cabs(one_way) * r1, 2.0), 0.023 * 4.0);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* Physical optics on an upright wall of height b that stands on the seabed, for two image heights;
 * the fan's wavefronts do not curve along-track. */
static double complex wall_family(const struct bench *bench, double b, double length, double one,
                                  double other, double range)
{
    const double y = bench->placements[0].centre[1];
    const double k = bench_wavenumber(bench);
    const double step = WAVELENGTH / 100.0;
    double complex sum = 0.0;
    for (double z = 0.5 * step; z < b; z += step) {
        const double r1 = hypot(y, z - one);
        const double r2 = hypot(y, z - other);
        const double half_range = 0.5 * (r1 + r2);
        sum += (y / r1 + y / r2) * cexp(2.0 * I * k * half_range) * half_range * half_range /
               (r1 * r2) * range_response(&bench->tracer.response, range - half_range) * step;
    }
    return -I / (2.0 * WAVELENGTH) * length * sum;
}

/* sigma = (2 A cos(grazing)/lambda)^2 from D-M and M-D together; what is buried does not count. */
static void test_wall(void **unused)
{
    (void)unused;
    const double b = 0.2;
    const double length = 0.3;
    double complex at_corner[3];
    for (uint32_t i = 0; i < 6; i++) {
        const uint32_t interactions = 1 + i % 3;
        const double buried = i < 3 ? 0.0 : 0.15;
        struct bench bench;
        open_at(&bench, 30.0, COLUMNS, interactions);
        set_mirror(&bench.scene.seabed.forward, 1.0);
        sonject_object_params *object =
            bench_add(&bench, SONJECT_SHAPE_PLANE, length, b + buried, 0.0);
        object->roll_rad = 0.5 * PI;
        object->burial_m = buried;
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        const double y = bench.placements[0].centre[1];
        const double corner = hypot(y, 10.0);
        const double complex measured = measured_at(&bench, &line, corner);
        double complex expected = wall_family(&bench, b, length, 10.0, 10.0, corner);
        if (interactions >= 2)
            expected += 2.0 * wall_family(&bench, b, length, 10.0, -10.0, corner);
        if (interactions >= 3)
            expected += wall_family(&bench, b, length, -10.0, -10.0, corner);
        print_message("%u interactions, %.2f m buried\n", (unsigned)interactions, buried);
        if (interactions >= 2) {
            expect_close("level, dB re 1 m^2", decibels_of_amplitude(cabs(measured)),
                         decibels_of_amplitude(cabs(expected)), LEVEL_DB);
            expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
        }
        at_corner[interactions - 1] = measured;
        if (interactions == 2)
            expect_close("D-M and M-D, closed form, dB",
                         decibels_of_amplitude(cabs(at_corner[1] - at_corner[0])),
                         decibels_of_amplitude(2.0 * b * length * y / corner / WAVELENGTH),
                         LEVEL_DB);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* Half a sphere buried: with its image in a rigid seabed the rest is a whole sphere, which the
 * sonar and its image see from two sides: D-M and M-D together return a/2, not 2 a/2. */
static void test_half_buried(void **unused)
{
    (void)unused;
    double complex before = 0.0;
    for (uint32_t interactions = 1; interactions <= 2; interactions++) {
        struct bench bench;
        open_at(&bench, RANGE, COLUMNS, interactions);
        set_mirror(&bench.scene.seabed.forward, 1.0);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6)->burial_m = 0.3;
        bench_ready(&bench);
        struct image images[IMAGES];
        find_images(&bench, images);
        const struct family family = family_of(&bench, &images[0], &images[1]);
        struct echo_line line = bench_glint_line(&bench, 0);
        const double complex measured = measured_at(&bench, &line, family.range);
        if (interactions == 2) {
            expect_close("D-M and M-D re a/2, dB",
                         decibels_of_amplitude(cabs(measured - before) / 0.15), 0.0, LEVEL_DB);
            expect_close("phase off the reference, rad",
                         carg((measured - before) / family.amplitude), 0.0, PHASE);
        }
        before = measured;
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* Wholly buried: no way leads there, whichever side it comes from. */
static void test_buried(void **unused)
{
    (void)unused;
    struct bench bench;
    open_at(&bench, RANGE, COLUMNS, 3);
    set_mirror(&bench.scene.seabed.forward, 1.0);
    bench.scene.surface.water_depth_m = 14.0;
    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = 0.5;
    bench_ready(&bench);
    struct echo_line line = bench_glint_line(&bench, 0);
    for (size_t i = 0; i < line.bins; i++)
        assert_true(line.real_part[i] == 0.0 && line.imaginary_part[i] == 0.0);
    echo_line_clear(&line);
    bench_close(&bench);
}

/* The way by the seabed is closed by an object that hides the point of reflection, in front of it
 * or behind it, and open beside it; the straight way is not. */
static void test_hidden_reflection(void **unused)
{
    (void)unused;
    /* metres beyond the point of reflection, height of the plate's foot, is it upright? */
    static const double plates[][3] = {
        {0.0, 0.05, 0.0}, {-1.5, 0.0, 1.0}, {1.0, 0.0, 1.0}, {0.0, 0.0, -1.0}};
    for (size_t i = 0; i < 4; i++) {
        struct bench bench;
        open_at(&bench, RANGE, 601, 3);
        set_mirror(&bench.scene.seabed.forward, 1.0);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = -0.5;
        bench_ready(&bench);
        const double y = bench.placements[0].centre[1];
        const double z = bench.placements[0].centre[2];
        const double at = y * 10.0 / (10.0 + z) + plates[i][0];
        sonject_object_params *plate = bench_add(&bench, SONJECT_SHAPE_PLANE, 0.8, 0.6, 0.0);
        plate->material.reflection = 0.0;
        plate->burial_m = -plates[i][1];
        plate->roll_rad = plates[i][2] > 0.0 ? 0.5 * PI : 0.0;
        plate->position_kind = SONJECT_POSITION_METRES;
        plate->position_along = (ROWS / 2) * 0.025 + (plates[i][2] < 0.0 ? 0.7 : 0.0);
        plate->position_range = hypot(at, 10.0);
        bench_ready(&bench);
        struct image images[IMAGES];
        find_images(&bench, images);
        struct echo_line line = bench_glint_line(&bench, 0);
        print_message("plate %zu at %.2f m, sphere at %.2f m\n", i, at, y);
        if (plates[i][2] < 0.0) {
            expect_echo(&bench, &line, 0, 1);
        } else {
            for (int one = 0; one <= 1; one++) {
                const double range = family_of(&bench, &images[one], &images[1]).range;
                /* what is left of the straight echo there: the residual of physical optics */
                expect_below("closed way, dB re a/2",
                             decibels_of_amplitude(cabs(measured_at(&bench, &line, range)) / 0.075),
                             -30.0);
            }
        }
        bench.scene.injection.interactions = 1; /* for the reference alone */
        expect_echo(&bench, &line, 0, 0);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

static bool planes_differ(const struct echoes *one, const struct echoes *other)
{
    const size_t bytes = one->rows * one->columns * sizeof(float);
    return memcmp(one->target_real, other->target_real, bytes) != 0 ||
           memcmp(one->target_imaginary, other->target_imaginary, bytes) != 0 ||
           memcmp(one->target_energy, other->target_energy, bytes) != 0 ||
           memcmp(one->seabed_energy, other->seabed_energy, bytes) != 0 ||
           memcmp(one->lost_energy, other->lost_energy, bytes) != 0 ||
           memcmp(one->seabed_real, other->seabed_real, bytes) != 0;
}

/* What cannot be heard in the patch changes no bit of it; what can does. */
static void test_far_surface(void **unused)
{
    (void)unused;
    static const double depths[] = {0.0, 10000.0, 14.0};
    struct echoes echoes[3];
    for (size_t i = 0; i < 3; i++) {
        struct bench bench;
        open_at(&bench, RANGE, COLUMNS, 3);
        bench.scene.surface.water_depth_m = depths[i];
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
        object->material.lambert = 0.05;
        object->material.roughness_m = 1e-3;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes[i]);
        bench_close(&bench);
    }
    assert_false(planes_differ(&echoes[0], &echoes[1]));
    assert_true(planes_differ(&echoes[0], &echoes[2]));
    for (size_t i = 0; i < 3; i++)
        echoes_clear(&echoes[i]);
}

/* The image holds what the line holds: the energies of all families are those of their sum. */
static void test_image(void **unused)
{
    (void)unused;
    struct bench bench;
    struct echoes echoes;
    open_at(&bench, RANGE, COLUMNS, 3);
    bench.scene.sonar.bandwidth_hz = 15e3; /* columns sample the pulse's energy within 1e-5 */
    set_mirror(&bench.scene.seabed.forward, -1.0);
    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = -3.0;
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    struct image images[IMAGES];
    find_images(&bench, images);
    double straight = 0.0;
    for (int family = 0; family < 3; family++) {
        const double range =
            family_of(&bench, &images[family / 2], &images[(family + 1) / 2]).range;
        const double middle = view_column_of_range(&bench.tracer.view, range);
        double energy = 0.0;
        double field = 0.0;
        for (size_t column = (size_t)middle - 8; column <= (size_t)middle + 9; column++) {
            const size_t at = (ROWS / 2) * COLUMNS + column;
            energy += echoes.target_energy[at];
            field += pow(echoes.target_real[at], 2.0) + pow(echoes.target_imaginary[at], 2.0);
        }
        straight = family == 0 ? field : straight;
        expect_close("energy over field", energy / field, 1.0, 1e-5);
        expect_close("re straight echo, dB", decibels_of_energy(field / straight),
                     family == 1 ? decibels_of_amplitude(2.0) : 0.0, LEVEL_DB);
    }
    echoes_clear(&echoes);
    bench_close(&bench);
}

/* What is left of D-M and M-D where a smooth convex body returns nothing: as straight there and
 * back (tests/physics/test_glints.c), below -64 dB re 1 m^2 at the default number of rays. */
static void test_residual(void **unused)
{
    (void)unused;
    const double a = 0.4;
    struct echoes echoes[2];
    size_t first = 0;
    size_t last = 0;
    for (uint32_t i = 0; i < 2; i++) {
        struct bench bench;
        struct image images[IMAGES];
        open_at(&bench, RANGE, COLUMNS, 1 + i);
        set_mirror(&bench.scene.seabed.forward, 1.0);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a)->burial_m = -2.5;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes[i]);
        find_images(&bench, images);
        const double range = family_of(&bench, &images[0], &images[1]).range;
        first = (size_t)ceil(view_column_of_range(&bench.tracer.view, range) + 5.0);
        last = (size_t)floor(view_column_of_range(&bench.tracer.view, range + 0.6 * a));
        bench_close(&bench);
    }
    double sum = 0.0;
    size_t count = 0;
    assert_true(last > first);
    for (size_t row = ROWS / 2 - 14; row <= ROWS / 2 + 14; row++)
        for (size_t column = first; column <= last; column++, count++) {
            const size_t at = row * COLUMNS + column;
            sum += pow(echoes[1].target_real[at] - echoes[0].target_real[at], 2.0) +
                   pow(echoes[1].target_imaginary[at] - echoes[0].target_imaginary[at], 2.0);
        }
    expect_below("residual, dB re 1 m^2", decibels_of_energy(sum / (double)count), -64.0);
    echoes_clear(&echoes[0]);
    echoes_clear(&echoes[1]);
}

/* Energy of a Lambert sphere seen at an angle from where it is lit, over that seen from there. */
static double lambert_sphere(double angle)
{
    return (sin(angle) + (PI - angle) * cos(angle)) / PI;
}

/* Energy of all families of a rough sphere over the straight one's: the reverse of a path by a
 * mirror is the same echo, twice the amplitude. Nearly 1 + 4 R^2 + R^4. */
static double rough_ratio(const struct bench *bench, double reflection)
{
    const double y = bench->placements[0].centre[1];
    const double z = bench->placements[0].centre[2];
    const double h = bench->scene.sonar.altitude_m;
    const double r1 = hypot(y, h - z);
    const double r2 = hypot(y, h + z);
    const double between = atan2(h - z, y) + atan2(h + z, y);
    const double mean = 0.5 * (r1 + r2);
    return 1.0 +
           4.0 * pow(reflection, 2.0) * lambert_sphere(between) *
               pow(mean * mean / (r1 * r2), 2.0) +
           pow(reflection, 4.0);
}

static double sum_of_energy(const struct echoes *echoes)
{
    double sum = 0.0;
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++)
        sum += echoes->target_energy[i];
    return sum;
}

/* A rough sphere over a smooth seabed, once so low that both sources are one direction. */
static void test_rough_sphere(void **unused)
{
    (void)unused;
    static const double altitudes[] = {1.0, 10.0};
    for (size_t i = 0; i < 4; i++) {
        const double reflection = i % 2 ? -0.7 : 1.0;
        double mean = 0.0;
        double square = 0.0;
        double expected = 0.0;
        for (uint64_t seed = 1; seed <= 6; seed++) {
            double sum[2];
            for (uint32_t mirrored = 0; mirrored <= 1; mirrored++) {
                struct bench bench;
                struct echoes echoes;
                open_at(&bench, RANGE, COLUMNS, mirrored ? 3 : 1);
                bench.scene.sonar.altitude_m = altitudes[i / 2];
                bench.scene.sonar.bandwidth_hz = 15e3; /* columns sample the pulse's energy */
                bench.scene.injection.seed = seed + 6 * mirrored;
                set_mirror(&bench.scene.seabed.forward, reflection);
                sonject_object_params *object =
                    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
                object->material.reflection = 0.0;
                object->material.lambert = 0.1;
                object->burial_m = i / 2 ? -3.0 : -0.3;
                bench_ready(&bench);
                bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
                sum[mirrored] = sum_of_energy(&echoes);
                expected = rough_ratio(&bench, reflection);
                echoes_clear(&echoes);
                bench_close(&bench);
            }
            mean += sum[1] / sum[0] / 6.0;
            square += pow(sum[1] / sum[0], 2.0) / 6.0;
        }
        const double error = sqrt(fmax(0.0, square - mean * mean) / 5.0);
        print_message("altitude %.0f m, R %.1f: 1 + 4 R^2 + R^4 is %.3f\n", altitudes[i / 2],
                      reflection, 1.0 + 4.0 * pow(reflection, 2.0) + pow(reflection, 4.0));
        /* 4 standard errors, and a/r = 0.3 % that the reference leaves out */
        expect_close("energy over the straight one's", mean, expected,
                     4.0 * error + 0.003 * expected);
    }
}

/* The echo of a rough sphere by way of the seabed is where half its path ends, and a plate over the
 * point of reflection takes it away. */
static void test_rough_sphere_hidden(void **unused)
{
    (void)unused;
    double sum[3];
    for (uint32_t i = 0; i < 3; i++) { /* straight; mirror; mirror behind a plate */
        struct bench bench;
        struct echoes echoes;
        open_at(&bench, RANGE, 601, i ? 3 : 1);
        set_mirror(&bench.scene.seabed.forward, 1.0);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
        object->material.reflection = 0.0;
        object->material.lambert = 0.1;
        object->burial_m = -0.5;
        bench_ready(&bench);
        const double y = bench.placements[0].centre[1];
        const double z = bench.placements[0].centre[2];
        sonject_object_params *plate = bench_add(&bench, SONJECT_SHAPE_PLANE, 0.8, 2.4, 0.0);
        plate->material.reflection = 0.0;
        plate->burial_m = -0.02;
        plate->position_kind = SONJECT_POSITION_METRES;
        plate->position_along = (ROWS / 2) * 0.025 + (i == 2 ? 0.0 : 0.7);
        plate->position_range = hypot(y * 10.0 / (10.0 + z), 10.0);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        sum[i] = sum_of_energy(&echoes);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
    assert_true(sum[1] > 3.0 * sum[0]);
    /* nothing is left but what sphere, plate and seabed scatter to one another */
    expect_close("hidden over straight", sum[2] / sum[0], 1.0, 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_three_echoes),
        cmocka_unit_test(test_surface_echo),
        cmocka_unit_test(test_two_mirrors),
        cmocka_unit_test(test_lloyd),
        cmocka_unit_test(test_wall),
        cmocka_unit_test(test_half_buried),
        cmocka_unit_test(test_buried),
        cmocka_unit_test(test_hidden_reflection),
        cmocka_unit_test(test_far_surface),
        cmocka_unit_test(test_image),
        cmocka_unit_test(test_residual),
        cmocka_unit_test(test_rough_sphere),
        cmocka_unit_test(test_rough_sphere_hidden),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
