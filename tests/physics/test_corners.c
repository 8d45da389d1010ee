/* Echoes of several smooth faces one after the other, against closed forms and the double integral
 * of physical optics (corner_reference.h). Levels are systematic: 0.2 dB. */
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
#include "corner_reference.h"

#define ROWS       101
#define COLUMNS    201
#define RANGE      50.0
#define LEVEL_DB   0.2
#define PHASE      0.05 /* rad */
#define WAVELENGTH 0.015
#define SPACING    (WAVELENGTH / 6.0)

static void open_at(struct bench *bench, uint32_t interactions)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    bench->scene.injection.interactions = interactions;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Puts a part exactly where it is wanted; nose and own y are unit vectors square to each other. */
static void put(struct bench *bench, uint32_t part, const double centre[3], const double nose[3],
                const double own_y[3])
{
    struct placement *placement = &bench->placements[part];
    memcpy(placement->centre, centre, sizeof placement->centre);
    memcpy(placement->axes[0], nose, sizeof placement->axes[0]);
    memcpy(placement->axes[1], own_y, sizeof placement->axes[1]);
    cross(nose, own_y, placement->axes[2]);
}

/* Unit vectors at the scene's middle: to the sonar, across that upwards, and along the track. */
struct sight {
    double middle[3], to_sonar[3], up[3], along[3];
    double range;
};

static struct sight sight_of(const struct bench *bench, double height)
{
    const struct patch_view *view = &bench->tracer.view;
    const double drop = view->altitude_m - height;
    struct sight sight;
    memset(&sight, 0, sizeof sight);
    sight.range = RANGE;
    sight.middle[0] = view_x_of_row(view, 0.5 * (ROWS - 1));
    sight.middle[1] = sqrt(RANGE * RANGE - drop * drop);
    sight.middle[2] = height;
    sight.to_sonar[1] = -sight.middle[1] / RANGE;
    sight.to_sonar[2] = drop / RANGE;
    sight.up[1] = drop / RANGE;
    sight.up[2] = sight.middle[1] / RANGE;
    sight.along[0] = 1.0;
    return sight;
}

/* a u + b v */
static void mix(double a, const double u[3], double b, const double v[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a * u[k] + b * v[k];
}

/* Two plates, `wide` from the edge and `length` along it, that open towards the sonar. The edge
 * runs along the track or, upright, across it; the bisector is `off` rad from the sonar about the
 * edge. */
static struct sight lay_dihedral(struct bench *bench, double wide, double length, bool is_upright,
                                 double off)
{
    bench_add(bench, SONJECT_SHAPE_PLANE, length, wide, 0.0)->burial_m = -1.0;
    bench_add(bench, SONJECT_SHAPE_PLANE, length, wide, 0.0)->burial_m = -1.0;
    bench_ready(bench);
    const struct sight sight = sight_of(bench, 3.0);
    const double *aside = is_upright ? sight.along : sight.up;
    const double *edge = is_upright ? sight.up : sight.along;
    for (uint32_t part = 0; part < 2; part++) {
        const double angle = off + (part == 0 ? 0.25 : -0.25) * PI;
        double outward[3], centre[3];
        mix(cos(angle), sight.to_sonar, sin(angle), aside, outward);
        mix(1.0, sight.middle, 0.5 * wide, outward, centre);
        put(bench, part, centre, edge, outward);
    }
    return sight;
}

/* What further interactions bring to the glints of some parts together, at a range. */
static double complex further_echo(struct bench *bench, uint32_t first_part, uint32_t last_part,
                                   double range)
{
    const uint32_t interactions = bench->scene.injection.interactions;
    double complex sum = 0.0;
    for (uint32_t part = first_part; part <= last_part; part++)
        for (int i = 0; i < 2; i++) {
            bench->scene.injection.interactions = i == 0 ? interactions : 1;
            struct echo_line line = bench_glint_line(bench, part);
            const struct complex_value value = echo_line_at(bench, &line, range);
            sum += (i == 0 ? 1.0 : -1.0) * (value.real_part + I * value.imaginary_part);
            echo_line_clear(&line);
        }
    bench->scene.injection.interactions = interactions;
    return sum;
}

static void expect_echo(double complex measured, double complex expected)
{
    expect_close("level, dB re 1 m^2", decibels_of_amplitude(cabs(measured)),
                 decibels_of_amplitude(cabs(expected)), LEVEL_DB);
    expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
}

/* sigma = 2 a^2 b^2 / lambda^2 on the bisector, half the amplitude from each plate first, and the
 * phase of an aperture that returns what comes: -i. */
static void test_dihedral(void **unused)
{
    (void)unused;
    const double a = 0.2;
    const double b = 0.15;
    for (int upright = 0; upright < 2; upright++) {
        struct bench bench;
        open_at(&bench, 2);
        const struct sight sight = lay_dihedral(&bench, a, b, upright, 0.0);
        print_message("edge %s\n", upright ? "across the track" : "along the track");
        const double complex plane_wave = -I * sqrt(2.0) * a * b / WAVELENGTH *
                                          cexp(2.0 * I * bench_wavenumber(&bench) * sight.range);
        const struct face one = face_of_plane(&bench, 0);
        const struct face other = face_of_plane(&bench, 1);
        const struct corner_way way = straight_way(&bench);
        const double complex first = corner_echo(&bench, &way, &one, &other, SPACING, sight.range);
        const double complex second = corner_echo(&bench, &way, &other, &one, SPACING, sight.range);
        expect_echo(further_echo(&bench, 0, 0, sight.range), first);
        expect_echo(further_echo(&bench, 1, 1, sight.range), second);
        const double complex both = further_echo(&bench, 0, 1, sight.range);
        expect_close("closed form, dB re 1 m^2", decibels_of_amplitude(cabs(both)),
                     decibels_of_amplitude(cabs(plane_wave)), LEVEL_DB);
        expect_close("phase off that of a plane wave, rad", carg(both / plane_wave), 0.0, 0.2);
        bench_close(&bench);
    }
}

/* However little two faces reflect, they echo in proportion. Of 2 * 10^4 rays each brings some 50
 * quanta, rounded by chance: four times half a quantum over 50 and the root of their number. */
static void test_weak_faces(void **unused)
{
    (void)unused;
    struct bench bench;
    open_at(&bench, 2);
    const struct sight sight = lay_dihedral(&bench, 0.2, 0.15, false, 0.0);
    const double complex strong = further_echo(&bench, 0, 1, sight.range);
    for (uint32_t part = 0; part < 2; part++)
        bench.scene.objects[part].material.reflection = 1e-3;
    const double complex weak = further_echo(&bench, 0, 1, sight.range) / 1e-6;
    expect_close("level of weak faces", cabs(weak / strong), 1.0, 3e-4);
    expect_close("phase of weak faces, rad", carg(weak / strong), 0.0, 3e-4);
    bench_close(&bench);
}

/* Off the bisector less of each plate lights the other. */
static void test_dihedral_off_its_bisector(void **unused)
{
    (void)unused;
    static const double offs[] = {0.1, -0.3, 0.5};
    for (size_t i = 0; i < 3; i++) {
        struct bench bench;
        open_at(&bench, 3);
        const struct sight sight = lay_dihedral(&bench, 0.25, 0.2, false, offs[i]);
        const struct face one = face_of_plane(&bench, 0);
        const struct face other = face_of_plane(&bench, 1);
        const struct corner_way way = straight_way(&bench);
        print_message("%.1f rad off the bisector\n", offs[i]);
        expect_echo(further_echo(&bench, 0, 1, sight.range),
                    corner_echo(&bench, &way, &one, &other, SPACING, sight.range) +
                        corner_echo(&bench, &way, &other, &one, SPACING, sight.range));
        bench_close(&bench);
    }
}

/* Lays a first part at the middle that sends sound along `onward` to a plate, part 1, `distance`
 * away, and turns that so that it sends it home. Returns the normal that the first part needs. */
static void lay_plate(struct bench *bench, const struct sight *sight, const double onward[3],
                      double distance, double normal_of_first[3])
{
    double normal[3], centre[3], aside[3], own_y[3];
    mix(1.0, sight->to_sonar, 1.0, onward, normal_of_first);
    mix(1.0, sight->to_sonar, -1.0, onward, normal);
    for (int k = 0; k < 3; k++) {
        normal_of_first[k] *= sqrt(0.5); /* onward is square to the sight */
        normal[k] *= sqrt(0.5);
    }
    cross(sight->to_sonar, onward, aside);
    cross(normal, aside, own_y);
    mix(1.0, sight->middle, distance, onward, centre);
    put(bench, 1, centre, aside, own_y);
}

/* A sphere beside a plate: geometrical optics spreads the sound that comes to the plate. */
static void test_sphere_and_plate(void **unused)
{
    (void)unused;
    const double radius = 0.15;
    static const double distances[] = {0.6, 1.0};
    for (int i = 0; i < 4; i += 3) {
        struct bench bench;
        open_at(&bench, 2);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * radius)->burial_m = -1.0;
        bench_add(&bench, SONJECT_SHAPE_PLANE, 0.5, 0.5, 0.0)->burial_m = -1.0;
        bench_ready(&bench);
        const struct sight sight = sight_of(&bench, 3.0);
        const double aside = i % 2 == 0 ? 0.0 : 0.8;
        double onward[3], normal[3], nose[3], own_y[3], centre[3], first_hit[3];
        mix(sqrt(1.0 - aside * aside), sight.up, aside, sight.along, onward);
        lay_plate(&bench, &sight, onward, distances[i / 2], normal);
        memcpy(nose, normal, sizeof nose);
        mix(-aside, sight.up, sqrt(1.0 - aside * aside), sight.along, own_y);
        mix(1.0, sight.middle, -radius, normal, centre); /* its specular point is at the middle */
        put(&bench, 0, centre, nose, own_y);
        memcpy(first_hit, sight.middle, sizeof first_hit);
        const struct corner_way way = straight_way(&bench);
        const struct face sphere = {&bench.placements[0], FACE_SPHERE, {-1.4, -1.4}, {1.4, 1.4}};
        const struct face plate = face_of_plane(&bench, 1);
        const double range = corner_range(&way, first_hit, bench.placements[1].centre);
        print_message("%.1f m away, %.1f along the track\n", distances[i / 2], aside);
        expect_echo(further_echo(&bench, 0, 0, range),
                    corner_echo(&bench, &way, &sphere, &plate, SPACING, range));
        expect_echo(further_echo(&bench, 1, 1, range),
                    corner_echo(&bench, &way, &plate, &sphere, SPACING, range));
        bench_close(&bench);
    }
}

/* The inner side of a tube gathers sound on a line before the plate: -pi/2. */
static void test_caustic(void **unused)
{
    (void)unused;
    static const double radii[] = {1.0, 0.4}; /* focal lengths at 45 degrees: 0.35 and 0.14 m */
    static const double distances[] = {0.09, 0.45};
    static const double widths[] = {0.06, 0.25}; /* of the plate, which must not hide the tube */
    for (int i = 0; i < 4; i++) {
        const double radius = radii[i / 2];
        const double half_angle = 0.06 / radius;
        struct bench bench;
        open_at(&bench, 2);
        sonject_object_params *tube =
            bench_add(&bench, SONJECT_SHAPE_CYLINDER, 0.15, 0.0, 2.0 * radius);
        tube->burial_m = -1.0;
        tube->nose_end = tube->tail_end = SONJECT_END_OPEN;
        tube->cuts[0].azimuth_rad = -0.5 * PI;
        tube->cuts[0].distance_m = -radius * cos(half_angle);
        tube->cut_count = 1;
        bench_add(&bench, SONJECT_SHAPE_PLANE, 0.15, widths[i / 2], 0.0)->burial_m = -1.0;
        bench_ready(&bench);
        const struct sight sight = sight_of(&bench, 3.0);
        const bool is_aside = i % 2 == 1;
        const double *onward = is_aside ? sight.along : sight.up;
        double normal[3], own_y[3], centre[3];
        lay_plate(&bench, &sight, onward, distances[i / 2], normal);
        mix(-1.0, normal, 0.0, normal, own_y);
        mix(1.0, sight.middle, radius, normal, centre);
        put(&bench, 0, centre, is_aside ? sight.up : sight.along, own_y);
        const struct corner_way way = straight_way(&bench);
        const struct face inside = {
            &bench.placements[0], FACE_INSIDE_TUBE, {-0.075, -half_angle}, {0.075, half_angle}};
        const struct face plate = face_of_plane(&bench, 1);
        const double range = corner_range(&way, sight.middle, bench.placements[1].centre);
        print_message("%.2f m away, %s\n", distances[i / 2], is_aside ? "along" : "across");
        expect_echo(further_echo(&bench, 0, 0, range),
                    corner_echo(&bench, &way, &inside, &plate, SPACING, range));
        bench_close(&bench);
    }
}

static void set_rigid_seabed(struct bench *bench, double reflection)
{
    sonject_material_params *seabed = &bench->scene.seabed.forward;
    seabed->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    seabed->reflection = reflection;
    seabed->lambert = 0.0;
}

/* Puts a plate so that it mirrors sound that goes along `in` into `out`, both unit vectors. */
static void put_mirror(struct bench *bench, uint32_t part, const double centre[3],
                       const double in[3], const double out[3])
{
    double normal[3], aside[3], own_y[3];
    mix(1.0, out, -1.0, in, normal);
    cross(in, out, aside);
    const double length =
        sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    const double breadth = sqrt(aside[0] * aside[0] + aside[1] * aside[1] + aside[2] * aside[2]);
    mix(1.0 / length, normal, 0.0, normal, normal);
    mix(1.0 / breadth, aside, 0.0, aside, aside);
    cross(normal, aside, own_y);
    put(bench, part, centre, aside, own_y);
}

/* From one plate by way of the seabed to the other. */
static void test_seabed_between(void **unused)
{
    (void)unused;
    struct bench bench;
    open_at(&bench, 3);
    set_rigid_seabed(&bench, -0.7);
    bench_add(&bench, SONJECT_SHAPE_PLANE, 0.2, 0.2, 0.0)->burial_m = -0.5;
    bench_add(&bench, SONJECT_SHAPE_PLANE, 0.2, 0.2, 0.0)->burial_m = -0.5;
    bench_ready(&bench);
    const struct sight sight = sight_of(&bench, 0.25);
    static const double down[3] = {0.6, 0.0, -0.8};
    static const double up[3] = {0.6, 0.0, 0.8};
    double from_sonar[3], other[3];
    mix(-1.0, sight.to_sonar, 0.0, down, from_sonar);
    mix(1.0, sight.middle, 0.3125, down, other);
    mix(1.0, other, 0.3125, up, other);
    put_mirror(&bench, 0, sight.middle, from_sonar, down);
    put_mirror(&bench, 1, other, up, sight.to_sonar);
    struct corner_way way = straight_way(&bench);
    way.is_folded = true;
    const struct face one = face_of_plane(&bench, 0);
    const struct face two = face_of_plane(&bench, 1);
    const double range = corner_range(&way, sight.middle, other);
    expect_echo(further_echo(&bench, 0, 0, range),
                -0.7 * corner_echo(&bench, &way, &one, &two, SPACING, range));
    expect_echo(further_echo(&bench, 1, 1, range),
                -0.7 * corner_echo(&bench, &way, &two, &one, SPACING, range));
    bench_close(&bench);
}

/* By way of the seabed to two plates and straight home, and the reverse, which is what is traced.
 */
static void test_seabed_before(void **unused)
{
    (void)unused;
    for (uint32_t interactions = 2; interactions <= 3; interactions++) {
        struct bench bench;
        open_at(&bench, interactions);
        set_rigid_seabed(&bench, -0.7);
        bench_add(&bench, SONJECT_SHAPE_PLANE, 0.2, 0.2, 0.0)->burial_m = -1.0;
        bench_add(&bench, SONJECT_SHAPE_PLANE, 0.2, 0.2, 0.0)->burial_m = -1.0;
        bench_ready(&bench);
        const struct sight sight = sight_of(&bench, 3.0);
        struct corner_way way = straight_way(&bench);
        way.height_home = -way.height_out;
        const double drop = way.height_home - sight.middle[2];
        const double reach = hypot(sight.middle[1], drop);
        const double from_image[3] = {0.0, sight.middle[1] / reach, -drop / reach};
        double other[3];
        mix(1.0, sight.middle, 0.4, sight.along, other);
        put_mirror(&bench, 0, sight.middle, from_image, sight.along);
        put_mirror(&bench, 1, other, sight.along, sight.to_sonar);
        const struct face one = face_of_plane(&bench, 0);
        const struct face two = face_of_plane(&bench, 1);
        const double range = corner_range(&way, other, sight.middle);
        const double complex expected =
            2.0 * -0.7 * corner_echo(&bench, &way, &two, &one, SPACING, range);
        const double complex measured = further_echo(&bench, 1, 1, range);
        if (interactions == 3)
            expect_echo(measured, expected);
        else /* but for what plates return by way of the seabed alone */
            expect_below("without a third interaction", cabs(measured / expected), 0.05);
        bench_close(&bench);
    }
}

/* The image: an upright edge focuses all of the corner on its own pixel; of one along the track
 * each pixel has what lies within the resolution. */
static void test_image(void **unused)
{
    (void)unused;
    const double a = 0.2;
    static const double lengths[] = {0.15, 1.0};
    for (int upright = 0; upright < 2; upright++) {
        struct bench bench;
        struct echoes echoes;
        open_at(&bench, 2);
        const double length = lengths[1 - upright];
        lay_dihedral(&bench, a, length, upright, 0.0);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        const size_t middle = (ROWS / 2) * COLUMNS + COLUMNS / 2;
        const double expected =
            sqrt(2.0) * a * (upright ? length : bench.tracer.response.resolution_m) / WAVELENGTH;
        print_message("edge %s the track\n", upright ? "across" : "along");
        expect_close("pixel, dB re 1 m^2",
                     decibels_of_amplitude(
                         hypot(echoes.target_real[middle], echoes.target_imaginary[middle])),
                     decibels_of_amplitude(expected), LEVEL_DB);
        /* each object has the half that meets it first */
        for (uint32_t i = 0; i < 2; i++) {
            const struct object_echo *echo = &echoes.objects[i];
            const size_t at = (ROWS / 2) * echo->columns + COLUMNS / 2 - echo->first_column;
            expect_close("object, dB re 1 m^2", decibels_of_energy(echo->energy[at]),
                         decibels_of_amplitude(0.5 * expected), LEVEL_DB);
        }
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* In the columns of the first hit the halves of an upright corner lie on its two sides. */
static void test_paper_columns(void **unused)
{
    (void)unused;
    struct bench bench;
    struct echoes echoes;
    open_at(&bench, 2);
    bench.scene.injection.column_rule = SONJECT_COLUMNS_PAPER;
    lay_dihedral(&bench, 0.3, 0.15, true, 0.0);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    const double expected = 0.15 * bench.tracer.response.resolution_m / WAVELENGTH;
    for (int row = -4; row <= 4; row += 8) { /* of 0.21 m, on the face that sound meets there */
        const size_t at = (size_t)(ROWS / 2 + row) * COLUMNS + COLUMNS / 2;
        expect_close(
            "pixel, dB re 1 m^2",
            decibels_of_amplitude(hypot(echoes.target_real[at], echoes.target_imaginary[at])),
            decibels_of_amplitude(expected), LEVEL_DB);
    }
    echoes_clear(&echoes);
    bench_close(&bench);
}

static void expect_same_line(const struct echo_line *a, const struct echo_line *b)
{
    assert_int_equal(a->bins, b->bins);
    assert_memory_equal(a->real_part, b->real_part, a->bins * sizeof *a->real_part);
    assert_memory_equal(a->imaginary_part, b->imaginary_part, a->bins * sizeof *a->imaginary_part);
}

/* Not a bit changes where sound cannot meet a second smooth face: a convex part alone, or beside a
 * rough one, or with one interaction. */
static void test_unchanged(void **unused)
{
    (void)unused;
    struct echo_line before = {0, 0.0, 0.0, NULL, NULL};
    for (int i = 0; i < 5; i++) {
        static const uint32_t interactions[] = {1, 2, 5, 4, 1};
        struct bench bench;
        open_at(&bench, interactions[i]);
        bench_add(&bench, SONJECT_SHAPE_CAPSULE, 0.6, 0.0, 0.3)->heading_rad = 0.05;
        if (i >= 3) {
            sonject_object_params *box = bench_add(&bench, SONJECT_SHAPE_BOX, 0.3, 0.3, 0.0);
            box->height_m = 0.3;
            box->position_kind = SONJECT_POSITION_METRES;
            box->position_range = RANGE + 1.5;
            if (i == 3) {
                box->material.reflection = 0.0;
                box->material.lambert = 0.1;
            }
        }
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        if (i > 0)
            expect_same_line(&line, &before);
        echo_line_clear(&before);
        before = line;
        bench_close(&bench);
    }
    echo_line_clear(&before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_dihedral),
        cmocka_unit_test(test_weak_faces),
        cmocka_unit_test(test_dihedral_off_its_bisector),
        cmocka_unit_test(test_sphere_and_plate),
        cmocka_unit_test(test_caustic),
        cmocka_unit_test(test_seabed_between),
        cmocka_unit_test(test_seabed_before),
        cmocka_unit_test(test_image),
        cmocka_unit_test(test_paper_columns),
        cmocka_unit_test(test_unchanged),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
