/* Objects of parts: their union is what a single shape of the same outline is. Rays of the two
 * differ, so pictures agree as two seeds of the same do; smooth surfaces agree within the error of
 * their sampling. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "scene/pose.h"
#include "union_mesh.h"

#define ROWS    161
#define COLUMNS 161
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define RANGE   40.0
#define SEEDS   4

/* Of rays on the wavefront, m, see lib/trace/smooth.c. */
#define WAVELENGTH 0.015
#define CELL       (WAVELENGTH / 8.0)

/* An object of one shape, or of parts: then width and height are those of its boxes. */
static sonject_object_params *add(struct bench *bench, sonject_shape shape, double length,
                                  double width, double height, double diameter)
{
    sonject_object_params *object = bench_add(bench, shape, length, width, diameter);
    object->height_m = height;
    return object;
}

/* A part of the first object, with the object's surface. */
static sonject_object_params *add_part(struct bench *bench, sonject_shape shape, double length,
                                       double diameter, double along, double across, double up)
{
    struct scene_part part;
    memset(&part, 0, sizeof part);
    part.shape = bench->scene.objects[0];
    part.shape.shape = shape;
    part.shape.length_m = length;
    part.shape.diameter_m = diameter;
    part.centre[0] = along;
    part.centre[1] = across;
    part.centre[2] = up;
    turn_axes(part.axes, 0.0, 0.0, 0.0);
    if (scene_append_part(&bench->scene, &bench->report, &part) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    return &bench->scene.parts[bench->scene.part_count - 1].shape;
}

/* Makes one of two objects that look the same, in one of some poses. */
typedef void (*builder)(struct bench *bench, bool other, size_t pose);

#define GRAZING 0.245 /* rad, of the sound that comes to the objects, about */

static void turn(sonject_object_params *object, const double pose[3])
{
    object->heading_rad = pose[0];
    object->pitch_rad = pose[1];
    object->roll_rad = pose[2];
}

#define LENGTH   1.2
#define DIAMETER 0.4

/* Any pose, broadside, and its nose to the sonar, where the ends of the cylinder within would
 * mirror the most. */
static const double capsule_poses[][3] = {
    {0.6, 0.2, 0.0}, {0.0, 0.0, 0.0}, {-0.5 * PI, GRAZING, 0.0}};

static void build_capsule(struct bench *bench, bool of_parts, size_t pose)
{
    const double straight = LENGTH - DIAMETER;
    sonject_object_params *object = add(
        bench, of_parts ? SONJECT_SHAPE_PARTS : SONJECT_SHAPE_CAPSULE, LENGTH, 0.0, 0.0, DIAMETER);
    turn(object, capsule_poses[pose]);
    if (!of_parts)
        return;
    add_part(bench, SONJECT_SHAPE_CYLINDER, straight, DIAMETER, 0.0, 0.0, 0.0);
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, DIAMETER, 0.5 * straight, 0.0, 0.0);
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, DIAMETER, -0.5 * straight, 0.0, 0.0);
}

/* The other one is a cylinder with round ends. */
static void build_capsule_or_cylinder(struct bench *bench, bool is_cylinder, size_t pose)
{
    build_capsule(bench, false, pose);
    sonject_object_params *object = &bench->scene.objects[0];
    if (!is_cylinder)
        return;
    object->shape = SONJECT_SHAPE_CYLINDER;
    object->nose_end = object->tail_end = SONJECT_END_SPHERICAL;
}

/* Any pose, and with a face to the sonar: a long one, with the joint in it, and the nose, behind
 * which the joint lies like another one. */
static const double box_poses[][3] = {
    {-1.0, 0.0, 0.15}, {0.0, 0.0, -GRAZING}, {-0.5 * PI, GRAZING, 0.0}};

static void build_box(struct bench *bench, bool of_parts, size_t pose)
{
    sonject_object_params *object =
        add(bench, of_parts ? SONJECT_SHAPE_PARTS : SONJECT_SHAPE_BOX, 1.0, 0.6, 0.4, 0.0);
    turn(object, box_poses[pose]);
    if (!of_parts)
        return;
    add_part(bench, SONJECT_SHAPE_BOX, 0.7, 0.0, -0.15, 0.0, 0.0);
    add_part(bench, SONJECT_SHAPE_BOX, 0.3, 0.0, 0.35, 0.0, 0.0);
}

static void build_spheres(struct bench *bench, bool of_parts, size_t pose)
{
    (void)pose;
    add(bench, of_parts ? SONJECT_SHAPE_PARTS : SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.6);
    if (!of_parts)
        return;
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.6, 0.0, 0.0, 0.0);
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.6, 0.0, 0.0, 0.0);
}

/* A sphere that lies in another touches no sound. */
static void build_hidden_sphere(struct bench *bench, bool of_parts, size_t pose)
{
    (void)pose;
    add(bench, of_parts ? SONJECT_SHAPE_PARTS : SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.6);
    if (!of_parts)
        return;
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.6, 0.0, 0.0, 0.0);
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.4, 0.05, -0.05, 0.02);
}

/* A lopsided object on the starboard side, and one of the other hand on the port side. Pose is
 * counted in the image, where they look the same; what is left of the nose is right of it there. */
static void build_lopsided(struct bench *bench, bool is_starboard, size_t pose)
{
    const double hand = is_starboard ? 1.0 : -1.0;
    (void)pose;
    bench->scene.geometry.side = is_starboard ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
    sonject_object_params *object = add(bench, SONJECT_SHAPE_PARTS, 0.0, 0.0, 0.0, 0.0);
    object->heading_rad = 0.5;
    object->pitch_rad = 0.1;
    object->roll_rad = 0.2;
    add_part(bench, SONJECT_SHAPE_CYLINDER, 1.0, 0.2, 0.0, 0.0, 0.0);
    add_part(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.4, 0.5, 0.3 * hand, 0.1);
    add_part(bench, SONJECT_SHAPE_CYLINDER, 0.8, 0.2, -0.4, -0.2 * hand, 0.2);
    turn_axes(bench->scene.parts[2].axes, 0.7 * hand, 0.3, 0.4 * hand);
    sonject_object_params *cut = &bench->scene.parts[1].shape;
    cut->cut_count = 1;
    cut->cuts[0].azimuth_rad = 1.0 * hand;
    cut->cuts[0].distance_m = 0.05;
}

/* Turned about the upright, and tipped. */
static const double union_poses[][3] = {{0.4, 0.0, 0.0}, {0.0, 0.0, -GRAZING}};

static void build_union(struct bench *bench, bool is_mesh, size_t pose)
{
    add_union(bench, is_mesh);
    turn(&bench->scene.objects[0], union_poses[pose]);
}

static void make_rough(struct bench *bench)
{
    for (uint32_t i = 0; i < bench->scene.object_count; i++) {
        bench->scene.objects[i].material.reflection = 0.0;
        bench->scene.objects[i].material.lambert = 0.1;
    }
    for (uint32_t i = 0; i < bench->scene.part_count; i++)
        bench->scene.parts[i].shape.material = bench->scene.objects[0].material;
}

/* Rows of a starboard view run against the image's. */
static void reverse_rows(float *plane)
{
    for (size_t row = 0; row < ROWS / 2; row++)
        for (size_t column = 0; column < COLUMNS; column++) {
            float *one = &plane[row * COLUMNS + column];
            float *other = &plane[(ROWS - 1 - row) * COLUMNS + column];
            const float kept = *one;
            *one = *other;
            *other = kept;
        }
}

struct picture {
    builder build;
    bool other, is_rough;
    size_t pose;
    uint64_t seed;
};

static void compute(struct echoes *echoes, const struct picture *picture)
{
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    picture->build(&bench, picture->other, picture->pose);
    if (picture->is_rough)
        make_rough(&bench);
    bench.scene.injection.seed = picture->seed;
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, echoes);
    if (bench.scene.geometry.side == SONJECT_SIDE_STARBOARD) {
        reverse_rows(echoes->target_energy);
        reverse_rows(echoes->lost_energy);
        reverse_rows(echoes->seabed_energy);
    }
    bench_close(&bench);
}

/* Energy and hidden share of the seabed, pixel by pixel, of several seeds. */
struct pictures {
    float *energy[SEEDS], *visibility[SEEDS];
};

static void draw(struct pictures *pictures, builder build, bool other, uint64_t first_seed)
{
    for (uint64_t i = 0; i < SEEDS; i++) {
        struct echoes echoes;
        const struct picture picture = {build, other, true, 0, first_seed + i};
        compute(&echoes, &picture);
        pictures->energy[i] = calloc(PIXELS, sizeof(float));
        pictures->visibility[i] = calloc(PIXELS, sizeof(float));
        assert_true(pictures->energy[i] && pictures->visibility[i]);
        memcpy(pictures->energy[i], echoes.target_energy, PIXELS * sizeof(float));
        for (size_t k = 0; k < PIXELS; k++)
            pictures->visibility[i][k] = 1.0f - echoes.lost_energy[k] / echoes.seabed_energy[k];
        echoes_clear(&echoes);
    }
}

static void pictures_clear(struct pictures *pictures)
{
    for (size_t i = 0; i < SEEDS; i++) {
        free(pictures->energy[i]);
        free(pictures->visibility[i]);
    }
}

static double difference(const float *a, const float *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < PIXELS; i++)
        sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sum;
}

static double total(const float *plane)
{
    double sum = 0.0;
    for (size_t i = 0; i < PIXELS; i++)
        sum += plane[i];
    return sum;
}

/* Mean square differences of pictures of one and of the other, over those of two seeds of the same:
 * 1 if they are the same. Some thousand pixels in 16 pairs tell within a few per cent; a joint
 * that shows, or a shadow that is a pixel off, changes it by much more. */
static void expect_same_pictures(const char *what, float *const *one, float *const *other)
{
    double between = 0.0;
    double within = 0.0;
    double means[2] = {0.0, 0.0};
    double squares[2] = {0.0, 0.0};
    for (size_t i = 0; i < SEEDS; i++) {
        for (size_t k = 0; k < SEEDS; k++)
            between += difference(one[i], other[k]) / (SEEDS * SEEDS);
        for (size_t k = 0; k < i; k++)
            within += (difference(one[i], one[k]) + difference(other[i], other[k])) /
                      (SEEDS * (SEEDS - 1));
        const double totals[2] = {total(one[i]), total(other[i])};
        for (int k = 0; k < 2; k++) {
            means[k] += totals[k] / SEEDS;
            squares[k] += totals[k] * totals[k] / SEEDS;
        }
    }
    const double variance =
        (squares[0] - means[0] * means[0] + squares[1] - means[1] * means[1]) / (SEEDS - 1);
    print_message("%s: ", what);
    expect_close("total", means[1], means[0], 4.0 * sqrt(fmax(variance, 0.0)) + 1e-6 * means[0]);
    expect_close("differences over those of seeds", between / within, 1.0, 0.1);
}

static void expect_same_rough_object(builder build)
{
    struct pictures one, other;
    draw(&one, build, false, 1);
    draw(&other, build, true, 1 + SEEDS);
    expect_same_pictures("energy", one.energy, other.energy);
    expect_same_pictures("visibility", one.visibility, other.visibility);
    pictures_clear(&one);
    pictures_clear(&other);
}

/* Error of one pixel if all that rays draw by chance came into it: a cell of the wavefront that an
 * edge divides is hit or missed, by 0.29 of its area (a uniform number's deviation) over the
 * wavelength. In truth it spreads over dozens of pixels. outlines: length of the edges, m. */
static double edge_error(double outlines)
{
    return 0.29 * sqrt(outlines / CELL) * CELL * CELL / WAVELENGTH;
}

static void expect_same_smooth_object(builder build, size_t poses, double outlines)
{
    for (size_t pose = 0; pose < poses; pose++) {
        struct echoes echoes[2];
        double peak = 0.0;
        double largest = 0.0;
        for (int i = 0; i < 2; i++) {
            const struct picture picture = {build, i > 0, false, pose, 1};
            compute(&echoes[i], &picture);
        }
        for (size_t i = 0; i < PIXELS; i++) {
            const float re = echoes[0].target_real[i];
            const float im = echoes[0].target_imaginary[i];
            peak = fmax(peak, hypotf(re, im));
            largest = fmax(
                largest, hypotf(re - echoes[1].target_real[i], im - echoes[1].target_imaginary[i]));
        }
        print_message("pose %zu, glint of %.1f dB re 1 m: ", pose, decibels_of_amplitude(peak));
        expect_below("largest difference, dB", decibels_of_amplitude(largest),
                     decibels_of_amplitude(edge_error(outlines)));
        echoes_clear(&echoes[0]);
        echoes_clear(&echoes[1]);
    }
}

static void test_capsule(void **unused)
{
    (void)unused;
    const double outline = 2.0 * (LENGTH - DIAMETER) + PI * DIAMETER;
    expect_same_rough_object(build_capsule);
    /* two outlines, and four sides of joints, of which a half is seen */
    expect_same_smooth_object(build_capsule, 3, 2.0 * outline + 2.0 * PI * DIAMETER);
}

static void test_cylinder_with_round_ends(void **unused)
{
    (void)unused;
    const double outline = 2.0 * (LENGTH - DIAMETER) + PI * DIAMETER;
    expect_same_rough_object(build_capsule_or_cylinder);
    expect_same_smooth_object(build_capsule_or_cylinder, 3, 2.0 * outline);
}

static void test_box_of_two(void **unused)
{
    (void)unused;
    expect_same_rough_object(build_box);
    expect_same_smooth_object(build_box, 3, 2.0 * (1.0 + 0.6 + 0.4) * 2.0);
}

static void test_mirrored_view(void **unused)
{
    (void)unused;
    expect_same_rough_object(build_lopsided);
}

/* Echoes and shadows of a mesh of the union, pixel by pixel, and its glints. Facets of the cylinder
 * are 3 mm wide and lie 0.005 mm within it: 0.004 rad of phase. Its edges are 10 m long. */
static void test_mesh_of_the_union(void **unused)
{
    (void)unused;
    expect_same_rough_object(build_union);
    expect_same_smooth_object(build_union, 2, 10.0);
}

/* What a union's parts scatter to one another, its mesh scatters to itself. */
static void test_mesh_of_the_union_lights_itself(void **unused)
{
    (void)unused;
    double mean[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
    for (int i = 0; i < 2 * SEEDS; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        add_union(&bench, i % 2 > 0);
        make_rough(&bench);
        bench.scene.objects[0].burial_m = -1.0;
        bench.scene.seabed.lambert = 1e-6; /* so that it is all from the object to the object */
        bench.scene.injection.interactions = 2;
        bench.scene.injection.order_energies = 1;
        bench.scene.injection.seed = (uint64_t)i + 1;
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        const double share = total(echoes.order_energy[1]) / total(echoes.order_energy[0]);
        mean[i % 2] += share / SEEDS;
        square[i % 2] += share * share / SEEDS;
        echoes_clear(&echoes);
        bench_close(&bench);
    }
    const double variance =
        (square[0] - mean[0] * mean[0] + square[1] - mean[1] * mean[1]) / (SEEDS - 1);
    assert_true(mean[0] > 1e-3);
    expect_close("share of two interactions", mean[1], mean[0],
                 4.0 * sqrt(fmax(variance, 0.0)) + 1e-3 * mean[0]);
}

static void expect_nothing_added(builder build)
{
    for (int is_rough = 0; is_rough < 2; is_rough++) {
        struct echoes echoes[2];
        for (int i = 0; i < 2; i++) {
            const struct picture picture = {build, i > 0, is_rough > 0, 0, 1};
            compute(&echoes[i], &picture);
        }
        const size_t bytes = PIXELS * sizeof(float);
        assert_true(total(echoes[0].target_energy) > 0.0);
        assert_memory_equal(echoes[0].target_real, echoes[1].target_real, bytes);
        assert_memory_equal(echoes[0].target_imaginary, echoes[1].target_imaginary, bytes);
        assert_memory_equal(echoes[0].target_energy, echoes[1].target_energy, bytes);
        assert_memory_equal(echoes[0].lost_energy, echoes[1].lost_energy, bytes);
        echoes_clear(&echoes[0]);
        echoes_clear(&echoes[1]);
    }
}

/* The second of two parts in one place, and a part within another, add no echo and hide nothing:
 * the first one's rays are those of the object by itself. */
static void test_hidden_parts(void **unused)
{
    (void)unused;
    expect_nothing_added(build_spheres);
    expect_nothing_added(build_hidden_sphere);
}

/* A sphere ahead and a box behind that is level as the object is pitched. */
static void test_parts_rest_on_the_seabed(void **unused)
{
    (void)unused;
    static const sonject_side sides[] = {SONJECT_SIDE_PORT, SONJECT_SIDE_STARBOARD};
    for (int i = 0; i < 6; i++) {
        struct bench bench;
        const double pitch = 0.3;
        const double lowest = -0.5 * sin(pitch) - 0.1;
        const double height = sin(pitch) + 0.2 - lowest;
        const double bottom = i / 2 == 0 ? -0.05 : i / 2 == 1 ? -0.25 * height : 0.3 - height;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.geometry.side = sides[i % 2];
        sonject_object_params *object = add(&bench, SONJECT_SHAPE_PARTS, 0.0, 0.4, 0.2, 0.0);
        object->heading_rad = 0.7;
        object->pitch_rad = pitch;
        object->burial_kind = (uint32_t)i / 2;
        object->burial_m = 0.05;
        object->burial_fraction = 0.25;
        object->proud_height_m = 0.3;
        add_part(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.4, 1.0, 0.0, 0.0);
        add_part(&bench, SONJECT_SHAPE_BOX, 0.6, 0.0, -0.5, 0.0, 0.0);
        turn_axes(bench.scene.parts[1].axes, 0.0, -pitch, 0.0);
        bench_ready(&bench);
        const struct placed_object *placed = &bench.placed.objects[0];
        /* bounds are exact but for double precision */
        expect_close("lowest point, m", placed->bottom_m, bottom, 1e-12);
        expect_close("highest point, m", placed->top_m, bottom + height, 1e-12);
        expect_close("origin, m", placed->origin[2], bottom - lowest, 1e-12);
        assert_int_equal(placed->part_count, 2);
        bench_close(&bench);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_capsule),
        cmocka_unit_test(test_cylinder_with_round_ends),
        cmocka_unit_test(test_box_of_two),
        cmocka_unit_test(test_mirrored_view),
        cmocka_unit_test(test_mesh_of_the_union),
        cmocka_unit_test(test_mesh_of_the_union_lights_itself),
        cmocka_unit_test(test_hidden_parts),
        cmocka_unit_test(test_parts_rest_on_the_seabed),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
