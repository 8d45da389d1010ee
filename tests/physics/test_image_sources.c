/* Glints and rough echoes by way of plane mirrors, the seabed and the sea surface, through layers
 * or none. The reference is worked out from image sources and stationary points, in double
 * precision. Levels have a systematic tolerance of 0.2 dB. */
#include "layered_sea.h"

#define ROWS       101
#define COLUMNS    201
#define RANGE      50.0
#define LEVEL_DB   0.2
#define PHASE      0.05 /* rad; stationary phase errs by 1/(2ka), 1/126 for a = 0.15 m */
#define WAVELENGTH 0.015

static struct sea *open_at(double range_m, size_t columns, uint32_t interactions, double reflection)
{
    struct sea *sea = sea_open(ROWS, columns, range_m);
    sea->injection->interactions = interactions;
    if (reflection != 0.0)
        set_mirror(&sea->seabed->forward, reflection);
    return sea;
}

/* Warm water over a thermocline; the sonar in the slower water; and a plane that reflects. */
static const struct water_layer thermocline[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 1.0}};
static const struct water_layer slow_above[] = {{0.0, 1520.0, 1.0}, {8.0, 1490.0, 1.0}};
static const struct water_layer light_above[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 0.4}};

/* Two layers (or none), the patch's range, heights of sonar and surface, the seabed's reflection,
 * roughness, the height of the sphere's lowest point, the limit of interactions, and the most
 * bounces of the compared families. is_sand: the seabed is coarse sand (APL-UW TR 9407). With more
 * interactions there are images of three bounces, beyond the compared ranges. At these heights
 * families that overlap do not cancel. */
struct mirror_case {
    const struct water_layer *layers;
    double range, altitude, depth, reflection, seabed_roughness, surface_roughness, height;
    size_t columns;
    uint32_t interactions, bounces;
    bool is_sand;
};

static struct sea *open_case(const struct mirror_case *mirrors)
{
    struct sea *sea =
        open_at(mirrors->range, mirrors->columns, mirrors->interactions, mirrors->reflection);
    sonject_material_params *seabed = &sea->seabed->forward;
    sea->sonar->altitude_m = mirrors->altitude;
    sea->surface->water_depth_m = mirrors->depth;
    sea->surface->material.roughness_m = mirrors->surface_roughness;
    seabed->roughness_m = mirrors->seabed_roughness;
    if (mirrors->is_sand) {
        set_mirror(seabed, 0.0);
        seabed->reflection_kind = SONJECT_REFLECTION_FLUID;
        seabed->density_ratio = 2.231;
        seabed->speed_ratio = 1.2503;
        seabed->loss = 0.01638;
    }
    if (mirrors->layers) {
        sea->medium->reference_sound_speed_mps = REFERENCE;
        sea_set_layers(sea, mirrors->layers, 2);
    }
    sea_add_sphere(sea, 0.15, mirrors->height);
    sea_ready(sea);
    return sea;
}

/* A sphere high over a smooth seabed, or under a surface, returns a/2 (1, 2R, R^2) at its three
 * ranges. In shallow water there is every family of up to two mirrors a leg. */
CLAIM(glints_by_mirrors)
{
    static const struct mirror_case cases[] = {
        {NULL, RANGE, 10.0, 0.0, 1.0, 0.0, 0.0, 3.0, 401, 3, 2, false},
        {NULL, RANGE, 10.0, 0.0, -1.0, 0.0, 0.0, 3.0, 401, 3, 2, false},
        {NULL, RANGE, 10.0, 0.0, 0.5, 1e-3, 0.0, 3.0, 401, 3, 2, false},
        {NULL, RANGE, 10.0, 0.0, 0.0, 0.0, 0.0, 3.0, 401, 3, 2, true},
        {NULL, 450.0, 60.0, 0.0, 1.0, 0.0, 0.0, 3.0, 401, 3, 2, false},
        {NULL, 450.0, 60.0, 0.0, -1.0, 0.0, 0.0, 3.0, 401, 3, 2, false},
        {NULL, 450.0, 60.0, 0.0, 0.5, 1e-3, 0.0, 3.0, 401, 3, 2, false},
        {NULL, 450.0, 60.0, 0.0, 0.0, 0.0, 0.0, 3.0, 401, 3, 2, true},
        {NULL, RANGE, 10.0, 14.0, 0.0, 0.0, 0.0, 3.0, COLUMNS, 3, 2, false},
        {NULL, RANGE, 5.0, 9.0, 0.8, 0.0, 0.0, 1.35, COLUMNS, 1, 0, false},
        {NULL, RANGE, 5.0, 9.0, 0.8, 0.0, 0.0, 1.35, COLUMNS, 2, 1, false},
        {NULL, RANGE, 5.0, 9.0, 0.8, 0.0, 0.0, 1.35, COLUMNS, 3, 2, false},
        {NULL, RANGE, 5.0, 9.0, 0.8, 0.0, 0.0, 1.35, COLUMNS, 4, 2, false},
        {NULL, RANGE, 5.0, 9.0, 0.8, 0.0, 0.0, 1.35, COLUMNS, 5, 1, false},
        {thermocline, 40.0, ALTITUDE, 25.0, 0.8, 0.0, 1e-3, 3.0, 1001, 3, 2, false},
        {thermocline, 120.0, ALTITUDE, 25.0, 0.8, 0.0, 1e-3, 6.9, 1001, 3, 2, false},
        {slow_above, 45.0, ALTITUDE, 25.0, 0.0, 0.0, 3e-3, 4.0, 501, 2, 1, false},
        {slow_above, 130.0, ALTITUDE, 25.0, 0.0, 0.0, 3e-3, 4.0, 501, 2, 1, false},
        {light_above, 50.0, ALTITUDE, 25.0, 0.0, 0.0, 3e-3, 4.0, 501, 2, 1, false},
        {light_above, 120.0, ALTITUDE, 25.0, 0.0, 0.0, 3e-3, 4.0, 501, 2, 1, false},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct sea *sea = open_case(&cases[i]);
        const struct line line = sea_line(sea, 0);
        print_message("R %.1f at %.0f m, %u interactions\n", cases[i].reflection, cases[i].range,
                      (unsigned)cases[i].interactions);
        expect_families(sea, &line, cases[i].bounces);
        if (i != 1 && i != 8) /* the closed form itself: twice a/2, sign reversed */
            continue;
        const double range = family_of(sea, SONAR, i == 1 ? BY_SEABED : BY_SURFACE).range;
        const double complex echo =
            line_at(sea, &line, range) * cexp(-2.0 * I * sea_wavenumber(sea) * range);
        expect_close("both ways by the mirror re a/2, dB",
                     decibels_of_amplitude(cabs(echo) / 0.075), decibels_of_amplitude(2.0),
                     LEVEL_DB);
        expect_close("sign", creal(echo) / cabs(echo), -1.0, 0.01);
    }
}

/* A glint of which roughness leaves no more than exp(-12) is not traced. The straight glint is at
 * normal incidence. The one by way of the seabed is at half the angle between the two directions,
 * here some 44 degrees. */
CLAIM(roughness_that_leaves_no_glint_is_not_traced)
{
    static const struct {
        double exponent, reflection;
        bool has_glints;
    } cases[] = {{11.9, 0.0, true},
                 {12.1, 0.0, false},
                 {12.1, 1.0, true},
                 {12.1 / 0.75, 1.0, true},
                 {12.1 / 0.45, 1.0, false}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct mirror_case slant = {
            NULL, 14.0, 10.0, 0.0, cases[i].reflection, 0.0, 0.0, 3.0, COLUMNS, 3, 2, false};
        struct sea *sea = open_case(&slant);
        sea_object(sea, 0)->material.roughness_m =
            sqrt(2.0 * cases[i].exponent) / (2.0 * sea_wavenumber(sea));
        sea_ready(sea);
        const struct line line = sea_line(sea, 0);
        print_message("exp(-%.1f), seabed's R %.0f: energy %g\n", cases[i].exponent,
                      cases[i].reflection, line_energy(&line));
        assert_int_equal(line.bins > 0, cases[i].has_glints);
    }
}

/* Lloyd's mirror for a pulse far longer than the paths differ: there and back the amplitude is
 * |e^{ikR1}/R1 + R e^{ikR2}/R2|^2. */
CLAIM(lloyds_mirror)
{
    static const double reflections[] = {-1.0, 0.6};
    for (size_t i = 0; i < 24; i++) {
        const double reflection = reflections[i / 12];
        const double a = 0.1; /* physical optics' edges add 1/(2ka) to each family */
        struct sea *sea = open_at(RANGE, COLUMNS, 3, 0.0);
        sea->sonar->bandwidth_hz = 100.0;
        /* so low that the sonar and its image see the same point of the sphere */
        sea->sonar->altitude_m = 1.0;
        sea_add_sphere(sea, a, 0.1 + 0.033 * (double)(i % 12)); /* a fringe is 0.375 m high */
        sea_ready(sea);
        const double y = sea_centre(sea, 0)[1], z = sea_centre(sea, 0)[2];
        const double r1 = hypot(y, z - 1.0), r2 = hypot(y, z + 1.0), k = sea_wavenumber(sea);
        const struct line free_field = sea_line(sea, 0);
        set_mirror(&sea->seabed->forward, reflection);
        const struct line with_mirror = sea_line(sea, 0);
        const double complex one_way = cexp(I * k * r1) / r1 + reflection * cexp(I * k * r2) / r2;
        /* 0.2 dB of the brightest fringe, 4 */
        expect_close("amplitude re free field",
                     cabs(line_at(sea, &with_mirror, r1 - a) / line_at(sea, &free_field, r1 - a)),
                     pow(cabs(one_way) * r1, 2.0), 0.023 * 4.0);
    }
}

/* Returns physical optics' echo of an upright wall of height b on the seabed, for two heights of
 * sources. The fan's wavefronts do not curve along-track. */
static double complex wall_family(const struct sea *sea, double b, double length, double one,
                                  double other, double range)
{
    const double y = sea_centre(sea, 0)[1], k = sea_wavenumber(sea), step = WAVELENGTH / 100.0;
    double complex sum = 0.0;
    for (double z = 0.5 * step; z < b; z += step) {
        const double r1 = hypot(y, z - one), r2 = hypot(y, z - other);
        const double half_range = 0.5 * (r1 + r2);
        sum += (y / r1 + y / r2) * cexp(2.0 * I * k * half_range) * half_range * half_range /
               (r1 * r2) * sea_pulse(sea, range - half_range) * step;
    }
    return -I / (2.0 * WAVELENGTH) * length * sum;
}

/* D-M (out direct, home by the mirror) and M-D together give sigma = (2 A cos(grazing)/lambda)^2.
 * The buried part of the wall does not count. */
CLAIM(a_wall_on_the_seabed)
{
    const double b = 0.2, length = 0.3;
    double complex before = 0.0;
    for (uint32_t i = 0; i < 6; i++) {
        const uint32_t interactions = 1 + i % 3;
        const double buried = i < 3 ? 0.0 : 0.15;
        struct sea *sea = open_at(30.0, COLUMNS, interactions, 1.0);
        sonject_object_params *object = sea_add(sea, SHAPE_PLANE, length, b + buried, 0.0);
        object->roll_rad = 0.5 * PI;
        object->burial_m = buried;
        const struct line line = sea_line(sea, 0);
        const double y = sea_centre(sea, 0)[1], corner = hypot(y, 10.0);
        const double complex measured = line_at(sea, &line, corner);
        double complex expected = wall_family(sea, b, length, 10.0, 10.0, corner);
        expected += 2.0 * wall_family(sea, b, length, 10.0, -10.0, corner);
        if (interactions >= 3)
            expected += wall_family(sea, b, length, -10.0, -10.0, corner);
        print_message("%u interactions, %.2f m buried\n", (unsigned)interactions, buried);
        if (interactions >= 2) {
            expect_close("level, dB re 1 m^2", decibels_of_amplitude(cabs(measured)),
                         decibels_of_amplitude(cabs(expected)), LEVEL_DB);
            expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
        }
        if (interactions == 2)
            expect_close(
                "D-M and M-D, closed form, dB", decibels_of_amplitude(cabs(measured - before)),
                decibels_of_amplitude(2.0 * b * length * y / corner / WAVELENGTH), LEVEL_DB);
        before = measured;
    }
}

/* A sphere is half buried. With its image in a rigid seabed the rest is a whole sphere, which the
 * sonar and its image see from two sides. So D-M and M-D together return a/2, not 2 a/2. No path
 * leads to a wholly buried sphere, from either side. */
CLAIM(buried_spheres)
{
    double complex before = 0.0;
    for (uint32_t interactions = 1; interactions <= 2; interactions++) {
        struct sea *sea = open_at(RANGE, COLUMNS, interactions, 1.0);
        sea_add_sphere(sea, 0.3, -0.3);
        sea_ready(sea);
        const struct family family = family_of(sea, SONAR, BY_SEABED);
        const struct line line = sea_line(sea, 0);
        const double complex echo = line_at(sea, &line, family.range) - before;
        if (interactions == 2) {
            expect_close("D-M and M-D re a/2, dB", decibels_of_amplitude(cabs(echo) / 0.15), 0.0,
                         LEVEL_DB);
            expect_close("phase off the reference, rad", carg(echo / family.amplitude), 0.0, PHASE);
        }
        before = echo;
    }
    struct sea *sea = open_at(RANGE, COLUMNS, 3, 1.0);
    sea->surface->water_depth_m = 14.0;
    sea_add_sphere(sea, 0.15, -0.5);
    const struct line line = sea_line(sea, 0);
    assert_true(line_energy(&line) == 0.0);
}

/* Adds a black plate, level or upright, with its foot at a height. It is `beyond` m behind the
 * point of the seabed that mirrors the sonar into the first object. */
static void add_plate(struct sea *sea, double wide, double beyond, double height, bool is_upright,
                      double along)
{
    const double *centre = sea_centre(sea, 0);
    const double at = centre[1] * 10.0 / (10.0 + centre[2]) + beyond;
    sonject_object_params *plate = sea_add(sea, SHAPE_PLANE, 0.8, wide, 0.0);
    plate->material.reflection = 0.0;
    plate->burial_m = -height;
    plate->roll_rad = is_upright ? 0.5 * PI : 0.0;
    place_in_metres(plate, (ROWS / 2) * 0.025 + along, hypot(at, 10.0));
    sea_ready(sea);
}

/* An object on the point of reflection, or hiding it from either side, closes the way by the
 * seabed. Beside the point the way is open. The straight way stays open. */
CLAIM(a_hidden_reflection_is_not_heard)
{
    static const struct {
        double beyond, height, along;
        bool is_upright;
    } plates[] = {
        {0.0, 0.05, 0.0, false}, {-1.5, 0.0, 0.0, true}, {1.0, 0.0, 0.0, true}, {0, 0, 0.7, false}};
    for (size_t i = 0; i < COUNT(plates); i++) {
        struct sea *sea = open_at(RANGE, 601, 3, 1.0);
        sea_add_sphere(sea, 0.15, 0.5);
        sea_ready(sea);
        add_plate(sea, 0.6, plates[i].beyond, plates[i].height, plates[i].is_upright,
                  plates[i].along);
        const struct line line = sea_line(sea, 0);
        print_message("plate %zu\n", i);
        for (enum image_of_sonar out = SONAR; out <= BY_SEABED && plates[i].along == 0.0; out++) {
            const double range = family_of(sea, out, BY_SEABED).range;
            /* the straight echo leaves the residual of physical optics there */
            expect_below("closed way, dB re a/2",
                         decibels_of_amplitude(cabs(line_at(sea, &line, range)) / 0.075), -30.0);
        }
        if (plates[i].along == 0.0)
            sea->injection->interactions = 1; /* for the reference alone */
        expect_families(sea, &line, 1);
    }
}

/* A surface that cannot be heard in the patch changes no bit of it. One that can be heard does. */
CLAIM(a_far_surface_changes_nothing)
{
    static const double depths[] = {0.0, 10000.0, 14.0};
    const struct image *images[3];
    for (size_t i = 0; i < 3; i++) {
        struct sea *sea = open_at(RANGE, COLUMNS, 3, 0.0);
        sea->surface->water_depth_m = depths[i];
        sonject_object_params *object = sea_add_sphere(sea, 0.15, 0.0);
        object->material.lambert = 0.05;
        object->material.roughness_m = 1e-3;
        images[i] = sea_image_of(sea, NULL, true);
    }
    assert_false(images_differ(images[0], images[1]));
    assert_true(images_differ(images[0], images[2]));
}

/* The image holds the families of the line, and its energies are those of its field. */
CLAIM(families_in_the_image)
{
    static const enum image_of_sonar pairs[][2] = {
        {SONAR, SONAR}, {SONAR, BY_SEABED}, {BY_SEABED, BY_SEABED}};
    struct sea *sea = open_at(RANGE, COLUMNS, 3, -1.0);
    sea->sonar->bandwidth_hz = 15e3; /* columns sample the pulse's energy within 1e-5 */
    sea_add_sphere(sea, 0.15, 3.0);
    const struct image *image = sea_image(sea);
    double straight = 0.0;
    for (int i = 0; i < 3; i++) {
        const double middle = sea_column(sea, family_of(sea, pairs[i][0], pairs[i][1]).range);
        double energy = 0.0, field = 0.0;
        for (size_t column = (size_t)middle - 8; column <= (size_t)middle + 9; column++) {
            const size_t at = (ROWS / 2) * COLUMNS + column;
            energy += image->target_energy[at];
            field += pow(cabs(image->target[at]), 2.0);
        }
        straight = i == 0 ? field : straight;
        expect_close("energy over field", energy / field, 1.0, 1e-5);
        expect_close("re straight echo, dB", decibels_of_energy(field / straight),
                     i == 1 ? decibels_of_amplitude(2.0) : 0.0, LEVEL_DB);
    }
}

/* The residual of D-M and M-D where a smooth convex body returns nothing is below -64 dB re 1 m^2
 * at the default number of rays, as there and back straight (tests/physics/test_glints.c). */
CLAIM(little_is_left_beside_a_mirrored_glint)
{
    const double a = 0.4;
    const struct image *images[2];
    size_t first = 0, last = 0;
    for (uint32_t i = 0; i < 2; i++) {
        struct sea *sea = open_at(RANGE, COLUMNS, 1 + i, 1.0);
        sea_add_sphere(sea, a, 2.5);
        images[i] = sea_image(sea);
        const double range = family_of(sea, SONAR, BY_SEABED).range;
        first = (size_t)ceil(sea_column(sea, range) + 5.0);
        last = (size_t)floor(sea_column(sea, range + 0.6 * a));
    }
    double sum = 0.0;
    assert_true(last > first);
    for (size_t row = ROWS / 2 - 14; row <= ROWS / 2 + 14; row++)
        for (size_t at = row * COLUMNS + first; at <= row * COLUMNS + last; at++)
            sum += pow(cabs(images[1]->target[at] - images[0]->target[at]), 2.0);
    expect_below("residual, dB re 1 m^2",
                 decibels_of_energy(sum / (29.0 * (double)(last - first + 1))), -64.0);
}

/* A rough sphere lies over a smooth seabed, once with both sources in one direction, since they are
 * low, or under a surface, through a thermocline. */
CLAIM(rough_spheres_by_mirrors)
{
    static const struct {
        struct mirror_case sea;
        enum image_of_sonar image;
        double systematic; /* a/r, which the reference leaves out */
    } cases[] = {
        {{NULL, RANGE, 1.0, 0.0, -0.7, 0.0, 0.0, 0.3, COLUMNS, 3, 0, false}, BY_SEABED, 0.003},
        {{NULL, RANGE, 10.0, 0.0, 1.0, 0.0, 0.0, 3.0, COLUMNS, 3, 0, false}, BY_SEABED, 0.003},
        {{thermocline, 42.0, ALTITUDE, 25.0, 0.0, 0.0, 0.0, 3.0, 401, 3, 0, false},
         BY_SURFACE,
         0.005},
        {{thermocline, 122.0, ALTITUDE, 25.0, 0.0, 0.0, 0.0, 3.0, 401, 3, 0, false},
         BY_SURFACE,
         0.005},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        double ratios[6], expected = 0.0;
        for (uint64_t seed = 0; seed < 6; seed++) {
            double sum[2];
            for (uint64_t mirrored = 0; mirrored < 2; mirrored++) {
                struct sea *sea = open_case(&cases[i].sea);
                sea->sonar->bandwidth_hz = 15e3; /* columns sample the pulse's energy */
                sea->injection->interactions = mirrored ? 3 : 1;
                sea->injection->seed = 1 + seed + 6 * mirrored;
                sea->seabed->lambert = 1e-9; /* to leave out chains by the seabed */
                make_rough(sea_object(sea, 0), 0.1);
                const struct image *image = sea_image(sea);
                sum[mirrored] = sum_of(image->target_energy, image->pixels);
                expected = rough_ratio(sea, cases[i].image,
                                       cases[i].image == BY_SEABED ? cases[i].sea.reflection : 1.0);
            }
            ratios[seed] = sum[1] / sum[0];
        }
        expect_estimate("energy over the straight one's", estimate_of(ratios, 6), expected,
                        cases[i].systematic * expected);
    }
}

/* A plate over the point of reflection takes away a rough sphere's echoes by way of the seabed. */
CLAIM(a_rough_sphere_behind_a_hidden_reflection)
{
    double sum[3];
    for (uint32_t i = 0; i < 3; i++) { /* straight; mirror; mirror behind a plate */
        struct sea *sea = open_at(RANGE, 601, i ? 3 : 1, 1.0);
        make_rough(sea_add_sphere(sea, 0.15, 0.5), 0.1);
        sea_ready(sea);
        add_plate(sea, 2.4, 0.0, 0.02, false, i == 2 ? 0.0 : 0.7);
        const struct image *image = sea_image(sea);
        sum[i] = sum_of(image->target_energy, image->pixels);
    }
    assert_true(sum[1] > 3.0 * sum[0]);
    /* nothing is left but what sphere, plate and seabed scatter to one another */
    expect_close("hidden over straight", sum[2] / sum[0], 1.0, 1e-3);
}
