/* Multipath through layers of water: ways by the sea surface and the seabed, and chains of several
 * interactions. The reference is Snell's law and the ray tube, summed up layer by layer along the
 * folded path (reference_layers.h). Levels are systematic: 0.2 dB. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layered_sea.h"

#define DEPTH    25.0
#define LEVEL_DB 0.2
#define PHASE    0.05 /* rad; stationary phase errs by 1/(2ka), 1/126 for a = 0.15 m */

/* Warm water over a thermocline, 8 m over the seabed. */
static const struct water_layer thermocline[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 1.0}};
static const double middles[] = {40.0, 120.0};

static void open_sea(struct bench *bench, double middle, size_t rows, size_t columns)
{
    layered_sea_open(bench, rows, columns, middle, thermocline, 2);
}

/* ---- mirrors ---- */

/* The sonar and its images of up to two bounces. */
#define WAYS 5
static const struct {
    uint32_t bounces;
    bool comes_from_seabed;
} ways[WAYS] = {{0, false}, {1, true}, {1, false}, {2, true}, {2, false}};

static struct reference_way way_of(const struct bench *bench, int number)
{
    const struct reference_way way = {
        bench->water.layers,           bench->water.count, ALTITUDE, DEPTH, ways[number].bounces,
        ways[number].comes_from_seabed};
    return way;
}

static struct reference_sound sound_by(const struct bench *bench, int number, double y, double z)
{
    const struct reference_way way = way_of(bench, number);
    return reference_sound_at(&way, y, z);
}

/* What the mirrors return, in amplitude; roughness eta counts exp(-2 (k eta sin)^2), k and angle
 * those at the mirror, and k sin = 2 pi f sqrt(1/c^2 - p^2). */
static double mirrors_on(const struct bench *bench, int number, struct reference_sound sound)
{
    const sonject_material_params *materials[] = {&bench->scene.seabed.forward,
                                                  &bench->scene.surface.material};
    const double speeds[] = {1490.0, 1520.0};
    const double p = cos(sound.grazing) / 1490.0;
    double product = 1.0;
    for (int mirror = 0; mirror < 2; mirror++) {
        const bool is_met =
            ways[number].bounces == 2 ||
            (ways[number].bounces == 1 && ways[number].comes_from_seabed == !mirror);
        const double k_sine = 2.0 * PI * bench->scene.sonar.centre_frequency_hz *
                              sqrt(1.0 / (speeds[mirror] * speeds[mirror]) - p * p);
        if (is_met)
            product *= materials[mirror]->reflection *
                       exp(-2.0 * pow(k_sine * materials[mirror]->roughness_m, 2.0));
    }
    return product;
}

/* Travel time out by one way and home by another, by a point of the first object, a sphere; angle
 * over the horizontal. */
static double time_by(const struct bench *bench, int out, int home, double angle)
{
    const struct placement *sphere = &bench->placements[0];
    const double y = sphere->centre[1] - sphere->size.radius_m * cos(angle);
    const double z = sphere->centre[2] + sphere->size.radius_m * sin(angle);
    return sound_by(bench, out, y, z).time + sound_by(bench, home, y, z).time;
}

/* One family's echo: a/2 at the point of the shortest time, both ray tubes and all mirrors. */
struct family {
    double complex amplitude;
    double range; /* apparent */
};

static struct family family_of(const struct bench *bench, int out, int home)
{
    const struct placement *sphere = &bench->placements[0];
    const double a = sphere->size.radius_m;
    double low = -0.5 * PI, high = 0.5 * PI;
    for (int i = 0; i < 60; i++) {
        const double one = low + (high - low) / 3.0;
        const double other = high - (high - low) / 3.0;
        if (time_by(bench, out, home, one) < time_by(bench, out, home, other))
            high = other;
        else
            low = one;
    }
    const double angle = 0.5 * (low + high);
    const double y = sphere->centre[1] - a * cos(angle);
    const double z = sphere->centre[2] + a * sin(angle);
    const struct reference_sound there = sound_by(bench, out, y, z);
    const struct reference_sound back = sound_by(bench, home, y, z);
    const double time = 0.5 * (there.time + back.time);
    struct family family;
    family.range = REFERENCE * time;
    family.amplitude = 0.5 * a * family.range * family.range * sqrt(there.out * back.home) *
                       mirrors_on(bench, out, there) * mirrors_on(bench, home, back) *
                       cexp(4.0 * I * PI * bench->scene.sonar.centre_frequency_hz * time);
    return family;
}

/* All families within the limit of interactions, each of which has its reverse; seen through the
 * pulse at the range of each pair of up to three. */
static void expect_families(struct bench *bench, const struct echo_line *line)
{
    struct family families[WAYS][WAYS];
    for (int i = 0; i < WAYS; i++)
        for (int j = 0; j < WAYS; j++)
            families[i][j] = family_of(bench, i, j);
    for (int i = 0; i < WAYS; i++)
        for (int j = i; j < WAYS; j++) {
            if (ways[i].bounces + ways[j].bounces >= bench->scene.injection.interactions)
                continue;
            const double range = families[i][j].range;
            if (view_column_of_range(&bench->tracer.view, range) > (double)bench->columns)
                continue;
            double complex expected = 0.0;
            for (int k = 0; k < WAYS; k++)
                for (int l = 0; l < WAYS; l++)
                    if (ways[k].bounces + ways[l].bounces < bench->scene.injection.interactions)
                        expected +=
                            families[k][l].amplitude *
                            range_response(&bench->tracer.response, range - families[k][l].range);
            const struct complex_value value = echo_line_at(bench, line, range);
            const double complex measured = value.real_part + I * value.imaginary_part;
            print_message("ways %d and %d, range %.3f m\n", i, j, range);
            expect_close("level re a/2, dB", decibels_of_amplitude(cabs(measured) / 0.075),
                         decibels_of_amplitude(cabs(expected) / 0.075), LEVEL_DB);
            expect_close("phase off the reference, rad", carg(measured / expected), 0.0, PHASE);
        }
}

/* A sphere in open water over a smooth seabed, under a rough sea. Heights are such that families
 * that overlap do not cancel. */
static void test_glints_by_mirrors(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        open_sea(&bench, middles[i], 101, 1001);
        bench.scene.surface.water_depth_m = DEPTH;
        bench.scene.surface.material.roughness_m = 1e-3;
        bench.scene.seabed.forward.reflection = 0.8;
        bench.scene.seabed.forward.lambert = 0.0;
        bench.scene.injection.interactions = 3;
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3)->burial_m = i ? -6.9 : -3.0;
        bench_ready(&bench);
        struct echo_line line = bench_glint_line(&bench, 0);
        print_message("%.0f m\n", middles[i]);
        expect_families(&bench, &line);
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* Energy of a Lambert sphere seen at an angle from where it is lit, over that seen from there. */
static double lambert_sphere(double angle)
{
    return (sin(angle) + (PI - angle) * cos(angle)) / PI;
}

/* Energy of all families of a rough sphere under the surface alone over the straight one's: the
 * reverse of a path by the mirror is the same echo, twice the amplitude. */
static double rough_ratio(const struct bench *bench)
{
    const double *centre = bench->placements[0].centre;
    const struct reference_sound straight = sound_by(bench, 0, centre[1], centre[2]);
    const struct reference_sound bent = sound_by(bench, 2, centre[1], centre[2]);
    const double unit = straight.out * straight.home * pow(straight.time, 4.0);
    const double mixed = bent.out * straight.home * pow(0.5 * (straight.time + bent.time), 4.0);
    const double mirrored = bent.out * bent.home * pow(bent.time, 4.0);
    return 1.0 + 4.0 * lambert_sphere(fabs(straight.grazing - bent.grazing)) * mixed / unit +
           mirrored / unit;
}

static double sum_of_energy(const struct echoes *echoes)
{
    double sum = 0.0;
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++)
        sum += echoes->target_energy[i];
    return sum;
}

#define SEEDS 6
static void test_rough_sphere_by_mirrors(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        double mean = 0.0, square = 0.0, expected = 0.0;
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            double sum[2];
            for (uint32_t mirrored = 0; mirrored <= 1; mirrored++) {
                struct bench bench;
                struct echoes echoes;
                open_sea(&bench, middles[i] + 2.0, 101, 401);
                bench.scene.surface.water_depth_m = DEPTH;
                bench.scene.sonar.bandwidth_hz = 15e3; /* columns sample the pulse's energy */
                bench.scene.injection.interactions = mirrored ? 3 : 1;
                bench.scene.injection.seed = seed + SEEDS * mirrored;
                bench.scene.seabed.lambert = 1e-9; /* chains by the seabed are not meant */
                sonject_object_params *object =
                    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.3);
                object->material.reflection = 0.0;
                object->material.lambert = 0.1;
                object->burial_m = -3.0;
                bench_ready(&bench);
                bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
                sum[mirrored] = sum_of_energy(&echoes);
                expected = rough_ratio(&bench);
                echoes_clear(&echoes);
                bench_close(&bench);
            }
            mean += sum[1] / sum[0] / SEEDS;
            square += pow(sum[1] / sum[0], 2.0) / SEEDS;
        }
        const double error = sqrt(fmax(0.0, square - mean * mean) / (SEEDS - 1));
        print_message("%.0f m\n", middles[i]);
        /* 4 standard errors, and a/r that the reference leaves out */
        expect_close("energy over the straight one's", mean, expected,
                     4.0 * error + 0.005 * expected);
    }
}

/* ---- chains ---- */

#define CHAIN_SEEDS 24

struct measured {
    double mean, error;
};

/* Energy of two interactions between a sphere that lies in the middle and the seabed around it,
 * over the grid of a patch. */
static struct measured chain_energy(struct bench *bench, uint64_t first_seed)
{
    sonject_object_params *sphere = bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.5);
    sphere->material.reflection = 0.0;
    sphere->material.lambert = 0.2;
    bench->scene.seabed.lambert = 0.2;
    bench->scene.injection.interactions = 2;
    bench->scene.injection.order_energies = 1;
    bench_ready(bench);
    double sum = 0.0, square = 0.0;
    for (uint64_t seed = 0; seed < CHAIN_SEEDS; seed++) {
        struct chain_trace trace;
        bench->scene.injection.seed = first_seed + seed;
        bench_trace_chains(bench, &trace);
        const size_t cells = line_grid_cells(&trace.grid);
        float *plane = malloc(cells * sizeof *plane);
        assert_non_null(plane);
        assert_int_equal(trace.first_order, 2);
        if (chain_trace_read(&trace, &bench->tracer, 0, plane) != SONJECT_OK)
            fail_msg("%s", bench->report.message);
        double energy = 0.0;
        for (size_t i = 0; i < cells; i++)
            energy += (double)plane[i];
        sum += energy / CHAIN_SEEDS;
        square += energy * energy / CHAIN_SEEDS;
        free(plane);
        chain_trace_end(&trace);
    }
    const struct measured measured = {sum, sqrt(fmax(0.0, square - sum * sum) / (CHAIN_SEEDS - 1))};
    return measured;
}

static const uint32_t column_rules[] = {SONJECT_COLUMNS_PAPER, SONJECT_COLUMNS_FOCUSED};

static void expect_ratio(const char *what, struct measured one, struct measured other, double ratio,
                         double systematic, double resolved)
{
    const double error = ratio * hypot(one.error / one.mean, other.error / other.mean);
    expect_close(what, one.mean / other.mean, ratio, 4.0 * error + systematic * ratio);
    expect_below("its 4 standard errors", 4.0 * error / ratio, resolved);
}

/* With the layers' contrast what they do goes: 1e-4 is worth less than 0.3 %. */
static void test_chains_of_small_contrast(void **unused)
{
    (void)unused;
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {8.0, 1490.149, 1.0}};
    for (int rule = 0; rule < 2; rule++) {
        struct measured energies[2];
        for (int is_plain = 0; is_plain < 2; is_plain++) {
            struct bench bench;
            open_sea(&bench, middles[0], 160, 160);
            bench_set_layers(&bench, layers, is_plain ? 0 : 2);
            bench.scene.medium.sound_speed_mps = 1490.0;
            bench.scene.injection.column_rule = column_rules[rule];
            energies[is_plain] = chain_energy(&bench, 100 + 800 * (uint64_t)is_plain);
            bench_close(&bench);
        }
        expect_ratio("weak layers over none", energies[0], energies[1], 1.0, 0.003, 0.03);
    }
}

/* Around the sphere the water is straight: what happens there is what happens in straight water to
 * a sonar from which sound comes at the same angle with the same curvature. Only what reaches the
 * place, and what comes home, is another. */
static void test_chains_scale_with_the_ray_tube(void **unused)
{
    (void)unused;
    for (int i = 0; i < 4; i++) {
        struct bench bench;
        open_sea(&bench, middles[i / 2], 160, 160);
        bench.scene.injection.column_rule = column_rules[i % 2];
        bench.scene.medium.reference_sound_speed_mps = 1490.0;
        bench_ready(&bench);
        const double ground = view_ground_range(
            &bench.tracer.view, view_apparent_range(&bench.tracer.view, 0.5 * (160 - 1)));
        const struct reference_sound sound = sound_by(&bench, 0, ground, 0.0);
        const double gain = pow(1490.0 * sound.time, 4.0) * sound.out * sound.home;
        const struct measured bent = chain_energy(&bench, 100);
        bench_close(&bench);
        open_sea(&bench, sound.wavefront, 160, 160);
        bench_set_layers(&bench, NULL, 0);
        bench.scene.medium.sound_speed_mps = 1490.0;
        bench.scene.medium.reference_sound_speed_mps = 1490.0;
        bench.scene.sonar.altitude_m = sound.wavefront * sin(sound.grazing);
        bench.scene.injection.column_rule = column_rules[i % 2];
        const struct measured straight = chain_energy(&bench, 900);
        bench_close(&bench);
        print_message("%.0f m, %s columns, sonar moved to %.1f m\n", middles[i / 2],
                      i % 2 ? "focused" : "paper", sound.wavefront);
        /* the gain changes by 1 % a metre of range there and back, and evenly about the middle */
        expect_ratio("energy over that in straight water", bent, straight, gain, 0.01, 0.03);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_glints_by_mirrors),
        cmocka_unit_test(test_rough_sphere_by_mirrors),
        cmocka_unit_test(test_chains_of_small_contrast),
        cmocka_unit_test(test_chains_scale_with_the_ray_tube),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
