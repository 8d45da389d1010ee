/* One mesh shown by several objects: the same bits as a mesh for each, and one copy of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "../kernel/mesh_samples.h"
#include "bench.h"

#define ROWS    81
#define COLUMNS 161
#define RANGE   40.0
#define OBJECTS 3

static void load(struct bench *bench, struct mesh *mesh)
{
    struct mesh_sample sample;
    struct mesh_options options;
    mesh_options_init(&options);
    options.unit_m = 0.4;
    options.smooth_angle_rad = 0.5;
    sample_ring(&sample, 60, 40);
    if (mesh_from_arrays(&bench->report, "ring", sample.positions, sample.vertices, sample.corners,
                         sample.triangles, &options, mesh) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    sample_clear(&sample);
}

/* Rings in different poses; each object shows a mesh of its own, or all the first one. */
static void lay_rings(struct bench *bench, bool is_shared)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    bench->scene.injection.interactions = 2;
    bench->scene.mesh_count = is_shared ? 1 : OBJECTS;
    bench->scene.meshes = calloc(OBJECTS, sizeof *bench->scene.meshes);
    assert_non_null(bench->scene.meshes);
    for (uint32_t i = 0; i < bench->scene.mesh_count; i++)
        load(bench, &bench->scene.meshes[i]);
    for (uint32_t i = 0; i < OBJECTS; i++) {
        sonject_object_params *object = bench_add(bench, SONJECT_SHAPE_MESH, 0.0, 0.0, 0.0);
        object->mesh = is_shared ? 0 : i;
        object->position_kind = SONJECT_POSITION_METRES;
        object->position_along = 1.0;
        object->position_range = RANGE - 1.2 + i;
        object->heading_rad = 0.7 * i;
        object->pitch_rad = 1.1 * i;
        object->material.lambert = 0.05;
        object->material.roughness_m = 0.002;
    }
    bench_ready(bench);
}

static size_t bytes_on_device(struct bench *bench)
{
    struct rough_trace trace;
    size_t bytes;
    if (rough_trace_begin(&trace, &bench->tracer, NULL) != SONJECT_OK)
        fail_msg("%s", bench->report.message);
    assert_int_equal(
        clGetMemObjectInfo(trace.on_device.objects, CL_MEM_SIZE, sizeof bytes, &bytes, NULL),
        CL_SUCCESS);
    rough_trace_end(&trace);
    return bytes;
}

static void test_one_mesh_of_many_objects(void **unused)
{
    (void)unused;
    struct echoes echoes[2];
    size_t bytes[2], of_mesh = 0;
    for (int is_shared = 0; is_shared < 2; is_shared++) {
        struct bench bench;
        lay_rings(&bench, is_shared > 0);
        const struct mesh_hierarchy *hierarchy = &bench.scene.meshes[0].hierarchy;
        of_mesh = hierarchy->branch_count * sizeof *hierarchy->branches +
                  hierarchy->leaf_count *
                      (sizeof *hierarchy->leaves + MESH_SLOTS * sizeof(struct mesh_corner_normals));
        bytes[is_shared] = bytes_on_device(&bench);
        bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes[is_shared]);
        bench_close(&bench);
    }
    const size_t plane = (size_t)ROWS * COLUMNS * sizeof(float);
    double sum = 0.0;
    for (size_t i = 0; i < (size_t)ROWS * COLUMNS; i++)
        sum += (double)echoes[0].target_energy[i];
    assert_true(sum > 0.0);
    assert_memory_equal(echoes[0].target_energy, echoes[1].target_energy, plane);
    assert_memory_equal(echoes[0].lost_energy, echoes[1].lost_energy, plane);
    assert_memory_equal(echoes[0].target_real, echoes[1].target_real, plane);
    assert_memory_equal(echoes[0].target_imaginary, echoes[1].target_imaginary, plane);
    print_message("%zu bytes on the device for three meshes, %zu for one; a mesh takes %zu\n",
                  bytes[0], bytes[1], of_mesh);
    /* meshes begin at multiples of 64 bytes */
    assert_in_range(bytes[0] - bytes[1], 2 * of_mesh, 2 * of_mesh + 2 * 128);
    assert_in_range(bytes[1], of_mesh, of_mesh + 8192);
    echoes_clear(&echoes[0]);
    echoes_clear(&echoes[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_mesh_of_many_objects),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
