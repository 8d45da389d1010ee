/* The scene that benchmarks run on: a capsule on a Lambert seabed, as in the paper's Figures 6 and
 * 7, on the default device. */
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

/* Lays a patch of pixels x pixels around 50 m. Ends the program where something fails. */
void benchmark_set_up(struct benchmark_scene *set, size_t pixels);

/* The same in two steps, for other objects: they are appended to the scene in between. */
void benchmark_begin(struct benchmark_scene *set, size_t pixels);
void benchmark_place(struct benchmark_scene *set, size_t pixels);
void benchmark_clear(struct benchmark_scene *set);
void benchmark_fail(const struct report *report, const char *what);

/* Threads for the native side: a CPU's cores, beside a GPU the host's. */
unsigned benchmark_threads(const struct device *device);

/* Runs work on each of `threads` elements of `size` bytes, and waits for all. */
void benchmark_run_threads(void *(*work)(void *), void *elements, size_t size, unsigned threads);

#endif
