#define _POSIX_C_SOURCE 200809L
#include "benchmark_scene.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void benchmark_fail(const struct report *report, const char *what)
{
    fprintf(stderr, "%s: %s\n", what, report->message);
    exit(1);
}

void benchmark_begin(struct benchmark_scene *set, size_t pixels)
{
    sonject_context_params params = {.struct_size = sizeof params};
    memset(set, 0, sizeof *set);
    scene_init(&set->scene);
    set->scene.sonar.aperture_rad = 0.0;
    set->scene.geometry.first_slant_range_m = 50.0 - 0.0125 * (double)pixels;
    set->tracer.report = &set->report;
    set->tracer.scene = &set->scene;
    if (device_open(&set->report, &params, &set->tracer.device) != SONJECT_OK)
        benchmark_fail(&set->report, "device");
}

void benchmark_place(struct benchmark_scene *set, size_t pixels)
{
    if (scene_lay_water(&set->scene, &set->report, &set->water) != SONJECT_OK ||
        patch_view_init(&set->tracer.view, &set->report, &set->scene, &set->water, 0.0, 0.0, pixels,
                        pixels) != SONJECT_OK ||
        placements_init(&set->placed, &set->report, &set->scene, &set->tracer.view, 0.0, 0.0) !=
            SONJECT_OK)
        benchmark_fail(&set->report, "set-up");
    set->tracer.placements = set->placed.parts;
    set->tracer.part_count = set->placed.part_count;
    set->tracer.objects = set->placed.objects;
    point_response_init(&set->tracer.response, &set->scene.sonar, 1500.0, 0.025);
}

void benchmark_set_up(struct benchmark_scene *set, size_t pixels)
{
    sonject_object_params capsule;
    benchmark_begin(set, pixels);
    sonject_object_params_init(&capsule);
    capsule.shape = SONJECT_SHAPE_CAPSULE;
    capsule.length_m = 2.3;
    capsule.diameter_m = 0.3;
    capsule.heading_rad = 0.6;
    capsule.burial_m = 0.1;
    if (scene_append_object(&set->scene, &set->report, &capsule) != SONJECT_OK)
        benchmark_fail(&set->report, "set-up");
    benchmark_place(set, pixels);
}

void benchmark_clear(struct benchmark_scene *set)
{
    device_close(&set->tracer.device);
    placements_clear(&set->placed);
    water_clear(&set->water);
    scene_clear(&set->scene);
}

unsigned benchmark_threads(const struct device *device)
{
    const long cores = device->is_cpu ? (long)device->compute_units : sysconf(_SC_NPROCESSORS_ONLN);
    return cores < 1 ? 1 : cores < THREADS_MAX ? (unsigned)cores : THREADS_MAX;
}

void benchmark_run_threads(void *(*work)(void *), void *elements, size_t size, unsigned threads)
{
    pthread_t workers[THREADS_MAX];
    for (unsigned i = 0; i < threads; i++)
        pthread_create(&workers[i], NULL, work, (char *)elements + i * size);
    for (unsigned i = 0; i < threads; i++)
        pthread_join(workers[i], NULL);
}
