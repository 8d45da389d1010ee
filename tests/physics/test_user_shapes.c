/* Shapes that users write: against the built-in sphere by physical optics, energies and chains; a
 * dome against double precision; several codes beside a mesh; compilers' errors in the user's
 * lines; and what the check of a shape catches. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "user/shape_check.h"
#include "user/shape_probe.h"
#include "user/user_program.h"
#include "user_codes.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define ROWS         121
#define COLUMNS      121
#define RANGE        50.0
#define RADIUS       0.25
#define DOME_A       0.4
#define DOME_H       0.25

static uint32_t add_code(struct user_shapes *shapes, struct report *report, const char *name,
                         const char *code, double radius, double first, double second)
{
    sonject_user_shape_params params;
    sonject_user_shape_params_init(&params);
    params.name = name;
    params.code = code;
    params.bounding_radius_m = radius;
    params.parameter_count = 2;
    params.parameters[0] = first;
    params.parameters[1] = second;
    if (check_user_shape(&params, report, NULL) != SONJECT_OK ||
        user_shapes_append(shapes, report, &params) != SONJECT_OK)
        fail_msg("%s", report->message);
    return shapes->count - 1;
}

enum sound_shape {
    SPHERE_SHAPE,
    DISC_SHAPE,
    PAIR_SHAPE
};

/* All of them wherever one is: programs, which take long to compile, are then the same. */
static void add_sound_shapes(struct bench *bench)
{
    struct user_shapes *shapes = &bench->scene.user_shapes;
    struct report *report = &bench->report;
    add_code(shapes, report, "sphere.cl", SPHERE_CODE, RADIUS, RADIUS, 0.0);
    add_code(shapes, report, "disc.cl", DISC_CODE, RADIUS, RADIUS, 0.0);
    add_code(shapes, report, "pair.cl", PAIR_CODE, 0.6, 0.25, 0.3);
    shapes->shapes[DISC_SHAPE].is_open = true;
    shapes->shapes[DISC_SHAPE].half_height_m = 1e-9;
    shapes->shapes[PAIR_SHAPE].half_height_m = 0.25;
    shapes->shapes[PAIR_SHAPE].half_width_m = 0.25;
}

/* A sphere of RADIUS, by code or the library's own. */
static sonject_object_params *add_sphere(struct bench *bench, bool is_user)
{
    sonject_object_params *object =
        bench_add(bench, is_user ? SONJECT_SHAPE_USER : SONJECT_SHAPE_SPHERE, 0.0, 0.0,
                  is_user ? 0.0 : 2.0 * RADIUS);
    if (is_user)
        add_sound_shapes(bench);
    object->user_shape = SPHERE_SHAPE;
    return object;
}

static void make_rough(sonject_object_params *object)
{
    object->material.reflection = 0.0;
    object->material.lambert = 0.1;
}

/* Energies, lost seabed and hits of each object's tile. */
static void trace_tiles(struct bench *bench, double sums[][TILE_PLANES])
{
    struct rough_trace trace;
    if (rough_trace_begin(&trace, &bench->tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    float *seabed = calloc(line_grid_cells(&trace.grid), sizeof *seabed);
    float *tiles = calloc(trace.tile_elements, sizeof *tiles);
    assert_true(seabed && tiles);
    if (rough_trace_strips(&trace, &bench->tracer, trace.grid.strips, seabed) != SONJECT_OK ||
        rough_trace_tiles(&trace, &bench->tracer, tiles) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    const float *next = tiles;
    for (uint32_t object = 0; object < bench->tracer.part_count; object++)
        for (int plane = 0; plane < TILE_PLANES; plane++) {
            sums[object][plane] = 0.0;
            for (size_t i = 0; i < line_grid_cells(&trace.tiles[object].grid); i++)
                sums[object][plane] += (double)*next++;
        }
    free(seabed);
    free(tiles);
    rough_trace_end(&trace);
}

/* A level disc 10 cm above the seabed, seen from above: its normal has to turn. */
static sonject_object_params *add_disc(struct bench *bench, bool is_user)
{
    sonject_object_params *object =
        bench_add(bench, is_user ? SONJECT_SHAPE_USER : SONJECT_SHAPE_DISC, 0.0, 0.0,
                  is_user ? 0.0 : 2.0 * RADIUS);
    object->burial_m = -0.1;
    if (!is_user)
        return object;
    add_sound_shapes(bench);
    object->user_shape = DISC_SHAPE;
    return object;
}

/* The same rays, the same formula: what is left are roundings and rays along the outline, of which
 * a disc at 11 deg of grazing has more. */
static void compare_rough(sonject_object_params *(*add)(struct bench *bench, bool is_user),
                          double tolerance)
{
    double sums[2][TILE_PLANES];
    for (int is_user = 0; is_user < 2; is_user++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        make_rough(add(&bench, is_user));
        bench_ready(&bench);
        trace_tiles(&bench, &sums[is_user]);
        bench_close(&bench);
    }
    assert_true(sums[0][TILE_FOOTPRINT] > 1000.0);
    for (int plane = 0; plane < TILE_PLANES; plane++) {
        assert_true(sums[0][plane] > 0.0);
        expect_close("tile", sums[1][plane] / sums[0][plane], 1.0, tolerance);
    }
}

static void test_rough_sphere(void **state)
{
    (void)state;
    compare_rough(add_sphere, 1e-4);
}

static void test_rough_disc(void **state)
{
    (void)state;
    compare_rough(add_disc, 1e-3);
}

/* Phases differ by roundings of ranges, 4 eps of 0.25 m at 0.84 rad/mm: 1e-4 rad, -80 dB. */
static void test_glint_of_a_sphere(void **state)
{
    struct echo_line lines[2];
    double difference = 0.0;
    double energy = 0.0;
    (void)state;
    for (int is_user = 0; is_user < 2; is_user++) {
        struct bench bench;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        add_sphere(&bench, is_user)->burial_m = -1.0;
        bench_ready(&bench);
        lines[is_user] = bench_glint_line(&bench, 0);
        bench_close(&bench);
    }
    const long shift =
        lround((lines[1].first_range_m - lines[0].first_range_m) / lines[0].spacing_m);
    for (size_t bin = 0; bin < lines[0].bins; bin++) {
        const long other = (long)bin - shift;
        if (other < 0 || other >= (long)lines[1].bins)
            continue;
        difference += pow(lines[1].real_part[other] - lines[0].real_part[bin], 2.0) +
                      pow(lines[1].imaginary_part[other] - lines[0].imaginary_part[bin], 2.0);
        energy += pow(lines[0].real_part[bin], 2.0) + pow(lines[0].imaginary_part[bin], 2.0);
    }
    assert_true(energy > 0.0);
    expect_below("difference of glints, dB", 10.0 * log10(difference / energy + 1e-30), -80.0);
    echo_line_clear(&lines[0]);
    echo_line_clear(&lines[1]);
}

/* Chains between sphere and seabed. The library leaves a convex shape out where rays leave it; code
 * is asked, 20 um off its surface: some grazing ways may be decided otherwise. */
static void test_chains_of_a_sphere(void **state)
{
    double sums[2][2];
    (void)state;
    for (int is_user = 0; is_user < 2; is_user++) {
        struct bench bench;
        struct chain_trace trace;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench.scene.injection.interactions = 3;
        bench.scene.injection.order_energies = 1;
        bench.scene.injection.ray_scale = 0.25;
        make_rough(add_sphere(&bench, is_user));
        bench_ready(&bench);
        bench_trace_chains(&bench, &trace);
        const size_t cells = line_grid_cells(&trace.grid);
        float *energy = calloc(cells, sizeof *energy);
        assert_non_null(energy);
        for (uint32_t plane = 0; plane < 2; plane++) {
            if (chain_trace_read(&trace, &bench.tracer, plane, energy) != SONJECT_OK)
                fail_msg("%s", bench.report.message);
            sums[is_user][plane] = 0.0;
            for (size_t i = 0; i < cells; i++)
                sums[is_user][plane] += (double)energy[i];
        }
        free(energy);
        chain_trace_end(&trace);
        bench_close(&bench);
    }
    for (int plane = 0; plane < 2; plane++) {
        assert_true(sums[0][plane] > 0.0);
        expect_close("chains", sums[1][plane] / sums[0][plane], 1.0, 1e-3);
    }
}

/* Two spheres light each other. As one shape of code they must find each other as parts do; the
 * seabed scatters nothing. Energies of 4 seeds each. */
static void test_a_shape_meets_itself(void **state)
{
    double means[2], errors[2];
    (void)state;
    for (int is_user = 0; is_user < 2; is_user++) {
        double sums[4];
        for (uint64_t seed = 0; seed < 4; seed++) {
            struct bench bench;
            struct chain_trace trace;
            bench_open(&bench, ROWS, COLUMNS, RANGE);
            bench.scene.injection.interactions = 2;
            bench.scene.injection.seed = 10 + seed;
            bench.scene.seabed.lambert = 1e-12;
            sonject_object_params *object = bench_add(
                &bench, is_user ? SONJECT_SHAPE_USER : SONJECT_SHAPE_PARTS, 0.0, 0.0, 0.0);
            make_rough(object);
            object->burial_m = -0.5;
            object->user_shape = PAIR_SHAPE;
            if (is_user)
                add_sound_shapes(&bench);
            for (int i = 0; !is_user && i < 2; i++) {
                struct scene_part part;
                memset(&part, 0, sizeof part);
                part.shape = *object;
                part.shape.shape = SONJECT_SHAPE_SPHERE;
                part.shape.diameter_m = 0.5;
                part.centre[0] = i == 0 ? -0.3 : 0.3;
                for (int k = 0; k < 3; k++)
                    part.axes[k][k] = 1.0;
                assert_int_equal(scene_append_part(&bench.scene, &bench.report, &part), SONJECT_OK);
            }
            bench_ready(&bench);
            bench_trace_chains(&bench, &trace);
            const size_t cells = line_grid_cells(&trace.grid);
            float *energy = calloc(cells, sizeof *energy);
            assert_non_null(energy);
            if (chain_trace_read(&trace, &bench.tracer, 0, energy) != SONJECT_OK)
                fail_msg("%s", bench.report.message);
            sums[seed] = 0.0;
            for (size_t i = 0; i < cells; i++)
                sums[seed] += (double)energy[i];
            free(energy);
            chain_trace_end(&trace);
            bench_close(&bench);
        }
        means[is_user] = (sums[0] + sums[1] + sums[2] + sums[3]) / 4.0;
        errors[is_user] = 0.0;
        for (int i = 0; i < 4; i++) /* variance of the mean */
            errors[is_user] += pow(sums[i] - means[is_user], 2.0) / 12.0;
    }
    assert_true(means[0] > 0.0);
    const double error = sqrt(errors[0] + errors[1]) / means[0];
    print_message("standard error %.3g\n", error);
    assert_true(error < 0.02);
    expect_close("echoes between the spheres", means[1] / means[0], 1.0, 4.0 * error);
}

static double uniform(uint64_t *random)
{
    *random = *random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*random >> 11) * 0x1p-53;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Value of the dome: negative inside. */
static double dome_at(const double p[3])
{
    const double k = 0.5 * DOME_A * DOME_A / DOME_H;
    const double round = (p[0] * p[0] + p[1] * p[1] - k * (DOME_H - p[2])) / (2.0 * DOME_A);
    return fmax(round, -DOME_H - p[2]);
}

/* First change of sides beyond `nearest`, by steps of 0.1 mm and bisection; NaN: none. */
static double march_dome(const double p[3], const double d[3], double nearest, double end)
{
    const double step = 1e-4;
    for (double t = nearest; t < end; t += step) {
        double ends[2] = {t, t + step};
        double values[2];
        for (int i = 0; i < 2; i++) {
            const double at[3] = {p[0] + ends[i] * d[0], p[1] + ends[i] * d[1],
                                  p[2] + ends[i] * d[2]};
            values[i] = dome_at(at);
        }
        if ((values[0] < 0.0) == (values[1] < 0.0))
            continue;
        for (int i = 0; i < 50; i++) {
            const double middle = 0.5 * (ends[0] + ends[1]);
            const double at[3] = {p[0] + middle * d[0], p[1] + middle * d[1], p[2] + middle * d[2]};
            ends[(dome_at(at) < 0.0) == (values[0] < 0.0) ? 0 : 1] = middle;
        }
        return ends[1];
    }
    return NAN;
}

/* From outside and from inside, at all angles. A distance is good to some roundings of the size
 * over the cosine of incidence. */
static void test_dome_against_double(void **state)
{
    enum {
        RAYS = 2000
    };
    static struct probe_ray rays[RAYS];
    static struct probe_hit hits[RAYS];
    const double radius = hypot(DOME_A, DOME_H);
    struct bench bench;
    struct shape_probe probe;
    uint64_t random = 7;
    size_t met = 0, wrong = 0;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    add_code(&bench.scene.user_shapes, &bench.report, "dome.cl", DOME_CODE, radius, DOME_A, DOME_H);
    if (shape_probe_begin(&probe, &bench.report, bench.tracer.device, &bench.scene.user_shapes,
                          0) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    for (size_t i = 0; i < RAYS; i++) {
        double d[3], p[3];
        double length = 0.0;
        for (int k = 0; k < 3; k++) {
            d[k] = 2.0 * uniform(&random) - 1.0;
            p[k] = (2.0 * uniform(&random) - 1.0) * radius;
        }
        length = sqrt(dot(d, d));
        for (int k = 0; k < 3; k++)
            d[k] /= length;
        const double middle = -dot(p, d);
        for (int k = 0; k < 3; k++) {
            rays[i].point[k] = (float)(p[k] + middle * d[k]);
            rays[i].direction[k] = (float)d[k];
        }
        rays[i].nearest = (float)((2.0 * uniform(&random) - 1.0) * radius);
    }
    if (shape_probe_ask(&probe, rays, hits, RAYS) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    for (size_t i = 0; i < RAYS; i++) {
        double p[3], d[3], at[3], normal[3], slope[3];
        for (int k = 0; k < 3; k++) {
            p[k] = rays[i].point[k];
            d[k] = rays[i].direction[k];
            normal[k] = hits[i].normal[k];
        }
        const double expected = march_dome(p, d, rays[i].nearest, 1.01 * radius);
        const bool is_met = isfinite(hits[i].distance);
        if (isnan(expected) || !is_met) {
            wrong += is_met == isnan(expected); /* along the outline and through the rim */
            continue;
        }
        for (int k = 0; k < 3; k++)
            at[k] = p[k] + expected * d[k];
        for (int k = 0; k < 3; k++) {
            double ends[2];
            for (int end = 0; end < 2; end++) {
                double beside[3] = {at[0], at[1], at[2]};
                beside[k] += end == 0 ? 1e-6 : -1e-6;
                ends[end] = dome_at(beside);
            }
            slope[k] = (ends[0] - ends[1]) / 2e-6;
        }
        const double cosine = fabs(dot(slope, d)) / sqrt(dot(slope, slope));
        const double rim = hypot(hypot(at[0], at[1]) - DOME_A, at[2] + DOME_H);
        if (cosine < 0.1 || rim < 1e-4)
            continue;
        met++;
        if (fabs(hits[i].distance - expected) > 64.0 * FLT_EPSILON * radius / (cosine * cosine))
            fail_msg("ray %zu: %.9g m, not %.9g m", i, (double)hits[i].distance, expected);
        const double agreement = dot(normal, slope) / sqrt(dot(normal, normal) * dot(slope, slope));
        if (!(agreement > cos(1e-3)))
            fail_msg("ray %zu: its normal is off by %g rad", i, acos(agreement));
    }
    print_message("%zu hits compared, %zu of %d missed by one\n", met, wrong, (int)RAYS);
    assert_true(met > RAYS / 5);
    assert_true(wrong < RAYS / 200);
    shape_probe_end(&probe);
    bench_close(&bench);
}

/* Dome, sphere twice (one code, two sizes), dome of other sizes and a mesh, along the track: each
 * tile is what it is where the library's own spheres stand. */
static void test_several_codes_and_a_mesh(void **state)
{
    static const double radii[2] = {RADIUS, 0.15};
    double sums[2][5][TILE_PLANES];
    (void)state;
    for (int is_user = 0; is_user < 2; is_user++) {
        struct bench bench;
        bench_open(&bench, 321, COLUMNS, RANGE);
        struct user_shapes *shapes = &bench.scene.user_shapes;
        bench_add_tetrahedron(&bench);
        for (int i = 0; i < 5; i++) {
            const bool is_dome = i == 0 || i == 3;
            const bool is_sphere = i == 1 || i == 2;
            sonject_object_params *object =
                bench_add(&bench,
                          i == 4               ? SONJECT_SHAPE_MESH
                          : is_dome || is_user ? SONJECT_SHAPE_USER
                                               : SONJECT_SHAPE_SPHERE,
                          0.0, 0.0, is_sphere ? 2.0 * radii[i - 1] : 0.0);
            object->position_kind = SONJECT_POSITION_PIXELS;
            object->position_along = 40.0 + 60.0 * i;
            object->position_range = 50.0;
            make_rough(object);
            /* both codes wherever the spheres are from: the program is then the same */
            object->user_shape = shapes->count;
            if (is_dome) {
                add_code(shapes, &bench.report, "dome.cl", DOME_CODE, 0.6, i == 0 ? DOME_A : 0.3,
                         i == 0 ? DOME_H : 0.1);
                shapes->shapes[object->user_shape].half_height_m = i == 0 ? DOME_H : 0.1;
            } else if (is_sphere) {
                add_code(shapes, &bench.report, "sphere.cl", SPHERE_CODE, radii[i - 1],
                         radii[i - 1], 0.0);
            }
        }
        assert_int_equal(shapes->snippet_count, 2);
        bench_ready(&bench);
        trace_tiles(&bench, sums[is_user]);
        bench_close(&bench);
    }
    for (int i = 0; i < 5; i++)
        for (int plane = 0; plane < TILE_PLANES; plane++) {
            assert_true(sums[0][i][plane] > 0.0);
            expect_close("tile", sums[1][i][plane] / sums[0][i][plane], 1.0, 1e-3);
        }
    /* other parameters, another size */
    assert_true(sums[1][3][TILE_FOOTPRINT] < 0.6 * sums[1][0][TILE_FOOTPRINT]);
    assert_true(sums[1][2][TILE_FOOTPRINT] < 0.6 * sums[1][1][TILE_FOOTPRINT]);
}

/* The message that a program with a code, behind a sound one, gives on a device. */
static sonject_status compile(struct bench *bench, const char *code, enum device_program program,
                              const char *kernel_name)
{
    cl_kernel kernel;
    struct user_shapes *shapes = &bench->scene.user_shapes;
    user_shapes_clear(shapes);
    add_code(shapes, &bench->report, "sound.cl", SPHERE_CODE, 1.0, 1.0, 0.0);
    add_code(shapes, &bench->report, "my shape.cl", code, 1.0, 1.0, 0.0);
    const sonject_status status = scene_kernel_create(
        &bench->report, bench->tracer.device, &bench->scene, 0, program, kernel_name, &kernel);
    if (status == SONJECT_OK)
        clReleaseKernel(kernel);
    return status;
}

static void test_errors_are_in_the_users_lines(void **state)
{
    /* what stands in the message after the name of the code */
    static const struct {
        const char *code, *place;
    } cases[] = {
        {SPHERE_NORMAL "\n\nfloat shape_distance(float3 p, float3 d, float t, const float *a)\n"
                       "{\n    return undeclared * t;\n}\n",
         "my shape.cl:6: "},
        {"float shape_distance(float3 p, float3 d, float t, const float *a) { return t "
         "}\n" SPHERE_NORMAL,
         "my shape.cl:1: "},
        {"\nfloat shape_distance(float3 p) { return 1.0f; }\n" SPHERE_NORMAL, "my shape.cl:2: "},
        {SPHERE_CODE "/* a long\n comment */ #error my own words\n",
         "my shape.cl:19: my own words"},
        {SPHERE_CODE "#error my own words\n", "my shape.cl:18: "},
        /* brackets that only macros show */
        {SPHERE_CODE "#define CLOSE }\nfloat g(float x) { return x; CLOSE }\n", "my shape.cl:19: "},
        {SPHERE_CODE "#define OPEN {\nfloat g(float x) { return x; OPEN }\n", "my shape.cl"},
        {SPHERE_CODE "#define HASH #undef\nHASH FUNCTION\n", "my shape.cl:19: "},
        /* what would hide our own text behind it */
        {SPHERE_CODE "}\n", "my shape.cl:18: "},
        {SPHERE_CODE "\n/* to the end\n", "my shape.cl:19: "},
        {SPHERE_CODE "#if 0\n\n", "my shape.cl:18: "},
        {SPHERE_CODE "constant char c[] = \"open;\n", "my shape.cl:18: "},
        {"#define shape_normal other\n" SPHERE_CODE, "shape_normal"},
        /* declared, never written */
        {"float shape_distance(float3 p, float3 d, float t, const float *a);\n" SPHERE_NORMAL,
         "shape_distance"},
    };
    struct bench bench;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct user_snippet snippet;
        if (snippet_make(&bench.report, "my shape.cl", 1, cases[i].code, &snippet) == SONJECT_OK) {
            snippet_clear(&snippet);
            assert_int_equal(
                compile(&bench, cases[i].code, PROGRAM_PROBE_USER_SHAPE, "probe_user_shape"),
                SONJECT_ERROR_INPUT);
        }
        print_message("%s\n", bench.report.message);
        if (!strstr(bench.report.message, cases[i].place))
            fail_msg("case %zu: '%s' is not in the message", i, cases[i].place);
        assert_null(strstr(bench.report.message, "user_1_"));
        assert_non_null(strstr(bench.report.message, "my shape.cl"));
        assert_null(strchr(bench.report.message, '\n'));
    }
    /* the programs that trace say the same */
    assert_int_equal(compile(&bench, cases[0].code, PROGRAM_TRACE_ROUGH, "trace_rough"),
                     SONJECT_ERROR_INPUT);
    assert_non_null(strstr(bench.report.message, cases[0].place));
    assert_int_equal(compile(&bench, DOME_CODE, PROGRAM_PROBE_USER_SHAPE, "probe_user_shape"),
                     SONJECT_OK);
    bench_close(&bench);
}

/* A normal that is none must not be drawn. */
static void test_a_missing_normal_fails_the_run(void **state)
{
    struct bench bench;
    struct rough_trace trace;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    sonject_object_params *object = bench_add(&bench, SONJECT_SHAPE_USER, 0.0, 0.0, 0.0);
    make_rough(object);
    object->user_shape = add_code(
        &bench.scene.user_shapes, &bench.report, "my.cl",
        SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return 0.0f * p; }\n",
        RADIUS, RADIUS, 0.0);
    bench_ready(&bench);
    if (rough_trace_begin(&trace, &bench.tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    float *seabed = calloc(line_grid_cells(&trace.grid), sizeof *seabed);
    assert_non_null(seabed);
    assert_int_equal(rough_trace_strips(&trace, &bench.tracer, trace.grid.strips, seabed),
                     SONJECT_ERROR_DEVICE);
    assert_non_null(strstr(bench.report.message, "not a number"));
    free(seabed);
    rough_trace_end(&trace);
    bench_close(&bench);
}

static sonject_status try_code(struct bench *bench, const char *code, double radius, bool is_open,
                               struct shape_check *check)
{
    struct user_shapes *shapes = &bench->scene.user_shapes;
    user_shapes_clear(shapes);
    add_code(shapes, &bench->report, "my.cl", code, radius, RADIUS, DOME_H);
    shapes->shapes[0].is_open = is_open;
    return shape_check_run(&bench->report, bench->tracer.device, shapes, 0, check);
}

static void test_sound_shapes_pass_the_check(void **state)
{
    static const struct {
        const char *code;
        double radius;
        bool is_open;
    } cases[] = {
        {SPHERE_CODE, RADIUS, false}, {SPHERE_CODE, 2.0 * RADIUS, false},
        {DOME_CODE, 0.36, false},     {DISC_CODE, RADIUS, true},
        {PAIR_CODE, 0.6, false},
    };
    struct bench bench;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct shape_check check;
        if (try_code(&bench, cases[i].code, cases[i].radius, cases[i].is_open, &check) !=
            SONJECT_OK)
            fail_msg("case %zu: %s", i, bench.report.message);
        print_message("%zu hits, %zu normals off by %.3g deg in the median, %.3g deg at most, %zu "
                      "of %zu meet again\n",
                      check.hits, check.compared, check.median_deg, check.largest_deg, check.acne,
                      check.restarts);
        /* a sphere of the bounding radius fills 1 / 1.3^2 of the disc of rays: 2424 of 4096, +-31
         */
        if (i == 0)
            expect_close("hits", (double)check.hits, 4096.0 / 1.69, 4.0 * 31.4);
        assert_true(check.compared > check.hits / 3);
        expect_below("median, deg", check.median_deg, 0.1);
    }
    bench_close(&bench);
}

#define SPHERE_WITH(result)                                                                        \
    "float met(float3 p, float3 d, float nearest, const float *a)\n"                               \
    "{\n"                                                                                          \
    "    const float s = sqrt(a[0] * a[0] - dot(p, p));\n"                                         \
    "    return -s > nearest ? -s : s > nearest ? s : INFINITY;\n"                                 \
    "}\n"                                                                                          \
    "float shape_distance(float3 p, float3 d, float nearest, const float *a)\n"                    \
    "{\n"                                                                                          \
    "    const float s = sqrt(a[0] * a[0] - dot(p, p));\n"                                         \
    "    return dot(p, p) > a[0] * a[0] ? INFINITY : " result ";\n"                                \
    "}\n"

static void test_the_check_catches_small_boxes(void **state)
{
    struct bench bench;
    struct shape_check check;
    struct user_shapes *shapes = &bench.scene.user_shapes;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    add_code(shapes, &bench.report, "dome.cl", DOME_CODE, 0.5, DOME_A, DOME_H);
    struct user_shape *shape = &shapes->shapes[0];
    double *const sizes[3] = {&shape->half_length_m, &shape->half_width_m, &shape->half_height_m};
    const double true_sizes[3] = {DOME_A, DOME_A, DOME_H};
    const char *const keys[3] = {"half_length", "half_width", "half_height"};
    for (int k = 0; k < 3; k++)
        *sizes[k] = true_sizes[k];
    assert_int_equal(shape_check_run(&bench.report, bench.tracer.device, shapes, 0, &check),
                     SONJECT_OK);
    for (int k = 0; k < 3; k++) {
        *sizes[k] = 0.97 * true_sizes[k];
        assert_int_equal(shape_check_run(&bench.report, bench.tracer.device, shapes, 0, &check),
                         SONJECT_ERROR_INPUT);
        assert_non_null(strstr(bench.report.message, keys[k]));
        *sizes[k] = true_sizes[k];
    }
    bench_close(&bench);
}

static void test_the_check_catches(void **state)
{
    static const struct {
        const char *code;
        double radius;
        bool is_open;
        const char *words;
    } cases[] = {
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) "
                         "{ return p + (float3)(0.0f, 0.0f, 0.03f); }\n",
         RADIUS, false, "shape_normal is not the normal"},
        /* only one pole in ten is wrong */
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) "
                         "{ return p + (float3)(0.0f, p.z > 0.2f ? 0.05f : 0.0f, 0.0f); }\n",
         RADIUS, false, "shape_normal is not the normal"},
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return -p; }\n", RADIUS,
         false, "point away from the ray"},
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return 0.0f * p; }\n",
         RADIUS, false, "a normal of length 0"},
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return p / 0.0f; }\n",
         RADIUS, false, "shape_normal gives what is not a finite number"},
        {SPHERE_CODE, 0.99 * RADIUS, false, "beyond the bounding_radius of 0.2475 m"},
        {SPHERE_CODE, 0.5 * RADIUS, false, "beyond the bounding_radius"},
        {SPHERE_WITH("NAN") SPHERE_NORMAL, RADIUS, false,
         "shape_distance gives what is not a number"},
        {SPHERE_WITH("INFINITY") SPHERE_NORMAL, RADIUS, false, "none of 4096 rays"},
        {SPHERE_WITH("-2.0f") SPHERE_NORMAL, RADIUS, false,
         "where the nearest that is asked for is"},
        {SPHERE_WITH("-s") SPHERE_NORMAL, RADIUS, false, "is not beyond `nearest`"},
        {SPHERE_WITH("-s > nearest ? -s : INFINITY") SPHERE_NORMAL, RADIUS, false,
         "do not next meet its inner side"},
        {SPHERE_WITH("nearest < -0.24999999f ? -s : met(p, d, nearest + 0.01f, a)") SPHERE_NORMAL,
         RADIUS, false, "not found again by the same ray"},
        /* surfaces 0.1 mm too far along each ray: echoes go on from within */
        {SPHERE_WITH("met(p, d, nearest - 1e-4f, a) + 1e-4f") SPHERE_NORMAL, RADIUS, false,
         "meet it again at once"},
    };
    struct bench bench;
    (void)state;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct shape_check check;
        if (try_code(&bench, cases[i].code, cases[i].radius, cases[i].is_open, &check) !=
            SONJECT_ERROR_INPUT)
            fail_msg("case %zu is not caught: %s", i, bench.report.message);
        print_message("%s\n", bench.report.message);
        if (!strstr(bench.report.message, cases[i].words))
            fail_msg("case %zu: '%s' is not in the message", i, cases[i].words);
    }
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rough_sphere),
        cmocka_unit_test(test_rough_disc),
        cmocka_unit_test(test_glint_of_a_sphere),
        cmocka_unit_test(test_chains_of_a_sphere),
        cmocka_unit_test(test_a_shape_meets_itself),
        cmocka_unit_test(test_dome_against_double),
        cmocka_unit_test(test_several_codes_and_a_mesh),
        cmocka_unit_test(test_errors_are_in_the_users_lines),
        cmocka_unit_test(test_a_missing_normal_fails_the_run),
        cmocka_unit_test(test_sound_shapes_pass_the_check),
        cmocka_unit_test(test_the_check_catches),
        cmocka_unit_test(test_the_check_catches_small_boxes),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
