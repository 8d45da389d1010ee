/* Images through layers of water, straight from the sonar and by several interactions: weak layers,
 * planes that transmit only a part, sound close to total reflection. The reference is Snell's law
 * and the ray tube, summed up layer by layer (reference_layers.h), and Rayleigh's reflection at
 * each plane. Levels have a systematic tolerance of 0.2 dB. */
#include "layered_sea.h"

#define LEVEL_DB 0.2
#define PHASE    0.05 /* rad; stationary phase errs by 1/(2ka), 1/250 for a = 0.3 m */
#define GRADIENT 200  /* layers */

/* Warm water over a thermocline, 8 m over the seabed; 1490 m/s at the seabed, 1505 at 25 m; the
 * sonar in the slower water, with sound that after 60 m runs level in the water below; a layer in
 * which all far sound runs level; and layers of different density. */
static const struct water_layer thermocline[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 1.0}};
static struct water_layer gradient[GRADIENT];
static const struct water_layer slow_above[] = {{0.0, 1520.0, 1.0}, {8.0, 1490.0, 1.0}};
static const struct water_layer fast_between[] = {
    {0.0, 1490.0, 1.0}, {10.0, 1540.0, 1.0}, {15.0, 1490.0, 1.0}};
static const struct water_layer light_above[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 0.4}};
static const struct water_layer light_between[] = {
    {0.0, 1490.0, 1.0}, {6.0, 1490.0, 0.5}, {12.0, 1505.0, 1.2}};

static const struct {
    const char *name;
    const struct water_layer *layers;
    size_t count;
    double middle; /* of the patch, processor range, m */
    double height; /* of targets that hang in it, m */
} seas[] = {
    {"thermocline", thermocline, 2, 40.0, 1.2},
    {"thermocline", thermocline, 2, 120.0, 1.2},
    {"gradient", gradient, GRADIENT, 40.0, 0.0},
    {"gradient", gradient, GRADIENT, 120.0, 0.0},
    {"slow water above", slow_above, 2, 45.0, 0.8},
    {"slow water above", slow_above, 2, 130.0, 0.8},
    {"fast layer between", fast_between, 3, 60.0, 0.8},
    {"fast layer between", fast_between, 3, 220.0, 0.8},
    {"light water above", light_above, 2, 50.0, 0.8},
    {"light water above", light_above, 2, 120.0, 0.8},
    {"light layer between", light_between, 3, 50.0, 0.8},
    {"light layer between", light_between, 3, 120.0, 0.8},
};
#define WEAK_SEAS 4

static struct sea *open_sea(size_t number, size_t rows, size_t columns)
{
    for (size_t i = 0; i < GRADIENT; i++) {
        const struct water_layer layer = {25.0 * (double)i / GRADIENT,
                                          1490.0 + 15.0 * ((double)i + 0.5) / GRADIENT, 1.0};
        gradient[i] = layer;
    }
    print_message("%s, %.0f m\n", seas[number].name, seas[number].middle);
    return layered_sea_open(rows, columns, seas[number].middle, seas[number].layers,
                            seas[number].count);
}

static struct reference_sound straight(const struct sea *sea, double range, double height)
{
    return sound_from(sea, SONAR, range, height);
}

/* ---- glints ---- */

struct heard {
    const struct sea *sea;
    const struct line *line;
};

static double minus_amplitude(double range, const void *context)
{
    const struct heard *heard = context;
    return -cabs(line_at(heard->sea, heard->line, range));
}

/* Compares a sphere's glint. Rays around the sphere are straight, so its front is where the ray to
 * its centre meets it. The wavefront curves in elevation alone. */
static void expect_sphere(struct sea *sea, double a)
{
    sea_ready(sea);
    const double *centre = sea_centre(sea, 0);
    const double grazing = straight(sea, centre[1], centre[2]).grazing;
    const struct reference_sound sound =
        straight(sea, centre[1] - a * cos(grazing), centre[2] + a * sin(grazing));
    const double nearest = REFERENCE * sound.time;
    const struct line line = sea_line(sea, 0);
    const struct heard heard = {sea, &line};
    double range;
    line_peak(sea, &line, &range);
    /* the top of the pulse, between bins */
    range = least_at(minus_amplitude, &heard, range - line.spacing_m, range + line.spacing_m);
    expect_close("range, m", range, nearest, 5e-4);
    expect_close(
        "level re a/2, dB", decibels_of_amplitude(cabs(line_at(sea, &line, range)) / (0.5 * a)),
        decibels_of_amplitude(gain_of(sea, sound, sound) / sqrt(1.0 + a / sound.wavefront)),
        LEVEL_DB);
    expect_close("phase over that of the travel time, rad",
                 remainder(carg(line_at(sea, &line, nearest)) -
                               4.0 * PI * sea->sonar->centre_frequency_hz * sound.time,
                           2.0 * PI),
                 0.0, PHASE);
}

/* The sphere is on the seabed, over it, or has its top near the thermocline, beside the middle. */
CLAIM(a_sphere_echoes_its_ray_tube)
{
    for (size_t i = 0; i < COUNT(seas); i++)
        for (int is_lifted = 0; is_lifted < (i < 2 ? 2 : 1); is_lifted++) {
            struct sea *sea = open_sea(i, 101, 161);
            sea_add_sphere(sea, 0.3, i >= 2 || is_lifted ? seas[i].height : 0.0);
            expect_sphere(sea, 0.3);
        }
    for (size_t i = 0; i < 2; i++) {
        struct sea *sea = open_sea(i, 101, 401);
        place_in_metres(sea_add_sphere(sea, 0.15, 7.0), 1.1, seas[i].middle);
        sea_move(sea, seas[i].middle - (i ? 3.0 : 4.5));
        expect_sphere(sea, 0.15);
    }
}

/* ---- where things are ---- */

/* A processor range stands for the place where the seabed is heard at that time. The map's pixels
 * lie there, too, and the image shows them there. */
CLAIM(processor_range_is_travel_time)
{
    for (size_t number = 0; number < WEAK_SEAS; number++) {
        struct sea *sea = open_sea(number, 120, 200);
        sea_add_sphere(sea, 0.05, -0.05);
        sea_ready(sea);
        expect_close("object in the middle, m",
                     REFERENCE * straight(sea, sea_centre(sea, 0)[1], 0.0).time,
                     seas[number].middle, 1e-9);
        float *map = claim_memory(sea->pixels, sizeof *map);
        for (size_t i = 0; i < sea->pixels; i++)
            map[i] = i % 200 < 100 ? 1.0f : 5.0f;
        const struct image *image = sea_image_of(sea, map, false);
        double line[200] = {0.0}, level = 0.0;
        for (size_t i = 0; i < sea->pixels; i++)
            line[i % 200] += image->seabed_energy[i];
        for (size_t i = 10; i < 20; i++)
            level += (line[100 - i] + line[99 + i]) / 20.0;
        size_t step = 90;
        while (step < 110 && line[step + 1] < level)
            step++;
        expect_close("step of the map, column",
                     (double)step + (level - line[step]) / (line[step + 1] - line[step]), 99.5,
                     0.1);
    }
}

/* ---- the seabed ---- */

#define ROWS    240
#define COLUMNS 200
#define EDGE    24 /* pixels near an edge, which lack a part of |W|^2 or of the pulse */

/* Returns mu sin^2(grazing) times the resolution cell's area and both intensities. */
static double closed_form(const struct sea *sea, double processor_range)
{
    double area;
    const struct reference_sound sound = sound_on_seabed(sea, processor_range, &area);
    return sea->seabed->lambert * area * pow(sin(sound.grazing) * gain_of(sea, sound, sound), 2.0);
}

CLAIM(the_seabeds_level)
{
    for (size_t number = 0; number < COUNT(seas); number++) {
        struct sea *sea = open_sea(number, ROWS, COLUMNS);
        const struct image *image = sea_image_of(sea, NULL, true);
        const struct estimate energy = level_over(sea, image, EDGE, EDGE, false, closed_form);
        const struct estimate field = level_over(sea, image, EDGE, EDGE, true, closed_form);
        /* W's tail beyond the kept reach has 0.1 % of the energy */
        expect_estimate("expected energy over closed form", energy, 1.0, 2e-3);
        expect_below("its 4 standard errors", 4.0 * energy.error, number < WEAK_SEAS ? 4e-3 : 8e-3);
        expect_estimate("realisation over closed form", field, 1.0, 2e-3);
        expect_below("4 standard errors of the realisation", 4.0 * field.error, 0.047);
    }
}

/* ---- a rough target, and shadows ---- */

/* A tilted Lambert plate has the energy mu cos^2 times its area and both intensities. The energy's
 * centroid is at the plate's travel time. */
CLAIM(a_rough_plate)
{
    const double tilt = 0.5;
    for (size_t number = 0; number < WEAK_SEAS; number++) {
        struct sea *sea = open_sea(number, 101, 201);
        sea->sonar->bandwidth_hz = 15e3; /* columns sample the pulse's energy */
        sea->injection->ray_scale = 16.0;
        sea->seabed->lambert = 1e-9;
        sonject_object_params *object = sea_add(sea, SHAPE_PLANE, 0.4, 0.4, 0.0);
        object->burial_m = number / 2 ? -0.3 : -1.5;
        object->heading_rad = -0.5 * PI;
        make_rough(object, 0.1);
        struct reference_sound sound = {0};
        for (int i = 0; i < 20; i++) { /* turning moves the plate */
            sea_ready(sea);
            sound = straight(sea, sea_centre(sea, 0)[1], sea_centre(sea, 0)[2]);
            object->pitch_rad = sound.grazing + tilt - 0.5 * PI;
        }
        const struct image *image = sea_image(sea);
        double sum = 0.0, moment = 0.0;
        for (size_t i = 0; i < image->pixels; i++) {
            sum += image->target_energy[i];
            moment += image->target_energy[i] * sea_range(sea, (double)(i % image->columns));
        }
        const double pixel = sea->geometry->column_spacing_m * 0.025;
        const double point = sea_pulse_energy(sea) * sea_window_energy(sea);
        expect_close(
            "energy, dB re that of the plate", decibels_of_energy(sum * pixel / point),
            decibels_of_energy(0.1 * 0.16 * pow(cos(tilt) * gain_of(sea, sound, sound), 2.0)), 0.1);
        expect_close("plate's range, m", moment / sum, REFERENCE * sound.time, 2e-3);
    }
}

/* Returns the column at which an edge hides the seabed. The edge's ray goes straight on to it. */
static double column_behind(const struct sea *sea, double range, double height)
{
    const double on = range + height / tan(straight(sea, range, height).grazing);
    return sea_column(sea, REFERENCE * straight(sea, on, 0.0).time);
}

CLAIM(the_shadow_of_a_flat_top)
{
    for (size_t number = 0; number < WEAK_SEAS; number++) {
        const double height = number % 2 ? 0.3 : 0.6;
        struct sea *sea = open_sea(number, 121, 401);
        sea->injection->ray_scale = 16.0;
        sea_add(sea, SHAPE_PLANE, 2.0, 1.2, 0.0)->burial_m = -height;
        const double *visibility = visibility_of(sea_image(sea)) + 60 * 401;
        const double centre = sea_centre(sea, 0)[1];
        const double near = column_behind(sea, centre - 0.6, height);
        const double far = column_behind(sea, centre + 0.6, height);
        const size_t middle = (size_t)(0.5 * (near + far));
        const double unbent = height * (centre + 0.6) / (ALTITUDE - height);
        const double bent = height / tan(straight(sea, centre + 0.6, height).grazing);
        print_message("shadow of %.3f m, without layers %.3f m\n", bent, unbent);
        /* the layers' effect is larger than the tolerance */
        assert_true(fabs(bent - unbent) > 0.25 * 0.025);
        expect_close("shadow begins, column", shadow_edge(visibility, 0, middle), near, 0.08);
        expect_close("shadow ends, column", shadow_edge(visibility, middle, 400), far, 0.08);
        expect_below("visibility in the middle", visibility[middle], 0.02);
    }
}

/* ---- bits ---- */

/* Returns an image of all kinds of echoes: glints and rough echoes of a sphere and a capsule, by
 * mirrors and by chains. */
static const struct image *all_echoes(const struct water_layer *layers, size_t count, double speed,
                                      double depth)
{
    struct sea *sea = layered_sea_open(80, 121, 40.0, layers, count);
    sea->medium->sound_speed_mps = speed;
    sea->surface->water_depth_m = depth;
    sea->seabed->forward.reflection = 0.7;
    sea->seabed->forward.roughness_m = 1e-3;
    sea->injection->interactions = 3;
    sea->injection->order_energies = 1;
    sonject_object_params *sphere = sea_add_sphere(sea, 0.2, 0.0);
    sphere->material.lambert = 0.05;
    sphere->material.roughness_m = 1e-3;
    sonject_object_params *capsule = sea_add(sea, SHAPE_CAPSULE, 1.0, 0.0, 0.3);
    capsule->material.lambert = 0.05;
    capsule->heading_rad = 0.4;
    capsule->burial_m = -0.5;
    const struct image *image = sea_image_of(sea, NULL, true);
    assert_true(image->orders == 3);
    return image;
}

/* Layers that differ in nothing are one, to the bit. Those over sonar and surface do not count. */
CLAIM(layers_that_do_nothing)
{
    static const struct water_layer equal[] = {
        {0.0, 1490.0, 1.0}, {0.3, 1490.0, 1.0}, {9.0, 1490.0, 1.0}, {23.0, 1490.0, 1.0}};
    static const struct water_layer over_surface[] = {{0.0, 1490.0, 1.0}, {25.0, 1520.0, 2.0}};
    static const struct water_layer over_sonar[] = {{0.0, 1490.0, 1.0}, {20.0, 1520.0, 2.0}};
    struct water_layer split[20];
    for (size_t i = 0; i < 20; i++) {
        split[i] = thermocline[i / 10];
        split[i].bottom_m += 0.8 * (double)(i % 10);
    }
    const struct image *whole = all_echoes(thermocline, 2, 1500.0, 25.0);
    assert_false(images_differ(whole, all_echoes(split, 20, 1500.0, 25.0)));
    for (int i = 0; i < 2; i++) {
        const double depth = i ? 0.0 : 25.0;
        const struct image *plain = all_echoes(NULL, 0, 1490.0, depth);
        assert_true(i || images_differ(whole, plain));
        assert_false(images_differ(plain, all_echoes(equal, 4, 1500.0, depth)));
        assert_false(
            images_differ(plain, all_echoes(i ? over_sonar : over_surface, 2, 1500.0, depth)));
    }
}

/* ---- planes that do not bend ---- */

/* Planes where density alone differs keep isovelocity water's rays and have, at every angle, R =
 * (d1 - d2)/(d1 + d2). A way that crosses the plane once keeps 1 - R^2, energies its square. */
#define DENSITY 0.4
#define SEEDS   8

enum kind {
    SEABED,
    SHADOW,
    GLINT,
    ONE_INTERACTION,
    TWO_INTERACTIONS,
    KINDS
};

static void add_energies(bool is_light_above, double source_side, uint64_t seed, size_t at,
                         double energies[KINDS][SEEDS])
{
    const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {8.0, 1490.0, DENSITY}};
    struct sea *sea = layered_sea_open(121, 161, 40.0, layers, is_light_above ? 2 : 0);
    sea->sonar->transducer_side_m = source_side;
    sea->medium->sound_speed_mps = 1490.0;
    /* heard within the patch. Some ways by both mirrors, which two interactions exclude, would
     * cross the plane three times */
    sea->surface->water_depth_m = 21.5;
    sea->seabed->forward.reflection = 0.7;
    sea->injection->interactions = 2;
    sea->injection->order_energies = 1;
    sea->injection->seed = seed;
    sonject_object_params *sphere = sea_add_sphere(sea, 0.3, 0.2);
    sphere->material.lambert = 0.1;
    sphere->material.roughness_m = 1e-3;
    const struct image *image = sea_image(sea);
    energies[SEABED][at] = sum_of(image->seabed_energy, image->pixels);
    energies[SHADOW][at] = sum_of(image->lost_energy, image->pixels);
    energies[GLINT][at] = pow(sea_peak(sea, NULL), 2.0);
    energies[ONE_INTERACTION][at] = sum_of(image->order_energy[0], image->pixels);
    energies[TWO_INTERACTIONS][at] = sum_of(image->order_energy[1], image->pixels);
}

CLAIM(density_alone_transmits)
{
    static const char *const names[KINDS] = {"seabed", "shadow", "glints", "one interaction",
                                             "two interactions"};
    static const double sides[] = {0.0, 0.4};
    const double reflection = (1.0 - DENSITY) / (1.0 + DENSITY);
    const double expected = pow(1.0 - reflection * reflection, 2.0);
    for (int k = 0; k < 2; k++) {
        double energies[2][KINDS][SEEDS];
        for (size_t i = 0; i < SEEDS; i++)
            for (size_t light = 0; light < 2; light++)
                add_energies(light > 0, sides[k], 1 + i + light * SEEDS, i, energies[light]);
        print_message("source of %.1f m\n", sides[k]);
        for (int kind = 0; kind < KINDS; kind++) {
            const struct estimate ratio = ratio_of(estimate_of(energies[1][kind], SEEDS),
                                                   estimate_of(energies[0][kind], SEEDS));
            /* 1e-3 is for bins and tallies in single precision */
            expect_estimate(names[kind], ratio, expected, 1e-3 * expected);
            expect_below("its 4 standard errors", 4.0 * ratio.error / ratio.mean, 0.012);
        }
    }
}

/* ---- chains ---- */

static const uint32_t column_rules[] = {SONJECT_COLUMNS_PAPER, SONJECT_COLUMNS_FOCUSED};

/* Returns the energy of two interactions between a sphere in the middle and the seabed about it. */
static struct estimate chain_energy(struct sea *sea, uint32_t column_rule, uint64_t first_seed)
{
    static const struct ranges all = {0, 0.0, 0.0};
    make_rough(sea_add_sphere(sea, 0.25, 0.0), 0.2);
    sea->seabed->lambert = 0.2;
    sea->injection->column_rule = column_rule;
    sea->injection->interactions = 2;
    sea->injection->order_energies = 1;
    const struct energies energies = sea_chains(sea, &all, first_seed, 24);
    return energy_of(&energies, 1, 0);
}

static void expect_ratio(const char *what, struct estimate one, struct estimate other,
                         double expected, double systematic)
{
    const struct estimate ratio = ratio_of(one, other);
    expect_estimate(what, ratio, expected, systematic * expected);
    expect_below("its 4 standard errors", 4.0 * ratio.error / expected, 0.03);
}

/* Rays around the sphere are straight. Chains there are those of straight water with a sonar whose
 * sound comes at the same angle with the same curvature. Only the energy that reaches the place,
 * and that comes home, differs. */
CLAIM(chains_scale_with_the_ray_tube)
{
    for (size_t i = 0; i < 4; i++) {
        struct sea *sea = open_sea(i / 2, 160, 160);
        sea->medium->reference_sound_speed_mps = 1490.0;
        sea_ready(sea);
        const double ground = sea_ground(sea, sea_range(sea, 0.5 * (160 - 1)));
        const struct reference_sound sound = straight(sea, ground, 0.0);
        const double gain = pow(1490.0 * sound.time, 4.0) * sound.out * sound.home;
        const struct estimate bent = chain_energy(sea, column_rules[i % 2], 100);
        sea = layered_sea_open(160, 160, sound.wavefront, NULL, 0);
        sea->medium->sound_speed_mps = sea->medium->reference_sound_speed_mps = 1490.0;
        sea->sonar->altitude_m = sound.wavefront * sin(sound.grazing);
        print_message("%s columns, sonar moved to %.1f m\n", i % 2 ? "focused" : "paper",
                      sound.wavefront);
        /* the gain changes by 1 % a metre of range there and back, and evenly about the middle */
        expect_ratio("energy over that in straight water", bent,
                     chain_energy(sea, column_rules[i % 2], 900), gain, 0.01);
    }
}
