/* A seabed that is not level: its own echo by the local grazing angle, its shadows and layover, and
 * what it does to targets, against geometry and integration in double precision. */
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

#define ROWS    160
#define COLUMNS 400
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define RANGE   30.0

static double middle_x(const struct bench *bench)
{
    return view_x_of_row(&bench->tracer.view, 0.5 * (ROWS - 1));
}

static double middle_ground(const struct bench *bench)
{
    const struct patch_view *view = &bench->tracer.view;
    return view_ground_range(view, view_apparent_range(view, 0.5 * (COLUMNS - 1)));
}

/* Where a caller's grid of `step` begins that covers the patch. */
static sonject_relief_params grid_over_patch(struct bench *bench, double step)
{
    const struct patch_view *view = &bench->tracer.view;
    sonject_relief_params grid;
    bench_ready(bench);
    const double near = view_ground_range(view, view_apparent_range(view, -1.0));
    const double far = view_ground_range(view, view_apparent_range(view, COLUMNS));
    sonject_relief_params_init(&grid);
    grid.first_along_track_m = view_x_of_row(view, -1.0);
    grid.first_ground_range_m = near;
    grid.row_spacing_m = grid.column_spacing_m = step;
    grid.rows = (uint32_t)((ROWS + 1) * view->row_spacing_m / step) + 2;
    grid.columns = (uint32_t)((far - near) / step) + 2;
    return grid;
}

/* A slope for `half` m each way, then down to 0 in `half` m more. */
static double ramp(double slope, double way, double half)
{
    const double beyond = (fabs(way) - half) / half;
    if (beyond <= 0.0)
        return slope * way;
    return beyond < 1.0 ? copysign(slope * half * 0.5 * (1.0 + cos(PI * beyond)), slope * way)
                        : 0.0;
}

/* Lays a plane of the slopes given through the middle of the patch: of 0.7 m each way along the
 * track, or 2 m in range. */
static void lay_slope(struct bench *bench, double along, double outward)
{
    const double step = 0.025;
    const sonject_relief_params grid = grid_over_patch(bench, step);
    float *heights = calloc((size_t)grid.rows * grid.columns, sizeof *heights);
    assert_non_null(heights);
    for (uint32_t row = 0; row < grid.rows; row++)
        for (uint32_t column = 0; column < grid.columns; column++)
            heights[(size_t)row * grid.columns + column] =
                (float)(ramp(along, grid.first_along_track_m + row * step - middle_x(bench), 0.7) +
                        ramp(outward,
                             grid.first_ground_range_m + column * step - middle_ground(bench),
                             2.0));
    if (relief_features_set_grid(&bench->scene.relief, &bench->report, &grid, heights) !=
        SONJECT_OK)
        fail_msg("%s", bench->report.message);
    free(heights);
    bench_ready(bench);
}

/* On ground that rises with a slope the sound of a range comes from another point, at another
 * angle: mu sin^2(local) / cos(local) times the point response's area on the ground. */
static double slope_energy(const struct bench *bench, double slope, double range)
{
    const struct point_response *response = &bench->tracer.response;
    const double altitude = bench->scene.sonar.altitude_m;
    double low = 1.0;
    double high = range;
    for (int i = 0; i < 60; i++) {
        const double y = 0.5 * (low + high);
        const double z = slope * (y - middle_ground(bench));
        if (hypot(y, altitude - z) < range)
            low = y;
        else
            high = y;
    }
    const double height = slope * (low - middle_ground(bench));
    const double local = atan2(altitude - height, low) + atan(slope);
    const double square = sin(local) * sin(local);
    return bench->scene.seabed.lambert * square / cos(local) * along_track_energy_width(response) *
           range_energy_width(response);
}

static void test_slopes_towards_and_away(void **unused)
{
    (void)unused;
    static const double slopes[] = {0.2, -0.15};
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.injection.ray_scale = 4.0;
        lay_slope(&bench, 0.0, slopes[i]);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        double sum = 0.0, squares = 0.0, change = 0.0;
        size_t count = 0;
        for (size_t column = 150; column < 250; column++) {
            const double range = view_apparent_range(&bench.tracer.view, (double)column);
            double line = 0.0;
            for (size_t row = 60; row < 100; row++)
                line += (double)echoes.seabed_energy[row * COLUMNS + column] / 40.0;
            const double ratio = line / slope_energy(&bench, slopes[i], range);
            sum += ratio;
            squares += ratio * ratio;
            change += line / slope_energy(&bench, 0.0, range);
            count++;
        }
        const double mean = sum / (double)count;
        const double error =
            sqrt(3.0 * fmax(0.0, squares / (double)count - mean * mean) / (double)count);
        print_message("slope %.2f: %.2f of the level seabed\n", slopes[i], change / (double)count);
        /* W's tail beyond the kept reach: 0.1 % of the energy */
        expect_close("energy over closed form", mean, 1.0, 4.0 * error + 2e-3);
        expect_below("its error", error, 2e-3);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* Ground that rises along the track: seen from abreast the range does not change along a row, and
 * Lambert's law loses 1/sqrt(1 + slope^2). */
static void test_slope_along_track(void **unused)
{
    (void)unused;
    const double slope = 0.4;
    struct bench bench;
    struct echoes echoes;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.ray_scale = 4.0;
    lay_slope(&bench, slope, 0.0);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    double sum = 0.0;
    for (size_t row = 60; row < 100; row++)
        for (size_t column = 150; column < 250; column++) {
            const double range = view_apparent_range(&bench.tracer.view, (double)column);
            const double height =
                slope * (view_x_of_row(&bench.tracer.view, (double)row) - middle_x(&bench));
            const double sine = (bench.scene.sonar.altitude_m - height) / range;
            const double expected = bench.scene.seabed.lambert * sine * sine /
                                    sqrt(1.0 - sine * sine) / sqrt(1.0 + slope * slope) *
                                    along_track_energy_width(&bench.tracer.response) *
                                    range_energy_width(&bench.tracer.response);
            sum += (double)echoes.seabed_energy[row * COLUMNS + column] / expected / 4000.0;
        }
    /* 4000 pixels of some 3 % scatter; W's tail 0.1 % */
    expect_close("energy over closed form", sum, 1.0, 4.0 * 0.03 / sqrt(4000.0) * 3.0 + 2e-3);
    echoes_clear(&echoes);
    bench_close(&bench);
}

/* The row through the middle in double precision: the ground in short steps, each lit where it
 * stands over all that is nearer, mu cos^2 of its energy in the pulse's squared envelope. */
static double *integrate_row(const struct bench *bench)
{
    const struct tracer *tracer = &bench->tracer;
    const double step = 2e-4;
    const double altitude = bench->scene.sonar.altitude_m;
    const double x = middle_x(bench);
    const double near = view_ground_range(&tracer->view, tracer->view.first_range_m) - 1.0;
    const double far =
        view_ground_range(&tracer->view, view_apparent_range(&tracer->view, COLUMNS + 40.0));
    double *energy = calloc(COLUMNS, sizeof *energy);
    double horizon = -INFINITY;
    assert_non_null(energy);
    for (double y = near; y < far; y += step) {
        const double z = relief_height(tracer->relief, x, y);
        const double rise = relief_height(tracer->relief, x, y + 0.5 * step) -
                            relief_height(tracer->relief, x, y - 0.5 * step);
        const double elevation = (z - altitude) / y;
        if (elevation <= horizon)
            continue;
        horizon = elevation;
        const double range = hypot(y, altitude - z);
        const double length = hypot(step, rise);
        const double cosine = (y * rise + (altitude - z) * step) / (range * length);
        const double column = view_column_of_range(&tracer->view, range);
        for (int i = (int)column - 8; i <= (int)column + 9; i++) {
            if (cosine <= 0.0 || i < 0 || i >= COLUMNS)
                continue;
            const double g =
                range_response(&tracer->response, view_apparent_range(&tracer->view, i) - range);
            energy[i] += bench->scene.seabed.lambert * cosine * cosine * length * g * g *
                         along_track_energy_width(&tracer->response);
        }
    }
    return energy;
}

static void lay_ripples(struct bench *bench, double wavelength, double height, double sharpness)
{
    struct relief_feature *ripples = bench_add_relief(bench, RELIEF_RIPPLES);
    ripples->wavelength_m = wavelength;
    ripples->height_m = height;
    ripples->heading_rad = 0.5 * PI; /* crests along the track */
    ripples->sharpness = sharpness;
}

/* Long-crested ripples: every pixel of the mean line, from gentle ones to such that hide half of
 * the ground. */
static void test_ripples(void **unused)
{
    (void)unused;
    static const double heights[] = {0.02, 0.10};
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.injection.ray_scale = 4.0;
        lay_ripples(&bench, 0.5, heights[i], 0.6);
        bench_ready(&bench);
        const double y = middle_ground(&bench) + 0.123;
        const double phase = 2.0 * PI * y / 0.5;
        expect_close("height of the ripples",
                     relief_height(bench.placed.relief, middle_x(&bench), y),
                     0.5 * heights[i] * (cos(phase) + 0.15 * cos(2.0 * phase)),
                     0.01 * heights[i]); /* bilinear between 40 points a wavelength */
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        double *expected = integrate_row(&bench);
        double mean = 0.0, expected_mean = 0.0, squares = 0.0, most = 0.0, least = INFINITY;
        for (size_t column = 80; column < COLUMNS - 80; column++) {
            double line = 0.0;
            for (size_t row = 60; row < 100; row++)
                line += (double)echoes.seabed_energy[row * COLUMNS + column] / 40.0;
            mean += line / 240.0;
            expected_mean += expected[column] / 240.0;
            squares += pow(line - expected[column], 2.0) / 240.0;
            most = fmax(most, expected[column]);
            least = fmin(least, expected[column]);
        }
        print_message("ripples of %.2f m: darkest over brightest %.4f\n", heights[i], least / most);
        expect_close("mean over integration", mean / expected_mean, 1.0, 2e-3);
        /* 40 rows of rays that meet a pixel some 50 times each, in strata; the grid's facets err by
         * 1/2 % of the slope */
        expect_below("rms difference over the mean", sqrt(squares) / expected_mean, 0.01);
        assert_true(heights[i] < 0.05 || least < 0.01 * most);
        free(expected);
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

/* The shadow of a mound ends where the line over its crest meets the ground, and begins where that
 * touches it. */
static void test_shadow_of_a_mound(void **unused)
{
    (void)unused;
    struct bench bench;
    struct echoes echoes;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.ray_scale = 16.0;
    struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
    mound->radius_m = 0.8;
    mound->height_m = 0.5;
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    double highest = -INFINITY;
    double touch = 0.0;
    for (double y = -0.8; y < 0.8; y += 1e-4) {
        const double ground = middle_ground(&bench) + y;
        const double z = 0.25 * (1.0 + cos(PI * y / 0.8));
        const double elevation = (z - bench.scene.sonar.altitude_m) / ground;
        if (elevation > highest) {
            highest = elevation;
            touch = hypot(ground, bench.scene.sonar.altitude_m - z);
        }
    }
    const double end = hypot(bench.scene.sonar.altitude_m / highest, bench.scene.sonar.altitude_m);
    const float *line = echoes.seabed_energy + (size_t)(ROWS / 2) * COLUMNS;
    const float *level = echoes.level_energy + (size_t)(ROWS / 2) * COLUMNS;
    size_t column = (size_t)(view_column_of_range(&bench.tracer.view, 0.5 * (touch + end)));
    assert_true(line[column] < 1e-3f * level[column]);
    size_t last = column;
    while (line[last + 1] < 0.5f * level[last + 1])
        last++;
    const double share = (0.5 - (double)line[last] / (double)level[last]) /
                         ((double)line[last + 1] / (double)level[last + 1] -
                          (double)line[last] / (double)level[last]);
    /* half a pixel: the edge is a step smoothed by the pulse, and 5 cm of W's main lobe see a
     * shadow that is 1 mm shorter */
    expect_close("end of the shadow, m",
                 view_apparent_range(&bench.tracer.view, (double)last + share), end, 0.0125);
    while (line[column] < 0.05f * level[column])
        column--;
    /* light fades on the back of the mound, where it grazes */
    expect_close("beginning of the shadow, m",
                 view_apparent_range(&bench.tracer.view, (double)column), touch, 0.08);
    echoes_clear(&echoes);
    bench_close(&bench);
}

/* A relief of no height is the plane: every bit of energies, glints and chains. */
static void test_no_height(void **unused)
{
    (void)unused;
    for (int is_wide = 0; is_wide < 2; is_wide++) {
        struct bench bench;
        struct echoes echoes[2];
        for (int i = 0; i < 2; i++) {
            bench_open(&bench, ROWS, COLUMNS, RANGE);
            sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.5);
            object->material.lambert = 0.1;
            object->material.reflection = 0.5;
            object->burial_m = 0.1;
            bench.scene.sonar.transducer_side_m = is_wide ? 0.1 : 0.0;
            bench.scene.injection.interactions = 2;
            if (i == 1) {
                struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
                mound->radius_m = 1.0;
            }
            bench_ready(&bench);
            bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes[i]);
            if (i == 0)
                bench_close(&bench);
        }
        const size_t bytes = PIXELS * sizeof(float);
        assert_null(echoes[0].level_energy);
        /* the object stands in some ways to a wide source, but not over the level seabed */
        if (!is_wide)
            assert_memory_equal(echoes[1].level_energy, echoes[0].seabed_energy, bytes);
        assert_memory_equal(echoes[1].seabed_energy, echoes[0].seabed_energy, bytes);
        assert_memory_equal(echoes[1].lost_energy, echoes[0].lost_energy, bytes);
        assert_memory_equal(echoes[1].target_energy, echoes[0].target_energy, bytes);
        assert_memory_equal(echoes[1].target_real, echoes[0].target_real, bytes);
        assert_memory_equal(echoes[1].energy, echoes[0].energy, bytes);
        echoes_clear(&echoes[0]);
        echoes_clear(&echoes[1]);
        bench_close(&bench);
    }
}

/* A sphere on the bottom of a pit glints from where it lies, at its own strength; behind a mound it
 * does not. */
static void test_glint_in_a_pit(void **unused)
{
    (void)unused;
    for (int is_hidden = 0; is_hidden < 2; is_hidden++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.4);
        struct relief_feature *pit = bench_add_relief(&bench, RELIEF_PIT);
        pit->radius_m = 2.0;
        pit->height_m = 0.4;
        if (is_hidden) {
            struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
            mound->radius_m = 1.0;
            mound->height_m = 0.7;
            mound->position_kind = SONJECT_POSITION_PIXELS;
            mound->position_along = 0.5 * (ROWS - 1);
            mound->position_range = 0.5 * (COLUMNS - 1) - 50.0;
        }
        bench_ready(&bench);
        const double *centre = bench.placements[0].centre;
        struct echo_line line = bench_glint_line(&bench, 0);
        double range;
        const double peak = echo_line_peak(&bench, &line, &range);
        if (is_hidden) {
            expect_below("glint behind a mound over that of a sphere", peak / 0.1, 0.01);
        } else {
            expect_close("height of its centre, m", centre[2], -0.2, 2e-3);
            expect_close("range of its glint, m", range,
                         hypot(centre[1], bench.scene.sonar.altitude_m - centre[2]) - 0.2, 2e-3);
            expect_close("its strength over a/2", peak / 0.1, 1.0, 0.01);
        }
        echo_line_clear(&line);
        bench_close(&bench);
    }
}

/* What a mound hides from the sonar the sea surface shows: only the way by it, there and back,
 * passes over the crest. */
static void test_glint_over_a_mound(void **unused)
{
    (void)unused;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench_add(&bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.4);
    struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
    mound->radius_m = 1.2;
    mound->height_m = 0.85;
    mound->position_kind = SONJECT_POSITION_PIXELS;
    mound->position_along = 0.5 * (ROWS - 1);
    mound->position_range = 0.5 * (COLUMNS - 1) - 50.0;
    bench.scene.surface.water_depth_m = 14.0;
    bench.scene.injection.interactions = 3;
    bench_ready(&bench);
    const double *centre = bench.placements[0].centre;
    struct echo_line line = bench_glint_line(&bench, 0);
    double range;
    const double peak = echo_line_peak(&bench, &line, &range);
    const double image = 2.0 * 14.0 - bench.scene.sonar.altitude_m;
    expect_close("range by way of the surface, m", range, hypot(centre[1], image - centre[2]) - 0.2,
                 2e-3);
    expect_close("its strength over a/2", peak / 0.1, 1.0, 0.01);
    const double direct = hypot(centre[1], bench.scene.sonar.altitude_m - centre[2]) - 0.2;
    const struct complex_value straight = echo_line_at(&bench, &line, direct);
    const struct complex_value mixed = echo_line_at(&bench, &line, 0.5 * (direct + range));
    /* the line over the crest passes 12 cm over where the sphere would glint */
    expect_below("straight glint", hypot(straight.real_part, straight.imaginary_part), 1e-4);
    expect_below("glint one way by the surface", hypot(mixed.real_part, mixed.imaginary_part),
                 1e-4);
    echo_line_clear(&line);
    bench_close(&bench);
}

/* A plate that stands upright on rising ground throws its shadow up the slope: shorter. */
static void test_shadow_on_a_slope(void **unused)
{
    (void)unused;
    const double slope = 0.25;
    struct bench bench;
    struct echoes echoes;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.ray_scale = 16.0;
    sonject_object_params *box = bench_add(&bench, SONJECT_SHAPE_BOX, 2.0, 0.1, 0.0);
    box->height_m = 0.6;
    lay_slope(&bench, 0.0, slope);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    /* the line over the far top edge, and the ground z = slope (y - middle) */
    const double altitude = bench.scene.sonar.altitude_m;
    const double edge = middle_ground(&bench) + 0.05;
    const double fall = (altitude - 0.6) / edge;
    const double y = (altitude + slope * middle_ground(&bench)) / (fall + slope);
    const double end = hypot(y, altitude - slope * (y - middle_ground(&bench)));
    const size_t row = (size_t)(ROWS / 2) * COLUMNS;
    size_t column = (size_t)view_column_of_range(&bench.tracer.view, end - 0.1);
    assert_true(echoes.lost_energy[row + column] > 0.99f * echoes.seabed_energy[row + column]);
    while (echoes.lost_energy[row + column] > 0.5f * echoes.seabed_energy[row + column])
        column++;
    const double inside = 1.0 - 0.5;
    expect_close("end of the shadow, m",
                 view_apparent_range(&bench.tracer.view, (double)column - inside), end, 0.02);
    echoes_clear(&echoes);
    bench_close(&bench);
}

/* Layers of nearly one sound speed bend nothing: the table of rays, with points above and below the
 * mean seabed, gives what straight rays give. */
static void test_layers(void **unused)
{
    (void)unused;
    static const struct water_layer layers[] = {{0.0, 1500.0, 1.0}, {4.0, 1500.0001, 1.0}};
    double sums[2] = {0.0, 0.0};
    double difference = 0.0;
    struct echoes echoes[2];
    for (int i = 0; i < 2; i++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.sonar.transducer_side_m = 0.05; /* ways home are looked up too */
        lay_ripples(&bench, 0.5, 0.08, 0.6);
        struct relief_feature *pit = bench_add_relief(&bench, RELIEF_PIT);
        pit->radius_m = 1.0;
        pit->height_m = 0.3;
        if (i == 1)
            bench_set_layers(&bench, layers, 2);
        bench_ready(&bench);
        assert_true(bench.tracer.view.water.is_straight == (i == 0));
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes[i]);
        bench_close(&bench);
    }
    for (size_t k = 0; k < PIXELS; k++) {
        sums[0] += (double)echoes[0].seabed_energy[k];
        sums[1] += (double)echoes[1].seabed_energy[k];
        difference += fabs((double)echoes[0].seabed_energy[k] - (double)echoes[1].seabed_energy[k]);
    }
    expect_close("energy through layers over straight", sums[1] / sums[0], 1.0, 1e-3);
    /* the fans' strata differ, so rays meet other points of a pixel: some per cent of it */
    expect_below("difference of pixels over the mean", difference / sums[0], 0.05);
    echoes_clear(&echoes[0]);
    echoes_clear(&echoes[1]);
}

/* A composite keeps every bit beyond the relief's reach, brightens the face of a mound, darkens its
 * back, and keeps the mean where all is level. */
static void test_composite(void **unused)
{
    (void)unused;
    struct bench bench;
    struct injection_input input;
    struct injection_result result;
    float *pixels = calloc(PIXELS, sizeof *pixels);
    assert_non_null(pixels);
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] = 1.0f + 0.3f * (float)((i * 7919) % 101) / 101.0f;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
    mound->radius_m = 0.8;
    mound->height_m = 0.5;
    memset(&input, 0, sizeof input);
    input.rows = ROWS;
    input.columns = COLUMNS;
    input.pixels = pixels;
    if (injection_run(&bench.report, bench.tracer.device, &bench.scene, &input, NULL, NULL,
                      &result) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    size_t kept = 0;
    double brightest = 0.0, darkest = 1.0;
    for (size_t i = 0; i < PIXELS; i++) {
        const double v = (double)result.visibility[i];
        brightest = fmax(brightest, v);
        darkest = fmin(darkest, v);
        if (result.influence[i]) {
            /* no target: what is there is sqrt(V) of what was, and noise where V < 1 */
            if (v > 1.0)
                assert_true(fabs((double)result.image[i] - sqrt(v) * (double)pixels[i]) <
                            1e-5 * sqrt(v));
            continue;
        }
        kept++;
        assert_true(result.visibility[i] == 1.0f);
        assert_memory_equal(&result.image[i], &pixels[i], sizeof(float));
    }
    print_message("%zu of %zu pixels kept; V from %.2g to %.3g\n", kept, PIXELS, darkest,
                  brightest);
    assert_true(kept > PIXELS / 3);
    assert_true(brightest > 2.0);
    assert_true(darkest < 1e-3);
    injection_result_clear(&result);
    bench_close(&bench);
    free(pixels);
}

static void expect_refused(struct bench *bench, const char *words)
{
    struct relief *relief = NULL;
    struct footprint none;
    memset(&none, 0, sizeof none);
    bench->report.message[0] = '\0';
    assert_int_equal(
        relief_create(&relief, &bench->report, &bench->scene, &bench->tracer.view, 0.0, 0.0, &none),
        SONJECT_ERROR_INPUT);
    assert_null(relief);
    assert_null(strchr(bench->report.message, '\n'));
    if (!strstr(bench->report.message, words))
        fail_msg("'%s' does not say '%s'", bench->report.message, words);
}

static void test_refusals(void **unused)
{
    (void)unused;
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench_ready(&bench);
    struct relief_feature *mound = bench_add_relief(&bench, RELIEF_MOUND);
    mound->radius_m = 0.5;
    mound->height_m = 1.0;
    expect_refused(&bench, "degrees");
    mound->height_m = 6.0;
    expect_refused(&bench, "half the sonar's altitude");
    mound->height_m = 0.1;
    mound->radius_m = 0.001;
    expect_refused(&bench, "too fine");
    mound->radius_m = 0.5;
    bench.scene.seabed.forward.reflection = 0.3;
    expect_refused(&bench, "cannot be smooth");
    bench.scene.seabed.forward.reflection = 0.0;
    bench.scene.injection.mode = SONJECT_MODE_RESYNTHESISE;
    bench.scene.seabed.map = SONJECT_MAP_COHERENT;
    expect_refused(&bench, "level seabed");
    bench.scene.injection.mode = SONJECT_MODE_COMPOSITE;
    mound->kind = RELIEF_SCOUR;
    mound->width_m = 0.5;
    strcpy(mound->object, "nothing");
    expect_refused(&bench, "no object has that name");
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_height),
        cmocka_unit_test(test_slopes_towards_and_away),
        cmocka_unit_test(test_slope_along_track),
        cmocka_unit_test(test_ripples),
        cmocka_unit_test(test_shadow_of_a_mound),
        cmocka_unit_test(test_glint_in_a_pit),
        cmocka_unit_test(test_shadow_on_a_slope),
        cmocka_unit_test(test_composite),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_glint_over_a_mound),
        cmocka_unit_test(test_layers),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
