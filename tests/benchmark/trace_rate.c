/* Rates of the tracing kernels on the OpenCL device beside the same functions compiled as native C
 * with 16 lanes, on the same scene (a capsule on a Lambert seabed, as in the paper's Figure 6) and
 * the same number of cores, in the same run. Prints one line a kernel; fails only if the two
 * disagree in a single bit. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "benchmark_scene.h"
#include "device/device.h"
#include "native_kernel.h"
#include "trace/glints.h"
#include "trace/rough.h"

#define REPEATS 7

/* One share of the strips on its own thread. */
struct share {
    const struct fan_record *fan;
    const struct object_record *objects;
    int64_t *tallies, *tiles;
    struct outcome_record *outcomes;
    int first, last;
    int is_smooth;
};

static void *run_share(void *argument)
{
    const struct share *share = argument;
    if (share->is_smooth)
        native_trace_smooth(share->fan, share->objects, share->tallies, share->first, share->last,
                            share->outcomes);
    else
        native_trace_rough(share->fan, share->objects, NULL, share->tallies, share->tiles,
                           share->first, share->last, share->outcomes);
    return NULL;
}

static void run_native(struct share work, unsigned threads)
{
    struct share shares[THREADS_MAX];
    const int strips = work.fan->strips;
    for (unsigned i = 0; i < threads; i++) {
        shares[i] = work;
        shares[i].first = (int)((long)strips * i / threads);
        shares[i].last = (int)((long)strips * (i + 1) / threads);
    }
    benchmark_run_threads(run_share, shares, sizeof *shares, threads);
}

struct rates {
    double device_s, native_s;
    double paths;
};

static void print_rates(const char *name, const struct rates *rates)
{
    printf("%s: %.1f Mpath/s on the device, %.1f Mpath/s native C, ratio %.2f\n", name,
           rates->paths / rates->device_s / 1e6, rates->paths / rates->native_s / 1e6,
           rates->native_s / rates->device_s);
}

/* Runs both versions REPEATS times, keeps the best times, and compares the tallies. */
static int compare(struct benchmark_scene *set, struct launch *launch, device_buffer tallies,
                   size_t tally_count, size_t tile_count, int is_smooth, struct rates *rates)
{
    struct fan_record *fan = &launch->fan;
    struct report *report = &set->report;
    struct device *device = set->tracer.device;
    int64_t *from_device = allocate_array(tally_count, sizeof *from_device);
    int64_t *native = allocate_array(tally_count, sizeof *native);
    int64_t *native_tiles = allocate_array(tile_count, sizeof *native_tiles);
    struct object_record record;
    struct outcome_record *outcomes = allocate_array((size_t)fan->strips, sizeof *outcomes);
    if (!from_device || !native || !native_tiles || !outcomes ||
        buffer_read(report, device, launch->buffers[0], 0, sizeof record, &record) != SONJECT_OK)
        benchmark_fail(report, "buffers");
    rates->device_s = rates->native_s = 1e9;
    const unsigned threads = benchmark_threads(device);
    for (int i = 0; i < REPEATS; i++) {
        if (buffer_clear(report, device, tallies, tally_count * sizeof(int64_t)) != SONJECT_OK)
            benchmark_fail(report, "clear");
        double start = clock_seconds();
        if (launch_run(launch, &set->tracer) != SONJECT_OK)
            benchmark_fail(report, "launch");
        double taken = clock_seconds() - start;
        rates->device_s = taken < rates->device_s ? taken : rates->device_s;
        memset(native, 0, tally_count * sizeof *native);
        start = clock_seconds();
        const struct share work = {fan, &record, native, native_tiles, outcomes, 0, 0, is_smooth};
        run_native(work, threads);
        taken = clock_seconds() - start;
        rates->native_s = taken < rates->native_s ? taken : rates->native_s;
    }
    rates->paths = (double)fan->rays * fan->strata * fan->strips;
    if (buffer_read(report, device, tallies, 0, tally_count * sizeof(int64_t), from_device) !=
        SONJECT_OK)
        benchmark_fail(report, "read");
    const int differs = memcmp(native, from_device, tally_count * sizeof *native) != 0;
    free(from_device);
    free(native);
    free(native_tiles);
    free(outcomes);
    return differs;
}

int main(void)
{
    static struct benchmark_scene set;
    static struct rough_trace rough;
    struct smooth_trace smooth;
    struct rates rates;
    benchmark_set_up(&set, 512);
    set.scene.injection.ray_scale = 16.0; /* kernels, not launches, are what is timed */
    printf("device: %s, %u lanes, %u cores\n", set.tracer.device->name,
           (unsigned)set.tracer.device->width, (unsigned)set.tracer.device->compute_units);
    if (rough_trace_begin(&rough, &set.tracer, NULL) != SONJECT_OK)
        benchmark_fail(&set.report, "rough part");
    rough.launch.fan.first_strip = rough.grid.strips.first;
    rough.launch.fan.strips = rough.grid.strips.count;
    int differs = compare(&set, &rough.launch, rough.launch.buffers[ROUGH_TALLIES],
                          line_grid_cells(&rough.grid), rough.tile_elements, 0, &rates);
    print_rates("seabed and rough surfaces", &rates);
    if (smooth_trace_begin(&smooth, &set.tracer, 0, NULL) != SONJECT_OK)
        benchmark_fail(&set.report, "smooth part");
    smooth.launch.fan.first_strip = smooth.grid.strips.first;
    smooth.launch.fan.strips = smooth.chunk;
    differs |= compare(&set, &smooth.launch, smooth.launch.buffers[SMOOTH_TALLIES],
                       2 * (size_t)smooth.chunk * (size_t)smooth.grid.bins.count, 0, 1, &rates);
    print_rates("glints", &rates);
    printf("device and native C agree in every bit: %s\n", differs ? "NO" : "yes");
    rough_trace_end(&rough);
    smooth_trace_end(&smooth);
    benchmark_clear(&set);
    return differs;
}
