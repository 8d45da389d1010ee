/* Rates of rays on a mesh of 534,360 triangles: kernels on the OpenCL device, kernels as native C
 * of 8 lanes, and, where it is installed, Embree in packets of 16. All trace the same rays on the
 * same number of cores in the same run. Processor time counts, since other programs may run, too
 * (on a GPU: the clock). Primary rays come from a fan like a sonar's, strip by strip. Bounced rays
 * leave their hits by Lambert's law. Prints one line per kind of ray, and how the device's time
 * grows with the triangles. Fails only if device and native C differ in a bit. */
#include <pthread.h>
#include <time.h>
#include <unistd.h>

#include "base/system/process.h"
#include "device/backend.h"
#include "kernel/mesh_native.h"
#include "kernel/mesh_probe.h"
#include "kernel/mesh_samples.h"
#include "kernel/probe_device.h"
#include "mesh_arrays.h"
#include "physics/bench.h"

#ifdef HAS_EMBREE
#include <embree3/rtcore.h>
#endif

#define REPEATS     7
#define SIDE        1024 /* number of strips, and of rays per strip */
#define THREADS_MAX 64

/* Embree's copy of the mesh. Where Embree is not installed, embree_open returns NULL. */
struct embree_scene;

#ifndef HAS_EMBREE

static struct embree_scene *embree_open(const struct mesh *mesh, double *build_s)
{
    (void)mesh;
    *build_s = 0.0;
    return NULL;
}

static void embree_close(struct embree_scene *scene)
{
    (void)scene;
}

static void embree_trace(struct embree_scene *scene, bool is_coherent, const float *input,
                         float *output, uint32_t rays, uint32_t first, uint32_t last)
{
    (void)scene, (void)is_coherent, (void)input, (void)output;
    (void)rays, (void)first, (void)last;
}

#else

/* The largest distance, m, of Embree's origin before the ray's closest approach to the mesh's
 * middle. Embree does not look behind the origin. It lies where the ray begins, if nearer. */
#define BEFORE 3.0f

struct embree_scene {
    RTCDevice device;
    RTCScene scene;
};

static struct embree_scene *embree_open(const struct mesh *mesh, double *build_s)
{
    struct embree_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return NULL;
    scene->device = rtcNewDevice("threads=1");
    scene->scene = rtcNewScene(scene->device);
    const RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             12, mesh->vertex_count);
    void *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            12, mesh->triangle_count);
    memcpy(vertices, mesh->vertices, 12 * mesh->vertex_count);
    memcpy(corners, mesh->corners, 12 * mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene->scene, geometry);
    rtcReleaseGeometry(geometry);
    const double start = clock_seconds();
    rtcCommitScene(scene->scene);
    *build_s = clock_seconds() - start;
    return scene;
}

static void embree_close(struct embree_scene *scene)
{
    if (!scene)
        return;
    rtcReleaseScene(scene->scene);
    rtcReleaseDevice(scene->device);
    free(scene);
}

static void embree_trace(struct embree_scene *scene, bool is_coherent, const float *input,
                         float *output, uint32_t rays, uint32_t first, uint32_t last)
{
    struct RTCIntersectContext context;
    int valid[16] __attribute__((aligned(64)));
    rtcInitIntersectContext(&context);
    context.flags =
        is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    memset(valid, 0xff, sizeof valid);
    for (uint32_t ray = first; ray < last; ray += 16) {
        struct RTCRayHit16 packet __attribute__((aligned(64)));
        for (uint32_t i = 0; i < 16; i++) {
            const float *at = input + ray + i;
            const float minimum = at[PROBE_MINIMUM * rays];
            const float start = minimum < -BEFORE ? -BEFORE : minimum;
            packet.ray.org_x[i] = at[0] + start * at[PROBE_DIRECTION * rays];
            packet.ray.org_y[i] = at[rays] + start * at[(PROBE_DIRECTION + 1) * rays];
            packet.ray.org_z[i] = at[2 * rays] + start * at[(PROBE_DIRECTION + 2) * rays];
            packet.ray.dir_x[i] = at[PROBE_DIRECTION * rays];
            packet.ray.dir_y[i] = at[(PROBE_DIRECTION + 1) * rays];
            packet.ray.dir_z[i] = at[(PROBE_DIRECTION + 2) * rays];
            packet.ray.tnear[i] = 0.0f;
            packet.ray.tfar[i] = FAR_AWAY;
            packet.ray.time[i] = 0.0f;
            packet.ray.mask[i] = ~0u;
            packet.ray.flags[i] = 0;
            packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene->scene, &context, &packet);
        for (uint32_t i = 0; i < 16; i++) {
            const bool is_hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            const int32_t triangle = is_hit ? (int32_t)packet.hit.primID[i] : -1;
            output[PROBE_DISTANCE * rays + ray + i] = packet.ray.tfar[i];
            memcpy(&output[PROBE_TRIANGLE * rays + ray + i], &triangle, sizeof triangle);
        }
    }
}

#endif

struct rays {
    const struct mesh *mesh;
    struct embree_scene *embree; /* NULL: native C */
    bool is_coherent;
    const float *input;
    float *output;
    uint32_t count;
};

/* A thread's rays. */
struct share {
    const struct rays *rays;
    uint32_t first, last;
};

static void *trace_share(void *argument)
{
    const struct share *share = argument;
    const struct rays *rays = share->rays;
    if (rays->embree)
        embree_trace(rays->embree, rays->is_coherent, rays->input, rays->output, rays->count,
                     share->first, share->last);
    else
        mesh_native_wide(rays->mesh, MESH_NEAREST, rays->input, rays->output, rays->count,
                         share->first, share->last);
    return NULL;
}

/* Traces packets of 16 rays in threads. */
static void trace_rays(const struct rays *rays, unsigned threads)
{
    pthread_t workers[THREADS_MAX];
    struct share shares[THREADS_MAX];
    const uint64_t packets = rays->count / 16;
    for (unsigned i = 0; i < threads; i++) {
        shares[i] = (struct share){rays, (uint32_t)(packets * i / threads) * 16,
                                   (uint32_t)(packets * (i + 1) / threads) * 16};
        pthread_create(&workers[i], NULL, trace_share, &shares[i]);
    }
    for (unsigned i = 0; i < threads; i++)
        pthread_join(workers[i], NULL);
}

/* Returns the processor time of all threads together. */
static double processor_seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Returns the best time of REPEATS, s. */
static double time_rays(const struct rays *rays, unsigned threads)
{
    double best = INFINITY;
    for (int i = 0; i < REPEATS; i++) {
        const double start = processor_seconds();
        trace_rays(rays, threads);
        best = fmin(best, (processor_seconds() - start) / threads);
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

/* Lays a fan over strips that cover the mesh, from 17 m away and 10 m above. */
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

/* Lays rays that leave the hits of the fan's rays. Returns their number, a multiple of 16. */
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
    /* closes the gaps between the planes, which now hold `count` rays each */
    count = count / 16 * 16;
    for (uint32_t plane = 1; plane < PROBE_INPUTS; plane++)
        memmove(input + plane * count, input + plane * fan_rays, count * sizeof *input);
    return count;
}

struct bench_set {
    struct bench bench;
    struct mesh mesh;
    struct probe_device probe;
    struct embree_scene *embree;
    unsigned threads;
};

/* Returns whether native C and device differ in a bit. Leaves the device's answers in output. */
static int compare(struct bench_set *set, const char *name, bool is_coherent, const float *input,
                   float *output, uint32_t rays)
{
    float *native = zeroed(rays, PROBE_OUTPUTS * sizeof *native);
    const double device_s = probe_device_run(&set->probe, "nearest", input, output, rays, REPEATS);
    struct rays work = {&set->mesh, NULL, is_coherent, input, native, rays};
    const double native_s = time_rays(&work, set->threads);
    const int differs = memcmp(native, output, 2 * (size_t)rays * sizeof *native) != 0;
    uint32_t hits = 0;
    for (uint32_t ray = 0; ray < rays; ray++)
        hits += output[ray] < FAR_AWAY;
    printf("%s rays (%.0f %% hit): %.1f Mrays/s on the device, %.1f native C", name,
           100.0 * hits / rays, 1e-6 * rays / device_s, 1e-6 * rays / native_s);
    if (set->embree) {
        work.embree = set->embree;
        const double embree_s = time_rays(&work, set->threads);
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
    sample_ring(&sample, around, across);
    const double start = clock_seconds();
    mesh_of_sample(&sample, 1.0, 0.0, &set->mesh);
    const double taken = clock_seconds() - start;
    sample_clear(&sample);
    return taken;
}

static void begin_probe(struct bench_set *set)
{
    struct device *device = set->bench.device;
    probe_device_begin(&set->probe, &set->bench.report, device, device->width, &set->mesh);
}

/* Opens the first OpenCL device. Its cores, or beside a GPU the host's, run native C's threads. */
static void set_up(struct bench_set *set)
{
    static char names[BENCH_DEVICES][128];
    const size_t count = bench_devices(names);
    size_t first = 0;
    double build_s;
    while (first < count && native_is_named(names[first]))
        first++;
    if (first == count) {
        printf("no OpenCL device: nothing is timed\n");
        exit(1);
    }
    bench_device = names[first];
    bench_open(&set->bench, 1, 1, 18.0);
    const double ready_s = build_mesh(set, 730, 366);
    printf("mesh of %zu triangles: ready after %.2f s on one core", set->mesh.triangle_count,
           ready_s);
    set->embree = embree_open(&set->mesh, &build_s);
    if (set->embree)
        printf(" (Embree's hierarchy alone %.2f s)", build_s);
    const struct device *device = set->bench.device;
    const long cores = device->is_cpu ? (long)device->compute_units : sysconf(_SC_NPROCESSORS_ONLN);
    set->threads = cores < 1 ? 1 : cores < THREADS_MAX ? (unsigned)cores : THREADS_MAX;
    printf("\ndevice: %s, %u lanes, %u cores\n", device->name, (unsigned)device->width,
           set->threads);
    begin_probe(set);
}

/* Prints the device's time per ray on rings of more and more triangles. */
static void print_growth(struct bench_set *set, float *input, float *output)
{
    static const uint32_t around[] = {24, 74, 232, 730, 2310};
    const uint32_t rays = SIDE * SIDE;
    printf("triangles  primary ns  bounced ns\n");
    for (size_t i = 0; i < sizeof around / sizeof *around; i++) {
        build_mesh(set, around[i], around[i] / 2);
        begin_probe(set);
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
    float *input = zeroed(rays, PROBE_INPUTS * sizeof *input);
    float *output = zeroed(rays, PROBE_OUTPUTS * sizeof *output);
    set_up(&set);
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
    bench_close(&set.bench);
    free(input);
    free(output);
    return differs;
}
