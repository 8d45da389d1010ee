/* What the facets of a mesh do: plates as large as they are, sheets with two sides, smooth surfaces
 * that coarse facets stand for, and the mesh of a union in the place of the union's parts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../kernel/mesh_samples.h"
#include "bench.h"
#include "scene/pose.h"

#define ROWS    121
#define COLUMNS 121
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define RANGE   40.0
#define RADIUS  0.3
#define SEEDS   4

/* Gives the scene its only mesh. */
static const struct mesh *use_mesh(struct bench *bench, const struct mesh_sample *sample,
                                   double unit_m, double smooth_angle_rad)
{
    struct mesh_options options;
    mesh_options_init(&options);
    options.unit_m = unit_m;
    options.smooth_angle_rad = smooth_angle_rad;
    bench->scene.meshes = calloc(1, sizeof *bench->scene.meshes);
    assert_non_null(bench->scene.meshes);
    bench->scene.mesh_count = 1;
    if (mesh_from_arrays(&bench->report, "sample", sample->positions, sample->vertices,
                         sample->corners, sample->triangles, &options,
                         bench->scene.meshes) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    return bench->scene.meshes;
}

static void make_rough(sonject_object_params *object)
{
    object->material.reflection = 0.0;
    object->material.lambert = 0.1;
}

/* The seabed sends all sound on. */
static void set_mirror(struct bench *bench)
{
    sonject_material_params *seabed = &bench->scene.seabed.forward;
    seabed->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    seabed->reflection = 1.0;
    seabed->roughness_m = 0.0;
    seabed->lambert = 0.0;
}

static double total(const float *plane)
{
    double sum = 0.0;
    for (size_t i = 0; i < PIXELS; i++)
        sum += (double)plane[i];
    return sum;
}

/* Largest difference of two glints as formed, over the largest value of the first, dB. */
static double glint_difference(const struct echoes *one, const struct echoes *other)
{
    double peak = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < PIXELS; i++) {
        const double re = (double)one->target_real[i];
        const double im = (double)one->target_imaginary[i];
        peak = fmax(peak, hypot(re, im));
        largest = fmax(largest, hypot(re - (double)other->target_real[i],
                                      im - (double)other->target_imaginary[i]));
    }
    return decibels_of_amplitude(largest / peak);
}

static const double poses[][3] = {{0.0, 0.0, -0.25}, {-0.5, 0.1, 0.0}, {0.9, 0.3, 0.4}};

static void turn(sonject_object_params *object, const double pose[3])
{
    object->heading_rad = pose[0];
    object->pitch_rad = pose[1];
    object->roll_rad = pose[2];
}

/* Twelve facets of many wavelengths are the box: the same rays meet it, and only single precision
 * and the rays at its edges differ. Once a face is seen straight on. */
static void test_box_of_facets(void **unused)
{
    (void)unused;
    struct mesh_sample sample;
    sample_box(&sample);
    for (size_t pose = 0; pose < sizeof poses / sizeof *poses; pose++) {
        struct echoes echoes[2];
        for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
            struct bench bench;
            bench_open(&bench, ROWS, COLUMNS, RANGE);
            sonject_object_params *object =
                bench_add(&bench, is_mesh ? SONJECT_SHAPE_MESH : SONJECT_SHAPE_BOX, 1.0, 0.6, 0.0);
            object->height_m = 0.3;
            turn(object, poses[pose]);
            if (is_mesh)
                use_mesh(&bench, &sample, 0.5, 0.0);
            bench_ready(&bench);
            bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes[is_mesh]);
            bench_close(&bench);
        }
        print_message("pose %zu: ", pose);
        /* a phase of 2 k x 1e-6 m of rounding is -61 dB; a few cells of (lambda/8)^2 at the edges
         * of a face of 0.3 m^2 are less */
        expect_below("mesh less box, dB of the glint", glint_difference(&echoes[0], &echoes[1]),
                     -50.0);
        echoes_clear(&echoes[0]);
        echoes_clear(&echoes[1]);
    }
    sample_clear(&sample);
}

/* An octahedron with corners on the sphere, one face of which looks up by an angle. */
static void turned_octahedron(struct mesh_sample *sample, double elevation)
{
    const double n[3] = {1.0 / sqrt(3.0), 1.0 / sqrt(3.0), 1.0 / sqrt(3.0)};
    const double t[3] = {1.0 / sqrt(2.0), -1.0 / sqrt(2.0), 0.0};
    const double b[3] = {-t[1] * n[2], t[0] * n[2], t[1] * n[0] - t[0] * n[1]};
    sample_sphere(sample, 0);
    for (size_t i = 0; i < sample->vertices; i++) {
        double *p = &sample->positions[3 * i];
        const double to_face = p[0] * n[0] + p[1] * n[1] + p[2] * n[2];
        const double along = p[0] * t[0] + p[1] * t[1] + p[2] * t[2];
        /* n x t, so that (t, b', n) turn into (x, ..., face) without a mirror */
        const double across = -(p[0] * b[0] + p[1] * b[1] + p[2] * b[2]);
        p[0] = along;
        p[1] = -cos(elevation) * to_face + sin(elevation) * across;
        p[2] = sin(elevation) * to_face + cos(elevation) * across;
    }
}

#define STEPS 700 /* of quadrature along a facet's edges: 0.6 mm, a phase of 0.5 rad at most */

/* Physical optics of one facet by quadrature, each point seen from abreast of it, through the
 * pulse: adds it at some ranges. */
static void add_facet(const struct bench *bench, double corners[3][3], const double *ranges,
                      size_t count, struct complex_value *values)
{
    const double k = bench_wavenumber(bench);
    const double h = bench->scene.sonar.altitude_m;
    double ab[3], ac[3];
    for (int axis = 0; axis < 3; axis++) {
        ab[axis] = corners[1][axis] - corners[0][axis];
        ac[axis] = corners[2][axis] - corners[0][axis];
    }
    const double n[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                         ab[0] * ac[1] - ab[1] * ac[0]}; /* twice the area */
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS - i; j++)
            for (int half = 0; half < (j < STEPS - i - 1 ? 2 : 1); half++) {
                const double u = (i + (1.0 + half) / 3.0) / STEPS;
                const double v = (j + (1.0 + half) / 3.0) / STEPS;
                const double y = corners[0][1] + u * ab[1] + v * ac[1];
                const double z = corners[0][2] + u * ab[2] + v * ac[2] - h;
                const double r = hypot(y, z);
                const double projected = -0.5 * (n[1] * y + n[2] * z) / (r * STEPS * STEPS);
                if (projected <= 0.0)
                    return; /* dark: all of a facet is, but for a grazing sliver */
                const double phase = 2.0 * k * r;
                const double share = projected * k / (2.0 * PI);
                for (size_t at = 0; at < count; at++) {
                    const double g =
                        share * range_response(&bench->tracer.response, ranges[at] - r);
                    values[at].real_part += g * sin(phase);
                    values[at].imaginary_part -= g * cos(phase);
                }
            }
}

/* Eight plates of many wavelengths against quadrature over them, once with a face that mirrors and
 * once with one that is 0.1 rad off it. */
static void test_octahedron(void **unused)
{
    (void)unused;
    static const double off[] = {0.0, 0.1};
    for (size_t i = 0; i < 2; i++) {
        struct mesh_sample sample;
        struct bench bench;
        double ranges[40];
        struct complex_value reference[40];
        const size_t count = sizeof ranges / sizeof *ranges;
        bench_open(&bench, ROWS, COLUMNS, RANGE);
        bench_add(&bench, SONJECT_SHAPE_MESH, 0.0, 0.0, 0.0)->burial_m = -0.5;
        turned_octahedron(&sample, asin((bench.scene.sonar.altitude_m - 0.8) / RANGE) + off[i]);
        const struct mesh *mesh = use_mesh(&bench, &sample, RADIUS, 0.0);
        assert_int_equal(mesh->triangle_count, 8);
        bench_ready(&bench);
        const struct placement *placed = &bench.placements[0];
        const double middle =
            hypot(placed->centre[1], placed->centre[2] - bench.scene.sonar.altitude_m);
        memset(reference, 0, sizeof reference);
        for (size_t at = 0; at < count; at++)
            ranges[at] = middle + RADIUS * (-1.2 + 2.4 * (double)at / (double)(count - 1));
        for (size_t facet = 0; facet < mesh->triangle_count; facet++) {
            double corners[3][3];
            for (size_t corner = 0; corner < 3; corner++)
                for (int axis = 0; axis < 3; axis++) {
                    const float *p = &mesh->vertices[3 * mesh->corners[3 * facet + corner]];
                    corners[corner][axis] = placed->centre[axis];
                    for (int own = 0; own < 3; own++)
                        corners[corner][axis] += (double)p[own] * placed->axes[own][axis];
                }
            add_facet(&bench, corners, ranges, count, reference);
        }
        struct echo_line line = bench_glint_line(&bench, 0);
        double peak = 0.0;
        double largest = 0.0;
        for (size_t at = 0; at < count; at++) {
            const struct complex_value value = echo_line_at(&bench, &line, ranges[at]);
            peak = fmax(peak, hypot(reference[at].real_part, reference[at].imaginary_part));
            largest = fmax(largest, hypot(value.real_part - reference[at].real_part,
                                          value.imaginary_part - reference[at].imaginary_part));
        }
        print_message("%.1f rad off, peak %.2f dB re 1 m: ", off[i], decibels_of_amplitude(peak));
        /* ranges of 40 m come in steps of 3.8 um in single precision: two of them are a phase of
         * 0.0064, and 0.02 dB of level; cells of lambda/8 that the facets' edges divide, 2.5 m of
         * them, are hit or missed by chance: 4 x 0.29 sqrt(L/c) c^2/lambda = 0.0098 m */
        expect_below("error, dB re 1 m", decibels_of_amplitude(largest),
                     decibels_of_amplitude(0.0098 + 0.009 * peak));
        echo_line_clear(&line);
        bench_close(&bench);
        sample_clear(&sample);
    }
}

/* A square that faces the sonar, or turns its back to it, as a mesh; or the plate itself. */
static void compute_sheet(struct echoes *echoes, int kind, bool is_rough)
{
    static double positions[][3] = {
        {-0.3, -0.2, 0.0}, {0.3, -0.2, 0.0}, {0.3, 0.2, 0.0}, {-0.3, 0.2, 0.0}};
    static uint32_t corners[][2][3] = {{{0, 1, 2}, {0, 2, 3}}, {{0, 2, 1}, {0, 3, 2}}};
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.interactions = is_rough ? 3 : 1;
    sonject_object_params *object =
        bench_add(&bench, kind < 2 ? SONJECT_SHAPE_MESH : SONJECT_SHAPE_PLANE, 0.6, 0.4, 0.0);
    object->heading_rad = 0.1;
    object->roll_rad = -1.3;
    if (is_rough)
        make_rough(object);
    set_mirror(&bench);
    if (kind < 2) {
        const struct mesh_sample sheet = {positions[0], corners[kind][0], 4, 2};
        assert_false(use_mesh(&bench, &sheet, 1.0, 0.0)->topology.is_closed);
    }
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, echoes);
    bench_close(&bench);
}

/* Mirrors and chains too find both sides: the same rays as the plate's. */
static void test_sheets_reflect_on_both_sides(void **unused)
{
    (void)unused;
    for (int is_rough = 0; is_rough < 2; is_rough++) {
        struct echoes plate;
        compute_sheet(&plate, 2, is_rough > 0);
        for (int kind = 0; kind < 2; kind++) {
            struct echoes sheet;
            compute_sheet(&sheet, kind, is_rough > 0);
            print_message("%s, side %d: ", is_rough ? "rough" : "smooth", kind);
            /* but for rays through the edges: 2 m of them against cells of some mm in 0.24 m^2 */
            if (is_rough)
                expect_close("energy over the plate's",
                             total(sheet.target_energy) / total(plate.target_energy), 1.0, 0.01);
            else
                expect_below("difference, dB of the glint", glint_difference(&plate, &sheet),
                             -40.0);
            echoes_clear(&sheet);
        }
        echoes_clear(&plate);
    }
}

enum sphere_kind {
    SPHERE_EXACT,
    SPHERE_FLAT,
    SPHERE_SMOOTH
};

/* Of a unit sphere's facets as large together as the sphere: convex bodies of equal surface show
 * the same area on average over all directions (Cauchy). */
static double radius_of_equal_surface(const struct mesh_sample *sample)
{
    double surface = 0.0;
    for (size_t i = 0; i < sample->triangles; i++) {
        const double *a = &sample->positions[3 * sample->corners[3 * i]];
        const double *b = &sample->positions[3 * sample->corners[3 * i + 1]];
        const double *c = &sample->positions[3 * sample->corners[3 * i + 2]];
        const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        surface +=
            0.5 * sqrt(pow(u[1] * v[2] - u[2] * v[1], 2.0) + pow(u[2] * v[0] - u[0] * v[2], 2.0) +
                       pow(u[0] * v[1] - u[1] * v[0], 2.0));
    }
    return sqrt(4.0 * PI / surface);
}

static const char *const kind_names[] = {"sphere", "flat facets", "smooth facets"};

/* A Lambert sphere of 128 facets (22.5 degrees), or the shape itself. */
static void add_lambert_sphere(struct bench *bench, enum sphere_kind kind)
{
    struct mesh_sample sample;
    sonject_object_params *object =
        bench_add(bench, kind == SPHERE_EXACT ? SONJECT_SHAPE_SPHERE : SONJECT_SHAPE_MESH, 0.0, 0.0,
                  2.0 * RADIUS);
    make_rough(object);
    object->burial_m = -1.0;
    sample_sphere(&sample, 2);
    if (kind != SPHERE_EXACT)
        use_mesh(bench, &sample, RADIUS * radius_of_equal_surface(&sample),
                 kind == SPHERE_SMOOTH ? 1.0 : 0.0);
    sample_clear(&sample);
}

/* What one estimate of a sphere's rough echoes holds. */
struct shading {
    struct line_grid grid;
    double first_range, middle, bin; /* m */
    float *energy;                   /* strips x bins; for free() */
};

/* exponent: of the cosine with which its surface scatters; rays are the same for all. */
static struct shading shading_of(enum sphere_kind kind, double exponent)
{
    struct bench bench;
    struct rough_trace trace;
    struct shading shading;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.ray_scale = 16.0;
    add_lambert_sphere(&bench, kind);
    bench.scene.objects[0].material.lambert_exponent = exponent;
    bench_ready(&bench);
    assert_int_equal(rough_trace_begin(&trace, &bench.tracer, NULL), SONJECT_OK);
    float *seabed = calloc(line_grid_cells(&trace.grid), sizeof *seabed);
    shading.energy = calloc(trace.tile_elements, sizeof *shading.energy);
    assert_true(seabed && shading.energy);
    if (rough_trace_strips(&trace, &bench.tracer, trace.grid.strips, seabed) != SONJECT_OK ||
        rough_trace_tiles(&trace, &bench.tracer, shading.energy) != SONJECT_OK)
        fail_msg("%s", bench.report.message);
    assert_true(TILE_ENERGY == 0);
    shading.grid = trace.tiles[0].grid;
    shading.bin = bench.tracer.view.column_spacing_m / shading.grid.bins_per_pixel;
    shading.first_range = bench.tracer.view.first_range_m + shading.grid.bins.first * shading.bin;
    shading.middle = placement_range(&bench.placements[0], &bench.tracer.view);
    free(seabed);
    rough_trace_end(&trace);
    bench_close(&bench);
    return shading;
}

/* A surface shows a ray a cosine c, which on a sphere falls from 1 by the depth over the radius,
 * and of exponents 1 and 2 returns c and 3/2 c^3: the ratio tells c, however echoes are shared
 * between bins. Returns its rms error over cells of a strip and a bin of range, weighed by their
 * energy, and *brightness, the sum of what is shown over that of what should be. */
static double shading_error(enum sphere_kind kind, double *brightness)
{
    struct shading lambert = shading_of(kind, 1.0);
    struct shading sharper = shading_of(kind, 2.0);
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < line_grid_cells(&lambert.grid); i++) {
        const double energy = (double)lambert.energy[i];
        const double range =
            lambert.first_range + (double)(i % (size_t)lambert.grid.bins.count) * lambert.bin;
        const double expected = (lambert.middle - range) / RADIUS;
        if (!(energy > 0.0) || expected < 0.05)
            continue; /* the outline */
        const double shown = sqrt((double)sharper.energy[i] / (1.5 * energy));
        sums[0] += energy;
        sums[1] += energy * pow(shown - expected, 2.0);
        sums[2] += energy * shown;
        sums[3] += energy * expected;
    }
    assert_true(sums[0] > 0.0);
    free(lambert.energy);
    free(sharper.energy);
    *brightness = sums[2] / sums[3];
    return sqrt(sums[1] / sums[0]);
}

static void test_smooth_normals_shade_like_the_sphere(void **unused)
{
    (void)unused;
    double error[3], brightness[3];
    for (int kind = 0; kind < 3; kind++) {
        error[kind] = shading_error((enum sphere_kind)kind, &brightness[kind]);
        print_message("%s: rms error of the cosine %.4f, brightness %.4f\n", kind_names[kind],
                      error[kind], brightness[kind]);
    }
    expect_below("of the sphere itself, half a bin over its radius", error[SPHERE_EXACT], 0.0052);
    expect_below("smooth over flat", error[SPHERE_SMOOTH] / error[SPHERE_FLAT], 1.0 / 3.5);
    /* what is left of it: facets up to 6 mm off the sphere look like 0.02 of its depth */
    expect_close("brightness", brightness[SPHERE_SMOOTH], 1.0, 0.01);
}

/* A convex body sees nothing of itself, and no more do the facets that stand for one: what there is
 * of two interactions is by way of a seabed that hardly scatters. */
static double energy_of_two(enum sphere_kind kind)
{
    struct bench bench;
    struct echoes echoes;
    bench_open(&bench, ROWS, COLUMNS, RANGE);
    bench.scene.injection.interactions = 2;
    bench.scene.injection.order_energies = 1;
    bench.scene.seabed.lambert = 1e-6;
    add_lambert_sphere(&bench, kind);
    bench_ready(&bench);
    bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
    const double share = total(echoes.order_energy[1]) / total(echoes.order_energy[0]);
    echoes_clear(&echoes);
    bench_close(&bench);
    return share;
}

static void test_facets_see_nothing_of_themselves(void **unused)
{
    (void)unused;
    const double exact = energy_of_two(SPHERE_EXACT);
    for (int kind = SPHERE_FLAT; kind <= SPHERE_SMOOTH; kind++)
        /* some thousand rays from seabed to sphere: 2 % */
        expect_close(kind_names[kind], energy_of_two((enum sphere_kind)kind) / exact, 1.0, 0.1);
}

/* Energy by column of paths by way of the seabed's mirror there or back: the sphere is lit from 75
 * degrees beside where it is seen from. */
static void mirrored_energy(enum sphere_kind kind, double columns[COLUMNS])
{
    memset(columns, 0, COLUMNS * sizeof *columns);
    for (uint32_t interactions = 2; interactions >= 1; interactions--) {
        struct bench bench;
        struct echoes echoes;
        bench_open(&bench, ROWS, COLUMNS, 13.5);
        bench.scene.injection.ray_scale = 4.0;
        bench.scene.injection.interactions = interactions;
        set_mirror(&bench);
        add_lambert_sphere(&bench, kind);
        bench_ready(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_NONE, &echoes);
        for (size_t i = 0; i < PIXELS; i++)
            columns[i % COLUMNS] +=
                (interactions == 2 ? 1.0 : -1.0) * (double)echoes.target_energy[i];
        echoes_clear(&echoes);
        bench_close(&bench);
    }
}

static void test_facets_throw_no_shadows(void **unused)
{
    (void)unused;
    double exact[COLUMNS], smooth[COLUMNS];
    double peak = 0.0, tails[2] = {0.0, 0.0};
    mirrored_energy(SPHERE_EXACT, exact);
    mirrored_energy(SPHERE_SMOOTH, smooth);
    for (size_t i = 0; i < COLUMNS; i++) {
        if (exact[i] >= peak)
            tails[0] = tails[1] = 0.0; /* the peak is still to come */
        peak = fmax(peak, exact[i]);
        if (exact[i] > 0.02 * peak)
            continue;
        tails[0] += exact[i];
        tails[1] += smooth[i];
    }
    /* within some ten facets of the shadow's edge; facets that shadow each other leave 0.25 */
    expect_close("energy where light fades out, over the sphere's", tails[1] / tails[0], 1.0, 0.4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_of_facets),
        cmocka_unit_test(test_octahedron),
        cmocka_unit_test(test_sheets_reflect_on_both_sides),
        cmocka_unit_test(test_smooth_normals_shade_like_the_sphere),
        cmocka_unit_test(test_facets_see_nothing_of_themselves),
        cmocka_unit_test(test_facets_throw_no_shadows),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
