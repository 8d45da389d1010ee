/* The scene that benchmarks run on: a capsule on a Lambert seabed, as in the paper's Figures 6 and
 * 7. Failures end the program. */
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

/* Gives the names of the OpenCL devices and returns their number, BENCHMARK_DEVICES at most. */
#define BENCHMARK_DEVICES 16
size_t benchmark_opencl_devices(char names[BENCHMARK_DEVICES][128]);

/* Lays a patch of pixels x pixels around 50 m. device: sonject_context_params' device_name. */
void benchmark_set_up(struct benchmark_scene *set, const char *device, size_t pixels);

/* The two steps of benchmark_set_up. Between them the caller appends other objects to the scene. */
void benchmark_begin(struct benchmark_scene *set, const char *device, size_t pixels);
void benchmark_place(struct benchmark_scene *set, size_t pixels);
void benchmark_clear(struct benchmark_scene *set);

void benchmark_expect(const struct report *report, sonject_status status);

/* Returns zeroed memory, to be given to free(). */
void *benchmark_array(size_t count, size_t bytes);

/* Returns the threads for the native side: a CPU device's cores, or beside a GPU the host's. */
unsigned benchmark_threads(const struct device *device);

/* Shares out `count` elements, a multiple of the grain, among threads and waits for all threads.
 * Each gets whole grains. */
typedef void benchmark_work(const void *what, unsigned thread, uint32_t first, uint32_t last);
void benchmark_share_out(benchmark_work *work, const void *what, unsigned threads, uint32_t count,
                         uint32_t grain);

#endif
