/* Targets in layers that bend sound: their echoes' travel times and levels, and their shadows. The
 * reference integrates the differential equation of rays through the profile itself, in small steps
 * of height from sonar to target and back. It uses Snell's law only where the speed jumps. Its ray
 * tubes are differences between neighbouring rays. */
#include "layered_sea.h"

#define TIME     1e-6 /* relative */
#define LEVEL_DB 0.05
#define STEPS    200 /* of a piece */
#define PIECES   4
#define TURN     1e-5 /* rad, between neighbouring rays */

/* A piece of a profile, from the seabed upwards. The sound speed is linear between both ends. */
struct piece {
    double bottom, speed_below, top, speed_above;
};

/* Warm water above; cold water above; a thermocline of 1 m; one without height, 2 m up. */
static const struct profile {
    const char *name;
    struct piece pieces[PIECES];
} profiles[] = {
    {"warm above", {{0.0, 1485.0, 12.0, 1503.0}, {12.0, 1503.0, 25.0, 1503.0}}},
    {"cold above", {{0.0, 1500.0, 25.0, 1475.0}}},
    {"thermocline",
     {{0.0, 1490.0, 1.5, 1490.0}, {1.5, 1490.0, 2.5, 1496.0}, {2.5, 1496.0, 25.0, 1497.0}}},
    {"sharp thermocline", {{0.0, 1490.0, 2.0, 1490.0}, {2.0, 1496.0, 25.0, 1496.0}}},
};

static const struct profile even = {"one sound speed", {{0.0, 1490.0, 25.0, 1490.0}}};

/* Height over the seabed and processor range of each profile's targets. */
static const double places[][2] = {{1.0, 30.0}, {1.6, 55.0}, {2.3, 70.0}, {4.0, 40.0}, {6.0, 90.0}};

static struct sea *open_sea(const struct profile *profile, size_t rows, size_t columns,
                            double middle)
{
    static struct water_layer layers[WATER_LAYERS_MAX];
    size_t count = 0;
    for (const struct piece *piece = profile->pieces;
         piece < profile->pieces + PIECES && piece->top > 0.0; piece++) {
        /* as thin as the layers that the library makes of a profile */
        const double rise = piece->speed_above - piece->speed_below;
        const size_t thin = (size_t)(fabs(rise) / 0.05) + 1;
        for (size_t i = 0; i < thin; i++) {
            const struct water_layer layer = {
                piece->bottom + (piece->top - piece->bottom) * (double)i / (double)thin,
                piece->speed_below + rise * ((double)i + 0.5) / (double)thin, 1.0};
            layers[count++] = layer;
        }
    }
    print_message("%s, %.0f m\n", profile->name, middle);
    return layered_sea_open(rows, columns, middle, layers, count);
}

/* ---- the reference ---- */

struct ray {
    double range, time, grazing;
};

static struct ray slope(const struct piece *piece, double height, struct ray ray)
{
    const double gradient =
        (piece->speed_above - piece->speed_below) / (piece->top - piece->bottom);
    const double speed = piece->speed_below + gradient * (height - piece->bottom);
    const struct ray rise = {1.0 / tan(ray.grazing), 1.0 / (speed * sin(ray.grazing)),
                             -gradient / (speed * tan(ray.grazing))};
    return rise;
}

static struct ray step(struct ray ray, struct ray slope, double way, double rise)
{
    const struct ray next = {ray.range + way * slope.range, ray.time + way * slope.time,
                             ray.grazing + rise * slope.grazing};
    return next;
}

/* Follows a ray within a piece by Runge and Kutta's rule. A level ray gets an infinite range. */
static struct ray cross(const struct piece *piece, double from, double to, struct ray ray)
{
    const double rise = (to - from) / STEPS, way = fabs(rise);
    for (int i = 0; i < STEPS; i++) {
        const double z = from + i * rise;
        const struct ray a = slope(piece, z, ray);
        const struct ray b = slope(piece, z + 0.5 * rise, step(ray, a, 0.5 * way, 0.5 * rise));
        const struct ray c = slope(piece, z + 0.5 * rise, step(ray, b, 0.5 * way, 0.5 * rise));
        const struct ray d = slope(piece, z + rise, step(ray, c, way, rise));
        ray = step(ray, a, way / 6.0, rise / 6.0);
        ray = step(ray, b, way / 3.0, rise / 3.0);
        ray = step(ray, c, way / 3.0, rise / 3.0);
        ray = step(ray, d, way / 6.0, rise / 6.0);
        if (!(ray.grazing > 1e-3 && ray.range < 1e3))
            ray.range = INFINITY;
    }
    return ray;
}

/* Follows a ray from one height to another, up or down, with a grazing angle at the first. */
static struct ray follow(const struct profile *profile, double from, double to, double grazing)
{
    struct ray ray = {0.0, 0.0, grazing};
    double speed = 0.0;
    for (int i = 0; i < PIECES; i++) {
        const struct piece *piece = &profile->pieces[to > from ? i : PIECES - 1 - i];
        const double low = fmax(piece->bottom, fmin(from, to));
        const double high = fmin(piece->top, fmax(from, to));
        if (!(high > low))
            continue;
        const double gradient =
            (piece->speed_above - piece->speed_below) / (piece->top - piece->bottom);
        const double begin = to > from ? low : high, end = to > from ? high : low;
        const double first = piece->speed_below + gradient * (begin - piece->bottom);
        if (speed > 0.0)
            ray.grazing = acos(cos(ray.grazing) * first / speed);
        ray = cross(piece, begin, end, ray);
        speed = piece->speed_below + gradient * (end - piece->bottom);
    }
    return ray;
}

/* Returns the grazing angle at the sonar of the ray to a point. */
static double launch_angle(const struct profile *profile, double range, double height)
{
    double flat = 0.0, steep = 0.5 * PI;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (flat + steep);
        const struct ray ray = follow(profile, ALTITUDE, height, middle);
        *(ray.range < range ? &steep : &flat) = middle;
    }
    return 0.5 * (flat + steep);
}

/* Returns the change of range per rad of the angle at which a ray begins. */
static double growth(const struct profile *profile, double from, double to, double grazing)
{
    return fabs(follow(profile, from, to, grazing + TURN).range -
                follow(profile, from, to, grazing - TURN).range) /
           (2.0 * TURN);
}

/* Sound at a target. amplitude: the echo of a unit cross-section. */
struct sound {
    double time, grazing, amplitude;
};

static struct sound sound_at(const struct profile *profile, double range, double height)
{
    const double launch = launch_angle(profile, range, height);
    const struct ray ray = follow(profile, ALTITUDE, height, launch);
    const double out =
        cos(launch) / (range * sin(ray.grazing) * growth(profile, ALTITUDE, height, launch));
    const double home =
        cos(ray.grazing) / (range * sin(launch) * growth(profile, height, ALTITUDE, ray.grazing));
    const struct sound sound = {ray.time, ray.grazing,
                                pow(REFERENCE * ray.time, 2.0) * sqrt(out * home)};
    return sound;
}

/* ---- echoes ---- */

static void expect_time(const char *what, double time, double expected)
{
    print_message("travel time %s: off by %.2g of it\n", what, time / expected - 1.0);
    assert_true(fabs(time / expected - 1.0) < TIME);
}

/* Compares the echo of a small Lambert plate that faces its ray. All of it is equally far, but for
 * the wavefront's curvature, some 40 um. */
static void expect_plate(const struct profile *profile, double height, double range)
{
    const double side = 0.2;
    struct sea *sea = open_sea(profile, 41, 241, range);
    sea->sonar->bandwidth_hz = 15e3; /* columns sample the pulse's energy */
    sea->injection->ray_scale = 16.0;
    sea->seabed->lambert = 1e-9;
    sonject_object_params *object = sea_add(sea, SHAPE_PLANE, side, side, 0.0);
    object->burial_m = -height;
    object->heading_rad = -0.5 * PI;
    make_rough(object, 0.1);
    struct sound sound = {0};
    for (int i = 0; i < 4; i++) { /* turning moves the plate */
        sea_ready(sea);
        sound = sound_at(profile, sea_centre(sea, 0)[1], sea_centre(sea, 0)[2]);
        object->pitch_rad = sound.grazing - 0.5 * PI;
    }
    expect_time("to its middle", sea_slant_range(sea, 0) / sea->bench->water.straight_speed_mps,
                sound.time);
    const struct image *image = sea_image(sea);
    double sum = 0.0, moment = 0.0;
    for (size_t i = 0; i < image->pixels; i++) {
        sum += image->target_energy[i];
        moment += image->target_energy[i] * (sea_range(sea, (double)(i % image->columns)) - range);
    }
    const double pixel = sea->geometry->column_spacing_m * sea->geometry->row_spacing_m;
    const double point = sea_pulse_energy(sea) * sea_window_energy(sea);
    expect_time("of its echo",
                (range + moment / sum - side * side / (24.0 * REFERENCE * sound.time)) / REFERENCE,
                sound.time);
    expect_close("level, dB re that of the plate", decibels_of_energy(sum * pixel / point),
                 decibels_of_energy(0.1 * side * side * pow(sound.amplitude, 2.0)), LEVEL_DB);
}

/* Compares the time of a glint, which its phase tells. Returns the level over the expected one, dB:
 * through the pulse 0.06 in any water. The wavefront curves in elevation alone. */
static double sphere_excess(const struct profile *profile, double height, double range)
{
    const double a = 0.15;
    struct sea *sea = open_sea(profile, 31, 281, range);
    sea_add_sphere(sea, a, height);
    sea_ready(sea);
    const double *centre = sea_centre(sea, 0);
    const double grazing = sound_at(profile, centre[1], centre[2]).grazing;
    const struct sound sound =
        sound_at(profile, centre[1] - a * cos(grazing), centre[2] + a * sin(grazing));
    const double cycles = 2.0 * sea->sonar->centre_frequency_hz * sound.time;
    const struct line line = sea_line(sea, 0);
    const double complex echo = line_at(sea, &line, REFERENCE * sound.time);
    expect_time("of the glint",
                sound.time * (1.0 + remainder(carg(echo) / (2.0 * PI) - cycles, 1.0) / cycles),
                sound.time);
    return decibels_of_amplitude(
        cabs(echo) / (0.5 * a * sound.amplitude / sqrt(1.0 + a / (REFERENCE * sound.time))));
}

CLAIM(echoes_from_within_layers)
{
    const double excess = sphere_excess(&even, 1.0, 55.0);
    for (size_t i = 0; i < COUNT(profiles); i++)
        for (size_t k = 0; k < COUNT(places); k++) {
            expect_plate(&profiles[i], places[k][0], places[k][1]);
            expect_close("level of the glint over that in one sound speed, dB",
                         sphere_excess(&profiles[i], places[k][0], places[k][1]), excess, LEVEL_DB);
        }
}

/* Targets must lie in straight water if more than fans from the sonar meets them. Rays that turn
 * over the seabed are not followed. */
CLAIM(what_is_refused)
{
    struct sea *sea = open_sea(&profiles[3], 61, 281, 55.0);
    sonject_object_params *object = sea_add_sphere(sea, 0.15, 3.0);
    sea_ready(sea);
    assert_true(sea->bench->water.slices == 2);
    sea->injection->interactions = 2;
    EXPECT_REFUSED(sea, "begin below 3.30 m over the seabed",
                   scene_lay_water(&sea->bench->scene, &sea->bench->report, &sea->bench->water));
    sea->injection->interactions = 1;
    object->burial_m = -21.0;
    EXPECT_REFUSED(sea, "begin below 21.30 m",
                   scene_lay_water(&sea->bench->scene, &sea->bench->report, &sea->bench->water));
}

/* ---- shadows ---- */

/* Returns the column at which an edge hides the seabed. The ray over the edge goes on, bent by
 * *bend m, to the seabed. */
static double column_behind(const struct sea *sea, const struct profile *profile, double range,
                            double height, double *bend)
{
    const double launch = launch_angle(profile, range, height);
    const struct ray at_edge = follow(profile, ALTITUDE, height, launch);
    const struct ray on_seabed = follow(profile, ALTITUDE, 0.0, launch);
    *bend = on_seabed.range - (range + height / tan(at_edge.grazing));
    return sea_column(sea, REFERENCE * on_seabed.time);
}

/* Level plates are high up. The last target, a slab, reaches through the sharp thermocline. */
CLAIM(shadows_along_bent_rays)
{
    static const struct {
        size_t profile;
        double height, range;
    } cases[] = {{0, 5.0, 40.0}, {1, 4.0, 50.0}, {2, 3.0, 55.0}, {3, 2.6, 60.0}, {3, 3.0, 40.0}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct profile *profile = &profiles[cases[i].profile];
        const double height = cases[i].height, half = 0.6;
        const bool is_slab = i + 1 == COUNT(cases);
        struct sea *sea = open_sea(profile, 121, 800, cases[i].range + 7.0);
        sea->injection->ray_scale = 16.0;
        sonject_object_params *object =
            sea_add(sea, is_slab ? SHAPE_BOX : SHAPE_PLANE, 2.0, 2.0 * half, 0.0);
        object->height_m = is_slab ? height : 0.0;
        object->burial_m = is_slab ? 0.0 : -height;
        place_in_metres(object, 1.5, cases[i].range);
        const double *visibility = visibility_of(sea_image(sea)) + 60 * 800;
        const double centre = sea_centre(sea, 0)[1];
        double bend;
        const double far = column_behind(sea, profile, centre + half, height, &bend);
        const double near = column_behind(sea, profile, centre - half, height, &bend);
        const size_t middle = (size_t)(0.5 * (near + far));
        print_message("bent by %.3f m\n", bend);
        assert_true(fabs(bend) > 2.0 * 0.025);
        if (!is_slab)
            expect_close("shadow begins, column", shadow_edge(visibility, 0, middle), near, 0.08);
        expect_close("shadow ends, column", shadow_edge(visibility, middle, 799), far, 0.08);
        expect_below("visibility in the middle", visibility[middle], 0.02);
    }
}

/* ---- aspects ---- */

/* Returns a pillar's echo and shadow, as a synthetic aperture sees them. */
static const struct image *pillar_in(const struct profile *profile)
{
    struct sea *sea = open_sea(profile, 161, 400, 44.0);
    sea->sonar->aperture_rad = 0.3;
    sonject_object_params *object = sea_add(sea, SHAPE_BOX, 0.6, 0.4, 0.0);
    object->height_m = 3.0;
    place_in_metres(object, 2.0, 42.0);
    make_rough(object, 0.1);
    return sea_image(sea);
}

/* Where sound speed hardly changes, squinted rays meet the pillar where straight ones do. */
CLAIM(squinted_rays_go_on_from_slice_to_slice)
{
    static const struct profile slight = {
        "slight steps",
        {{0.0, 1490.0, 1.0, 1490.0}, {1.0, 1490.15, 2.0, 1490.15}, {2.0, 1490.3, 25.0, 1490.3}}};
    const struct image *bent = pillar_in(&slight), *straight = pillar_in(&even);
    double change[2] = {0.0, 0.0}, sum[2] = {0.0, 0.0};
    for (size_t i = 0; i < straight->pixels; i++) {
        change[0] += fabs((double)bent->target_energy[i] - (double)straight->target_energy[i]);
        change[1] += fabs((double)bent->lost_energy[i] - (double)straight->lost_energy[i]);
        sum[0] += straight->target_energy[i];
        sum[1] += straight->lost_energy[i];
    }
    expect_below("change of the echo", change[0] / sum[0], 0.02);
    expect_below("change of the shadow", change[1] / sum[1], 0.02);
}
