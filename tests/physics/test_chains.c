/* Paths of several interactions, compared with references that share nothing with the kernels but
 * the physics, with closed forms, and between different ways of finding the same paths. */
#include "reference_paths.h"

#define ORDERS     3
#define SEEDS      24
#define MIDDLE_M   50.0
#define FEW_RANGES 4
#define FEW_RAYS   0.1
#define FAR_M      400.0
#define NEAR_M     20.0

/* Returns `count` ranges, 6 m in all, about the middle of a patch. */
static struct ranges ranges_about(double middle, int count)
{
    const struct ranges ranges = {count, middle - 3.0, 6.0 / count};
    return ranges;
}

/* Opens a sea with one object. Surfaces are so bright that the third order is heard. Rays are few,
 * since 24 seeds of few rays know their standard errors better. */
static struct sea *open_with(enum shape_kind shape, double length_m, double diameter_m)
{
    struct sea *sea = sea_open(160, 240, MIDDLE_M);
    sonject_object_params *object = sea_add(sea, shape, length_m, 0.0, diameter_m);
    object->heading_rad = 35.0 * PI / 180.0;
    make_rough(object, 0.2);
    sea->seabed->lambert = 0.2;
    sea->injection->interactions = ORDERS;
    sea->injection->order_energies = 1;
    sea->injection->column_rule = SONJECT_COLUMNS_PAPER;
    sea->injection->ray_scale = 0.25;
    return sea;
}

/* Opens Figure 7's geometry. The relief has ripples with shadows of their own and scour about the
 * target. Its rays take five times as long, so they are fewer. They still know the energies better
 * than brute force does. */
static struct sea *open_capsule(bool has_relief)
{
    struct sea *sea = open_with(SHAPE_CAPSULE, 2.3, 0.3);
    sea_object(sea, 0)->burial_m = 0.1;
    if (has_relief) {
        sea->injection->ray_scale = FEW_RAYS;
        sea_add_ripples(sea, 0.6, 0.06, 1.2, 0.5);
        sea_add_scour(sea, 0.5, 0.1);
    }
    return sea;
}

/* Opens an object within one bounding sphere, which also holds the seabed under the overhang. No
 * cone leads from there to a target. Range and patch suit brute force: near and wide. */
static struct sea *open_overhang(enum shape_kind shape, double diameter_m)
{
    struct sea *sea = open_with(shape, 0.0, diameter_m);
    sea->geometry->row_spacing_m = 0.1;
    sea->geometry->column_spacing_m = 0.06;
    sea_move(sea, NEAR_M);
    return sea;
}

/* Traces chains into few ranges, which need few rays. */
static struct energies trace_seeds(struct sea *sea, double middle, uint64_t first_seed)
{
    const struct ranges ranges = ranges_about(middle, FEW_RANGES);
    return sea_chains(sea, &ranges, first_seed, SEEDS);
}

static struct estimate sum_of_two(struct estimate a, struct estimate b)
{
    return (struct estimate){a.mean + b.mean, hypot(a.error, b.error)};
}

/* Compares energies within four standard errors, in each range where the energy is known to 20 %
 * and in the sum of these ranges. Ranges with less than a tenth of the most are left out: brute
 * force may find nothing there, and far beyond the target seabed outside the patch counts. */
static void expect_same(const char *what, const struct energies *a, const struct energies *b,
                        double systematic)
{
    for (int order = 1; order < ORDERS; order++) {
        int compared = 0;
        double most = 0.0;
        struct estimate all_a = {0.0, 0.0}, all_b = {0.0, 0.0};
        for (int range = 0; range < FEW_RANGES; range++)
            most = fmax(most, energy_of(b, order, range).mean);
        for (int range = 0; range <= FEW_RANGES; range++) {
            const bool is_sum = range == FEW_RANGES;
            const struct estimate one = is_sum ? all_a : energy_of(a, order, range);
            const struct estimate other = is_sum ? all_b : energy_of(b, order, range);
            const double error = hypot(one.error, other.error);
            if (!(error < 0.2 * other.mean) || other.mean < 0.1 * most)
                continue;
            const struct estimate measured = {one.mean / other.mean, error / other.mean};
            print_message(is_sum ? "%s, order %d, %d ranges: " : "%s, order %d, range %d: ", what,
                          order + 1, is_sum ? compared : range);
            expect_estimate("energy over the other's", measured, 1.0, systematic);
            all_a = sum_of_two(all_a, one);
            all_b = sum_of_two(all_b, other);
            compared++;
        }
        assert_true(compared >= 3);
    }
}

/* Compares the paper's brute force, with `counted_rays` times the usual rays, with connections to
 * random points of the same rectangle. */
static void compare_estimators(const char *what, struct sea *sea, double middle,
                               double counted_rays)
{
    sea->sonar->transducer_side_m = 8.0;
    const struct energies connected = trace_seeds(sea, middle, 100);
    sea->injection->estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
    sea->injection->ray_scale = counted_rays;
    const struct energies counted = trace_seeds(sea, middle, 900);
    expect_same(what, &counted, &connected, 0.0);
}

/* The relief tests visibility, normals, and directions towards the target. */
CLAIM(brute_force_finds_what_connections_find)
{
    compare_estimators("brute force", open_capsule(false), MIDDLE_M, 1.0);
    compare_estimators("over relief", open_capsule(true), MIDDLE_M, 3.0);
    struct sea *sea = open_overhang(SHAPE_TORUS, 1.2);
    sea_object(sea, 0)->height_m = 0.4;
    compare_estimators("under a torus", sea, NEAR_M, 0.7);
    sea = open_overhang(SHAPE_MESH, 0.0);
    sea_object(sea, 0)->pitch_rad = PI; /* standing on its tip */
    sea_add_tetrahedron(sea);
    compare_estimators("under a mesh", sea, NEAR_M, 0.7);
}

/* Sound that mirrors alone send into the source's rectangle is a glint and counts in no energy. */
CLAIM(brute_force_leaves_glints_out)
{
    const struct ranges ranges = ranges_about(MIDDLE_M, CHAIN_RANGES);
    struct sea *sea = open_capsule(false);
    sonject_object_params *capsule = sea_object(sea, 0);
    capsule->heading_rad = 0.0;
    set_mirror(&capsule->material, 1.0);
    sea->seabed->lambert = 0.0;
    sea->sonar->transducer_side_m = 8.0;
    sea->injection->estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
    const struct energies counted = sea_chains(sea, &ranges, 900, 2);
    for (int i = 0; i < CHAIN_ORDERS * CHAIN_RANGES; i++)
        assert_true((&counted.sum[0][0])[i] == 0.0);
}

/* In focused columns paths between seabed and target are searched from the seabed alone and stand
 * for both ways. With a source of a millimetre beside the receiver both are found on their own,
 * each seen from broadside of its first hit. At this range that changes the angles by less than a
 * degree and the energies by less than 3 %. Rays are few: errors are as large as this. */
CLAIM(one_way_stands_for_both)
{
    for (int has_relief = 0; has_relief < 2; has_relief++) {
        struct sea *sea = open_capsule(has_relief);
        sea->sonar->altitude_m = 80.0;
        sea_move(sea, FAR_M);
        sea->injection->column_rule = SONJECT_COLUMNS_FOCUSED;
        sea->injection->ray_scale = FEW_RAYS;
        const struct energies reciprocal = trace_seeds(sea, FAR_M, 100);
        sea->sonar->transducer_side_m = 1e-3;
        const struct energies plain = trace_seeds(sea, FAR_M, 900);
        expect_same("one way for both", &reciprocal, &plain, 0.03);
    }
}

/* ---- against the reference ---- */

/* The orders of Figure 7's capsule have the reference's energy, however weak the surfaces are.
 * Sound goes to and fro between them, so each path of the reference is scaled by the surfaces that
 * it meets. A drum on its side lies within one sphere, which also holds the seabed under its
 * overhang. Weak surfaces have fewer seeds, enough to show that shares scale. Paths begin on seabed
 * from well before the patch to its end. A bin of 3 mm, shared at a range's ends, is systematic. */
CLAIM(orders_have_the_references_energy)
{
    static struct reference_energy energy;
    static const double seabed_and_target_db[][2] = {
        {-7.0, -7.0}, {-60.0, -60.0}, {-10.0, -60.0}, {-60.0, -10.0}};
    for (int is_drum = 0; is_drum < 2; is_drum++) {
        struct reference_scene scene;
        struct reference_request request;
        struct sea *sea = is_drum ? open_with(SHAPE_CYLINDER, 0.6, 0.6) : open_capsule(false);
        sea_ready(sea);
        reference_of_sea(sea, is_drum ? REFERENCE_CYLINDER : REFERENCE_CAPSULE, &scene, &request);
        request.ranges = ranges_about(MIDDLE_M, CHAIN_RANGES);
        request.near_ground = sqrt(34.0 * 34.0 - scene.altitude * scene.altitude);
        request.far_ground = sqrt(52.9 * 52.9 - scene.altitude * scene.altitude);
        request.rays = 800000;
        reference_trace(&scene, &request, &energy);
        for (size_t i = 0; i < (is_drum ? 1 : COUNT(seabed_and_target_db)); i++) {
            struct estimate expected[CHAIN_ORDERS][CHAIN_RANGES] = {0};
            sea->seabed->lambert = pow(10.0, 0.1 * seabed_and_target_db[i][0]);
            sea_object(sea, 0)->material.lambert = pow(10.0, 0.1 * seabed_and_target_db[i][1]);
            for (int path = 0; path < REFERENCE_PATHS; path++) {
                int met[REFERENCE_ORDERS];
                const int count = reference_met(path, met);
                double factor = 1.0;
                for (int k = 0; k < count; k++)
                    factor *= met[k] == MET_SEABED
                                  ? sea->seabed->lambert / scene.seabed_lambert
                                  : sea_object(sea, 0)->material.lambert / scene.body.lambert;
                for (int range = 0; count > 1 && range < CHAIN_RANGES; range++) {
                    const struct estimate value = energy.in_first[path][range];
                    struct estimate *sum = &expected[count - 1][range];
                    sum->mean += factor * value.mean;
                    sum->error = hypot(sum->error, factor * value.error);
                }
            }
            const struct energies traced =
                sea_chains(sea, &request.ranges, 100, i == 0 ? SEEDS : SEEDS / 3);
            print_message("%g dB, %g dB\n", seabed_and_target_db[i][0], seabed_and_target_db[i][1]);
            for (int order = 1; order < ORDERS; order++)
                expect_energies("orders", &traced, order, expected[order], CHAIN_RANGES, 0.01, 0.1,
                                4);
        }
    }
}

/* Echoes of an object by way of the seabed's mirror belong to the pairs of sources. Chains could
 * find them, too, but must not count them again. Over a mirror without a rough part chains have
 * nothing else to find. */
CLAIM(a_mirrored_object_is_left_to_image_pairs)
{
    const struct ranges ranges = ranges_about(MIDDLE_M, CHAIN_RANGES);
    struct sea *sea = open_capsule(false);
    sea->injection->interactions = 2;
    sea->injection->column_rule = SONJECT_COLUMNS_FOCUSED;
    sea->seabed->forward.reflection = 0.9;
    sea->seabed->forward.lambert = 0.0;
    const struct energies energies = sea_chains(sea, &ranges, 1, 1);
    assert_true(sea->bench->tracer.counts.queries >
                sea->bench->tracer.counts.rays + 1000); /* connections to the source were tested */
    for (int range = 0; range < CHAIN_RANGES; range++)
        assert_true(energies.sum[1][range] == 0.0);
}

/* The narrowest cones are 2500 times as bright as Lambert's law, and tallies must hold them. A
 * sphere alone echoes a quarter of its radius' square, and other paths add to that. A tilted plate
 * mirrors past the sonar. Eight interactions take long. Half the seeds know the sum to 15 %. */
CLAIM(the_narrowest_cone_is_in_scale)
{
    static const double slopes[] = {0.01, 0.03};
    for (size_t i = 0; i < COUNT(slopes); i++) {
        double energies[SEEDS / 2];
        struct sea *sea = sea_open(80, 160, MIDDLE_M);
        sea_add_sphere(sea, 0.25, 0.0);
        sea_add(sea, SHAPE_PLANE, 1.0, 0.6, 0.0)->roll_rad = 68.0 * PI / 180.0;
        for (uint32_t k = 0; k < 2; k++) {
            make_rough(sea_object(sea, k), 0.0);
            sea_object(sea, k)->material.glossy_albedo = 1.0;
            sea_object(sea, k)->material.glossy_slope = slopes[i];
        }
        sea->injection->interactions = 8;
        sea->injection->order_energies = i == 0;
        sea_ready(sea);
        for (uint64_t seed = 0; seed < SEEDS / 2; seed++) {
            sea->injection->seed = seed;
            energies[seed] = sum_of(sea_image(sea)->target_energy, sea->pixels);
        }
        const struct estimate energy = estimate_of(energies, SEEDS / 2);
        print_message("slope %g: %.4g +- %.2g m2\n", slopes[i], energy.mean, energy.error);
        assert_true(energy.error < 0.15 * energy.mean);
        assert_true(energy.mean >= 0.25 * 0.25 * 0.25 - 4.0 * energy.error);
    }
}

/* ---- a glint that lights the seabed: double integral over the sphere ---- */

struct lit {
    double radius, height, lambert; /* of the sphere, of its centre, of the seabed */
    struct ranges ranges;           /* counted from the sphere's centre */
    int steps;                      /* of the integral, in each direction */
};
static const struct lit lit = {0.5, 1.5, 0.02, {3, 0.25, 0.25}, 3001};

/* Adds one bundle of rays, of the wavefront dx by r dphi at the sphere. The sphere mirrors its
 * energy, over the square of the range, to the seabed, which sends mu cos(angle) / r^2 of it to the
 * sonar. The sonar is broadside of the sphere's hit, in focused columns of the middle of both
 * hits. */
static void add_bundle(const struct sea *sea, const struct reference_scene *scene, double x,
                       double elevation, double width, struct estimate *energies)
{
    const double altitude = sea->sonar->altitude_m;
    const struct reference_vector sonar = {x, 0.0, altitude};
    const struct reference_vector out = {0.0, cos(elevation), sin(elevation)};
    const struct reference_vector centre = scene->body.centre;
    struct reference_hit first, last;
    if (reference_nearest(scene, sonar, out, &first) != MET_TARGET)
        return;
    const struct reference_vector on =
        reference_sum(out, -2.0 * reference_dot(out, first.normal), first.normal);
    if (reference_nearest(scene, first.point, on, &last) != MET_SEABED)
        return;
    const bool is_focused = sea->injection->column_rule == SONJECT_COLUMNS_FOCUSED;
    const double aside = is_focused ? 0.5 * (last.point.x - x) : 0.0;
    const struct reference_vector home = {x + aside, 0.0, altitude};
    const struct reference_vector back = reference_sum(home, -1.0, last.point);
    const double square = reference_dot(back, back);
    if (reference_blocked(scene, last.point, home))
        return;
    const double half_path = 0.5 * (hypot(first.distance, aside) + last.distance + sqrt(square));
    const int range =
        (int)floor((half_path - hypot(centre.y, altitude - centre.z) - lit.ranges.first_m) /
                   lit.ranges.width_m);
    if (range >= 0 && range < lit.ranges.count)
        energies[range].mean += width / first.distance * 0.8 * 0.8 * lit.lambert * back.z /
                                pow(square, 1.5) * pow(half_path, 4.0);
}

/* The path sonar, smooth sphere, Lambert seabed, sonar and its reverse. In paper columns the path
 * is in its first hit's column, the reverse in the seabed's. In focused columns both are one echo
 * of twice the amplitude. 1 % is for bins at a range's edges and seabed beyond the track's ends. */
CLAIM(a_glint_lights_the_seabed)
{
    for (int is_focused = 0; is_focused < 2; is_focused++) {
        struct estimate expected[3] = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
        struct sea *sea = sea_open(480, 200, 50.0);
        sonject_object_params *sphere = sea_add_sphere(sea, lit.radius, lit.height - lit.radius);
        sphere->material.reflection = 0.8;
        sea->seabed->lambert = lit.lambert;
        sea->injection->interactions = 2;
        sea->injection->column_rule = is_focused ? SONJECT_COLUMNS_FOCUSED : SONJECT_COLUMNS_PAPER;
        sea_ready(sea);
        const double *centre = sea_centre(sea, 0);
        struct reference_scene scene;
        struct reference_request request;
        reference_of_sea(sea, REFERENCE_SPHERE, &scene, &request);
        const double drop = sea->sonar->altitude_m - centre[2];
        const double middle = -atan2(drop, centre[1]);
        const double half_angle = 1.02 * lit.radius / hypot(drop, centre[1]);
        const double width = 2.0 * lit.radius / lit.steps * 2.0 * half_angle / lit.steps;
        for (int i = 0; i < lit.steps; i++)
            for (int j = 0; j < lit.steps; j++)
                add_bundle(sea, &scene, centre[0] + lit.radius * ((2 * i + 1.0) / lit.steps - 1.0),
                           middle + half_angle * ((2 * j + 1.0) / lit.steps - 1.0), width,
                           expected);
        struct ranges ranges = lit.ranges;
        ranges.first_m += sea_slant_range(sea, 0);
        for (int range = 0; range < ranges.count; range++)
            expected[range].mean *= is_focused ? 4.0 : 2.0;
        const struct energies measured = sea_chains(sea, &ranges, 1, 8);
        expect_energies(is_focused ? "focused columns" : "paper columns", &measured, 1, expected,
                        ranges.count, 0.01, 1.0, ranges.count);
    }
}

/* ---- a Lambert sphere well over the seabed ---- */

#define OVER_M      52.0 /* range of the patch's middle, and the first that counts */
#define HEIGHT_M    1.5
#define RADIUS_M    0.4
#define RINGS       150 /* rings of seabed, ever wider */
#define SECTORS     200
#define PARALLEL    24 /* pieces of the sphere */
#define MERIDIAN    48
#define REFERENCE_M 200.0 /* the reference's depth; its black seabed is not heard */

static const struct ranges behind = {2, OVER_M, 0.5};

static struct sea *open_over_seabed(uint32_t interactions)
{
    struct sea *sea = sea_open(300, 400, OVER_M);
    sea->geometry->row_spacing_m = 0.1;
    make_rough(sea_add_sphere(sea, RADIUS_M, HEIGHT_M - RADIUS_M), 0.3);
    sea->seabed->lambert = 0.1;
    sea->injection->interactions = interactions;
    sea->injection->order_energies = 1;
    sea->injection->column_rule = SONJECT_COLUMNS_FOCUSED;
    return sea;
}

/* Adds the paths sonar, seabed at `bottom`, a piece of the sphere, sonar. The sonar is broadside of
 * the middle between both hits. Together with its reverse a path is in the image four times. */
static void add_pieces(const struct sea *sea, struct reference_vector centre,
                       struct reference_vector bottom, double area, struct estimate *expected)
{
    const double altitude = sea->sonar->altitude_m;
    const struct reference_vector broadside = {bottom.x, 0.0, altitude}, up = {0.0, 0.0, 1.0};
    const struct reference_scene scene = {
        .body = {.shape = REFERENCE_SPHERE, .centre = centre, .radius = RADIUS_M}};
    if (reference_blocked(&scene, broadside, reference_sum(bottom, 1e-9, up)))
        return;
    for (int i = 0; i < PARALLEL; i++)
        for (int k = 0; k < MERIDIAN; k++) {
            const double cosine = 2.0 * (i + 0.5) / PARALLEL - 1.0;
            const double sine = sqrt(1.0 - cosine * cosine);
            const double turn = 2.0 * PI * (k + 0.5) / MERIDIAN;
            const struct reference_vector normal = {sine * cos(turn), sine * sin(turn), cosine};
            const struct reference_vector hit = reference_sum(centre, RADIUS_M, normal);
            const struct reference_vector sonar = {0.5 * (bottom.x + hit.x), 0.0, altitude};
            const struct reference_vector between = reference_sum(bottom, -1.0, hit);
            const struct reference_vector home = reference_sum(sonar, -1.0, hit);
            const struct reference_vector out = reference_sum(bottom, -1.0, sonar);
            const double first = sqrt(reference_dot(out, out));
            const double lit_by = sea->seabed->lambert * area * altitude / pow(first, 3.0);
            const double way = sqrt(reference_dot(between, between)),
                         last = sqrt(reference_dot(home, home));
            if (reference_dot(between, normal) <= 0.0 || reference_dot(home, normal) <= 0.0)
                continue;
            const double half_path = 0.5 * (first + way + last);
            const int range = (int)floor((half_path - behind.first_m) / behind.width_m);
            if (range < 0 || range >= behind.count)
                continue;
            const double piece = 4.0 * PI * RADIUS_M * RADIUS_M / (PARALLEL * MERIDIAN);
            expected[range].mean +=
                4.0 * lit_by * hit.z / pow(way, 4.0) * reference_dot(between, normal) * piece *
                0.3 * reference_dot(home, normal) / pow(last, 3.0) * pow(half_path, 4.0);
        }
}

/* Seabed far in front of the sphere is heard. The reference is an integral over the sphere and all
 * seabed, up to below the sonar. 1.5 % allows for bins at the edges of a range and for what may be
 * left out: 0.5 % of the detours up to the sphere's height, which are in the first two ranges. */
CLAIM(far_seabed_is_heard)
{
    struct estimate expected[2] = {{0.0, 0.0}, {0.0, 0.0}};
    struct sea *sea = open_over_seabed(2);
    sea_ready(sea);
    const double *placed = sea_centre(sea, 0);
    const struct reference_vector centre = {0.0, placed[1], placed[2]};
    const double growth = log(placed[1] / 0.02) / RINGS;
    for (int ring = 0; ring < RINGS; ring++)
        for (int sector = 0; sector < SECTORS; sector++) {
            const double from_centre = 0.02 * exp(growth * (ring + 0.5));
            const double turn = 2.0 * PI * (sector + 0.5) / SECTORS;
            const struct reference_vector bottom = {from_centre * sin(turn),
                                                    placed[1] - from_centre * cos(turn), 0.0};
            if (bottom.y > 0.0)
                add_pieces(sea, centre, bottom,
                           from_centre * from_centre * growth * 2.0 * PI / SECTORS, expected);
        }
    const struct energies measured = sea_chains(sea, &behind, 1, 8);
    expect_energies("far seabed", &measured, 1, expected, behind.count, 0.015, 0.02, behind.count);
}

/* Returns how often a path of three interactions is in the image. */
static double ways_of(int path)
{
    int met[REFERENCE_ORDERS];
    if (reference_met(path, met) < 3 ||
        (met[0] != MET_TARGET && met[1] != MET_TARGET && met[2] != MET_TARGET) ||
        met[2] == MET_MIRROR)
        return 0.0; /* a path that ends on the mirror is a reverse */
    if (met[0] == met[2])
        return 2.0;
    return met[0] == MET_TARGET ? 0.0 : 4.0;
}

/* Paths that begin at the seabed's mirror, above all sonar, seabed's mirror, sphere, seabed, sonar.
 * The reference has them upside down, with a sphere under its sea surface and a black seabed. The
 * mirror's point is 7.7 m in front of the sphere, so the sound spreads 8 m further. */
CLAIM(sound_spreads_from_the_mirrored_sonar)
{
    static struct reference_energy energy;
    struct reference_scene scene;
    struct reference_request request;
    struct estimate expected[2] = {{0.0, 0.0}, {0.0, 0.0}};
    struct sea *sea = open_over_seabed(3);
    sea->seabed->forward.reflection = 0.9;
    sea_ready(sea);
    reference_of_sea(sea, REFERENCE_SPHERE, &scene, &request);
    scene.depth = REFERENCE_M;
    scene.altitude = REFERENCE_M - scene.altitude;
    scene.body.centre.z = REFERENCE_M - scene.body.centre.z;
    scene.surface_lambert = scene.seabed_lambert;
    scene.seabed_lambert = 0.0;
    /* the mirror has the energy that the rough part leaves */
    scene.reflection = sqrt(1.0 - PI * sea->seabed->lambert) * 0.9;
    scene.phase = 0.0;
    scene.rough_is_apart = true;
    request.ranges = behind;
    request.is_focused = true;
    request.rays = 2000000;
    reference_trace(&scene, &request, &energy);
    for (int path = 0; path < REFERENCE_PATHS; path++) {
        const double ways = ways_of(path);
        for (int range = 0; range < behind.count; range++) {
            const struct estimate value = energy.in_first[path][range];
            expected[range].mean += ways * value.mean;
            expected[range].error = hypot(expected[range].error, ways * value.error);
        }
    }
    const struct energies measured = sea_chains(sea, &behind, 1, 8);
    expect_energies("mirror first", &measured, 2, expected, behind.count, 0.01, 0.02, behind.count);
}

/* ---- second order ---- */

static float rays_counted; /* times the rays that there are */

/* Weighs the target's rays as if there were rays_counted times as many. Samples have the rest. */
static void weigh_rays(struct bench *bench, struct chain_trace *trace)
{
    struct report *report = &bench->report;
    const device_buffer buffer = trace->launch.buffers[LAUNCH_SPHERES];
    struct chain_record *chains = bench_copy_buffer(bench, trace->launch.buffers[LAUNCH_CHAINS]);
    float *words = bench_copy_buffer(bench, buffer);
    struct target_record *target = (void *)(words + chains->target_words);
    assert_true(chains->cell_samples > 0 && target->rays > 0.0f);
    target->rays *= rays_counted;
    EXPECT_OK(report, buffer_write(report, bench->tracer.device, buffer,
                                   chains->target_words * sizeof *words, sizeof *target, target));
    free(words);
    free(chains);
}

static struct energies weighed_seeds(struct sea *sea, float counted, uint64_t first_seed)
{
    const struct ranges ranges = {FEW_RANGES, MIDDLE_M - 0.7, 0.5};
    rays_counted = counted;
    return sea_changed_chains(sea, &ranges, first_seed, SEEDS, weigh_rays);
}

/* Paths between target and seabed are sampled by the cells in which their echoes end, and are found
 * by rays that the target scatters. Either way alone finds all of them, and so do both with their
 * proper shares. Samples alone vary without bound where target and seabed touch, so most targets
 * hang over the seabed. */
CLAIM(samples_and_rays_find_the_same_paths)
{
    static const struct water_layer layers[] = {{0.0, 1480.0, 1.0}, {4.0, 1520.0, 1.0}};
    static const char *const names[] = {"over the seabed", "over relief",  "through layers",
                                        "glossy",          "weak",         "on the seabed",
                                        "low, on relief",  "partly smooth"};
    for (int variant = 0; variant < 8; variant++) {
        struct sea *sea = open_capsule(variant == 1 || variant == 6);
        sea->injection->ray_scale = FEW_RAYS;
        sea->injection->column_rule = SONJECT_COLUMNS_FOCUSED;
        if (variant < 5)
            sea_object(sea, 0)->burial_m = -0.4;
        if (variant == 4) /* cells leave out some samples of so weak a target */
            make_rough(sea_object(sea, 0), 0.002);
        if (variant == 6) {
            sea_object(sea, 0)->diameter_m = 0.12;
            sea_object(sea, 0)->burial_m = 0.0;
        }
        if (variant == 7) {
            sea_object(sea, 0)->material.reflection = 0.7;
            sea_object(sea, 0)->material.roughness_m = 2e-3;
        }
        if (variant == 2)
            sea_set_layers(sea, layers, 2);
        if (variant == 3) {
            sea_object(sea, 0)->material.glossy_albedo = 0.2;
            sea_object(sea, 0)->material.glossy_slope = 0.2;
        }
        const struct energies by_rays = weighed_seeds(sea, 1e6f, 1);
        const struct energies by_both = weighed_seeds(sea, 1.0f, 200);
        print_message("%s\n", names[variant]);
        expect_same("both", &by_both, &by_rays, 0.003);
        if (variant >= 5)
            continue;
        const struct energies by_samples = weighed_seeds(sea, 1e-6f, 100);
        expect_same("samples", &by_samples, &by_rays, 0.003);
    }
}
