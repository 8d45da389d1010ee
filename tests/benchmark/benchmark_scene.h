/* The scene that benchmarks run on: a capsule on a Lambert seabed, as in the paper's Figures 6 and
 * 7. What fails ends the program. */
#ifndef SONJECT_TESTS_BENCHMARK_SCENE_H
#define SONJECT_TESTS_BENCHMARK_SCENE_H

#include "trace/tracer.h"

#define THREADS_MAX 64

struct benchmark_scene {
    struct report report;
    struct scene scene;
    struct tracer tracer;
    struct placements placed;
    struct water water;
};

/* Names of OpenCL's devices; their number. */
#define BENCHMARK_DEVICES 16
size_t benchmark_opencl_devices(char names[BENCHMARK_DEVICES][128]);

/* Lays a patch of pixels x pixels around 50 m. device: as sonject_context_params' device_name. */
void benchmark_set_up(struct benchmark_scene *set, const char *device, size_t pixels);

/* The same in two steps, for other objects: they are appended to the scene in between. */
void benchmark_begin(struct benchmark_scene *set, const char *device, size_t pixels);
void benchmark_place(struct benchmark_scene *set, size_t pixels);
void benchmark_clear(struct benchmark_scene *set);

void benchmark_expect(const struct report *report, sonject_status status);

/* Zeros, for free(). */
void *benchmark_array(size_t count, size_t bytes);

/* Threads for the native side: a CPU's cores, beside a GPU the host's. */
unsigned benchmark_threads(const struct device *device);

/* Shares out `count` elements, a multiple of the grain, among threads, whole grains to each, and
 * waits for all. */
typedef void benchmark_work(const void *what, unsigned thread, uint32_t first, uint32_t last);
void benchmark_share_out(benchmark_work *work, const void *what, unsigned threads, uint32_t count,
                         uint32_t grain);

#endif
