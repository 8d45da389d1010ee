/* Images through water that is hard on rays: planes that transmit only a part, sound that comes
 * close to total reflection, a sonar in the slower water. The reference is Snell's law and the ray
 * tube (reference_layers.h) and Rayleigh's reflection at each plane. Levels are systematic: 0.2 dB.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "layered_sea.h"

#define LEVEL_DB 0.2
#define PHASE    0.05 /* rad; stationary phase errs by 1/(2ka), 1/250 for a = 0.3 m */

/* The sonar in the slower water: sound that has gone 60 m there runs level in the water below. */
static const struct water_layer slow_above[] = {{0.0, 1520.0, 1.0}, {8.0, 1490.0, 1.0}};
/* Far away all sound runs level through the fast layer. */
static const struct water_layer fast_between[] = {
    {0.0, 1490.0, 1.0}, {10.0, 1540.0, 1.0}, {15.0, 1490.0, 1.0}};
static const struct water_layer light_above[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 0.4}};
static const struct water_layer light_between[] = {
    {0.0, 1490.0, 1.0}, {6.0, 1490.0, 0.5}, {12.0, 1505.0, 1.2}};

static const struct {
    const char *name;
    const struct water_layer *layers;
    size_t count;
    double middle; /* of the patch, apparent range, m */
} seas[] = {
    {"slow water above", slow_above, 2, 45.0},
    {"slow water above", slow_above, 2, 130.0},
    {"fast layer between", fast_between, 3, 60.0},
    {"fast layer between", fast_between, 3, 220.0},
    {"light water above", light_above, 2, 50.0},
    {"light water above", light_above, 2, 120.0},
    {"light layer between", light_between, 3, 50.0},
    {"light layer between", light_between, 3, 120.0},
};
#define SEAS (sizeof seas / sizeof *seas)

static void open_sea(struct bench *bench, size_t number, size_t rows, size_t columns)
{
    layered_sea_open(bench, rows, columns, seas[number].middle, seas[number].layers,
                     seas[number].count);
    print_message("%s, %.0f m\n", seas[number].name, seas[number].middle);
}

/* Share of the energy that all planes under the sonar pass on, one way, for sound of p = cos/c:
 * 1 - R^2 = 4 Z1 Z2 / (Z1 + Z2)^2 with Z = density c / sin. Planes of a profile, at which density
 * is the same, pass all. */
static double passed_on(const struct bench *bench, double p)
{
    double share = 1.0;
    for (size_t i = 0; i + 1 < bench->water.count; i++) {
        const struct water_layer *layer = &bench->water.layers[i];
        double impedance[2];
        for (int side = 0; side < 2; side++)
            impedance[side] = layer[side].density * layer[side].speed_mps /
                              sqrt(1.0 - pow(p * layer[side].speed_mps, 2.0));
        if (layer[0].density != layer[1].density && layer[1].bottom_m < ALTITUDE)
            share *= 4.0 * impedance[0] * impedance[1] / pow(impedance[0] + impedance[1], 2.0);
    }
    return share;
}

/* Amplitude of a target of unit cross-section there: the planes are crossed there and back. */
static double gain_of(const struct bench *bench, struct reference_sound sound)
{
    const double p = cos(sound.grazing) / bench->water.straight_speed_mps;
    return pow(REFERENCE * sound.time, 2.0) * sqrt(sound.out * sound.home) * passed_on(bench, p);
}

/* ---- a glint ---- */

#define RADIUS 0.3

/* Around the sphere the water is straight: its front is where the ray to its centre meets it. */
static struct reference_sound sound_at_front(const struct bench *bench)
{
    const double *centre = bench->placements[0].centre;
    const double grazing = sound_in_bench(bench, centre[1], centre[2]).grazing;
    return sound_in_bench(bench, centre[1] - RADIUS * cos(grazing),
                          centre[2] + RADIUS * sin(grazing));
}

static void test_sphere(void **unused)
{
    (void)unused;
    for (size_t number = 0; number < SEAS; number++) {
        struct bench bench;
        open_sea(&bench, number, 101, 161);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * RADIUS)->burial_m = -0.8;
        bench_ready(&bench);
        const struct reference_sound sound = sound_at_front(&bench);
        const double nearest = REFERENCE * sound.time;
        const double gain = gain_of(&bench, sound);
        struct echo_line line = bench_glint_line(&bench, 0);
        double range;
        const double peak = echo_line_peak(&bench, &line, &range);
        print_message("grazing %.2f degrees, gain %.2f dB\n", sound.grazing * 180.0 / PI,
                      decibels_of_amplitude(gain));
        /* the wavefront curves in elevation alone; bins are finer than 3 mm */
        expect_close("level re a/2, dB", decibels_of_amplitude(peak / (0.5 * RADIUS)),
                     decibels_of_amplitude(gain / sqrt(1.0 + RADIUS / sound.wavefront)), LEVEL_DB);
        expect_close("range, m", range, nearest, 0.5 * line.spacing_m + 5e-4);
        const struct complex_value value = echo_line_at(&bench, &line, nearest);
        const double cycles = 2.0 * bench.scene.sonar.centre_frequency_hz * sound.time;
        expect_close(
            "phase over that of the travel time, rad",
            remainder(atan2(value.imaginary_part, value.real_part) - 2.0 * PI * cycles, 2.0 * PI),
            0.0, PHASE);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* ---- the sea surface ---- */

#define SURFACE   25.0
#define ROUGHNESS 3e-3 /* of the surface: takes 1 dB to 8 dB here */

static struct reference_sound sound_by_surface(const struct bench *bench, double y, double z)
{
    const struct reference_way way = {
        bench->water.layers, bench->water.count, ALTITUDE, SURFACE, 1, false};
    return reference_sound_at(&way, y, z);
}

/* Half the travel time out straight and home by the surface, by a point of a sphere. */
static double time_of_pair(const struct bench *bench, double radius, double angle)
{
    const double *centre = bench->placements[0].centre;
    const double y = centre[1] - radius * cos(angle);
    const double z = centre[2] + radius * sin(angle);
    return 0.5 * (sound_in_bench(bench, y, z).time + sound_by_surface(bench, y, z).time);
}

/* The surface is rough to sound of the wavelength that it has there, at the angle that it has
 * there: exp(-2 (kz eta)^2), kz = 2 pi f sqrt(1/c^2 - p^2). */
static double surface_returns(const struct bench *bench, struct reference_sound sound)
{
    const double p = cos(sound.grazing) / bench->water.straight_speed_mps;
    const double c = bench->water.layers[bench->water.count - 1].speed_mps;
    const double kz =
        2.0 * PI * bench->scene.sonar.centre_frequency_hz * sqrt(1.0 / (c * c) - p * p);
    return fabs(bench->scene.surface.material.reflection) * exp(-2.0 * pow(kz * ROUGHNESS, 2.0));
}

static void test_glint_by_the_surface(void **unused)
{
    (void)unused;
    static const size_t numbers[] = {0, 1, 4, 5};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const double radius = 0.15;
        struct bench bench;
        open_sea(&bench, numbers[i], 101, 501);
        bench.scene.surface.water_depth_m = SURFACE;
        bench.scene.surface.material.roughness_m = ROUGHNESS;
        bench.scene.injection.interactions = 2;
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * radius)->burial_m = -4.0;
        bench_ready(&bench);
        double low = -0.5 * PI, high = 0.5 * PI;
        for (int k = 0; k < 60; k++) {
            const double third = (high - low) / 3.0;
            if (time_of_pair(&bench, radius, low + third) <
                time_of_pair(&bench, radius, high - third))
                high -= third;
            else
                low += third;
        }
        const double range = REFERENCE * time_of_pair(&bench, radius, low);
        const double *centre = bench.placements[0].centre;
        const double y = centre[1] - radius * cos(low);
        const double z = centre[2] + radius * sin(low);
        const struct reference_sound out = sound_in_bench(&bench, y, z);
        const struct reference_sound home = sound_by_surface(&bench, y, z);
        const double straight = REFERENCE * out.time;
        /* both directions are one echo; planes under the sonar are crossed once each way */
        const double passed = passed_on(&bench, cos(out.grazing) / bench.water.straight_speed_mps) *
                              passed_on(&bench, cos(home.grazing) / bench.water.straight_speed_mps);
        const double expected = 2.0 * range * range * sqrt(out.out * home.home * passed) *
                                surface_returns(&bench, home);
        struct echo_line line = bench_glint_line(&bench, 0);
        const struct complex_value value = echo_line_at(&bench, &line, range);
        print_message("straight %.2f m, by the surface %.2f m, which takes %.2f dB\n", straight,
                      range, -decibels_of_amplitude(surface_returns(&bench, home)));
        assert_true(range - straight > 0.5); /* pulses of 2.5 cm lie apart */
        expect_close(
            "level re a/2, dB",
            decibels_of_amplitude(hypot(value.real_part, value.imaginary_part) / (0.5 * radius)),
            decibels_of_amplitude(expected), LEVEL_DB);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* ---- the seabed ---- */

#define ROWS    160
#define COLUMNS 160
#define EDGE    24 /* resolution cells of |W|^2 and pulses that pixels near the edge lack */

/* mu sin^2(grazing) times the resolution cell's area and both intensities. */
static double seabed_level(const struct bench *bench, double apparent)
{
    double area;
    const struct reference_sound sound = sound_on_seabed(bench, apparent, &area);
    return bench->scene.seabed.lambert * area *
           pow(sin(sound.grazing) * gain_of(bench, sound), 2.0);
}

static void test_seabed_level(void **unused)
{
    (void)unused;
    for (size_t number = 0; number < SEAS; number++) {
        struct bench bench;
        struct echoes echoes;
        double sum = 0.0, squares = 0.0;
        const double count = COLUMNS - 2 * EDGE;
        open_sea(&bench, number, ROWS, COLUMNS);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        for (size_t column = EDGE; column < COLUMNS - EDGE; column++) {
            const double expected =
                seabed_level(&bench, view_apparent_range(&bench.tracer.view, (double)column));
            double mean = 0.0;
            for (size_t row = EDGE; row < ROWS - EDGE; row++)
                mean += echoes.seabed_energy[row * COLUMNS + column] / expected / (ROWS - 2 * EDGE);
            sum += mean / count;
            squares += mean * mean / count;
        }
        /* three columns lie within a pulse */
        const double error = sqrt(3.0 * fmax(0.0, squares - sum * sum) / count);
        /* W's tail beyond the kept reach: 0.1 % of the energy */
        expect_close("expected energy over closed form", sum, 1.0, 4.0 * error + 2e-3);
        expect_below("its 4 standard errors", 4.0 * error, 8e-3);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* ---- planes that do not bend ---- */

/* Where density alone differs, rays are those of isovelocity water and R = (d1 - d2)/(d1 + d2) at
 * every angle: each way that crosses the plane once takes 1 - R^2, so energies take its square. */
#define DENSITY 0.4
#define DEPTH   21.5 /* the surface is heard within the patch */
#define SEEDS   8

struct energies {
    double seabed, lost, glint, one_interaction, chains;
};

static struct energies energies_of(bool is_light_above, double source_side, uint64_t seed)
{
    const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {8.0, 1490.0, DENSITY}};
    struct bench bench;
    struct echoes echoes;
    struct energies sums = {0.0, 0.0, 0.0, 0.0, 0.0};
    bench_open(&bench, 121, 161, 40.0);
    bench.scene.sonar.altitude_m = ALTITUDE;
    bench.scene.sonar.transducer_side_m = source_side;
    bench.scene.medium.sound_speed_mps = 1490.0;
    bench.scene.medium.reference_sound_speed_mps = REFERENCE;
    bench_set_layers(&bench, layers, is_light_above ? 2 : 0);
    /* of ways by both mirrors some would cross the plane three times */
    bench.scene.surface.water_depth_m = DEPTH;
    bench.scene.seabed.forward.reflection = 0.7;
    bench.scene.injection.interactions = 2;
    bench.scene.injection.order_energies = 1;
    bench.scene.injection.seed = seed;
    sonject_object_params *sphere = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6);
    sphere->material.lambert = 0.1;
    sphere->material.roughness_m = 1e-3;
    sphere->burial_m = -0.2;
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    for (size_t i = 0; i < echoes.rows * echoes.columns; i++) {
        sums.seabed += echoes.seabed_energy[i];
        sums.lost += echoes.lost_energy[i];
        sums.one_interaction += echoes.order_energy[0][i];
        sums.chains += echoes.order_energy[1][i];
    }
    struct echo_line line = bench_glint_line(&bench, 0);
    sums.glint = pow(echo_line_peak(&bench, &line, NULL), 2.0);
    echo_line_clear(&line);
    echoes_clear(&echoes);
    bench_close(&bench);
    return sums;
}

static void expect_square(const char *what, const double *with, const double *without)
{
    const double reflection = (1.0 - DENSITY) / (1.0 + DENSITY);
    const double expected = pow(1.0 - reflection * reflection, 2.0);
    double mean[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
    for (int i = 0; i < SEEDS; i++)
        for (int side = 0; side < 2; side++) {
            const double value = side ? with[i] : without[i];
            mean[side] += value / SEEDS;
            square[side] += value * value / SEEDS;
        }
    double error = 0.0; /* relative */
    for (int side = 0; side < 2; side++)
        error = hypot(error, sqrt(fmax(0.0, square[side] - mean[side] * mean[side]) / (SEEDS - 1)) /
                                 mean[side]);
    /* 4 standard errors; bins and tallies in single precision */
    expect_close(what, mean[1] / mean[0], expected, expected * (4.0 * error + 1e-3));
    expect_below("its 4 standard errors", 4.0 * error, 0.012);
}

static void test_density_alone(void **unused)
{
    (void)unused;
    static const double sides[] = {0.0, 0.4};
    for (int k = 0; k < 2; k++) {
        double sums[2][5][SEEDS];
        for (int i = 0; i < SEEDS; i++)
            for (int side = 0; side < 2; side++) {
                const struct energies one =
                    energies_of(side, sides[k], (uint64_t)(1 + i + side * SEEDS));
                const double values[] = {one.seabed, one.lost, one.glint, one.one_interaction,
                                         one.chains};
                for (int n = 0; n < 5; n++)
                    sums[side][n][i] = values[n];
            }
        print_message("source of %.1f m\n", sides[k]);
        expect_square("seabed", sums[1][0], sums[0][0]);
        expect_square("shadow", sums[1][1], sums[0][1]);
        expect_square("glints", sums[1][2], sums[0][2]);
        expect_square("one interaction", sums[1][3], sums[0][3]);
        expect_square("two interactions", sums[1][4], sums[0][4]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_glint_by_the_surface),
        cmocka_unit_test(test_seabed_level),
        cmocka_unit_test(test_density_alone),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
