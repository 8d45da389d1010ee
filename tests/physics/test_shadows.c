/* Shadows lie where rays say they must, and starboard mirrors port. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "inject/injection.h"
#include "shadow_edge.h"

#define ROWS    201
#define COLUMNS 401
#define RANGE   40.0

/* Visibility 1 - lost / without, row by row. */
static double *visibility_of(struct bench *bench)
{
    struct echoes echoes;
    bench->scene.injection.ray_scale = 16.0;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    double *visibility = calloc(ROWS * COLUMNS, sizeof *visibility);
    assert_non_null(visibility);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        visibility[i] = 1.0 - (double)echoes.lost_energy[i] / echoes.seabed_energy[i];
        /* single precision sums of the same energies */
        assert_true(visibility[i] > -1e-5 && visibility[i] < 1.0 + 1e-5);
    }
    echoes_clear(&echoes);
    return visibility;
}

/* Visibility along the track, mean over some columns: where an edge runs along the rays, each ray
 * of a strip is hidden or not by chance. */
static void along_track(const double *visibility, size_t first_column, size_t columns,
                        double line[ROWS])
{
    for (size_t row = 0; row < ROWS; row++) {
        line[row] = 0.0;
        for (size_t column = first_column; column < first_column + columns; column++)
            line[row] += visibility[row * COLUMNS + column] / (double)columns;
    }
}

static double column_of_ground(const struct bench *bench, double ground_range)
{
    return view_column_of_range(&bench->tracer.view,
                                hypot(ground_range, bench->tracer.view.altitude_m));
}

/* A level plate at height H hides the ground from y h/(h - H) of its near edge to that of its far
 * one: H y/(h - H) behind each. Half a pixel is asked; stratified rays draw a tenth of it. */
static void test_flat_top(void **unused)
{
    (void)unused;
    static const double heights[] = {0.3, 0.6, 1.0};
    for (size_t i = 0; i < 3; i++) {
        const double height = heights[i];
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench_add(&bench, SONJECT_SHAPE_PLANE, 2.0, 1.2, 0.0)->burial_m = -height;
        double *visibility = visibility_of(&bench);
        const double *row = visibility + 100 * COLUMNS;
        const double h = bench.tracer.view.altitude_m;
        const double centre = bench.placements[0].centre[1];
        const double near = (centre - 0.6) * h / (h - height);
        const double far = (centre + 0.6) * h / (h - height);
        const double middle = column_of_ground(&bench, 0.5 * (near + far));
        print_message("height %.1f m\n", height);
        expect_close("shadow begins, column", shadow_edge(row, 0, (size_t)middle),
                     column_of_ground(&bench, near), 0.05);
        expect_close("shadow ends, column", shadow_edge(row, (size_t)middle, COLUMNS - 1),
                     column_of_ground(&bench, far), 0.05);
        const double range =
            view_apparent_range(&bench.tracer.view, shadow_edge(row, (size_t)middle, COLUMNS - 1));
        expect_close("length behind the far edge, m", sqrt(range * range - h * h) - (centre + 0.6),
                     height * (centre + 0.6) / (h - height), 0.05 * 0.025 / (centre / RANGE));
        /* the plate's middle is on row 100, its ends 1 m = 40 rows away */
        double line[ROWS];
        along_track(visibility, (size_t)middle - 10, 21, line);
        /* 20 columns of some 130 rays each: 0.5/sqrt(2600) is 0.01, 0.02 rows */
        expect_close("shadow's side, row", shadow_edge(line, 0, 100), 60.0, 0.08);
        expect_close("shadow's other side, row", shadow_edge(line, 100, ROWS - 1), 140.0, 0.08);
        expect_below("visibility in the middle", row[(size_t)(middle + 0.5)], 0.02);
        free(visibility);
        bench_close(&bench);
    }
}

/* Rays tangent to the sphere, in the plane through its centre. */
static void test_sphere(void **unused)
{
    (void)unused;
    static const double radii[] = {0.25, 0.35};
    static const double burials[] = {0.0, -0.2};
    for (size_t i = 0; i < 4; i++) {
        const double a = radii[i % 2];
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * a)->burial_m = burials[i / 2];
        double *visibility = visibility_of(&bench);
        const double *row = visibility + 100 * COLUMNS;
        const double h = bench.tracer.view.altitude_m;
        const double *centre = bench.placements[0].centre;
        const double depression = atan2(h - centre[2], centre[1]);
        const double half = asin(a / hypot(h - centre[2], centre[1]));
        const double near = column_of_ground(&bench, h / tan(depression + half));
        const double far = column_of_ground(&bench, h / tan(depression - half));
        const size_t middle = (size_t)(0.5 * (near + far));
        print_message("radius %.2f m, %.1f m over the seabed\n", a, -burials[i / 2]);
        /* the rows beside, which |W|^2 brings in, have a shorter shadow */
        expect_close("shadow begins, column", shadow_edge(row, 0, middle), near, 0.06);
        expect_close("shadow ends, column", shadow_edge(row, middle, COLUMNS - 1), far, 0.06);
        /* in the middle of the shadow its width is that of the sphere */
        double line[ROWS];
        along_track(visibility, (size_t)(column_of_ground(&bench, h / tan(depression)) + 0.5), 1,
                    line);
        expect_close("width, rows", shadow_edge(line, 100, ROWS - 1) - shadow_edge(line, 0, 100),
                     2.0 * a / 0.025, 0.15);
        free(visibility);
        bench_close(&bench);
    }
}

static float *flat_pixels(void)
{
    float *pixels = malloc(ROWS * COLUMNS * sizeof *pixels);
    assert_non_null(pixels);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        pixels[i] = 1.0f;
    return pixels;
}

/* A tilted plate off the middle: nothing about it is symmetric. */
static void add_plate(struct bench *bench, double row, double heading, double roll)
{
    sonject_object_params *object = bench_add(bench, SONJECT_SHAPE_PLANE, 1.0, 0.7, 0.0);
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = row;
    object->position_range = 180.0;
    object->heading_rad = heading;
    object->pitch_rad = 0.3;
    object->roll_rad = roll;
    object->material.lambert = 0.05;
    object->material.reflection = 0.5;
    object->material.roughness_m = 1e-3;
}

static void inject(struct bench *bench, const float *pixels, struct injection_result *result)
{
    struct injection_input input;
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.pixels = pixels;
    if (injection_run(&bench->report, bench->tracer.device, &bench->scene, &input, NULL, NULL,
                      result) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
}

/* Starboard is port seen from the other end: rows in reverse, heading pi less, roll the other way
 * round. The same rays are traced, so every bit agrees. */
static void test_starboard_is_mirrored(void **unused)
{
    (void)unused;
    float *pixels = flat_pixels();
    struct injection_result port, starboard;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.geometry.first_along_track_m = -200.0 * 0.025;
    add_plate(&bench, 200.0 - 80.0, PI - 0.5, -0.25);
    inject(&bench, pixels, &port);
    bench.scene.geometry.side = SONJECT_SIDE_STARBOARD;
    bench.scene.geometry.first_along_track_m = 0.0;
    bench.scene.objects[0].position_along = 80.0;
    bench.scene.objects[0].heading_rad = 0.5;
    bench.scene.objects[0].roll_rad = 0.25;
    inject(&bench, pixels, &starboard);
    size_t shaded = 0;
    for (size_t row = 0; row < ROWS; row++)
        for (size_t column = 0; column < COLUMNS; column++) {
            const size_t i = row * COLUMNS + column;
            const size_t j = (ROWS - 1 - row) * COLUMNS + column;
            assert_true(starboard.energy[i] == port.energy[j]);
            assert_true(starboard.visibility[i] == port.visibility[j]);
            assert_true(starboard.image[i] == port.image[j]);
            assert_true(starboard.field[2 * i] == port.field[2 * j]);
            assert_int_equal(starboard.labels[i], port.labels[j]);
            shaded += starboard.visibility[i] < 0.5f;
        }
    assert_true(shaded > 100);
    expect_close("row of the truth", starboard.objects[0].row, 80.0, 1e-9);
    injection_result_clear(&port);
    injection_result_clear(&starboard);
    bench_close(&bench);
    free(pixels);
}

/* The same scene on the other side makes the same picture: poses are meant in ping order. Other
 * rays are traced, so energies agree as far as their number allows. */
static void test_sides_look_alike(void **unused)
{
    (void)unused;
    float *pixels = flat_pixels();
    struct injection_result port, starboard;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.ray_scale = 4.0;
    add_plate(&bench, 80.0, 0.5, 0.25);
    inject(&bench, pixels, &port);
    bench.scene.geometry.side = SONJECT_SIDE_STARBOARD;
    inject(&bench, pixels, &starboard);
    double difference = 0.0;
    double sum = 0.0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        difference += fabs(starboard.visibility[i] - port.visibility[i]);
        sum += 1.0 - port.visibility[i];
    }
    /* a pixel on the shadow's edge has some 100 rays: a few per cent of the edge's pixels, which
     * are a tenth of the shadow. A turned plate would share half of its shadow at best. */
    expect_below("shadows' difference over their area", difference / sum, 0.02);
    injection_result_clear(&port);
    injection_result_clear(&starboard);
    bench_close(&bench);
    free(pixels);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flat_top),
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_starboard_is_mirrored),
        cmocka_unit_test(test_sides_look_alike),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
