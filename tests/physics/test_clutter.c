/* Many objects at a time. An object far from all others is as it is alone, and sound between seabed
 * and many targets is as plain cosine sampling finds it. */
#include "device/device.h"
#include "sea.h"

#define PIXELS   400
#define SIDE     10 /* objects along a side of the lattice */
#define MIDDLE_M 25.0

static void add_object(struct sea *sea, double row, double column, double diameter)
{
    sonject_object_params *object = sea_add_sphere(sea, 0.5 * diameter, 0.0);
    place_in_pixels(object, row, column);
    object->material.lambert = 0.2;
    object->material.reflection = 0.9;
}

/* Adds an object of a lattice. Shadows, of 0.3 m at most, end before the next object. */
static void add_to_lattice(struct sea *sea, int number)
{
    const double step = (double)PIXELS / (SIDE + 1);
    add_object(sea, step * (1 + number / SIDE), 0.9 * step * (1 + number % SIDE),
               0.06 + 0.0005 * number);
}

/* Each of 100 objects has the same bits as alone in echo, footprint and shadow, since rays and
 * their random numbers are the patch's. The random numbers of glints depend on the object's number.
 * The first object's glint has the same bits, any other the same energy. */
CLAIM(each_is_what_it_is_alone)
{
    static struct strips all[SIDE * SIDE], one;
    double energy[SIDE * SIDE];
    struct sea *sea = sea_open(PIXELS, PIXELS, MIDDLE_M);
    for (int i = 0; i < SIDE * SIDE; i++)
        add_to_lattice(sea, i);
    sea_rough(sea, NULL, all);
    for (int i = 0; i < SIDE * SIDE; i += 9) {
        const struct line among = sea_line(sea, (uint32_t)i);
        energy[i] = line_energy(&among);
    }
    for (int i = 0; i < SIDE * SIDE; i += 9) {
        sea = sea_open(PIXELS, PIXELS, MIDDLE_M);
        add_to_lattice(sea, i);
        sea_rough(sea, NULL, &one);
        const size_t cells = (size_t)(one.strips * one.bins);
        assert_int_equal(one.strips, all[i].strips);
        assert_int_equal(one.bins, all[i].bins);
        assert_true(sum_of(one.energy, TILE_PLANES * cells) > 0.0);
        assert_memory_equal(one.energy, all[i].energy, TILE_PLANES * cells * sizeof(float));
        const struct line alone = sea_line(sea, 0);
        /* more rays may change a glint by 0.06 dB (test_glints.c) */
        expect_close("glint among others over alone, dB",
                     decibels_of_energy(energy[i] / line_energy(&alone)), 0.0, 0.06);
        if (i % 45 > 0)
            continue;
        for (int k = 0; k < SIDE * SIDE; k++)
            if (k != i)
                add_to_lattice(sea, k);
        const struct line among = sea_line(sea, 0);
        assert_true(line_energy(&alone) > 0.0);
        assert_int_equal(alone.bins, among.bins);
        assert_memory_equal(alone.values, among.values, alone.bins * sizeof *alone.values);
    }
}

#define SEEDS  16
#define ORDERS 3

/* Makes sampling plain cosine sampling, which leads no ray to a target. */
static void make_plain(struct bench *bench, struct chain_trace *trace)
{
    struct chain_record *chains = bench_copy_buffer(bench, trace->launch.buffers[LAUNCH_CHAINS]);
    assert_true(chains->groups > 8);
    chains->spheres = 0;
    chains->groups = 0;
    chains->seabed_share = 0.0f;
    buffer_release(bench->tracer.device, &trace->launch.buffers[LAUNCH_CHAINS]);
    assert_int_equal(buffer_create(&bench->report, bench->tracer.device, sizeof *chains, chains,
                                   &trace->launch.buffers[LAUNCH_CHAINS]),
                     SONJECT_OK);
    free(chains);
}

/* Sound that is led from the seabed to one of 160 targets has the energy of sound that is not led,
 * in ranges that plain sampling knows to 10 % or better. Targets are strewn, or heaped so that
 * their spheres overlap and hold the seabed about them. The heap lies below waves, to which sound
 * from the seabed is led, too. */
CLAIM(sound_led_to_many_targets_has_its_energy)
{
    static const struct {
        const char *name;
        bool is_heap;
        double depth_m; /* 0: no sea surface */
        int compared;
    } seas[] = {{"strewn", false, 0.0, 4}, {"heap below waves", true, 12.0, 2}};
    for (size_t i = 0; i < COUNT(seas); i++) {
        struct sea *sea = sea_open(160, 160, MIDDLE_M);
        double first_x, last_x;
        for (int k = 0; k < 160; k++) {
            const double step = seas[i].is_heap ? 4.0 : 11.0, first = seas[i].is_heap ? 60.0 : 12.0;
            add_object(sea, first + step * (k % 13),
                       first + (seas[i].is_heap ? 4.0 : 10.0) * (k / 13),
                       seas[i].is_heap ? 0.25 : 0.12);
            sonject_object_params *object = sea_object(sea, (uint32_t)k);
            object->material.reflection = 0.0;
            if (k % 3 > 0)
                continue;
            object->shape = SHAPE_CYLINDER;
            object->length_m = 0.5;
            object->diameter_m = 0.08;
            object->heading_rad = 0.7 * k;
            object->burial_m = seas[i].is_heap ? 0.05 : 0.0;
        }
        sea->seabed->lambert = 0.2;
        sea->surface->water_depth_m = seas[i].depth_m;
        sea->surface->material.roughness_m = 0.1; /* leaves no mirror */
        sea->surface->material.lambert = 0.3;
        sea->surface->material.glossy_albedo = 0.0;
        sea->injection->interactions = ORDERS;
        sea->injection->order_energies = 1;
        sea->injection->column_rule = SONJECT_COLUMNS_PAPER;
        sea->injection->ray_scale = 0.05;
        sea_ready(sea);
        const struct strips grid = sea_grid(sea, &first_x, &last_x);
        const double width = (double)grid.bins / grid.bins_per_pixel * 0.025 / 8.0;
        const struct ranges ranges = {
            8, sea_range(sea, (grid.first_bin - 0.5) / (double)grid.bins_per_pixel), width};
        const struct energies led = sea_chains(sea, &ranges, 100, SEEDS);
        const struct energies plain = sea_changed_chains(sea, &ranges, 900, SEEDS, make_plain);
        for (int order = 1; order < ORDERS; order++) {
            int compared = 0;
            for (int range = 0; range < ranges.count; range++) {
                struct estimate energy = energy_of(&led, order, range);
                const struct estimate expected = energy_of(&plain, order, range);
                energy.error = hypot(energy.error, expected.error);
                if (!(energy.error < 0.1 * expected.mean))
                    continue;
                print_message("%s, order %d, range %d: ", seas[i].name, order + 1, range);
                expect_estimate("led, m2", energy, expected.mean, 0.0);
                compared++;
            }
            assert_true(compared >= seas[i].compared);
        }
    }
}

/* A scene is refused with one line if it has more shapes than random numbers can tell apart. */
CLAIM(too_many_shapes_are_refused)
{
    static const double nowhere[3] = {0.0, 0.0, 0.0};
    struct placements placed;
    struct sea *sea = sea_open(160, 160, MIDDLE_M);
    struct bench *bench = sea->bench;
    add_object(sea, 80.0, 80.0, 0.1);
    sea_object(sea, 0)->shape = SHAPE_PARTS;
    for (int i = 0; i < 1000; i++)
        sea_add_part(sea, SHAPE_SPHERE, nowhere, nowhere);
    for (int i = 0; i < 24; i++)
        add_object(sea, 80.0, 80.0, 0.1);
    sea_ready(sea); /* 1024 */
    add_object(sea, 80.0, 80.0, 0.1);
    assert_int_equal(
        placements_init(&placed, &bench->report, &bench->scene, &bench->tracer.view, 0.0, 0.0),
        SONJECT_ERROR_INPUT);
    assert_string_equal(sea_message(sea),
                        "objects: 1025 shapes, counting those of parts, are too many: a scene may "
                        "have 1024; split it");
}
