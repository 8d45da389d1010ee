/* Echoes of several smooth faces in turn, compared with closed forms and the double integral of
 * physical optics (multibounce_reference.h). Levels have a systematic tolerance of 0.2 dB. */
#include "multibounce_reference.h"

#define ROWS       101
#define COLUMNS    201
#define RANGE      50.0
#define LEVEL_DB   0.2
#define PHASE      0.05 /* rad */
#define WAVELENGTH 0.015
#define SPACING    (WAVELENGTH / 6.0)

static struct sea *open_at(uint32_t interactions)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->injection->interactions = interactions;
    return sea;
}

/* Adds a rigid plate, as part 0, 1, ..., which the caller then puts in its place. */
static void add_plate(struct sea *sea, double length, double width)
{
    sea_add(sea, SHAPE_PLANE, length, width, 0.0)->burial_m = -1.0;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The scene's middle, with unit vectors to the sonar, upwards across that, and along the track. */
struct sight {
    double middle[3], to_sonar[3], up[3], along[3];
    double range;
};

static struct sight sight_of(const struct sea *sea, double height)
{
    const double drop = sea->sonar->altitude_m - height;
    struct sight sight;
    memset(&sight, 0, sizeof sight);
    sight.range = RANGE;
    sight.middle[0] = sea_x(sea, 0.5 * (ROWS - 1));
    sight.middle[1] = sqrt(RANGE * RANGE - drop * drop);
    sight.middle[2] = height;
    sight.to_sonar[1] = -sight.middle[1] / RANGE;
    sight.to_sonar[2] = drop / RANGE;
    sight.up[1] = drop / RANGE;
    sight.up[2] = sight.middle[1] / RANGE;
    sight.along[0] = 1.0;
    return sight;
}

/* out = a u + b v */
static void mix(double a, const double u[3], double b, const double v[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a * u[k] + b * v[k];
}

/* Lays two plates that open towards the sonar, `wide` from their edge and `length` along it. The
 * edge runs along the track or, upright, across it. The bisector is `off` rad from the sonar. */
static struct sight lay_dihedral(struct sea *sea, double wide, double length, bool is_upright,
                                 double off)
{
    add_plate(sea, length, wide);
    add_plate(sea, length, wide);
    sea_ready(sea);
    const struct sight sight = sight_of(sea, 3.0);
    const double *aside = is_upright ? sight.along : sight.up;
    const double *edge = is_upright ? sight.up : sight.along;
    for (uint32_t part = 0; part < 2; part++) {
        const double angle = off + (part == 0 ? 0.25 : -0.25) * PI;
        double outward[3], centre[3];
        mix(cos(angle), sight.to_sonar, sin(angle), aside, outward);
        mix(1.0, sight.middle, 0.5 * wide, outward, centre);
        sea_put(sea, part, centre, edge, outward);
    }
    return sight;
}

/* Returns the echo that further interactions add to the glints of some parts, at a range. */
static double complex further_echo(struct sea *sea, uint32_t first_part, uint32_t last_part,
                                   double range)
{
    const uint32_t interactions = sea->injection->interactions;
    double complex sum = 0.0;
    for (uint32_t part = first_part; part <= last_part; part++)
        for (int i = 0; i < 2; i++) {
            sea->injection->interactions = i == 0 ? interactions : 1;
            const struct line line = sea_line(sea, part);
            sum += (i == 0 ? 1.0 : -1.0) * line_at(sea, &line, range);
        }
    sea->injection->interactions = interactions;
    return sum;
}

static void expect_echo(double complex measured, double complex expected)
{
    expect_close("level, dB re 1 m^2", decibels_of_amplitude(cabs(measured)),
                 decibels_of_amplitude(cabs(expected)), LEVEL_DB);
    expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
}

/* On the bisector sigma = 2 a^2 b^2 / lambda^2, with half the amplitude from each plate first. The
 * phase is -i, that of an aperture that returns all sound. Off the bisector less of each lights the
 * other. */
CLAIM(a_dihedral)
{
    static const struct {
        double wide, length, off;
        bool is_upright;
    } cases[] = {{0.2, 0.15, 0.0, false},
                 {0.2, 0.15, 0.0, true},
                 {0.25, 0.2, 0.1, false},
                 {0.25, 0.2, -0.3, false},
                 {0.25, 0.2, 0.5, false}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct sea *sea = open_at(i < 2 ? 2 : 3);
        const struct sight sight =
            lay_dihedral(sea, cases[i].wide, cases[i].length, cases[i].is_upright, cases[i].off);
        const struct face one = face_of_plane(sea, 0), other = face_of_plane(sea, 1);
        const struct multibounce_way way = straight_way(sea);
        print_message("edge %s the track, %.1f rad off the bisector\n",
                      cases[i].is_upright ? "across" : "along", cases[i].off);
        const double complex first =
            multibounce_echo(sea, &way, &one, &other, SPACING, sight.range);
        const double complex second =
            multibounce_echo(sea, &way, &other, &one, SPACING, sight.range);
        const double complex both = further_echo(sea, 0, 1, sight.range);
        expect_echo(both, first + second);
        if (cases[i].off != 0.0)
            continue;
        const double complex plane_wave = -I * sqrt(2.0) * cases[i].wide * cases[i].length /
                                          WAVELENGTH *
                                          cexp(2.0 * I * sea_wavenumber(sea) * sight.range);
        expect_echo(further_echo(sea, 0, 0, sight.range), first);
        expect_echo(further_echo(sea, 1, 1, sight.range), second);
        expect_close("closed form, dB re 1 m^2", decibels_of_amplitude(cabs(both)),
                     decibels_of_amplitude(cabs(plane_wave)), LEVEL_DB);
        expect_close("phase off that of a plane wave, rad", carg(both / plane_wave), 0.0, 0.2);
    }
}

/* Two faces echo in proportion, however little they reflect. 2 * 10^4 rays bring some 50 quanta
 * each, rounded by chance. The tolerance is four times half a quantum over 50, and over the root of
 * the number of rays. */
CLAIM(weak_faces_echo_in_proportion)
{
    struct sea *sea = open_at(2);
    const struct sight sight = lay_dihedral(sea, 0.2, 0.15, false, 0.0);
    const double complex strong = further_echo(sea, 0, 1, sight.range);
    for (uint32_t part = 0; part < 2; part++)
        sea->bench->placements[part].material.reflection = 1e-3;
    const double complex weak = further_echo(sea, 0, 1, sight.range) / 1e-6;
    expect_close("level of weak faces", cabs(weak / strong), 1.0, 3e-4);
    expect_close("phase of weak faces, rad", carg(weak / strong), 0.0, 3e-4);
}

/* Puts a plate, part 1, `distance` away from the middle along `onward`, so that it sends the sound
 * home. Gives the normal with which a first part at the middle sends sound along `onward`. */
static void lay_plate(struct sea *sea, const struct sight *sight, const double onward[3],
                      double distance, double normal_of_first[3])
{
    double normal[3], centre[3], aside[3], own_y[3];
    mix(1.0, sight->to_sonar, 1.0, onward, normal_of_first);
    mix(1.0, sight->to_sonar, -1.0, onward, normal);
    for (int k = 0; k < 3; k++) {
        normal_of_first[k] *= sqrt(0.5); /* onward is at right angles to the sight */
        normal[k] *= sqrt(0.5);
    }
    cross(sight->to_sonar, onward, aside);
    cross(normal, aside, own_y);
    mix(1.0, sight->middle, distance, onward, centre);
    sea_put(sea, 1, centre, aside, own_y);
}

/* A sphere spreads the sound that comes to a plate beside it, by geometrical optics. */
CLAIM(a_sphere_and_a_plate)
{
    const double radius = 0.15;
    static const double distances[] = {0.6, 1.0}, asides[] = {0.0, 0.8};
    for (int i = 0; i < 2; i++) {
        struct sea *sea = open_at(2);
        sea_add_sphere(sea, radius, 1.0);
        add_plate(sea, 0.5, 0.5);
        sea_ready(sea);
        const struct sight sight = sight_of(sea, 3.0);
        const double aside = asides[i];
        double onward[3], normal[3], own_y[3], centre[3];
        mix(sqrt(1.0 - aside * aside), sight.up, aside, sight.along, onward);
        lay_plate(sea, &sight, onward, distances[i], normal);
        mix(-aside, sight.up, sqrt(1.0 - aside * aside), sight.along, own_y);
        mix(1.0, sight.middle, -radius, normal, centre); /* its specular point is at the middle */
        sea_put(sea, 0, centre, normal, own_y);
        const struct multibounce_way way = straight_way(sea);
        const struct face sphere = {0, FACE_SPHERE, radius, {-1.4, -1.4}, {1.4, 1.4}};
        const struct face plate = face_of_plane(sea, 1);
        const double range = multibounce_range(&way, sight.middle, sea_centre(sea, 1));
        print_message("%.1f m away, %.1f along the track\n", distances[i], aside);
        expect_echo(further_echo(sea, 0, 0, range),
                    multibounce_echo(sea, &way, &sphere, &plate, SPACING, range));
        expect_echo(further_echo(sea, 1, 1, range),
                    multibounce_echo(sea, &way, &plate, &sphere, SPACING, range));
    }
}

/* The inner side of a tube focuses sound on a line, before or beyond the plate. A line before the
 * plate turns the phase by -pi/2. */
CLAIM(a_caustic)
{
    static const double radii[] = {
        1.0, 0.2}; /* focal lengths across the tube at 45 degrees: 0.71 and 0.14 m */
    static const double distances[] = {0.09, 0.45};
    static const double widths[] = {0.1, 0.4}; /* of the plate, which must not hide the tube */
    for (int i = 0; i < 4; i++) {
        const double radius = radii[i / 2], half_angle = fmin(0.3 / radius, 1.2);
        const double length = 0.15;
        struct sea *sea = open_at(2);
        sonject_object_params *tube = sea_add(sea, SHAPE_CYLINDER, length, 0.0, 2.0 * radius);
        tube->burial_m = -1.0;
        tube->nose_end = tube->tail_end = SONJECT_END_OPEN;
        add_plate(sea, 0.4, widths[i / 2]);
        sea_ready(sea);
        const struct sight sight = sight_of(sea, 3.0);
        const bool is_aside = i % 2 == 1;
        const double *onward = is_aside ? sight.along : sight.up;
        double normal[3], own_y[3], centre[3], axis[3];
        lay_plate(sea, &sight, onward, distances[i / 2], normal);
        mix(-1.0, normal, 0.0, normal, own_y);
        mix(1.0, sight.middle, radius, normal, centre);
        mix(sqrt(0.5), onward, -sqrt(0.5), sight.to_sonar, axis); /* sound comes in by an end */
        sea_put(sea, 0, centre, axis, own_y);
        const struct multibounce_way way = straight_way(sea);
        const struct face inside = {
            0, FACE_INSIDE_TUBE, radius, {-0.5 * length, -half_angle}, {0.5 * length, half_angle}};
        const struct face plate = face_of_plane(sea, 1);
        const double range = multibounce_range(&way, sight.middle, sea_centre(sea, 1));
        print_message("%.2f m away, %s\n", distances[i / 2], is_aside ? "along" : "across");
        expect_echo(further_echo(sea, 0, 0, range),
                    multibounce_echo(sea, &way, &inside, &plate, SPACING, range));
    }
}

/* Puts a plate so that it mirrors sound that goes along `in` into `out`, both unit vectors. */
static void put_mirror(struct sea *sea, uint32_t part, const double centre[3], const double in[3],
                       const double out[3])
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
    sea_put(sea, part, centre, aside, own_y);
}

/* Sound goes from one plate by way of the seabed to the other. */
CLAIM(the_seabed_between_two_faces)
{
    struct sea *sea = open_at(3);
    set_mirror(&sea->seabed->forward, -0.7);
    add_plate(sea, 0.2, 0.2);
    add_plate(sea, 0.2, 0.2);
    sea_ready(sea);
    const struct sight sight = sight_of(sea, 0.25);
    static const double down[3] = {0.6, 0.0, -0.8}, up[3] = {0.6, 0.0, 0.8};
    double from_sonar[3], other[3];
    mix(-1.0, sight.to_sonar, 0.0, down, from_sonar);
    mix(1.0, sight.middle, 0.3125, down, other);
    mix(1.0, other, 0.3125, up, other);
    put_mirror(sea, 0, sight.middle, from_sonar, down);
    put_mirror(sea, 1, other, up, sight.to_sonar);
    struct multibounce_way way = straight_way(sea);
    way.is_folded = true;
    const struct face one = face_of_plane(sea, 0), two = face_of_plane(sea, 1);
    const double range = multibounce_range(&way, sight.middle, other);
    expect_echo(further_echo(sea, 0, 0, range),
                -0.7 * multibounce_echo(sea, &way, &one, &two, SPACING, range));
    expect_echo(further_echo(sea, 1, 1, range),
                -0.7 * multibounce_echo(sea, &way, &two, &one, SPACING, range));
}

/* Sound goes by way of the seabed to two plates and straight home. The reverse is traced. */
CLAIM(the_seabed_before_two_faces)
{
    for (uint32_t interactions = 2; interactions <= 3; interactions++) {
        struct sea *sea = open_at(interactions);
        set_mirror(&sea->seabed->forward, -0.7);
        add_plate(sea, 0.2, 0.2);
        add_plate(sea, 0.2, 0.2);
        sea_ready(sea);
        const struct sight sight = sight_of(sea, 3.0);
        struct multibounce_way way = straight_way(sea);
        way.height_home = -way.height_out;
        const double drop = way.height_home - sight.middle[2];
        const double reach = hypot(sight.middle[1], drop);
        const double from_image[3] = {0.0, sight.middle[1] / reach, -drop / reach};
        double other[3];
        mix(1.0, sight.middle, 0.4, sight.along, other);
        put_mirror(sea, 0, sight.middle, from_image, sight.along);
        put_mirror(sea, 1, other, sight.along, sight.to_sonar);
        const struct face one = face_of_plane(sea, 0), two = face_of_plane(sea, 1);
        const double range = multibounce_range(&way, other, sight.middle);
        const double complex expected =
            2.0 * -0.7 * multibounce_echo(sea, &way, &two, &one, SPACING, range);
        const double complex measured = further_echo(sea, 1, 1, range);
        if (interactions == 3)
            expect_echo(measured, expected);
        else /* plates return a little by way of the seabed alone */
            expect_below("without a third interaction", cabs(measured / expected), 0.05);
    }
}

/* All of a corner with an upright edge is focused on the edge's own pixel. With an edge along the
 * track each pixel has the part within the resolution. Each object has the half that meets it
 * first. In the columns of the first hit the halves of an upright corner lie on its two sides. */
CLAIM(a_corner_in_the_image)
{
    const double a = 0.2;
    for (int is_upright = 0; is_upright < 2; is_upright++) {
        struct sea *sea = open_at(2);
        lay_dihedral(sea, a, is_upright ? 0.15 : 1.0, is_upright, 0.0);
        const struct image *image = sea_image(sea);
        const double expected = sqrt(2.0) * a * (is_upright ? 0.15 : 0.025) / WAVELENGTH;
        print_message("edge %s the track\n", is_upright ? "across" : "along");
        expect_close("pixel, dB re 1 m^2",
                     decibels_of_amplitude(cabs(image->target[(ROWS / 2) * COLUMNS + COLUMNS / 2])),
                     decibels_of_amplitude(expected), LEVEL_DB);
        for (uint32_t i = 0; i < 2; i++) {
            const struct object_echo *echo = &image->objects[i];
            const size_t at = (ROWS / 2) * echo->columns + COLUMNS / 2 - echo->first_column;
            expect_close("object, dB re 1 m^2", decibels_of_energy(echo->energy[at]),
                         decibels_of_amplitude(0.5 * expected), LEVEL_DB);
        }
    }
    struct sea *sea = open_at(2);
    sea->injection->column_rule = SONJECT_COLUMNS_PAPER;
    lay_dihedral(sea, 0.3, 0.15, true, 0.0);
    const struct image *image = sea_image(sea);
    for (int row = -4; row <= 4; row += 8) { /* 0.1 m to each side, of 0.21 m */
        const size_t at = (size_t)(ROWS / 2 + row) * COLUMNS + COLUMNS / 2;
        expect_close("pixel, dB re 1 m^2", decibels_of_amplitude(cabs(image->target[at])),
                     decibels_of_amplitude(0.15 * 0.025 / WAVELENGTH), LEVEL_DB);
    }
}

/* No bit changes where sound cannot meet a second smooth face: with a convex part alone or beside a
 * rough one, or with one interaction. */
CLAIM(no_second_face_changes_nothing)
{
    struct line before = {0, 0.0, 0.0, NULL};
    for (int i = 0; i < 5; i++) {
        static const uint32_t interactions[] = {1, 2, 5, 4, 1};
        struct sea *sea = open_at(interactions[i]);
        sea_add(sea, SHAPE_CAPSULE, 0.6, 0.0, 0.3)->heading_rad = 0.05;
        if (i >= 3) {
            sonject_object_params *box = sea_add(sea, SHAPE_BOX, 0.3, 0.3, 0.0);
            box->height_m = 0.3;
            place_in_metres(box, 0.0, RANGE + 1.5);
            if (i == 3)
                make_rough(box, 0.1);
        }
        const struct line line = sea_line(sea, 0);
        if (i > 0) {
            assert_int_equal(line.bins, before.bins);
            assert_memory_equal(line.values, before.values, line.bins * sizeof *line.values);
        }
        before = line;
    }
}
