#define _POSIX_C_SOURCE 200809L
#include "benchmark_scene.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

void benchmark_expect(const struct report *report, sonject_status status)
{
    if (status == SONJECT_OK)
        return;
    fprintf(stderr, "%s\n", report->message);
    exit(1);
}

void *benchmark_array(size_t count, size_t bytes)
{
    void *array = allocate_array(count, bytes);
    if (!array)
        exit(1);
    return array;
}

size_t benchmark_opencl_devices(char names[BENCHMARK_DEVICES][128])
{
    static sonject_device_info devices[BENCHMARK_DEVICES + 1];
    static struct report report;
    size_t count;
    benchmark_expect(&report, device_list(&report, devices, BENCHMARK_DEVICES + 1, &count));
    for (size_t i = 1; i < count && i <= BENCHMARK_DEVICES; i++)
        memcpy(names[i - 1], devices[i].name, sizeof devices[i].name);
    return count - 1 < BENCHMARK_DEVICES ? count - 1 : BENCHMARK_DEVICES;
}

void benchmark_begin(struct benchmark_scene *set, const char *device, size_t pixels)
{
    const sonject_context_params params = {.struct_size = sizeof params, .device_name = device};
    memset(set, 0, sizeof *set);
    scene_init(&set->scene);
    set->scene.sonar.aperture_rad = 0.0;
    set->scene.sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    set->scene.geometry.first_slant_range_m = 50.0 - 0.0125 * (double)pixels;
    set->tracer.report = &set->report;
    set->tracer.scene = &set->scene;
    benchmark_expect(&set->report, device_open(&set->report, &params, &set->tracer.device));
}

void benchmark_place(struct benchmark_scene *set, size_t pixels)
{
    sonject_status status = scene_lay_water(&set->scene, &set->report, &set->water);
    THEN(status, patch_view_init(&set->tracer.view, &set->report, &set->scene, &set->water, 0.0,
                                 0.0, pixels, pixels));
    THEN(status,
         placements_init(&set->placed, &set->report, &set->scene, &set->tracer.view, 0.0, 0.0));
    benchmark_expect(&set->report, status);
    set->tracer.placements = set->placed.parts;
    set->tracer.part_count = set->placed.part_count;
    set->tracer.objects = set->placed.objects;
    point_response_init(&set->tracer.response, &set->scene.sonar, 1500.0, 0.025);
}

void benchmark_set_up(struct benchmark_scene *set, const char *device, size_t pixels)
{
    sonject_object_params capsule;
    benchmark_begin(set, device, pixels);
    object_init(&capsule);
    capsule.shape = SHAPE_CAPSULE;
    capsule.length_m = 2.3;
    capsule.diameter_m = 0.3;
    capsule.heading_rad = 0.6;
    capsule.burial_m = 0.1;
    benchmark_expect(&set->report, scene_append_object(&set->scene, &set->report, &capsule));
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

struct share {
    benchmark_work *work;
    const void *what;
    unsigned thread;
    uint32_t first, last;
};

static void *run_share(void *argument)
{
    const struct share *share = argument;
    share->work(share->what, share->thread, share->first, share->last);
    return NULL;
}

void benchmark_share_out(benchmark_work *work, const void *what, unsigned threads, uint32_t count,
                         uint32_t grain)
{
    pthread_t workers[THREADS_MAX];
    struct share shares[THREADS_MAX];
    const uint64_t grains = count / grain;
    for (unsigned i = 0; i < threads; i++) {
        const uint32_t first = (uint32_t)(grains * i / threads) * grain;
        const uint32_t last = (uint32_t)(grains * (i + 1) / threads) * grain;
        shares[i] = (struct share){work, what, i, first, last};
        pthread_create(&workers[i], NULL, run_share, &shares[i]);
    }
    for (unsigned i = 0; i < threads; i++)
        pthread_join(workers[i], NULL);
}
