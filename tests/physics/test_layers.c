/* Images through layers of water: what comes straight from the sonar. The reference is Snell's law
 * and the ray tube, summed up layer by layer (reference_layers.h). Levels are systematic: 0.2 dB.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layered_sea.h"
#include "shadow_edge.h"

#define LEVEL_DB 0.2
#define PHASE    0.05 /* rad; stationary phase errs by 1/(2ka), 1/250 for a = 0.3 m */
#define GRADIENT 200  /* layers */

/* Warm water over a thermocline, 8 m over the seabed. */
static const struct water_layer thermocline[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 1.0}};
static struct water_layer gradient[GRADIENT]; /* 1490 m/s at the seabed, 1505 at 25 m */

static const struct {
    const char *name;
    const struct water_layer *layers;
    size_t count;
} seas[] = {{"thermocline", thermocline, 2}, {"gradient", gradient, GRADIENT}};
static const double middles[] = {40.0, 120.0};
#define CASES 4 /* seas x middles */

static void open_sea(struct bench *bench, int number, size_t rows, size_t columns)
{
    layered_sea_open(bench, rows, columns, middles[number % 2], seas[number / 2].layers,
                     seas[number / 2].count);
    print_message("%s, %.0f m\n", seas[number / 2].name, middles[number % 2]);
}

/* Amplitude of a target of unit cross-section there. */
static double gain_of(struct reference_sound sound)
{
    return pow(REFERENCE * sound.time, 2.0) * sqrt(sound.out * sound.home);
}

/* ---- glints ---- */

/* The top of the pulse, between bins. */
static double peak_between_bins(const struct bench *bench, const struct echo_line *line,
                                double *range)
{
    echo_line_peak(bench, line, range);
    double low = *range - line->spacing_m;
    double high = *range + line->spacing_m;
    double amplitude = 0.0;
    for (int i = 0; i < 40; i++) {
        double values[2];
        for (int side = 0; side < 2; side++) {
            const struct complex_value value =
                echo_line_at(bench, line, low + (high - low) * (1.0 + side) / 3.0);
            values[side] = hypot(value.real_part, value.imaginary_part);
        }
        *(values[0] < values[1] ? &low : &high) += (high - low) / (values[0] < values[1] ? 3 : -3);
        amplitude = fmax(values[0], values[1]);
    }
    *range = 0.5 * (low + high);
    return amplitude;
}

/* Around the sphere the water is straight: of the ray to its centre, the sphere's front is where
 * that ray meets it. The wavefront curves in elevation alone. */
static void expect_sphere(struct bench *bench, double a)
{
    bench_ready(bench);
    const double *centre = bench->placements[0].centre;
    const struct reference_sound to_centre = sound_in_bench(bench, centre[1], centre[2]);
    const double y = centre[1] - a * cos(to_centre.grazing);
    const double z = centre[2] + a * sin(to_centre.grazing);
    const struct reference_sound sound = sound_in_bench(bench, y, z);
    const double nearest = REFERENCE * sound.time;
    struct echo_line line = bench_glint_line(bench, 0);
    double range;
    const double peak = peak_between_bins(bench, &line, &range);
    const double expected = 0.5 * a / sqrt(1.0 + a / sound.wavefront) * gain_of(sound);
    print_message("gain %.2f dB, grazing %.2f degrees\n", decibels_of_amplitude(gain_of(sound)),
                  sound.grazing * 180.0 / PI);
    expect_close("range, m", range, nearest, 5e-4);
    expect_close("level re a/2, dB", decibels_of_amplitude(peak / (0.5 * a)),
                 decibels_of_amplitude(expected / (0.5 * a)), LEVEL_DB);
    const struct complex_value value = echo_line_at(bench, &line, nearest);
    const double phase = atan2(value.imaginary_part, value.real_part);
    expect_close(
        "phase over that of the travel time, rad",
        remainder(phase - 4.0 * PI * bench->scene.sonar.centre_frequency_hz * sound.time, 2.0 * PI),
        0.0, PHASE);
    echo_line_clear(&line);
}

static void test_sphere(void **unused)
{
    (void)unused;
    static const double burials[] = {0.0, -1.2};
    for (int number = 0; number < CASES; number++)
        for (size_t i = 0; i < 2; i++) {
            struct bench bench;
            open_sea(&bench, number, 101, 161);
            bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.6)->burial_m =
                number / 2 ? 0.0 : burials[i];
            expect_sphere(&bench, 0.3);
            bench_close(&bench);
        }
}

/* A sphere whose top is near the thermocline, and one away from the middle of its patch. */
static void test_sphere_elsewhere(void **unused)
{
    (void)unused;
    for (int number = 0; number < 2; number++) {
        struct bench bench;
        open_sea(&bench, number, 101, 401);
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
        object->burial_m = -7.0;
        object->position_kind = SONJECT_POSITION_METRES;
        object->position_along = 1.1;
        object->position_range = middles[number] + 3.0;
        bench_move(&bench, middles[number] - (number ? 3.0 : 4.5));
        object->position_range = middles[number];
        expect_sphere(&bench, 0.15);
        bench_close(&bench);
    }
}

/* ---- where things are ---- */

/* A place given by its apparent range is where the seabed is heard at that time; the map's pixels
 * lie there too, and the image shows them there. */
static void test_apparent_range(void **unused)
{
    (void)unused;
    for (int number = 0; number < CASES; number++) {
        struct bench bench;
        struct echoes echoes;
        open_sea(&bench, number, 120, 200);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.1)->burial_m = 0.05;
        bench_ready(&bench);
        const struct reference_way way = way_through_bench(&bench);
        for (double column = 0.0; column < 200.0; column += 33.0) {
            const double apparent = view_apparent_range(&bench.tracer.view, column);
            const long double p = reference_parameter_of_time(&way, apparent / REFERENCE);
            const double ground = (double)reference_sum(&way, 0.0, p).range;
            expect_close("ground range, m", view_ground_range(&bench.tracer.view, apparent), ground,
                         1e-9);
            expect_close("grazing angle, rad", view_grazing(&bench.tracer.view, apparent),
                         sound_in_bench(&bench, ground, 0.0).grazing, 1e-9);
        }
        const double time = sound_in_bench(&bench, bench.placements[0].centre[1], 0.0).time;
        expect_close("object in the middle, m", REFERENCE * time, middles[number % 2], 1e-9);
        float *map = malloc((size_t)120 * 200 * sizeof *map);
        assert_non_null(map);
        for (size_t i = 0; i < (size_t)120 * 200; i++)
            map[i] = i % 200 < 100 ? 1.0f : 5.0f;
        bench_echoes(&bench, map, SEABED_FIELD_NONE, &echoes);
        double line[200] = {0.0};
        for (size_t i = 0; i < (size_t)120 * 200; i++)
            line[i % 200] += echoes.seabed_energy[i];
        double dark = 0.0, bright = 0.0;
        for (size_t i = 10; i < 20; i++) {
            dark += line[100 - i] / 10.0;
            bright += line[99 + i] / 10.0;
        }
        size_t step = 90;
        while (step < 110 && line[step + 1] < 0.5 * (dark + bright))
            step++;
        expect_close("step of the map, column",
                     (double)step +
                         (0.5 * (dark + bright) - line[step]) / (line[step + 1] - line[step]),
                     99.5, 0.1);
        echoes_clear(&echoes);
        free(map);
        bench_close(&bench);
    }
}

/* ---- the seabed ---- */

#define ROWS    240
#define COLUMNS 200
#define EDGE    24 /* resolution cells of |W|^2 and pulses that pixels near the edge lack */

/* mu sin^2(grazing) times the resolution cell's area and both intensities. */
static double seabed_level(const struct bench *bench, double apparent)
{
    double area;
    const struct reference_sound sound = sound_on_seabed(bench, apparent, &area);
    return bench->scene.seabed.lambert * area * pow(sin(sound.grazing) * gain_of(sound), 2.0);
}

/* Mean of pixels over their closed form, and its standard error from columns, of which three lie
 * within a pulse. */
static void expect_level(const char *what, const struct bench *bench, const float *a,
                         const float *b)
{
    double sum = 0.0, squares = 0.0;
    const double count = COLUMNS - 2 * EDGE;
    for (size_t column = EDGE; column < COLUMNS - EDGE; column++) {
        const double expected =
            seabed_level(bench, view_apparent_range(&bench->tracer.view, (double)column));
        double mean = 0.0;
        for (size_t row = EDGE; row < ROWS - EDGE; row++) {
            const size_t i = row * COLUMNS + column;
            mean += (b ? (double)a[i] * a[i] + (double)b[i] * b[i] : a[i]) / expected /
                    (ROWS - 2 * EDGE);
        }
        sum += mean / count;
        squares += mean * mean / count;
    }
    const double error = sqrt(3.0 * fmax(0.0, squares - sum * sum) / count);
    /* W's tail beyond the kept reach: 0.1 % of the energy */
    expect_close(what, sum, 1.0, 4.0 * error + 2e-3);
    expect_below("its 4 standard errors", 4.0 * error, b ? 0.047 : 4e-3);
}

static void test_seabed_level(void **unused)
{
    (void)unused;
    for (int number = 0; number < CASES; number++) {
        struct bench bench;
        struct echoes echoes;
        open_sea(&bench, number, ROWS, COLUMNS);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
        expect_level("expected energy over closed form", &bench, echoes.seabed_energy, NULL);
        expect_level("realisation over closed form", &bench, echoes.seabed_real,
                     echoes.seabed_imaginary);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* ---- a rough target ---- */

/* Energy of a tilted Lambert plate: mu cos^2 times its area, and both intensities. The centroid of
 * its energy is its travel time. */
#define TILT 0.5
static void test_rough_plate(void **unused)
{
    (void)unused;
    for (int number = 0; number < CASES; number++) {
        struct bench bench;
        struct echoes echoes;
        open_sea(&bench, number, 101, 201);
        bench.scene.sonar.bandwidth_hz = 15e3; /* columns sample the pulse's energy */
        bench.scene.injection.ray_scale = 16.0;
        bench.scene.seabed.lambert = 1e-9;
        sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_PLANE, 0.4, 0.4, 0.0);
        object->burial_m = number / 2 ? -0.3 : -1.5;
        object->heading_rad = -0.5 * PI;
        object->material.reflection = 0.0;
        object->material.lambert = 0.1;
        struct reference_sound sound = {0};
        for (int i = 0; i < 20; i++) { /* turning moves it */
            bench_ready(&bench);
            sound = sound_in_bench(&bench, bench.placements[0].centre[1],
                                   bench.placements[0].centre[2]);
            object->pitch_rad = sound.grazing + TILT - 0.5 * PI;
        }
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        double sum = 0.0, moment = 0.0;
        for (size_t i = 0; i < echoes.rows * echoes.columns; i++) {
            sum += echoes.target_energy[i];
            moment += echoes.target_energy[i] *
                      view_apparent_range(&bench.tracer.view, (double)(i % echoes.columns));
        }
        const double pixel = bench.scene.geometry.column_spacing_m * 0.025;
        const double point = range_energy_width(&bench.tracer.response) *
                             along_track_energy_width(&bench.tracer.response);
        expect_close("energy, dB re that of the plate", decibels_of_energy(sum * pixel / point),
                     decibels_of_energy(0.1 * 0.16 * pow(cos(TILT) * gain_of(sound), 2.0)), 0.1);
        expect_close("range, m", moment / sum, REFERENCE * sound.time, 2e-3);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* ---- shadows ---- */

/* Column at which the seabed is hidden by an edge: its ray goes straight on to the seabed. */
static double column_behind(const struct bench *bench, double range, double height)
{
    const double on = range + height / tan(sound_in_bench(bench, range, height).grazing);
    return view_column_of_range(&bench->tracer.view,
                                REFERENCE * sound_in_bench(bench, on, 0.0).time);
}

static void test_flat_top(void **unused)
{
    (void)unused;
    for (int number = 0; number < CASES; number++) {
        const double height = number % 2 ? 0.3 : 0.6;
        struct bench bench;
        struct echoes echoes;
        open_sea(&bench, number, 121, 401);
        bench.scene.injection.ray_scale = 16.0;
        bench_add(&bench, SONJECT_SHAPE_PLANE, 2.0, 1.2, 0.0)->burial_m = -height;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        double visibility[401];
        for (size_t i = 0; i < 401; i++)
            visibility[i] =
                1.0 - (double)echoes.lost_energy[60 * 401 + i] / echoes.seabed_energy[60 * 401 + i];
        const double centre = bench.placements[0].centre[1];
        const double near = column_behind(&bench, centre - 0.6, height);
        const double far = column_behind(&bench, centre + 0.6, height);
        const size_t middle = (size_t)(0.5 * (near + far));
        const double straight = height * (centre + 0.6) / (ALTITUDE - height);
        const double bent = height / tan(sound_in_bench(&bench, centre + 0.6, height).grazing);
        print_message("shadow of %.3f m, without layers %.3f m\n", bent, straight);
        /* layers matter, more than the test can overlook */
        assert_true(fabs(bent - straight) > 0.25 * 0.025);
        expect_close("shadow begins, column", shadow_edge(visibility, 0, middle), near, 0.08);
        expect_close("shadow ends, column", shadow_edge(visibility, middle, 400), far, 0.08);
        expect_below("visibility in the middle", visibility[middle], 0.02);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* ---- bits ---- */

static bool planes_differ(const struct echoes *one, const struct echoes *other)
{
    const size_t bytes = one->rows * one->columns * sizeof(float);
    bool differ = memcmp(one->target_real, other->target_real, bytes) != 0 ||
                  memcmp(one->target_imaginary, other->target_imaginary, bytes) != 0 ||
                  memcmp(one->target_energy, other->target_energy, bytes) != 0 ||
                  memcmp(one->seabed_energy, other->seabed_energy, bytes) != 0 ||
                  memcmp(one->lost_energy, other->lost_energy, bytes) != 0 ||
                  memcmp(one->seabed_real, other->seabed_real, bytes) != 0 ||
                  memcmp(one->energy, other->energy, bytes) != 0;
    for (uint32_t order = 0; order < one->orders; order++)
        differ = differ || memcmp(one->order_energy[order], other->order_energy[order], bytes) != 0;
    return differ;
}

/* Everything that the library can hear in a patch: glints and rough echoes, of a sphere and a
 * capsule, by mirrors and by chains. */
static void all_echoes(const struct water_layer *layers, size_t count, double speed, double depth,
                       struct echoes *echoes)
{
    struct bench bench;
    bench_open(&bench, 80, 121, 40.0);
    bench.scene.sonar.altitude_m = ALTITUDE;
    bench.scene.medium.sound_speed_mps = speed;
    bench.scene.medium.reference_sound_speed_mps = REFERENCE;
    bench_set_layers(&bench, layers, count);
    bench.scene.surface.water_depth_m = depth;
    bench.scene.seabed.forward.reflection = 0.7;
    bench.scene.seabed.forward.roughness_m = 1e-3;
    bench.scene.injection.interactions = 3;
    bench.scene.injection.order_energies = 1;
    sonject_object_params *sphere = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.4);
    sphere->material.lambert = 0.05;
    sphere->material.roughness_m = 1e-3;
    sonject_object_params *capsule = bench_add(&bench, SONJECT_SHAPE_CAPSULE, 1.0, 0.0, 0.3);
    capsule->material.lambert = 0.05;
    capsule->heading_rad = 0.4;
    capsule->burial_m = -0.5;
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, echoes);
    assert_true(echoes->orders == 3);
    bench_close(&bench);
}

static void test_split_layer(void **unused)
{
    (void)unused;
    struct water_layer split[20];
    for (size_t i = 0; i < 20; i++) {
        split[i] = thermocline[i / 10];
        split[i].bottom_m += 0.8 * (double)(i % 10);
    }
    struct echoes whole, parts, isovelocity;
    all_echoes(thermocline, 2, 1500.0, 25.0, &whole);
    all_echoes(split, 20, 1500.0, 25.0, &parts);
    all_echoes(NULL, 0, 1490.0, 25.0, &isovelocity);
    assert_false(planes_differ(&whole, &parts));
    assert_true(planes_differ(&whole, &isovelocity));
    echoes_clear(&whole);
    echoes_clear(&parts);
    echoes_clear(&isovelocity);
}

static void test_layers_that_do_nothing(void **unused)
{
    (void)unused;
    static const struct water_layer equal[] = {
        {0.0, 1490.0, 1.0}, {0.3, 1490.0, 1.0}, {9.0, 1490.0, 1.0}, {23.0, 1490.0, 1.0}};
    static const struct water_layer over_surface[] = {{0.0, 1490.0, 1.0}, {25.0, 1520.0, 2.0}};
    static const struct water_layer over_sonar[] = {{0.0, 1490.0, 1.0}, {20.0, 1520.0, 2.0}};
    static const double depths[] = {25.0, 0.0};
    for (int i = 0; i < 2; i++) {
        struct echoes plain, one, other;
        all_echoes(NULL, 0, 1490.0, depths[i], &plain);
        all_echoes(equal, 4, 1500.0, depths[i], &one);
        all_echoes(i ? over_sonar : over_surface, 2, 1500.0, depths[i], &other);
        assert_false(planes_differ(&plain, &one));
        assert_false(planes_differ(&plain, &other));
        echoes_clear(&plain);
        echoes_clear(&one);
        echoes_clear(&other);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),         cmocka_unit_test(test_sphere_elsewhere),
        cmocka_unit_test(test_apparent_range), cmocka_unit_test(test_seabed_level),
        cmocka_unit_test(test_rough_plate),    cmocka_unit_test(test_flat_top),
        cmocka_unit_test(test_split_layer),    cmocka_unit_test(test_layers_that_do_nothing),
    };
    for (size_t i = 0; i < GRADIENT; i++) {
        gradient[i].bottom_m = 25.0 * (double)i / GRADIENT;
        gradient[i].speed_mps = 1490.0 + 15.0 * ((double)i + 0.5) / GRADIENT;
        gradient[i].density = 1.0;
    }
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
