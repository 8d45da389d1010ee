/* Rates of rays on a mesh of 534,360 triangles: the kernels on the OpenCL device, as native C of 16
 * lanes, and Embree in packets of 16 where it is installed; same rays, same number of cores, same
 * run; by the processors' time, since other programs may run too (on a GPU: by the clock). Primary
 * rays come from a fan as a sonar's do, strip by strip; bounced ones leave where these hit, by
 * Lambert's law. Prints a line a kind of ray, and how the device's time grows with the triangles;
 * fails only if device and native C disagree in a bit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "base/report.h"
#include "benchmark_scene.h"
#include "kernel/mesh_native.h"
#include "kernel/mesh_probe.h"
#include "kernel/mesh_samples.h"
#include "kernel/probe_device.h"
#include "mesh_embree.h"

#define REPEATS 7
#define SIDE    1024 /* strips, and rays a strip */

enum tracer_kind {
    TRACE_NATIVE,
    TRACE_EMBREE
};

/* Rays for one thread. */
struct share {
    const struct mesh *mesh;
    struct embree_scene *embree;
    enum tracer_kind kind;
    bool is_coherent;
    const float *input;
    float *output;
    uint32_t rays, first, last;
};

static void *run_share(void *argument)
{
    const struct share *share = argument;
    if (share->kind == TRACE_EMBREE)
        embree_trace(share->embree, share->is_coherent, share->input, share->output, share->rays,
                     share->first, share->last);
    else
        mesh_native_wide(share->mesh, MESH_NEAREST, share->input, share->output, share->rays,
                         share->first, share->last);
    return NULL;
}

/* Of all threads together. */
static double processor_seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Best time of REPEATS, s. */
static double time_shares(const struct share *work, unsigned threads)
{
    struct share shares[THREADS_MAX];
    double best = 1e9;
    for (unsigned i = 0; i < threads; i++) {
        shares[i] = *work;
        shares[i].first = (uint32_t)((uint64_t)work->rays / 16 * i / threads * 16);
        shares[i].last = (uint32_t)((uint64_t)work->rays / 16 * (i + 1) / threads * 16);
    }
    for (int i = 0; i < REPEATS; i++) {
        const double start = processor_seconds();
        benchmark_run_threads(run_share, shares, sizeof *shares, threads);
        const double taken = (processor_seconds() - start) / threads;
        best = taken < best ? taken : best;
    }
    return best;
}

static void set_ray(float *input, uint32_t rays, uint32_t ray, const double point[3],
                    const double direction[3], double minimum)
{
    double approach = 0.0;
    for (int axis = 0; axis < 3; axis++)
        approach -= point[axis] * direction[axis];
    for (uint32_t axis = 0; axis < 3; axis++) {
        input[axis * rays + ray] = (float)(point[axis] + approach * direction[axis]);
        input[(PROBE_DIRECTION + axis) * rays + ray] = (float)direction[axis];
    }
    input[PROBE_MINIMUM * rays + ray] = (float)(minimum - approach);
    input[PROBE_MAXIMUM * rays + ray] = 1e29f;
}

static void normalise(double v[3])
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int axis = 0; axis < 3; axis++)
        v[axis] /= length;
}

/* A fan over strips that cover the mesh, from 17 m away and 10 m above. */
static void lay_fan(float *input, uint32_t rays)
{
    for (uint32_t ray = 0; ray < rays; ray++) {
        const double along = -1.0 + 2.0 * (ray / SIDE + sample_uniform(0.0, 1.0)) / SIDE;
        const double up = -1.0 + 2.0 * (ray % SIDE + sample_uniform(0.0, 1.0)) / SIDE;
        const double from[3] = {along, -17.0, 10.0};
        double direction[3] = {0.0, 17.0 + up * 0.5, -10.0 + up * 0.86};
        normalise(direction);
        set_ray(input, rays, ray, from, direction, 0.0);
    }
}

/* From where the fan's rays hit; returns how many, a multiple of 16. */
static uint32_t lay_bounces(const float *output, uint32_t fan_rays, float *input)
{
    uint32_t count = 0;
    for (uint32_t ray = 0; ray < fan_rays; ray++) {
        double from[3], direction[3], square = 0.0;
        sample_direction(direction);
        for (uint32_t axis = 0; axis < 3; axis++) {
            const double normal = (double)output[(PROBE_FACET + axis) * fan_rays + ray];
            from[axis] = (double)output[(PROBE_HIT + axis) * fan_rays + ray] + 2e-5 * normal;
            direction[axis] = 0.9999 * direction[axis] + normal;
            square += normal * normal;
        }
        if (square == 0.0)
            continue; /* met nothing */
        normalise(direction);
        set_ray(input, fan_rays, count++, from, direction, 0.0);
    }
    /* planes of `count` rays */
    count = count / 16 * 16;
    for (uint32_t plane = 1; plane < PROBE_INPUTS; plane++)
        memmove(input + plane * count, input + plane * fan_rays, count * sizeof *input);
    return count;
}

struct bench_set {
    struct report report;
    struct device *device;
    struct mesh mesh;
    struct probe_device probe;
    struct embree_scene *embree;
    unsigned threads;
};

/* Returns whether native C and device differ in a bit; leaves the device's answers in output. */
static int compare(struct bench_set *set, const char *name, bool is_coherent, const float *input,
                   float *output, uint32_t rays)
{
    float *native = allocate_array(rays, PROBE_OUTPUTS * sizeof *native);
    if (!native)
        exit(1);
    const double device_s = probe_device_run(&set->probe, "nearest", input, output, rays, REPEATS);
    struct share work = {&set->mesh, set->embree, TRACE_NATIVE, is_coherent, input, native, rays, 0,
                         0};
    const double native_s = time_shares(&work, set->threads);
    const int differs = memcmp(native, output, 2 * (size_t)rays * sizeof *native) != 0;
    uint32_t hits = 0;
    for (uint32_t ray = 0; ray < rays; ray++)
        hits += output[ray] < FAR_AWAY;
    printf("%s rays (%.0f %% hit): %.1f Mrays/s on the device, %.1f native C", name,
           100.0 * hits / rays, 1e-6 * rays / device_s, 1e-6 * rays / native_s);
    if (set->embree) {
        work.kind = TRACE_EMBREE;
        const double embree_s = time_shares(&work, set->threads);
        printf(", %.1f Embree; device over Embree %.2f", 1e-6 * rays / embree_s,
               embree_s / device_s);
    }
    printf("\n");
    free(native);
    return differs;
}

/* Returns how long it took from triangles to mesh, s. */
static double build_mesh(struct bench_set *set, uint32_t around, uint32_t across)
{
    struct mesh_sample sample;
    struct mesh_options options;
    mesh_options_init(&options);
    sample_ring(&sample, around, across);
    const double start = clock_seconds();
    if (mesh_from_arrays(&set->report, "ring", sample.positions, sample.vertices, sample.corners,
                         sample.triangles, &options, &set->mesh) != SONJECT_OK)
        benchmark_fail(&set->report, "mesh");
    const double taken = clock_seconds() - start;
    sample_clear(&sample);
    return taken;
}

static void set_up(struct bench_set *set)
{
    sonject_context_params params = {.struct_size = sizeof params};
    double build_s;
    if (device_open(&set->report, &params, &set->device) != SONJECT_OK)
        benchmark_fail(&set->report, "device");
    const double ready_s = build_mesh(set, 730, 366);
    printf("mesh of %zu triangles: ready after %.2f s on one core", set->mesh.triangle_count,
           ready_s);
    set->embree = embree_open(&set->mesh, &build_s);
    if (set->embree)
        printf(" (Embree's hierarchy alone %.2f s)", build_s);
    set->threads = benchmark_threads(set->device);
    printf("\ndevice: %s, %u lanes, %u cores\n", set->device->name, (unsigned)set->device->width,
           set->threads);
    probe_device_begin(&set->probe, &set->report, set->device, set->device->width, &set->mesh);
}

/* The device's time for each ray on rings of ever more triangles. */
static void print_growth(struct bench_set *set, float *input, float *output)
{
    static const uint32_t around[] = {24, 74, 232, 730, 2310};
    const uint32_t rays = SIDE * SIDE;
    printf("triangles  primary ns  bounced ns\n");
    for (size_t i = 0; i < sizeof around / sizeof *around; i++) {
        build_mesh(set, around[i], around[i] / 2);
        probe_device_begin(&set->probe, &set->report, set->device, set->device->width, &set->mesh);
        lay_fan(input, rays);
        const double primary_s =
            probe_device_run(&set->probe, "nearest", input, output, rays, REPEATS);
        probe_device_run(&set->probe, "surface", input, output, rays, 1);
        const uint32_t bounces = lay_bounces(output, rays, input);
        const double bounced_s =
            probe_device_run(&set->probe, "nearest", input, output, bounces, REPEATS);
        printf("%9zu %11.1f %11.1f\n", set->mesh.triangle_count, 1e9 * primary_s / rays,
               1e9 * bounced_s / bounces);
        probe_device_end(&set->probe);
        mesh_clear(&set->mesh);
    }
}

int main(void)
{
    static struct bench_set set;
    const uint32_t rays = SIDE * SIDE;
    float *input = allocate_array(rays, PROBE_INPUTS * sizeof *input);
    float *output = allocate_array(rays, PROBE_OUTPUTS * sizeof *output);
    set_up(&set);
    if (!input || !output)
        return 1;
    lay_fan(input, rays);
    int differs = compare(&set, "primary", true, input, output, rays);
    probe_device_run(&set.probe, "surface", input, output, rays, 1);
    const uint32_t bounces = lay_bounces(output, rays, input);
    differs |= compare(&set, "bounced", false, input, output, bounces);
    printf("device and native C agree in every bit: %s\n", differs ? "NO" : "yes");
    probe_device_end(&set.probe);
    embree_close(set.embree);
    mesh_clear(&set.mesh);
    print_growth(&set, input, output);
    device_close(&set.device);
    free(input);
    free(output);
    return differs;
}
